/* Which place of a flat picture each feature of a film shows: by features that look alike,
 * with neighbours whose distance the cloth doesn't stretch.
 *
 * D. Pritchard and W. Heidrich, “Cloth Motion Capture” (2003), section 4.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/match/align.h"
#include "gst/vision/match/grid.h"
#include "gst/vision/match/grow.h"
#include "gst/vision/match/planes.h"
#include "gst/vision/match/reference.h"
#include "gst/vision/match/steady.h"
#include "gst/vision/match/stretch.h"
#include "gst/vision/match/verify.h"
#include "gst/vision/match/warp.h"
