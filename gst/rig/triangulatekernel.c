/* Inner loops of triangulation: the same arithmetic for 1, 4 or 8 points at a time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/triangulateprivate.h"

#include <math.h>

#if CLOTH_SIMD_BITS >= 256
#include <immintrin.h>
#endif

/* Gauss–Newton steps; one or two are the rule. */
#define MAX_STEPS 12
/* A step of at most one standard deviation (δᵀHδ) and of a thousandth of the cameras'
 * distance is the last one: it leaves a thousandth of itself, and the chord step after it
 * a thousandth of that. */
#define LAST_SIGMA 1.
#define LAST_RELATIVE 1e-6
/* A pivot this small against the trace: the distance is not determined. */
#define SINGULAR 1e-13
/* Newton steps that undistort, and the error before the last of them: it leaves its
 * square; of a Brown lens the chord step after it leaves the cube. */
#define MAX_NEWTON 6
#define LAST_NEWTON 1e-5
#define LAST_NEWTON_FISHEYE 1e-7

/* Every width is the same source, so every width gives the same bits: there are no sums
 * over lanes, and products are fused with sums where the source says so and nowhere
 * else. A width has its operations on vectors V of LANES doubles and on masks M; VECTOR
 * makes one of a number, where the two meet. */
#define FMA(a, b, c) V_FMA (VECTOR (a), VECTOR (b), VECTOR (c))
/* c − a·b */
#define FNMA(a, b, c) V_FNMA (VECTOR (a), VECTOR (b), VECTOR (c))
#define GREATER(a, b) V_GREATER (VECTOR (a), VECTOR (b))
#define CHOOSE(mask, a, b) V_CHOOSE (mask, VECTOR (a), VECTOR (b))
#define INLINE static inline __attribute__((always_inline))

#if CLOTH_SIMD_BITS == 512
INLINE __m512d
same (__m512d a)
{
  return a;
}

#define LANES 8
#define V __m512d
#define M __mmask8
#define VECTOR(x) _Generic ((x), V: same, default: _mm512_set1_pd) (x)
#define V_FMA _mm512_fmadd_pd
#define V_FNMA _mm512_fnmadd_pd
#define V_GREATER(a, b) _mm512_cmp_pd_mask (a, b, _CMP_GT_OQ)
#define V_CHOOSE(mask, a, b) _mm512_mask_blend_pd ((M) (mask), b, a)
#define BITS(mask) ((guint) (mask) & 0xff)
#define LOAD _mm512_loadu_pd
#define STORE _mm512_storeu_pd
#elif CLOTH_SIMD_BITS == 256
typedef gint64 Mask4 __attribute__((vector_size (32)));

INLINE __m256d
same (__m256d a)
{
  return a;
}

#define LANES 4
#define V __m256d
#define M Mask4
#define VECTOR(x) _Generic ((x), V: same, default: _mm256_set1_pd) (x)
#define V_FMA _mm256_fmadd_pd
#define V_FNMA _mm256_fnmadd_pd
#define V_GREATER(a, b) ((M) _mm256_cmp_pd (a, b, _CMP_GT_OQ))
#define V_CHOOSE(mask, a, b) _mm256_blendv_pd (b, a, (V) (mask))
#define BITS(mask) ((guint) _mm256_movemask_pd ((V) (mask)))
#define LOAD _mm256_loadu_pd
#define STORE _mm256_storeu_pd
#else
#define LANES 1
#define V gdouble
#define M guint
#define VECTOR(x) ((gdouble) (x))
#define V_FMA(a, b, c) fma (a, b, c)
#define V_FNMA(a, b, c) fma (-(a), b, c)
#define V_GREATER(a, b) ((a) > (b) ? ~0u : 0u)
#define V_CHOOSE(mask, a, b) ((mask) ? (a) : (b))
#define BITS(mask) ((mask) & 1)
#define LOAD(p) (*(p))
#define STORE(p, v) (*(p) = (v))
#endif

/* Undistortion sums its polynomials in pairs: its time goes in operations that wait for
 * the one before rather than in their number. */

/* What one group's steps of undistortion hand on. */
typedef struct
{
  /* distorted and true place; of a fisheye x is the ratio of angle to radius */
  V dx, dy, x, y;
  /* newton_brown's; of a fisheye inverse is the slope of radius over angle */
  V J[3], inverse, iden;
  /* information of the distorted place */
  V ixx, ixy, iyy;
  /* seen at all; not converged */
  M seen, open;
} Place;

/* One step of Newton's method towards the place (x, y) that a Brown lens brings to
 * (dx, dy). J: the derivative of distortion where it starts, symmetric: xx, xy, yy;
 * inverse: 1 over J's determinant; iden: 1 over the denominator of the radial term.
 * Returns the square of the error where it starts. */
INLINE V
newton_brown (const TriangulateCamera * camera, V dx, V dy, V * x_io,
    V * y_io, V J[3], V * inverse, V * iden)
{
  const gdouble *k = camera->k, *slope = camera->slope;
  V x = *x_io, y = *y_io, xx = x * x, q = FMA (y, y, xx), qq = q * q, ex, ey, d;
  /* twice the product with the direction of the tangential distortion */
  V t = FMA (slope[7], x, slope[6] * y);
  V c = FMA (qq, FMA (q, k[4], k[1]), FMA (q, k[0], 1.)), both;
  /* twice the derivative of c by q */
  V dc = FMA (q, FMA (q, slope[2], slope[1]), slope[0]);

  *iden = VECTOR (1.);
  if (camera->lens == CLOTH_LENS_BROWN8) {
    *iden = 1. / FMA (qq, FMA (q, k[7], k[6]), FMA (q, k[5], 1.));
    c = c * *iden;
    dc = FNMA (c, FMA (q, FMA (q, slope[5], slope[4]), slope[3]), dc) * *iden;
  }
  both = c + t;
  ex = FNMA (x, both, FNMA (k[3], q, dx));
  ey = FNMA (y, both, FNMA (k[2], q, dy));
  J[0] = FMA (slope[9], x, FMA (xx, dc, both));
  J[1] = FMA (FMA (y, dc, slope[6]), x, slope[7] * y);
  J[2] = FMA (FMA (y, dc, slope[8]), y, both);
  *inverse = d = 1. / FNMA (J[1], J[1], J[0] * J[2]);
  *x_io = FMA (FNMA (J[1], ey, J[2] * ex), d, x);
  *y_io = FMA (FNMA (J[1], ex, J[0] * ey), d, y);
  return FMA (ex, ex, ey * ey);
}

/* Undistorts by a Brown lens, but for one last step. */
INLINE void
start_brown (const TriangulateCamera * camera, Place * o)
{
  const gdouble *p = camera->inverse, *k = camera->k;
  V dx = o->dx, dy = o->dy;
  V q = FMA (dx, dx, dy * dy), qq = q * q, t = FMA (k[3], dx, k[2] * dy);
  V radial = FMA (q, FMA (qq, FMA (qq, FMA (qq, p[6], FMA (q, p[5], p[4])),
              FMA (q, p[3], p[2])), FMA (q, p[1], p[0])),
      FMA (t, FMA (qq, FMA (q, p[10], p[9]), FMA (q, p[8], p[7])), 1.));
  V shift = FMA (qq, FMA (q, p[14], p[13]), FMA (q, p[12], p[11])) * q;
  V x = FMA (dx, radial, k[3] * shift), y = FMA (dy, radial, k[2] * shift);
  V error = newton_brown (camera, dx, dy, &x, &y, o->J, &o->inverse,
      &o->iden);
  /* also open when it is NaN */
  M open = o->seen & ~GREATER (LAST_NEWTON * LAST_NEWTON, error);

  for (gint step = 1; step < MAX_NEWTON && BITS (open); step++) {
    V nx = x, ny = y, J[3], inverse, iden;

    error = newton_brown (camera, dx, dy, &nx, &ny, J, &inverse, &iden);
    x = CHOOSE (open, nx, x);
    y = CHOOSE (open, ny, y);
    o->inverse = CHOOSE (open, inverse, o->inverse);
    o->iden = CHOOSE (open, iden, o->iden);
    for (gint i = 0; i < 3; i++)
      o->J[i] = CHOOSE (open, J[i], o->J[i]);
    open &= ~GREATER (LAST_NEWTON * LAST_NEWTON, error);
  }
  o->x = x;
  o->y = y;
  o->open = open;
}

/* The last step, with the matrix of the one before: J is the derivative of distortion
 * where that started, LAST_NEWTON away at most. Returns where Newton's method could not
 * be trusted. */
INLINE M
finish_brown (const TriangulateCamera * camera, Place * o)
{
  const gdouble *k = camera->k, *slope = camera->slope;
  V x = o->x, y = o->y, q = FMA (x, x, y * y), qq = q * q;
  V t = FMA (slope[7], x, slope[6] * y);
  V c = FMA (qq, FMA (q, k[4], k[1]), FMA (q, k[0], 1.)), den, both;
  V ex = FNMA (k[3], q, o->dx), ey = FNMA (k[2], q, o->dy);

  if (camera->lens == CLOTH_LENS_BROWN8) {
    den = FMA (qq, FMA (q, k[7], k[6]), FMA (q, k[5], 1.));
    both = FMA (t, den, c);
    ex = FNMA (x, both, ex * den) * o->iden;
    ey = FNMA (y, both, ey * den) * o->iden;
  } else {
    both = c + t;
    ex = FNMA (x, both, ex);
    ey = FNMA (y, both, ey);
  }
  o->x = x = FMA (FNMA (o->J[1], ey, o->J[2] * ex), o->inverse, x);
  o->y = y = FMA (FNMA (o->J[1], ex, o->J[0] * ey), o->inverse, y);
  return o->seen & (o->open | ~(GREATER (o->inverse, 0.)
          & GREATER (camera->max_r2, FMA (x, x, y * y))));
}

/* The same for a fisheye, in which an angle θ from the axis becomes a radius of
 * θ·(1 + k₀θ² + … + k₃θ⁸). Newton's method finds the ratio of angle to radius, which has
 * no singular point in the middle. */
INLINE void
start_fisheye (const TriangulateCamera * camera, Place * o)
{
  const gdouble *p = camera->inverse, *k = camera->k, *of = camera->slope;
  V q = FMA (o->dx, o->dx, o->dy * o->dy), qq = q * q, w, ww, e;
  V ratio = FMA (q, FMA (qq, FMA (qq, FMA (qq, p[6], FMA (q, p[5], p[4])),
              FMA (q, p[3], p[2])), FMA (q, p[1], p[0])), 1.);
  V slope = VECTOR (0.);
  M open = o->seen;

  for (gint step = 0; step < MAX_NEWTON && BITS (open); step++) {
    V f;

    w = q * ratio * ratio;
    ww = w * w;
    e = FNMA (ratio, FMA (ww, FMA (ww, k[3], FMA (w, k[2], k[1])),
            FMA (w, k[0], 1.)), 1.);
    f = FMA (ww, FMA (ww, of[3], FMA (w, of[2], of[1])), FMA (w, of[0], 1.));
    ratio = CHOOSE (open, ratio + e / f, ratio);
    slope = CHOOSE (open, f, slope);
    open &= ~GREATER (LAST_NEWTON_FISHEYE * LAST_NEWTON_FISHEYE, e * e);
  }
  o->x = ratio;
  o->inverse = slope;
  o->open = open;
}

/* True place and derivative. Returns where Newton's method could not be trusted. */
INLINE M
finish_fisheye (const TriangulateCamera * camera, Place * o)
{
  V dx = o->dx, dy = o->dy, q = FMA (dx, dx, dy * dy), ratio = o->x;
  V w, u, uu, s, c, m, e, d, along;

  /* sine over angle and cosine of half the angle by their series; it is below π/4 */
  w = q * ratio * ratio;
  u = 0.25 * w;
  uu = u * u;
  s = FMA (uu, FMA (uu, FMA (uu, FMA (u, -1. / 1307674368000.,
                  1. / 6227020800.), FMA (u, -1. / 39916800., 1. / 362880.)),
          FMA (u, -1. / 5040., 1. / 120.)), FMA (u, -1. / 6., 1.));
  c = FMA (uu, FMA (uu, FMA (uu, FMA (uu, 1. / 20922789888000.,
                  FMA (u, -1. / 87178291200., 1. / 479001600.)),
              FMA (u, -1. / 3628800., 1. / 40320.)),
          FMA (u, -1. / 720., 1. / 24.)), FMA (u, -0.5, 1.));
  /* cosine of the whole, then tangent over distorted radius */
  m = FNMA (u * s, s, c * c);
  e = ratio * s * c;
  /* one division for three; in the very middle the last term is 0 */
  q = CHOOSE (GREATER (q, 1e-30), q, 1.);
  d = 1. / (m * e * q);
  s = d * q;
  u = e * e * s;
  o->x = dx * u;
  o->y = dy * u;
  /* across the radius and along it */
  s = m * m * s;
  along = o->inverse * m * m;
  along = (along - s) * (d * m * e);
  o->J[0] = FMA (along * dx, dx, s);
  o->J[1] = along * dx * dy;
  o->J[2] = FMA (along * dy, dy, s);
  return o->seen & (o->open | ~(GREATER (o->inverse, 0.)
          & GREATER (camera->max_r2, w)));
}

/* From px to normalised coordinates, still distorted. */
INLINE void
load_group (const TriangulateCamera * camera, const gdouble * const *in,
    guint offset, gdouble error_floor, Place * o)
{
  const gdouble *unit = camera->unit;
  V u = LOAD (in[IN_U] + offset), v = LOAD (in[IN_V] + offset);
  V cxx = LOAD (in[IN_XX] + offset) + error_floor;
  V cxy = LOAD (in[IN_XY] + offset);
  V cyy = LOAD (in[IN_YY] + offset) + error_floor;
  /* not fused: 0 when the two are perfectly correlated */
  V det = cxx * cyy - cxy * cxy;
  V y = (v - camera->cy) * camera->ify;
  V sum = u + v + det;
  /* sum − sum is 0 unless anything is infinite or NaN; cyy is above 0 with the others */
  M seen = GREATER (cxx, 0.) & GREATER (sum - sum + det, 0.);
  V ixx, ixy, iyy, idet = 1. / CHOOSE (seen, det, 1.);

  /* information in px, then of coordinates in which K is the identity */
  ixx = cyy * idet;
  ixy = -cxy * idet;
  iyy = cxx * idet;
  o->iyy = FMA (unit[3], ixx, FMA (unit[4], ixy, unit[5] * iyy));
  o->ixy = FMA (unit[1], ixx, unit[2] * ixy);
  o->ixx = unit[0] * ixx;
  o->dx = o->x = FNMA (camera->skew, y, u - camera->cx) * camera->ifx;
  o->dy = o->y = y;
  o->seen = seen;
}

/* 0 where not seen. */
INLINE void
store_group (const Place * o, gdouble * obs)
{
  V zero = VECTOR (0.);

  STORE (obs + OBS_X * BLOCK, CHOOSE (o->seen, o->x, zero));
  STORE (obs + OBS_Y * BLOCK, CHOOSE (o->seen, o->y, zero));
  STORE (obs + OBS_IXX * BLOCK, CHOOSE (o->seen, o->ixx, zero));
  STORE (obs + OBS_IXY * BLOCK, CHOOSE (o->seen, o->ixy, zero));
  STORE (obs + OBS_IYY * BLOCK, CHOOSE (o->seen, o->iyy, zero));
}

/* Information of the true place: Jᵀ·I·J. */
INLINE void
carry (Place * o)
{
  const V *J = o->J;
  V a = FMA (o->ixx, J[0], o->ixy * J[1]);
  V b = FMA (o->ixx, J[1], o->ixy * J[2]);
  V c = FMA (o->ixy, J[1], o->iyy * J[2]);
  V d = FMA (o->ixy, J[0], o->iyy * J[1]);

  o->ixx = FMA (J[0], a, J[1] * d);
  o->ixy = FMA (J[0], b, J[1] * c);
  o->iyy = FMA (J[1], b, J[2] * c);
}

static guint
load (const TriangulateCamera * camera, const gdouble * const *in,
    gdouble error_floor, gdouble * obs, guint * again)
{
  enum
  { N = BLOCK / LANES };
  Place o[N];
  guint seen = 0;

  /* step by step, as solve () below */
  *again = 0;
  for (guint i = 0; i < N; i++) {
    load_group (camera, in, i * LANES, error_floor, &o[i]);
    seen |= BITS (o[i].seen) << i * LANES;
  }
  if (camera->lens == CLOTH_LENS_FISHEYE) {
    for (guint i = 0; i < N; i++)
      start_fisheye (camera, &o[i]);
    for (guint i = 0; i < N; i++)
      *again |= BITS (finish_fisheye (camera, &o[i])) << i * LANES;
  } else if (camera->lens != CLOTH_LENS_NONE) {
    for (guint i = 0; i < N; i++)
      start_brown (camera, &o[i]);
    for (guint i = 0; i < N; i++)
      *again |= BITS (finish_brown (camera, &o[i])) << i * LANES;
  }
  for (guint i = 0; i < N; i++) {
    if (camera->lens != CLOTH_LENS_NONE)
      carry (&o[i]);
    store_group (&o[i], obs + i * LANES);
  }
  return seen;
}

/* The linear estimate: the null vector of AᵀA, A's rows p₁ − x·p₃ and p₂ − y·p₃ of every
 * view over its σ (Hartley & Zisserman, Multiple View Geometry, 12.2). By two steps of
 * inverse iteration: the first one alone is the solution with the last coordinate at
 * 1. */
INLINE void
linear (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, V X[3])
{
  V zero = VECTOR (0.);
  V a00 = zero, a01 = zero, a02 = zero, a03 = zero, a11 = zero, a12 = zero;
  V a13 = zero, a22 = zero, a23 = zero, a33 = zero;
  V i0, i1, i2, i3, l10, l20, l30, l21, l31, l32, b, x0, x1, x2, x3;

  for (guint i = 0; i < n_views; i++) {
    const gdouble *P = cameras[views[i]].P;
    const gdouble *o = obs + views[i] * (N_OBS * BLOCK);
    V x = LOAD (o + OBS_X * BLOCK), y = LOAD (o + OBS_Y * BLOCK);
    V w = LOAD (o + OBS_IXX * BLOCK) + LOAD (o + OBS_IYY * BLOCK);
    V r[4], s[4], wr[4], ws[4];

    for (gint j = 0; j < 4; j++) {
      r[j] = FNMA (x, P[8 + j], P[j]);
      s[j] = FNMA (y, P[8 + j], P[4 + j]);
      wr[j] = w * r[j];
      ws[j] = w * s[j];
    }
    a00 = FMA (wr[0], r[0], FMA (ws[0], s[0], a00));
    a01 = FMA (wr[0], r[1], FMA (ws[0], s[1], a01));
    a02 = FMA (wr[0], r[2], FMA (ws[0], s[2], a02));
    a03 = FMA (wr[0], r[3], FMA (ws[0], s[3], a03));
    a11 = FMA (wr[1], r[1], FMA (ws[1], s[1], a11));
    a12 = FMA (wr[1], r[2], FMA (ws[1], s[2], a12));
    a13 = FMA (wr[1], r[3], FMA (ws[1], s[3], a13));
    a22 = FMA (wr[2], r[2], FMA (ws[2], s[2], a22));
    a23 = FMA (wr[2], r[3], FMA (ws[2], s[3], a23));
    a33 = FMA (wr[3], r[3], FMA (ws[3], s[3], a33));
  }
  /* L·D·Lᵀ */
  i0 = 1. / a00;
  l10 = a01 * i0;
  l20 = a02 * i0;
  l30 = a03 * i0;
  i1 = 1. / FNMA (l10, a01, a11);
  b = FNMA (l10, a02, a12);
  l21 = b * i1;
  x0 = FNMA (l10, a03, a13);
  l31 = x0 * i1;
  i2 = 1. / FNMA (l21, b, FNMA (l20, a02, a22));
  x1 = FNMA (l21, x0, FNMA (l20, a03, a23));
  l32 = x1 * i2;
  x2 = FNMA (l32, x1, FNMA (l31, x0, FNMA (l30, a03, a33)));
  /* 0 but for rounding when the rays meet */
  b = a33 * 1e-16;
  i3 = 1. / CHOOSE (GREATER (x2, b), x2, b);

  x2 = -l32;
  x1 = FNMA (l21, x2, -l31);
  x0 = FNMA (l20, x2, FNMA (l10, x1, -l30));
  /* second step, from (x0, x1, x2, 1) */
  x1 = FNMA (l10, x0, x1);
  x2 = FNMA (l21, x1, FNMA (l20, x0, x2));
  x3 = FNMA (l32, x2, FNMA (l31, x1, FNMA (l30, x0, 1.))) * i3;
  x2 = FMA (x2, i2, -(l32 * x3));
  x1 = FMA (x1, i1, -FMA (l21, x2, l31 * x3));
  x0 = FMA (x0, i0, -FMA (l10, x1, FMA (l20, x2, l30 * x3)));
  b = 1. / x3;
  X[0] = x0 * b;
  X[1] = x1 * b;
  X[2] = x2 * b;
}

/* Reprojection of X in one view: error e, derivative of (e·depth) J0, J1, depth,
 * returns 1/depth. */
INLINE V
reproject (const gdouble * P, const gdouble * o, const V X[3], V e[2],
    V J0[3], V J1[3], V * depth)
{
  V p = FMA (P[0], X[0], FMA (P[1], X[1], FMA (P[2], X[2], P[3])));
  V q = FMA (P[4], X[0], FMA (P[5], X[1], FMA (P[6], X[2], P[7])));
  V r = FMA (P[8], X[0], FMA (P[9], X[1], FMA (P[10], X[2], P[11])));
  V i = 1. / r;

  *depth = r;
  p = p * i;
  q = q * i;
  e[0] = p - LOAD (o + OBS_X * BLOCK);
  e[1] = q - LOAD (o + OBS_Y * BLOCK);
  for (gint j = 0; j < 3; j++) {
    J0[j] = FNMA (p, P[8 + j], P[j]);
    J1[j] = FNMA (q, P[8 + j], P[4 + j]);
  }
  return i;
}

/* What one group's steps of solution hand on. */
typedef struct
{
  V X[3];
  /* the normal matrix as L·D·Lᵀ, D inverted */
  V i0, i1, i2, l10, l20, l21;
  /* views that saw the point */
  V count;
  /* not converged; without a solution */
  M open, singular;
} Solution;

INLINE void
start (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, Solution * s)
{
  V zero = VECTOR (0.), one = VECTOR (1.);

  s->count = zero;
  for (guint i = 0; i < n_views; i++) {
    V w = LOAD (obs + views[i] * (N_OBS * BLOCK) + OBS_IXX * BLOCK);

    s->count += CHOOSE (GREATER (w, 0.), one, zero);
  }
  s->i0 = s->i1 = s->i2 = s->l10 = s->l20 = s->l21 = zero;
  s->open = GREATER (s->count, 1.);
  s->singular = s->open & ~s->open;
  if (BITS (s->open))
    linear (cameras, obs, views, n_views, s->X);
}

/* Gauss–Newton. */
INLINE void
refine (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, Solution * s)
{
  V zero = VECTOR (0.), X[3] = { s->X[0], s->X[1], s->X[2] };
  V i0 = s->i0, i1 = s->i1, i2 = s->i2;
  V l10 = s->l10, l20 = s->l20, l21 = s->l21;
  M open = s->open, singular = s->singular;

  for (gint step = 0; step < MAX_STEPS && BITS (open); step++) {
    V h00 = zero, h01 = zero, h02 = zero, h11 = zero, h12 = zero, h22 = zero;
    V g0 = zero, g1 = zero, g2 = zero, d0, d1, d2, trace, b, d, y1, y2, size;
    M bad;

    for (guint i = 0; i < n_views; i++) {
      const gdouble *o = obs + views[i] * (N_OBS * BLOCK);
      V e[2], J0[3], J1[3], z, iz, iz2, ixx, ixy, iyy, B0[3], B1[3];

      iz = reproject (cameras[views[i]].P, o, X, e, J0, J1, &z);
      iz2 = iz * iz;
      ixx = LOAD (o + OBS_IXX * BLOCK);
      ixy = LOAD (o + OBS_IXY * BLOCK);
      iyy = LOAD (o + OBS_IYY * BLOCK);
      b = FMA (ixx, e[0], ixy * e[1]) * iz;
      d = FMA (ixy, e[0], iyy * e[1]) * iz;
      g0 = FMA (J0[0], b, FMA (J1[0], d, g0));
      g1 = FMA (J0[1], b, FMA (J1[1], d, g1));
      g2 = FMA (J0[2], b, FMA (J1[2], d, g2));
      ixx = ixx * iz2;
      ixy = ixy * iz2;
      iyy = iyy * iz2;
      for (gint j = 0; j < 3; j++) {
        B0[j] = FMA (ixx, J0[j], ixy * J1[j]);
        B1[j] = FMA (ixy, J0[j], iyy * J1[j]);
      }
      h00 = FMA (J0[0], B0[0], FMA (J1[0], B1[0], h00));
      h01 = FMA (J0[0], B0[1], FMA (J1[0], B1[1], h01));
      h02 = FMA (J0[0], B0[2], FMA (J1[0], B1[2], h02));
      h11 = FMA (J0[1], B0[1], FMA (J1[1], B1[1], h11));
      h12 = FMA (J0[1], B0[2], FMA (J1[1], B1[2], h12));
      h22 = FMA (J0[2], B0[2], FMA (J1[2], B1[2], h22));
    }
    trace = (h00 + h11 + h22) * SINGULAR;
    i0 = CHOOSE (open, 1. / h00, i0);
    l10 = CHOOSE (open, h01 * i0, l10);
    l20 = CHOOSE (open, h02 * i0, l20);
    d1 = FNMA (l10, h01, h11);
    i1 = CHOOSE (open, 1. / d1, i1);
    b = FNMA (l10, h02, h12);
    l21 = CHOOSE (open, b * i1, l21);
    d2 = FNMA (l21, b, FNMA (l20, h02, h22));
    i2 = CHOOSE (open, 1. / d2, i2);
    bad = ~(GREATER (h00, trace) & GREATER (d1, trace) & GREATER (d2, trace));
    singular |= open & bad;

    y1 = FNMA (l10, g0, g1);
    y2 = FNMA (l21, y1, FNMA (l20, g0, g2)) * i2;
    d2 = y2;
    d1 = FMA (y1, i1, -(l21 * d2));
    d0 = FMA (g0, i0, -FMA (l10, d1, l20 * d2));
    size = FMA (d0, g0, FMA (d1, g1, d2 * g2));
    open &= ~bad;
    X[0] = CHOOSE (open, X[0] - d0, X[0]);
    X[1] = CHOOSE (open, X[1] - d1, X[1]);
    X[2] = CHOOSE (open, X[2] - d2, X[2]);
    /* NaN ends it too, and is found out afterwards */
    open &= GREATER (size, LAST_SIGMA) | GREATER (FMA (d0, d0, FMA (d1, d1,
                d2 * d2)), LAST_RELATIVE);
  }
  for (gint j = 0; j < 3; j++)
    s->X[j] = X[j];
  s->i0 = i0;
  s->i1 = i1;
  s->i2 = i2;
  s->l10 = l10;
  s->l20 = l20;
  s->l21 = l21;
  s->open = open;
  s->singular = singular;
}

/* Covariance and the error of each view against the others. Returns where all is well
 * and all views saw the point. */
INLINE M
finish (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, const TriangulateLimits * limits,
    const Solution * s, gdouble * out)
{
  V zero = VECTOR (0.), one = VECTOR (1.), C[6], g[3] = { zero, zero, zero };
  V X[3] = { s->X[0], s->X[1], s->X[2] }, D[3], u20;
  V i0 = s->i0, i1 = s->i1, i2 = s->i2;
  V l10 = s->l10, l20 = s->l20, l21 = s->l21;
  V chi2 = zero, worst = zero, per = one, worst_px = zero;
  V depth = VECTOR (G_MAXDOUBLE), reason;
  M singular = s->singular, good = GREATER (s->count, 1.);

  if (!BITS (good))
    return good;
  /* inverse of L·D·Lᵀ */
  u20 = FMA (l10, l21, -l20);
  C[5] = i2;
  C[4] = -l21 * i2;
  C[3] = FNMA (l21, C[4], i1);
  C[2] = u20 * i2;
  C[1] = FMA (u20, C[4], -(l10 * i1));
  C[0] = FMA (u20, C[2], FMA (l10 * l10, i1, i0));
  for (guint i = 0; i < n_views; i++) {
    const TriangulateCamera *camera = &cameras[views[i]];
    const gdouble *o = obs + views[i] * (N_OBS * BLOCK);
    V e[2], J0[3], J1[3], z, iz, ixx, ixy, iyy;
    V f0, f1, m00, m01, m11, a00, a01, a10, a11, det, w, s1, s2, t1, t2;
    M seen, above;

    iz = reproject (camera->P, o, X, e, J0, J1, &z);
    ixx = LOAD (o + OBS_IXX * BLOCK);
    ixy = LOAD (o + OBS_IXY * BLOCK);
    iyy = LOAD (o + OBS_IYY * BLOCK);
    seen = GREATER (ixx, 0.);
    f0 = FMA (ixx, e[0], ixy * e[1]);
    f1 = FMA (ixy, e[0], iyy * e[1]);
    chi2 = FMA (f0, e[0], FMA (f1, e[1], chi2));
    a00 = f0 * iz;
    a11 = f1 * iz;
    for (gint j = 0; j < 3; j++)
      g[j] = FMA (J0[j], a00, FMA (J1[j], a11, g[j]));
    /* J·C·Jᵀ, the point's own covariance in this view, by way of J·L⁻ᵀ */
    s1 = FNMA (l10, J0[0], J0[1]);
    s2 = FMA (u20, J0[0], FNMA (l21, J0[1], J0[2]));
    t1 = FNMA (l10, J1[0], J1[1]);
    t2 = FMA (u20, J1[0], FNMA (l21, J1[1], J1[2]));
    w = iz * iz;
    a00 = i0 * w;
    a11 = i1 * w;
    w = i2 * w;
    m00 = FMA (a00 * J0[0], J0[0], FMA (a11 * s1, s1, w * s2 * s2));
    a00 = a00 * J1[0];
    a11 = a11 * t1;
    w = w * t2;
    m01 = FMA (a00, J0[0], FMA (a11, s1, w * s2));
    m11 = FMA (a00, J1[0], FMA (a11, t1, w * t2));
    /* With A = 1 − I·J·C·Jᵀ eᵀ·A⁻¹·I·e is by how much χ² falls when this view is left
     * out: its normalised error against the others, 2 degrees of freedom. */
    a00 = FNMA (ixx, m00, FNMA (ixy, m01, 1.));
    a01 = FMA (ixx, m01, ixy * m11);
    a10 = FMA (ixy, m00, iyy * m01);
    a11 = FNMA (ixy, m01, FNMA (iyy, m11, 1.));
    det = FNMA (a01, a10, a00 * a11);
    w = FMA (e[0], FMA (a11, f0, a01 * f1), e[1] * FMA (a10, f0, a00 * f1));
    /* the greatest w / det; a view without which the point is undetermined can't be
     * tested */
    above = seen & GREATER (det, 1e-10) & GREATER (w * per, worst * det);
    worst = CHOOSE (above, w, worst);
    per = CHOOSE (above, det, per);
    w = FMA (e[0], e[0], e[1] * e[1]) * camera->area;
    worst_px = CHOOSE (seen & GREATER (w, worst_px), w, worst_px);
    /* also when it is NaN */
    depth = CHOOSE (seen & ~GREATER (z, depth), z, depth);
  }
  /* One more step with the matrix at hand. */
  D[0] = FMA (C[0], g[0], FMA (C[1], g[1], C[2] * g[2]));
  D[1] = FMA (C[1], g[0], FMA (C[3], g[1], C[4] * g[2]));
  D[2] = FMA (C[2], g[0], FMA (C[4], g[1], C[5] * g[2]));
  /* Two views have one degree of freedom together, none apart. */
  worst = CHOOSE (GREATER (s->count, 2.), worst / per, chi2);

  for (gint j = 0; j < 3; j++)
    STORE (out + (OUT_X + j) * BLOCK, X[j] - D[j]);
  for (gint j = 0; j < 6; j++)
    STORE (out + (OUT_XX + j) * BLOCK, C[j]);
  STORE (out + OUT_CHI2 * BLOCK, chi2);

  /* false when it is NaN */
  good = GREATER (worst, -1.) & ~(GREATER (worst, limits->error)
      | GREATER (worst_px, limits->error_px));
  reason = CHOOSE (good, zero, CLOTH_POINT_DISAGREE);
  good &= GREATER (depth, 0.);
  reason = CHOOSE (GREATER (depth, 0.), reason, CLOTH_POINT_BEHIND);
  /* a standard deviation of half the distance is no measurement */
  singular |= s->open | ~GREATER (depth * depth * 0.25, C[0] + C[3] + C[5]);
  STORE (out + OUT_REASON * BLOCK, CHOOSE (singular, CLOTH_POINT_PARALLEL,
          reason));
  return good & ~singular & GREATER (s->count, n_views - 0.5);
}

static guint
solve (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, const TriangulateLimits * limits,
    gdouble * out)
{
  enum
  { N = BLOCK / LANES };
  Solution s[N];
  guint good = 0;

  /* Step by step, not group by group: while one group waits for its matrix to be
   * factored, the next one's views are at work. */
  for (guint i = 0; i < N; i++)
    start (cameras, obs + i * LANES, views, n_views, &s[i]);
  for (guint i = 0; i < N; i++)
    refine (cameras, obs + i * LANES, views, n_views, &s[i]);
  for (guint i = 0; i < N; i++)
    good |= BITS (finish (cameras, obs + i * LANES, views, n_views,
            limits, &s[i], out + i * LANES)) << i * LANES;
  return good;
}

const TriangulateKernel CLOTH_SIMD_NAME (cloth_triangulate_kernel) = { load,
  solve
};
