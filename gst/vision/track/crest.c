/* Points of a moving cloth that lie in a fold's crest instead of on the cloth.
 *
 * Model: points whose places on the cloth are known are joined by Delaunay's triangles on the cloth. In
 *   the picture a sheet that is seen from one side keeps the sense of each triangle, and lengths of
 *   neighbouring edges, as shares of their lengths on the cloth, differ little.
 * Assumption: a point that the cloth hides stays at the crest of the fold, where optical flow finds the
 *   same edge again and again. Then its edges to those before the fold grow short (they pile up), those to
 *   points that are further out grow long (a step of depth lies between), or triangles turn over.
 * Method: of each edge the ratio of lengths r = |Δpx| / |Δuv|; what is usual about a point is the median
 *   of r over its edges and those of its neighbours. Both ends of a short edge are lost, as nobody can
 *   tell which of them is hidden; of a long edge, and of triangles turned over, a point is lost when
 *   they are a good share of its own.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 4.3 and figure 7, which show the points and don't drop them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/crest.h"

#include <math.h>
#include <string.h>

#include "gst/math/delaunay.h"
#include "gst/math/statistics.h"

/* Edges longer on the cloth than this many times the median join what are no neighbours. */
#define REACH 3.

typedef struct
{
  guint a, b;
  gdouble ratio;                /* px/m */
} Edge;

struct _ClothCrest
{
  ClothDelaunay *delaunay;
  GArray *edges, *lengths, *ratios;
  guint *begin, *order;         /* edges of each point: order[begin[i]] … */
  gdouble *usual;
  guint *good, *bad;            /* triangles of a point, and those turned over */
  gsize size, order_size;
};

/* Returns: the usual ones
 */
ClothCrestParams
cloth_crest_default_params (void)
{
  return (ClothCrestParams) {
  0.3, 2.5, 0.5};
}

/* Returns: (transfer full): room to work in
 */
ClothCrest *
cloth_crest_new (void)
{
  ClothCrest *crest = g_new0 (ClothCrest, 1);

  crest->delaunay = cloth_delaunay_new ();
  crest->edges = g_array_new (FALSE, FALSE, sizeof (Edge));
  crest->lengths = g_array_new (FALSE, FALSE, sizeof (gdouble));
  crest->ratios = g_array_new (FALSE, FALSE, sizeof (gdouble));
  return crest;
}

/* @crest: (nullable) (transfer full): room
 */
void
cloth_crest_free (ClothCrest * crest)
{
  if (!crest)
    return;
  cloth_delaunay_free (crest->delaunay);
  g_array_unref (crest->edges);
  g_array_unref (crest->lengths);
  g_array_unref (crest->ratios);
  g_free (crest->begin);
  g_free (crest->order);
  g_free (crest->usual);
  g_free (crest->good);
  g_free (crest->bad);
  g_free (crest);
}

static void
make_room (ClothCrest * c, guint n)
{
  if (n <= c->size)
    return;
  c->size = n;
  c->begin = g_renew (guint, c->begin, n + 1);
  c->usual = g_renew (gdouble, c->usual, n);
  c->good = g_renew (guint, c->good, n);
  c->bad = g_renew (guint, c->bad, n);
}

static gdouble
measure (const gdouble * points, guint a, guint b)
{
  return hypot (points[2 * a] - points[2 * b],
      points[2 * a + 1] - points[2 * b + 1]);
}

/* Edges of the triangles, each once for each of its triangles: inner ones twice. */
static void
list_edges (ClothCrest * c, const guint * triangles, guint n_triangles,
    const gdouble * uv, const gdouble * px)
{
  gdouble longest;

  g_array_set_size (c->edges, 0);
  g_array_set_size (c->lengths, 0);
  for (guint i = 0; i < 3 * n_triangles; i++) {
    const gdouble length = measure (uv, triangles[i],
        triangles[i - i % 3 + (i + 1) % 3]);

    g_array_append_val (c->lengths, length);
  }
  longest = REACH * cloth_median ((gdouble *) c->lengths->data,
      c->lengths->len);
  for (guint i = 0; i < 3 * n_triangles; i++) {
    const guint a = triangles[i], b = triangles[i - i % 3 + (i + 1) % 3];
    const gdouble length = measure (uv, a, b);
    const Edge edge = { a, b, measure (px, a, b) / length };

    if (length <= longest)
      g_array_append_val (c->edges, edge);
  }
}

/* Lists the edges of each point. */
static void
index_edges (ClothCrest * c, guint n)
{
  const Edge *edges = (const Edge *) c->edges->data;
  const guint n_ends = 2 * c->edges->len;

  if (n_ends > c->order_size) {
    c->order_size = n_ends;
    c->order = g_renew (guint, c->order, n_ends);
  }
  memset (c->begin, 0, (n + 1) * sizeof *c->begin);
  for (guint i = 0; i < c->edges->len; i++) {
    c->begin[edges[i].a]++;
    c->begin[edges[i].b]++;
  }
  for (guint i = 1; i <= n; i++)
    c->begin[i] += c->begin[i - 1];
  /* from the back, so that each begin ends up at the first */
  for (guint i = c->edges->len; i-- > 0;) {
    c->order[--c->begin[edges[i].a]] = i;
    c->order[--c->begin[edges[i].b]] = i;
  }
}

/* The median ratio over the edges of a point and of its neighbours; NaN: there are none. */
static gdouble
find_usual (ClothCrest * c, guint point)
{
  const Edge *edges = (const Edge *) c->edges->data;

  g_array_set_size (c->ratios, 0);
  for (guint i = c->begin[point]; i < c->begin[point + 1]; i++) {
    const Edge *edge = &edges[c->order[i]];
    const guint other = edge->a == point ? edge->b : edge->a;

    for (guint j = c->begin[other]; j < c->begin[other + 1]; j++)
      g_array_append_val (c->ratios, edges[c->order[j]].ratio);
  }
  return c->ratios->len ? cloth_median ((gdouble *) c->ratios->data,
      c->ratios->len) : NAN;
}

/* Counts triangles that keep their sense and those that don't. */
static void
count_turned (ClothCrest * c, const guint * triangles, guint n_triangles,
    guint n, const gdouble * px)
{
  memset (c->good, 0, n * sizeof *c->good);
  memset (c->bad, 0, n * sizeof *c->bad);
  for (guint i = 0; i < n_triangles; i++) {
    const guint *t = triangles + 3 * i;
    const gdouble *a = px + 2 * t[0], *b = px + 2 * t[1], *d = px + 2 * t[2];
    const gdouble area = (b[0] - a[0]) * (d[1] - a[1]) - (b[1] -
        a[1]) * (d[0] - a[0]);

    for (guint k = 0; k < 3; k++)
      (area > 0 ? c->good : c->bad)[t[k]]++;
  }
}

/* @crest: room to work in
 * @params: when a point is lost
 * @n: points
 * @uv: (array): u and v of each on the cloth, m, no two the same
 * @px: (array): x and y of each in the picture, px
 * @lost: (array length=n) (out caller-allocates): 1 of those that are not where they seem, else 0
 *
 * The cloth is seen from the side of its print, from which v runs clockwise from u as y does from
 * x in a picture.
 *
 * Returns: how many are lost
 */
guint
cloth_crest_run (ClothCrest * crest, const ClothCrestParams * params, guint n,
    const gdouble * uv, const gdouble * px, guint8 * lost)
{
  ClothCrest *c = crest;
  guint n_triangles, n_lost = 0;
  const guint *triangles;
  const Edge *edges;

  memset (lost, 0, n);
  if (n < 3)
    return 0;
  make_room (c, n);
  triangles = cloth_delaunay_run (c->delaunay, n, uv, 0.01, &n_triangles);
  if (n_triangles == 0)
    return 0;
  list_edges (c, triangles, n_triangles, uv, px);
  index_edges (c, n);
  count_turned (c, triangles, n_triangles, n, px);
  edges = (const Edge *) c->edges->data;
  for (guint i = 0; i < n; i++)
    c->usual[i] = find_usual (c, i);
  for (guint i = 0; i < n; i++) {
    const guint n_edges = c->begin[i + 1] - c->begin[i];
    guint n_long = 0;

    for (guint j = c->begin[i]; j < c->begin[i + 1]; j++) {
      const Edge *edge = &edges[c->order[j]];

      lost[i] |= edge->ratio < params->crowding * c->usual[i];
      n_long += edge->ratio > params->tear * c->usual[i];
    }
    lost[i] |= c->bad[i] > 0
        && c->bad[i] >= params->turned * (c->bad[i] + c->good[i]);
    lost[i] |= 2 * n_long > n_edges;
    n_lost += lost[i];
  }
  return n_lost;
}
