/* Diagnoses with twins: what is recorded comes from the mass–spring model with an effect; the twin is
 * the same without, written at other times; the diagnosing model is a membrane.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "gst/gap/diagnose.h"
#include "gst/gap/report/report.h"
#include "tests/common/gaprecord.h"

#define NOISE 3e-4

static const TestGapSheet filmed = { 9, 9, 75, 0.16, 0.16, 50., NOISE };

/* What a simulator writes has no noise; it goes on after the recording. */
static const TestGapSheet written = { 9, 9, 160, 0.16, 0.16, 100., 0. };

static const gchar *const few[] = {
  "air_drag", "wind", "gravity_tilt", "shrinkage", NULL
};

static gchar *parent;

/* The corners come closer and sway. */
static void
sway_at (guint held, gdouble t, gfloat p[3])
{
  gdouble ramp = MIN (1., t / 0.3), close = 0.03 * ramp * ramp *
      (3. - 2. * ramp);

  p[0] = (gfloat) (held ? 0.16 - close : close);
  p[1] = (gfloat) (0.05 * ramp * sin (8. * t));
  p[2] = 0.f;
}

/* The other motion is slower and across. */
static void
other_at (guint held, gdouble t, gfloat p[3])
{
  gdouble ramp = MIN (1., t / 0.3);

  sway_at (held, t, p);
  p[1] = (gfloat) (0.03 * ramp * sin (5. * t + held));
  p[2] = (gfloat) (0.02 * ramp * sin (6. * t));
}

static ClothModel *
model_new (ClothForceModel force_model)
{
  ClothModel *model = cloth_model_new ();

  model->force_model = force_model;
  model->areal_density = 0.15;
  model->stretch_warp = model->stretch_weft = 40.;
  model->shear = 12.;
  model->bending_warp = model->bending_weft = 3e-5;
  model->damping_mass = 0.3;
  model->damping_stiffness = 5e-4;
  test_gap_free_parameters (model);
  return model;
}

/* A take of the mass–spring cloth, with a coefficient of air drag. */
static ClothTake *
record (const TestGapSheet * sheet, const gchar * name, TestGapClamp clamp,
    gdouble drag, guint64 seed)
{
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MASS_SPRING);

  if (drag > 0.)
    cloth_model_set_effect (model, cloth_effect_find ("air_drag"), &drag);
  return test_gap_record (sheet, model, clamp, parent, name, seed);
}

static ClothGapResult *
diagnose (ClothTake ** takes, guint n, const ClothGapOptions * options)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  ClothGapResult *result = cloth_gap_diagnose (takes, n, model, options,
      &error);
  g_autofree gchar *summary = NULL;

  g_assert_no_error (error);
  summary = cloth_gap_result_summary (result);
  g_test_message ("%s", summary);
  for (guint i = 0; i < result->takes->len; i++) {
    const ClothGapMeasuredTake *t = &g_array_index (result->takes,
        ClothGapMeasuredTake, i);

    g_test_message ("%s: windows %.2f, %.2f of %.2f mm; free %.2f, %.2f of "
        "%.2f mm", t->name, 1e3 * t->gap_before.value,
        1e3 * t->gap_after.value, 1e3 * t->noise_floor.value,
        1e3 * t->free_before.value, 1e3 * t->free_after.value,
        1e3 * t->free_floor.value);
  }
  g_test_message ("predicted %.2f %.2f, measured %.2f %.2f, agree %g",
      result->predicted_shrink.windows.value,
      result->predicted_shrink.free.value,
      result->measured_shrink.windows.value,
      result->measured_shrink.free.value, result->takes_agree_p_value);
  return result;
}

/* RMS over frames but the first and vertices of recorded less every other frame simulated, m. */
static gdouble
find_distance (ClothTake * recorded, ClothTake * simulated)
{
  const guint n = cloth_take_get_topology (recorded)->n_vertices;
  const guint n_frames = cloth_take_get_n_frames (recorded);
  g_autofree gfloat *a = g_new (gfloat, 3 * n), *b = g_new (gfloat, 3 * n);
  gdouble sum = 0.;

  for (guint f = 1; f < n_frames; f++) {
    g_assert_true (cloth_take_read_positions (recorded, f, a, NULL));
    g_assert_true (cloth_take_read_positions (simulated, 2 * f, b, NULL));
    for (guint k = 0; k < 3 * n; k++)
      sum += pow ((gdouble) a[k] - b[k], 2.);
  }
  return sqrt (sum / (n * (n_frames - 1.)));
}

/* Whether one of the notes has @text. */
static gboolean
says (const ClothGapResult * result, const gchar * text)
{
  gboolean found = FALSE;

  for (guint i = 0; i < result->notes->len; i++) {
    g_test_message ("%s", (const gchar *) result->notes->pdata[i]);
    found |= strstr (result->notes->pdata[i], text) != NULL;
  }
  return found;
}

/* The effect is named; the free run is recorded less simulated as they are; with the effect in the
 * other simulator what remains is noise, as it was foretold. */
static void
test_named (void)
{
  g_autoptr (ClothTake) take = record (&filmed, "drag", sway_at, 2., 2);
  g_autoptr (ClothTake) twin = record (&written, "twin", sway_at, 0., 3);
  g_autoptr (ClothTake) after = record (&written, "after", sway_at, 2., 4);
  const ClothGapOptions options = {.simulated = &twin,.n_simulated = 1,
    .after = &after,.n_after = 1,.seed = 1
  };
  g_autoptr (ClothGapResult) result = diagnose (&take, 1, &options);
  const ClothGapEffect *first = &g_array_index (result->effects,
      ClothGapEffect, 0);
  const ClothGapMeasuredTake *row = &g_array_index (result->takes,
      ClothGapMeasuredTake, 0);

  g_assert_true (result->has_simulated);
  g_assert_cmpstr (first->effect->id, ==, "air_drag");
  g_assert_true (first->accepted);
  g_assert_cmpfloat_with_epsilon (first->values[0], 2., 0.4);
  g_assert_true (result->verdict == CLOTH_GAP_EXPLAINED
      || result->verdict == CLOTH_GAP_AMBIGUOUS);
  g_assert_cmpuint (result->takes->len, ==, 1);
  g_assert_cmpfloat_with_epsilon (row->free_before.value,
      find_distance (take, twin), 1e-6);
  g_assert_cmpfloat (row->free_before.low, <, row->free_before.value);
  g_assert_cmpfloat (row->free_before.high, >, row->free_before.value);
  /* noise at least, and hardly more: equal simulations do equal things */
  g_assert_cmpfloat (row->free_floor.value, >, 0.99 * sqrt (3.) * NOISE);
  g_assert_cmpfloat (row->noise_floor.value, >, 0.99 * sqrt (3.) * NOISE);
  g_assert_cmpfloat (result->measured_shrink.free.value, >, 0.9);
  g_assert_cmpfloat (result->measured_shrink.windows.value, >, 0.9);
  /* over all of the time two force models part more, but not about which way */
  g_assert_cmpfloat (result->predicted_shrink.free.value, >, 0.3);
  g_assert_cmpfloat_with_epsilon (result->predicted_shrink.windows.value,
      result->measured_shrink.windows.value, 0.15);
  g_assert_true (isnan (result->takes_agree_p_value));
  g_assert_true (says (result, "longer than drag"));
}

/* A twin that lacks nothing, whatever the model lacks: no gap, but its noise. */
static void
test_no_gap (void)
{
  g_autoptr (ClothTake) take = record (&filmed, "drag", sway_at, 2., 5);
  g_autoptr (ClothTake) twin = record (&written, "twin", sway_at, 2., 6);
  const ClothGapOptions options = {.simulated = &twin,.n_simulated = 1,.seed = 1
  };
  g_autoptr (ClothGapResult) result = diagnose (&take, 1, &options);
  const ClothGapMeasuredTake *row = &g_array_index (result->takes,
      ClothGapMeasuredTake, 0);

  g_assert_cmpint (result->verdict, ==, CLOTH_GAP_NO_GAP);
  g_assert_cmpfloat_with_epsilon (row->free_before.value, sqrt (3.) * NOISE,
      2e-5);
  g_assert_cmpfloat_with_epsilon (row->gap_before.value,
      row->noise_floor.value, 0.15 * row->noise_floor.value);
}

/* Takes and hold-outs in two motions, with twins of each: all are measured, those that judge decide,
 * and they agree on the one effect. */
static void
test_all_measured (void)
{
  g_autoptr (ClothTake) one = record (&filmed, "one", sway_at, 2., 7);
  g_autoptr (ClothTake) two = record (&filmed, "two", other_at, 2., 8);
  g_autoptr (ClothTake) held = record (&filmed, "held", other_at, 2., 9);
  g_autoptr (ClothTake) sway = record (&written, "sway", sway_at, 0., 10);
  g_autoptr (ClothTake) other = record (&written, "other", other_at, 0., 11);
  g_autoptr (ClothTake) after = record (&written, "after", other_at, 2., 12);
  ClothTake *takes[] = { one, two }, *twins[] = { sway, other, other };
  const ClothGapOptions options = {.hold_outs = &held,.n_hold_outs = 1,
    .simulated = twins,.n_simulated = 3,.after = &after,.n_after = 1,
    .effects = few,.seed = 1
  };
  g_autoptr (ClothGapResult) result = diagnose (takes, 2, &options);
  static const gchar *const names[] = { "one", "two", "held" };

  g_assert_cmpuint (result->takes->len, ==, 3);
  for (guint i = 0; i < 3; i++) {
    const ClothGapMeasuredTake *row = &g_array_index (result->takes,
        ClothGapMeasuredTake, i);

    g_assert_cmpstr (row->name, ==, names[i]);
    g_assert_cmpint (row->role, ==,
        i < 2 ? CLOTH_GAP_TAKE : CLOTH_GAP_HOLD_OUT);
    g_assert_cmpfloat (row->gap_after.value, <, row->gap_before.value);
    g_assert_cmpfloat (row->free_after.value, <, row->free_before.value);
    if (i == 2)
      g_assert_cmpfloat (row->gap_before.value, ==, result->gap_before.value);
  }
  g_assert_true (result->held_out_takes);
  g_assert_cmpfloat (result->measured_shrink.free.value, >, 0.9);
  g_assert_cmpfloat (result->takes_agree_p_value, >, 0.01);
}

/* The same cloth with much drag and with little: no one number explains both. */
static void
test_contradiction (void)
{
  g_autoptr (ClothTake) one = record (&filmed, "one", sway_at, 4., 13);
  g_autoptr (ClothTake) two = record (&filmed, "two", sway_at, 1., 14);
  g_autoptr (ClothTake) sway = record (&written, "sway", sway_at, 0., 15);
  ClothTake *takes[] = { one, two }, *twins[] = { sway, sway };
  const ClothGapOptions options = {.simulated = twins,.n_simulated = 2,
    .effects = few,.seed = 1
  };
  g_autoptr (ClothGapResult) result = diagnose (takes, 2, &options);

  g_assert_cmpint (result->verdict, ==, CLOTH_GAP_UNEXPLAINED);
  g_assert_cmpfloat (result->takes_agree_p_value, <, 0.01);
  g_assert_nonnull (strstr (result->reason, "contradict each other"));
  g_assert_true (says (result, "effects.air_drag.coefficient would be"));
}

/* What acts on the take does not act on what judges, where something else does: with the effect the simulation comes
 * no nearer there, so it is taken back, but where the user's own simulator was run with it. */
static void
test_taken_back (void)
{
  const gdouble drag = 2.;
  g_autoptr (ClothModel) tilted = model_new (CLOTH_FORCE_MASS_SPRING);
  g_autoptr (ClothTake) take = record (&filmed, "drag", sway_at, drag, 16);
  g_autoptr (ClothTake) twin = record (&written, "twin", sway_at, 0., 17);
  g_autoptr (ClothTake) after = record (&written, "after", sway_at, drag, 18);
  g_autoptr (ClothTake) held = NULL;
  ClothTake *twins[] = { twin, twin };
  ClothGapOptions options = {.hold_outs = &held,.n_hold_outs = 1,
    .simulated = twins,.n_simulated = 2,.effects = few,.seed = 1
  };
  g_autoptr (ClothGapResult) result = NULL, measured = NULL;
  const ClothGapEffect *first;

  g_assert_true (cloth_model_set (tilted, "effects.gravity_tilt.x", 3., NULL));
  held = test_gap_record (&filmed, tilted, sway_at, parent, "held", 19);
  result = diagnose (&take, 1, &options);
  first = &g_array_index (result->effects, ClothGapEffect, 0);
  g_assert_cmpstr (first->effect->id, ==, "air_drag");
  g_assert_false (first->accepted);
  g_assert_cmpint (result->verdict, ==, CLOTH_GAP_UNEXPLAINED);
  g_assert_true (says (result, "air_drag, but the simulation with it is not "
          "surely nearer"));
  g_assert_true (isnan (result->gap_after.value));
  g_assert_true (isnan (result->shrink.value));
  g_assert_cmpuint (result->model->effects->len, ==, 0);
  options.after = &after;
  options.n_after = 1;
  measured = diagnose (&take, 1, &options);
  first = &g_array_index (measured->effects, ClothGapEffect, 0);
  g_assert_true (first->accepted);
  g_assert_false (says (measured, "surely nearer"));
  g_assert_false (isnan (measured->measured_shrink.windows.value));
  g_assert_cmpint (measured->verdict, ==, CLOTH_GAP_UNEXPLAINED);
}

/* Without twins the free run is measured, too, of takes and hold-outs. */
static void
test_no_twin (void)
{
  g_autoptr (ClothTake) take = record (&filmed, "take", sway_at, 3., 16);
  g_autoptr (ClothTake) held = record (&filmed, "held", other_at, 3., 17);
  g_autoptr (ClothTake) baseline = record (&filmed, "baseline", sway_at, 0.,
      18);
  const ClothGapOptions options = {.baselines = &baseline,.n_baselines = 1,
    .hold_outs = &held,.n_hold_outs = 1,.effects = few,.seed = 1
  };
  g_autoptr (ClothGapResult) result = diagnose (&take, 1, &options);

  g_assert_false (result->has_simulated);
  g_assert_cmpuint (result->takes->len, ==, 2);
  for (guint i = 0; i < 2; i++) {
    const ClothGapMeasuredTake *row = &g_array_index (result->takes,
        ClothGapMeasuredTake, i);

    g_assert_cmpfloat (row->free_after.value, <, row->free_before.value);
    g_assert_cmpfloat (row->free_floor.value, >, sqrt (3.) * NOISE);
  }
  g_assert_true (isnan (result->predicted_shrink.free.value));
  g_assert_true (isnan (result->measured_shrink.windows.value));
}

/* A step that is too long for the model decides nothing, and a report says why. */
static void
test_diverging (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothTake) take = record (&filmed, "take", sway_at, 0., 19);
  const ClothGapOptions options = {.effects = few };
  g_autoptr (ClothGapResult) result = NULL;

  model->time_step = 5e-3;
  result = cloth_gap_diagnose (&take, 1, model, &options, &error);
  g_assert_no_error (error);
  g_assert_cmpint (result->verdict, ==, CLOTH_GAP_UNDECIDABLE);
  g_test_message ("%s", result->reason);
  g_assert_nonnull (strstr (result->reason, "take: the simulation diverges"));
  g_assert_nonnull (strstr (result->reason, "time_step"));
  g_assert_cmpuint (result->failures->len, >, 0);
}

/* One for each, or none; nothing after without one before. */
static void
test_counts (void)
{
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (ClothTake) take = record (&filmed, "take", sway_at, 0., 20);
  g_autoptr (ClothTake) twin = record (&written, "twin", sway_at, 0., 21);
  g_autoptr (ClothTake) other = record (&written, "other", other_at, 0., 22);
  ClothTake *two[] = { twin, other };
  const ClothGapOptions options[] = {
    {.simulated = two,.n_simulated = 2},
    {.simulated = two,.n_simulated = 1,.after = two,.n_after = 2},
    {.after = two,.n_after = 1},
    {.simulated = two + 1,.n_simulated = 1},
    {.simulated = two,.n_simulated = 1,.after = two + 1,.n_after = 1},
  };
  static const gchar *const says[] = {
    "2 simulations for 1", "2 simulations with the effect added for 1",
    "without those before", "recorded path", "recorded path"
  };

  for (guint i = 0; i < G_N_ELEMENTS (options); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_gap_diagnose (&take, 1, model, &options[i], &error));
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
    g_test_message ("%s", error->message);
    g_assert_nonnull (strstr (error->message, says[i]));
  }
}

int
main (int argc, char **argv)
{
  int status;

  g_test_init (&argc, &argv, NULL);
  parent = g_dir_make_tmp ("cloth-gaptwin-XXXXXX", NULL);
  g_test_add_func ("/gap/twin/counts", test_counts);
  g_test_add_func ("/gap/twin/diverging", test_diverging);
  g_test_add_func ("/gap/twin/named", test_named);
  g_test_add_func ("/gap/twin/no-gap", test_no_gap);
  g_test_add_func ("/gap/twin/contradiction", test_contradiction);
  g_test_add_func ("/gap/twin/all-measured", test_all_measured);
  g_test_add_func ("/gap/twin/taken-back", test_taken_back);
  g_test_add_func ("/gap/twin/no-twin", test_no_twin);
  status = g_test_run ();
  test_gap_remove (parent);
  g_free (parent);
  return status;
}
