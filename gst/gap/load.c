/* The recordings of a diagnosis: read, checked and noted among its inputs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/load.h"

#include <math.h>

#include "gst/file/hash.h"
#include "gst/fit/error.h"

/* Most steps of a simulation for each frame. */
#define MOST_STEPS 2e4

static gboolean
load_one (ClothDiagnosis * d, ClothTake * take, ClothGapRole role,
    GError ** error)
{
  ClothRecording *r = cloth_recording_new (take, error), *first;
  g_autofree gchar *sha256 = NULL;

  if (!r)
    return FALSE;
  g_ptr_array_add (d->recordings, r);
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
 * Reads the takes, the baselines and the hold-outs, which must be of the same cloth, and notes
 * their names and hashes.
 *
 * Returns: whether they and the model can be used
 */
gboolean
cloth_diagnosis_load (ClothDiagnosis * d, const ClothModel * model,
    GError ** error)
{
  const ClothGapOptions *o = d->options;

  for (guint i = 0; i < d->n_takes; i++)
    if (!load_one (d, d->takes[i], CLOTH_GAP_TAKE, error))
      return FALSE;
  for (guint i = 0; i < o->n_baselines; i++)
    if (!load_one (d, o->baselines[i], CLOTH_GAP_BASELINE, error))
      return FALSE;
  for (guint i = 0; i < o->n_hold_outs; i++)
    if (!load_one (d, o->hold_outs[i], CLOTH_GAP_HOLD_OUT, error))
      return FALSE;
  note_model (d);
  return check_steps (d, model, error);
}
