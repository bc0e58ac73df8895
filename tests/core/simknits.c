/* Real knits: measured loading curves against strips of the simulator whose stretch
 * stiffens beyond a knee. What is measured is in tests/data/knits.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#include "tests/common/npyfloats.h"

#define N_FABRICS 16
#define N_PULLS 5
#define N_POINTS 60
#define COLUMNS 3
#define ROWS 41

static const gchar *const names[N_FABRICS] = {
  "acrylic garter x", "acrylic garter y", "acrylic rib x", "acrylic rib y",
  "acrylic seed x", "acrylic seed y", "acrylic stockinette x",
  "acrylic stockinette y", "cotton garter x", "cotton garter y",
  "cotton rib x", "cotton rib y", "cotton seed x", "cotton seed y",
  "cotton stockinette x", "cotton stockinette y"
};

typedef struct
{
  gfloat stretch[N_POINTS];
  gfloat pulls[N_PULLS][N_POINTS];
} Curves;

/* Force of a strip one metre wide over its stretch λ: λ (c E + c r max (E − knee, 0)) with
 * Green's strain E = (λ² − 1)/2. */
typedef struct
{
  gdouble stiffness, ratio, knee, residual;
} Law;

static Curves *
read_curves (void)
{
  g_autoptr (GError) error = NULL;
  ClothNpyInfo info;
  gfloat *items = load_npy_floats (TEST_DATA "/knits/curves.npy", &info,
      &error);

  g_assert_no_error (error);
  g_assert_cmpuint (info.shape[0], ==, N_FABRICS);
  g_assert_cmpuint (info.row_items * sizeof *items, ==, sizeof (Curves));
  return (Curves *) items;
}

static gdouble
mean_of_later (const Curves * curves, guint point)
{
  gdouble sum = 0.;

  for (guint pull = 1; pull < N_PULLS; pull++)
    sum += curves->pulls[pull][point];
  return sum / (N_PULLS - 1);
}

/* Standard deviation from pull to pull, RMS over the curve. */
static gdouble
scatter (const Curves * curves, guint first_pull)
{
  gdouble sum = 0.;
  guint n = N_PULLS - first_pull;

  for (guint i = 0; i < N_POINTS; i++) {
    gdouble mean = 0.;

    for (guint pull = first_pull; pull < N_PULLS; pull++)
      mean += curves->pulls[pull][i] / n;
    for (guint pull = first_pull; pull < N_PULLS; pull++)
      sum += (curves->pulls[pull][i] - mean) *
          (curves->pulls[pull][i] - mean) / (n - 1);
  }
  return sqrt (sum / N_POINTS);
}

static gdouble
green (gdouble stretch)
{
  return 0.5 * (stretch * stretch - 1.);
}

/* Least squares for both stiffnesses at each of a row of knees. Without @biphasic one
 * stiffness. */
static Law
fit (const Curves * curves, gboolean biphasic)
{
  gdouble most = green (curves->stretch[N_POINTS - 1]);
  Law best = { 0., 0., 0., INFINITY };

  for (guint at = 0; at < (biphasic ? 200 : 1); at++) {
    Law law = { 0., 0., biphasic ? 0.98 * most * at / 199. : most, 0. };
    gdouble aa = 0., ab = 0., bb = 0., af = 0., bf = 0., det, sum = 0.;

    for (guint side = 0; side < 2; side++) {
      for (guint i = 0; i < N_POINTS; i++) {
        gdouble stretch = curves->stretch[i], force = mean_of_later (curves, i);
        gdouble a = stretch * green (stretch);
        gdouble b = stretch * MAX (green (stretch) - law.knee, 0.);
        gdouble error = law.stiffness * (a + law.ratio * b) - force;

        aa += a * a, ab += a * b, bb += b * b, af += a * force, bf += b * force;
        sum += side ? error * error : 0.;
      }
      det = aa * bb - ab * ab;
      if (side)
        law.residual = sqrt (sum / N_POINTS);
      else if (det > 1e-9 * aa * bb) {
        law.stiffness = (af * bb - bf * ab) / det;
        law.ratio = (bf * aa - af * ab) / det / law.stiffness;
      } else
        law.stiffness = af / aa;
    }
    if (law.stiffness > 0. && law.residual < best.residual)
      best = law;
  }
  return best;
}

/* Strips hung by their upper edge, as heavy as the greatest force: statics says the force
 * at every depth, the simulator the stretch there. So one strip samples the whole curve. */
static gdouble *
hang (const Law * laws, const Curves * curves)
{
  g_autoptr (ClothScene) scene = sheet_new (COLUMNS, ROWS, 0.05, 1.);
  g_autoptr (ClothSim) sim = NULL;
  g_autoptr (GError) error = NULL;
  ClothModel *models[N_FABRICS];
  gdouble *stretch = g_new (gdouble, N_FABRICS * (ROWS - 1));

  for (guint i = 0; i < COLUMNS; i++)
    cloth_scene_hold (scene, i);
  for (guint f = 0; f < N_FABRICS; f++) {
    const gdouble values[2] = { laws[f].ratio, laws[f].knee };

    models[f] = model_new (mean_of_later (&curves[f], N_POINTS - 1) / 9.81,
        laws[f].stiffness);
    models[f]->damping_mass = 10.;
    models[f]->time_step = 2e-4;
    cloth_model_set_effect (models[f], &cloth_effect_biphasic_stretch, values);
  }
  sim = cloth_sim_new (scene, (const ClothModel * const *) models, N_FABRICS,
      NULL, &error);
  g_assert_no_error (error);
  run_for (sim, 8.);
  for (guint f = 0; f < N_FABRICS; f++) {
    g_autofree gdouble *x = positions_of (sim, f);

    for (guint row = 0; row + 1 < ROWS; row++)
      stretch[f * (ROWS - 1) + row] = (ROWS - 1) *
          (x[3 * (row * COLUMNS + 1) + 2] - x[3 * ((row + 1) * COLUMNS + 1) +
              2]);
    cloth_model_free (models[f]);
  }
  return stretch;
}

/* The simulated strips lie on the measured curves. */
static void
test_loading (void)
{
  g_autofree Curves *curves = read_curves ();
  Law laws[N_FABRICS];
  g_autofree gdouble *stretch = NULL;
  gdouble all[4] = { 0., 0., 0., 0. };
  guint n_within = 0;

  for (guint f = 0; f < N_FABRICS; f++)
    laws[f] = fit (&curves[f], TRUE);
  stretch = hang (laws, curves);
  for (guint f = 0; f < N_FABRICS; f++) {
    const Curves *c = &curves[f];
    gdouble top = mean_of_later (c, N_POINTS - 1), sum = 0., length = 0.;
    gdouble single = fit (c, FALSE).residual;
    gdouble spread = scatter (c, 0), later = scatter (c, 1), residual;

    /* evenly over stretch, as the scatter is */
    for (guint row = 1; row + 2 < ROWS; row++) {
      const gdouble *here = stretch + f * (ROWS - 1) + row;
      gdouble force = top * (1. - (row + 0.5) / (ROWS - 1));
      gdouble at = *here, measured, share = 0.5 * (here[-1] - here[1]);
      gdouble place = (at - c->stretch[0]) / (c->stretch[1] - c->stretch[0]);
      guint i = (guint) CLAMP (place, 0., N_POINTS - 2.);

      if (place < 0. || place > N_POINTS - 1.)
        continue;
      measured = mean_of_later (c, i) + (place - i) *
          (mean_of_later (c, i + 1) - mean_of_later (c, i));
      sum += share * (force - measured) * (force - measured);
      length += share;
      /* the strip keeps to its law */
      assert_within (at * laws[f].stiffness * (green (at) + laws[f].ratio *
              MAX (green (at) - laws[f].knee, 0.)), force, 0.01);
    }
    g_assert_cmpfloat (length, >, 0.6 * (c->stretch[N_POINTS - 1] - 1.));
    residual = sqrt (sum / length);
    g_test_message ("%s: up to %.1f N at stretch %.2f; strip off by %.2f N "
        "(law %.2f, one stiffness %.2f), scatter of pulls %.2f, of 2 to 5 "
        "%.2f; stiffness %.3g N, ratio %.2g, knee %.2f", names[f], top,
        c->stretch[N_POINTS - 1], residual, laws[f].residual, single, spread,
        later, laws[f].stiffness, laws[f].ratio, laws[f].knee);
    n_within += residual <= spread;
    all[0] += residual * residual / N_FABRICS;
    all[1] += spread * spread / N_FABRICS;
    all[2] += later * later / N_FABRICS;
    all[3] += single * single / N_FABRICS;
    /* no fabric is far off either */
    g_assert_cmpfloat (residual, <, 1.5 * spread);
  }
  g_test_message ("all: strips off by %.2f N RMS, one stiffness by %.2f; "
      "scatter of pulls %.2f, of 2 to 5 %.2f; %u of %u within their own",
      sqrt (all[0]), sqrt (all[3]), sqrt (all[1]), sqrt (all[2]), n_within,
      N_FABRICS);
  g_assert_cmpfloat (all[0], <, all[1]);
  g_assert_cmpfloat (all[3], >, 4. * all[1]);
  g_assert_cmpuint (n_within, >=, 12);
}

/* The first pull takes more than the later ones, beyond their scatter: what hysteresis is
 * there for. */
static void
test_first_pull (void)
{
  g_autofree Curves *curves = read_curves ();

  for (guint f = 0; f < N_FABRICS; f++) {
    const Curves *c = &curves[f];
    gdouble sum = 0., work[2] = { 0., 0. }, apart;

    for (guint i = 0; i < N_POINTS; i++) {
      gdouble later = mean_of_later (c, i);

      sum += (c->pulls[0][i] - later) * (c->pulls[0][i] - later);
      work[0] += c->pulls[0][i];
      work[1] += later;
    }
    apart = sqrt (sum / N_POINTS);
    g_test_message ("%s: the first pull is %.2f N off the later ones, whose "
        "scatter is %.2f, and takes %.2f times their work", names[f], apart,
        scatter (c, 1), work[0] / work[1]);
    g_assert_cmpfloat (apart, >, 1.25 * scatter (c, 1));
    g_assert_cmpfloat (work[0], >, 1.05 * work[1]);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/knits/loading", test_loading);
  g_test_add_func ("/sim/knits/first-pull", test_first_pull);
  return g_test_run ();
}
