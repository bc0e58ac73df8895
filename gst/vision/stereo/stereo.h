/* A stereo head: two or three cameras of a rig, whose pictures give each pixel of the first
 * one's a disparity.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/rig/rig.h"
#include "gst/vision/disparity/disparity.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

#define CLOTH_STEREO_MAX_CAMERAS 3

/* @near: least depth, m, along the axis of ClothStereoGeometry.normal
 * @far: greatest
 * @window: edge of the blocks that are compared, px, odd, 1 to 31
 * @small_step: penalty of a step of 1 px between neighbours, for each pixel of a block
 * @large_step: penalty of a greater one; above @small_step
 * @uniqueness: by how many percent the best disparity must beat the second, 0 to 100
 * @speckle: pieces of fewer pixels are dropped, 0: none, to 100000
 * @left_right: greatest difference of the disparities from left to right and back, px, 0 to
 *   16
 * @agree: greatest difference of two baselines, px of the first, above 0
 * @surface: holes and fractions
 * @refine: refining by the pictures
 * @settle: half-width of the smoothing after that, px; 0: none
 */
typedef struct {
  gdouble near, far;
  gint window;
  gint small_step, large_step;
  gint uniqueness, speckle;
  gdouble left_right, agree;
  ClothDisparityParams surface;
  ClothRefineParams refine;
  gdouble settle;
} ClothStereoParams;

/* @width: of the first camera's picture, px
 * @height: of it
 * @rays: (array): 2·@width·@height: x/z and y/z of each filmed pixel in that camera's frame,
 *   the lens undone; NaN where it can't be
 * @normal: unit axis along which depth is measured, in that frame
 * @focal_baseline: disparity times depth, px·m
 *
 * What never changes: the point of a pixel with disparity d is s·(rx, ry, 1) in the first
 * camera's frame, s being @focal_baseline / (d · (@normal · (rx, ry, 1))).
 */
typedef struct {
  gint width, height;
  const gfloat *rays;
  gdouble normal[3];
  gdouble focal_baseline;
} ClothStereoGeometry;

/* @near_end: share of what a baseline finds on the cloth that lies at the near end of the
 *   range or before it
 * @far_end: at the far end or behind it; 0 without a mask
 * @chance: the share that would lie at an end by chance
 */
typedef struct {
  gdouble near_end, far_end, chance;
} ClothStereoBorder;

/* @map: on the pixels of the first picture as filmed; valid until the next run
 * @sigma: standard deviation of a measured disparity, px: 1.4826/√2 times the median
 *   difference of those from left to right and back. NaN when none was found
 * @n_mask: pixels of the mask; of the whole picture without one
 * @n_measured: of them with a measured disparity
 * @border: of each baseline
 */
typedef struct {
  ClothDisparityMap map;
  gdouble sigma;
  gsize n_mask, n_measured;
  ClothStereoBorder border[CLOTH_STEREO_MAX_CAMERAS - 1];
} ClothStereoResult;

typedef struct _ClothStereo ClothStereo;

ClothStereoParams cloth_stereo_default_params (void);
ClothStereo *cloth_stereo_new (const ClothCamera * const *cameras,
    guint n_cameras, const ClothStereoParams * params, GError ** error);
void cloth_stereo_free (ClothStereo * self);
ClothStereoGeometry cloth_stereo_get_geometry (const ClothStereo * self);
gboolean cloth_stereo_run (ClothStereo * self, const ClothImage * images,
    const ClothImage * mask, ClothPool * pool, ClothStereoResult * result,
    GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothStereo, cloth_stereo_free)
G_END_DECLS
