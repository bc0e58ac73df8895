/* A place for every vertex, for formats whose viewers cannot show NaN.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/hold.h"

#include <math.h>
#include <string.h>

struct _ClothHold
{
  guint n_vertices;
  gfloat *uv;
  gfloat *positions;            /* 3 a vertex, what the last frame was shown with */
  guint8 *seen;                 /* 1: seen in some frame so far */
  guint n_never;                /* vertices not seen so far */
  /* Neighbours along the edges of faces. */
  guint32 *first;               /* n_vertices + 1 */
  guint32 *neighbours;
  guint32 *queue;
  guint8 *placed;
};

/* The edges of a face run round its corners. */
static void
visit_edges (const ClothTopology * topology, ClothHold * hold, gboolean store)
{
  for (gsize f = 0; f < topology->n_faces; f++) {
    const guint32 *face = topology->faces + 4 * f;
    guint n = cloth_face_corners (face);

    for (guint k = 0; k < n; k++) {
      guint32 a = face[k], b = face[(k + 1) % n];

      if (store) {
        hold->neighbours[hold->first[a]++] = b;
        hold->neighbours[hold->first[b]++] = a;
      } else {
        hold->first[a + 1]++;
        hold->first[b + 1]++;
      }
    }
  }
}

static void
find_neighbours (const ClothTopology * topology, ClothHold * hold)
{
  guint n = topology->n_vertices;

  hold->first = g_new0 (guint32, (gsize) n + 1);
  visit_edges (topology, hold, FALSE);
  for (guint i = 0; i < n; i++)
    hold->first[i + 1] += hold->first[i];
  hold->neighbours = g_new (guint32, (gsize) hold->first[n] + 1);
  visit_edges (topology, hold, TRUE);
  /* Storing moved each start to the next one's. */
  memmove (hold->first + 1, hold->first, n * sizeof *hold->first);
  hold->first[0] = 0;
}

/* @topology: the mesh
 *
 * Returns: (transfer full): a filler for the frames of one sequence
 */
ClothHold *
cloth_hold_new (const ClothTopology * topology)
{
  ClothHold *hold = g_new0 (ClothHold, 1);
  guint n = topology->n_vertices;

  hold->n_vertices = hold->n_never = n;
  hold->uv = g_memdup2 (topology->uv, 2 * (gsize) n * sizeof *topology->uv);
  hold->positions = g_new0 (gfloat, 3 * (gsize) n);
  hold->seen = g_new0 (guint8, n);
  hold->queue = g_new (guint32, n);
  hold->placed = g_new (guint8, n);
  find_neighbours (topology, hold);
  return hold;
}

/* From the vertices seen so far outwards, each new one takes the mean of the
 * neighbours that have a place already; parts where nothing was seen lie flat. */
static void
place_never_seen (ClothHold * hold)
{
  guint head = 0, tail = 0;

  memcpy (hold->placed, hold->seen, hold->n_vertices);
  for (guint32 i = 0; i < hold->n_vertices; i++)
    if (hold->placed[i])
      hold->queue[tail++] = i;
  while (head < tail) {
    guint32 at = hold->queue[head++];

    for (guint32 e = hold->first[at]; e < hold->first[at + 1]; e++) {
      guint32 to = hold->neighbours[e];
      gdouble sum[3] = { 0 };
      guint n = 0;

      if (hold->placed[to])
        continue;
      for (guint32 d = hold->first[to]; d < hold->first[to + 1]; d++) {
        const gfloat *from = hold->positions + 3 * (gsize) hold->neighbours[d];

        if (!hold->placed[hold->neighbours[d]])
          continue;
        for (guint k = 0; k < 3; k++)
          sum[k] += from[k];
        n++;
      }
      for (guint k = 0; k < 3; k++)
        hold->positions[3 * (gsize) to + k] = (gfloat) (sum[k] / n);
      hold->placed[to] = 1;
      hold->queue[tail++] = to;
    }
  }
  for (gsize i = 0; tail < hold->n_vertices && i < hold->n_vertices; i++) {
    if (hold->placed[i])
      continue;
    hold->positions[3 * i] = hold->uv[2 * i];
    hold->positions[3 * i + 1] = hold->uv[2 * i + 1];
    hold->positions[3 * i + 2] = 0;
  }
}

/* @hold: the filler
 * @positions: the next frame, 3 numbers a vertex, NaN when not seen
 *
 * A vertex not seen stays where it was last seen. One never seen so far takes the
 * mean of its neighbours, from those seen outwards; in a part of the mesh where
 * nothing was seen yet it lies flat at (u, v, 0).
 *
 * Returns: (transfer none): the frame with a place for every vertex; valid until the
 *   next call
 */
const gfloat *
cloth_hold_apply (ClothHold * hold, const gfloat * positions)
{
  for (gsize i = 0; i < hold->n_vertices; i++) {
    if (isnan (positions[3 * i]))
      continue;
    memcpy (hold->positions + 3 * i, positions + 3 * i, 3 * sizeof *positions);
    if (!hold->seen[i]) {
      hold->seen[i] = 1;
      hold->n_never--;
    }
  }
  if (hold->n_never > 0)
    place_never_seen (hold);
  return hold->positions;
}

/* @hold: (transfer full) (nullable): the filler
 */
void
cloth_hold_free (ClothHold * hold)
{
  if (!hold)
    return;
  g_free (hold->uv);
  g_free (hold->positions);
  g_free (hold->seen);
  g_free (hold->first);
  g_free (hold->neighbours);
  g_free (hold->queue);
  g_free (hold->placed);
  g_free (hold);
}
