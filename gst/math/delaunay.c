/* Delaunay triangles of points in the plane.
 *
 * Points come from left to right, so that a triangle whose circle lies left of the next
 * point is done and looked at no more (A. Bowyer and D. Watson, 1981, with a sweep).
 * The dots of a grid lie on common circles; each point is therefore moved by less than
 * anybody draws, by a hash of its number, which decides every tie in the same way always.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/delaunay.h"

#include <math.h>
#include <stdlib.h>

#include "gst/math/delaunay-private.h"

/* By how much of the scale a point is moved, and how far out of all points the first
 * triangle reaches, in their extents. */
#define MOVE 1e-6
#define FAR 50.0
/* Edges that are sorted without calls. */
#define FEW 32

typedef struct
{
  guint a, b, c;
} Triangle;

typedef struct
{
  guint64 key;                  /* of the two points, in either order */
  guint a, b;
} Edge;

typedef struct
{
  gdouble x;
  guint number;
} Place;

struct _ClothDelaunay
{
  GArray *places, *order, *edges, *found;
  /* not yet done, with their circles */
  Triangle *open;
  ClothDelaunayCircles circles;
  guint n_open, most;
};

static gdouble
hash (guint number)
{
  guint32 h = number * 2654435761u + 12345u;

  h ^= h >> 15;
  h *= 2246822519u;
  h ^= h >> 13;
  return h / 4294967296.0 - 0.5;
}

static gint
compare_places (gconstpointer pa, gconstpointer pb)
{
  const Place *a = pa, *b = pb;

  if (a->x != b->x)
    return a->x < b->x ? -1 : 1;
  return a->number < b->number ? -1 : a->number > b->number;
}

static gint
compare_edges (gconstpointer pa, gconstpointer pb)
{
  const Edge *a = pa, *b = pb;

  return a->key < b->key ? -1 : a->key > b->key;
}

/* A point has some six edges around it: fewer steps than a call each. */
static void
sort_edges (GArray * edges)
{
  Edge *e = (Edge *) edges->data;

  if (edges->len > FEW) {
    g_array_sort (edges, compare_edges);
    return;
  }
  for (guint i = 1; i < edges->len; i++) {
    const Edge edge = e[i];
    guint k = i;

    for (; k > 0 && e[k - 1].key > edge.key; k--)
      e[k] = e[k - 1];
    e[k] = edge;
  }
}

/* An edge of two triangles lies within the hole that they leave. */
static void
add_edge (GArray * edges, guint a, guint b)
{
  const Edge edge = { (guint64) MIN (a, b) << 32 | MAX (a, b), a, b };
  const Edge *e = (const Edge *) edges->data;

  for (guint k = 0; k < edges->len; k++)
    if (e[k].key == edge.key) {
      g_array_remove_index_fast (edges, k);
      return;
    }
  g_array_append_val (edges, edge);
}

/* ---- triangles that are not done ---- */

static void
reserve (ClothDelaunay * self, guint n)
{
  ClothDelaunayCircles *c = &self->circles;
  const guint before = self->most + CLOTH_DELAUNAY_LANES;

  if (n <= self->most)
    return;
  self->most = MAX (n, 2 * self->most);
  self->open = g_renew (Triangle, self->open, self->most);
  c->x = g_renew (gdouble, c->x, self->most + CLOTH_DELAUNAY_LANES);
  c->y = g_renew (gdouble, c->y, self->most + CLOTH_DELAUNAY_LANES);
  c->square = g_renew (gdouble, c->square, self->most + CLOTH_DELAUNAY_LANES);
  for (guint i = before; i < self->most + CLOTH_DELAUNAY_LANES; i++) {
    c->x[i] = INFINITY;
    c->y[i] = c->square[i] = 0;
  }
}

/* Adds the triangle of three points, for which there is room. */
static void
open_triangle (ClothDelaunay * self, guint a, guint b, guint c)
{
  const gdouble *p = (const gdouble *) self->places->data;
  const gdouble bx = p[2 * b] - p[2 * a], by = p[2 * b + 1] - p[2 * a + 1];
  const gdouble cx = p[2 * c] - p[2 * a], cy = p[2 * c + 1] - p[2 * a + 1];
  const gdouble d = 2 * (bx * cy - by * cx);
  const gdouble b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  const gdouble x = (cy * b2 - by * c2) / d, y = (bx * c2 - cx * b2) / d;
  const guint at = self->n_open++;

  self->open[at] = (Triangle) {
  a, b, c};
  self->circles.x[at] = p[2 * a] + x;
  self->circles.y[at] = p[2 * a + 1] + y;
  self->circles.square[at] = x * x + y * y;
}

/* The last one takes its place. */
static void
close_triangle (ClothDelaunay * self, guint at)
{
  const ClothDelaunayCircles *c = &self->circles;
  const guint last = --self->n_open;

  self->open[at] = self->open[last];
  c->x[at] = c->x[last];
  c->y[at] = c->y[last];
  c->square[at] = c->square[last];
  c->x[last] = INFINITY;
  c->y[last] = c->square[last] = 0;
}

static void
close_all (ClothDelaunay * self)
{
  while (self->n_open)
    close_triangle (self, self->n_open - 1);
}

/* Closes those whose circles hold the point, which leaves a hole with edges; and those that
 * are done. */
static void
make_hole (ClothDelaunay * self, const ClothDelaunayKernel * kernel,
    const gdouble at[2], guint n)
{
  const ClothDelaunayCircles *c = &self->circles;

  g_array_set_size (self->edges, 0);
  for (guint k = 0; (k = kernel->find (c, k, self->n_open, at[0],
              at[1])) < self->n_open;) {
    const Triangle t = self->open[k];
    const gdouble dx = at[0] - c->x[k], dy = at[1] - c->y[k];

    if (dx * dx + dy * dy < c->square[k]) {
      add_edge (self->edges, t.a, t.b);
      add_edge (self->edges, t.b, t.c);
      add_edge (self->edges, t.c, t.a);
    } else if (t.a < n && t.b < n && t.c < n)
      g_array_append_vals (self->found, &t, 3);
    close_triangle (self, k);
  }
  sort_edges (self->edges);
}

/* Triangles of the hole's edges and point @number. */
static void
fill_hole (ClothDelaunay * self, guint number)
{
  const Edge *edges = (const Edge *) self->edges->data;
  const guint n = self->edges->len;

  reserve (self, self->n_open + n);
  for (guint k = 0; k < n; k++)
    open_triangle (self, edges[k].a, edges[k].b, number);
}

/* Returns: (transfer full): room for triangles that is used again and again
 */
ClothDelaunay *
cloth_delaunay_new (void)
{
  ClothDelaunay *self = g_new0 (ClothDelaunay, 1);

  self->places = g_array_new (FALSE, FALSE, sizeof (gdouble));
  self->order = g_array_new (FALSE, FALSE, sizeof (Place));
  self->edges = g_array_new (FALSE, FALSE, sizeof (Edge));
  self->found = g_array_new (FALSE, FALSE, sizeof (guint));
  return self;
}

/* @delaunay: (nullable) (transfer full): what to free
 */
void
cloth_delaunay_free (ClothDelaunay * delaunay)
{
  if (!delaunay)
    return;
  g_array_unref (delaunay->places);
  g_array_unref (delaunay->order);
  g_free (delaunay->open);
  g_free (delaunay->circles.x);
  g_free (delaunay->circles.y);
  g_free (delaunay->circles.square);
  g_array_unref (delaunay->edges);
  g_array_unref (delaunay->found);
  g_free (delaunay);
}

/* @delaunay: room to work in
 * @n: number of points; fewer than 3 have no triangle
 * @points: (array): x and y of each, no two the same
 * @scale: their usual distance
 * @n_triangles: (out): number of triangles
 *
 * Returns: (transfer none): three points a triangle, the caller's until the next call;
 *   those of a positive area x·y′ − y·x′
 */
guint *
cloth_delaunay_run (ClothDelaunay * delaunay, guint n, const gdouble * points,
    gdouble scale, guint * n_triangles)
{
  const ClothDelaunayKernel *kernel = CLOTH_SIMD_TABLE (cloth_delaunay_kernel,
      CLOTH_SIMD_BEST);
  GArray *found = g_array_set_size (delaunay->found, 0);
  gdouble *p = (gdouble *) g_array_set_size (delaunay->places,
      2 * (n + 3))->data;
  Place *order = (Place *) g_array_set_size (delaunay->order, n)->data;
  gdouble low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  gdouble middle[2], extent;

  *n_triangles = 0;
  if (n < 3)
    return NULL;
  for (guint i = 0; i < 2 * n; i++) {
    p[i] = points[i] + MOVE * scale * hash (i);
    low[i % 2] = MIN (low[i % 2], p[i]);
    high[i % 2] = MAX (high[i % 2], p[i]);
  }
  extent = fmax (fmax (high[0] - low[0], high[1] - low[1]), scale);
  middle[0] = (low[0] + high[0]) / 2;
  middle[1] = (low[1] + high[1]) / 2;
  for (guint i = 0; i < 3; i++) {
    gdouble angle = 2 * G_PI * i / 3 + 0.1;

    p[2 * (n + i)] = middle[0] + FAR * extent * cos (angle);
    p[2 * (n + i) + 1] = middle[1] + FAR * extent * sin (angle);
  }
  close_all (delaunay);
  reserve (delaunay, 2 * n);
  open_triangle (delaunay, n, n + 1, n + 2);
  for (guint i = 0; i < n; i++)
    order[i] = (Place) {
    p[2 * i], i};
  qsort (order, n, sizeof *order, compare_places);

  for (guint i = 0; i < n; i++) {
    const guint number = order[i].number;

    make_hole (delaunay, kernel, p + 2 * number, n);
    fill_hole (delaunay, number);
  }
  for (guint k = 0; k < delaunay->n_open; k++) {
    const Triangle *t = &delaunay->open[k];

    if (t->a < n && t->b < n && t->c < n)
      g_array_append_vals (found, t, 3);
  }
  for (guint k = 0; k < found->len; k += 3) {
    guint *t = &g_array_index (found, guint, k);
    const gdouble *a = p + 2 * t[0], *b = p + 2 * t[1], *c = p + 2 * t[2];

    if ((b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0])) {
      guint swap = t[1];

      t[1] = t[2];
      t[2] = swap;
    }
  }
  *n_triangles = found->len / 3;
  return (guint *) found->data;
}
