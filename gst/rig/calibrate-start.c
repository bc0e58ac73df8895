/* Start values of a calibration: each camera alone, then the cameras' places.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/calibrate-start.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"
#include "gst/math/vec3.h"
#include "gst/rig/planar.h"
#include "gst/rig/rig.h"
#include "gst/rig/rotation.h"

/* Scatter assumed while start values are compared: those of a lens not yet known. */
#define START_EXCESS 2.0

/* Boards closer to parallel than this don't determine a focal length. */
#define MIN_TILT_DEGREES 4.0

/* @lens: a lens model
 *
 * Returns: the bits of its coefficients in ClothBundle.free.
 */
guint
cloth_calibrate_lens_bits (ClothLens lens)
{
  guint bits = 0;

  for (guint i = 0; i < cloth_lens_n_coefficients (lens); i++)
    bits |= CLOTH_BUNDLE_COEFFICIENT (i);
  return bits;
}

/* Pose of the board, in the camera's frame, from the points that the lens can undo. */
static gboolean
pose_of_view (const ClothCamera * camera, const ClothBundleView * view,
    const gdouble * board, gdouble pose[12])
{
  g_autofree gdouble *x = g_new (gdouble, view->n);
  g_autofree gdouble *y = g_new (gdouble, view->n);
  g_autofree gdouble *X = g_new (gdouble, view->n);
  g_autofree gdouble *Y = g_new (gdouble, view->n);
  gdouble H[9];
  guint n = 0;

  cloth_camera_undistort_points (camera, view->n, view->x, view->y, x, y, NULL);
  for (guint i = 0; i < view->n; i++) {
    if (!isfinite (x[i]))
      continue;
    x[n] = x[i];
    y[n] = y[i];
    X[n] = board[3 * view->vertex[i]];
    Y[n++] = board[3 * view->vertex[i] + 1];
  }
  if (!cloth_planar_homography (n, X, Y, x, y, H)
      || !cloth_planar_pose (H, pose, pose + 9))
    return FALSE;
  for (guint i = 0; i < view->n; i++) {
    gdouble p[3];

    cloth_mat3_vec (pose, board + 3 * (gsize) view->vertex[i], p);
    if (!(p[2] + pose[11] > 0))
      return FALSE;
  }
  return TRUE;
}

/* Seen from afar, a board tilted to one side looks like one tilted to the other. */
static void
flip (const ClothBundleView * view, const gdouble * board,
    const gdouble pose[12], gdouble flipped[12])
{
  gdouble c[3] = { 0, 0, 0 }, sight[3], n, R[9];

  for (guint i = 0; i < view->n; i++) {
    for (gint j = 0; j < 3; j++)
      c[j] += board[3 * view->vertex[i] + j] / view->n;
  }
  cloth_mat3_vec (pose, c, sight);
  n = 0;
  for (gint j = 0; j < 3; j++) {
    sight[j] += pose[9 + j];
    n += sight[j] * sight[j];
  }
  for (gint e = 0; e < 2; e++) {
    gdouble along = 0;

    for (gint j = 0; j < 3; j++)
      along += pose[3 * j + e] * sight[j] / n;
    for (gint j = 0; j < 3; j++)
      R[3 * j + e] = pose[3 * j + e] - 2 * along * sight[j];
  }
  for (gint j = 0; j < 3; j++) {
    gint k = (j + 1) % 3, l = (j + 2) % 3;

    R[3 * j + 2] = R[3 * k] * R[3 * l + 1] - R[3 * l] * R[3 * k + 1];
  }
  memcpy (flipped, R, sizeof R);
  cloth_mat3_vec (R, c, flipped + 9);
  for (gint j = 0; j < 3; j++)
    flipped[9 + j] = sight[j] - flipped[9 + j];
}

static gdouble
rms_of_view (const ClothBundle * b, guint v)
{
  guint n = b->views[v].n;
  g_autofree gdouble *e = g_new (gdouble, 2 * n);
  gdouble sum = 0;

  cloth_bundle_residuals (b, v, e, e + n, NULL);
  for (guint i = 0; i < 2 * n; i++)
    sum += e[i] * e[i];
  return isnan (sum) ? HUGE_VAL : sqrt (sum / n);
}

/* A pose can be caught in the wrong tilt, or thrown away by a step that helped the others.
 * Views that fit worse than @factor times the median try the other tilt, and both tilts
 * of a new start. TRUE when one fitted better. */
static gboolean
mend_poses (const ClothBundle * bundle, gdouble factor)
{
  gboolean better = FALSE;
  g_autofree gdouble *rms = g_new (gdouble, bundle->n_views);
  g_autofree gdouble *sorted = g_new (gdouble, bundle->n_views);
  gdouble median;
  guint n_used = 0;

  for (guint v = 0; v < bundle->n_views; v++) {
    rms[v] = bundle->views[v].use ? rms_of_view (bundle, v) : 0;
    if (bundle->views[v].use)
      sorted[n_used++] = rms[v];
  }
  median = cloth_median (sorted, n_used);
  for (guint v = 0; v < bundle->n_views; v++) {
    ClothBundleView view = bundle->views[v];
    gdouble *pose = bundle->poses + 12 * (gsize) v;
    gdouble tries[4][12], least = HUGE_VAL;
    guint nothing = 0, n = 2, best = 0;
    ClothBundle one = *bundle;

    if (!view.use || rms[v] < factor * median)
      continue;
    memcpy (tries[0], pose, sizeof tries[0]);
    flip (&view, bundle->board, pose, tries[1]);
    if (pose_of_view (&bundle->cameras[0], &view, bundle->board, tries[2])) {
      flip (&view, bundle->board, tries[2], tries[3]);
      n = 4;
    }
    one.free = &nothing;
    one.n_poses = one.n_views = 1;
    one.max_iterations = 20;
    view.pose = 0;
    one.views = &view;
    for (guint i = 0; i < n; i++) {
      gdouble cost = HUGE_VAL;

      one.poses = tries[i];
      if (!cloth_bundle_solve (&one, &cost, NULL))
        continue;
      /* Another one must be clearly better. */
      if (cost < (i ? 0.9 : 1) * least) {
        least = cost;
        best = i;
      }
    }
    if (best > 0) {
      memcpy (pose, tries[best], sizeof tries[best]);
      better = TRUE;
    }
  }
  return better;
}

static guint
count_used (const ClothBundle * bundle)
{
  guint n = 0;

  for (guint v = 0; v < bundle->n_views; v++)
    n += !!bundle->views[v].use;
  return n;
}

static gboolean
check_tilts (const ClothBundle * bundle, GError ** error)
{
  const gchar *name = bundle->cameras[0].name;
  gdouble least = 1;

  for (guint a = 0; a < bundle->n_poses; a++) {
    for (guint b = 0; bundle->views[a].use && b < a; b++) {
      const gdouble *A = bundle->poses + 12 * (gsize) a;
      const gdouble *B = bundle->poses + 12 * (gsize) b;

      if (bundle->views[b].use)
        least = fmin (least, fabs (A[2] * B[2] + A[5] * B[5] + A[8] * B[8]));
    }
  }
  if (least > cos (MIN_TILT_DEGREES * G_PI / 180)) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "camera %s: all %u views of the board are parallel within %.1f°, which "
        "does not determine the focal length; tilt the board by 20° to 45° to "
        "different sides", name, count_used (bundle),
        acos (fmin (1, least)) * 180 / G_PI);
    return FALSE;
  }
  return TRUE;
}

/* Poses of all views that a camera can tell one of. Returns how many points the others
 * have. */
static guint
start_poses (const ClothBundle * bundle, ClothBundleView * views)
{
  guint lost = 0;

  for (guint v = 0; v < bundle->n_views; v++) {
    gdouble pose[12];

    views[v].use = pose_of_view (&bundle->cameras[0], &views[v],
        bundle->board, pose);
    if (views[v].use)
      memcpy (bundle->poses + 12 * (gsize) v, pose, sizeof pose);
    else
      lost += views[v].n;
  }
  return lost;
}

/* Focal length and poses from the best of several guesses. A view that shows too little
 * for a pose under a guess counts as if all its corners were at the limit. */
static gboolean
guess (ClothBundle * bundle, ClothBundleView * views, GError ** error)
{
  static const gdouble factors[] = { 0, 0.35, 0.6, 1, 1.7, 3, 6 };
  ClothCamera *c = &bundle->cameras[0], best = *c;
  gsize size = 12 * bundle->n_views * sizeof (gdouble);
  g_autofree gdouble *H = g_new (gdouble, 9 * bundle->n_views);
  g_autofree gdouble *best_poses = g_malloc (size);
  g_autofree gboolean *best_use = g_new0 (gboolean, bundle->n_views);
  gdouble best_cost = HUGE_VAL, zhang[2];
  gdouble longer = MAX (c->width, c->height);

  c->K[2] = best.K[2] = 0.5 * (c->width - 1);
  c->K[5] = best.K[5] = 0.5 * (c->height - 1);
  for (guint v = 0; v < bundle->n_views; v++) {
    const ClothBundleView *view = &bundle->views[v];
    g_autofree gdouble *X = g_new (gdouble, 2 * view->n);

    for (guint i = 0; i < view->n; i++) {
      X[i] = bundle->board[3 * view->vertex[i]];
      X[view->n + i] = bundle->board[3 * view->vertex[i] + 1];
    }
    cloth_planar_homography (view->n, X, X + view->n, view->x, view->y,
        H + 9 * v);
  }
  for (guint i = 0; i < G_N_ELEMENTS (factors); i++) {
    gdouble cost;
    guint lost;

    c->K[0] = c->K[4] = factors[i] * longer;
    if (i == 0) {
      if (!cloth_planar_focal (bundle->n_views, H, c->K[2], c->K[5], zhang))
        continue;
      c->K[0] = zhang[0];
      c->K[4] = zhang[1];
    }
    lost = start_poses (bundle, views);
    if (count_used (bundle) < 3 || !cloth_bundle_solve (bundle, &cost, NULL))
      continue;
    cost += lost * bundle->huber * bundle->huber;
    if (!(cost < best_cost))
      continue;
    best_cost = cost;
    best = *c;
    memcpy (best_poses, bundle->poses, size);
    for (guint v = 0; v < bundle->n_views; v++)
      best_use[v] = views[v].use;
  }
  if (g_cancellable_set_error_if_cancelled (bundle->cancellable, error))
    return FALSE;
  if (!isfinite (best_cost)) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "camera %s: no focal length explains the views of the board", c->name);
    return FALSE;
  }
  *c = best;
  memcpy (bundle->poses, best_poses, size);
  for (guint v = 0; v < bundle->n_views; v++)
    views[v].use = best_use[v];
  return TRUE;
}

/* The rational model has many minima, and poles between them. Several ways to write the
 * same distortion, N (1 + a r²) / (1 + a r²), each start a fit. */
static gboolean
solve_brown8 (ClothBundle * bundle, GError ** error)
{
  static const gdouble factors[] = { 0, 0.3, 1, 3 };
  ClothCamera start = bundle->cameras[0], best = start;
  gsize size = 12 * bundle->n_poses * sizeof (gdouble);
  g_autofree gdouble *poses = g_memdup2 (bundle->poses, size);
  g_autofree gdouble *best_poses = g_memdup2 (bundle->poses, size);
  gdouble least = HUGE_VAL;

  for (guint i = 0; i < G_N_ELEMENTS (factors); i++) {
    ClothCamera *c = &bundle->cameras[0];
    gdouble a = factors[i], cost;

    *c = start;
    memcpy (bundle->poses, poses, size);
    c->k[0] += a;
    c->k[1] += a * start.k[0];
    c->k[4] += a * start.k[1];
    c->k[5] = a;
    if (!cloth_bundle_solve (bundle, &cost, error))
      return FALSE;
    if (cost < least) {
      least = cost;
      best = *c;
      memcpy (best_poses, bundle->poses, size);
    }
  }
  bundle->cameras[0] = best;
  memcpy (bundle->poses, best_poses, size);
  return TRUE;
}

/* Views that had no pose under the first guess may have one under a better one. */
static void
take_back (const ClothBundle * bundle, ClothBundleView * views)
{
  for (guint v = 0; v < bundle->n_views; v++) {
    gdouble pose[12];

    if (!views[v].use && pose_of_view (&bundle->cameras[0], &views[v],
            bundle->board, pose)) {
      memcpy (bundle->poses + 12 * (gsize) v, pose, sizeof pose);
      views[v].use = TRUE;
    }
  }
}

/* @camera: (inout): name, size and lens are read, K and k written
 * @n_views: views of this camera, at least 3
 * @views: (array length=n_views): the views, each a pose of its own
 * @board: 3 numbers a vertex, m
 * @huber: as in #ClothBundle
 * @max_iterations: as in #ClothBundle
 * @poses: (out caller-allocates): 12 numbers a view: board to camera
 * @used: (out caller-allocates): for each view whether its pose could be told
 * @excess: (out): as cloth_bundle_excess() gives it
 * @cancellable: (nullable): stops it
 * @error: #ClothRigError, naming the camera
 *
 * Intrinsics of one camera. Zhang's closed form and a ladder of focal lengths each start a
 * short fit without distortion; the best is refined, distortion joining by and by.
 *
 * Returns: %FALSE when the views don't determine the camera.
 */
gboolean
cloth_calibrate_alone (ClothCamera * camera, guint n_views,
    const ClothBundleView * views, const gdouble * board, gdouble huber,
    guint max_iterations, gdouble * poses, gboolean * used, gdouble * excess,
    GCancellable * cancellable, GError ** error)
{
  g_autofree ClothBundleView *own =
      g_memdup2 (views, n_views * sizeof (ClothBundleView));
  guint lens = cloth_calibrate_lens_bits (camera->lens);
  guint low = CLOTH_BUNDLE_COEFFICIENT (0) | CLOTH_BUNDLE_COEFFICIENT (1);
  guint brown5 = cloth_calibrate_lens_bits (CLOTH_LENS_BROWN5);
  guint stages[] = { CLOTH_BUNDLE_FOCAL | (lens & low),
    CLOTH_BUNDLE_FOCAL | CLOTH_BUNDLE_CENTRE | (lens & brown5),
    CLOTH_BUNDLE_FOCAL | CLOTH_BUNDLE_CENTRE | lens
  };
  guint free_bits = CLOTH_BUNDLE_FOCAL;
  ClothBundle bundle = { 1, camera, &free_bits, FALSE, n_views, poses, n_views,
    own, board, excess, huber, 12, cancellable
  };

  for (guint v = 0; v < n_views; v++) {
    own[v].camera = 0;
    own[v].pose = v;
    own[v].use = TRUE;
  }
  *excess = START_EXCESS;
  memset (camera->k, 0, sizeof camera->k);
  if (!guess (&bundle, own, error))
    return FALSE;
  bundle.max_iterations = max_iterations;
  for (guint i = 0; i < G_N_ELEMENTS (stages); i++) {
    free_bits = stages[i];
    if (!(i == 2 && camera->lens == CLOTH_LENS_BROWN8 ?
            solve_brown8 (&bundle, error)
            : cloth_bundle_solve (&bundle, NULL, error))
        || (mend_poses (&bundle, i == 0 ? 0 : 2)
            && !cloth_bundle_solve (&bundle, NULL, error))) {
      g_prefix_error (error, "camera %s: ", camera->name);
      return FALSE;
    }
    *excess = cloth_bundle_excess (&bundle, 0);
    if (i == 0)
      take_back (&bundle, own);
  }
  if (!cloth_bundle_solve (&bundle, NULL, error))
    return FALSE;
  *excess = cloth_bundle_excess (&bundle, 0);
  for (guint v = 0; v < n_views; v++)
    used[v] = own[v].use;
  return check_tilts (&bundle, error);
}

/* B after A⁻¹: from the frame A leads to, to the one B leads to. */
static void
relative (const gdouble A[12], const gdouble B[12], gdouble out[12])
{
  gdouble Rt[3];

  cloth_mat3_mul_nt (B, A, out);
  cloth_mat3_vec (out, A + 9, Rt);
  for (gint j = 0; j < 3; j++)
    out[9 + j] = B[9 + j] - Rt[j];
}

static void
compose (const gdouble A[12], const gdouble B[12], gdouble out[12])
{
  gdouble Rt[3];

  cloth_mat3_mul (A, B, out);
  cloth_mat3_vec (A, B + 9, Rt);
  for (gint j = 0; j < 3; j++)
    out[9 + j] = Rt[j] + A[9 + j];
}

static gdouble
distance (const gdouble A[12], const gdouble B[12])
{
  gdouble R[9], r[3], turned, moved = 0, size = 0;

  cloth_mat3_mul_nt (A, B, R);
  cloth_rotation_to_vector (R, r);
  turned = cloth_vec3_length (r);
  for (gint j = 9; j < 12; j++) {
    moved += (A[j] - B[j]) * (A[j] - B[j]);
    size += A[j] * A[j] + B[j] * B[j];
  }
  return turned + sqrt (moved / fmax (size, 1e-300));
}

/* From one camera to another: of what their common poses say, the one nearest to what all
 * of them say. Where the board looks the same after a turn, each pose says several things,
 * and only the right ones agree with other poses. Returns how many poses they share. */
static guint
pair (const ClothBundle * b, const gdouble * view_poses, guint n_turns,
    const gdouble * turns, guint from, guint to, gdouble best[12])
{
  g_autoptr (GArray) all = g_array_new (FALSE, FALSE, 12 * sizeof (gdouble));
  gdouble best_sum = HUGE_VAL;

  for (guint u = 0; u < b->n_views; u++) {
    for (guint v = 0; b->views[u].use && b->views[u].camera == from
        && v < b->n_views; v++) {
      if (!b->views[v].use || b->views[v].camera != to
          || b->views[v].pose != b->views[u].pose)
        continue;
      for (guint k = 0; k < n_turns; k++) {
        gdouble P[12], T[12];

        compose (view_poses + 12 * (gsize) v, turns + 12 * k, P);
        relative (view_poses + 12 * (gsize) u, P, T);
        g_array_append_vals (all, T, 1);
      }
    }
  }
  for (guint i = 0; i < all->len; i++) {
    const gdouble *T = (const gdouble *) all->data + 12 * i;
    gdouble sum = 0;

    for (guint j = 0; j < all->len; j += n_turns) {
      gdouble least = HUGE_VAL;

      for (guint k = 0; k < n_turns; k++)
        least = fmin (least, distance (T, (const gdouble *) all->data
                + 12 * (j + k)));
      sum += least;
    }
    if (sum < best_sum) {
      best_sum = sum;
      memcpy (best, T, 12 * sizeof (gdouble));
    }
  }
  return all->len / n_turns;
}

/* @bundle: (inout): R and t of the cameras and all poses are written
 * @view_poses: (inout): 12 numbers a view: board to the view's camera
 * @n_turns: ways to lay the board that look the same, 1 or more
 * @turns: 12 numbers each: the board's motion, the first one none
 * @turned: (out caller-allocates): for each view which of @turns comes before the pose
 *   that was found, so that views of the same pose agree; @view_poses have it applied
 * @error: #ClothRigError, naming the cameras that share no view with the others
 *
 * Places the cameras relative to the first one along a spanning tree that joins the
 * cameras which share most poses.
 *
 * Returns: whether all cameras could be reached.
 */
gboolean
cloth_calibrate_place (ClothBundle * bundle, gdouble * view_poses,
    guint n_turns, const gdouble * turns, guint * turned, GError ** error)
{
  guint n = bundle->n_cameras;
  g_autofree gboolean *placed = g_new0 (gboolean, n);
  g_autofree gdouble *T = g_new0 (gdouble, 12 * n);
  g_autofree gdouble *steps = g_new0 (gdouble, (gsize) 12 * n * n);
  g_autofree guint *shared = g_new0 (guint, n * n);
  g_autofree gdouble *weight = g_new0 (gdouble, bundle->n_poses);

  for (guint a = 0; a < n; a++) {
    for (guint b = 0; b < n; b++) {
      if (a != b)
        shared[a * n + b] = pair (bundle, view_poses, n_turns, turns, a, b,
            steps + 12 * ((gsize) a * n + b));
    }
  }
  placed[0] = TRUE;
  T[0] = T[4] = T[8] = 1;
  for (guint count = 1; count < n; count++) {
    guint most = 0, from = 0, to = 0;

    for (guint a = 0; a < n; a++) {
      for (guint b = 0; b < n; b++) {
        if (placed[a] && !placed[b] && shared[a * n + b] > most) {
          most = shared[a * n + b];
          from = a;
          to = b;
        }
      }
    }
    if (most == 0) {
      g_autoptr (GString) reached = g_string_new (NULL);
      g_autoptr (GString) lost = g_string_new (NULL);

      for (guint c = 0; c < n; c++) {
        GString *list = placed[c] ? reached : lost;

        g_string_append_printf (list, "%s%s", list->len ? ", " : "",
            bundle->cameras[c].name);
      }
      g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
          "cameras %s share no view of the board with %s; add pictures in "
          "which both see it at the same moment, or calibrate intrinsics only",
          lost->str, reached->str);
      return FALSE;
    }
    compose (steps + 12 * ((gsize) from * n + to), T + 12 * from, T + 12 * to);
    placed[to] = TRUE;
  }
  for (guint c = 0; c < n; c++) {
    memcpy (bundle->cameras[c].R, T + 12 * c, 9 * sizeof (gdouble));
    memcpy (bundle->cameras[c].t, T + 12 * c + 9, 3 * sizeof (gdouble));
  }
  /* Each pose from the camera that sees most of it. */
  for (guint v = 0; v < bundle->n_views; v++) {
    const ClothBundleView *view = &bundle->views[v];
    gdouble inverse[12], identity[12] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0 };

    if (!view->use || !(view->n > weight[view->pose]))
      continue;
    weight[view->pose] = view->n;
    relative (T + 12 * view->camera, identity, inverse);
    compose (inverse, view_poses + 12 * (gsize) v,
        bundle->poses + 12 * (gsize) view->pose);
  }
  for (guint v = 0; v < bundle->n_views; v++) {
    const ClothBundleView *view = &bundle->views[v];
    gdouble seen[12], turn[12], best[12], least = HUGE_VAL;
    gdouble *pose = view_poses + 12 * (gsize) v;

    turned[v] = 0;
    if (!view->use)
      continue;
    compose (T + 12 * view->camera, bundle->poses + 12 * (gsize) view->pose,
        seen);
    for (guint k = 0; k < n_turns; k++) {
      gdouble d;

      compose (pose, turns + 12 * k, turn);
      d = distance (seen, turn);
      if (d < least) {
        least = d;
        turned[v] = k;
        memcpy (best, turn, sizeof best);
      }
    }
    memcpy (pose, best, sizeof best);
  }
  return TRUE;
}
