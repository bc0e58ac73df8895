/* Bright dots on dark cloth: where their centres are, and of what colour they are.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* The most dots that one picture may give.
 */
#define CLOTH_DOT_MAX 65536

/* The widest dots that can be asked for, px.
 */
#define CLOTH_DOT_MAX_DIAMETER 200

/* @x: column of the centre, px, centre of the top-left pixel at 0
 * @y: row of the centre, px
 * @cov: covariance xx, xy, yy of (@x, @y), px²: the picture's noise, taken for white, and
 *   what the method leaves
 * @shape: second moments xx, xy, yy of its area, px²: a quarter of the squared half-axes
 *   of an ellipse
 * @area: pixels, edge pixels by their share
 * @background: luma of the ground around it, grey levels
 * @colour: mean Y, Cb and Cr of its inside, grey levels; Cb and Cr are 128 in a grey
 *   picture
 * @touches: whether it was cut from another dot or spot that it runs into; @cov then says
 *   too little
 */
typedef struct {
  gfloat x, y;
  gfloat cov[3];
  gfloat shape[3];
  gfloat area;
  gfloat background;
  gfloat colour[3];
  gboolean touches;
} ClothDot;

/* @contrast: least luma of a dot above the ground around it, grey levels, 1 to 254; never
 *   less than a quarter of the ground's
 * @share: least luma above the ground as a share of the brightest around, 0 to 0.9
 * @min_area: lower threshold of the area, px, at least 4
 * @max_diameter: greatest extent of a dot each way, px, 4 to %CLOTH_DOT_MAX_DIAMETER
 * @roundness: least area over that of the ellipse with the same second moments, 0 to 1
 *
 * Values out of range are brought into it.
 */
typedef struct {
  gfloat contrast;
  gfloat share;
  gfloat min_area;
  gint max_diameter;
  gfloat roundness;
} ClothDotParams;

typedef struct _ClothDotDetector ClothDotDetector;

ClothDotParams cloth_dot_default_params (void);

ClothDotDetector *cloth_dot_detector_new (void);
void cloth_dot_detector_free (ClothDotDetector * detector);

void cloth_dot_detector_run (ClothDotDetector * detector,
    const ClothDotParams * params, const ClothPlanarImage * image,
    ClothSimd level);

const ClothDot *cloth_dot_detector_get_dots (const ClothDotDetector *
    detector, guint * n_dots);
gboolean cloth_dot_detector_was_cut (const ClothDotDetector * detector);
gfloat cloth_dot_detector_get_noise (const ClothDotDetector * detector);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothDotDetector, cloth_dot_detector_free)
G_END_DECLS
