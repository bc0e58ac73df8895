/* What faults of a whole recording make of positions, against numbers found by hand.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/take/measurement.h"

#define MOST 12

static void
add (ClothMeasurement * m, const gchar * id, const gdouble * values)
{
  const ClothEffect *effect = cloth_effect_find (id);

  g_assert_nonnull (effect);
  g_assert_cmpint (effect->side, ==, CLOTH_EFFECT_MEASUREMENT);
  cloth_measurement_add_effect (m, effect, values);
}

static void
assert_places (const ClothMeasurement * m, const ClothTopology * t,
    const gdouble * positions, const gdouble * expected)
{
  gdouble recorded[3 * MOST];
  g_autofree gchar *fault = cloth_measurement_find_fault (m, t);

  g_assert_null (fault);
  cloth_measurement_apply (m, t, positions, recorded);
  for (guint i = 0; i < 3 * t->n_vertices; i++)
    g_assert_cmpfloat_with_epsilon (recorded[i], expected[i], 1e-13);
}

/* Two by two vertices; each fault by itself and one on top of the other. */
static void
test_places (void)
{
  g_autoptr (ClothTopology) t = cloth_topology_new_grid (2, 2, 1, 1);
  const gdouble x[12] = { 1., 2., 3., -1., 0., 2., 0.5, 0., 0., 0., 0., 4. };
  const gdouble scaled[12] =
      { 1.5, 3., 4.5, -1.5, 0., 3., 0.75, 0., 0., 0., 0., 6. };
  /* a quarter turn about z, then shifted by (1, 2, 3) */
  const gdouble turned[12] =
      { -1., 3., 6., 1., 1., 5., 1., 2.5, 3., 1., 2., 7. };
  const gdouble both[12] =
      { -2., 3.5, 7.5, 1., 0.5, 6., 1., 2.75, 3., 1., 2., 9. };
  /* recorded as (x, z, −y) */
  const gdouble up[12] = { 1., 3., -2., -1., 2., 0., 0.5, 0., 0., 0., 4., 0. };
  const gdouble factor = 1.5, axes[3] = { 1., 3., -2. };
  const gdouble way[6] = { 0., 0., 45., 0., 0., 0. };
  const gdouble way_on[6] = { 0., 0., 45., 1., 2., 3. };
  ClothMeasurement m;

  cloth_measurement_init (&m);
  assert_places (&m, t, x, x);
  add (&m, "position_scale", &factor);
  assert_places (&m, t, x, scaled);
  cloth_measurement_init (&m);
  add (&m, "misalignment", way);
  add (&m, "misalignment", way_on);
  assert_places (&m, t, x, turned);
  cloth_measurement_init (&m);
  add (&m, "position_scale", &factor);
  add (&m, "misalignment", way);
  add (&m, "misalignment", way_on);
  assert_places (&m, t, x, both);
  cloth_measurement_init (&m);
  add (&m, "axes_exchange", axes);
  assert_places (&m, t, x, up);
  g_assert_false (cloth_measurement_takes_time (&m));
}

/* A label of 3 × 3: which vertex is recorded under it. */
static void
assert_labels (const gdouble values[4], const guint expected[9])
{
  g_autoptr (ClothTopology) t = cloth_topology_new_grid (3, 3, 1, 1);
  g_autofree gint *labels = NULL;
  gdouble x[27], recorded[27];
  ClothMeasurement m;

  for (guint i = 0; i < 27; i++)
    x[i] = 1. / (i + 1.);
  cloth_measurement_init (&m);
  add (&m, "label_exchange", values);
  cloth_measurement_apply (&m, t, x, recorded);
  labels = cloth_measurement_list_labels (&m, t);
  for (guint v = 0; v < 9; v++) {
    g_assert_cmpmem (recorded + 3 * v, 24, x + 3 * expected[v], 24);
    g_assert_cmpint (labels[expected[v]], ==, v);
  }
}

static void
test_labels (void)
{
  const gdouble mirrored[4] = { 1. }, turned[4] = { 0., 1. };
  const gdouble about[4] = { 0., 2. }, three[4] = { 0., 3. };
  const gdouble both[4] = { 1., 1. };
  const guint by_columns[9] = { 2, 1, 0, 5, 4, 3, 8, 7, 6 };
  const guint backwards[9] = { 8, 7, 6, 5, 4, 3, 2, 1, 0 };
  /* the first column, from below, becomes the first row */
  const guint quarter[9] = { 6, 3, 0, 7, 4, 1, 8, 5, 2 };
  const guint other[9] = { 2, 5, 8, 1, 4, 7, 0, 3, 6 };
  const guint diagonal[9] = { 8, 5, 2, 7, 4, 1, 6, 3, 0 };

  assert_labels (mirrored, by_columns);
  assert_labels (about, backwards);
  assert_labels (turned, quarter);
  assert_labels (three, other);
  assert_labels (both, diagonal);
}

/* Labels that are shifted off a flat cloth point to where it would go on. */
static void
test_shift (void)
{
  g_autoptr (ClothTopology) t = cloth_topology_new_grid (4, 3, 1, 1);
  const gdouble values[4] = { 0., 0., -1., 2. };
  const gint expected[12] = { -1, 8, 9, 10, -1, -1, -1, -1, -1, -1, -1, -1 };
  gdouble x[36], shifted[36];
  g_autofree gint *labels = NULL;
  ClothMeasurement m;

  for (guint v = 0; v < 12; v++)
    for (guint k = 0; k < 3; k++) {
      x[3 * v + k] = 0.3 * k + 0.1 * (k + 1) * (v % 4) + 0.7 * (v / 4);
      shifted[3 * v + k] = x[3 * v + k] + 0.1 * (k + 1) - 1.4;
    }
  cloth_measurement_init (&m);
  add (&m, "label_exchange", values);
  assert_places (&m, t, x, shifted);
  labels = cloth_measurement_list_labels (&m, t);
  g_assert_cmpmem (labels, sizeof expected, expected, sizeof expected);
}

/* Clocks one after the other: t → f t + d each. */
static void
test_time (void)
{
  const gdouble factor = 1.25, delay = 0.1, width = 0.03, more = 0.04;
  ClothMeasurement m;

  cloth_measurement_init (&m);
  g_assert_false (cloth_measurement_takes_time (&m));
  add (&m, "recording_delay", &delay);
  g_assert_true (cloth_measurement_takes_time (&m));
  g_assert_cmpfloat (m.delay_s, ==, delay);
  add (&m, "time_scale", &factor);
  g_assert_cmpfloat (m.delay_s, ==, factor * delay);
  g_assert_cmpfloat (m.time_factor, ==, factor);
  add (&m, "smoothing", &width);
  add (&m, "smoothing", &more);
  g_assert_cmpfloat_with_epsilon (m.smoothing_s, 0.05, 1e-15);
}

/* A⁻¹ A = 1 for any matrix that has an inverse. */
static void
test_inverse (void)
{
  ClothRandom random;

  cloth_random_init (&random, 7);
  for (guint i = 0; i < 100; i++) {
    gdouble matrix[9], inverse[9], product;
    const gdouble shift[3] = { 0. };
    ClothMeasurement m;

    for (guint k = 0; k < 9; k++)
      matrix[k] = cloth_random_gaussian (&random) + (k % 4 ? 0. : 3.);
    cloth_measurement_init (&m);
    cloth_measurement_map (&m, matrix, shift);
    cloth_measurement_invert (&m, inverse);
    for (guint k = 0; k < 9; k++) {
      product = 0.;
      for (guint j = 0; j < 3; j++)
        product += inverse[3 * (k / 3) + j] * matrix[3 * j + k % 3];
      g_assert_cmpfloat_with_epsilon (product, k % 4 ? 0. : 1., 1e-10);
    }
  }
}

/* Null values change no bit, and no effect of another side changes anything. */
static void
test_null (void)
{
  guint n;
  const ClothEffect *const *table = cloth_effect_table (&n);
  ClothMeasurement m;

  for (guint i = 0; i < n; i++) {
    gdouble values[CLOTH_EFFECT_MAX_PARAMETERS], most[G_N_ELEMENTS (values)];

    for (guint k = 0; k < table[i]->n_parameters; k++) {
      values[k] = table[i]->parameters[k].null_value;
      most[k] = table[i]->parameters[k].max;
    }
    cloth_measurement_init (&m);
    cloth_measurement_add_effect (&m, table[i], values);
    g_assert_true (cloth_measurement_is_null (&m));
    cloth_measurement_add_effect (&m, table[i], most);
    g_assert_cmpint (cloth_measurement_is_null (&m), !=,
        table[i]->side == CLOTH_EFFECT_MEASUREMENT);
  }
}

static void
test_refused (void)
{
  static const struct
  {
    const gchar *id;
    gdouble values[4];
    const gchar *why;
  } cases[] = {
    {"axes_exchange", {1., 1., 3.}, "each axis once"},
    {"axes_exchange", {1., 2., 0.}, "each axis once"},
    {"axes_exchange", {1., 2.5, 3.}, "each axis once"},
    {"axes_exchange", {-2., 2., 3.}, "each axis once"},
    {"label_exchange", {0.5}, "whole numbers"},
    {"label_exchange", {0., 1.5}, "whole numbers"},
    {"label_exchange", {0., 0., 0.1}, "whole numbers"},
    {"label_exchange", {0., 0., 0., -0.2}, "whole numbers"},
    {"label_exchange", {0., 1.}, "4 columns and 3 rows"},
    {"label_exchange", {1., 3.}, "4 columns and 3 rows"},
    {"label_exchange", {0., 0., 4.}, "off the cloth"},
    {"label_exchange", {0., 0., 0., -3.}, "off the cloth"},
    {"time_scale", {0.}, "doesn't run"},
    {"time_scale", {-1.}, "doesn't run"},
    {"recording_delay", {NAN}, "doesn't run"},
    {"position_scale", {0.}, "fall together"},
    {"position_scale", {NAN}, "fall together"},
  };
  static const gdouble about[4] = { 0., 2. };
  g_autoptr (ClothTopology) grid = cloth_topology_new_grid (4, 3, 1, 1);
  g_autoptr (ClothTopology) other = cloth_topology_copy (grid);
  g_autofree gchar *fault = NULL;
  ClothMeasurement m;

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *text = NULL;

    cloth_measurement_init (&m);
    add (&m, cases[i].id, cases[i].values);
    text = cloth_measurement_find_fault (&m, grid);
    g_assert_nonnull (text);
    g_test_message ("%s", text);
    g_assert_nonnull (strstr (text, cases[i].why));
  }
  other->columns = other->rows = 0;
  cloth_measurement_init (&m);
  add (&m, "label_exchange", about);
  fault = cloth_measurement_find_fault (&m, other);
  g_assert_nonnull (strstr (fault, "no grid"));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/measurement/places", test_places);
  g_test_add_func ("/measurement/labels", test_labels);
  g_test_add_func ("/measurement/shift", test_shift);
  g_test_add_func ("/measurement/time", test_time);
  g_test_add_func ("/measurement/inverse", test_inverse);
  g_test_add_func ("/measurement/null", test_null);
  g_test_add_func ("/measurement/refused", test_refused);
  return g_test_run ();
}
