/* Labels of a film's dots in light that the print doesn't allow for.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/random.h"
#include "gst/vision/label/label.h"

#define COLUMNS 24
#define ROWS 20
#define N (COLUMNS * ROWS)
#define COLOURS 5
/* ITU-R BT.709. */
#define KR 0.2126
#define KB 0.0722

/* Gains of red, green and blue. */
static const gdouble white[3] = { 1, 1, 1 };
static const gdouble tinted[3] = { 1.6, 1, 0.7 };

static ClothMArray *
make_array (guint64 seed)
{
  const ClothMArrayCode code = { 1, FALSE, seed };
  g_autoptr (GError) error = NULL;
  ClothMArray *array = cloth_m_array_new (COLUMNS, ROWS, COLOURS, 0.02, 0.012,
      0.02, &code, &error);

  g_assert_no_error (error);
  return array;
}

/* The dots of the whole array, 20 px from each other, each in light of its own. */
static void
film (const ClothMArray * array, const gdouble gains[3], guint64 seed,
    ClothDot * dots)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gint i = 0; i < N; i++) {
    const guint8 *print = array->colours[array->matrix[i]].rgb;
    const gdouble shade = 0.25 + 0.35 * cloth_random_uniform (&random);
    gdouble rgb[3], luma;

    for (gint k = 0; k < 3; k++)
      rgb[k] = shade * gains[k] * print[k];
    luma = KR * rgb[0] + (1 - KR - KB) * rgb[1] + KB * rgb[2];
    dots[i] = (ClothDot) {
      .x = (gfloat) (50 + 20 * (i % COLUMNS)),.y =
          (gfloat) (50 + 20 * (i / COLUMNS)),.cov = { 0.01f, 0, 0.01f },.shape =
          { 10, 0, 10 },.area = 120,.background = 25,.colour = {
        (gfloat) (25 + luma + cloth_random_gaussian (&random)),
        (gfloat) (128 + (rgb[2] - luma) / (2 * (1 - KB))
            + cloth_random_gaussian (&random)),
        (gfloat) (128 + (rgb[0] - luma) / (2 * (1 - KR))
            + cloth_random_gaussian (&random))
      }
    };
  }
}

static ClothFilmLabeller *
make_labeller (const ClothMArray * array)
{
  g_autoptr (GError) error = NULL;
  ClothFilmLabeller *labeller = cloth_film_labeller_new (array, &error);

  g_assert_no_error (error);
  cloth_film_labeller_start_colours (labeller, (gfloat) KR, (gfloat) KB);
  return labeller;
}

/* Labels one more picture. Dot i of film() is dot i of the array: none may be said to be
 * another. */
static guint
run (ClothFilmLabeller * labeller, gboolean learn, const ClothDot * dots)
{
  ClothFilmLabelParams params = cloth_film_label_default_params ();
  const ClothDotLabel *labels;
  guint n, n_labelled;

  g_assert_true (params.learn);
  params.learn = learn;
  n_labelled = cloth_film_labeller_run (labeller, &params, NULL, dots, N);
  labels = cloth_film_labeller_get_labels (labeller, &n);
  g_assert_cmpuint (n, ==, N);
  for (guint i = 0; i < n; i++)
    if (labels[i].column >= 0)
      g_assert_cmpint (labels[i].row * COLUMNS + labels[i].column, ==, i);
  g_test_message ("%u of %d labelled", n_labelled, N);
  return n_labelled;
}

/* Share of the dots whose likeliest colour is theirs. */
static gdouble
share_right (const ClothFilmLabeller * labeller, const ClothMArray * array)
{
  const gfloat *likelihoods = cloth_film_labeller_get_likelihoods (labeller);
  guint n = 0;

  for (guint i = 0; i < N; i++) {
    const gfloat *of = likelihoods + i * COLOURS;
    guint best = 0;

    for (guint c = 1; c < COLOURS; c++)
      if (of[c] > of[best])
        best = c;
    n += best == array->matrix[i];
  }
  return (gdouble) n / N;
}

/* Light that turns colours into each other is found without labels; what is learnt of it
 * stays when another part of the film begins, and goes when the colours start anew. */
static void
test_adapts (void)
{
  static const gdouble lamp[3] = { 0.45, 1, 2.2 };
  g_autoptr (ClothMArray) array = make_array (1);
  g_autoptr (ClothFilmLabeller) labeller = make_labeller (array);
  ClothDot dots[N];

  film (array, lamp, 1, dots);
  g_assert_cmpuint (run (labeller, FALSE, dots), ==, 0);
  g_assert_cmpuint (run (labeller, TRUE, dots), >, N * 9 / 10);
  cloth_film_labeller_reset (labeller);
  g_assert_cmpuint (run (labeller, FALSE, dots), >, N * 9 / 10);
  g_assert_cmpfloat (share_right (labeller, array), >, 0.98);
  cloth_film_labeller_start_colours (labeller, (gfloat) KR, (gfloat) KB);
  cloth_film_labeller_reset (labeller);
  g_assert_cmpuint (run (labeller, FALSE, dots), ==, 0);
}

/* The labels of one picture teach the colours of the next. */
static void
test_learns (void)
{
  g_autoptr (ClothMArray) array = make_array (1);
  g_autoptr (ClothFilmLabeller) learning = make_labeller (array);
  g_autoptr (ClothFilmLabeller) fixed = make_labeller (array);
  gdouble shares[2];
  ClothDot dots[N];

  for (guint64 k = 0; k < 5; k++) {
    film (array, tinted, k, dots);
    run (learning, TRUE, dots);
    run (fixed, FALSE, dots);
  }
  shares[0] = share_right (fixed, array);
  shares[1] = share_right (learning, array);
  g_test_message ("%.1f%% right, %.1f%% when learnt", 100 * shares[0],
      100 * shares[1]);
  g_assert_cmpfloat (shares[0], <, 0.95);
  g_assert_cmpfloat (shares[1], >, 0.99);
}

/* Dots of another print: told once, after a while or at the end of the film. */
static void
test_in_vain (void)
{
  g_autoptr (ClothMArray) array = make_array (1);
  g_autoptr (ClothMArray) other = make_array (2);
  g_autoptr (ClothFilmLabeller) labeller = make_labeller (array);
  ClothFilmLabelParams params = cloth_film_label_default_params ();
  ClothDot dots[N];
  guint n_told = 0;
  gint a, b;

  g_assert_false (cloth_film_labeller_is_in_vain (labeller, TRUE));
  film (other, white, 1, dots);
  /* eight dots are no window */
  cloth_film_labeller_run (labeller, &params, NULL, dots, 8);
  g_assert_false (cloth_film_labeller_is_in_vain (labeller, TRUE));
  for (guint k = 0; k < 30; k++) {
    g_assert_cmpuint (run (labeller, k % 10 == 0, dots), ==, 0);
    g_assert_true (cloth_film_labeller_is_in_vain (labeller, TRUE));
    n_told += cloth_film_labeller_is_in_vain (labeller, FALSE);
  }
  g_assert_cmpuint (n_told, ==, 1);
  g_assert_false (cloth_film_labeller_try_swaps (labeller, &params.label, dots,
          N, &a, &b));
  film (array, white, 1, dots);
  g_assert_cmpuint (run (labeller, TRUE, dots), >, N * 9 / 10);
  g_assert_false (cloth_film_labeller_is_in_vain (labeller, TRUE));
}

/* Two colours in the other order than in print are named. */
static void
test_swap (void)
{
  g_autoptr (ClothMArray) array = make_array (1);
  g_autoptr (ClothMArray) described = make_array (1);
  g_autoptr (ClothFilmLabeller) labeller = NULL;
  const ClothFilmLabelParams params = cloth_film_label_default_params ();
  ClothDot dots[N];
  gint a = -1, b = -1;

  described->colours[1] = array->colours[3];
  described->colours[3] = array->colours[1];
  labeller = make_labeller (described);
  film (array, white, 1, dots);
  g_assert_true (cloth_film_labeller_try_swaps (labeller, &params.label, dots,
          N, &a, &b));
  g_assert_cmpint (a, ==, 1);
  g_assert_cmpint (b, ==, 3);
  /* it was a try: the colours are as described */
  for (guint k = 0; k < 5; k++)
    run (labeller, FALSE, dots);
  g_assert_cmpfloat (share_right (labeller, array), <, 0.8);
}

/* A chart teaches what the film is then labelled by; one of another print teaches nothing
 * and takes nothing away. */
static void
test_chart (void)
{
  g_autoptr (ClothMArray) array = make_array (1);
  g_autoptr (ClothMArray) other = make_array (2);
  g_autoptr (ClothFilmLabeller) labeller = make_labeller (array);
  const ClothDotLabelParams params = cloth_dot_label_default_params ();
  ClothDot dots[N], chart[N];
  g_autofree gfloat *before = NULL;

  film (array, tinted, 1, dots);
  run (labeller, FALSE, dots);
  before = g_memdup2 (cloth_film_labeller_get_likelihoods (labeller),
      N * COLOURS * sizeof (gfloat));
  film (other, tinted, 2, chart);
  g_assert_false (cloth_film_labeller_learn_chart (labeller, &params, chart,
          N));
  g_assert_false (cloth_film_labeller_learn_chart (labeller, &params, chart,
          0));
  run (labeller, FALSE, dots);
  g_assert_cmpmem (before, N * COLOURS * sizeof (gfloat),
      cloth_film_labeller_get_likelihoods (labeller),
      N * COLOURS * sizeof (gfloat));
  g_assert_cmpfloat (share_right (labeller, array), <, 0.95);
  film (array, tinted, 3, chart);
  g_assert_true (cloth_film_labeller_learn_chart (labeller, &params, chart, N));
  g_assert_cmpuint (run (labeller, FALSE, dots), >, N * 9 / 10);
  g_assert_cmpfloat (share_right (labeller, array), >, 0.99);
}

static void
test_refuses (void)
{
  g_autoptr (ClothMArray) array = make_array (1);
  g_autoptr (GError) error = NULL;

  array->columns = 2;
  g_assert_null (cloth_film_labeller_new (array, &error));
  g_assert_nonnull (error);
  array->columns = COLUMNS;
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/filmlabel/adapts", test_adapts);
  g_test_add_func ("/filmlabel/learns", test_learns);
  g_test_add_func ("/filmlabel/in-vain", test_in_vain);
  g_test_add_func ("/filmlabel/swap", test_swap);
  g_test_add_func ("/filmlabel/chart", test_chart);
  g_test_add_func ("/filmlabel/refuses", test_refuses);
  return g_test_run ();
}
