/* How far off fitted numbers are: the fit is made again of recordings whose numbers are known.
 *
 * Model: the fitted cloth, simulated, with the recording's noise and gaps is an imitation of it. What spoils the fit of
 *   the one spoils that of the others likewise, so its error is drawn from what theirs are (parametric bootstrap).
 *   Imitations by a mesh twice as fine show what the mesh does: those numbers of the finer mesh count whose
 *   imitations, fitted by the mesh as it is, end where those of the fitted numbers do (indirect inference).
 * Assumption: a few steps by the same derivatives lead to where a fit ends. Springs draw an imitation past the
 *   noise of the first frame.
 * Formula: with B, W and Λ of the fit, A = BᵀWB/φ + Λ and z (δ) an imitation's residual at θ + δ,
 *     δ ← δ − A⁻¹ (BᵀW z (δ)/φ + Λδ), back most of the way where zᵀWz/φ + δᵀΛδ grows (chord method).
 *   With the ends e_k of K imitations s² = K/(K − 2) · Σ e_k²/K, the variance of Student's distribution of a further
 *   one. They begin at their own truth, which the prior does not: σ² = s² + (A⁻¹ΛA⁻¹)ᵢᵢ.
 *   On the finer mesh θ′ ← θ′ − c, c = mean (e′_k − e_k), both off by s/√K at most. What all further halvings of its
 *   edges change is, where errors are of first order in them, as much again, ½ + ¼ + …: with the last c
 *     σ′² = σ² + 2s²/K + c² + (θ′ − θ)².
 * Reference: Efron and Tibshirani, An Introduction to the Bootstrap, 1993, 6.5; Gouriéroux, Monfort and Renault, Indirect
 *   inference, 1993; Roache, Annu. Rev. Fluid Mech. 29, 1997; Ortega and Rheinboldt, 1970, 7.1 (chord method).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/synthesis/errors.h"

#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "gst/fit/error.h"
#include "gst/fit/recording/recording.h"

/* Imitations: eight drawn and eight let go fill a group of 16 lanes. */
#define N_IMITATIONS 8
/* How long the cloth is drawn first, in times that it remembers. */
#define LEAD 2.
/* Places that the fit of each tries. */
#define N_TRIED 4
/* How often the numbers of the finer mesh are looked for. */
#define N_SEARCHES 3
/* Imitations of a recording take no more memory, bytes; a longer one has no deviations. */
#define MOST_MEMORY 2e9
/* Of the mesh's edges. */
static const gdouble halved = 2.;

/* The fit, linearised where it ended. */
typedef struct
{
  ClothRecording **recordings;
  guint n;
  const ClothCandidates *candidates;
  guint m;
  const ClothModel *model;
  ClothEstimateOptions *options;
  ClothSensitivities **studies;
  gdouble **weights;            /* of each study: W, a feature each */
  gdouble *precisions;          /* Λ */
  ClothPosterior posterior;     /* A */
} Fit;

static void
fit_clear (Fit * fit)
{
  for (guint t = 0; fit->studies && t < fit->n; t++) {
    cloth_sensitivities_free (fit->studies[t]);
    g_free (fit->weights[t]);
  }
  g_free (fit->studies);
  g_free (fit->weights);
  g_free (fit->precisions);
  cloth_posterior_clear (&fit->posterior);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Fit, fit_clear);

/* W and BᵀWB of one recording. */
static void
weigh (Fit * fit, guint t)
{
  const ClothSensitivities *s = fit->studies[t];
  const ClothFeatures *f = s->features;
  const gsize block = f->size / f->n_blocks;
  g_autoptr (ClothPowerSpectrum) power = cloth_power_spectrum_new (f, s->z);
  g_autoptr (ClothNormalEquations) normal = cloth_normal_equations_new (f,
      power, s->z, s->columns, fit->m);
  g_autofree gdouble *g = g_new (gdouble, (gsize) fit->m * fit->m);
  g_autofree gdouble *score = g_new (gdouble, fit->m);

  cloth_normal_equations_project (normal, NULL, fit->m, NULL, g, score);
  cloth_posterior_add_data (&fit->posterior, g, score,
      fit->options->overdispersion);
  fit->weights[t] = g_new (gdouble, f->size);
  cloth_power_spectrum_get_weights (power, f, fit->weights[t]);
  for (guint b = 1; b < f->n_blocks; b++)
    memcpy (fit->weights[t] + b * block, fit->weights[t],
        block * sizeof (gdouble));
}

static gboolean
fit_init (Fit * fit, GError ** error)
{
  g_autofree guint *directions = g_new (guint, fit->m);

  fit->studies = g_new0 (ClothSensitivities *, fit->n);
  fit->weights = g_new0 (gdouble *, fit->n);
  fit->precisions = g_new (gdouble, fit->m);
  cloth_posterior_init (&fit->posterior, fit->m);
  for (guint i = 0; i < fit->m; i++) {
    const gdouble prior =
        cloth_candidates_direction (fit->candidates, i)->prior;

    directions[i] = i;
    fit->precisions[i] = 1. / (prior * prior);
  }
  for (guint t = 0; t < fit->n; t++) {
    fit->studies[t] = cloth_sensitivities_new (fit->recordings[t],
        fit->options);
    if (!cloth_sensitivities_linearise (fit->studies[t], fit->candidates,
            fit->model, directions, fit->m, fit->options, error))
      return FALSE;
    weigh (fit, t);
  }
  cloth_posterior_add_prior (&fit->posterior, fit->precisions, NULL);
  return TRUE;
}

/* @recordings: (array length=n): recordings of one scene
 * @n: how many
 * @model: the model at hand
 * @gain: of the springs that draw it, 1/s²
 * @rollout: how to simulate
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * What is to draw the cloth: first as smoothing has it, then without what smoothing takes off the motion of
 * the model at hand.
 *
 * Returns: whether that could be done
 */
gboolean
cloth_synthesis_straighten (ClothRecording ** recordings, guint n,
    const ClothModel * model, gdouble gain, const ClothRolloutOptions * rollout,
    GError ** error)
{
  const gsize all = 3 * (gsize) recordings[0]->n * recordings[0]->n_frames;
  g_autofree gdouble *paths = g_new (gdouble, n * all);
  g_autofree gboolean *sound = g_new (gboolean, n);

  for (guint i = 0; i < n; i++)
    cloth_recording_straighten (recordings[i], NULL);
  if (!cloth_rollout_follow ((const ClothRecording * const *) recordings, n,
          model, gain, rollout, paths, sound, error))
    return FALSE;
  /* where it diverges the fit says so */
  for (guint i = 0; i < n; i++)
    if (sound[i])
      cloth_recording_straighten (recordings[i], paths + i * all);
  return TRUE;
}

/* Where the fit of an imitation is. */
typedef struct
{
  gdouble *delta;               /* from the fitted numbers: the best place so far */
  gdouble *step;                /* from there to the next one */
  gdouble *score;               /* BᵀWz/φ + Λδ there */
  gdouble cost;                 /* zᵀWz/φ + δᵀΛδ there */
  gdouble best;                 /* at the best place */
  gboolean sound;               /* it could be made and followed */
} Search;

static void
searches_clear (Search * searches)
{
  for (guint k = 0; k < N_IMITATIONS; k++) {
    g_free (searches[k].delta);
    g_free (searches[k].step);
    g_free (searches[k].score);
  }
}

static void
searches_init (Search * searches, guint m)
{
  for (guint k = 0; k < N_IMITATIONS; k++)
    searches[k] = (Search) {
    g_new0 (gdouble, m), g_new0 (gdouble, m), g_new0 (gdouble, m)};
}

/* How long the cloth is drawn first, s. */
static gdouble
find_lead (const Fit * fit)
{
  return LEAD / (CLOTH_ROLLOUT_ZETA * sqrt (fit->options->gain));
}

/* Whether a recording lasts long enough to be imitated, and not too long. */
static gboolean
can_be_imitated (const Fit * fit, const ClothRecording * r)
{
  const gdouble frame = 3. * r->n * sizeof (gdouble);

  /* places, velocities, targets and paths */
  return 2 * cloth_rollout_count_led (r, find_lead (fit)) < r->n_frames
      && 4. * N_IMITATIONS * frame * r->n_frames < MOST_MEMORY;
}

/* Fills imitations of recording @t by @model, each by a run of its own, as folds fall one way or the other. Those
 * that diverge are not sound. */
static gboolean
imitate (const Fit * fit, guint t, const ClothModel * model,
    ClothImitations * made, Search * searches, GError ** error)
{
  const guint64 seed = fit->options->rollout.seed;
  const gdouble gain = fit->options->gain;
  ClothRolloutOptions quiet = fit->options->rollout;
  const ClothModel *models[N_IMITATIONS];
  gdouble gains[N_IMITATIONS];
  gboolean sound[N_IMITATIONS];

  quiet.failed = NULL;
  /* what chance does to the cloth is not known to who fits it */
  quiet.seed += 1 + t;
  fit->options->simulations += 2 * N_IMITATIONS;
  for (guint i = 0; i < N_IMITATIONS; i++) {
    models[i] = model;
    gains[i] = gain * exp2 ((i + 0.5) / N_IMITATIONS - 0.5);
  }
  if (!cloth_rollout_led (fit->recordings[t], models, gains, N_IMITATIONS,
          find_lead (fit), &quiet, cloth_imitations_keep, made, sound, error))
    return FALSE;
  for (guint i = 0; i < N_IMITATIONS; i++)
    searches[i].sound = searches[i].sound && sound[i];
  cloth_imitations_spoil (made, sound, 1., seed + t * N_IMITATIONS + 1);
  quiet.seed = seed;
  return cloth_synthesis_straighten (made->list, N_IMITATIONS, fit->model,
      gain, &quiet, error);
}

/* Features of the residuals of models let go in windows, each of its own imitation. */
typedef struct
{
  const ClothFeatures *features;
  const ClothImitations *made;
  gdouble *z;                   /* [imitation][size] */
} Residuals;

static void
collect (gpointer data, guint model, guint frame, const gdouble * positions)
{
  const Residuals *r = data;

  if (model < N_IMITATIONS)
    cloth_features_add (r->features, r->made->list[model], frame, positions,
        r->z + model * r->features->size);
}

/* Adds what the imitations of recording @t, followed by these models, have in the scores and costs. */
static gboolean
add_scores (const Fit * fit, guint t, const ClothImitations * made,
    const ClothModel * const *models, Search * searches, GError ** error)
{
  const ClothSensitivities *s = fit->studies[t];
  const gsize size = s->features->size;
  const gdouble phi = fit->options->overdispersion;
  g_autofree gdouble *z = g_new0 (gdouble, N_IMITATIONS * size);
  Residuals residuals = { s->features, made, z };
  gboolean followed[N_IMITATIONS];
  ClothRolloutOptions quiet = fit->options->rollout;

  quiet.failed = NULL;
  fit->options->simulations += N_IMITATIONS;
  if (!cloth_rollout_windows ((const ClothRecording * const *) made->list,
          models, N_IMITATIONS, fit->options->gain, fit->options->window_s,
          &quiet, collect, &residuals, followed, error))
    return FALSE;
  for (guint k = 0; k < N_IMITATIONS; k++) {
    const gdouble *own = z + k * size;

    for (gsize f = 0; f < size; f++)
      searches[k].cost += fit->weights[t][f] * own[f] * own[f] / phi;
    for (guint i = 0; i < fit->m; i++)
      for (gsize f = 0; f < size; f++)
        searches[k].score[i] += s->columns[i * size + f] *
            fit->weights[t][f] * own[f] / phi;
    if (!followed[k])
      searches[k].cost = INFINITY;
  }
  return TRUE;
}

/* From a place that was tried: on from there if it is better than the best one, else back, most of the way. */
static void
go_on (const Fit * fit, Search * s)
{
  if (!(s->cost < s->best)) {
    for (guint i = 0; i < fit->m; i++)
      s->step[i] *= CLOTH_GAUSS_NEWTON_CUT;
    return;
  }
  s->best = s->cost;
  cloth_posterior_apply (&fit->posterior, s->score);
  for (guint i = 0; i < fit->m; i++) {
    const ClothDirection *d = cloth_candidates_direction (fit->candidates, i);
    const gdouble place = cloth_candidates_place (fit->candidates, fit->model,
        i);
    const gdouble longest = CLOTH_GAUSS_NEWTON_LONGEST_STEP * d->prior;

    s->delta[i] += s->step[i];
    s->step[i] = CLAMP (-s->score[i], -longest, longest);
    s->step[i] = CLAMP (place + s->delta[i] + s->step[i], d->fit_low,
        d->fit_high) - place - s->delta[i];
  }
}

/* Moves the fitted model; to be freed. */
static ClothModel *
move (const Fit * fit, const gdouble * delta)
{
  g_autofree guint *directions = g_new (guint, fit->m);

  for (guint i = 0; i < fit->m; i++)
    directions[i] = i;
  return cloth_candidates_move (fit->candidates, fit->model, directions, delta,
      fit->m);
}

/* Tries the next place of each fit; @all: (element-type ClothImitations): of each recording. */
static gboolean
try_places (const Fit * fit, const GPtrArray * all, Search * searches,
    GError ** error)
{
  g_autoptr (GPtrArray) models =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_model_free);

  for (guint k = 0; k < N_IMITATIONS; k++) {
    Search *s = &searches[k];
    g_autofree gdouble *delta = g_new (gdouble, fit->m);

    s->cost = 0.;
    for (guint i = 0; i < fit->m; i++) {
      delta[i] = s->delta[i] + s->step[i];
      s->score[i] = fit->precisions[i] * delta[i];
      s->cost += s->score[i] * delta[i];
    }
    g_ptr_array_add (models, move (fit, delta));
  }
  for (guint t = 0; t < fit->n; t++)
    if (!add_scores (fit, t, g_ptr_array_index (all, t),
            (const ClothModel * const *) models->pdata, searches, error))
      return FALSE;
  return TRUE;
}

/* Fits imitations by a model, from the best places of other fits on. */
static gboolean
fit_imitations (const Fit * fit, const ClothModel * model, Search * searches,
    GError ** error)
{
  g_autoptr (GPtrArray) all =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_imitations_free);

  for (guint k = 0; k < N_IMITATIONS; k++) {
    searches[k].best = INFINITY;
    searches[k].sound = TRUE;
    memset (searches[k].step, 0, fit->m * sizeof (gdouble));
  }
  for (guint t = 0; t < fit->n; t++) {
    ClothImitations *made = cloth_imitations_new (fit->recordings[t],
        N_IMITATIONS);

    g_ptr_array_add (all, made);
    if (!imitate (fit, t, model, made, searches, error))
      return FALSE;
  }
  for (guint pass = 0; pass < N_TRIED; pass++) {
    if (!try_places (fit, all, searches, error))
      return FALSE;
    for (guint k = 0; k < N_IMITATIONS; k++)
      go_on (fit, &searches[k]);
  }
  for (guint k = 0; k < N_IMITATIONS; k++)
    searches[k].sound = searches[k].sound && isfinite (searches[k].best);
  return TRUE;
}

/* Variances by the ends of fits, s²; NaN where too few could be made. */
static void
find_variances (const Fit * fit, const Search * searches, gdouble * variances)
{
  guint n = 0;

  for (guint k = 0; k < N_IMITATIONS; k++)
    n += searches[k].sound;
  for (guint i = 0; i < fit->m; i++) {
    gdouble sum = 0.;

    for (guint k = 0; k < N_IMITATIONS; k++)
      sum += searches[k].sound ? pow (searches[k].delta[i], 2.) : 0.;
    variances[i] = n > 2 ? sum / (n - 2) : NAN;
  }
}

/* Adds what the prior holds back. */
static void
find_sigmas (const Fit * fit, const gdouble * variances,
    ClothSynthesisError * errors)
{
  const guint m = fit->m;
  g_autofree gdouble *inverse = g_new (gdouble, (gsize) m * m);

  cloth_posterior_covariance (&fit->posterior, inverse);
  for (guint i = 0; i < m; i++) {
    gdouble held = 0.;

    for (guint j = 0; j < m; j++)
      held += fit->precisions[j] * pow (inverse[i * m + j], 2.);
    errors[i].sigma = sqrt (variances[i] + held);
  }
}

/* Moves the numbers of the finer mesh to where its imitations fit as those of the fitted ones; @last is by how
 * much. Returns how many there are of both kinds to hold against each other. */
static guint
move_finer (const Fit * fit, const Search * searches, const Search * finer,
    gdouble * moved, gdouble * last)
{
  guint n = 0;

  for (guint k = 0; k < N_IMITATIONS; k++)
    n += searches[k].sound && finer[k].sound;
  for (guint i = 0; i < fit->m && n; i++) {
    const ClothDirection *d = cloth_candidates_direction (fit->candidates, i);
    const gdouble place = cloth_candidates_place (fit->candidates, fit->model,
        i);
    gdouble sum = 0.;

    for (guint k = 0; k < N_IMITATIONS; k++)
      sum += searches[k].sound && finer[k].sound ? finer[k].delta[i] -
          searches[k].delta[i] : 0.;
    last[i] = sum / n;
    moved[i] = CLAMP (place + moved[i] - last[i], d->fit_low, d->fit_high) -
        place;
  }
  return n;
}

/* What the numbers are on a mesh twice as fine: where the range ends they are not known. FALSE without an error: none
 * are. */
static gboolean
find_finer (const Fit * fit, const Search * searches,
    const gdouble * variances, ClothSynthesisError * errors, GError ** error)
{
  g_autofree gdouble *moved = g_new0 (gdouble, fit->m);
  g_autofree gdouble *last = g_new0 (gdouble, fit->m);
  Search finer[N_IMITATIONS];
  guint counted = N_IMITATIONS;

  searches_init (finer, fit->m);
  for (guint search = 0; search < N_SEARCHES && counted; search++) {
    g_autoptr (ClothModel) model = move (fit, moved);

    cloth_model_set_effect (model, cloth_effect_find ("mesh_resolution"),
        &halved);
    counted = fit_imitations (fit, model, finer, error) ?
        move_finer (fit, searches, finer, moved, last) : 0;
  }
  searches_clear (finer);
  for (guint i = 0; i < fit->m && counted; i++) {
    const ClothDirection *d = cloth_candidates_direction (fit->candidates, i);
    const gdouble place = moved[i] + cloth_candidates_place (fit->candidates,
        fit->model, i);

    if (!(place > d->fit_low && place < d->fit_high))
      continue;
    errors[i].finer = place;
    errors[i].finer_sigma = sqrt (pow (errors[i].sigma, 2.) +
        2. * variances[i] / counted + last[i] * last[i] + moved[i] * moved[i]);
  }
  return counted > 0;
}

/* Whether the model says itself how fine its mesh is. */
static gboolean
has_resolution (const ClothModel * model)
{
  for (guint i = 0; i < model->effects->len; i++) {
    const ClothModelEffect *e = &g_array_index (model->effects,
        ClothModelEffect, i);

    if (g_str_equal (e->effect->id, "mesh_resolution") && e->values[0] != 1.)
      return TRUE;
  }
  return FALSE;
}

/* Models that can't be simulated leave errors unknown; whoever looks at the fitted cloth is told. */
static gboolean
is_of_model (const GError * failed)
{
  return g_error_matches (failed, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL)
      || g_error_matches (failed, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL);
}

/* @recordings: (array length=n): what was fitted
 * @n: how many
 * @candidates: the free numbers
 * @model: the fitted model
 * @options: how it was fitted, in windows
 * @errors: (out) (array): of each free number
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * The model is simulated as the cloth, as it is and on a mesh twice as fine, and fitted to that again.
 *
 * Returns: whether that could be done. What diverges leaves NaN, and so does a recording that is too short or too
 *   long to be imitated
 */
gboolean
cloth_synthesis_find_errors (ClothRecording ** recordings, guint n,
    const ClothCandidates * candidates, const ClothModel * model,
    ClothEstimateOptions * options, ClothSynthesisError * errors,
    GError ** error)
{
  const guint m = candidates->n_free;
  g_auto (Fit) fit = { recordings, n, candidates, m, model, options };
  g_autofree gdouble *variances = g_new (gdouble, m);
  g_autoptr (GError) failed = NULL;
  Search searches[N_IMITATIONS];
  gboolean possible = TRUE;

  for (guint i = 0; i < m; i++)
    errors[i] = (ClothSynthesisError) {
    NAN, NAN, NAN};
  for (guint t = 0; t < n; t++)
    possible = possible && can_be_imitated (&fit, recordings[t]);
  searches_init (searches, m);
  if (possible && fit_init (&fit, &failed)
      && cloth_posterior_solve (&fit.posterior)
      && fit_imitations (&fit, model, searches, &failed)) {
    find_variances (&fit, searches, variances);
    find_sigmas (&fit, variances, errors);
    if (!has_resolution (model))
      find_finer (&fit, searches, variances, errors, &failed);
  }
  searches_clear (searches);
  if (!failed || is_of_model (failed))
    return TRUE;
  g_propagate_error (error, g_steal_pointer (&failed));
  return FALSE;
}
