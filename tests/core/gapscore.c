/* The score test against the Gaussian density of all features at once, with its full
 * covariance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/gap/camera/score.h"
#include "gst/math/linalg.h"
#include "gst/math/random.h"

#define N 60
/* one nuisance, then the effect's directions */
#define MOST CLOTH_EFFECT_MAX_PARAMETERS
#define COLUMNS (1 + MOST)

static const gdouble prior = 0.3, precision = 0.04, overdispersion = 5.;
static const ClothEffect effect = {.id = "made up",.n_parameters = MOST };

typedef struct
{
  gdouble c[N][COLUMNS], z[N];
} Data;

/* Some of each parameter of the effect and of the nuisance, and noise. */
static void
fill (Data * data, gdouble amount, guint64 seed)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint i = 0; i < N; i++) {
    data->z[i] = cloth_random_gaussian (&random);
    for (guint k = 0; k < COLUMNS; k++) {
      data->c[i][k] = cloth_random_gaussian (&random) +
          (k ? 0.5 * data->c[i][0] : 0.);
      data->z[i] -= (k ? amount * k : 2.) * data->c[i][k];
    }
  }
}

static ClothNormalEquations *
normal_of (const Data * data)
{
  ClothNormalEquations *n = g_new0 (ClothNormalEquations, 1);

  n->m = COLUMNS;
  n->n_blocks = 1;
  n->per_block = N;
  n->g = g_new0 (gdouble, COLUMNS * COLUMNS);
  n->s = g_new0 (gdouble, COLUMNS);
  n->r = g_new0 (gdouble, 1);
  for (guint i = 0; i < N; i++) {
    n->r[0] += data->z[i] * data->z[i];
    for (guint p = 0; p < COLUMNS; p++) {
      n->s[p] += data->c[i][p] * data->z[i];
      for (guint q = 0; q < COLUMNS; q++)
        n->g[p * COLUMNS + q] += data->c[i][p] * data->c[i][q];
    }
  }
  return n;
}

/* The nuisance as a direction, then candidates of @n directions each. */
static ClothCandidates *
list_candidates (guint n)
{
  ClothCandidates *c = g_new0 (ClothCandidates, 1);

  c->directions = g_array_new (FALSE, TRUE, sizeof (ClothDirection));
  c->list = g_array_new (FALSE, TRUE, sizeof (ClothCandidate));
  c->n_free = 1;
  for (guint k = 0; k < COLUMNS; k++) {
    const ClothDirection direction = {.prior = prior };

    g_array_append_val (c->directions, direction);
  }
  for (guint k = 1; k + n <= COLUMNS; k += n) {
    ClothCandidate candidate = { &effect };

    candidate.first = k;
    candidate.n = n;
    g_array_append_val (c->list, candidate);
  }
  return c;
}

/* Logarithm of the density of the features, their noise of variance @phi, without the effect
 * or with it; less a constant. */
static gdouble
density (const Data * data, gdouble phi, gboolean with)
{
  gdouble s[N * N], x[N], sum = 0.;

  for (guint i = 0; i < N; i++)
    for (guint k = 0; k < N; k++) {
      gdouble *to = &s[i * N + k];

      *to = (i == k ? phi : 0.) + data->c[i][0] * data->c[k][0] * phi /
          (precision * overdispersion);
      for (guint p = 1; p < COLUMNS && with; p++)
        *to += prior * prior * data->c[i][p] * data->c[k][p];
    }
  g_assert_true (cloth_cholesky_factor (N, s));
  memcpy (x, data->z, sizeof x);
  cloth_cholesky_solve (N, s, x);
  for (guint i = 0; i < N; i++)
    sum -= 0.5 * x[i] * data->z[i] + log (s[i * N + i]);
  return sum;
}

/* An effect of as many parameters as any may have. */
static void
test_five (void)
{
  const gboolean blocks[1] = { TRUE };
  const guint nuisance = 0;
  gboolean sound[COLUMNS];

  for (guint k = 0; k < COLUMNS; k++)
    sound[k] = TRUE;
  for (guint64 seed = 1; seed <= 3; seed++) {
    Data data;
    g_autoptr (ClothNormalEquations) normal = NULL;
    g_autoptr (ClothCandidates) candidates = list_candidates (MOST);
    g_autoptr (GArray) scores = NULL;
    const ClothGapScore *score;
    ClothReducedEquations reduced;
    gdouble phi;

    fill (&data, 0.2 * (gdouble) (seed - 1), seed);
    normal = normal_of (&data);
    {
      const ClothGapTest test = {.normal = normal,.candidates = candidates,
        .blocks = blocks,.nuisances = &nuisance,.precisions = &precision,
        .n_nuisances = 1,.n_numbers = 1,.overdispersion = overdispersion,
        .sound = sound
      };

      g_assert_true (cloth_gap_test_reduce (&test, normal, blocks, NULL, 0,
              &reduced));
      phi = cloth_gap_test_dispersion (&test, normal, &reduced);
      scores = cloth_gap_test_run (&test);
    }
    g_assert_cmpuint (scores->len, ==, 1);
    score = &g_array_index (scores, ClothGapScore, 0);
    g_assert_cmpfloat_with_epsilon (score->log_bayes_factor,
        density (&data, phi, TRUE) - density (&data, phi, FALSE), 1e-8);
    for (guint k = 0; k < MOST; k++)
      g_assert_true (score->sigmas[k] > 0. && score->sigmas[k] < prior);
    g_assert_true (score->kept > 0. && score->kept <= 1.);
  }
}

/* The best of several candidates pays for the choice: if there is nothing, one of n has a p-value below p with
 * a probability of 1 − (1 − p)ⁿ. */
static void
test_choice (void)
{
  const gboolean blocks[1] = { TRUE };
  const guint nuisance = 0;
  gboolean sound[COLUMNS];

  for (guint k = 0; k < COLUMNS; k++)
    sound[k] = TRUE;
  for (guint64 seed = 1; seed <= 5; seed++) {
    Data data;
    g_autoptr (ClothNormalEquations) normal = NULL;
    g_autoptr (ClothCandidates) candidates = list_candidates (1);
    g_autoptr (GArray) scores = NULL;
    const ClothGapScore *score;
    gdouble least = 1.;

    fill (&data, 0.05, seed);
    normal = normal_of (&data);
    {
      const ClothGapTest test = {.normal = normal,.candidates = candidates,
        .blocks = blocks,.nuisances = &nuisance,.precisions = &precision,
        .n_nuisances = 1,.n_numbers = 1,.overdispersion = overdispersion,
        .sound = sound
      };

      for (guint k = 1; k < COLUMNS; k++) {
        ClothReducedEquations reduced;
        gdouble phi, square;

        g_assert_true (cloth_gap_test_reduce (&test, normal, blocks, &k, 1,
                &reduced));
        phi = cloth_gap_test_dispersion (&test, normal, &reduced);
        square = pow (reduced.s[0] / phi, 2.) / (reduced.g[0] / phi +
            1. / (prior * prior));
        /* beyond a normal number of that square, to either side */
        least = MIN (least, erfc (sqrt (0.5 * square)));
      }
      scores = cloth_gap_test_run (&test);
    }
    g_assert_cmpuint (scores->len, ==, 1);
    score = &g_array_index (scores, ClothGapScore, 0);
    g_test_message ("p %g, of the best %g", least, score->p_value);
    g_assert_cmpfloat_with_epsilon (score->p_value, 1. - pow (1. - least,
            COLUMNS - 1), 1e-9);
  }
}

/* The nuisances of a likeness have the same prior as those of a score. */
static void
test_cosine (void)
{
  const gboolean blocks[1] = { TRUE };
  const gdouble strong = 4.;
  const guint nuisance = 0;
  gdouble g[2][2];
  Data data;
  g_autoptr (ClothNormalEquations) normal = NULL;
  g_autoptr (ClothCandidates) candidates = list_candidates (1);

  fill (&data, 0.3, 7);
  normal = normal_of (&data);
  for (guint i = 0; i < 2; i++)
    for (guint k = 0; k < 2; k++)
      g[i][k] = normal->g[(1 + i) * COLUMNS + 1 + k] -
          normal->g[1 + i] * normal->g[1 + k] / (normal->g[0] +
          strong * overdispersion);
  {
    const ClothGapTest test = {.normal = normal,.candidates = candidates,
      .blocks = blocks,.nuisances = &nuisance,.precisions = &strong,
      .n_nuisances = 1,.overdispersion = overdispersion
    };

    g_assert_cmpfloat_with_epsilon (cloth_gap_test_cosine (&test, 0, 1),
        fabs (g[0][1]) / sqrt (g[0][0] * g[1][1]), 1e-9);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gap/score/five", test_five);
  g_test_add_func ("/gap/score/choice", test_choice);
  g_test_add_func ("/gap/score/cosine", test_cosine);
  return g_test_run ();
}
