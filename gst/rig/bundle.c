/* Least-squares refinement of cameras and board poses together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/bundle.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"
#include "gst/rig/rig.h"
#include "gst/rig/rotation.h"

#define N_OWN CLOTH_CAMERA_N_PARAMETERS
/* With the board's warp, which all cameras share. */
#define N_CAMERA (N_OWN + 2)
#define N_ALL (N_CAMERA + 6)

/* Bounds of the rational lens model's denominator, over the picture and a rim. */
#define MIN_DENOMINATOR 0.1
#define MAX_DENOMINATOR 10

/* Poses are eliminated first: with C the cameras' parameters and P those of poses,
 *   [ A   W ] [dC]   [g]
 *   [ W'  B ] [dP] = [h],  B block-diagonal (6×6 a pose),
 * so (A − W B⁻¹ W') dC = g − W B⁻¹ h. W has one block (20×6) a view; the board's warp counts
 * among the parameters of each camera. */
typedef struct
{
  const ClothBundle *bundle;
  guint n;                      /* free camera parameters */
  gint *map;                    /* N_CAMERA a camera: column, or -1 */
  guint *first, *order;         /* views by pose */
  gdouble *A, *g;
  gdouble *B, *h;
  gdouble *W;
  gdouble *S, *B_inverse;
  gdouble *dc, *dp;
} Normal;

static void
normal_init (Normal * s, const ClothBundle * b)
{
  guint *fill = g_new0 (guint, b->n_poses + 1);
  gint shared[8], warp[2] = { -1, -1 };

  memset (s, 0, sizeof *s);
  s->bundle = b;
  s->map = g_new (gint, b->n_cameras * N_CAMERA);
  for (guint j = 0; j < 8; j++)
    shared[j] = -1;
  for (guint c = 0; c < b->n_cameras; c++) {
    for (guint j = 0; j < N_CAMERA; j++) {
      gboolean lens = j >= 4 && j < 12;
      gint *column = &s->map[c * N_CAMERA + j];

      if (j >= N_OWN) {
        if (b->free_warp && warp[j - N_OWN] < 0)
          warp[j - N_OWN] = (gint) s->n++;
        *column = warp[j - N_OWN];
        continue;
      }
      if (!(b->free[c] & (1u << j)))
        *column = -1;
      else if (lens && b->share_lens && shared[j - 4] >= 0)
        *column = shared[j - 4];
      else
        *column = (gint) s->n++;
      if (lens && b->share_lens && *column >= 0)
        shared[j - 4] = *column;
    }
  }
  s->first = g_new0 (guint, b->n_poses + 1);
  s->order = g_new (guint, MAX (b->n_views, 1));
  for (guint v = 0; v < b->n_views; v++)
    s->first[b->views[v].pose + 1]++;
  for (guint p = 0; p < b->n_poses; p++)
    s->first[p + 1] += s->first[p];
  for (guint v = 0; v < b->n_views; v++) {
    guint p = b->views[v].pose;

    s->order[s->first[p] + fill[p]++] = v;
  }
  g_free (fill);
  s->A = g_new (gdouble, (gsize) s->n * s->n + 1);
  s->S = g_new (gdouble, (gsize) s->n * s->n + 1);
  s->g = g_new (gdouble, s->n + 1);
  s->dc = g_new (gdouble, s->n + 1);
  s->B = g_new (gdouble, (gsize) b->n_poses * 36 + 1);
  s->B_inverse = g_new (gdouble, (gsize) b->n_poses * 36 + 1);
  s->h = g_new (gdouble, (gsize) b->n_poses * 6 + 1);
  s->dp = g_new (gdouble, (gsize) b->n_poses * 6 + 1);
  s->W = g_new (gdouble, (gsize) b->n_views * N_CAMERA * 6 + 1);
}

static void
normal_clear (Normal * s)
{
  g_free (s->map);
  g_free (s->first);
  g_free (s->order);
  g_free (s->A);
  g_free (s->S);
  g_free (s->g);
  g_free (s->dc);
  g_free (s->B);
  g_free (s->B_inverse);
  g_free (s->h);
  g_free (s->dp);
  g_free (s->W);
}

/* Inverse of a point's covariance, with the variance e added. */
static void
information (const ClothBundleView * view, guint i, gdouble e, gdouble M[3])
{
  gdouble xx = e, xy = 0, yy = e, det;

  if (view->cov) {
    xx += view->cov[3 * i];
    xy = view->cov[3 * i + 1];
    yy += view->cov[3 * i + 2];
  }
  det = xx * yy - xy * xy;
  M[0] = yy / det;
  M[1] = -xy / det;
  M[2] = xx / det;
}

/* One point: residual (seen − predicted), and with J its derivative of the prediction:
 * row-major 2×N_ALL, columns of the camera (rotation: a small one about the camera's axes,
 * on the left), of the warp, then of the pose (rotation on the left, translation). */
static gboolean
point (const ClothBundle * b, const ClothBundleView * view, guint i,
    gdouble e[2], gdouble * J)
{
  ClothCamera camera = b->cameras[view->camera];
  const gdouble *P = b->poses + 12 * (gsize) view->pose;
  const gdouble *vertex = b->board + 3 * (gsize) view->vertex[i];
  const gdouble *bulge = b->bulge ? b->bulge + 2 * (gsize) view->vertex[i]
      : NULL;
  gdouble X[3] = { vertex[0], vertex[1], vertex[2] };
  const gdouble *R = b->cameras[view->camera].R;
  const gdouble *t = b->cameras[view->camera].t;
  static const gdouble identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  gdouble PX[3], Y[3], RY[3], Z[3], px[2], a[6], d[2 * N_OWN];

  if (bulge)
    X[2] += bulge[0] * b->warp[0] + bulge[1] * b->warp[1];
  cloth_mat3_vec (P, X, PX);
  for (gint j = 0; j < 3; j++)
    Y[j] = PX[j] + P[9 + j];
  cloth_mat3_vec (R, Y, RY);
  for (gint j = 0; j < 3; j++)
    Z[j] = RY[j] + t[j];
  memcpy (camera.R, identity, sizeof identity);
  memset (camera.t, 0, sizeof camera.t);
  if (!cloth_camera_project (&camera, Z, px, J ? a : NULL, J ? d : NULL))
    return FALSE;
  e[0] = view->x[i] - px[0];
  e[1] = view->y[i] - px[1];
  if (!isfinite (e[0]) || !isfinite (e[1]))
    return FALSE;
  for (gint r = 0; J && r < 2; r++) {
    gdouble *row = J + r * N_ALL, aR[3];
    const gdouble *ar = a + 3 * r;

    memcpy (row, d + r * N_OWN, 12 * sizeof (gdouble));
    for (gint j = 0; j < 3; j++) {
      gint k = (j + 1) % 3, l = (j + 2) % 3;

      /* a · (w × v) = w · (v × a) */
      row[12 + j] = RY[k] * ar[l] - RY[l] * ar[k];
      row[15 + j] = ar[j];
    }
    cloth_mat3_vec_t (R, ar, aR);
    for (gint j = 0; j < 3; j++) {
      gint k = (j + 1) % 3, l = (j + 2) % 3;

      row[N_CAMERA + j] = PX[k] * aR[l] - PX[l] * aR[k];
      row[N_CAMERA + 3 + j] = aR[j];
    }
    for (gint j = 0; j < 2; j++)
      row[N_OWN + j] = bulge
          ? bulge[j] * (aR[0] * P[2] + aR[1] * P[5] + aR[2] * P[8]) : 0;
  }
  return TRUE;
}

/* Huber's cost of a distance in standard deviations, doubled so that it is d² inside. */
static gdouble
huber_cost (gdouble d2, gdouble limit, gdouble * weight)
{
  gdouble d = sqrt (d2);

  if (d <= limit) {
    *weight = 1;
    return d2;
  }
  *weight = limit / d;
  return limit * (2 * d - limit);
}

/* The cost, or infinity when a point isn't in front of its camera. With s the normal
 * equations too. */
static gdouble
build (const ClothBundle * b, Normal * s)
{
  gdouble cost = 0;

  if (s) {
    memset (s->A, 0, (gsize) s->n * s->n * sizeof (gdouble));
    memset (s->g, 0, s->n * sizeof (gdouble));
    memset (s->B, 0, (gsize) b->n_poses * 36 * sizeof (gdouble));
    memset (s->h, 0, (gsize) b->n_poses * 6 * sizeof (gdouble));
    memset (s->W, 0, (gsize) b->n_views * N_CAMERA * 6 * sizeof (gdouble));
  }
  for (guint v = 0; v < b->n_views; v++) {
    const ClothBundleView *view = &b->views[v];
    gdouble H[N_ALL][N_ALL], f[N_ALL], excess = b->excess[view->camera];
    guint active[N_ALL], n_active = 0;
    const gint *map;

    if (!view->use)
      continue;
    if (s) {
      memset (H, 0, sizeof H);
      memset (f, 0, sizeof f);
      map = s->map + view->camera * N_CAMERA;
      for (guint j = 0; j < N_ALL; j++) {
        if (j >= N_CAMERA || map[j] >= 0)
          active[n_active++] = j;
      }
    }
    for (guint i = 0; i < view->n; i++) {
      gdouble e[2], M[3], J[2 * N_ALL], Me[2], w;

      if (!point (b, view, i, e, s ? J : NULL))
        return HUGE_VAL;
      information (view, i, excess * excess, M);
      Me[0] = M[0] * e[0] + M[1] * e[1];
      Me[1] = M[1] * e[0] + M[2] * e[1];
      cost += huber_cost (e[0] * Me[0] + e[1] * Me[1], b->huber, &w);
      if (!s)
        continue;
      for (guint a = 0; a < n_active; a++) {
        guint j = active[a];
        gdouble p = w * (M[0] * J[j] + M[1] * J[N_ALL + j]);
        gdouble q = w * (M[1] * J[j] + M[2] * J[N_ALL + j]);

        f[j] += p * e[0] + q * e[1];
        for (guint c = 0; c <= a; c++)
          H[j][active[c]] += p * J[active[c]] + q * J[N_ALL + active[c]];
      }
    }
    if (!s)
      continue;
    map = s->map + view->camera * N_CAMERA;
    for (guint j = 0; j < N_CAMERA; j++) {
      if (map[j] < 0)
        continue;
      s->g[map[j]] += f[j];
      for (guint k = 0; k <= j; k++) {
        if (map[k] < 0)
          continue;
        s->A[(gsize) map[j] * s->n + map[k]] += H[j][k];
        if (map[j] != map[k])
          s->A[(gsize) map[k] * s->n + map[j]] += H[j][k];
      }
      for (guint k = 0; k < 6; k++)
        s->W[((gsize) v * N_CAMERA + j) * 6 + k] = H[N_CAMERA + k][j];
    }
    for (guint j = 0; j < 6; j++) {
      s->h[6 * (gsize) view->pose + j] += f[N_CAMERA + j];
      for (guint k = 0; k < 6; k++)
        s->B[36 * (gsize) view->pose + 6 * j + k] +=
            H[N_CAMERA + MAX (j, k)][N_CAMERA + MIN (j, k)];
    }
  }
  return cost;
}

/* Whether any view in use shows the pose. */
static gboolean
pose_used (const Normal * s, guint p)
{
  for (guint i = s->first[p]; i < s->first[p + 1]; i++) {
    if (s->bundle->views[s->order[i]].use)
      return TRUE;
  }
  return FALSE;
}

/* S = A − W B⁻¹ W', dc = g − W B⁻¹ h, both damped by @lambda times the diagonal. */
static gboolean
eliminate (Normal * s, gdouble lambda)
{
  const ClothBundle *b = s->bundle;
  guint n = s->n;

  memcpy (s->S, s->A, (gsize) n * n * sizeof (gdouble));
  memcpy (s->dc, s->g, n * sizeof (gdouble));
  for (guint i = 0; i < n; i++)
    s->S[(gsize) i * n + i] *= 1 + lambda;
  for (guint p = 0; p < b->n_poses; p++) {
    gdouble L[36], *inverse = s->B_inverse + 36 * (gsize) p;

    if (!pose_used (s, p))
      continue;
    memcpy (L, s->B + 36 * (gsize) p, sizeof L);
    for (guint i = 0; i < 6; i++)
      L[7 * i] *= 1 + lambda;
    if (!cloth_cholesky_factor (6, L))
      return FALSE;
    cloth_cholesky_inverse (6, L, inverse);
    for (guint i = s->first[p]; i < s->first[p + 1]; i++) {
      guint v = s->order[i];
      const gint *map = s->map + b->views[v].camera * N_CAMERA;
      gdouble WB[N_CAMERA][6];

      if (!b->views[v].use)
        continue;
      for (guint j = 0; j < N_CAMERA; j++) {
        const gdouble *w = s->W + ((gsize) v * N_CAMERA + j) * 6;

        if (map[j] < 0)
          continue;
        for (guint k = 0; k < 6; k++) {
          WB[j][k] = 0;
          for (guint l = 0; l < 6; l++)
            WB[j][k] += w[l] * inverse[6 * l + k];
          s->dc[map[j]] -= WB[j][k] * s->h[6 * (gsize) p + k];
        }
      }
      for (guint o = s->first[p]; o < s->first[p + 1]; o++) {
        guint u = s->order[o];
        const gint *other = s->map + b->views[u].camera * N_CAMERA;

        if (!b->views[u].use)
          continue;
        for (guint j = 0; j < N_CAMERA; j++) {
          for (guint k = 0; map[j] >= 0 && k < N_CAMERA; k++) {
            const gdouble *w = s->W + ((gsize) u * N_CAMERA + k) * 6;
            gdouble sum = 0;

            if (other[k] < 0)
              continue;
            for (guint l = 0; l < 6; l++)
              sum += WB[j][l] * w[l];
            s->S[(gsize) map[j] * n + other[k]] -= sum;
          }
        }
      }
    }
  }
  return TRUE;
}

/* The same with S factored. */
static gboolean
reduce (Normal * s, gdouble lambda)
{
  return eliminate (s, lambda)
      && (s->n == 0 || cloth_cholesky_factor (s->n, s->S));
}

static void
back_substitute (Normal * s)
{
  const ClothBundle *b = s->bundle;

  if (s->n > 0)
    cloth_cholesky_solve (s->n, s->S, s->dc);
  for (guint p = 0; p < b->n_poses; p++) {
    gdouble rest[6];

    if (!pose_used (s, p)) {
      memset (s->dp + 6 * (gsize) p, 0, 6 * sizeof (gdouble));
      continue;
    }
    memcpy (rest, s->h + 6 * (gsize) p, sizeof rest);
    for (guint i = s->first[p]; i < s->first[p + 1]; i++) {
      guint v = s->order[i];
      const gint *map = s->map + b->views[v].camera * N_CAMERA;

      if (!b->views[v].use)
        continue;
      for (guint j = 0; j < N_CAMERA; j++) {
        for (guint k = 0; map[j] >= 0 && k < 6; k++)
          rest[k] -= s->W[((gsize) v * N_CAMERA + j) * 6 + k] * s->dc[map[j]];
      }
    }
    for (guint j = 0; j < 6; j++) {
      gdouble sum = 0;

      for (guint k = 0; k < 6; k++)
        sum += s->B_inverse[36 * (gsize) p + 6 * j + k] * rest[k];
      s->dp[6 * (gsize) p + j] = sum;
    }
  }
}

static void
turn (gdouble R[9], const gdouble w[3])
{
  gdouble D[9], M[9];

  cloth_rotation_from_vector (w, D);
  cloth_mat3_mul (D, R, M);
  /* Rounding would add up over many steps. */
  if (!cloth_mat3_nearest_rotation (M, R))
    memcpy (R, M, sizeof M);
}

static void
apply (ClothBundle * b, const Normal * s)
{
  for (guint c = 0; c < b->n_cameras; c++) {
    static const guint k_index[4] = { 0, 4, 2, 5 };
    ClothCamera *camera = &b->cameras[c];
    gdouble d[N_CAMERA];

    for (guint j = 0; j < N_CAMERA; j++) {
      gint column = s->map[c * N_CAMERA + j];

      d[j] = column < 0 ? 0 : s->dc[column];
    }
    for (guint j = 0; j < 4; j++)
      camera->K[k_index[j]] += d[j];
    for (guint j = 0; j < 8; j++)
      camera->k[j] += d[4 + j];
    if (b->free[c] & CLOTH_BUNDLE_PLACE)
      turn (camera->R, d + 12);
    for (guint j = 0; j < 3; j++)
      camera->t[j] += d[15 + j];
  }
  for (guint j = 0; j < 2; j++)
    b->warp[j] += b->free_warp ? s->dc[s->map[N_OWN + j]] : 0;
  for (guint p = 0; p < b->n_poses; p++) {
    gdouble *P = b->poses + 12 * (gsize) p;

    if (!pose_used (s, p))
      continue;
    turn (P, s->dp + 6 * (gsize) p);
    for (guint j = 0; j < 3; j++)
      P[9 + j] += s->dp[6 * (gsize) p + 3 + j];
  }
}

/* A fit of the rational model to few corners would hide a pole between them, or a cusp at
 * the centre from numerator and denominator that are both huge. */
static gboolean
has_pole (const ClothCamera * camera)
{
  const gdouble *k = camera->k;
  gdouble x = fmax (camera->K[2], camera->width - camera->K[2]) / camera->K[0];
  gdouble y = fmax (camera->K[5], camera->height - camera->K[5]) / camera->K[4];

  for (gint i = 1; camera->lens == CLOTH_LENS_BROWN8 && i <= 64; i++) {
    gdouble r = 1.2 * i / 64, s = r * r * (x * x + y * y);

    gdouble d = 1 + s * (k[5] + s * (k[6] + s * k[7]));

    if (!(d > MIN_DENOMINATOR && d < MAX_DENOMINATOR))
      return TRUE;
  }
  return FALSE;
}

static gboolean
sane (const ClothBundle * b)
{
  for (guint c = 0; c < b->n_cameras; c++) {
    if (!(b->cameras[c].K[0] > 0) || !(b->cameras[c].K[4] > 0)
        || has_pole (&b->cameras[c]))
      return FALSE;
  }
  return TRUE;
}

/* @bundle: the problem, its cameras and poses replaced by the result
 * @cost: (out) (optional): the sum of Huber's costs, in squared standard deviations
 * @error: #GIOErrorEnum cancelled, or #ClothRigError when the start is impossible
 *
 * Levenberg and Marquardt's method on whitened reprojection errors with Huber's weights,
 * board poses eliminated by the Schur complement (Triggs et al., "Bundle adjustment, a
 * modern synthesis", 2000). The order of all sums is fixed: equal input gives equal bytes.
 *
 * Returns: whether a minimum, or the last iteration, was reached.
 */
gboolean
cloth_bundle_solve (ClothBundle * bundle, gdouble * cost, GError ** error)
{
  Normal s;
  g_autofree ClothCamera *cameras =
      g_memdup2 (bundle->cameras, bundle->n_cameras * sizeof (ClothCamera));
  g_autofree gdouble *poses = g_memdup2 (bundle->poses,
      12 * bundle->n_poses * sizeof (gdouble));
  gdouble lambda = 1e-4, now, warp[2] = { bundle->warp[0], bundle->warp[1] };
  gboolean ok = TRUE;
  guint settled = 0;

  normal_init (&s, bundle);
  now = build (bundle, &s);
  if (!isfinite (now)) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "a board lies behind its camera at the start of the fit");
    ok = FALSE;
  }
  for (guint i = 0; ok && i < bundle->max_iterations && settled < 2; i++) {
    gdouble next = HUGE_VAL;

    if (g_cancellable_set_error_if_cancelled (bundle->cancellable, error)) {
      ok = FALSE;
      break;
    }
    if (reduce (&s, lambda)) {
      back_substitute (&s);
      apply (bundle, &s);
      if (sane (bundle))
        next = build (bundle, NULL);
    }
    if (next <= now) {
      /* Twice no gain worth a digit of any parameter: there. */
      settled = now - next <= 1e-11 * now ? settled + 1 : 0;
      memcpy (cameras, bundle->cameras,
          bundle->n_cameras * sizeof (ClothCamera));
      memcpy (poses, bundle->poses, 12 * bundle->n_poses * sizeof (gdouble));
      memcpy (warp, bundle->warp, sizeof warp);
      lambda = fmax (lambda / 10, 1e-12);
      now = build (bundle, &s);
    } else {
      memcpy (bundle->cameras, cameras,
          bundle->n_cameras * sizeof (ClothCamera));
      memcpy (bundle->poses, poses, 12 * bundle->n_poses * sizeof (gdouble));
      memcpy (bundle->warp, warp, sizeof warp);
      lambda *= 10;
      if (lambda > 1e10)
        break;
    }
  }
  if (cost)
    *cost = now;
  normal_clear (&s);
  return ok;
}

struct _ClothBundleSpread
{
  Normal s;
  gdouble variance;
  gdouble *observed, *expected; /* n×n; NULL: too few views to leave one out */
};

/* How the cameras' parameters move when one pose is left out, summed over poses. One step
 * of Gauss and Newton from the minimum is
 *   δ_p = (S − S_p)⁻¹ (g − g_p),  S = Σ S_p, g = Σ g_p,
 * and independent corners of the variance 1 let Σ δ_p δ_p' be Σ (S − S_p)⁻¹ − S⁻¹ on
 * average. Poses not in use move nothing. */
static void
leave_each_out (ClothBundleSpread * spread)
{
  const ClothBundle *b = spread->s.bundle;
  guint n = spread->s.n;
  gsize n2 = (gsize) n * n;
  g_autofree ClothBundleView *views =
      g_memdup2 (b->views, b->n_views * sizeof (ClothBundleView));
  g_autofree gdouble *S = g_new (gdouble, n2 + 1);
  g_autofree gdouble *inverse = g_new (gdouble, n2 + 1);
  g_autofree gdouble *with_all = g_new (gdouble, n2 + 1);
  g_autofree gdouble *d = g_new (gdouble, n + 1), *g = g_new (gdouble, n + 1);
  g_autofree gdouble *observed = g_new0 (gdouble, n2 + 1);
  g_autofree gdouble *expected = g_new0 (gdouble, n2 + 1);
  ClothBundle one = *b;
  gboolean ok;
  Normal s;

  one.views = views;
  normal_init (&s, &one);
  build (&one, &s);
  ok = eliminate (&s, 0);
  memcpy (S, s.S, n2 * sizeof (gdouble));
  memcpy (g, s.dc, n * sizeof (gdouble));
  cloth_cholesky_inverse (n, spread->s.S, with_all);
  for (guint p = 0; ok && p < b->n_poses; p++) {
    if (!pose_used (&spread->s, p))
      continue;
    for (guint v = 0; v < b->n_views; v++)
      views[v].use = b->views[v].use && b->views[v].pose == p;
    build (&one, &s);
    ok = eliminate (&s, 0);
    for (gsize i = 0; i < n2; i++)
      s.S[i] = S[i] - s.S[i];
    for (guint i = 0; i < n; i++)
      d[i] = g[i] - s.dc[i];
    ok = ok && cloth_cholesky_factor (n, s.S);
    if (!ok)
      break;
    cloth_cholesky_solve (n, s.S, d);
    cloth_cholesky_inverse (n, s.S, inverse);
    for (guint i = 0; i < n; i++) {
      for (guint j = 0; j < n; j++)
        observed[(gsize) i * n + j] += d[i] * d[j];
    }
    for (gsize i = 0; i < n2; i++)
      expected[i] += inverse[i] - with_all[i];
  }
  normal_clear (&s);
  if (!ok)
    return;
  spread->observed = g_steal_pointer (&observed);
  spread->expected = g_steal_pointer (&expected);
}

/* @bundle: a problem at its minimum, kept unchanged while the result is in use
 * @error: #ClothRigError when the data leave a direction undetermined
 *
 * The information matrix of all parameters, factored, and the variance of the standardised
 * residuals, by which its inverse is scaled.
 *
 * Returns: (transfer full): how certain the parameters are, or %NULL.
 */
ClothBundleSpread *
cloth_bundle_spread_new (const ClothBundle * bundle, GError ** error)
{
  g_autoptr (ClothBundleSpread) spread = g_new0 (ClothBundleSpread, 1);
  Normal *s = &spread->s;
  gdouble sum = 0, dof;
  guint n_points = 0, n_poses = 0;

  normal_init (s, bundle);
  build (bundle, s);
  for (guint v = 0; v < bundle->n_views; v++) {
    const ClothBundleView *view = &bundle->views[v];
    gdouble excess = bundle->excess[view->camera];

    for (guint i = 0; view->use && i < view->n; i++) {
      gdouble e[2], M[3], d2, w;

      if (!point (bundle, view, i, e, NULL))
        continue;
      information (view, i, excess * excess, M);
      d2 = M[0] * e[0] * e[0] + 2 * M[1] * e[0] * e[1] + M[2] * e[1] * e[1];
      huber_cost (d2, bundle->huber, &w);
      sum += w * d2;
      n_points++;
    }
  }
  for (guint p = 0; p < bundle->n_poses; p++)
    n_poses += pose_used (s, p);
  dof = 2. * n_points - s->n - 6. * n_poses;
  spread->variance = dof > 0 ? sum / dof : NAN;
  if (!(dof > 0) || !reduce (s, 0)) {
    g_set_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE,
        "the views don't determine all parameters");
    return NULL;
  }
  if (s->n > 0)
    leave_each_out (spread);
  return g_steal_pointer (&spread);
}

/* @spread: (transfer full) (nullable): what cloth_bundle_spread_new() returned
 */
void
cloth_bundle_spread_free (ClothBundleSpread * spread)
{
  if (!spread)
    return;
  normal_clear (&spread->s);
  g_free (spread->observed);
  g_free (spread->expected);
  g_free (spread);
}

/* @spread: a problem's
 *
 * Returns: variance of the standardised residuals.
 */
gdouble
cloth_bundle_spread_variance (const ClothBundleSpread * spread)
{
  return spread->variance;
}

/* @spread: a problem's
 * @covariance: (out caller-allocates): 18×18 a camera, columns as in
 *   #CLOTH_CAMERA_N_PARAMETERS but for the rotation, which is a small one about the
 *   camera's own axes; zeros for what is not free
 *
 * Inverse of the information matrix, board poses marginalised, times the residual variance.
 */
void
cloth_bundle_spread_cameras (const ClothBundleSpread * spread,
    gdouble * covariance)
{
  const Normal *s = &spread->s;
  g_autofree gdouble *inverse = g_new (gdouble, (gsize) s->n * s->n + 1);

  cloth_cholesky_inverse (s->n, s->S, inverse);
  for (guint c = 0; c < s->bundle->n_cameras; c++) {
    const gint *map = s->map + c * N_CAMERA;

    for (guint i = 0; i < N_OWN; i++) {
      for (guint j = 0; j < N_OWN; j++)
        covariance[(c * N_OWN + i) * N_OWN + j] =
            map[i] < 0 || map[j] < 0 ? 0
            : spread->variance * inverse[(gsize) map[i] * s->n + map[j]];
    }
  }
}

/* @spread: a problem's
 * @sd: (out): standard deviations of the board's warp, m; 0 when that is not free
 */
void
cloth_bundle_spread_warp (const ClothBundleSpread * spread, gdouble sd[2])
{
  const Normal *s = &spread->s;

  for (guint j = 0; j < 2; j++) {
    g_autofree gdouble *unit = g_new0 (gdouble, s->n + 1);
    gint column = s->map[N_OWN + j];

    sd[j] = 0;
    if (column < 0)
      continue;
    unit[column] = 1;
    cloth_cholesky_solve (s->n, s->S, unit);
    sd[j] = sqrt (spread->variance * unit[column]);
  }
}

/* Both rows of the derivative of where a camera sees a point that moves with the mean of
 * the boards it saw, poses eliminated: r = g_C − W B⁻¹ g_P, and what the poses leave over,
 * g_P' B⁻¹ g_P. */
static void
reduce_gradient (const Normal * s, guint camera, const gdouble * X,
    gboolean at_infinity, const gdouble * own, const gdouble aR[2][3],
    gdouble * r, gdouble rest[3])
{
  const ClothBundle *b = s->bundle;
  const gint *map = s->map + camera * N_CAMERA;
  guint n_seen = 0;

  memset (r, 0, 2 * (gsize) s->n * sizeof (gdouble));
  memset (rest, 0, 3 * sizeof (gdouble));
  for (guint i = 0; i < 2; i++) {
    for (guint j = 0; j < N_OWN; j++) {
      if (map[j] >= 0)
        r[i * s->n + map[j]] += own[i * N_OWN + j];
    }
  }
  for (guint v = 0; v < b->n_views; v++)
    n_seen += b->views[v].use && b->views[v].camera == camera;
  for (guint v = 0; v < b->n_views; v++) {
    guint p = b->views[v].pose;
    const gdouble *t = b->poses + 12 * (gsize) p + 9;
    const gdouble *inverse = s->B_inverse + 36 * (gsize) p;
    gdouble g[2][6], Bg[2][6] = { {0,}, };

    if (!b->views[v].use || b->views[v].camera != camera)
      continue;
    for (guint i = 0; i < 2; i++) {
      gdouble arm[3];

      for (guint j = 0; j < 3; j++)
        arm[j] = at_infinity ? X[j] : X[j] - t[j];
      cloth_vec3_cross (arm, aR[i], g[i]);
      for (guint j = 0; j < 3; j++) {
        g[i][j] /= n_seen;
        g[i][3 + j] = at_infinity ? 0 : aR[i][j] / n_seen;
      }
      for (guint j = 0; j < 6; j++) {
        for (guint k = 0; k < 6; k++)
          Bg[i][j] += inverse[6 * j + k] * g[i][k];
      }
    }
    for (guint j = 0; j < 6; j++) {
      rest[0] += g[0][j] * Bg[0][j];
      rest[1] += g[0][j] * Bg[1][j];
      rest[2] += g[1][j] * Bg[1][j];
    }
    for (guint o = s->first[p]; o < s->first[p + 1]; o++) {
      guint u = s->order[o];
      const gint *other = s->map + b->views[u].camera * N_CAMERA;

      for (guint j = 0; b->views[u].use && j < N_CAMERA; j++) {
        const gdouble *w = s->W + ((gsize) u * N_CAMERA + j) * 6;

        for (guint k = 0; other[j] >= 0 && k < 6; k++) {
          r[other[j]] -= w[k] * Bg[0][k];
          r[s->n + other[j]] -= w[k] * Bg[1][k];
        }
      }
    }
  }
}

/* Σ over both rows of r' M r. */
static gdouble
quadratic (guint n, const gdouble * M, const gdouble * r)
{
  gdouble sum = 0;

  for (guint i = 0; i < n; i++) {
    for (guint j = 0; j < n; j++)
      sum += M[(gsize) i * n + j] * (r[i] * r[j] + r[n + i] * r[n + j]);
  }
  return sum;
}

/* @spread: a problem's
 * @camera: which camera
 * @Z: a point in the camera's frame, m; at infinity only its direction counts
 * @at_infinity: whether the point is infinitely far
 * @cov: (out): covariance xx, xy, yy of where the camera sees it, px²
 * @disagreement: (out): its variance when poses are left out one by one, over that which
 *   independent errors of the corners would give: greater than 1 where those of a view are
 *   not, as on a bent board; NaN when there are too few views to leave one out
 *
 * How certain a projection is. Errors of lens, camera and board poses compensate each
 * other, so where a point appears has a meaning only beside what was seen: the point is
 * held fixed to each board pose this camera saw, and is where the mean of them says
 * (“mean-pcam” of mrcal.secretsauce.net/uncertainty.html, there over all poses).
 *
 * Returns: %FALSE when the point is not in front of the camera.
 */
gboolean
cloth_bundle_spread_project (const ClothBundleSpread * spread, guint camera,
    const gdouble Z[3], gboolean at_infinity, gdouble cov[3],
    gdouble * disagreement)
{
  const Normal *s = &spread->s;
  static const gdouble identity[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  ClothCamera own = s->bundle->cameras[camera];
  gdouble R[9], t[3], X[3], d[3], px[2], a[6], J[2 * N_OWN], aR[2][3];
  g_autofree gdouble *r = g_new (gdouble, 2 * (gsize) s->n + 1);
  g_autofree gdouble *solved = NULL;

  memcpy (R, own.R, sizeof R);
  memcpy (t, own.t, sizeof t);
  memcpy (own.R, identity, sizeof identity);
  memset (own.t, 0, sizeof own.t);
  if (!cloth_camera_project (&own, Z, px, a, J))
    return FALSE;
  for (guint j = 0; j < 3; j++)
    d[j] = at_infinity ? Z[j] : Z[j] - t[j];
  cloth_mat3_vec_t (R, d, X);
  for (guint i = 0; i < 2; i++) {
    cloth_vec3_cross (d, a + 3 * i, J + i * N_OWN + 12);
    for (guint j = 0; j < 3; j++)
      J[i * N_OWN + 15 + j] = at_infinity ? 0 : a[3 * i + j];
    cloth_mat3_vec_t (R, a + 3 * i, aR[i]);
  }
  reduce_gradient (s, camera, X, at_infinity, J, aR, r, cov);
  *disagreement = spread->observed ? quadratic (s->n, spread->observed, r)
      / (spread->variance * quadratic (s->n, spread->expected, r)) : NAN;
  solved = g_memdup2 (r, 2 * (gsize) s->n * sizeof (gdouble));
  for (guint i = 0; s->n > 0 && i < 2; i++)
    cloth_cholesky_solve (s->n, s->S, solved + i * s->n);
  for (guint j = 0; j < s->n; j++) {
    cov[0] += r[j] * solved[j];
    cov[1] += r[j] * solved[s->n + j];
    cov[2] += r[s->n + j] * solved[s->n + j];
  }
  for (guint i = 0; i < 3; i++)
    cov[i] *= spread->variance;
  return TRUE;
}

/* @bundle: a problem
 * @view: which view
 * @dx: (out caller-allocates): seen minus predicted, px, a number a point; NaN where the
 *   point is not in front of the camera
 * @dy: (out caller-allocates): likewise
 * @distance: (out caller-allocates) (nullable): the same in standard deviations
 */
void
cloth_bundle_residuals (const ClothBundle * bundle, guint view, gdouble * dx,
    gdouble * dy, gdouble * distance)
{
  const ClothBundleView *v = &bundle->views[view];
  gdouble excess = bundle->excess[v->camera];

  for (guint i = 0; i < v->n; i++) {
    gdouble e[2], M[3];

    if (!point (bundle, v, i, e, NULL))
      e[0] = e[1] = NAN;
    dx[i] = e[0];
    dy[i] = e[1];
    if (distance) {
      information (v, i, excess * excess, M);
      distance[i] = sqrt (M[0] * e[0] * e[0] + 2 * M[1] * e[0] * e[1]
          + M[2] * e[1] * e[1]);
    }
  }
}

/* The median of a squared distance in two dimensions that has unit variances. */
#define MEDIAN_D2 (2 * G_LN2)

/* @bundle: a problem at, or near, its minimum
 * @camera: a camera
 *
 * What the residuals scatter beyond the covariances of the corners: a board that is not
 * flat, a lens that the model does not follow. The standard deviation that, added to all
 * covariances, brings the median standardised distance to that of a Gaussian; at least
 * 0.0001 px. Outliers don't move it.
 *
 * Returns: the standard deviation, px.
 */
gdouble
cloth_bundle_excess (const ClothBundle * bundle, guint camera)
{
  g_autoptr (GArray) points = g_array_new (FALSE, FALSE, 4 * sizeof (gdouble));
  gdouble low = 1e-4, high = 1e-4;

  for (guint v = 0; v < bundle->n_views; v++) {
    const ClothBundleView *view = &bundle->views[v];

    if (!view->use || view->camera != camera)
      continue;
    for (guint i = 0; i < view->n; i++) {
      gdouble e[2];

      if (point (bundle, view, i, e, NULL)) {
        gdouble entry[4] = { e[0], e[1], v, i };

        g_array_append_vals (points, entry, 1);
        high = fmax (high, fabs (e[0]) + fabs (e[1]));
      }
    }
  }
  if (points->len == 0)
    return low;
  for (gint step = -1; step < 40; step++) {
    gdouble middle = step < 0 ? low : 0.5 * (low + high);
    guint n_above = 0;

    for (guint i = 0; i < points->len; i++) {
      const gdouble *p = (const gdouble *) points->data + 4 * i;
      gdouble M[3];

      information (&bundle->views[(guint) p[2]], (guint) p[3],
          middle * middle, M);
      n_above += M[0] * p[0] * p[0] + 2 * M[1] * p[0] * p[1]
          + M[2] * p[1] * p[1] > MEDIAN_D2;
    }
    if (2 * n_above > points->len)
      low = middle;
    else if (step < 0)
      return low;
    else
      high = middle;
  }
  return 0.5 * (low + high);
}
