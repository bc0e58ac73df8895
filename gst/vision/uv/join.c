/* Several heads' vertices, weighed by their information.
 *
 * Two places X and Y of one vertex with covariances C and D agree when
 * (X − Y)ᵀ (C + D)⁻¹ (X − Y) is what χ² of three degrees of freedom lets be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/uv/join.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"

typedef struct
{
  gdouble point[3];
  gdouble covariance[9], information[9];
  guint n_cameras;
} View;

/* A head's vertex in the world; FALSE where its covariance is none. */
static gboolean
get_view (const ClothUVHead * head, guint i, View * view)
{
  const ClothUVVertex *v = &head->vertices[i];
  const gdouble *c = v->covariance;
  const gdouble own[9] = { c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4],
    c[5]
  };
  gdouble d[3], half[9];

  if (!v->seen)
    return FALSE;
  for (gint k = 0; k < 3; k++)
    d[k] = v->point[k] - head->t[k];
  cloth_mat3_vec_t (head->R, d, view->point);
  cloth_mat3_mul_tn (head->R, own, half);
  cloth_mat3_mul (half, head->R, view->covariance);
  view->n_cameras = head->n_cameras;
  return cloth_mat3_inverse (view->covariance, view->information);
}

/* The mean of all views but @without. */
static gboolean
fuse (const View * views, guint n, guint without, View * mean)
{
  gdouble information[9] = { 0 }, sum[3] = { 0 }, part[3];

  mean->n_cameras = 0;
  for (guint k = 0; k < n; k++) {
    if (k == without)
      continue;
    cloth_mat3_vec (views[k].information, views[k].point, part);
    for (gint c = 0; c < 9; c++)
      information[c] += views[k].information[c];
    for (gint c = 0; c < 3; c++)
      sum[c] += part[c];
    mean->n_cameras += views[k].n_cameras;
  }
  if (!cloth_mat3_inverse (information, mean->covariance))
    return FALSE;
  cloth_mat3_vec (mean->covariance, sum, mean->point);
  return TRUE;
}

/* Probability that two places of one vertex are so far apart. */
static gdouble
get_agreement (const View * a, const View * b)
{
  gdouble both[9], inverse[9], d[3], id[3], square = 0;

  for (gint c = 0; c < 9; c++)
    both[c] = a->covariance[c] + b->covariance[c];
  if (!cloth_mat3_inverse (both, inverse))
    return 0;
  for (gint c = 0; c < 3; c++)
    d[c] = a->point[c] - b->point[c];
  cloth_mat3_vec (inverse, d, id);
  for (gint c = 0; c < 3; c++)
    square += d[c] * id[c];
  return isfinite (square) ? cloth_chi_square_tail (MAX (square, 0), 3) : 0;
}

/* Leaves out views that the others contradict, the worst first; returns how many are left,
 * 0 where two contradict each other. */
static guint
refuse (View * views, guint n, gdouble significance, guint * n_left_out)
{
  while (n >= 2) {
    gdouble worst = INFINITY;
    guint at = 0;

    for (guint k = 0; k < n; k++) {
      View others;
      const gdouble agreement = fuse (views, n, k, &others) ?
          get_agreement (&views[k], &others) : 0;

      if (agreement < worst) {
        worst = agreement;
        at = k;
      }
    }
    if (worst >= significance)
      return n;
    if (n == 2)
      return 0;
    views[at] = views[--n];
    ++*n_left_out;
  }
  return n;
}

/* @heads: (array length=n_heads): at most %CLOTH_UV_MAX_HEADS
 * @n_heads: how many
 * @n_vertices: of each head
 * @significance: heads that agree are as far apart as this rarely, 0 to 1; what is farther
 *   contradicts
 * @positions: (out): (array): x, y and z of each vertex, m, world; NaN where unseen
 * @states: (out): (array): a ClothPointState of each: %CLOTH_POINT_TWO_VIEWS where one head
 *   of two cameras saw it
 * @covariances: (out): (array): xx, xy, xz, yy, yz, zz of each, m²; NaN where unseen
 * @joined: (out): what was done
 *
 * Where three or more heads see a vertex, those that the others contradict are left out;
 * where two do and contradict each other it is unseen.
 */
void
cloth_uv_join (const ClothUVHead * heads, guint n_heads, guint n_vertices,
    gdouble significance, gfloat * positions, guint8 * states,
    gfloat * covariances, ClothUVJoined * joined)
{
  static const gint upper[6] = { 0, 1, 2, 4, 5, 8 };

  *joined = (ClothUVJoined) {
  0};
  n_heads = MIN (n_heads, CLOTH_UV_MAX_HEADS);
  for (guint i = 0; i < n_vertices; i++) {
    View views[CLOTH_UV_MAX_HEADS], mean;
    guint n = 0, n_seeing;

    for (guint h = 0; h < n_heads; h++)
      n += get_view (&heads[h], i, &views[n]);
    n_seeing = n;
    n = refuse (views, n, significance, &joined->n_left_out);
    joined->n_contradicted += n_seeing > 1 && n == 0;
    if (n == 0 || !fuse (views, n, G_MAXUINT, &mean)) {
      states[i] = CLOTH_POINT_UNSEEN;
      for (gint c = 0; c < 3; c++)
        positions[3 * i + c] = NAN;
      for (gint c = 0; c < 6; c++)
        covariances[6 * i + c] = NAN;
      continue;
    }
    states[i] = mean.n_cameras >= 3 ? CLOTH_POINT_MEASURED
        : CLOTH_POINT_TWO_VIEWS;
    for (gint c = 0; c < 3; c++)
      positions[3 * i + c] = (gfloat) mean.point[c];
    for (gint c = 0; c < 6; c++)
      covariances[6 * i + c] = (gfloat) mean.covariance[upper[c]];
    joined->n_seen++;
    joined->n_joined += n >= 2;
  }
}
