/* The fit of a dear function by mended derivatives, against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/broyden.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"

/* A function of two unknowns, and how often it was asked. */
typedef struct
{
  void (*residual) (const gdouble * x, gdouble * z);
  gdouble most;                 /* beyond it the first has none */
  guint n_calls;
} Dear;

static gboolean
find (gpointer data, const gdouble * x, gdouble * z, GError ** error)
{
  Dear *dear = data;

  dear->n_calls++;
  if (isnan (dear->most) || x[0] > dear->most) {
    g_set_error (error, CLOTH_FIT_ERROR,
        isnan (dear->most) ? CLOTH_FIT_ERROR_RECORDING :
        CLOTH_FIT_ERROR_MODEL, "%g", x[0]);
    return FALSE;
  }
  dear->residual (x, z);
  return TRUE;
}

static const gdouble low[2] = { -10., -10. }, high[2] = { 10., 10. };
static const gdouble loose[2] = { 1e-9, 1e-9 };

static gboolean
run_from (Dear * dear, const gdouble * precisions, const gdouble * guess,
    gdouble longest, guint n_calls, gdouble * x, gdouble * z,
    gdouble * columns, GError ** error)
{
  const ClothBroydenOptions options = {
    2, 3, low, high, precisions, guess, longest, 1e-3, n_calls
  };

  dear->residual (x, z);
  return cloth_broyden_run (find, dear, &options, x, z, columns, error);
}

static gboolean
run (Dear * dear, const gdouble * precisions, gdouble longest, guint n_calls,
    gdouble * x, gdouble * z, gdouble * columns, GError ** error)
{
  return run_from (dear, precisions, NULL, longest, n_calls, x, z, columns,
      error);
}

/* Three data that contradict each other: a line each. */
static void
lines (const gdouble * x, gdouble * z)
{
  z[0] = 2. * x[0] - 1.;
  z[1] = x[0] + x[1] - 4.;
  z[2] = x[1] + 1.;
}

/* They agree on (1.5, −2). */
static void
agree (const gdouble * x, gdouble * z)
{
  z[0] = 2. * x[0] - 3.;
  z[1] = x[0] + x[1] + 0.5;
  z[2] = x[1] + 2.;
}

/* Rosenbrock's valley, to (1, 1). */
static void
valley (const gdouble * x, gdouble * z)
{
  z[0] = 10. * (x[1] - x[0] * x[0]);
  z[1] = 1. - x[0];
  z[2] = 0.;
}

/* What saturates, and is rough: a wave of a tenth of a unit on it. The first is 4. */
static void
rough (const gdouble * x, gdouble * z)
{
  z[0] = 10. * (exp (-0.3 * x[0]) - exp (-1.2)) + 0.1 * sin (40. * x[0]);
  z[1] = 0.1 * sin (70. * x[0]);
  z[2] = x[1];
}

/* With the right derivatives one call leads to the mean of the posterior:
 * (AᵀA + Λ) x = Aᵀb, here [5.5 1; 1 2.5] x = [6; 3]. */
static void
test_linear (void)
{
  g_autoptr (GError) error = NULL;
  const gdouble precisions[2] = { 0.5, 0.5 };
  gdouble x[2] = { 0. }, z[3], columns[6] = { 2., 1., 0., 0., 1., 1. };
  Dear dear = { lines, INFINITY };

  g_assert_true (run (&dear, precisions, 100., 1, x, z, columns, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (dear.n_calls, ==, 1);
  g_assert_cmpfloat_with_epsilon (x[0], (6. * 2.5 - 3.) / 12.75, 1e-12);
  g_assert_cmpfloat_with_epsilon (x[1], (5.5 * 3. - 6.) / 12.75, 1e-12);
  g_assert_cmpfloat_with_epsilon (z[0], 2. * x[0] - 1., 1e-14);
  /* what was right stays */
  g_assert_cmpfloat_with_epsilon (columns[0], 2., 1e-12);
  g_assert_cmpfloat_with_epsilon (columns[4], 1., 1e-12);
}

/* Units that are wrong by 3 and by a tenth, and a sign: mended by a few calls. */
static void
test_wrong_units (void)
{
  static const gdouble factors[][2] = { {3., 0.1}, {0.3, 4.}, {1., 0.2} };

  for (guint i = 0; i < G_N_ELEMENTS (factors); i++) {
    g_autoptr (GError) error = NULL;
    gdouble x[2] = { 0. }, z[3], columns[6] = { 2., 1., 0., 0., 1., 1. };
    Dear dear = { agree, INFINITY };

    for (guint k = 0; k < 6; k++)
      columns[k] *= factors[i][k / 3];
    g_assert_true (run (&dear, loose, 100., 12, x, z, columns, &error));
    g_test_message ("%u calls: %g, %g", dear.n_calls, x[0], x[1]);
    g_assert_cmpuint (dear.n_calls, <=, 12);
    g_assert_cmpfloat_with_epsilon (x[0], 1.5, 0.02);
    g_assert_cmpfloat_with_epsilon (x[1], -2., 0.02);
  }
}

static void
test_valley (void)
{
  g_autoptr (GError) error = NULL;
  gdouble x[2] = { -0.5, 0.5 }, z[3];
  gdouble columns[6] = { 10., -1., 0., 10., 0., 0. };
  Dear dear = { valley, INFINITY };

  g_assert_true (run (&dear, loose, 100., 30, x, z, columns, &error));
  g_test_message ("%u calls: %g, %g", dear.n_calls, x[0], x[1]);
  g_assert_cmpfloat_with_epsilon (x[0], 1., 0.02);
  g_assert_cmpfloat_with_epsilon (x[1], 1., 0.04);
}

/* A guess is the first call, however far; from there the ray from the start is searched, so that
 * what saturates is found although derivatives there are too large. */
static void
test_guess (void)
{
  g_autoptr (GError) error = NULL;
  const gdouble guess[2] = { 2.5, 0. };
  gdouble x[2] = { 0. }, z[3], columns[6] = { -3., 0., 0., 0., 0., 1. };
  Dear dear = { rough, INFINITY };

  g_assert_true (run_from (&dear, loose, guess, 1., 1, x, z, columns, &error));
  g_assert_cmpuint (dear.n_calls, ==, 1);
  g_assert_cmpfloat (x[0], ==, 2.5);
  x[0] = 0.;
  memcpy (columns, (gdouble[]) {
      -3., 0., 0., 0., 0., 1.}, sizeof columns);
  g_assert_true (run_from (&dear, loose, guess, 1., 15, x, z, columns, &error));
  g_test_message ("%u calls: %g, %g", dear.n_calls, x[0], x[1]);
  g_assert_cmpfloat_with_epsilon (x[0], 4., 0.3);
  /* one that makes things worse is not stayed at */
  x[0] = 4.;
  g_assert_true (run_from (&dear, loose, (gdouble[]) {
          -9., 9.}
          , 1., 1, x, z, columns, &error));
  g_assert_cmpfloat (x[0], ==, 4.);
}

/* Not beyond the bounds, nor further than a step may go; the best place is kept. */
static void
test_bounds (void)
{
  g_autoptr (GError) error = NULL;
  gdouble x[2] = { 9.5, 0. }, z[3], columns[6] = { -2., 1., 0., 0., 1., 1. };
  gdouble square;
  Dear dear = { lines, INFINITY };

  /* the sign is wrong: it runs against the bound */
  g_assert_true (run (&dear, loose, 100., 1, x, z, columns, &error));
  g_assert_cmpfloat (x[0], <=, 10.);
  square = z[0] * z[0] + z[1] * z[1] + z[2] * z[2];
  lines (x, z);
  g_assert_cmpfloat_with_epsilon (square, z[0] * z[0] + z[1] * z[1] +
      z[2] * z[2], 1e-12);
  x[0] = x[1] = 0.;
  columns[0] = 2.;
  memcpy (columns + 1, (gdouble[]) {
      1., 0., 0., 1., 1.}, 5 * sizeof (gdouble));
  g_assert_true (run (&dear, loose, 0.25, 1, x, z, columns, &error));
  g_assert_cmpfloat_with_epsilon (x[0], 0.25, 1e-12);
}

/* Places without a residual are gone back from; when all are, it stays where it was; another
 * failure ends it; and what does nothing asks for nothing. */
static void
test_failures (void)
{
  static const gdouble right[6] = { 2., 1., 0., 0., 1., 1. };
  g_autoptr (GError) error = NULL;
  gdouble x[2] = { 0. }, z[3], columns[6];
  Dear dear = { agree, 1. };

  memcpy (columns, right, sizeof columns);
  g_assert_true (run (&dear, loose, 100., 2, x, z, columns, &error));
  g_assert_cmpuint (dear.n_calls, ==, 2);
  g_assert_cmpfloat_with_epsilon (x[0], 0.4 * 1.5, 1e-6);
  g_assert_cmpfloat_with_epsilon (z[2], 2. + x[1], 1e-12);
  dear.most = -1.;
  x[0] = x[1] = 0.;
  g_assert_true (run (&dear, loose, 100., 3, x, z, columns, &error));
  g_assert_no_error (error);
  g_assert_cmpfloat (x[0], ==, 0.);
  g_assert_cmpfloat (x[1], ==, 0.);
  g_assert_cmpfloat (z[0], ==, -3.);
  dear.most = NAN;
  g_assert_false (run (&dear, loose, 100., 3, x, z, columns, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING);
  g_assert_cmpfloat (x[0], ==, 0.);
  g_clear_error (&error);
  dear = (Dear) {
  agree, INFINITY};
  memset (columns, 0, sizeof columns);
  g_assert_true (run (&dear, loose, 100., 5, x, z, columns, &error));
  g_assert_cmpuint (dear.n_calls, ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/broyden/linear", test_linear);
  g_test_add_func ("/broyden/wrong-units", test_wrong_units);
  g_test_add_func ("/broyden/valley", test_valley);
  g_test_add_func ("/broyden/guess", test_guess);
  g_test_add_func ("/broyden/bounds", test_bounds);
  g_test_add_func ("/broyden/failures", test_failures);
  return g_test_run ();
}
