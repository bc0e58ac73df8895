/* Fits the numbers of the user's simulator that do what the accepted effects do, and then, if that
 * brings more, its base numbers.
 *
 * Model: ours, nudged to a recording y and to what the user's simulator makes of the scene with
 *   numbers x, is off by z_y and z_x. The residual is z_y − z_x: what the user's simulator lacks, as
 *   what ours can't do is in both.
 * Assumption: a number of the user's changes z_x as what it `is` of ours changes the motion of ours,
 *   in the units that the capabilities say: the derivatives of z_y − z_x are those of ours times
 *   these. Where they say none, a run with the number moved measures them.
 * Formula: broyden.c, with the variance that is left at the start of a stage, class by class of
 *   features, times the overdispersion as that of the residual. Numbers are counted in steps of a
 *   finite difference; that of an effect has a prior of so many, a base number fewer: it was
 *   accepted before. Every other block of time is fitted, the others choose: a stage counts when
 *   the square of their residual does not grow by it; for base numbers it must fall by a tenth. These are the numbers
 *   that do what a free number of the model does, or nothing of ours. They stay when the
 *   simulator lacks an accepted effect, of which they would take the place.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/loop/refit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/gap/load.h"
#include "gst/gap/report/words.h"
#include "gst/gap/simulator/mapping.h"
#include "gst/gap/simulator/simulator.h"

/* Base numbers must take so much off the square of the residual to be changed. */
#define LEAST_FALL 0.1
/* Standard deviations of priors, in steps: about that of an effect in a refit of ours, and of a
 * base number that of a factor of 1.4. */
#define EFFECT_PRIOR 5.
#define BASE_PRIOR 1.5
/* Longest step of a fit: a factor of 2.6. */
#define LONGEST 4.
/* Shortest step: a factor of 1.01, less than two runs of wrinkled cloth differ by. */
#define SHORTEST 0.05
/* Stages of the fit of effects; each weighs by what the one before left. */
#define N_EFFECT_STAGES 2
/* Fewer runs than this are no fit. */
#define LEAST_RUNS 2

/* A number of the simulator that is fitted. */
typedef struct
{
  const ClothSimulatorParameter *parameter;
  guint index;                  /* in the capabilities */
  gboolean is_base;
  gdouble guess;                /* where the diagnosis has it, in steps; NaN: not known */
  gdouble *column;              /* ∂(z_y − z_x) by a step of it; not weighted */
} Number;

typedef struct
{
  ClothDiagnosis *d;
  const ClothSimulatorCapabilities *capabilities;
  gdouble *values;              /* of all numbers of the simulator: the best so far */
  GArray *numbers;              /* Number */
  guint n;                      /* of them that are fitted at the moment */
  gsize size;                   /* features of all takes */
  gdouble *ours;                /* z_y */
  gdouble *z;                   /* z_y − z_x at the best values */
  gdouble *weights;             /* square roots, 0 in blocks that choose */
  gdouble *choosing;            /* the same, 0 in blocks that are fitted */
  gdouble *columns;             /* of ours, [targets][size] */
  ClothSimulatorTarget *targets;
  guint *directions;
  guint n_targets;
  GPtrArray *places;            /* of the stage that were run */
  gdouble *last;                /* values of the last run, and what it made of each take */
  GPtrArray *twins;
  guint left;                   /* runs that may be made */
  guint n_sound;                /* runs with other numbers that succeeded */
  GError *failed;               /* of the last one that did not */
} Refit;

static void
number_clear (gpointer item)
{
  g_free (((Number *) item)->column);
}

static void
refit_clear (Refit * r)
{
  g_free (r->values);
  g_clear_pointer (&r->numbers, g_array_unref);
  g_free (r->ours);
  g_free (r->z);
  g_free (r->weights);
  g_free (r->choosing);
  g_free (r->columns);
  g_free (r->targets);
  g_free (r->directions);
  g_free (r->last);
  g_clear_pointer (&r->places, g_ptr_array_unref);
  g_clear_pointer (&r->twins, g_ptr_array_unref);
  g_clear_error (&r->failed);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Refit, refit_clear);

static inline Number *
get_number (const Refit * r, guint i)
{
  return &g_array_index (r->numbers, Number, i);
}

/* ---- what of ours has derivatives ---- */

static void
add_target (Refit * r, guint direction)
{
  const ClothDiagnosis *d = r->d;
  const ClothDirection *o = cloth_candidates_direction (d->candidates,
      direction);
  ClothSimulatorTarget *target = &r->targets[r->n_targets];

  target->name = o->name;
  target->logarithmic = o->logarithmic;
  cloth_model_get (d->with, o->name, &target->value, NULL);
  r->directions[r->n_targets++] = direction;
}

/* The free numbers and what is accepted. */
static void
list_targets (Refit * r)
{
  const ClothDiagnosis *d = r->d;
  const guint most = d->candidates->directions->len;

  r->targets = g_new (ClothSimulatorTarget, most + 1);
  r->directions = g_new (guint, most + 1);
  for (guint i = 0; i < d->candidates->n_free; i++)
    add_target (r, i);
  for (guint c = 0; c < d->n_accepted; c++)
    for (guint k = 0; k < cloth_diagnosis_accepted (d, c)->n; k++)
      add_target (r, cloth_diagnosis_accepted (d, c)->first + k);
}

/* ---- residuals ---- */

/* Of what was simulated of take @i, into the features from @z on: z_y − z_x. */
static gboolean
find_residual (Refit * r, guint i, const ClothRecording * twin,
    const gdouble * ours, gdouble * z, GError ** error)
{
  ClothDiagnosis *d = r->d;
  g_autoptr (ClothSensitivities) study = cloth_sensitivities_new (twin,
      &d->study);
  const gdouble scale = study->features->sigma /
      cloth_diagnosis_study (d, i)->features->sigma;
  const gsize size = study->features->size;
  g_autofree gdouble *own = g_new0 (gdouble, size);
  ClothModel *models[] = { d->with };
  gboolean sound;

  cloth_diagnosis_begin_part (d, d->from, 1., 0.02, "running your simulator");
  if (!cloth_sensitivities_run (study, models, 1, &d->study, &own, &sound,
          error))
    return FALSE;
  if (!sound) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL,
        "our simulation can't follow it");
    return FALSE;
  }
  for (gsize k = 0; k < size; k++)
    z[k] = ours[k] - scale * own[k];
  return TRUE;
}

/* Ours at the recordings, with derivatives, and the simulator's own numbers. */
static gboolean
begin (Refit * r, GError ** error)
{
  ClothDiagnosis *d = r->d;
  gsize at = 0;

  for (guint i = 0; i < d->n_takes; i++)
    r->size += cloth_diagnosis_study (d, i)->features->size;
  r->ours = g_new (gdouble, r->size);
  r->z = g_new (gdouble, r->size);
  r->weights = g_new0 (gdouble, r->size);
  r->choosing = g_new0 (gdouble, r->size);
  r->columns = g_new (gdouble, r->n_targets * r->size + 1);
  for (guint i = 0; i < d->n_takes; i++) {
    g_autoptr (ClothSensitivities) study =
        cloth_sensitivities_new (cloth_diagnosis_recording (d, i), &d->study);
    const gsize size = study->features->size;

    cloth_diagnosis_begin_part (d, d->from, 1., 0.1, "running your simulator");
    if (!cloth_sensitivities_linearise (study, d->candidates,
            d->with, r->directions, r->n_targets, &d->study, error))
      return FALSE;
    memcpy (r->ours + at, study->z, size * sizeof (gdouble));
    for (guint k = 0; k < r->n_targets; k++)
      memcpy (r->columns + k * r->size + at, study->columns + k * size,
          size * sizeof (gdouble));
    if (!find_residual (r, i, cloth_diagnosis_twin (d, i), r->ours + at,
            r->z + at, error))
      return FALSE;
    at += size;
  }
  return TRUE;
}

/* By the variance that is left. A take of one block has nothing to choose by. */
static void
weigh (Refit * r)
{
  const ClothDiagnosis *d = r->d;
  gsize at = 0;

  for (guint i = 0; i < d->n_takes; i++) {
    const ClothFeatures *f = cloth_diagnosis_study (d, i)->features;
    const gsize block = f->size / f->n_blocks;
    g_autoptr (ClothPowerSpectrum) left = cloth_power_spectrum_new (f,
        r->z + at);
    g_autofree gdouble *weights = g_new (gdouble, block);

    cloth_power_spectrum_get_weights (left, f, weights);
    for (guint b = 0; b < f->n_blocks; b++)
      for (gsize k = 0; k < block; k++, at++) {
        gdouble weight = sqrt (weights[k] / d->study.overdispersion);

        r->weights[at] = b % 2 ? 0. : weight;
        r->choosing[at] = b % 2 ? weight : 0.;
      }
  }
}

/* In the blocks that choose. */
static gdouble
find_square (const Refit * r, const gdouble * z)
{
  gdouble sum = 0.;

  for (gsize k = 0; k < r->size; k++)
    sum += pow (r->choosing[k] * z[k], 2.);
  return sum;
}

/* ---- runs ---- */

/* "changing “drag” from 0 to 0.4 and …" */
static gchar *
describe_changes (const Refit * r, const gdouble * values)
{
  g_autoptr (GString) text = g_string_new ("changing");

  for (guint i = 0, n = 0; i < r->capabilities->parameters->len; i++) {
    const ClothSimulatorParameter *p =
        cloth_simulator_capabilities_get (r->capabilities, i);

    if (values[i] != r->last[i])
      g_string_append_printf (text, "%s “%s” from %g to %g", n++ ? "," : "",
          p->name, r->last[i], values[i]);
  }
  return g_string_free (g_steal_pointer (&text), FALSE);
}

/* Equal numbers make equal runs, and others others. */
static gboolean
check_changed (Refit * r, const gdouble * values, GPtrArray * twins,
    GError ** error)
{
  g_autofree gchar *changes = NULL;
  gboolean changed = memcmp (values, r->last,
      r->capabilities->parameters->len * sizeof *values) == 0;

  for (guint i = 0; i < twins->len && !changed; i++) {
    const ClothRecording *now = g_ptr_array_index (twins, i);
    const ClothRecording *before = r->twins->len ?
        g_ptr_array_index (r->twins, i) : cloth_diagnosis_twin (r->d, i);

    changed = memcmp (now->y, before->y, 3 * (gsize) now->n * now->n_frames *
        sizeof *now->y) != 0;
  }
  if (changed)
    return TRUE;
  changes = describe_changes (r, values);
  g_set_error (error, CLOTH_SIMULATOR_ERROR, CLOTH_SIMULATOR_ERROR_RESULT,
      "%s: %s changed nothing: does your command read parameters.json, and "
      "does the number act in this scene?", r->capabilities->simulator,
      changes);
  return FALSE;
}

/* A run that fails is no end: other numbers may do. */
static gboolean
note_failed (Refit * r, GError * failed, GError ** error)
{
  if (!g_error_matches (failed, CLOTH_SIMULATOR_ERROR,
          CLOTH_SIMULATOR_ERROR_RUN)
      && !g_error_matches (failed, CLOTH_SIMULATOR_ERROR,
          CLOTH_SIMULATOR_ERROR_RESULT)) {
    g_propagate_error (error, failed);
    return FALSE;
  }
  cloth_gap_result_add_failure (r->d->result, r->capabilities->simulator,
      failed->message);
  g_set_error_literal (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL,
      failed->message);
  g_clear_error (&r->failed);
  r->failed = failed;
  return FALSE;
}

/* Runs all takes with @values. */
static gboolean
evaluate (Refit * r, const gdouble * values, gdouble * z, GError ** error)
{
  ClothDiagnosis *d = r->d;
  g_autoptr (GPtrArray) twins = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_recording_free);
  gsize at = 0;

  r->left -= r->left > 0;
  for (guint i = 0; i < d->n_takes; i++) {
    GError *failed = NULL;
    g_autoptr (ClothTake) take = cloth_diagnosis_run_simulator (d, i, values,
        &failed);
    ClothRecording *twin;

    if (!take)
      return note_failed (r, failed, error);
    twin = cloth_recording_new_twin (take, cloth_diagnosis_recording (d, i),
        error);
    if (!twin)
      return FALSE;
    g_ptr_array_add (twins, twin);
  }
  if (!check_changed (r, values, twins, error))
    return FALSE;
  for (guint i = 0; i < d->n_takes; i++) {
    if (!find_residual (r, i, g_ptr_array_index (twins, i), r->ours + at,
            z + at, error))
      return FALSE;
    at += cloth_diagnosis_study (d, i)->features->size;
  }
  r->n_sound++;
  memcpy (r->last, values, r->capabilities->parameters->len * sizeof *values);
  g_ptr_array_unref (r->twins);
  r->twins = g_steal_pointer (&twins);
  return TRUE;
}

/* The numbers at a place of the fit, in steps. */
static gdouble *
find_values (const Refit * r, const gdouble * x)
{
  gdouble *values = g_memdup2 (r->values,
      r->capabilities->parameters->len * sizeof *values);

  for (guint i = 0; i < r->n; i++) {
    const Number *number = get_number (r, i);

    values[number->index] = cloth_simulator_parameter_value
        (number->parameter, x[i]);
  }
  return values;
}

/* Keeps the place with its residual: [n + size]. */
static gboolean
find_weighted (gpointer data, const gdouble * x, gdouble * z, GError ** error)
{
  Refit *r = data;
  g_autofree gdouble *values = find_values (r, x);
  g_autofree gdouble *place = g_new (gdouble, r->n + r->size);

  memcpy (place, x, r->n * sizeof *x);
  if (!evaluate (r, values, place + r->n, error))
    return FALSE;
  for (gsize k = 0; k < r->size; k++)
    z[k] = r->weights[k] * place[r->n + k];
  g_ptr_array_add (r->places, g_steal_pointer (&place));
  return TRUE;
}

/* ---- derivatives ---- */

/* A run with the number a step away; none is left, or it fails either way: FALSE without an error. */
static gboolean
measure_column (Refit * r, Number * number, GError ** error)
{
  const gdouble *range = number->parameter->range;
  const gdouble own = r->values[number->index];
  const gdouble place = cloth_simulator_parameter_place (number->parameter,
      own);

  for (guint side = 0; side < 2 && r->left; side++) {
    const gdouble step = side ? -1. : 1.;
    const gdouble value = cloth_simulator_parameter_value (number->parameter,
        place + step);
    g_autofree gdouble *values = g_memdup2 (r->values,
        r->capabilities->parameters->len * sizeof *values);
    g_autoptr (GError) failed = NULL;

    if (value == own || (!side && value >= range[1] && own > range[0]))
      continue;
    values[number->index] = value;
    if (evaluate (r, values, number->column, &failed)) {
      const gdouble gone = cloth_simulator_parameter_place (number->parameter,
          value) - place;

      for (gsize k = 0; k < r->size; k++)
        number->column[k] = (number->column[k] - r->z[k]) / gone;
      return TRUE;
    }
    if (!g_error_matches (failed, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL)) {
      g_propagate_error (error, g_steal_pointer (&failed));
      return FALSE;
    }
  }
  return FALSE;
}

/* How many steps do what the accepted effects do in ours; a number that does the work of several is
 * in between. NaN: not known. */
static gdouble
find_guess (const Refit * r, const ClothSimulatorParameter * parameter)
{
  const ClothDiagnosis *d = r->d;
  const guint first = d->candidates->n_free, n = r->n_targets - first;
  g_autofree gdouble *slopes = g_new (gdouble, n + 1);
  gdouble square = 0., sum = 0.;

  if (!cloth_simulator_parameter_slopes (parameter, r->targets + first, n,
          slopes))
    return NAN;
  for (guint i = 0; i < n; i++) {
    square += slopes[i] * slopes[i];
    sum += slopes[i] * (r->targets[first + i].value -
        cloth_candidates_direction (d->candidates,
            r->directions[first + i])->centre);
  }
  return square > 0. ? sum / square : NAN;
}

/* Those of ours, or, where they are not known, those that a run shows. */
static gboolean
find_column (Refit * r, Number * number, GError ** error)
{
  g_autofree gdouble *slopes = g_new (gdouble, r->n_targets + 1);

  number->guess = find_guess (r, number->parameter);
  number->column = g_new0 (gdouble, r->size);
  if (!cloth_simulator_parameter_slopes (number->parameter, r->targets,
          r->n_targets, slopes))
    return measure_column (r, number, error);
  for (guint i = 0; i < r->n_targets; i++)
    for (gsize k = 0; slopes[i] != 0. && k < r->size; k++)
      number->column[k] += slopes[i] * r->columns[i * r->size + k];
  return TRUE;
}

/* Takes a number into the fit, if its derivatives can be had. */
static gboolean
add_number (Refit * r, guint index, gboolean is_base, GError ** error)
{
  Number number = {
    cloth_simulator_capabilities_get (r->capabilities, index), index, is_base
  };
  GError *failed = NULL;

  if (find_column (r, &number, &failed)) {
    g_array_append_val (r->numbers, number);
    return TRUE;
  }
  g_free (number.column);
  if (!failed)
    return TRUE;
  g_propagate_error (error, failed);
  return FALSE;
}

/* ---- which numbers ---- */

static gboolean
does_accepted (const Refit * r, const ClothSimulatorParameter * parameter,
    guint accepted)
{
  const ClothDiagnosis *d = r->d;
  const ClothCandidate *c = cloth_diagnosis_accepted (d, accepted);

  for (guint k = 0; k < c->n; k++)
    if (cloth_simulator_parameter_does (parameter,
            cloth_candidates_direction (d->candidates, c->first + k)->name))
      return TRUE;
  return FALSE;
}

/* Whether the simulator has an accepted effect. */
static gboolean
has_effect (const Refit * r, guint accepted)
{
  for (guint i = 0; i < r->capabilities->parameters->len; i++)
    if (does_accepted (r, cloth_simulator_capabilities_get (r->capabilities,
                i), accepted))
      return TRUE;
  return FALSE;
}

/* It does what a free number of the model does, or nothing of ours. */
static gboolean
is_base (const Refit * r, const ClothSimulatorParameter * parameter)
{
  if (cloth_simulator_parameter_is_fixed (parameter))
    return FALSE;
  for (guint i = 0; i < r->d->candidates->n_free; i++)
    if (parameter->is && g_strv_contains ((const gchar * const *)
            parameter->is, r->targets[i].name))
      return TRUE;
  return !parameter->is;
}

static gboolean
add_effects (Refit * r, GError ** error)
{
  for (guint i = 0; i < r->capabilities->parameters->len; i++) {
    gboolean does = FALSE;

    for (guint c = 0; c < r->d->n_accepted; c++)
      does |= does_accepted (r,
          cloth_simulator_capabilities_get (r->capabilities, i), c);
    if (does && !add_number (r, i, FALSE, error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
add_base (Refit * r, GError ** error)
{
  for (guint i = 0; i < r->capabilities->parameters->len; i++) {
    gboolean there = FALSE;

    for (guint k = 0; k < r->numbers->len; k++)
      there |= get_number (r, k)->index == i;
    if (!there && is_base (r, cloth_simulator_capabilities_get
            (r->capabilities, i)) && !add_number (r, i, TRUE, error))
      return FALSE;
  }
  return TRUE;
}

/* ---- the fit ---- */

/* Fits all numbers from where they are by at most @n_runs runs. @x: where each is, in steps.
 * @is_first: nothing was fitted before. */
static gboolean
fit (Refit * r, gboolean is_first, guint n_runs, gdouble * x, GError ** error)
{
  const guint n = r->n;
  g_autofree gdouble *low = g_new (gdouble, n);
  g_autofree gdouble *high = g_new (gdouble, n);
  g_autofree gdouble *precisions = g_new (gdouble, n);
  g_autofree gdouble *columns = g_new (gdouble, n * r->size);
  g_autofree gdouble *z = g_new (gdouble, r->size);
  g_autofree gdouble *guess = is_first ? g_new (gdouble, n) : NULL;
  const ClothBroydenOptions options = {
    n, r->size, low, high, precisions, guess, LONGEST, SHORTEST, n_runs
  };

  for (guint i = 0; i < n; i++) {
    const Number *number = get_number (r, i);
    const gdouble prior = number->is_base ? BASE_PRIOR : EFFECT_PRIOR;

    x[i] = cloth_simulator_parameter_place (number->parameter,
        r->values[number->index]);
    if (guess)
      guess[i] = isnan (number->guess) ? x[i] : number->guess;
    low[i] = cloth_simulator_parameter_place (number->parameter,
        number->parameter->range[0]);
    high[i] = cloth_simulator_parameter_place (number->parameter,
        number->parameter->range[1]);
    precisions[i] = 1. / (prior * prior);
    for (gsize k = 0; k < r->size; k++)
      columns[i * r->size + k] = r->weights[k] * number->column[k];
  }
  for (gsize k = 0; k < r->size; k++)
    z[k] = r->weights[k] * r->z[k];
  if (!cloth_broyden_run (find_weighted, r, &options, x, z, columns, error))
    return FALSE;
  for (guint i = 0; i < n; i++)
    for (gsize k = 0; k < r->size; k++)
      if (r->weights[k] > 0.)
        get_number (r, i)->column[k] = columns[i * r->size + k] / r->weights[k];
  return TRUE;
}

/* Where a stage has led becomes the best place, if it takes @share of the square off. */
static gboolean
run_stage (Refit * r, gboolean is_first, guint n_runs, gdouble share,
    GError ** error)
{
  g_autofree gdouble *x = g_new (gdouble, r->numbers->len + 1);
  g_autofree gdouble *values = NULL;

  r->n = r->numbers->len;
  if (!r->n || n_runs < LEAST_RUNS)
    return TRUE;
  weigh (r);
  g_ptr_array_set_size (r->places, 0);
  if (!fit (r, is_first, n_runs, x, error))
    return FALSE;
  for (guint i = 0; i < r->places->len; i++) {
    const gdouble *place = r->places->pdata[i];

    if (memcmp (place, x, r->n * sizeof *x) != 0)
      continue;
    if (find_square (r, place + r->n) > (1. - share) * find_square (r, r->z))
      return TRUE;
    values = find_values (r, x);
    memcpy (r->values, values,
        r->capabilities->parameters->len * sizeof *values);
    memcpy (r->z, place + r->n, r->size * sizeof *place);
    return TRUE;
  }
  return TRUE;
}

static gboolean
fit_all (Refit * r, gboolean has_all, GError ** error)
{
  const guint most = r->left;

  if (!add_effects (r, error))
    return FALSE;
  for (guint i = 0; i < N_EFFECT_STAGES; i++)
    if (!run_stage (r, !i, MIN (r->left, most / 2), 0., error))
      return FALSE;
  if (!has_all || !r->n_sound || r->left < LEAST_RUNS)
    return TRUE;
  return add_base (r, error)
      && run_stage (r, FALSE, r->left, LEAST_FALL, error);
}

/* ---- what to change ---- */

/* Three digits, as people type them. Where runs failed no number goes further than it was run. */
static void
round_values (Refit * r)
{
  for (guint i = 0; i < r->capabilities->parameters->len; i++) {
    const ClothSimulatorParameter *p =
        cloth_simulator_capabilities_get (r->capabilities, i);
    const gdouble far = r->values[i] - p->value;
    gchar text[G_ASCII_DTOSTR_BUF_SIZE];
    gdouble rounded;

    if (far == 0.)
      continue;
    g_ascii_formatd (text, sizeof text, "%.3g", r->values[i]);
    rounded = g_ascii_strtod (text, NULL);
    if (r->failed && fabs (rounded - p->value) > fabs (far)) {
      g_ascii_formatd (text, sizeof text, "%.3g", rounded - copysign (pow (10.,
                  floor (log10 (fabs (r->values[i]))) - 2.), far));
      rounded = g_ascii_strtod (text, NULL);
      /* the user's own may have more digits */
      if (!((rounded - p->value) * far > 0.))
        rounded = r->values[i];
    }
    r->values[i] = CLAMP (rounded, p->range[0], p->range[1]);
  }
}

static void
fill_changes (const Refit * r)
{
  for (guint i = 0; i < r->capabilities->parameters->len; i++) {
    const ClothSimulatorParameter *p =
        cloth_simulator_capabilities_get (r->capabilities, i);
    g_autofree gchar *text = NULL;

    if (r->values[i] == p->value)
      continue;
    text = cloth_gap_change_text (p->name, p->value, r->values[i], p->unit);
    cloth_gap_result_add_patch (r->d->result, p->name, text, p->value,
        r->values[i], p->unit);
  }
}

/* An effect that the simulator has no number for: which one, how much, and what it does. */
static void
fill_lack (const Refit * r, guint accepted)
{
  ClothDiagnosis *d = r->d;
  const ClothCandidate *c = cloth_diagnosis_accepted (d, accepted);
  g_autoptr (GString) text = g_string_new ("has no number there: add it");

  for (guint k = 0; k < c->n; k++) {
    const ClothEffectParameter *p = &c->effect->parameters[c->parameters[k]];
    gdouble value = NAN;

    cloth_model_get (d->with,
        cloth_candidates_direction (d->candidates, c->first + k)->name, &value,
        NULL);
    g_string_append_printf (text, "%s %s %.3g", k ? "," : " with", p->name,
        value);
    if (strcmp (p->unit, "1") != 0)
      g_string_append_printf (text, " %s", p->unit);
  }
  g_string_append_printf (text, ". %s", c->effect->blurb);
  cloth_gap_result_add_patch (d->result, c->effect->id, text->str, NAN, NAN,
      "1");
}

/* What the simulator makes of what judges. A run that fails there is told, and measures nothing. */
static gboolean
run_judges (Refit * r, GError ** error)
{
  ClothDiagnosis *d = r->d;
  const guint first = d->options->n_hold_outs ? d->n_takes +
      d->options->n_baselines : 0;
  const guint n = d->options->n_hold_outs ? d->options->n_hold_outs :
      d->n_takes;

  for (guint i = first; i < first + n; i++) {
    g_autoptr (GError) failed = NULL;
    g_autofree gchar *note = NULL;

    if (cloth_diagnosis_add_after (d, i, r->values, &failed))
      continue;
    if (failed->domain != CLOTH_SIMULATOR_ERROR) {
      g_propagate_error (error, g_steal_pointer (&failed));
      return FALSE;
    }
    note = g_strdup_printf ("With what to change, %s could not simulate %s: "
        "%s.", r->capabilities->simulator,
        cloth_diagnosis_recording (d, i)->name, failed->message);
    cloth_gap_result_add_note (d->result, note);
    g_ptr_array_set_size (d->afters, 0);
    return TRUE;
  }
  return TRUE;
}

static gboolean
is_changed (const Refit * r)
{
  for (guint i = 0; i < r->capabilities->parameters->len; i++)
    if (r->values[i] != cloth_simulator_capabilities_get (r->capabilities,
            i)->value)
      return TRUE;
  return FALSE;
}

/* @d: a diagnosis whose verdict is decided
 * @error: #ClothSimulatorError, #ClothSimError, #ClothFitError
 *
 * Fits the numbers of the user's simulator on the takes, runs it with them on what judges, and
 * writes what to change there, in its names and units. What it has no number for is left to the
 * user to add. Without accepted effects there is nothing to change.
 *
 * Returns: whether it could be fitted
 */
gboolean
cloth_diagnosis_refit (ClothDiagnosis * d, GError ** error)
{
  ClothGapSimulator *simulator = d->options->simulator;
  g_auto (Refit) r = { d };
  gboolean has_all = TRUE, has_any = FALSE;

  if (!simulator || d->result->verdict == CLOTH_GAP_UNDECIDABLE)
    return TRUE;
  r.capabilities = simulator->capabilities;
  g_free (d->result->patch_simulator);
  d->result->patch_simulator = g_strdup (r.capabilities->simulator);
  if (!d->n_accepted)
    return TRUE;
  r.values = cloth_gap_simulator_defaults (r.capabilities);
  r.last = cloth_gap_simulator_defaults (r.capabilities);
  r.twins = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_recording_free);
  r.places = g_ptr_array_new_with_free_func (g_free);
  r.numbers = g_array_new (FALSE, FALSE, sizeof (Number));
  g_array_set_clear_func (r.numbers, number_clear);
  r.left = d->options->simulator_runs;
  list_targets (&r);
  for (guint c = 0; c < d->n_accepted; c++) {
    gboolean has = has_effect (&r, c);

    has_all &= has;
    has_any |= has;
  }
  if (has_any) {
    if (!begin (&r, error) || !fit_all (&r, has_all, error))
      return FALSE;
    if (r.failed && !r.n_sound) {
      g_propagate_error (error, g_steal_pointer (&r.failed));
      return FALSE;
    }
  }
  round_values (&r);
  fill_changes (&r);
  for (guint c = 0; c < d->n_accepted; c++)
    if (!has_effect (&r, c))
      fill_lack (&r, c);
  return !is_changed (&r) || run_judges (&r, error);
}
