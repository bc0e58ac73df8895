/* What a model might lack, as directions in which to change it.
 *
 * Model: θ are the model's free numbers (their logarithms, if only positive ones are allowed)
 *   and the parameters of effects, which are 0 in the model: their null.
 * Assumption: priors are independent Gaussian; that of an effect's parameter is stated with the
 *   effect, that of a logarithm is 1.2. Parameters that mean nothing at the null, such as the
 *   height of a knee, are fixed at values to try, one candidate each. A clamp slips when its
 *   vertex jumps most against the clamp's path: the largest χ² of two means of five frames,
 *   if beyond 6².
 *   What is there or not has no derivative: its column is what it changes when it is there. A trial
 *   of axes or labels must bring what is held nearer to its clamps, or not further off than noise.
 *   A floor that nobody stated lies where the cloth comes lowest.
 * Formula: finite differences are 0.4 priors of an effect, 0.2 of a free number to each side.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/candidates.h"

#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "gst/fit/error.h"
#include "gst/math/vec3.h"

/* Finite differences are this share of a prior: variability adds the same to every step, so a
 * short one would drown in it. */
#define STEP 0.4
#define FREE_STEP 0.2
/* Prior of the logarithm of a stiffness or damping, half of an order of magnitude. */
#define LOG_PRIOR 1.2
/* A clamp that is off its path by this many standard deviations of a mean of frames. */
#define SLIP_SIGMAS 6.
#define SLIP_FRAMES 5
/* A trial of axes or labels may put what is held so much further off its clamps. */
#define TRIAL_SIGMAS 6.
/* The lowest place of the cloth is a mean over so many frames. */
#define FLOOR_FRAMES 5

static void
clear_direction (gpointer item)
{
  g_free (((ClothDirection *) item)->name);
}

/* Returns: (transfer full): room for candidates, none yet */
ClothCandidates *
cloth_candidates_new_empty (void)
{
  ClothCandidates *c = g_new0 (ClothCandidates, 1);

  c->directions = g_array_new (FALSE, FALSE, sizeof (ClothDirection));
  g_array_set_clear_func (c->directions, clear_direction);
  c->list = g_array_new (FALSE, FALSE, sizeof (ClothCandidate));
  return c;
}

static gboolean
is_free (const ClothModel * model, const gchar * name)
{
  for (guint i = 0; i < model->free->len; i++)
    if (strcmp (g_array_index (model->free, ClothModelFree, i).name, name) == 0)
      return TRUE;
  return FALSE;
}

static gboolean
add_free (ClothCandidates * c, const ClothModel * model, GError ** error)
{
  for (guint i = 0; i < model->free->len; i++) {
    const ClothModelFree *f = &g_array_index (model->free, ClothModelFree, i);
    ClothDirection d = { NULL };

    if (!cloth_model_get (model, f->name, &d.centre, error))
      return FALSE;
    d.name = g_strdup (f->name);
    d.logarithmic = f->range[0] > 0. && d.centre > 0.;
    d.low = f->range[0];
    d.high = f->range[1];
    if (d.logarithmic) {
      d.centre = log (d.centre);
      d.low = log (d.low);
      d.high = log (d.high);
      d.prior = LOG_PRIOR;
    } else {
      d.prior = (d.high - d.low) / 4.;
    }
    d.fit_low = d.low;
    d.fit_high = d.high;
    d.step = FREE_STEP * d.prior;
    g_array_append_val (c->directions, d);
  }
  c->n_free = c->directions->len;
  return TRUE;
}

static ClothCandidate
start (const ClothCandidates * c, const ClothEffect * effect)
{
  ClothCandidate candidate = { effect };

  for (guint k = 0; k < effect->n_parameters; k++)
    candidate.values[k] = effect->parameters[k].null_value;
  candidate.first = c->directions->len;
  return candidate;
}

static void
add_direction (ClothCandidates * c, ClothCandidate * candidate, guint k)
{
  const ClothEffectParameter *p = &candidate->effect->parameters[k];
  ClothDirection d = { NULL };

  d.name = g_strdup_printf ("effects.%s.%s", candidate->effect->id, p->name);
  d.centre = candidate->values[k];
  d.shapes = p->shapes;
  d.prior = p->prior;
  d.step = STEP * p->prior;
  d.one_sided = p->one_sided;
  d.low = d.fit_low = p->min;
  d.high = d.fit_high = p->max;
  g_array_append_val (c->directions, d);
  candidate->parameters[candidate->n++] = k;
}

/* One candidate for each value that a shaping parameter is tried at. */
static void
add_plain (ClothCandidates * c, const ClothEffect * effect)
{
  guint n = 1;

  for (guint k = 0; k < effect->n_parameters; k++)
    n = MAX (n, effect->parameters[k].n_tried);
  for (guint i = 0; i < n; i++) {
    ClothCandidate candidate = start (c, effect);

    for (guint k = 0; k < effect->n_parameters; k++) {
      const ClothEffectParameter *p = &effect->parameters[k];

      if (!p->shapes)
        add_direction (c, &candidate, k);
      else if (p->n_tried)
        candidate.values[k] = p->tried[MIN (i, p->n_tried - 1)];
    }
    for (guint k = 0; k < effect->n_parameters; k++)
      if (effect->parameters[k].shapes)
        add_direction (c, &candidate, k);
    g_array_append_val (c->list, candidate);
  }
}

/* One candidate for the effect as it is tried. */
static void
add_present (ClothCandidates * c, ClothCandidate * candidate)
{
  ClothDirection d = {.present = TRUE,.step = 1.,.prior = 1.,.one_sided =
        TRUE,.high = 1.,.fit_high = 1.
  };

  d.name = g_strdup_printf ("effects.%s", candidate->effect->id);
  g_array_append_val (c->directions, d);
  candidate->n = 1;
  g_array_append_val (c->list, *candidate);
}

/* Mean square of what is held from its clamps, m²; NaN when nothing was seen. */
static gdouble
find_clamps_square (const ClothRecording * r)
{
  const GArray *held = r->scene->held;
  gdouble sum = 0., n = 0.;

  for (guint i = 0; i < held->len; i++) {
    const ClothHeld *h = &g_array_index (held, ClothHeld, i);

    for (guint f = 0; f < r->n_frames; f++) {
      const gsize at = (gsize) f * r->n + h->vertex;
      gdouble off[3];

      if (r->seen[at] == 0. || !cloth_held_holds (h, r->times[f]))
        continue;
      cloth_vec3_subtract (r->y + 3 * at, r->scene->clamps +
          3 * ((gsize) f * held->len + i), off);
      sum += cloth_vec3_dot (off, off);
      n++;
    }
  }
  return sum / n;
}

/* NULL when the recording may be wrong as the candidate has it, else why not. */
static const gchar *
why_not_wrong (const ClothCandidate * candidate, const ClothRecording * r)
{
  g_autoptr (ClothRecording) corrected = NULL;
  g_autofree gchar *fault = NULL;
  const gdouble furthest = TRIAL_SIGMAS * r->sigma;
  gdouble off, then;
  ClothMeasurement m;

  cloth_measurement_init (&m);
  cloth_measurement_add_effect (&m, candidate->effect, candidate->values);
  fault = cloth_measurement_find_fault (&m, r->scene->topology);
  if (fault)
    return "The cloth is no grid on which labels could be exchanged.";
  corrected = cloth_recording_correct (r, &m);
  off = sqrt (find_clamps_square (r));
  then = sqrt (find_clamps_square (corrected));
  if (isnan (then) ? off <= furthest : then > off + furthest)
    return "What is held is at its clamps as it was recorded.";
  return NULL;
}

/* Returns NULL when there are some, else why there are none. */
static const gchar *
add_trials (ClothCandidates * c, const ClothEffect * effect,
    const ClothRecording * r)
{
  const guint before = c->list->len;
  const gchar *reason = NULL;

  for (guint i = 0; i < effect->parameters[0].n_tried; i++) {
    ClothCandidate candidate = start (c, effect);

    for (guint k = 0; k < effect->n_parameters; k++)
      candidate.values[k] = effect->parameters[k].tried[i];
    if (effect->side == CLOTH_EFFECT_MEASUREMENT)
      reason = why_not_wrong (&candidate, r);
    if (!reason)
      add_present (c, &candidate);
  }
  return c->list->len > before ? NULL : reason;
}

static guint
parameter_of (const ClothEffect * effect, const gchar * name)
{
  guint k = 0;

  while (strcmp (effect->parameters[k].name, name) != 0)
    k++;
  return k;
}

/* The lowest place that a vertex is at over some frames in a row, m; NaN when none was seen. */
static gdouble
find_lowest (const ClothRecording * r)
{
  gdouble lowest = INFINITY;

  for (guint v = 0; v < r->n; v++)
    for (guint f = 0; f + FLOOR_FRAMES <= r->n_frames; f++) {
      gdouble z = 0., seen = 1.;

      for (guint i = f; i < f + FLOOR_FRAMES; i++) {
        z += r->y[3 * ((gsize) i * r->n + v) + 2] / FLOOR_FRAMES;
        seen *= r->seen[(gsize) i * r->n + v];
      }
      if (seen > 0.)
        lowest = MIN (lowest, z);
    }
  return isfinite (lowest) ? lowest : NAN;
}

/* Returns NULL when there is one, else why there is none. */
static const gchar *
add_floor (ClothCandidates * c, const ClothEffect * effect,
    const ClothRecording * r)
{
  ClothCandidate candidate = start (c, effect);
  const guint floor = parameter_of (effect, "floor");

  for (guint k = 0; k < effect->n_parameters; k++)
    if (!effect->parameters[k].shapes)
      candidate.values[k] =
          effect->parameters[k].null_value + effect->parameters[k].prior;
  candidate.values[floor] = find_lowest (r);
  if (!(candidate.values[floor] > effect->parameters[floor].min
          && candidate.values[floor] <= effect->parameters[floor].max))
    return "Nobody saw the cloth long enough to say where a floor may be.";
  add_present (c, &candidate);
  return NULL;
}

static gdouble
find_mean_distance (const ClothRecording * r, guint held, guint vertex,
    guint begin, guint end, guint k, guint * n)
{
  gdouble sum = 0.;

  *n = 0;
  for (guint f = begin; f < end; f++) {
    gsize at = (gsize) f * r->n + vertex;

    if (r->seen[at] == 0.)
      continue;
    sum += r->y[3 * at + k] -
        r->scene->clamps[3 * ((gsize) f * r->scene->held->len + held) + k];
    (*n)++;
  }
  return *n ? sum / *n : 0.;
}

/* When the seen position of a held vertex jumps most against its path, s; NaN when it never
 * does. What is seen of a clamp is an observation like any other. */
static gdouble
find_slip (const ClothRecording * r, guint held)
{
  const ClothHeld *h = &g_array_index (r->scene->held, ClothHeld, held);
  gdouble best = SLIP_SIGMAS * SLIP_SIGMAS, when = NAN;

  for (guint f = SLIP_FRAMES; f + SLIP_FRAMES <= r->n_frames; f++) {
    gdouble jump = 0.;
    guint n[2];

    if (r->times[f - SLIP_FRAMES] < h->from_s
        || r->times[f + SLIP_FRAMES - 1] > h->until_s)
      continue;
    for (guint k = 0; k < 3; k++) {
      gdouble before =
          find_mean_distance (r, held, h->vertex, f - SLIP_FRAMES, f, k,
          &n[0]);
      gdouble after =
          find_mean_distance (r, held, h->vertex, f, f + SLIP_FRAMES, k,
          &n[1]);

      if (n[0] && n[1])
        jump += (after - before) * (after - before) / (r->sigma * r->sigma *
            (1. / n[0] + 1. / n[1]));
    }
    if (jump > best) {
      best = jump;
      when = r->times[f];
    }
  }
  return when;
}

static void
add_jumps (ClothCandidates * c, const ClothEffect * effect,
    const ClothRecording * r)
{
  /* the ramp is over a twentieth of a second: it began before the middle of the jump */
  const gdouble lead = 0.03;

  for (guint held = 0; held < r->scene->held->len; held++) {
    gdouble when = find_slip (r, held);
    ClothCandidate candidate = start (c, effect);

    candidate.values[parameter_of (effect, "held")] = held;
    candidate.values[parameter_of (effect, "time")] =
        isnan (when) ? r->times[0] : when - lead;
    for (guint k = 0; k < effect->n_parameters; k++)
      if (!effect->parameters[k].shapes)
        add_direction (c, &candidate, k);
    g_array_append_val (c->list, candidate);
  }
}

/* What varies by chance has no directions of its own, but those of what varies. */
static gboolean
add_stochastic (ClothCandidates * c, const ClothEffect * effect)
{
  ClothCandidate candidate = start (c, effect);

  for (guint i = 0; i < c->list->len; i++) {
    const ClothCandidate *steady = &g_array_index (c->list, ClothCandidate, i);

    if (strcmp (steady->effect->id, effect->varies) != 0)
      continue;
    candidate.first = steady->first;
    g_array_append_val (c->list, candidate);
    return TRUE;
  }
  return FALSE;
}

static gboolean
has_squares (const ClothTopology * t)
{
  for (guint f = 0; f < t->n_faces; f++)
    if (cloth_face_corners (t->faces + 4 * (gsize) f) == 4)
      return TRUE;
  return FALSE;
}

/* NULL when a trial can be simulated, else why not. */
static const gchar *
why_no_trial (const ClothEffect * effect, const ClothRecording * r,
    ClothCandidatesFlags flags)
{
  const ClothTopology *t = r->scene->topology;

  if (!(flags & CLOTH_CANDIDATES_TRIALS))
    return effect->untested;
  if (strcmp (effect->id, "mesh_diagonals") == 0 && !has_squares (t))
    return "The mesh has no squares.";
  /* a face brings no more than five vertices */
  if (strcmp (effect->id, "mesh_resolution") == 0
      && t->n_vertices + 5 * (guint64) t->n_faces > CLOTH_MAX_VERTICES)
    return "The mesh is too fine to be made finer.";
  return NULL;
}

static gboolean
needs_floor (const ClothEffect * effect, const ClothRecording * r)
{
  return effect->needs_obstacles && !r->scene->obstacles->len;
}

/* NULL when the effect can be a candidate, else why not. */
static const gchar *
why_not (const ClothEffect * effect, const ClothModel * model,
    const ClothRecording * r, ClothCandidatesFlags flags)
{
  const gboolean frozen = flags & CLOTH_CANDIDATES_FROZEN;
  const gchar *reason;

  if (effect->side == CLOTH_EFFECT_CAMERA || effect->side == CLOTH_EFFECT_IMAGE)
    return
        "The take has positions only: record what the cameras saw to test it "
        "(rig.json, and observations/NAME.obs of each camera by detector ! "
        "clothmetapay ! filesink; docs/formats.md).";
  if (effect->side == CLOTH_EFFECT_CLAMP && !r->scene->held->len)
    return "Nothing is held in this take.";
  if (r->scene->clamps_sd && (effect->side == CLOTH_EFFECT_CLAMP
          || effect->side == CLOTH_EFFECT_MEASUREMENT))
    return "The paths of clamps were not logged, and are taken from the cloth: "
        "give them as clamps.npy.";
  if (needs_floor (effect, r) && !(flags & CLOTH_CANDIDATES_TRIALS))
    return "There is no obstacle in this take.";
  if (effect->test == CLOTH_EFFECT_TEST_NONE)
    return effect->untested;
  if (effect->test == CLOTH_EFFECT_TEST_TRIAL
      && (reason = why_no_trial (effect, r, flags)))
    return reason;
  if (effect->same_as && !frozen && is_free (model, effect->same_as))
    return "The model's own number is free and was fitted on this take: give "
        "a baseline to freeze it.";
  for (guint i = 0; i < model->effects->len; i++)
    if (g_array_index (model->effects, ClothModelEffect, i).effect == effect)
      return "The model has it already.";
  return NULL;
}

/* Returns NULL when there are some, else why there are none. */
static const gchar *
add (ClothCandidates * c, const ClothEffect * effect, const ClothRecording * r)
{
  if (needs_floor (effect, r))
    return add_floor (c, effect, r);
  if (effect->test == CLOTH_EFFECT_TEST_TRIAL)
    return add_trials (c, effect, r);
  if (effect->test == CLOTH_EFFECT_TEST_STOCHASTIC)
    return add_stochastic (c, effect) ? NULL : effect->untested;
  if (effect->test == CLOTH_EFFECT_TEST_JUMP)
    add_jumps (c, effect, r);
  else
    add_plain (c, effect);
  return NULL;
}

/* @model: the model that is looked at
 * @recording: what it is to explain
 * @effects: (nullable) (array zero-terminated=1): ids of those to consider
 * @flags: what is known and considered
 * @skip: called for those that are not considered
 * @data: for @skip
 * @error: #ClothFitError
 *
 * Returns: (transfer full) (nullable): the candidates
 */
ClothCandidates *
cloth_candidates_new (const ClothModel * model,
    const ClothRecording * recording, const gchar * const *effects,
    ClothCandidatesFlags flags, ClothCandidateSkip skip, gpointer data,
    GError ** error)
{
  g_autoptr (ClothCandidates) c = cloth_candidates_new_empty ();
  guint n_effects;
  const ClothEffect *const *table = cloth_effect_table (&n_effects);

  for (guint i = 0; effects && effects[i]; i++)
    if (!cloth_effect_find (effects[i])) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_EFFECT,
          "there is no effect “%s”; gst-cloth-gap-1.0 effects lists them",
          effects[i]);
      return NULL;
    }
  if (!add_free (c, model, error))
    return NULL;
  for (guint i = 0; i < n_effects; i++) {
    const gchar *reason;

    if (!cloth_effect_is_among (effects, table[i]->id)
        || (table[i]->side == CLOTH_EFFECT_MEASUREMENT
            && !(flags & CLOTH_CANDIDATES_MEASUREMENT)))
      continue;
    reason = why_not (table[i], model, recording, flags);
    if (!reason && !effects && table[i]->side == CLOTH_EFFECT_MEASUREMENT
        && table[i]->test != CLOTH_EFFECT_TEST_TRIAL)
      reason = table[i]->untested;
    if (!reason)
      reason = add (c, table[i], recording);
    if (reason && skip)
      skip (data, table[i], reason);
  }
  return g_steal_pointer (&c);
}

static const ClothCandidate *
find_candidate (const ClothCandidates * c, guint direction)
{
  for (guint i = 0; i < c->list->len; i++) {
    const ClothCandidate *candidate =
        &g_array_index (c->list, ClothCandidate, i);

    if (direction >= candidate->first
        && direction < candidate->first + candidate->n)
      return candidate;
  }
  return NULL;
}

/* Which of the model's effects it is, −1: none. */
static gint
find_effect (const ClothModel * model, const ClothEffect * effect)
{
  for (guint i = 0; i < model->effects->len; i++)
    if (g_array_index (model->effects, ClothModelEffect, i).effect == effect)
      return (gint) i;
  return -1;
}

/* Whether the model has the effect as the candidate does. */
static gboolean
is_present (const ClothModel * model, const ClothCandidate * candidate)
{
  const ClothEffect *effect = candidate->effect;
  const gint at = find_effect (model, effect);

  for (guint k = 0; at >= 0 && k < effect->n_parameters; k++)
    if (g_array_index (model->effects, ClothModelEffect, at).values[k] !=
        candidate->values[k])
      return FALSE;
  return at >= 0;
}

/* @candidates: the candidates
 * @model: a model
 * @direction: a direction
 *
 * Returns: where the model is along it: the number, or its logarithm; 1 where an effect is
 *   present, else 0
 */
gdouble
cloth_candidates_place (const ClothCandidates * candidates,
    const ClothModel * model, guint direction)
{
  const ClothDirection *d = cloth_candidates_direction (candidates,
      direction);
  gdouble value = d->centre;

  if (d->present)
    return is_present (model, find_candidate (candidates, direction));
  if (cloth_model_get (model, d->name, &value, NULL) && d->logarithmic)
    value = log (value);
  return value;
}

static void
set_present (ClothModel * model, const ClothCandidate * candidate,
    gboolean present)
{
  if (present)
    cloth_model_set_effect (model, candidate->effect, candidate->values);
  else if (is_present (model, candidate))
    g_array_remove_index (model->effects,
        (guint) find_effect (model, candidate->effect));
}

/* @candidates: the candidates
 * @model: where they start
 * @directions: (array length=n): along which
 * @changes: (array length=n): how far: added to the number, or to its logarithm
 * @n: how many
 *
 * An effect that is present or not becomes whichever is nearer.
 *
 * Returns: (transfer full): the model so changed, kept within each number's range
 */
ClothModel *
cloth_candidates_move (const ClothCandidates * candidates,
    const ClothModel * model, const guint * directions,
    const gdouble * changes, guint n)
{
  ClothModel *moved = cloth_model_copy (model);

  for (guint i = 0; i < n; i++) {
    const ClothDirection *d = cloth_candidates_direction (candidates,
        directions[i]);
    const ClothCandidate *candidate = find_candidate (candidates,
        directions[i]);
    gdouble value;

    if (candidate && !d->present && find_effect (moved, candidate->effect) < 0)
      cloth_model_set_effect (moved, candidate->effect, candidate->values);
    value = cloth_candidates_place (candidates, moved, directions[i]);
    value = CLAMP (value + changes[i], d->low, d->high);
    if (d->present)
      set_present (moved, candidate, value >= 0.5);
    else
      cloth_model_set (moved, d->name, d->logarithmic ? exp (value) : value,
          NULL);
  }
  return moved;
}

/* @candidates: the candidates
 * @model: a model
 * @direction: one of the free numbers
 * @reach: how far it may be from where it is in @model, or the logarithm of it
 *
 * Bounds the number in fits to come. Logarithms reach less far up: by no more than makes
 * as much of a difference.
 */
void
cloth_candidates_bound (ClothCandidates * candidates,
    const ClothModel * model, guint direction, gdouble reach)
{
  ClothDirection *d = &g_array_index (candidates->directions,
      ClothDirection, direction);
  gdouble value = cloth_candidates_place (candidates, model, direction);

  d->fit_low = MAX (d->low, value - reach);
  d->fit_high = MIN (d->high, value + (d->logarithmic ? log1p (reach) : reach));
}

/* @candidates: the candidates
 * @model: where it starts
 * @direction: along which
 * @step: how far
 *
 * Returns: whether the number stays in its range @step above and below
 */
gboolean
cloth_candidates_has_room (const ClothCandidates * candidates,
    const ClothModel * model, guint direction, gdouble step)
{
  const ClothDirection *d = cloth_candidates_direction (candidates,
      direction);
  gdouble value = cloth_candidates_place (candidates, model, direction);

  return value - step >= d->low && value + step <= d->high;
}

/* @candidates: (nullable) (transfer full): the candidates
 */
void
cloth_candidates_free (ClothCandidates * candidates)
{
  if (!candidates)
    return;
  if (candidates->directions)
    g_array_unref (candidates->directions);
  if (candidates->list)
    g_array_unref (candidates->list);
  g_free (candidates);
}
