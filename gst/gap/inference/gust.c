/* Decides how much the residual supports gusts: winds that change from one moment to the next.
 *
 * No two gusts are alike, so there is no derivative with respect to them. But the observer forgets
 * within a tenth of a second: a gust is a wind of its own in each third of a block of time.
 * Model: the wind along the ground in these parts is an Ornstein–Uhlenbeck process (1930) with the
 * standard deviation τ, and of its value a share a = exp (−Δt/T) is left after each part. It is a
 * Markov chain, so that its precision K⁻¹/τ² is tridiagonal.
 * Formula, with the normal equations G, b of the nuisances and of all winds w together:
 *   log p (z | τ) = ½ bᵀ(G/φ + Λ)⁻¹b/φ² − ½ log det (G/φ + Λ) + ½ log det Λ + constant
 *   log Bayes factor = log of the mean over τ of p (z | τ)/p (z | no wind)
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/gust.h"

#include <math.h>
#include <string.h>

/* Intensities that are tried, in priors of the effect. */
static const gdouble intensities[] = { 0.5, 1., 2., 4. };

/* Of wind along the ground. */
#define N_WAYS CLOTH_GAP_GUST_WAYS
#define N_COLUMNS CLOTH_GAP_GUST_COLUMNS

/* Normal equations of the nuisances and, behind them, of the wind in every part of time. */
typedef struct
{
  guint q, n;
  gdouble *a, *b;
} System;

static void
system_clear (System * system)
{
  g_free (system->a);
  g_free (system->b);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (System, system_clear);

static void
assemble (const ClothGapTest * test, System * system)
{
  const ClothNormalEquations *normal = test->normal;
  const guint m = normal->m, q = test->n_nuisances;
  const guint all = q + N_COLUMNS * normal->n_blocks;

  system->q = q;
  system->n = all - q;
  system->a = g_new0 (gdouble, (gsize) all * all + 1);
  system->b = g_new0 (gdouble, all + 1);
  for (guint b = 0; b < normal->n_blocks; b++) {
    const gdouble *g = normal->g + (gsize) b * m * m;
    const gdouble *s = normal->s + (gsize) b * m;

    for (guint i = 0; i < q + N_COLUMNS && test->blocks[b]; i++) {
      const guint from = i < q ? test->nuisances[i] : test->gusts + i - q;
      const guint to = i < q ? i : i + N_COLUMNS * b;

      for (guint j = 0; j < q + N_COLUMNS; j++)
        system->a[(gsize) to * all + (j < q ? j : j + N_COLUMNS * b)] +=
            g[(gsize) from * m + (j < q ? test->nuisances[j] : test->gusts +
                j - q)];
      system->b[to] -= s[from];
    }
  }
  for (guint i = 0; i < q; i++)
    system->a[(gsize) i * all + i] += test->precisions[i] *
        test->overdispersion;
}

/* Precision of a process of Ornstein and Uhlenbeck of variance 1 at steps between which
 * this share is left: it is a Markov chain. */
static gdouble
ornstein (guint n, gdouble share, guint i, guint k)
{
  const gdouble kick = 1. - share * share;

  if (i == k)
    return n == 1 ? 1. : (i == 0 || i + 1 == n ? 1. : 1. +
        share * share) / kick;
  return i + 1 == k || k + 1 == i ? -share / kick : 0.;
}

/* Solves for the nuisances and, with an intensity, the winds. Returns twice the logarithm
 * of the probability of the residual, but for what is alike for all intensities. */
static gdouble
solve (const System * system, gdouble phi, gdouble intensity, gdouble share,
    gdouble * x)
{
  const guint all = system->q + system->n;
  const guint size = intensity > 0. ? all : system->q;
  const guint n_parts = system->n / N_WAYS;
  g_auto (ClothPosterior) posterior = { 0 };
  gdouble gained;

  cloth_posterior_init (&posterior, size);
  for (guint i = 0; i < size; i++) {
    gdouble *a = posterior.precision + (gsize) i * size;

    memcpy (a, system->a + (gsize) i * all, size * sizeof *a);
    posterior.mean[i] = system->b[i];
    for (guint k = system->q; k < size && i >= system->q; k++)
      if ((i - k) % N_WAYS == 0)
        a[k] += phi / (intensity * intensity) *
            ornstein (n_parts, share, (i - system->q) / N_WAYS,
            (k - system->q) / N_WAYS);
  }
  if (!size)
    return 0.;
  if (!cloth_posterior_solve (&posterior))
    return NAN;
  gained = -cloth_posterior_log_determinant (&posterior);
  /* of the winds' prior: the chain's determinant is that of its kicks */
  if (size > system->q)
    gained += system->n * log (phi / (intensity * intensity)) -
        N_WAYS * (n_parts - 1.) * log (1. - share * share);
  memcpy (x, posterior.mean, size * sizeof *x);
  for (guint i = 0; i < size; i++)
    gained += x[i] * system->b[i] / phi;
  return gained;
}

/* @test: what is tested; its blocks of time must follow each other, and @test->gusts be set
 * @intensity: prior of the gusts' standard deviation, m/s
 * @share: of a gust that is left after one part of a block
 * @gusts: (out): what was found
 *
 * Compares winds along the ground that change from part to part, a process of Ornstein and
 * Uhlenbeck of unknown intensity, to none at all.
 *
 * Returns: whether the equations could be solved
 */
gboolean
cloth_gap_test_gusts (const ClothGapTest * test, gdouble intensity,
    gdouble share, ClothGapGusts * gusts)
{
  g_auto (System) system = { 0 };
  ClothReducedEquations reduced;
  g_autofree gdouble *x = NULL;
  gdouble phi, none, sum = 0., best = -INFINITY;
  gdouble xx = 0., xy = 0., yy = 0.;

  *gusts = (ClothGapGusts) {
  0};
  if (!test->gusts || !cloth_gap_test_reduce (test, test->normal,
          test->blocks, NULL, 0, &reduced))
    return FALSE;
  phi = cloth_gap_test_dispersion (test, test->normal, &reduced);
  assemble (test, &system);
  x = g_new (gdouble, system.q + system.n + 1);
  none = solve (&system, phi, 0., share, x);
  for (guint i = 0; i < G_N_ELEMENTS (intensities); i++) {
    gdouble gained = 0.5 * (solve (&system, phi, intensities[i] * intensity,
            share, x) - none);

    if (isnan (gained))
      return FALSE;
    if (gained > best) {
      sum *= exp (best - gained);
      best = gained;
      xx = xy = yy = 0.;
      for (guint b = 0; b < system.n / N_WAYS; b++) {
        const gdouble *w = x + system.q + N_WAYS * b;

        xx += w[0] * w[0];
        xy += w[0] * w[1];
        yy += w[1] * w[1];
      }
    }
    sum += exp (gained - best);
  }
  gusts->log_bayes_factor = best + log (sum / G_N_ELEMENTS (intensities));
  gusts->intensity = sqrt ((xx + yy) / (system.n / N_WAYS));
  gusts->azimuth = 0.5 * atan2 (2. * xy, xx - yy) * 180. / G_PI;
  return TRUE;
}
