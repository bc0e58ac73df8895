/* Gusts against the Gaussian density of all features at once, with its full covariance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/gap/inference/gust.h"
#include "gst/math/linalg.h"
#include "gst/math/random.h"

#define ROWS 200
#define BLOCKS 3
#define ALL (ROWS * BLOCKS)
/* one nuisance, then the winds */
#define COLUMNS (1 + CLOTH_GAP_GUST_COLUMNS)
#define PARTS (BLOCKS * CLOTH_GAP_GUST_PARTS)

static const gdouble prior = 0.3, share = 0.7, precision = 0.04;
static const gdouble overdispersion = 5.;

typedef struct
{
  gdouble c[ALL][COLUMNS], z[ALL];
} Data;

static void
fill (Data * data, gdouble gust, guint64 seed)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint i = 0; i < ALL; i++) {
    for (guint k = 0; k < COLUMNS; k++)
      data->c[i][k] = 3. * cloth_random_gaussian (&random);
    data->z[i] = cloth_random_gaussian (&random) + 2. * data->c[i][0];
  }
  for (guint p = 0; p < PARTS; p++)
    for (guint w = 0; w < CLOTH_GAP_GUST_WAYS; w++) {
      gdouble speed = gust * cloth_random_gaussian (&random) * (w ? 1. : 0.1);
      guint b = p / CLOTH_GAP_GUST_PARTS;

      for (guint i = b * ROWS; i < (b + 1) * ROWS; i++)
        data->z[i] -= speed * data->c[i][1 +
            p % CLOTH_GAP_GUST_PARTS * CLOTH_GAP_GUST_WAYS + w];
    }
}

static ClothNormalEquations *
normal_of (const Data * data)
{
  ClothNormalEquations *n = g_new0 (ClothNormalEquations, 1);

  n->m = COLUMNS;
  n->n_blocks = BLOCKS;
  n->per_block = ROWS;
  n->g = g_new0 (gdouble, BLOCKS * COLUMNS * COLUMNS);
  n->s = g_new0 (gdouble, BLOCKS * COLUMNS);
  n->r = g_new0 (gdouble, BLOCKS);
  for (guint i = 0; i < ALL; i++) {
    const guint b = i / ROWS;

    n->r[b] += data->z[i] * data->z[i];
    for (guint p = 0; p < COLUMNS; p++) {
      n->s[b * COLUMNS + p] += data->c[i][p] * data->z[i];
      for (guint q = 0; q < COLUMNS; q++)
        n->g[(b * COLUMNS + p) * COLUMNS + q] += data->c[i][p] * data->c[i][q];
    }
  }
  return n;
}

/* Logarithm of the density of the residual, its features' noise of variance @phi. */
static gdouble
density (const Data * data, gdouble phi, gdouble intensity)
{
  static gdouble s[ALL * ALL], x[ALL];
  gdouble sum = 0.;

  for (guint i = 0; i < ALL; i++)
    for (guint k = 0; k < ALL; k++) {
      gdouble *to = &s[i * ALL + k];

      *to = (i == k ? phi : 0.) + data->c[i][0] * data->c[k][0] * phi /
          (precision * overdispersion);
      for (guint p = 0; p < CLOTH_GAP_GUST_PARTS; p++)
        for (guint q = 0; q < CLOTH_GAP_GUST_PARTS; q++) {
          gint apart = (gint) (i / ROWS * CLOTH_GAP_GUST_PARTS + p) -
              (gint) (k / ROWS * CLOTH_GAP_GUST_PARTS + q);

          for (guint w = 0; w < CLOTH_GAP_GUST_WAYS; w++)
            *to += intensity * intensity * pow (share, abs (apart)) *
                data->c[i][1 + p * CLOTH_GAP_GUST_WAYS +
                w] * data->c[k][1 + q * CLOTH_GAP_GUST_WAYS + w];
        }
    }
  g_assert_true (cloth_cholesky_factor (ALL, s));
  memcpy (x, data->z, sizeof x);
  cloth_cholesky_solve (ALL, s, x);
  for (guint i = 0; i < ALL; i++)
    sum -= 0.5 * x[i] * data->z[i] + log (s[i * ALL + i]);
  return sum;
}

static gboolean
find (const Data * data, const gboolean * blocks, ClothGapGusts * gusts,
    gdouble * phi)
{
  const guint nuisance = 0;
  g_autoptr (ClothNormalEquations) normal = normal_of (data);
  ClothGapTest test = {
    .normal = normal,.blocks = blocks,.nuisances = &nuisance,.precisions =
        &precision,.n_nuisances = 1,.overdispersion = overdispersion,.gusts = 1
  };
  ClothReducedEquations reduced;
  gdouble weighed = precision * overdispersion;

  g_assert_true (cloth_normal_equations_reduce (normal, blocks, &nuisance,
          &weighed, 1, NULL, 0, &reduced));
  *phi = cloth_gap_test_dispersion (&test, normal, &reduced);
  return cloth_gap_test_gusts (&test, prior, share, gusts);
}

static void
test_evidence (void)
{
  const gboolean blocks[BLOCKS] = { TRUE, TRUE, TRUE };
  const gdouble strengths[] = { 0., 0.3, 2. };

  for (guint i = 0; i < G_N_ELEMENTS (strengths); i++) {
    Data data;
    ClothGapGusts gusts;
    gdouble phi, none, mean = 0.;

    fill (&data, strengths[i], i + 1);
    g_assert_true (find (&data, blocks, &gusts, &phi));
    none = density (&data, phi, 0.);
    for (gdouble times = 0.5; times <= 4.; times *= 2.)
      mean += 0.25 * exp (density (&data, phi, times * prior) - none);
    g_test_message ("gusts of %g: evidence %g, %g m/s along %g°", strengths[i],
        gusts.log_bayes_factor, gusts.intensity, gusts.azimuth);
    g_assert_cmpfloat_with_epsilon (gusts.log_bayes_factor, log (mean), 1e-6);
  }
}

/* What blows along y is found to blow along y, as hard as it does. */
static void
test_wind (void)
{
  const gboolean blocks[BLOCKS] = { TRUE, TRUE, TRUE };
  Data data;
  ClothGapGusts gusts;
  gdouble phi;

  fill (&data, 2., 5);
  g_assert_true (find (&data, blocks, &gusts, &phi));
  g_assert_cmpfloat (fabs (gusts.azimuth), >, 80.);
  g_assert_cmpfloat (fabs (gusts.azimuth), <=, 90.);
  g_assert_cmpfloat_with_epsilon (gusts.intensity, 2., 1.);
}

/* Blocks that do not count change nothing, whatever is in them. */
static void
test_blocks (void)
{
  const gboolean blocks[BLOCKS] = { TRUE, TRUE, FALSE };
  Data data;
  ClothGapGusts one, two;
  gdouble phi;

  fill (&data, 1., 6);
  g_assert_true (find (&data, blocks, &one, &phi));
  for (guint i = 2 * ROWS; i < ALL; i++)
    data.z[i] = 1000.;
  g_assert_true (find (&data, blocks, &two, &phi));
  g_assert_cmpfloat (one.log_bayes_factor, ==, two.log_bayes_factor);
}

static void
test_none (void)
{
  const ClothGapTest test = { NULL };
  ClothGapGusts gusts;

  g_assert_false (cloth_gap_test_gusts (&test, prior, share, &gusts));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gap/gust/evidence", test_evidence);
  g_test_add_func ("/gap/gust/wind", test_wind);
  g_test_add_func ("/gap/gust/blocks", test_blocks);
  g_test_add_func ("/gap/gust/none", test_none);
  return g_test_run ();
}
