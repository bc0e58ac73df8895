/* Dots on bent cloth: against discs that are integrated numerically; error floors against
 * the noise that was put in.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/rig/dotbend.h"
#include "gst/rig/errorfloor.h"

#define COLUMNS 9
#define ROWS 7
#define N (COLUMNS * ROWS)
#define PITCH 0.02
#define DIAMETER 0.013

/* A sheet rolled to a cylinder of @radius about a slanted axis: no cloth is stretched. */
static void
cylinder (gdouble radius, gdouble u, gdouble v, gdouble X[3])
{
  const gdouble c = cos (0.4), s = sin (0.4);
  const gdouble along = c * u + s * v, across = c * v - s * u;

  X[0] = c * along - s * radius * sin (across / radius);
  X[1] = s * along + c * radius * sin (across / radius);
  X[2] = radius * (1 - cos (across / radius));
}

/* 1.5 m away, @turn about the vertical axis. */
static void
make_camera (ClothCamera * camera, gdouble turn)
{
  const gdouble c = cos (turn), s = sin (turn);
  const gdouble R[9] = { c, 0, s, 0, 1, 0, -s, 0, c };

  memset (camera, 0, sizeof *camera);
  camera->width = camera->height = 1004;
  camera->K[0] = camera->K[4] = 1500;
  camera->K[2] = camera->K[5] = 501.5;
  camera->K[8] = 1;
  memcpy (camera->R, R, sizeof R);
  camera->t[2] = 1.5;
}

/* Centre of gravity of the picture of a dot, from many small pieces of it. */
static void
picture (const ClothCamera * camera, gdouble radius, gint dot, gdouble px[2])
{
  const gint steps = 60;
  const gdouble u0 = (dot % COLUMNS - COLUMNS / 2) * PITCH;
  const gdouble v0 = (dot / COLUMNS - ROWS / 2) * PITCH, r = DIAMETER / 2;
  const gdouble h = 2 * r / steps;
  gdouble sum[2] = { 0 }, area = 0;

  for (gint j = 0; j < steps; j++) {
    for (gint i = 0; i < steps; i++) {
      const gdouble u = -r + h * (i + 0.5), v = -r + h * (j + 0.5);
      gdouble X[3], at[2], right[2], below[2], piece;

      if (u * u + v * v > r * r)
        continue;
      cylinder (radius, u0 + u, v0 + v, X);
      cloth_camera_project (camera, X, at, NULL, NULL);
      cylinder (radius, u0 + u + 1e-6, v0 + v, X);
      cloth_camera_project (camera, X, right, NULL, NULL);
      cylinder (radius, u0 + u, v0 + v + 1e-6, X);
      cloth_camera_project (camera, X, below, NULL, NULL);
      piece = fabs ((right[0] - at[0]) * (below[1] - at[1])
          - (right[1] - at[1]) * (below[0] - at[0]));
      sum[0] += piece * at[0];
      sum[1] += piece * at[1];
      area += piece;
    }
  }
  px[0] = sum[0] / area;
  px[1] = sum[1] / area;
}

/* RMS distance of what is seen from where the centres would be, px, before and after. */
static void
compare (gdouble radius, gdouble turn, const gboolean * known, gdouble rms[2],
    gdouble * doubt)
{
  g_autoptr (ClothDotBend) bend =
      cloth_dot_bend_new (COLUMNS, ROWS, PITCH, DIAMETER);
  gdouble x[N], y[N], xx[N], xy[N] = { 0 }, sum[2] = { 0 };
  gfloat positions[3 * N];
  ClothTriangulateView view = { x, y, xx, xy, xx }, corrected;
  ClothCamera camera;

  make_camera (&camera, turn);
  for (gint i = 0; i < N; i++) {
    gdouble X[3], px[2];

    cylinder (radius, (i % COLUMNS - COLUMNS / 2) * PITCH,
        (i / COLUMNS - ROWS / 2) * PITCH, X);
    for (gint k = 0; k < 3; k++)
      positions[3 * i + k] = known && !known[i] ? NAN : (gfloat) X[k];
    picture (&camera, radius, i, px);
    x[i] = px[0];
    y[i] = px[1];
    xx[i] = 1e-6;
  }
  cloth_dot_bend_set_positions (bend, positions);
  cloth_dot_bend_correct (bend, 3, &camera, &view, &corrected);
  *doubt = 0;
  for (gint i = 0; i < N; i++) {
    gdouble X[3], px[2];

    cylinder (radius, (i % COLUMNS - COLUMNS / 2) * PITCH,
        (i / COLUMNS - ROWS / 2) * PITCH, X);
    cloth_camera_project (&camera, X, px, NULL, NULL);
    sum[0] += pow (x[i] - px[0], 2) + pow (y[i] - px[1], 2);
    sum[1] += pow (corrected.x[i] - px[0], 2)
        + pow (corrected.y[i] - px[1], 2);
    *doubt += corrected.xx[i] + corrected.yy[i] - 2e-6;
  }
  rms[0] = sqrt (sum[0] / N);
  rms[1] = sqrt (sum[1] / N);
  *doubt = sqrt (*doubt / N);
}

static void
test_cylinders (void)
{
  static const gdouble radii[] = { 0.15, 0.3, 0.6 };
  static const gdouble turns[] = { 0.3, -0.5, 0.7 };

  for (guint i = 0; i < G_N_ELEMENTS (radii); i++) {
    for (guint k = 0; k < G_N_ELEMENTS (turns); k++) {
      gdouble rms[2], doubt;

      compare (radii[i], turns[k], NULL, rms, &doubt);
      g_test_message ("radius %g m, turned by %g: %.4f px off, corrected %.4f, "
          "doubt %.4f", radii[i], turns[k], rms[0], rms[1], doubt);
      g_assert_cmpfloat (rms[1], <, 0.35 * rms[0]);
      /* what was taken off is what is doubted */
      g_assert_cmpfloat_with_epsilon (doubt, rms[0], 0.25 * rms[0]);
    }
  }
}

/* A dot alone, or in a row: nothing is known of its bend, nothing is changed. */
static void
test_unknown (void)
{
  gboolean known[N] = { FALSE };
  gdouble rms[2], doubt;

  known[N / 2] = TRUE;
  for (gint i = 0; i < COLUMNS; i++)
    known[i] = TRUE;
  compare (0.2, 0.5, known, rms, &doubt);
  g_assert_cmpfloat (rms[0], ==, rms[1]);
  g_assert_cmpfloat (doubt, ==, 0);
}

static void
test_doubt (void)
{
  g_autoptr (ClothDotBend) bend =
      cloth_dot_bend_new (COLUMNS, ROWS, PITCH, DIAMETER);
  gfloat before[3 * N], after[3 * N], covariances[6 * N] = { 0 };

  for (gint i = 0; i < N; i++) {
    const gdouble v = (i / COLUMNS - ROWS / 2) * PITCH;

    /* a curvature of 20/m about one axis */
    before[3 * i] = after[3 * i] = (gfloat) ((i % COLUMNS) * PITCH);
    before[3 * i + 1] = after[3 * i + 1] = (gfloat) v;
    before[3 * i + 2] = (gfloat) (10 * v * v);
    after[3 * i + 2] = before[3 * i + 2] + 0.0003f;
  }
  after[0] = NAN;
  cloth_dot_bend_set_positions (bend, before);
  cloth_dot_bend_add_doubt (bend, after, covariances);
  for (gint i = 0; i < N; i++) {
    const gint column = i % COLUMNS, row = i / COLUMNS;
    const gboolean inside = column > 0 && row > 0 && column < COLUMNS - 1
        && row < ROWS - 1;
    const gdouble depth = DIAMETER * DIAMETER / 32 * 20;
    const gdouble each = i == 0 ? 0 : inside ? depth * depth : 9e-8;

    g_assert_cmpfloat_with_epsilon (covariances[6 * i], each, 1e-11);
    g_assert_cmpfloat_with_epsilon (covariances[6 * i + 1], 0, 1e-11);
    g_assert_cmpfloat_with_epsilon (covariances[6 * i + 5],
        i == 0 ? 0 : each + 9e-8, 1e-10);
  }
}

/* Four cameras see N points with noise of known size; half of it they state. */
static void
test_error_floor (void)
{
  static const gdouble sigmas[] = { 0.03, 0.1, 0.4 };
  ClothCamera cameras[4];
  ClothRandom random;

  cloth_random_init (&random, 5);
  for (gint c = 0; c < 4; c++)
    make_camera (&cameras[c], -0.6 + 0.4 * c);
  for (guint s = 0; s < G_N_ELEMENTS (sigmas); s++) {
    const gdouble own = 0.02 * 0.02, all = sigmas[s] * sigmas[s];
    g_autoptr (ClothTriangulator) triangulator =
        cloth_triangulator_new (4, cameras, NULL);
    ClothTriangulateParameters parameters =
        CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;
    ClothErrorFloor floor = { 0.01, 0 };
    gdouble mean = 0;

    for (gint set = 0; set < 60; set++) {
      gdouble x[4][N], y[4][N], xx[N], xy[N] = { 0 };
      ClothTriangulateView views[4];
      const ClothTriangulation *result;

      for (gint i = 0; i < N; i++) {
        gdouble X[3], px[2];

        cylinder (0.2, (i % COLUMNS) * PITCH, (i / COLUMNS) * PITCH, X);
        xx[i] = own;
        for (gint c = 0; c < 4; c++) {
          cloth_camera_project (&cameras[c], X, px, NULL, NULL);
          x[c][i] = px[0] + sigmas[s] * cloth_random_gaussian (&random);
          y[c][i] = px[1] + sigmas[s] * cloth_random_gaussian (&random);
        }
      }
      /* a wrong label: it is left out and does not count */
      x[2][7] += 40;
      for (gint c = 0; c < 4; c++)
        views[c] = (ClothTriangulateView) {
        x[c], y[c], xx, xy, xx};
      parameters.error_floor = floor.floor;
      cloth_triangulator_set_parameters (triangulator, &parameters);
      g_assert_true (cloth_triangulator_run (triangulator, 4, views, N, &result,
              NULL));
      cloth_error_floor_add (&floor, 4, views, result);
      if (set >= 30)
        mean += floor.floor / 30;
    }
    g_test_message ("sigma %g px: floor %g px² of %g", sigmas[s], mean,
        all - own);
    /* 60 sets of 315 degrees of freedom: 1% */
    g_assert_cmpfloat_with_epsilon (mean + own, all, 0.06 * all);
  }
}

/* Too little to tell, points of two views only: the guess stays. */
static void
test_nothing_to_learn (void)
{
  ClothErrorFloor floor = { 0.5, 0 };
  guint8 reason[3] = { CLOTH_POINT_FINE, CLOTH_POINT_FEW_VIEWS,
    CLOTH_POINT_FINE
  };
  guint8 n_views[3] = { 3, 0, 2 };
  guint64 mask[3] = { 7, 0, 3 };
  gdouble chi2[3] = { 100, NAN, 100 };
  const ClothTriangulation result = {.n_points = 3,.reason = reason,.n_views =
        n_views,.views = mask,.chi2 = chi2
  };
  const ClothTriangulateView none[3] = { {NULL} };

  guint8 fine[500] = { CLOTH_POINT_FINE }, two[500];
  guint64 pair[500];
  gdouble large[500];
  const ClothTriangulation pairs = {.n_points = 500,.reason = fine,.n_views =
        two,.views = pair,.chi2 = large
  };

  for (guint i = 0; i < 500; i++) {
    fine[i] = CLOTH_POINT_FINE;
    two[i] = 2;
    pair[i] = 5;
    large[i] = 9;
  }
  g_assert_true (isnan (cloth_error_floor_add (&floor, 3, none, &result)));
  g_assert_true (isnan (cloth_error_floor_add (&floor, 3, none, &pairs)));
  g_assert_cmpfloat (floor.floor, ==, 0.5);
  g_assert_cmpfloat (floor.weight, ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/dot-bend/cylinders", test_cylinders);
  g_test_add_func ("/dot-bend/unknown", test_unknown);
  g_test_add_func ("/dot-bend/doubt", test_doubt);
  g_test_add_func ("/error-floor/noise", test_error_floor);
  g_test_add_func ("/error-floor/nothing", test_nothing_to_learn);
  return g_test_run ();
}
