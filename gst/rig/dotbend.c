/* Where the centre of gravity of a dot on bent cloth lies beside the dot's centre.
 *
 * A detector gives the centre of gravity of a dot's picture. Let the cloth near a dot be
 * X(u, v) = X + Xu u + Xv v + ½ (Xuu u² + 2 Xuv u v + Xvv v²). The area of its picture at
 * (u, v) goes with the normal times the way d to the camera over the cube of the depth z,
 * (Xu × Xv)·d / z³: to first order with 1 + a u + b v. Over a disc of radius r the means of
 * u² and v² are r²/4 and that of u v is 0, so the centre of gravity is the picture of
 * X + r²/8 (Xuu + Xvv) + r²/4 (a Xu + b Xv), once more a and b are less by zu / z and
 * zv / z, for a mean of pictures is not the picture of a mean.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/dotbend.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"

/* Derivatives of a vertex. */
enum
{ U, V, UU, VV, UV, N_DERIVATIVES };

typedef gdouble Derivatives[N_DERIVATIVES][3];

struct _ClothDotBend
{
  guint columns, rows;
  gdouble pitch, radius;
  gdouble *position;            /* 3 a vertex; NaN: not known */
  Derivatives *derivative;      /* NaN: not known */
  gdouble *plane[CLOTH_TRIANGULATE_MAX_CAMERAS];        /* x, y, xx, xy, yy */
};

/* @columns: dots in a row of the grid
 * @rows: dots in a column
 * @pitch: distance of neighbours on the flat cloth, over 0, the unit of the positions
 * @diameter: of a dot, the same unit
 *
 * Returns: (transfer full): memory for the correction of a grid of dots
 */
ClothDotBend *
cloth_dot_bend_new (guint columns, guint rows, gdouble pitch, gdouble diameter)
{
  ClothDotBend *self = g_new0 (ClothDotBend, 1);
  const gsize n = (gsize) columns * rows;

  self->columns = columns;
  self->rows = rows;
  self->pitch = pitch;
  self->radius = diameter / 2;
  self->position = g_new (gdouble, 3 * n);
  self->derivative = g_new (Derivatives, n);
  return self;
}

/* @self: (nullable) (transfer full): what cloth_dot_bend_new () gave
 */
void
cloth_dot_bend_free (ClothDotBend * self)
{
  if (self == NULL)
    return;
  for (guint i = 0; i < CLOTH_TRIANGULATE_MAX_CAMERAS; i++)
    g_free (self->plane[i]);
  g_free (self->position);
  g_free (self->derivative);
  g_free (self);
}

/* First and second differences along one direction: @step vertices on, @at of @n. At an
 * end, or beside a dot that is not known, the second difference next to it stands in. */
static void
differ (const ClothDotBend * self, guint vertex, guint step, guint at, guint n,
    gdouble first[3], gdouble second[3])
{
  const gdouble h = self->pitch;
  const gdouble *p = self->position + 3 * (gsize) vertex;

  for (gint shift = 0; shift < 3; shift++) {
    /* the middle one of three: this vertex, the next, the one before */
    const gint middle = shift == 0 ? 0 : shift == 1 ? 1 : -1;
    const gdouble *m = p + 3 * middle * (gint) step;
    const gdouble *a = m - 3 * (gint) step, *b = m + 3 * (gint) step;

    if ((gint) at + middle < 1 || (gint) at + middle + 1 >= (gint) n
        || !isfinite (a[0] + m[0] + b[0]))
      continue;
    for (gint k = 0; k < 3; k++) {
      second[k] = (a[k] + b[k] - 2 * m[k]) / (h * h);
      first[k] = (b[k] - a[k]) / (2 * h) - middle * h * second[k];
    }
    return;
  }
  first[0] = second[0] = NAN;
}

/* @self: memory for the correction
 * @positions: (array): 3 a dot, row by row: where the dots are as far as is known, NaN
 *   where not
 *
 * Finds slopes and curvatures from differences to the neighbours.
 *
 * Returns: for how many dots they are known
 */
guint
cloth_dot_bend_set_positions (ClothDotBend * self, const gfloat * positions)
{
  const guint columns = self->columns, rows = self->rows;
  guint known = 0;

  for (guint i = 0; i < 3 * columns * rows; i++)
    self->position[i] = positions[i];
  for (guint i = 0; i < columns * rows; i++) {
    const guint column = i % columns, row = i / columns;
    gdouble (*d)[3] = self->derivative[i];

    d[U][0] = NAN;
    if (!isfinite (self->position[3 * (gsize) i]))
      continue;
    differ (self, i, columns, row, rows, d[V], d[VV]);
    if (!isfinite (d[V][0]))
      continue;
    differ (self, i, 1, column, columns, d[U], d[UU]);
    known += isfinite (d[U][0]);
    memset (d[UV], 0, sizeof d[UV]);
    if (column > 0 && row > 0 && column + 1 < columns && row + 1 < rows) {
      const gdouble *p = self->position + 3 * (gsize) i;
      const gdouble *below = p + 3 * columns, *above = p - 3 * columns;
      const gdouble h = self->pitch;

      if (isfinite (below[3] + above[-3] + above[3] + below[-3]))
        for (gint k = 0; k < 3; k++)
          d[UV][k] = (below[3 + k] + above[k - 3] - above[3 + k]
              - below[k - 3]) / (4 * h * h);
    }
  }
  return known;
}

/* (a × b)·c */
static gdouble
triple (const gdouble a[3], const gdouble b[3], const gdouble c[3])
{
  gdouble ab[3];

  cloth_vec3_cross (a, b, ab);
  return cloth_vec3_dot (c, ab);
}

/* The place whose picture is the centre of gravity of the dot's. */
static void
gravity (const ClothDotBend * self, guint vertex, const ClothCamera * camera,
    const gdouble eye[3], gdouble G[3])
{
  const gdouble (*d)[3] = (const gdouble (*)[3]) self->derivative[vertex];
  const gdouble *X = self->position + 3 * (gsize) vertex;
  const gdouble r = self->radius, r2 = r * r;
  const gdouble *axis = camera->R + 6;
  gdouble view[3], w, z, a, b, steep;

  cloth_vec3_subtract (eye, X, view);
  w = triple (d[U], d[V], view);
  z = cloth_vec3_dot (axis, X) + camera->t[2];
  a = (triple (d[UU], d[V], view) + triple (d[U], d[UV], view)) / w;
  b = (triple (d[UV], d[V], view) + triple (d[U], d[VV], view)) / w;
  for (gint k = 0; k < 3; k++) {
    a -= 4 * axis[k] * d[U][k] / z;
    b -= 4 * axis[k] * d[V][k] / z;
  }
  /* seen along the cloth, part of the dot is hidden: no area is less than none */
  steep = r * hypot (a, b);
  if (!isfinite (steep))
    a = b = 0;
  else if (steep > 1) {
    a /= steep;
    b /= steep;
  }
  for (gint k = 0; k < 3; k++)
    G[k] = X[k] + r2 / 8 * (d[UU][k] + d[VV][k])
        + r2 / 4 * (a * d[U][k] + b * d[V][k]);
}

/* @self: what cloth_dot_bend_set_positions () has been called on
 * @index: which camera, below %CLOTH_TRIANGULATE_MAX_CAMERAS
 * @camera: the camera
 * @view: what it saw: centres of gravity, by dot
 * @corrected: (out): the same, moved to where the dots' centres would be seen; its arrays
 *   belong to @self until the next call for this camera
 *
 * Takes the effect of the cloth's bend off what a camera saw. Where the bend is not known
 * nothing is changed. The neighbours tell the mean of the curvature around a dot: a crease
 * inside the dot moves it more, one beside it not at all, so the correction is as uncertain
 * as it is large, and its square is added to the covariance.
 */
void
cloth_dot_bend_correct (ClothDotBend * self, guint index,
    const ClothCamera * camera, const ClothTriangulateView * view,
    ClothTriangulateView * corrected)
{
  const gsize n = (gsize) self->columns * self->rows;
  const gdouble *R = camera->R, *t = camera->t;
  gdouble *plane[5], eye[3];

  g_return_if_fail (index < CLOTH_TRIANGULATE_MAX_CAMERAS);

  if (!self->plane[index])
    self->plane[index] = g_new (gdouble, G_N_ELEMENTS (plane) * n);
  for (guint k = 0; k < G_N_ELEMENTS (plane); k++)
    plane[k] = self->plane[index] + k * n;
  for (gint k = 0; k < 3; k++)
    eye[k] = -(R[k] * t[0] + R[3 + k] * t[1] + R[6 + k] * t[2]);
  for (guint i = 0; i < n; i++) {
    gdouble G[3], centre[2], seen[2];

    plane[0][i] = view->x[i];
    plane[1][i] = view->y[i];
    plane[2][i] = view->xx ? view->xx[i] : 1;
    plane[3][i] = view->xy ? view->xy[i] : 0;
    plane[4][i] = view->yy ? view->yy[i] : plane[2][i];
    if (!isfinite (view->x[i]) || !isfinite (self->derivative[i][U][0]))
      continue;
    gravity (self, i, camera, eye, G);
    if (cloth_camera_project (camera, G, seen, NULL, NULL)
        && cloth_camera_project (camera, self->position + 3 * (gsize) i,
            centre, NULL, NULL)) {
      const gdouble dx = centre[0] - seen[0], dy = centre[1] - seen[1];

      plane[0][i] += dx;
      plane[1][i] += dy;
      plane[2][i] += dx * dx;
      plane[3][i] += dx * dy;
      plane[4][i] += dy * dy;
    }
  }
  *corrected = (ClothTriangulateView) {
  plane[0], plane[1], plane[2], plane[3], plane[4]};
}

/* Whether the differences to all of its neighbours are known. */
static gboolean
is_inside (const ClothDotBend * self, guint vertex)
{
  const guint column = vertex % self->columns, row = vertex / self->columns;
  const gdouble *p = self->position + 3 * (gsize) vertex;

  return column > 0 && row > 0 && column + 1 < self->columns
      && row + 1 < self->rows
      && isfinite (p[0] + p[-3] + p[3] + *(p - 3 * self->columns)
      + p[3 * self->columns]);
}

/* @self: the correction
 * @positions: (array): 3 a dot: the dots with the correction, NaN where not known
 * @covariances: (array): 6 a dot, xx, xy, xz, yy, yz, zz: to be added to
 *
 * What all cameras share of the correction's error doesn't show in how they agree. It is
 * taken to be as large as what the correction did to the place, and, since light that
 * falls unevenly on a bent dot shifts it in its plane, each way as large as the dot's mean
 * depth below or above its centre. Where not all neighbours are known it is as large as
 * the mean correction of the others, each way.
 */
void
cloth_dot_bend_add_doubt (const ClothDotBend * self, const gfloat * positions,
    gfloat * covariances)
{
  static const guint at[6][2] =
      { {0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2} };
  const gdouble r2 = self->radius * self->radius;
  const guint n = self->columns * self->rows;
  gdouble mean = 0;
  guint n_inside = 0;

  for (gint pass = 0; pass < 2; pass++) {
    for (guint i = 0; i < n; i++) {
      const gdouble (*d)[3] = (const gdouble (*)[3]) self->derivative[i];
      const gboolean inside = is_inside (self, i);
      gdouble shift[3] = { 0 }, each = mean, squared;

      if (!isfinite (positions[3 * i]))
        continue;
      for (gint k = 0; k < 3 && isfinite (d[U][0]); k++)
        shift[k] = positions[3 * i + k] - self->position[3 * (gsize) i + k];
      squared = cloth_vec3_dot (shift, shift);
      if (pass == 0) {
        if (inside) {
          mean += squared;
          n_inside++;
        }
        continue;
      }
      if (inside) {
        each = 0;
        for (gint k = 0; k < 3; k++)
          each += pow (r2 / 8 * (d[UU][k] + d[VV][k]), 2);
      }
      for (gint k = 0; k < 6; k++)
        covariances[6 * i + k] += (gfloat) (shift[at[k][0]] * shift[at[k][1]]
            + (at[k][0] == at[k][1] ? each : 0));
    }
    if (n_inside > 0)
      mean /= n_inside;
    n_inside = 0;
  }
}
