/* Labels of dots, against the array that a made-up picture was laid out from.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gio/gio.h>
#include <math.h>

#include "gst/math/random.h"
#include "gst/pattern/marray.h"
#include "gst/vision/dotcolour.h"
#include "gst/vision/lattice.h"

#define N (ROWS * COLUMNS)
#define COLUMNS 24
#define ROWS 20
#define COLOURS 5

static guint8 matrix[N], other[N];

/* A picture of the array, dot by dot: dot k of the array is dot k of the picture. */
typedef struct
{
  ClothDot dots[N];
  guint8 colours[N];
  gfloat likelihoods[N * COLOURS];
} Scene;

/* @map takes (column, row) to the picture: x and y each by both, px. */
static Scene *
make_scene (const gdouble map[4], gdouble noise, guint64 seed)
{
  Scene *scene = g_new0 (Scene, 1);
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gint k = 0; k < N; k++) {
    ClothDot *dot = &scene->dots[k];
    const gdouble r = 0.325 / 2;

    dot->x = (gfloat) (500 + map[0] * (k % COLUMNS) + map[1] * (k / COLUMNS)
        + noise * cloth_random_gaussian (&random));
    dot->y = (gfloat) (500 + map[2] * (k % COLUMNS) + map[3] * (k / COLUMNS)
        + noise * cloth_random_gaussian (&random));
    dot->shape[0] = (gfloat) (r * r * (map[0] * map[0] + map[1] * map[1]));
    dot->shape[1] = (gfloat) (r * r * (map[0] * map[2] + map[1] * map[3]));
    dot->shape[2] = (gfloat) (r * r * (map[2] * map[2] + map[3] * map[3]));
    scene->colours[k] = matrix[k];
  }
  return scene;
}

/* Likelihoods that are sure of each colour. */
static void
colour (Scene * scene)
{
  for (gint k = 0; k < N; k++)
    for (gint c = 0; c < COLOURS; c++)
      scene->likelihoods[k * COLOURS + c] = c == scene->colours[k] ? 0 : -6;
}

static void
count (ClothDotLabeller * labeller, const Scene * scene, gint * right,
    gint * wrong)
{
  const ClothDotLabelParams params = cloth_dot_label_default_params ();
  const ClothDotLabel *labels;
  guint n;

  cloth_dot_labeller_run (labeller, &params, scene->dots, N,
      scene->likelihoods);
  labels = cloth_dot_labeller_get_labels (labeller, &n);
  g_assert_cmpuint (n, ==, N);
  *right = *wrong = 0;
  for (gint k = 0; k < N; k++) {
    if (labels[k].column >= 0) {
      const gboolean is_right = labels[k].column == k % COLUMNS
          && labels[k].row == k / COLUMNS;

      *right += is_right;
      *wrong += !is_right;
    }
  }
}

static void
test_views (void)
{
  static const gdouble maps[][4] = {
    {20, 0, 0, 20}, {0, -20, 20, 0}, {-20, 0, 0, 20}, {14, -14, 14, 14},
    {7, 0, 0, 20}, {10, -12, 8, 18}, {20, 12, 0, 8}
  };
  g_autoptr (ClothDotLabeller) labeller =
      cloth_dot_labeller_new (COLUMNS, ROWS, COLOURS, matrix, NULL);

  for (guint k = 0; k < G_N_ELEMENTS (maps); k++) {
    g_autofree Scene *scene = make_scene (maps[k], 0.2, k);
    gint right, wrong;

    colour (scene);
    count (labeller, scene, &right, &wrong);
    g_assert_cmpint (wrong, ==, 0);
    g_assert_cmpint (right, ==, N);
  }
}

static void
test_wrong_pattern (void)
{
  static const gdouble map[4] = { 20, 2, -2, 20 };
  g_autoptr (ClothDotLabeller) labeller =
      cloth_dot_labeller_new (COLUMNS, ROWS, COLOURS, other, NULL);
  g_autofree Scene *scene = make_scene (map, 0.2, 1);
  gint right, wrong;

  colour (scene);
  count (labeller, scene, &right, &wrong);
  g_assert_cmpint (right + wrong, ==, 0);
}

static void
test_bad_arrays (void)
{
  guint8 bad[N] = { 0 };
  GError *error = NULL;

  g_assert_null (cloth_dot_labeller_new (2, ROWS, COLOURS, matrix, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
  g_clear_error (&error);
  g_assert_null (cloth_dot_labeller_new (COLUMNS, 401, COLOURS, matrix,
          &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
  g_clear_error (&error);
  g_assert_null (cloth_dot_labeller_new (COLUMNS, ROWS, 9, matrix, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
  g_clear_error (&error);
  bad[N - 1] = COLOURS;
  g_assert_null (cloth_dot_labeller_new (COLUMNS, ROWS, COLOURS, bad, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT);
  g_clear_error (&error);
}

int
main (int argc, char **argv)
{
  ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;

  g_test_init (&argc, &argv, NULL);
  code.two_sided = TRUE;
  if (!cloth_m_array_generate (COLUMNS, ROWS, COLOURS, &code, matrix, NULL))
    return 1;
  code.seed = 2;
  if (!cloth_m_array_generate (COLUMNS, ROWS, COLOURS, &code, other, NULL))
    return 1;
  g_test_add_func ("/lattice/views", test_views);
  g_test_add_func ("/lattice/wrong-pattern", test_wrong_pattern);
  g_test_add_func ("/lattice/bad-arrays", test_bad_arrays);
  return g_test_run ();
}
