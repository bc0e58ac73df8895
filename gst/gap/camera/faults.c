/* Decides what was wrong with the cameras, and gives the recordings without it.
 *
 * The points in the pictures are held against each other only, never against a simulation: what is
 * found here says nothing of the cloth, and the other way round.
 * Model: the normal equations of solve.c are linear in the faults. Each fault is tested by the score
 * test of score.c, the likeliest is accepted and fitted by Gauss–Newton together with
 * those before it, and all are tested anew.
 * Assumption: detectors err alike in picture after picture, so that squares count a twentieth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/faults.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/recording.h"
#include "gst/fit/rig/refine.h"
#include "gst/gap/camera/candidates.h"
#include "gst/gap/camera/score.h"

/* Overdispersion: squares of the residual count so much less. */
#define OVERDISPERSION 20.
/* A fault must take this share of the residual's square off blocks of time that it was
 * not estimated on. */
#define LEAST_IMPROVEMENT 0.02
/* A fault matters when the mean square of the displacement of points by it is so many times
 * that of the errors of detection. */
#define LEAST_DISPLACEMENT 4.
/* The baselines' log Bayes factor of the same effect is taken off so many times. */
#define NULL_SHARE 1.5
/* The log Bayes factor is divided by this before it becomes a probability. */
#define TEMPERATURE 1.5
/* Gauss–Newton steps of the fit of the faults, in which priors are so many times as wide. */
#define N_STEPS 3
#define WIDTH 3.
/* Faults whose derivatives have a larger cosine than this can't be told apart … */
#define AMBIGUOUS_COSINE 0.9
/* … unless one is this much less likely than the other. */
#define LEAST_ODDS 0.05
/* Largest exponent, which does not overflow. */
#define LARGEST 600.

/* The search for faults. */
typedef struct
{
  ClothDiagnosis *d;
  const ClothRig *rig;
  ClothCandidates *candidates;
  GPtrArray *views;             /* of the takes that have observations of this rig */
  ClothNormalEquations *normal; /* linearised at the known faults */
  /* of each candidate: what its log Bayes factor must exceed, whether it looks like the first
   * fault */
  gdouble *null_log_bayes_factors;
  gboolean *alike;
} Search;

static void
search_clear (Search * s)
{
  cloth_candidates_free (s->candidates);
  g_clear_pointer (&s->views, g_ptr_array_unref);
  cloth_normal_equations_free (s->normal);
  g_free (s->null_log_bayes_factors);
  g_free (s->alike);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Search, search_clear);

static gboolean
same_cameras (const ClothRig * a, const ClothRig * b)
{
  if (a->n_cameras != b->n_cameras)
    return FALSE;
  for (guint c = 0; c < a->n_cameras; c++)
    if (strcmp (a->cameras[c].name, b->cameras[c].name) != 0)
      return FALSE;
  return TRUE;
}

static GPtrArray *
open_views (const Search * s, guint begin, guint end)
{
  GPtrArray *views = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_camera_view_free);

  for (guint i = begin; i < end; i++) {
    const ClothObservations *observations =
        cloth_diagnosis_observations (s->d, i);

    if (observations && same_cameras (observations->rig, s->rig))
      g_ptr_array_add (views,
          cloth_camera_view_new (cloth_diagnosis_recording (s->d, i),
              observations, s->d->options->threads));
  }
  return views;
}

/* The equations of all views together. */
static ClothNormalEquations *
linearise (const Search * s, const GPtrArray * views,
    ClothCameraErrors * errors)
{
  ClothNormalEquations *all = NULL;

  for (guint i = 0; i < views->len; i++) {
    ClothCameraErrors mine;
    ClothNormalEquations *normal =
        cloth_camera_view_linearise (g_ptr_array_index (views, i),
        s->d->options->threads, &mine);

    if (!normal)
      continue;
    if (!all)
      *errors = mine;
    all = cloth_normal_equations_append (all, normal);
  }
  return all;
}

static const ClothCandidate *
candidate_at (const Search * s, guint i)
{
  return &g_array_index (s->candidates->list, ClothCandidate, i);
}

/* The scores of all effects beside the known faults, the likeliest first. */
static GArray *
rank (const Search * s, ClothNormalEquations * normal)
{
  const ClothDiagnosis *d = s->d;
  guint m = s->candidates->directions->len;
  g_autofree gboolean *blocks = g_new (gboolean, normal->n_blocks);
  g_autofree gboolean *sound = g_new (gboolean, m);
  guint nuisances[CLOTH_DIAGNOSIS_MAX_ACCEPTED * CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble precisions[G_N_ELEMENTS (nuisances)];
  ClothGapTest test = {.normal = normal,.candidates = s->candidates,.blocks =
        blocks,.nuisances = nuisances,.precisions = precisions,.overdispersion =
        OVERDISPERSION,.sound = sound
  };
  GArray *scores;

  for (guint b = 0; b < normal->n_blocks; b++)
    blocks[b] = TRUE;
  for (guint k = 0; k < m; k++)
    sound[k] = TRUE;
  for (guint i = 0; i < d->n_faults; i++) {
    const ClothCandidate *c = candidate_at (s, d->faults[i].candidate);

    for (guint k = 0; k < c->n; k++) {
      const gdouble prior = cloth_candidates_direction (s->candidates,
          c->first + k)->prior;

      nuisances[test.n_nuisances] = c->first + k;
      precisions[test.n_nuisances++] = 1. / (prior * prior);
    }
  }
  test.n_numbers = test.n_nuisances;
  scores = cloth_gap_test_run (&test);
  for (guint i = 0; i < scores->len; i++) {
    ClothGapScore *score = &g_array_index (scores, ClothGapScore, i);

    score->log_bayes_factor -= s->null_log_bayes_factors[score->candidate];
  }
  g_array_sort (scores, cloth_gap_score_compare);
  return scores;
}

/* Notes how much the baselines support each effect, of any camera. */
static void
study_baselines (Search * s)
{
  const ClothDiagnosis *d = s->d;
  g_autoptr (GPtrArray) views = open_views (s, d->n_takes,
      d->n_takes + d->options->n_baselines);
  ClothCameraErrors errors;
  g_autoptr (ClothNormalEquations) normal = linearise (s, views, &errors);
  g_autoptr (GArray) scores = NULL;

  if (!normal)
    return;
  scores = rank (s, normal);
  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *score = &g_array_index (scores, ClothGapScore, i);

    for (guint c = 0; c < s->candidates->list->len; c++)
      if (candidate_at (s, c)->effect ==
          candidate_at (s, score->candidate)->effect)
        s->null_log_bayes_factors[c] =
            NULL_SHARE * MAX (score->log_bayes_factor, 0.);
  }
}

/* Assumes the known faults to act. */
static void
apply_faults (const ClothDiagnosis * d, ClothCameraView * view)
{
  cloth_camera_view_reset (view);
  for (guint i = 0; i < d->n_faults; i++)
    cloth_camera_view_apply (view, d->faults[i].camera, d->faults[i].effect,
        d->faults[i].values);
}

/* One Gauss–Newton step towards the most probable values of all faults. */
static gboolean
step_faults (Search * s)
{
  ClothDiagnosis *d = s->d;
  guint columns[CLOTH_DIAGNOSIS_MAX_ACCEPTED * CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble g[G_N_ELEMENTS (columns) * G_N_ELEMENTS (columns)];
  gdouble covariance[G_N_ELEMENTS (g)], r, phi;
  gdouble score[G_N_ELEMENTS (columns)], precisions[G_N_ELEMENTS (columns)];
  gdouble means[G_N_ELEMENTS (columns)];
  g_auto (ClothPosterior) posterior = { 0 };
  guint n = 0, at = 0;

  for (guint i = 0; i < d->n_faults; i++) {
    const ClothCandidate *c = candidate_at (s, d->faults[i].candidate);

    for (guint k = 0; k < c->n; k++)
      columns[n++] = c->first + k;
  }
  r = cloth_normal_equations_sum (s->normal, NULL, columns, n, g, score);
  phi = cloth_gap_dispersion (OVERDISPERSION, r, s->normal->per_block *
      s->normal->n_blocks);
  for (guint i = 0; i < d->n_faults; i++) {
    const ClothCandidate *c = candidate_at (s, d->faults[i].candidate);

    for (guint k = 0; k < c->n; k++, at++) {
      const gdouble prior = WIDTH * cloth_candidates_direction
          (s->candidates, c->first + k)->prior;

      precisions[at] = 1. / (prior * prior);
      means[at] = -d->faults[i].values[k];
    }
  }
  cloth_posterior_init (&posterior, n);
  cloth_posterior_add_data (&posterior, g, score, phi);
  cloth_posterior_add_prior (&posterior, precisions, means);
  if (!cloth_posterior_solve (&posterior))
    return FALSE;
  cloth_posterior_covariance (&posterior, covariance);
  at = 0;
  for (guint i = 0; i < d->n_faults; i++) {
    const ClothCandidate *c = candidate_at (s, d->faults[i].candidate);

    for (guint k = 0; k < c->n; k++, at++) {
      const ClothDirection *direction =
          cloth_candidates_direction (s->candidates, c->first + k);

      d->faults[i].values[k] = CLAMP (d->faults[i].values[k] +
          posterior.mean[at], direction->low, direction->high);
      d->faults[i].sigmas[k] = sqrt (covariance[at * n + at]);
    }
  }
  return TRUE;
}

/* Looks at the pictures as cameras with the known faults took them. */
static void
look_again (Search * s)
{
  for (guint i = 0; i < s->views->len; i++) {
    ClothCameraView *view = g_ptr_array_index (s->views, i);

    apply_faults (s->d, view);
    cloth_camera_view_solve_unseen (view, s->d->options->threads);
  }
}

/* The normal equations, linearised at the known faults. */
static gboolean
linearise_again (Search * s)
{
  ClothCameraErrors errors;

  look_again (s);
  cloth_normal_equations_free (s->normal);
  s->normal = linearise (s, s->views, &errors);
  if (s->normal)
    s->d->camera_errors = errors;
  return s->normal != NULL;
}

static gboolean
is_drop (const ClothCameraFault * fault)
{
  return fault->effect->test == CLOTH_EFFECT_TEST_REPEAT;
}

/* Estimates the faults together. */
static gboolean
fit_faults (Search * s)
{
  ClothDiagnosis *d = s->d;

  for (guint step = 0; step < N_STEPS; step++)
    if (!step_faults (s) || !linearise_again (s))
      return FALSE;
  for (guint i = 0; i < d->n_faults; i++)
    if (is_drop (&d->faults[i]))
      d->faults[i].values[0] =
          cloth_camera_view_stale_share (g_ptr_array_index (s->views, 0),
          d->faults[i].camera, &d->faults[i].sigmas[0]);
  return TRUE;
}

static const gchar *
camera_name (const Search * s, guint camera)
{
  return camera < s->rig->n_cameras ?
      g_intern_string (s->rig->cameras[camera].name) : NULL;
}

static const ClothCameraFault *
find_fault (const Search * s, const ClothEffect * effect)
{
  for (guint i = 0; i < s->d->n_faults; i++)
    if (s->d->faults[i].effect == effect)
      return &s->d->faults[i];
  return NULL;
}

/* Probability of an effect among those that were ranked together, or none of them. */
static gdouble
probability_of (const Search * s, const GArray * scores,
    const ClothEffect * effect)
{
  gdouble total = 1., mine = 0.;

  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *score = &g_array_index (scores, ClothGapScore, i);
    gdouble odds = exp (MIN (score->log_bayes_factor / TEMPERATURE, LARGEST));

    total += odds;
    if (candidate_at (s, score->candidate)->effect == effect)
      mine = odds;
  }
  return mine / total;
}

static const ClothGapScore *
find_score (const Search * s, const GArray * scores, const ClothEffect * effect,
    const ClothGapScore * otherwise)
{
  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *score = &g_array_index (scores, ClothGapScore, i);

    if (candidate_at (s, score->candidate)->effect == effect)
      return score;
  }
  return otherwise;
}

/* Lists the effects beside the faults with their scores: @first before any fault was known,
 * @last with all. Those that explain the pictures as well as the first fault form a group with
 * it. */
static void
list_effects (const Search * s, const GArray * first, const GArray * last)
{
  const ClothDiagnosis *d = s->d;

  for (guint i = 0; i < first->len; i++) {
    const ClothGapScore *score = &g_array_index (first, ClothGapScore, i);
    const ClothCandidate *c = candidate_at (s, score->candidate);
    ClothGapEffect e = { c->effect,.group = -1,.shrink = {NAN, NAN, NAN} };

    if (score->kept < CLOTH_GAP_IDENTIFIABLE || find_fault (s, c->effect))
      continue;
    if (d->n_faults && s->alike[score->candidate]) {
      e.probability = probability_of (s, first, c->effect);
      e.group = e.probability > LEAST_ODDS * probability_of (s, first,
          d->faults[0].effect) ? 0 : -1;
    } else {
      e.probability = probability_of (s, last, c->effect);
      score = find_score (s, last, c->effect, score);
      c = candidate_at (s, score->candidate);
    }
    e.p_value = score->p_value;
    e.constancy_p_value = score->constancy_p_value;
    e.camera = camera_name (s, cloth_camera_of_candidate (c));
    for (guint k = 0; k < c->n; k++) {
      e.values[k] = score->changes[k];
      e.sigmas[k] = CLOTH_DIAGNOSIS_SIGMA_WIDTH * score->sigmas[k];
    }
    g_array_append_val (d->camera_effects, e);
  }
}

/* Puts the faults before the other effects, small ones behind them. */
static void
list_faults (const Search * s)
{
  const ClothDiagnosis *d = s->d;
  GArray *to = d->camera_effects;
  guint first = 0;

  for (guint i = 0; i < d->n_faults; i++) {
    const ClothCameraFault *f = &d->faults[i];
    ClothGapEffect e = { f->effect,.group = -1,.accepted =
          !f->small,.probability = f->probability,.p_value =
          f->p_value,.constancy_p_value = f->constancy_p_value,.shrink =
          {NAN, NAN, NAN}
    };

    e.camera = camera_name (s, f->camera);
    for (guint k = 0; k < f->effect->n_parameters; k++) {
      e.values[k] = f->values[k];
      e.sigmas[k] = CLOTH_DIAGNOSIS_SIGMA_WIDTH * f->sigmas[k];
    }
    for (guint k = 0; k < to->len && i == 0; k++)
      if (g_array_index (to, ClothGapEffect, k).group == 0)
        e.group = 0;
    if (f->small)
      g_array_append_val (to, e);
    else
      g_array_insert_val (to, first++, e);
  }
}

/* Notes which effects of the same camera look like the fault that was found first. */
static void
find_alike (Search * s, guint fault)
{
  g_autofree gboolean *blocks = g_new (gboolean, s->normal->n_blocks);
  const ClothGapTest test = {.normal = s->normal,.candidates =
        s->candidates,.blocks = blocks
  };

  for (guint b = 0; b < s->normal->n_blocks; b++)
    blocks[b] = TRUE;
  for (guint c = 0; c < s->candidates->list->len; c++)
    s->alike[c] = candidate_at (s, c)->effect != candidate_at (s, fault)->effect
        && cloth_camera_of_candidate (candidate_at (s, c)) ==
        cloth_camera_of_candidate (candidate_at (s, fault))
        && cloth_gap_test_cosine (&test, fault, c) > AMBIGUOUS_COSINE;
}

/* Mean square of the displacement of the first take's points by a fault alone, m². */
static gdouble
displacement_square (const Search * s, const ClothCameraFault * fault)
{
  const ClothDiagnosis *d = s->d;
  ClothCameraView *view = g_ptr_array_index (s->views, 0);
  gdouble square;

  cloth_camera_view_reset (view);
  cloth_camera_view_apply (view, fault->camera, fault->effect, fault->values);
  square = cloth_camera_view_displacement (view, d->options->threads);
  apply_faults (d, view);
  return square;
}

static void
start_fault (const Search * s, const ClothGapScore * score,
    ClothCameraFault * f)
{
  const ClothCandidate *c = candidate_at (s, score->candidate);

  *f = (ClothCameraFault) {
  .candidate = score->candidate,.effect = c->effect};
  f->camera = cloth_camera_of_candidate (c);
  f->probability = 1. / (1. + exp (-score->log_bayes_factor / TEMPERATURE));
  f->p_value = score->p_value;
  f->constancy_p_value = score->constancy_p_value;
}

/* Accepts and fits the likeliest fault, if it is supported. When it can't be fitted all is as before, but that
 * there are no equations any more. */
static gboolean
accept_fault (Search * s, const GArray * scores)
{
  ClothDiagnosis *d = s->d;
  const ClothCameraErrors errors = d->camera_errors;
  ClothCameraFault before[G_N_ELEMENTS (d->faults)];
  ClothCameraFault *f = &d->faults[d->n_faults];
  const ClothGapScore *score = scores->len ? &g_array_index (scores,
      ClothGapScore, 0) : NULL;

  if (!score || d->n_faults == G_N_ELEMENTS (d->faults)
      || !(score->log_bayes_factor >= CLOTH_DIAGNOSIS_LEAST_LOG_BAYES_FACTOR)
      || !(score->improvement > LEAST_IMPROVEMENT))
    return FALSE;
  if (!d->n_faults)
    find_alike (s, score->candidate);
  memcpy (before, d->faults, sizeof before);
  start_fault (s, score, f);
  d->n_faults++;
  if (!fit_faults (s)) {
    d->n_faults--;
    memcpy (d->faults, before, sizeof before);
    d->camera_errors = errors;
    look_again (s);
    return FALSE;
  }
  return TRUE;
}

/* Faults that hardly move points count as small. Not lost pictures: they were found because
 * they are far off. */
static void
find_small (Search * s)
{
  ClothDiagnosis *d = s->d;

  for (guint i = 0; i < d->n_faults; i++)
    d->faults[i].small = !is_drop (&d->faults[i])
        && !(displacement_square (s, &d->faults[i]) > LEAST_DISPLACEMENT *
        d->camera_errors.detection);
}

/* Corrects the takes and hold-outs: their positions become those that cameras without the faults
 * would have given. The positions before stay beside them. */
static void
correct (ClothDiagnosis * d, const Search * s)
{
  for (guint i = 0; i < d->recordings->len; i++) {
    const ClothObservations *observations = cloth_diagnosis_observations (d, i);
    ClothRecording *r = cloth_diagnosis_recording (d, i);
    g_autoptr (ClothCameraView) view = NULL;
    gdouble square;

    if (!observations || !same_cameras (observations->rig, s->rig)
        || (i >= d->n_takes && i < d->n_takes + d->options->n_baselines))
      continue;
    view = cloth_camera_view_new (r, observations, d->options->threads);
    apply_faults (d, view);
    d->uncorrected[i] = g_memdup2 (r->y, 3 * (gsize) r->n * r->n_frames *
        sizeof *r->y);
    square = cloth_camera_view_correct (view, d->options->threads, r);
    if (i == 0) {
      d->camera_mean_square = square;
      d->camera_errors.triangulation = 0.;
    }
    cloth_recording_interpolate (r);
    cloth_recording_differentiate (r);
  }
}

/* The rig as the first film of the take has it, for whoever films on. */
static void
refine_rig (ClothDiagnosis * d)
{
  const ClothRefineOptions options = CLOTH_REFINE_OPTIONS_DEFAULT;
  g_autoptr (ClothRefinement) refinement = NULL;
  guint i = 0;

  while (!cloth_diagnosis_observations (d, i))
    i++;
  refinement = cloth_refine_rig (cloth_diagnosis_observations (d, i), &options,
      NULL);
  if (!refinement)
    return;
  d->result->rig = g_steal_pointer (&refinement->rig);
  cloth_gap_result_add_note (d->result, "rig-refined.json is the rig as the "
      "film has it, with standard deviations; “gst-cloth-calibrate-1.0 "
      "refine” says what it changes.");
}

/* @d: a diagnosis whose recordings are loaded
 *
 * Looks for what is wrong with the cameras and takes it off the recordings.
 */
void
cloth_diagnosis_find_faults (ClothDiagnosis * d)
{
  g_auto (Search) s = { d };
  g_autoptr (GArray) first = NULL, last = NULL;

  d->camera_effects = g_array_new (FALSE, FALSE, sizeof (ClothGapEffect));
  d->uncorrected = g_new0 (gdouble *, d->recordings->len);
  for (guint i = 0; i < d->n_takes && !s.rig; i++)
    s.rig =
        cloth_diagnosis_observations (d, i) ? cloth_diagnosis_observations (d,
        i)->rig : NULL;
  if (!s.rig)
    return;
  s.candidates = cloth_camera_candidates_new (s.rig, d->options->effects);
  s.null_log_bayes_factors = g_new0 (gdouble, s.candidates->list->len + 1);
  s.alike = g_new0 (gboolean, s.candidates->list->len + 1);
  s.views = open_views (&s, 0, d->n_takes);
  s.normal = linearise (&s, s.views, &d->camera_errors);
  d->has_camera_errors = s.normal != NULL;
  if (!s.normal)
    return;
  study_baselines (&s);
  first = rank (&s, s.normal);
  last = g_array_ref (first);
  while (s.normal && accept_fault (&s, last)) {
    g_array_unref (last);
    last = rank (&s, s.normal);
  }
  find_small (&s);
  list_effects (&s, first, last);
  list_faults (&s);
  if (!cloth_diagnosis_count_faults (d))
    return;
  correct (d, &s);
  refine_rig (d);
}
