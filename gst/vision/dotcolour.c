/* Colours of dots: Gaussian classes of chroma over brightness, with room for outliers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dotcolour.h"

#include <math.h>
#include <string.h>

/* How far a camera shows a printed colour from where it should be, each way, as a share
 * of its distance from grey plus one. */
#define PRINT_SPREAD 0.07f
/* What a class keeps of that as spread from dot to dot once it has been learnt. */
#define LEAST_SPREAD 0.01f
/* Spread of the least brightness that still tells a colour, grey levels. */
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
  }
}

/**
 * cloth_dot_colour_model_init:
 * @model: (out caller-allocates): the model
 * @n: number of colours, 2 to %CLOTH_DOT_COLOURS_MAX
 * @rgb: (array length=n): how each is printed, 0 to 255 (sRGB)
 * @kr: share of red in the pictures' luma: 0.2126 for BT.709, 0.299 for BT.601
 * @kb: share of blue in the pictures' luma: 0.0722 for BT.709, 0.114 for BT.601
 *
 * Expects the colours as they are printed. With cloth_dot_colour_model_adapt() and
 * cloth_dot_colour_model_learn() it becomes what a camera sees.
 *
 * Since: 0.1
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

/**
 * cloth_dot_colour_model_init_patches:
 * @model: (out caller-allocates): the model
 * @n: number of colours, 2 to %CLOTH_DOT_COLOURS_MAX
 * @ycbcr: (array length=n): mean luma, Cb and Cr of each colour on a test chart, grey
 *   levels
 * @ground: mean luma, Cb and Cr of the black next to them
 * @kr: as for cloth_dot_colour_model_init()
 * @kb: as for cloth_dot_colour_model_init()
 *
 * Expects the colours as the camera sees them on a chart.
 *
 * Since: 0.1
 */
void
cloth_dot_colour_model_init_patches (ClothDotColourModel * model, gint n,
    const gfloat (*ycbcr)[3], const gfloat ground[3], gfloat kr, gfloat kb)
{
  memset (model, 0, sizeof *model);
  model->kr = kr;
  model->kb = kb;
  for (gint i = 0; i < 2; i++)
    model->ground[i] = ground[1 + i] - 128;
  for (gint k = 0; k < CLAMP (n, 2, CLOTH_DOT_COLOURS_MAX); k++)
    for (gint i = 0; i < 2; i++)
      model->classes[k].mean[i] = (ycbcr[k][1 + i] - ground[1 + i])
          / MAX (LEAST_LUMA, ycbcr[k][0] - ground[0]);
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

/* Density of a class at @chroma. */
static gfloat
density (const ClothDotColourClass * class, const gfloat chroma[2],
    gfloat noise)
{
  const gfloat a = class->cov[0] + noise, b = class->cov[1];
  const gfloat c = class->cov[2] + noise, det = a * c - b * b;
  const gfloat x = chroma[0] - class->mean[0], y = chroma[1] - class->mean[1];
  const gfloat d2 = (c * x * x - 2 * b * x * y + a * y * y) / det;

  return expf (-0.5f * d2) / (2 * (gfloat) G_PI * sqrtf (det));
}

/**
 * cloth_dot_colour_model_classify:
 * @model: the model
 * @dots: (array length=n_dots): dots
 * @n_dots: how many
 * @log_likelihoods: (out caller-allocates): for each dot @model->n floats: the log
 *   density of its chroma over brightness if it has that colour. Outliers are part of
 *   each, so that a dot that looks like none of them tells nothing
 *
 * Since: 0.1
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
