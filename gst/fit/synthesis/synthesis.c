/* Analysis by synthesis: a simulated cloth fitted to what cameras saw.
 *
 * Model: the simulation is drawn to what was seen by weak springs (ClothRecordingNoise says along
 *   which directions); what it is off by, as waves, is linear in small changes of its numbers.
 * Formula: Gauss–Newton on what the cloth is off by where it is let go in windows, from the state that
 *   the springs have brought it to: what springs hide, damping above all, shows there. Each class of
 *   features weighs by the power that the model at hand leaves in it; numbers have the priors of their
 *   ranges. Films without a mesh are looked at anew with the fitted numbers, as places on lone rays hang
 *   on the simulation.
 * Assumption: springs always lower the residual, so nothing is judged by it: every gap is also told
 *   without springs, in windows and from the start.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/synthesis/synthesis.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/synthesis/errors.h"

/* A number is at the end of its range when it is this share of it away. */
#define AT_END 1e-3

/* @options: (out): the usual ones
 */
void
cloth_synthesis_options_init (ClothSynthesisOptions * options)
{
  *options = (ClothSynthesisOptions) {
    1600., 0.3, 18, 2, {
  0}};
}

static ClothRecording *
record (const ClothSynthesisInput * input, const ClothModel * model,
    const ClothSynthesisOptions * o, ClothObservedCounts * counts,
    GError ** error)
{
  if (!input->observations)
    return cloth_recording_new (input->take, error);
  return cloth_recording_new_observed (input->take, input->observations, model,
      o->gain, &o->rollout, counts, error);
}

static gdouble
root_of (const ClothWindowedGap * gap)
{
  return gap->sound ? sqrt (cloth_windowed_gap_square (gap, NULL)) : INFINITY;
}

/* RMS of what springs leave between the cloth and what was seen. */
static gdouble
find_drawn (const ClothWindowedGap * gap, const ClothRecording * r)
{
  gdouble sum = 0.;
  gsize n = 0;

  for (gsize i = r->n; i < (gsize) r->n * r->n_frames; i++) {
    gdouble off[3];

    if (r->seen[i] == 0.)
      continue;
    for (guint k = 0; k < 3; k++)
      off[k] = gap->nudged[3 * i + k];
    cloth_recording_cut_blind (r, i, off);
    sum += off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
    n++;
  }
  return sqrt (sum / MAX (n, 1));
}

static gboolean
fail_unsound (const ClothRecording * r, GError ** error)
{
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "%s: the fitted "
      "cloth diverges; narrow the ranges of the model's free numbers", r->name);
  return FALSE;
}

/* How far two models are off what was seen, and where the second one lets the cloth go. */
static gboolean
measure (ClothSynthesisTake * take, const ClothModel * before,
    const ClothModel * after, const ClothSynthesisOptions * o, GError ** error)
{
  const ClothModel *models[2] = { before, after };
  ClothSynthesisGap *gaps[2] = { &take->before, &take->after };
  const ClothRecording *r = take->recording;
  const gsize all = 3 * (gsize) r->n * r->n_frames;
  ClothWindowedGap **windows = cloth_windowed_gaps_new (r, models, 2, o->gain,
      o->window_s, &o->rollout, error);
  ClothWindowedGap **runs = windows ? cloth_windowed_gaps_new_free (r, models,
      2, o->gain, 0., o->window_s, &o->rollout, error) : NULL;

  for (guint k = 0; runs && k < 2; k++) {
    gaps[k]->windows = root_of (windows[k]);
    gaps[k]->drawn = find_drawn (windows[k], r);
    gaps[k]->free = root_of (runs[k]);
  }
  if (runs) {
    take->let_go = g_memdup2 (windows[1]->positions, all * sizeof (gfloat));
    take->positions = g_new (gfloat, all);
  }
  cloth_windowed_gaps_free (windows, 2);
  cloth_windowed_gaps_free (runs, 2);
  return runs && (!isinf (take->after.windows) || fail_unsound (r, error));
}

/* The strengths that are tried: how many times the usual gain. */
static const gdouble strengths[] = { 0.25, 1., 4., 16., 64. };

#define N_STRENGTHS G_N_ELEMENTS (strengths)
/* What is left out for it: one in so many tiles of so many vertices each way, for so many frames. */
#define LEFT_OUT 5
#define TILE 3
#define FRAMES 5

typedef struct
{
  const ClothRecording *recording;
  const gdouble *left_out;      /* 1 where a place was seen and left out */
  gdouble sums[N_STRENGTHS];
} Drawn;

/* How far each strength is off what was left out. */
static void
judge_strength (gpointer data, guint model, guint frame,
    const gdouble * positions)
{
  Drawn *d = data;
  const ClothRecording *r = d->recording;

  for (guint v = 0; v < r->n; v++) {
    const gsize at = (gsize) frame * r->n + v;
    gdouble off[3];

    if (d->left_out[at] == 0.)
      continue;
    for (guint k = 0; k < 3; k++)
      off[k] = positions[3 * v + k] - r->y[3 * at + k];
    cloth_recording_cut_blind (r, at, off);
    d->sums[model] += off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
  }
}

/* Whether a place is left out: tiles of the cloth, for some frames. */
static gboolean
is_left_out (const ClothTopology * t, guint v, guint frame)
{
  const guint columns = MAX (t->columns, 1);
  const guint tile = v % columns / TILE + 7 * (v / columns / TILE);

  return (2 * tile + 3 * (frame / FRAMES)) % LEFT_OUT == 0;
}

/* The strength that foretells places best that it was not shown. The first frame is shown whole. */
static gboolean
choose_gain (ClothSynthesisTake * take, const ClothModel * model,
    const ClothSynthesisOptions * o, GError ** error)
{
  const ClothRecording *r = take->recording;
  const gsize all = (gsize) r->n * r->n_frames;
  g_autofree gdouble *seen = g_memdup2 (r->seen, all * sizeof *seen);
  g_autofree gdouble *left_out = g_new0 (gdouble, all);
  ClothRecording shown = *r;
  const ClothRecording *targets[N_STRENGTHS];
  const ClothModel *models[N_STRENGTHS];
  gdouble gains[N_STRENGTHS];
  gboolean sound[N_STRENGTHS];
  Drawn d = { r, left_out };
  guint best = 1;

  for (gsize at = r->n; at < all; at++)
    if (seen[at] > 0. && is_left_out (r->scene->topology, at % r->n,
            (guint) (at / r->n))) {
      left_out[at] = 1.;
      seen[at] = 0.;
    }
  shown.seen = seen;
  for (guint i = 0; i < N_STRENGTHS; i++) {
    targets[i] = &shown;
    models[i] = model;
    gains[i] = strengths[i] * o->gain;
  }
  if (!cloth_rollout_nudged (targets, models, gains, N_STRENGTHS, &o->rollout,
          judge_strength, &d, sound, error))
    return FALSE;
  for (guint i = 0; i < N_STRENGTHS; i++)
    if (sound[i] && (!sound[best] || d.sums[i] < d.sums[best]))
      best = i;
  take->gain = gains[best];
  return TRUE;
}

/* Where the springs have the cloth, what nobody saw of it too. */
static gboolean
draw (ClothSynthesisTake * take, const ClothModel * model,
    const ClothSynthesisOptions * o, GError ** error)
{
  const ClothRecording *r = take->recording;
  const gsize all = 3 * (gsize) r->n * r->n_frames;
  g_autofree gdouble *path = g_new (gdouble, all);
  gboolean sound;

  if (!choose_gain (take, model, o, error)
      || !cloth_rollout_follow (&r, 1, model, take->gain, &o->rollout, path,
          &sound, error))
    return FALSE;
  for (gsize i = 0; i < all; i++)
    take->positions[i] = (gfloat) path[i];
  return sound || fail_unsound (r, error);
}

static void
clear_number (gpointer item)
{
  g_free (((ClothSynthesisNumber *) item)->name);
}

/* @errors: of the places of numbers, which are logarithms of what is positive by its nature */
static void
list_numbers (ClothSynthesis * s, const ClothCandidates * candidates,
    const ClothModel * before, const ClothSynthesisError * errors)
{
  for (guint i = 0; i < candidates->n_free; i++) {
    const ClothDirection *d = cloth_candidates_direction (candidates, i);
    const gdouble place = cloth_candidates_place (candidates, s->model, i);
    const gdouble slack = AT_END * (d->high - d->low);
    ClothSynthesisNumber number = { g_strdup (d->name) };

    cloth_model_get (before, d->name, &number.before, NULL);
    cloth_model_get (s->model, d->name, &number.value, NULL);
    number.sigma = errors[i].sigma * (d->logarithmic ? number.value : 1.);
    number.finer = d->logarithmic ? exp (errors[i].finer) : errors[i].finer;
    number.finer_sigma = errors[i].finer_sigma *
        (d->logarithmic ? number.finer : 1.);
    number.at_end = place - d->low < slack || d->high - place < slack;
    g_array_append_val (s->numbers, number);
  }
}

static void
estimate_options_init (ClothEstimateOptions * options,
    const ClothSynthesisOptions * o)
{
  cloth_estimate_options_init (options);
  options->gain = o->gain;
  options->window_s = o->window_s;
  options->rollout = o->rollout;
}

/* One fit of all recordings. Returns the model. */
static ClothModel *
fit (const ClothSynthesis * s, ClothCandidates * candidates,
    const ClothModel * model, const ClothSynthesisOptions * o, GError ** error)
{
  const guint m = candidates->n_free;
  g_autoptr (GPtrArray) studies =
      g_ptr_array_new_with_free_func ((GDestroyNotify)
      cloth_sensitivities_free);
  g_autofree guint *directions = g_new (guint, m);
  g_autofree gdouble *precisions = g_new (gdouble, m);
  ClothEstimateOptions options;

  estimate_options_init (&options, o);
  for (guint i = 0; i < m; i++) {
    const gdouble prior = cloth_candidates_direction (candidates, i)->prior;

    directions[i] = i;
    precisions[i] = 1. / (prior * prior);
  }
  for (guint i = 0; i < s->n_takes; i++)
    g_ptr_array_add (studies, cloth_sensitivities_new (s->takes[i].recording,
            &options));
  return cloth_gauss_newton_fit ((ClothSensitivities **) studies->pdata,
      s->n_takes, candidates, model, directions, precisions, m, NULL,
      CLOTH_FIT_DEFAULT, o->n_passes, &options, NULL, error);
}

/* How far off the fitted numbers are. */
static gboolean
find_errors (const ClothSynthesis * s, const ClothCandidates * candidates,
    const ClothModel * found, const ClothSynthesisOptions * o,
    ClothSynthesisError * errors, GError ** error)
{
  g_autofree ClothRecording **recordings = g_new (ClothRecording *, s->n_takes);
  ClothEstimateOptions options;

  estimate_options_init (&options, o);
  for (guint i = 0; i < s->n_takes; i++)
    recordings[i] = s->takes[i].recording;
  return cloth_synthesis_find_errors (recordings, s->n_takes, candidates, found,
      &options, errors, error);
}

/* Places on lone rays, and paths of clamps that nobody logged, are as the model at hand has them. */
static gboolean
is_to_be_made (const ClothSynthesisTake * take)
{
  return !take->recording || take->counts.places
      || take->recording->scene->clamps_sd;
}

/* Whether a place was seen from the second frame on: with the first one a fit only begins. */
static gboolean
check_seen (const ClothRecording * r, GError ** error)
{
  for (gsize i = r->n; i < (gsize) r->n * r->n_frames; i++)
    if (r->seen[i] > 0.)
      return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: nothing "
      "of the cloth was seen after the first frame, so there is nothing to fit "
      "it to", r->name);
  return FALSE;
}

/* What was seen, as the model at hand has it. */
static gboolean
look (ClothSynthesis * s, const ClothSynthesisInput * inputs,
    const ClothModel * model, const ClothSynthesisOptions * o, GError ** error)
{
  for (guint i = 0; i < s->n_takes; i++) {
    ClothSynthesisTake *take = &s->takes[i];

    if (is_to_be_made (take)) {
      cloth_recording_free (take->recording);
      take->recording = record (&inputs[i], model, o, &take->counts, error);
    }
    if (!take->recording || !check_seen (take->recording, error)
        || !cloth_recording_refine_paths (take->recording, model, o->gain,
            &o->rollout, error)
        || !cloth_synthesis_straighten (&take->recording, 1, model, o->gain,
            &o->rollout, error))
      return FALSE;
  }
  return TRUE;
}

struct _ClothSynthesisProblem
{
  const ClothSynthesisInput *inputs;
  const ClothModel *model;      /* where it starts */
  ClothSynthesisOptions options;
  ClothCandidates *candidates;
  ClothSynthesis *s;            /* its recordings */
};

/* @inputs: (array length=n_inputs): what was filmed, of one cloth; has to outlive the problem
 * @n_inputs: how many, at least 1
 * @model: what is known of the cloth, and which numbers are free; so has this
 * @options: how
 * @error: #ClothFitError, #ClothSimError, or what reading a take says
 *
 * Returns: (transfer full) (nullable): the problem
 */
ClothSynthesisProblem *
cloth_synthesis_problem_new (const ClothSynthesisInput * inputs,
    guint n_inputs, const ClothModel * model,
    const ClothSynthesisOptions * options, GError ** error)
{
  static const gchar *const no_effects[] = { NULL };
  g_autoptr (ClothSynthesisProblem) p = g_new0 (ClothSynthesisProblem, 1);
  ClothSynthesis *s = g_new0 (ClothSynthesis, 1);

  p->inputs = inputs;
  p->model = model;
  p->options = *options;
  p->s = s;
  s->numbers = g_array_new (FALSE, FALSE, sizeof (ClothSynthesisNumber));
  g_array_set_clear_func (s->numbers, clear_number);
  s->takes = g_new0 (ClothSynthesisTake, n_inputs);
  s->n_takes = n_inputs;
  if (!look (s, inputs, model, options, error))
    return NULL;
  p->candidates = cloth_candidates_new (model, s->takes[0].recording,
      no_effects, CLOTH_CANDIDATES_DEFAULT, NULL, NULL, error);
  if (!p->candidates)
    return NULL;
  if (p->candidates->n_free == 0) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL,
        "the model has no free numbers; list what to fit under “free”, for "
        "instance {\"name\": \"stretch.warp\", \"range\": [10, 1000]}");
    return NULL;
  }
  return g_steal_pointer (&p);
}

/* @problem: a problem
 *
 * Returns: how many numbers are free
 */
guint
cloth_synthesis_problem_get_n (const ClothSynthesisProblem * problem)
{
  return problem->candidates->n_free;
}

/* @problem: a problem
 * @start: (out) (array): where the model has the free numbers, or the nearest end of their ranges; of
 *   those that are positive by their nature the logarithms
 * @low: (out) (array): their least values
 * @high: (out) (array): their greatest ones
 */
void
cloth_synthesis_problem_get_room (const ClothSynthesisProblem * problem,
    gdouble * start, gdouble * low, gdouble * high)
{
  for (guint i = 0; i < problem->candidates->n_free; i++) {
    const ClothDirection *d = cloth_candidates_direction (problem->candidates,
        i);

    low[i] = d->low;
    high[i] = d->high;
    /* a model's number may be out of the range that it is looked for in */
    start[i] = CLAMP (cloth_candidates_place (problem->candidates,
            problem->model, i), d->low, d->high);
  }
}

static ClothModel *
move_to (const ClothSynthesisProblem * p, const gdouble * point)
{
  const guint n = p->candidates->n_free;
  g_autofree guint *directions = g_new (guint, n);
  g_autofree gdouble *changes = g_new (gdouble, n);

  for (guint i = 0; i < n; i++) {
    directions[i] = i;
    changes[i] = point[i] - cloth_candidates_place (p->candidates, p->model, i);
  }
  return cloth_candidates_move (p->candidates, p->model, directions, changes,
      n);
}

/* @problem: a #ClothSynthesisProblem
 * @point: (array): free numbers, as cloth_synthesis_problem_get_room () has them
 * @worker: which thread asks
 *
 * A #ClothSearchFunc: several threads may call it at once.
 *
 * Returns: log (S + N), S the mean square distance of what was seen to the cloth let go in windows, over
 *   all takes, N that of noise, m²; NaN when it diverges
 */
gdouble
cloth_synthesis_problem_evaluate (gpointer problem, const gdouble * point,
    guint worker)
{
  const ClothSynthesisProblem *p = problem;
  g_autoptr (ClothModel) model = move_to (p, point);
  const ClothModel *models[1] = { model };
  ClothRolloutOptions rollout = p->options.rollout;
  gdouble sum = 0.;

  rollout.threads = 1;
  rollout.failed = NULL;
  for (guint i = 0; i < p->s->n_takes; i++) {
    ClothWindowedGap **gap = cloth_windowed_gaps_new (p->s->takes[i].recording,
        models, 1, p->options.gain, p->options.window_s, &rollout, NULL);
    const gdouble root = gap ? root_of (gap[0]) : NAN;

    cloth_windowed_gaps_free (gap, 1);
    sum += (root * root +
        cloth_recording_noise_square (p->s->takes[i].recording)) /
        p->s->n_takes;
  }
  return isfinite (sum) ? log (sum) : NAN;
}

/* Gaps and the drawn cloth with the model that was found. The problem's recordings go with it. */
static ClothSynthesis *
finish (ClothSynthesisProblem * p, ClothModel * found,
    const ClothSynthesisError * errors, GError ** error)
{
  g_autoptr (ClothSynthesis) s = g_steal_pointer (&p->s);

  s->model = found;
  list_numbers (s, p->candidates, p->model, errors);
  for (guint i = 0; i < s->n_takes; i++)
    if (!measure (&s->takes[i], p->model, s->model, &p->options, error)
        || !draw (&s->takes[i], s->model, &p->options, error))
      return NULL;
  return g_steal_pointer (&s);
}

/* @problem: a problem; it is used up
 * @point: (array): the free numbers that were found
 * @error: #ClothFitError when the cloth diverges with them
 *
 * Returns: (transfer full) (nullable): the cloth with these numbers
 */
ClothSynthesis *
cloth_synthesis_problem_finish (ClothSynthesisProblem * problem,
    const gdouble * point, GError ** error)
{
  const guint n = problem->candidates->n_free;
  g_autofree ClothSynthesisError *errors = g_new (ClothSynthesisError, n);

  for (guint i = 0; i < n; i++)
    errors[i] = (ClothSynthesisError) {
    NAN, NAN, NAN};
  return finish (problem, move_to (problem, point), errors, error);
}

/* @problem: (nullable) (transfer full): a problem
 */
void
cloth_synthesis_problem_free (ClothSynthesisProblem * problem)
{
  if (!problem)
    return;
  cloth_candidates_free (problem->candidates);
  cloth_synthesis_free (problem->s);
  g_free (problem);
}

/* @inputs: (array length=n_inputs): what was filmed, of one cloth
 * @n_inputs: how many, at least 1
 * @model: what is known of the cloth; its free numbers are fitted
 * @options: how
 * @error: #ClothFitError, #ClothSimError, or what reading a take says
 *
 * Returns: (transfer full) (nullable): the fitted cloth
 */
ClothSynthesis *
cloth_synthesis_fit (const ClothSynthesisInput * inputs, guint n_inputs,
    const ClothModel * model, const ClothSynthesisOptions * options,
    GError ** error)
{
  g_autoptr (ClothSynthesisProblem) p = cloth_synthesis_problem_new (inputs,
      n_inputs, model, options, error);
  g_autoptr (ClothModel) found = NULL;
  g_autofree ClothSynthesisError *errors = NULL;

  if (!p)
    return NULL;
  errors = g_new (ClothSynthesisError, p->candidates->n_free);
  found = cloth_model_copy (model);
  for (guint turn = 0; turn < MAX (options->turns, 1); turn++) {
    ClothModel *fitted;

    if (turn && !look (p->s, inputs, found, options, error))
      return NULL;
    fitted = fit (p->s, p->candidates, found, options, error);
    if (!fitted)
      return NULL;
    cloth_model_free (found);
    found = fitted;
  }
  if (!find_errors (p->s, p->candidates, found, options, errors, error))
    return NULL;
  return finish (p, g_steal_pointer (&found), errors, error);
}

/* @take: a fitted take
 * @positions: (array): where its cloth is, [n_frames][n][3], m
 * @observations: what cameras saw of it
 * @errors: (out) (array): RMS distance of what a camera saw in a frame to where it would see that,
 *   px, [n_cameras][n_frames]; NaN where it saw nothing
 *
 * How far the cloth is off in each picture.
 */
void
cloth_synthesis_reproject (const ClothSynthesisTake * take,
    const gfloat * positions, const ClothObservations * observations,
    gdouble * errors)
{
  const ClothRecording *r = take->recording;
  g_autoptr (ClothViews) views = cloth_views_new (observations,
      cloth_recording_get_frame_s (r));
  const ClothRig *rig = observations->rig;

  for (guint c = 0; c < rig->n_cameras; c++)
    for (guint f = 0; f < r->n_frames; f++) {
      gdouble sum = 0.;
      guint n = 0;

      cloth_views_find (views, c, r->times[f] + rig->cameras[c].offset_s);
      for (guint v = 0; v < r->n; v++) {
        const gfloat *p = positions + 3 * ((gsize) f * r->n + v);
        const gdouble X[3] = { p[0], p[1], p[2] };
        const gdouble x = views->views[c].x[v], y = views->views[c].y[v];
        gdouble px[2];

        if (!isfinite (x + y)
            || !cloth_camera_project (&rig->cameras[c], X, px, NULL, NULL))
          continue;
        sum += (px[0] - x) * (px[0] - x) + (px[1] - y) * (px[1] - y);
        n++;
      }
      errors[(gsize) c * r->n_frames + f] = n ? sqrt (sum / n) : NAN;
    }
}

/* @synthesis: (nullable) (transfer full): a fitted cloth
 */
void
cloth_synthesis_free (ClothSynthesis * synthesis)
{
  if (!synthesis)
    return;
  cloth_model_free (synthesis->model);
  g_array_unref (synthesis->numbers);
  for (guint i = 0; i < synthesis->n_takes; i++) {
    cloth_recording_free (synthesis->takes[i].recording);
    g_free (synthesis->takes[i].positions);
    g_free (synthesis->takes[i].let_go);
  }
  g_free (synthesis->takes);
  g_free (synthesis);
}
