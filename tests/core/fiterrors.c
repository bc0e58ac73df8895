/* How far off fitted numbers are said to be, held against numbers that are known: sheets are simulated with
 * drawn ones, on the model's mesh and on one twice as fine, and fitted.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "gst/fit/error.h"
#include "gst/fit/synthesis/synthesis.h"
#include "gst/math/random.h"
#include "tests/common/gaprecord.h"

#define N_CASES 3
#define N_NUMBERS 7
#define NOISE_M 2e-4

static const gdouble halved = 2.;
static const gdouble usual[N_NUMBERS] =
    { 120., 120., 30., 3e-5, 3e-5, 0.4, 1e-3 };
static const gchar *const names[N_NUMBERS] =
    { "stretch.warp", "stretch.weft", "shear", "bending.warp", "bending.weft",
  "damping.mass", "damping.stiffness"
};

static void
sway (guint held, gdouble t, gfloat p[3])
{
  p[0] = (gfloat) ((held ? 0.3 : 0.) + 0.015 * sin (5. * t));
  p[1] = (gfloat) (0.06 * (1. - cos (7. * t)));
  p[2] = (gfloat) (0.03 * sin ((9. + held) * t));
}

static ClothModel *
model_new (void)
{
  ClothModel *model = cloth_model_new ();

  model->areal_density = 0.2;
  for (guint i = 0; i < N_NUMBERS; i++)
    g_assert_true (cloth_model_set (model, names[i], usual[i], NULL));
  return model;
}

/* Within a factor of two of the usual. */
static ClothModel *
draw_reality (guint seed, gboolean is_finer)
{
  ClothModel *reality = model_new ();
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint i = 0; i < N_NUMBERS; i++)
    g_assert_true (cloth_model_set (reality, names[i], usual[i] *
            exp2 (2. * cloth_random_uniform (&random) - 1.), NULL));
  if (is_finer)
    cloth_model_set_effect (reality, cloth_effect_find ("mesh_resolution"),
        &halved);
  return reality;
}

static ClothModel *
free_model (void)
{
  ClothModel *model = model_new ();

  for (guint i = 0; i < N_NUMBERS; i++) {
    const ClothModelFree number = { g_strdup (names[i]),
      {usual[i] / 10., usual[i] * 10.}
    };

    g_array_append_val (model->free, number);
  }
  return model;
}

static ClothSynthesis *
fit (const ClothModel * reality, const ClothModel * model, guint seed,
    guint n_frames, gdouble noise_m, const ClothSynthesisOptions * options,
    GError ** error)
{
  const TestGapSheet sheet = { 9, 10, n_frames, 0.3, 0.34, 50., noise_m };
  g_autofree gchar *folder = g_dir_make_tmp ("cloth-errors-XXXXXX", NULL);
  g_autoptr (ClothTake) take =
      test_gap_record (&sheet, reality, sway, folder, "take", seed);
  const ClothSynthesisInput input = { take };
  ClothSynthesis *fitted = cloth_synthesis_fit (&input, 1, model, options,
      error);

  test_gap_remove (folder);
  return fitted;
}

static const ClothSynthesisNumber *
number_of (const ClothSynthesis * s, guint i)
{
  const ClothSynthesisNumber *n = &g_array_index (s->numbers,
      ClothSynthesisNumber, i);

  g_assert_cmpstr (n->name, ==, names[i]);
  return n;
}

/* Counts intervals that hold the truth, and adds up how far off numbers are. */
static void
count (gboolean is_finer, guint held[2], gdouble off[2], gdouble widths[2])
{
  g_autoptr (ClothModel) model = free_model ();
  ClothSynthesisOptions options;

  cloth_synthesis_options_init (&options);
  for (guint seed = 1; seed <= N_CASES; seed++) {
    g_autoptr (ClothModel) reality = draw_reality (seed, is_finer);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothSynthesis) s =
        fit (reality, model, seed, 100, NOISE_M, &options, &error);

    g_assert_no_error (error);
    for (guint i = 0; i < N_NUMBERS; i++) {
      const ClothSynthesisNumber *n = number_of (s, i);
      const gdouble values[2] = { n->value, n->finer };
      const gdouble sigmas[2] = { n->sigma, n->finer_sigma };
      gdouble truth;

      cloth_model_get (reality, names[i], &truth, NULL);
      g_test_message ("%s %g: %.4g ± %.2g, finer %.4g ± %.2g", names[i],
          truth, n->value, n->sigma, n->finer, n->finer_sigma);
      for (guint k = 0; k < 2; k++) {
        held[k] += fabs (log (values[k] / truth)) <
            1.96 * sigmas[k] / values[k];
        off[k] += fabs (log (values[k] / truth)) / (N_CASES * N_NUMBERS);
        widths[k] += sigmas[k] / values[k] / (N_CASES * N_NUMBERS);
      }
    }
  }
  g_test_message ("mesh%s: of the mesh %u of %u held, off by %.3f, sigma %.3f; "
      "of a finer one %u, off by %.3f, sigma %.3f", is_finer ? " finer" : "",
      held[0], N_CASES * N_NUMBERS, off[0], widths[0], held[1], off[1],
      widths[1]);
}

/* Of 21 intervals of 95% fewer than 17 hold once in 300 times. */
static void
test_same (void)
{
  guint held[2] = { 0 };
  gdouble off[2] = { 0. }, widths[2] = { 0. };

  count (FALSE, held, off, widths);
  g_assert_cmpuint (held[0], >=, 17);
  /* and they say something: the mean of |x| is 0.8 σ */
  g_assert_cmpfloat (widths[0], <, 4. * off[0]);
  g_assert_cmpfloat (off[0], <, 0.1);
}

/* What follows a finer mesh has other numbers; those said to be the finer mesh's are the cloth's. */
static void
test_finer (void)
{
  guint held[2] = { 0 };
  gdouble off[2] = { 0. }, widths[2] = { 0. };

  count (TRUE, held, off, widths);
  g_assert_cmpuint (held[1], >=, 17);
  g_assert_cmpuint (held[0], <, 12);
  g_assert_cmpfloat (off[1], <, 0.5 * off[0]);
}

/* The same for any number of threads. */
static void
test_threads (void)
{
  g_autoptr (ClothModel) model = free_model ();
  g_autoptr (ClothModel) reality = draw_reality (1, FALSE);
  ClothSynthesisOptions options;
  ClothSynthesis *fitted[2];

  cloth_synthesis_options_init (&options);
  for (guint k = 0; k < 2; k++) {
    g_autoptr (GError) error = NULL;

    options.rollout.threads = k ? 3 : 1;
    fitted[k] = fit (reality, model, 1, 30, NOISE_M, &options, &error);
    g_assert_no_error (error);
  }
  for (guint i = 0; i < N_NUMBERS; i++) {
    const ClothSynthesisNumber *a = number_of (fitted[0], i);
    const ClothSynthesisNumber *b = number_of (fitted[1], i);

    g_assert_cmpfloat (a->sigma, ==, b->sigma);
    g_assert_cmpfloat (a->finer, ==, b->finer);
    g_assert_cmpfloat (a->finer_sigma, ==, b->finer_sigma);
  }
  for (guint k = 0; k < 2; k++)
    cloth_synthesis_free (fitted[k]);
}

/* A model that says how fine its mesh is has no other. */
static void
test_fine_already (void)
{
  g_autoptr (ClothModel) model = free_model ();
  g_autoptr (ClothModel) reality = draw_reality (1, TRUE);
  g_autoptr (ClothSynthesis) s = NULL;
  g_autoptr (GError) error = NULL;
  ClothSynthesisOptions options;

  cloth_synthesis_options_init (&options);
  cloth_model_set_effect (model, cloth_effect_find ("mesh_resolution"),
      &halved);
  s = fit (reality, model, 1, 30, NOISE_M, &options, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < N_NUMBERS; i++) {
    g_assert_true (number_of (s, i)->sigma > 0.);
    g_assert_true (isnan (number_of (s, i)->finer));
    g_assert_true (isnan (number_of (s, i)->finer_sigma));
  }
}

/* A recording says nothing of the friction on obstacles that are not there: it is as open as its range has it. */
static void
test_unknown (void)
{
  static const gchar *const name = "effects.friction.coefficient";
  const ClothModelFree friction = { g_strdup (name), {0., 1.} };
  const gdouble values[2] = { 0.3, -1000. };    /* and no floor */
  g_autoptr (ClothModel) model = free_model ();
  g_autoptr (ClothModel) reality = draw_reality (1, FALSE);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSynthesis) s = NULL;
  const ClothSynthesisNumber *n;
  ClothSynthesisOptions options;

  cloth_synthesis_options_init (&options);
  cloth_model_set_effect (model, cloth_effect_find ("friction"), values);
  g_array_append_val (model->free, friction);
  s = fit (reality, model, 1, 30, NOISE_M, &options, &error);
  g_assert_no_error (error);
  n = &g_array_index (s->numbers, ClothSynthesisNumber, N_NUMBERS);
  g_assert_cmpstr (n->name, ==, name);
  g_test_message ("%s: %.3g ± %.3g, finer %.3g ± %.3g", n->name, n->value,
      n->sigma, n->finer, n->finer_sigma);
  g_assert_cmpfloat (n->value, ==, values[0]);
  g_assert_cmpfloat (n->sigma, >, 0.1);
  g_assert_cmpfloat (n->finer_sigma, >=, n->sigma);
}

/* A recording that is hardly longer than imitations are drawn is fitted, and no more is said. */
static void
test_short (void)
{
  g_autoptr (ClothModel) model = free_model ();
  g_autoptr (ClothModel) reality = draw_reality (1, FALSE);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSynthesis) s = NULL;
  ClothSynthesisOptions options;

  cloth_synthesis_options_init (&options);
  s = fit (reality, model, 1, 9, NOISE_M, &options, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < N_NUMBERS; i++) {
    g_assert_true (isfinite (number_of (s, i)->value));
    g_assert_true (isnan (number_of (s, i)->sigma));
    g_assert_true (isnan (number_of (s, i)->finer));
  }
}

typedef struct
{
  guint left;
} Patience;

static gboolean
lose_patience (gpointer data, gdouble share)
{
  Patience *patience = data;

  return patience->left == 0 || --patience->left > 0;
}

/* It can be stopped at any time. */
static void
test_stopped (void)
{
  g_autoptr (ClothModel) model = free_model ();
  g_autoptr (ClothModel) reality = draw_reality (1, FALSE);
  Patience patience = { 0 };
  ClothSynthesisOptions options;

  cloth_synthesis_options_init (&options);
  options.rollout.progress = lose_patience;
  options.rollout.data = &patience;
  for (guint after = 1; after < 20000; after *= 5) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothSynthesis) s = NULL;

    patience.left = after;
    s = fit (reality, model, 1, 30, NOISE_M, &options, &error);
    if (s) {
      g_assert_cmpuint (after, >, 500);
      break;
    }
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/fiterrors/same", test_same);
  g_test_add_func ("/fiterrors/finer", test_finer);
  g_test_add_func ("/fiterrors/threads", test_threads);
  g_test_add_func ("/fiterrors/fine-already", test_fine_already);
  g_test_add_func ("/fiterrors/unknown", test_unknown);
  g_test_add_func ("/fiterrors/short", test_short);
  g_test_add_func ("/fiterrors/stopped", test_stopped);
  return g_test_run ();
}
