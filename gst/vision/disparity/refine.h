/* Disparities from the pictures themselves, to small parts of a pixel.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/vision/disparity/map.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* The most other cameras. */
#define CLOTH_REFINE_MAX_VIEWS 7

/* @image: of the other camera, rectified
 * @shift: what the map's pixel p with disparity d is seen at there is p + d·@shift: −1, 0 of
 *   a camera to the right by the first baseline, 1, 0 of one to the left, 0, −0.75 of one
 *   three quarters of it below
 * @forward: of a camera that isn't in one plane with the map's: it sees the pixel at
 *   c + (p − c + d·@shift) / (1 + d·@forward), c being @centre; 0 of one that is
 * @centre: principal point, px
 * @shown: (nullable): bytes with the rows of @image: 0 where that shows nothing, 2 px around
 *   it included
 */
typedef struct {
  ClothImage image;
  gdouble shift[2];
  gdouble forward, centre[2];
  const guint8 *shown;
} ClothRefineView;

/* @radius: of the windows and of the windows of windows, px, 1 to 64
 * @rounds: how often disparities are bettered, 0 to 100
 * @outlier: difference of two pictures at which it counts half, grey levels, 1e-3 to 1e6
 * @damping: what is added to a window's sum of squared gradients, grey levels², 0 to 1e9:
 *   windows with no more than that stay nearly as they are
 * @most: how far a disparity may be moved in one round, px, 0 to 4
 */
typedef struct {
  gint radius;
  guint rounds;
  gdouble outlier, damping, most;
} ClothRefineParams;

typedef struct _ClothRefine ClothRefine;

ClothRefineParams cloth_refine_default_params (void);
ClothRefine *cloth_refine_new (void);
void cloth_refine_free (ClothRefine * self);
gboolean cloth_refine_run (ClothRefine * self,
    const ClothRefineParams * params, const ClothImage * image,
    const ClothRefineView * views, guint n_views, ClothDisparityMap * map,
    ClothPool * pool, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRefine, cloth_refine_free)
G_END_DECLS
