/* Saddle points of image intensity: the corners of a checkerboard.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/saddle.h"

#include <math.h>
#include <string.h>

#include "gst/vision/corner/corner.h"
#include "gst/vision/corner/saddle-mask.h"
#include "gst/vision/corner/saddle-private.h"

/* Saddles whose residual is looked at in a picture. */
#define MAX_RESIDUALS 12

struct _ClothSaddleDetector
{
  ClothSaddleKernel kernel;
  gfloat kernel_sigma;
  ClothSaddleRefiner *refiner;
  ClothSaddleMask mask;

  ClothSaddleCandidate *candidates;
  guint n_candidates, candidates_allocated;
  ClothSaddle *saddles;
  guint n_saddles, saddles_allocated;
    gfloat (*theta)[2];
  guint theta_allocated;
  ClothSaddleCandidate *peaks;
  guint n_peaks, peaks_allocated;

  gboolean cut;
  gfloat epsilon;
  gfloat noise;
};

/* Returns: the parameters that suit a printed board filmed in focus.
 */
ClothSaddleParams
cloth_saddle_default_params (void)
{
  /* *INDENT-OFF* */
  return (ClothSaddleParams) {
    .sigma = 1.5f,
    .epsilon = 3.0f,
    .relative = 0.01f,
    .refine = CLOTH_SADDLE_REFINE_STREAM,
    .radius = 8.0f,
    .max_candidates = CLOTH_SADDLE_MAX,
    .max_saddles = CLOTH_SADDLE_MAX,
  };
  /* *INDENT-ON* */
}

/* Returns: (transfer full): a detector; it keeps its buffers from picture to picture, so
 *   that pictures of one size allocate nothing after the first. One thread at a time.
 */
ClothSaddleDetector *
cloth_saddle_detector_new (void)
{
  return g_new0 (ClothSaddleDetector, 1);
}

/* @detector: (transfer full) (nullable): freed
 */
void
cloth_saddle_detector_free (ClothSaddleDetector * detector)
{
  if (!detector)
    return;
  cloth_saddle_mask_clear (&detector->mask);
  cloth_saddle_refiner_free (detector->refiner);
  g_free (detector->candidates);
  g_free (detector->saddles);
  g_free (detector->theta);
  g_free (detector->peaks);
  g_free (detector);
}

/* Distance between the 5th and the 95th percentile of the grey levels in the region,
 * read at no more than about 16,000 places. */
static gfloat
measure_contrast (const ClothSaddleMask * mask, const ClothImage * image)
{
  gint step = 1 + (gint) sqrt ((gdouble) mask->width * mask->height / 16384.0);
  guint histogram[256] = { 0 }, total = 0, below = 0;
  gint low = -1, high = 255;

  for (gint y = step / 2; y < mask->height; y += step) {
    const guint8 *row = image->data + (gsize) (mask->y + y) *
        (gsize) image->stride + mask->x;
    for (gint x = step / 2; x < mask->width; x += step) {
      histogram[row[x]]++;
      total++;
    }
  }
  for (gint i = 0; i < 256; i++) {
    below += histogram[i];
    if (low < 0 && below * 20 > total)
      low = i;
    if (below * 20 >= total * 19) {
      high = i;
      break;
    }
  }
  return (gfloat) (high - MAX (low, 0));
}

/* Standard deviation of white noise, grey levels, by the median of a second mixed
 * difference that planes and straight axis-parallel edges don't touch. Not below the
 * noise of rounding to whole levels. */
static gfloat
measure_noise (const ClothSaddleMask * mask, const ClothImage * image)
{
  gint step = 1 + (gint) sqrt ((gdouble) mask->width * mask->height / 8192.0);
  guint histogram[2041] = { 0 }, total = 0, below = 0;
  gint x1 = MIN (mask->x + mask->width, image->width - 1);
  gint y1 = MIN (mask->y + mask->height, image->height - 1);
  const gfloat least = 0.2886751f;

  for (gint y = mask->y + 1; y < y1; y += step) {
    const guint8 *b = image->data + (gsize) y * (gsize) image->stride;
    const guint8 *a = b - image->stride, *c = b + image->stride;
    for (gint x = mask->x + 1; x < x1; x += step) {
      gint v = a[x - 1] + a[x + 1] + c[x - 1] + c[x + 1] + 4 * b[x] -
          2 * (a[x] + b[x - 1] + b[x + 1] + c[x]);
      histogram[ABS (v)]++;
      total++;
    }
  }
  for (gint i = 0; i < 2041; i++) {
    guint next = below + histogram[i];
    if (2 * next >= total && histogram[i] > 0) {
      /* The median within the step of one level, of |v| which is 6 sigma wide. */
      gdouble m = i == 0 ? 0.5 * total / (gdouble) next * 0.5 :
          i - 0.5 + (0.5 * total - below) / (gdouble) histogram[i];
      return MAX (least, (gfloat) (m / (0.67448975 * 6.0)));
    }
    below = next;
  }
  return least;
}

/* The bits of columns [x - reach, x + reach], the first in bit 0. */
static inline guint64
mask_window (const ClothSaddleMask * mask, gint x, gint y, gint reach)
{
  const guint64 *bits = mask->bits + (gsize) y * (gsize) mask->words;
  gint from = x - reach, w = from >> 6, shift = from & 63;
  guint64 window = w >= 0 ? bits[w] >> shift : 0;

  if (shift > 0 && w + 1 < mask->words)
    window |= bits[w + 1] << (64 - shift);
  return window & ((G_GUINT64_CONSTANT (1) << (2 * reach + 1)) - 1);
}

/* A peak is not surpassed within @reach pixels; of equals the first one counts. */
static gboolean
is_peak (const ClothSaddleMask * mask, gint x, gint y, gint reach, gint d)
{
  /* The nearest rows first: they refuse most. */
  for (gint k = 0; k <= 2 * reach; k++) {
    gint row = y + (k % 2 ? -(k + 1) / 2 : k / 2);
    guint64 window;

    if (row < 0 || row >= mask->height)
      continue;
    for (window = mask_window (mask, x, row, reach); window;
        window &= window - 1) {
      gint i = __builtin_ctzll (window) - reach;
      gint other = cloth_saddle_mask_det (mask, x + i, row);
      if (other < d || (other == d && (row < y || (row == y && i < 0))))
        return FALSE;
    }
  }
  return TRUE;
}

/* The threshold, not below @threshold, above which the @limit strongest pixels lie; those
 * just at it may be more. */
static gint
raise_threshold (const ClothSaddleMask * mask, gint threshold, guint limit)
{
  guint histogram[8192] = { 0 }, above = 0;
  const guint64 *word = mask->bits;
  gint bin = 8191;

  for (gint y = 0; y < mask->height; y++) {
    for (gint w = 0; w < mask->words; w++, word++) {
      for (guint64 bits = *word; bits; bits &= bits - 1)
        histogram[(guint) - cloth_saddle_mask_det (mask,
                64 * w + __builtin_ctzll (bits), y) >> 2 & 8191]++;
    }
  }
  for (; bin >= 0; bin--) {
    above += histogram[bin];
    if (above > limit)
      break;
  }
  return MAX (threshold, 4 * bin - 1);
}

/* Grows an array that the scan fills, by whole powers of two. */
static gpointer
grow (gpointer array, guint * allocated, guint need, gsize size)
{
  if (need <= *allocated)
    return array;
  *allocated = MAX (1024, need + need / 2);
  return g_realloc_n (array, *allocated, size);
}

/* Lists the pixels beyond @listed as candidates, and all peaks; FALSE when there are more
 * candidates than @limit, of which the first are listed. */
static gboolean
scan_mask (ClothSaddleDetector * self, gint threshold, gint listed, gint reach,
    guint limit)
{
  const ClothSaddleMask *mask = &self->mask;
  gboolean all = TRUE;

  self->n_candidates = 0;
  self->n_peaks = 0;
  for (gint y = 0; y < mask->height; y++) {
    const guint64 *bits = mask->bits + (gsize) y * (gsize) mask->words;
    const guint64 *above = bits - mask->words, *below = bits + mask->words;

    for (gint w = 0; w < mask->words; w++) {
      const gint16 *block = cloth_saddle_mask_block (mask, w, y);
      guint64 word = bits[w];

      if (!word)
        continue;
      self->candidates = grow (self->candidates, &self->candidates_allocated,
          self->n_candidates + 64, sizeof (ClothSaddleCandidate));
      self->peaks = grow (self->peaks, &self->peaks_allocated,
          self->n_peaks + 64, sizeof (ClothSaddleCandidate));
      for (; word; word &= word - 1) {
        gint i = __builtin_ctzll (word), x = 64 * w + i;
        gint d = cloth_saddle_block_det (block, i);
        ClothSaddleCandidate pixel;

        if (d >= -threshold)
          continue;
        pixel.x = (gfloat) (mask->x + x);
        pixel.y = (gfloat) (mask->y + y);
        pixel.response = (gfloat) - d * self->kernel.scale;
        if (d >= -listed || self->n_candidates == limit)
          all &= d >= -listed;
        else
          self->candidates[self->n_candidates++] = pixel;
        /* The four neighbours refuse most without a closer look. */
        if (!(i > 0 && bits[w] >> (i - 1) & 1
                && cloth_saddle_block_det (block, i - 1) <= d)
            && !(i < 63 && bits[w] >> (i + 1) & 1
                && cloth_saddle_block_det (block, i + 1) < d)
            && !(y > 0 && above[w] >> i & 1
                && cloth_saddle_mask_det (mask, x, y - 1) <= d)
            && !(y + 1 < mask->height && below[w] >> i & 1
                && cloth_saddle_mask_det (mask, x, y + 1) < d)
            && is_peak (mask, x, y, reach, d)) {
          if (self->n_peaks < CLOTH_SADDLE_MAX)
            self->peaks[self->n_peaks++] = pixel;
          else
            self->cut = TRUE;
        }
      }
    }
  }
  return all;
}

/* Two peaks of one flat blob may lead to the same saddle. Saddles come row after row,
 * so an equal one is near the end of the list. */
static gboolean
is_known (const ClothSaddleDetector * self, const ClothSaddle * saddle,
    gfloat distance)
{
  for (guint i = self->n_saddles; i > 0; i--) {
    const ClothSaddle *other = &self->saddles[i - 1];
    gfloat dx = other->x - saddle->x, dy = other->y - saddle->y;

    if (dx * dx + dy * dy < distance * distance)
      return TRUE;
    if (dy < -4.0f * distance - 8.0f)
      return FALSE;
  }
  return FALSE;
}

static void
refine_peaks (ClothSaddleDetector * self, const ClothSaddleParams * params,
    const ClothImage * image, ClothSimd level)
{
  guint limit = MIN (params->max_saddles, CLOTH_SADDLE_MAX);

  for (guint i = 0; i < self->n_peaks; i++) {
    const ClothSaddleCandidate *peak = &self->peaks[i];
    ClothSaddle saddle;
    gfloat theta[2];

    if (!cloth_saddle_refiner_run (self->refiner, image, peak, self->noise,
            &saddle, params->refine == CLOTH_SADDLE_REFINE_MODEL ? theta :
            NULL, level))
      continue;
    if (saddle.response <= self->epsilon || is_known (self, &saddle, 1.0f))
      continue;
    if (self->n_saddles >= limit) {
      self->cut = TRUE;
      return;
    }
    self->saddles = grow (self->saddles, &self->saddles_allocated,
        self->n_saddles + 1, sizeof (ClothSaddle));
    if (params->refine == CLOTH_SADDLE_REFINE_MODEL) {
      self->theta = grow (self->theta, &self->theta_allocated,
          self->n_saddles + 1, sizeof (self->theta[0]));
      memcpy (self->theta[self->n_saddles], theta, sizeof (theta));
    }
    self->saddles[self->n_saddles++] = saddle;
  }
}

/* Distance to the nearest saddle that is not much weaker, at most @most. The list goes
 * row after row but for a few pixels. */
static gfloat
spacing (const ClothSaddleDetector * self, guint index, gfloat most)
{
  const ClothSaddle *saddle = &self->saddles[index];
  gfloat best = most * most;

  for (gint direction = -1; direction <= 1; direction += 2) {
    for (gint64 i = (gint64) index + direction; i >= 0 && i < self->n_saddles;
        i += direction) {
      const ClothSaddle *other = &self->saddles[i];
      gfloat dx = other->x - saddle->x, dy = other->y - saddle->y;

      if ((gfloat) direction * dy > most + 8.0f)
        break;
      if (other->response > 0.2f * saddle->response)
        best = MIN (best, dx * dx + dy * dy);
    }
  }
  return sqrtf (best);
}

/* What the corner model leaves unexplained around some of the saddles, the median, grey
 * levels: on pictures of a camera the noise, on films what compression, texture and bends
 * of the cloth add as well, which flat places don't show. 0 when nothing could be fitted. */
static gfloat
measure_residual (const ClothSaddleDetector * self, gfloat sigma,
    const ClothImage * image, ClothSimd level)
{
  ClothCornerParams params = cloth_corner_default_params ();
  guint n = MIN (self->n_saddles, MAX_RESIDUALS), found = 0;
  gfloat sorted[MAX_RESIDUALS];
  /* As far as the Gaussian looks. */
  gfloat radius = CLAMP (3 * sigma, 3.0f, 7.0f);

  params.max_shift = 1.0f;
  for (guint i = 0; i < n; i++) {
    guint index = (guint) ((2 * i + 1) * (guint64) self->n_saddles / (2 * n));
    const ClothSaddle *saddle = &self->saddles[index];
    ClothCornerFit fit;
    guint at;

    params.radius = MIN (radius, 0.5f * spacing (self, index, 2 * radius));
    if (!cloth_corner_refine (image, saddle->x, saddle->y, &params, level,
            &fit) || !cloth_corner_is_saddle (&fit))
      continue;
    for (at = found++; at > 0 && sorted[at - 1] > fit.rms; at--)
      sorted[at] = sorted[at - 1];
    sorted[at] = fit.rms;
  }
  return found ? sorted[found / 2] : 0;
}

/* The refiner takes the noise of flat places. Where there is more around the saddles, that
 * counts. */
static void
widen (ClothSaddleDetector * self, gfloat residual)
{
  gfloat factor = residual / self->noise;

  factor *= factor;
  for (guint i = 0; i < self->n_saddles && factor > 1; i++)
    for (gint k = 0; k < 3; k++)
      self->saddles[i].cov[k] *= factor;
}

/* Where the model doesn't fit, the saddle of the smoothed intensity stays. */
static void
fit_models (ClothSaddleDetector * self, gfloat radius,
    const ClothImage * image, ClothSimd level)
{
  ClothCornerParams params = cloth_corner_default_params ();

  params.known_angles = TRUE;
  params.max_shift = 1.0f;
  for (guint i = 0; i < self->n_saddles; i++) {
    ClothSaddle *saddle = &self->saddles[i];
    ClothCornerFit fit;

    /* Half way to the next corner its edges come in. */
    params.radius = MIN (radius, 0.5f * spacing (self, i, 2 * radius));
    memcpy (params.theta, self->theta[i], sizeof (params.theta));
    if (!cloth_corner_refine (image, saddle->x, saddle->y, &params, level,
            &fit))
      continue;
    saddle->x = fit.x;
    saddle->y = fit.y;
    memcpy (saddle->cov, fit.cov, sizeof (saddle->cov));
  }
}

static void
set_region (ClothSaddleMask * mask, const ClothSaddleParams * params,
    const ClothImage * image)
{
  gint64 x1 = params->roi_width > 0 ?
      (gint64) params->roi_x + params->roi_width : image->width;
  gint64 y1 = params->roi_height > 0 ?
      (gint64) params->roi_y + params->roi_height : image->height;

  mask->x = MAX (params->roi_x, 0);
  mask->y = MAX (params->roi_y, 0);
  mask->width = (gint) (MIN (x1, image->width) - mask->x);
  mask->height = (gint) (MIN (y1, image->height) - mask->y);
}

static gfloat
in_range (gfloat value, gfloat low, gfloat high)
{
  /* The negation takes NaN to the low end. */
  return !(value > low) ? low : MIN (value, high);
}

/* @detector: a detector
 * @params: what to look for
 * @image: the picture, at most 65,536 pixels a side; read only during the call
 * @level: the highest instruction set to use; every one gives the same bytes
 *
 * Finds the candidates of (3.4) of Guskov & Zhukov, "Direct pattern tracking on flexible
 * geometry", and one refined saddle for each peak of their response. The results belong
 * to @detector and hold until its next run.
 *
 * A saddle's covariance is that of white noise of the picture's strength: as flat places
 * show it or, if that is more, as the corner model leaves unexplained around some of the
 * saddles. Where the corner model was fitted it is that of its own residual.
 */
void
cloth_saddle_detector_run (ClothSaddleDetector * detector,
    const ClothSaddleParams * params, const ClothImage * image, ClothSimd level)
{
  ClothSaddleMask *mask = &detector->mask;
  gfloat sigma = in_range (params->sigma, 0.5f, 5.0f);
  gfloat epsilon = in_range (params->epsilon, 0.0f, 1e9f);
  gfloat relative = in_range (params->relative, 0.0f, 1.0f);
  guint limit = MIN (params->max_candidates, CLOTH_SADDLE_MAX);
  gint reach = MAX (2, (gint) ceilf (sigma));
  gint threshold;

  detector->n_candidates = detector->n_saddles = 0;
  detector->cut = FALSE;
  detector->epsilon = epsilon;
  g_return_if_fail (image->width > 0 && image->width <= 65536);
  g_return_if_fail (image->height > 0 && image->height <= 65536);

  set_region (mask, params, image);
  if (mask->width <= 0 || mask->height <= 0)
    return;

  level = cloth_simd_resolve (level);
  if (sigma != detector->kernel_sigma) {
    cloth_saddle_kernel_init (&detector->kernel, sigma);
    detector->kernel_sigma = sigma;
  }
  if (relative > 0) {
    /* A sharp corner between levels C apart has Fxy = C / (pi sigma²). */
    gfloat peak = measure_contrast (mask, image) / (3.1415927f * sigma * sigma);
    epsilon = MAX (epsilon, relative * peak * peak);
  }
  threshold = (gint) MIN (epsilon / detector->kernel.scale, 32767.0f);

  cloth_saddle_mask_run (mask, &detector->kernel, image, threshold, level);
  detector->epsilon = epsilon;
  if (!scan_mask (detector, threshold, threshold, reach, limit)) {
    /* Only the list of candidates is cut, to the strongest; each corner has many. */
    scan_mask (detector, threshold, raise_threshold (mask, threshold, limit),
        reach, limit);
    detector->cut = TRUE;
  }

  detector->noise = measure_noise (mask, image);
  if (params->refine != CLOTH_SADDLE_REFINE_NONE) {
    if (!detector->refiner)
      detector->refiner = cloth_saddle_refiner_new ();
    cloth_saddle_refiner_set (detector->refiner, sigma);
    refine_peaks (detector, params, image, level);
    widen (detector, measure_residual (detector, sigma, image, level));
    if (params->refine == CLOTH_SADDLE_REFINE_MODEL)
      fit_models (detector, in_range (params->radius, 2.0f, 12.0f), image,
          level);
  }
}

/* @detector: a detector
 * @n_candidates: (out): how many
 *
 * Returns: (transfer none): the hyperbolic pixels of the last picture, row after row.
 */
const ClothSaddleCandidate *
cloth_saddle_detector_get_candidates (const ClothSaddleDetector * detector,
    guint * n_candidates)
{
  *n_candidates = detector->n_candidates;
  return detector->candidates;
}

/* @detector: a detector
 * @n_saddles: (out): how many
 *
 * Returns: (transfer none): the refined saddles of the last picture, in the order of the
 *   rows of their strongest pixels.
 */
const ClothSaddle *
cloth_saddle_detector_get_saddles (const ClothSaddleDetector * detector,
    guint * n_saddles)
{
  *n_saddles = detector->n_saddles;
  return detector->saddles;
}

/* @detector: a detector
 *
 * Returns: whether the last picture had more candidates or saddles than allowed. Of
 *   candidates the strongest were kept, of saddles the topmost.
 */
gboolean
cloth_saddle_detector_was_cut (const ClothSaddleDetector * detector)
{
  return detector->cut;
}

/* @detector: a detector
 *
 * Returns: the bound that was in force for the last picture, grey levels² / px⁴.
 */
gfloat
cloth_saddle_detector_get_epsilon (const ClothSaddleDetector * detector)
{
  return detector->epsilon;
}

/* @detector: a detector
 *
 * Returns: the last picture's noise, standard deviation in grey levels.
 */
gfloat
cloth_saddle_detector_get_noise (const ClothSaddleDetector * detector)
{
  return detector->noise;
}
