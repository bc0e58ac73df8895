/* The experiment that would tell effects apart which a recording can't: T-optimal discrimination
 * (Atkinson and Fedorov, Biometrika 62, 1975) over a list of captures, for the score test of the
 * diagnosis.
 *
 * Each capture is simulated without any of the effects, as if it were recorded. Observers with one
 * of the effects each follow that recording, and leave the residuals zᵢ.
 * Assumption: if effect i acts, the residual of the model with effect j is zᵢ − zⱼ. What the
 * model's free numbers and run-to-run variability could do as well is projected out by P.
 * Formula: expected log Bayes factor of i against j = ½ (zᵢ − zⱼ)ᵀP(zᵢ − zⱼ)/φ₀, with φ₀ the
 * overdispersion. A capture is worth the least of all pairs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/design/experiment.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/effect/effect.h"

/* Before it is filmed, the cloth comes to rest with this damping, 1/s, for so long, s. */
#define SETTLE_RATE 6.
#define SETTLE_S 1.5
/* Frames a second meanwhile: nobody looks. */
#define SETTLE_FPS 10.

typedef struct
{
  const ClothExperiment *e;
  const ClothModelEffect *members;
  guint n_members;
  ClothEstimateOptions *options;
  ClothRecording *thin;         /* what the stage is of, if not the take itself */
  ClothStage *stage;
  gdouble *rest[2];             /* hanging as in the take, and from the side edge */
} Search;

static void
search_clear (Search * search)
{
  g_clear_pointer (&search->stage, cloth_stage_free);
  cloth_recording_free (search->thin);
  g_free (search->rest[0]);
  g_free (search->rest[1]);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Search, search_clear);

static void
write_frame (gpointer data, guint model, guint frame, const gdouble * positions)
{
  ClothRecording *r = data;

  memcpy (r->y + 3 * (gsize) frame * r->n, positions,
      3 * (gsize) r->n * sizeof (gdouble));
}

/* The recording that the model would make of a scene. NULL without an error when it
 * diverges. */
static ClothRecording *
record (Search * s, ClothScene * scene, const ClothModel * model,
    GError ** error)
{
  g_autoptr (ClothRecording) r = g_new0 (ClothRecording, 1);
  gboolean sound;
  gsize all;

  r->name = g_strdup ("experiment");
  r->scene = scene;
  r->n = scene->topology->n_vertices;
  r->n_frames = scene->n_frames;
  r->times = g_memdup2 (scene->times, scene->n_frames * sizeof (gdouble));
  r->sigma = s->stage->recording->sigma;
  all = (gsize) r->n * r->n_frames;
  r->y = g_new0 (gdouble, 3 * all);
  r->velocity = g_new0 (gdouble, 3 * all);
  r->seen = g_new (gdouble, all);
  for (gsize i = 0; i < all; i++)
    r->seen[i] = 1.;
  memcpy (r->y, scene->positions, 3 * (gsize) r->n * sizeof (gdouble));
  s->options->simulations++;
  if (!cloth_rollout_free (r, &model, 1, &s->options->rollout, write_frame,
          r, &sound, error) || !sound)
    return NULL;
  cloth_recording_differentiate (r);
  return g_steal_pointer (&r);
}

/* Where the cloth hangs still, before any motion that begins so. */
static gboolean
settle (Search * s, ClothStageMotion motion, gdouble ** rest, GError ** error)
{
  g_autoptr (ClothModel) model = cloth_model_copy (s->e->model);
  g_autoptr (ClothRecording) r = NULL;

  if (*rest)
    return TRUE;
  model->damping_mass = MAX (model->damping_mass, SETTLE_RATE);
  r = record (s, cloth_stage_make_scene (s->stage, motion, SETTLE_FPS,
          SETTLE_S, NULL), model, error);
  if (!r)
    return FALSE;
  *rest = g_memdup2 (r->y + 3 * (gsize) r->n * (r->n_frames - 1),
      3 * (gsize) r->n * sizeof (gdouble));
  return TRUE;
}

/* Adds the fan's wind to a model's. */
static void
blow (const ClothStage * stage, ClothModel * model)
{
  static const gchar *const names[] = {
    "effects.wind.x", "effects.wind.y", "effects.wind.z"
  };

  for (guint k = 0; k < 3; k++) {
    gdouble speed = 0.;

    cloth_model_get (model, names[k], &speed, NULL);
    cloth_model_set (model, names[k], speed +
        CLOTH_MOTION_FAN_M_S * stage->normal[k], NULL);
  }
}

typedef struct
{
  const ClothRecording *recording;
  const ClothFeatures *features;
  gdouble *z;                   /* [model][feature] */
} Collect;

static void
collect (gpointer data, guint model, guint frame, const gdouble * positions)
{
  Collect *c = data;

  cloth_features_add (c->features, c->recording, frame, positions,
      c->z + model * c->features->size);
}

/* Features of the residuals with one member each; FALSE without an error when one
 * diverges. */
static gboolean
follow (Search * s, const ClothSensitivities * study, ClothStageMotion motion,
    gdouble * z, GError ** error)
{
  g_autoptr (GPtrArray) models = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_model_free);
  g_autofree gdouble *gains = g_new (gdouble, s->n_members);
  g_autofree const ClothRecording **targets =
      g_new (const ClothRecording *, s->n_members);
  g_autofree gboolean *sound = g_new (gboolean, s->n_members);
  Collect c = { study->recording, study->features, z };

  for (guint i = 0; i < s->n_members; i++) {
    ClothModel *model = cloth_model_copy (s->e->model);
    const ClothModelEffect *member = &s->members[i];

    g_ptr_array_add (models, model);
    if (motion != CLOTH_MOTION_FAN_OFF || !member->effect->is_moving_air)
      cloth_model_set_effect (model, member->effect, member->values);
    if (motion == CLOTH_MOTION_FAN_ON)
      blow (s->stage, model);
    gains[i] = s->options->gain;
    targets[i] = study->recording;
  }
  s->options->simulations += s->n_members;
  if (!cloth_rollout_nudged (targets,
          (const ClothModel * const *) models->pdata, gains, s->n_members,
          &s->options->rollout, collect, &c, sound, error))
    return FALSE;
  for (guint i = 0; i < s->n_members; i++)
    if (!sound[i])
      return FALSE;
  return TRUE;
}

/* The simulator's own error in the features of a capture: of the take's class by class, in
 * proportion to the frames that a feature sums over. */
static ClothPowerSpectrum *
find_discrepancy_variance (const Search * s, const ClothFeatures * features,
    const gdouble * nothing, gdouble faster)
{
  ClothPowerSpectrum *power = cloth_power_spectrum_new (features, nothing);
  const ClothPowerSpectrum *known = s->e->discrepancy_variance;
  guint band = 3 * features->n_bands;

  for (guint k = 0; known && k < power->n; k++) {
    guint of = k;

    while (of >= known->n)
      of -= band;
    power->values[k] = faster * known->values[of];
  }
  return power;
}

/* The evidence to expect between the two members that are nearest to each other. */
static gdouble
weigh (const Search * s, const ClothSensitivities * study, const gdouble * z,
    gdouble faster)
{
  const ClothFeatures *f = study->features;
  guint n_free = s->e->candidates->n_free, q = n_free + study->n_variability;
  guint m = q + s->n_members;
  g_autofree gdouble *columns = g_new (gdouble, m * f->size);
  g_autofree gdouble *nothing = g_new0 (gdouble, f->size);
  g_autofree guint *nuisances = g_new (guint, q + 1);
  g_autofree gdouble *precisions = g_new (gdouble, q + 1);
  g_autoptr (ClothPowerSpectrum) power =
      find_discrepancy_variance (s, f, nothing, faster);
  g_autoptr (ClothNormalEquations) normal = NULL;
  gdouble least = INFINITY;

  memcpy (columns, study->columns, n_free * f->size * sizeof (gdouble));
  memcpy (columns + n_free * f->size, study->variability,
      study->n_variability * f->size * sizeof (gdouble));
  memcpy (columns + q * f->size, z, s->n_members * f->size * sizeof (gdouble));
  for (guint i = 0; i < q; i++) {
    nuisances[i] = i;
    precisions[i] = i < n_free ? s->options->overdispersion *
        s->
        e->precisions[i] : cloth_sensitivities_get_variability_precision (study,
        i - n_free);
  }
  normal = cloth_normal_equations_new (f, power, nothing, columns, m);
  for (guint i = 0; i < s->n_members; i++)
    for (guint j = 0; j < i; j++) {
      const guint pair[2] = { q + i, q + j };
      ClothReducedEquations r;

      if (!cloth_normal_equations_reduce (normal, NULL, nuisances, precisions,
              q, pair, 2, &r))
        return NAN;
      least = MIN (least, MAX (0., r.g[0] - r.g[1] - r.g[2] + r.g[3]));
    }
  return 0.5 * least / s->options->overdispersion;
}

/* What a capture would bring: NaN without an error when something diverges. */
static gdouble
try_motion (Search * s, ClothStageMotion motion, gdouble fps, GError ** error)
{
  gboolean edge = motion == CLOTH_MOTION_EDGE;
  const ClothRecording *take = s->e->recording;
  gdouble take_fps = (take->n_frames - 1) /
      (take->times[take->n_frames - 1] - take->times[0]);
  guint n_free = s->e->candidates->n_free;
  g_autofree guint *directions = g_new (guint, n_free + 1);
  g_autoptr (ClothModel) model = cloth_model_copy (s->e->model);
  g_autoptr (ClothRecording) r = NULL;
  g_autoptr (ClothSensitivities) study = NULL;
  g_autofree gdouble *z = NULL;

  if (!settle (s, edge ? motion : CLOTH_MOTION_HANG, &s->rest[edge], error))
    return NAN;
  if (motion == CLOTH_MOTION_FAN_ON)
    blow (s->stage, model);
  r = record (s, cloth_stage_make_scene (s->stage, motion, fps,
          CLOTH_MOTION_SECONDS, s->rest[edge]), model, error);
  if (!r)
    return NAN;
  study = cloth_sensitivities_new (r, s->options);
  z = g_new0 (gdouble, s->n_members * study->features->size);
  for (guint i = 0; i < n_free; i++)
    directions[i] = i;
  if (!cloth_sensitivities_linearise (study, s->e->candidates, model,
          directions, n_free, s->options, error)
      || !follow (s, study, motion, z, error))
    return NAN;
  return weigh (s, study, z, fps / take_fps);
}

/* Adds a trial: FALSE only when the search was stopped. A capture that can't be simulated
 * is one that is not proposed. */
static gboolean
add_trial (Search * s, ClothStageMotion motion, gdouble fps, GArray * trials,
    GError ** error)
{
  g_autoptr (GError) failed = NULL;
  ClothTrial trial = { motion, fps };

  trial.log_bayes_factor = try_motion (s, motion, fps, &failed);
  if (g_error_matches (failed, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED)) {
    g_propagate_error (error, g_steal_pointer (&failed));
    return FALSE;
  }
  if (failed)
    trial.log_bayes_factor = NAN;
  g_array_append_val (trials, trial);
  return TRUE;
}

/* @experiment: what is to be parted where
 * @members: (array length=n_members): effects at their estimated values
 * @n_members: how many
 * @options: (inout): how recordings are studied
 * @error: #ClothFitError when it was stopped
 *
 * Tries each motion that the cloth as it is held allows, those with a fan only when wind
 * is among the effects; and the best at twice the frame rate.
 *
 * Returns: (transfer full) (nullable) (element-type ClothTrial): what each would bring;
 *   empty when there are fewer than two members
 */
GArray *
cloth_experiment_try (const ClothExperiment * experiment,
    const ClothModelEffect * members, guint n_members,
    ClothEstimateOptions * options, GError ** error)
{
  g_auto (Search) s = { experiment, members, n_members, options };
  const ClothRecording *r = experiment->recording;
  gdouble fps = MIN (CLOTH_EXPERIMENT_MOST_FPS, (r->n_frames - 1) /
      (r->times[r->n_frames - 1] - r->times[0]));
  g_autoptr (GArray) trials = g_array_new (FALSE, FALSE, sizeof (ClothTrial));
  const ClothTrial *best;
  gboolean windy = FALSE;

  if (n_members < 2)
    return g_steal_pointer (&trials);
  s.thin = cloth_recording_resample (r, CLOTH_EXPERIMENT_MOST_LINES);
  s.stage = cloth_stage_new (s.thin ? s.thin : r);
  for (guint i = 0; i < n_members; i++)
    windy = windy || members[i].effect->is_moving_air;
  for (guint m = 0; m < CLOTH_N_MOTIONS; m++)
    if (cloth_stage_allows (s.stage, m)
        && (windy || (m != CLOTH_MOTION_FAN_OFF && m != CLOTH_MOTION_FAN_ON))
        && !add_trial (&s, m, fps, trials, error))
      return NULL;
  best = cloth_experiment_choose (trials);
  if (best && best->log_bayes_factor < CLOTH_EXPERIMENT_MOST_LOG_BAYES_FACTOR
      && fps < CLOTH_EXPERIMENT_MOST_FPS
      && !add_trial (&s, best->motion, 2. * fps, trials, error))
    return NULL;
  return g_steal_pointer (&trials);
}

/* @trials: (element-type ClothTrial): the easiest first, then with more frames
 *
 * Returns: (nullable) (transfer none): the one that brings most; among those that bring
 *   %CLOTH_EXPERIMENT_MOST_LOG_BAYES_FACTOR the first; %NULL when none brings enough
 */
const ClothTrial *
cloth_experiment_choose (const GArray * trials)
{
  const ClothTrial *best = NULL;
  gdouble most = 0.;

  for (guint i = 0; i < trials->len; i++) {
    const ClothTrial *t = &g_array_index (trials, ClothTrial, i);
    gdouble log_bayes_factor =
        MIN (t->log_bayes_factor, CLOTH_EXPERIMENT_MOST_LOG_BAYES_FACTOR);
    gdouble ask = best
        && t->fps > best->fps ? CLOTH_EXPERIMENT_FASTER * most : most;

    if (!isnan (t->log_bayes_factor)
        && log_bayes_factor >= CLOTH_EXPERIMENT_LEAST_LOG_BAYES_FACTOR
        && log_bayes_factor > ask) {
      best = t;
      most = log_bayes_factor;
    }
  }
  return best;
}
