/* The inner loops of surface.c.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/render/draw.h"

G_BEGIN_DECLS

/* Fraction bits of places in the print, of light and of weights. */
#define CLOTH_SURFACE_PLACE_BITS 16
#define CLOTH_SURFACE_WEIGHT_BITS 16

/* One scale of the print: red, green, blue, 255, one byte each, red lowest. The last
 * column and row are there twice, so that each pixel has neighbours. */
typedef struct {
  gint width, height;           /* without the second ones */
  guint32 *pixels;              /* (height + 1) rows of width + 1 */
} ClothSurfaceLevel;

/* Pixels of one row that a triangle may cover: each quantity at the first and its step;
 * places of the print are within it at both ends, so between them too. */
typedef struct {
  gint n;
  gfloat w, w_step;             /* 1/depth, greatest nearest */
  gint32 u, u_step, v, v_step;  /* pixels of the level, PLACE_BITS */
  gint32 light, light_step;     /* 0 to 256, PLACE_BITS */
  const ClothSurfaceLevel *level;
} ClothSurfaceSpan;

typedef struct {
  void (*fill) (const ClothSurfaceSpan * span, guint32 * colours,
      gfloat * depths);
  /* One row of a component that is not subsampled. */
  void (*lay) (const guint32 * colours, gint n, const gint * weights,
      gint opacity, guint8 * to, gint step);
  /* One row of a component of half as many columns and rows. */
  void (*lay_half) (const guint32 * upper, const guint32 * lower, gint n,
      const gint * weights, gint opacity, guint8 * to, gint step);
} ClothSurfaceRows;

CLOTH_SIMD_TABLES (ClothSurfaceRows, cloth_surface_rows);

G_END_DECLS
