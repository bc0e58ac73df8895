/* What alignment shares with its inner loops.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

/* Columns of a window at most, as vectors take them. */
#define CLOTH_ALIGN_PITCH 64

/* Sums over rows of products, with row t and weight w, light p, film f, difference e, slopes
 * g and h: g²·tᵏ, gh·tᵏ and h²·tᵏ for k to 4; of both g and h, e·tᵏ, p·tᵏ and tᵏ for k to 2;
 * w, wp, wp², we, wpe, we². */
#define CLOTH_ALIGN_SUMS 39

/* @columns: of a row, a multiple of 16, at most %CLOTH_ALIGN_PITCH
 * @rows: of the window
 * @weights: of each pixel, row by row, @columns each; 0: not looked at
 * @film: of the film
 * @print: of the print as it should look there
 * @across: its slope by the flat picture's column
 * @down: by its row
 */
typedef struct {
  guint columns, rows;
  const gfloat *weights, *film, *print, *across, *down;
} ClothAlignWindow;

/* @sample: adds @weight times a spline at (x, y) to @value, and @slope times its slopes; (x, y)
 *   at least 2 from its rim; @n a multiple of 4, at most %CLOTH_ALIGN_PITCH
 * @sum_light: per column w, wp, wf, wp², wpf, wf²
 * @weigh: film − gain·print − offset = e, which scales the weights by 1 / (1 + e²·@outlier)
 * @add: the sums above per column, of weighted pixels
 */
typedef struct {
  void (*sample) (const gfloat * plane, gint stride, guint n, const gfloat * x,
      const gfloat * y, gfloat weight, gfloat slope, gfloat * value,
      gfloat * across, gfloat * down);
  void (*sum_light) (const ClothAlignWindow * window,
      gfloat sums[6][CLOTH_ALIGN_PITCH]);
  void (*weigh) (const ClothAlignWindow * window, gfloat gain, gfloat offset,
      gfloat outlier, gfloat * differences, gfloat * weights);
  void (*add) (const ClothAlignWindow * window, const gfloat * differences,
      const gfloat * t, gfloat sums[CLOTH_ALIGN_SUMS][CLOTH_ALIGN_PITCH]);
} ClothAlignKernel;

CLOTH_SIMD_TABLES (ClothAlignKernel, cloth_align_kernel);

G_END_DECLS
