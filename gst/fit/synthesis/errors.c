/* How far off fitted numbers are: the fit is made again of recordings whose numbers are known.
 *
 * Model: the fitted cloth is simulated freely from where the recording began. With the recording's noise and
 *   gaps that is an imitation of it. What spoils the fit of the recording spoils that of an imitation likewise:
 *   noise, what was hidden, smoothing, and that features of one motion hang together. So the error of the
 *   one is drawn from what the errors of the others are (parametric bootstrap).
 *   Imitations by the cloth on a mesh twice as fine show what the mesh does to the numbers. Those numbers of the
 *   finer mesh count whose imitations fit as those of the fitted numbers do (indirect inference).
 * Assumption: one step and a few more of the same derivatives lead to where a fit of an imitation ends.
 * Formula: with B, W and Λ of the fit, A = BᵀWB/φ + Λ and z (δ) an imitation's residual at θ + δ,
 *     δ ← δ − A⁻¹ (BᵀW z (δ)/φ + Λδ)                                      (chord method).
 *   With the ends e_k of K imitations σ² = K/(K − 2) · Σ e_k²/K: the variance of Student's distribution of a
 *   further one. On the finer mesh θ′ ← θ′ − mean (e′_k − e_k), by the same noise. What a further halving of
 *   its edges, and all after it, would change is taken to be half of what this one did:
 *     σ′² = σ² + (θ′ − θ)²/4,
 *   which is Roache's index of convergence, 95% within 3/(2² − 1) |θ′ − θ|, of a method of second order.
 * Reference: Efron and Tibshirani, An Introduction to the Bootstrap, 1993, section 6.5; Gouriéroux, Monfort
 *   and Renault, Indirect inference, 1993; Roache, Perspective: a method for uniform reporting of grid
 *   refinement studies, 1994; Ortega and Rheinboldt, 1970, section 7.1 (chord method).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/synthesis/errors.h"

#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "gst/fit/error.h"
#include "gst/fit/recording/recording.h"

/* Imitations: as many as, let go beside drawn, fill a group of lanes. */
#define N_IMITATIONS 8
/* Steps of each. */
#define N_STEPS 3
/* How often the numbers of the finer mesh are looked for. */
#define N_SEARCHES 3
/* No step is longer than this many priors. */
#define LONGEST_STEP 1.5
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
  for (guint t = 0; t < fit->n; t++) {
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
  g_autofree guint *columns = g_new (guint, fit->m);
  g_autofree gdouble *g = g_new (gdouble, (gsize) fit->m * fit->m);
  g_autofree gdouble *score = g_new (gdouble, fit->m);

  for (guint i = 0; i < fit->m; i++)
    columns[i] = i;
  cloth_normal_equations_sum (normal, NULL, columns, fit->m, g, score);
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

/* Imitations of all recordings: [recording][imitation]. */
typedef struct
{
  ClothRecording **made;
  guint n;
} Imitations;

static void
imitations_clear (Imitations * all)
{
  for (guint i = 0; i < all->n; i++)
    cloth_imitation_free (all->made[i]);
  g_free (all->made);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Imitations, imitations_clear);

typedef struct
{
  gdouble **paths;              /* of each model, [n_frames][n][3] */
  gsize row;
} Keep;

static void
keep (gpointer data, guint model, guint frame, const gdouble * positions)
{
  const Keep *k = data;

  memcpy (k->paths[model] + frame * k->row, positions,
      k->row * sizeof (gdouble));
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
  const gsize row = 3 * (gsize) recordings[0]->n;
  const gsize all = row * recordings[0]->n_frames;
  g_autofree gdouble *memory = g_new (gdouble, n * all);
  g_autofree gdouble **paths = g_new (gdouble *, n);
  g_autofree const ClothModel **models = g_new (const ClothModel *, n);
  g_autofree gdouble *gains = g_new (gdouble, n);
  g_autofree gboolean *sound = g_new (gboolean, n);
  Keep k = { paths, row };

  for (guint i = 0; i < n; i++) {
    cloth_recording_straighten (recordings[i], NULL);
    paths[i] = memory + i * all;
    models[i] = model;
    gains[i] = gain;
  }
  if (!cloth_rollout_nudged ((const ClothRecording * const *) recordings,
          models, gains, n, rollout, keep, &k, sound, error))
    return FALSE;
  /* where it diverges the fit says so */
  for (guint i = 0; i < n; i++)
    if (sound[i])
      cloth_recording_straighten (recordings[i], paths[i]);
  return TRUE;
}

/* Makes imitations of recording @t by @model. FALSE without an error: it diverges. */
static gboolean
imitate (const Fit * fit, guint t, const ClothModel * model,
    ClothRecording ** made, GError ** error)
{
  const ClothRecording *r = fit->recordings[t];
  const gsize row = 3 * (gsize) r->n;
  ClothRolloutOptions quiet = fit->options->rollout;
  Keep k = { &made[0]->y, row };
  gboolean sound;

  quiet.failed = NULL;
  fit->options->simulations += 1 + N_IMITATIONS;
  if (!cloth_rollout_free (r, &model, 1, &quiet, keep, &k, &sound, error)
      || !sound)
    return FALSE;
  for (guint i = 1; i < N_IMITATIONS; i++)
    memcpy (made[i]->y, made[0]->y, row * r->n_frames * sizeof (gdouble));
  for (guint i = 0; i < N_IMITATIONS; i++)
    cloth_imitation_spoil (made[i], r, 1., fit->options->rollout.seed +
        t * N_IMITATIONS + i + 1);
  return cloth_synthesis_straighten (made, N_IMITATIONS, fit->model,
      fit->options->gain, &quiet, error);
}

/* Features of the residuals of models let go in windows, each of its own imitation. */
typedef struct
{
  const ClothFeatures *features;
  ClothRecording **made;
  gdouble *z;                   /* [imitation][size] */
} Residuals;

static void
collect (gpointer data, guint model, guint frame, const gdouble * positions)
{
  const Residuals *r = data;

  if (model < N_IMITATIONS)
    cloth_features_add (r->features, r->made[model], frame, positions,
        r->z + model * r->features->size);
}

/* Adds BᵀWz/φ of the imitations of recording @t with these models to the scores, [imitation][m]. */
static gboolean
add_scores (const Fit * fit, guint t, ClothRecording ** made,
    const ClothModel * const *models, gdouble * scores, gboolean * sound,
    GError ** error)
{
  const ClothSensitivities *s = fit->studies[t];
  const gsize size = s->features->size;
  g_autofree gdouble *z = g_new0 (gdouble, N_IMITATIONS * size);
  Residuals residuals = { s->features, made, z };
  gboolean followed[N_IMITATIONS];
  ClothRolloutOptions quiet = fit->options->rollout;

  quiet.failed = NULL;
  fit->options->simulations += N_IMITATIONS;
  if (!cloth_rollout_windows ((const ClothRecording * const *) made, models,
          N_IMITATIONS, fit->options->gain, fit->options->window_s, &quiet,
          collect, &residuals, followed, error))
    return FALSE;
  for (guint k = 0; k < N_IMITATIONS; k++) {
    sound[k] = sound[k] && followed[k];
    for (guint i = 0; i < fit->m; i++) {
      const gdouble *column = s->columns + i * size;
      gdouble sum = 0.;

      for (gsize f = 0; f < size; f++)
        sum += column[f] * fit->weights[t][f] * z[k * size + f];
      scores[k * fit->m + i] += sum / fit->options->overdispersion;
    }
  }
  return TRUE;
}

/* One step of the chord method of each imitation. */
static void
step (const Fit * fit, gdouble * scores, gdouble * deltas)
{
  for (guint k = 0; k < N_IMITATIONS; k++) {
    gdouble *score = scores + k * fit->m, *delta = deltas + k * fit->m;

    for (guint i = 0; i < fit->m; i++)
      score[i] += fit->precisions[i] * delta[i];
    cloth_posterior_apply (&fit->posterior, score);
    for (guint i = 0; i < fit->m; i++) {
      const ClothDirection *d = cloth_candidates_direction (fit->candidates, i);
      const gdouble place = cloth_candidates_place (fit->candidates, fit->model,
          i);

      delta[i] -= CLAMP (score[i], -LONGEST_STEP * d->prior,
          LONGEST_STEP * d->prior);
      delta[i] = CLAMP (place + delta[i], d->fit_low, d->fit_high) - place;
    }
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

/* Fits the imitations by a model: where the fits end, from the fitted numbers, [imitation][m], which they begin
 * with. Those that diverge on the way are not @sound. FALSE without an error: the model does. */
static gboolean
fit_imitations (const Fit * fit, const ClothModel * model, gdouble * deltas,
    gboolean * sound, GError ** error)
{
  g_auto (Imitations) all = { g_new0 (ClothRecording *,
        fit->n * N_IMITATIONS), fit->n * N_IMITATIONS
  };

  for (guint i = 0; i < all.n; i++)
    all.made[i] = cloth_imitation_new (fit->recordings[i / N_IMITATIONS]);
  for (guint t = 0; t < fit->n; t++)
    if (!imitate (fit, t, model, all.made + t * N_IMITATIONS, error))
      return FALSE;
  for (guint k = 0; k < N_IMITATIONS; k++)
    sound[k] = TRUE;
  for (guint pass = 0; pass < N_STEPS; pass++) {
    g_autofree gdouble *scores = g_new0 (gdouble, N_IMITATIONS * fit->m);
    ClothModel *models[N_IMITATIONS];
    gboolean done = TRUE;

    for (guint k = 0; k < N_IMITATIONS; k++)
      models[k] = move (fit, deltas + k * fit->m);
    for (guint t = 0; t < fit->n && done; t++)
      done = add_scores (fit, t, all.made + t * N_IMITATIONS,
          (const ClothModel * const *) models, scores, sound, error);
    for (guint k = 0; k < N_IMITATIONS; k++)
      cloth_model_free (models[k]);
    if (!done)
      return FALSE;
    step (fit, scores, deltas);
  }
  return TRUE;
}

/* Standard deviations by the ends of fits. */
static void
find_sigmas (const Fit * fit, const gdouble * ends, const gboolean * sound,
    ClothSynthesisError * errors)
{
  guint n = 0;

  for (guint k = 0; k < N_IMITATIONS; k++)
    n += sound[k];
  for (guint i = 0; i < fit->m; i++) {
    gdouble sum = 0.;

    for (guint k = 0; k < N_IMITATIONS; k++)
      sum += sound[k] ? pow (ends[k * fit->m + i], 2.) : 0.;
    errors[i] = (ClothSynthesisError) {
    n > 2 ? sqrt (sum / (n - 2)) : NAN, NAN, NAN};
  }
}

/* Moves the numbers of the finer mesh to where its imitations fit as those of the fitted ones. FALSE: there is none
 * of both kinds to hold against each other. */
static gboolean
move_finer (const Fit * fit, const gdouble * ends, const gboolean * sound,
    const gdouble * ends_finer, const gboolean * sound_finer, gdouble * moved)
{
  guint n = 0;

  for (guint k = 0; k < N_IMITATIONS; k++)
    n += sound[k] && sound_finer[k];
  for (guint i = 0; i < fit->m && n; i++) {
    const ClothDirection *d = cloth_candidates_direction (fit->candidates, i);
    const gdouble place = cloth_candidates_place (fit->candidates, fit->model,
        i);
    gdouble sum = 0.;

    for (guint k = 0; k < N_IMITATIONS; k++)
      sum += sound[k] && sound_finer[k] ? ends_finer[k * fit->m + i] -
          ends[k * fit->m + i] : 0.;
    moved[i] -= sum / n;
    moved[i] = CLAMP (place + moved[i], d->fit_low, d->fit_high) - place;
  }
  return n > 0;
}

/* What the numbers are on a mesh twice as fine. FALSE without an error: that can't be told. */
static gboolean
find_finer (const Fit * fit, const gdouble * ends, const gboolean * sound,
    gdouble * moved, GError ** error)
{
  g_autofree gdouble *ends_finer = g_new0 (gdouble, N_IMITATIONS * fit->m);
  gboolean sound_finer[N_IMITATIONS];

  for (guint search = 0; search < N_SEARCHES; search++) {
    g_autoptr (ClothModel) finer = move (fit, moved);

    cloth_model_set_effect (finer, cloth_effect_find ("mesh_resolution"),
        &halved);
    if (!fit_imitations (fit, finer, ends_finer, sound_finer, error)
        || !move_finer (fit, ends, sound, ends_finer, sound_finer, moved))
      return FALSE;
  }
  return TRUE;
}

static gboolean
has_effect (const ClothModel * model, const gchar * id)
{
  for (guint i = 0; i < model->effects->len; i++)
    if (g_str_equal (g_array_index (model->effects, ClothModelEffect,
                i).effect->id, id))
      return TRUE;
  return FALSE;
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
 * Returns: whether that could be done; what diverges leaves NaN
 */
gboolean
cloth_synthesis_find_errors (ClothRecording ** recordings, guint n,
    const ClothCandidates * candidates, const ClothModel * model,
    ClothEstimateOptions * options, ClothSynthesisError * errors,
    GError ** error)
{
  const guint m = candidates->n_free;
  g_auto (Fit) fit = { recordings, n, candidates, m, model, options };
  g_autofree gdouble *ends = g_new0 (gdouble, N_IMITATIONS * m);
  g_autofree gdouble *moved = g_new0 (gdouble, m);
  g_autoptr (GError) failed = NULL;
  gboolean sound[N_IMITATIONS] = { FALSE };

  if (!fit_init (&fit, error))
    return FALSE;
  find_sigmas (&fit, ends, sound, errors);
  if (!cloth_posterior_solve (&fit.posterior))
    return TRUE;
  if (!fit_imitations (&fit, model, ends, sound, &failed)) {
    if (!failed)
      return TRUE;
    g_propagate_error (error, g_steal_pointer (&failed));
    return FALSE;
  }
  find_sigmas (&fit, ends, sound, errors);
  if (has_effect (model, "mesh_resolution")
      || !find_finer (&fit, ends, sound, moved, &failed)) {
    /* a mesh that can't be made so fine, or diverges then */
    if (!failed || g_error_matches (failed, CLOTH_SIM_ERROR,
            CLOTH_SIM_ERROR_MODEL))
      return TRUE;
    g_propagate_error (error, g_steal_pointer (&failed));
    return FALSE;
  }
  for (guint i = 0; i < m; i++) {
    errors[i].finer = cloth_candidates_place (candidates, model, i) + moved[i];
    errors[i].finer_sigma = hypot (errors[i].sigma, moved[i] / 2.);
  }
  return TRUE;
}
