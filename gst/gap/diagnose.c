/* The diagnosis.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/diagnose.h"

#include <math.h>
#include <string.h>

#include "gst/gap/extent.h"
#include "gst/gap/score.h"
#include "gst/sim/effect-table.h"

/* Version of the priors and thresholds: a change of either changes probabilities. */
#define PRIORS "1"

/* Length of the windows that the gap is measured in, s. */
#define WINDOW_S 0.3
/* Gain of the observer that leads up to them, 1/s². */
#define WINDOW_GAIN 100.
#define N_FIT 8
#define N_REFIT 3
#define MAX_ACCEPTED 3
#define N_DRAWS 1000
/* Clamps that are never further apart than this move alike, m. */
#define SAME_PATH 1e-3
/* What two takes of one motion share of the simulator's own error is taken off; this
 * part of its power stays. */
#define SIGNATURE_LEFT 0.1
/* A frozen number may be off by this many of its standard deviations on the baseline,
 * which know nothing of the simulator's own error. */
#define FROZEN 3.
/* An effect is accepted when its evidence is this and more than that of the best one on a
 * baseline, when it removes this share of the whitened residual's square from blocks it
 * was not estimated on, and this share of the gap's variance. */
#define LEAST_EVIDENCE 10.
#define LEAST_IMPROVEMENT 0.005
#define LEAST_SHRINK 0.1
/* Evidence is divided by this before it becomes a probability. */
#define TEMPERATURE 4.
/* Effects this close in probability to the best, or with derivatives this alike, are
 * reported together. */
#define AMBIGUOUS_PROBABILITY 0.1
#define AMBIGUOUS_COSINE 0.9
/* Below this share left by the nuisances an effect can't be told from them. */
#define IDENTIFIABLE 0.05
/* What remains is no more than noise when it is below this many floors (variance). */
#define BAND 2.25

typedef struct
{
  ClothTake **takes;
  guint n_takes;
  const ClothGapOptions *options;
  ClothStudyOptions study;
  ClothGapResult *result;
  GPtrArray *recordings;        /* of the takes, the baselines, the hold-outs */
  GPtrArray *studies;           /* of the takes and the baselines */
  ClothModel *model;            /* with its free numbers fitted */
  ClothGapCandidates *candidates;
  gdouble *precisions;          /* of the free numbers */
  guint *all;                   /* every direction */
  ClothGapNormal *normals[CLOTH_STUDY_N_GAINS];
  gboolean *sound;
  gboolean *blocks;             /* that estimates come from */
  guint n_blocks;
  gdouble least_evidence;
  gdouble done;
} Diagnosis;

static void
diagnosis_clear (Diagnosis * d)
{
  g_clear_pointer (&d->recordings, g_ptr_array_unref);
  g_clear_pointer (&d->studies, g_ptr_array_unref);
  cloth_model_free (d->model);
  cloth_gap_candidates_free (d->candidates);
  g_free (d->precisions);
  g_free (d->all);
  for (guint g = 0; g < CLOTH_STUDY_N_GAINS; g++)
    cloth_gap_normal_free (d->normals[g]);
  g_free (d->sound);
  g_free (d->blocks);
  cloth_gap_result_free (d->result);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Diagnosis, diagnosis_clear)
     static gboolean
         tell (Diagnosis * d, gdouble share, const gchar * what,
    GError ** error)
{
  if (!d->options->progress
      || d->options->progress (d->options->progress_data, share, what))
    return TRUE;
  g_set_error (error, CLOTH_GAP_ERROR, CLOTH_GAP_ERROR_CANCELLED,
      "the diagnosis was stopped");
  return FALSE;
}

static ClothRecording *
recording (const Diagnosis * d, guint i)
{
  return g_ptr_array_index (d->recordings, i);
}

static ClothStudy *
study (const Diagnosis * d, guint i)
{
  return g_ptr_array_index (d->studies, i);
}

static gboolean
load_one (Diagnosis * d, ClothTake * take, ClothGapRole role, GError ** error)
{
  ClothRecording *r = cloth_recording_new (take, error);

  if (!r)
    return FALSE;
  g_ptr_array_add (d->recordings, r);
  if (r->n != recording (d, 0)->n) {
    g_set_error (error, CLOTH_GAP_ERROR, CLOTH_GAP_ERROR_TAKE, "%s has %u "
        "vertices and %s has %u: takes, baselines and hold-outs are of one "
        "mesh", recording (d, 0)->name, recording (d, 0)->n, r->name, r->n);
    return FALSE;
  }
  cloth_gap_result_add_input (d->result, role, r->name, NULL);
  if (role != CLOTH_GAP_HOLD_OUT)
    g_ptr_array_add (d->studies, cloth_study_new (r, &d->study));
  return TRUE;
}

static gboolean
load (Diagnosis * d, GError ** error)
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
  return TRUE;
}

static void
skip (gpointer data, const ClothEffect * effect, const gchar * reason)
{
  cloth_gap_result_add_untested (data, effect, reason);
}

/* The model's free numbers: fitted on the baselines, else on the takes. */
static gboolean
fit_free (Diagnosis * d, const ClothModel * model, GError ** error)
{
  guint begin = d->options->n_baselines ? d->n_takes : 0;
  guint n = d->options->n_baselines ? d->options->n_baselines : d->n_takes;
  guint m = d->candidates->n_free;
  g_autofree gdouble *precisions = g_new (gdouble, m + 1);
  g_autofree gdouble *sigmas = g_new0 (gdouble, m + 1);

  for (guint i = 0; i < m; i++) {
    gdouble prior = g_array_index (d->candidates->directions,
        ClothGapDirection, i).prior;

    precisions[i] = 1. / (prior * prior);
  }
  d->model = cloth_study_fit ((ClothStudy **) d->studies->pdata + begin, n,
      d->candidates, model, d->all, precisions, m, NULL, N_FIT, &d->study,
      sigmas, error);
  for (guint i = 0; i < m; i++)
    d->precisions[i] = d->options->n_baselines && sigmas[i] > 0. ?
        MAX (precisions[i], 1. / (FROZEN * FROZEN * sigmas[i] * sigmas[i])) :
        precisions[i];
  return d->model != NULL;
}

static gboolean
moves_alike (const ClothRecording * a, const ClothRecording * b)
{
  const ClothScene *s = a->scene, *t = b->scene;

  if (a->n_frames != b->n_frames || s->held->len != t->held->len
      || a->times[a->n_frames - 1] != b->times[b->n_frames - 1])
    return FALSE;
  for (guint i = 0; i < s->held->len; i++) {
    const ClothHeld *p = &g_array_index (s->held, ClothHeld, i);
    const ClothHeld *q = &g_array_index (t->held, ClothHeld, i);

    if (p->vertex != q->vertex || p->from_s != q->from_s
        || p->until_s != q->until_s)
      return FALSE;
  }
  for (gsize i = 0; i < 3 * (gsize) a->n_frames * s->held->len; i++)
    if (!(fabs (s->clamps[i] - t->clamps[i]) < SAME_PATH))
      return FALSE;
  return TRUE;
}

static ClothGapNormal *
append (ClothGapNormal * to, ClothGapNormal * from)
{
  gsize square = (gsize) from->m * from->m;

  if (!to)
    return from;
  to->g = g_renew (gdouble, to->g, (to->n_blocks + from->n_blocks) * square);
  to->s = g_renew (gdouble, to->s, (to->n_blocks + from->n_blocks) * from->m);
  to->r = g_renew (gdouble, to->r, to->n_blocks + from->n_blocks);
  memcpy (to->g + to->n_blocks * square, from->g,
      from->n_blocks * square * sizeof (gdouble));
  memcpy (to->s + (gsize) to->n_blocks * from->m, from->s,
      (gsize) from->n_blocks * from->m * sizeof (gdouble));
  memcpy (to->r + to->n_blocks, from->r, from->n_blocks * sizeof (gdouble));
  to->n_blocks += from->n_blocks;
  cloth_gap_normal_free (from);
  return to;
}

/* Mean square that the simulator itself is off by: of the baselines, else of the take
 * with the model fitted to it. */
static ClothGapPower *
mismatch_of (const Diagnosis * d, guint gain)
{
  guint begin = d->options->n_baselines ? d->n_takes : 0;
  guint n = d->options->n_baselines ? d->options->n_baselines : d->n_takes;
  ClothGapPower *mean = NULL;

  for (guint i = begin; i < begin + n; i++) {
    ClothGapPower *power = cloth_gap_power_new (study (d, i)->features,
        study (d, i)->z[gain]);

    if (!mean) {
      mean = power;
      continue;
    }
    for (guint k = 0; k < mean->n; k++)
      mean->values[k] += (power->values[k] - mean->values[k]) / (i - begin + 1);
    cloth_gap_power_free (power);
  }
  return mean;
}

/* The signature of the simulator's own error in a take is that of a baseline that moves
 * alike: taken off, a tenth of its power is left to doubt. */
static ClothGapNormal *
normal_of (const Diagnosis * d, guint take, guint gain,
    const ClothGapPower * mismatch)
{
  const ClothStudy *s = study (d, take);
  g_autofree gdouble *z = g_memdup2 (s->z[gain],
      s->features->size * sizeof (gdouble));
  g_autoptr (ClothGapPower) left = NULL;

  for (guint i = d->n_takes; i < d->studies->len; i++) {
    const ClothStudy *b = study (d, i);

    if (i == take || !moves_alike (s->recording, b->recording))
      continue;
    for (gsize k = 0; k < s->features->size; k++)
      z[k] -= b->z[gain][k];
    left = cloth_gap_power_new (s->features, z);
    for (guint k = 0; k < left->n; k++)
      left->values[k] = MIN (mismatch->values[k], MAX (left->values[k],
              SIGNATURE_LEFT * mismatch->values[k]));
    break;
  }
  return cloth_gap_normal_new (s->features, left ? left : mismatch, 1., z,
      s->columns[gain], s->m);
}

static gboolean
linearise (Diagnosis * d, guint begin, guint end, gdouble from, gdouble to,
    GError ** error)
{
  for (guint i = begin; i < end; i++) {
    g_autofree gchar *what = g_strdup_printf ("effects on %s",
        recording (d, i)->name);

    if (!tell (d, from + (to - from) * (i - begin) / (end - begin), what, error)
        || !cloth_study_linearise (study (d, i), d->candidates, d->model,
            d->all, d->candidates->directions->len, &d->study, error))
      return FALSE;
  }
  return TRUE;
}

/* Test of the takes' blocks from begin to end, as studies. */
static void
make_test (Diagnosis * d, guint begin, guint end, ClothGapTest * test)
{
  guint m = d->candidates->directions->len;

  for (guint i = 0; i < m; i++)
    d->sound[i] = TRUE;
  for (guint g = 0; g < CLOTH_STUDY_N_GAINS; g++) {
    g_autoptr (ClothGapPower) mismatch = mismatch_of (d, g);

    g_clear_pointer (&d->normals[g], cloth_gap_normal_free);
    for (guint i = begin; i < end; i++)
      d->normals[g] = append (d->normals[g], normal_of (d, i, g, mismatch));
    test->normals[g] = d->normals[g];
  }
  for (guint i = begin; i < end; i++)
    for (guint k = 0; k < m; k++)
      d->sound[k] = d->sound[k] && study (d, i)->sound[k];
  d->n_blocks = d->normals[0]->n_blocks;
  g_free (d->blocks);
  d->blocks = g_new (gboolean, d->n_blocks);
  for (guint b = 0; b < d->n_blocks; b++)
    d->blocks[b] = TRUE;
  test->candidates = d->candidates;
  test->blocks = d->blocks;
  test->nuisances = d->all;
  test->precisions = d->precisions;
  test->n_nuisances = d->candidates->n_free;
  test->overdispersion = d->study.overdispersion;
  test->sound = d->sound;
}

static const ClothGapCandidate *
candidate_of (const Diagnosis * d, const ClothGapScore * score)
{
  return &g_array_index (d->candidates->list, ClothGapCandidate,
      score->candidate);
}

/* Largest evidence that holds on blocks it was not estimated on. */
static gdouble
best_evidence (const GArray * scores)
{
  gdouble best = 0.;

  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);

    if (s->improvement > LEAST_IMPROVEMENT)
      best = MAX (best, s->evidence);
  }
  return best;
}

static void
fill_effects (Diagnosis * d, const ClothGapTest * test, const GArray * scores)
{
  gdouble total = 1., top = 0.;
  gboolean grouped = FALSE;

  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);

    top = MAX (top, s->evidence / TEMPERATURE);
  }
  total = exp (-top);
  for (guint i = 0; i < scores->len; i++)
    total += exp (g_array_index (scores, ClothGapScore, i).evidence /
        TEMPERATURE - top);
  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);
    const ClothGapCandidate *c = candidate_of (d, s);
    ClothGapEffect *e;

    if (s->kept < IDENTIFIABLE) {
      cloth_gap_result_add_untested (d->result, c->effect, "In this motion it "
          "can't be told from the model's free numbers.");
      continue;
    }
    e = cloth_gap_result_add_effect (d->result, c->effect);
    e->probability = exp (s->evidence / TEMPERATURE - top) / total;
    e->p_value = s->p_value;
    e->constancy_p_value = s->constancy_p_value;
    e->group = -1;
    for (guint k = 0; k < c->effect->n_parameters; k++) {
      e->values[k] = c->values[k];
      e->sigmas[k] = NAN;
    }
    for (guint k = 0; k < c->n; k++) {
      e->values[c->parameters[k]] += s->changes[k];
      e->sigmas[c->parameters[k]] = s->sigmas[k];
    }
  }
  /* the best, and those that can't be told from it */
  for (guint i = 1; i < d->result->effects->len && i < scores->len; i++) {
    ClothGapEffect *best = &g_array_index (d->result->effects, ClothGapEffect,
        0);
    ClothGapEffect *e = &g_array_index (d->result->effects, ClothGapEffect, i);
    gboolean near = best->probability - e->probability < AMBIGUOUS_PROBABILITY;

    for (guint k = 1; k < scores->len && !near; k++) {
      const ClothGapScore *s = &g_array_index (scores, ClothGapScore, k);
      const ClothGapScore *first = &g_array_index (scores, ClothGapScore, 0);

      if (candidate_of (d, s)->effect == e->effect
          && candidate_of (d, first)->effect == best->effect)
        near = e->probability > 0.05 * best->probability
            && cloth_gap_test_cosine (test, first->candidate, s->candidate) >
            AMBIGUOUS_COSINE;
    }
    if (!near)
      continue;
    if (!grouped)
      cloth_gap_result_add_group (d->result, NULL, NAN);
    grouped = TRUE;
    best->group = e->group = 0;
  }
}

/* Every other block of time judges what the others have fitted. */
static gboolean
is_held_out (const Diagnosis * d, guint block)
{
  return !d->options->n_hold_outs && block % 2 == 1;
}

/* The windows that judge: those that end in a held-out block, or all. */
static gboolean *
judging_windows (const Diagnosis * d, const ClothGapExtent * extent)
{
  const ClothGapFeatures *f = study (d, 0)->features;
  gboolean *windows = g_new0 (gboolean, extent->n_windows);
  gboolean any = FALSE;

  for (guint frame = 1, block = 0; frame < extent->n_frames; frame++) {
    while (block + 1 < f->n_blocks && frame >= f->first[block + 1])
      block++;
    windows[extent->window[frame]] = is_held_out (d, block);
  }
  for (guint w = 0; w < extent->n_windows; w++)
    any |= windows[w];
  for (guint w = 0; w < extent->n_windows && !any; w++)
    windows[w] = TRUE;
  return windows;
}

/* Takes the leader into the model, fitted; the free numbers may give a little. */
static ClothModel *
refit (Diagnosis * d, const ClothModel * model, const ClothGapScore * score,
    gdouble * sigmas, GError ** error)
{
  const ClothGapCandidate *c = candidate_of (d, score);
  guint free = d->candidates->n_free, m = free + c->n;
  g_autofree guint *directions = g_new (guint, m);
  g_autofree gdouble *precisions = g_new (gdouble, m);
  g_autofree gdouble *all_sigmas = g_new (gdouble, m);
  g_autofree guint *moved = g_new (guint, c->n);
  g_autofree gboolean *blocks = g_new (gboolean, d->n_blocks);
  g_autoptr (ClothModel) start = NULL;
  ClothModel *fitted;

  for (guint b = 0; b < d->n_blocks; b++)
    blocks[b] = !is_held_out (d, b);

  for (guint i = 0; i < m; i++) {
    directions[i] = i < free ? i : c->first + i - free;
    if (i < free) {
      precisions[i] = d->precisions[i];
    } else {
      gdouble prior = g_array_index (d->candidates->directions,
          ClothGapDirection, directions[i]).prior;

      precisions[i] = 1. / (4. * prior * prior);
      moved[i - free] = directions[i];
    }
  }
  start = cloth_gap_candidates_move (d->candidates, model, moved,
      score->changes, c->n);
  fitted = cloth_study_fit ((ClothStudy **) d->studies->pdata, d->n_takes,
      d->candidates, start, directions, precisions, m, blocks, N_REFIT,
      &d->study, all_sigmas, error);
  for (guint k = 0; fitted && k < c->n; k++)
    sigmas[k] = all_sigmas[free + k];
  return fitted;
}

static ClothGapEstimate
estimate (gdouble square, gdouble * draws, guint n, guint stride)
{
  ClothGapEstimate e = { sqrt (square), NAN, NAN };
  g_autoptr (GArray) sorted = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint i = 0; i < n; i++)
    g_array_append_val (sorted, draws[(gsize) i * stride]);
  for (guint i = 1; i < sorted->len; i++) {
    gdouble x = g_array_index (sorted, gdouble, i);
    guint k = i;

    for (; k && g_array_index (sorted, gdouble, k - 1) > x; k--)
      g_array_index (sorted, gdouble, k) =
          g_array_index (sorted, gdouble, k - 1);
    g_array_index (sorted, gdouble, k) = x;
  }
  if (n) {
    e.low = sqrt (MAX (0., g_array_index (sorted, gdouble, n / 40)));
    e.high = sqrt (MAX (0., g_array_index (sorted, gdouble, n - 1 - n / 40)));
  }
  return e;
}

/* Without a baseline the floor is what the two force models differ by, and the noise:
 * NaN on errors. */
static gdouble
own_floor (Diagnosis * d, guint judge, const ClothGapExtent * extent,
    GError ** error)
{
  const ClothRecording *r = recording (d, judge);
  g_autoptr (ClothModel) other = cloth_model_copy (d->model);
  const ClothModel *models[1] = { other };
  ClothGapExtent **extents;
  gdouble sum = 0.;
  gsize all = (gsize) r->n * r->n_frames;

  other->force_model = other->force_model == CLOTH_FORCE_MEMBRANE ?
      CLOTH_FORCE_MASS_SPRING : CLOTH_FORCE_MEMBRANE;
  extents = cloth_gap_extents_new (r, models, 1, WINDOW_GAIN, WINDOW_S,
      &d->study.rollout, error);
  if (!extents)
    return NAN;
  for (gsize i = 0; i < 3 * all && extents[0]->sound; i++) {
    gdouble off = extents[0]->positions[i] - extent->positions[i];

    sum += off * off;
  }
  cloth_gap_extents_free (extents, 1);
  return 3. * r->sigma * r->sigma + sum / all;
}

/* How large the gap is before and after, on the hold-outs if there are any; the floor on
 * the baselines. */
static gboolean
measure (Diagnosis * d, const ClothModel * with, GError ** error)
{
  ClothGapResult *result = d->result;
  const ClothModel *models[2] = { d->model, with };
  guint n = with ? 2 : 1;
  guint judge = d->options->n_hold_outs ? d->n_takes + d->options->n_baselines
      : 0;
  g_autofree gdouble *draws = g_new0 (gdouble, N_DRAWS * 2);
  g_autofree gdouble *shrinks = g_new (gdouble, N_DRAWS);
  g_autofree gboolean *windows = NULL;
  ClothGapExtent **extents, **floor = NULL;
  gdouble v[2] = { NAN, NAN }, v_floor = NAN;

  if (!tell (d, 0.9, "the gap in windows", error))
    return FALSE;
  extents = cloth_gap_extents_new (recording (d, judge), models, n,
      WINDOW_GAIN, WINDOW_S, &d->study.rollout, error);
  if (!extents)
    return FALSE;
  if (!judge)
    windows = judging_windows (d, extents[0]);
  for (guint i = 0; i < n; i++)
    v[i] = cloth_gap_extent_square (extents[i], windows);
  cloth_gap_extents_interval (extents, n, windows, d->options->seed, N_DRAWS,
      draws);
  result->held_out_takes = d->options->n_hold_outs > 0;
  result->gap_before = estimate (v[0], draws, N_DRAWS, n);
  if (with)
    result->gap_after = estimate (v[1], draws + 1, N_DRAWS, n);
  if (d->options->n_baselines) {
    g_autofree gdouble *floor_draws = g_new (gdouble, N_DRAWS);

    floor = cloth_gap_extents_new (recording (d, d->n_takes), models, 1,
        WINDOW_GAIN, WINDOW_S, &d->study.rollout, error);
    if (floor) {
      v_floor = cloth_gap_extent_square (floor[0], NULL);
      cloth_gap_extents_interval (floor, 1, NULL, d->options->seed, N_DRAWS,
          floor_draws);
      result->noise_floor = estimate (v_floor, floor_draws, N_DRAWS, 1);
    }
    cloth_gap_extents_free (floor, 1);
  } else {
    v_floor = own_floor (d, judge, extents[0], error);
    if (isnan (v_floor)) {
      cloth_gap_extents_free (extents, n);
      return FALSE;
    }
    result->noise_floor = (ClothGapEstimate) {
    sqrt (v_floor), NAN, NAN};
  }
  if (with && v[0] > v_floor) {
    for (guint i = 0; i < N_DRAWS; i++) {
      gdouble s = (draws[2 * i] - draws[2 * i + 1]) / (draws[2 * i] - v_floor);

      shrinks[i] = draws[2 * i] > v_floor ? s * s : 0.;
    }
    result->shrink = estimate (0., shrinks, N_DRAWS, 1);
    result->shrink.value = (v[0] - v[1]) / (v[0] - v_floor);
  }
  if (judge == 0)
    cloth_gap_extent_fill (extents[0], with ? extents[1] : NULL,
        recording (d, 0), d->takes[0], result);
  cloth_gap_extents_free (extents, n);
  if (judge) {
    extents = cloth_gap_extents_new (recording (d, 0), models, n, WINDOW_GAIN,
        WINDOW_S, &d->study.rollout, error);
    if (!extents)
      return FALSE;
    cloth_gap_extent_fill (extents[0], with ? extents[1] : NULL,
        recording (d, 0), d->takes[0], result);
    cloth_gap_extents_free (extents, n);
  }
  return TRUE;
}

static void
decide (Diagnosis * d, guint n_accepted)
{
  ClothGapResult *r = d->result;
  gdouble floor2 = r->noise_floor.value * r->noise_floor.value;
  gdouble after = n_accepted ? r->gap_after.value : r->gap_before.value;

  if (n_accepted && !(after * after < (1. - LEAST_SHRINK) *
          r->gap_before.value * r->gap_before.value)) {
    /* it is there by the test, but too small to matter */
    for (guint i = 0; i < r->effects->len; i++)
      g_array_index (r->effects, ClothGapEffect, i).accepted = FALSE;
    n_accepted = 0;
    after = r->gap_before.value;
  }
  for (guint i = 0; i < r->effects->len && n_accepted; i++) {
    ClothGapEffect *e = &g_array_index (r->effects, ClothGapEffect, i);

    if (e->accepted)
      e->shrink = r->shrink;
  }
  if (!n_accepted) {
    r->verdict = after * after < BAND * floor2 ? CLOTH_GAP_NO_GAP :
        CLOTH_GAP_UNEXPLAINED;
    return;
  }
  if (after * after > BAND * floor2)
    r->verdict = CLOTH_GAP_UNEXPLAINED;
  else
    r->verdict = r->groups->len ? CLOTH_GAP_AMBIGUOUS : CLOTH_GAP_EXPLAINED;
}

static void
accept_effect (Diagnosis * d, const ClothGapScore * score,
    const ClothModel * model, const gdouble * sigmas)
{
  const ClothGapCandidate *c = candidate_of (d, score);

  for (guint i = 0; i < d->result->effects->len; i++) {
    ClothGapEffect *e = &g_array_index (d->result->effects, ClothGapEffect, i);

    if (e->effect != c->effect)
      continue;
    e->accepted = TRUE;
    for (guint k = 0; k < c->n; k++) {
      const ClothGapDirection *direction =
          &g_array_index (d->candidates->directions, ClothGapDirection,
          c->first + k);

      cloth_model_get (model, direction->name, &e->values[c->parameters[k]],
          NULL);
      e->sigmas[c->parameters[k]] = sigmas[k];
    }
  }
}

static gboolean
select_effects (Diagnosis * d, const ClothGapTest * test,
    const GArray * scores, ClothModel ** with, guint * n_accepted,
    GError ** error)
{
  const ClothGapScore *first;
  gdouble sigmas[4] = { NAN, NAN, NAN, NAN };

  *n_accepted = 0;
  if (!scores->len)
    return TRUE;
  first = &g_array_index (scores, ClothGapScore, 0);
  if (first->evidence < d->least_evidence
      || first->improvement < LEAST_IMPROVEMENT)
    return TRUE;
  if (!tell (d, 0.75, candidate_of (d, first)->effect->id, error))
    return FALSE;
  *with = refit (d, d->model, first, sigmas, error);
  if (!*with)
    return FALSE;
  accept_effect (d, first, *with, sigmas);
  *n_accepted = 1;
  return TRUE;
}

static gboolean
diagnose (Diagnosis * d, const ClothModel * model, GError ** error)
{
  g_autoptr (GArray) scores = NULL;
  g_autoptr (ClothModel) with = NULL;
  ClothGapTest test = { {NULL} };
  guint n_all, n_accepted, n_baselines = d->options->n_baselines;

  if (!load (d, error))
    return FALSE;
  d->candidates = cloth_gap_candidates_new (model, recording (d, 0),
      d->options->effects, n_baselines > 0, skip, d->result, error);
  if (!d->candidates)
    return FALSE;
  n_all = d->candidates->directions->len;
  d->all = g_new (guint, n_all + 1);
  for (guint i = 0; i < n_all; i++)
    d->all[i] = i;
  d->precisions = g_new (gdouble, d->candidates->n_free + 1);
  d->sound = g_new (gboolean, n_all + 1);
  if (!tell (d, 0., "the model's free numbers", error)
      || !fit_free (d, model, error))
    return FALSE;
  if (n_baselines) {
    g_autoptr (GArray) null_scores = NULL;

    if (!linearise (d, d->n_takes, d->studies->len, 0.3, 0.5, error))
      return FALSE;
    make_test (d, d->n_takes, d->studies->len, &test);
    null_scores = cloth_gap_test_run (&test);
    d->least_evidence = MAX (d->least_evidence, best_evidence (null_scores));
  }
  if (!linearise (d, 0, d->n_takes, 0.5, 0.7, error))
    return FALSE;
  make_test (d, 0, d->n_takes, &test);
  scores = cloth_gap_test_run (&test);
  fill_effects (d, &test, scores);
  if (!select_effects (d, &test, scores, &with, &n_accepted, error)
      || !measure (d, with, error))
    return FALSE;
  decide (d, n_accepted);
  return TRUE;
}

/**
 * cloth_gap_diagnose:
 * @takes: (array length=n_takes): what was recorded
 * @n_takes: how many, at least one; of the same cloth
 * @model: what the simulator knows
 * @options: what else is given
 * @error: #ClothGapError, #ClothSimError, or what reading a take says
 *
 * Runs the simulation with weak springs to what was recorded, tests by its score which
 * effect the residual asks for once the model's free numbers and the simulator's own
 * error are taken off, adds the best one, and measures the gap without and with it.
 *
 * Returns: (transfer full) (nullable): what was found
 * Since: 0.1
 */
ClothGapResult *
cloth_gap_diagnose (ClothTake ** takes, guint n_takes,
    const ClothModel * model, const ClothGapOptions * options, GError ** error)
{
  g_auto (Diagnosis) d = { takes, n_takes, options };
  gint64 start = g_get_monotonic_time ();

  d.least_evidence = LEAST_EVIDENCE;
  cloth_study_options_init (&d.study);
  d.study.rollout.seed = options->seed;
  d.study.rollout.threads = options->threads;
  d.result = cloth_gap_result_new ();
  d.recordings = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_recording_free);
  d.studies = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_study_free);
  if (!diagnose (&d, model, error))
    return NULL;
  d.result->seed = options->seed;
  d.result->simulations = d.study.simulations;
  d.result->seconds = (g_get_monotonic_time () - start) * 1e-6;
  cloth_gap_result_add_version (d.result, "priors", PRIORS);
  cloth_gap_result_add_threshold (d.result, "least evidence (logarithm of the "
      "Bayes factor)", d.least_evidence, "1");
  cloth_gap_result_add_threshold (d.result, "least share of the whitened "
      "residual removed from blocks not estimated on", LEAST_IMPROVEMENT, "1");
  cloth_gap_result_add_threshold (d.result, "least share of the gap's variance",
      LEAST_SHRINK, "1");
  cloth_gap_result_add_threshold (d.result, "largest rest over the floor, of "
      "variance", BAND, "1");
  return g_steal_pointer (&d.result);
}
