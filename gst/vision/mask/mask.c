/* The silhouette of what moves before a background that doesn't.
 *
 * A window of the film f is the background g in another light when f = a·g + noise, with a
 * gain a between shadow and glow. Of n pixels with noise of variance v, Σ(f − a·g)² / v is
 * χ²-distributed: mean n, standard deviation √(2n). What exceeds that by far is something
 * else. Mean chroma over the window must be a times the background's too. The noise is that
 * of the film around, measured by differences of neighbouring pixels; where the cloth is,
 * the background's own differences bound it, and the noise of where it isn't: of the
 * quietest quarter of the picture. What the background's picture has lost or shifts by its
 * coding is measured, see bound_noise () and measure_chroma ().
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/mask/mask.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"
#include "gst/vision/mask/bits.h"
#include "gst/vision/mask/mask-private.h"

/* Edge of the blocks in which noise is measured, px; every second row is looked at. */
#define BLOCK 32
#define ROW_STEP 2
/* Pixels beside a row that windows may reach. */
#define PAD CLOTH_MASK_MAX_RADIUS
/* Median of |d| of two pixels with noise of standard deviation 1 each: 0.6745·√2. */
#define MEDIAN 0.9539f
/* Whole numbers of both pictures are off by √(1/12) each. */
#define LEAST_NOISE 0.41f
/* Greatest noise, as a multiple of that which a quarter of the blocks are below. */
#define MOST_NOISE 3
/* A quarter of |d|², of two components with noise of standard deviation 1 each, is below this:
 * −2·ln(¾). */
#define QUARTER 0.5754f
/* Steps of a grey level in which it is counted, and the most of it: of steps of 510. */
#define STEPS 8
#define MOST_STEPS (STEPS * 540)

typedef struct
{
  gint32 *memory;
  gint32 *sums[3], *chroma[4];  /* PAD columns before the row */
  gfloat *gains, *limits;       /* of luma; then, thinned out, of chroma */
  gfloat *variances;
  guint8 *hits, *chroma_hits;
} Scratch;

struct _ClothMask
{
  /* What a background is like; its planes lie behind each other without gaps. */
  gint width, height;           /* 0: none */
  gint chroma_width, chroma_height;     /* 0: grey */
  gint shift[2];
  gsize size;
  guint8 *ground;
  gboolean known;
  guint8 *samples[CLOTH_MASK_SAMPLES];
  guint n_samples, next_sample;
  gfloat *ground_noise, *ground_power;  /* of each block */

  /* Of the picture at hand. */
  const ClothPlanarImage *image;
  ClothMaskParams params;
  const ClothMaskKernels *kernels;
  gboolean in_colour;           /* the film and the background */
  gint columns, rows;           /* of blocks */
  gfloat *noise, *power, most_noise;
  gfloat *chroma_off[2];        /* of each block; NaN where luma sees no background */
  gdouble *sorted;
  gsize n_blocks;
  gfloat chroma_bias[2], chroma_variance;
  gint n_words;
  gsize n_bits;                 /* words that there is room for */
  guint64 *bits, *spare;
  Scratch *scratch;
  guint n_scratch;
  gint scratch_width;
  GArray *runs, *gaps, *pieces;
  gboolean cut;
};

/* Returns: windows of 3 × 3 px, light of 0.4 to 1.15 times the background's, 14 standard
 *   deviations, 5 px thin, pieces and holes of 400 px, any luma and chroma
 */
ClothMaskParams
cloth_mask_default_params (void)
{
  return (ClothMaskParams) {
    1, 0.4, 1.15, 14, 2, 400, 400, {
    0, 0, 0}
    , {
    255, 255, 255}
  , NULL, 0, G_MAXFLOAT};
}

/* Returns: (transfer full): a mask without a background; its memory is used again for each
 *   picture
 */
ClothMask *
cloth_mask_new (void)
{
  ClothMask *mask = g_new0 (ClothMask, 1);

  mask->runs = g_array_new (FALSE, FALSE, sizeof (ClothRun));
  mask->gaps = g_array_new (FALSE, FALSE, sizeof (ClothRun));
  mask->pieces = cloth_runs_new_pieces ();
  return mask;
}

static void
free_scratch (ClothMask * mask)
{
  for (guint i = 0; i < mask->n_scratch; i++) {
    g_free (mask->scratch[i].memory);
    g_free (mask->scratch[i].hits);
  }
  g_clear_pointer (&mask->scratch, g_free);
  mask->n_scratch = 0;
}

/* @mask: (nullable) (transfer full): a mask
 */
void
cloth_mask_free (ClothMask * mask)
{
  if (!mask)
    return;
  cloth_mask_forget (mask);
  free_scratch (mask);
  g_free (mask->noise);
  g_free (mask->power);
  g_free (mask->chroma_off[0]);
  g_free (mask->chroma_off[1]);
  g_free (mask->sorted);
  g_free (mask->bits);
  g_free (mask->spare);
  g_array_unref (mask->runs);
  g_array_unref (mask->gaps);
  g_array_unref (mask->pieces);
  g_free (mask);
}

/* ---- the background ---- */

/* @mask: a mask
 *
 * From now on it has no background and no samples of one.
 */
void
cloth_mask_forget (ClothMask * mask)
{
  for (guint i = 0; i < CLOTH_MASK_SAMPLES; i++)
    g_clear_pointer (&mask->samples[i], g_free);
  g_clear_pointer (&mask->ground, g_free);
  g_clear_pointer (&mask->ground_noise, g_free);
  g_clear_pointer (&mask->ground_power, g_free);
  mask->width = mask->height = 0;
  mask->n_samples = mask->next_sample = 0;
  mask->known = FALSE;
}

static gint
halved (gint size, gint shift)
{
  return (size + (1 << shift) - 1) >> shift;
}

static gboolean
is_alike (const ClothMask * mask, const ClothPlanarImage * image)
{
  return mask->width == image->luma.width && mask->height == image->luma.height
      && (mask->chroma_width > 0) == (image->chroma[0] != NULL)
      && (!image->chroma[0] || (mask->shift[0] == image->chroma_shift[0]
          && mask->shift[1] == image->chroma_shift[1]));
}

/* Makes room for backgrounds like @image, and forgets others. */
static void
prepare_ground (ClothMask * mask, const ClothPlanarImage * image)
{
  const gint width = image->luma.width, height = image->luma.height;
  gsize n_blocks;

  if (is_alike (mask, image))
    return;
  cloth_mask_forget (mask);
  mask->width = width;
  mask->height = height;
  mask->shift[0] = image->chroma_shift[0];
  mask->shift[1] = image->chroma_shift[1];
  mask->chroma_width = image->chroma[0] ? halved (width, mask->shift[0]) : 0;
  mask->chroma_height = image->chroma[0] ? halved (height, mask->shift[1]) : 0;
  mask->size = (gsize) width *(gsize) height +
      2 * (gsize) mask->chroma_width * (gsize) mask->chroma_height;
  mask->ground = g_malloc (mask->size);
  n_blocks = (gsize) halved (width, 5) * (gsize) halved (height, 5);
  mask->ground_noise = g_new (gfloat, n_blocks);
  mask->ground_power = g_new (gfloat, n_blocks);
}

/* Top-left sample of the background's Cb or Cr. */
static const guint8 *
ground_chroma (const ClothMask * mask, gint plane)
{
  return mask->ground + (gsize) mask->width * (gsize) mask->height +
      (gsize) plane *(gsize) mask->chroma_width * (gsize) mask->chroma_height;
}

/* Writes the planes of @image behind each other. */
static void
copy_planes (const ClothMask * mask, const ClothPlanarImage * image,
    guint8 * to)
{
  for (gint y = 0; y < mask->height; y++, to += mask->width)
    memcpy (to, image->luma.data + (gsize) y * (gsize) image->luma.stride,
        (gsize) mask->width);
  for (gint c = 0; c < 2; c++)
    for (gint y = 0; y < mask->chroma_height; y++, to += mask->chroma_width) {
      const guint8 *row =
          image->chroma[c] + (gsize) y * (gsize) image->chroma_stride;

      for (gint x = 0; x < mask->chroma_width; x++)
        to[x] = row[x * image->chroma_step];
    }
}

/* The median of whole numbers, of which @counts has how many there are of each; a number k
 * stands for all from k − ½ to k + ½, and 0 for those up to ½. */
static gfloat
median_of (const guint32 * counts, guint32 n)
{
  const gfloat half = 0.5f * (gfloat) n;
  guint32 below = 0, k = 0;

  if (n == 0)
    return 0;
  while ((gfloat) (below + counts[k]) < half)
    below += counts[k++];
  return k == 0 ? 0.5f * half / (gfloat) counts[0]
      : (gfloat) k - 0.5f + (half - (gfloat) below) / (gfloat) counts[k];
}

/* Median of |Δ(film − ground)| over neighbours in the rows of a block; of the ground alone
 * when @film is %NULL. @power: (out): sum of the film's squared differences, or the ground's */
static gfloat
median_step (const ClothMask * mask, const ClothImage * film, gint column,
    gint row, gfloat * power)
{
  const gint x0 = column * BLOCK, x1 = MIN (x0 + BLOCK, mask->width);
  const gint y0 = row * BLOCK, y1 = MIN (y0 + BLOCK, mask->height);
  guint32 counts[2 * 255 + 1] = { 0 }, n = 0, squares = 0;

  for (gint y = y0; y < y1; y += ROW_STEP) {
    const guint8 *g = mask->ground + (gsize) y * (gsize) mask->width;
    const guint8 *f = film ? film->data + (gsize) y * (gsize) film->stride : g;
    const gint own = film ? 1 : 0;

    for (gint x = x0; x + 1 < x1; x++, n++) {
      const gint step = f[x + 1] - f[x];

      counts[ABS (own * step - (g[x + 1] - g[x]))]++;
      squares += (guint32) (step * step);
    }
  }
  *power = (gfloat) squares;
  return median_of (counts, n);
}

static void
measure_ground (ClothMask * mask)
{
  const gint columns = halved (mask->width, 5), rows = halved (mask->height, 5);

  for (gint j = 0; j < rows; j++)
    for (gint i = 0; i < columns; i++)
      mask->ground_noise[j * columns + i] =
          (gfloat) G_SQRT2 *median_step (mask, NULL, i, j,
      &mask->ground_power[j * columns + i]) / MEDIAN;
  mask->known = TRUE;
}

/* @mask: a mask
 * @image: the scene without the cloth, by the camera that films; it is copied
 */
void
cloth_mask_set_background (ClothMask * mask, const ClothPlanarImage * image)
{
  prepare_ground (mask, image);
  copy_planes (mask, image, mask->ground);
  measure_ground (mask);
}

/* @mask: a mask
 * @image: a picture of the film
 * @level: vector instructions that may be used at most
 *
 * The background becomes the median of the last %CLOTH_MASK_SAMPLES pictures that this was
 * given: at each pixel the cloth must be elsewhere in more than half of them.
 */
void
cloth_mask_learn (ClothMask * mask, const ClothPlanarImage * image,
    ClothSimd level)
{
  prepare_ground (mask, image);
  if (!mask->samples[mask->next_sample])
    mask->samples[mask->next_sample] = g_malloc (mask->size);
  copy_planes (mask, image, mask->samples[mask->next_sample]);
  mask->next_sample = (mask->next_sample + 1) % CLOTH_MASK_SAMPLES;
  mask->n_samples = MIN (mask->n_samples + 1, CLOTH_MASK_SAMPLES);
  CLOTH_SIMD_TABLE (cloth_mask_kernels, level)->median (mask->samples,
      mask->n_samples, mask->size, mask->ground);
  measure_ground (mask);
}

/* @mask: a mask
 * @image: a picture
 *
 * Returns: whether a background of the size and the format of @image is known
 */
gboolean
cloth_mask_has_background (const ClothMask * mask,
    const ClothPlanarImage * image)
{
  return mask->known && mask->width == image->luma.width
      && mask->height == image->luma.height;
}

/* ---- one picture ---- */

/* NaN becomes @least. */
static gdouble
within (gdouble value, gdouble least, gdouble most)
{
  return value >= least ? MIN (value, most) : least;
}

static void
prepare_scratch (ClothMask * mask, gint width, guint n)
{
  const gsize columns = (gsize) width + 2 * PAD;

  if (width <= mask->scratch_width && n <= mask->n_scratch)
    return;
  n = MAX (n, mask->n_scratch);
  width = MAX (width, mask->scratch_width);
  free_scratch (mask);
  mask->scratch = g_new0 (Scratch, n);
  mask->n_scratch = n;
  mask->scratch_width = width;
  for (guint i = 0; i < n; i++) {
    Scratch *s = &mask->scratch[i];
    gint32 *next = s->memory = g_malloc_n (10 * columns, 4);

    for (guint k = 0; k < 3; k++, next += columns)
      s->sums[k] = next;
    for (guint k = 0; k < 4; k++, next += columns)
      s->chroma[k] = next;
    s->gains = (gfloat *) next;
    s->limits = s->gains + columns;
    s->variances = s->limits + columns;
    s->hits = g_malloc0 (2 * (columns + 8));
    s->chroma_hits = s->hits + columns + 8;
  }
}

static void
prepare (ClothMask * mask, const ClothMaskParams * p,
    const ClothPlanarImage * image, ClothPool * pool, ClothSimd level)
{
  const gint width = image->luma.width, height = image->luma.height;
  gsize n_blocks, n_bits;

  mask->image = image;
  mask->params = *p;
  mask->params.radius = CLAMP (p->radius, 1, CLOTH_MASK_MAX_RADIUS);
  mask->params.shadow = within (p->shadow, 0, 1);
  mask->params.glow = within (p->glow, 1, 10);
  mask->params.significance = within (p->significance, 0, 1000);
  mask->params.thin = CLAMP (p->thin, 0, 32);
  mask->kernels = CLOTH_SIMD_TABLE (cloth_mask_kernels, level);
  mask->in_colour = cloth_mask_has_background (mask, image)
      && is_alike (mask, image) && image->chroma[0];
  mask->columns = halved (width, 5);
  mask->rows = halved (height, 5);
  mask->n_words = (width + 63) / 64;
  n_blocks = (gsize) mask->columns * (gsize) mask->rows;
  n_bits = (gsize) mask->n_words * (gsize) height;
  if (n_blocks > mask->n_blocks) {
    mask->noise = g_renew (gfloat, mask->noise, n_blocks);
    mask->power = g_renew (gfloat, mask->power, n_blocks);
    for (guint c = 0; c < 2; c++)
      mask->chroma_off[c] = g_renew (gfloat, mask->chroma_off[c], n_blocks);
    mask->sorted = g_renew (gdouble, mask->sorted, n_blocks);
    mask->n_blocks = n_blocks;
  }
  if (n_bits > mask->n_bits) {
    mask->bits = g_renew (guint64, mask->bits, n_bits);
    mask->spare = g_renew (guint64, mask->spare, n_bits);
    mask->n_bits = n_bits;
  }
  prepare_scratch (mask, width, cloth_pool_get_n_threads (pool));
}

static void
measure_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothMask *mask = data;

  for (gint j = (gint) begin; j < (gint) end; j++)
    for (gint i = 0; i < mask->columns; i++) {
      const gsize at = (gsize) j * (gsize) mask->columns + (gsize) i;

      mask->noise[at] = median_step (mask, &mask->image->luma, i, j,
          &mask->power[at]) / MEDIAN;
    }
}

/* Bounds the noise by that of the quietest quarter of the blocks, and by the background's own.
 * A background that was coded, or is a median, has lost noise and fine texture and bounds
 * nothing: the share that it lacks of the film's own differences, in what is quiet enough for
 * background, tells. */
static void
bound_noise (ClothMask * mask)
{
  const guint n = (guint) (mask->columns * mask->rows);
  guint counts[MOST_STEPS] = { 0 }, below = 0, k = 0, n_quiet = 0;
  gfloat lost;

  for (guint i = 0; i < n; i++)
    counts[(gint) (STEPS * MIN (mask->noise[i], mask->ground_noise[i]))]++;
  while (4 * (below += counts[k++]) < n);
  mask->most_noise = MOST_NOISE * MAX ((gfloat) k / STEPS, LEAST_NOISE);
  for (guint i = 0; i < n; i++)
    if (mask->noise[i] <= mask->most_noise && mask->power[i] > 0)
      mask->sorted[n_quiet++] = (gdouble) (mask->ground_power[i]
          / mask->power[i]);
  lost = n_quiet == 0 ? 0 : (gfloat) fmax (0, 1 -
      cloth_median (mask->sorted, n_quiet));
  for (guint i = 0; i < n; i++)
    mask->noise[i] = MIN (mask->noise[i], MAX (mask->ground_noise[i],
            lost * mask->most_noise));
}

/* Variance in each column of a row of blocks: the most of the blocks around. */
static void
spread_noise (const ClothMask * mask, gint row, gfloat * variances)
{
  for (gint i = 0; i < mask->columns; i++) {
    gfloat most = LEAST_NOISE;

    for (gint v = MAX (row - 1, 0); v <= MIN (row + 1, mask->rows - 1); v++)
      for (gint u = MAX (i - 1, 0); u <= MIN (i + 1, mask->columns - 1); u++)
        most = MAX (most, mask->noise[v * mask->columns + u]);
    most = MIN (most, mask->most_noise);
    for (gint x = i * BLOCK; x < MIN ((i + 1) * BLOCK, mask->width); x++)
      variances[x] = most * most;
  }
}

/* Greatest Σ(f − a·g)² of a window of background whose noise has variance 1. */
static gfloat
most_residual (const ClothMaskParams * p)
{
  const gint edge = 2 * p->radius + 1, n = edge * edge;

  return (gfloat) (n + p->significance * sqrt (2. * n));
}

/* Sets @gain to that of the window about a pixel. Returns: whether luma takes it for
 * background */
static gboolean
is_background (const ClothMask * mask, gint x, gint y, gfloat variance,
    gfloat * gain)
{
  const ClothMaskParams *p = &mask->params;
  const ClothImage *film = &mask->image->luma;
  gint32 ff = 0, fg = 0, gg = 0;
  gfloat residual;

  for (gint v = y - p->radius; v <= y + p->radius; v++)
    for (gint u = x - p->radius; u <= x + p->radius; u++) {
      const gint row = CLAMP (v, 0, mask->height - 1);
      const gint column = CLAMP (u, 0, mask->width - 1);
      const gint32 f = film->data[(gsize) row * (gsize) film->stride +
          (gsize) column];
      const gint32 g = mask->ground[(gsize) row * (gsize) mask->width +
          (gsize) column];

      ff += f * f;
      fg += f * g;
      gg += g * g;
    }
  *gain = CLAMP ((gfloat) fg / (gfloat) MAX (gg, 1), (gfloat) p->shadow,
      (gfloat) p->glow);
  residual = (gfloat) ff - *gain * (2 * (gfloat) fg - *gain * (gfloat) gg);
  return residual <= most_residual (p) * variance;
}

/* Mean of film − gain · ground over the window about a sample of Cb or Cr. */
static gfloat
chroma_difference (const ClothMask * mask, gint plane, gint x, gint y,
    gfloat gain)
{
  const ClothPlanarImage *film = mask->image;
  const gint radius = mask->params.radius, edge = 2 * radius + 1;
  const guint8 *ground = ground_chroma (mask, plane);
  gint32 f = -128 * edge * edge, g = f;

  for (gint v = y - radius; v <= y + radius; v++)
    for (gint u = x - radius; u <= x + radius; u++) {
      const gint row = CLAMP (v, 0, mask->chroma_height - 1);
      const gint column = CLAMP (u, 0, mask->chroma_width - 1);

      f += film->chroma[plane][(gsize) row * (gsize) film->chroma_stride +
          (gsize) (column * film->chroma_step)];
      g += ground[(gsize) row * (gsize) mask->chroma_width + (gsize) column];
    }
  return ((gfloat) f - gain * (gfloat) g) / (gfloat) (edge * edge);
}

/* One window of each block, at another place in each, so that they don't lie alike in the
 * blocks of a picture's coding. */
static void
sample_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothMask *mask = data;
  gfloat *variances = mask->scratch[worker].variances;

  for (gint j = (gint) begin; j < (gint) end; j++) {
    spread_noise (mask, j, variances);
    for (gint i = 0; i < mask->columns; i++) {
      const gsize at = (gsize) j * (gsize) mask->columns + (gsize) i;
      const gint x = MIN (i * BLOCK + (11 * i + 7 * j) % BLOCK,
          mask->width - 1);
      const gint y = MIN (j * BLOCK + (5 * i + 13 * j) % BLOCK,
          mask->height - 1);
      gfloat gain;

      mask->chroma_off[0][at] = mask->chroma_off[1][at] = NAN;
      if (!is_background (mask, x, y, variances[x], &gain))
        continue;
      for (gint c = 0; c < 2; c++)
        mask->chroma_off[c][at] = chroma_difference (mask, c,
            x >> mask->shift[0], y >> mask->shift[1], gain);
    }
  }
}

/* How far the background's chroma is off, and by what variance in each component: coding and
 * conversion shift the colours of whole walls by a level or two. At least a quarter of what
 * luma takes for background is: a shift that not three quarters agree on in its sign is none,
 * and of two quartiles the lesser counts. */
static void
measure_chroma (ClothMask * mask, ClothPool * pool)
{
  const guint n_blocks = (guint) (mask->columns * mask->rows);
  guint n = 0;

  mask->chroma_bias[0] = mask->chroma_bias[1] = mask->chroma_variance = 0;
  cloth_pool_run (pool, sample_rows, mask, (guint) mask->rows);
  for (gint c = 0; c < 2; c++) {
    n = 0;
    for (guint i = 0; i < n_blocks; i++)
      if (!isnan (mask->chroma_off[c][i]))
        mask->sorted[n++] = (gdouble) mask->chroma_off[c][i];
    if (n == 0)
      return;
    qsort (mask->sorted, n, sizeof (gdouble), cloth_compare_doubles);
    if (mask->sorted[n / 4] > 0)
      mask->chroma_bias[c] = (gfloat) mask->sorted[n / 4];
    else if (mask->sorted[n - 1 - n / 4] < 0)
      mask->chroma_bias[c] = (gfloat) mask->sorted[n - 1 - n / 4];
  }
  n = 0;
  for (guint i = 0; i < n_blocks; i++)
    if (!isnan (mask->chroma_off[0][i])) {
      const gfloat u = mask->chroma_off[0][i] - mask->chroma_bias[0];
      const gfloat v = mask->chroma_off[1][i] - mask->chroma_bias[1];

      mask->sorted[n++] = (gdouble) (u * u + v * v);
    }
  qsort (mask->sorted, n, sizeof (gdouble), cloth_compare_doubles);
  mask->chroma_variance = (gfloat) mask->sorted[n / 4] / QUARTER;
}

/* Repeats the first and the last column of @sums beside the row. */
static void
pad (gint32 * sums, gint width, gint radius)
{
  for (gint k = 0; k < radius; k++) {
    sums[k] = sums[radius];
    sums[radius + width + k] = sums[radius + width - 1];
  }
}

static void
add_row (const ClothMask * mask, gint y, gint32 sign, const Scratch * scratch)
{
  const ClothImage *film = &mask->image->luma;
  const gint row = CLAMP (y, 0, mask->height - 1), radius = mask->params.radius;
  gint32 *const sums[3] = { scratch->sums[0] + radius,
    scratch->sums[1] + radius, scratch->sums[2] + radius
  };

  mask->kernels->add_row (film->data + (gsize) row * (gsize) film->stride,
      mask->ground + (gsize) row * (gsize) mask->width, mask->width, sign,
      sums);
}

/* Rows of windows of Cb and Cr about row @y of theirs; less 128 a sample, so that what is
 * multiplied by a gain is a colour. */
static void
add_chroma (const ClothMask * mask, gint y, const Scratch * scratch)
{
  const ClothPlanarImage *film = mask->image;
  const gint radius = mask->params.radius, width = mask->chroma_width;
  const gint step = film->chroma_step;

  for (gint c = 0; c < 2; c++) {
    gint32 *f = scratch->chroma[2 * c], *g = scratch->chroma[2 * c + 1];

    for (gint x = 0; x < width; x++)
      f[radius + x] = g[radius + x] = -128 * (2 * radius + 1);
    for (gint k = -radius; k <= radius; k++) {
      const gint row = CLAMP (y + k, 0, mask->chroma_height - 1);
      const guint8 *of_film = film->chroma[c] +
          (gsize) row * (gsize) film->chroma_stride;
      const guint8 *of_ground = ground_chroma (mask, c) +
          (gsize) row * (gsize) width;

      for (gint x = 0; x < width; x++) {
        f[radius + x] += of_film[x * step];
        g[radius + x] += of_ground[x];
      }
    }
    pad (f, width, radius);
    pad (g, width, radius);
  }
}

/* Chroma is spoilt by a film's coding in whole blocks: its errors don't average out in a
 * window. Sums are of n samples, hence n². */
static void
test_chroma (const ClothMask * mask, gint y, Scratch * scratch)
{
  const gint edge = 2 * mask->params.radius + 1, n = edge * edge;
  const gfloat most = (gfloat) (n * n) *
      (2 + (gfloat) mask->params.significance * 2);
  ClothMaskTest test = { mask->params.radius, 0, 0, scratch->limits, {
      (gfloat) n * mask->chroma_bias[0], (gfloat) n * mask->chroma_bias[1]}
  };

  add_chroma (mask, y, scratch);
  for (gint x = 0; x < mask->chroma_width; x++) {
    const gint at = MIN (x << mask->shift[0], mask->width - 1);

    scratch->gains[x] = scratch->gains[at];
    scratch->limits[x] = most * MAX (scratch->variances[at],
        mask->chroma_variance);
  }
  mask->kernels->test_chroma (&test, scratch->chroma, mask->chroma_width,
      scratch->gains, scratch->chroma_hits);
}

/* Rows of windows of luma about row @y, from those about the row before. */
static void
move_down (const ClothMask * mask, gint y, gboolean first,
    const Scratch * scratch)
{
  const gint radius = mask->params.radius;

  if (first) {
    for (gint k = 0; k < 3; k++)
      memset (scratch->sums[k] + radius, 0, (gsize) mask->width * 4);
    for (gint k = -radius; k <= radius; k++)
      add_row (mask, y + k, 1, scratch);
  } else {
    add_row (mask, y + radius, 1, scratch);
    add_row (mask, y - radius - 1, -1, scratch);
  }
  for (gint k = 0; k < 3; k++)
    pad (scratch->sums[k], mask->width, radius);
}

static void
test_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothMask *mask = data;
  const ClothMaskParams *p = &mask->params;
  const gfloat most = most_residual (p);
  const gint y0 = (gint) begin * BLOCK;
  const gint y1 = MIN ((gint) end * BLOCK, mask->height);
  Scratch *scratch = &mask->scratch[worker];

  for (gint y = y0; y < y1; y++) {
    ClothMaskTest test = { p->radius, (gfloat) p->shadow, (gfloat) p->glow,
      scratch->limits, {0, 0}
    };
    guint64 *bits = mask->bits + (gsize) y * (gsize) mask->n_words;

    if (y == y0 || y % BLOCK == 0)
      spread_noise (mask, y / BLOCK, scratch->variances);
    for (gint x = 0; x < mask->width; x++)
      scratch->limits[x] = most * scratch->variances[x];
    move_down (mask, y, y == y0, scratch);
    mask->kernels->test_row (&test, scratch->sums, mask->width, scratch->gains,
        scratch->hits);
    if (mask->in_colour) {
      if (y == y0 || y % (1 << mask->shift[1]) == 0)
        test_chroma (mask, y >> mask->shift[1], scratch);
      for (gint x = 0; x < mask->width; x++)
        scratch->hits[x] |= scratch->chroma_hits[x >> mask->shift[0]];
    }
    cloth_bits_pack (scratch->hits, mask->width, bits);
  }
}

static gboolean
has_ranges (const ClothMaskParams * p)
{
  for (gint c = 0; c < 3; c++)
    if (p->low[c] > 0 || p->high[c] < 255)
      return TRUE;
  return FALSE;
}

/* Clears what is out of the ranges of luma and chroma. */
static void
clear_other_colours (ClothMask * mask)
{
  const ClothPlanarImage *image = mask->image;
  const ClothMaskParams *p = &mask->params;
  const gint width = image->luma.width;
  guint8 *inside = mask->scratch->hits, *chroma = mask->scratch->chroma_hits;
  guint64 *row = mask->spare;

  for (gint y = 0; y < image->luma.height; y++) {
    const guint8 *luma = image->luma.data +
        (gsize) y * (gsize) image->luma.stride;
    guint64 *bits = mask->bits + (gsize) y * (gsize) mask->n_words;

    for (gint x = 0; x < width; x++)
      inside[x] = luma[x] >= p->low[0] && luma[x] <= p->high[0];
    if (image->chroma[0]) {
      const gsize at = (gsize) (y >> image->chroma_shift[1]) *
          (gsize) image->chroma_stride;
      const guint8 *u = image->chroma[0] + at, *v = image->chroma[1] + at;
      const gint n = halved (width, image->chroma_shift[0]);

      for (gint x = 0; x < n; x++) {
        const gint k = x * image->chroma_step;

        chroma[x] = u[k] >= p->low[1] && u[k] <= p->high[1] &&
            v[k] >= p->low[2] && v[k] <= p->high[2];
      }
      for (gint x = 0; x < width; x++)
        inside[x] &= chroma[x >> image->chroma_shift[0]];
    }
    cloth_bits_pack (inside, width, row);
    for (gint k = 0; k < mask->n_words; k++)
      bits[k] &= row[k];
  }
}

/* Clears what has no disparity, or one out of range. */
static void
clear_other_depths (ClothMask * mask)
{
  const ClothMaskParams *p = &mask->params;
  const gint width = mask->image->luma.width;
  guint8 *inside = mask->scratch->hits;
  guint64 *row = mask->spare;

  for (gint y = 0; y < mask->image->luma.height; y++) {
    const gfloat *d = p->disparities + (gsize) y * (gsize) width;
    guint64 *bits = mask->bits + (gsize) y * (gsize) mask->n_words;

    /* false for what is no number */
    for (gint x = 0; x < width; x++)
      inside[x] = (gdouble) d[x] >= p->least_disparity
          && (gdouble) d[x] <= p->most_disparity;
    cloth_bits_pack (inside, width, row);
    for (gint k = 0; k < mask->n_words; k++)
      bits[k] &= row[k];
  }
}

/* @mask: a mask
 * @params: parameters
 * @image: the picture
 * @pool: (nullable): threads that share the work
 * @level: vector instructions that may be used at most
 *
 * Finds the silhouette, see cloth_mask_get_runs (). Where no background of the size of
 * @image is known, all is taken for cloth that the ranges of @params leave. The result
 * depends on neither @pool nor @level.
 */
void
cloth_mask_run (ClothMask * mask, const ClothMaskParams * params,
    const ClothPlanarImage * image, ClothPool * pool, ClothSimd level)
{
  const gint width = image->luma.width, height = image->luma.height;
  const ClothMaskParams *p = &mask->params;

  prepare (mask, params, image, pool, level);
  if (cloth_mask_has_background (mask, image)) {
    cloth_pool_run (pool, measure_rows, mask, (guint) mask->rows);
    bound_noise (mask);
    if (mask->in_colour)
      measure_chroma (mask, pool);
    cloth_pool_run (pool, test_rows, mask, (guint) mask->rows);
    cloth_bits_open (mask->bits, mask->spare, width, height, p->thin);
    /* a window that touches the cloth is none of the background */
    cloth_bits_erode (mask->bits, mask->spare, width, height, p->radius);
    if (has_ranges (p))
      clear_other_colours (mask);
    if (p->disparities)
      clear_other_depths (mask);
  } else {
    memset (mask->bits, 0xff, (gsize) mask->n_words * (gsize) height * 8);
    clear_other_colours (mask);
    if (p->disparities)
      clear_other_depths (mask);
    cloth_bits_open (mask->bits, mask->spare, width, height, p->thin);
  }
  mask->cut = !cloth_runs_of_bits (mask->runs, mask->bits, width, height);
  cloth_runs_drop (mask->runs, mask->pieces, p->least);
  cloth_runs_fill (mask->runs, mask->gaps, mask->pieces, p->hole, width,
      height);
  mask->image = NULL;
}

/* @mask: a mask
 * @n_runs: (out): how many
 *
 * Returns: (transfer none): the silhouette in the last picture, by row and column
 */
const ClothRun *
cloth_mask_get_runs (const ClothMask * mask, guint * n_runs)
{
  *n_runs = mask->runs->len;
  return (const ClothRun *) mask->runs->data;
}

/* @mask: a mask
 *
 * Returns: whether the silhouette in the last picture has more than %CLOTH_RUNS_MAX runs,
 *   so that the rows below are missing
 */
gboolean
cloth_mask_was_cut (const ClothMask * mask)
{
  return mask->cut;
}
