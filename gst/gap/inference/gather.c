/* From simulations to arrays: the residuals of takes, their derivatives, the ensemble, references.
 *
 * A take's reference is its twin, else that baseline whose clamps move most as its own do. Features of
 * the two belong together that have the same place in their recordings: the same block of time, the
 * same frequency, wave and axis. How much the one says of the other the ensemble finds out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/gather.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/gap/inference/clamps.h"

/* Directions of wind along the ground, and parts of all takes in which it may differ. */
#define WAYS 2
#define N_PARTS 8

static guint
find_reference (const ClothDiagnosis * d, guint take)
{
  const guint end = d->n_takes + d->options->n_baselines;
  gdouble nearest = INFINITY;
  guint best = G_MAXUINT;

  if (cloth_diagnosis_twin (d, take))
    return end + take;
  for (guint i = d->n_takes; i < end; i++) {
    const gdouble distance = cloth_gap_find_clamps_distance
        (cloth_diagnosis_recording (d, take), cloth_diagnosis_recording (d, i));

    if (distance < nearest) {
      nearest = distance;
      best = i;
    }
  }
  return best;
}

/* What a take's reference has of the noise that its recording is said to have: a twin's σ is that of the
 * recorded less the simulated, and only the simulator's own is in its places. */
static gdouble
find_noise (const ClothDiagnosis * d, guint take)
{
  const ClothRecording *twin = cloth_diagnosis_twin (d, take);
  const gdouble sigma = cloth_diagnosis_recording (d, take)->sigma;

  return twin ? sqrt (fmax (1. - pow (sigma / twin->sigma, 2.), 0.)) : 1.;
}

/* @d: a diagnosis whose model is fitted
 * @gathered: (out caller-allocates): what it must agree with
 * @error: #ClothSimError or #ClothFitError
 *
 * Finds the residual of each reference and its derivatives by the free numbers, and what it would be
 * of each member of the ensemble.
 *
 * Returns: whether they could be simulated
 */
gboolean
cloth_gap_gather_references (ClothDiagnosis * d, ClothGapGathered * gathered,
    GError ** error)
{
  ClothEnsemble *ensemble = gathered->ensemble =
      cloth_ensemble_new (d->model, cloth_diagnosis_recording (d,
          0)->scene->topology, d->candidates, d->options->seed);
  g_autofree gboolean *sound = g_new (gboolean, ensemble->n);

  gathered->references = g_new (guint, d->n_takes);
  gathered->on_references = g_new0 (gdouble *, d->n_takes);
  gathered->sound = g_new (gboolean, ensemble->n);
  for (guint m = 0; m < ensemble->n; m++)
    gathered->sound[m] = TRUE;
  for (guint t = 0; t < d->n_takes; t++) {
    ClothSensitivities *study;
    guint same = 0;

    gathered->references[t] = find_reference (d, t);
    if (gathered->references[t] == G_MAXUINT)
      continue;
    study = cloth_diagnosis_study (d, gathered->references[t]);
    while (gathered->references[same] != gathered->references[t])
      same++;
    gathered->on_references[t] = same < t ?
        g_memdup2 (gathered->on_references[same], ensemble->n *
        study->features->size * sizeof (gdouble)) : g_new0 (gdouble,
        ensemble->n * study->features->size);
    if (same < t)
      continue;
    if (!cloth_sensitivities_linearise (study, d->candidates, d->model, d->all,
            d->candidates->n_free, &d->study, error)
        || !cloth_ensemble_run (ensemble, study, d->model, find_noise (d, t),
            gathered->references[t], &d->study, gathered->on_references[t],
            sound, error))
      return FALSE;
    for (guint m = 0; m < ensemble->n; m++)
      gathered->sound[m] = gathered->sound[m] && sound[m];
  }
  return TRUE;
}

/* @gathered: what was gathered
 * @n_takes: how many takes there are
 */
void
cloth_gap_gathered_clear (ClothGapGathered * gathered, guint n_takes)
{
  for (guint t = 0; gathered->on_references && t < n_takes; t++)
    g_free (gathered->on_references[t]);
  g_free (gathered->on_references);
  g_free (gathered->references);
  g_free (gathered->sound);
  cloth_ensemble_free (gathered->ensemble);
}

/* @made: what was made; is empty then
 */
void
cloth_gap_made_clear (ClothGapMade * made)
{
  g_clear_pointer (&made->model, cloth_model_free);
  g_clear_pointer (&made->made, g_ptr_array_unref);
  g_clear_pointer (&made->sound, g_free);
}

/* @stack: (nullable) (transfer full): features
 */
void
cloth_gap_stack_free (ClothGapStack * stack)
{
  if (!stack)
    return;
  g_free (stack->classes);
  g_free (stack->bands);
  g_free (stack->z);
  g_free (stack->free);
  g_free (stack->columns);
  g_free (stack->priors);
  g_free (stack->precisions);
  g_free (stack->families);
  g_free (stack->members);
  g_free (stack->reference);
  g_free (stack->reference_free);
  g_free (stack->reference_members);
  g_free (stack);
}

static gboolean
has_references (const ClothDiagnosis * d, const ClothGapGathered * gathered)
{
  for (guint t = 0; t < d->n_takes; t++)
    if (gathered->references[t] != G_MAXUINT)
      return TRUE;
  return FALSE;
}

/* Gusts, if they are looked for and all takes could be simulated in wind, else NULL. */
static const ClothCandidate *
find_gusts (const ClothDiagnosis * d)
{
  for (guint i = 0; i < d->candidates->list->len; i++) {
    const ClothCandidate *c = &g_array_index (d->candidates->list,
        ClothCandidate, i);
    gboolean sound = TRUE;

    if (!cloth_candidate_is_stochastic (c))
      continue;
    for (guint t = 0; t < d->n_takes; t++)
      for (guint k = 0; k < WAYS; k++)
        sound = sound && cloth_diagnosis_study (d, t)->sound[c->first + k];
    return sound ? c : NULL;
  }
  return NULL;
}

/* Winds of parts of the takes: the derivative by wind, in some time only. Many blocks share a part, few
 * have several. */
static void
put_winds (const ClothDiagnosis * d, const ClothCandidate * gusts,
    guint n_blocks, ClothGapStack * s)
{
  const guint n_parts = s->n_winds / WAYS, each = MAX (n_parts / n_blocks, 1);
  guint block = 0;
  gsize begin = 0;

  for (guint t = 0; t < d->n_takes; t++) {
    const ClothSensitivities *study = cloth_diagnosis_study (d, t);
    const ClothFeatures *f = study->features;
    const gsize size = f->size / f->n_blocks;
    g_autofree gdouble *windowed = g_new (gdouble, f->size);

    for (guint k = 0; k < WAYS; k++)
      for (guint i = 0; i < each; i++) {
        cloth_features_window (f, study->columns + (gusts->first +
                k) * f->size, i, each, windowed);
        for (guint b = 0; b < f->n_blocks; b++) {
          const guint part = each > 1 ? each * (block + b) + i :
              (block + b) * n_parts / n_blocks;

          memcpy (s->columns + (s->n - s->n_winds + WAYS * part +
                  k) * s->size + begin + b * size, windowed + b * size,
              size * sizeof (gdouble));
        }
      }
    block += f->n_blocks;
    begin += f->size;
  }
}

static ClothGapStack *
empty_stack (const ClothDiagnosis * d, const ClothGapGathered * gathered,
    guint most_members)
{
  ClothGapStack *s = g_new0 (ClothGapStack, 1);
  const ClothCandidate *gusts = find_gusts (d);
  guint n_blocks = 0;

  for (guint t = 0; t < d->n_takes; t++) {
    s->size += cloth_diagnosis_study (d, t)->features->size;
    n_blocks += cloth_diagnosis_study (d, t)->features->n_blocks;
  }
  s->n_free = d->candidates->n_free;
  s->n_winds = !gusts ? 0 : n_blocks > N_PARTS ? WAYS * N_PARTS :
      WAYS * n_blocks * (N_PARTS / n_blocks);
  s->n = d->candidates->directions->len - s->n_free + s->n_winds;
  s->overdispersion = d->study.overdispersion;
  s->classes = g_new (guint, s->size);
  s->z = g_new (gdouble, s->size);
  s->free = g_new (gdouble, s->n_free * s->size + 1);
  s->columns = g_new0 (gdouble, s->n * s->size + 1);
  s->priors = g_new (gdouble, s->n + 1);
  s->precisions = g_new (gdouble, s->n_free + 1);
  s->families = g_new (guint, most_members);
  s->members = g_new (gdouble, most_members * s->size);
  for (guint k = 0; k < s->n_free; k++) {
    const gdouble prior = cloth_candidates_direction (d->candidates, k)->prior;

    s->precisions[k] = 1. / (prior * prior);
  }
  for (guint k = 0; k < s->n; k++)
    s->priors[k] = k < s->n - s->n_winds ?
        cloth_candidates_direction (d->candidates, s->n_free + k)->prior :
        gusts->effect->parameters[0].prior;
  if (has_references (d, gathered)) {
    s->reference = g_new0 (gdouble, s->size);
    s->reference_free = g_new0 (gdouble, s->n_free * s->size + 1);
    s->reference_members = g_new0 (gdouble, most_members * s->size);
  }
  return s;
}

/* Features of a reference at the places of a take's, in units of the take's noise; 0 where it has
 * none. */
static void
put_reference (const ClothFeatures * take, const ClothFeatures * reference,
    const gdouble * z, gdouble * to)
{
  const gdouble scale = reference->sigma / take->sigma;
  const gsize waves = 3 * (gsize) take->n_waves;

  for (guint b = 0; b < MIN (take->n_blocks, reference->n_blocks); b++)
    for (guint c = 0; c < MIN (take->n_cosines, reference->n_cosines); c++)
      for (gsize i = 0; i < waves; i++)
        to[((gsize) b * take->n_cosines + c) * waves + i] = scale *
            z[((gsize) b * reference->n_cosines + c) * waves + i];
}

/* A number that shapes an effect changes nothing while the model has not that effect: a difference of
 * two runs would be chance. */
static gboolean
does_something (const ClothDiagnosis * d, const ClothModel * model,
    guint direction)
{
  if (!cloth_candidates_direction (d->candidates, direction)->shapes)
    return TRUE;
  for (guint i = 0; i < d->candidates->list->len; i++) {
    const ClothCandidate *c = &g_array_index (d->candidates->list,
        ClothCandidate, i);

    if (direction < c->first || direction >= c->first + c->n)
      continue;
    for (guint k = 0; k < model->effects->len; k++)
      if (g_array_index (model->effects, ClothModelEffect, k).effect ==
          c->effect)
        return TRUE;
  }
  return FALSE;
}

/* What a take and its reference have in the stack, from feature @begin on. @members: which members
 * there are, @kin: those that the reference is taken for. */
static void
put_take (const ClothDiagnosis * d, const ClothGapGathered * gathered,
    const ClothModel * model, guint t, const gdouble * made,
    const guint * members, const guint * kin, ClothGapStack * s, gsize begin)
{
  const ClothSensitivities *study = cloth_diagnosis_study (d, t);
  const ClothSensitivities *reference = gathered->references[t] ==
      G_MAXUINT ? NULL : cloth_diagnosis_study (d, gathered->references[t]);
  const gsize size = study->features->size, row = size * sizeof (gdouble);
  g_autofree guint *classes = NULL;
  guint n_classes;

  classes = cloth_features_list_classes (study->features, &n_classes);
  for (gsize i = 0; i < size; i++)
    s->classes[begin + i] = s->n_classes + classes[i];
  s->bands = g_renew (guint, s->bands, s->n_classes + n_classes);
  for (gsize i = 0; i < size; i++)
    s->bands[s->n_classes + classes[i]] =
        study->features->bands[i / 3 % study->features->n_waves];
  s->n_classes += n_classes;
  memcpy (s->z + begin, study->z, row);
  for (guint k = 0; k < s->n_free; k++)
    memcpy (s->free + k * s->size + begin, study->columns + k * size, row);
  for (guint k = 0; k < s->n - s->n_winds; k++)
    if (does_something (d, model, s->n_free + k))
      memcpy (s->columns + k * s->size + begin,
          study->columns + (s->n_free + k) * size, row);
  for (guint m = 0; m < s->n_members; m++)
    memcpy (s->members + m * s->size + begin, made + members[m] * size, row);
  if (!reference)
    return;
  put_reference (study->features, reference->features, reference->z,
      s->reference + begin);
  for (guint k = 0; k < s->n_free; k++)
    put_reference (study->features, reference->features,
        reference->columns + k * reference->features->size,
        s->reference_free + k * s->size + begin);
  for (guint m = 0; m < s->n_members; m++)
    put_reference (study->features, reference->features,
        gathered->on_references[t] + kin[m] * reference->features->size,
        s->reference_members + m * s->size + begin);
}

/* @d: a diagnosis
 * @gathered: its references
 * @model: where the takes are linearised
 * @before: (nullable): what the ensemble made of them before: what simulators are off by if nothing acts
 *   does not change with where the takes are linearised; %NULL: it runs
 * @made: (out caller-allocates): what the ensemble makes of them
 * @error: #ClothSimError, or #ClothFitError when @model can't be simulated
 *
 * Returns: whether they could be simulated
 */
gboolean
cloth_gap_gather_takes (ClothDiagnosis * d, const ClothGapGathered * gathered,
    const ClothModel * model, const ClothGapMade * before,
    ClothGapMade * made, GError ** error)
{
  const ClothEnsemble *ensemble = gathered->ensemble;
  g_autofree gboolean *here = g_new (gboolean, ensemble->n);

  made->model = cloth_model_copy (model);
  if (before) {
    made->made = g_ptr_array_ref (before->made);
    made->sound = g_memdup2 (before->sound, ensemble->n * sizeof *made->sound);
    for (guint t = 0; t < d->n_takes; t++)
      if (!cloth_sensitivities_linearise (cloth_diagnosis_study (d, t),
              d->candidates, model, d->all, d->candidates->directions->len,
              &d->study, error))
        return FALSE;
    return TRUE;
  }
  made->made = g_ptr_array_new_with_free_func (g_free);
  made->sound = g_memdup2 (gathered->sound, ensemble->n * sizeof *made->sound);
  for (guint t = 0; t < d->n_takes; t++) {
    ClothSensitivities *study = cloth_diagnosis_study (d, t);
    gdouble *z = g_new0 (gdouble, ensemble->n * study->features->size);

    g_ptr_array_add (made->made, z);
    if (!cloth_sensitivities_linearise (study, d->candidates, model, d->all,
            d->candidates->directions->len, &d->study, error)
        || !cloth_ensemble_run (ensemble, study, model, 1., t, &d->study, z,
            here, error))
      return FALSE;
    for (guint m = 0; m < ensemble->n; m++)
      made->sound[m] = made->sound[m] && here[m];
  }
  return TRUE;
}

/* @d: a diagnosis whose takes were gathered last
 * @gathered: its references
 * @made: what the ensemble makes of the takes
 * @kin: how the references are related to the takes
 * @error: #ClothFitError when too few members can be simulated
 *
 * Returns: (transfer full) (nullable): all features
 */
ClothGapStack *
cloth_gap_stack_new (const ClothDiagnosis * d,
    const ClothGapGathered * gathered, const ClothGapMade * made,
    ClothEnsembleKin kin, GError ** error)
{
  const ClothEnsemble *e = gathered->ensemble;
  g_autoptr (ClothGapStack) s = empty_stack (d, gathered, e->n);
  g_autofree guint *members = g_new (guint, e->n);
  g_autofree guint *others = g_new (guint, e->n);
  gsize begin = 0;
  guint n_blocks = 0;

  for (guint m = 0; m < e->n; m++) {
    const guint other = cloth_ensemble_find_kin (e, m, kin);

    if (!made->sound[m] || !made->sound[other])
      continue;
    members[s->n_members] = m;
    others[s->n_members] = other;
    s->families[s->n_members++] = e->families[m];
  }
  if (s->n_members < CLOTH_ENSEMBLE_LEAST) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "%u of %u "
        "simulations that differ from the model in how they compute diverge; "
        "give the model softer cloth or more damping", e->n - s->n_members,
        e->n);
    return NULL;
  }
  for (guint t = 0; t < d->n_takes; t++) {
    put_take (d, gathered, made->model, t, g_ptr_array_index (made->made, t),
        members, others, s, begin);
    begin += cloth_diagnosis_study (d, t)->features->size;
  }
  for (guint t = 0; t < d->n_takes; t++)
    n_blocks += cloth_diagnosis_study (d, t)->features->n_blocks;
  if (s->n_winds)
    put_winds (d, find_gusts (d), n_blocks, s);
  return g_steal_pointer (&s);
}
