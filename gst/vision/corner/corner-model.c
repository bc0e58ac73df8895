/* Sums of the corner model over a window, for corner.c: sixteen pixels at a time, the
 * same rounding in every instruction set.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/corner-model.h"

#include <math.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))

typedef gint32 LanesInt __attribute__((vector_size (64)));
typedef gfloat Lanes8 __attribute__((vector_size (32)));
typedef gfloat Lanes4 __attribute__((vector_size (16)));

INLINE gfloat
sum_lanes (const ClothLanes * v)
{
  Lanes8 h[2], s;
  Lanes4 q[2], t;

  memcpy (h, v, sizeof (h));
  s = h[0] + h[1];
  memcpy (q, &s, sizeof (q));
  t = q[0] + q[1];
  return (t[0] + t[2]) + (t[1] + t[3]);
}

/* exp (x) for x <= 0, to 3e-7. */
INLINE void
exp_lanes (ClothLanes * x)
{
  const ClothLanes zero = { 0 };
  ClothLanes n, f, p, t = *x * 1.44269504f;
  LanesInt far = t < -40.0f, k;

  t = (ClothLanes) (((LanesInt) t & ~far) | ((LanesInt) (zero - 40.0f) & far));
  n = (t + 12582912.0f) - 12582912.0f;
  f = t - n;
  p = f * 1.8775767e-3f + 8.9893397e-3f;
  p = p * f + 5.5826318e-2f;
  p = p * f + 2.4015361e-1f;
  p = p * f + 6.9315308e-1f;
  p = p * f + 9.9999994e-1f;
  k = __builtin_convertvector (n, LanesInt);
  *x = p * (ClothLanes) ((k + 127) << 23);
}

/* e = erf (u) to 1.5e-7 and g = exp (−u²), by formula 7.1.26 of Abramowitz & Stegun,
 * "Handbook of Mathematical Functions". */
INLINE void
erf_lanes (const ClothLanes * u, ClothLanes * e, ClothLanes * g)
{
  const LanesInt sign = (LanesInt) * u & (gint32) 0x80000000;
  const ClothLanes a = (ClothLanes) ((LanesInt) * u & 0x7fffffff);
  ClothLanes p, t;

  *g = -(a * a);
  exp_lanes (g);
  t = 1.0f / (1.0f + 0.3275911f * a);
  p = t * 1.061405429f - 1.453152027f;
  p = p * t + 1.421413741f;
  p = p * t - 0.284496736f;
  p = p * t + 0.254829592f;
  t = 1.0f - p * t * *g;
  *e = (ClothLanes) ((LanesInt) t | sign);
}

/* Nodes and weights of Gauss and Legendre on [0, 1]. */
#define N_NODES 3
static const gfloat node[N_NODES] = { 0.11270167f, 0.5f, 0.88729833f };
static const gfloat node_weight[N_NODES] =
    { 0.27777778f, 0.44444444f, 0.27777778f };

/* The blurred product of two steps is not the product of the blurred steps unless they
 * cross at right angles: with r the correlation of the distances to both edges,
 * d E[sgn sgn] / dr = 4 phi2 (Plackett 1954), integrated from r = 0 by r = sin t. */
static void
basis (ClothCornerWindow * win, const ClothCornerState * st, gfloat * sums)
{
  const gfloat k = 0.70710678f / st->blur;
  const gfloat sin1 = k * sinf (st->theta1), cos1 = k * cosf (st->theta1);
  const gfloat sin2 = k * sinf (st->theta2), cos2 = k * cosf (st->theta2);
  const gfloat r = cosf (st->theta1 - st->theta2), turn = asinf (r);
  const gfloat across = sqrtf (MAX (1.0f - r * r, 1e-4f));
  const gfloat inv = 1.0f / across;
  gfloat weight[N_NODES], node_sin[N_NODES], node_inv[N_NODES];
  ClothLanes acc[CLOTH_CORNER_N_BASIS] = { {0} };

  for (gint i = 0; i < N_NODES; i++) {
    gfloat c = cosf (turn * node[i]);
    node_sin[i] = 2 * sinf (turn * node[i]);
    node_inv[i] = -1 / (c * c);
    weight[i] = 0.63661977f * turn * node_weight[i];
  }
  for (gint v = 0; v < win->n_vectors; v++) {
    ClothLanes dx = win->x[v] - st->x, dy = win->y[v] - st->y;
    ClothLanes u1 = dy * cos1 - dx * sin1, u2 = dy * cos2 - dx * sin2;
    ClothLanes q1 = (u2 - u1 * r) * inv, q2 = (u1 - u2 * r) * inv;
    ClothLanes w = win->weight[v], i = win->value[v];
    ClothLanes e1, e2, e12, w1, w2, w12, wi, along, unused;
    ClothLanes squares = u1 * u1 + u2 * u2, product = u1 * u2;

    erf_lanes (&u1, &e1, &win->g1[v]);
    erf_lanes (&u2, &e2, &win->g2[v]);
    erf_lanes (&q1, &win->q1[v], &along);
    erf_lanes (&q2, &win->q2[v], &unused);
    e12 = e1 * e2;
#pragma GCC unroll 3
    for (gint n = 0; n < N_NODES; n++) {
      ClothLanes t = (squares - product * node_sin[n]) * node_inv[n];
      exp_lanes (&t);
      e12 += t * weight[n];
    }
    /* (u1² + u2² − 2 r u1 u2) / (1 − r²) = u1² + q1² */
    win->ridge[v] = win->g1[v] * along;
    win->e1[v] = e1;
    win->e2[v] = e2;
    win->e12[v] = e12;
    w1 = w * e1;
    w2 = w * e2;
    w12 = w * e12;
    wi = w * i;
    acc[0] += w;
    acc[1] += w1;
    acc[2] += w2;
    acc[3] += w12;
    acc[4] += w1 * e1;
    acc[5] += w1 * e2;
    acc[6] += w1 * e12;
    acc[7] += w2 * e2;
    acc[8] += w2 * e12;
    acc[9] += w12 * e12;
    acc[10] += wi;
    acc[11] += wi * e1;
    acc[12] += wi * e2;
    acc[13] += wi * e12;
  }
  for (gint j = 0; j < CLOTH_CORNER_N_BASIS; j++)
    sums[j] = sum_lanes (&acc[j]);
}

/* The residual, and the derivatives of the model by its parameters. */
INLINE void
linearise (const ClothCornerWindow * win, gint v, const ClothCornerState * st,
    const gfloat * trig, const gfloat * c, ClothLanes * r, ClothLanes * j)
{
  const gfloat k = 0.70710678f / st->blur, two = 1.1283792f;
  const gfloat sin1 = trig[0], cos1 = trig[1], sin2 = trig[2], cos2 = trig[3];
  const gfloat skew = c[3] *
      (sin1 * cos2 - cos1 * sin2 > 0 ? 0.63661977f : -0.63661977f);
  ClothLanes dx = win->x[v] - st->x, dy = win->y[v] - st->y;
  ClothLanes t1 = dx * cos1 + dy * sin1, t2 = dx * cos2 + dy * sin2;
  ClothLanes d1 = dy * cos1 - dx * sin1, d2 = dy * cos2 - dx * sin2;
  ClothLanes e1 = win->e1[v], e2 = win->e2[v], e12 = win->e12[v];
  ClothLanes a1 = (c[1] + c[3] * win->q1[v]) * win->g1[v] * two;
  ClothLanes a2 = (c[2] + c[3] * win->q2[v]) * win->g2[v] * two;

  *r = win->value[v] - (c[0] + c[1] * e1 + c[2] * e2 + c[3] * e12);
  /* Along its normal an edge moves against the signed distance. */
  j[0] = -a1;
  j[1] = -a2;
  j[2] = t1 * a1 * -k - win->ridge[v] * skew;
  j[3] = t2 * a2 * -k + win->ridge[v] * skew;
  j[4] = (d1 * a1 + d2 * a2) * (-k / st->blur);
  j[5] = 1.0f + 0.0f * e1;
  j[6] = e1;
  j[7] = e2;
  j[8] = e12;
}

/* Sums with one of the first five parameters; those of the others alone are the basis's. */
#define N_CROSS 35

static void
normal (const ClothCornerWindow * win, const ClothCornerState * st,
    const gfloat * c, const gfloat * sums, gfloat * out, gfloat * gradient,
    gfloat * cost)
{
  const gfloat trig[4] = { sinf (st->theta1), cosf (st->theta1),
    sinf (st->theta2), cosf (st->theta2)
  };
  ClothLanes acc[N_CROSS + 6] = { {0} };

  for (gint v = 0; v < win->n_vectors; v++) {
    ClothLanes j[CLOTH_CORNER_N], r, w = win->weight[v];
    gint n = 0;

    linearise (win, v, st, trig, c, &r, j);
#pragma GCC unroll 5
    for (gint a = 0; a < 5; a++) {
      ClothLanes wa = w * j[a];
#pragma GCC unroll 9
      for (gint b = a; b < CLOTH_CORNER_N; b++)
        acc[n++] += wa * j[b];
    }
    w *= r;
#pragma GCC unroll 5
    for (gint a = 0; a < 5; a++)
      acc[n++] += w * j[a];
    acc[n] += w * r;
  }
  for (gint n = 0; n < N_CROSS; n++)
    out[n] = sum_lanes (&acc[n]);
  memcpy (out + N_CROSS, sums, (CLOTH_CORNER_N_SUMS - N_CROSS) * sizeof (*out));
  for (gint n = 0; n < 5; n++)
    gradient[n] = sum_lanes (&acc[N_CROSS + n]);
  *cost = sum_lanes (&acc[N_CROSS + 5]);
}

static void
influence (const ClothCornerWindow * win, const ClothCornerState * st,
    const gfloat * c, const gfloat * root, const gfloat * row, gfloat * out)
{
  const gfloat trig[4] = { sinf (st->theta1), cosf (st->theta1),
    sinf (st->theta2), cosf (st->theta2)
  };
  ClothLanes acc[3] = { {0} };

  for (gint v = 0; v < win->n_vectors; v++) {
    ClothLanes j[CLOTH_CORNER_N], y[CLOTH_CORNER_N], r, w = win->weight[v];
    ClothLanes px = 0.0f * w, py = px, lever = px, noise;

    linearise (win, v, st, trig, c, &r, j);
#pragma GCC unroll 9
    for (gint a = 0; a < CLOTH_CORNER_N; a++) {
      px += j[a] * row[a];
      py += j[a] * row[CLOTH_CORNER_N + a];
      y[a] = j[a];
#pragma GCC unroll 9
      for (gint b = 0; b < a; b++)
        y[a] -= y[b] * root[b * CLOTH_CORNER_N + a];
      y[a] *= root[a * CLOTH_CORNER_N + a];
      lever += y[a] * y[a];
    }
    /* A pixel that nearly fixes a parameter alone has next to no residual. */
    noise = 1.0f - w * lever;
    {
      LanesInt low = noise < 0.1f;
      noise = (ClothLanes) (((LanesInt) noise & ~low) |
          ((LanesInt) (0.0f * w + 0.1f) & low));
    }
    noise = w * w * (r * r + 0.01f) / noise;
    acc[0] += noise * px * px;
    acc[1] += noise * px * py;
    acc[2] += noise * py * py;
  }
  for (gint n = 0; n < 3; n++)
    out[n] = sum_lanes (&acc[n]);
}

const ClothCornerModel CLOTH_SIMD_NAME (cloth_corner_model) = { basis, normal,
  influence
};
