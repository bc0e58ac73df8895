/* Labels of dots: the likelihood of patches against the paper's seeds and regions, on
 * eight views of a waving cloth with colours that are wrong more and more often.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/math/random.h"
#include "gst/pattern/marray.h"
#include "gst/vision/label/dot-colour.h"
#include "gst/vision/label/dot-label.h"
#include "tests/bench/clock.h"

#define COLUMNS 31
#define ROWS 33
#define N (COLUMNS * ROWS)
#define COLOURS 5
#define VIEWS 8
#define PICTURES 25
#define REPEATS 5

static const guint8 print[COLOURS][3] = { {40, 165, 215}, {205, 40, 120},
{235, 215, 40}, {235, 120, 25}, {45, 160, 60}
};

static guint8 matrix[N];

typedef struct
{
  guint n;
  ClothDot dots[N];
  gint labels[N];
} Picture;

/* A point of the cloth in a view, px: waves run over it. */
static void
project (gint view, gint picture, gdouble u, gdouble v, gdouble at[2])
{
  const gdouble angle = G_PI * view / VIEWS, t = 0.25 * picture;
  const gdouble x = u - 0.31, y = v - 0.33;
  const gdouble z = 0.02 * sin (14 * x + 5 * y + t)
      + 0.012 * sin (9 * y - 0.7 * t);
  const gdouble side = cos (angle) * x + sin (angle) * z;
  const gdouble depth = 2 - sin (angle) * x + cos (angle) * z;

  at[0] = 502 + 1534 * side / depth;
  at[1] = 502 + 1534 * y / depth;
}

/* Dots that are seen at less than 70 degrees or so. */
static void
film (gint view, gint number, gdouble errors, Picture * picture,
    ClothRandom * random)
{
  const gdouble h = 0.0065;

  picture->n = 0;
  for (gint k = 0; k < N; k++) {
    const gdouble u = 0.02 * (k % COLUMNS), v = 0.02 * (k / COLUMNS);
    gdouble at[2], p[2], q[2], a[2], b[2], area;
    ClothDot *dot = &picture->dots[picture->n];
    guint c = matrix[k];
    gdouble rgb[3], luma, shade;

    project (view, number, u, v, at);
    project (view, number, u - h, v, p);
    project (view, number, u + h, v, q);
    a[0] = (q[0] - p[0]) / 2, a[1] = (q[1] - p[1]) / 2;
    project (view, number, u, v - h, p);
    project (view, number, u, v + h, q);
    b[0] = (q[0] - p[0]) / 2, b[1] = (q[1] - p[1]) / 2;
    area = a[0] * b[1] - a[1] * b[0];
    if (fabs (area) < 0.34 * pow (1534 * h / 2, 2))
      continue;
    if (cloth_random_uniform (random) < errors)
      c = (c + 1 + cloth_random_below (random, COLOURS - 1)) % COLOURS;
    shade = 0.4 + 0.5 * fabs (area) / pow (1534 * h / 2, 2);
    for (gint i = 0; i < 3; i++)
      rgb[i] = shade * print[c][i];
    luma = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    *dot = (ClothDot) {
      .x = (gfloat) (at[0] + 0.05 * cloth_random_gaussian (random)),.y =
          (gfloat) (at[1] + 0.05 * cloth_random_gaussian (random)),.shape = {
        (gfloat) ((a[0] * a[0] + b[0] * b[0]) / 4 + 0.4),
        (gfloat) ((a[0] * a[1] + b[0] * b[1]) / 4),
        (gfloat) ((a[1] * a[1] + b[1] * b[1]) / 4 + 0.4)
      },.background = 25,.colour = {
        (gfloat) (25 + luma + cloth_random_gaussian (random)),
        (gfloat) (128 + (rgb[2] - luma) / 1.8556
            + cloth_random_gaussian (random)),
        (gfloat) (128 + (rgb[0] - luma) / 1.5748
            + cloth_random_gaussian (random))
      }
    };
    picture->labels[picture->n++] = k;
  }
}

static gboolean
run (gdouble errors, gboolean paper)
{
  ClothDotLabelParams params = cloth_dot_label_default_params ();
  g_autofree Picture *picture = g_new (Picture, 1);
  g_autofree gfloat *likelihoods = g_new (gfloat, N * COLOURS);
  ClothDotLabeller *labellers[REPEATS];
  ClothDotColourModel model;
  guint right = 0, wrong = 0, all = 0;
  gdouble labelling = 0, classifying = 0;

  params.paper = paper;
  cloth_dot_colour_model_init (&model, COLOURS, print, 0.2126f, 0.0722f);
  for (gint view = 0; view < VIEWS; view++) {
    ClothRandom random;

    cloth_random_init (&random, (guint64) view);
    for (gint i = 0; i < REPEATS; i++)
      if (!(labellers[i] = cloth_dot_labeller_new (COLUMNS, ROWS, COLOURS,
                  matrix, NULL)))
        return FALSE;
    for (gint number = 0; number < PICTURES; number++) {
      gdouble least[2] = { G_MAXDOUBLE, G_MAXDOUBLE };
      const ClothDotLabel *labels;
      guint n;

      film (view, number, errors, picture, &random);
      for (gint i = 0; i < REPEATS; i++) {
        const gdouble start = cpu_ms ();
        gdouble middle;

        cloth_dot_colour_model_classify (&model, picture->dots, picture->n,
            likelihoods);
        middle = cpu_ms ();
        cloth_dot_labeller_run (labellers[i], &params, picture->dots,
            picture->n, likelihoods);
        least[0] = MIN (least[0], middle - start);
        least[1] = MIN (least[1], cpu_ms () - middle);
      }
      classifying += least[0];
      labelling += least[1];
      labels = cloth_dot_labeller_get_labels (labellers[0], &n);
      all += n;
      for (guint i = 0; i < n; i++) {
        const gboolean is_right = labels[i].row * COLUMNS + labels[i].column
            == picture->labels[i];

        right += labels[i].column >= 0 && is_right;
        wrong += labels[i].column >= 0 && !is_right;
      }
    }
    for (gint i = 0; i < REPEATS; i++)
      cloth_dot_labeller_free (labellers[i]);
  }
  g_print ("  %-11s %6.2f%% labelled, %6.2f%% of them right; colours %.3f ms, "
      "labels %.3f ms a picture of %u dots\n",
      paper ? "the paper's" : "patches", 100.0 * (right + wrong) / all,
      100.0 * right / MAX (1, right + wrong),
      classifying / (VIEWS * PICTURES),
      labelling / (VIEWS * PICTURES), all / (VIEWS * PICTURES));
  return TRUE;
}

int
main (void)
{
  static const gdouble errors[] = { 0, 0.05, 0.1, 0.2, 0.3 };
  ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;

  code.two_sided = TRUE;
  if (!cloth_m_array_generate (COLUMNS, ROWS, COLOURS, &code, matrix, NULL))
    return 1;
  for (guint k = 0; k < G_N_ELEMENTS (errors); k++) {
    g_print ("%.0f%% of the colours wrong:\n", 100 * errors[k]);
    if (!run (errors[k], FALSE) || !run (errors[k], TRUE))
      return 1;
  }
  return 0;
}
