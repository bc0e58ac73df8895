/* Points that no cloth allows: found on bent grids whose wrong points are known.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/isometry.h"

#include <math.h>
#include <string.h>

#define COLUMNS 9
#define ROWS 7
#define N (COLUMNS * ROWS)
#define EDGE 0.05

static gdouble denials[(COLUMNS + 1) * ROWS];

static const ClothIsometry standard =
    { COLUMNS, ROWS, {EDGE, EDGE}, 0.8, 1.05 };

/* A sheet rolled around a cylinder of radius r: distances along it stay, chords are
 * 2 r sin (s / 2 r). */
static void
roll (gfloat positions[3 * N], gdouble radius)
{
  for (gint k = 0; k < N; k++) {
    gdouble s = (k % COLUMNS) * EDGE, t = (k / COLUMNS) * EDGE;

    positions[3 * k] = (gfloat) (radius * sin (s / radius));
    positions[3 * k + 1] = (gfloat) t;
    positions[3 * k + 2] = (gfloat) (radius * cos (s / radius));
  }
}

static void
test_bent (void)
{
  gfloat positions[3 * N];
  gboolean wrong[N];

  roll (positions, 100);
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL, wrong,
          denials), ==, 0);
  /* The chord of an edge on a cylinder of 25 mm: sin (1) / 1 = 0.84. */
  roll (positions, 0.025);
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL, wrong,
          denials), ==, 0);
  /* Of 20 mm: sin (1.25) / 1.25 = 0.76, sharper than the limit. */
  roll (positions, 0.02);
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL, wrong,
          denials), >, 0);
}

static void
test_wrong (void)
{
  static const gint places[] = { 0, 4, 8, 20, 31, 58, 62 };
  gfloat positions[3 * N];
  gboolean wrong[N];

  for (guint p = 0; p < G_N_ELEMENTS (places); p++)
    for (gint sign = -1; sign <= 1; sign += 2) {
      gint k = places[p];

      roll (positions, 0.3);
      /* Along the normal: sqrt (50² + 25²) = 55.9 mm to each neighbour. */
      positions[3 * k] *= 1 + (gfloat) sign *0.025f / 0.3f;
      positions[3 * k + 2] *= 1 + (gfloat) sign *0.025f / 0.3f;
      g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL,
              wrong, denials), ==, 1);
      g_assert_true (wrong[k]);
    }
  /* Two far apart. */
  roll (positions, 0.3);
  positions[3 * 10] += 0.03f;
  positions[3 * 50 + 1] -= 0.03f;
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL, wrong,
          denials), ==, 2);
  g_assert_true (wrong[10] && wrong[50]);
}

/* Cells of 50 mm by 40 mm: right where rows are that near to each other, wrong when the two
 * are taken for one another or both for the larger. */
static void
test_unequal (void)
{
  static const gdouble edges[][2] = { {EDGE, 0.8 * EDGE}, {0.8 * EDGE, EDGE},
  {EDGE, EDGE}
  };
  gfloat positions[3 * N];
  gboolean wrong[N];

  roll (positions, 100);
  for (gint k = 0; k < N; k++)
    positions[3 * k + 1] *= 0.8f;
  for (guint i = 0; i < G_N_ELEMENTS (edges); i++) {
    const ClothIsometry unequal = { COLUMNS, ROWS, {edges[i][0], edges[i][1]},
    0.9, 1.05
    };
    const guint n = cloth_isometry_check (&unequal, positions, NULL, wrong,
        denials);

    g_assert_true ((n == 0) == (i == 0));
  }
  /* a strip one vertex wide has edges along its columns only */
  for (guint i = 0; i < 2; i++) {
    const ClothIsometry strip = { 1, ROWS, {edges[i][0], edges[i][1]}, 0.9,
    1.05
    };

    for (gint k = 0; k < ROWS; k++)
      positions[3 * k + 1] = (gfloat) (k * 0.8 * EDGE),
          positions[3 * k] = positions[3 * k + 2] = 0;
    g_assert_true ((cloth_isometry_check (&strip, positions, NULL, wrong,
                denials) == 0) == (i == 0));
  }
}

static void
test_covariance (void)
{
  gfloat positions[3 * N], covariances[6 * N];
  gboolean wrong[N];

  roll (positions, 100);
  memset (covariances, 0, sizeof covariances);
  /* 60 mm where 52.5 are allowed, uncertain by 3 mm along the edge: 7.5 < 9. */
  positions[3 * 8] += 0.01f;
  covariances[6 * 8] = 9e-6f;
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, covariances,
          wrong, denials), ==, 0);
  /* By 2 mm: 7.5 > 6. The corner's other edge is right: the two deny each other alone,
   * and the less certain one goes. */
  covariances[6 * 8] = 4e-6f;
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, covariances,
          wrong, denials), ==, 1);
  g_assert_true (wrong[8]);
  memset (covariances, 0, sizeof covariances);
  covariances[6 * 7] = 4e-6f;
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, covariances,
          wrong, denials), ==, 1);
  g_assert_true (wrong[7]);
}

static void
test_limits (void)
{
  ClothIsometry none = { COLUMNS, ROWS, {EDGE, EDGE}, 0, 0 };
  ClothIsometry one = { 1, 1, {EDGE, EDGE}, 0.8, 1.05 };
  gfloat positions[3 * N];
  gboolean wrong[N];

  roll (positions, 0.3);
  positions[3 * 10] += 5;
  g_assert_cmpuint (cloth_isometry_check (&none, positions, NULL, wrong,
          denials), ==, 0);
  g_assert_cmpuint (cloth_isometry_check (&one, positions, NULL, wrong,
          denials), ==, 0);
  /* Not seen: neither wrong nor a witness. */
  for (gint i = 0; i < 3; i++)
    positions[3 * 10 + i] = NAN;
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL, wrong,
          denials), ==, 0);
  for (gint i = 0; i < 3 * N; i++)
    positions[i] = NAN;
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL, wrong,
          denials), ==, 0);
  /* All in one place: all but one deny it. */
  memset (positions, 0, sizeof positions);
  g_assert_cmpuint (cloth_isometry_check (&standard, positions, NULL, wrong,
          denials), >=, N / 2);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/isometry/bent", test_bent);
  g_test_add_func ("/isometry/wrong", test_wrong);
  g_test_add_func ("/isometry/unequal", test_unequal);
  g_test_add_func ("/isometry/covariance", test_covariance);
  g_test_add_func ("/isometry/limits", test_limits);
  return g_test_run ();
}
