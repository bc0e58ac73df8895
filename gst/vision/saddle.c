/* Saddle points of image intensity: the corners of a checkerboard.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/saddle.h"
