/* Starts of cloth whose true shape is known: bent cloth is freed of noise, wrinkled cloth is left as it
 * was seen.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/fit/recording/start.h"
#include "gst/math/random.h"

#define COLUMNS 12
#define ROWS 10
#define N (COLUMNS * ROWS)
#define SIGMA 5e-3

/* A sheet that is bent, or has wrinkles from vertex to vertex. */
static void
find_shape (guint v, gboolean wrinkled, gdouble place[3])
{
  const gdouble u = (v % COLUMNS) / (COLUMNS - 1.), w = v / COLUMNS / (ROWS -
      1.);

  place[0] = 0.3 * u;
  place[1] = wrinkled ? (v % 2 ? 0.03 : -0.03) : 0.1 * sin (2. * u) * w;
  place[2] = -0.3 * w;
}

static ClothRecording *
record (gboolean wrinkled, gdouble sigma)
{
  ClothRecording *r = g_new0 (ClothRecording, 1);
  ClothRandom random;

  cloth_random_init (&random, 3);
  r->name = g_strdup ("bent");
  r->scene = cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.3f,
          0.3f), 50., 2);
  r->n = N;
  r->n_frames = 2;
  r->times = g_memdup2 (r->scene->times, 2 * sizeof (gdouble));
  r->sigma = sigma;
  r->y = g_new0 (gdouble, 6 * N);
  r->velocity = g_new0 (gdouble, 6 * N);
  r->seen = g_new (gdouble, 2 * N);
  for (guint v = 0; v < 2 * N; v++) {
    find_shape (v % N, wrinkled, r->y + 3 * v);
    r->seen[v] = 1.;
    for (guint k = 0; k < 3; k++) {
      r->y[3 * v + k] += SIGMA * cloth_random_gaussian (&random);
      r->velocity[3 * v + k] = 1. + 0.5 * cloth_random_gaussian (&random);
    }
  }
  return r;
}

/* RMS distance from the truth of what is found in the first frame, by coordinate. */
static gdouble
find_error (const gdouble * positions)
{
  gdouble sum = 0.;

  for (guint v = 0; v < N; v++) {
    gdouble place[3];

    find_shape (v, FALSE, place);
    for (guint k = 0; k < 3; k++)
      sum += pow (positions[3 * v + k] - place[k], 2.);
  }
  return sqrt (sum / (3. * N));
}

/* A surface of m terms keeps √(m/n) of the noise: of degree 4 at most a third of it. */
static void
test_bent (void)
{
  g_autoptr (ClothRecording) r = record (FALSE, SIGMA);
  gdouble positions[3 * N], velocities[3 * N], speed = 0.;

  g_assert_true (cloth_recording_find_start (r, positions, velocities));
  g_assert_cmpfloat (find_error (positions), <, 0.45 * SIGMA);
  for (guint i = 0; i < 3 * N; i++)
    speed += pow (velocities[i] - 1., 2.) / (3. * N);
  g_assert_cmpfloat (sqrt (speed), <, 0.45 * 0.5);
}

/* What was not seen may be anywhere. */
static void
test_hidden (void)
{
  g_autoptr (ClothRecording) r = record (FALSE, SIGMA);
  gdouble positions[3 * N];

  for (guint v = 20; v < 30; v++) {
    r->seen[v] = 0.;
    r->y[3 * v] = 1e3;
  }
  g_assert_true (cloth_recording_find_start (r, positions, NULL));
  g_assert_cmpfloat (find_error (positions), <, 0.6 * SIGMA);
}

static void
test_left (void)
{
  g_autoptr (ClothRecording) wrinkled = record (TRUE, SIGMA);
  g_autoptr (ClothRecording) exact = record (FALSE, 0.);
  g_autoptr (ClothRecording) blind = record (FALSE, SIGMA);
  const ClothRecording *all[] = { wrinkled, exact, blind };

  memset (blind->seen, 0, 2 * N * sizeof (gdouble));
  for (guint i = 0; i < G_N_ELEMENTS (all); i++) {
    gdouble positions[3 * N], velocities[3 * N];

    g_assert_false (cloth_recording_find_start (all[i], positions, velocities));
    g_assert_cmpmem (positions, sizeof positions, all[i]->y, sizeof positions);
    g_assert_cmpmem (velocities, sizeof velocities, all[i]->velocity,
        sizeof velocities);
  }
}

/* In a small hole the surface is known, in a large one it is not: there nothing is made up. */
static void
test_holes (void)
{
  for (guint large = 0; large < 2; large++) {
    g_autoptr (ClothRecording) r = record (FALSE, SIGMA);
    g_autofree gdouble *x = g_new (gdouble, 3 * N);
    guint n_unknown = 0, n_hidden = 0;

    memcpy (x, r->y, 3 * N * sizeof *x);
    for (guint v = 0; v < N; v++) {
      const gboolean hidden = large ? v / COLUMNS >= ROWS / 2 :
          v % COLUMNS / 2 == 2 && v / COLUMNS / 2 == 2;

      r->seen[v] = hidden ? 0. : 1.;
      for (guint k = 0; k < 3 && hidden; k++)
        x[3 * v + k] = NAN;
    }
    g_assert_true (cloth_start_smooth (r->scene->topology, r->seen, SIGMA, x,
            NULL));
    for (guint v = 0; v < N; v++) {
      gdouble place[3], square = 0.;

      n_hidden += r->seen[v] == 0.;
      n_unknown += isnan (x[3 * v]);
      find_shape (v, FALSE, place);
      for (guint k = 0; k < 3; k++)
        square += pow (x[3 * v + k] - place[k], 2.);
      g_assert_true (isnan (square) || square < pow (5. * SIGMA, 2.));
    }
    g_assert_cmpuint (n_unknown, >=, large ? n_hidden / 2 : 0);
    g_assert_cmpuint (n_unknown, <=, large ? n_hidden : 0);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/fit/start/bent", test_bent);
  g_test_add_func ("/fit/start/hidden", test_hidden);
  g_test_add_func ("/fit/start/left", test_left);
  g_test_add_func ("/fit/holes", test_holes);
  return g_test_run ();
}
