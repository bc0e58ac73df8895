/* Where the cloth of a recording was in its first frame, without the noise of that frame: a simulation that
 * begins with it has folds as sharp as its mesh, and bursts.
 *
 * Model: the cloth lies along a polynomial x (u, v) of its flat coordinates, with noise N(0, σ²).
 * Formula: least squares in Legendre polynomials, of the least degree whose rest
 *   Σ|y − x|²/3(n − terms) is no more than σ² but by chance. Cloth with wrinkles higher than the noise has
 *   none, and begins as it was seen.
 * Reference: Morozov, On the solution of functional equations by the method of regularization,
 *   1966 (discrepancy principle).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/start.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/flat-map.h"
#include "gst/math/linalg.h"

/* Highest degree, and the least number of vertices of each term. */
#define MAX_DEGREE 10
#define PER_TERM 3
#define MAX_TERMS ((MAX_DEGREE + 1) * (MAX_DEGREE + 2) / 2)
/* Chance: so many standard deviations of a rest. */
#define CHANCE 2.

/* P₀ … P_n of x in [-1, 1]. */
static void
find_legendre (guint n, gdouble x, gdouble * p)
{
  p[0] = 1.;
  p[1] = x;
  for (guint k = 1; k < n; k++)
    p[k + 1] = ((2. * k + 1.) * x * p[k] - k * p[k - 1]) / (k + 1.);
}

/* All terms up to the highest degree, degree by degree, of every vertex. */
static gdouble *
make_terms (const ClothTopology * t)
{
  gdouble *terms = g_new (gdouble, (gsize) t->n_vertices * MAX_TERMS);
  gdouble low[2], high[2];

  cloth_flat_map_find_extent (t, low, high);
  for (guint v = 0; v < t->n_vertices; v++) {
    gdouble along[2][MAX_DEGREE + 1], *to = terms + (gsize) v * MAX_TERMS;

    for (guint k = 0; k < 2; k++)
      find_legendre (MAX_DEGREE, high[k] > low[k] ?
          (2. * t->uv[2 * v + k] - low[k] - high[k]) / (high[k] - low[k]) : 0.,
          along[k]);
    for (guint degree = 0; degree <= MAX_DEGREE; degree++)
      for (guint i = 0; i <= degree; i++)
        *to++ = along[0][degree - i] * along[1][i];
  }
  return terms;
}

/* The normal equations of some terms, factored, [m][m]; FALSE when the terms can't be told apart. */
static gboolean
factor (guint n, const gdouble * seen, const gdouble * terms, guint m,
    gdouble * normal)
{
  memset (normal, 0, (gsize) m * m * sizeof *normal);
  for (guint v = 0; v < n; v++) {
    const gdouble *t = terms + (gsize) v * MAX_TERMS;

    for (guint i = 0; i < m && seen[v] != 0.; i++)
      for (guint k = 0; k < m; k++)
        normal[i * m + k] += t[i] * t[k];
  }
  return cloth_cholesky_factor (m, normal);
}

/* The polynomial along @values, [m][3]. */
static void
fit (guint n, const gdouble * seen, const gdouble * terms, guint m,
    const gdouble * values, const gdouble * normal, gdouble * coefficients)
{
  gdouble right[3][MAX_TERMS] = { {0.} };

  for (guint v = 0; v < n; v++) {
    const gdouble *t = terms + (gsize) v * MAX_TERMS;

    for (guint i = 0; i < m && seen[v] != 0.; i++)
      for (guint k = 0; k < 3; k++)
        right[k][i] += t[i] * values[3 * v + k];
  }
  for (guint k = 0; k < 3; k++) {
    cloth_cholesky_solve (m, normal, right[k]);
    for (guint i = 0; i < m; i++)
      coefficients[3 * i + k] = right[k][i];
  }
}

static void
evaluate (const gdouble * terms, guint m, const gdouble * coefficients,
    gdouble place[3])
{
  for (guint k = 0; k < 3; k++) {
    place[k] = 0.;
    for (guint i = 0; i < m; i++)
      place[k] += terms[i] * coefficients[3 * i + k];
  }
}

/* Σ|y − x|² of what was seen. */
static gdouble
find_rest (guint n, const gdouble * seen, const gdouble * positions,
    const gdouble * terms, guint m, const gdouble * coefficients)
{
  gdouble sum = 0.;

  for (guint v = 0; v < n; v++) {
    gdouble place[3];

    if (seen[v] == 0.)
      continue;
    evaluate (terms + (gsize) v * MAX_TERMS, m, coefficients, place);
    for (guint k = 0; k < 3; k++)
      sum += pow (positions[3 * v + k] - place[k], 2.);
  }
  return sum;
}

/* Whether the polynomial is known somewhere no worse than what is seen there would be: t (TᵀT)⁻¹ t is its
 * variance over σ². Away from what was seen it grows at once. */
static gboolean
is_known (const gdouble * terms, guint m, const gdouble * normal)
{
  gdouble solved[MAX_TERMS], variance = 0.;

  memcpy (solved, terms, m * sizeof *solved);
  cloth_cholesky_solve (m, normal, solved);
  for (guint i = 0; i < m; i++)
    variance += terms[i] * solved[i];
  return variance <= 1.;
}

/* In place of @values where the polynomial is @known. */
static void
replace (guint n, const gboolean * known, const gdouble * terms, guint m,
    const gdouble * coefficients, gdouble * values)
{
  for (guint v = 0; v < n; v++)
    if (known[v])
      evaluate (terms + (gsize) v * MAX_TERMS, m, coefficients, values + 3 * v);
}

/* @topology: the cloth's mesh, of n vertices
 * @seen: (array length=n): 0 where nothing was seen
 * @sigma: standard deviation of a coordinate, m
 * @positions: (inout) (array): as seen, then where the cloth may have been, [n][3], m; NaN is taken where
 *   nothing was seen. In large holes they stay as they were
 * @velocities: (inout) (optional) (array): likewise, [n][3], m/s
 *
 * Returns: whether they are smoother than what was seen; else they are as they were
 */
gboolean
cloth_start_smooth (const ClothTopology * topology, const gdouble * seen,
    gdouble sigma, gdouble * positions, gdouble * velocities)
{
  const guint n = topology->n_vertices;
  g_autofree gdouble *terms = NULL, *normal = NULL;
  g_autofree gboolean *known = NULL;
  gdouble coefficients[3 * MAX_TERMS];
  guint n_seen = 0;

  for (guint v = 0; v < n; v++)
    n_seen += seen[v] != 0.;
  if (!(sigma > 0.) || !topology->uv)
    return FALSE;
  terms = make_terms (topology);
  normal = g_new (gdouble, MAX_TERMS * MAX_TERMS);
  for (guint degree = 1; degree <= MAX_DEGREE; degree++) {
    const guint m = (degree + 1) * (degree + 2) / 2;
    gdouble count;

    if (m * PER_TERM > n_seen || !factor (n, seen, terms, m, normal))
      return FALSE;
    fit (n, seen, terms, m, positions, normal, coefficients);
    count = 3. * (n_seen - m);
    if (find_rest (n, seen, positions, terms, m, coefficients) > count * sigma *
        sigma * (1. + CHANCE * sqrt (2. / count)))
      continue;
    known = g_new (gboolean, n);
    for (guint v = 0; v < n; v++)
      known[v] = seen[v] != 0.
          || is_known (terms + (gsize) v * MAX_TERMS, m, normal);
    replace (n, known, terms, m, coefficients, positions);
    if (velocities) {
      fit (n, seen, terms, m, velocities, normal, coefficients);
      replace (n, known, terms, m, coefficients, velocities);
    }
    return TRUE;
  }
  return FALSE;
}

/* @recording: a recording
 * @positions: (out) (array): of its first frame, [n][3], m
 * @velocities: (out) (optional) (array): in it, [n][3], m/s
 *
 * Returns: whether they are smoother than what was seen
 */
gboolean
cloth_recording_find_start (const ClothRecording * recording,
    gdouble * positions, gdouble * velocities)
{
  const ClothRecording *r = recording;

  memcpy (positions, r->y, 3 * (gsize) r->n * sizeof *positions);
  if (velocities)
    memcpy (velocities, r->velocity, 3 * (gsize) r->n * sizeof *velocities);
  return cloth_start_smooth (r->scene->topology, r->seen, r->sigma, positions,
      velocities);
}
