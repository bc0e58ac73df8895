/* What the windows of a free simulation give to the result: where, when, how it looked.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/fill.h"

#include <math.h>

static void
fill_playback (const ClothWindowedGap * before, const ClothWindowedGap * after,
    const ClothRecording * r, ClothTake * take, ClothGapPlayback * p)
{
  gsize all = (gsize) r->n * r->n_frames;

  p->take = g_strdup (r->name);
  p->topology = cloth_topology_copy (cloth_take_get_topology (take));
  p->n_frames = r->n_frames;
  p->times = g_memdup2 (r->times, r->n_frames * sizeof *r->times);
  p->recorded = g_new (gfloat, 3 * all);
  for (gsize i = 0; i < all; i++)
    for (guint k = 0; k < 3; k++)
      p->recorded[3 * i + k] = r->seen[i] > 0. ? (gfloat) r->y[3 * i + k] : NAN;
  p->before = g_memdup2 (before->positions, 3 * all * sizeof (gfloat));
  if (after)
    p->after = g_memdup2 (after->positions, 3 * all * sizeof (gfloat));
}

static void
fill_series (const ClothWindowedGap * before, const ClothWindowedGap * after,
    const ClothRecording * r, ClothGapSeries * s)
{
  g_autofree gboolean *one = g_new0 (gboolean, before->n_windows);
  g_autofree guint *counts = g_new0 (guint, before->n_windows);

  s->n = before->n_windows;
  s->times = g_new0 (gdouble, s->n);
  s->before = g_new (gdouble, s->n);
  s->after = after ? g_new (gdouble, s->n) : NULL;
  for (guint frame = 1; frame < before->n_frames; frame++) {
    s->times[before->window[frame]] += r->times[frame];
    counts[before->window[frame]]++;
  }
  for (guint w = 0; w < s->n; w++) {
    one[w] = TRUE;
    s->times[w] /= counts[w];
    s->before[w] = sqrt (cloth_windowed_gap_square (before, one));
    if (after)
      s->after[w] = sqrt (cloth_windowed_gap_square (after, one));
    one[w] = FALSE;
  }
}

/* @before: distances without the accepted effects
 * @after: (nullable): with them
 * @recording: what they are of
 * @take: its take
 * @result: (inout): gets the shares of vertices, frames and directions, what @after
 *   gains, the series and the playback
 */
void
cloth_windowed_gap_fill (const ClothWindowedGap * before,
    const ClothWindowedGap * after, const ClothRecording * recording,
    ClothTake * take, ClothGapResult * result)
{
  gdouble sum = 0., along = 0.;
  g_autofree gboolean *seen = g_new0 (gboolean, before->n);
  g_autofree gdouble *left = g_new0 (gdouble, before->n);

  result->n_vertices = before->n;
  result->n_frames = before->n_frames;
  result->vertices = g_new0 (gdouble, before->n);
  result->frames = g_new0 (gdouble, before->n_frames);
  for (guint frame = 1; frame < before->n_frames; frame++)
    for (guint v = 0; v < before->n; v++) {
      gsize at = (gsize) frame * before->n + v;
      gdouble square = before->squares[at];

      if (!isfinite (square))
        continue;
      seen[v] = TRUE;
      result->vertices[v] += square;
      left[v] += after ? after->squares[at] : 0.;
      result->frames[frame] += square;
      sum += square;
    }
  for (guint v = 0; v < before->n; v++)
    result->vertices[v] = seen[v] ? result->vertices[v] / sum : NAN;
  result->gained = after ? g_new (gdouble, before->n) : NULL;
  for (guint v = 0; v < before->n && after; v++)
    result->gained[v] = result->vertices[v] - left[v] / sum;
  for (guint frame = 0; frame < before->n_frames; frame++)
    result->frames[frame] /= sum;
  for (guint a = 0; a < 3; a++)
    along += before->directions[a];
  for (guint a = 0; a < 3; a++)
    result->directions[a] = along > 0. ? before->directions[a] / along : NAN;
  fill_series (before, after, recording, &result->series);
  fill_playback (before, after, recording, take, &result->playback);
}
