/* Vertices that neither their neighbours nor their past agree with.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/fill/fill-private.h"

#include <math.h>
#include <string.h>

/* Fewer neighbours than this say nothing of what is usual. */
#define LEAST_PEERS 4
/* Neighbours of neighbours that the usual deviation is taken from, at most. */
#define MOST_PEERS 24
/* Removing the worst makes its neighbours look better: how often to look again. */
#define ROUNDS 3
/* A median of lengths of normal vectors of three dimensions, in standard deviations. */
#define MEDIAN_LENGTH 1.538

/* How far @v lies from the middle of the neighbours on either side of it, in the mean of
 * its lines; with @past the same less what it was there. FALSE when no line was seen. */
static gboolean
deviate (const ClothFill * self, const gfloat * past, guint v,
    gfloat deviation[3])
{
  const ClothStencils *stencils = self->stencils;
  const gfloat *now = self->measured;
  gfloat sum[3] = { 0, };
  guint n = 0;

  for (guint i = stencils->line_start[v]; i < stencils->line_start[v + 1];
      i += 2) {
    guint a = 3 * stencils->line[i], b = 3 * stencils->line[i + 1];

    if (isnan (now[a] + now[b]) || (past && isnan (past[a] + past[b])))
      continue;
    for (guint c = 0; c < 3; c++)
      sum[c] +=
          now[a + c] + now[b + c] - (past ? past[a + c] + past[b + c] : 0);
    n += 2;
  }
  for (guint c = 0; c < 3; c++)
    deviation[c] = now[3 * v + c] - (past ? past[3 * v + c] : 0)
        - sum[c] / (gfloat) MAX (n, 1);
  return n > 0 && !isnan (deviation[0]);
}

static gint
compare (gconstpointer a, gconstpointer b)
{
  gfloat x = *(const gfloat *) a, y = *(const gfloat *) b;

  return (x > y) - (x < y);
}

/* The usual length of what is in @length around @v, without it. */
static gdouble
usual (const ClothFill * self, const gfloat * length, guint v)
{
  const ClothStencils *stencils = self->stencils;
  gfloat peers[MOST_PEERS];
  guint n = 0;

  for (guint i = stencils->near_start[v]; i < stencils->near_start[v + 1]; i++) {
    guint w = stencils->near[i];

    for (guint j = stencils->near_start[w];
        j < stencils->near_start[w + 1] && n < MOST_PEERS; j++)
      if (stencils->near[j] != v && !isnan (length[stencils->near[j]]))
        peers[n++] = length[stencils->near[j]];
  }
  if (n < LEAST_PEERS)
    return INFINITY;
  qsort (peers, n, sizeof *peers, compare);
  return peers[n / 2] / MEDIAN_LENGTH;
}

/* By how many times the usual each vertex deviates, into @score; NaN where not known. */
static void
score (ClothFill * self, const gfloat * past, gfloat * length, gfloat * score)
{
  for (guint v = 0; v < self->n; v++) {
    gfloat d[3];

    length[v] = NAN;
    if (!isnan (self->measured[3 * v]) && deviate (self, past, v, d))
      length[v] = sqrtf (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }
  for (guint v = 0; v < self->n; v++) {
    gdouble noise, scale;

    score[v] = NAN;
    if (isnan (length[v]))
      continue;
    noise = (self->noise[6 * v] + self->noise[6 * v + 3]
        + self->noise[6 * v + 5]) / 3 * (past ? 2 : 1);
    /* a cheap bound first: nothing can be usual below the noise */
    if (length[v] <= self->parameters.outlier * sqrt (noise)) {
      score[v] = 0;
      continue;
    }
    scale = usual (self, length, v);
    if (past)
      scale *= sqrt (self->age[v]);
    score[v] = (gfloat) (length[v] / sqrt (scale * scale + noise));
  }
}

/* @self: the frame
 *
 * A vertex is removed when it deviates from the mean of its neighbours more than the
 * threshold times what is usual around it, and so does the change of that since it was
 * last seen: a sharp fold is no outlier, since it was there before, and neither is a fast
 * place, since its neighbours go along. Without a past, space decides alone. What was not
 * seen for k frames may change k times as much.
 *
 * Returns: number of vertices removed
 */
guint
cloth_fill_outliers (ClothFill * self)
{
  gfloat *length = self->work, *in_space = length + self->n;
  gfloat *in_time = in_space + self->n;
  gfloat limit = (gfloat) self->parameters.outlier;
  guint removed = 0;

  for (guint round = 0; round < ROUNDS; round++) {
    guint found = 0;

    score (self, NULL, length, in_space);
    score (self, self->carried, length, in_time);
    for (guint v = 0; v < self->n; v++) {
      const ClothStencils *s = self->stencils;
      gboolean worst = in_space[v] > limit && !(in_time[v] <= limit);

      /* the worst of its neighbourhood, for it spoils the others */
      for (guint i = s->near_start[v]; worst && i < s->near_start[v + 1]; i++) {
        guint w = s->near[i];

        worst = !(in_space[w] > in_space[v] && in_space[w] > limit
            && !(in_time[w] <= limit));
      }
      self->wrong[v] = worst;
    }
    for (guint v = 0; v < self->n; v++) {
      if (!self->wrong[v])
        continue;
      self->measured[3 * v] = self->measured[3 * v + 1] =
          self->measured[3 * v + 2] = NAN;
      self->states[v] = CLOTH_VERTEX_UNSEEN;
      found++;
    }
    removed += found;
    if (found == 0)
      break;
  }
  return removed;
}
