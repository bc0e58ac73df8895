/* Cameras calibrated by the cloth that they film: bundle adjustment of all places of the cloth and
 * of each camera's place, focal length and clock.
 *
 * Model: camera c sees place p of the cloth at π_c (X_p), in the picture of the time t + o_c.
 * Assumption: most cameras are as they were calibrated, a few are far off: a change θ of a camera's
 *   direction, place, focal length or clock costs ln (1 + |θ|²/s²), Cauchy's, with s the
 *   calibration's accuracy. It also keeps the world where most cameras have it.
 * Formula: min Σ ρ (|z_cp (o_c) − π_c (X_p; θ_c)|_Σ) + Σ ln (1 + |θ|²/s²), ρ Huber's; places are
 *   eliminated from the normal equations (Schur's complement). Covariance: inverse of what is
 *   left, times χ² over the degrees of freedom.
 * Reference: Triggs, McLauchlan, Hartley and Fitzgibbon, Bundle adjustment, a modern synthesis, 2000.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/rig/refine.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/math/linalg.h"
#include "gst/math/statistics.h"
#include "gst/math/vec3.h"
#include "gst/rig/errorfloor.h"
#include "gst/rig/rotation.h"

/* Of a camera: rotation, translation, relative focal length, clock. */
#define EACH 8
#define FOCAL 6
#define CLOCK 7
/* Starts and limits of the damping. */
#define DAMPING 1e-4
#define LARGEST_DAMPING 1e8
/* It ends when the cost falls by less than this part. */
#define SETTLED 1e-7
/* Most fits of the cameras and of the error floor, in turn, and by which part of its scale a number
 * may still move at the end. */
#define MOST_TURNS 12
#define SETTLED_SHARE 0.02
/* Fewer places with two rays tell nothing of a rig. */
#define LEAST_POINTS 50
/* A rate in a picture is a difference over this part of a frame. */
#define RATE_STEP 0.02
/* Where cameras must meet at least for a first guess: all views count, however far off. */
#define NO_THRESHOLD 1e6

typedef struct
{
  guint frame, vertex;
  gdouble X[3], trial[3];
  guint first, n;               /* among the observations */
} Point;

typedef struct
{
  guint camera;
  gdouble px[2], rate[2];       /* px, px/s */
  gdouble covariance[3];        /* xx, xy, yy, px² */
} Seen;

typedef struct
{
  const ClothObservations *observations;
  const ClothRefineOptions *options;
  const ClothRig *rig;
  ClothViews *views;
  gdouble frame_s;
  guint n_cameras, n_frames, n_seeing;  /* cameras; those with pictures */
  gdouble *times;
  ClothCamera *cameras, *trial;
  gdouble *theta, *trial_theta; /* [camera][EACH], from the rig */
  GArray *points, *seen;
  gdouble floor;
} Refine;

static void
refine_clear (Refine * r)
{
  cloth_views_free (r->views);
  g_free (r->times);
  for (guint c = 0; r->cameras && c < r->n_cameras; c++) {
    cloth_camera_clear (&r->cameras[c]);
    cloth_camera_clear (&r->trial[c]);
  }
  g_free (r->cameras);
  g_free (r->trial);
  g_free (r->theta);
  g_free (r->trial_theta);
  g_clear_pointer (&r->points, g_array_unref);
  g_clear_pointer (&r->seen, g_array_unref);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Refine, refine_clear);

static const ClothObservation *
picture (const Refine * r, guint i)
{
  return &g_array_index (r->observations->list, ClothObservation, i);
}

/* The times of the camera with the most pictures, by the rig's clock. */
static gboolean
find_times (Refine * r, GError ** error)
{
  g_autofree guint *counts = g_new0 (guint, r->n_cameras);
  g_autofree gdouble *steps = NULL;
  guint best = 0, n = 0;

  for (guint i = 0; i < r->observations->list->len; i++)
    counts[picture (r, i)->camera]++;
  for (guint c = 0; c < r->n_cameras; c++) {
    if (counts[c] > counts[best])
      best = c;
    n += counts[c] > 1;
    r->n_seeing += counts[c] > 0;
  }
  if (n < 2) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "cameras are refined by what two of them see of the same cloth; only "
        "%u of %u took pictures", n, r->n_cameras);
    return FALSE;
  }
  r->times = g_new (gdouble, counts[best]);
  for (guint i = 0; i < r->observations->list->len; i++)
    if (picture (r, i)->camera == best)
      r->times[r->n_frames++] = picture (r, i)->time_s -
          r->rig->cameras[best].offset_s;
  /* a pause between two parts of the film is no frame */
  steps = g_new (gdouble, r->n_frames);
  for (guint f = 1; f < r->n_frames; f++)
    steps[f - 1] = r->times[f] - r->times[f - 1];
  r->frame_s = cloth_median (steps, r->n_frames - 1);
  return TRUE;
}

static gboolean
refine_init (Refine * r, const ClothObservations * observations,
    const ClothRefineOptions * options, GError ** error)
{
  const ClothRig *rig = observations->rig;

  *r = (Refine) {
  observations, options, rig,.n_cameras = rig->n_cameras};
  r->cameras = g_new0 (ClothCamera, rig->n_cameras);
  r->trial = g_new0 (ClothCamera, rig->n_cameras);
  for (guint c = 0; c < rig->n_cameras; c++) {
    cloth_camera_copy (&r->cameras[c], &rig->cameras[c]);
    cloth_camera_copy (&r->trial[c], &rig->cameras[c]);
  }
  r->theta = g_new0 (gdouble, EACH * (gsize) rig->n_cameras);
  r->trial_theta = g_new0 (gdouble, EACH * (gsize) rig->n_cameras);
  r->points = g_array_new (FALSE, FALSE, sizeof (Point));
  r->seen = g_array_new (FALSE, FALSE, sizeof (Seen));
  if (!find_times (r, error))
    return FALSE;
  r->views = cloth_views_new (observations, r->frame_s);
  return TRUE;
}

/* All that the cameras saw at a frame's time, as their clocks are now; @rates: [camera][n][2]. */
static void
find_views (Refine * r, guint frame, gdouble * rates)
{
  const gdouble step = RATE_STEP * r->frame_s;

  for (guint c = 0; c < r->n_cameras; c++) {
    const gdouble time = r->times[frame] + r->cameras[c].offset_s;
    const ClothTriangulateView *view = &r->views->views[c];
    gdouble *rate = rates + 2 * (gsize) c * r->views->n;

    /* a rate is of the lines or polynomials about the time itself */
    cloth_views_find (r->views, c, time + step);
    for (guint v = 0; v < r->views->n; v++) {
      rate[2 * v] = view->x[v];
      rate[2 * v + 1] = view->y[v];
    }
    cloth_views_find (r->views, c, time - step);
    for (guint v = 0; v < r->views->n; v++) {
      rate[2 * v] = (rate[2 * v] - view->x[v]) / (2. * step);
      rate[2 * v + 1] = (rate[2 * v + 1] - view->y[v]) / (2. * step);
    }
    cloth_views_find (r->views, c, time);
  }
}

static void
add_point (Refine * r, guint frame, guint v, const gdouble X[3],
    const gdouble * rates)
{
  Point point = { frame, v, {X[0], X[1], X[2]}, {0.}, r->seen->len };

  for (guint c = 0; c < r->n_cameras; c++) {
    const ClothTriangulateView *view = &r->views->views[c];
    const gdouble *rate = rates + 2 * ((gsize) c * r->views->n + v);
    const Seen seen = { c, {view->x[v], view->y[v]}, {rate[0], rate[1]},
    {view->xx[v], view->xy[v], view->yy[v]}
    };
    gdouble px[2];

    /* where it isn't known how the point moves nothing is known of the clock */
    if (isfinite (seen.px[0] + seen.px[1] + seen.rate[0] + seen.rate[1])
        && cloth_camera_project (&r->cameras[c], X, px, NULL, NULL)) {
      g_array_append_val (r->seen, seen);
      point.n++;
    }
  }
  if (point.n >= 2)
    g_array_append_val (r->points, point);
  else
    g_array_set_size (r->seen, point.first);
}

static guint
count_places (const Refine * r)
{
  gsize n = 0;

  for (guint i = 0; i < r->observations->list->len; i++)
    n += picture (r, i)->n;
  return (guint) MIN (n / r->n_seeing, G_MAXUINT);
}

/* Places and what was seen of them, with the cameras as they are now. Frame after frame other
 * vertices are left out when there are too many. */
static gboolean
gather (Refine * r, GError ** error)
{
  const guint stride = count_places (r) / r->options->most_points + 1;
  ClothTriangulateParameters parameters = CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;
  g_autoptr (ClothTriangulator) triangulator =
      cloth_triangulator_new (r->n_cameras, r->cameras, error);
  g_autofree gdouble *rates = g_new (gdouble, 2 * (gsize) r->n_cameras *
      r->views->n);

  if (!triangulator)
    return FALSE;
  g_array_set_size (r->points, 0);
  g_array_set_size (r->seen, 0);
  parameters.threshold = NO_THRESHOLD;
  parameters.error_floor = r->floor;
  cloth_triangulator_set_parameters (triangulator, &parameters);
  for (guint f = 0; f < r->n_frames; f++) {
    const ClothTriangulation *t;

    find_views (r, f, rates);
    if (!cloth_triangulator_run (triangulator, r->n_cameras, r->views->views,
            r->views->n, &t, error))
      return FALSE;
    for (guint v = f % stride; v < r->views->n; v += stride) {
      const gdouble X[3] =
          { t->position[0][v], t->position[1][v], t->position[2][v] };

      if (t->reason[v] == CLOTH_POINT_FINE)
        add_point (r, f, v, X, rates);
    }
  }
  if (r->points->len >= LEAST_POINTS)
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "only %u "
      "places of the cloth are seen by two cameras at a time, and at least %u "
      "are needed: film a longer take with views that overlap",
      r->points->len, LEAST_POINTS);
  return FALSE;
}

static void
set_camera (const ClothCamera * from, const gdouble theta[EACH],
    ClothCamera * to)
{
  gdouble turn[9], t[3];

  cloth_rotation_from_vector (theta, turn);
  cloth_mat3_mul (turn, from->R, to->R);
  cloth_mat3_vec (turn, from->t, t);
  for (guint k = 0; k < 3; k++)
    to->t[k] = t[k] + theta[3 + k];
  for (guint k = 0; k < 6; k++)
    to->K[k] = k == 0 || k == 1 || k == 4 ?
        from->K[k] * exp (theta[FOCAL]) : from->K[k];
  to->offset_s = from->offset_s + theta[CLOCK];
}

/* The residual of an observation, whitened, by its Cholesky factor; FALSE: behind the camera.
 * @d_point: [2][3], @d_camera: [2][EACH], whitened, both may be NULL. @shift: what the camera's
 * clock has moved by since it was gathered, s. */
static gboolean
find_residual (const Refine * r, const Seen * s, const ClothCamera * camera,
    gdouble shift, const gdouble X[3], gdouble e[2], gdouble * d_point,
    gdouble * d_camera)
{
  const gdouble a = sqrt (s->covariance[0] + r->floor);
  const gdouble b = s->covariance[1] / a;
  const gdouble c = sqrt (fmax (s->covariance[2] + r->floor - b * b, 1e-12));
  gdouble px[2], d_X[6], d_all[2 * CLOTH_CAMERA_N_PARAMETERS];

  if (!cloth_camera_project (camera, X, px, d_point ? d_X : NULL,
          d_camera ? d_all : NULL))
    return FALSE;
  for (guint i = 0; i < 2; i++)
    e[i] = px[i] - s->px[i] - shift * s->rate[i];
  e[0] /= a;
  e[1] = (e[1] - b * e[0]) / c;
  if (d_point) {
    gdouble x[3], seen[6];

    /* by the point in the camera's frame */
    cloth_mat3_vec (camera->R, X, x);
    for (guint k = 0; k < 3; k++)
      x[k] += camera->t[k];
    for (guint i = 0; i < 2; i++)
      cloth_mat3_vec (camera->R, d_X + 3 * i, seen + 3 * i);
    for (guint i = 0; i < 2; i++) {
      gdouble *to = d_camera + EACH * i, *d = seen + 3 * i;

      /* ω × x */
      to[0] = d[2] * x[1] - d[1] * x[2];
      to[1] = d[0] * x[2] - d[2] * x[0];
      to[2] = d[1] * x[0] - d[0] * x[1];
      for (guint k = 0; k < 3; k++)
        to[3 + k] = d[k];
      to[FOCAL] = d_all[CLOTH_CAMERA_N_PARAMETERS * i] * camera->K[0] +
          d_all[CLOTH_CAMERA_N_PARAMETERS * i + 1] * camera->K[4];
      to[CLOCK] = -s->rate[i];
    }
    for (guint k = 0; k < 3; k++) {
      d_point[k] = d_X[k] / a;
      d_point[3 + k] = (d_X[3 + k] - b * d_point[k]) / c;
    }
    for (guint k = 0; k < EACH; k++) {
      d_camera[k] /= a;
      d_camera[EACH + k] = (d_camera[EACH + k] - b * d_camera[k]) / c;
    }
  }
  return TRUE;
}

static gdouble
huber_cost (gdouble square, gdouble huber)
{
  return square <= huber * huber ? square :
      2. * huber * sqrt (square) - huber * huber;
}

/* Of the parts of θ: where each begins and ends, and its scale. */
static gdouble
find_part (const ClothRefineOptions * o, guint part, guint * begin, guint * end)
{
  const guint edges[5] = { 0, 3, 6, 7, 8 };
  const gdouble scales[4] = { o->turned_rad, o->moved_m, o->focal, o->late_s };

  *begin = edges[part];
  *end = edges[part + 1];
  return scales[part];
}

static gdouble
find_square (const gdouble * theta, guint begin, guint end, gdouble scale)
{
  gdouble square = 0.;

  for (guint k = begin; k < end; k++)
    square += theta[k] * theta[k] / (scale * scale);
  return square;
}

/* The part of the cost that the calibration has. */
static gdouble
prior_cost (const Refine * r, const gdouble * theta)
{
  gdouble cost = 0.;

  for (guint c = 0; c < r->n_cameras; c++)
    for (guint part = 0; part < 4; part++) {
      guint begin, end;
      gdouble scale = find_part (r->options, part, &begin, &end);

      cost += (end - begin + 1.) * log1p (find_square (theta + EACH * c, begin,
              end, scale));
    }
  return cost;
}

/* @gathered: θ when what was seen was gathered; @chi_square: of residuals as Huber's weights have
 * them */
static gdouble
find_cost (const Refine * r, gboolean trial, const gdouble * gathered,
    gdouble * chi_square, guint * n)
{
  const ClothCamera *cameras = trial ? r->trial : r->cameras;
  const gdouble *theta = trial ? r->trial_theta : r->theta;
  gdouble cost = prior_cost (r, theta), sum = 0.;
  guint count = 0;

  for (guint i = 0; i < r->points->len; i++) {
    const Point *p = &g_array_index (r->points, Point, i);

    for (guint k = 0; k < p->n; k++) {
      const Seen *s = &g_array_index (r->seen, Seen, p->first + k);
      const guint clock = EACH * s->camera + CLOCK;
      gdouble e[2], square;

      if (!find_residual (r, s, &cameras[s->camera],
              theta[clock] - gathered[clock], trial ? p->trial : p->X, e, NULL,
              NULL))
        return INFINITY;
      square = e[0] * e[0] + e[1] * e[1];
      cost += huber_cost (square, r->options->huber);
      sum += fmin (square, r->options->huber * sqrt (square));
      count += 2;
    }
  }
  if (chi_square)
    *chi_square = sum;
  if (n)
    *n = count;
  return cost;
}

typedef struct
{
  guint m;                      /* EACH · cameras */
  gdouble *U, *g;               /* of the cameras */
  gdouble *W;                   /* [observation][EACH][3] */
  gdouble *V;                   /* inverses, [point][9] */
  gdouble *gp;                  /* [point][3] */
} Normal;

static void
normal_init (Normal * n, const Refine * r)
{
  n->m = EACH * r->n_cameras;
  n->U = g_new (gdouble, (gsize) n->m * n->m);
  n->g = g_new (gdouble, n->m);
  n->W = g_new (gdouble, 3 * EACH * (gsize) r->seen->len);
  n->V = g_new (gdouble, 9 * (gsize) r->points->len);
  n->gp = g_new (gdouble, 3 * (gsize) r->points->len);
}

static void
normal_clear (Normal * n)
{
  g_free (n->U);
  g_free (n->g);
  g_free (n->W);
  g_free (n->V);
  g_free (n->gp);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Normal, normal_clear);

/* What Cauchy's cost is like near θ: a quadratic of this weight. */
static void
add_prior (const Refine * r, Normal * n)
{
  for (guint c = 0; c < r->n_cameras; c++)
    for (guint part = 0; part < 4; part++) {
      const gdouble *theta = r->theta + EACH * c;
      guint begin, end;
      gdouble scale = find_part (r->options, part, &begin, &end), weight;

      weight = (end - begin + 1.) / (scale * scale) /
          (1. + find_square (theta, begin, end, scale));
      for (guint k = begin; k < end; k++) {
        const guint at = EACH * c + k;

        n->U[(gsize) at * n->m + at] += weight;
        n->g[at] -= weight * theta[k];
      }
    }
}

/* One point: its block is inverted, and what it takes from the cameras' equations is taken. */
static gboolean
add_point_normal (const Refine * r, const gdouble * gathered, guint index,
    gdouble damping, Normal * n)
{
  const Point *p = &g_array_index (r->points, Point, index);
  gdouble V[9] = { 0. }, *inverse = n->V + 9 * (gsize) index;
  gdouble *gp = n->gp + 3 * (gsize) index;

  memset (gp, 0, 3 * sizeof *gp);
  for (guint i = 0; i < p->n; i++) {
    const Seen *s = &g_array_index (r->seen, Seen, p->first + i);
    const guint base = EACH * s->camera;
    gdouble *W = n->W + 3 * EACH * (gsize) (p->first + i);
    gdouble e[2], A[6], B[2 * EACH], size, weight;

    if (!find_residual (r, s, &r->cameras[s->camera],
            r->theta[base + CLOCK] - gathered[base + CLOCK], p->X, e, A, B))
      return FALSE;
    size = hypot (e[0], e[1]);
    weight = size > r->options->huber ? r->options->huber / size : 1.;
    memset (W, 0, 3 * EACH * sizeof *W);
    for (guint k = 0; k < 2; k++) {
      const gdouble *a = A + 3 * k, *b = B + EACH * k;

      for (guint x = 0; x < 3; x++) {
        for (guint y = 0; y < 3; y++)
          V[3 * x + y] += weight * a[x] * a[y];
        gp[x] -= weight * a[x] * e[k];
      }
      for (guint x = 0; x < EACH; x++) {
        for (guint y = 0; y < EACH; y++)
          n->U[(gsize) (base + x) * n->m + base + y] += weight * b[x] * b[y];
        for (guint y = 0; y < 3; y++)
          W[3 * x + y] += weight * b[x] * a[y];
        n->g[base + x] -= weight * b[x] * e[k];
      }
    }
  }
  for (guint x = 0; x < 3; x++)
    V[4 * x] *= 1. + damping;
  return cloth_mat3_inverse (V, inverse);
}

static void
eliminate_point (const Refine * r, guint index, Normal * n)
{
  const Point *p = &g_array_index (r->points, Point, index);
  const gdouble *inverse = n->V + 9 * (gsize) index;
  const gdouble *gp = n->gp + 3 * (gsize) index;

  for (guint i = 0; i < p->n; i++) {
    const gdouble *W = n->W + 3 * EACH * (gsize) (p->first + i);
    const guint at = EACH * g_array_index (r->seen, Seen, p->first + i).camera;
    gdouble WV[3 * EACH];

    for (guint x = 0; x < EACH; x++) {
      for (guint y = 0; y < 3; y++)
        WV[3 * x + y] = W[3 * x] * inverse[y] + W[3 * x + 1] * inverse[3 + y] +
            W[3 * x + 2] * inverse[6 + y];
      n->g[at + x] -= cloth_vec3_dot (WV + 3 * x, gp);
    }
    for (guint j = 0; j < p->n; j++) {
      const gdouble *other = n->W + 3 * EACH * (gsize) (p->first + j);
      const guint to = EACH * g_array_index (r->seen, Seen,
          p->first + j).camera;

      for (guint x = 0; x < EACH; x++)
        for (guint y = 0; y < EACH; y++)
          n->U[(gsize) (at + x) * n->m + to + y] -=
              cloth_vec3_dot (WV + 3 * x, other + 3 * y);
    }
  }
}

/* The cameras' equations without the places; FALSE: they have no solution. */
static gboolean
make_normal (const Refine * r, const gdouble * gathered, gdouble damping,
    Normal * n)
{
  memset (n->U, 0, (gsize) n->m * n->m * sizeof *n->U);
  memset (n->g, 0, n->m * sizeof *n->g);
  for (guint i = 0; i < r->points->len; i++)
    if (!add_point_normal (r, gathered, i, damping, n))
      return FALSE;
  add_prior (r, n);
  for (guint k = 0; k < n->m; k++)
    n->U[(gsize) k * n->m + k] *= 1. + damping;
  for (guint i = 0; i < r->points->len; i++)
    eliminate_point (r, i, n);
  return cloth_cholesky_factor (n->m, n->U);
}

/* Where a step leads, into the trial. */
static void
try_step (Refine * r, Normal * n)
{
  cloth_cholesky_solve (n->m, n->U, n->g);
  for (guint k = 0; k < n->m; k++)
    r->trial_theta[k] = r->theta[k] + n->g[k];
  for (guint c = 0; c < r->n_cameras; c++) {
    gdouble step[3], turn[9], before[9], both[9];

    /* rotations are composed, not added */
    memcpy (step, n->g + EACH * c, sizeof step);
    cloth_rotation_from_vector (step, turn);
    cloth_rotation_from_vector (r->theta + EACH * c, before);
    cloth_mat3_mul (turn, before, both);
    cloth_rotation_to_vector (both, r->trial_theta + EACH * c);
    /* x′ = turn (R₀ x + t₀ …) + τ: what was moved before turns, too */
    cloth_mat3_vec (turn, r->theta + EACH * c + 3,
        r->trial_theta + EACH * c + 3);
    for (guint k = 0; k < 3; k++)
      r->trial_theta[EACH * c + 3 + k] += n->g[EACH * c + 3 + k];
    set_camera (&r->rig->cameras[c], r->trial_theta + EACH * c, &r->trial[c]);
  }
  for (guint i = 0; i < r->points->len; i++) {
    Point *p = &g_array_index (r->points, Point, i);
    const gdouble *inverse = n->V + 9 * (gsize) i;
    gdouble right[3], move[3];

    memcpy (right, n->gp + 3 * (gsize) i, sizeof right);
    for (guint k = 0; k < p->n; k++) {
      const gdouble *W = n->W + 3 * EACH * (gsize) (p->first + k);
      const gdouble *step = n->g + EACH * g_array_index (r->seen, Seen,
          p->first + k).camera;

      for (guint x = 0; x < EACH; x++)
        for (guint y = 0; y < 3; y++)
          right[y] -= W[3 * x + y] * step[x];
    }
    cloth_mat3_vec (inverse, right, move);
    for (guint k = 0; k < 3; k++)
      p->trial[k] = p->X[k] + move[k];
  }
}

static void
take_step (Refine * r)
{
  memcpy (r->theta, r->trial_theta, EACH * (gsize) r->n_cameras *
      sizeof *r->theta);
  for (guint c = 0; c < r->n_cameras; c++)
    set_camera (&r->rig->cameras[c], r->theta + EACH * c, &r->cameras[c]);
  for (guint i = 0; i < r->points->len; i++) {
    Point *p = &g_array_index (r->points, Point, i);

    memcpy (p->X, p->trial, sizeof p->X);
  }
}

/* Levenberg and Marquardt, with what was seen as it was gathered. */
static void
solve (Refine * r)
{
  g_auto (Normal) n = { 0 };
  g_autofree gdouble *gathered = g_memdup2 (r->theta,
      EACH * (gsize) r->n_cameras * sizeof *r->theta);
  gdouble damping = DAMPING, cost = find_cost (r, FALSE, gathered, NULL, NULL);

  normal_init (&n, r);
  for (guint i = 0; i < r->options->max_iterations
      && damping < LARGEST_DAMPING; i++) {
    gdouble next = INFINITY;

    if (make_normal (r, gathered, damping, &n)) {
      try_step (r, &n);
      next = find_cost (r, TRUE, gathered, NULL, NULL);
    }
    if (!(next < cost)) {
      damping *= 10.;
      continue;
    }
    take_step (r);
    damping = fmax (damping / 10., 1e-12);
    if (cost - next < SETTLED * cost)
      break;
    cost = next;
  }
}

/* Observations of each camera that are used. */
static guint *
count_seen (const Refine * r)
{
  guint *counts = g_new0 (guint, r->n_cameras);

  for (guint i = 0; i < r->seen->len; i++)
    counts[g_array_index (r->seen, Seen, i).camera]++;
  return counts;
}

/* All clocks may run late together: the rig's time is that of most of them. One that saw nothing
 * stays. */
static void
set_clocks (Refine * r)
{
  g_autofree guint *counts = count_seen (r);
  g_autofree gdouble *late = g_new (gdouble, r->n_cameras);
  gdouble usual;
  guint n = 0;

  for (guint c = 0; c < r->n_cameras; c++)
    if (counts[c])
      late[n++] = r->theta[EACH * c + CLOCK];
  usual = cloth_median (late, n);
  for (guint c = 0; c < r->n_cameras; c++) {
    if (!counts[c])
      continue;
    r->theta[EACH * c + CLOCK] -= usual;
    set_camera (&r->rig->cameras[c], r->theta + EACH * c, &r->cameras[c]);
  }
}

/* What the cameras still disagree by, from film to film. */
static gboolean
find_floor (Refine * r, const ClothCamera * cameras, gdouble * floor,
    GError ** error)
{
  g_autoptr (ClothTriangulator) triangulator =
      cloth_triangulator_new (r->n_cameras, cameras, error);
  ClothTriangulateParameters parameters = CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;
  ClothErrorFloor self = { 0. };

  if (!triangulator)
    return FALSE;
  for (guint f = 0; f < r->n_frames; f++) {
    const ClothTriangulation *t;

    for (guint c = 0; c < r->n_cameras; c++)
      cloth_views_find (r->views, c, r->times[f] + cameras[c].offset_s);
    parameters.error_floor = self.floor;
    cloth_triangulator_set_parameters (triangulator, &parameters);
    if (!cloth_triangulator_run (triangulator, r->n_cameras, r->views->views,
            r->views->n, &t, error))
      return FALSE;
    cloth_error_floor_add (&self, r->n_cameras, r->views->views, t);
  }
  *floor = self.floor;
  return TRUE;
}

/* How well some cameras agree: χ² over its degrees of freedom of what agrees, and the share of the
 * observations that contradict the others. */
static gboolean
find_agreement (Refine * r, const ClothCamera * cameras,
    ClothRefineAgreement * agreement, GError ** error)
{
  g_autoptr (ClothTriangulator) triangulator =
      cloth_triangulator_new (r->n_cameras, cameras, error);
  ClothTriangulateParameters parameters = CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;
  gdouble sum = 0., n = 0., used = 0., rejected = 0.;

  if (!triangulator)
    return FALSE;
  parameters.error_floor = r->floor;
  cloth_triangulator_set_parameters (triangulator, &parameters);
  for (guint f = 0; f < r->n_frames; f++) {
    const ClothTriangulation *t;

    for (guint c = 0; c < r->n_cameras; c++)
      cloth_views_find (r->views, c, r->times[f] + cameras[c].offset_s);
    if (!cloth_triangulator_run (triangulator, r->n_cameras, r->views->views,
            r->views->n, &t, error))
      return FALSE;
    for (guint v = 0; v < r->views->n; v++) {
      rejected += t->n_rejected[v];
      used += t->n_views[v];
      if (t->reason[v] == CLOTH_POINT_FINE && t->n_views[v] > 2) {
        sum += t->chi2[v];
        n += 2. * t->n_views[v] - 3.;
      }
    }
  }
  agreement->chi_square = n > 0. ? sum / n : NAN;
  agreement->contradicted = rejected / fmax (used + rejected, 1.);
  return TRUE;
}

/* Of t = ω × t + τ, whose @axis-th number it is. */
static gdouble
find_t_sd (const gdouble * covariance, guint m, guint first,
    const gdouble t[3], guint axis, gdouble scale)
{
  const guint a = (axis + 1) % 3, b = (axis + 2) % 3;
  const guint at[3] = { first + a, first + b, first + 3 + axis };
  const gdouble by[3] = { t[b], -t[a], 1. };
  gdouble variance = 0.;

  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 3; k++)
      variance += by[i] * by[k] * covariance[(gsize) at[i] * m + at[k]];
  return sqrt (scale * variance);
}

/* Whether no number moved since the turn before, whose numbers become these. */
static gboolean
has_settled (const Refine * r, gdouble * before)
{
  gboolean settled = TRUE;

  for (guint c = 0; c < r->n_cameras; c++)
    for (guint part = 0; part < 4; part++) {
      guint begin, end;
      gdouble scale = find_part (r->options, part, &begin, &end);

      for (guint k = begin; k < end; k++)
        settled = settled && fabs (r->theta[EACH * c + k] -
            before[EACH * c + k]) < SETTLED_SHARE * scale;
    }
  memcpy (before, r->theta, EACH * (gsize) r->n_cameras * sizeof *before);
  return settled;
}

static ClothRefinement *
refinement_new (Refine * r, GError ** error)
{
  g_autoptr (ClothRefinement) result = g_new0 (ClothRefinement, 1);
  g_auto (Normal) n = { 0 };
  g_autofree gdouble *covariance = NULL;
  g_autofree guint *counts = count_seen (r);
  gdouble sum, scale, freedom;
  guint count;

  result->n_points = r->points->len;
  result->n_observations = r->seen->len;
  result->error_floor = r->floor;
  if (!find_agreement (r, r->rig->cameras, &result->before, error)
      || !find_agreement (r, r->cameras, &result->after, error))
    return NULL;
  normal_init (&n, r);
  if (!make_normal (r, r->theta, 0., &n)) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "what the cameras saw does not tell where they are; film cloth that "
        "fills more of the pictures");
    return NULL;
  }
  covariance = g_new (gdouble, (gsize) n.m * n.m);
  cloth_cholesky_inverse (n.m, n.U, covariance);
  find_cost (r, FALSE, r->theta, &sum, &count);
  freedom = count - 3. * r->points->len;
  for (guint c = 0; c < r->n_cameras; c++)
    freedom -= counts[c] ? EACH : 0;
  if (!(freedom > 0.)) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "%u observations of %u places are too few for the cameras; film a "
        "longer take, seen by more cameras at a time", r->seen->len,
        r->points->len);
    return NULL;
  }
  scale = fmax (1., sum / freedom);
  result->rig = cloth_rig_new (r->n_cameras);
  result->cameras = g_new0 (ClothRefineCamera, r->n_cameras);
  for (guint c = 0; c < r->n_cameras; c++) {
    ClothRefineCamera *to = &result->cameras[c];
    ClothCamera *camera = &result->rig->cameras[c];
    const gdouble *theta = r->theta + EACH * c;
    gdouble sd[EACH], centre[2][3];

    cloth_camera_copy (camera, &r->cameras[c]);
    for (guint k = 0; k < EACH; k++)
      sd[k] = sqrt (scale * covariance[(gsize) (EACH * c + k) * (n.m + 1)]);
    for (guint k = 0; k < 2; k++) {
      const ClothCamera *of = k ? &r->cameras[c] : &r->rig->cameras[c];

      cloth_mat3_vec_t (of->R, of->t, centre[k]);
    }
    for (guint k = 0; k < 3; k++) {
      gdouble variance = 0.;

      to->turned_rad[k] = theta[k];
      to->turned_sd[k] = camera->r_sd[k] = sd[k];
      to->moved_m[k] = centre[0][k] - centre[1][k];
      camera->t_sd[k] = find_t_sd (covariance, n.m, EACH * c, camera->t, k,
          scale);
      /* a turn is about the centre itself */
      for (guint i = 0; i < 3; i++)
        for (guint j = 0; j < 3; j++)
          variance += camera->R[3 * i + k] * camera->R[3 * j + k] *
              covariance[(gsize) (EACH * c + 3 + i) * n.m + EACH * c + 3 + j];
      to->moved_sd[k] = sqrt (scale * variance);
    }
    to->focal = expm1 (theta[FOCAL]);
    to->focal_sd = sd[FOCAL];
    for (guint k = 0; k < 2; k++)
      camera->K_sd[k] = sd[FOCAL] * camera->K[k ? 4 : 0];
    to->late_s = theta[CLOCK];
    to->late_sd = camera->offset_sd = sd[CLOCK];
    to->n = counts[c];
  }
  return g_steal_pointer (&result);
}

/* @observations: what the cameras saw of one cloth, and the rig as it was calibrated
 * @options: how sure that was
 * @error: #ClothFitError, #ClothTriangulateError
 *
 * Corrects a rig by a film of cloth: directions, places, focal lengths and clocks. Lenses and
 * centres of pictures stay. Neither a mesh nor a model is needed. A camera without pictures stays
 * as it was.
 *
 * Returns: (transfer full) (nullable): the rig as the film has it
 */
ClothRefinement *
cloth_refine_rig (const ClothObservations * observations,
    const ClothRefineOptions * options, GError ** error)
{
  g_auto (Refine) r = { NULL };
  g_autoptr (ClothRefinement) result = NULL;
  g_autofree gdouble *before = NULL;
  gboolean settled = FALSE;

  if (!refine_init (&r, observations, options, error))
    return NULL;
  before = g_new0 (gdouble, EACH * (gsize) r.n_cameras);
  for (guint turn = 0; turn < MOST_TURNS && !settled; turn++) {
    if (!gather (&r, error))
      return NULL;
    solve (&r);
    set_clocks (&r);
    if (!find_floor (&r, r.cameras, &r.floor, error))
      return NULL;
    settled = has_settled (&r, before);
  }
  if (!gather (&r, error))
    return NULL;
  result = refinement_new (&r, error);
  if (result)
    result->settled = settled;
  return g_steal_pointer (&result);
}

/* @refinement: (nullable) (transfer full): a refinement
 */
void
cloth_refinement_free (ClothRefinement * refinement)
{
  if (!refinement)
    return;
  cloth_rig_free (refinement->rig);
  g_free (refinement->cameras);
  g_free (refinement);
}
