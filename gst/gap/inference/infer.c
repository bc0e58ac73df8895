/* Which effects act: the posterior over all sets of them.
 *
 * Rounds: the takes are linearised at the likeliest set so far, first at none, where the ensemble runs,
 * and all sets are compared there (hypotheses.c). When the likeliest set is
 * the one at which they were linearised, or after three rounds, the posterior stands.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/infer.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/gap/inference/conclude.h"
#include "gst/gap/inference/gather.h"
#include "gst/gap/inference/prediction.h"

/* Rounds at most. */
#define N_ROUNDS 3
/* Simulations of the fit that measures the gap. */
#define N_REFIT 3
/* The reference's residual is taken off where the take has this share of it: then the rest is
 * smaller than it would be otherwise. */
#define TAKEN_OFF 0.5

/* One round. */
typedef struct
{
  ClothGapMade made;
  ClothGapStack *stack;
  ClothGapDiscrepancy *discrepancy;
  ClothGapLikelihood *likelihood;
  ClothGapGram *gram;
} Round;

/* All but what was made by simulations. */
static void
forget_likelihood (Round * r)
{
  g_clear_pointer (&r->gram, cloth_gap_gram_free);
  g_clear_pointer (&r->likelihood, cloth_gap_likelihood_free);
  g_clear_pointer (&r->discrepancy, cloth_gap_discrepancy_free);
  g_clear_pointer (&r->stack, cloth_gap_stack_free);
}

static void
round_clear (Round * r)
{
  forget_likelihood (r);
  cloth_gap_made_clear (&r->made);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Round, round_clear);

/* @null: (nullable): the residual without effects. FALSE without an error: there is no effect to
 * look for. */
static gboolean
find_likelihood (const ClothDiagnosis * d, const ClothGapGathered * gathered,
    ClothEnsembleKin kin, const gdouble * null, Round * r, GError ** error)
{
  g_autofree gdouble *response = NULL;

  forget_likelihood (r);
  r->stack = cloth_gap_stack_new (d, gathered, &r->made, kin, error);
  if (!r->stack)
    return FALSE;
  if (null) {
    response = g_new (gdouble, r->stack->size);
    for (gsize i = 0; i < r->stack->size; i++)
      response[i] = r->stack->z[i] - null[i];
  }
  r->discrepancy = cloth_gap_discrepancy_new (r->stack, response);
  r->likelihood = cloth_gap_likelihood_new (r->stack, r->discrepancy,
      CLOTH_GAP_ALL_FAMILIES);
  r->gram = cloth_gap_gram_new (r->likelihood, r->stack->z, r->stack->columns,
      r->stack->n);
  return r->stack->n > 0;
}

/* Compares all sets where the takes were linearised. */
static gboolean
compare (ClothDiagnosis * d, const Round * r, const ClothGapHypothesis * base,
    gboolean is_first, GArray * hypotheses, GError ** error)
{
  const ClothGapLinearisation l = { r->likelihood, r->stack, r->gram, base,
    is_first
  };

  return cloth_gap_hypotheses_compare (d, &l, hypotheses, error)
      && cloth_gap_hypotheses_predict (d, hypotheses, error);
}

/* The probability that the likeliest set is not all. */
static gboolean
find_unknown (ClothDiagnosis * d, const ClothGapBasis * basis,
    const GArray * hypotheses, GError ** error)
{
  g_autofree gdouble *z = g_new0 (gdouble, basis->stack->size);

  if (!cloth_gap_hypothesis_simulate (d, &g_array_index (hypotheses,
              ClothGapHypothesis, 0), z, error))
    return FALSE;
  cloth_diagnosis_find_unknown (d, basis, z);
  return TRUE;
}

/* What is taken off the takes' residuals in fits to come: that of the reference, where it is alike. */
static void
note_discrepancies (ClothDiagnosis * d, const ClothGapGathered * gathered,
    const Round * r)
{
  d->is_alike = r->discrepancy->shared > TAKEN_OFF;
  for (guint t = 0; t < d->n_takes && d->is_alike; t++) {
    ClothSensitivities *study = cloth_diagnosis_study (d, t), *reference;

    if (gathered->references[t] == G_MAXUINT)
      continue;
    reference = cloth_diagnosis_study (d, gathered->references[t]);
    if (reference->features->size == study->features->size)
      study->discrepancy = reference;
  }
  d->discrepancy_variance = cloth_power_spectrum_new (cloth_diagnosis_study (d,
          0)->features, r->stack->z);
  memcpy (d->discrepancy_variance->values, r->discrepancy->variances,
      d->discrepancy_variance->n * sizeof (gdouble));
}

/* Fits the free numbers and the directions of some of what is accepted. A model that can't be fitted stays as it
 * starts. */
static gboolean
refit (ClothDiagnosis * d, guint subset, const ClothModel * start,
    GError ** error)
{
  const guint most = d->candidates->directions->len;
  g_autofree guint *directions = g_new (guint, most + 1);
  g_autofree gdouble *precisions = g_new (gdouble, most + 1);
  g_autofree gboolean *blocks = NULL;
  g_autoptr (GError) failed = NULL;
  const guint m = cloth_diagnosis_list_accepted (d, subset, directions,
      precisions);
  guint n = 0;

  for (guint t = 0; t < d->n_takes; t++)
    n += cloth_diagnosis_study (d, t)->features->n_blocks;
  blocks = g_new (gboolean, n);
  n = 0;
  for (guint t = 0; t < d->n_takes; t++)
    for (guint b = 0; b < cloth_diagnosis_study (d, t)->features->n_blocks; b++)
      blocks[n++] = !cloth_diagnosis_is_held_out (d, b);
  d->fitted[subset] = cloth_gauss_newton_fit ((ClothSensitivities **)
      d->studies->pdata, d->n_takes, d->candidates, start, directions,
      precisions, m, blocks, CLOTH_FIT_DEFAULT, N_REFIT, &d->study, NULL,
      &failed);
  if (!failed)
    return TRUE;
  if (!g_error_matches (failed, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL)) {
    g_propagate_error (error, g_steal_pointer (&failed));
    return FALSE;
  }
  d->fitted[subset] = cloth_model_copy (start);
  return TRUE;
}

/* How the twins are related to the recordings, nobody knows: they are taken for what makes the recordings
 * likeliest. Without twins, a baseline is of the recorded cloth itself. */
static gboolean
find_kin (ClothDiagnosis * d, const ClothGapGathered * gathered,
    const ClothGapHypothesis * none, Round * first, ClothEnsembleKin * kin,
    GError ** error)
{
  gdouble most = -INFINITY;

  *kin = CLOTH_KIN_SAME;
  for (guint k = 0; d->twins->len && k < CLOTH_N_KINS; k++) {
    ClothGapLinearisation l = {.base = none,.is_first = TRUE };
    g_autoptr (GError) failed = NULL;
    ClothGapEvidence best;
    gdouble log_evidence;

    /* members without a sound partner of this kind tell nothing of it */
    if (!find_likelihood (d, gathered, k, NULL, first, &failed)) {
      if (g_error_matches (failed, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL))
        continue;
      g_propagate_error (error, g_steal_pointer (&failed));
      return FALSE;
    }
    l.likelihood = first->likelihood;
    l.stack = first->stack;
    l.gram = first->gram;
    if (!cloth_gap_hypotheses_screen (d, &l, &best))
      continue;
    log_evidence = best.log_evidence +
        cloth_gap_likelihood_find_constant (first->likelihood);
    if (log_evidence > most) {
      most = log_evidence;
      *kin = k;
    }
  }
  return TRUE;
}

/* The first round. */
static gboolean
run_first (ClothDiagnosis * d, const ClothGapGathered * gathered,
    const ClothGapHypothesis * none, GArray * hypotheses, Round * first,
    ClothEnsembleKin * kin, GError ** error)
{
  return cloth_gap_gather_takes (d, gathered, d->model, NULL, &first->made,
      error)
      && find_kin (d, gathered, none, first, kin, error)
      && find_likelihood (d, gathered, *kin, NULL, first, error)
      && compare (d, first, none, TRUE, hypotheses, error);
}

/* The rounds; the last one that could be simulated is left in @last, the residual without effects in
 * @null. FALSE without an error: there
 * is no effect to look for. */
static gboolean
run_rounds (ClothDiagnosis * d, const ClothGapGathered * gathered,
    GArray * hypotheses, Round * last, gdouble ** null, GError ** error)
{
  ClothGapHypothesis base;
  ClothEnsembleKin kin;

  cloth_gap_hypothesis_init (&base, d->candidates, NULL, NULL, 0);
  cloth_diagnosis_begin_part (d, 0.3, 0.45, 0.1, "comparing effects");
  if (!run_first (d, gathered, &base, hypotheses, last, &kin, error))
    return FALSE;
  *null = g_memdup2 (last->stack->z, last->stack->size * sizeof (gdouble));
  for (guint i = 1; i < N_ROUNDS; i++) {
    g_auto (Round) next = { {NULL}
    };
    g_autoptr (GError) failed = NULL;
    g_autoptr (ClothModel) model = NULL;
    const ClothGapHypothesis *best = &g_array_index (hypotheses,
        ClothGapHypothesis, 0);
    Round done;

    if (cloth_gap_hypothesis_is_same (best, &base))
      break;
    cloth_gap_hypothesis_copy (&base, best);
    model = cloth_gap_hypothesis_make_model (d, &base);
    cloth_diagnosis_begin_part (d, 0.3 + 0.15 * i, 0.45 + 0.15 * i, 0.1,
        "comparing effects");
    /* where the likeliest set can't be linearised, what is known of it stands */
    if (!cloth_gap_gather_takes (d, gathered, model, &last->made, &next.made,
            &failed)
        || !find_likelihood (d, gathered, kin, *null, &next, &failed)) {
      if (failed && !g_error_matches (failed, CLOTH_FIT_ERROR,
              CLOTH_FIT_ERROR_MODEL)) {
        g_propagate_error (error, g_steal_pointer (&failed));
        return FALSE;
      }
      break;
    }
    done = *last;
    *last = next;
    next = done;
    if (!compare (d, last, &base, FALSE, hypotheses, error))
      return FALSE;
  }
  return TRUE;
}

/* The model with some of what was accepted: as they were found by themselves, else as in the likeliest explanation. */
static ClothModel *
make_accepted_model (const ClothDiagnosis * d, const GArray * hypotheses,
    guint subset)
{
  const ClothGapHypothesis *from;
  guint list[CLOTH_DIAGNOSIS_MAX_ACCEPTED], n = 0;
  ClothGapHypothesis some;

  for (guint c = 0; c < d->n_accepted; c++)
    if (subset >> c & 1)
      list[n++] = d->accepted[c];
  cloth_gap_hypothesis_init (&some, d->candidates, NULL, list, n);
  from = cloth_gap_hypotheses_find (hypotheses, &some);
  if (!from || !from->z)
    from = &g_array_index (hypotheses, ClothGapHypothesis, 0);
  for (guint k = 0; k < some.n_directions; k++)
    for (guint i = 0; i < from->n_directions; i++)
      if (from->directions[i] == some.directions[k])
        some.at[k] = from->at[i];
  return cloth_gap_hypothesis_make_model (d, &some);
}

/* Fits the model with each subset of what was accepted, so that it shows what each effect is good for; with all of it
 * only where the user's simulator shows that. */
static gboolean
fit_accepted (ClothDiagnosis * d, const GArray * hypotheses, GError ** error)
{
  const guint n_subsets = 1 << d->n_accepted;
  const guint first = cloth_diagnosis_runs_theirs (d) && d->n_accepted ?
      n_subsets - 1 : 1;

  for (guint subset = first; subset < n_subsets; subset++) {
    g_autoptr (ClothModel) start = make_accepted_model (d, hypotheses, subset);

    cloth_diagnosis_begin_part (d, 0.75 + 0.1 * (subset - 1) / n_subsets,
        0.75 + 0.1 * subset / n_subsets, 0.3, "fitting the likeliest effects");
    if (!refit (d, subset, start, error))
      return FALSE;
  }
  if (d->n_accepted)
    d->with = cloth_model_copy (d->fitted[n_subsets - 1]);
  return TRUE;
}

/* @d: a diagnosis whose model is fitted
 * @error: #ClothSimError or #ClothFitError
 *
 * Finds the probabilities of all explanations, accepts the effects of the likeliest that are more likely
 * than not, and fits the model with them on what doesn't judge.
 *
 * Returns: whether that could be simulated
 */
gboolean
cloth_diagnosis_infer (ClothDiagnosis * d, GError ** error)
{
  ClothGapGathered gathered = { NULL };
  g_autoptr (GArray) hypotheses = cloth_gap_hypotheses_new ();
  g_autoptr (GError) failed = NULL;
  g_auto (Round) last = { {NULL}
  };
  g_autofree gdouble *null = NULL;

  cloth_diagnosis_begin_part (d, 0.2, 0.3, 0.2,
      "comparing with the references");
  if (cloth_gap_gather_references (d, &gathered, &failed)
      && run_rounds (d, &gathered, hypotheses, &last, &null, &failed)) {
    const ClothGapBasis basis = { last.stack, last.discrepancy, last.likelihood,
      last.gram, null
    };

    if (find_unknown (d, &basis, hypotheses, &failed)) {
      note_discrepancies (d, &gathered, &last);
      cloth_diagnosis_conclude (d, &basis, hypotheses);
    }
  }
  cloth_gap_gathered_clear (&gathered, d->n_takes);
  if (!failed && fit_accepted (d, hypotheses, &failed))
    return TRUE;
  g_propagate_error (error, g_steal_pointer (&failed));
  return FALSE;
}
