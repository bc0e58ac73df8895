/* Users' simulators as functions: what is asked of them, and which answers are none.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/simulator/simulator.h"

#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/gap/simulator/mapping.h"
#include "tests/common/gaprecord.h"

#define TEXT "{\"version\": 1, \"simulator\": \"mine\", \"parameters\": [" \
    "{\"name\": \"tension\", \"unit\": \"N/m\", \"value\": 10," \
    " \"range\": [1, 12], \"is\": [\"stretch.warp\", \"stretch.weft\"]}," \
    "{\"name\": \"drag\", \"value\": 0.5, \"range\": [0, 4]," \
    " \"is\": \"effects.air_drag.coefficient\", \"scale\": 2}," \
    "{\"name\": \"stickiness\", \"value\": 2, \"range\": [0, 2]}," \
    "{\"name\": \"iterations\", \"value\": 20}]}"

static gchar *parent;

static ClothSimulatorCapabilities *
parse (void)
{
  g_autoptr (GError) error = NULL;
  ClothSimulatorCapabilities *capabilities =
      cloth_simulator_capabilities_parse (TEXT, strlen (TEXT), &error);

  g_assert_no_error (error);
  return capabilities;
}

static void
test_capabilities (void)
{
  g_autoptr (ClothSimulatorCapabilities) c = parse ();
  const ClothSimulatorParameter *p = cloth_simulator_capabilities_get (c, 0);

  g_assert_cmpstr (c->simulator, ==, "mine");
  g_assert_null (c->version);
  g_assert_cmpuint (c->parameters->len, ==, 4);
  g_assert_cmpstr (p->unit, ==, "N/m");
  g_assert_cmpuint (g_strv_length (p->is), ==, 2);
  g_assert_true (isnan (p->scale));
  g_assert_true (cloth_simulator_parameter_is_logarithmic (p));
  p = cloth_simulator_capabilities_get (c, 1);
  g_assert_cmpfloat (p->scale, ==, 2.);
  g_assert_false (cloth_simulator_parameter_is_logarithmic (p));
  p = cloth_simulator_capabilities_get (c, 3);
  g_assert_cmpstr (p->unit, ==, "1");
  g_assert_null (p->is);
  g_assert_true (cloth_simulator_parameter_is_fixed (p));
}

/* Steps go up, or down where there is no room; of an effect by 0.4 of its prior, which of
 * air_drag is 1.5. */
static void
test_move (void)
{
  g_autoptr (ClothSimulatorCapabilities) c = parse ();
  g_autofree gdouble *values = cloth_gap_simulator_defaults (c);
  g_autofree gchar *none = cloth_gap_simulator_describe (c, values);
  g_autofree gchar *some = NULL;

  g_assert_cmpstr (none, ==, "");
  for (guint i = 0; i < 3; i++)
    values[i] =
        cloth_gap_simulator_move (cloth_simulator_capabilities_get (c, i),
        values[i]);
  g_assert_cmpfloat_with_epsilon (values[0], 10. * exp (-0.24), 1e-12);
  g_assert_cmpfloat_with_epsilon (values[1], 0.5 + 0.4 * 1.5 / 2., 1e-12);
  g_assert_cmpfloat_with_epsilon (values[2], 1.8, 1e-12);
  some = cloth_gap_simulator_describe (c, values);
  g_assert_cmpstr (some, ==,
      "tension = 7.86628 N/m, drag = 0.8, stickiness = 1.8");
}

/* ---- what its numbers do to ours ---- */

/* Of the tension, along its logarithm in steps of 0.24, ours goes in proportion; of the drag a step
 * is 0.3, twice that of ours. */
static void
test_slopes (void)
{
  static const ClothSimulatorTarget targets[] = {
    {"stretch.warp", TRUE, 30.}, {"stretch.weft", TRUE, 50.},
    {"effects.air_drag.coefficient", FALSE, 0.},
    {"effects.stretch.log_ratio", FALSE, 0.},
    {"effects.stretch_anisotropy.log_ratio", FALSE, 0.}
  };
  g_autoptr (ClothSimulatorCapabilities) c = parse ();
  const ClothSimulatorParameter *tension =
      cloth_simulator_capabilities_get (c, 0);
  const ClothSimulatorParameter *drag = cloth_simulator_capabilities_get (c, 1);
  gdouble slopes[5];

  g_assert_true (cloth_simulator_parameter_slopes (tension, targets, 3,
          slopes));
  g_assert_cmpfloat_with_epsilon (slopes[0], 0.24, 1e-12);
  g_assert_cmpfloat_with_epsilon (slopes[1], 0.24, 1e-12);
  g_assert_cmpfloat (slopes[2], ==, 0.);
  /* of numbers that are no targets through the effect that changes both */
  g_assert_true (cloth_simulator_parameter_slopes (tension, targets + 2, 2,
          slopes));
  g_assert_cmpfloat_with_epsilon (slopes[1], 0.24, 1e-12);
  /* half of it is known only, or nothing */
  g_assert_false (cloth_simulator_parameter_slopes (tension, targets, 1,
          slopes));
  g_assert_false (cloth_simulator_parameter_slopes (tension, targets + 2, 1,
          slopes));
  g_assert_true (cloth_simulator_parameter_slopes (drag, targets, 3, slopes));
  g_assert_cmpfloat_with_epsilon (slopes[2], 2. * 0.3, 1e-12);
  /* what is nothing of ours, and what has no unit */
  g_assert_false (cloth_simulator_parameter_slopes
      (cloth_simulator_capabilities_get (c, 2), targets, 5, slopes));
  ((ClothSimulatorParameter *) drag)->scale = NAN;
  g_assert_false (cloth_simulator_parameter_slopes (drag, targets, 3, slopes));
  g_assert_true (cloth_simulator_parameter_does (tension,
          "effects.stretch.log_ratio"));
  /* both alike: their ratio stays */
  g_assert_false (cloth_simulator_parameter_does (tension,
          "effects.stretch_anisotropy.log_ratio"));
  g_assert_false (cloth_simulator_parameter_does (tension,
          "effects.bending.log_ratio"));
  g_assert_true (cloth_simulator_parameter_does (drag,
          "effects.air_drag.coefficient"));
  /* settings do nothing */
  g_assert_false (cloth_simulator_parameter_does
      (cloth_simulator_capabilities_get (c, 3), "effects.shear.log_ratio"));
}

/* Places are steps from the own value, there and back, and end with the range. */
static void
test_places (void)
{
  g_autoptr (ClothSimulatorCapabilities) c = parse ();
  const ClothSimulatorParameter *tension =
      cloth_simulator_capabilities_get (c, 0);
  const ClothSimulatorParameter *drag = cloth_simulator_capabilities_get (c, 1);

  g_assert_cmpfloat (cloth_simulator_parameter_value (tension, 0.), ==, 10.);
  g_assert_cmpfloat_with_epsilon (cloth_simulator_parameter_value (tension,
          -2.), 10. * exp (-0.48), 1e-12);
  g_assert_cmpfloat_with_epsilon (cloth_simulator_parameter_place (tension,
          10. * exp (-0.48)), -2., 1e-12);
  g_assert_cmpfloat (cloth_simulator_parameter_value (tension, 9.), ==, 12.);
  g_assert_cmpfloat_with_epsilon (cloth_simulator_parameter_value (drag, 3.),
      0.5 + 0.9, 1e-12);
  g_assert_cmpfloat (cloth_simulator_parameter_value (drag, -9.), ==, 0.);
}

/* ---- answers ---- */

static const TestGapSheet sheet = { 5, 5, 20, 0.16, 0.16, 50., 0. };
static const TestGapSheet smaller = { 5, 4, 20, 0.16, 0.16, 50., 0. };
static const TestGapSheet shorter = { 5, 5, 15, 0.16, 0.16, 50., 0. };
static const TestGapSheet noisy = { 5, 5, 20, 0.16, 0.16, 50., 100. };

static void
hold_at (guint held, gdouble t, gfloat p[3])
{
  p[0] = held ? 0.16f : 0.f;
  p[1] = p[2] = 0.f;
}

/* Answers with what @data records, whatever is asked; NULL: not at all. */
static ClothTake *
answer (gpointer data, ClothTake * scene, const gdouble * values,
    GError ** error)
{
  g_autoptr (ClothModel) model = cloth_model_new ();

  if (data)
    return test_gap_record (data, model, hold_at, parent, "answer", 1);
  g_set_error (error, CLOTH_SIMULATOR_ERROR, CLOTH_SIMULATOR_ERROR_RUN,
      "no licence");
  return NULL;
}

static void
test_answers (void)
{
  static const struct
  {
    const TestGapSheet *sheet;
    const gchar *words;
  } cases[] = {
    {&sheet, NULL},
    {&smaller, "same mesh"},
    {&shorter, "scene/times.npy"},
    {&noisy, "blew up"},
    {NULL, "no licence"},
  };
  g_autoptr (ClothSimulatorCapabilities) c = parse ();
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (ClothTake) scene = test_gap_record (&sheet, model, hold_at,
      parent, "scene", 0);
  g_autofree gdouble *values = cloth_gap_simulator_defaults (c);
  ClothGapSimulator simulator = { c, answer };

  values[1] = 3.;
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothTake) result = NULL;

    simulator.data = (gpointer) cases[i].sheet;
    result = cloth_gap_simulator_run (&simulator, scene, values, &error);
    g_test_message ("%s", error ? error->message : "fine");
    g_assert_cmpuint (simulator.n_runs, ==, i + 1);
    g_assert_true ((result != NULL) == (cases[i].words == NULL));
    if (result)
      continue;
    g_assert_nonnull (strstr (error->message, cases[i].words));
    g_assert_true (g_str_has_prefix (error->message, "mine with drag = 3: "));
  }
}

int
main (int argc, char **argv)
{
  gint result;

  g_test_init (&argc, &argv, NULL);
  parent = g_dir_make_tmp ("cloth-simulator-XXXXXX", NULL);
  g_assert_nonnull (parent);
  g_test_add_func ("/simulator/capabilities", test_capabilities);
  g_test_add_func ("/simulator/move", test_move);
  g_test_add_func ("/simulator/slopes", test_slopes);
  g_test_add_func ("/simulator/places", test_places);
  g_test_add_func ("/simulator/answers", test_answers);
  result = g_test_run ();
  test_gap_remove (parent);
  g_free (parent);
  return result;
}
