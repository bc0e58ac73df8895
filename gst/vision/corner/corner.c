/* The exact place of a corner where two straight edges cross.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/corner.h"

#include <math.h>
#include <string.h>

#include "gst/vision/corner/corner-model.h"

#define SECTORS 24
#define MAX_EVALUATIONS 16
/* Sharper edges look the same, px. */
#define MIN_BLUR 0.25f

/* Returns: parameters for squares of 12 px and more.
 */
ClothCornerParams
cloth_corner_default_params (void)
{
  /* *INDENT-OFF* */
  return (ClothCornerParams) {
    .radius = 5.0f,
    .max_shift = 2.0f,
    .blur = 0.8f,
  };
  /* *INDENT-ON* */
}

/* Takes the pixels of a disc around (x, y); its weight falls to 0 at its rim, so that
 * what lies beyond enters gently. Offsets are from the pixel (ix, iy). */
static gboolean
take_window (ClothCornerWindow * win, const ClothImage * image, gfloat x,
    gfloat y, gint ix, gint iy, gfloat radius, gboolean linear, gfloat * mean)
{
  const gfloat rim = radius + 0.5f, shape = 1.0f / (rim * rim);
  const gint reach = (gint) ceilf (rim);
  const gfloat fx = x - (gfloat) ix, fy = y - (gfloat) iy;
  gfloat *px = (gfloat *) win->x, *py = (gfloat *) win->y;
  gfloat *value = (gfloat *) win->value, *weight = (gfloat *) win->weight;
  gfloat sum = 0, sum_weight = 0;
  gint n = 0, n_padded;

  for (gint j = MAX (-reach, -iy); j <= MIN (reach, image->height - 1 - iy);
      j++) {
    const guint8 *row =
        image->data + (gsize) (iy + j) * (gsize) image->stride + ix;
    gfloat dy = (gfloat) j - fy, left = rim * rim - dy * dy;
    gint i0, i1;

    if (left <= 0)
      continue;
    left = sqrtf (left);
    i0 = MAX ((gint) ceilf (fx - left), -ix);
    i1 = MIN ((gint) floorf (fx + left), image->width - 1 - ix);
    for (gint i = i0; i <= i1; i++) {
      gfloat dx = (gfloat) i - fx;
      gfloat w = MAX (1.0f - (dx * dx + dy * dy) * shape, 0.0f);
      px[n] = (gfloat) i;
      py[n] = (gfloat) j;
      value[n] = row[i];
      weight[n] = w;
      sum += w * value[n];
      sum_weight += w;
      n++;
    }
  }
  /* Nine parameters and something left over to tell the noise from. */
  if (n < 14)
    return FALSE;
  *mean = sum / sum_weight;
  if (linear) {
    /* Scaled such that contrast stays what it is in grey levels, about. */
    gfloat scale = 0.5f / MAX (*mean, 1.0f);

    sum = 0;
    for (gint i = 0; i < n; i++) {
      value[i] *= scale * value[i];
      sum += weight[i] * value[i];
    }
    *mean = sum / sum_weight;
  }
  for (gint i = 0; i < n; i++)
    value[i] -= *mean;
  n_padded = (n + CLOTH_CORNER_LANES - 1) / CLOTH_CORNER_LANES *
      CLOTH_CORNER_LANES;
  for (gint i = n; i < n_padded; i++)
    px[i] = py[i] = value[i] = weight[i] = 0;
  win->n_vectors = n_padded / CLOTH_CORNER_LANES;
  return TRUE;
}

/* Both directions whose four sectors explain most of the grey levels around (x, y). */
static gboolean
find_angles (const ClothCornerWindow * win, gfloat x, gfloat y, gfloat radius,
    gfloat * theta)
{
  const gfloat *px = (const gfloat *) win->x, *py = (const gfloat *) win->y;
  const gfloat *value = (const gfloat *) win->value;
  const gfloat *weight = (const gfloat *) win->weight;
  gfloat sum[2 * SECTORS + 1] = { 0 }, mass[2 * SECTORS + 1] = { 0 };
  gfloat best = 0;
  gint best_a = -1, best_b = -1;
  const gfloat inner = MIN (0.16f * radius * radius, 4.0f);

  for (gint i = 0; i < win->n_vectors * CLOTH_CORNER_LANES; i++) {
    gfloat dx = px[i] - x, dy = py[i] - y, turn;
    gint sector;

    if (weight[i] <= 0 || dx * dx + dy * dy < inner)
      continue;
    /* A diamond in place of a circle: one division, no arc tangent. */
    turn = dy / (fabsf (dx) + fabsf (dy));
    turn = dx < 0 ? 2 - turn : dy < 0 ? 4 + turn : turn;
    sector = MIN ((gint) (turn * (SECTORS / 4)), SECTORS - 1);
    sum[sector + 1] += value[i];
    mass[sector + 1] += 1;
  }
  for (gint i = 1; i <= SECTORS; i++) {
    sum[SECTORS + i] = sum[i];
    mass[SECTORS + i] = mass[i];
  }
  for (gint i = 1; i <= 2 * SECTORS; i++) {
    sum[i] += sum[i - 1];
    mass[i] += mass[i - 1];
  }
  for (gint a = 0; a < SECTORS / 2; a++) {
    for (gint b = a + 2; b < SECTORS / 2 && b <= a + SECTORS / 2 - 2; b++) {
      const gint cut[5] = { a, b, a + SECTORS / 2, b + SECTORS / 2,
        a + SECTORS
      };
      gfloat explained = 0;

      for (gint q = 0; q < 4; q++) {
        gfloat m = mass[cut[q + 1]] - mass[cut[q]];
        gfloat s = sum[cut[q + 1]] - sum[cut[q]];
        if (m > 0)
          explained += s * s / m;
      }
      if (explained > best) {
        best = explained;
        best_a = a;
        best_b = b;
      }
    }
  }
  if (best_a < 0)
    return FALSE;
  for (gint i = 0; i < 2; i++) {
    gfloat turn = (gfloat) (i ? best_b : best_a) / (SECTORS / 4);
    gfloat dx = 1 - turn, dy = turn > 1 ? 2 - turn : turn;
    theta[i] = atan2f (dy, dx);
  }
  return TRUE;
}

/* Cholesky's factor of the upper triangle given by rows, in place; its diagonal is left
 * inverted. */
static gboolean
factor (gdouble * a, gint n)
{
  for (gint i = 0; i < n; i++) {
    for (gint j = i; j < n; j++) {
      gdouble s = a[i * n + j];
      for (gint k = 0; k < i; k++)
        s -= a[k * n + i] * a[k * n + j];
      if (i == j) {
        if (!(s > 0))
          return FALSE;
        a[i * n + i] = 1 / sqrt (s);
      } else {
        a[i * n + j] = s * a[i * n + i];
      }
    }
  }
  return TRUE;
}

static void
solve (const gdouble * u, gint n, gdouble * b)
{
  for (gint i = 0; i < n; i++) {
    for (gint k = 0; k < i; k++)
      b[i] -= u[k * n + i] * b[k];
    b[i] *= u[i * n + i];
  }
  for (gint i = n - 1; i >= 0; i--) {
    for (gint k = i + 1; k < n; k++)
      b[i] -= u[i * n + k] * b[k];
    b[i] *= u[i * n + i];
  }
}

static void
unpack (const gfloat * packed, gdouble damping, gdouble * a)
{
  gint m = 0;

  for (gint i = 0; i < CLOTH_CORNER_N; i++) {
    for (gint j = i; j < CLOTH_CORNER_N; j++)
      a[i * CLOTH_CORNER_N + j] = packed[m++];
    a[i * CLOTH_CORNER_N + i] *= 1 + (i < 5 ? damping : 1e-9);
  }
}

/* The best c0 to c3 for the edges as they are. */
static gboolean
solve_levels (const gfloat * s, gfloat * c)
{
  const gdouble ridge = 1e-4 * s[0];
  gdouble a[16] = {
    s[0], s[1], s[2], s[3],
    0, s[4] + ridge, s[5], s[6],
    0, 0, s[7] + ridge, s[8],
    0, 0, 0, s[9] + ridge
  };
  gdouble b[4] = { s[10], s[11], s[12], s[13] };

  if (!factor (a, 4))
    return FALSE;
  solve (a, 4, b);
  for (gint i = 0; i < 4; i++)
    c[i] = (gfloat) b[i];
  return TRUE;
}

/* From the places of both edges to the place of their crossing:
 * n_i · (dx, dy) = sqrt(2)·blur·delta_i with n_i = (−sin, cos). */
static gboolean
crossing (const ClothCornerState * st, gdouble m[4])
{
  gdouble k = 1.4142135623730951 * st->blur;
  gdouble det = sin ((gdouble) st->theta2 - st->theta1);

  if (fabs (det) < 0.1)
    return FALSE;
  m[0] = k * cos (st->theta2) / det;
  m[1] = -k * cos (st->theta1) / det;
  m[2] = k * sin (st->theta2) / det;
  m[3] = -k * sin (st->theta1) / det;
  return TRUE;
}

typedef struct
{
  ClothCornerState state;
  gfloat c[4];
  gfloat normal[CLOTH_CORNER_N_SUMS];
  gfloat gradient[5];
  gfloat cost;
} Evaluation;

static gboolean
evaluate (ClothCornerWindow * win, Evaluation * e,
    const ClothCornerModel * model)
{
  gfloat sums[CLOTH_CORNER_N_BASIS];

  model->basis (win, &e->state, sums);
  if (!solve_levels (sums, e->c))
    return FALSE;
  model->normal (win, &e->state, e->c, sums, e->normal, e->gradient, &e->cost);
  return isfinite (e->cost);
}

/* Levenberg's step; @held: what the blur does, if that is settled. */
static gboolean
solve_step (const Evaluation * from, gdouble damping, const gdouble * held,
    gdouble b[CLOTH_CORNER_N])
{
  gdouble a[CLOTH_CORNER_N * CLOTH_CORNER_N];

  unpack (from->normal, damping, a);
  for (gint i = 0; i < CLOTH_CORNER_N; i++)
    b[i] = i < 5 ? from->gradient[i] : 0;
  for (gint i = 0; held && i < CLOTH_CORNER_N; i++) {
    gdouble *other = i < 4 ? &a[i * CLOTH_CORNER_N + 4]
        : &a[4 * CLOTH_CORNER_N + i];

    b[i] = i == 4 ? *held : b[i] - *other * *held;
    *other = i == 4;
  }
  if (!factor (a, CLOTH_CORNER_N))
    return FALSE;
  solve (a, CLOTH_CORNER_N, b);
  return TRUE;
}

static gboolean
step (const Evaluation * from, gdouble damping, gfloat radius,
    ClothCornerState * to, gdouble * moved)
{
  gdouble b[CLOTH_CORNER_N], m[4], dx, dy, length;
  gdouble sharper = MAX (-0.4 * from->state.blur, MIN_BLUR - from->state.blur);

  if (!crossing (&from->state, m) || !solve_step (from, damping, NULL, b))
    return FALSE;
  /* Where the blur is at its bound the others go the way that is left to them. */
  if (b[4] < sharper && !solve_step (from, damping, &sharper, b))
    return FALSE;
  dx = m[0] * b[0] + m[1] * b[1];
  dy = m[2] * b[0] + m[3] * b[1];
  length = sqrt (dx * dx + dy * dy);
  if (length > 1) {
    dx /= length;
    dy /= length;
  }
  b[2] = CLAMP (b[2], -0.3, 0.3);
  b[3] = CLAMP (b[3], -0.3, 0.3);
  b[4] = MIN (b[4], 0.6 * from->state.blur);
  *moved = length + (fabs (b[2]) + fabs (b[3])) * 0.1 + fabs (b[4]) * 0.2;
  *to = from->state;
  to->x += (gfloat) dx;
  to->y += (gfloat) dy;
  to->theta1 += (gfloat) b[2];
  to->theta2 += (gfloat) b[3];
  to->blur = CLAMP (to->blur + (gfloat) b[4], MIN_BLUR, 0.5f * radius);
  return isfinite (*moved);
}

/* Each pixel's own residual stands for its noise (White 1980), since that of edges is
 * often larger than that of areas. */
static gboolean
covariance (const ClothCornerWindow * win, const Evaluation * e,
    ClothCornerFit * fit, const ClothCornerModel * model)
{
  gdouble a[CLOTH_CORNER_N * CLOTH_CORNER_N], m[4], sum = 0, square = 0, left;
  gfloat root[CLOTH_CORNER_N * CLOTH_CORNER_N], row[2 * CLOTH_CORNER_N];

  for (gint i = 0; i < win->n_vectors * CLOTH_CORNER_LANES; i++) {
    gdouble w = ((const gfloat *) win->weight)[i];
    sum += w;
    square += w * w;
  }
  /* The fit has eaten part of the residual. */
  left = sum - CLOTH_CORNER_N * square / sum;
  if (!(left > 0))
    return FALSE;
  fit->rms = (gfloat) sqrt (e->cost / left);

  unpack (e->normal, 0, a);
  if (!crossing (&e->state, m) || !factor (a, CLOTH_CORNER_N))
    return FALSE;
  for (gint i = 0; i < 2; i++) {
    gdouble b[CLOTH_CORNER_N] = { m[2 * i], m[2 * i + 1] };
    solve (a, CLOTH_CORNER_N, b);
    for (gint k = 0; k < CLOTH_CORNER_N; k++)
      row[i * CLOTH_CORNER_N + k] = (gfloat) b[k];
  }
  for (gint i = 0; i < CLOTH_CORNER_N * CLOTH_CORNER_N; i++)
    root[i] = i % CLOTH_CORNER_N >= i / CLOTH_CORNER_N ? (gfloat) a[i] : 0;
  model->influence (win, &e->state, e->c, root, row, fit->cov);
  return isfinite (fit->cov[0] + fit->cov[1] + fit->cov[2]) &&
      fit->cov[0] > 0 && fit->cov[2] > 0;
}

/* @image: the picture
 * @x: where to start, px
 * @y: where to start, px
 * @params: the window and the start
 * @level: the highest instruction set to use; every one gives the same bytes
 * @fit: (out): the corner
 *
 * Fits, by least squares over a disc, two straight edges with a common Gaussian blur and
 * a grey level for each of the four quadrants they make: the inner corner of a
 * checkerboard, the outer corner of a square, and what lies between. Variable projection
 * (Golub & Pereyra 1973) with Levenberg's damping. The covariance is that of independent
 * noise of which each pixel's residual is a sample.
 *
 * Returns: FALSE when the fit doesn't settle near its start, when the edges are within
 *   6 degrees of each other, when the window holds too few pixels or when the corner is
 *   uncertain by more than @params lets it move.
 */
gboolean
cloth_corner_refine (const ClothImage * image, gfloat x, gfloat y,
    const ClothCornerParams * params, ClothSimd level, ClothCornerFit * fit)
{
  const ClothCornerModel *model = CLOTH_SIMD_TABLE (cloth_corner_model, level);
  ClothCornerWindow win;
  Evaluation best, next;
  gfloat radius = params->radius > 2 ? MIN (params->radius, 12.0f) : 2.0f;
  gfloat mean = 0, low = G_MAXFLOAT, high = -G_MAXFLOAT;
  gdouble damping = 1e-5, moved = 0;
  gboolean settled = FALSE;
  gint ix, iy, evaluations = 1;

  if (!(x >= 0 && y >= 0 && x <= (gfloat) (image->width - 1)
          && y <= (gfloat) (image->height - 1)))
    return FALSE;
  ix = (gint) floorf (x + 0.5f);
  iy = (gint) floorf (y + 0.5f);
  if (!take_window (&win, image, x, y, ix, iy, radius,
          params->linear_light, &mean))
    return FALSE;

  best.state.x = x - (gfloat) ix;
  best.state.y = y - (gfloat) iy;
  best.state.blur = params->blur > MIN_BLUR ?
      MIN (params->blur, 0.5f * radius) : MIN_BLUR;
  if (params->known_angles) {
    best.state.theta1 = params->theta[0];
    best.state.theta2 = params->theta[1];
    if (!isfinite (params->theta[0] + params->theta[1]))
      return FALSE;
  } else {
    gfloat theta[2];
    if (!find_angles (&win, best.state.x, best.state.y, radius, theta))
      return FALSE;
    best.state.theta1 = theta[0];
    best.state.theta2 = theta[1];
  }
  if (!evaluate (&win, &best, model))
    return FALSE;

  while (evaluations < MAX_EVALUATIONS && !settled) {
    if (!step (&best, damping, radius, &next.state, &moved))
      return FALSE;
    /* The last step is so short that what was learnt before it still holds. */
    if (moved < 3e-3 && damping < 2e-4) {
      best.state = next.state;
      settled = TRUE;
      break;
    }
    if (!evaluate (&win, &next, model))
      return FALSE;
    evaluations++;
    if (next.cost <= best.cost * 1.000001f) {
      best = next;
      damping = MAX (damping * 0.1, 1e-7);
    } else {
      damping *= 10;
      settled = moved < 1e-4;
    }
    if (fabsf (best.state.x - x + (gfloat) ix) > params->max_shift
        || fabsf (best.state.y - y + (gfloat) iy) > params->max_shift)
      return FALSE;
  }
  if (!settled && moved > 0.02)
    return FALSE;

  if (!covariance (&win, &best, fit, model))
    return FALSE;
  fit->x = (gfloat) ix + best.state.x;
  fit->y = (gfloat) iy + best.state.y;
  fit->theta[0] = best.state.theta1;
  fit->theta[1] = best.state.theta2;
  fit->blur = best.state.blur;
  memcpy (fit->c, best.c, sizeof (fit->c));
  fit->c[0] += mean;
  for (gint q = 0; q < 4; q++) {
    gfloat s1 = q & 1 ? 1 : -1, s2 = q & 2 ? 1 : -1;
    gfloat v = s1 * best.c[1] + s2 * best.c[2] + s1 * s2 * best.c[3];
    low = MIN (low, v);
    high = MAX (high, v);
  }
  fit->contrast = high - low;
  fit->iterations = evaluations;
  /* A corner that can't be told from the noise is none. */
  return fit->contrast >= 1
      && fit->cov[0] + fit->cov[2] < params->max_shift * params->max_shift;
}
