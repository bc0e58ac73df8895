/* Explanations: sets of effects, each simulated where the data ask it to be.
 *
 * Sets of up to three effects are compared by the derivatives of one linearisation. Every single
 * effect and the best of the larger sets get simulations of their own: each moves to its most
 * probable values by Gauss–Newton steps, with derivatives that follow what was simulated (Broyden
 * 1965). An effect of one number may turn over far from its null, so in the first round it is
 * also tried at one and two priors to either side.
 * Formula: posterior ∝ evidence (likelihood.c) × Π 1/number of effects, and of an effect with several
 *   candidates 1/number of these.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/hypotheses.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/pool.h"
#include "gst/math/statistics.h"

/* Sets of two and of three effects that are simulated. */
#define N_PAIRS 16
#define N_TRIPLES 8
/* Steps of each at most, and the share of a prior at which it has arrived. */
#define N_STEPS 4
#define ARRIVED 0.2
/* No step is longer than this many priors. */
#define LONGEST_STEP 1.5
/* What is less likely by this much (logarithm) won't be the likeliest. */
#define HOPELESS 12.

/* What is there or not is there as it is tried, up to this share. */
#define PRESENT_PRIOR 0.1
/* Gusts may be so many times as strong as they are expected to be. */
#define STRONG_GUSTS 3.

static const gdouble probes[] = { -2., -1., 1., 2. };

static void
clear (gpointer item)
{
  cloth_gap_hypothesis_clear (item);
}

/* Returns: (transfer full) (element-type ClothGapHypothesis): none yet */
GArray *
cloth_gap_hypotheses_new (void)
{
  GArray *hypotheses = g_array_new (FALSE, TRUE, sizeof (ClothGapHypothesis));

  g_array_set_clear_func (hypotheses, clear);
  return hypotheses;
}

/* @hypothesis: an explanation
 *
 * Frees what it holds.
 */
void
cloth_gap_hypothesis_clear (ClothGapHypothesis * hypothesis)
{
  g_clear_pointer (&hypothesis->z, g_free);
  g_clear_pointer (&hypothesis->derivatives, g_free);
}

/* @hypothesis: (out caller-allocates): an explanation that was not simulated yet
 * @candidates: all candidates
 * @stack: (nullable): features; %NULL: none of the candidates are gusts
 * @list: (array length=n): which of them act, growing
 * @n: how many
 *
 * Returns: whether they have no more numbers together than an explanation can have
 */
gboolean
cloth_gap_hypothesis_init (ClothGapHypothesis * hypothesis,
    const ClothCandidates * candidates, const ClothGapStack * stack,
    const guint * list, guint n)
{
  ClothGapHypothesis *h = hypothesis;

  *h = (ClothGapHypothesis) {
  n,.objective = -INFINITY,.by_residual = INFINITY,.behind = INFINITY};
  for (guint c = 0; c < n; c++) {
    const ClothCandidate *candidate =
        &g_array_index (candidates->list, ClothCandidate, list[c]);

    h->candidates[c] = list[c];
    if (cloth_candidate_is_stochastic (candidate))
      h->n_winds = stack->n_winds;
    if (h->n_directions + h->n_winds + candidate->n > CLOTH_GAP_MAX_DIRECTIONS)
      return FALSE;
    for (guint k = 0; k < candidate->n; k++) {
      const ClothDirection *d = cloth_candidates_direction (candidates,
          candidate->first + k);

      h->directions[h->n_directions] = candidate->first + k;
      h->priors[h->n_directions++] = d->present ? (ClothGapPrior) {
      PRESENT_PRIOR, 1., FALSE} : (ClothGapPrior) {
      d->prior, 0., d->one_sided};
    }
  }
  for (guint k = 0; k < h->n_winds; k++) {
    const guint direction = stack->n - stack->n_winds + k;

    h->directions[h->n_directions] = stack->n_free + direction;
    h->priors[h->n_directions++] = (ClothGapPrior) {
    stack->priors[direction], 0., FALSE};
  }
  return TRUE;
}

/* @to: (out caller-allocates): a copy
 * @from: an explanation
 */
void
cloth_gap_hypothesis_copy (ClothGapHypothesis * to,
    const ClothGapHypothesis * from)
{
  *to = *from;
  to->z = NULL;
  to->derivatives = NULL;
}

/* @hypothesis: an explanation
 * @candidate: a candidate
 *
 * Returns: whether it is part of it
 */
gboolean
cloth_gap_hypothesis_has (const ClothGapHypothesis * hypothesis,
    guint candidate)
{
  for (guint c = 0; c < hypothesis->n; c++)
    if (hypothesis->candidates[c] == candidate)
      return TRUE;
  return FALSE;
}

/* @a: an explanation
 * @b: another
 *
 * Returns: whether the same candidates act
 */
gboolean
cloth_gap_hypothesis_is_same (const ClothGapHypothesis * a,
    const ClothGapHypothesis * b)
{
  return a->n == b->n && memcmp (a->candidates, b->candidates,
      a->n * sizeof *a->candidates) == 0;
}

static ClothModel *
make_model_at (const ClothDiagnosis * d, const ClothGapHypothesis * h,
    const gdouble * at)
{
  return cloth_candidates_move (d->candidates, d->model, h->directions, at,
      h->n_directions - h->n_winds);
}

/* @d: a diagnosis
 * @hypothesis: an explanation
 *
 * Returns: (transfer full): the model with it
 */
ClothModel *
cloth_gap_hypothesis_make_model (const ClothDiagnosis * d,
    const ClothGapHypothesis * hypothesis)
{
  return make_model_at (d, hypothesis, hypothesis->at);
}

static const ClothCandidate *
candidate_of (const ClothDiagnosis * d, guint i)
{
  return &g_array_index (d->candidates->list, ClothCandidate, i);
}

/* Whether all directions of a candidate could be simulated. */
static gboolean
can_act (const ClothDiagnosis * d, const ClothGapStack * stack, guint i)
{
  const ClothCandidate *c = candidate_of (d, i);

  if (!c->n)
    return stack->n_winds > 0;
  for (guint t = 0; t < d->n_takes; t++)
    for (guint k = 0; k < c->n; k++)
      if (!cloth_diagnosis_study (d, t)->sound[c->first + k])
        return FALSE;
  return TRUE;
}

/* How many effects there are, of which each is as likely as another. */
static guint
count_effects (const ClothDiagnosis * d)
{
  guint n = 0;

  for (guint i = 0; i < d->candidates->list->len; i++)
    n += i == 0
        || candidate_of (d, i)->effect != candidate_of (d, i - 1)->effect;
  return MAX (n, 2);
}

static guint
count_alternatives (const ClothDiagnosis * d, guint candidate)
{
  guint n = 0;

  for (guint i = 0; i < d->candidates->list->len; i++)
    n += candidate_of (d, i)->effect == candidate_of (d, candidate)->effect;
  return n;
}

/* Logarithm of its odds against nothing, before anything is seen. */
static gdouble
log_odds (const ClothDiagnosis * d, const ClothGapHypothesis * h)
{
  gdouble sum = 0.;

  for (guint c = 0; c < h->n; c++)
    sum -= log ((count_effects (d) - 1.) * count_alternatives (d,
            h->candidates[c]));
  return sum;
}

/* Within the range of each number, and not too far from where it is. */
static void
keep_in_range (const ClothDiagnosis * d, ClothGapHypothesis * h)
{
  for (guint k = 0; k < h->n_directions - h->n_winds; k++) {
    const ClothDirection *direction =
        cloth_candidates_direction (d->candidates, h->directions[k]);
    const gdouble step = LONGEST_STEP * direction->prior;

    if (direction->present) {
      h->next[k] = 1.;
      continue;
    }
    if (h->z)
      h->next[k] = CLAMP (h->next[k], h->at[k] - step, h->at[k] + step);
    h->next[k] = CLAMP (h->next[k], direction->low - direction->centre,
        direction->high - direction->centre);
  }
}

/* The evidence of gusts that are as strong as expected, or so many times as strong, each as likely. */
static gboolean
find_gust_evidence (const ClothGapGram * gram, const guint * list,
    const gdouble * at, ClothGapHypothesis * h)
{
  const guint n_simulated = h->n_directions - h->n_winds;
  ClothGapPrior priors[CLOTH_GAP_MAX_DIRECTIONS];
  ClothGapEvidence strong;
  gdouble most;

  memcpy (priors, h->priors, sizeof priors);
  for (guint k = n_simulated; k < h->n_directions; k++)
    priors[k].prior *= STRONG_GUSTS;
  if (!cloth_gap_gram_find_evidence (gram, list, at, h->priors,
          h->n_directions, &h->evidence)
      || !cloth_gap_gram_find_evidence (gram, list, at, priors,
          h->n_directions, &strong))
    return FALSE;
  most = MAX (h->evidence.log_evidence, strong.log_evidence);
  most += log (0.5 * (exp (h->evidence.log_evidence - most) +
          exp (strong.log_evidence - most)));
  if (strong.log_evidence > h->evidence.log_evidence)
    h->evidence = strong;
  h->evidence.log_evidence = most;
  return TRUE;
}

/* Less its posterior by the residual, logarithm. */
static gdouble
find_behind (const ClothDiagnosis * d, const ClothGapHypothesis * h)
{
  return -h->evidence.log_evidence - log_odds (d, h);
}

/* A hypothesis by the derivatives of the linearisation: from where the base is. It stays uncompared when its numbers
 * aren't finite. */
static void
screen (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    ClothGapHypothesis * h)
{
  guint list[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble at[CLOTH_GAP_MAX_DIRECTIONS] = { 0. };

  for (guint k = 0; k < h->n_directions; k++) {
    for (guint b = 0; b < l->base->n_directions - l->base->n_winds; b++)
      if (l->base->directions[b] == h->directions[k])
        at[k] = l->base->at[b];
    list[k] = h->directions[k] - d->candidates->n_free;
  }
  if (h->n_winds ? !find_gust_evidence (l->gram, list, at, h) :
      !cloth_gap_gram_find_evidence (l->gram, list, at, h->priors,
          h->n_directions, &h->evidence))
    return;
  h->by_residual = find_behind (d, h);
  memcpy (h->next, h->evidence.values, sizeof h->next);
  keep_in_range (d, h);
  h->is_compared = TRUE;
  h->is_settled = h->n_winds > 0;
}

static gint
compare_by_residual (gconstpointer a, gconstpointer b)
{
  const ClothGapHypothesis *x = a, *y = b;

  return x->by_residual < y->by_residual ? -1 : x->by_residual > y->by_residual;
}

/* @hypotheses: (element-type ClothGapHypothesis): explanations, none of which is there twice
 * @hypothesis: one
 *
 * Returns: (nullable): the one of the list with the same effects
 */
ClothGapHypothesis *
cloth_gap_hypotheses_find (const GArray * hypotheses,
    const ClothGapHypothesis * hypothesis)
{
  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *other = &g_array_index (hypotheses,
        ClothGapHypothesis, i);

    if (cloth_gap_hypothesis_is_same (other, hypothesis))
      return other;
  }
  return NULL;
}

/* The one of the list that lacks one candidate of @h and is the same else, or NULL. */
static ClothGapHypothesis *
find_part (const GArray * hypotheses, const ClothGapHypothesis * h, guint c)
{
  ClothGapHypothesis part = { 0 };

  for (guint k = 0; k < h->n; k++)
    if (k != c)
      part.candidates[part.n++] = h->candidates[k];
  return cloth_gap_hypotheses_find (hypotheses, &part);
}

/* A set and one more; FALSE when that can't be. */
static gboolean
add_one (const ClothDiagnosis * d, const ClothGapStack * stack,
    const ClothGapHypothesis * set, guint one, ClothGapHypothesis * h)
{
  guint list[CLOTH_GAP_MAX_EFFECTS], n = 0;

  if (set->n == CLOTH_GAP_MAX_EFFECTS || !can_act (d, stack, one))
    return FALSE;
  for (guint c = 0; c < set->n; c++) {
    if (candidate_of (d, set->candidates[c])->effect ==
        candidate_of (d, one)->effect)
      return FALSE;
    if (n == c && one < set->candidates[c])
      list[n++] = one;
    list[n++] = set->candidates[c];
  }
  if (n == set->n)
    list[n++] = one;
  return cloth_gap_hypothesis_init (h, d->candidates, stack, list, n);
}

typedef struct
{
  const ClothDiagnosis *d;
  const ClothGapLinearisation *l;
  GArray *hypotheses;
} Screening;

static void
screen_some (gpointer data, guint begin, guint end, guint worker)
{
  const Screening *s = data;

  for (guint i = begin; i < end; i++)
    screen (s->d, s->l, &g_array_index (s->hypotheses, ClothGapHypothesis, i));
}

/* What @sets become by one more effect, the likeliest first. */
static GArray *
grow (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    const GArray * sets)
{
  g_autoptr (ClothPool) pool = cloth_pool_new (d->options->threads);
  g_autoptr (GArray) all = cloth_gap_hypotheses_new ();
  GArray *grown = cloth_gap_hypotheses_new ();
  Screening screening = { d, l, all };

  for (guint i = 0; i < sets->len; i++) {
    const ClothGapHypothesis *set = &g_array_index (sets, ClothGapHypothesis,
        i);

    for (guint one = 0; one < d->candidates->list->len; one++) {
      ClothGapHypothesis h;

      if (!cloth_gap_hypothesis_has (set, one)
          && add_one (d, l->stack, set, one, &h)
          && !cloth_gap_hypotheses_find (all, &h))
        g_array_append_val (all, h);
    }
  }
  cloth_pool_run_one_by_one (pool, screen_some, &screening, all->len);
  for (guint i = 0; i < all->len; i++)
    if (g_array_index (all, ClothGapHypothesis, i).is_compared)
      g_array_append_vals (grown, &g_array_index (all, ClothGapHypothesis, i),
          1);
  g_array_sort (grown, compare_by_residual);
  return grown;
}

static void
append_best (GArray * hypotheses, const GArray * from, guint most)
{
  for (guint i = 0; i < MIN (most, from->len); i++)
    if (!cloth_gap_hypotheses_find (hypotheses, &g_array_index (from,
                ClothGapHypothesis, i)))
      g_array_append_vals (hypotheses, &g_array_index (from, ClothGapHypothesis,
              i), 1);
}

static gboolean
contains (const ClothGapHypothesis * h, const ClothGapHypothesis * part)
{
  for (guint c = 0; c < part->n; c++)
    if (!cloth_gap_hypothesis_has (h, part->candidates[c]))
      return FALSE;
  return TRUE;
}

/* All hypotheses of a linearisation: those that contain the base, were compared before and are not
 * hopeless, and the likeliest of those that the base grows to. How the base compares with others was
 * found where nothing was taken to act, and stands: at the base the reference says less, and so
 * does what it is compared with. */
static void
list_hypotheses (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    GArray * hypotheses)
{
  g_autoptr (GArray) base = cloth_gap_hypotheses_new ();
  ClothGapHypothesis none, start;
  const guint most[] = { G_MAXUINT, N_PAIRS, N_TRIPLES };

  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        i);

    h->is_compared = contains (h, l->base) && (h->by_residual <= HOPELESS
        || cloth_gap_hypothesis_is_same (h, l->base));
    h->is_settled = !h->is_compared || h->n_winds;
    if (!h->is_compared)
      continue;
    /* other derivatives: it begins where it was, and must be simulated anew */
    if (h->z)
      memcpy (h->next, h->at, sizeof h->next);
    cloth_gap_hypothesis_clear (h);
    h->objective = -INFINITY;
  }
  cloth_gap_hypothesis_init (&none, d->candidates, l->stack, NULL, 0);
  none.is_compared = l->base->n == 0;
  if (!cloth_gap_hypotheses_find (hypotheses, &none))
    g_array_append_val (hypotheses, none);
  cloth_gap_hypothesis_init (&start, d->candidates, l->stack,
      l->base->candidates, l->base->n);
  g_array_append_val (base, start);
  for (guint size = 0; size < CLOTH_GAP_MAX_EFFECTS - l->base->n; size++) {
    GArray *grown = grow (d, l, base);

    append_best (hypotheses, grown, most[size]);
    /* larger sets grow from the best */
    if (grown->len > most[size])
      g_array_set_size (grown, most[size]);
    g_array_unref (base);
    base = grown;
  }
}

/* Residuals of models on all takes, [n][size]. */
static gboolean
simulate_all (ClothDiagnosis * d, ClothModel ** models, guint n, gsize size,
    gdouble * z, gboolean * sound, GError ** error)
{
  g_autofree gdouble **to = g_new (gdouble *, n + 1);
  g_autofree gboolean *here = g_new (gboolean, n + 1);
  gsize begin = 0;

  for (guint i = 0; i < n; i++)
    sound[i] = TRUE;
  for (guint t = 0; t < d->n_takes && n; t++) {
    const ClothSensitivities *study = cloth_diagnosis_study (d, t);

    for (guint i = 0; i < n; i++)
      to[i] = z + i * size + begin;
    if (!cloth_sensitivities_run (study, models, n, &d->study, to, here, error))
      return FALSE;
    for (guint i = 0; i < n; i++)
      sound[i] = sound[i] && here[i];
    begin += study->features->size;
  }
  return TRUE;
}

/* @d: a diagnosis
 * @hypothesis: an explanation
 * @z: (inout) (array): the residual with it, of all takes; start with zeros
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * Returns: whether it could be simulated
 */
gboolean
cloth_gap_hypothesis_simulate (ClothDiagnosis * d,
    const ClothGapHypothesis * hypothesis, gdouble * z, GError ** error)
{
  g_autoptr (ClothModel) model =
      cloth_gap_hypothesis_make_model (d, hypothesis);
  gboolean sound;

  return simulate_all (d, &model, 1, 0, z, &sound, error);
}

/* Log likelihood of a residual, nuisances integrated out, and log prior. */
static gdouble
objective_at (const ClothGapLinearisation * l, const ClothGapHypothesis * h,
    const gdouble * at, const gdouble * z)
{
  g_autoptr (ClothGapGram) gram = cloth_gap_gram_new (l->likelihood, z, NULL,
      0);
  ClothGapEvidence evidence;

  if (!cloth_gap_gram_find_evidence (gram, NULL, NULL, NULL, 0, &evidence))
    return -INFINITY;
  return evidence.log_evidence + cloth_gap_log_prior (h->priors, at,
      h->n_directions);
}

/* Broyden: the derivatives change as little as makes them true to what was simulated. */
static void
update_derivatives (ClothGapHypothesis * h, gsize size, const gdouble * to,
    const gdouble * z)
{
  g_autofree gdouble *off = g_new (gdouble, size);
  gdouble square = 0.;

  for (gsize i = 0; i < size; i++)
    off[i] = z[i] - h->z[i];
  for (guint k = 0; k < h->n_directions; k++) {
    const gdouble step = to[k] - h->at[k];

    square += pow (step / h->priors[k].prior, 2.);
    for (gsize i = 0; i < size; i++)
      off[i] -= h->derivatives[k * size + i] * step;
  }
  for (guint k = 0; k < h->n_directions && square > 0.; k++)
    for (gsize i = 0; i < size; i++)
      h->derivatives[k * size + i] += off[i] * (to[k] - h->at[k]) /
          (h->priors[k].prior * h->priors[k].prior * square);
}

static const guint all_directions[CLOTH_GAP_MAX_DIRECTIONS] = {
  0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17
};

/* What follows from the simulation at a hypothesis, and where it is simulated next. */
static void
look_ahead (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    ClothGapHypothesis * h)
{
  g_autoptr (ClothGapGram) gram = cloth_gap_gram_new (l->likelihood, h->z,
      h->derivatives, h->n_directions);
  gdouble farthest = 0.;

  if (!cloth_gap_gram_find_evidence (gram, all_directions, h->at, h->priors,
          h->n_directions, &h->evidence)) {
    h->evidence.log_evidence = -INFINITY;
    h->is_settled = TRUE;
    return;
  }
  memcpy (h->next, h->evidence.values, sizeof h->next);
  keep_in_range (d, h);
  for (guint k = 0; k < h->n_directions; k++)
    farthest = MAX (farthest, fabs (h->next[k] - h->at[k]) /
        h->priors[k].prior);
  h->is_settled = farthest < ARRIVED;
  /* evidence is of what was simulated, unless it has arrived */
  if (!h->is_settled)
    h->evidence.log_evidence = h->objective + h->evidence.log_volume;
}

/* Derivatives of the linearisation, of directions from @from on. */
static void
put_derivatives (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    ClothGapHypothesis * h, guint from)
{
  const gsize size = l->stack->size;

  for (guint k = from; k < h->n_directions; k++)
    memcpy (h->derivatives + k * size, l->stack->columns +
        (h->directions[k] - d->candidates->n_free) * size,
        size * sizeof (gdouble));
}

/* Takes a simulation at the next place in: it becomes the place if it is better, else the next one
 * is half as far. */
static void
take_step (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    ClothGapHypothesis * h, const gdouble * z, gboolean sound)
{
  const gsize size = l->stack->size;
  const gdouble objective = sound ? objective_at (l, h, h->next, z) : -INFINITY;
  gboolean is_better;

  if (!h->z) {
    if (!sound) {
      /* it may be sound nearer to its null */
      for (guint k = 0; k < h->n_directions; k++)
        h->next[k] *= 0.5;
      keep_in_range (d, h);
      h->is_settled = !h->n_directions;
      return;
    }
    h->z = g_memdup2 (z, size * sizeof *z);
    h->derivatives = g_new (gdouble, h->n_directions * size + 1);
    put_derivatives (d, l, h, 0);
    memcpy (h->at, h->next, sizeof h->at);
    h->objective = objective;
    look_ahead (d, l, h);
    return;
  }
  if (sound)
    update_derivatives (h, size, h->next, z);
  is_better = objective > h->objective;
  if (is_better) {
    memcpy (h->z, z, size * sizeof *z);
    memcpy (h->at, h->next, sizeof h->at);
    h->objective = objective;
    look_ahead (d, l, h);
    return;
  }
  for (guint k = 0; k < h->n_directions; k++)
    h->next[k] = 0.5 * (h->at[k] + h->next[k]);
}

/* One simulation of each that has not arrived. */
static gboolean
step_all (ClothDiagnosis * d, const ClothGapLinearisation * l,
    GArray * hypotheses, guint * n_left, GError ** error)
{
  const gsize size = l->stack->size;
  g_autoptr (GPtrArray) models =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_model_free);
  g_autofree gdouble *z = NULL;
  g_autofree gboolean *sound = g_new (gboolean, hypotheses->len + 1);
  guint at = 0;

  for (guint i = 0; i < hypotheses->len; i++) {
    const ClothGapHypothesis *h = &g_array_index (hypotheses,
        ClothGapHypothesis, i);

    if (!h->is_settled)
      g_ptr_array_add (models, make_model_at (d, h, h->next));
  }
  *n_left = models->len;
  z = g_new0 (gdouble, models->len * size + 1);
  if (!simulate_all (d, (ClothModel **) models->pdata, models->len, size, z,
          sound, error))
    return FALSE;
  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        i);

    if (h->is_settled)
      continue;
    take_step (d, l, h, z + at * size, sound[at]);
    at++;
  }
  return TRUE;
}

/* What is hopeless where it has come to is simulated no further. */
static void
give_up (const ClothDiagnosis * d, GArray * hypotheses)
{
  gdouble best = INFINITY;

  for (guint pass = 0; pass < 2; pass++)
    for (guint i = 0; i < hypotheses->len; i++) {
      ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
          i);

      if (!h->z || !h->is_compared)
        continue;
      if (pass == 0)
        best = MIN (best, find_behind (d, h));
      else if (find_behind (d, h) > best + HOPELESS)
        h->is_settled = TRUE;
    }
}

/* Whether it is a single effect of one number, but for those that shape it. */
static gboolean
has_one_number (const ClothDiagnosis * d, const ClothGapHypothesis * h)
{
  guint n = 0;

  if (h->n != 1 || h->n_winds)
    return FALSE;
  for (guint k = 0; k < h->n_directions; k++) {
    const ClothDirection *direction =
        cloth_candidates_direction (d->candidates, h->directions[k]);

    if (direction->present)
      return FALSE;
    n += !direction->shapes;
  }
  return n == 1;
}

/* Single effects of one number begin at the best of some places along it. */
static gboolean
probe (ClothDiagnosis * d, const ClothGapLinearisation * l,
    GArray * hypotheses, GError ** error)
{
  const gsize size = l->stack->size;
  g_autoptr (GPtrArray) models =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_model_free);
  g_autoptr (GArray) owners = g_array_new (FALSE, FALSE, sizeof (guint));
  g_autoptr (GArray) places = g_array_new (FALSE, FALSE, sizeof (gdouble));
  g_autofree gdouble *z = NULL;
  g_autofree gboolean *sound = NULL;

  for (guint i = 0; i < hypotheses->len; i++) {
    const ClothGapHypothesis *h = &g_array_index (hypotheses,
        ClothGapHypothesis, i);
    const ClothDirection *direction;
    gdouble places_of[CLOTH_GAP_MAX_DIRECTIONS] = { 0. };

    if (!has_one_number (d, h))
      continue;
    direction = cloth_candidates_direction (d->candidates, h->directions[0]);
    for (guint p = 0; p < G_N_ELEMENTS (probes); p++) {
      const gdouble at = probes[p] * direction->prior;

      if (direction->centre + at < direction->low
          || direction->centre + at > direction->high
          || (direction->one_sided && at < 0.))
        continue;
      places_of[0] = at;
      g_ptr_array_add (models, make_model_at (d, h, places_of));
      g_array_append_val (owners, i);
      g_array_append_val (places, at);
    }
  }
  z = g_new0 (gdouble, models->len * size + 1);
  sound = g_new (gboolean, models->len + 1);
  if (!simulate_all (d, (ClothModel **) models->pdata, models->len, size, z,
          sound, error))
    return FALSE;
  for (guint p = 0; p < models->len; p++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        g_array_index (owners, guint, p));
    const gdouble at[CLOTH_GAP_MAX_DIRECTIONS] = {
      g_array_index (places, gdouble, p)
    };
    gdouble objective;

    if (!sound[p])
      continue;
    objective = objective_at (l, h, at, z + p * size);
    if (!(objective > h->objective))
      continue;
    if (!h->z) {
      h->z = g_new (gdouble, size);
      h->derivatives = g_new0 (gdouble, h->n_directions * size);
    }
    /* from here on the way back to the null is known */
    memcpy (h->z, z + p * size, size * sizeof *z);
    for (gsize i = 0; i < size; i++)
      h->derivatives[i] = (h->z[i] - l->stack->z[i]) / at[0];
    h->at[0] = at[0];
    h->objective = objective;
  }
  return TRUE;
}

/* Gusts beside what was simulated: their winds by the derivatives there. */
static void
blow (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    GArray * hypotheses, ClothGapHypothesis * h)
{
  const gsize size = l->stack->size;
  const guint n_simulated = h->n_directions - h->n_winds;
  guint list[CLOTH_GAP_MAX_EFFECTS], n_list = 0;
  const ClothGapHypothesis *other;
  g_autoptr (ClothGapGram) gram = NULL;
  ClothGapHypothesis without;

  for (guint c = 0; c < h->n; c++)
    if (!cloth_candidate_is_stochastic (candidate_of (d, h->candidates[c])))
      list[n_list++] = h->candidates[c];
  cloth_gap_hypothesis_init (&without, d->candidates, l->stack, list, n_list);
  other = cloth_gap_hypotheses_find (hypotheses, &without);
  if (!other || !other->z)
    return;
  h->z = g_memdup2 (other->z, size * sizeof *h->z);
  h->derivatives = g_new (gdouble, h->n_directions * size);
  memcpy (h->derivatives, other->derivatives,
      n_simulated * size * sizeof *h->z);
  memcpy (h->at, other->at, sizeof h->at);
  for (guint k = n_simulated; k < h->n_directions; k++)
    h->at[k] = 0.;
  put_derivatives (d, l, h, n_simulated);
  gram = cloth_gap_gram_new (l->likelihood, h->z, h->derivatives,
      h->n_directions);
  if (find_gust_evidence (gram, all_directions, h->at, h))
    h->objective = h->evidence.log_evidence - h->evidence.log_volume;
  else
    cloth_gap_hypothesis_clear (h);
}

/* How far a candidate of an explanation is from its null by the explanation's own posterior: the numbers that
 * are 0 there (not those that only shape it), how many they are, their square in units of their covariance,
 * and the logarithm of the density of their priors over that of the posterior where each is largest. FALSE
 * where there is no such null. */
static gboolean
find_nested (const ClothDiagnosis * d, const ClothGapHypothesis * h, guint c,
    guint * n_numbers, gdouble * square, gdouble * volume)
{
  gdouble sigma[CLOTH_GAP_MAX_DIRECTIONS * CLOTH_GAP_MAX_DIRECTIONS];
  gdouble off[CLOTH_GAP_MAX_DIRECTIONS], way[CLOTH_GAP_MAX_DIRECTIONS];
  guint list[CLOTH_GAP_MAX_DIRECTIONS], n = 0, first = 0;

  for (guint i = 0; i < c; i++)
    first += candidate_of (d, h->candidates[i])->n;
  for (guint k = 0; k < candidate_of (d, h->candidates[c])->n; k++) {
    const ClothDirection *direction =
        cloth_candidates_direction (d->candidates, h->directions[first + k]);

    if (direction->present)
      return FALSE;
    if (!direction->shapes)
      list[n++] = first + k;
  }
  *volume = 0.;
  for (guint i = 0; i < n; i++) {
    off[i] = way[i] = h->evidence.modes[list[i]];
    *volume -= log (h->priors[list[i]].prior);
    for (guint k = 0; k < n; k++)
      sigma[i * n + k] = h->evidence.covariance[list[i] * h->n_directions +
          list[k]];
    /* both densities are of the half that is not negative */
    if (h->priors[list[i]].one_sided)
      *volume += G_LN2 + cloth_gap_log_normal_cdf (off[i] / sqrt (sigma[i * n +
                  i]));
  }
  if (!n || !cloth_cholesky_factor (n, sigma))
    return FALSE;
  cloth_cholesky_solve (n, sigma, way);
  *square = 0.;
  for (guint i = 0; i < n; i++) {
    *volume += log (sigma[i * n + i]);
    *square += off[i] * way[i];
  }
  *n_numbers = n;
  return TRUE;
}

/* Logarithm of the Bayes factor for candidate @c of an explanation by its own posterior: the prior density
 * at the candidate's null over the posterior one there (Dickey 1971). Two simulations never differ by
 * what an effect does only; this one is of one simulation. Infinite where it has no such null. */
static gdouble
find_nested_evidence (const ClothDiagnosis * d, const ClothGapHypothesis * h,
    guint c)
{
  gdouble square, volume;
  guint n;

  return find_nested (d, h, c, &n, &square, &volume) ? volume + 0.5 * square :
      INFINITY;
}

/* @d: a diagnosis
 * @hypothesis: an explanation that was simulated
 * @candidate: one that is part of it
 *
 * Returns: how often the candidate would be found as far from its null if it didn't act (Wald's test), at
 *   most, as the likelihood is coarsened; NaN where it has no null or was not tested
 */
gdouble
cloth_gap_hypothesis_find_p_value (const ClothDiagnosis * d,
    const ClothGapHypothesis * hypothesis, guint candidate)
{
  const ClothGapHypothesis *h = hypothesis;
  gdouble square, volume;
  guint n;

  for (guint c = 0; c < h->n; c++)
    if (h->candidates[c] == candidate && h->z && !h->n_winds
        && find_nested (d, h, c, &n, &square, &volume))
      return cloth_chi_square_tail (square, n);
  return NAN;
}

/* @hypotheses: (element-type ClothGapHypothesis): all that were compared
 * @h: one of them
 * @c: which of its candidates
 *
 * Returns: the probability of @h without that candidate, with nothing in its place, against @h; 0 where that
 *   was not among the likeliest, which are compared
 */
gdouble
cloth_gap_hypotheses_find_without (const GArray * hypotheses,
    const ClothGapHypothesis * h, guint c)
{
  const ClothGapHypothesis *part = find_part (hypotheses, h, c);

  return part ? 1. / (1. + exp (part->behind - h->behind)) : 0.;
}

/* What a candidate of an explanation adds to its other part. Gusts are not simulated: with them and without
 * it is one simulation. */
static gdouble
find_added_evidence (const ClothDiagnosis * d, const ClothGapHypothesis * h,
    guint c, const ClothGapHypothesis * part)
{
  if (cloth_candidate_is_stochastic (candidate_of (d, h->candidates[c])))
    return part->is_compared && part->z
        && isfinite (part->evidence.log_evidence) ?
        h->evidence.log_evidence - part->evidence.log_evidence : INFINITY;
  return h->n_winds ? INFINITY : find_nested_evidence (d, h, c);
}

/* No effect adds more to an explanation than its own posterior says: what more there is, chance made, as
 * the explanation was simulated at several places and the best was kept. What the base adds was found where
 * nothing was taken to act, and stands. */
static void
bound_by_parts (const ClothDiagnosis * d, const ClothGapHypothesis * base,
    GArray * hypotheses)
{
  for (guint size = 1; size <= CLOTH_GAP_MAX_EFFECTS; size++)
    for (guint i = 0; i < hypotheses->len; i++) {
      ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
          i);

      if (h->n != size || !h->is_compared || !h->z)
        continue;
      for (guint c = 0; c < h->n; c++) {
        const ClothGapHypothesis one = {.n = 1,.candidates = {h->candidates[c]}
        };
        const ClothGapHypothesis *part;

        if (cloth_gap_hypothesis_has (base, h->candidates[c]))
          continue;
        part = find_part (hypotheses, h, c);
        if (part && isfinite (part->by_residual))
          h->by_residual = MAX (h->by_residual, part->by_residual -
              find_added_evidence (d, h, c, part) - log_odds (d, &one));
      }
    }
}

/* Less the posterior in this linearisation of what was simulated in an earlier one; infinite where nothing was. */
static gdouble
find_behind_here (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    const ClothGapHypothesis * h)
{
  g_autoptr (ClothGapGram) gram = NULL;
  ClothGapHypothesis here = *h;

  if (!h->z || h->n_winds)
    return INFINITY;
  gram = cloth_gap_gram_new (l->likelihood, h->z, h->derivatives,
      h->n_directions);
  if (!cloth_gap_gram_find_evidence (gram, all_directions, h->at, h->priors,
          h->n_directions, &here.evidence))
    return INFINITY;
  here.evidence.log_evidence = objective_at (l, h, h->at, h->z) +
      here.evidence.log_volume;
  return find_behind (d, &here);
}

/* What explains the same as an effect of the base makes that effect superfluous: a set without it is as likely as the
 * set with it, but for what the effect adds there. That is as much less than what it was found to add to the base as
 * the posteriors of both sets, of this linearisation, say; and no more likely than its own simulation is here. */
static void
raise_parts (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    GArray * hypotheses)
{
  const ClothGapHypothesis *now =
      cloth_gap_hypotheses_find (hypotheses, l->base);

  if (!now || !now->is_compared || !now->z)
    return;
  for (guint b = 0; b < now->n; b++) {
    const ClothGapHypothesis *rest = find_part (hypotheses, now, b);
    const gdouble own = find_nested_evidence (d, now, b);

    for (guint i = 0; rest && i < hypotheses->len; i++) {
      const ClothGapHypothesis *h = &g_array_index (hypotheses,
          ClothGapHypothesis, i);
      ClothGapHypothesis *part;
      gdouble behind;
      guint c = 0;

      /* one in place of one: several together explain much */
      if (h->n != now->n + 1 || !h->is_compared || !h->z || h->n_winds)
        continue;
      while (h->candidates[c] != now->candidates[b])
        c++;
      part = find_part (hypotheses, h, c);
      if (!part)
        continue;
      behind = h->by_residual + rest->by_residual - now->by_residual +
          find_nested_evidence (d, h, c) - own;
      if (isfinite (behind) && behind < part->by_residual)
        part->by_residual = MIN (part->by_residual, MAX (behind,
                find_behind_here (d, l, part)));
    }
  }
}

/* How much less likely than the likeliest each is; those that could not be simulated are out. Of
 * those that are not compared in this round it is what it was before, held against the base. */
static void
rank (const ClothDiagnosis * d, const ClothGapLinearisation * l,
    GArray * hypotheses)
{
  gdouble before = 0., after = 0., best = INFINITY;

  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        i);
    const gboolean is_base = cloth_gap_hypothesis_is_same (h, l->base);

    if (is_base && isfinite (h->by_residual))
      before = h->by_residual;
    if (h->is_compared)
      h->by_residual = h->z ? find_behind (d, h) : INFINITY;
    if (is_base)
      after = h->by_residual;
  }
  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        i);

    if (!h->is_compared && isfinite (after))
      h->by_residual += after - before;
  }
  bound_by_parts (d, l->base, hypotheses);
  raise_parts (d, l, hypotheses);
  for (guint i = 0; i < hypotheses->len; i++)
    best = MIN (best, g_array_index (hypotheses, ClothGapHypothesis,
            i).by_residual);
  for (guint i = 0; i < hypotheses->len; i++)
    g_array_index (hypotheses, ClothGapHypothesis, i).by_residual -= best;
}

/* @d: a diagnosis
 * @linearisation: where nothing is taken to act
 * @best: (out caller-allocates): evidence of the likeliest set of at most two effects, by the
 *   derivatives only
 *
 * Returns: whether there is any
 */
gboolean
cloth_gap_hypotheses_screen (const ClothDiagnosis * d,
    const ClothGapLinearisation * linearisation, ClothGapEvidence * best)
{
  g_autoptr (GArray) sets = cloth_gap_hypotheses_new ();
  gdouble behind = INFINITY;

  g_array_append_vals (sets, linearisation->base, 1);
  for (guint size = 0; size < 2; size++) {
    GArray *grown = grow (d, linearisation, sets);

    g_array_unref (sets);
    sets = grown;
    if (sets->len && g_array_index (sets, ClothGapHypothesis,
            0).by_residual < behind) {
      behind = g_array_index (sets, ClothGapHypothesis, 0).by_residual;
      *best = g_array_index (sets, ClothGapHypothesis, 0).evidence;
    }
    if (sets->len > N_PAIRS)
      g_array_set_size (sets, N_PAIRS);
  }
  return isfinite (behind);
}

/* @d: a diagnosis
 * @linearisation: where hypotheses are compared
 * @hypotheses: (inout) (element-type ClothGapHypothesis): those that were compared before; then all
 *   that were
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * Returns: whether they could be simulated
 */
gboolean
cloth_gap_hypotheses_compare (ClothDiagnosis * d,
    const ClothGapLinearisation * linearisation, GArray * hypotheses,
    GError ** error)
{
  const ClothGapLinearisation *l = linearisation;
  guint left = 1;

  list_hypotheses (d, l, hypotheses);
  if (l->is_first && !probe (d, l, hypotheses, error))
    return FALSE;
  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        i);
    gdouble screened[CLOTH_GAP_MAX_DIRECTIONS];

    if (!h->z || !h->is_compared)
      continue;
    /* the screening's place is tried before the probes are followed */
    memcpy (screened, h->next, sizeof screened);
    look_ahead (d, l, h);
    h->is_settled = FALSE;
    memcpy (h->next, screened, sizeof screened);
  }
  for (guint step = 0; step <= N_STEPS && left; step++) {
    if (!step_all (d, l, hypotheses, &left, error))
      return FALSE;
    if (step)
      give_up (d, hypotheses);
  }
  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        i);

    if (h->is_compared && h->n_winds)
      blow (d, l, hypotheses, h);
  }
  rank (d, l, hypotheses);
  return TRUE;
}
