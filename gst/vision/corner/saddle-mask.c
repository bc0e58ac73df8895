/* The hyperbolic pixels of a picture as a bit mask: the inner loop of the detector.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/saddle-mask.h"

#include <math.h>
#include <string.h>

#include "gst/vision/corner/saddle-mask-private.h"

/* Positive part of the second difference of the weights: what a picture of 0 and 1
 * can make of it at most. */
static gdouble
second_difference_bound (const gdouble * w, gint radius, gint h)
{
  gdouble sum = 0;

  for (gint i = -radius - h; i <= radius + h; i++) {
    gdouble a = ABS (i - h) <= radius ? w[ABS (i - h)] : 0;
    gdouble b = ABS (i) <= radius ? w[ABS (i)] : 0;
    gdouble c = ABS (i + h) <= radius ? w[ABS (i + h)] : 0;
    sum += MAX (0, a - 2 * b + c);
  }
  return sum;
}

static gdouble
mixed_difference_bound (const gdouble * w, gint radius, gint h)
{
  gdouble sum = 0;

  for (gint i = -radius - h; i <= radius + h; i++) {
    gdouble a = ABS (i - h) <= radius ? w[ABS (i - h)] : 0;
    gdouble c = ABS (i + h) <= radius ? w[ABS (i + h)] : 0;
    sum += fabs (c - a);
  }
  return 0.5 * sum * sum;
}

/* Rounds the weights to a whole sum; the middle weight takes the remainder. */
static gint
round_weights (const gdouble * w, gint total, gint * rounded)
{
  gint sum = 0, radius = 0;

  for (gint k = 1; k <= CLOTH_SADDLE_MAX_RADIUS; k++) {
    rounded[k] = (gint) floor (w[k] * total + 0.5);
    sum += 2 * rounded[k];
    if (rounded[k] > 0)
      radius = k;
  }
  rounded[0] = total - sum;
  return radius;
}

/* @kernel: (out caller-allocates): filled
 * @sigma: width of the Gaussian, px, 0.5 to 5
 */
void
cloth_saddle_kernel_init (ClothSaddleKernel * kernel, gfloat sigma)
{
  gdouble w[CLOTH_SADDLE_MAX_RADIUS + 1], sum = 0;
  gint rounded[CLOTH_SADDLE_MAX_RADIUS + 1];
  gint total = 256, radius, h;
  gdouble s;

  memset (kernel, 0, sizeof (*kernel));
  for (gint k = 0; k <= CLOTH_SADDLE_MAX_RADIUS; k++) {
    w[k] = exp (-0.5 * k * k / ((gdouble) sigma * sigma));
    sum += k > 0 ? 2 * w[k] : w[k];
  }
  for (gint k = 0; k <= CLOTH_SADDLE_MAX_RADIUS; k++)
    w[k] /= sum;

  radius = round_weights (w, total, rounded);
  if (rounded[0] + rounded[1] > 128) {
    total = 128;
    radius = round_weights (w, total, rounded);
  }
  /* The second difference of weights rounded to 8 bits is too coarse for a wide
   * filter; a longer step gains its square. */
  h = sigma < 2.0f ? 1 : sigma < 3.5f ? 2 : 3;

  kernel->radius = radius;
  kernel->step = h;
  for (gint k = 0; k <= radius; k++) {
    kernel->across[radius - k] = (gint8) rounded[k];
    kernel->across[radius + k] = (gint8) rounded[k];
    w[k] = (gdouble) rounded[k] / total;
  }
  s = 32600.0 / (255.0 * 4.0 * second_difference_bound (w, radius, h));
  s = MIN (s, 32600.0 / (255.0 * mixed_difference_bound (w, radius, h)));
  for (gint k = 0; k <= radius; k++) {
    gdouble t = floor (w[k] * s * 65536.0 / total * (k > 0 ? 2 : 1) + 0.5);
    kernel->down[k] = (guint16) MIN (t, 65535.0);
  }
  kernel->scale = (gfloat) (65536.0 / (16.0 * s * s * h * h * h * h));
}

static void
mask_resize (ClothSaddleMask * mask)
{
  /* Rows come in twos; two blocks more are written before it is known whether they are
   * kept. */
  gsize need = (gsize) mask->words * (gsize) (mask->height + 1);

  if (need > mask->bits_allocated) {
    g_free (mask->bits);
    g_free (mask->blocks);
    g_aligned_free (mask->det);
    mask->bits = g_new (guint64, need);
    mask->blocks = g_new (guint32, (need + 1) / 2);
    mask->det = g_aligned_alloc (need + 2, 128, 64);
    mask->bits_allocated = need;
  }
}

static guint8 *
mask_scratch (ClothSaddleMask * mask, gsize need)
{
  need += 64;
  if (need > mask->scratch_allocated) {
    g_free (mask->scratch);
    mask->scratch = g_malloc (need);
    mask->scratch_allocated = need;
  }
  return (guint8 *) (((gsize) mask->scratch + 63) & ~(gsize) 63);
}

void
cloth_saddle_mask_clear (ClothSaddleMask * mask)
{
  g_free (mask->bits);
  g_free (mask->blocks);
  g_aligned_free (mask->det);
  g_free (mask->scratch);
  memset (mask, 0, sizeof (*mask));
}

/* Pixels [x, x + n) of row y, the picture's border repeated outwards. */
static void
copy_row (guint8 * out, const ClothImage * image, gint x, gint y, gint n)
{
  const guint8 *row =
      image->data + (gsize) CLAMP (y, 0, image->height - 1) *
      (gsize) image->stride;
  gint left = CLAMP (-x, 0, n);
  gint right = CLAMP (x + n - image->width, 0, n - left);

  memset (out, row[0], (gsize) left);
  memcpy (out + left, row + x + left, (gsize) (n - left - right));
  memset (out + n - right, row[image->width - 1], (gsize) right);
}

/* Rows of the reference, in loops that any compiler makes vectors of. */
static void
across (guint16 * restrict out, gint n, const guint8 * restrict line,
    const ClothSaddleKernel * kernel)
{
  memset (out, 0, (gsize) n * sizeof (guint16));
  for (gint k = 0; k <= 2 * kernel->radius; k++) {
    guint16 weight = (guint16) kernel->across[k];
    for (gint x = 0; x < n; x++)
      out[x] = (guint16) (out[x] + weight * line[x + k]);
  }
}

static void
down (guint16 * restrict out, gint n, const guint16 * ring, gint row,
    const ClothSaddleKernel * kernel)
{
  const gint r = kernel->radius, n_ring = 2 * r + 1;

  for (gint k = 0; k <= r; k++) {
    const guint16 *a = ring + (gsize) ((row + r - k) % n_ring) * (gsize) n;
    const guint16 *b = ring + (gsize) ((row + r + k) % n_ring) * (gsize) n;
    guint32 weight = kernel->down[k];

    for (gint x = 0; x < n; x++) {
      guint32 pair = ((guint32) a[x] + b[x] + 1) >> 1;
      guint32 part = (pair * weight) >> 16;
      out[x] = (guint16) (k > 0 ? out[x] + part : part);
    }
  }
}

static void
determinants (gint16 * restrict det, gint n, const guint16 * a,
    const guint16 * b, const guint16 * c, gint h)
{
  for (gint x = 0; x < n; x++) {
    gint16 fxx = (gint16) (4 * (b[x - h] + b[x + h] - 2 * b[x]));
    gint16 fyy = (gint16) (4 * (a[x] + c[x] - 2 * b[x]));
    gint16 fxy = (gint16) (c[x + h] - a[x + h] - c[x - h] + a[x - h]);
    det[x] = (gint16) (((fxx * fyy) >> 16) - ((fxy * fxy) >> 16));
  }
}

/* The reference: every vector level gives these very bits. */
static void
mask_run_scalar (ClothSaddleMask * mask, const ClothSaddleKernel * kernel,
    const ClothImage * image, gint threshold)
{
  const gint r = kernel->radius, h = kernel->step;
  const gint n = mask->words * 64 + 2 * h;
  const gint n_ring = 2 * r + 1, n_smooth = 2 * h + 1;
  guint8 *bytes = mask_scratch (mask,
      (gsize) (n_ring + n_smooth + 1) * (gsize) n * 2 + (gsize) (n + 2 * r));
  guint16 *ring = (guint16 *) bytes;
  guint16 *smooth = ring + (gsize) n_ring * (gsize) n;
  gint16 *det = (gint16 *) (smooth + (gsize) n_smooth * (gsize) n);
  guint8 *line = (guint8 *) (det + n);

  for (gint i = 0; i < mask->height + 2 * (h + r); i++) {
    gint row = i - 2 * r, centre = row - 2 * h;

    copy_row (line, image, mask->x - h - r, mask->y - h - r + i, n + 2 * r);
    across (ring + (gsize) (i % n_ring) * (gsize) n, n, line, kernel);
    if (row < 0)
      continue;
    down (smooth + (gsize) (row % n_smooth) * (gsize) n, n, ring, row, kernel);
    if (centre < 0)
      continue;

    {
      guint64 *bits = mask->bits + (gsize) centre * (gsize) mask->words;
      guint32 *block =
          mask->blocks + (gsize) (centre / 2) * (gsize) mask->words;

      determinants (det, 64 * mask->words,
          smooth + (gsize) (centre % n_smooth) * (gsize) n + h,
          smooth + (gsize) ((centre + h) % n_smooth) * (gsize) n + h,
          smooth + (gsize) (row % n_smooth) * (gsize) n + h, h);
      for (gint w = 0; w < mask->words; w++) {
        guint64 word = 0;
        gint16 *out;

        if (centre % 2 == 0) {
          block[w] = mask->n_blocks;
          mask->n_blocks += 2;
        }
        out = mask->det + 64 * ((gsize) block[w] + (gsize) (centre % 2));
        for (gint k = 0; k < 64; k++) {
          gint16 d = det[64 * w + k];

          word |= (guint64) (d < -threshold) << k;
          out[32 * (k % 2) + k / 2] = d;
        }
        bits[w] = word;
      }
    }
  }
}

static void
mask_run_tiles (ClothSaddleMask * mask, const ClothSaddleKernel * kernel,
    const ClothImage * image, gint threshold, const ClothSaddleTile * tile)
{
  const gsize rows = (gsize) (2 * kernel->radius + 2 * kernel->step + 4);
  /* All rows of a tile stay in the first-level cache. */
  const gint widest = MAX (3, (gint) (30720 / (rows * 4 * 32)) - 1);
  const gint n_tiles = (mask->words + widest - 1) / widest;
  const gint wide = (mask->words + n_tiles - 1) / n_tiles;
  guint8 *scratch = mask_scratch (mask,
      2 * (rows * CLOTH_SADDLE_TILE_ROW (wide) + 32) +
      4 * CLOTH_SADDLE_TILE_LINE (wide));

  for (gint i = 0; i < n_tiles; i++) {
    gint from = (gint) ((gint64) mask->words * i / n_tiles);
    gint to = (gint) ((gint64) mask->words * (i + 1) / n_tiles);

    tile->run (mask, kernel, image, threshold, from, to - from, scratch);
  }
}

/* Nothing is told where a difference would reach over the picture's border: there the
 * repeated border itself makes corners of edges. */
static void
mask_cut_border (ClothSaddleMask * mask, const ClothImage * image, gint h)
{
  gint x0 = CLAMP (h - mask->x, 0, mask->width);
  gint x1 = CLAMP (image->width - h - mask->x, x0, mask->width);

  for (gint y = 0; y < mask->height; y++) {
    guint64 *bits = mask->bits + (gsize) y * (gsize) mask->words;

    if (mask->y + y < h || mask->y + y >= image->height - h) {
      memset (bits, 0, (gsize) mask->words * sizeof (guint64));
      continue;
    }
    for (gint w = 0; w * 64 < x0; w++)
      bits[w] &= x0 >= 64 * (w + 1) ? 0 : ~G_GUINT64_CONSTANT (0) << (x0 % 64);
    for (gint w = x1 / 64; w < mask->words; w++)
      bits[w] &= x1 <= 64 * w ? 0 : ~(~G_GUINT64_CONSTANT (0) << (x1 - 64 * w));
  }
}

/* @mask: its region set; the rest is filled
 * @kernel: the smoothing filter
 * @image: the picture
 * @threshold: a bit is set where the 16-bit determinant is below −@threshold
 * @level: the instruction set
 */
void
cloth_saddle_mask_run (ClothSaddleMask * mask,
    const ClothSaddleKernel * kernel, const ClothImage * image,
    gint threshold, ClothSimd level)
{
  const ClothSaddleTile *tile = CLOTH_SIMD_TABLE (cloth_saddle_tile, level);

  mask->words = (mask->width + 63) / 64;
  mask->n_blocks = 0;
  mask_resize (mask);
  if (tile->run)
    mask_run_tiles (mask, kernel, image, threshold, tile);
  else
    mask_run_scalar (mask, kernel, image, threshold);
  mask_cut_border (mask, image, kernel->step);
}
