/* The estimator on made-up equations, against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/estimate/gauss-newton.h"
#include "gst/math/random.h"

/* One datum z = −b θ + ε, ε ~ N(0, φ), θ ~ N(m, 1/λ). */
static void
test_one (void)
{
  const gdouble z = -1.7, b = 0.6, phi = 2.5, lambda = 0.8, mean = 0.3;
  const gdouble g = b * b, s = b * z;
  const gdouble precision = b * b / phi + lambda;
  g_auto (ClothPosterior) p = { 0 };
  gdouble covariance;

  cloth_posterior_init (&p, 1);
  cloth_posterior_add_data (&p, &g, &s, phi);
  cloth_posterior_add_prior (&p, &lambda, &mean);
  g_assert_true (cloth_posterior_solve (&p));
  cloth_posterior_covariance (&p, &covariance);
  g_assert_cmpfloat_with_epsilon (p.mean[0],
      (lambda * mean - b * z / phi) / precision, 1e-14);
  g_assert_cmpfloat_with_epsilon (covariance, 1. / precision, 1e-14);
  g_assert_cmpfloat_with_epsilon (cloth_posterior_log_determinant (&p),
      log (precision), 1e-14);
}

/* The logarithm of the Bayes factor is that of the densities of the data: with the effect
 * they are Gaussian with the covariance φ I + B Λ⁻¹ Bᵀ. */
static void
test_two (void)
{
  const gdouble z[2] = { 1.3, -0.4 }, b[2][2] = { {0.9, 0.5}, {-0.2, 1.1} };
  const gdouble lambda[2] = { 0.7, 2. }, phi = 0.6;
  gdouble g[4], s[2], c[4], covariance[4], a[4], det, bayes, by_density;
  g_auto (ClothPosterior) p = { 0 };

  for (guint i = 0; i < 2; i++) {
    s[i] = b[0][i] * z[0] + b[1][i] * z[1];
    for (guint k = 0; k < 2; k++) {
      g[2 * i + k] = b[0][i] * b[0][k] + b[1][i] * b[1][k];
      a[2 * i + k] = g[2 * i + k] / phi + (i == k ? lambda[i] : 0.);
      c[2 * i + k] = b[i][0] * b[k][0] / lambda[0] +
          b[i][1] * b[k][1] / lambda[1] + (i == k ? phi : 0.);
    }
  }
  cloth_posterior_init (&p, 2);
  cloth_posterior_add_data (&p, g, s, phi);
  cloth_posterior_add_prior (&p, lambda, NULL);
  g_assert_true (cloth_posterior_solve (&p));
  cloth_posterior_covariance (&p, covariance);
  det = a[0] * a[3] - a[1] * a[2];
  g_assert_cmpfloat_with_epsilon (covariance[0], a[3] / det, 1e-14);
  g_assert_cmpfloat_with_epsilon (covariance[1], -a[1] / det, 1e-14);
  g_assert_cmpfloat_with_epsilon (covariance[3], a[0] / det, 1e-14);
  g_assert_cmpfloat_with_epsilon (p.mean[0],
      (-a[3] * s[0] + a[1] * s[1]) / phi / det, 1e-14);
  g_assert_cmpfloat_with_epsilon (p.mean[1],
      (a[2] * s[0] - a[0] * s[1]) / phi / det, 1e-14);
  bayes = 0.5 * (-s[0] * p.mean[0] - s[1] * p.mean[1]) / phi -
      0.5 * (cloth_posterior_log_determinant (&p) - log (lambda[0] *
          lambda[1]));
  det = c[0] * c[3] - c[1] * c[2];
  by_density = -0.5 * ((c[3] * z[0] * z[0] - 2. * c[1] * z[0] * z[1] +
          c[0] * z[1] * z[1]) / det + log (det)) +
      0.5 * ((z[0] * z[0] + z[1] * z[1]) / phi + log (phi * phi));
  g_assert_cmpfloat_with_epsilon (bayes, by_density, 1e-13);
}

/* Data one after the other give what they give together; nothing known is no posterior. */
static void
test_in_parts (void)
{
  const gdouble g[2][4] = { {2., 0.5, 0.5, 1.}, {1., -0.2, -0.2, 3.} };
  const gdouble s[2][2] = { {0.3, -1.}, {2., 0.1} }, lambda[2] = { 1., 0.5 };
  gdouble all[4], score[2], x[2] = { 1., 0. }, covariance[4];
  g_auto (ClothPosterior) parts = { 0 };
  g_auto (ClothPosterior) one = { 0 };
  g_auto (ClothPosterior) none = { 0 };

  for (guint i = 0; i < 4; i++)
    all[i] = g[0][i] + g[1][i];
  for (guint i = 0; i < 2; i++)
    score[i] = s[0][i] + s[1][i];
  cloth_posterior_init (&parts, 2);
  cloth_posterior_add_data (&parts, g[0], s[0], 2.);
  cloth_posterior_add_prior (&parts, lambda, NULL);
  cloth_posterior_add_data (&parts, g[1], s[1], 2.);
  cloth_posterior_init (&one, 2);
  cloth_posterior_add_data (&one, all, score, 2.);
  cloth_posterior_add_prior (&one, lambda, NULL);
  g_assert_true (cloth_posterior_solve (&parts));
  g_assert_true (cloth_posterior_solve (&one));
  for (guint i = 0; i < 2; i++)
    g_assert_cmpfloat_with_epsilon (parts.mean[i], one.mean[i], 1e-14);
  cloth_posterior_apply (&one, x);
  cloth_posterior_covariance (&one, covariance);
  g_assert_cmpfloat_with_epsilon (x[0], covariance[0], 1e-14);
  g_assert_cmpfloat_with_epsilon (x[1], covariance[2], 1e-14);
  cloth_posterior_init (&none, 2);
  g_assert_false (cloth_posterior_solve (&none));
}

/* Two blocks of two cosines, two waves in bands of their own and three axes. */
#define BLOCKS 2
#define COSINES 2
#define WAVES 2
#define SIZE (3 * BLOCKS * COSINES * WAVES)
/* The nuisances are the first ones. */
#define NUISANCES 2
#define LOOKED_AT CLOTH_EFFECT_MAX_PARAMETERS
#define COLUMNS (NUISANCES + LOOKED_AT)

typedef struct
{
  guint bands[WAVES];
  ClothFeatures features;
  gdouble values[3 * COSINES * WAVES];
  ClothPowerSpectrum discrepancy;
  gdouble z[SIZE], columns[COLUMNS][SIZE];
  ClothNormalEquations *normal;
} Equations;

static void
equations_clear (Equations * e)
{
  cloth_normal_equations_free (e->normal);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Equations, equations_clear);

static void
fill (Equations * e, guint64 seed)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  e->bands[1] = 1;
  e->features = (ClothFeatures) {
  .n_waves = WAVES,.bands = e->bands,.n_bands = WAVES,.n_blocks =
        BLOCKS,.n_cosines = COSINES,.size = SIZE};
  for (guint i = 0; i < G_N_ELEMENTS (e->values); i++)
    e->values[i] = 0.3 * i;
  e->discrepancy.n = G_N_ELEMENTS (e->values);
  e->discrepancy.values = e->values;
  for (guint i = 0; i < SIZE; i++) {
    e->z[i] = cloth_random_gaussian (&random);
    for (guint k = 0; k < COLUMNS; k++)
      e->columns[k][i] = cloth_random_gaussian (&random) +
          (k ? 0.5 * e->columns[0][i] : 0.);
  }
  e->normal = cloth_normal_equations_new (&e->features, &e->discrepancy,
      e->z, e->columns[0], COLUMNS);
}

/* Features lie block by block, cosine by cosine, wave by wave, axis by axis. */
static gdouble
weight_of (const Equations * e, guint i)
{
  const guint axis = i % 3, wave = i / 3 % WAVES;
  const guint cosine = i / 3 / WAVES % COSINES;

  return 1. / (1. + e->values[3 * (WAVES * cosine + wave) + axis]);
}

static void
test_equations (void)
{
  g_auto (Equations) e = { {0} };
  const guint columns[2] = { 4, 1 };
  const gboolean second[BLOCKS] = { FALSE, TRUE };
  gdouble g[4], s[2], r, direct[4] = { 0. };

  fill (&e, 1);
  g_assert_cmpuint (e.normal->n_blocks, ==, BLOCKS);
  g_assert_cmpfloat (e.normal->per_block, ==, SIZE / BLOCKS);
  for (guint i = SIZE / BLOCKS; i < SIZE; i++) {
    direct[0] += weight_of (&e, i) * e.z[i] * e.z[i];
    direct[1] += weight_of (&e, i) * e.columns[4][i] * e.z[i];
    direct[2] += weight_of (&e, i) * e.columns[4][i] * e.columns[1][i];
    direct[3] += weight_of (&e, i) * e.columns[1][i] * e.columns[1][i];
  }
  r = cloth_normal_equations_sum (e.normal, second, columns, 2, g, s);
  g_assert_cmpfloat_with_epsilon (r, direct[0], 1e-12);
  g_assert_cmpfloat_with_epsilon (s[0], direct[1], 1e-12);
  g_assert_cmpfloat_with_epsilon (g[1], direct[2], 1e-12);
  g_assert_cmpfloat_with_epsilon (g[2], direct[2], 1e-12);
  g_assert_cmpfloat_with_epsilon (g[3], direct[3], 1e-12);
  /* a mean square by class is what white features have */
  {
    g_autoptr (ClothPowerSpectrum) power =
        cloth_power_spectrum_new (&e.features, e.z);

    g_assert_cmpuint (power->n, ==, e.discrepancy.n);
    g_assert_cmpfloat_with_epsilon (power->values[0],
        0.5 * (e.z[0] * e.z[0] + e.z[SIZE / 2] * e.z[SIZE / 2]), 1e-14);
  }
}

/* With the nuisances projected out the directions are what a fit of all at once has, their
 * covariance too, and the square that is left is that of this fit (Frisch and Waugh). */
static void
test_projection (void)
{
  g_auto (Equations) e = { {0} };
  const gdouble prior[NUISANCES] = { 0.4, 1.5 };
  const gboolean both[BLOCKS] = { TRUE, TRUE };
  const gdouble flat[LOOKED_AT] = { 0. };
  gdouble precisions[COLUMNS] = { prior[0], prior[1] };
  guint all[COLUMNS], reversed[COLUMNS];
  gdouble g[COLUMNS * COLUMNS], s[COLUMNS], r, some, left;
  gdouble of_all[COLUMNS * COLUMNS], of_some[LOOKED_AT * LOOKED_AT];
  ClothReducedEquations reduced;
  g_auto (ClothPosterior) full = { 0 };
  g_auto (ClothPosterior) part = { 0 };

  fill (&e, 2);
  for (guint i = 0; i < COLUMNS; i++)
    all[i] = i;
  r = cloth_normal_equations_sum (e.normal, NULL, all, COLUMNS, g, s);
  cloth_posterior_init (&full, COLUMNS);
  cloth_posterior_add_data (&full, g, s, 1.);
  cloth_posterior_add_prior (&full, precisions, NULL);
  g_assert_true (cloth_posterior_solve (&full));
  cloth_posterior_covariance (&full, of_all);
  g_assert_true (cloth_normal_equations_reduce (e.normal, both, all, prior,
          NUISANCES, all + NUISANCES, LOOKED_AT, &reduced));
  cloth_posterior_init (&part, LOOKED_AT);
  cloth_posterior_add_data (&part, reduced.g, reduced.s, 1.);
  cloth_posterior_add_prior (&part, flat, NULL);
  g_assert_true (cloth_posterior_solve (&part));
  cloth_posterior_covariance (&part, of_some);
  left = r;
  some = reduced.r;
  for (guint i = 0; i < COLUMNS; i++)
    left += s[i] * full.mean[i];
  for (guint i = 0; i < LOOKED_AT; i++) {
    some += reduced.s[i] * part.mean[i];
    g_assert_cmpfloat_with_epsilon (part.mean[i], full.mean[NUISANCES + i],
        1e-11);
    for (guint k = 0; k < LOOKED_AT; k++)
      g_assert_cmpfloat_with_epsilon (of_some[i * LOOKED_AT + k],
          of_all[(NUISANCES + i) * COLUMNS + NUISANCES + k], 1e-11);
    g_assert_cmpfloat (reduced.kept[i], >, 0.);
    g_assert_cmpfloat (reduced.kept[i], <, 1.);
  }
  g_assert_cmpfloat_with_epsilon (some, left, 1e-11);
  /* the same where the last ones are projected out of the first */
  for (guint i = 0; i < COLUMNS; i++)
    reversed[i] = (i + NUISANCES) % COLUMNS;
  {
    gdouble columns[COLUMNS][SIZE];
    g_autoptr (ClothNormalEquations) turned = NULL;

    for (guint i = 0; i < COLUMNS; i++)
      memcpy (columns[i], e.columns[reversed[i]], sizeof columns[i]);
    turned = cloth_normal_equations_new (&e.features, &e.discrepancy, e.z,
        columns[0], COLUMNS);
    r = cloth_normal_equations_project (turned, NULL, LOOKED_AT, prior, g, s);
    g_assert_cmpfloat_with_epsilon (r, reduced.r, 1e-12);
    for (guint i = 0; i < LOOKED_AT; i++)
      g_assert_cmpfloat_with_epsilon (s[i], reduced.s[i], 1e-12);
    for (guint i = 0; i < LOOKED_AT * LOOKED_AT; i++)
      g_assert_cmpfloat_with_epsilon (g[i], reduced.g[i], 1e-12);
  }
}

/* By how much zᵀWz of a block changes is what it is with the changes made. */
static void
test_change (void)
{
  g_auto (Equations) e = { {0} };
  const guint directions[2] = { 2, 5 };
  const gdouble changes[2] = { 0.3, -1.1 };
  gdouble before = 0., after = 0.;

  fill (&e, 3);
  for (guint i = SIZE / BLOCKS; i < SIZE; i++) {
    const gdouble z = e.z[i] + changes[0] * e.columns[2][i] +
        changes[1] * e.columns[5][i];

    before += weight_of (&e, i) * e.z[i] * e.z[i];
    after += weight_of (&e, i) * z * z;
  }
  g_assert_cmpfloat_with_epsilon (cloth_normal_equations_change (e.normal, 1,
          directions, changes, 2), after - before, 1e-11);
}

/* A residual of one number, as a function of it. */
typedef struct
{
  gdouble (*residual) (gdouble x, gdouble * slope);
  gdouble most;                 /* beyond it nothing can be simulated */
  gdouble x, accepted, z, slope;
  guint n_linearised;
} Curve;

static gboolean
curve_linearise (gpointer data, GError ** error)
{
  Curve *c = data;

  c->n_linearised++;
  if (isnan (c->x) || c->x > c->most) {
    g_set_error (error, CLOTH_FIT_ERROR,
        isnan (c->x) ? CLOTH_FIT_ERROR_RECORDING : CLOTH_FIT_ERROR_MODEL,
        "%g", c->x);
    return FALSE;
  }
  c->z = c->residual (c->x, &c->slope);
  return TRUE;
}

static void
curve_accept (gpointer data)
{
  Curve *c = data;

  c->accepted = c->x;
}

static gdouble
curve_add (gpointer data, ClothPosterior * posterior)
{
  const Curve *c = data;
  const gdouble g = c->slope * c->slope, s = c->slope * c->z;

  if (posterior)
    cloth_posterior_add_data (posterior, &g, &s, 5.);
  return c->z * c->z;
}

static void
curve_move (gpointer data, const gdouble * step, gdouble share, gdouble * moved)
{
  Curve *c = data;

  c->x += share * step[0];
  moved[0] += share * step[0];
}

static void
curve_restore (gpointer data)
{
  Curve *c = data;

  c->x = c->accepted;
}

static gboolean
run (Curve * c, gdouble precision, gdouble longest, guint n_passes,
    gdouble * sigma, GError ** error)
{
  static const ClothGaussNewtonProblem problem = {
    curve_linearise, curve_accept, curve_add, curve_move, curve_restore
  };
  const ClothGaussNewtonOptions options = {
    1, &precision, &longest, 5., n_passes, FALSE
  };

  return cloth_gauss_newton_run (&problem, c, &options, sigma, error);
}

static gdouble
line (gdouble x, gdouble * slope)
{
  *slope = 2.;
  return 2. * x - 3.;
}

static gdouble
arc_tangent (gdouble x, gdouble * slope)
{
  *slope = 1. / (1. + x * x);
  return atan (x);
}

/* Falls to 0 at 0, and rises twice as fast beyond; its slope is that of a flatter one. */
static gdouble
hat (gdouble x, gdouble * slope)
{
  *slope = 0.1;
  return x > 0. ? x : -2. * x;
}

/* A linear problem is solved by one step, which stays; the prior draws back to the start. */
static void
test_linear (void)
{
  g_autoptr (GError) error = NULL;
  const gdouble precision = 0.5, best = (2. * 3. / 5.) / (4. / 5. + precision);
  Curve c = { line, INFINITY };
  gdouble sigma;

  g_assert_true (run (&c, precision, 100., 2, &sigma, &error));
  g_assert_no_error (error);
  g_assert_cmpfloat_with_epsilon (c.x, best, 1e-14);
  g_assert_cmpfloat_with_epsilon (sigma, 1. / sqrt (4. / 5. + precision),
      1e-14);
  c = (Curve) {
  line, INFINITY};
  g_assert_true (run (&c, precision, 100., 10, NULL, &error));
  g_assert_cmpfloat_with_epsilon (c.x, best, 1e-14);
  /* no step is longer than it may be */
  c = (Curve) {
  line, INFINITY};
  g_assert_true (run (&c, precision, 0.25, 2, NULL, &error));
  g_assert_cmpfloat_with_epsilon (c.x, 0.25, 1e-14);
}

/* From 3 a whole step leads to −9.5, where the residual is larger: it is cut. */
static void
test_cut (void)
{
  g_autoptr (GError) error = NULL;
  Curve c = { arc_tangent, INFINITY, 3. };

  g_assert_true (run (&c, 1e-9, 100., 20, NULL, &error));
  g_assert_cmpfloat (fabs (c.x), <, 0.1);
}

/* Steps of 2.5 lead from 3 to 0.5 and to −2, which is worse: as nothing is tried any more, it ends where it
 * was best. */
static void
test_last (void)
{
  g_autoptr (GError) error = NULL;
  Curve c = { hat, INFINITY, 3. };

  g_assert_true (run (&c, 1e-9, 2.5, 3, NULL, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (c.n_linearised, ==, 3);
  g_assert_cmpfloat_with_epsilon (c.x, 0.5, 1e-12);
}

/* What can't be simulated is stepped back from; where it is all there is, it is told. */
static void
test_unsound (void)
{
  g_autoptr (GError) error = NULL;
  Curve c = { line, 1. };

  g_assert_true (run (&c, 1e-9, 100., 3, NULL, &error));
  g_assert_no_error (error);
  g_assert_cmpfloat_with_epsilon (c.x, 0.4 * 1.5, 1e-6);
  c = (Curve) {
  line, 1.};
  g_assert_true (run (&c, 1e-9, 100., 2, NULL, &error));
  g_assert_cmpfloat (c.x, ==, 0.);
  c = (Curve) {
  line, -1.};
  g_assert_false (run (&c, 1e-9, 100., 3, NULL, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL);
  g_clear_error (&error);
  c = (Curve) {
  line, 1., NAN};
  g_assert_false (run (&c, 1e-9, 100., 3, NULL, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/estimate/posterior/one", test_one);
  g_test_add_func ("/estimate/posterior/two", test_two);
  g_test_add_func ("/estimate/posterior/parts", test_in_parts);
  g_test_add_func ("/estimate/equations", test_equations);
  g_test_add_func ("/estimate/projection", test_projection);
  g_test_add_func ("/estimate/change", test_change);
  g_test_add_func ("/estimate/gauss-newton/linear", test_linear);
  g_test_add_func ("/estimate/gauss-newton/cut", test_cut);
  g_test_add_func ("/estimate/gauss-newton/last", test_last);
  g_test_add_func ("/estimate/gauss-newton/unsound", test_unsound);
  return g_test_run ();
}
