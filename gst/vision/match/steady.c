/* The mean of the pictures in which a vertex stands still, by their information.
 *
 * The test is that of two independent estimates of one place: their difference has the sum of
 * both covariances (Y. Bar-Shalom et al., “Estimation with Applications to Tracking and
 * Navigation”, 2001, section 1.5.3).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/steady.h"

#include <math.h>

/* χ² of 2 degrees of freedom that 95% of still vertices stay below. */
#define CHI2 5.991

/* @x: place, px
 * @i: information, the inverse of the covariance: xx, xy, yy, 1/px²
 */
typedef struct
{
  gdouble x[2], i[3];
} Sample;

/* @n: pictures that are averaged
 * @next: where the next one goes
 * @mirrored: of all of them
 */
typedef struct
{
  guint n, next;
  gboolean mirrored;
} Run;

struct _ClothSteady
{
  guint n_vertices, most;
  Run *runs;
  Sample *samples;              /* most a vertex */
};

/* @n_vertices: of the grid
 * @most: pictures that are averaged, 1 to %CLOTH_STEADY_MAX
 *
 * Returns: (transfer full): the memory of one camera's pictures, for one thread at a time
 */
ClothSteady *
cloth_steady_new (guint n_vertices, guint most)
{
  ClothSteady *self = g_new (ClothSteady, 1);

  self->n_vertices = n_vertices;
  self->most = CLAMP (most, 1, CLOTH_STEADY_MAX);
  self->runs = g_new0 (Run, n_vertices);
  self->samples = g_new (Sample, (gsize) n_vertices * self->most);
  return self;
}

/* @steady: (nullable) (transfer full): what to free
 */
void
cloth_steady_free (ClothSteady * steady)
{
  if (!steady)
    return;
  g_free (steady->runs);
  g_free (steady->samples);
  g_free (steady);
}

/* @steady: forgets all pictures
 */
void
cloth_steady_reset (ClothSteady * steady)
{
  for (guint v = 0; v < steady->n_vertices; v++)
    steady->runs[v].n = steady->runs[v].next = 0;
}

/* Inverse of the symmetric matrix xx, xy, yy; FALSE: it isn't positive definite. */
static gboolean
invert (const gdouble m[3], gdouble inverse[3])
{
  const gdouble det = m[0] * m[2] - m[1] * m[1];

  if (!(m[0] > 0 && det > 0 && isfinite (det)))
    return FALSE;
  inverse[0] = m[2] / det;
  inverse[1] = -m[1] / det;
  inverse[2] = m[0] / det;
  return isfinite (inverse[0]) && isfinite (inverse[1])
      && isfinite (inverse[2]);
}

/* The mean of @n samples weighted by their information, and its covariance. Places are taken
 * from the first one, so that nothing is lost of them. */
static gboolean
average (const Sample * samples, guint n, gdouble mean[2],
    gdouble covariance[3])
{
  gdouble sum[3] = { 0 }, weighted[2] = { 0 };

  for (guint k = 0; k < n; k++) {
    const Sample *s = &samples[k];
    const gdouble x = s->x[0] - samples[0].x[0], y = s->x[1] - samples[0].x[1];

    for (guint c = 0; c < 3; c++)
      sum[c] += s->i[c];
    weighted[0] += s->i[0] * x + s->i[1] * y;
    weighted[1] += s->i[1] * x + s->i[2] * y;
  }
  if (!invert (sum, covariance))
    return FALSE;
  mean[0] = samples[0].x[0] + covariance[0] * weighted[0]
      + covariance[1] * weighted[1];
  mean[1] = samples[0].x[1] + covariance[1] * weighted[0]
      + covariance[2] * weighted[1];
  return TRUE;
}

static gboolean
differs (const ClothGridVertex * vertex, const gdouble mean[2],
    const gdouble covariance[3])
{
  const gdouble sum[3] = { vertex->xx + covariance[0],
    vertex->xy + covariance[1], vertex->yy + covariance[2]
  };
  const gdouble dx = vertex->x - mean[0], dy = vertex->y - mean[1];
  gdouble i[3];

  return !invert (sum, i)
      || !(i[0] * dx * dx + 2 * i[1] * dx * dy + i[2] * dy * dy <= CHI2);
}

/* @steady: what was seen before
 * @vertices: (inout) (array): of the next picture: place and covariance become those of the
 *   mean
 *
 * A vertex's run of pictures ends where it isn't seen, is seen from the other side, or differs
 * by more than chance from the mean of the run; then its place is that of this picture alone.
 * Errors that all pictures of a run have in common are not averaged out, and the covariance of
 * the mean doesn't know them.
 */
void
cloth_steady_run (ClothSteady * steady, ClothGridVertex * vertices)
{
  for (guint v = 0; v < steady->n_vertices; v++) {
    ClothGridVertex *vertex = &vertices[v];
    Run *run = &steady->runs[v];
    Sample *samples = steady->samples + (gsize) v * steady->most;
    const gdouble covariance[3] = { vertex->xx, vertex->xy, vertex->yy };
    gdouble mean[2], of_mean[3];
    Sample sample = { {vertex->x, vertex->y}, {0} };

    if (vertex->state == CLOTH_GRID_UNSEEN || !isfinite (vertex->x)
        || !isfinite (vertex->y) || !invert (covariance, sample.i)) {
      run->n = run->next = 0;
      continue;
    }
    if (run->n && (run->mirrored != vertex->mirrored
            || !average (samples, run->n, mean, of_mean)
            || differs (vertex, mean, of_mean)))
      run->n = run->next = 0;
    run->mirrored = vertex->mirrored;
    samples[run->next] = sample;
    run->next = (run->next + 1) % steady->most;
    run->n = MIN (run->n + 1, steady->most);
    if (average (samples, run->n, mean, of_mean)) {
      vertex->x = mean[0];
      vertex->y = mean[1];
      vertex->xx = of_mean[0];
      vertex->xy = of_mean[1];
      vertex->yy = of_mean[2];
    }
  }
}
