#!/bin/sh
# Starts workers of a survey by GNU parallel, on this host or on others that have the same folders.
#
#   pipelines/cluster/parallel.sh SPOOL N [OPTION…]
#
# N: workers on each host. Further options are parallel's, such as --sshlogin one,two.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -eu
spool=$(realpath -m "$1") n=$2
shift 2
# -N0: the number is for counting only.
seq "$n" | parallel "$@" --quote -N0 --jobs "$n" --line-buffer \
  gst-cloth-gap-1.0 survey --worker --spool "$spool"
