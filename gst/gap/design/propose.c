/* Decides what to film next: for each group of effects that the data can't tell apart, the capture
 * with the largest expected log Bayes factor between its two nearest effects (experiment.c).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/design/propose.h"

#include <math.h>
#include <string.h>

#include "gst/gap/design/experiment.h"

/* Of a larger group the likeliest are to be parted. */
#define MOST_MEMBERS 4
/* Share of what is left to do that each simulation is taken for. */
#define EACH 0.05

/* One of unknown size can't be simulated. */
static gboolean
acts (const ClothGapEffect * e)
{
  gboolean any = FALSE;

  for (guint k = 0; k < e->effect->n_parameters; k++) {
    if (isnan (e->values[k]))
      return FALSE;
    any |= e->values[k] != e->effect->parameters[k].null_value;
  }
  return any;
}

static void
put_effect (const ClothGapEffect * e, ClothModelEffect * to)
{
  *to = (ClothModelEffect) {
  e->effect};
  for (guint k = 0; k < e->effect->n_parameters; k++)
    to->values[k] = CLAMP (e->values[k], e->effect->parameters[k].min,
        e->effect->parameters[k].max);
}

/* The likeliest of a group; what was accepted and is not of it goes into the model. */
static guint
list_members (const ClothGapResult * result, gint group,
    ClothModelEffect * members, ClothModel * model)
{
  guint n = 0;

  for (guint i = 0; i < result->effects->len; i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);
    ClothModelEffect known;

    put_effect (e, &known);
    if (e->group == group && acts (e) && n < MOST_MEMBERS)
      members[n++] = known;
    else if (e->group != group && e->accepted)
      cloth_model_set_effect (model, known.effect, known.values);
  }
  return n;
}

static void
note_failures (ClothGapResult * result, const ClothStage * stage,
    const GArray * trials)
{
  for (guint i = 0; i < trials->len; i++) {
    const ClothTrial *t = &g_array_index (trials, ClothTrial, i);
    g_autofree gchar *what = cloth_stage_describe (stage, t->motion);

    if (isnan (t->log_bayes_factor))
      cloth_gap_result_add_failure (result, what, "The simulation of this "
          "capture diverged, so it was not considered.");
  }
}

static gboolean
propose_one (ClothDiagnosis * d, guint group, GError ** error)
{
  ClothGapGroup *g = &g_array_index (d->result->groups, ClothGapGroup, group);
  g_autoptr (ClothModel) model = cloth_model_copy (d->model);
  const ClothExperiment experiment = {
    cloth_diagnosis_recording (d, 0), model, d->candidates, d->precisions,
    d->discrepancy_variance
  };
  g_autoptr (ClothStage) stage = cloth_stage_new (experiment.recording);
  ClothModelEffect members[MOST_MEMBERS];
  guint n = list_members (d->result, (gint) group, members, model);
  g_autoptr (GArray) trials = NULL;
  const ClothTrial *best;

  if (!stage->held->len) {
    g->experiment = g_strdup ("Film the sheet held by its two upper corners: "
        "while nothing holds it, no other capture could be tried.");
    return TRUE;
  }
  trials = cloth_experiment_try (&experiment, members, n, &d->study, error);
  if (!trials)
    return FALSE;
  note_failures (d->result, stage, trials);
  best = cloth_experiment_choose (trials);
  if (!best)
    return TRUE;
  g->log_bayes_factor =
      MIN (best->log_bayes_factor, CLOTH_EXPERIMENT_MOST_LOG_BAYES_FACTOR);
  g->experiment = cloth_stage_describe (stage, best->motion);
  if (best->fps > g_array_index (trials, ClothTrial, 0).fps) {
    g_autofree gchar *slow = g->experiment;

    g->experiment = g_strdup_printf ("%s, at %.0f frames a second", slow,
        best->fps);
  }
  {
    g_autofree gchar *sentence = g->experiment;

    g->experiment = g_strconcat (sentence, ".", NULL);
  }
  return TRUE;
}

/* Fills the groups' experiments. Where nothing is amiss there is nothing to part. */
gboolean
cloth_diagnosis_propose (ClothDiagnosis * d, GError ** error)
{
  if (d->result->verdict == CLOTH_GAP_NO_GAP)
    return TRUE;
  for (guint i = 0; i < d->result->groups->len; i++) {
    /* cameras have theirs already */
    if (g_array_index (d->result->groups, ClothGapGroup, i).experiment)
      continue;
    cloth_diagnosis_begin_part (d, d->from, 1., EACH,
        "looking what to film next");
    /* of a capture one sentence says it, however many simulations it took */
    d->study.rollout.failed = NULL;
    if (!propose_one (d, i, error))
      return FALSE;
  }
  return TRUE;
}
