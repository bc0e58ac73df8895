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

struct _ClothOutliers
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
  ClothOutliers *outliers = g_new0 (ClothOutliers, 1);

  outliers->n = t->n_vertices;
  outliers->edges = g_array_new (FALSE, FALSE, sizeof (Edge));
  outliers->piece = g_new (guint, outliers->n);
  outliers->size = g_new (guint, outliers->n);
  outliers->wrong = g_new (gboolean, outliers->n);
  outliers->torn = g_array_new (FALSE, FALSE, sizeof (Edge));
  outliers->denials = g_new (gdouble, outliers->n);
  for (guint f = 0; f < t->n_faces; f++) {
    const guint32 *face = t->faces + 4 * (gsize) f;
    guint corners = cloth_face_corners (face);

    for (guint i = 0; i < corners; i++) {
      Edge edge = { face[i], face[(i + 1) % corners] };
      const gfloat *a = t->uv + 2 * (gsize) edge.a;
      const gfloat *b = t->uv + 2 * (gsize) edge.b;

      edge.flat = hypot ((gdouble) a[0] - b[0], (gdouble) a[1] - b[1]);
      if (edge.flat > 0.)
        g_array_append_val (outliers->edges, edge);
    }
  }
  return outliers;
}

static guint
find_piece (ClothOutliers * outliers, guint v)
{
  while (outliers->piece[v] != v) {
    outliers->piece[v] = outliers->piece[outliers->piece[v]];
    v = outliers->piece[v];
  }
  return v;
}

static void
join (ClothOutliers * outliers, guint a, guint b)
{
  a = find_piece (outliers, a);
  b = find_piece (outliers, b);
  if (a == b)
    return;
  if (outliers->size[a] < outliers->size[b]) {
    guint c = a;

    a = b;
    b = c;
  }
  outliers->piece[b] = a;
  outliers->size[a] += outliers->size[b];
}

/* Of two pieces the smaller one, and both when they are equal. */
static void
blame (ClothOutliers * outliers, guint a, guint b)
{
  a = find_piece (outliers, a);
  b = find_piece (outliers, b);
  if (a == b)
    return;
  if (outliers->size[a] <= outliers->size[b])
    outliers->wrong[a] = TRUE;
  if (outliers->size[b] <= outliers->size[a])
    outliers->wrong[b] = TRUE;
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
find_torn (ClothOutliers * outliers, gdouble slack_m, const gdouble * positions)
{
  g_array_set_size (outliers->torn, 0);
  for (guint i = 0; i < outliers->edges->len; i++) {
    Edge edge = g_array_index (outliers->edges, Edge, i);

    edge.flat = excess (&edge, slack_m, positions);
    if (edge.flat > 0.)
      g_array_append_val (outliers->torn, edge);
  }
}

/* The smaller ones of the pieces that were cut apart. */
static void
find_pieces (ClothOutliers * outliers, gdouble slack_m,
    const gdouble * positions)
{
  for (guint v = 0; v < outliers->n; v++) {
    outliers->piece[v] = v;
    outliers->size[v] = 1;
    outliers->wrong[v] = FALSE;
  }
  for (guint i = 0; i < outliers->edges->len; i++) {
    const Edge *edge = &g_array_index (outliers->edges, Edge, i);

    if (excess (edge, slack_m, positions) <= 0.)
      join (outliers, edge->a, edge->b);
  }
  for (guint i = 0; i < outliers->torn->len; i++) {
    const Edge *edge = &g_array_index (outliers->torn, Edge, i);

    blame (outliers, edge->a, edge->b);
  }
  /* a piece's own vertex is the only one that was blamed for it */
  for (guint v = 0; v < outliers->n; v++)
    outliers->wrong[v] = outliers->wrong[find_piece (outliers, v)];
}

/* Drops edges at wrong vertices and sums up the others. */
static gdouble
sum_up (ClothOutliers * outliers)
{
  gdouble most = 0.;
  guint n = 0;

  for (guint i = 0; i < outliers->torn->len; i++) {
    const Edge edge = g_array_index (outliers->torn, Edge, i);

    outliers->denials[edge.a] = outliers->denials[edge.b] = 0.;
    if (!outliers->wrong[edge.a] && !outliers->wrong[edge.b])
      g_array_index (outliers->torn, Edge, n++) = edge;
  }
  g_array_set_size (outliers->torn, n);
  for (guint i = 0; i < n; i++) {
    const Edge *edge = &g_array_index (outliers->torn, Edge, i);

    outliers->denials[edge->a] += edge->flat;
    outliers->denials[edge->b] += edge->flat;
    most =
        MAX (most, MAX (outliers->denials[edge->a],
            outliers->denials[edge->b]));
  }
  return most;
}

/* What tears a piece that hangs together elsewhere: the vertex that is most out of place goes
 * first, and with it what it made of its neighbours' distances. */
static void
find_denied (ClothOutliers * outliers)
{
  gdouble most;

  while ((most = sum_up (outliers)) > 0.) {
    const gboolean all = outliers->torn->len > MOST_TORN;

    for (guint i = 0; i < outliers->torn->len; i++) {
      const Edge *edge = &g_array_index (outliers->torn, Edge, i);

      outliers->wrong[edge->a] |= all || outliers->denials[edge->a] == most;
      outliers->wrong[edge->b] |= all || outliers->denials[edge->b] == most;
    }
  }
}

/* @outliers: of the mesh
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
cloth_outliers_remove (ClothOutliers * outliers, gdouble slack_m,
    gdouble * positions)
{
  guint removed = 0;

  find_torn (outliers, slack_m, positions);
  if (!outliers->torn->len)
    return 0;
  find_pieces (outliers, slack_m, positions);
  find_denied (outliers);
  for (guint v = 0; v < outliers->n; v++) {
    if (!outliers->wrong[v])
      continue;
    for (guint k = 0; k < 3; k++)
      positions[3 * (gsize) v + k] = NAN;
    removed++;
  }
  return removed;
}

/* @outliers: (nullable) (transfer full): what finds tears
 */
void
cloth_outliers_free (ClothOutliers * outliers)
{
  if (!outliers)
    return;
  g_array_unref (outliers->edges);
  g_free (outliers->piece);
  g_free (outliers->size);
  g_free (outliers->wrong);
  g_array_unref (outliers->torn);
  g_free (outliers->denials);
  g_free (outliers);
}
