/* Saddle points of image intensity: the corners of a checkerboard.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/cpu.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/**
 * ClothSaddle:
 * @x: column of the saddle, px, centre of the top-left pixel at 0
 * @y: row of the saddle, px
 * @response: −Det of the Hessian of the smoothed intensity there, grey levels² / px⁴
 * @axis: angle in [0, π) of the axis along which the intensity has its *maximum curvature
 *   upwards*, i.e. the bisector that runs through the two bright quadrants, radians,
 *   from +x towards +y
 * @cov: covariance xx, xy, yy of (@x, @y), px²
 *
 * Since: 0.1
 */
typedef struct {
  gfloat x, y;
  gfloat response;
  gfloat axis;
  gfloat cov[3];
} ClothSaddle;

/* A pixel with Det(I * G) < -epsilon: where a corner may be put (paper 3.4). */
typedef struct {
  guint16 x, y;
  gfloat response;
} ClothSaddleCandidate;

G_END_DECLS
