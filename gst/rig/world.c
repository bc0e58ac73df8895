/* Where the world of a rig lies, and which way is up.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/world.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"
#include "gst/rig/planar.h"
#include "gst/rig/rotation.h"

/* A camera this close to the origin, and to the axes, is where the world was put. */
#define AT_ORIGIN 1e-6

/* Of a corner, px: enough for a start, and none is left out. */
#define BOARD_NOISE 0.5

static gdouble
distance (const gdouble * a, const gdouble * b)
{
  gdouble d[3];

  cloth_vec3_subtract (a, b, d);
  return cloth_vec3_length (d);
}

static void
centre (const ClothCamera * camera, gdouble C[3])
{
  cloth_mat3_vec_t (camera->R, camera->t, C);
  for (gint i = 0; i < 3; i++)
    C[i] = -C[i];
}

/* @rig: a rig
 *
 * A calibration puts the world into a camera when it knows nothing better: its origin is
 * that camera's centre, its axes are those of the picture. Up is then up in the picture.
 *
 * Returns: (transfer none) (nullable): the camera whose frame the world is.
 */
const ClothCamera *
cloth_world_camera (const ClothRig * rig)
{
  for (guint c = 0; c < rig->n_cameras; c++) {
    const ClothCamera *camera = &rig->cameras[c];
    gboolean at = cloth_vec3_length (camera->t) < AT_ORIGIN;

    for (gint i = 0; i < 9; i++)
      at = at && (fabs (camera->R[i]) < AT_ORIGIN
          || fabs (fabs (camera->R[i]) - 1) < AT_ORIGIN);
    if (at)
      return camera;
  }
  return NULL;
}

/* @camera: a camera of the rig
 * @world: (out): its centre; x to its right, y along its view, z up in its picture
 */
void
cloth_world_of_camera (const ClothCamera * camera, ClothWorld * world)
{
  static const gdouble axes[9] = { 1, 0, 0, 0, 0, -1, 0, 1, 0 };

  cloth_mat3_mul_tn (camera->R, axes, world->R);
  centre (camera, world->t);
}

static gboolean
parse_line (const ClothRig * rig, gchar * line, ClothWorldPoint * point,
    const gchar * where, GError ** error)
{
  g_auto (GStrv) words = g_strsplit (line, ",", 7);
  const ClothCamera *camera;
  gdouble values[5];

  if (g_strv_length (words) != 6)
    return cloth_rig_invalid (error, where, "", "give camera,x,y,X,Y,Z: where "
        "in its picture (px) the camera sees the point that is at X, Y, Z (m) "
        "in the world");
  camera = cloth_rig_find (rig, g_strstrip (words[0]));
  if (!camera)
    return cloth_rig_invalid (error, where, "camera",
        "the rig has no \"%.200s\"", words[0]);
  for (guint i = 0; i < 5; i++) {
    gchar *end;

    values[i] = g_ascii_strtod (g_strstrip (words[1 + i]), &end);
    if (end == words[1 + i] || *end || !isfinite (values[i])
        || fabs (values[i]) > 1e6)
      return cloth_rig_invalid (error, where, "", "\"%.40s\" is not a number "
          "within ±10⁶", words[1 + i]);
  }
  point->camera = (guint) (camera - rig->cameras);
  memcpy (point->px, values, sizeof point->px);
  memcpy (point->world, values + 2, sizeof point->world);
  return TRUE;
}

/* @rig: whose cameras are named
 * @data: lines camera,x,y,X,Y,Z; empty ones and what follows a # are left out
 * @length: its bytes
 * @error: #ClothRigError, naming the line
 *
 * Returns: (transfer full) (element-type ClothWorldPoint): the points, or %NULL.
 */
GArray *
cloth_world_points_parse (const ClothRig * rig, const gchar * data,
    gsize length, GError ** error)
{
  g_autoptr (GArray) points =
      g_array_new (FALSE, FALSE, sizeof (ClothWorldPoint));
  g_autofree gchar *text = g_strndup (length ? data : "", length);
  gchar *line = text;

  for (guint number = 1; line; number++) {
    gchar *next = strchr (line, '\n'), *comment;
    g_autofree gchar *where = g_strdup_printf ("line %u", number);
    ClothWorldPoint point;

    if (next)
      *next++ = 0;
    comment = strchr (line, '#');
    if (comment)
      *comment = 0;
    if (*g_strstrip (line)) {
      if (points->len == CLOTH_WORLD_MAX_POINTS) {
        cloth_rig_invalid (error, where, "", "more than %d points",
            CLOTH_WORLD_MAX_POINTS);
        return NULL;
      }
      if (!parse_line (rig, line, &point, where, error))
        return NULL;
      g_array_append_val (points, point);
    }
    line = next;
  }
  return g_steal_pointer (&points);
}

/* The point nearest to the rays of all its views: Σ (I − d d') (X − C) = 0. */
static gboolean
triangulate (const ClothRig * rig, guint n, const ClothWorldPoint * points,
    const gdouble world[3], gdouble X[3], GError ** error)
{
  gdouble A[9] = { 0, }, L[9];
  guint n_views = 0;

  memset (X, 0, 3 * sizeof (gdouble));
  for (guint i = 0; i < n; i++) {
    const ClothCamera *camera = &rig->cameras[points[i].camera];
    gdouble ray[3] = { 0, 0, 1 }, d[3], C[3], length;
    gdouble px[2] = { points[i].px[0], points[i].px[1] };

    if (memcmp (points[i].world, world, 3 * sizeof (gdouble)) != 0)
      continue;
    if (!cloth_camera_undistort_points (camera, 1, px, px + 1, ray, ray + 1,
            NULL))
      return cloth_rig_invalid (error, camera->name, "",
          "its lens does not reach %g, %g", px[0], px[1]);
    cloth_mat3_vec_t (camera->R, ray, d);
    length = cloth_vec3_length (d);
    centre (camera, C);
    for (gint j = 0; j < 3; j++) {
      for (gint k = 0; k < 3; k++) {
        gdouble m = (j == k) - d[j] * d[k] / (length * length);

        A[3 * j + k] += m;
        X[j] += m * C[k];
      }
    }
    n_views++;
  }
  memcpy (L, A, sizeof L);
  if (n_views < 2 || !cloth_cholesky_factor (3, L))
    return cloth_rig_invalid (error, "points", "",
        "the one at %g, %g, %g must be "
        "given as two cameras see it that look from different places", world[0],
        world[1], world[2]);
  cloth_cholesky_solve (3, L, X);
  return TRUE;
}

/* The shortest turn of one direction onto another. */
static void
turn (const gdouble from[3], const gdouble to[3], gdouble R[9])
{
  gdouble axis[3], sine, angle;

  cloth_vec3_cross (from, to, axis);
  sine = cloth_vec3_length (axis);
  angle = atan2 (sine, cloth_vec3_dot (from, to));
  if (sine < 1e-12) {
    /* Half a turn about any axis across. */
    gdouble other[3] = { fabs (from[0]) < 0.5, fabs (from[0]) >= 0.5, 0 };

    cloth_vec3_cross (from, other, axis);
    sine = cloth_vec3_length (axis);
  }
  for (gint i = 0; i < 3; i++)
    axis[i] *= angle / sine;
  cloth_rotation_from_vector (axis, R);
}

/* The first point and the one farthest from it; returns how far others are off their line. */
static gdouble
widest (guint n, const gdouble * X, guint * farthest)
{
  gdouble best = 0, off = 0;

  *farthest = 0;
  for (guint i = 1; i < n; i++) {
    gdouble d = distance (X, X + 3 * i);

    if (d > best) {
      best = d;
      *farthest = i;
    }
  }
  for (guint i = 0; i < n; i++) {
    gdouble a[3], b[3], c[3];

    cloth_vec3_subtract (X + 3 * *farthest, X, a);
    cloth_vec3_subtract (X + 3 * i, X, b);
    cloth_vec3_cross (a, b, c);
    if (best > 0)
      off = fmax (off, cloth_vec3_length (c) / best);
  }
  return off;
}

/* From the world's points onto those seen, both about their middles. Points on a line leave
 * a turn about it open; then the rig is turned as little as may be. */
static gboolean
align (guint n, const gdouble * W, const gdouble * X, gdouble R[9],
    GError ** error)
{
  gdouble M[9] = { 0, }, size;
  guint far = 0;
  gdouble off = n > 0 ? widest (n, W, &far) : 0;

  size = n > 0 ? distance (W, W + 3 * far) : 0;
  if (!(size > 0) || !(distance (X, X + 3 * far) > 0))
    return cloth_rig_invalid (error, "points", "",
        "two at different places are needed at least");
  if (off < 1e-3 * size) {
    gdouble w[3], x[3], length;

    cloth_vec3_subtract (W + 3 * far, W, w);
    cloth_vec3_subtract (X + 3 * far, X, x);
    length = cloth_vec3_length (x);
    for (gint i = 0; i < 3; i++) {
      w[i] /= size;
      x[i] /= length;
    }
    turn (w, x, R);
    return TRUE;
  }
  for (guint i = 0; i < n; i++) {
    for (gint j = 0; j < 9; j++)
      M[j] += X[3 * i + j / 3] * W[3 * i + j % 3] / (size * size);
  }
  return cloth_mat3_nearest_rotation (M, R)
      || cloth_rig_invalid (error, "points", "",
      "they don't fit each other: are some of them mixed up?");
}

/* @rig: a rig
 * @n: points as cameras see them
 * @points: (array length=n): each at least twice
 * @world: (out): the world in which they are where they are said to be
 * @rms: (out): how far they are from there, root mean square, m
 * @scale: (out): how large they are seen, over how large they are said to be
 * @error: #ClothRigError
 *
 * Triangulates points and puts the world where they fit best (B. Horn, "Closed-form solution
 * of absolute orientation", 1987). Two points, or more of one
 * line, a plumb line for instance, say which way is up; three more.
 *
 * Returns: whether they say it.
 */
gboolean
cloth_world_of_points (const ClothRig * rig, guint n,
    const ClothWorldPoint * points, ClothWorld * world, gdouble * rms,
    gdouble * scale, GError ** error)
{
  g_autofree gdouble *W = g_new (gdouble, 3 * n + 1);
  g_autofree gdouble *X = g_new (gdouble, 3 * n + 1);
  gdouble w[3] = { 0, }, x[3] = { 0, }, Rw[3], sum_w = 0, sum_x = 0;
  guint m = 0;

  for (guint i = 0; i < n; i++) {
    guint same = 0;

    while (same < m && memcmp (W + 3 * same, points[i].world, sizeof w) != 0)
      same++;
    if (same < m)
      continue;
    memcpy (W + 3 * m, points[i].world, sizeof w);
    if (!triangulate (rig, n, points, points[i].world, X + 3 * m, error))
      return FALSE;
    m++;
  }
  for (guint i = 0; i < 3 * m; i++) {
    w[i % 3] += W[i] / m;
    x[i % 3] += X[i] / m;
  }
  for (guint i = 0; i < 3 * m; i++) {
    W[i] -= w[i % 3];
    X[i] -= x[i % 3];
    sum_w += W[i] * W[i];
    sum_x += X[i] * X[i];
  }
  if (!align (m, W, X, world->R, error))
    return FALSE;
  cloth_mat3_vec (world->R, w, Rw);
  cloth_vec3_subtract (x, Rw, world->t);
  *scale = sqrt (sum_x / sum_w);
  *rms = 0;
  for (guint i = 0; i < m; i++) {
    gdouble RW[3];

    cloth_mat3_vec (world->R, W + 3 * i, RW);
    *rms += pow (distance (RW, X + 3 * i), 2) / m;
  }
  *rms = sqrt (*rms);
  return TRUE;
}

/* Board to camera, from one view. */
static gboolean
start_pose (const ClothCamera * camera, const ClothBundleView * view,
    const gdouble * board, gdouble R[9], gdouble t[3])
{
  guint n = view->n;
  g_autofree gdouble *v = g_new (gdouble, 4 * n + 1);
  gdouble H[9];

  for (guint i = 0; i < n; i++) {
    v[i] = board[3 * view->vertex[i]];
    v[n + i] = board[3 * view->vertex[i] + 1];
  }
  return cloth_camera_undistort_points (camera, n, view->x, view->y, v + 2 * n,
      v + 3 * n, NULL) == n
      && cloth_planar_homography (n, v, v + n, v + 2 * n, v + 3 * n, H)
      && cloth_planar_pose (H, R, t);
}

/* @rig: a rig
 * @n_views: views, at least one
 * @views: (array length=n_views): of one pose of a board, by different cameras
 * @board: (array): 3 numbers a vertex, m
 * @world: (out): vertex 0 of the board; x along its rows, z off it towards the first view's
 *   camera
 * @error: #ClothRigError
 *
 * Returns: whether the views show where the board is.
 */
gboolean
cloth_world_of_board (const ClothRig * rig, guint n_views,
    const ClothBundleView * views, const gdouble * board, ClothWorld * world,
    GError ** error)
{
  const ClothCamera *first = &rig->cameras[views[0].camera];
  g_autofree ClothCamera *cameras =
      g_memdup2 (rig->cameras, rig->n_cameras * sizeof (ClothCamera));
  g_autofree ClothBundleView *own =
      g_memdup2 (views, n_views * sizeof (ClothBundleView));
  g_autofree guint *none = g_new0 (guint, rig->n_cameras);
  g_autofree gdouble *noise = g_new (gdouble, rig->n_cameras);
  gdouble P[12], Pt[3], d[3], C[3];
  ClothBundle bundle = { rig->n_cameras, cameras, none, FALSE, 1, P, n_views,
    own, board, noise, 3, 100, NULL
  };

  if (!start_pose (first, views, board, world->R, world->t))
    return cloth_rig_invalid (error, first->name, "",
        "its view of the board doesn't show where that is");
  cloth_mat3_mul_tn (first->R, world->R, P);
  cloth_vec3_subtract (world->t, first->t, d);
  cloth_mat3_vec_t (first->R, d, Pt);
  memcpy (P + 9, Pt, sizeof Pt);
  for (guint c = 0; c < rig->n_cameras; c++)
    noise[c] = BOARD_NOISE;
  for (guint v = 0; v < n_views; v++) {
    own[v].pose = 0;
    own[v].use = TRUE;
  }
  if (!cloth_bundle_solve (&bundle, NULL, error))
    return FALSE;
  memcpy (world->R, P, sizeof world->R);
  memcpy (world->t, P + 9, sizeof world->t);
  centre (first, C);
  cloth_vec3_subtract (C, world->t, d);
  if (P[2] * d[0] + P[5] * d[1] + P[8] * d[2] < 0) {
    for (gint i = 0; i < 9; i++)
      world->R[i] = i % 3 ? -P[i] : P[i];
  }
  return TRUE;
}

/* @world: where the world shall be
 * @rig: changed: its cameras' places, and what these are known to
 *
 * A camera's t is known worse by what its rotation is, times the lever; what both share is
 * not known of a finished rig, and left out.
 */
void
cloth_world_move_rig (const ClothWorld * world, ClothRig * rig)
{
  for (guint c = 0; c < rig->n_cameras; c++) {
    ClothCamera *camera = &rig->cameras[c];
    gdouble lever[3], R[9];

    cloth_mat3_vec (camera->R, world->t, lever);
    cloth_mat3_mul (camera->R, world->R, R);
    memcpy (camera->R, R, sizeof R);
    for (gint i = 0; i < 3; i++) {
      gint j = (i + 1) % 3, k = (i + 2) % 3;

      camera->t[i] += lever[i];
      camera->t_sd[i] = sqrt (camera->t_sd[i] * camera->t_sd[i]
          + pow (camera->r_sd[j] * lever[k], 2)
          + pow (camera->r_sd[k] * lever[j], 2));
    }
  }
  cloth_rig_mend_rotations (rig);
}

/* @world: where the world shall be
 * @pose: changed: R and t of something in the old world
 */
void
cloth_world_move_pose (const ClothWorld * world, gdouble pose[12])
{
  gdouble R[9], d[3];

  cloth_mat3_mul_tn (world->R, pose, R);
  memcpy (pose, R, sizeof R);
  cloth_vec3_subtract (pose + 9, world->t, d);
  cloth_mat3_vec_t (world->R, d, pose + 9);
}
