/* Points in space from what several cameras saw, with their covariance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/triangulateprivate.h"

#include <math.h>
#include <string.h>

static const gdouble ones[BLOCK] =
    { 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1. };
static const gdouble zeros[BLOCK] = { 0. };

static void
free_scratch (ClothTriangulator * self)
{
  for (guint i = 0; i < self->n_scratch; i++) {
    g_aligned_free (self->scratch[i]->obs);
    g_free (self->scratch[i]);
  }
  g_clear_pointer (&self->scratch, g_free);
  self->n_scratch = 0;
}

/* @self: (nullable) (transfer full): a triangulator
 */
void
cloth_triangulator_free (ClothTriangulator * self)
{
  if (self == NULL)
    return;
  for (guint i = 0; i < self->n_cameras; i++)
    cloth_camera_clear (&self->cameras[i].camera);
  g_free (self->cameras);
  free_scratch (self);
  g_free (self->reals);
  g_free (self->words);
  g_free (self->bytes);
  g_free (self);
}

/* @self: a triangulator
 * @parameters: copied; by default %CLOTH_TRIANGULATE_PARAMETERS_DEFAULT
 */
void
cloth_triangulator_set_parameters (ClothTriangulator * self,
    const ClothTriangulateParameters * parameters)
{
  self->parameters = *parameters;
  self->parameters.min_views = MAX (parameters->min_views, 2);
  self->limits.error = parameters->threshold * parameters->threshold;
  self->limits.error_px = parameters->max_error > 0. ?
      parameters->max_error * parameters->max_error : INFINITY;
}

/* @self: a triangulator
 * @pool: (nullable): threads to use, which must outlive their use; %NULL: the calling
 *   thread
 *
 * The results are the same bytes whatever the number of threads.
 */
void
cloth_triangulator_set_pool (ClothTriangulator * self, ClothPool * pool)
{
  self->pool = pool;
}

/* @self: a triangulator
 * @simd: vector instructions to use at most; by default the best
 *
 * The results are the same bytes whatever the instructions.
 */
void
cloth_triangulator_set_simd (ClothTriangulator * self, ClothSimd simd)
{
  self->kernel = CLOTH_SIMD_TABLE (cloth_triangulate_kernel, simd);
#ifdef __x86_64__
  /* Whoever has AVX2 has the fused instructions. */
  if (simd == CLOTH_SIMD_SCALAR
      && cloth_simd_resolve (CLOTH_SIMD_BEST) != CLOTH_SIMD_SCALAR)
    self->kernel = &cloth_triangulate_kernel_fused;
#endif
}

/* One observation with the lens model's own undistortion, where the kernel's short Newton
 * iteration did not do. Returns whether it counts as seen. */
static gboolean
load_one (const TriangulateCamera * camera, const gdouble * const *in,
    guint lane, gdouble error_floor, gdouble * obs)
{
  gdouble cxx = in[IN_XX][lane] + error_floor, cxy = in[IN_XY][lane];
  gdouble cyy = in[IN_YY][lane] + error_floor;
  gdouble place[2], J[4], det, sxx, sxy, syy;

  for (guint i = 0; i < N_OBS; i++)
    obs[i * BLOCK + lane] = 0.;
  cloth_camera_undistort_points (&camera->camera, 1, in[IN_U] + lane,
      in[IN_V] + lane, place, place + 1, J);
  /* covariance in normalised coordinates: J·C·Jᵀ */
  sxx = J[0] * J[0] * cxx + 2. * J[0] * J[1] * cxy + J[1] * J[1] * cyy;
  sxy = J[0] * J[2] * cxx + (J[0] * J[3] + J[1] * J[2]) * cxy +
      J[1] * J[3] * cyy;
  syy = J[2] * J[2] * cxx + 2. * J[2] * J[3] * cxy + J[3] * J[3] * cyy;
  det = sxx * syy - sxy * sxy;
  /* false also when anything is NaN */
  if (!(cxx > 0. && cyy > 0. && cxx * cyy - cxy * cxy > 0.)
      || !(sxx > 0. && det > 0. && isfinite (det) && isfinite (place[0])
          && isfinite (place[1])))
    return FALSE;
  obs[OBS_X * BLOCK + lane] = place[0];
  obs[OBS_Y * BLOCK + lane] = place[1];
  obs[OBS_IXX * BLOCK + lane] = syy / det;
  obs[OBS_IXY * BLOCK + lane] = -sxy / det;
  obs[OBS_IYY * BLOCK + lane] = sxx / det;
  return TRUE;
}

/* Fills obs of one block; views: those that saw anything. */
static guint
load_block (ClothTriangulator * self, Scratch * scratch, guint first,
    guint8 * views)
{
  guint n = MIN (self->result.n_points - first, BLOCK), n_views = 0;

  for (guint i = 0; i < self->n_cameras; i++) {
    const ClothTriangulateView *view = &self->views[i];
    const TriangulateCamera *camera = &self->cameras[i];
    gdouble *obs = scratch->obs + i * (N_OBS * BLOCK);
    const gdouble *in[N_IN] = { NULL, NULL, ones, zeros, ones };
    guint again, seen;

    if (view->x == NULL || view->y == NULL)
      continue;
    in[IN_U] = view->x + first;
    in[IN_V] = view->y + first;
    if (view->xx != NULL && view->yy != NULL) {
      in[IN_XX] = view->xx + first;
      in[IN_YY] = view->yy + first;
      if (view->xy != NULL)
        in[IN_XY] = view->xy + first;
    }
    if (n < BLOCK) {
      for (guint k = 0; k < N_IN; k++) {
        for (guint l = 0; l < BLOCK; l++)
          scratch->pad[k * BLOCK + l] = l < n ? in[k][l] : NAN;
        in[k] = scratch->pad + k * BLOCK;
      }
    }
    seen = self->kernel->load (camera, in, self->parameters.error_floor, obs,
        &again);
    for (guint l = 0; again != 0; l++, again >>= 1)
      if (again & 1 && !load_one (camera, in, l,
              self->parameters.error_floor, obs))
        seen &= ~(1u << l);
    if (seen)
      views[n_views++] = (guint8) i;
  }
  return n_views;
}

/* The view with the greatest normalised error from Huber's estimate, which several
 * outliers together pull less than the least squares. */
static guint
worst_by_huber (ClothTriangulator * self, Scratch * scratch,
    const gdouble * obs, const guint8 * views, guint n_views)
{
  gdouble *weighted = scratch->weighted, *out = scratch->trial;
  guint worst = 0;

  /* in the first column; the others saw nothing */
  for (guint i = 0; i < n_views; i++)
    for (guint j = 0; j < N_OBS; j++) {
      gdouble *row = weighted + (views[i] * N_OBS + j) * BLOCK;

      memset (row, 0, BLOCK * sizeof (gdouble));
      row[0] = obs[(views[i] * N_OBS + j) * BLOCK];
    }

  /* iteratively re-weighted least squares (Huber, Robust Statistics, 7.8) */
  for (guint step = 0; step < 20; step++) {
    gdouble greatest = -1.;

    self->kernel->solve (self->cameras, weighted, views, n_views,
        &self->limits, out);
    for (guint i = 0; i < n_views; i++) {
      const gdouble *P = self->cameras[views[i]].P;
      const gdouble *o = obs + views[i] * (N_OBS * BLOCK);
      gdouble *w = weighted + views[i] * (N_OBS * BLOCK);
      gdouble p[3], ex, ey, error, weight;

      for (gint j = 0; j < 3; j++)
        p[j] = P[4 * j] * out[OUT_X * BLOCK] + P[4 * j + 1] *
            out[OUT_Y * BLOCK] + P[4 * j + 2] * out[OUT_Z * BLOCK] +
            P[4 * j + 3];
      ex = p[0] / p[2] - o[OBS_X * BLOCK];
      ey = p[1] / p[2] - o[OBS_Y * BLOCK];
      error = sqrt (ex * ex * o[OBS_IXX * BLOCK] +
          2. * ex * ey * o[OBS_IXY * BLOCK] + ey * ey * o[OBS_IYY * BLOCK]);
      if (!isfinite (error))
        return worst;
      if (error > greatest) {
        greatest = error;
        worst = i;
      }
      weight = error > self->parameters.huber ?
          self->parameters.huber / error : 1.;
      for (gint j = OBS_IXX; j <= OBS_IYY; j++)
        w[j * BLOCK] = weight * o[j * BLOCK];
    }
  }
  return worst;
}

/* Solves a point without view first, without view first + 1 and so on, each in a column
 * of scratch->trial. */
static void
try_without (ClothTriangulator * self, Scratch * scratch, const gdouble * obs,
    const guint8 * views, guint n_views, guint first)
{
  for (guint i = 0; i < n_views; i++) {
    for (guint j = 0; j < N_OBS; j++) {
      guint row = (views[i] * N_OBS + j) * BLOCK;

      for (guint l = 0; l < BLOCK; l++)
        scratch->weighted[row + l] = first + l == i || first + l >= n_views ?
            0. : obs[row];
    }
  }
  self->kernel->solve (self->cameras, scratch->weighted, views, n_views,
      &self->limits, scratch->trial);
}

/* Looks for the views that disagree. On success out holds the solution of the rest, and
 * views those that are left. */
static ClothPointReason
leave_out (ClothTriangulator * self, Scratch * scratch, const gdouble * obs,
    guint8 * views, guint * n_views, gdouble * out)
{
  guint n_seen = *n_views;

  while (*n_views > 2) {
    guint n = *n_views, best = n, n_agreeing = 0, worst;

    for (guint i = 0; i < n; i++) {
      const gdouble *trial = scratch->trial + i % BLOCK;

      if (i % BLOCK == 0)
        try_without (self, scratch, obs, views, n, i);
      if (trial[OUT_REASON * BLOCK] != CLOTH_POINT_FINE)
        continue;
      n_agreeing++;
      if (best == n || trial[OUT_CHI2 * BLOCK] < out[OUT_CHI2 * BLOCK]) {
        best = i;
        for (guint j = 0; j < N_OUT; j++)
          out[j * BLOCK] = trial[j * BLOCK];
      }
    }
    if (best < n) {
      /* Of three views two pairs may agree by chance along the epipolar lines; nothing
       * tells which pair is right. */
      if (n == 3 && n_agreeing > 1)
        return CLOTH_POINT_DISAGREE;
      memmove (views + best, views + best + 1, n - 1 - best);
      *n_views = n - 1;
      return CLOTH_POINT_FINE;
    }
    /* what would agree after two more are gone must still be a majority */
    if (2 * (n - 2) <= n_seen)
      break;
    worst = worst_by_huber (self, scratch, obs, views, n);
    memmove (views + worst, views + worst + 1, n - 1 - worst);
    *n_views = n - 1;
  }
  return CLOTH_POINT_DISAGREE;
}

static void
store_point (ClothTriangulator * self, guint point, ClothPointReason reason,
    const gdouble * out, const guint8 * views, guint n_views, guint n_seen)
{
  ClothTriangulation *r = &self->result;
  gdouble s2 = self->scale * self->scale;
  guint64 mask = 0;

  r->reason[point] = (guint8) reason;
  if (reason != CLOTH_POINT_FINE) {
    for (gint j = 0; j < 3; j++)
      r->position[j][point] = NAN;
    for (gint j = 0; j < 6; j++)
      r->covariance[j][point] = j == 0 || j == 3 || j == 5 ? INFINITY : 0.;
    r->state[point] = CLOTH_POINT_UNSEEN;
    r->n_views[point] = r->n_rejected[point] = 0;
    r->views[point] = 0;
    r->chi2[point] = NAN;
    return;
  }
  for (gint j = 0; j < 3; j++)
    r->position[j][point] = self->origin[j] + self->scale *
        out[(OUT_X + j) * BLOCK];
  for (gint j = 0; j < 6; j++)
    r->covariance[j][point] = s2 * out[(OUT_XX + j) * BLOCK];
  for (guint i = 0; i < n_views; i++)
    mask |= G_GUINT64_CONSTANT (1) << views[i];
  r->views[point] = mask;
  r->n_views[point] = (guint8) n_views;
  r->n_rejected[point] = (guint8) (n_seen - n_views);
  r->chi2[point] = out[OUT_CHI2 * BLOCK];
  r->state[point] = n_views > 2 ? CLOTH_POINT_MEASURED : CLOTH_POINT_TWO_VIEWS;
}

static void
finish_point (ClothTriangulator * self, Scratch * scratch, guint point,
    guint lane, const guint8 * views, guint n_views)
{
  gdouble *out = scratch->out + lane;
  const gdouble *obs = scratch->obs + lane;
  guint8 seen[CLOTH_TRIANGULATE_MAX_CAMERAS];
  guint n = 0, n_seen;
  ClothPointReason reason;

  for (guint i = 0; i < n_views; i++)
    if (obs[(views[i] * N_OBS + OBS_IXX) * BLOCK] > 0.)
      seen[n++] = views[i];
  n_seen = n;
  if (n < self->parameters.min_views) {
    reason = CLOTH_POINT_FEW_VIEWS;
  } else {
    reason = (ClothPointReason) out[OUT_REASON * BLOCK];
    if (reason != CLOTH_POINT_FINE && n > 2) {
      if (leave_out (self, scratch, obs, seen, &n, out) == CLOTH_POINT_FINE)
        reason = n < self->parameters.min_views ? CLOTH_POINT_FEW_VIEWS :
            CLOTH_POINT_FINE;
    }
  }
  store_point (self, point, reason, out, seen, n, n_seen);
}

static void
store_block (ClothTriangulator * self, guint first, const gdouble * out,
    const guint8 * views, guint n_views)
{
  ClothTriangulation *r = &self->result;
  gdouble s2 = self->scale * self->scale;
  guint64 mask = 0;

  for (guint i = 0; i < n_views; i++)
    mask |= G_GUINT64_CONSTANT (1) << views[i];
  for (gint j = 0; j < 3; j++)
    for (guint l = 0; l < BLOCK; l++)
      r->position[j][first + l] = self->origin[j] + self->scale *
          out[(OUT_X + j) * BLOCK + l];
  for (gint j = 0; j < 6; j++)
    for (guint l = 0; l < BLOCK; l++)
      r->covariance[j][first + l] = s2 * out[(OUT_XX + j) * BLOCK + l];
  memcpy (r->chi2 + first, out + OUT_CHI2 * BLOCK, BLOCK * sizeof (gdouble));
  for (guint l = 0; l < BLOCK; l++)
    r->views[first + l] = mask;
  memset (r->reason + first, CLOTH_POINT_FINE, BLOCK);
  memset (r->n_rejected + first, 0, BLOCK);
  memset (r->n_views + first, (int) n_views, BLOCK);
  memset (r->state + first,
      n_views > 2 ? CLOTH_POINT_MEASURED : CLOTH_POINT_TWO_VIEWS, BLOCK);
}

static void
run_blocks (gpointer data, guint begin, guint end, guint worker)
{
  ClothTriangulator *self = data;
  Scratch *scratch = self->scratch[worker];
  guint8 views[CLOTH_TRIANGULATE_MAX_CAMERAS];

  for (guint b = begin; b < end; b++) {
    guint first = b * BLOCK;
    guint n = MIN (self->result.n_points - first, BLOCK), n_views, good = 0;

    n_views = load_block (self, scratch, first, views);
    if (n_views > 1)
      good = self->kernel->solve (self->cameras, scratch->obs, views, n_views,
          &self->limits, scratch->out);
    if (n == BLOCK && good == (1u << BLOCK) - 1
        && n_views >= self->parameters.min_views) {
      store_block (self, first, scratch->out, views, n_views);
      continue;
    }
    for (guint l = 0; l < n; l++)
      finish_point (self, scratch, first + l, l, views, n_views);
  }
}

static void
ensure_memory (ClothTriangulator * self, guint n_points)
{
  guint n_threads = cloth_pool_get_n_threads (self->pool);
  ClothTriangulation *r = &self->result;

  if (n_threads > self->n_scratch) {
    free_scratch (self);
    self->scratch = g_new0 (Scratch *, n_threads);
    self->n_scratch = n_threads;
    for (guint i = 0; i < n_threads; i++) {
      Scratch *s = self->scratch[i] = g_new0 (Scratch, 1);

      s->obs = g_aligned_alloc0 (2 * self->n_cameras * N_OBS * BLOCK,
          sizeof (gdouble), 64);
      s->weighted = s->obs + self->n_cameras * N_OBS * BLOCK;
    }
  }
  if (n_points > self->n_allocated) {
    self->n_allocated = n_points;
    g_free (self->reals);
    g_free (self->words);
    g_free (self->bytes);
    self->reals = g_new (gdouble, 10 * (gsize) n_points);
    self->words = g_new (guint64, n_points);
    self->bytes = g_new (guint8, 4 * (gsize) n_points);
    for (gint j = 0; j < 3; j++)
      r->position[j] = self->reals + j * (gsize) n_points;
    for (gint j = 0; j < 6; j++)
      r->covariance[j] = self->reals + (3 + j) * (gsize) n_points;
    r->chi2 = self->reals + 9 * (gsize) n_points;
    r->views = self->words;
    r->state = self->bytes;
    r->reason = self->bytes + n_points;
    r->n_views = self->bytes + 2 * (gsize) n_points;
    r->n_rejected = self->bytes + 3 * (gsize) n_points;
  }
  r->n_points = n_points;
}

/* @self: a triangulator
 * @n_views: as many as there are cameras
 * @views: (array length=n_views): what each camera saw, in the cameras' order
 * @n_points: number of points, 0 … %CLOTH_TRIANGULATE_MAX_POINTS
 * @result: (out) (transfer none): belongs to @self until the next run
 * @error: return location
 *
 * Each point on its own: observations are undistorted and their covariances carried
 * along; the linear estimate (Hartley & Zisserman, 12.2) starts Gauss–Newton on the
 * normalised reprojection error, whose minimum is the maximum-likelihood point for
 * Gaussian errors. Every view is tested against the others, by how much χ² falls when it
 * is left out. If one is above the threshold, views are left out in turn; while no
 * remainder agrees, the view with the greatest error from Huber's robust estimate goes,
 * as long as a majority is left. The covariance is the inverse of the information of the
 * views used: it scales with the stated covariances only, not with how well they fit.
 *
 * Memory is allocated when the number of points or threads grows, not otherwise.
 *
 * Returns: %FALSE on wrong counts
 */
gboolean
cloth_triangulator_run (ClothTriangulator * self, guint n_views,
    const ClothTriangulateView * views, guint n_points,
    const ClothTriangulation ** result, GError ** error)
{
  if (n_views != self->n_cameras) {
    g_set_error (error, CLOTH_TRIANGULATE_ERROR, CLOTH_TRIANGULATE_ERROR_VIEWS,
        "%u views for %u cameras; give one view a camera, an empty one where a "
        "camera saw nothing", n_views, self->n_cameras);
    return FALSE;
  }
  if (n_points > CLOTH_TRIANGULATE_MAX_POINTS) {
    g_set_error (error, CLOTH_TRIANGULATE_ERROR,
        CLOTH_TRIANGULATE_ERROR_POINTS, "%u points are more than %d", n_points,
        CLOTH_TRIANGULATE_MAX_POINTS);
    return FALSE;
  }
  ensure_memory (self, n_points);
  self->views = views;
  cloth_pool_run (self->pool, run_blocks, self, (n_points + BLOCK - 1) / BLOCK);
  self->views = NULL;
  *result = &self->result;
  return TRUE;
}
