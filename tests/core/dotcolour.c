/* Colours of dots, against those that made-up dots were given.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/math/random.h"
#include "gst/vision/label/dot-colour.h"

#define COLOURS 5
#define N 600
/* ITU-R BT.709. */
#define KR 0.2126
#define KB 0.0722

static const guint8 print[COLOURS][3] = { {40, 165, 215}, {205, 40, 120},
{235, 215, 40}, {235, 120, 25}, {45, 160, 60}
};

/* What the camera makes of the print. */
typedef struct
{
  gdouble gains[3];             /* of red, green and blue */
  gdouble ground[2];            /* Cb and Cr of the ground */
  gdouble noise;                /* of the means, grey levels */
} Light;

static const Light studio = { {1, 1, 1}, {0, 0}, 1 };

/* Dots of random colours in light and shade. */
static void
film (const Light * light, ClothDot * dots, gint8 * colours, guint64 seed)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint i = 0; i < N; i++) {
    const guint c = cloth_random_below (&random, COLOURS);
    const gdouble shade = 0.25 + 0.6 * cloth_random_uniform (&random);
    gdouble rgb[3], luma;

    colours[i] = (gint8) c;
    for (gint k = 0; k < 3; k++)
      rgb[k] = shade * light->gains[k] * print[c][k];
    luma = KR * rgb[0] + (1 - KR - KB) * rgb[1] + KB * rgb[2];
    dots[i] = (ClothDot) {
      .background = 25,.colour = {
        (gfloat) (25 + luma + light->noise * cloth_random_gaussian (&random)),
        (gfloat) (128 + light->ground[0] + (rgb[2] - luma) / (2 * (1 - KB))
            + light->noise * cloth_random_gaussian (&random)),
        (gfloat) (128 + light->ground[1] + (rgb[0] - luma) / (2 * (1 - KR))
            + light->noise * cloth_random_gaussian (&random))
      }
    };
  }
}

static void
start (ClothDotColourModel * model)
{
  cloth_dot_colour_model_init (model, COLOURS, print, (gfloat) KR, (gfloat) KB);
}

static guint
best_of (const gfloat * likelihoods)
{
  guint best = 0;

  for (guint k = 1; k < COLOURS; k++)
    if (likelihoods[k] > likelihoods[best])
      best = k;
  return best;
}

/* Share of dots whose likeliest colour is theirs. */
static gdouble
share_right (const ClothDotColourModel * model, const ClothDot * dots,
    const gint8 * colours)
{
  g_autofree gfloat *likelihoods = g_new (gfloat, N * COLOURS);
  guint n = 0;

  cloth_dot_colour_model_classify (model, dots, N, likelihoods);
  for (guint i = 0; i < N; i++)
    n += best_of (likelihoods + i * COLOURS) == (guint) colours[i];
  g_test_message ("%.1f%% right", 100.0 * n / N);
  return (gdouble) n / N;
}

static void
test_print (void)
{
  ClothDotColourModel model;
  ClothDot dots[N];
  gint8 colours[N];

  start (&model);
  film (&studio, dots, colours, 1);
  g_assert_cmpfloat (share_right (&model, dots, colours), >, 0.995);
}

/* A change of light that the print does not allow for is found without labels. */
static void
test_adapt (void)
{
  static const Light lights[] = {
    {{1.6, 1, 0.7}, {0, 0}, 1}, {{0.65, 1, 1.6}, {0, 0}, 1},
    {{1.3, 1, 1.4}, {0, 0}, 1.5}
  };

  for (guint k = 0; k < G_N_ELEMENTS (lights); k++) {
    ClothDotColourModel model, chart;
    ClothDot dots[N];
    gint8 colours[N];

    start (&model);
    chart = model;
    film (&lights[k], dots, colours, k);
    g_assert_true (cloth_dot_colour_model_adapt (&model, dots, N));
    g_assert_cmpfloat (share_right (&model, dots, colours), >, 0.99);
    g_assert_cmpfloat (share_right (&model, dots, colours), >=,
        share_right (&chart, dots, colours));
  }
}

/* Prints that the description gives far paler or stronger than they are. */
static void
test_adapt_print (void)
{
  static const gdouble saturations[] = { 0.4, 0.6, 1.5, 2.5 };
  static const Light lights[] = {
    {{1, 1, 1}, {0, 0}, 1}, {{0.65, 1, 1.6}, {0, 0}, 1}
  };

  for (guint l = 0; l < G_N_ELEMENTS (lights); l++) {
    for (guint s = 0; s < G_N_ELEMENTS (saturations); s++) {
      guint8 described[COLOURS][3];
      ClothDotColourModel model;
      ClothDot dots[N];
      gint8 colours[N];

      for (gint c = 0; c < COLOURS; c++) {
        const gdouble luma = KR * print[c][0] + (1 - KR - KB) * print[c][1]
            + KB * print[c][2];

        for (gint k = 0; k < 3; k++)
          described[c][k] = (guint8) CLAMP (luma + (print[c][k] - luma)
              * saturations[s], 0, 255);
      }
      cloth_dot_colour_model_init (&model, COLOURS,
          (const guint8 (*)[3]) described, (gfloat) KR, (gfloat) KB);
      film (&lights[l], dots, colours, s);
      g_assert_true (cloth_dot_colour_model_adapt (&model, dots, N));
      g_assert_cmpfloat (share_right (&model, dots, colours), >, 0.99);
    }
  }
}

/* From labels, a twentieth of them wrong: the means are those of the truth, and dark dots
 * on tinted ground are told apart better than before. */
static void
test_learn (void)
{
  static const Light light = { {1.25, 1, 0.8}, {8, -6}, 1 };
  ClothDotColourModel model, before;
  ClothDot dots[N];
  gint8 colours[N];

  start (&model);
  before = model;
  for (guint picture = 0; picture < 40; picture++) {
    film (&light, dots, colours, picture);
    for (guint i = 0; i < N; i += 20)
      colours[i] = (gint8) ((colours[i] + 1) % COLOURS);
    for (guint i = 10; i < N; i += 20)
      colours[i] = -1;
    cloth_dot_colour_model_learn (&model, dots, N, colours);
  }
  for (gint c = 0; c < COLOURS; c++) {
    const gdouble r = 1.25 * print[c][0], g = print[c][1];
    const gdouble b = 0.8 * print[c][2];
    const gdouble luma = KR * r + (1 - KR - KB) * g + KB * b;

    g_assert_cmpfloat_with_epsilon (model.classes[c].mean[0],
        (b - luma) / (2 * (1 - KB) * luma), 0.03);
    g_assert_cmpfloat_with_epsilon (model.classes[c].mean[1],
        (r - luma) / (2 * (1 - KR) * luma), 0.03);
  }
  g_assert_cmpfloat_with_epsilon (model.ground[0], 8, 1.5);
  g_assert_cmpfloat_with_epsilon (model.ground[1], -6, 1.5);
  film (&light, dots, colours, 100);
  g_assert_cmpfloat (share_right (&model, dots, colours), >, 0.995);
  g_assert_cmpfloat (share_right (&model, dots, colours), >=,
      share_right (&before, dots, colours));
}

/* Every pixel votes by its hue: a picture of discs, half of whose pixels are grey. */
static void
test_vote (void)
{
  enum
  { SIZE = 40 };
  guint8 luma[SIZE * SIZE] = { 0 }, cb[SIZE * SIZE / 4], cr[SIZE * SIZE / 4];
  ClothDot dot = {.x = 20,.y = 20,.shape = {9, 0, 9} };
  const ClothPlanarImage image = {
    .luma = {luma, SIZE, SIZE, SIZE},.chroma = {cb, cr},.chroma_stride =
        SIZE / 2,.chroma_step = 1,.chroma_shift = {1, 1}
  };
  ClothDotColourModel model;

  start (&model);
  for (gint c = 0; c < COLOURS; c++) {
    const gdouble r = 0.4 * print[c][0], g = 0.4 * print[c][1];
    const gdouble b = 0.4 * print[c][2];
    const gdouble y = KR * r + (1 - KR - KB) * g + KB * b;
    gfloat likelihoods[COLOURS];

    for (gint k = 0; k < SIZE * SIZE / 4; k++) {
      cb[k] = (guint8) (128.5 + (b - y) / (2 * (1 - KB)));
      cr[k] = (guint8) (128.5 + (r - y) / (2 * (1 - KR)));
    }
    cloth_dot_colour_model_vote (&model, &image, &dot, 1, likelihoods);
    g_assert_cmpuint (best_of (likelihoods), ==, (guint) c);
    g_assert_cmpfloat (likelihoods[c], >, -0.2);
  }
}

/* --- what must not be believed -------------------------------------------------------- */

/* Few dots, grey ones, and such as lie nowhere near the print leave the model alone. */
static void
test_no_colours (void)
{
  ClothDotColourModel model, before;
  ClothDot dots[N];
  gint8 colours[N];
  ClothRandom random;

  start (&model);
  before = model;
  film (&studio, dots, colours, 1);
  g_assert_false (cloth_dot_colour_model_adapt (&model, dots, 20));
  g_assert_cmpmem (&model, sizeof model, &before, sizeof before);
  g_assert_false (cloth_dot_colour_model_adapt (&model, dots, 0));
  cloth_random_init (&random, 1);
  for (guint i = 0; i < N; i++)
    for (gint k = 1; k < 3; k++)
      dots[i].colour[k] = (gfloat) (255 * cloth_random_uniform (&random));
  g_assert_false (cloth_dot_colour_model_adapt (&model, dots, N));
  g_assert_cmpmem (&model, sizeof model, &before, sizeof before);
}

/* A dot that looks like none of the colours says little for any. */
static void
test_outlier (void)
{
  ClothDot dot = {.background = 20,.colour = {120, 240, 240} };
  ClothDotColourModel model;
  gfloat likelihoods[COLOURS], least = G_MAXFLOAT, most = -G_MAXFLOAT;

  start (&model);
  cloth_dot_colour_model_classify (&model, &dot, 1, likelihoods);
  for (gint k = 0; k < COLOURS; k++) {
    least = MIN (least, likelihoods[k]);
    most = MAX (most, likelihoods[k]);
  }
  g_assert_cmpfloat (most - least, <, 0.1);
}

/* No numbers: nothing is said, nothing learnt that is none. */
static void
test_no_numbers (void)
{
  static const gfloat bad[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f };
  ClothDotColourModel model;
  ClothDot dots[N];
  gint8 colours[N];
  gfloat likelihoods[N * COLOURS];

  start (&model);
  film (&studio, dots, colours, 1);
  for (guint k = 0; k < G_N_ELEMENTS (bad); k++) {
    for (gint c = 0; c < 3; c++)
      dots[20 * k + (guint) c].colour[c] = bad[k];
    dots[20 * k + 3].background = bad[k];
    colours[20 * k + 10] = 100;
  }
  cloth_dot_colour_model_classify (&model, dots, N, likelihoods);
  for (gint i = 0; i < N * COLOURS; i++)
    g_assert_true (isfinite (likelihoods[i]));
  cloth_dot_colour_model_learn (&model, dots, N, colours);
  cloth_dot_colour_model_adapt (&model, dots, N);
  for (gint k = 0; k < COLOURS; k++) {
    g_assert_true (isfinite (model.classes[k].mean[0]));
    g_assert_true (isfinite (model.classes[k].mean[1]));
    g_assert_cmpfloat (model.classes[k].cov[0] * model.classes[k].cov[2], >,
        model.classes[k].cov[1] * model.classes[k].cov[1]);
  }
  for (guint k = 0; k < G_N_ELEMENTS (bad); k++)
    g_assert_true (isfinite (model.ground[0]));
}

/* A grey picture has no votes, and dots outside it none either. */
static void
test_no_votes (void)
{
  guint8 luma[400] = { 0 }, chroma[400] = { 0 };
  const ClothPlanarImage grey = {.luma = {luma, 20, 20, 20} };
  const ClothPlanarImage small = {
    .luma = {luma, 20, 20, 20},.chroma = {chroma, chroma},.chroma_stride =
        20,.chroma_step = 1
  };
  const ClothDot dots[] = { {.x = 10,.y = 10,.shape = {4, 0, 4}},
  {.x = -500,.y = 10,.shape = {4, 0, 4}},
  {.x = 10,.y = 1e9f,.shape = {4, 0, 4}},
  {.x = NAN,.y = 10,.shape = {4, 0, 4}},
  {.x = 10,.y = 10,.shape = {NAN, 0, 4}},
  {.x = 10,.y = 10,.shape = {1e9f, 0, 1e9f}}
  };
  ClothDotColourModel model;
  gfloat likelihoods[G_N_ELEMENTS (dots) * COLOURS];

  start (&model);
  for (gint round = 0; round < 2; round++) {
    cloth_dot_colour_model_vote (&model, round ? &small : &grey, dots,
        G_N_ELEMENTS (dots), likelihoods);
    for (guint i = round ? COLOURS : 0; i < G_N_ELEMENTS (dots) * COLOURS; i++)
      g_assert_cmpfloat_with_epsilon (likelihoods[i], log (1.0 / COLOURS),
          1e-5);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/dot-colour/print", test_print);
  g_test_add_func ("/dot-colour/adapt", test_adapt);
  g_test_add_func ("/dot-colour/adapt-print", test_adapt_print);
  g_test_add_func ("/dot-colour/learn", test_learn);
  g_test_add_func ("/dot-colour/vote", test_vote);
  g_test_add_func ("/dot-colour/no-colours", test_no_colours);
  g_test_add_func ("/dot-colour/outlier", test_outlier);
  g_test_add_func ("/dot-colour/no-numbers", test_no_numbers);
  g_test_add_func ("/dot-colour/no-votes", test_no_votes);
  return g_test_run ();
}
