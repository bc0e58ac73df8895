/* The derivatives of the smoothed picture at one place.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

#define CLOTH_SADDLE_TAPS 16

/* Sixteen lanes at every level, so that sums come out the same in all. */
typedef gfloat ClothSaddleTaps __attribute__((vector_size (64)));

/* @derivatives: Fx, Fy, Fxx, Fxy, Fyy of a window of 15 rows; @gx, @gy: the Gaussian and
 *   its first two derivatives along x and y */
typedef struct {
  void (*derivatives) (const guint8 * data, gsize stride,
      const ClothSaddleTaps * gx, const ClothSaddleTaps * gy, gfloat out[5]);
} ClothSaddleDerivatives;

CLOTH_SIMD_TABLES (ClothSaddleDerivatives, cloth_saddle_derivatives);

G_END_DECLS
