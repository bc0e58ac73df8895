/* A user's simulator as a function, and what of its answers is no simulation.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/simulator/simulator.h"

#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "gst/gap/inputs.h"
#include "gst/sim/model.h"

/* Neighbours are never this many times the cloth's longest side apart, in a recording
 * neither (gst/fit/recording). */
#define FAR 10.
/* Steps of finite differences, as those of our own models (gst/fit/estimate): of a logarithm,
 * and of an effect as a share of its prior. */
#define LOG_STEP 0.24
#define EFFECT_STEP 0.4
/* Of a number of which only the range is known, as a share of it: own choice. */
#define RANGE_STEP 0.1

/* @capabilities: what a simulator says of itself
 *
 * Returns: (transfer full): its numbers where they are when nobody asks for others
 */
gdouble *
cloth_gap_simulator_defaults (const ClothSimulatorCapabilities * capabilities)
{
  gdouble *values = g_new (gdouble, capabilities->parameters->len);

  for (guint i = 0; i < capabilities->parameters->len; i++)
    values[i] = cloth_simulator_capabilities_get (capabilities, i)->value;
  return values;
}

/* What our prior of an effect's parameter is, in the simulator's unit; NaN if not known. */
static gdouble
find_prior (const ClothSimulatorParameter * parameter)
{
  guint n;
  const ClothEffect *const *effects = cloth_effect_table (&n);

  for (guint i = 0; i < n && parameter->is; i++)
    for (guint k = 0; k < effects[i]->n_parameters; k++) {
      const ClothEffectParameter *p = &effects[i]->parameters[k];
      g_autofree gchar *name = g_strdup_printf ("effects.%s.%s",
          effects[i]->id, p->name);

      if (!strcmp (name, parameter->is[0]))
        return p->prior / fabs (parameter->scale);
    }
  return NAN;
}

/* @parameter: a number of a simulator that has a range
 * @value: where it is
 *
 * Goes one step of a finite difference up, or down where there is no room.
 *
 * Returns: the other value
 */
gdouble
cloth_gap_simulator_move (const ClothSimulatorParameter * parameter,
    gdouble value)
{
  gdouble low = parameter->range[0], high = parameter->range[1];
  gdouble step;

  if (cloth_simulator_parameter_is_logarithmic (parameter)) {
    step = value * exp (LOG_STEP);
    return step <= high ? step : MAX (low, value * exp (-LOG_STEP));
  }
  step = EFFECT_STEP * find_prior (parameter);
  if (!(step < (high - low) / 2.))
    step = RANGE_STEP * (high - low);
  return value + step <= high ? value + step : MAX (low, value - step);
}

/* @capabilities: what a simulator says of itself
 * @values: its numbers
 *
 * Returns: (transfer full): those that are not where they are by themselves, for people:
 *   "tension = 12 N/m, drag = 0.3"
 */
gchar *
cloth_gap_simulator_describe (const ClothSimulatorCapabilities * capabilities,
    const gdouble * values)
{
  g_autoptr (GString) text = g_string_new (NULL);

  for (guint i = 0; i < capabilities->parameters->len; i++) {
    const ClothSimulatorParameter *p =
        cloth_simulator_capabilities_get (capabilities, i);

    if (values[i] == p->value)
      continue;
    g_string_append_printf (text, "%s%s = %g", text->len ? ", " : "", p->name,
        values[i]);
    if (strcmp (p->unit, "1") != 0)
      g_string_append_printf (text, " %s", p->unit);
  }
  return g_string_free (g_steal_pointer (&text), FALSE);
}

static gboolean
G_GNUC_PRINTF (2, 3)
refuse (GError ** error, const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_set_error_literal (error, CLOTH_SIMULATOR_ERROR,
      CLOTH_SIMULATOR_ERROR_RESULT, text);
  return FALSE;
}

/* Its frames begin and end with the scene's, to less than a frame. */
static gboolean
check_times (const ClothTake * scene, const ClothTake * result, GError ** error)
{
  guint n = cloth_take_get_n_frames (result);
  guint n_scene = cloth_take_get_n_frames (scene);
  gdouble from = cloth_take_get_time (scene, 0);
  gdouble to = cloth_take_get_time (scene, n_scene - 1);
  gdouble first = cloth_take_get_time (result, 0);
  gdouble last = cloth_take_get_time (result, n - 1);
  gdouble frame = n_scene > 1 ? (to - from) / (n_scene - 1) : 0.;

  if (n >= 2 && fabs (first - from) < frame && fabs (last - to) < frame)
    return TRUE;
  return refuse (error, "simulated/ has %u frames from %g to %g s, and the "
      "scene goes from %g to %g s: write a frame for each time of "
      "scene/times.npy", n, first, last, from, to);
}

static gdouble
longest_side (const ClothTopology * cloth)
{
  gdouble longest = 0.;

  for (guint k = 0; k < 2; k++) {
    gdouble low = INFINITY, high = -INFINITY;

    for (gsize i = 0; i < cloth->n_vertices; i++) {
      low = MIN (low, cloth->uv[2 * i + k]);
      high = MAX (high, cloth->uv[2 * i + k]);
    }
    longest = MAX (longest, high - low);
  }
  return longest;
}

static gdouble
distance (const gfloat * a, const gfloat * b)
{
  return sqrt (pow ((gdouble) a[0] - b[0], 2.) + pow ((gdouble) a[1] - b[1],
          2.) + pow ((gdouble) a[2] - b[2], 2.));
}

static gboolean
check_frame (const ClothTopology * cloth, const gfloat * places, gdouble time,
    gdouble side, GError ** error)
{
  static const gchar *mend = "shorten its time step, or the ranges of its "
      "parameters to where it is stable";

  for (guint i = 0; i < cloth->n_vertices; i++)
    for (guint k = 0; k < 3; k++)
      if (!isfinite (places[3 * (gsize) i + k]))
        return refuse (error, "the simulation blew up: at %g s vertex %u is "
            "%g; %s", time, i, places[3 * (gsize) i + k], mend);
  for (guint f = 0; f < cloth->n_faces; f++) {
    const guint32 *face = cloth->faces + 4 * (gsize) f;
    gdouble edge = distance (places + 3 * (gsize) face[0],
        places + 3 * (gsize) face[1]);

    if (edge > FAR * side)
      return refuse (error, "the simulation blew up: at %g s the vertices %u "
          "and %u, which are neighbours, are %g m apart; %s", time, face[0],
          face[1], edge, mend);
  }
  return TRUE;
}

static gboolean
check_positions (ClothTake * result, GError ** error)
{
  const ClothTopology *cloth = cloth_take_get_topology (result);
  g_autofree gfloat *places = g_new (gfloat, 3 * (gsize) cloth->n_vertices);
  gdouble side = longest_side (cloth);

  for (guint frame = 0; frame < cloth_take_get_n_frames (result); frame++)
    if (!cloth_take_read_positions (result, frame, places, error) ||
        !check_frame (cloth, places, cloth_take_get_time (result, frame), side,
            error))
      return FALSE;
  return TRUE;
}

/* @simulator: a simulator
 * @scene: what to simulate
 * @values: its numbers
 * @error: #ClothSimulatorError and what reading a take says; the numbers that were asked
 *   for are named
 *
 * Runs it once and checks what it made: the cloth of the scene over all of the scene's time,
 * each vertex somewhere.
 *
 * Returns: (transfer full) (nullable): what was simulated
 */
ClothTake *
cloth_gap_simulator_run (ClothGapSimulator * simulator, ClothTake * scene,
    const gdouble * values, GError ** error)
{
  g_autoptr (ClothTake) result = NULL;
  g_autofree gchar *numbers = NULL;

  simulator->n_runs++;
  result = simulator->run (simulator->data, scene, values, error);
  if (result && cloth_gap_check_same_cloth ("the scene",
          cloth_take_get_topology (scene), "what was simulated",
          cloth_take_get_topology (result), error)
      && check_times (scene, result, error) && check_positions (result, error))
    return g_steal_pointer (&result);
  numbers = cloth_gap_simulator_describe (simulator->capabilities, values);
  g_prefix_error (error, "%s%s%s: ", simulator->capabilities->simulator,
      *numbers ? " with " : "", numbers);
  return NULL;
}
