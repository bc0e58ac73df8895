/* Residuals of nudged simulations and their derivatives with respect to a model's numbers.
 *
 * Model: z (θ) are features of simulated less recorded positions in units of the noise, with
 *   the model at θ nudged to the recording.
 * Assumption: z is linear in θ over a step of a finite difference. The rest is run-to-run
 *   variability: tiny changes that grow, as wrinkles fall one way or the other. Its directions
 *   are few samples; along each it counts with ten times their variance.
 *   A fault of the recording is in θ as physics is: x is drawn to the recording without it and then
 *   compared with the recording as it would have it.
 * Formula: Bᵢ = (z (θ + hᵢeᵢ) − z (θ − hᵢeᵢ)) / 2hᵢ for free numbers; for effects, which lie at their
 *   null, (z (θ + hᵢeᵢ) − z̄) / hᵢ, where z̄ is the mean of the midpoints of those pairs. How the
 *   midpoints and z (θ) scatter about their mean shows the variability.
 *   What is to be explained is z less that of the discrepancy, in units of its own noise.
 * Reference: Kennedy and O'Hagan 2001 (discrepancy).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/sensitivities.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"

/* Variability counts as so many times the variance of its samples, which are few. */
#define VARIABILITY_WIDTH 10.
/* @options: (out caller-allocates): the default values
 */
void
cloth_estimate_options_init (ClothEstimateOptions * options)
{
  *options = (ClothEstimateOptions) {
  .gain = 1600.,.n_waves = 8,.block_s = 0.5,.highest_hz =
        10.,.overdispersion = 5.};
}

/* @recording: a recording; must outlive them
 * @options: how to simulate
 */
ClothSensitivities *
cloth_sensitivities_new (const ClothRecording * recording,
    const ClothEstimateOptions * options)
{
  ClothSensitivities *sensitivities = g_new0 (ClothSensitivities, 1);

  sensitivities->recording = recording;
  sensitivities->features = cloth_features_new (recording, options->n_waves,
      options->block_s, options->highest_hz);
  return sensitivities;
}

static void
forget (ClothSensitivities * sensitivities)
{
  g_clear_pointer (&sensitivities->z, g_free);
  g_clear_pointer (&sensitivities->columns, g_free);
  g_clear_pointer (&sensitivities->variability, g_free);
  g_clear_pointer (&sensitivities->sound, g_free);
}

/* @sensitivities: sensitivities, linearised
 * @options: how to simulate
 *
 * Returns: (transfer full): another one of the same recording, linearised at the same
 *   model
 */
ClothSensitivities *
cloth_sensitivities_copy (const ClothSensitivities * sensitivities,
    const ClothEstimateOptions * options)
{
  ClothSensitivities *copy =
      cloth_sensitivities_new (sensitivities->recording, options);
  gsize row = sensitivities->features->size * sizeof (gdouble);

  copy->discrepancy = sensitivities->discrepancy;
  copy->m = sensitivities->m;
  copy->n_variability = sensitivities->n_variability;
  copy->sound =
      g_memdup2 (sensitivities->sound, sensitivities->m * sizeof (gboolean));
  copy->z = g_memdup2 (sensitivities->z, row);
  copy->columns = g_memdup2 (sensitivities->columns, sensitivities->m * row);
  copy->variability =
      g_memdup2 (sensitivities->variability,
      sensitivities->n_variability * row);
  if (sensitivities->residual_variance)
    copy->residual_variance =
        cloth_power_spectrum_copy (sensitivities->residual_variance);
  return copy;
}

/* @sensitivities: (nullable) (transfer full): sensitivities
 */
void
cloth_sensitivities_free (ClothSensitivities * sensitivities)
{
  if (!sensitivities)
    return;
  forget (sensitivities);
  cloth_power_spectrum_free (sensitivities->residual_variance);
  cloth_features_free (sensitivities->features);
  g_free (sensitivities);
}

/* @sensitivities: sensitivities
 *
 * Returns: what the discrepancy's features are to be multiplied by: each recording's are in
 *   multiples of its own noise; 0 without a discrepancy
 */
gdouble
cloth_sensitivities_discrepancy_scale (const ClothSensitivities * sensitivities)
{
  return sensitivities->discrepancy ? sensitivities->discrepancy->
      features->sigma / sensitivities->features->sigma : 0.;
}

/* @sensitivities: sensitivities
 *
 * Returns: how many directions are known in which variability moves the residual, that of the
 *   discrepancy included
 */
guint
cloth_sensitivities_count_variability (const ClothSensitivities * sensitivities)
{
  return sensitivities->n_variability +
      (sensitivities->discrepancy ? sensitivities->
      discrepancy->n_variability : 0);
}

/* @sensitivities: sensitivities
 * @columns: (out) (array): cloth_sensitivities_count_variability () directions, each of features->size
 */
void
cloth_sensitivities_get_variability (const ClothSensitivities * sensitivities,
    gdouble * columns)
{
  gsize size = sensitivities->features->size, own =
      sensitivities->n_variability * size;
  gdouble scale = cloth_sensitivities_discrepancy_scale (sensitivities);

  if (own)
    memcpy (columns, sensitivities->variability, own * sizeof (gdouble));
  for (gsize k = 0;
      sensitivities->discrepancy
      && k < sensitivities->discrepancy->n_variability * size; k++)
    columns[own + k] = scale * sensitivities->discrepancy->variability[k];
}

/* @sensitivities: sensitivities
 * @i: one of the directions of cloth_sensitivities_get_variability ()
 *
 * Returns: of how far variability goes along it, over the noise's variance
 */
gdouble
cloth_sensitivities_get_variability_precision (const ClothSensitivities *
    sensitivities, guint i)
{
  return (i <
      sensitivities->
      n_variability ? sensitivities->n_variability : sensitivities->
      discrepancy->n_variability) / VARIABILITY_WIDTH;
}

/* @sensitivities: sensitivities
 * @z: (inout) (array): features of a residual
 *
 * Takes off what the simulator itself is off by, if there is a discrepancy.
 */
void
cloth_sensitivities_take_off_discrepancy (const ClothSensitivities *
    sensitivities, gdouble * z)
{
  gdouble scale = cloth_sensitivities_discrepancy_scale (sensitivities);

  for (gsize k = 0;
      sensitivities->discrepancy && k < sensitivities->features->size; k++)
    z[k] -= scale * sensitivities->discrepancy->z[k];
}

/* @sensitivities: sensitivities
 *
 * Returns: (transfer full) (array): what is to be explained: z less that of the discrepancy
 */
gdouble *
cloth_sensitivities_residual (const ClothSensitivities * sensitivities)
{
  gdouble *z = g_memdup2 (sensitivities->z,
      sensitivities->features->size * sizeof (gdouble));

  cloth_sensitivities_take_off_discrepancy (sensitivities, z);
  return z;
}

/* Models that are simulated side by side, each drawn to the recording without what the model says
 * was wrong with it. */
typedef struct
{
  const ClothSensitivities *sensitivities;
  gdouble **z;                  /* of each model */
  ClothMeasurement *measurements;       /* of each model */
  const ClothRecording **targets;       /* of each model */
  GPtrArray *corrected;         /* recordings */
  gdouble *recorded;            /* of each model: a frame, as it would be recorded */
  gdouble **paths;              /* of each model: all frames so, where one hangs on others */
  guint n;
} Batch;

static void
batch_clear (Batch * b)
{
  for (guint i = 0; b->paths && i < b->n; i++)
    g_free (b->paths[i]);
  g_free (b->paths);
  g_free (b->measurements);
  g_free (b->targets);
  g_free (b->recorded);
  g_clear_pointer (&b->corrected, g_ptr_array_unref);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Batch, batch_clear);

/* What draws a model: the recording itself, or one that was corrected for another model, too. */
static const ClothRecording *
find_target (const Batch * b, guint model)
{
  const ClothRecording *recording = b->sensitivities->recording;
  const ClothMeasurement *m = &b->measurements[model];

  if (cloth_measurement_is_null (m))
    return recording;
  for (guint i = 0; i < model; i++)
    if (cloth_measurement_is_equal (m, &b->measurements[i]))
      return b->targets[i];
  g_ptr_array_add (b->corrected, cloth_recording_correct (recording, m));
  return g_ptr_array_index (b->corrected, b->corrected->len - 1);
}

static gboolean
batch_init (Batch * b, const ClothSensitivities * sensitivities,
    ClothModel ** models, guint n, gdouble ** z, GError ** error)
{
  const ClothRecording *r = sensitivities->recording;

  *b = (Batch) {
  sensitivities, z,.n = n};
  b->measurements = g_new (ClothMeasurement, n);
  b->targets = g_new (const ClothRecording *, n);
  b->corrected =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_recording_free);
  b->recorded = g_new (gdouble, 3 * (gsize) r->n * n);
  b->paths = g_new0 (gdouble *, n);
  for (guint i = 0; i < n; i++) {
    if (!cloth_recording_find_measurement (r, models[i], &b->measurements[i],
            error))
      return FALSE;
    b->targets[i] = find_target (b, i);
    if (cloth_measurement_takes_time (&b->measurements[i]))
      b->paths[i] = g_new (gdouble, 3 * (gsize) r->n * r->n_frames);
  }
  return TRUE;
}

static void
collect (gpointer data, guint model, guint frame, const gdouble * positions)
{
  const Batch *b = data;
  const ClothRecording *r = b->sensitivities->recording;
  const ClothMeasurement *m = &b->measurements[model];
  const gsize row = 3 * (gsize) r->n;
  gdouble *recorded = b->paths[model] ? b->paths[model] + frame * row :
      b->recorded + model * row;

  if (!cloth_measurement_is_null (m)) {
    cloth_measurement_apply (m, r->scene->topology, positions, recorded);
    positions = recorded;
  }
  if (!b->paths[model])
    cloth_features_add (b->sensitivities->features, r, frame, positions,
        b->z[model]);
}

/* Of models let go in windows; those nudged beside them only lead up to these. */
static void
collect_windows (gpointer data, guint model, guint frame,
    const gdouble * positions)
{
  const Batch *b = data;

  if (model < b->n)
    collect (data, model, frame, positions);
}

static void
collect_paths (const Batch * b)
{
  const ClothRecording *r = b->sensitivities->recording;

  for (guint i = 0; i < b->n; i++) {
    if (!b->paths[i])
      continue;
    cloth_recording_measure (r, b->paths[i], &b->measurements[i]);
    for (guint frame = 0; frame < r->n_frames; frame++)
      cloth_features_add (b->sensitivities->features, r, frame,
          b->paths[i] + 3 * (gsize) frame * r->n, b->z[i]);
  }
}

/* @sensitivities: sensitivities
 * @models: (array length=n): models
 * @n: how many
 * @options: how to simulate
 * @z: (inout) (array length=n): of each model, the features of the residual, each
 *   features->size; start with zeros
 * @sound: (out) (array length=n): which models did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped or a model says that something
 *   was wrong with the recording that can't have been
 *
 * Simulates models side by side, each drawn to the recording without what the model says was wrong
 * with it. The residual is what would be recorded of them, with it, less the recording as it is:
 * its noise is the same for all.
 *
 * Returns: whether that could be done
 */
gboolean
cloth_sensitivities_run (const ClothSensitivities * sensitivities,
    ClothModel ** models, guint n, ClothEstimateOptions * options, gdouble ** z,
    gboolean * sound, GError ** error)
{
  g_autofree gdouble *gains = g_new (gdouble, n);
  g_auto (Batch) b = { NULL };

  if (!batch_init (&b, sensitivities, models, n, z, error))
    return FALSE;
  for (guint i = 0; i < n; i++)
    gains[i] = options->gain;
  options->simulations += n;
  if (options->window_s > 0. ?
      !cloth_rollout_windows (b.targets,
          (const ClothModel * const *) models, n, options->gain,
          options->window_s, &options->rollout, collect_windows, &b, sound,
          error) :
      !cloth_rollout_nudged (b.targets, (const ClothModel * const *) models,
          gains, n, &options->rollout, collect, &b, sound, error))
    return FALSE;
  collect_paths (&b);
  return TRUE;
}

/* Features of one linearisation: of the model, of it moved along each direction, and of
 * it moved back along those that are looked at from both sides. */
typedef struct
{
  GPtrArray *models;
  gdouble **z;                  /* by model */
  gboolean *sound;              /* by model */
  guint *back;                  /* of each direction: a model, 0 for none */
  gdouble *memory;              /* of the models moved back */
  gdouble *reference;           /* what columns are differences from */
} Moved;

static void
moved_clear (Moved * moved)
{
  g_clear_pointer (&moved->models, g_ptr_array_unref);
  g_free (moved->z);
  g_free (moved->sound);
  g_free (moved->back);
  g_free (moved->memory);
  g_free (moved->reference);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Moved, moved_clear);

static void
move (Moved * moved, ClothSensitivities * sensitivities,
    const ClothCandidates * candidates, const ClothModel * model,
    const guint * directions, guint m)
{
  gsize size = sensitivities->features->size;
  guint n;

  moved->models =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_model_free);
  moved->back = g_new0 (guint, m + 1);
  g_ptr_array_add (moved->models, cloth_model_copy (model));
  for (guint side = 0; side < 2; side++)
    for (guint i = 0; i < m; i++) {
      gdouble step = cloth_candidates_direction (candidates,
          directions[i])->step;

      if (side && (directions[i] >= candidates->n_free
              || !cloth_candidates_has_room (candidates, model,
                  directions[i], step)))
        continue;
      if (side) {
        moved->back[i] = moved->models->len;
        step = -step;
      }
      g_ptr_array_add (moved->models, cloth_candidates_move (candidates,
              model, &directions[i], &step, 1));
    }
  n = moved->models->len;
  moved->sound = g_new (gboolean, n);
  moved->z = g_new (gdouble *, n);
  moved->memory = g_new0 (gdouble, (n - m) * size);
  for (guint i = 0; i < n; i++)
    moved->z[i] =
        i == 0 ? sensitivities->z : i <=
        m ? sensitivities->columns + (i - 1) * size : moved->memory + (i - m -
        1) * size;
}

/* Where the model is, seen from both sides: the mean of such pairs of runs. What variability did
 * to the model's own run is in its residual and must not be in the columns too, or each of
 * them would seem to explain some of it. How the pairs differ shows what variability does. */
static void
find_reference (Moved * moved, ClothSensitivities * sensitivities)
{
  gsize size = sensitivities->features->size;
  g_autofree guint *pairs = g_new (guint, sensitivities->m + 1);
  gdouble *reference, *variability;
  guint n = 0;

  for (guint i = 0; i < sensitivities->m; i++)
    if (moved->back[i] && moved->sound[moved->back[i]] && moved->sound[i + 1])
      pairs[n++] = i;
  sensitivities->n_variability = n ? n + 1 : 0;
  moved->reference = reference = g_new0 (gdouble, size);
  sensitivities->variability = variability =
      g_new0 (gdouble, sensitivities->n_variability * size + 1);
  for (guint p = 0; p < n; p++, variability += size) {
    const gdouble *before = moved->z[moved->back[pairs[p]]];
    const gdouble *behind = moved->z[pairs[p] + 1];

    for (gsize k = 0; k < size; k++) {
      variability[k] = 0.5 * (before[k] + behind[k]);
      reference[k] += (variability[k] - reference[k]) / (p + 1);
    }
  }
  if (!n) {
    memcpy (reference, sensitivities->z, size * sizeof (gdouble));
    return;
  }
  memcpy (variability, sensitivities->z, size * sizeof (gdouble));
  for (gsize k = 0; k < size; k++) {
    gdouble mean = (n * reference[k] + variability[k]) / (n + 1);

    for (guint p = 0; p <= n; p++)
      sensitivities->variability[p * size + k] -= mean;
  }
}

/* @sensitivities: sensitivities
 * @candidates: what directions mean
 * @model: where to take derivatives
 * @directions: (array length=m): with respect to what
 * @m: how many
 * @options: how
 * @error: #ClothSimError, or #ClothFitError when the model itself can't be simulated
 *
 * Fills @sensitivities's z, columns, sound and variability. Directions along which the simulation fails
 * have columns of zeros. Free numbers are moved to both sides; the others' columns are
 * differences from the mean of these. That of an effect which is there or not is what it changes.
 */
gboolean
cloth_sensitivities_linearise (ClothSensitivities * sensitivities,
    const ClothCandidates * candidates, const ClothModel * model,
    const guint * directions, guint m, ClothEstimateOptions * options,
    GError ** error)
{
  g_auto (Moved) moved = { NULL };
  gsize size = sensitivities->features->size;

  forget (sensitivities);
  sensitivities->m = m;
  sensitivities->z = g_new0 (gdouble, size);
  sensitivities->columns = g_new0 (gdouble, m * size + 1);
  sensitivities->sound = g_new0 (gboolean, m + 1);
  move (&moved, sensitivities, candidates, model, directions, m);
  if (!cloth_sensitivities_run (sensitivities,
          (ClothModel **) moved.models->pdata, moved.models->len, options,
          moved.z, moved.sound, error))
    return FALSE;
  if (!moved.sound[0]) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "%s: the "
        "simulation diverges; give the model softer cloth, more damping or a "
        "smaller time_step", sensitivities->recording->name);
    return FALSE;
  }
  find_reference (&moved, sensitivities);
  for (guint i = 0; i < m; i++) {
    gdouble step = cloth_candidates_direction (candidates,
        directions[i])->step;
    guint back = moved.back[i];
    gdouble *column = sensitivities->columns + i * size;
    const gdouble *from;

    sensitivities->sound[i] = moved.sound[i + 1];
    if (back && moved.sound[back])
      step *= 2.;
    else
      back = 0;
    from = back ? moved.z[back] : moved.reference;
    for (gsize k = 0; k < size; k++)
      column[k] = sensitivities->sound[i] ? (column[k] - from[k]) / step : 0.;
  }
  return TRUE;
}
