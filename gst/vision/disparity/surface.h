/* Surfaces of disparities: holes are filled, whole numbers become fractions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/math/simd.h"
#include "gst/vision/disparity/map.h"

G_BEGIN_DECLS

/* @step: greatest difference of neighbours on one surface, px, 1e-6 to
 *   %CLOTH_DISPARITY_MOST; more is an edge of depth
 * @hole: pixels of the largest hole that is filled
 * @tolerance: of the filling's equations, relative to their right side, 1e-7 to 1
 * @half_width: how far a measured disparity may be moved, px, 0 to 64: half of the quantum
 *   and the noise. The paper's 0.5 is for whole numbers
 * @narrowing: factor of the half-width each time the picture is halved, 0.1 to 1. The error
 *   of whole numbers is that of a whole stair, as large after blurring: 1. Noise grows less
 * @sweeps: how often each level of the pyramid is relaxed, 0 to 10000
 * @relaxation: factor of a correction, 0.01 to 1.99
 *
 * Of the sixteenths of cloth_cv_stereo_run () a half-width of 0.3 px with a narrowing of 0.7
 * came out best, when the pictures refine it afterwards (film of a rendered cloth at 18 mm a
 * pixel). Wider bounds flatten folds.
 */
typedef struct {
  gdouble step;
  guint hole;
  gdouble tolerance;
  gdouble half_width, narrowing;
  guint sweeps;
  gdouble relaxation;
} ClothDisparityParams;

typedef struct _ClothDisparity ClothDisparity;

ClothDisparityParams cloth_disparity_default_params (void);
ClothDisparity *cloth_disparity_new (void);
void cloth_disparity_free (ClothDisparity * self);
gboolean cloth_disparity_fill (ClothDisparity * self,
    const ClothDisparityParams * params, ClothDisparityMap * map,
    ClothPool * pool, ClothSimd level, GError ** error);
gboolean cloth_disparity_smooth (ClothDisparity * self,
    const ClothDisparityParams * params, ClothDisparityMap * map,
    ClothPool * pool, ClothSimd level, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothDisparity, cloth_disparity_free)
G_END_DECLS
