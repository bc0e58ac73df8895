/* How true fitted numbers are: sheets of drawn numbers, on a mesh twice as fine or as it is, with half the step,
 * filmed by three cameras that each miss a part, are fitted from rays alone.
 *
 *   bench-fit [CASES [FINER [FIRST]]]     12 cases, and reality's mesh twice as fine; 1: the model's own;
 *                                         the first case's number, 1
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gst/fit/synthesis/synthesis.h"
#include "gst/math/random.h"
#include "gst/math/statistics.h"
#include "tests/common/gapfilm.h"
#include "tests/common/gaprecord.h"

#define LANES(name) extern const ClothEffect cloth_effect_##name;
#define SCENE(name) LANES (name)
#include "gst/effect/list.h"

#define COLUMNS 9
#define ROWS 10
#define N (COLUMNS * ROWS)
#define N_FRAMES 100
#define FPS 50.

static const gdouble middle[3] = { 0.15, 0., -0.2 };

static const struct
{
  const gchar *name;
  gdouble usual;
} numbers[] = {
  {"stretch.warp", 120.}, {"stretch.weft", 120.}, {"shear", 30.},
  {"bending.warp", 3e-5}, {"bending.weft", 3e-5}, {"damping.mass", 0.4},
  {"damping.stiffness", 1e-3}
};

#define N_NUMBERS G_N_ELEMENTS (numbers)

static guint64 seed;

static void
sway (guint held, gdouble t, gfloat p[3])
{
  const gdouble w = 6. + 0.4 * (gdouble) (seed % 6);

  p[0] = (gfloat) ((held ? 0.3 : 0.) + 0.015 * sin ((4. + seed % 3) * t));
  p[1] = (gfloat) (0.06 * (1. - cos (w * t)));
  p[2] = (gfloat) (0.03 * sin ((w + 2. + held) * t));
}

static gboolean
hide_some (guint camera, guint vertex, guint frame)
{
  return (vertex / 9 + 3 * camera + frame / 10 + (guint) seed) % 5 == 0;
}

int
main (int argc, char **argv)
{
  const guint64 n_cases = argc > 1 ? strtoull (argv[1], NULL, 10) : 12;
  const gdouble finer[1] = { argc > 2 ? atof (argv[2]) : 2. };
  const guint64 first = argc > 3 ? strtoull (argv[3], NULL, 10) : 1;
  const gdouble shorter[1] = { 0.5 };
  /* as the model's mesh has the numbers, and as one twice as fine */
  g_autofree gdouble *memory = g_new (gdouble, 2 * n_cases * N_NUMBERS);
  gdouble *errors[2] = { memory, memory + n_cases * N_NUMBERS };
  guint held[2][N_NUMBERS] = { {0} }, all[2] = { 0 };
  gdouble before = 0., after = 0.;

  for (seed = first; seed < first + n_cases; seed++) {
    const TestGapSheet sheet = { COLUMNS, ROWS, N_FRAMES, 0.3, 0.34, FPS };
    const TestGapFilming filming = { 3, 0.3, hide_some };
    g_autofree gchar *parent = g_dir_make_tmp ("cloth-fit-XXXXXX", NULL);
    g_autoptr (ClothModel) reality = cloth_model_new ();
    g_autoptr (ClothModel) model = cloth_model_new ();
    g_autoptr (ClothRig) rig = test_gap_ring (3, middle);
    g_autoptr (ClothSynthesis) fitted = NULL;
    g_autoptr (GError) error = NULL;
    g_autofree gdouble *truth = NULL;
    ClothObservations *observations;
    ClothSynthesisOptions options;
    ClothSynthesisInput input;
    ClothTake *whole, *take;
    ClothRandom random;
    gdouble times[N_FRAMES];

    cloth_random_init (&random, seed);
    reality->areal_density = model->areal_density = 0.2;
    for (guint i = 0; i < N_NUMBERS; i++) {
      /* within a factor of two of the usual */
      cloth_model_set (reality, numbers[i].name, numbers[i].usual *
          exp2 (2. * cloth_random_uniform (&random) - 1.), NULL);
      cloth_model_set (model, numbers[i].name, numbers[i].usual, NULL);
    }
    cloth_model_set_effect (reality, &cloth_effect_mesh_resolution, finer);
    cloth_model_set_effect (reality, &cloth_effect_time_step, shorter);
    test_gap_free_parameters (model);
    whole = test_gap_record (&sheet, reality, sway, parent, "take", 1);
    truth = test_gap_positions (whole);
    for (guint f = 0; f < N_FRAMES; f++)
      times[f] = f / FPS;
    observations = test_gap_film (rig, rig, truth, times, N_FRAMES, N,
        &filming, seed);
    take = test_gap_forget_positions (whole, TRUE);
    cloth_synthesis_options_init (&options);
    input = (ClothSynthesisInput) {
    take, observations};
    fitted = cloth_synthesis_fit (&input, 1, model, &options, &error);
    g_assert_no_error (error);
    before += fitted->takes[0].before.windows;
    after += fitted->takes[0].after.windows;
    for (guint i = 0; i < fitted->numbers->len; i++) {
      const ClothSynthesisNumber *n =
          &g_array_index (fitted->numbers, ClothSynthesisNumber, i);

      for (guint k = 0; k < N_NUMBERS; k++) {
        gdouble value;

        if (strcmp (numbers[k].name, n->name))
          continue;
        cloth_model_get (reality, n->name, &value, NULL);
        errors[0][k * n_cases + seed - first] = fabs (log (n->value / value));
        errors[1][k * n_cases + seed - first] = fabs (log (n->finer / value));
        held[0][k] += fabs (log (n->value / value)) <
            1.96 * n->sigma / n->value;
        held[1][k] += fabs (log (n->finer / value)) <
            1.96 * n->finer_sigma / n->finer;
      }
    }
    cloth_take_free (take);
    cloth_take_free (whole);
    cloth_observations_free (observations);
    test_gap_remove (parent);
  }
  for (guint k = 0; k < N_NUMBERS; k++) {
    printf ("%-20s of the mesh: median error %5.1f%%, 95%% intervals hold %2u "
        "of %u; of one twice as fine: %5.1f%%, %2u\n", numbers[k].name,
        100. * cloth_median (errors[0] + k * n_cases, n_cases), held[0][k],
        (guint) n_cases, 100. * cloth_median (errors[1] + k * n_cases, n_cases),
        held[1][k]);
    for (guint i = 0; i < 2; i++)
      all[i] += held[i][k];
  }
  printf
      ("all: 95%% intervals hold %.0f%%, of the finer mesh %.0f%%; gap in "
      "windows %.2f mm before, %.2f fitted\n",
      100. * all[0] / (n_cases * N_NUMBERS),
      100. * all[1] / (n_cases * N_NUMBERS), 1e3 * before / n_cases,
      1e3 * after / n_cases);
  return 0;
}
