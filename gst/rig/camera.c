/* One camera: pinhole with lens distortion, and its place in the world.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/camera.h"
