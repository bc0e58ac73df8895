# Lets this shell use the build in ./build without installing it: to be sourced,
#   . pipelines/environment.sh
# CLOTH_BUILD names another build folder.
# SPDX-License-Identifier: LGPL-2.1-or-later

cloth_root=$(cd "$(dirname "${BASH_SOURCE:-$0}")/.." && pwd)
cloth_build=${CLOTH_BUILD:-$cloth_root/build}

export GST_PLUGIN_PATH_1_0="$cloth_build/elements${GST_PLUGIN_PATH_1_0:+:$GST_PLUGIN_PATH_1_0}"
export GI_TYPELIB_PATH="$cloth_build/gst/cloth${GI_TYPELIB_PATH:+:$GI_TYPELIB_PATH}"
export LD_LIBRARY_PATH="$cloth_build/gst/cloth${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
export PATH="$cloth_build/tools:$PATH"
unset cloth_root cloth_build
