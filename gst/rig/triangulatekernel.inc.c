/* Inner loops of triangulation, included once a vector width: LANES points at a time, V
 * a vector of LANES doubles, M one of LANES masks (0 or −1), NAME() names of this width.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

#define INLINE static inline __attribute__((always_inline))

#if LANES == 1
#define MASK(condition) ((M) -(condition))
#define LOAD(p) (*(p))
#define STORE(p, v) (*(p) = (v))
INLINE gboolean NAME (any) (M mask)
{
  return mask != 0;
}

INLINE V NAME (choose) (M mask, V a, V b)
{
  return mask ? a : b;
}
#else
#define MASK(condition) ((M) (condition))
/* inputs are aligned as doubles are, no more */
typedef V NAME (Unaligned) __attribute__((aligned (8), may_alias));
#define LOAD(p) ((V) *(const NAME (Unaligned) *) (p))
#define STORE(p, v) (*(NAME (Unaligned) *) (p) = (v))
INLINE gboolean NAME (any) (M mask)
{
  gint64 all = 0;

  for (gint l = 0; l < LANES; l++)
    all |= mask[l];
  return all != 0;
}

INLINE V NAME (choose) (M mask, V a, V b)
{
  return (V) ((mask & (M) a) | (~mask & (M) b));
}
#endif

/* Distorts (x, y) by a Brown lens into (*dx, *dy); J: its derivative, symmetric: xx, xy,
 * yy. */
INLINE void
NAME (brown) (const TriangulateCamera * camera, V x, V y, V * dx, V * dy,
    V J[3])
{
  const gdouble * k = camera->k;
  V xx = x * x, yy = y * y, xy = x * y, q = xx + yy;
  V c = 1. + q * (k[0] + q * (k[1] + q * k[4]));
  V dc = k[0] + q * (2. * k[1] + q * (3. * k[4]));

  if (camera->lens == CLOTH_LENS_BROWN8) {
    V iden = 1. / (1. + q * (k[5] + q * (k[6] + q * k[7])));
    V dden = k[5] + q * (2. * k[6] + q * (3. * k[7]));

    c = c * iden;
    dc = (dc - c * dden) * iden;
  }
  *dx = x * c + 2. * k[2] * xy + k[3] * (q + 2. * xx);
  *dy = y * c + k[2] * (q + 2. * yy) + 2. * k[3] * xy;
  J[0] = c + 2. * xx * dc + 2. * k[2] * y + 6. * k[3] * x;
  J[1] = 2. * xy * dc + 2. * k[2] * x + 2. * k[3] * y;
  J[2] = c + 2. * yy * dc + 6. * k[2] * y + 2. * k[3] * x;
}

/* From px to normalised coordinates. Returns where Newton's method could not be
 * trusted. */
INLINE M
NAME (load_group) (const TriangulateCamera * camera, const gdouble * const *in,
    gdouble error_floor, gdouble * obs)
{
  V u = LOAD (in[IN_U]), v = LOAD (in[IN_V]);
  V cxx = LOAD (in[IN_XX]) + error_floor, cxy = LOAD (in[IN_XY]);
  V cyy = LOAD (in[IN_YY]) + error_floor;
  V det = cxx * cyy - cxy * cxy, zero = (V) { 0. };
  V y = (v - camera->cy) * camera->ify;
  V x = (u - camera->cx - camera->skew * y) * camera->ifx;
  /* a − a is 0 unless a is infinite or NaN */
  M seen = MASK (u - u == 0.) & MASK (v - v == 0.) & MASK (cxx > 0.)
      & MASK (cyy > 0.) & MASK (det > 0.) & MASK (det - det == 0.);
  M again = (M) { 0 };
  V ixx, ixy, iyy, idet;

  idet = 1. / NAME (choose) (seen, det, zero + 1.);
  /* information in px, then of coordinates in which K is the identity */
  ixx = cyy * idet;
  ixy = -cxy * idet;
  iyy = cxx * idet;
  iyy = camera->skew * camera->skew * ixx + 2. * camera->skew * camera->fy * ixy
      + camera->fy * camera->fy * iyy;
  ixy = camera->fx * (camera->skew * ixx + camera->fy * ixy);
  ixx = camera->fx * camera->fx * ixx;

  if (camera->lens == CLOTH_LENS_BROWN5 || camera->lens == CLOTH_LENS_BROWN8) {
    const gdouble *p = camera->inverse;
    V dx = NAME (choose) (seen, x, zero), dy = NAME (choose) (seen, y, zero);
    V q = dx * dx + dy * dy;
    V radial = 1. + q * (p[0] + q * (p[1] + q * (p[2] + q * p[3])));
    V J[3] = { zero, zero, zero };
    V a, b, c;
    M open = seen;

    x = dx * radial + 2. * p[4] * dx * dy + p[5] * (q + 2. * dx * dx);
    y = dy * radial + p[4] * (q + 2. * dy * dy) + 2. * p[5] * dx * dy;
    for (gint step = 0; step < MAX_NEWTON && NAME (any) (open); step++) {
      V fx, fy, F[3], ex, ey, scale;

      NAME (brown) (camera, x, y, &fx, &fy, F);
      ex = dx - fx;
      ey = dy - fy;
      scale = 1. / (F[0] * F[2] - F[1] * F[1]);
      x = NAME (choose) (open, x + (F[2] * ex - F[1] * ey) * scale, x);
      y = NAME (choose) (open, y + (F[0] * ey - F[1] * ex) * scale, y);
      for (gint i = 0; i < 3; i++)
        J[i] = NAME (choose) (open, F[i], J[i]);
      /* also open when it is NaN */
      open &= ~(MASK (ex < LAST_NEWTON) & MASK (ex > -LAST_NEWTON)
          & MASK (ey < LAST_NEWTON) & MASK (ey > -LAST_NEWTON));
    }
    again = seen & (open | ~(MASK (J[0] * J[2] - J[1] * J[1] > 0.)
            & MASK (x * x + y * y <= camera->max_r2)));
    /* Jᵀ·I·J */
    a = ixx * J[0] + ixy * J[1];
    b = ixx * J[1] + ixy * J[2];
    c = ixy * J[1] + iyy * J[2];
    ixy = ixy * J[0] + iyy * J[1];
    ixx = J[0] * a + J[1] * ixy;
    ixy = J[0] * b + J[1] * c;
    iyy = J[1] * b + J[2] * c;
  }
  STORE (obs + OBS_X * BLOCK, NAME (choose) (seen, x, zero));
  STORE (obs + OBS_Y * BLOCK, NAME (choose) (seen, y, zero));
  STORE (obs + OBS_IXX * BLOCK, NAME (choose) (seen, ixx, zero));
  STORE (obs + OBS_IXY * BLOCK, NAME (choose) (seen, ixy, zero));
  STORE (obs + OBS_IYY * BLOCK, NAME (choose) (seen, iyy, zero));
  return again;
}

static guint
NAME (load) (const TriangulateCamera * camera, const gdouble * const *in,
    gdouble error_floor, gdouble * obs)
{
  guint again = 0;

  for (guint offset = 0; offset < BLOCK; offset += LANES) {
    const gdouble *group[N_IN];
    M mask;

    for (guint i = 0; i < N_IN; i++)
      group[i] = in[i] + offset;
    mask = NAME (load_group) (camera, group, error_floor, obs + offset);
#if LANES == 1
    again |= (mask & 1) << offset;
#else
    if (NAME (any) (mask))
      for (guint l = 0; l < LANES; l++)
        again |= (guint) (mask[l] & 1) << (offset + l);
#endif
  }
  return again;
}

/* The linear estimate: the null vector of AᵀA, A's rows x·p₃ − p₁ and y·p₃ − p₂ of every
 * view over its σ (Hartley & Zisserman, Multiple View Geometry, 12.2). By two steps of
 * inverse iteration: the first one alone is the solution with the last coordinate at
 * 1. */
INLINE void
NAME (linear) (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, V X[3])
{
  V zero = (V) {0.};
  V a00 = zero, a01 = zero, a02 = zero, a03 = zero, a11 = zero, a12 = zero;
  V a13 = zero, a22 = zero, a23 = zero, a33 = zero;
  V i0, i1, i2, i3, l10, l20, l30, l21, l31, l32, b, x0, x1, x2, x3;

  for (guint i = 0; i < n_views; i++) {
    const gdouble *P = cameras[views[i]].P;
    const gdouble *o = obs + views[i] * (N_OBS * BLOCK);
    V x = LOAD (o + OBS_X * BLOCK), y = LOAD (o + OBS_Y * BLOCK);
    V w = LOAD (o + OBS_IXX * BLOCK) + LOAD (o + OBS_IYY * BLOCK);
    V r0 = x * P[8] - P[0], r1 = x * P[9] - P[1], r2 = x * P[10] - P[2];
    V r3 = x * P[11] - P[3];
    V s0 = y * P[8] - P[4], s1 = y * P[9] - P[5], s2 = y * P[10] - P[6];
    V s3 = y * P[11] - P[7];
    V wr0 = w * r0, wr1 = w * r1, wr2 = w * r2, wr3 = w * r3;
    V ws0 = w * s0, ws1 = w * s1, ws2 = w * s2, ws3 = w * s3;

    a00 += wr0 * r0 + ws0 * s0;
    a01 += wr0 * r1 + ws0 * s1;
    a02 += wr0 * r2 + ws0 * s2;
    a03 += wr0 * r3 + ws0 * s3;
    a11 += wr1 * r1 + ws1 * s1;
    a12 += wr1 * r2 + ws1 * s2;
    a13 += wr1 * r3 + ws1 * s3;
    a22 += wr2 * r2 + ws2 * s2;
    a23 += wr2 * r3 + ws2 * s3;
    a33 += wr3 * r3 + ws3 * s3;
  }
  /* L·D·Lᵀ */
  i0 = 1. / a00;
  l10 = a01 * i0;
  l20 = a02 * i0;
  l30 = a03 * i0;
  i1 = 1. / (a11 - l10 * a01);
  b = a12 - l10 * a02;
  l21 = b * i1;
  x0 = a13 - l10 * a03;
  l31 = x0 * i1;
  i2 = 1. / (a22 - l20 * a02 - l21 * b);
  x1 = a23 - l20 * a03 - l21 * x0;
  l32 = x1 * i2;
  x2 = a33 - l30 * a03 - l31 * x0 - l32 * x1;
  /* 0 but for rounding when the rays meet */
  b = a33 * 1e-16;
  i3 = 1. / NAME (choose) (MASK (x2 > b), x2, b);

  x2 = -l32;
  x1 = -l31 - l21 * x2;
  x0 = -l30 - l10 * x1 - l20 * x2;
  /* second step, from (x0, x1, x2, 1) */
  x1 = x1 - l10 * x0;
  x2 = x2 - l20 * x0 - l21 * x1;
  x3 = (1. - l30 * x0 - l31 * x1 - l32 * x2) * i3;
  x2 = x2 * i2 - l32 * x3;
  x1 = x1 * i1 - l21 * x2 - l31 * x3;
  x0 = x0 * i0 - l10 * x1 - l20 * x2 - l30 * x3;
  b = 1. / x3;
  X[0] = x0 * b;
  X[1] = x1 * b;
  X[2] = x2 * b;
}

/* Reprojection of X in one view: error e, derivative of (e·depth) J0, J1, depth,
 * returns 1/depth. */
INLINE V
NAME (reproject) (const gdouble * P, const gdouble * o, const V X[3], V e[2],
    V J0[3], V J1[3], V * depth)
{
  V p = P[0] * X[0] + P[1] * X[1] + P[2] * X[2] + P[3];
  V q = P[4] * X[0] + P[5] * X[1] + P[6] * X[2] + P[7];
  V r = P[8] * X[0] + P[9] * X[1] + P[10] * X[2] + P[11];
  V i = 1. / r;

  *depth = r;
  p = p * i;
  q = q * i;
  e[0] = p - LOAD (o + OBS_X * BLOCK);
  e[1] = q - LOAD (o + OBS_Y * BLOCK);
  for (gint j = 0; j < 3; j++) {
    J0[j] = P[j] - p * P[8 + j];
    J1[j] = P[4 + j] - q * P[8 + j];
  }
  return i;
}

/* Linear estimate, Gauss–Newton, covariance, error of each view against the others. */
INLINE void
NAME (solve_group) (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, gdouble * out)
{
  V zero = (V) {0.}, X[3], C[6], g[3];
  V i0 = zero, i1 = zero, i2 = zero, l10 = zero, l20 = zero, l21 = zero;
  V chi2 = zero, worst = zero, worst_px = zero, depth = zero + G_MAXDOUBLE;
  V count = zero;
  M open, singular = (M) { 0 };

  g[0] = g[1] = g[2] = zero;
  for (guint i = 0; i < n_views; i++) {
    V w = LOAD (obs + views[i] * (N_OBS * BLOCK) + OBS_IXX * BLOCK);

    count += NAME (choose) (MASK (w > 0.), zero + 1., zero);
  }
  open = MASK (count > 1.);

  NAME (linear) (cameras, obs, views, n_views, X);

  for (gint step = 0; step < MAX_STEPS && NAME (any) (open); step++) {
    V h00 = zero, h01 = zero, h02 = zero, h11 = zero, h12 = zero, h22 = zero;
    V g0 = zero, g1 = zero, g2 = zero, d0, d1, d2, trace, b, d, y1, y2, size;
    M bad;

    for (guint i = 0; i < n_views; i++) {
      const gdouble *o = obs + views[i] * (N_OBS * BLOCK);
      V e[2], J0[3], J1[3], z, iz, iz2, ixx, ixy, iyy, B0[3], B1[3];

      iz = NAME (reproject) (cameras[views[i]].P, o, X, e, J0, J1, &z);
      iz2 = iz * iz;
      ixx = LOAD (o + OBS_IXX * BLOCK);
      ixy = LOAD (o + OBS_IXY * BLOCK);
      iyy = LOAD (o + OBS_IYY * BLOCK);
      b = (ixx * e[0] + ixy * e[1]) * iz;
      d = (ixy * e[0] + iyy * e[1]) * iz;
      g0 += J0[0] * b + J1[0] * d;
      g1 += J0[1] * b + J1[1] * d;
      g2 += J0[2] * b + J1[2] * d;
      ixx = ixx * iz2;
      ixy = ixy * iz2;
      iyy = iyy * iz2;
      for (gint j = 0; j < 3; j++) {
        B0[j] = ixx * J0[j] + ixy * J1[j];
        B1[j] = ixy * J0[j] + iyy * J1[j];
      }
      h00 += J0[0] * B0[0] + J1[0] * B1[0];
      h01 += J0[0] * B0[1] + J1[0] * B1[1];
      h02 += J0[0] * B0[2] + J1[0] * B1[2];
      h11 += J0[1] * B0[1] + J1[1] * B1[1];
      h12 += J0[1] * B0[2] + J1[1] * B1[2];
      h22 += J0[2] * B0[2] + J1[2] * B1[2];
    }
    trace = (h00 + h11 + h22) * SINGULAR;
    i0 = NAME (choose) (open, 1. / h00, i0);
    l10 = NAME (choose) (open, h01 * i0, l10);
    l20 = NAME (choose) (open, h02 * i0, l20);
    d1 = h11 - l10 * h01;
    i1 = NAME (choose) (open, 1. / d1, i1);
    b = h12 - l10 * h02;
    l21 = NAME (choose) (open, b * i1, l21);
    d2 = h22 - l20 * h02 - l21 * b;
    i2 = NAME (choose) (open, 1. / d2, i2);
    bad = ~(MASK (h00 > trace) & MASK (d1 > trace) & MASK (d2 > trace));
    singular |= open & bad;

    y1 = g1 - l10 * g0;
    y2 = (g2 - l20 * g0 - l21 * y1) * i2;
    d2 = y2;
    d1 = y1 * i1 - l21 * d2;
    d0 = g0 * i0 - l10 * d1 - l20 * d2;
    size = d0 * g0 + d1 * g1 + d2 * g2;
    open &= ~bad;
    X[0] = NAME (choose) (open, X[0] - d0, X[0]);
    X[1] = NAME (choose) (open, X[1] - d1, X[1]);
    X[2] = NAME (choose) (open, X[2] - d2, X[2]);
    /* NaN ends it too, and is found out afterwards */
    open &= MASK (size > LAST_SIGMA) | MASK (d0 * d0 + d1 * d1 + d2 * d2 >
        LAST_RELATIVE);
  }

  /* inverse of L·D·Lᵀ */
  {
    V u20 = l10 * l21 - l20;

    C[0] = i0 + l10 * l10 * i1 + u20 * u20 * i2;
    C[1] = -l10 * i1 - u20 * l21 * i2;
    C[2] = u20 * i2;
    C[3] = i1 + l21 * l21 * i2;
    C[4] = -l21 * i2;
    C[5] = i2;
  }
  for (guint i = 0; i < n_views; i++) {
    const TriangulateCamera *camera = &cameras[views[i]];
    const gdouble *o = obs + views[i] * (N_OBS * BLOCK);
    V e[2], J0[3], J1[3], z, iz, ixx, ixy, iyy, B0[3], B1[3], D0[3], D1[3];
    V f0, f1, q00, q01, q11, det, w;
    M seen;

    iz = NAME (reproject) (camera->P, o, X, e, J0, J1, &z);
    ixx = LOAD (o + OBS_IXX * BLOCK);
    ixy = LOAD (o + OBS_IXY * BLOCK);
    iyy = LOAD (o + OBS_IYY * BLOCK);
    seen = MASK (ixx > 0.);
    f0 = ixx * e[0] + ixy * e[1];
    f1 = ixy * e[0] + iyy * e[1];
    chi2 += f0 * e[0] + f1 * e[1];
    q00 = f0 * iz;
    q11 = f1 * iz;
    for (gint j = 0; j < 3; j++)
      g[j] += J0[j] * q00 + J1[j] * q11;
    for (gint j = 0; j < 3; j++) {
      B0[j] = (ixx * J0[j] + ixy * J1[j]) * iz;
      B1[j] = (ixy * J0[j] + iyy * J1[j]) * iz;
    }
    for (gint j = 0; j < 3; j++) {
      V c0 = j == 0 ? C[0] : j == 1 ? C[1] : C[2];
      V c1 = j == 0 ? C[1] : j == 1 ? C[3] : C[4];
      V c2 = j == 0 ? C[2] : j == 1 ? C[4] : C[5];

      D0[j] = B0[0] * c0 + B0[1] * c1 + B0[2] * c2;
      D1[j] = B1[0] * c0 + B1[1] * c1 + B1[2] * c2;
    }
    /* I − I·J·C·Jᵀ·I. With it fᵀ·q⁻¹·f is by how much χ² falls when this view is left
     * out: its normalised error against the others, 2 degrees of freedom. */
    q00 = ixx - D0[0] * B0[0] - D0[1] * B0[1] - D0[2] * B0[2];
    q01 = ixy - D0[0] * B1[0] - D0[1] * B1[1] - D0[2] * B1[2];
    q11 = iyy - D1[0] * B1[0] - D1[1] * B1[1] - D1[2] * B1[2];
    det = q00 * q11 - q01 * q01;
    w = (f0 * f0 * q11 - 2. * f0 * f1 * q01 + f1 * f1 * q00) / det;
    /* a view without which the point is undetermined can't be tested */
    seen &= MASK (det > 1e-10 * (ixx * iyy - ixy * ixy));
    worst = NAME (choose) (seen & MASK (w > worst), w, worst);
    seen = MASK (ixx > 0.);
    w = (e[0] * e[0] + e[1] * e[1]) * camera->area;
    worst_px = NAME (choose) (seen & MASK (w > worst_px), w, worst_px);
    /* also when it is NaN */
    depth = NAME (choose) (seen & ~MASK (z > depth), z, depth);
  }
  /* One more step with the matrix at hand. */
  X[0] -= C[0] * g[0] + C[1] * g[1] + C[2] * g[2];
  X[1] -= C[1] * g[0] + C[3] * g[1] + C[4] * g[2];
  X[2] -= C[2] * g[0] + C[4] * g[1] + C[5] * g[2];
  /* Two views have one degree of freedom together, none apart. */
  worst = NAME (choose) (MASK (count > 2.), worst, chi2);

  for (gint j = 0; j < 3; j++)
    STORE (out + (OUT_X + j) * BLOCK, X[j]);
  for (gint j = 0; j < 6; j++)
    STORE (out + (OUT_XX + j) * BLOCK, C[j]);
  STORE (out + OUT_CHI2 * BLOCK, chi2);
  STORE (out + OUT_WORST * BLOCK, worst);
  STORE (out + OUT_WORST_PX * BLOCK, worst_px);
  STORE (out + OUT_DEPTH * BLOCK, depth);
  STORE (out + OUT_COUNT * BLOCK, count);
  STORE (out + OUT_SINGULAR * BLOCK, NAME (choose) (singular | open, zero + 1.,
          zero));
}

static void
NAME (solve) (const TriangulateCamera * cameras, const gdouble * obs,
    const guint8 * views, guint n_views, gdouble * out)
{
  for (guint offset = 0; offset < BLOCK; offset += LANES)
    NAME (solve_group) (cameras, obs + offset, views, n_views, out + offset);
}

#undef INLINE
#undef MASK
#undef LOAD
#undef STORE
