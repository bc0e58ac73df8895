/* Between the shapes and the loops over their rows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/render/draw.h"

G_BEGIN_DECLS

/* Samples whose coverages are worked out and blended at once. */
#define CLOTH_DRAW_CHUNK 16

/* Components that share one sampling grid. */
typedef struct {
  gint first, n;
  gint width, height;           /* samples */
  gfloat scale_x, scale_y;      /* pixels a sample, a power of two */
  gfloat offset_x, offset_y;    /* pixel position of the first sample */
  gfloat softness;              /* pixels over which an edge fades */
} ClothDrawGroup;

/* A colour in such components. */
typedef struct {
  const ClothComponent *components;
  gint n;
  guint8 values[4];
  /* Samples side by side: bytes from one to the next, and 0 where the components lie
   * apart; then the first of them, which bytes are theirs, and the values over a chunk. */
  gint step;
  guint8 *data;
  gint stride;
  guint16 own[4], value[4 * CLOTH_DRAW_CHUNK];
} ClothDrawInk;

typedef struct {
  gfloat x0, y0, x1, y1;
  gfloat ux, uy, length;        /* direction */
  gfloat slope;                 /* columns a row */
  gfloat strip;                 /* half width along a row, per radius; 0: not across rows */
  gfloat radius;
  gfloat strength, most;        /* coverage a pixel inwards, and at most */
} ClothDrawLine;

typedef struct {
  gfloat nx[4], ny[4], d[4];    /* distance inwards to edge k: nx px + ny py + d */
  gfloat top, bottom;
  gfloat full;                  /* coverage at most */
} ClothDrawQuad;

/* Draws all rows of a shape; every instruction set gives the same bytes. */
typedef struct {
  void (*line) (const ClothDrawGroup * group, const ClothDrawInk * ink,
      const ClothDrawLine * line);
  void (*quad) (const ClothDrawGroup * group, const ClothDrawInk * ink,
      const ClothDrawQuad * quad);
} ClothDrawRows;

CLOTH_SIMD_TABLES (ClothDrawRows, cloth_draw_rows);

G_END_DECLS
