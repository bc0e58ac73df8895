/* Labels of dots, against the array that a made-up picture was laid out from.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gio/gio.h>
#include <math.h>

#include "gst/math/random.h"
#include "gst/pattern/marray.h"
#include "gst/vision/label/dot-label.h"

#define N (ROWS * COLUMNS)
#define COLUMNS 24
#define ROWS 20
#define COLOURS 5

static guint8 matrix[N], other[N];

#define PITCH 20.0

/* Of the dots, in pitches. */
static gdouble diameter = 0.65;

/* A picture of the array. */
typedef struct
{
  guint n;
  ClothDot dots[2 * N];
  gint labels[2 * N];           /* row·COLUMNS + column; -1: no dot of the array */
  gfloat likelihoods[2 * N * COLOURS];
} Scene;

typedef struct
{
  gint right, wrong;
  gint of;                      /* that are dots of the array */
} Count;

/* Where dots of a part of the array lie: @map takes (column, row) to x and y. */
static void
add_part (Scene * scene, gint first, gint last, const gdouble map[4], gdouble x,
    gdouble y, gdouble noise, ClothRandom * random)
{
  const gdouble r = diameter / 4;

  for (gint k = 0; k < N; k++) {
    const gint column = k % COLUMNS, row = k / COLUMNS;
    ClothDot *dot = &scene->dots[scene->n];

    if (column < first || column >= last)
      continue;
    dot->x = (gfloat) (x + map[0] * column + map[1] * row
        + noise * cloth_random_gaussian (random));
    dot->y = (gfloat) (y + map[2] * column + map[3] * row
        + noise * cloth_random_gaussian (random));
    dot->shape[0] =
        (gfloat) (r * r * (map[0] * map[0] + map[1] * map[1]) + 0.4);
    dot->shape[1] = (gfloat) (r * r * (map[0] * map[2] + map[1] * map[3]));
    dot->shape[2] =
        (gfloat) (r * r * (map[2] * map[2] + map[3] * map[3]) + 0.4);
    scene->labels[scene->n++] = k;
  }
}

/* Likelihoods of the dots' colours in @from, @errors of them of another. */
static void
colour (Scene * scene, const guint8 * from, gdouble errors,
    ClothRandom * random)
{
  for (guint i = 0; i < scene->n; i++) {
    guint is = scene->labels[i] >= 0 ? from[scene->labels[i]]
        : cloth_random_below (random, COLOURS);

    if (cloth_random_uniform (random) < errors)
      is = (is + 1 + cloth_random_below (random, COLOURS - 1)) % COLOURS;
    for (guint c = 0; c < COLOURS; c++)
      scene->likelihoods[i * COLOURS + c] = c == is ? 0 : -6;
  }
}

static Scene *
make_scene (const gdouble map[4], gdouble noise, gdouble errors,
    ClothRandom * random)
{
  Scene *scene = g_new0 (Scene, 1);

  add_part (scene, 0, COLUMNS, map, 500, 500, noise, random);
  colour (scene, matrix, errors, random);
  return scene;
}

static Count
count_with (ClothDotLabeller * labeller, const ClothDotLabelParams * params,
    const Scene * scene)
{
  gint uses[N] = { 0 };
  Count count = { 0 };
  const ClothDotLabel *labels;
  guint n;

  cloth_dot_labeller_run (labeller, params, scene->dots, scene->n,
      scene->likelihoods);
  labels = cloth_dot_labeller_get_labels (labeller, &n);
  g_assert_cmpuint (n, ==, scene->n);
  for (guint i = 0; i < n; i++) {
    count.of += scene->labels[i] >= 0;
    if (labels[i].column < 0) {
      g_assert_cmpint (labels[i].row, ==, -1);
      g_assert_cmpuint (labels[i].patch, ==, G_MAXUINT);
      continue;
    }
    g_assert_cmpint (labels[i].column, <, COLUMNS);
    g_assert_cmpint (labels[i].row, <, ROWS);
    /* No label twice. */
    g_assert_cmpint (uses[labels[i].row * COLUMNS + labels[i].column]++, ==, 0);
    if (labels[i].row * COLUMNS + labels[i].column == scene->labels[i])
      count.right++;
    else
      count.wrong++;
  }
  g_test_message ("%d right, %d wrong of %d", count.right, count.wrong,
      count.of);
  return count;
}

static Count
count_labels (ClothDotLabeller * labeller, const Scene * scene)
{
  const ClothDotLabelParams params = cloth_dot_label_default_params ();

  return count_with (labeller, &params, scene);
}

static ClothDotLabeller *
new_labeller (const guint8 * array)
{
  GError *error = NULL;
  ClothDotLabeller *labeller =
      cloth_dot_labeller_new (COLUMNS, ROWS, COLOURS, array, &error);

  g_assert_no_error (error);
  return labeller;
}

static const gdouble plain[4] = { PITCH, 1, -1, PITCH };

/* Takes @share of the dots away. */
static void
leave_out (Scene * scene, gdouble share, ClothRandom * random)
{
  guint n = 0;

  for (guint i = 0; i < scene->n; i++) {
    if (cloth_random_uniform (random) < share)
      continue;
    scene->dots[n] = scene->dots[i];
    scene->labels[n++] = scene->labels[i];
  }
  scene->n = n;
}

static void
test_views (void)
{
  static const gdouble maps[][4] = {
    {20, 0, 0, 20}, {0, -20, 20, 0}, {14, -14, 14, 14},
    {-20, 0, 0, 20}, {0, 20, 20, 0}, {7, 0, 0, 20}, {10, -12, 8, 18},
    {20, 12, 0, 8}
  };
  const ClothDotLabelParams defaults = cloth_dot_label_default_params ();

  for (guint k = 0; k < 2 * G_N_ELEMENTS (maps); k++) {
    const gdouble *map = maps[k / 2];
    g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
    ClothDotLabelParams params = defaults;
    ClothRandom random;
    g_autofree Scene *scene = NULL;
    const ClothDotLabel *labels;
    Count count;
    guint n;

    params.paper = k & 1;
    /* There u is not among the three nearest neighbours that the paper goes by. */
    if (params.paper && k / 2 == G_N_ELEMENTS (maps) - 1)
      continue;
    cloth_random_init (&random, k);
    scene = make_scene (map, 0.2, 0, &random);
    count = count_with (labeller, &params, scene);
    g_assert_cmpint (count.wrong, ==, 0);
    g_assert_cmpint (count.right, ==, N);
    labels = cloth_dot_labeller_get_labels (labeller, &n);
    for (guint i = 0; i < n; i++)
      if (labels[i].column >= 0)
        g_assert_cmpint (labels[i].mirrored, ==,
            map[0] * map[3] - map[1] * map[2] < 0);
  }
}

/* Other prints have smaller or larger dots. */
static void
test_diameters (void)
{
  static const gdouble diameters[] = { 0.45, 0.55, 0.75, 0.9 };

  for (guint k = 0; k < G_N_ELEMENTS (diameters); k++) {
    static const gdouble oblique[4] = { 9, 3, -1, 24 };
    g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
    g_autofree Scene *scene = NULL;
    ClothRandom random;

    diameter = diameters[k];
    cloth_random_init (&random, k);
    scene = make_scene (oblique, 0.2, 0, &random);
    g_assert_cmpint (count_labels (labeller, scene).right, ==, N);
  }
  diameter = 0.65;
}

/* Places that are off by a twentieth of the pitch, of colours that are often wrong, of
 * dots that are missing and others that are none. */
static void
test_hard_pictures (void)
{
  static const struct
  {
    gdouble noise, errors, missing;
    guint n_false;
    gdouble least;              /* share of the dots that must be labelled */
  } cases[] = {
    {1, 0, 0, 0, 0.98}, {0.3, 0.1, 0, 0, 0.95}, {0.3, 0.3, 0, 0, 0.8},
    {0.3, 0, 0.1, 0, 0.95}, {0.3, 0, 0, 80, 0.9}, {0.5, 0.1, 0.1, 40, 0.75}
  };

  for (guint k = 0; k < G_N_ELEMENTS (cases); k++) {
    g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
    g_autofree Scene *scene = NULL;
    ClothRandom random;
    Count count = { 0 };

    cloth_random_init (&random, k);
    /* How often colours are wrong is learnt from the first pictures. */
    for (gint round = 0; round < 12; round++) {
      g_free (scene);
      scene = make_scene (plain, cases[k].noise, 0, &random);
      leave_out (scene, cases[k].missing, &random);
      for (guint i = 0; i < cases[k].n_false; i++) {
        scene->dots[scene->n] = scene->dots[0];
        scene->dots[scene->n].x =
            (gfloat) (500 + PITCH * COLUMNS * cloth_random_uniform (&random));
        scene->dots[scene->n].y =
            (gfloat) (500 + PITCH * ROWS * cloth_random_uniform (&random));
        scene->labels[scene->n++] = -1;
      }
      colour (scene, matrix, cases[k].errors, &random);
      count = count_labels (labeller, scene);
      g_assert_cmpint (200 * count.wrong, <=, count.right + count.wrong);
    }
    g_assert_cmpfloat (count.right, >=, cases[k].least * count.of);
  }
}

/* A fold: the left columns lie over others, turned and seen from behind. */
static void
test_fold (void)
{
  static const gdouble folded[4] = { -15, 4, 4, 19 };
  g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
  g_autofree Scene *scene = g_new0 (Scene, 1);
  ClothRandom random;
  Count count;

  cloth_random_init (&random, 1);
  add_part (scene, 10, COLUMNS, plain, 500, 500, 0.2, &random);
  add_part (scene, 0, 10, folded, 500 + 10 * PITCH - 8, 490, 0.2, &random);
  colour (scene, matrix, 0, &random);
  count = count_labels (labeller, scene);
  g_assert_cmpint (count.wrong, <=, 2);
  g_assert_cmpfloat (count.right, >=, 0.95 * N);
}

/* Two times the same cloth in one picture: each label once all the same. */
static void
test_twice (void)
{
  g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
  g_autofree Scene *scene = g_new0 (Scene, 1);
  ClothRandom random;
  Count count;

  cloth_random_init (&random, 1);
  add_part (scene, 0, COLUMNS, plain, 500, 500, 0.2, &random);
  add_part (scene, 0, COLUMNS, plain, 1500, 500, 0.2, &random);
  colour (scene, matrix, 0, &random);
  count = count_labels (labeller, scene);
  g_assert_cmpint (count.wrong, ==, 0);
  g_assert_cmpint (count.right, <=, N);
}

/* Six dots are too few to say where they lie, but not where they were before; nor do
 * former labels help dots of other colours. */
static void
test_through_time (void)
{
  g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
  g_autofree Scene *scene = NULL, *few = g_new0 (Scene, 1);
  ClothRandom random;

  cloth_random_init (&random, 1);
  scene = make_scene (plain, 0.2, 0, &random);
  for (guint i = 0; i < N; i++) {
    if (i / COLUMNS >= 8 && i / COLUMNS < 10 && i % COLUMNS >= 5
        && i % COLUMNS < 8) {
      few->dots[few->n] = scene->dots[i];
      few->labels[few->n++] = (gint) i;
    }
  }
  colour (few, matrix, 0, &random);
  g_assert_cmpint (count_labels (labeller, few).right, ==, 0);
  g_assert_cmpint (count_labels (labeller, scene).right, ==, N);
  g_assert_cmpint (count_labels (labeller, few).right, ==, 6);
  cloth_dot_labeller_reset (labeller);
  g_assert_cmpint (count_labels (labeller, few).right, ==, 0);
  g_assert_cmpint (count_labels (labeller, scene).right, ==, N);
  colour (few, other, 0, &random);
  g_assert_cmpint (count_labels (labeller, few).right, ==, 0);
}

/* Same input, same labels. */
static void
test_repeatable (void)
{
  ClothDotLabel *first = NULL;

  for (gint round = 0; round < 2; round++) {
    g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
    g_autofree Scene *scene = NULL;
    const ClothDotLabel *labels;
    ClothRandom random;
    guint n;

    cloth_random_init (&random, 1);
    scene = make_scene (plain, 0.5, 0.2, &random);
    count_labels (labeller, scene);
    labels = cloth_dot_labeller_get_labels (labeller, &n);
    if (first)
      g_assert_cmpmem (labels, n * sizeof *labels, first, n * sizeof *first);
    else
      first = g_memdup2 (labels, n * sizeof *labels);
  }
  g_free (first);
}

/* --- what must not get labels -------------------------------------------------------- */

static void
test_wrong_pattern (void)
{
  for (gint paper = 0; paper < 2; paper++) {
    g_autoptr (ClothDotLabeller) labeller = new_labeller (other);
    ClothDotLabelParams params = cloth_dot_label_default_params ();
    g_autofree Scene *scene = NULL;
    ClothRandom random;
    Count count;

    params.paper = paper;
    cloth_random_init (&random, 1);
    scene = make_scene (plain, 0.2, 0, &random);
    count = count_with (labeller, &params, scene);
    g_assert_cmpint (count.right + count.wrong, ==, 0);
  }
}

/* Two colours in the wrong order: no labels, or right ones and the swap is told. */
static void
test_swapped_colours (void)
{
  gint a, b, n_told = 0;

  for (gint first = 0; first < COLOURS; first++) {
    for (gint second = first + 1; second < COLOURS; second++) {
      g_autoptr (ClothDotLabeller) labeller = NULL;
      g_autofree Scene *scene = NULL;
      guint8 swapped[N];
      ClothRandom random;
      Count count = { 0 };

      for (gint k = 0; k < N; k++)
        swapped[k] = (guint8) (matrix[k] == first ? second
            : matrix[k] == second ? first : matrix[k]);
      labeller = new_labeller (swapped);
      cloth_random_init (&random, 1);
      scene = make_scene (plain, 0.2, 0, &random);
      for (gint round = 0; round < 5; round++)
        count = count_labels (labeller, scene);
      g_assert_cmpint (count.wrong, ==, 0);
      if (count.right > N / 10) {
        g_assert_true (cloth_dot_labeller_find_swap (labeller, &a, &b));
        g_assert_cmpint (a, ==, first);
        g_assert_cmpint (b, ==, second);
        n_told++;
      }
    }
  }
  g_test_message ("%d of 10 told", n_told);
}

static void
test_no_swap (void)
{
  g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
  g_autofree Scene *scene = NULL;
  ClothRandom random;
  gint a, b;

  g_assert_false (cloth_dot_labeller_find_swap (labeller, &a, &b));
  cloth_random_init (&random, 1);
  scene = make_scene (plain, 0.2, 0.3, &random);
  g_assert_cmpint (count_labels (labeller, scene).right, >, 0);
  g_assert_false (cloth_dot_labeller_find_swap (labeller, &a, &b));
}

/* From behind, where that is ruled out. */
static void
test_one_sided (void)
{
  static const gdouble behind[4] = { -PITCH, 0, 0, PITCH };
  ClothDotLabelParams params = cloth_dot_label_default_params ();

  params.mirrored = FALSE;
  for (params.paper = FALSE; params.paper < 2; params.paper++) {
    g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
    g_autofree Scene *scene = NULL;
    ClothRandom random;
    Count count;

    cloth_random_init (&random, 1);
    scene = make_scene (behind, 0.2, 0, &random);
    count = count_with (labeller, &params, scene);
    g_assert_cmpint (count.right + count.wrong, ==, 0);
  }
}

/* Dots in no order, of random colours; one line of dots; the same place again and again;
 * none at all. */
static void
test_no_lattice (void)
{
  g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
  g_autofree Scene *scene = NULL;
  ClothRandom random;
  Count count;

  cloth_random_init (&random, 1);
  scene = make_scene (plain, 0, 0, &random);
  for (gint k = 0; k < N; k++) {
    scene->dots[k].x = (gfloat) (1000 * cloth_random_uniform (&random));
    scene->dots[k].y = (gfloat) (1000 * cloth_random_uniform (&random));
    scene->labels[k] = -1;
  }
  colour (scene, matrix, 0, &random);
  count = count_labels (labeller, scene);
  g_assert_cmpint (count.wrong, ==, 0);
  for (gint k = 0; k < N; k++) {
    scene->dots[k].x = 10;
    scene->dots[k].y = 10;
  }
  count = count_labels (labeller, scene);
  g_assert_cmpint (count.wrong, ==, 0);
  for (gint k = 0; k < N; k++)
    scene->dots[k].x = (gfloat) (PITCH * k);
  count = count_labels (labeller, scene);
  g_assert_cmpint (count.wrong, ==, 0);
  scene->n = 0;
  count_labels (labeller, scene);
}

/* What is no number, or too large, harms neither itself nor the others. */
static void
test_no_numbers (void)
{
  static const gfloat bad[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 0 };

  for (gint paper = 0; paper < 2; paper++) {
    g_autoptr (ClothDotLabeller) labeller = new_labeller (matrix);
    ClothDotLabelParams params = cloth_dot_label_default_params ();
    g_autofree Scene *scene = NULL;
    ClothRandom random;
    Count count;

    params.paper = paper;
    cloth_random_init (&random, 1);
    scene = make_scene (plain, 0.2, 0, &random);
    for (guint k = 0; k < G_N_ELEMENTS (bad); k++) {
      scene->dots[4 * k].x = bad[k];
      scene->dots[4 * k + 100].y = bad[k];
      scene->dots[4 * k + 200].shape[k % 3] = bad[k];
      scene->likelihoods[(4 * k + 300) * COLOURS] = bad[k];
      for (guint c = 0; c < COLOURS; c++)
        scene->likelihoods[(4 * k + 400) * COLOURS + c] = bad[k];
    }
    count = count_with (labeller, &params, scene);
    g_assert_cmpint (count.wrong, ==, 0);
    g_assert_cmpint (count.right, >, N / 2);
    params.c = params.colour_error = params.lead = NAN;
    count_with (labeller, &params, scene);
    params.c = params.colour_error = params.lead = -1;
    params.least_region = 0;
    count_with (labeller, &params, scene);
  }
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
  g_test_add_func ("/dotlabel/views", test_views);
  g_test_add_func ("/dotlabel/diameters", test_diameters);
  g_test_add_func ("/dotlabel/hard-pictures", test_hard_pictures);
  g_test_add_func ("/dotlabel/fold", test_fold);
  g_test_add_func ("/dotlabel/twice", test_twice);
  g_test_add_func ("/dotlabel/through-time", test_through_time);
  g_test_add_func ("/dotlabel/repeatable", test_repeatable);
  g_test_add_func ("/dotlabel/swapped-colours", test_swapped_colours);
  g_test_add_func ("/dotlabel/no-swap", test_no_swap);
  g_test_add_func ("/dotlabel/one-sided", test_one_sided);
  g_test_add_func ("/dotlabel/no-lattice", test_no_lattice);
  g_test_add_func ("/dotlabel/no-numbers", test_no_numbers);
  g_test_add_func ("/dotlabel/wrong-pattern", test_wrong_pattern);
  g_test_add_func ("/dotlabel/bad-arrays", test_bad_arrays);
  return g_test_run ();
}
