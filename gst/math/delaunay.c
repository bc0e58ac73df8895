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

/* By how much of the scale a point is moved, and how far out of all points the first
 * triangle reaches, in their extents. */
#define MOVE 1e-6
#define FAR 50.0
/* Edges that are sorted without calls. */
#define FEW 32

typedef struct
{
  guint a, b, c;
  gdouble x, y, square;         /* the circle */
} Triangle;

typedef struct
{
  guint a, b;
} Edge;

typedef struct
{
  gdouble x;
  guint number;
} Place;

struct _ClothDelaunay
{
  GArray *places, *order, *open, *edges, *found;
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
  guint a0 = MIN (a->a, a->b), b0 = MIN (b->a, b->b);
  guint a1 = MAX (a->a, a->b), b1 = MAX (b->a, b->b);

  if (a0 != b0)
    return a0 < b0 ? -1 : 1;
  return a1 < b1 ? -1 : a1 > b1;
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

    for (; k > 0 && compare_edges (&e[k - 1], &edge) > 0; k--)
      e[k] = e[k - 1];
    e[k] = edge;
  }
}

static Triangle
circle (const gdouble * p, guint a, guint b, guint c)
{
  Triangle t = { a, b, c, 0, 0, 0 };
  gdouble bx = p[2 * b] - p[2 * a], by = p[2 * b + 1] - p[2 * a + 1];
  gdouble cx = p[2 * c] - p[2 * a], cy = p[2 * c + 1] - p[2 * a + 1];
  gdouble d = 2 * (bx * cy - by * cx);
  gdouble b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  gdouble x = (cy * b2 - by * c2) / d, y = (bx * c2 - cx * b2) / d;

  t.x = p[2 * a] + x;
  t.y = p[2 * a + 1] + y;
  t.square = x * x + y * y;
  return t;
}

/* Returns: (transfer full): room for triangles that is used again and again
 */
ClothDelaunay *
cloth_delaunay_new (void)
{
  ClothDelaunay *self = g_new (ClothDelaunay, 1);

  self->places = g_array_new (FALSE, FALSE, sizeof (gdouble));
  self->order = g_array_new (FALSE, FALSE, sizeof (Place));
  self->open = g_array_new (FALSE, FALSE, sizeof (Triangle));
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
  g_array_unref (delaunay->open);
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
  GArray *open = g_array_set_size (delaunay->open, 0);
  GArray *edges = delaunay->edges;
  GArray *found = g_array_set_size (delaunay->found, 0);
  gdouble *p = (gdouble *) g_array_set_size (delaunay->places,
      2 * (n + 3))->data;
  Place *order = (Place *) g_array_set_size (delaunay->order, n)->data;
  gdouble low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
  gdouble middle[2], extent;
  Triangle first;

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
  first = circle (p, n, n + 1, n + 2);
  g_array_append_val (open, first);
  for (guint i = 0; i < n; i++)
    order[i] = (Place) {
    p[2 * i], i};
  qsort (order, n, sizeof *order, compare_places);

  for (guint i = 0; i < n; i++) {
    guint number = order[i].number;
    const gdouble *at = p + 2 * number;

    g_array_set_size (edges, 0);
    for (guint k = 0; k < open->len;) {
      Triangle t = g_array_index (open, Triangle, k);
      gdouble dx = at[0] - t.x, dy = at[1] - t.y;

      if (dx * dx + dy * dy < t.square) {
        Edge three[3] = { {t.a, t.b}, {t.b, t.c}, {t.c, t.a}
        };

        g_array_append_vals (edges, three, 3);
      } else if (dx > 0 && dx * dx > t.square) {
        if (t.a < n && t.b < n && t.c < n)
          g_array_append_vals (found, &t, 3);
      } else {
        k++;
        continue;
      }
      g_array_remove_index_fast (open, k);
    }
    sort_edges (edges);
    for (guint k = 0; k < edges->len; k++) {
      const Edge *edge = &g_array_index (edges, Edge, k);
      Triangle t;

      /* an edge of two of them lies within */
      if (k + 1 < edges->len && compare_edges (edge, edge + 1) == 0) {
        k++;
        continue;
      }
      t = circle (p, edge->a, edge->b, number);
      g_array_append_val (open, t);
    }
  }
  for (guint k = 0; k < open->len; k++) {
    const Triangle *t = &g_array_index (open, Triangle, k);

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
