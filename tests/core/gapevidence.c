/* Evidence against integrals that are computed here, and what prediction and clamps say against closed
 * forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/gap/inference/clamps.h"
#include "gst/gap/inference/evidence.h"
#include "gst/gap/inference/prediction.h"
#include "gst/math/random.h"

#define N 12
#define STEP 1e-3

/* log ∫ p (e + Jθ) N(θ; 0, prior²) dθ / p (e), by the midpoint rule. */
static gdouble
integrate (const gdouble * e, const gdouble * j, gdouble prior,
    gboolean one_sided)
{
  gdouble none = 0., sum = 0.;

  for (guint i = 0; i < N; i++)
    none += e[i] * e[i];
  for (gdouble x = one_sided ? 0.5 * STEP : -12. + 0.5 * STEP; x < 12.;
      x += STEP) {
    const gdouble theta = x * prior;
    gdouble square = 0.;

    for (guint i = 0; i < N; i++)
      square += pow (e[i] + j[i] * theta, 2.);
    sum += STEP * (one_sided ? 2. : 1.) * exp (-0.5 * x * x) / sqrt (2. * G_PI)
        * exp (-0.5 * (CLOTH_GAP_FREEDOM + N) * (log1p (square /
                CLOTH_GAP_FREEDOM) - log1p (none / CLOTH_GAP_FREEDOM)));
  }
  return log (sum);
}

static void
fill (gdouble * e, gdouble * j, gdouble theta, ClothRandom * random)
{
  for (guint i = 0; i < N; i++) {
    j[i] = 3. * cloth_random_gaussian (random);
    e[i] = cloth_random_gaussian (random) - j[i] * theta;
  }
}

/* One number, that may be negative or not, weak and strong. */
static void
test_integral (void)
{
  static const gdouble truths[] = { 0., 0.1, 0.4, 1.5, -0.4 };
  ClothRandom random;

  cloth_random_init (&random, 11);
  for (guint c = 0; c < 2 * G_N_ELEMENTS (truths); c++) {
    const ClothGapPrior prior = { 0.7, 0., c % 2 == 1 };
    const gdouble at = 0.;
    ClothGapEvidence with, none;
    gdouble e[N], j[N], found, truth;

    fill (e, j, truths[c / 2], &random);
    g_assert_true (cloth_gap_evidence_find (N, e, NULL, NULL, NULL, 0, &none));
    g_assert_true (cloth_gap_evidence_find (N, e, j, &at, &prior, 1, &with));
    found = with.log_evidence - none.log_evidence;
    truth = integrate (e, j, prior.prior, prior.one_sided);
    g_test_message ("truth %g%s: %.3f, integral %.3f", truths[c / 2],
        prior.one_sided ? ", not below 0" : "", found, truth);
    /* what lies far on the other side is not like a normal variable: both say that it is not so */
    if (prior.one_sided && truths[c / 2] < 0.)
      g_assert_true (found < -2. && truth < -2.);
    else
      g_assert_cmpfloat (fabs (found - truth), <, 0.1);
  }
}

/* Where it is linearised doesn't matter. */
static void
test_place (void)
{
  const ClothGapPrior prior = { 0.7, 0., FALSE };
  const gdouble places[] = { 0., 0.5 };
  gdouble e[2][N], j[N];
  ClothGapEvidence found[2];
  ClothRandom random;

  cloth_random_init (&random, 12);
  fill (e[0], j, 0.4, &random);
  for (guint i = 0; i < N; i++)
    e[1][i] = e[0][i] + j[i] * places[1];
  for (guint k = 0; k < 2; k++)
    g_assert_true (cloth_gap_evidence_find (N, e[k], j, &places[k], &prior, 1,
            &found[k]));
  g_assert_cmpfloat_with_epsilon (found[0].log_evidence,
      found[1].log_evidence, 1e-6);
  g_assert_cmpfloat_with_epsilon (found[0].values[0], found[1].values[0], 1e-6);
}

static void
test_not_finite (void)
{
  const ClothGapPrior prior = { 0.7, 0., FALSE };
  const gdouble at = 0.;
  gdouble e[N] = { NAN }, j[N] = { 1. };
  ClothGapEvidence found;

  g_assert_false (cloth_gap_evidence_find (N, e, j, &at, &prior, 1, &found));
  e[0] = INFINITY;
  g_assert_false (cloth_gap_evidence_find (N, e, NULL, NULL, NULL, 0, &found));
}

/* Each window counts by its own size; one in which nothing was seen says nothing. */
static void
test_prediction (void)
{
  const gdouble floor = 1e-6, one = floor * expm1 (2. / 3.);
  const gdouble windows[] = { one, NAN, 0., one };

  g_assert_cmpfloat_with_epsilon (cloth_gap_find_prediction_evidence (windows,
          4, floor), -2., 1e-12);
  g_assert_cmpfloat (cloth_gap_find_prediction_evidence (windows + 1, 2,
          floor), ==, 0.);
  g_assert_cmpfloat (cloth_gap_find_prediction_evidence (NULL, 0, floor), ==,
      0.);
}

/* The ratio of two Gaussian likelihoods, less the cost of one number. */
static void
test_clamps (void)
{
  const gdouble n = 40., usual = 1e-6, square = 4e-6;
  /* log N(x; 0, square) − log N(x; 0, usual) of n numbers whose mean square is @square */
  const gdouble truth = 0.5 * n * (square / usual - 1.) -
      0.5 * n * log (square / usual) - 0.5 * log (n);

  g_assert_cmpfloat_with_epsilon (cloth_gap_find_clamps_evidence (square,
          usual, n), truth, 1e-9);
  g_assert_cmpfloat (cloth_gap_find_clamps_evidence (usual, usual, n), ==,
      -INFINITY);
  g_assert_cmpfloat (cloth_gap_find_clamps_evidence (0.5 * usual, usual, n),
      ==, -INFINITY);
  g_assert_cmpfloat (cloth_gap_find_clamps_evidence (square, usual, 1.), ==,
      -INFINITY);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gap/evidence/integral", test_integral);
  g_test_add_func ("/gap/evidence/place", test_place);
  g_test_add_func ("/gap/evidence/not-finite", test_not_finite);
  g_test_add_func ("/gap/evidence/prediction", test_prediction);
  g_test_add_func ("/gap/evidence/clamps", test_clamps);
  return g_test_run ();
}
