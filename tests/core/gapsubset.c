/* Which effects help, by gaps and draws made by hand: each effect takes a known share off, with a known spread.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/gap/verdict/subset.h"
#include "gst/math/random.h"

#define N_DRAWS 1000
#define MOST 3

/* Draws of squares that share what varies from window to window, but for the spread of each. */
static guint
choose_spread (const gdouble * squares, const gdouble * spreads, guint n,
    gdouble floor)
{
  const guint n_subsets = 1u << n;
  g_autofree gdouble *draws = g_new (gdouble, n_subsets * N_DRAWS);
  ClothRandom random;

  cloth_random_init (&random, 5);
  for (guint i = 0; i < N_DRAWS; i++) {
    const gdouble shared = 20. * cloth_random_gaussian (&random);

    for (guint s = 0; s < n_subsets; s++)
      draws[s * N_DRAWS + i] = squares[s] + shared +
          spreads[s] * cloth_random_gaussian (&random);
  }
  return cloth_gap_choose_subset (squares, draws, N_DRAWS, n, 0, floor);
}

/* The same, with one spread of all but the last. */
static guint
choose (const gdouble * squares, guint n, gdouble spread, gdouble floor)
{
  const guint n_subsets = 1u << n;
  gdouble spreads[1 << MOST] = { 0. };

  for (guint s = 0; s + 1 < n_subsets; s++)
    spreads[s] = spread;
  return choose_spread (squares, spreads, n, floor);
}

/* A gain of 30 with a standard deviation of 10 is surely one: 1.645 × 10 < 30. One of 15 is not. What all
 * windows share (20) doesn't matter. */
static void
test_one (void)
{
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 70.}, 1, 10., 1.), ==, 1);
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 85.}, 1, 10., 1.), ==, 0);
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 130.}, 1, 10., 1.), ==, 0);
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 100.}, 1, 0., 1.), ==, 0);
}

/* Where no more than the floor is left with it and without it nobody can tell, so that it stays; but it goes where it
 * takes what was at the floor above it. */
static void
test_floor (void)
{
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 85.}, 1, 10., 89.), ==, 0);
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 85.}, 1, 10., 91.), ==, 1);
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 300.}, 1, 10., 91.), ==, 0);
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 300.}, 1, 10., 271.), ==, 1);
  g_assert_cmpuint (choose ((gdouble[]) {
          100., 85.}, 1, 10., NAN), ==, 1);
  g_assert_cmpuint (choose ((gdouble[]) {
          NAN, 85.}, 1, 10., 1.), ==, 1);
}

/* Of two the idle one goes, and the other stays; both when each does its part. */
static void
test_two (void)
{
  const gdouble both[] = { 100., 60., 70., 20. };
  const gdouble second_idle[] = { 100., 22., 99., 20. };
  const gdouble none[] = { 100., 98., 99., 101. };

  g_assert_cmpuint (choose (both, 2, 10., 1.), ==, 3);
  g_assert_cmpuint (choose (second_idle, 2, 10., 1.), ==, 1);
  g_assert_cmpuint (choose (none, 2, 10., 1.), ==, 0);
}

/* Of three, two of which do the same, one of these goes, the one that is missed less, though neither is missed
 * while the other is there. */
static void
test_same (void)
{
  const gdouble squares[] = { 100., 60., 64., 58., 70., 32., 30., 29. };

  g_assert_cmpuint (choose (squares, MOST, 4., 1.), ==, 6);
}

/* The first goes because of the second, which goes, too, as it varies: then the first comes back. */
static void
test_back (void)
{
  const gdouble squares[] = { 100., 70., 70., 60., 28., 21., 20.5, 20.6 };
  const gdouble spreads[] = { 1., 1., 1., 1., 0.5, 0.5, 10., 0. };

  g_assert_cmpuint (choose_spread (squares, spreads, MOST, 1.), ==, 5);
}

/* What is to be kept stays, though it does not help; another one goes. */
static void
test_kept (void)
{
  const gdouble squares[] = { 100., 98., 99., 101. };
  gdouble draws[4 * N_DRAWS];

  for (guint i = 0; i < 4 * N_DRAWS; i++)
    draws[i] = squares[i / N_DRAWS];
  g_assert_cmpuint (cloth_gap_choose_subset (squares, draws, N_DRAWS, 2, 2,
          1.), ==, 2);
}

/* Nothing was accepted. */
static void
test_nothing (void)
{
  g_assert_cmpuint (choose ((gdouble[]) {
          100.}, 0, 1., 1.), ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gap/subset/one", test_one);
  g_test_add_func ("/gap/subset/floor", test_floor);
  g_test_add_func ("/gap/subset/two", test_two);
  g_test_add_func ("/gap/subset/same", test_same);
  g_test_add_func ("/gap/subset/back", test_back);
  g_test_add_func ("/gap/subset/kept", test_kept);
  g_test_add_func ("/gap/subset/nothing", test_nothing);
  return g_test_run ();
}
