/* The recordings of a diagnosis: read, checked and noted among its inputs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/load.h"

#include <math.h>

#include "gst/file/hash.h"
#include "gst/fit/error.h"
#include "gst/gap/simulator/simulator.h"

/* Most steps of a simulation for each frame. */
#define MOST_STEPS 2e4

/* What is known of places that one camera saw, and of those that it can't be. */
static void
note_observed (ClothDiagnosis * d, const gchar * name,
    const ClothObservedCounts * c)
{
  g_autoptr (GString) note = g_string_new (NULL);

  g_string_printf (note, "%s has no positions: %.0f%% of its places are where "
      "rays meet", name, 100. * c->triangulated / c->places);
  if (c->single)
    g_string_append_printf (note, ", %.0f%% lie on one camera's ray, along "
        "which nothing is known: %.0f%% of their motion is the model's own "
        "there, and a gap along it is not seen", 100. * c->single / c->places,
        100. * c->along);
  if (c->contradicted)
    g_string_append_printf (note, ", and of %.1f%% the cameras contradict each "
        "other", 100. * c->contradicted / c->places);
  if (c->torn)
    g_string_append_printf (note, "; %.1f%% are where no cloth can be, and "
        "count as not seen", 100. * c->torn / c->places);
  g_string_append_c (note, '.');
  cloth_gap_result_add_note (d->result, note->str);
}

/* What a diagnosis can't tell where the clamps' paths come from the cloth itself. */
static void
note_paths (ClothDiagnosis * d, const ClothRecording * r)
{
  const ClothScene *scene = r->scene;
  g_autofree gchar *note = NULL;
  gdouble worst = 0.;

  for (gsize k = 0; scene->clamps_sd
      && k < (gsize) r->n_frames * scene->held->len; k++)
    worst = fmax (worst, scene->clamps_sd[k]);
  if (worst == 0.)
    return;
  note = g_strdup_printf ("Of %s the clamps' paths were not all logged; they "
      "are taken from the cloth, to %.1f mm at worst, so nothing is said of "
      "what clamps and measurement may do wrong.", r->name, 1e3 * worst);
  cloth_gap_result_add_note (d->result, note);
}

/* A user's simulator follows the log of the clamps. */
static gboolean
check_paths_are_logged (const ClothDiagnosis * d, const ClothRecording * r,
    GError ** error)
{
  if (!r->scene->clamps_sd || (!d->options->simulator
          && d->options->n_simulated == 0))
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s: the "
      "paths of its clamps were not logged, so your simulator can't have "
      "followed them; run “gst-cloth-fit-1.0 fit” and diagnose the take that "
      "it writes, whose paths are known", r->name);
  return FALSE;
}

/* From its positions, or from what cameras saw. */
static ClothRecording *
make_recording (ClothDiagnosis * d, ClothTake * take,
    const ClothModel * model, GError ** error)
{
  const ClothObservations *observations = cloth_diagnosis_observations (d,
      d->recordings->len);
  ClothObservedCounts counts;
  ClothRecording *r;

  if (!observations
      || cloth_take_get_n_positions (take) == cloth_take_get_n_frames (take))
    return cloth_recording_new (take, error);
  r = cloth_recording_new_observed (take, observations, model, d->study.gain,
      &d->study.rollout, &counts, error);
  if (r)
    note_observed (d, r->name, &counts);
  return r;
}

static gboolean
load_one (ClothDiagnosis * d, ClothTake * take, const ClothModel * model,
    ClothGapRole role, GError ** error)
{
  ClothRecording *r = make_recording (d, take, model, error), *first;
  g_autofree gchar *sha256 = NULL;

  if (!r)
    return FALSE;
  g_ptr_array_add (d->recordings, r);
  if (role != CLOTH_GAP_BASELINE && !check_paths_are_logged (d, r, error))
    return FALSE;
  if (!cloth_recording_refine_paths (r, model, d->study.gain,
          &d->study.rollout, error))
    return FALSE;
  note_paths (d, r);
  first = cloth_diagnosis_recording (d, 0);
  if (!cloth_gap_check_same_cloth (r->name, r->scene->topology, first->name,
          first->scene->topology, error) ||
      !(sha256 = cloth_take_sha256 (take, error)))
    return FALSE;
  /* the same cloth may be filmed twice */
  for (guint i = 0; i + 1 < d->recordings->len
      && !cloth_diagnosis_has_observations (d); i++)
    if (!cloth_recording_check_other (r, cloth_diagnosis_recording (d, i),
            error))
      return FALSE;
  cloth_gap_result_add_input (d->result, role, r->name, sha256);
  if (role != CLOTH_GAP_HOLD_OUT)
    g_ptr_array_add (d->studies, cloth_sensitivities_new (r, &d->study));
  return TRUE;
}

/* What was simulated of one recording. */
static gboolean
load_twin (ClothDiagnosis * d, ClothTake * take, ClothRecording * recorded,
    ClothGapRole role, GPtrArray * twins, GError ** error)
{
  g_autoptr (ClothRecording) twin = cloth_recording_new_twin (take, recorded,
      error);
  g_autofree gchar *sha256 = NULL;
  const guint n = cloth_take_get_n_frames (take);
  gdouble more_s;

  if (twin && d->options->simulator) {
    g_free (twin->name);
    twin->name = g_strdup (d->options->simulator->capabilities->simulator);
  }
  if (!twin || !cloth_recording_check_other (twin, recorded, error)
      || !(sha256 = cloth_take_sha256 (take, error)))
    return FALSE;
  cloth_recording_see_alike (recorded, twin);
  if (twin->between > 0.) {
    g_autofree gchar *note =
        g_strdup_printf ("Between its frames %s is known to "
        "%.2g m only, which counts as noise; written at the times of %s it would "
        "tell more.", twin->name, twin->between, recorded->name);

    cloth_gap_result_add_note (d->result, note);
  }
  more_s = cloth_take_get_time (take, n - 1) -
      recorded->times[recorded->n_frames - 1] + recorded->times[0] -
      cloth_take_get_time (take, 0);
  if (more_s > 1.5 * (cloth_take_get_time (take, n - 1) -
          cloth_take_get_time (take, 0)) / (n - 1)) {
    g_autofree gchar *note = g_strdup_printf ("%s is %.3g s longer than %s; "
        "what is before and after was cut.", twin->name, more_s,
        recorded->name);

    cloth_gap_result_add_note (d->result, note);
  }
  cloth_gap_result_add_input (d->result, role, twin->name, sha256);
  g_ptr_array_add (twins, g_steal_pointer (&twin));
  return TRUE;
}

static gboolean
check_count (guint n, guint wanted, const gchar * what, const gchar * of,
    GError ** error)
{
  if (n == 0 || n == wanted)
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "there are "
      "%u %s for %u recordings; give one for each %s, in their order, or none",
      n, what, wanted, of);
  return FALSE;
}

/* @d: a diagnosis whose recordings are loaded
 * @recording: a take or a hold-out
 * @values: the numbers of the user's simulator
 * @error: #ClothSimulatorError, and what reading a take says
 *
 * Lets the user's simulator run.
 *
 * Returns: (transfer full) (nullable): what it made of the recording
 */
ClothTake *
cloth_diagnosis_run_simulator (ClothDiagnosis * d, guint recording,
    const gdouble * values, GError ** error)
{
  const guint end = d->n_takes + d->options->n_baselines;

  return cloth_gap_simulator_run (d->options->simulator, recording < end ?
      d->takes[recording] : d->options->hold_outs[recording - end], values,
      error);
}

/* As those that are given, made here. */
static gboolean
simulate_twins (ClothDiagnosis * d, GError ** error)
{
  const ClothGapOptions *o = d->options;
  g_autofree gdouble *values =
      cloth_gap_simulator_defaults (o->simulator->capabilities);

  for (guint i = 0; i < d->recordings->len; i++) {
    g_autoptr (ClothTake) twin = NULL;

    if (i >= d->n_takes && i < d->n_takes + o->n_baselines)
      continue;
    cloth_diagnosis_begin_part (d, 0., 0., 1., "running your simulator");
    if (o->progress && !o->progress (o->progress_data, 0., d->what)) {
      g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED,
          "stopped");
      return FALSE;
    }
    twin = cloth_diagnosis_run_simulator (d, i, values, error);
    if (!twin || !load_twin (d, twin, cloth_diagnosis_recording (d, i),
            CLOTH_GAP_SIMULATED, d->twins, error))
      return FALSE;
  }
  return TRUE;
}

/* @d: a diagnosis
 * @recording: a take or a hold-out
 * @values: the numbers of the user's simulator
 * @error: #ClothSimulatorError, #ClothFitError, and what reading a take says
 *
 * Lets the user's simulator run with the accepted effects added, and keeps what it made among those
 * after.
 *
 * Returns: whether it can be used
 */
gboolean
cloth_diagnosis_add_after (ClothDiagnosis * d, guint recording,
    const gdouble * values, GError ** error)
{
  g_autoptr (ClothTake) after = cloth_diagnosis_run_simulator (d, recording,
      values, error);

  return after && load_twin (d, after, cloth_diagnosis_recording (d,
          recording), CLOTH_GAP_SIMULATED_AFTER, d->afters, error);
}

/* The twins, which are seen where their recordings are, and those of what judges with the effect
 * added; those of the takes are what the model must agree with. */
static gboolean
load_twins (ClothDiagnosis * d, GError ** error)
{
  const ClothGapOptions *o = d->options;
  const guint judges = o->n_hold_outs ? d->n_takes + o->n_baselines : 0;

  if (!check_count (o->n_simulated, d->n_takes + o->n_hold_outs, "simulations",
          "take and then each hold-out", error)
      || !check_count (o->n_after,
          o->n_hold_outs ? o->n_hold_outs : d->n_takes,
          "simulations with the effect added",
          o->n_hold_outs ? "hold-out" : "take", error))
    return FALSE;
  if (o->n_after && !o->n_simulated) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "simulations with the effect added say nothing without those before; "
        "give these too");
    return FALSE;
  }
  for (guint i = 0; i < o->n_simulated; i++)
    if (!load_twin (d, o->simulated[i], cloth_diagnosis_recording (d,
                i < d->n_takes ? i : o->n_baselines + i), CLOTH_GAP_SIMULATED,
            d->twins, error))
      return FALSE;
  for (guint i = 0; i < o->n_after; i++) {
    if (!load_twin (d, o->after[i], cloth_diagnosis_recording (d, judges + i),
            CLOTH_GAP_SIMULATED_AFTER, d->afters, error))
      return FALSE;
    cloth_recording_see_alike (cloth_diagnosis_recording (d, judges + i),
        cloth_diagnosis_twin (d, judges + i));
  }
  if (o->simulator && !simulate_twins (d, error))
    return FALSE;
  for (guint i = 0; d->twins->len && i < d->n_takes; i++)
    g_ptr_array_add (d->studies,
        cloth_sensitivities_new (cloth_diagnosis_twin (d, i), &d->study));
  d->result->has_simulated = d->twins->len > 0;
  return TRUE;
}

/* A stream may outlive its model's file: then there is no hash. */
static void
note_model (ClothDiagnosis * d)
{
  const gchar *path = d->options->model_file;
  g_autofree gchar *name = path ? g_path_get_basename (path) : NULL;
  g_autofree gchar *sha256 = path ? cloth_file_sha256 (path, NULL) : NULL;

  if (path)
    cloth_gap_result_add_input (d->result, CLOTH_GAP_MODEL, name, sha256);
}

/* Refuses a model that needs too many steps for a frame: it would seem to hang, as progress is
 * told once a frame. */
static gboolean
check_steps (ClothDiagnosis * d, const ClothModel * model, GError ** error)
{
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  const ClothRecording *r = cloth_diagnosis_recording (d, 0);
  g_autoptr (ClothSim) sim = cloth_sim_new (r->scene, &model, 1, &options,
      error);
  gdouble steps;

  if (!sim)
    return FALSE;
  /* frames further apart are found implausible anyway */
  steps = fmin ((r->times[r->n_frames - 1] - r->times[0]) / (r->n_frames - 1),
      CLOTH_DIAGNOSIS_WINDOW_S) / cloth_sim_get_time_step (sim);
  if (steps <= MOST_STEPS)
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "the model needs "
      "%.2g steps a frame of %s, and a diagnosis simulates it hundreds of "
      "times; lower “damping.stiffness” or the stiffnesses", steps,
      r->name);
  return FALSE;
}

/* @d: a diagnosis of nothing yet
 * @model: what the simulator knows
 * @error: #ClothFitError, #ClothSimError, or what reading a take says
 *
 * Reads the takes, the baselines and the hold-outs, which must be of the same cloth, and what was
 * simulated of them, and notes their names and hashes.
 *
 * Returns: whether they and the model can be used
 */
gboolean
cloth_diagnosis_load (ClothDiagnosis * d, const ClothModel * model,
    GError ** error)
{
  const ClothGapOptions *o = d->options;

  for (guint i = 0; i < d->n_takes; i++)
    if (!load_one (d, d->takes[i], model, CLOTH_GAP_TAKE, error))
      return FALSE;
  for (guint i = 0; i < o->n_baselines; i++)
    if (!load_one (d, o->baselines[i], model, CLOTH_GAP_BASELINE, error))
      return FALSE;
  for (guint i = 0; i < o->n_hold_outs; i++)
    if (!load_one (d, o->hold_outs[i], model, CLOTH_GAP_HOLD_OUT, error))
      return FALSE;
  if (!load_twins (d, error))
    return FALSE;
  note_model (d);
  return check_steps (d, model, error);
}
