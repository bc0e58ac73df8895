/* Calibration of cameras from views of a board.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/calibrate.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"
#include "gst/math/vec3.h"
#include "gst/rig/calibrate-start.h"
#include "gst/rig/planar.h"

#define N CLOTH_CAMERA_N_PARAMETERS

/* A focal length less certain than this is none. */
#define MAX_FOCAL_DEVIATION 0.05

/* Fewer corners than this say nothing that their own pose doesn't absorb. */
#define MIN_POINTS 6
#define MIN_VIEWS 3

/* Rounds of fit and estimate of the scatter; it settles in two or three. */
#define MAX_ROUNDS 6

typedef struct
{
  const ClothCalibrateInput *in;
  const ClothCalibrateParams *params;
  ClothBundleView *views;       /* as the input's; unusable ones not in use */
  gdouble *view_poses;          /* 12 a view: board to camera */
  gdouble *poses;
  gdouble *excess;
  guint *free_bits;
  gdouble *bulge;
  GPtrArray *renumbered;        /* vertices of views, owned */
  ClothRig *rig;
  ClothBundle bundle;
  ClothCalibrateProgress progress;
  gpointer user_data;
} Work;

/* @params: (out): set to the defaults
 */
void
cloth_calibrate_params_init (ClothCalibrateParams * params)
{
  memset (params, 0, sizeof *params);
  params->huber = 3;
  params->leave_out = 5;
  params->max_iterations = 100;
}

/* @calibration: (transfer full) (nullable): a result
 */
void
cloth_calibration_free (ClothCalibration * calibration)
{
  if (!calibration)
    return;
  cloth_rig_free (calibration->rig);
  g_free (calibration->cameras);
  g_free (calibration->view_rms);
  g_free (calibration->dx);
  g_free (calibration->dy);
  g_free (calibration->outlier);
  g_free (calibration->poses);
  g_free (calibration);
}

static void
work_clear (Work * w)
{
  g_free (w->views);
  g_free (w->view_poses);
  g_free (w->poses);
  g_free (w->excess);
  g_free (w->free_bits);
  g_free (w->bulge);
  g_clear_pointer (&w->renumbered, g_ptr_array_unref);
  cloth_rig_free (w->rig);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Work, work_clear);

static void
tell (const Work * w, const gchar * stage, gdouble fraction)
{
  if (w->progress)
    w->progress (stage, fraction, w->user_data);
}

G_GNUC_PRINTF (2, 3)
     static gboolean bad (GError ** error, const gchar * format, ...)
{
  va_list args;
  g_autofree gchar *what = NULL;

  va_start (args, format);
  what = g_strdup_vprintf (format, args);
  va_end (args);
  g_set_error_literal (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE, what);
  return FALSE;
}

static gboolean
check_view (const ClothCalibrateInput * in, guint index, GError ** error)
{
  const ClothBundleView *v = &in->views[index];

  if (v->camera >= in->n_cameras || v->pose >= in->n_poses)
    return bad (error, "view %u: camera %u or pose %u is out of range", index,
        v->camera, v->pose);
  for (guint i = 0; i < v->n; i++) {
    if (v->vertex[i] >= in->n_vertices)
      return bad (error, "view %u: vertex %u is out of range", index,
          v->vertex[i]);
    if (!isfinite (v->x[i]) || !isfinite (v->y[i]))
      return bad (error, "view %u: corner %u is not finite", index, i);
    if (v->cov) {
      const gdouble *c = v->cov + 3 * (gsize) i;

      if (!(c[0] >= 0) || !(c[2] >= 0) || !(c[0] * c[2] >= c[1] * c[1])
          || !isfinite (c[0] + c[2]))
        return bad (error, "view %u: corner %u has no valid covariance", index,
            i);
    }
  }
  for (guint u = 0; u < index; u++) {
    if (in->views[u].camera == v->camera && in->views[u].pose == v->pose)
      return bad (error, "camera %s sees pose %u twice",
          in->cameras[v->camera].name, v->pose);
  }
  return TRUE;
}

static gboolean
check_input (const ClothCalibrateInput * in,
    const ClothCalibrateParams * params, GError ** error)
{
  if (in->n_cameras < 1 || in->n_cameras > CLOTH_RIG_MAX_CAMERAS)
    return bad (error, "%u cameras; 1 to %d are allowed", in->n_cameras,
        CLOTH_RIG_MAX_CAMERAS);
  for (guint c = 0; c < in->n_cameras; c++) {
    const ClothCamera *camera = &in->cameras[c];

    if (camera->width < 1 || camera->height < 1
        || camera->width > CLOTH_RIG_MAX_SIZE
        || camera->height > CLOTH_RIG_MAX_SIZE)
      return bad (error, "camera %s: impossible size %d×%d", camera->name,
          camera->width, camera->height);
  }
  for (guint c = 1; params->share_lens && c < in->n_cameras; c++) {
    if (in->cameras[c].lens != in->cameras[0].lens)
      return bad (error, "cameras %s and %s can't share a lens: their models "
          "differ", in->cameras[0].name, in->cameras[c].name);
  }
  for (guint i = 0; i < 3 * in->n_vertices; i++) {
    if (!isfinite (in->board[i]) || (i % 3 == 2 && in->board[i] != 0))
      return bad (error, "vertex %u of the board is not finite or not at 0 "
          "height", i / 3);
  }
  for (guint i = 0; i < in->n_symmetries * in->n_vertices; i++) {
    if (in->symmetries[i] >= in->n_vertices)
      return bad (error, "symmetry %u: vertex %u is out of range",
          i / in->n_vertices, in->symmetries[i]);
  }
  for (guint v = 0; v < in->n_views; v++) {
    if (!check_view (in, v, error))
      return FALSE;
  }
  return TRUE;
}

/* Enough corners, not on a line. */
static gboolean
usable (const ClothCalibrateInput * in, const ClothBundleView * v)
{
  g_autofree gdouble *X = g_new (gdouble, 2 * v->n + 1);
  gdouble H[9];

  for (guint i = 0; i < v->n; i++) {
    X[i] = in->board[3 * (gsize) v->vertex[i]];
    X[v->n + i] = in->board[3 * (gsize) v->vertex[i] + 1];
  }
  return v->n >= MIN_POINTS
      && cloth_planar_homography (v->n, X, X + v->n, v->x, v->y, H);
}

static gboolean
start_cameras (Work * w, GError ** error)
{
  const ClothCalibrateInput *in = w->in;

  for (guint c = 0; c < in->n_cameras; c++) {
    g_autofree ClothBundleView *own = g_new (ClothBundleView, in->n_views + 1);
    g_autofree guint *index = g_new (guint, in->n_views + 1);
    g_autofree gdouble *poses = NULL;
    g_autofree gboolean *used = NULL;
    guint n = 0;

    tell (w, in->cameras[c].name, (gdouble) c / in->n_cameras);
    for (guint v = 0; v < in->n_views; v++) {
      if (w->views[v].use && w->views[v].camera == c) {
        index[n] = v;
        own[n++] = w->views[v];
      }
    }
    if (n < MIN_VIEWS)
      return bad (error, "camera %s: the board was found in %u views; at least "
          "%d are needed, 10 or more with different tilts are better",
          in->cameras[c].name, n, MIN_VIEWS);
    poses = g_new (gdouble, 12 * n);
    used = g_new (gboolean, n);
    if (!cloth_calibrate_alone (&w->rig->cameras[c], n, own, in->board,
            w->params->huber, w->params->max_iterations, poses, used,
            &w->excess[c], w->bundle.cancellable, error))
      return FALSE;
    for (guint i = 0; i < n; i++) {
      memcpy (w->view_poses + 12 * (gsize) index[i], poses + 12 * i,
          12 * sizeof (gdouble));
      w->views[index[i]].use = used[i];
    }
  }
  return TRUE;
}

/* Fits until the scatter that weighs the corners no longer changes. */
static gboolean
settle (Work * w, const gchar * stage, GError ** error)
{
  for (guint round = 0; round < MAX_ROUNDS; round++) {
    gdouble change = 0;

    tell (w, stage, (gdouble) round / MAX_ROUNDS);
    if (!cloth_bundle_solve (&w->bundle, NULL, error))
      return FALSE;
    for (guint c = 0; c < w->in->n_cameras; c++) {
      gdouble e = cloth_bundle_excess (&w->bundle, c);

      change = fmax (change, fabs (e - w->excess[c]) / (e + 1e-3));
      w->excess[c] = e;
    }
    if (change < 1e-3)
      break;
  }
  return cloth_bundle_solve (&w->bundle, NULL, error);
}

static gdouble
view_rms (const ClothBundle * b, guint v)
{
  guint n = b->views[v].n;
  g_autofree gdouble *e = g_new (gdouble, 2 * n + 1);
  gdouble sum = 0;

  cloth_bundle_residuals (b, v, e, e + n, NULL);
  for (guint i = 0; i < 2 * n; i++)
    sum += e[i] * e[i];
  return sqrt (sum / n);
}

/* Over the views whose poses other cameras see too; only these can contradict. */
static gdouble
median_view_rms (const ClothBundle * b, const gboolean * shared)
{
  g_autofree gdouble *rms = g_new (gdouble, b->n_views + 1);
  guint n = 0;

  for (guint v = 0; v < b->n_views; v++) {
    if (b->views[v].use && shared[v])
      rms[n++] = view_rms (b, v);
  }
  return cloth_median (rms, n);
}

/* What each camera reaches without the others. */
static gdouble
median_alone (const Work * w, const gboolean * shared)
{
  g_autofree ClothBundleView *views =
      g_memdup2 (w->views, w->in->n_views * sizeof (ClothBundleView));
  g_autofree ClothCamera *cameras =
      g_memdup2 (w->rig->cameras, w->in->n_cameras * sizeof (ClothCamera));
  ClothBundle b = w->bundle;

  for (guint c = 0; c < b.n_cameras; c++) {
    static const gdouble identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };

    memcpy (cameras[c].R, identity, sizeof identity);
    memset (cameras[c].t, 0, sizeof cameras[c].t);
  }
  for (guint v = 0; v < b.n_views; v++)
    views[v].pose = v;
  b.cameras = cameras;
  b.views = views;
  b.n_poses = b.n_views;
  b.poses = w->view_poses;
  return median_view_rms (&b, shared);
}

/* Which views show poses that several cameras see. */
static gboolean *
find_shared (const Work * w)
{
  guint n = w->in->n_views;
  g_autofree guint *count = g_new0 (guint, w->in->n_poses + 1);
  gboolean *shared = g_new0 (gboolean, n + 1);

  for (guint v = 0; v < n; v++)
    count[w->in->views[v].pose] += w->views[v].use;
  for (guint v = 0; v < n; v++)
    shared[v] = w->views[v].use && count[w->in->views[v].pose] > 1;
  return shared;
}

/* Every view a pose of its own, in its camera's frame. */
static void
separate (Work * w)
{
  ClothBundle *b = &w->bundle;

  for (guint v = 0; v < b->n_views; v++)
    w->views[v].pose = v;
  b->n_poses = b->n_views;
  memcpy (w->poses, w->view_poses, 12 * b->n_views * sizeof (gdouble));
}

/* One lens for all starts at the mean of what each camera found. */
static void
share_lens (Work * w)
{
  guint n = w->in->n_cameras;
  gdouble mean[8] = { 0, };

  for (guint c = 0; c < n; c++) {
    for (guint j = 0; j < 8; j++)
      mean[j] += w->rig->cameras[c].k[j] / n;
  }
  for (guint c = 0; c < n; c++) {
    memcpy (w->rig->cameras[c].k, mean, sizeof mean);
    w->excess[c] = fmax (w->excess[c], 0.5);
  }
}

/* The motions of the board that its symmetries are, after none: 12 numbers each. */
static gdouble *
find_turns (const ClothCalibrateInput * in)
{
  gdouble *turns = g_new0 (gdouble, 12 * (in->n_symmetries + 1));
  gdouble middle[2] = { 0, 0 };

  for (guint i = 0; i < in->n_vertices; i++) {
    middle[0] += in->board[3 * i] / in->n_vertices;
    middle[1] += in->board[3 * i + 1] / in->n_vertices;
  }
  for (guint k = 0; k <= in->n_symmetries; k++) {
    const gdouble *X = in->board, *Y = in->board;
    gdouble *T = turns + 12 * k, angle;

    /* The inverse motion is the one that comes before the pose that was found. */
    if (k > 0)
      Y += 3 * (gsize) in->symmetries[(gsize) (k - 1) * in->n_vertices];
    angle = k == 0 ? 0 : atan2 (X[1] - middle[1], X[0] - middle[0])
        - atan2 (Y[1] - middle[1], Y[0] - middle[0]);
    T[0] = T[4] = cos (angle);
    T[3] = sin (angle);
    T[1] = -T[3];
    T[8] = 1;
    T[9] = middle[0] - T[0] * middle[0] - T[1] * middle[1];
    T[10] = middle[1] - T[3] * middle[0] - T[4] * middle[1];
  }
  return turns;
}

/* Places the cameras and lets the views of each pose number the board alike. */
static gboolean
place (Work * w, GError ** error)
{
  const ClothCalibrateInput *in = w->in;
  g_autofree gdouble *turns = find_turns (in);
  g_autofree guint *turned = g_new0 (guint, in->n_views + 1);

  if (!cloth_calibrate_place (&w->bundle, w->view_poses, in->n_symmetries + 1,
          turns, turned, error))
    return FALSE;
  w->renumbered = g_ptr_array_new_with_free_func (g_free);
  for (guint v = 0; v < in->n_views; v++) {
    ClothBundleView *view = &w->views[v];
    guint *vertex;

    if (turned[v] == 0)
      continue;
    vertex = g_new (guint, view->n);
    for (guint i = 0; i < view->n; i++)
      vertex[i] = in->symmetries[(gsize) (turned[v] - 1) * in->n_vertices
          + view->vertex[i]];
    g_ptr_array_add (w->renumbered, vertex);
    view->vertex = vertex;
  }
  return TRUE;
}

/* A board that is bent is a parabola both ways, as mrcal has it: 1 in the middle, 0 at the
 * rim. */
static void
bend (Work * w)
{
  const ClothCalibrateInput *in = w->in;
  gdouble low[2] = { HUGE_VAL, HUGE_VAL }, high[2] = { -HUGE_VAL, -HUGE_VAL };

  for (guint i = 0; i < 2 * in->n_vertices; i++) {
    gdouble x = in->board[3 * (i / 2) + i % 2];

    low[i % 2] = fmin (low[i % 2], x);
    high[i % 2] = fmax (high[i % 2], x);
  }
  w->bulge = g_new (gdouble, 2 * in->n_vertices + 1);
  for (guint i = 0; i < 2 * in->n_vertices; i++) {
    gdouble u = (in->board[3 * (i / 2) + i % 2] - low[i % 2])
        / (high[i % 2] - low[i % 2]);

    w->bulge[i] = 4 * u * (1 - u);
  }
  w->bundle.bulge = w->bulge;
  w->bundle.free_warp = TRUE;
}

static gboolean
fit (Work * w, GError ** error)
{
  ClothBundle *b = &w->bundle;
  g_autofree gboolean *shared = find_shared (w);
  gboolean one = w->in->n_cameras == 1;
  gdouble alone, together;

  for (guint c = 0; c < b->n_cameras; c++)
    w->free_bits[c] = CLOTH_BUNDLE_FOCAL | CLOTH_BUNDLE_CENTRE
        | cloth_calibrate_lens_bits (b->cameras[c].lens);
  if (w->params->intrinsics_only) {
    if (w->params->share_lens)
      share_lens (w);
    separate (w);
    if (w->params->warp)
      bend (w);
    return settle (w, "intrinsics", error);
  }
  if (!place (w, error))
    return FALSE;
  alone = median_alone (w, shared);
  if (w->params->share_lens)
    share_lens (w);
  if (w->params->warp)
    bend (w);
  if (one)
    return settle (w, "refinement", error);

  for (guint c = 1; c < b->n_cameras; c++)
    w->free_bits[c] |= CLOTH_BUNDLE_PLACE;
  for (guint c = 0; c < b->n_cameras; c++)
    w->excess[c] = fmax (w->excess[c], 0.5);
  if (!settle (w, "all cameras", error))
    return FALSE;
  together = median_view_rms (b, shared);
  if (together > 3 * alone + 0.3)
    return bad (error, "the views don't fit one rigid rig: %.2f px together, "
        "%.2f px camera by camera; views of the same number must be taken at "
        "the same moment, else calibrate intrinsics only", together, alone);
  return TRUE;
}

static gboolean
check_focal (const Work * w, const gdouble * C, GError ** error)
{
  for (guint c = 0; c < w->in->n_cameras; c++) {
    const ClothCamera *camera = &w->rig->cameras[c];
    const gdouble *V = C + N * N * c;
    gdouble sd = sqrt (fmax (V[0], V[N + 1]));

    if (!(sd < MAX_FOCAL_DEVIATION * camera->K[0]))
      return bad (error,
          "camera %s: the focal length is known to ±%.0f%% only; "
          "add views that fill the picture, with the board tilted by 20° to "
          "45° to different sides, or take a lens model of fewer coefficients",
          camera->name, 100 * sd / camera->K[0]);
  }
  return TRUE;
}

static void
sum_up (const Work * w, ClothCalibration * result)
{
  g_autofree gboolean *shared = find_shared (w);
  gdouble total = 0;
  guint n = 0;

  for (guint c = 0; c < w->in->n_cameras; c++) {
    ClothCalibrateCamera *camera = &result->cameras[c];

    camera->excess = w->excess[c];
    camera->rms = 0;
    for (guint v = 0; v < w->in->n_views; v++) {
      if (!w->views[v].use || w->views[v].camera != c)
        continue;
      result->view_rms[v] = view_rms (&w->bundle, v);
      camera->rms += result->view_rms[v] * result->view_rms[v] * w->views[v].n;
      camera->n_views++;
      camera->n_shared += result->placed && shared[v];
      camera->n_points += w->views[v].n;
    }
    total += camera->rms;
    n += camera->n_points;
    camera->rms = sqrt (camera->rms / camera->n_points);
  }
  result->rms = sqrt (total / n);
}

/* Of N corners none is farther off than d by chance, in 19 cases of 20, when
 * N exp (−d²/2) is 0.05. */
static void
find_outliers (const Work * w, ClothCalibration * result)
{
  guint n = 0, n_used = 0;
  gdouble limit;

  for (guint v = 0; v < w->in->n_views; v++) {
    n += w->views[v].n;
    n_used += w->views[v].use ? w->views[v].n : 0;
  }
  limit = sqrt (2 * log (n_used / 0.05));
  result->dx = g_new (gdouble, n + 1);
  result->dy = g_new (gdouble, n + 1);
  result->outlier = g_new0 (gboolean, n + 1);
  n = 0;
  for (guint v = 0; v < w->in->n_views; v++) {
    const ClothBundleView *view = &w->views[v];
    g_autofree gdouble *distance = g_new (gdouble, view->n + 1);

    if (view->use)
      cloth_bundle_residuals (&w->bundle, v, result->dx + n, result->dy + n,
          distance);
    for (guint i = 0; i < view->n; i++) {
      if (!view->use)
        result->dx[n + i] = result->dy[n + i] = NAN;
      result->outlier[n + i] = view->use && !(distance[i] <= limit);
      result->cameras[view->camera].n_outliers += result->outlier[n + i];
    }
    n += view->n;
  }
}

/* Turns the world, in which the first camera is at the origin, and writes deviations. */
static void
place_world (const Work * w, ClothCalibration * result, const gdouble * C)
{
  /* New world to the first camera: x right, y forward, z up. */
  gdouble R[9] = { 1, 0, 0, 0, 0, -1, 0, 1, 0 }, t[3] = { 0, 0, 0 };
  gboolean board = w->params->world == CLOTH_CALIBRATE_WORLD_BOARD
      && !w->params->intrinsics_only;
  guint first = 0;

  if (board) {
    while (isnan (result->poses[12 * (gsize) first]))
      first++;
    memcpy (R, result->poses + 12 * (gsize) first, sizeof R);
    memcpy (t, result->poses + 12 * (gsize) first + 9, sizeof t);
    /* The first camera's height over the board. */
    if (R[2] * t[0] + R[5] * t[1] + R[8] * t[2] > 0) {
      for (gint i = 0; i < 9; i++)
        R[i] = i % 3 ? -R[i] : R[i];
    }
  }
  for (guint c = 0; c < w->in->n_cameras; c++) {
    ClothCamera *camera = &w->rig->cameras[c];
    const gdouble *V = C + N * N * c;
    gdouble m[9], lever[3];

    cloth_mat3_vec (camera->R, t, lever);
    cloth_mat3_mul (camera->R, R, m);
    memcpy (camera->R, m, sizeof m);
    for (gint i = 0; i < 3; i++) {
      gint j = (i + 1) % 3, k = (i + 2) % 3;
      /* t' = t + w × lever: row of its derivative by w */
      gdouble d[6] = { 0, }, var = 0;

      camera->t[i] += lever[i];
      d[j] = lever[k];
      d[k] = -lever[j];
      d[3 + i] = 1;
      for (gint a = 0; a < 6; a++) {
        for (gint b = 0; b < 6; b++)
          var += d[a] * d[b] * V[N * (12 + a) + 12 + b];
      }
      camera->t_sd[i] = sqrt (fmax (0, var));
      camera->r_sd[i] = sqrt (V[(N + 1) * (12 + i)]);
    }
    for (gint i = 0; i < 4; i++)
      camera->K_sd[i] = sqrt (V[(N + 1) * i]);
    for (gint i = 0; i < 8; i++)
      camera->k_sd[i] = sqrt (V[(N + 1) * (4 + i)]);
  }
  for (guint p = 0; p < result->n_poses; p++) {
    gdouble *P = result->poses + 12 * (gsize) p, *from = P + 9, M[9], d[3];

    cloth_vec3_subtract (from, t, d);
    cloth_mat3_vec_t (R, d, from);
    cloth_mat3_mul_tn (R, P, M);
    memcpy (P, M, sizeof M);
  }
}

/* Fits without every so many poses, then these poses alone. */
static gboolean
leave_out (Work * w, ClothCalibration * result, GError ** error)
{
  ClothBundle *b = &w->bundle;
  g_autofree guint *rank = g_new0 (guint, b->n_poses + 1);
  g_autofree gboolean *out = g_new0 (gboolean, b->n_views + 1);
  g_autofree gboolean *use = g_new0 (gboolean, b->n_views + 1);
  g_autofree ClothCamera *cameras =
      g_memdup2 (b->cameras, b->n_cameras * sizeof (ClothCamera));
  g_autofree gdouble *poses = g_memdup2 (b->poses,
      12 * b->n_poses * sizeof (gdouble));
  g_autoptr (GError) undetermined = NULL;
  gdouble total = 0, warp[2] = { b->warp[0], b->warp[1] };
  guint n = 0, all = 0;
  gboolean ok = TRUE, enough = TRUE;

  tell (w, "leave-out check", 0);
  /* Counted within each camera where poses are not shared. */
  for (guint c = 0; c < b->n_cameras; c++) {
    guint left = 0, count = 0;

    for (guint p = 0; p < b->n_poses; p++) {
      for (guint v = 0; v < b->n_views; v++) {
        if (!w->views[v].use || w->views[v].camera != c
            || w->views[v].pose != p)
          continue;
        if (rank[p] == 0)
          rank[p] = 1 + (w->params->intrinsics_only ? count : all++);
        count++;
        out[v] = rank[p] % w->params->leave_out == 0;
        left += !out[v];
      }
    }
    enough = enough && left >= MIN_VIEWS;
  }
  for (guint v = 0; v < b->n_views; v++) {
    use[v] = w->views[v].use;
    w->views[v].use = use[v] && !out[v];
  }
  if (enough)
    ok = cloth_bundle_solve (b, NULL, error);
  if (enough && ok) {
    g_autoptr (ClothBundleSpread) spread =
        cloth_bundle_spread_new (b, &undetermined);

    enough = spread != NULL;
  }
  if (enough && ok) {
    for (guint v = 0; v < b->n_views; v++)
      w->views[v].use = use[v] && out[v];
    memset (w->free_bits, 0, b->n_cameras * sizeof (guint));
    b->free_warp = FALSE;
    tell (w, "leave-out check", 0.5);
    ok = cloth_bundle_solve (b, NULL, error);
    for (guint c = 0; ok && c < b->n_cameras; c++) {
      gdouble sum = 0;
      guint points = 0;

      for (guint v = 0; v < b->n_views; v++) {
        if (w->views[v].use && w->views[v].camera == c) {
          gdouble rms = view_rms (b, v);

          sum += rms * rms * w->views[v].n;
          points += w->views[v].n;
        }
      }
      if (points)
        result->cameras[c].left_out_rms = sqrt (sum / points);
      total += sum;
      n += points;
    }
    if (ok && n)
      result->left_out_rms = sqrt (total / n);
  }
  for (guint v = 0; v < b->n_views; v++)
    w->views[v].use = use[v];
  memcpy (b->cameras, cameras, b->n_cameras * sizeof (ClothCamera));
  memcpy (b->poses, poses, 12 * b->n_poses * sizeof (gdouble));
  memcpy (b->warp, warp, sizeof warp);
  return ok;
}

/* @input: cameras, board and views
 * @params: how
 * @progress: (nullable) (scope call): told what goes on
 * @user_data: for @progress
 * @cancellable: (nullable): stops it
 * @error: #GIOErrorEnum cancelled, or #ClothRigError that names the camera and what to do
 *
 * Calibrates each camera alone, places the cameras, then refines everything together:
 * reprojection errors weighed by the corners' covariances and by the scatter found beyond
 * them, robust to outliers, deterministic. Standard deviations come from the inverse
 * information matrix times the residual variance; those of places are relative to the
 * first camera. With @params->intrinsics_only all cameras stay at the origin.
 *
 * Returns: (transfer full): the result, or %NULL.
 */
ClothCalibration *
cloth_calibrate (const ClothCalibrateInput * input,
    const ClothCalibrateParams * params, ClothCalibrateProgress progress,
    gpointer user_data, GCancellable * cancellable, GError ** error)
{
  g_auto (Work) w = { input, params };
  g_autoptr (ClothCalibration) result = NULL;
  g_autoptr (ClothBundleSpread) spread = NULL;
  g_autofree gdouble *C = NULL;
  guint n_poses = MAX (input->n_poses, input->n_views);

  if (!check_input (input, params, error))
    return NULL;
  w.progress = progress;
  w.user_data = user_data;
  w.views = g_memdup2 (input->views, input->n_views * sizeof (ClothBundleView));
  w.view_poses = g_new0 (gdouble, 12 * (gsize) input->n_views + 1);
  w.poses = g_new0 (gdouble, 12 * (gsize) n_poses + 1);
  w.excess = g_new0 (gdouble, input->n_cameras);
  w.free_bits = g_new0 (guint, input->n_cameras);
  w.rig = cloth_rig_new (input->n_cameras);
  for (guint c = 0; c < input->n_cameras; c++) {
    ClothCamera *camera = &w.rig->cameras[c];

    camera->name = g_strdup (input->cameras[c].name);
    camera->device = g_strdup (input->cameras[c].device);
    camera->width = input->cameras[c].width;
    camera->height = input->cameras[c].height;
    camera->lens = input->cameras[c].lens;
  }
  for (guint v = 0; v < input->n_views; v++)
    w.views[v].use = usable (input, &w.views[v]);
  w.bundle = (ClothBundle) {
  input->n_cameras, w.rig->cameras, w.free_bits, params->share_lens,
        input->n_poses, w.poses, input->n_views, w.views, input->board,
        w.excess, params->huber, params->max_iterations, cancellable};

  if (!start_cameras (&w, error) || !fit (&w, error))
    return NULL;

  result = g_new0 (ClothCalibration, 1);
  result->placed = !params->intrinsics_only;
  result->cameras = g_new0 (ClothCalibrateCamera, input->n_cameras);
  result->view_rms = g_new (gdouble, input->n_views + 1);
  result->n_poses = input->n_poses;
  result->poses = g_new (gdouble, 12 * (gsize) input->n_poses + 1);
  result->left_out_rms = NAN;
  for (guint c = 0; c < input->n_cameras; c++)
    result->cameras[c].left_out_rms = NAN;
  for (guint v = 0; v < input->n_views; v++)
    result->view_rms[v] = NAN;
  for (guint i = 0; i < 12 * input->n_poses; i++)
    result->poses[i] = NAN;
  for (guint v = 0; result->placed && v < input->n_views; v++) {
    gsize p = w.views[v].pose;

    if (w.views[v].use)
      memcpy (result->poses + 12 * p, w.poses + 12 * p, 12 * sizeof (gdouble));
  }
  sum_up (&w, result);
  find_outliers (&w, result);
  C = g_new0 (gdouble, N * N * input->n_cameras);
  spread = cloth_bundle_spread_new (&w.bundle, error);
  if (!spread) {
    g_prefix_error (error, "add views, or take a lens model of fewer "
        "coefficients: ");
    return NULL;
  }
  result->variance = cloth_bundle_spread_variance (spread);
  cloth_bundle_spread_cameras (spread, C);
  cloth_bundle_spread_warp (spread, result->warp_sd);
  memcpy (result->warp, w.bundle.warp, sizeof result->warp);
  if (!check_focal (&w, C, error))
    return NULL;
  for (guint c = 0; c < input->n_cameras; c++)
    cloth_uncertainty_map (&w.bundle, spread, c, &result->cameras[c].map);
  g_clear_pointer (&spread, cloth_bundle_spread_free);
  if (params->leave_out > 1 && !leave_out (&w, result, error))
    return NULL;
  place_world (&w, result, C);
  result->rig = g_steal_pointer (&w.rig);
  return g_steal_pointer (&result);
}
