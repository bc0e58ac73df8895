/* Vertices between features: the truth is a picture in closed form.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/math/random.h"
#include "gst/vision/track/vertices.h"

#define COLUMNS 13
#define ROWS 11
#define N (COLUMNS * ROWS)
#define WIDTH 0.6
#define HEIGHT 0.5
#define N_FEATURES 900

/* Where a picture shows a place of the cloth: seen obliquely, bent by @bend, @mirrored. */
static void
show (const gdouble uv[2], gdouble bend, gboolean mirrored, gdouble px[2])
{
  px[0] = 100. + 500. * uv[0] + 120. * uv[1] + bend * uv[0] * uv[0];
  px[1] = 50. + 40. * uv[0] + 400. * uv[1] + bend * uv[0] * uv[1];
  if (mirrored)
    px[0] = 640. - px[0];
}

typedef struct
{
  gdouble uv[2 * N_FEATURES], px[2 * N_FEATURES];
} Scene;

static void
make (Scene * s, gdouble noise, gdouble bend, gboolean mirrored)
{
  ClothRandom random;

  cloth_random_init (&random, 5);
  for (guint i = 0; i < N_FEATURES; i++) {
    s->uv[2 * i] = WIDTH * cloth_random_uniform (&random);
    s->uv[2 * i + 1] = HEIGHT * cloth_random_uniform (&random);
    show (s->uv + 2 * i, bend, mirrored, s->px + 2 * i);
    for (guint k = 0; k < 2; k++)
      s->px[2 * i + k] += noise * cloth_random_gaussian (&random);
  }
}

/* How many vertices were placed, and their mean squares: of the errors, and of these over the variances. */
static guint
judge (const Scene * s, gdouble bend, gboolean mirrored, gdouble * off,
    gdouble * chi)
{
  const ClothVerticesParams params = cloth_vertices_default_params ();
  g_autoptr (ClothVertices) vertices = cloth_vertices_new (COLUMNS, ROWS,
      WIDTH, HEIGHT);
  ClothGridVertex grid[N];
  const guint n = cloth_vertices_run (vertices, &params, N_FEATURES, s->uv,
      s->px, grid);
  guint seen = 0;

  *off = *chi = 0.;
  for (guint v = 0; v < N; v++) {
    const gdouble uv[2] = { WIDTH * (v % COLUMNS) / (COLUMNS - 1),
      HEIGHT * (v / COLUMNS) / (ROWS - 1)
    };
    gdouble px[2], square;

    if (grid[v].state == CLOTH_GRID_UNSEEN) {
      g_assert_true (isnan (grid[v].x));
      continue;
    }
    g_assert_cmpint (grid[v].mirrored, ==, mirrored);
    show (uv, bend, mirrored, px);
    square = pow (grid[v].x - px[0], 2.) + pow (grid[v].y - px[1], 2.);
    *off += square;
    *chi += square / (grid[v].xx + grid[v].yy);
    seen++;
  }
  g_assert_cmpuint (seen, ==, n);
  *off /= MAX (n, 1);
  *chi /= MAX (n, 1);
  return n;
}

/* Without noise and bend vertices are exact; all but those on the rim have features about them. */
static void
test_exact (void)
{
  for (guint mirrored = 0; mirrored < 2; mirrored++) {
    Scene s;
    gdouble off, chi;

    make (&s, 0., 0., mirrored);
    g_assert_cmpuint (judge (&s, 0., mirrored, &off, &chi), >=,
        (COLUMNS - 2) * (ROWS - 2));
    g_assert_cmpfloat (off, <, 1e-18);
  }
}

/* What is said of the errors holds, of noise and of bends. */
static void
test_errors (void)
{
  const gdouble noises[] = { 0.3, 0.05 }, bends[] = { 0., 2000. };

  for (guint i = 0; i < 2; i++) {
    Scene s;
    gdouble off, chi;

    make (&s, noises[i], bends[i], FALSE);
    judge (&s, bends[i], FALSE, &off, &chi);
    g_test_message ("%.3f px, %.2f of what is said", sqrt (off), sqrt (chi));
    g_assert_cmpfloat (sqrt (chi), >, 0.2);
    g_assert_cmpfloat (sqrt (chi), <, 1.1);
  }
}

/* A feature that is elsewhere turns its triangles over: the vertices about it are left out, or unsure. */
static void
test_wrong_features (void)
{
  Scene s;
  gdouble off, chi;

  make (&s, 0.3, 0., FALSE);
  for (guint i = 0; i < N_FEATURES; i += 30)
    s.px[2 * i] += 90.;
  judge (&s, 0., FALSE, &off, &chi);
  g_test_message ("%.2f of what is said", sqrt (chi));
  g_assert_cmpfloat (sqrt (chi), <, 1.5);
}

/* Features that are too few or too far apart place nothing; so do those that are all on one line. */
static void
test_too_few (void)
{
  const ClothVerticesParams params = cloth_vertices_default_params ();
  g_autoptr (ClothVertices) vertices = cloth_vertices_new (COLUMNS, ROWS,
      WIDTH, HEIGHT);
  const gdouble far[] = { 0., 0., 0.6, 0., 0.6, 0.5, 0., 0.5 };
  const gdouble line[] = { 0.1, 0.1, 0.12, 0.12, 0.14, 0.14, 0.16, 0.16 };
  const gdouble same[] = { 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1 };
  ClothGridVertex grid[N];

  g_assert_cmpuint (cloth_vertices_run (vertices, &params, 0, NULL, NULL,
          grid), ==, 0);
  g_assert_cmpuint (cloth_vertices_run (vertices, &params, 2, far, far, grid),
      ==, 0);
  g_assert_cmpuint (cloth_vertices_run (vertices, &params, 4, far, far, grid),
      ==, 0);
  g_assert_cmpuint (cloth_vertices_run (vertices, &params, 4, line, line,
          grid), ==, 0);
  g_assert_cmpuint (cloth_vertices_run (vertices, &params, 4, same, same,
          grid), ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/vertices/exact", test_exact);
  g_test_add_func ("/vertices/errors", test_errors);
  g_test_add_func ("/vertices/wrong-features", test_wrong_features);
  g_test_add_func ("/vertices/too-few", test_too_few);
  return g_test_run ();
}
