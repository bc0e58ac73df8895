/* Disparities of a cloth: out of one or more baselines, without holes, with a fraction.
 *
 * The order is cloth_disparity_check () of each baseline, cloth_disparity_merge (),
 * cloth_disparity_fill (), cloth_disparity_smooth (); and, with the pictures at hand,
 * cloth_refine_run () and once more cloth_disparity_smooth ().
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/disparity/map.h"
#include "gst/vision/disparity/merge.h"
#include "gst/vision/disparity/refine.h"
#include "gst/vision/disparity/surface.h"
