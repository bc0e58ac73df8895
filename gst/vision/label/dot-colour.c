/* Colours of dots: Gaussian classes of chroma over brightness, with room for outliers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/label/dot-colour.h"

#include <math.h>
#include <string.h>

/* How far a camera shows a printed colour from where it should be, each way, as a share
 * of its distance from grey plus one. */
#define PRINT_SPREAD 0.07f
/* What a class keeps of that as spread from dot to dot once it has been learnt. */
#define LEAST_SPREAD 0.02f
/* Least brightness that still tells a colour, grey levels. */
#define LEAST_LUMA 4.0f
/* Dots that a class remembers, and for how many the print counts. */
#define REMEMBERED 1000.0f
#define PRINT_COUNTS 10.0f
/* Width of the square of chroma over brightness that outliers are strewn over. */
#define OUTLIER_WIDTH 3.0f

static void
set_means (ClothDotColourModel * model, gint n)
{
  model->n = CLAMP (n, 2, CLOTH_DOT_COLOURS_MAX);
  model->noise = 2;
  model->outliers = 0.05f;
  for (gint k = 0; k < model->n; k++) {
    ClothDotColourClass *class = &model->classes[k];
    const gfloat spread = PRINT_SPREAD
        * (1 + hypotf (class->mean[0], class->mean[1]));

    class->cov[0] = class->cov[2] = spread * spread;
    model->seen[k] = PRINT_COUNTS;
  }
}

/* @model: (out caller-allocates): the model
 * @n: number of colours, 2 to %CLOTH_DOT_COLOURS_MAX
 * @rgb: (array length=n): how each is printed, 0 to 255 (sRGB)
 * @kr: share of red in the pictures' luma: 0.2126 for BT.709, 0.299 for BT.601
 * @kb: share of blue in the pictures' luma: 0.0722 for BT.709, 0.114 for BT.601
 *
 * Expects the colours as they are printed. With cloth_dot_colour_model_adapt() and
 * cloth_dot_colour_model_learn() it becomes what a camera sees.
 */
void
cloth_dot_colour_model_init (ClothDotColourModel * model, gint n,
    const guint8 (*rgb)[3], gfloat kr, gfloat kb)
{
  memset (model, 0, sizeof *model);
  model->kr = kr;
  model->kb = kb;
  for (gint k = 0; k < CLAMP (n, 2, CLOTH_DOT_COLOURS_MAX); k++) {
    const gfloat red = rgb[k][0], green = rgb[k][1], blue = rgb[k][2];
    const gfloat luma = MAX (1, kr * red + (1 - kr - kb) * green + kb * blue);

    model->classes[k].mean[0] = (blue - luma) / (2 * (1 - kb) * luma);
    model->classes[k].mean[1] = (red - luma) / (2 * (1 - kr) * luma);
  }
  set_means (model, n);
}

/* Chroma over brightness, and what the picture's noise adds to its variance. */
static gfloat
chroma_of (const ClothDotColourModel * model, const ClothDot * dot,
    gfloat chroma[2])
{
  const gfloat luma = MAX (LEAST_LUMA, dot->colour[0] - dot->background);
  const gfloat sigma = model->noise / luma;

  for (gint i = 0; i < 2; i++)
    chroma[i] = (dot->colour[1 + i] - 128 - model->ground[i]) / luma;
  return sigma * sigma;
}

/* Squared distance of @chroma from a class in standard deviations; the determinant of
 * its covariance. */
static gfloat
distance2 (const ClothDotColourClass * class, const gfloat chroma[2],
    gfloat noise, gfloat * determinant)
{
  const gfloat a = class->cov[0] + noise, b = class->cov[1];
  const gfloat c = class->cov[2] + noise, det = a * c - b * b;
  const gfloat x = chroma[0] - class->mean[0], y = chroma[1] - class->mean[1];

  *determinant = det;
  return (c * x * x - 2 * b * x * y + a * y * y) / det;
}

static gfloat
density (const ClothDotColourClass * class, const gfloat chroma[2],
    gfloat noise)
{
  gfloat det;
  const gfloat d2 = distance2 (class, chroma, noise, &det);

  return expf (-0.5f * d2) / (2 * (gfloat) G_PI * sqrtf (det));
}

/* @model: the model
 * @dots: (array length=n_dots): dots
 * @n_dots: how many
 * @log_likelihoods: (out caller-allocates): for each dot @model->n floats: the log
 *   density of its chroma over brightness if it has that colour. Outliers are part of
 *   each, so that a dot that looks like none of them tells nothing
 */
void
cloth_dot_colour_model_classify (const ClothDotColourModel * model,
    const ClothDot * dots, guint n_dots, gfloat * log_likelihoods)
{
  const gfloat floor = model->outliers / (OUTLIER_WIDTH * OUTLIER_WIDTH);

  for (guint i = 0; i < n_dots; i++) {
    gfloat chroma[2];
    const gfloat noise = chroma_of (model, &dots[i], chroma);

    for (gint k = 0; k < model->n; k++) {
      const gfloat p = (1 - model->outliers)
          * density (&model->classes[k], chroma, noise) + floor;

      /* Written so that NaN tells nothing. */
      *log_likelihoods++ = logf (p > floor ? p : floor);
    }
  }
}

/* --- what a camera makes of the print ------------------------------------------------ */

/* The model as it would be with other gains of red and blue and with colours so much
 * paler. */
static void
change_light (const ClothDotColourModel * from, gfloat red, gfloat blue,
    gfloat saturation, ClothDotColourModel * to)
{
  const gfloat kr = from->kr, kb = from->kb, kg = 1 - kr - kb;

  *to = *from;
  for (gint k = 0; k < from->n; k++) {
    const gfloat *mean = from->classes[k].mean;
    gfloat r = 1 + 2 * (1 - kr) * mean[1], b = 1 + 2 * (1 - kb) * mean[0];
    const gfloat g = (1 - kr * r - kb * b) / kg;
    gfloat luma;

    r *= red;
    b *= blue;
    luma = MAX (0.05f, kr * r + kg * g + kb * b);
    to->classes[k].mean[0] = saturation * (b / luma - 1) / (2 * (1 - kb));
    to->classes[k].mean[1] = saturation * (r / luma - 1) / (2 * (1 - kr));
  }
}

/* Mean log density of every @step-th dot, whatever its colour. */
static gfloat
mean_likelihood (const ClothDotColourModel * model, const ClothDot * dots,
    guint n_dots, guint step)
{
  const gfloat floor = model->outliers / (OUTLIER_WIDTH * OUTLIER_WIDTH);
  gfloat sum = 0;
  guint n = 0;

  for (guint i = 0; i < n_dots; i += step, n++) {
    gfloat chroma[2], p = 0;
    const gfloat noise = chroma_of (model, &dots[i], chroma);

    for (gint k = 0; k < model->n; k++)
      p += density (&model->classes[k], chroma, noise);
    p = floor + (1 - model->outliers) * p / (gfloat) model->n;
    sum += logf (p > floor ? p : floor);
  }
  return sum / (gfloat) n;
}

/* A covariance that is no narrower than anything seen, and no line. */
static void
keep_sound (gfloat cov[3])
{
  gfloat most;

  cov[0] = MAX (cov[0], LEAST_SPREAD * LEAST_SPREAD);
  cov[2] = MAX (cov[2], LEAST_SPREAD * LEAST_SPREAD);
  most = 0.9f * sqrtf (cov[0] * cov[2]);
  cov[1] = CLAMP (cov[1], -most, most);
}

/* One round of expectation and maximisation. The share of outliers. */
static gfloat
expect (ClothDotColourModel * model, const ClothDotColourModel * prior,
    const ClothDot * dots, guint n_dots)
{
  const gfloat floor = model->outliers / (OUTLIER_WIDTH * OUTLIER_WIDTH);
  gfloat sums[CLOTH_DOT_COLOURS_MAX][6] = { {0} }, outliers = 0;

  for (guint i = 0; i < n_dots; i++) {
    gfloat chroma[2], p[CLOTH_DOT_COLOURS_MAX], sum = floor;
    const gfloat noise = chroma_of (model, &dots[i], chroma);

    if (!(fabsf (chroma[0]) < OUTLIER_WIDTH
            && fabsf (chroma[1]) < OUTLIER_WIDTH))
      continue;
    for (gint k = 0; k < model->n; k++) {
      p[k] = (1 - model->outliers) / (gfloat) model->n
          * density (&model->classes[k], chroma, noise);
      sum += p[k];
    }
    outliers += floor / sum;
    for (gint k = 0; k < model->n; k++) {
      const gfloat share = p[k] / sum;
      const gfloat x = chroma[0] - model->classes[k].mean[0];
      const gfloat y = chroma[1] - model->classes[k].mean[1];
      const gfloat terms[6] = { 1, x, y, x * x - noise, x * y, y * y - noise };

      for (gint t = 0; t < 6; t++)
        sums[k][t] += share * terms[t];
    }
  }
  for (gint k = 0; k < model->n; k++) {
    ClothDotColourClass *class = &model->classes[k];
    const ClothDotColourClass *from = &prior->classes[k];
    const gfloat *s = sums[k], all = s[0] + PRINT_COUNTS;

    for (gint c = 0; c < 3; c++)
      class->cov[c] = (s[3 + c] + PRINT_COUNTS * from->cov[c]) / all;
    /* Colours that are wide enough take in anything. */
    for (gint c = 0; c < 3; c += 2)
      class->cov[c] = MIN (class->cov[c], from->cov[c]);
    keep_sound (class->cov);
    for (gint c = 0; c < 2; c++)
      class->mean[c] += (s[1 + c]
          + PRINT_COUNTS * (from->mean[c] - class->mean[c])) / all;
  }
  return outliers / (gfloat) n_dots;
}

/* How light is looked for: gains of red and blue over green, log; saturation. */
#define GAIN_STEP 0.15f
#define GAIN_STEPS 4
#define GAIN_SPREAD 0.4f
#define EM_ROUNDS 10
/* Fewest dots of each colour, and most outliers, for an answer. */
#define LEAST_DOTS 8
#define MOST_OUTLIERS 0.4f
#define N_SAMPLES 256

/* @model in the light that makes the dots likeliest, for one saturation. */
static ClothDotColourModel
find_light (const ClothDotColourModel * model, gfloat saturation,
    const ClothDot * dots, guint n_dots, guint step)
{
  ClothDotColourModel best = *model;
  gfloat most = -G_MAXFLOAT;

  for (gint i = -GAIN_STEPS; i <= GAIN_STEPS; i++) {
    for (gint j = -GAIN_STEPS; j <= GAIN_STEPS; j++) {
      const gfloat red = GAIN_STEP * (gfloat) i;
      const gfloat blue = GAIN_STEP * (gfloat) j;
      ClothDotColourModel fit;
      gfloat likely;

      change_light (model, expf (red), expf (blue), saturation, &fit);
      likely = mean_likelihood (&fit, dots, n_dots, step)
          - (red * red + blue * blue) / (2 * GAIN_SPREAD * GAIN_SPREAD)
          / (gfloat) LEAST_DOTS;
      if (likely > most) {
        most = likely;
        best = fit;
      }
    }
  }
  return best;
}

/* @model: (inout): the model, as printed or from a chart
 * @dots: (array length=n_dots): dots of a picture or more
 * @n_dots: how many
 *
 * Fits the colours to dots that nobody has labelled: for each of several saturations first
 * one change of light for all of them, the gains of red and blue that make the dots
 * likeliest, then a mixture of Gaussians by expectation maximisation from there (Dempster,
 * Laird & Rubin 1977), with the print as prior. The likeliest of these is taken.
 *
 * Returns: whether the dots show such colours; if not, @model stays as it was
 */
gboolean
cloth_dot_colour_model_adapt (ClothDotColourModel * model,
    const ClothDot * dots, guint n_dots)
{
  static const gfloat saturations[] =
      { 0.35f, 0.5f, 0.7f, 0.85f, 1, 1.2f, 1.6f, 2.2f, 3 };
  const guint step = n_dots / N_SAMPLES + 1;
  ClothDotColourModel best = *model;
  gfloat most = -G_MAXFLOAT, outliers = 1;

  if (n_dots < (guint) model->n * LEAST_DOTS)
    return FALSE;
  for (guint k = 0; k < G_N_ELEMENTS (saturations); k++) {
    const ClothDotColourModel light =
        find_light (model, saturations[k], dots, n_dots, step);
    ClothDotColourModel fit = light;
    gfloat left = 1, likely;

    for (guint round = 0; round < EM_ROUNDS; round++)
      left = expect (&fit, &light, dots, n_dots);
    likely = mean_likelihood (&fit, dots, n_dots, step);
    if (likely > most) {
      most = likely;
      best = fit;
      outliers = left;
    }
  }
  if (!(outliers < MOST_OUTLIERS))
    return FALSE;
  *model = best;
  return TRUE;
}

/* --- what labels teach ------------------------------------------------------------------ */

/* Heavy tails of what is learnt: Student's t with so many degrees of freedom. */
#define FREEDOM 4.0f
/* How fast the ground's chroma is learnt, how many dots it counts for that the ground is
 * grey, and what it can be at most, grey levels. */
#define GROUND_RATE 0.2f
#define GROUND_PRIOR 4.0f
#define GROUND_MOST 20.0f

/* The chroma that all dots have in common however bright they are: least squares of one
 * intercept and a slope for each colour. */
static void
learn_ground (ClothDotColourModel * model, const ClothDot * dots, guint n_dots,
    const gint8 * colours)
{
  gfloat sums[CLOTH_DOT_COLOURS_MAX][5] = { {0} }, top[2] = { 0 };
  gfloat below = GROUND_PRIOR;

  for (guint i = 0; i < n_dots; i++) {
    const gint k = colours[i];
    const gfloat luma = dots[i].colour[0] - dots[i].background;
    gfloat det, chroma[2], noise;

    if (k < 0 || k >= model->n || !(luma > LEAST_LUMA))
      continue;
    noise = chroma_of (model, &dots[i], chroma);
    if (!(distance2 (&model->classes[k], chroma, noise, &det) < 9))
      continue;
    sums[k][0] += 1;
    sums[k][1] += luma;
    sums[k][2] += luma * luma;
    for (gint c = 0; c < 2; c++) {
      top[c] += dots[i].colour[1 + c] - 128;
      sums[k][3 + c] += luma * (dots[i].colour[1 + c] - 128);
    }
  }
  for (gint k = 0; k < model->n; k++) {
    if (sums[k][0] < 2)
      continue;
    below += sums[k][0] - sums[k][1] * sums[k][1] / sums[k][2];
  }
  for (gint c = 0; c < 2; c++) {
    for (gint k = 0; k < model->n; k++)
      if (sums[k][0] > 0)
        top[c] -= sums[k][1] / sums[k][2] * sums[k][3 + c];
    model->ground[c] += GROUND_RATE * (CLAMP (top[c] / below, -GROUND_MOST,
            GROUND_MOST) - model->ground[c]);
  }
}

/* @model: (inout): the model
 * @dots: (array length=n_dots): dots of a picture
 * @n_dots: how many
 * @colours: (array length=n_dots): which colour the label of each dot says it has; -1 for
 *   no label
 *
 * Learns from labelled dots, picture by picture: means and covariances of the colours
 * that forget slowly and that hardly heed dots far from the others, and what the ground
 * adds.
 */
void
cloth_dot_colour_model_learn (ClothDotColourModel * model,
    const ClothDot * dots, guint n_dots, const gint8 * colours)
{
  gfloat sums[CLOTH_DOT_COLOURS_MAX][6] = { {0} };

  learn_ground (model, dots, n_dots, colours);
  for (guint i = 0; i < n_dots; i++) {
    const gint k = colours[i];
    gfloat chroma[2], noise, weight, det, x, y, d2;

    if (k < 0 || k >= model->n)
      continue;
    noise = chroma_of (model, &dots[i], chroma);
    d2 = distance2 (&model->classes[k], chroma, noise, &det);
    if (!(d2 < G_MAXFLOAT))
      continue;
    weight = (FREEDOM + 2) / (FREEDOM + d2);
    x = chroma[0] - model->classes[k].mean[0];
    y = chroma[1] - model->classes[k].mean[1];
    sums[k][0] += weight;
    sums[k][1] += weight * x;
    sums[k][2] += weight * y;
    sums[k][3] += weight * (x * x - noise);
    sums[k][4] += weight * x * y;
    sums[k][5] += weight * (y * y - noise);
  }
  for (gint k = 0; k < model->n; k++) {
    ClothDotColourClass *class = &model->classes[k];
    const gfloat *s = sums[k], all = model->seen[k] + s[0];

    for (gint c = 0; c < 3; c++)
      class->cov[c] = (model->seen[k] * class->cov[c] + s[3 + c]) / all;
    keep_sound (class->cov);
    for (gint c = 0; c < 2; c++)
      class->mean[c] += s[1 + c] / all;
    model->seen[k] = MIN (all, REMEMBERED);
  }
}

/* --- the paper's way -------------------------------------------------------------------- */

/* Hue, 0 to 6, of chroma; luma has no part in it. */
static gfloat
hue_of (const ClothDotColourModel * model, gfloat cb, gfloat cr)
{
  const gfloat kr = model->kr, kb = model->kb;
  const gfloat r = 2 * (1 - kr) * cr, b = 2 * (1 - kb) * cb;
  const gfloat g = -(kr * r + kb * b) / (1 - kr - kb);
  const gfloat most = MAX (r, MAX (g, b)), least = MIN (r, MIN (g, b));
  const gfloat chroma = most - least;

  if (!(chroma > 0))
    return 0;
  if (most == r)
    return g >= b ? (g - b) / chroma : 6 + (g - b) / chroma;
  return most == g ? 2 + (b - r) / chroma : 4 + (r - g) / chroma;
}

static gint
nearest_hue (const gfloat * hues, gint n, gfloat hue)
{
  gfloat least = G_MAXFLOAT;
  gint best = 0;

  for (gint k = 0; k < n; k++) {
    const gfloat away = fabsf (hue - hues[k]);
    const gfloat round = MIN (away, 6 - away);

    if (round < least) {
      least = round;
      best = k;
    }
  }
  return best;
}

/* Pixels that vote: within this share of the ellipse. */
#define VOTES_WITHIN 0.8f

/* @model: the model; only the hues of its means count
 * @image: the picture
 * @dots: (array length=n_dots): its dots
 * @n_dots: how many
 * @log_likelihoods: (out caller-allocates): for each dot @model->n floats: the log share
 *   of its votes
 *
 * Classifies as Scholz et al. 2005, 4.1 do: every pixel inside a dot votes for the colour
 * whose hue is nearest to its own.
 */
void
cloth_dot_colour_model_vote (const ClothDotColourModel * model,
    const ClothPlanarImage * image, const ClothDot * dots, guint n_dots,
    gfloat * log_likelihoods)
{
  const gint width = image->luma.width, height = image->luma.height;
  gfloat hues[CLOTH_DOT_COLOURS_MAX];

  for (gint k = 0; k < model->n; k++)
    hues[k] = hue_of (model, model->classes[k].mean[0],
        model->classes[k].mean[1]);
  for (guint i = 0; i < n_dots; i++, log_likelihoods += model->n) {
    const ClothDot *dot = &dots[i];
    const gfloat *s = dot->shape, det = s[0] * s[2] - s[1] * s[1];
    const gfloat reach = 4 * VOTES_WITHIN * VOTES_WITHIN;
    const gfloat across = sqrtf (reach * s[0]), down = sqrtf (reach * s[2]);
    gfloat votes[CLOTH_DOT_COLOURS_MAX] = { 0 }, all = 0;

    if (det > 0 && image->chroma[0] && dot->x > -across && dot->y > -down
        && dot->x < (gfloat) width + across
        && dot->y < (gfloat) height + down && across < (gfloat) width
        && down < (gfloat) height) {
      const gint left = MAX (0, (gint) ceilf (dot->x - across));
      const gint right = MIN (width - 1, (gint) floorf (dot->x + across));
      const gint top = MAX (0, (gint) ceilf (dot->y - down));
      const gint bottom = MIN (height - 1, (gint) floorf (dot->y + down));

      for (gint y = top; y <= bottom; y++) {
        for (gint x = left; x <= right; x++) {
          const gfloat u = (gfloat) x - dot->x, v = (gfloat) y - dot->y;
          const gsize at = (gsize) (y >> image->chroma_shift[1])
              * (gsize) image->chroma_stride
              + (gsize) ((x >> image->chroma_shift[0]) * image->chroma_step);

          if (s[2] * u * u - 2 * s[1] * u * v + s[0] * v * v > reach * det)
            continue;
          votes[nearest_hue (hues, model->n, hue_of (model,
                      (gfloat) image->chroma[0][at] - 128,
                      (gfloat) image->chroma[1][at] - 128))] += 1;
          all += 1;
        }
      }
    }
    for (gint k = 0; k < model->n; k++)
      log_likelihoods[k] = logf ((votes[k] + 0.5f)
          / (all + 0.5f * (gfloat) model->n));
  }
}
