/* A mesh with holes becomes a whole one, frame by frame.
 *
 * The plate of V. Scholz et al., “Garment Motion Capture Using Color-Coded Patterns” (2005),
 * section 4.4, with four differences that were measured to be worth it (docs/filling.md):
 * the plate has the flat cloth's measures and is free at the cloth's border; what was seen
 * of a place before is kept in the measure in which the cloth around it keeps its shape;
 * the factor of a hole's system stays as long as the hole does; and each vertex says how
 * sure it is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/fill/fill-private.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/mesh/hold.h"

/* Second differences of cloth are not independent: a fold is wider than an edge. By how
 * much the variance grows for it, measured on takes (docs/filling.md): little for a
 * small hole, most of it for one whose variance is beyond WIDE. */
#define CORRELATION 4.0
#define WIDE 0.4
/* Holes are where cloth hides, in folds deeper than around. What the filled cloth lacks of
 * its length, beyond what its surroundings lack, tells: the variance that it adds, for a
 * part of the edges' squares lacking, times the plate's. */
#define HIDDEN 1.0
/* Frame periods after which, when the prediction has ended too, the cloth is met anew. */
#define MOST_STEPS 2

/* @topology: the mesh, checked
 * @seams: (nullable) (element-type ClothSeamLine): vertices that are one: the same place
 *   is found for them
 * @parameters: (nullable): how to fill; %NULL: the defaults
 *
 * Returns: (transfer full): what fills the frames of a sequence
 */
ClothFill *
cloth_fill_new (const ClothTopology * topology, const GArray * seams,
    const ClothFillParameters * parameters)
{
  static const ClothFillParameters standard = {
    CLOTH_FILL_PLATE, CLOTH_FILL_NOISE, CLOTH_FILL_MAX_SIGMA,
    CLOTH_FILL_PREDICTION, CLOTH_FILL_OUTLIER
  };
  ClothFill *self = g_new0 (ClothFill, 1);
  gsize n = topology->n_vertices;

  self->n = topology->n_vertices;
  self->stencils = cloth_stencils_new (topology, seams);
  self->measured = g_new (gfloat, 3 * n);
  self->noise = g_new (gfloat, 6 * n);
  self->positions = g_new (gfloat, 3 * n);
  self->covariances = g_new (gfloat, 6 * n);
  self->states = g_new (guint8, n);
  self->carried = g_new (gfloat, 3 * n);
  self->age = g_new (guint, n);
  self->depth = CLOTH_FILL_HISTORY;
  while (self->depth > 2
      && self->depth * 3 * n * sizeof (gfloat) > CLOTH_FILL_MEMORY)
    self->depth /= 2;
  self->history = g_new (gfloat *, self->depth);
  for (guint i = 0; i < self->depth; i++)
    self->history[i] = g_new (gfloat, 3 * n);
  self->hole_at = g_new0 (ClothHole *, n);
  self->holes = g_ptr_array_new ();
  self->index = g_new (gint, n);
  for (guint i = 0; i < self->n; i++)
    self->index[i] = -1;
  self->queue = g_new (guint, n);
  self->queued = g_new0 (gboolean, n);
  self->wrong = g_new0 (gboolean, n);
  self->work = g_new (gfloat, 4 * n);
  self->numbers = g_array_new (FALSE, FALSE, sizeof (gdouble));
  cloth_fill_set_parameters (self, parameters ? parameters : &standard);
  cloth_fill_reset (self);
  return self;
}

/* @fill: what fills
 * @parameters: how, from the next frame on
 */
void
cloth_fill_set_parameters (ClothFill * fill,
    const ClothFillParameters * parameters)
{
  fill->parameters = *parameters;
}

/* @fill: what fills
 *
 * Returns: (transfer none): the mesh's neighbours and second differences
 */
const ClothStencils *
cloth_fill_get_stencils (const ClothFill * fill)
{
  return fill->stencils;
}

/* @fill: what fills
 *
 * Forgets the past: the next frame has nothing to do with the last one.
 */
void
cloth_fill_reset (ClothFill * fill)
{
  for (guint i = 0; i < fill->n; i++) {
    fill->carried[3 * i] = fill->carried[3 * i + 1] = fill->carried[3 * i + 2] =
        NAN;
    fill->age[i] = CLOTH_FILL_NEVER;
  }
  fill->frames = 0;
  fill->last_s = fill->period_s = NAN;
}

static void
copy_vertex (ClothFill * self, guint from, guint to, gfloat * positions,
    gfloat * covariances)
{
  memcpy (positions + 3 * to, positions + 3 * from, 3 * sizeof (gfloat));
  memcpy (covariances + 6 * to, covariances + 6 * from, 6 * sizeof (gfloat));
  self->states[to] = self->states[from];
}

/* Takes the frame in: what is measured and how well. */
static void
take (ClothFill * self, const ClothMeshFrame * frame)
{
  gfloat variance = (gfloat) (self->parameters.noise_m
      * self->parameters.noise_m);
  const gfloat none[6] = { variance, 0, 0, variance, 0, variance };

  for (guint i = 0; i < self->n; i++) {
    const gfloat *given =
        frame->covariances ? frame->covariances + 6 * i : none;
    gboolean known = TRUE;

    /* what another element filled or predicted was not measured */
    if (frame->states[i] == CLOTH_VERTEX_MEASURED
        || frame->states[i] == CLOTH_VERTEX_TWO_VIEWS)
      memcpy (self->measured + 3 * i, frame->positions + 3 * i,
          3 * sizeof (gfloat));
    else
      self->measured[3 * i] = self->measured[3 * i + 1] =
          self->measured[3 * i + 2] = NAN;
    self->states[i] = isnan (self->measured[3 * i]) ? CLOTH_VERTEX_UNSEEN
        : frame->states[i];
    for (guint c = 0; c < 6; c++)
      known = known && isfinite (given[c]);
    memcpy (self->noise + 6 * i, known ? given : none, 6 * sizeof (gfloat));
  }
  /* of vertices that are one, the first carries what any of them knows */
  for (guint i = 0; i < self->n; i++) {
    guint first = self->stencils->same[i];

    if (first != i && isnan (self->measured[3 * first]))
      copy_vertex (self, i, first, self->measured, self->noise);
  }
}

/* All unknown vertices that second differences connect with @start, ascending in the
 * order in which they are found. */
static guint
grow (ClothFill * self, guint start)
{
  const ClothStencils *stencils = self->stencils;
  guint done = 0, filled = 0;

  self->queue[filled++] = start;
  self->queued[start] = TRUE;
  while (done < filled) {
    guint v = self->queue[done++];

    for (guint i = stencils->of_start[v]; i < stencils->of_start[v + 1]; i++) {
      const ClothStencil *stencil = &stencils->stencils[stencils->of[i]];

      for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++) {
        guint w = stencil->vertex[k];

        if (w != CLOTH_NO_VERTEX && !self->queued[w]
            && isnan (self->measured[3 * w])) {
          self->queued[w] = TRUE;
          self->queue[filled++] = w;
        }
      }
    }
  }
  return filled;
}

/* Finds the frame's holes, keeps those that were there before and factors the others. */
static guint
find_holes (ClothFill * self)
{
  guint factored = 0;

  g_ptr_array_set_size (self->holes, 0);
  for (guint i = 0; i < self->n; i++) {
    ClothHole *hole = self->hole_at[i];
    guint n;

    if (!isnan (self->measured[3 * i]) || self->queued[i]
        || self->stencils->same[i] != i) {
      /* no hole begins here */
      cloth_hole_free (hole);
      self->hole_at[i] = NULL;
      continue;
    }
    n = grow (self, i);
    if (!hole || hole->n != n
        || memcmp (hole->found, self->queue, n * sizeof *self->queue) != 0) {
      cloth_hole_free (hole);
      hole = self->hole_at[i] = cloth_hole_new (self->stencils, n, self->queue,
          self->index);
      factored++;
    }
    g_ptr_array_add (self->holes, hole);
  }
  memset (self->queued, 0, self->n * sizeof *self->queued);
  return factored;
}

static void
set_place (ClothFill * self, guint v, const gdouble place[3],
    const gdouble covariance[6], ClothVertexState state)
{
  gdouble most = self->parameters.max_sigma_m;
  gboolean sure = cloth_fill_trace (covariance) <= 3 * most * most;

  for (guint c = 0; c < 3; c++) {
    sure = sure && isfinite (place[c]);
    self->positions[3 * v + c] = (gfloat) place[c];
  }
  for (guint c = 0; c < 6; c++)
    self->covariances[6 * v + c] = (gfloat) covariance[c];
  self->states[v] = state;
  if (sure)
    return;
  self->states[v] = CLOTH_VERTEX_UNSEEN;
  for (guint c = 0; c < 3; c++)
    self->positions[3 * v + c] = NAN;
  for (guint c = 0; c < 6; c++)
    self->covariances[6 * v + c] = NAN;
}

/* A hole that no ring holds: what it was last, moved on, for a short time. */
static void
predict (ClothFill * self, const ClothHole * hole)
{
  static const gdouble nothing[3] = { NAN, NAN, NAN };
  guint known_age = 0;
  gdouble keeps = 0, motion[6] = { 0, };
  gboolean known = FALSE;

  for (guint i = 0; i < hole->n; i++) {
    guint v = hole->found[i], age = self->age[v], lag;
    const gfloat *last, *before;
    gdouble place[3], covariance[6];

    /* without a past there is no frame rate, no motion and no place */
    if (age == CLOTH_FILL_NEVER || !(age * self->period_s
            <= self->parameters.prediction_s)) {
      set_place (self, v, nothing, motion, CLOTH_VERTEX_UNSEEN);
      continue;
    }
    if (age != known_age) {
      known = cloth_fill_motion (self, age, &keeps, motion);
      known_age = age;
    }
    lag = MIN (age, CLOTH_FILL_HISTORY / 3 - 1);
    last = cloth_fill_past (self, age);
    before = cloth_fill_past (self, age + lag);
    if (!known || !last || isnan (last[3 * v])) {
      set_place (self, v, nothing, motion, CLOTH_VERTEX_UNSEEN);
      continue;
    }
    for (guint c = 0; c < 3; c++) {
      place[c] = last[3 * v + c];
      if (before && !isnan (before[3 * v]))
        place[c] += keeps * age / lag
            * ((gdouble) last[3 * v + c] - before[3 * v + c]);
    }
    for (guint c = 0; c < 6; c++)
      covariance[c] = motion[c] + self->noise[6 * v + c];
    set_place (self, v, place, covariance, CLOTH_VERTEX_PREDICTED);
  }
}

/* Which part of their squared length the edges at @v lack. */
static gdouble
find_lack (const ClothFill * self, guint v)
{
  const ClothStencils *s = self->stencils;
  gdouble sum = 0;
  guint n = 0;

  for (guint i = s->near_start[v]; i < s->near_start[v + 1]; i++) {
    const gfloat *p = self->positions + 3 * v;
    const gfloat *q = self->positions + 3 * s->near[i];
    gdouble x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    gdouble part = (x * x + y * y + z * z) / (s->length[i] * s->length[i]);

    if (!isfinite (part))
      continue;
    sum += fmax (1 - part, 0);
    n++;
  }
  return n > 0 ? sum / n : 0;
}

/* What the plate through @ring (3·n_ring) gives for the hole's vertices. */
static void
fill_hole (ClothFill * self, const ClothHole * hole)
{
  ClothFillShape shape;
  gdouble *ring, *offset, *flat, *moved, *kept, rotation[9], shift[3];
  gdouble persistence = 0, usual = 0;
  guint of_age = CLOTH_FILL_NEVER;

  cloth_fill_shape (self, hole, &shape);
  g_array_set_size (self->numbers, 6 * (hole->n_ring + hole->n) + hole->n);
  ring = (gdouble *) (gpointer) self->numbers->data;
  offset = ring + 3 * hole->n_ring;
  flat = offset + 3 * hole->n_ring;
  moved = flat + 3 * hole->n;
  kept = moved + 3 * hole->n;

  cloth_fill_align (self->carried, self->measured, hole->n_region, hole->region,
      rotation, shift);
  for (guint k = 0; k < hole->n_ring; k++) {
    guint v = hole->ring[k];
    gdouble before[3], after[3];

    for (guint c = 0; c < 3; c++) {
      ring[3 * k + c] = self->measured[3 * v + c];
      before[c] = self->carried[3 * v + c];
    }
    cloth_mat3_vec (rotation, before, after);
    for (guint c = 0; c < 3; c++) {
      gdouble rest = ring[3 * k + c] - after[c] - shift[c];

      /* one that was not known moved with the others */
      offset[3 * k + c] = isnan (rest) ? 0 : rest;
    }
  }
  cloth_hole_solve (hole, ring, flat);
  cloth_hole_solve (hole, offset, moved);
  for (guint i = 0; i < hole->n; i++) {
    guint v = hole->vertices[i];
    gdouble before[3], after[3];

    for (guint c = 0; c < 3; c++)
      before[c] = self->carried[3 * v + c];
    cloth_mat3_vec (rotation, before, after);
    if (self->age[v] != of_age) {
      of_age = self->age[v];
      persistence = cloth_fill_persistence (self, hole, &shape, of_age);
    }
    kept[i] = persistence;
    for (guint c = 0; c < 3; c++) {
      moved[3 * i + c] += after[c] + shift[c];
      if (isnan (moved[3 * i + c]))
        moved[3 * i + c] = flat[3 * i + c];
      flat[3 * i + c] += persistence * (moved[3 * i + c] - flat[3 * i + c]);
      self->positions[3 * v + c] = (gfloat) flat[3 * i + c];
      /* the shape kept, for the next frame */
      self->carried[3 * v + c] = (gfloat) moved[3 * i + c];
    }
  }
  for (guint k = 0; k < hole->n_ring; k++)
    usual += find_lack (self, hole->ring[k]) / hole->n_ring;
  for (guint i = 0; i < hole->n; i++)
    moved[i] = fmax (find_lack (self, hole->vertices[i]) - usual, 0);
  for (guint i = 0; i < hole->n; i++) {
    gdouble variance = hole->variance[i], covariance[6];
    gdouble apart = variance * (1 - kept[i] * kept[i])
        * (1 + CORRELATION * variance / (variance + WIDE));
    gdouble far = hole->leverage[i]
        + kept[i] * kept[i] * (1 + hole->leverage[i]);
    gdouble hidden = HIDDEN * moved[i] * variance
        * self->stencils->edge_m * self->stencils->edge_m;

    for (guint c = 0; c < 6; c++)
      covariance[c] = apart * shape.covariance[c] + far * shape.noise[c];
    covariance[0] += hidden;
    covariance[3] += hidden;
    covariance[5] += hidden;
    if (shape.n == 0)
      flat[3 * i] = NAN;
    set_place (self, hole->vertices[i], flat + 3 * i, covariance,
        CLOTH_VERTEX_FILLED);
  }
}

/* The time since the last frame; a jump in it ends what was known. */
static void
keep_time (ClothFill * self, gdouble time_s)
{
  gdouble step = time_s - self->last_s;

  if (self->frames > 0 && (!(step > 0) || (step > self->parameters.prediction_s
              && step > MOST_STEPS * self->period_s)))
    cloth_fill_reset (self);
  else if (self->frames > 0)
    self->period_s = step;
  self->last_s = time_s;
}

static void
remember (ClothFill * self)
{
  memcpy (self->history[self->frames % self->depth], self->measured,
      3 * sizeof (gfloat) * self->n);
  for (guint i = 0; i < self->n; i++) {
    if (isnan (self->measured[3 * i])) {
      if (self->age[i] < CLOTH_FILL_NEVER - 1)
        self->age[i]++;
    } else {
      self->age[i] = 1;
      memcpy (self->carried + 3 * i, self->measured + 3 * i,
          3 * sizeof (gfloat));
    }
  }
  self->frames++;
}

/* @fill: what fills
 * @time_s: the frame's time, seconds; a frame that isn't later than the last one, or comes
 *   after a gap longer than a prediction, starts a new sequence
 * @frame: the frame as measured; what its states call filled or predicted counts as unseen
 * @filled: (out): the frame with its holes filled, with covariances; valid until the next
 *   call
 * @counts: (out) (optional): what was done
 *
 * Removes outliers, then fills each hole. A vertex leaves as measured or by two views as it
 * came, as filled when a ring of known vertices holds its hole, as predicted when none
 * does but it was seen at most @prediction_s ago, or as unseen.
 *
 * The covariance of a filled vertex is the plate's: second differences around the hole are
 * taken as a sample of those inside. Part of it, what the persistence of the surroundings
 * explains, is known from the past; the noise of the ring is added, and what the filled
 * cloth lacks of its length.
 */
void
cloth_fill_run (ClothFill * fill, gdouble time_s, const ClothMeshFrame * frame,
    ClothMeshFrame * filled, ClothFillCounts * counts)
{
  ClothFillCounts done = { 0, };

  keep_time (fill, time_s);
  take (fill, frame);
  if (fill->parameters.outlier > 0)
    done.outliers = cloth_fill_outliers (fill);
  done.factored = find_holes (fill);
  done.holes = fill->holes->len;
  memcpy (fill->positions, fill->measured, 3 * sizeof (gfloat) * fill->n);
  memcpy (fill->covariances, fill->noise, 6 * sizeof (gfloat) * fill->n);
  for (guint i = 0; i < fill->holes->len; i++) {
    const ClothHole *hole = g_ptr_array_index (fill->holes, i);

    if (!hole->anchored) {
      predict (fill, hole);
    } else {
      fill_hole (fill, hole);
      if (fill->parameters.method == CLOTH_FILL_BILAPLACIAN)
        cloth_fill_bilaplacian (fill, hole);
    }
  }
  remember (fill);
  for (guint i = 0; i < fill->n; i++) {
    if (fill->stencils->same[i] != i)
      copy_vertex (fill, fill->stencils->same[i], i, fill->positions,
          fill->covariances);
    done.filled += fill->states[i] == CLOTH_VERTEX_FILLED;
    done.predicted += fill->states[i] == CLOTH_VERTEX_PREDICTED;
    done.unseen += fill->states[i] == CLOTH_VERTEX_UNSEEN;
  }
  filled->positions = fill->positions;
  filled->states = fill->states;
  filled->covariances = fill->covariances;
  if (counts)
    *counts = done;
}

/* @topology: the mesh
 * @seams: (element-type ClothSeamLine) (nullable): what is sewn together
 * @noise_m: standard deviation of a coordinate, metres; 0: not known
 * @start: (nullable): places that the cloth may begin at, 3 numbers a vertex, metres
 * @positions: (inout): one frame, 3 numbers a vertex, metres, NaN when not seen
 *
 * Gives what was not seen a place to begin at: thin plates close the holes; where no plate
 * can, neighbours do, as cloth_hold_apply () says: with their places, or, with @start, as far from it as they are.
 */
void
cloth_fill_close (const ClothTopology * topology, const GArray * seams,
    gdouble noise_m, const gdouble * start, gfloat * positions)
{
  const gsize n = topology->n_vertices;
  const ClothFillParameters parameters = { CLOTH_FILL_PLATE,
    noise_m > 0 ? noise_m : CLOTH_FILL_NOISE, CLOTH_FILL_MAX_SIGMA, 0., 0.
  };
  g_autoptr (ClothFill) fill = cloth_fill_new (topology, seams, &parameters);
  g_autoptr (ClothHold) hold = cloth_hold_new (topology);
  g_autofree gfloat *off = g_new (gfloat, 3 * n);
  g_autofree guint8 *states = g_malloc (n);
  ClothMeshFrame from = { positions, states, NULL }, to = { NULL };
  const gfloat *closed;

  for (gsize i = 0; i < n; i++)
    states[i] = isnan (positions[3 * i]) ? CLOTH_VERTEX_UNSEEN :
        CLOTH_VERTEX_MEASURED;
  cloth_fill_run (fill, 0., &from, &to, NULL);
  for (gsize i = 0; i < 3 * n; i++)
    off[i] = to.positions[i] - (start ? (gfloat) start[i] : 0.f);
  closed = cloth_hold_apply (hold, off);
  for (gsize i = 0; i < 3 * n; i++)
    if (isnan (positions[i]))
      positions[i] = closed[i] + (start ? (gfloat) start[i] : 0.f);
}

/* @fill: (transfer full) (nullable): what fills
 */
void
cloth_fill_free (ClothFill * fill)
{
  if (!fill)
    return;
  cloth_stencils_free (fill->stencils);
  g_free (fill->measured);
  g_free (fill->noise);
  g_free (fill->positions);
  g_free (fill->covariances);
  g_free (fill->states);
  g_free (fill->carried);
  g_free (fill->age);
  for (guint i = 0; i < fill->depth; i++)
    g_free (fill->history[i]);
  g_free (fill->history);
  for (guint i = 0; i < fill->n; i++)
    cloth_hole_free (fill->hole_at[i]);
  g_free (fill->hole_at);
  g_ptr_array_unref (fill->holes);
  g_free (fill->index);
  g_free (fill->queue);
  g_free (fill->queued);
  g_free (fill->wrong);
  g_free (fill->work);
  g_array_unref (fill->numbers);
  g_free (fill);
}

/* Laplacian smoothing of the same paper, section 4.4: p + w L(p), with the neighbours that
 * hole filling has, or the frames before and after. */

/* @stencils: the mesh's
 * @weight: part of the way to the mean of its neighbours that a vertex goes, 0 to 1
 * @positions: 3 numbers a vertex, metres, NaN when not seen
 * @smoothed: (out): the same, smoothed; a vertex with a neighbour that isn't seen stays
 *
 * The neighbours are those on both sides of a vertex, of a vertex at the border those
 * along it: the mean of all would draw it in.
 */
void
cloth_smooth_space (const ClothStencils * stencils, gdouble weight,
    const gfloat * positions, gfloat * smoothed)
{
  for (guint v = 0; v < stencils->n_vertices; v++) {
    guint n = stencils->line_start[v + 1] - stencils->line_start[v];
    gdouble sum[3] = { 0, };

    for (guint i = stencils->line_start[v]; i < stencils->line_start[v + 1];
        i++)
      for (guint c = 0; c < 3; c++)
        sum[c] += positions[3 * stencils->line[i] + c];
    for (guint c = 0; c < 3; c++) {
      gdouble p = positions[3 * v + c], way = weight * (sum[c] / n - p);

      smoothed[3 * v + c] = (gfloat) (isfinite (way) ? p + way : p);
    }
  }
}

/* @n_vertices: number of vertices
 * @weight: part of the way to the mean of the frames beside that a vertex goes, 0 to 1
 * @before: positions of the frame before
 * @after: positions of the frame after, as far away in time
 * @positions: (inout): positions of the frame; a vertex that either doesn't see stays
 */
void
cloth_smooth_time (guint n_vertices, gdouble weight, const gfloat * before,
    const gfloat * after, gfloat * positions)
{
  for (gsize i = 0; i < 3 * (gsize) n_vertices; i++) {
    gdouble p = positions[i];
    gdouble way = weight * (((gdouble) before[i] + after[i]) / 2 - p);

    if (isfinite (way))
      positions[i] = (gfloat) (p + way);
  }
}
