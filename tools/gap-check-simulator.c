/* gst-cloth-gap-1.0 check-simulator: whether a user's simulator does what it says.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-tool.h"

#include <gio/gio.h>
#include <math.h>

#include "tools/gap-simulator.h"

/* Root mean square distance of two simulations, frame by frame; NaN when their frames are
 * not the same. */
static gdouble
compare (ClothTake * a, ClothTake * b, GError ** error)
{
  gsize n = 3 * (gsize) cloth_take_get_topology (a)->n_vertices;
  guint n_frames = cloth_take_get_n_frames (a);
  g_autofree gfloat *first = g_new (gfloat, n), *second = g_new (gfloat, n);
  gdouble sum = 0.;

  if (cloth_take_get_n_frames (b) != n_frames)
    return NAN;
  for (guint frame = 0; frame < n_frames; frame++) {
    if (!cloth_take_read_positions (a, frame, first, error) ||
        !cloth_take_read_positions (b, frame, second, error))
      return NAN;
    for (gsize i = 0; i < n; i++)
      sum += pow ((gdouble) first[i] - second[i], 2.);
  }
  return sqrt (sum / ((gdouble) n / 3. * n_frames));
}

/* Moves one parameter and says what that does. */
static gboolean
check_parameter (ClothGapSimulator * simulator, ClothTake * scene, guint i,
    ClothTake * usual, gdouble repeat, GError ** error)
{
  const ClothSimulatorParameter *p =
      cloth_simulator_capabilities_get (simulator->capabilities, i);
  g_autofree gdouble *values =
      cloth_gap_simulator_defaults (simulator->capabilities);
  g_autoptr (ClothTake) moved = NULL;
  g_autofree gchar *is = p->is ? g_strjoinv (", ", p->is) : NULL;
  const gboolean has_unit = !g_str_equal (p->unit, "1");
  gdouble by;

  if (cloth_simulator_parameter_is_fixed (p)) {
    g_print ("%-24s %g%s%s, fixed\n", p->name, p->value, has_unit ? " " : "",
        has_unit ? p->unit : "");
    return TRUE;
  }
  values[i] = cloth_gap_simulator_move (p, p->value);
  moved = cloth_gap_simulator_run (simulator, scene, values, error);
  if (!moved)
    return FALSE;
  by = compare (usual, moved, error);
  if (!isfinite (by)) {
    if (error && !*error)
      g_set_error (error, CLOTH_SIMULATOR_ERROR, CLOTH_SIMULATOR_ERROR_RESULT,
          "changing “%s” changed the number of frames: write those of the "
          "scene", p->name);
    return FALSE;
  }
  g_print ("%-24s %g to %g%s%s moves the cloth by %.3g mm%s%s\n", p->name,
      p->value, values[i], has_unit ? " " : "", has_unit ? p->unit : "",
      1e3 * by, is ? ", is " : "", is ? is : "");
  if (by > repeat)
    return TRUE;
  g_set_error (error, CLOTH_SIMULATOR_ERROR, CLOTH_SIMULATOR_ERROR_RESULT,
      "changing “%s” from %g to %g changed nothing: does your command read "
      "parameters.json, and does the number act in this scene?", p->name,
      p->value, values[i]);
  return FALSE;
}

static gboolean
check_all (ClothGapSimulator * simulator, ClothTake * scene, GError ** error)
{
  const ClothSimulatorCapabilities *capabilities = simulator->capabilities;
  g_autofree gdouble *values = cloth_gap_simulator_defaults (capabilities);
  g_autoptr (ClothTake) usual =
      cloth_gap_simulator_run (simulator, scene, values, error);
  g_autoptr (ClothTake) again = NULL;
  guint n_faults = 0;
  gdouble repeat;

  if (!usual)
    return FALSE;
  again = cloth_gap_simulator_run (simulator, scene, values, error);
  repeat = again ? compare (usual, again, error) : NAN;
  if (!again || (isnan (repeat) && error && *error))
    return FALSE;
  g_print ("%s %s: %u parameters; two equal runs differ by %.3g mm\n",
      capabilities->simulator,
      capabilities->version ? capabilities->version : "",
      capabilities->parameters->len, 1e3 * repeat);
  for (guint i = 0; i < capabilities->parameters->len; i++) {
    g_autoptr (GError) fault = NULL;

    if (check_parameter (simulator, scene, i, usual, repeat, &fault))
      continue;
    if (g_error_matches (fault, G_IO_ERROR, G_IO_ERROR_CANCELLED)) {
      g_propagate_error (error, g_steal_pointer (&fault));
      return FALSE;
    }
    g_print ("%s\n", fault->message);
    n_faults++;
  }
  if (n_faults == 0)
    return TRUE;
  g_set_error (error, CLOTH_SIMULATOR_ERROR, CLOTH_SIMULATOR_ERROR_RESULT,
      "%u of %u parameters do not do what the capabilities say", n_faults,
      capabilities->parameters->len);
  return FALSE;
}

gint
check_simulator (const Arguments * arguments)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GapSimulator) simulator = NULL;
  g_autoptr (ClothTake) scene = NULL;

  if (g_strv_length (arguments->rest) != 2)
    return complain (BAD_USAGE, "check-simulator needs the command of your "
        "simulator, as one word: check-simulator \"./mine --fast\" --scene "
        "TAKE");
  if (!arguments->scene)
    return complain (BAD_USAGE,
        "name the take that is to be simulated: --scene TAKE");
  if (arguments->run_seconds < 1)
    return complain (BAD_USAGE, "--run-seconds: give a number of 1 or more");
  catch_interrupts ();
  scene = cloth_take_open (arguments->scene, &error);
  simulator = scene ? gap_simulator_new (arguments->rest[1],
      (guint) arguments->run_seconds, &error) : NULL;
  if (simulator && check_all (gap_simulator_get (simulator), scene, &error))
    return DONE;
  return complain (FAILED, "%s", error->message);
}
