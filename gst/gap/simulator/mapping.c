/* What the numbers of a user's simulator do to ours.
 *
 * Model: a number of a simulator is searched along s, its logarithm when its range is all above 0,
 *   else itself, in steps of a finite difference from its value on. What it `is` of ours, θ (or
 *   log θ), goes with it: in proportion where both are searched by logarithms, else by @scale.
 *   Some effects change numbers of the model: the logarithm of a ratio is then
 *     log_ratio = Σ wₖ log (numberₖ/its own value),  Σ wₖ = 1,  or 1 and −1 for a ratio of two.
 * Formula: derivatives along s are slopes times those along ours.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/simulator/mapping.h"

#include <math.h>
#include <string.h>

#include "gst/gap/simulator/simulator.h"

/* An effect's parameter as numbers of the model: what each counts. */
typedef struct
{
  const gchar *parameter;
  gboolean is_ratio;
  struct
  {
    const gchar *number;
    gdouble weight;
  } parts[2];
} Same;

static const Same same[] = {
  {"effects.areal_mass.log_ratio", TRUE, {{"areal_density", 1.}}},
  {"effects.bending.log_ratio", TRUE,
      {{"bending.warp", 0.5}, {"bending.weft", 0.5}}},
  {"effects.bending_anisotropy.log_ratio", TRUE,
      {{"bending.warp", 1.}, {"bending.weft", -1.}}},
  {"effects.stretch.log_ratio", TRUE,
      {{"stretch.warp", 0.5}, {"stretch.weft", 0.5}}},
  {"effects.stretch_anisotropy.log_ratio", TRUE,
      {{"stretch.warp", 1.}, {"stretch.weft", -1.}}},
  {"effects.shear.log_ratio", TRUE, {{"shear", 1.}}},
  {"effects.damping_mass.rate", FALSE, {{"damping.mass", 1.}}},
  {"effects.damping_stiffness.time", FALSE, {{"damping.stiffness", 1.}}},
};

static const Same *
find_same (const gchar * name)
{
  for (guint i = 0; i < G_N_ELEMENTS (same); i++)
    if (!strcmp (same[i].parameter, name))
      return &same[i];
  return NULL;
}

/* How much of an effect's parameter a number of the model is; 0: nothing. */
static gdouble
find_weight (const Same * effect, const gchar * number)
{
  for (guint i = 0; i < G_N_ELEMENTS (effect->parts); i++)
    if (!g_strcmp0 (effect->parts[i].number, number))
      return effect->parts[i].weight;
  return 0.;
}

/* Where it is along its axis, which has no unit. */
static gdouble
find_axis (const ClothSimulatorParameter * parameter, gdouble value)
{
  return cloth_simulator_parameter_is_logarithmic (parameter) ?
      log (value) : value;
}

/* @parameter: a number of a simulator that has a range
 *
 * Returns: one step of a finite difference along its axis
 */
gdouble
cloth_simulator_parameter_unit (const ClothSimulatorParameter * parameter)
{
  gdouble moved = cloth_gap_simulator_move (parameter, parameter->value);

  return fabs (find_axis (parameter, moved) - find_axis (parameter,
          parameter->value));
}

/* @parameter: a number of a simulator that has a range
 * @value: a value of it
 *
 * Returns: how many steps that is from its own value
 */
gdouble
cloth_simulator_parameter_place (const ClothSimulatorParameter * parameter,
    gdouble value)
{
  return (find_axis (parameter, value) - find_axis (parameter,
          parameter->value)) / cloth_simulator_parameter_unit (parameter);
}

/* @parameter: a number of a simulator that has a range
 * @place: steps from its own value
 *
 * Returns: the value there, within its range
 */
gdouble
cloth_simulator_parameter_value (const ClothSimulatorParameter * parameter,
    gdouble place)
{
  gdouble axis = find_axis (parameter, parameter->value) + place *
      cloth_simulator_parameter_unit (parameter);

  if (place == 0.)
    return parameter->value;
  return CLAMP (cloth_simulator_parameter_is_logarithmic (parameter) ?
      exp (axis) : axis, parameter->range[0], parameter->range[1]);
}

/* @parameter: a number of a simulator
 * @name: of an effect's parameter, as cloth_model_get () names it
 *
 * Returns: whether the number does what the effect's parameter does
 */
gboolean
cloth_simulator_parameter_does (const ClothSimulatorParameter * parameter,
    const gchar * name)
{
  const Same *effect = find_same (name);
  gdouble sum = 0.;

  if (!parameter->is || cloth_simulator_parameter_is_fixed (parameter))
    return FALSE;
  if (g_strv_contains ((const gchar * const *) parameter->is, name))
    return TRUE;
  for (guint i = 0; effect && parameter->is[i]; i++)
    sum += find_weight (effect, parameter->is[i]);
  return sum != 0.;
}

/* What the logarithm of the number's value gains per step, or NaN where it is 0. */
static gdouble
find_ratio (const ClothSimulatorParameter * p)
{
  gdouble unit = cloth_simulator_parameter_unit (p);

  if (cloth_simulator_parameter_is_logarithmic (p))
    return unit;
  return p->value > 0. ? unit / p->value : NAN;
}

/* What the target gains per step. */
static gdouble
find_slope (const ClothSimulatorParameter * p,
    const ClothSimulatorTarget * target)
{
  gdouble gain = p->scale * cloth_simulator_parameter_unit (p);

  if (cloth_simulator_parameter_is_logarithmic (p))
    gain *= p->value;
  if (!target->logarithmic)
    return gain;
  return isnan (gain) || cloth_simulator_parameter_is_logarithmic (p) ?
      find_ratio (p) : gain / target->value;
}

static gint
find_target (const ClothSimulatorTarget * targets, guint n, const gchar * name)
{
  for (guint i = 0; i < n; i++)
    if (!strcmp (targets[i].name, name))
      return (gint) i;
  return -1;
}

/* Of a number of the model that is no target: through the effect that is. */
static gboolean
add_effect (const ClothSimulatorParameter * p, const gchar * number,
    const ClothSimulatorTarget * targets, guint n, gdouble * slopes)
{
  for (guint i = 0; i < n; i++) {
    const Same *effect = find_same (targets[i].name);
    gdouble weight = effect ? find_weight (effect, number) : 0.;

    if (weight == 0.)
      continue;
    slopes[i] += weight * (effect->is_ratio ? find_ratio (p) :
        find_slope (p, &targets[i]));
    return TRUE;
  }
  return FALSE;
}

/* @parameter: a number of a simulator that has a range
 * @targets: (array length=n): numbers of ours that have derivatives
 * @n: how many
 * @slopes: (out) (array): how far each goes with a step of it
 *
 * Returns: whether these are known: all that it is of ours is among the targets, in units that
 *   can be converted
 */
gboolean
cloth_simulator_parameter_slopes (const ClothSimulatorParameter * parameter,
    const ClothSimulatorTarget * targets, guint n, gdouble * slopes)
{
  memset (slopes, 0, n * sizeof *slopes);
  if (!parameter->is)
    return FALSE;
  for (guint k = 0; parameter->is[k]; k++) {
    gint target = find_target (targets, n, parameter->is[k]);

    if (target >= 0)
      slopes[target] += find_slope (parameter, &targets[target]);
    else if (!add_effect (parameter, parameter->is[k], targets, n, slopes))
      return FALSE;
  }
  for (guint i = 0; i < n; i++)
    if (isnan (slopes[i]))
      return FALSE;
  return TRUE;
}
