/* A recording of a fine grid as one of a coarse grid.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/recording/recording.h"

/* Where line @i of @n lies among @all: the line below and how far it is beyond. */
static guint
find_line (guint i, guint n, guint all, gdouble * beyond)
{
  gdouble at = (gdouble) i * (all - 1) / (n - 1);
  guint line = MIN ((guint) at, all - 2);

  *beyond = at - line;
  return line;
}

/* Between the four vertices about each, frame by frame. */
static void
interpolate (const ClothRecording * from, ClothRecording * to)
{
  const ClothTopology *a = from->scene->topology, *b = to->scene->topology;

  for (guint row = 0; row < b->rows; row++)
    for (guint column = 0; column < b->columns; column++) {
      gdouble u, v;
      guint i = find_line (column, b->columns, a->columns, &u);
      guint first = find_line (row, b->rows, a->rows, &v) * a->columns + i;

      for (guint frame = 0; frame < to->n_frames; frame++) {
        const gdouble *y = from->y + 3 * ((gsize) frame * from->n + first);
        gdouble *p = to->y + 3 * ((gsize) frame * to->n + row * b->columns +
            column);

        for (guint k = 0; k < 3; k++)
          p[k] = (1. - v) * ((1. - u) * y[k] + u * y[3 + k]) +
              v * ((1. - u) * y[3 * a->columns + k] +
              u * y[3 * a->columns + 3 + k]);
      }
    }
}

/* Clamps hold the nearest vertices, each but one. */
static void
hold (const ClothScene * from, ClothScene * to)
{
  const ClothTopology *a = from->topology, *b = to->topology;
  g_autofree guint *of = g_new (guint, from->held->len + 1);

  for (guint i = 0; i < from->held->len; i++) {
    ClothHeld held = g_array_index (from->held, ClothHeld, i);
    guint column = (guint) round ((gdouble) (held.vertex % a->columns) *
        (b->columns - 1) / (a->columns - 1));
    guint row = (guint) round ((gdouble) (held.vertex / a->columns) *
        (b->rows - 1) / (a->rows - 1));
    gboolean taken = FALSE;

    held.vertex = row * b->columns + column;
    for (guint k = 0; k < to->held->len; k++)
      taken = taken
          || g_array_index (to->held, ClothHeld, k).vertex == held.vertex;
    if (taken)
      continue;
    of[to->held->len] = i;
    g_array_append_val (to->held, held);
  }
  to->clamps = g_new (gdouble, 3 * (gsize) from->n_frames * to->held->len + 1);
  for (guint frame = 0; frame < from->n_frames; frame++)
    for (guint i = 0; i < to->held->len; i++)
      memcpy (to->clamps + 3 * ((gsize) frame * to->held->len + i),
          from->clamps + 3 * ((gsize) frame * from->held->len + of[i]),
          3 * sizeof (gdouble));
}

/* @recording: a recording
 * @most: lines that are enough along u and along v, at least 2
 *
 * The noise becomes less by the root of the vertices, so that the features' square over
 * the noise stays what it was. Everything counts as seen; velocities are not filled.
 *
 * Returns: (transfer full) (nullable): the same on a coarser grid; %NULL when it is no
 *   grid, or none that is finer, or has seams
 */
ClothRecording *
cloth_recording_resample (const ClothRecording * recording, guint most)
{
  const ClothScene *scene = recording->scene;
  const ClothTopology *t = scene->topology;
  gsize last = t->n_vertices - 1;
  guint columns = MIN (t->columns, most), rows = MIN (t->rows, most);
  ClothRecording *r;

  if (!t->columns || scene->seams->len
      || (columns == t->columns && rows == t->rows))
    return NULL;
  r = g_new0 (ClothRecording, 1);
  r->name = g_strdup (recording->name);
  r->n = columns * rows;
  r->n_frames = recording->n_frames;
  r->times = g_memdup2 (recording->times, r->n_frames * sizeof (gdouble));
  r->sigma = recording->sigma * sqrt ((gdouble) r->n / recording->n);
  r->scene = cloth_scene_new (cloth_topology_new_grid (columns, rows,
          t->uv[2 * last] - t->uv[0], t->uv[2 * last + 1] - t->uv[1]),
      scene->fps, scene->n_frames);
  memcpy (r->scene->times, scene->times, scene->n_frames * sizeof (gdouble));
  memcpy (r->scene->gravity, scene->gravity, sizeof scene->gravity);
  g_array_unref (r->scene->obstacles);
  r->scene->obstacles = cloth_obstacles_copy (scene->obstacles);
  hold (scene, r->scene);
  r->y = g_new (gdouble, 3 * (gsize) r->n * r->n_frames);
  interpolate (recording, r);
  return r;
}
