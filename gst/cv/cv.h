/* OpenCV's features, block matching and resampling as plain C functions. Pictures are grey,
 * with any stride; what OpenCV throws becomes a GError. OpenCV works in the calling thread
 * only: pictures are shared out by this project's own pool.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/error.h"

G_BEGIN_DECLS

/* Largest width and height of a picture, px. */
#define CLOTH_CV_MAX_SIZE 16384

/* @data: (not nullable): top-left pixel
 * @width: pixels a row, 1 to %CLOTH_CV_MAX_SIZE
 * @height: rows, 1 to %CLOTH_CV_MAX_SIZE
 * @stride: bytes from one row to the next, >= @width
 *
 * A view of an 8-bit grey picture; owns nothing.
 */
typedef struct {
  const guint8 *data;
  gint width, height, stride;
} ClothCvPicture;

/* ---- features ---- */

/* Bytes of a descriptor. */
#define CLOTH_CV_SIFT_BYTES 128

/* The most pixels of a picture whose features are looked for: each takes about 240 bytes
 * of scale space. */
#define CLOTH_CV_SIFT_MAX_AREA (4096 * 4096)

/* @n_layers: layers of an octave, 1 to 8; Lowe's 3
 * @contrast: least contrast of a feature, as a share of the full range over @n_layers:
 *   0.04 of OpenCV; Lowe's 0.03 is 0.09 here. 0 to 1
 * @edge: greatest ratio of a feature's principal curvatures, 1 to 1000; Lowe's 10
 * @sigma: blur of the first layer, px, 0.6 to 10; Lowe's 1.6
 */
typedef struct {
  gint n_layers;
  gdouble contrast, edge, sigma;
} ClothCvSiftParams;

/* @n: features
 * @x: (array length=n): columns, px, centre of the top-left pixel at 0
 * @y: (array length=n): rows, px
 * @scale: (array length=n): blur at which each was found, px
 * @angle: (array length=n): of its strongest gradient, radians in [0, 2π), from +x
 *   towards +y
 * @descriptors: (array): @n times %CLOTH_CV_SIFT_BYTES
 *
 * Features of one picture, by y, x, scale, angle. A place may have several angles.
 */
typedef struct {
  guint n;
  const gfloat *x, *y, *scale, *angle;
  const guint8 *descriptors;
} ClothCvFeatures;

typedef struct _ClothCvSift ClothCvSift;

ClothCvSiftParams cloth_cv_sift_default_params (void);
ClothCvSift *cloth_cv_sift_new (const ClothCvSiftParams * params,
    GError ** error);
void cloth_cv_sift_free (ClothCvSift * sift);
void cloth_cv_sift_keep (ClothCvSift * sift, guint most);
guint cloth_cv_sift_get_n_dropped (const ClothCvSift * sift);
gboolean cloth_cv_sift_run (ClothCvSift * sift,
    const ClothCvPicture * picture, const ClothCvPicture * mask,
    ClothCvFeatures * features, GError ** error);

/* ---- block matching ---- */

/* Steps of a disparity in one pixel, and the disparity of a pixel that has none. */
#define CLOTH_CV_STEPS 16
#define CLOTH_CV_NO_DISPARITY (-CLOTH_CV_STEPS)

/* @least: least disparity, px, 0 to 4096
 * @range: how many disparities are looked at from @least on, a multiple of 16, 16 to 1024
 * @window: edge of the blocks that are compared, px, odd, 1 to 31
 * @small_step: penalty of a step of 1 px between neighbours, 0 or more
 * @large_step: penalty of a greater step, above @small_step; at most 28000 − 16·@window²
 * @left_right: greatest difference of the disparities from left to right and back, px;
 *   negative: not checked
 * @uniqueness: by how many percent the best disparity must beat the second, 0 to 100
 * @speckle_area: pieces of fewer pixels are dropped, 0: none, to 100000
 * @speckle_step: greatest step of disparity inside a piece, px, 1 to 255
 */
typedef struct {
  gint least, range;
  gint window;
  gint small_step, large_step;
  gint left_right;
  gint uniqueness;
  gint speckle_area, speckle_step;
} ClothCvStereoParams;

typedef struct _ClothCvStereo ClothCvStereo;

ClothCvStereoParams cloth_cv_stereo_default_params (void);
ClothCvStereo *cloth_cv_stereo_new (const ClothCvStereoParams * params,
    GError ** error);
void cloth_cv_stereo_free (ClothCvStereo * stereo);
gboolean cloth_cv_stereo_run (ClothCvStereo * stereo,
    const ClothCvPicture * left, const ClothCvPicture * right,
    gint16 * disparities, GError ** error);

/* ---- resampling ---- */

gboolean cloth_cv_remap (const ClothCvPicture * from, const gfloat * x,
    const gfloat * y, gint width, gint height, guint8 * to, gint to_stride,
    GError ** error);
gboolean cloth_cv_squeeze (const ClothCvPicture * from, gint width,
    gint height, guint8 * to, gint to_stride, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCvSift, cloth_cv_sift_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCvStereo, cloth_cv_stereo_free)
/* ---- optical flow ---- */

/* @window: side of the window that is looked at about each point, px, 3 to 255
 * @levels: halvings of the picture beyond the first level, 0 to 10
 */
typedef struct {
  gint window, levels;
} ClothCvFlowParams;

gboolean cloth_cv_flow (const ClothCvPicture * from, const ClothCvPicture * to,
    const ClothCvFlowParams * params, guint n, const gfloat * points,
    gfloat * moved, guint8 * found, GError ** error);

G_END_DECLS
