/* A hierarchy of boxes about triangles at rest: which point of them is the nearest.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/bvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "gst/mesh/side.h"
#include "gst/sim/nearest.h"

#define LEAF 4
/* halves of 2³² triangles */
#define MAX_DEPTH 40

/* Corners 0, 1, 2; edges 01, 12, 20; the face. */
#define N_FEATURES 7

typedef struct
{
  gdouble corner[3][3];
  gdouble normal[N_FEATURES][3];
  gboolean border[N_FEATURES];
} Triangle;

/* A leaf has @n triangles from @first on. The halves of any other node are the next node
 * and the node @first. */
typedef struct
{
  gdouble low[3], high[3];
  guint first, n;
} Node;

struct _ClothBvh
{
  guint n_triangles, n_nodes;
  Triangle *triangles;
  Node *nodes;
  gboolean closed;
};

static gint
compare_points (gconstpointer a, gconstpointer b, gpointer data)
{
  const gdouble *points = data;
  guint32 i = *(const guint32 *) a, j = *(const guint32 *) b;

  for (guint k = 0; k < 3; k++) {
    gdouble p = points[3 * (gsize) i + k], q = points[3 * (gsize) j + k];

    if (p != q)
      return p < q ? -1 : 1;
  }
  return i < j ? -1 : i > j;
}

/* Points at the same place are one: files split them where textures meet. */
static guint32 *
weld (const gdouble * points, guint n_points)
{
  g_autofree guint32 *order = g_new (guint32, n_points + 1);
  guint32 *same = g_new (guint32, n_points + 1);

  for (guint i = 0; i < n_points; i++)
    order[i] = i;
  g_qsort_with_data (order, (gint) n_points, sizeof *order, compare_points,
      (gpointer) points);
  for (guint i = 0; i < n_points; i++) {
    const gdouble *p = points + 3 * (gsize) order[i];

    same[order[i]] = order[i];
    if (i > 0) {
      const gdouble *q = points + 3 * (gsize) order[i - 1];

      if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2])
        same[order[i]] = same[order[i - 1]];
    }
  }
  return same;
}

/* Normals of edges and corners as in Bærentzen and Aanæs (2005), whose sign tells inside
 * from outside wherever the nearest point is. */
static void
make_normals (ClothBvh * bvh, const guint32 * corners, guint n_points)
{
  guint n = 3 * bvh->n_triangles, end;
  g_autofree ClothSide *sides = g_new (ClothSide, n + 1);
  g_autofree gdouble *of_corner = g_new0 (gdouble, 3 * (gsize) n_points + 1);
  g_autofree gboolean *on_border = g_new0 (gboolean, n_points + 1);

  bvh->closed = TRUE;
  for (guint i = 0; i < bvh->n_triangles; i++) {
    const Triangle *t = &bvh->triangles[i];

    for (guint k = 0; k < 3; k++) {
      guint32 a = corners[3 * i + k], b = corners[3 * i + (k + 1) % 3];
      gdouble e[3], f[3];

      sides[3 * i + k] = cloth_side (a, b, i, k);
      cloth_vec3_subtract (t->corner[(k + 1) % 3], t->corner[k], e);
      cloth_vec3_subtract (t->corner[(k + 2) % 3], t->corner[k], f);
      cloth_vec3_add_scaled (of_corner + 3 * (gsize) a,
          acos (CLAMP (cloth_vec3_dot (e, f) / sqrt (cloth_vec3_dot (e,
                          e) * cloth_vec3_dot (f, f)), -1., 1.)), t->normal[6]);
    }
  }
  qsort (sides, n, sizeof *sides, cloth_side_compare);
  for (guint i = 0; i < n; i = end) {
    gdouble sum[3] = { 0., 0., 0. };

    for (end = i; end < n && cloth_side_same_edge (&sides[end], &sides[i]);
        end++)
      cloth_vec3_add_scaled (sum, 1.,
          bvh->triangles[sides[end].face].normal[6]);
    cloth_vec3_normalise (sum);
    if (end - i < 2) {
      on_border[sides[i].a] = on_border[sides[i].b] = TRUE;
      bvh->closed = FALSE;
    }
    for (guint k = i; k < end; k++) {
      Triangle *t = &bvh->triangles[sides[k].face];

      memcpy (t->normal[3 + sides[k].number], sum, sizeof sum);
      t->border[3 + sides[k].number] = end - i < 2;
    }
  }
  for (guint i = 0; i < bvh->n_triangles; i++) {
    Triangle *t = &bvh->triangles[i];

    for (guint k = 0; k < 3; k++) {
      guint32 p = corners[3 * i + k];

      memcpy (t->normal[k], of_corner + 3 * (gsize) p, sizeof t->normal[k]);
      cloth_vec3_normalise (t->normal[k]);
      t->border[k] = on_border[p];
    }
  }
}

static gint
compare_middles (gconstpointer a, gconstpointer b, gpointer data)
{
  guint axis = *(const guint *) data;
  const Triangle *t = a, *u = b;
  gdouble x = t->corner[0][axis] + t->corner[1][axis] + t->corner[2][axis];
  gdouble y = u->corner[0][axis] + u->corner[1][axis] + u->corner[2][axis];

  return x < y ? -1 : x > y;
}

/* Halves along the longest axis, so the depth is the logarithm of the number. */
static void
build (ClothBvh * bvh, guint first, guint n)
{
  guint index = bvh->n_nodes++, axis = 0;
  Node *node = &bvh->nodes[index];

  for (guint k = 0; k < 3; k++) {
    node->low[k] = INFINITY;
    node->high[k] = -INFINITY;
    for (guint i = first; i < first + n; i++) {
      for (guint c = 0; c < 3; c++) {
        gdouble x = bvh->triangles[i].corner[c][k];

        node->low[k] = MIN (node->low[k], x);
        node->high[k] = MAX (node->high[k], x);
      }
    }
    if (node->high[k] - node->low[k] > node->high[axis] - node->low[axis])
      axis = k;
  }
  node->first = first;
  node->n = n;
  if (n <= LEAF)
    return;
  node->n = 0;
  g_qsort_with_data (bvh->triangles + first, (gint) n, sizeof *bvh->triangles,
      compare_middles, &axis);
  build (bvh, first, n / 2);
  bvh->nodes[index].first = bvh->n_nodes;
  build (bvh, first + n / 2, n - n / 2);
}

/* @points: 3 numbers a point, m; nothing of it is kept
 * @n_points: how many
 * @triangles: 3 points a triangle, counter-clockwise as seen from outside
 * @n_triangles: how many
 *
 * Triangles without area, and those with a corner that is not finite, are left out.
 *
 * Returns: (transfer full): the hierarchy
 */
ClothBvh *
cloth_bvh_new (const gdouble * points, guint n_points,
    const guint32 * triangles, guint n_triangles)
{
  ClothBvh *bvh = g_new0 (ClothBvh, 1);
  g_autofree guint32 *same = weld (points, n_points);
  g_autofree guint32 *corners = g_new (guint32, 3 * (gsize) n_triangles + 1);

  bvh->triangles = g_new0 (Triangle, n_triangles + 1);
  for (guint i = 0; i < n_triangles; i++) {
    Triangle *t = &bvh->triangles[bvh->n_triangles];
    gdouble e[3], f[3], *n = t->normal[6], square;

    for (guint k = 0; k < 3; k++) {
      guint32 p = triangles[3 * (gsize) i + k];

      memcpy (t->corner[k], points + 3 * (gsize) p, sizeof t->corner[k]);
      corners[3 * bvh->n_triangles + k] = same[p];
    }
    cloth_vec3_subtract (t->corner[1], t->corner[0], e);
    cloth_vec3_subtract (t->corner[2], t->corner[0], f);
    cloth_vec3_cross (e, f, n);
    square = cloth_vec3_dot (n, n);
    /* thinner than this it has no direction */
    if (!(square > 1e-24 * cloth_vec3_dot (e, e) * cloth_vec3_dot (f, f))
        || !isfinite (square))
      continue;
    cloth_vec3_normalise (n);
    bvh->n_triangles++;
  }
  make_normals (bvh, corners, n_points);
  bvh->nodes = g_new0 (Node, 2 * (gsize) bvh->n_triangles + 1);
  if (bvh->n_triangles > 0)
    build (bvh, 0, bvh->n_triangles);
  return bvh;
}

/* @bvh: (nullable) (transfer full): a hierarchy
 */
void
cloth_bvh_free (ClothBvh * bvh)
{
  if (!bvh)
    return;
  g_free (bvh->triangles);
  g_free (bvh->nodes);
  g_free (bvh);
}

/* @bvh: a hierarchy
 *
 * Returns: whether every edge has two triangles, so that there is an inside
 */
gboolean
cloth_bvh_is_closed (const ClothBvh * bvh)
{
  return bvh->closed && bvh->n_triangles > 0;
}

/* The nearest point of a triangle. Returns the feature. */
static guint
nearest_of_triangle (const Triangle * t, const gdouble p[3], gdouble point[3])
{
  gdouble weights[3], ap[3];
  guint feature = cloth_nearest_on_triangle (t->corner[0], t->corner[1],
      t->corner[2], p, weights);

  if (feature == CLOTH_NEAREST_FACE) {
    cloth_vec3_subtract (p, t->corner[0], ap);
    memcpy (point, p, sizeof ap);
    cloth_vec3_add_scaled (point, -cloth_vec3_dot (ap, t->normal[6]),
        t->normal[6]);
    return feature;
  }
  for (guint k = 0; k < 3; k++)
    point[k] = weights[0] * t->corner[0][k] + weights[1] * t->corner[1][k] +
        weights[2] * t->corner[2][k];
  return feature;
}

static gdouble
square_to_box (const Node * node, const gdouble p[3])
{
  gdouble square = 0.;

  for (guint k = 0; k < 3; k++) {
    gdouble d = MAX (MAX (node->low[k] - p[k], p[k] - node->high[k]), 0.);

    square += d * d;
  }
  return square;
}

/* @bvh: a hierarchy
 * @point: a point
 * @hit: (out): the nearest point of the triangles
 *
 * Returns: %FALSE when there are no triangles, or @point is not finite
 */
gboolean
cloth_bvh_nearest (const ClothBvh * bvh, const gdouble point[3],
    ClothBvhHit * hit)
{
  guint stack[MAX_DEPTH], depth = 0, feature = 0;
  const Triangle *best = NULL;
  gdouble least = INFINITY, away[3];

  if (bvh->n_nodes > 0)
    stack[depth++] = 0;
  while (depth > 0) {
    guint index = stack[--depth];
    const Node *node = &bvh->nodes[index];

    if (!(square_to_box (node, point) < least))
      continue;
    if (node->n == 0) {
      guint near = index + 1, far = node->first;

      if (square_to_box (&bvh->nodes[far], point) <
          square_to_box (&bvh->nodes[near], point)) {
        guint swap = near;

        near = far;
        far = swap;
      }
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (guint i = node->first; i < node->first + node->n; i++) {
      gdouble q[3], square;
      guint f = nearest_of_triangle (&bvh->triangles[i], point, q);

      cloth_vec3_subtract (point, q, away);
      square = cloth_vec3_dot (away, away);
      if (square < least) {
        least = square;
        best = &bvh->triangles[i];
        feature = f;
        memcpy (hit->point, q, sizeof q);
      }
    }
  }
  if (!best)
    return FALSE;
  cloth_vec3_subtract (point, hit->point, away);
  hit->distance = sqrt (least);
  memcpy (hit->normal, best->normal[feature], sizeof hit->normal);
  hit->inside = cloth_vec3_dot (away, hit->normal) < 0.;
  hit->face = feature == 6;
  hit->border = best->border[feature];
  return TRUE;
}
