/* Draws one tile of the picture: what is seen at 16 points of every pixel, then its light.
 *
 * The points are a lattice whose projections on both axes are evenly spaced, and which is
 * its own mirror image through the pixel's centre, so that edges are smoothed and not
 * moved. A point is seen through one triangle only: its depth is compared there, and the
 * paint is looked up there, filtered to the spacing of the points.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/render-private.h"

#include <math.h>
#include <string.h>

#define TILE CLOTH_RENDER_TILE
#define SAMPLES CLOTH_RENDER_SAMPLES

/* 16 at once, whatever the machine's width: every width gives the same bits. */
typedef gfloat F16 __attribute__((vector_size (64)));
typedef gint32 I16 __attribute__((vector_size (64)));
/* two lanes at once */
typedef gint64 __attribute__((may_alias)) Pair;

#define X(i) (((i) + 0.5f) / SAMPLES - 0.5f)
#define Y(i) (((5 * (i) + 2) % SAMPLES + 0.5f) / SAMPLES - 0.5f)
static const gfloat sample_x[SAMPLES] = { X (0), X (1), X (2), X (3), X (4),
  X (5), X (6), X (7), X (8), X (9), X (10), X (11), X (12), X (13), X (14),
  X (15)
};

static const gfloat sample_y[SAMPLES] = { Y (0), Y (1), Y (2), Y (3), Y (4),
  Y (5), Y (6), Y (7), Y (8), Y (9), Y (10), Y (11), Y (12), Y (13), Y (14),
  Y (15)
};

#undef X
#undef Y

/* 1/depth and triangle at every point of every pixel that a triangle has touched. */
typedef struct
{
  F16 depth[TILE * TILE];
  I16 seen[TILE * TILE];
  guint8 touched[TILE * TILE];
} Scratch;

gsize
cloth_render_tile_scratch (void)
{
  return (sizeof (Scratch) + 63) & ~(gsize) 63;
}

#define NAME(f) f ## _plain
#include "gst/render/render-tile.inc.c"
#undef NAME

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2,fma")
#define NAME(f) f ## _avx2
#include "gst/render/render-tile.inc.c"
#undef NAME
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target ("avx512f,avx512bw,avx512dq,avx512vl")
#define NAME(f) f ## _avx512
#include "gst/render/render-tile.inc.c"
#undef NAME
#pragma GCC pop_options
#endif

ClothRenderTileFunc
cloth_render_tile_func (ClothSimd simd)
{
#if defined (__x86_64__) && defined (__GNUC__)
  switch (cloth_simd_resolve (simd)) {
    case CLOTH_SIMD_AVX512:
      return draw_tile_avx512;
    case CLOTH_SIMD_AVX2:
      return draw_tile_avx2;
    default:
      break;
  }
#endif
  return draw_tile_plain;
}
