/* Evidence against integrals that are computed here, what prediction, clamps and other explanations say
 * against closed forms, and what is said when no effect was accepted.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "gst/gap/inference/clamps.h"
#include "gst/gap/inference/hypotheses.h"
#include "gst/gap/inference/likelihood.h"
#include "gst/gap/inference/prediction.h"
#include "gst/gap/verdict/judge.h"
#include "gst/math/random.h"

#define N 60
#define STEP 1e-2
/* Degrees of freedom of a class's size, and the power that likelihoods are raised to. */
#define SIZE_FREEDOM 10.
#define COARSENING 0.5

/* One class of features with the variance 1, independent: as many members as features, each off in one
 * of them. They are of one family, which is left out. */
typedef struct
{
  guint classes[N], families[N];
  gdouble z[N], j[N], free[N], members[N * N], variances[1];
  gdouble precisions[1];
  ClothGapStack stack;
  ClothGapDiscrepancy discrepancy;
} Fixture;

static void
fixture_init (Fixture * f, gdouble theta, guint n_free, ClothRandom * random)
{
  *f = (Fixture) {
  0};
  for (guint i = 0; i < N; i++) {
    f->j[i] = 1.3 * cloth_random_gaussian (random);
    f->free[i] = 0.9 * cloth_random_gaussian (random);
    f->z[i] = cloth_random_gaussian (random) - f->j[i] * theta;
    f->members[i * N + i] = sqrt (N);
  }
  f->variances[0] = 1.;
  f->precisions[0] = 4.;
  f->stack = (ClothGapStack) {
  .size = N,.n_classes = 1,.classes = f->classes,.n_free = n_free,.n = 1,.z =
        f->z,.free = f->free,.columns = f->j,.precisions =
        f->precisions,.overdispersion = 1.,.n_members = N,.families =
        f->families,.members = f->members};
  f->discrepancy = (ClothGapDiscrepancy) {
  .free = f->free,.members = f->members,.variances = f->variances};
}

static gdouble
log_density (const Fixture * f, gdouble theta, gdouble c)
{
  gdouble square = 0.;

  for (guint i = 0; i < N; i++)
    square += pow (f->z[i] + f->j[i] * theta + f->free[i] * c, 2.);
  return -0.5 * (SIZE_FREEDOM + COARSENING * N) * log1p (COARSENING * square /
      SIZE_FREEDOM);
}

/* log ∫∫ p (z | θ, c) N(θ; 0, prior²) N(c; 0, ¼) dθ dc, by the midpoint rule. */
static gdouble
integrate (const Fixture * f, gdouble prior, gboolean one_sided)
{
  const gdouble sigma = 1. / sqrt (f->precisions[0]);
  gdouble sum = 0.;

  for (gdouble x = one_sided ? 0.5 * STEP : -8. + 0.5 * STEP; x < 8.; x += STEP) {
    const gdouble weight = STEP * (one_sided ? 2. : 1.) * exp (-0.5 * x * x) /
        sqrt (2. * G_PI);

    if (!f->stack.n_free)
      sum += weight * exp (log_density (f, x * prior, 0.));
    for (gdouble y = -8. + 0.5 * STEP; f->stack.n_free && y < 8.; y += STEP)
      sum += weight * STEP * exp (-0.5 * y * y) / sqrt (2. * G_PI) *
          exp (log_density (f, x * prior, y * sigma));
  }
  return log (sum);
}

static gboolean
find (const Fixture * f, const gdouble * z, const gdouble * at,
    const ClothGapPrior * prior, guint n, ClothGapEvidence * found)
{
  g_autoptr (ClothGapLikelihood) l = cloth_gap_likelihood_new (&f->stack,
      &f->discrepancy, 0);
  g_autoptr (ClothGapGram) gram = cloth_gap_gram_new (l, z, f->j, 1);
  const guint list = 0;

  return cloth_gap_gram_find_evidence (gram, &list, at, prior, n, found);
}

/* One number, that may be negative or not, weak and strong, with a free number beside it or not. */
static void
test_integral (void)
{
  static const gdouble truths[] = { 0., 0.1, 0.4, 1.5, -0.6 };
  ClothRandom random;

  cloth_random_init (&random, 11);
  for (guint c = 0; c < 4 * G_N_ELEMENTS (truths); c++) {
    const gdouble theta = truths[c / 4];
    const ClothGapPrior prior = { 0.7, 0., c % 2 == 1 };
    const gdouble at = 0.;
    ClothGapEvidence with;
    Fixture f;
    gdouble truth;

    fixture_init (&f, theta, c / 2 % 2, &random);
    g_assert_true (find (&f, f.z, &at, &prior, 1, &with));
    truth = integrate (&f, prior.prior, prior.one_sided);
    g_test_message ("truth %g%s%s: %.3f, integral %.3f", theta,
        prior.one_sided ? ", not below 0" : "",
        f.stack.n_free ? ", with a free number" : "", with.log_evidence, truth);
    /* what lies far on the other side is not like a normal variable */
    if (prior.one_sided && theta < 0.)
      g_assert_cmpfloat (with.log_evidence, <, truth + 1.);
    else
      g_assert_cmpfloat (fabs (with.log_evidence - truth), <, 0.1);
  }
}

/* Where it is linearised doesn't matter. */
static void
test_place (void)
{
  const ClothGapPrior prior = { 0.7, 0., FALSE };
  const gdouble places[] = { 0., 0.5 };
  gdouble moved[N];
  ClothGapEvidence found[2];
  ClothRandom random;
  Fixture f;

  cloth_random_init (&random, 12);
  fixture_init (&f, 0.4, 1, &random);
  for (guint i = 0; i < N; i++)
    moved[i] = f.z[i] + f.j[i] * places[1];
  for (guint k = 0; k < 2; k++)
    g_assert_true (find (&f, k ? moved : f.z, &places[k], &prior, 1,
            &found[k]));
  g_assert_cmpfloat_with_epsilon (found[0].log_evidence,
      found[1].log_evidence, 1e-6);
  g_assert_cmpfloat_with_epsilon (found[0].values[0], found[1].values[0], 1e-6);
}

/* The residual in one class only is a hundred times what members show: it counts by its logarithm. */
static void
test_robust (void)
{
  const ClothGapPrior prior = { 0.7, 0., FALSE };
  const gdouble at = 0.;
  ClothGapEvidence none, with;
  ClothRandom random;
  Fixture f;

  cloth_random_init (&random, 13);
  fixture_init (&f, 0., 0, &random);
  for (guint i = 0; i < N; i++)
    f.z[i] *= 100.;
  g_assert_true (find (&f, f.z, NULL, NULL, 0, &none));
  g_assert_true (find (&f, f.z, &at, &prior, 1, &with));
  g_assert_cmpfloat (fabs (with.log_evidence - none.log_evidence), <, 3.);
}

/* Densities with different variances are compared with their constants: a multivariate t distribution. */
static void
test_constant (void)
{
  const gdouble variances[] = { 0.1, 1., 10. };
  gdouble log_densities[3];
  ClothRandom random;
  Fixture f;

  cloth_random_init (&random, 15);
  fixture_init (&f, 0., 0, &random);
  for (guint k = 0; k < G_N_ELEMENTS (variances); k++) {
    const gdouble v = variances[k];
    g_autofree gdouble *members = g_memdup2 (f.members, sizeof f.members);
    ClothGapDiscrepancy d = f.discrepancy;
    g_autoptr (ClothGapLikelihood) l = NULL;
    g_autoptr (ClothGapGram) gram = NULL;
    ClothGapEvidence none;
    gdouble square = 0.;

    for (guint i = 0; i < N * N; i++)
      members[i] *= sqrt (v);
    for (guint i = 0; i < N; i++)
      square += f.z[i] * f.z[i] / v;
    d.members = members;
    d.variances = (gdouble *) & variances[k];
    l = cloth_gap_likelihood_new (&f.stack, &d, 0);
    gram = cloth_gap_gram_new (l, f.z, f.j, 1);
    g_assert_true (cloth_gap_gram_find_evidence (gram, NULL, NULL, NULL, 0,
            &none));
    log_densities[k] = none.log_evidence +
        cloth_gap_likelihood_find_constant (l);
    g_assert_cmpfloat_with_epsilon (log_densities[k],
        -0.5 * (SIZE_FREEDOM + COARSENING * N) * log1p (COARSENING * square /
            SIZE_FREEDOM) - 0.5 * COARSENING * N * log (v), 1e-6);
  }
  g_assert_cmpfloat (log_densities[1], >, log_densities[0]);
  g_assert_cmpfloat (log_densities[1], >, log_densities[2]);
}

/* The information of independent features of variance 1 is the sum of squared derivatives. */
static void
test_information (void)
{
  g_autoptr (ClothGapLikelihood) l = NULL;
  g_autoptr (ClothGapGram) gram = NULL;
  gdouble truth = 0.;
  ClothRandom random;
  Fixture f;

  cloth_random_init (&random, 14);
  fixture_init (&f, 0., 0, &random);
  l = cloth_gap_likelihood_new (&f.stack, &f.discrepancy, 0);
  gram = cloth_gap_gram_new (l, f.z, f.j, 1);
  for (guint i = 0; i < N; i++)
    truth += f.j[i] * f.j[i];
  g_assert_cmpfloat_with_epsilon (cloth_gap_gram_find_information (gram, 0),
      truth, 1e-9 * truth);
}

static void
test_not_finite (void)
{
  const ClothGapPrior prior = { 0.7, 0., FALSE };
  const gdouble at = 0.;
  ClothGapEvidence found;
  ClothRandom random;
  Fixture f;

  cloth_random_init (&random, 15);
  fixture_init (&f, 0., 0, &random);
  f.z[0] = NAN;
  g_assert_false (find (&f, f.z, &at, &prior, 1, &found));
  f.z[0] = INFINITY;
  g_assert_false (find (&f, f.z, NULL, NULL, 0, &found));
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

/* A recording of clamps that move evenly, as fast as @speed along x, and let go after @until_s: then nobody
 * knows where they are. */
static ClothRecording *
record_clamps (guint n_held, gdouble fps, gdouble begin_s, gdouble at,
    gdouble speed, gdouble until_s)
{
  const guint n_frames = (guint) (2. * fps) + 1;
  ClothRecording *r = g_new0 (ClothRecording, 1);

  r->n_frames = n_frames;
  r->times = g_new (gdouble, n_frames);
  r->scene = g_new0 (ClothScene, 1);
  r->scene->held = g_array_new (FALSE, FALSE, sizeof (ClothHeld));
  r->scene->clamps = g_new (gdouble, 3 * n_frames * n_held + 1);
  for (guint i = 0; i < n_held; i++) {
    const ClothHeld held = { i, -INFINITY, begin_s + until_s };

    g_array_append_val (r->scene->held, held);
  }
  for (guint f = 0; f < n_frames; f++) {
    r->times[f] = begin_s + f / fps;
    for (guint i = 0; i < n_held; i++) {
      gdouble *place = r->scene->clamps + 3 * (f * n_held + i);

      place[0] = f / fps < until_s ? at + i + speed * f / fps : NAN;
      place[1] = place[2] = at;
    }
  }
  return r;
}

static void
forget_clamps (ClothRecording * r)
{
  g_array_unref (r->scene->held);
  g_free (r->scene->clamps);
  g_free (r->scene);
  g_free (r->times);
  g_free (r);
}

/* Clamps that move alike are alike wherever, whenever and how often they were recorded, and however soon they
 * let go; others are apart by what they move more, t apart in speed. */
static void
test_clamps_distance (void)
{
  ClothRecording *take = record_clamps (2, 50., 0., 0., 0.3, INFINITY);
  ClothRecording *alike = record_clamps (2, 30., 1e6, 5., 0.3, 1.01);
  ClothRecording *faster = record_clamps (2, 50., 3., 0., 0.5, 1.01);
  ClothRecording *loose = record_clamps (0, 50., 0., 0., 0., 0.);
  gdouble expected = 0.;

  for (guint f = 0; f <= 50; f++)
    expected += pow (0.2 * f / 50., 2.) / 51.;
  g_assert_cmpfloat_with_epsilon (cloth_gap_find_clamps_distance (take, alike),
      0., 1e-15);
  g_assert_cmpfloat_with_epsilon (cloth_gap_find_clamps_distance (take,
          faster), expected, 1e-12);
  g_assert_cmpfloat_with_epsilon (cloth_gap_find_clamps_distance (faster,
          take), expected, 1e-12);
  /* what can't be compared is the last choice, but still one */
  g_assert_cmpfloat (cloth_gap_find_clamps_distance (take, loose), ==,
      G_MAXDOUBLE);
  g_assert_cmpfloat (cloth_gap_find_clamps_distance (loose, loose), ==, 0.);
  forget_clamps (take);
  forget_clamps (alike);
  forget_clamps (faster);
  forget_clamps (loose);
}

/* Odds of two sets that differ in one effect, and of one whose rest was not compared. */
static void
test_without (void)
{
  g_autoptr (GArray) hypotheses = cloth_gap_hypotheses_new ();
  ClothGapHypothesis h[] = {
    {.n = 2,.candidates = {3, 7},.behind = 0.},
    {.n = 1,.candidates = {3},.behind = log (19.)},
    {.n = 0,.behind = INFINITY},
  };

  g_array_append_vals (hypotheses, h, 3);
  g_assert_cmpfloat_with_epsilon (cloth_gap_hypotheses_find_without
      (hypotheses, &h[0], 1), 0.05, 1e-12);
  g_assert_cmpfloat (cloth_gap_hypotheses_find_without (hypotheses, &h[0], 0),
      ==, 0.);
  g_assert_cmpfloat (cloth_gap_hypotheses_find_without (hypotheses, &h[1], 0),
      ==, 0.);
}

/* What is said when no effect was accepted: @none is how likely it is that nothing acts. */
static void
check_verdict (gdouble none, gdouble unknown, guint n_references,
    ClothGapVerdict verdict, gboolean is_named)
{
  ClothDiagnosis d = { 0 };
  gpointer study = NULL;

  d.result = cloth_gap_result_new ();
  d.camera_effects = g_array_new (FALSE, TRUE, sizeof (ClothGapEffect));
  d.studies = g_ptr_array_new ();
  for (guint i = 0; i < n_references; i++)
    g_ptr_array_add (d.studies, study);
  cloth_gap_result_add_effect (d.result, cloth_effect_find ("wind"));
  d.result->rivals.none_acts = none * (1. - unknown);
  d.unknown_probability = unknown;
  cloth_diagnosis_decide (&d);
  g_assert_cmpint (d.result->verdict, ==, verdict);
  g_assert_true (!is_named == !(d.result->reason
          && strstr (d.result->reason, "wind")));
  g_ptr_array_unref (d.studies);
  g_array_unref (d.camera_effects);
  cloth_gap_result_free (d.result);
}

/* No gap stands only where it is likelier than not that nothing acts. */
static void
test_likely (void)
{
  check_verdict (0.8, 0., 1, CLOTH_GAP_NO_GAP, FALSE);
  check_verdict (0.8, 0.6, 1, CLOTH_GAP_NO_GAP, FALSE);
  check_verdict (0.3, 0., 1, CLOTH_GAP_UNDECIDABLE, TRUE);
  check_verdict (0.3, 0., 0, CLOTH_GAP_UNDECIDABLE, TRUE);
  check_verdict (0.8, 0., 0, CLOTH_GAP_UNDECIDABLE, FALSE);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gap/evidence/integral", test_integral);
  g_test_add_func ("/gap/evidence/place", test_place);
  g_test_add_func ("/gap/evidence/robust", test_robust);
  g_test_add_func ("/gap/evidence/constant", test_constant);
  g_test_add_func ("/gap/evidence/information", test_information);
  g_test_add_func ("/gap/evidence/not-finite", test_not_finite);
  g_test_add_func ("/gap/evidence/prediction", test_prediction);
  g_test_add_func ("/gap/evidence/clamps", test_clamps);
  g_test_add_func ("/gap/evidence/clamps-distance", test_clamps_distance);
  g_test_add_func ("/gap/evidence/without", test_without);
  g_test_add_func ("/gap/evidence/likely", test_likely);
  return g_test_run ();
}
