/* Where a window of a print on bent cloth is found beside its middle.
 *
 * Vertices of a printed cloth are placed by windows of the film that are held against the flat
 * print, with a warp of second order. How a vertex is then off depends on how the cloth's
 * bending is spread between it and its neighbours, which the neighbours don't tell. Along a
 * row or a column let h be their distance and D = p₊ + p₋ − 2 p their second difference.
 * Spread evenly, f(s) = D s² / 2h², second order tells the place exactly. All in a crease at
 * the vertex, f(s) = D |s| / 2h, the parabola that fits best over −R ≤ s ≤ R is at
 * 3/16 R · D / 2h = 3/32 (R/h) D there. The middle of both is taken, and half their
 * distance as its uncertainty, which all cameras share.
 *
 * What is known of D is noisy, the more the closer the cameras stand together, and to move a
 * vertex away from its neighbours by noise makes it noisier. So D counts by the share
 * 1 − trace (Σ₊ + Σ₋ + 4 Σ) / |D|², or not at all (W. James and C. Stein, “Estimation with
 * quadratic loss”, 1961).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/windowbend.h"

#include <math.h>

#include "gst/math/vec3.h"

/* How far a crease would move a vertex: what of D over R/h. */
#define CREASE (3 / 32.0)

/* R/h in the mean of the cameras that see @vertex; beyond its neighbours no window of use
 * reaches. */
static gdouble
get_reach (const ClothRig * rig, const ClothTriangulateView * views,
    guint vertex, gdouble radius_px, const gdouble before[3],
    const gdouble after[3])
{
  gdouble sum = 0;
  guint n = 0;

  for (guint c = 0; c < rig->n_cameras; c++) {
    gdouble a[2], b[2];

    if (!views[c].x || !isfinite (views[c].x[vertex])
        || !cloth_camera_project (&rig->cameras[c], before, a, NULL, NULL)
        || !cloth_camera_project (&rig->cameras[c], after, b, NULL, NULL))
      continue;
    sum += MIN (radius_px / (hypot (a[0] - b[0], a[1] - b[1]) / 2), 1);
    n++;
  }
  return n > 0 ? sum / n : 0;
}

/* Adds how far a crease across one direction would move @vertex; FALSE: a neighbour is not
 * known. */
static gboolean
add_crease (const ClothRig * rig, const ClothTriangulateView * views,
    const gfloat * positions, const gfloat * covariances, guint vertex,
    guint step, gdouble radius_px, gdouble crease[3])
{
  static const gdouble weights[3] = { 1, 4, 1 };
  gdouble p[3][3], second[3], noise = 0, reach, share;

  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 3; k++)
      p[i][k] = positions[3 * (vertex + i * step - step) + k];
  if (!isfinite (p[0][0] + p[1][0] + p[2][0]))
    return FALSE;
  for (guint i = 0; i < 3; i++) {
    const gfloat *c = covariances + 6 * (vertex + i * step - step);

    noise += weights[i] * (c[0] + c[3] + c[5]);
  }
  for (guint k = 0; k < 3; k++)
    second[k] = p[0][k] + p[2][k] - 2 * p[1][k];
  share = 1 - noise / cloth_vec3_dot (second, second);
  if (!(share > 0))
    return TRUE;
  reach = get_reach (rig, views, vertex, radius_px, p[0], p[2]);
  for (guint k = 0; k < 3; k++)
    crease[k] += CREASE * reach * share * second[k];
  return TRUE;
}

/* @columns: vertices in a row of the grid
 * @rows: vertices in a column
 * @radius_px: half the edge of the windows in the film, px
 * @rig: the cameras
 * @views: (array): what each saw: places of windows
 * @positions: (array) (inout): 3 a vertex, m, NaN where not known
 * @covariances: (array) (inout): 6 a vertex, xx, xy, xz, yy, yz, zz, m²
 * @room: (array): 3 a vertex
 *
 * Moves each vertex halfway to where it is if the cloth is creased there, and adds the square
 * of that to its covariance. A vertex some of whose neighbours are not known stays, and is
 * as uncertain, each way, as the others are in the mean.
 */
void
cloth_window_bend_correct (guint columns, guint rows, gdouble radius_px,
    const ClothRig * rig, const ClothTriangulateView * views,
    gfloat * positions, gfloat * covariances, gdouble * room)
{
  static const guint at[6][2] =
      { {0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2} };
  const guint n = columns * rows;
  gdouble mean = 0;
  guint n_known = 0;

  for (guint i = 0; i < n; i++) {
    const guint column = i % columns, row = i / columns;
    gdouble *half = room + 3 * (gsize) i;

    half[0] = half[1] = half[2] = 0;
    if (column == 0 || row == 0 || column + 1 == columns || row + 1 == rows
        || !add_crease (rig, views, positions, covariances, i, 1, radius_px,
            half)
        || !add_crease (rig, views, positions, covariances, i, columns,
            radius_px, half)) {
      half[0] = NAN;
      continue;
    }
    for (guint k = 0; k < 3; k++)
      half[k] /= 2;
    mean += cloth_vec3_dot (half, half) / 3;
    n_known++;
  }
  mean /= MAX (n_known, 1);
  for (guint i = 0; i < n; i++) {
    const gdouble *half = room + 3 * (gsize) i;
    const gboolean known = isfinite (half[0]);

    for (guint k = 0; k < 3 && known; k++)
      positions[3 * i + k] -= (gfloat) half[k];
    for (guint k = 0; k < 6; k++)
      covariances[6 * i + k] += (gfloat) (known ? half[at[k][0]]
          * half[at[k][1]] : at[k][0] == at[k][1] ? mean : 0);
  }
}
