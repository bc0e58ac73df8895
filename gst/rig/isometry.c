/* Cloth bends but hardly stretches: points too far from or too near to their neighbours are
 * wrong.
 *
 * A third camera can check a point that two cameras have measured. Where there is none, or
 * where a fold hides a corner and its edge looks like one, the distances from the
 * neighbours are the only check.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/isometry.h"

#include <math.h>

/* A distance may be out of its limits by this many of its standard deviations. */
#define FORGIVEN 3.0

/* By how much the distance of two vertices is out of its limits, metres. */
static gdouble
excess (const ClothIsometry * isometry, const gfloat * positions,
    const gfloat * covariances, guint a, guint b)
{
  /* xx, xy, xz, yy, yz, zz */
  static const gint at[3][3] = { {0, 1, 2}, {1, 3, 4}, {2, 4, 5} };
  const guint apart = a > b ? a - b : b - a;
  /* neighbours in a column are as many vertices apart as a row has */
  const gdouble edge_m = isometry->edge_m[apart == isometry->columns];
  gdouble d[3], length = 0, variance = 0, least, most, out = 0;

  for (gint i = 0; i < 3; i++) {
    d[i] = (gdouble) positions[3 * a + i] - positions[3 * b + i];
    length += d[i] * d[i];
  }
  length = sqrt (length);
  if (!(length > 0))
    return isometry->shortest > 0 ? edge_m : 0;
  if (covariances)
    for (gint i = 0; i < 3; i++)
      for (gint j = 0; j < 3; j++)
        variance += d[i] * d[j] / (length * length)
            * ((gdouble) covariances[6 * a + at[i][j]]
            + covariances[6 * b + at[i][j]]);
  least = isometry->shortest * edge_m;
  most = isometry->longest * edge_m;
  if (isometry->longest > 0 && length > most)
    out = length - most;
  else if (length < least)
    out = least - length;
  return out > FORGIVEN * sqrt (MAX (variance, 0)) ? out : 0;
}

/* The denial of vertex @k: the sum of its excesses over its four neighbours, metres. */
static gdouble
denial (const ClothIsometry * isometry, const gfloat * positions,
    const gfloat * covariances, const gboolean * wrong, guint k)
{
  guint column = k % isometry->columns, row = k / isometry->columns;
  guint near[4], n = 0;
  gdouble sum = 0;

  if (wrong[k] || !isfinite (positions[3 * k]))
    return 0;
  if (column > 0)
    near[n++] = k - 1;
  if (column + 1 < isometry->columns)
    near[n++] = k + 1;
  if (row > 0)
    near[n++] = k - isometry->columns;
  if (row + 1 < isometry->rows)
    near[n++] = k + isometry->columns;
  for (guint i = 0; i < n; i++)
    if (!wrong[near[i]] && isfinite (positions[3 * near[i]]))
      sum += excess (isometry, positions, covariances, k, near[i]);
  return sum;
}

static gdouble
size (const gfloat * covariances, guint k)
{
  return covariances ? (gdouble) covariances[6 * k]
      + covariances[6 * k + 3] + covariances[6 * k + 5] : 0;
}

/* Behind the denials of all vertices, @denials holds the greatest one of each row. */
static void
find_most_of_row (const ClothIsometry * isometry, guint row, gdouble * denials)
{
  const gdouble *of_row = denials + row * isometry->columns;
  gdouble most = 0;

  for (guint i = 0; i < isometry->columns; i++)
    most = MAX (most, of_row[i]);
  denials[isometry->columns * isometry->rows + row] = most;
}

/* The vertex with the greatest denial; of equal ones the least certain one, of these the
 * first. The number of all vertices when every denial is 0. */
static guint
find_worst (const ClothIsometry * isometry, const gfloat * covariances,
    const gdouble * denials)
{
  const guint columns = isometry->columns, rows = isometry->rows;
  const gdouble *most_of_row = denials + columns * rows;
  guint worst = columns * rows;
  gdouble most = 0;

  for (guint row = 0; row < rows; row++)
    most = MAX (most, most_of_row[row]);
  for (guint row = 0; most > 0 && row < rows; row++)
    for (guint k = row * columns;
        most_of_row[row] == most && k < (row + 1) * columns; k++)
      if (denials[k] == most && (worst == columns * rows
              || size (covariances, k) > size (covariances, worst)))
        worst = k;
  return worst;
}

/* @isometry: the grid and its limits
 * @positions: (array): 3·columns·rows, metres; NaN: not seen
 * @covariances: (array) (nullable): 6·columns·rows: xx, xy, xz, yy, yz, zz, m²
 * @wrong: (out) (array): columns·rows: whether the vertex can't be where it is
 * @denials: (out) (array): (columns + 1)·rows, room to work in
 *
 * Finds the vertices whose distances from their neighbours no cloth allows. The one with
 * the greatest denial is called wrong first; its distances then no longer count for its
 * neighbours. Where two vertices have only their common distance wrong, the less certain
 * one is called wrong.
 *
 * Returns: number of wrong vertices
 */
guint
cloth_isometry_check (const ClothIsometry * isometry,
    const gfloat * positions, const gfloat * covariances, gboolean * wrong,
    gdouble * denials)
{
  const guint columns = isometry->columns, rows = isometry->rows;
  const guint n = columns * rows;
  guint found = 0;

  for (guint k = 0; k < n; k++)
    wrong[k] = FALSE;
  for (guint k = 0; k < n; k++)
    denials[k] = denial (isometry, positions, covariances, wrong, k);
  for (guint row = 0; row < rows; row++)
    find_most_of_row (isometry, row, denials);
  for (;;) {
    const guint worst = find_worst (isometry, covariances, denials);
    const guint row = worst / columns, column = worst % columns;

    if (worst == n)
      return found;
    wrong[worst] = TRUE;
    found++;
    /* It no longer says anything of its neighbours. */
    for (guint j = row > 0 ? row - 1 : 0; j < MIN (row + 2, rows); j++) {
      for (guint i = column > 0 ? column - 1 : 0; i < MIN (column + 2, columns);
          i++) {
        if (i == column || j == row)
          denials[j * columns + i] = denial (isometry, positions, covariances,
              wrong, j * columns + i);
      }
      find_most_of_row (isometry, j, denials);
    }
  }
}
