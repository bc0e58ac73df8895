/* Whether cloth goes through itself: all pairs of triangles, exactly.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <math.h>
#include <string.h>

#include "gst/mesh/topology.h"

/* Triangles of the simulated mesh: quads of several sheets are cut along the first
 * diagonal, those of a grid along alternating ones. */
static guint32 *
triangles_of (const ClothTopology * t, guint * n)
{
  guint32 *corners = g_new (guint32, 6 * t->n_faces);

  *n = 2 * t->n_faces;
  for (guint i = 0; i < t->n_faces; i++) {
    const guint32 *q = t->faces + 4 * i;
    guint odd = t->columns > 1 &&
        (i / (t->columns - 1) + i % (t->columns - 1)) % 2;
    guint32 both[6] = { q[odd], q[1 + odd], q[2 + odd], q[odd], q[2 + odd],
      q[(3 + odd) % 4]
    };

    memcpy (corners + 6 * i, both, sizeof both);
  }
  return corners;
}

typedef __int128 Wide;

/* Which side of the plane of abc d is on, exactly: of points on a grid of 2⁻³⁰ m. */
static gint
side (const gint64 * a, const gint64 * b, const gint64 * c, const gint64 * d)
{
  gint64 p[3], q[3], r[3];
  Wide volume;

  for (guint k = 0; k < 3; k++) {
    p[k] = a[k] - d[k];
    q[k] = b[k] - d[k];
    r[k] = c[k] - d[k];
  }
  volume = p[0] * ((Wide) q[1] * r[2] - (Wide) q[2] * r[1]) +
      p[1] * ((Wide) q[2] * r[0] - (Wide) q[0] * r[2]) +
      p[2] * ((Wide) q[0] * r[1] - (Wide) q[1] * r[0]);
  return (volume > 0) - (volume < 0);
}

/* Whether the line pq goes through the inside of the triangle. */
static gboolean
pierces (const gint64 * p, const gint64 * q, const gint64 * const t[3])
{
  gint turn;

  if (side (t[0], t[1], t[2], p) * side (t[0], t[1], t[2], q) >= 0)
    return FALSE;
  turn = side (p, q, t[0], t[1]);
  return turn != 0 && side (p, q, t[1], t[2]) == turn
      && side (p, q, t[2], t[0]) == turn;
}

/* Pairs of triangles without common corners of which an edge of one pierces the other. */
static guint
count_crossings (const ClothTopology * topology, const gdouble * x)
{
  guint n, crossings = 0;
  g_autofree guint32 *corners = triangles_of (topology, &n);
  g_autofree gint64 *grid = g_new (gint64, 3 * topology->n_vertices);

  for (guint i = 0; i < 3 * topology->n_vertices; i++)
    grid[i] = llround (ldexp (x[i], 30));
  for (guint i = 0; i < n; i++) {
    for (guint j = 0; j < i; j++) {
      const guint32 *c[2] = { corners + 3 * i, corners + 3 * j };
      const gint64 *t[2][3];
      gboolean apart = FALSE, common = FALSE, crosses = FALSE;

      for (guint k = 0; k < 3; k++) {
        t[0][k] = grid + 3 * c[0][k];
        t[1][k] = grid + 3 * c[1][k];
        for (guint m = 0; m < 3; m++)
          common |= c[0][k] == c[1][m];
      }
      for (guint k = 0; k < 3; k++)
        for (guint s = 0; s < 2; s++)
          apart |= MAX (MAX (t[s][0][k], t[s][1][k]), t[s][2][k]) <
              MIN (MIN (t[!s][0][k], t[!s][1][k]), t[!s][2][k]);
      if (common || apart)
        continue;
      for (guint k = 0; k < 3; k++)
        crosses |= pierces (t[0][k], t[0][(k + 1) % 3], t[1])
            || pierces (t[1][k], t[1][(k + 1) % 3], t[0]);
      crossings += crosses;
    }
  }
  return crossings;
}
