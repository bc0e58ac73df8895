/* Seen vertices that would have to be torn off the cloth to be where they are.
 *
 * A corner that was taken for another one lies at another one's place. Where that is far off,
 * a simulation that starts there, or is drawn there, bursts.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/outliers.h"

#include <math.h>

/* No cloth is stretched to so many times its length. */
#define TORN 2.
/* Where more edges than this are torn, nothing at them is believed. */
#define MOST_TORN 2000

typedef struct
{
  guint a, b;
  gdouble flat;                 /* m; of torn ones what they are longer than they may be */
} Edge;

struct _ClothTears
{
  guint n;
  GArray *edges;                /* Edge */
  guint *piece;                 /* of a vertex: another one of its piece, or itself */
  guint *size;                  /* of the piece of a vertex that is its own */
  gboolean *wrong;
  GArray *torn;                 /* Edge */
  gdouble *denials;             /* of a vertex, sum of excesses, m */
};

/* @topology: a mesh, with uv in metres
 *
 * Returns: (transfer full): what finds tears in its frames
 */
ClothOutliers *
cloth_outliers_new (const ClothTopology * topology)
{
  const ClothTopology *t = topology;
  ClothOutliers *tears = g_new0 (ClothOutliers, 1);

  tears->n = t->n_vertices;
  tears->edges = g_array_new (FALSE, FALSE, sizeof (Edge));
  tears->piece = g_new (guint, tears->n);
  tears->size = g_new (guint, tears->n);
  tears->wrong = g_new (gboolean, tears->n);
  tears->torn = g_array_new (FALSE, FALSE, sizeof (Edge));
  tears->denials = g_new (gdouble, tears->n);
  for (guint f = 0; f < t->n_faces; f++) {
    const guint32 *face = t->faces + 4 * (gsize) f;
    guint corners = cloth_face_corners (face);

    for (guint i = 0; i < corners; i++) {
      Edge edge = { face[i], face[(i + 1) % corners] };
      const gfloat *a = t->uv + 2 * (gsize) edge.a;
      const gfloat *b = t->uv + 2 * (gsize) edge.b;

      edge.flat = hypot ((gdouble) a[0] - b[0], (gdouble) a[1] - b[1]);
      if (edge.flat > 0.)
        g_array_append_val (tears->edges, edge);
    }
  }
  return tears;
}

static guint
find_piece (ClothOutliers * tears, guint v)
{
  while (tears->piece[v] != v) {
    tears->piece[v] = tears->piece[tears->piece[v]];
    v = tears->piece[v];
  }
  return v;
}

static void
join (ClothOutliers * tears, guint a, guint b)
{
  a = find_piece (tears, a);
  b = find_piece (tears, b);
  if (a == b)
    return;
  if (tears->size[a] < tears->size[b]) {
    guint c = a;

    a = b;
    b = c;
  }
  tears->piece[b] = a;
  tears->size[a] += tears->size[b];
}

/* Of two pieces the smaller one, and both when they are equal. */
static void
blame (ClothOutliers * tears, guint a, guint b)
{
  a = find_piece (tears, a);
  b = find_piece (tears, b);
  if (a == b)
    return;
  if (tears->size[a] <= tears->size[b])
    tears->wrong[a] = TRUE;
  if (tears->size[b] <= tears->size[a])
    tears->wrong[b] = TRUE;
}

/* Over the distance that neighbours on the cloth may have; NaN when one was not seen. */
static gdouble
excess (const Edge * edge, gdouble slack_m, const gdouble * positions)
{
  const gdouble *p = positions + 3 * (gsize) edge->a;
  const gdouble *q = positions + 3 * (gsize) edge->b;
  gdouble x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];

  return sqrt (x * x + y * y + z * z) - TORN * edge->flat - slack_m;
}

/* Lists the torn edges. */
static void
find_torn (ClothOutliers * tears, gdouble slack_m, const gdouble * positions)
{
  g_array_set_size (tears->torn, 0);
  for (guint i = 0; i < tears->edges->len; i++) {
    Edge edge = g_array_index (tears->edges, Edge, i);

    edge.flat = excess (&edge, slack_m, positions);
    if (edge.flat > 0.)
      g_array_append_val (tears->torn, edge);
  }
}

/* The smaller ones of the pieces that were cut apart. */
static void
find_pieces (ClothOutliers * tears, gdouble slack_m, const gdouble * positions)
{
  for (guint v = 0; v < tears->n; v++) {
    tears->piece[v] = v;
    tears->size[v] = 1;
    tears->wrong[v] = FALSE;
  }
  for (guint i = 0; i < tears->edges->len; i++) {
    const Edge *edge = &g_array_index (tears->edges, Edge, i);

    if (excess (edge, slack_m, positions) <= 0.)
      join (tears, edge->a, edge->b);
  }
  for (guint i = 0; i < tears->torn->len; i++) {
    const Edge *edge = &g_array_index (tears->torn, Edge, i);

    blame (tears, edge->a, edge->b);
  }
  /* a piece's own vertex is the only one that was blamed for it */
  for (guint v = 0; v < tears->n; v++)
    tears->wrong[v] = tears->wrong[find_piece (tears, v)];
}

/* Drops edges at wrong vertices and sums up the others. */
static gdouble
sum_up (ClothOutliers * tears)
{
  gdouble most = 0.;
  guint n = 0;

  for (guint i = 0; i < tears->torn->len; i++) {
    const Edge edge = g_array_index (tears->torn, Edge, i);

    tears->denials[edge.a] = tears->denials[edge.b] = 0.;
    if (!tears->wrong[edge.a] && !tears->wrong[edge.b])
      g_array_index (tears->torn, Edge, n++) = edge;
  }
  g_array_set_size (tears->torn, n);
  for (guint i = 0; i < n; i++) {
    const Edge *edge = &g_array_index (tears->torn, Edge, i);

    tears->denials[edge->a] += edge->flat;
    tears->denials[edge->b] += edge->flat;
    most = MAX (most, MAX (tears->denials[edge->a], tears->denials[edge->b]));
  }
  return most;
}

/* What tears a piece that hangs together elsewhere: the vertex that is most out of place goes
 * first, and with it what it made of its neighbours' distances. */
static void
find_denied (ClothOutliers * tears)
{
  gdouble most;

  while ((most = sum_up (tears)) > 0.) {
    const gboolean all = tears->torn->len > MOST_TORN;

    for (guint i = 0; i < tears->torn->len; i++) {
      const Edge *edge = &g_array_index (tears->torn, Edge, i);

      tears->wrong[edge->a] |= all || tears->denials[edge->a] == most;
      tears->wrong[edge->b] |= all || tears->denials[edge->b] == most;
    }
  }
}

/* @tears: of the mesh
 * @slack_m: how far noise may put two vertices apart, m
 * @positions: (inout) (array): 3 numbers a vertex, m; NaN when not seen
 *
 * Cuts the mesh where neighbours are more than twice as far apart as on the flat cloth.
 * Where two pieces were cut apart, the smaller one is not where it seems: it becomes NaN,
 * and so do both when they are equal; and so does in a piece that is torn, but hangs
 * together elsewhere, what is most out of place. No two neighbours that are left are so far
 * apart.
 *
 * Returns: number of vertices removed
 */
guint
cloth_outliers_remove (ClothOutliers * tears, gdouble slack_m,
    gdouble * positions)
{
  guint removed = 0;

  find_torn (tears, slack_m, positions);
  if (!tears->torn->len)
    return 0;
  find_pieces (tears, slack_m, positions);
  find_denied (tears);
  for (guint v = 0; v < tears->n; v++) {
    if (!tears->wrong[v])
      continue;
    for (guint k = 0; k < 3; k++)
      positions[3 * (gsize) v + k] = NAN;
    removed++;
  }
  return removed;
}

/* @tears: (nullable) (transfer full): what finds tears
 */
void
cloth_outliers_free (ClothOutliers * tears)
{
  if (!tears)
    return;
  g_array_unref (tears->edges);
  g_free (tears->piece);
  g_free (tears->size);
  g_free (tears->wrong);
  g_array_unref (tears->torn);
  g_free (tears->denials);
  g_free (tears);
}
