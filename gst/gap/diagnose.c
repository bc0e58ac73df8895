/* The diagnosis, stage by stage.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/diagnose.h"

#include "config.h"

#include <math.h>

#include "gst/gap/camera/faults.h"
#include "gst/gap/design/propose.h"
#include "gst/gap/inference/candidates.h"
#include "gst/gap/inference/free-numbers.h"
#include "gst/gap/inference/infer.h"
#include "gst/gap/load.h"
#include "gst/gap/localise/null-distribution.h"
#include "gst/gap/localise/where.h"
#include "gst/gap/loop/refit.h"
#include "gst/gap/report/patch.h"
#include "gst/gap/verdict/agreement.h"
#include "gst/gap/verdict/confirm.h"
#include "gst/gap/verdict/failure.h"
#include "gst/gap/verdict/implausible.h"
#include "gst/gap/verdict/judge.h"
#include "gst/gap/verdict/measure.h"

/* Version of the priors and thresholds: a change of either changes probabilities. */
#define PRIORS "5"

/* The stages. Each reads what those before it wrote into the diagnosis. */
static gboolean
diagnose (ClothDiagnosis * d, const ClothModel * model, GError ** error)
{
  gchar *implausible;

  /* Reads the takes, baselines, hold-outs and their twins; writes the recordings and the studies. */
  if (!cloth_diagnosis_load (d, model, error))
    return FALSE;
  /* Reads the recordings; writes the reason why nothing can be decided, if there is one. */
  d->result->reason = cloth_diagnosis_find_implausible_input (d, model);
  if (d->result->reason)
    return TRUE;
  /* Reads the observations; writes the camera faults, and the recordings without them. */
  cloth_diagnosis_find_faults (d);
  /* Reads the model and the wanted effects; writes the directions that are fitted and tested. */
  if (!cloth_diagnosis_list_candidates (d, model, error))
    return FALSE;
  /* Reads the studies of the baselines and the twins, without any those of the takes; writes the
   * fitted model and the precisions of its free numbers. */
  if (!cloth_diagnosis_fit_free (d, model, error))
    return FALSE;
  /* Reads the studies of takes, baselines and twins; writes the posterior over effects, those that
   * are accepted and the model with them. */
  if (!cloth_diagnosis_infer (d, error))
    return FALSE;
  /* Reads the candidates and the ranked effects; writes those that could not be tested. */
  cloth_diagnosis_note_untested (d);
  /* Reads the models with and without the effects; writes the gap of each take, its floor, its shrink. */
  if (!cloth_diagnosis_measure (d, error))
    return FALSE;
  /* Reads all takes and hold-outs with the accepted effects; writes whether they agree on them. */
  if (!cloth_diagnosis_test_agreement (d, error))
    return FALSE;
  /* Reads the energies of residuals and the camera errors; writes frequencies, waves, stages. */
  cloth_diagnosis_locate (d);
  /* Reads the gaps, the accepted effects and the camera faults; writes the verdict. */
  cloth_diagnosis_decide (d);
  /* Reads the verdict and the gaps; writes the reason why they decide nothing. */
  implausible = cloth_diagnosis_find_implausible_result (d, model);
  if (implausible) {
    g_free (d->result->reason);
    d->result->reason = implausible;
    d->result->verdict = CLOTH_GAP_UNDECIDABLE;
  }
  /* Reads the gaps of simulations that lack nothing; writes the band over time, the place and
   * the onset. */
  cloth_diagnosis_fill_null_distribution (d);
  /* Reads the groups of effects that can't be told apart; writes what to film next. */
  if (!cloth_diagnosis_propose (d, error))
    return FALSE;
  /* Reads the accepted effects and the takes; lets the user's simulator run, if there is a command
   * for it; writes what to change there, and what it makes with that of what judges. */
  if (!cloth_diagnosis_refit (d, error))
    return FALSE;
  /* Reads what the user's simulator made with the effects; writes the measured shrink. */
  if (!cloth_diagnosis_measure_after (d, error))
    return FALSE;
  /* Reads that; corrects the verdict. */
  cloth_diagnosis_confirm (d);
  return TRUE;
}

/* A model that diverges, even without an effect, decides nothing; a report says so. Other failures,
 * and a model that could not be simulated at all, make none. */
static gboolean
is_undecidable (ClothDiagnosis * d, const GError * failed)
{
  if (!d->candidates || !g_error_matches (failed, CLOTH_FIT_ERROR,
          CLOTH_FIT_ERROR_MODEL))
    return FALSE;
  d->result->verdict = CLOTH_GAP_UNDECIDABLE;
  g_free (d->result->reason);
  d->result->reason = cloth_diagnosis_find_noise (d);
  if (!d->result->reason)
    d->result->reason = g_strdup_printf ("%s.", failed->message);
  return TRUE;
}

/* What was decided by, and with what. */
static void
fill_provenance (const ClothDiagnosis * d, gint64 start)
{
  ClothGapResult *result = d->result;

  result->seed = d->options->seed;
  result->simulations = d->study.simulations;
  result->seconds = (g_get_monotonic_time () - start) * 1e-6;
  cloth_gap_result_add_version (result, PACKAGE, PACKAGE_VERSION);
  cloth_gap_result_add_version (result, "priors", PRIORS);
  cloth_gap_result_add_threshold (result, "least probability of an accepted "
      "effect", 0.5, "1", CLOTH_GAP_ORIGIN_DEFINITION, "It is likelier than "
      "not.");
  cloth_gap_result_add_threshold (result, "least probability of something "
      "unknown", 0.5, "1", CLOTH_GAP_ORIGIN_DEFINITION, "It is likelier than "
      "not.");
  cloth_gap_result_add_threshold (result, "least share of the gap that is "
      "unknown", CLOTH_DIAGNOSIS_LEAST_SHARE, "1",
      CLOTH_GAP_ORIGIN_PARAMETER, "Less is not worth a word.");
  if (d->options->simulator)
    cloth_gap_result_add_threshold (result, "most runs of your simulator of "
        "each take, to find its numbers", d->options->simulator_runs, "1",
        CLOTH_GAP_ORIGIN_PARAMETER, "--simulator-runs.");
  if (d->afters->len)
    cloth_gap_result_add_threshold (result, "largest rest in your simulator "
        "over the floor, of variance", CLOTH_DIAGNOSIS_LARGEST_REST, "1",
        CLOTH_GAP_ORIGIN_PARAMETER, "One and a half floors, RMS.");
}

/* @takes: (array length=n_takes): what was recorded
 * @n_takes: how many, at least one; of the same cloth
 * @model: what the simulator knows
 * @options: what else is given
 * @error: #ClothFitError, #ClothSimError, or what reading a take says
 *
 * Runs the simulation with weak springs to what was recorded, finds the posterior over all
 * sets of effects given the residual, what simulators differ by when nothing acts, and what the
 * model must agree with, and measures the gap without and with those that are likelier than not.
 *
 * Returns: (transfer full) (nullable): what was found
 */
ClothGapResult *
cloth_gap_diagnose (ClothTake ** takes, guint n_takes,
    const ClothModel * model, const ClothGapOptions * options, GError ** error)
{
  g_auto (ClothDiagnosis) d = { NULL };
  g_autoptr (GError) failed = NULL;
  gint64 start = g_get_monotonic_time ();

  cloth_diagnosis_init (&d, takes, n_takes, options);
  d.study.rollout.failed = cloth_diagnosis_note_failure;
  if (!diagnose (&d, model, &failed) && !is_undecidable (&d, failed)) {
    g_propagate_error (error, g_steal_pointer (&failed));
    return NULL;
  }
  if (d.model)
    d.result->model =
        d.with ? g_steal_pointer (&d.with) : g_steal_pointer (&d.model);
  if (d.result->model && d.result->verdict != CLOTH_GAP_UNDECIDABLE
      && !options->simulator)
    cloth_gap_result_fill_patch (d.result, model);
  fill_provenance (&d, start);
  return g_steal_pointer (&d.result);
}
