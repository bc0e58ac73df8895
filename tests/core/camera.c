/* Camera model: against OpenCV's figures, derivatives, round trips.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/rig/camera.h"
#include "gst/rig/rotation.h"

/* The figures below were printed by OpenCV 4.6.0's Python module:
 * cv2.Rodrigues (rvec), cv2.projectPoints (X, rvec, t, K, k),
 * cv2.fisheye.projectPoints (X, rvec, t, K, k). */
static const gdouble rvec[3] = { 0.21, -0.37, 0.5 };

static const gdouble rodrigues[9] = {
  0.8133990230253382, -0.5023239727597242, -0.2933473295128378,
  0.42737491144707884, 0.8581562488285137, -0.284461838674673,
  0.39462984480019636, 0.10601169269218423, 0.9127041177761339
};

static const gdouble world[4][3] = {
  {0.1, 0.2, 0.05}, {-0.31, 0.22, 0.4}, {0, 0, 0}, {0.35, -0.4, -0.1}
};

typedef struct
{
  const gchar *name;
  ClothLens lens;
  gdouble k[8];                 /* OpenCV's order */
  gdouble px[4][2];             /* cv2's projections of world[] */
  /* cv2's derivative of the last of them: rvec, t */
  gdouble d_pose[2][6];
} Figures;

static const Figures figures[] = {
  {"none", CLOTH_LENS_NONE, {0},
      {{338.999113871526, 310.593827095234},
          {133.898825427032, 181.435123148675},
          {359.468888888889, 198.506666666667},
          {663.845184587668, 99.8405463190755}},
      {{118.561965236, 172.103115953, 60.2417973643, 591.301614812, 0,
              -362.813720156},
          {15.3689497914, -47.1850697611, 314.152886718, 0,
              598.37777475, 155.630688597}}},
  {"brown5", CLOTH_LENS_BROWN5, {-.28, .11, .0013, -.0007, -.02},
      {{338.978534212088, 310.302155437002},
          {141.998556306277, 183.935358965634},
          {359.40636069742, 198.61772621488},
          {628.913092789701, 115.065988168251}},
      {{89.4373948008, 125.436753322, 64.7931314187, 441.207845264,
              37.7954223971, -260.888331357},
          {20.9852906457, -29.7506048792, 276.090520575, 38.2477236374,
              518.456945927, 111.3760412}}},
  {"brown8", CLOTH_LENS_BROWN8,
        {.31, -.22, -.0009, .0011, .05, .6, -.18, .03},
        {{338.992336046787, 310.232626994743},
            {142.578800222154, 183.878159742572},
            {359.424151077709, 198.59034629078},
            {628.809214719674, 114.765140858123}},
        {{88.0619772946, 123.2610375, 64.8841177141, 434.150630771,
                39.3382098845, -256.156871349},
            {21.267938469, -29.2028617914, 275.628209366, 39.8089738023,
              517.273398619, 110.110255656}}},
  {"fisheye", CLOTH_LENS_FISHEYE, {.031, -.012, .004, -.0021},
      {{338.9825365980622, 310.2421245297261},
          {142.62196617108776, 183.99260850013968},
          {359.4114616408767, 198.60836701556775},
          {627.872202198962, 115.27132996647333}},
      {{NAN}}},
};

static void
make_camera (ClothCamera * camera, const Figures * f)
{
  static const gdouble K[9] = { 534.8, 0, 335.7, 0, 541.2, 240.6, 0, 0, 1 };
  static const gdouble t[3] = { 0.04, -0.07, 0.9 };

  memset (camera, 0, sizeof *camera);
  camera->width = 640;
  camera->height = 480;
  camera->lens = f->lens;
  memcpy (camera->K, K, sizeof K);
  memcpy (camera->k, f->k, sizeof camera->k);
  memcpy (camera->t, t, sizeof t);
  cloth_rotation_from_vector (rvec, camera->R);
}

static void
assert_near (gdouble a, gdouble b, gdouble tolerance)
{
  if (!(fabs (a - b) <= tolerance))
    g_error ("%.17g is not %.17g within %g", a, b, tolerance);
}

static void
test_rotation (void)
{
  static const gdouble lengths[] = { 0, 1e-9, 1e-5, 5e-3, 0.02, 1, 3,
    3.14159, G_PI
  };
  gdouble R[9], r[3];

  cloth_rotation_from_vector (rvec, R);
  for (gint i = 0; i < 9; i++)
    assert_near (R[i], rodrigues[i], 1e-15);

  for (guint l = 0; l < G_N_ELEMENTS (lengths); l++) {
    for (gint a = 0; a < 7; a++) {
      gdouble v[3] = { (a + 1) & 1, ((a + 1) >> 1) & 1, -(((a + 1) >> 2) & 1) };
      gdouble n = sqrt (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      gdouble back[9], J[9];

      for (gint i = 0; i < 3; i++)
        v[i] *= lengths[l] / n;
      cloth_rotation_from_vector (v, R);
      cloth_rotation_to_vector (R, r);
      cloth_rotation_from_vector (r, back);
      for (gint i = 0; i < 9; i++)
        assert_near (back[i], R[i], 3e-15);
      if (lengths[l] < 3.1) {
        for (gint i = 0; i < 3; i++)
          assert_near (r[i], v[i], 1e-14);
      }

      cloth_rotation_left_jacobian (v, J);

      /* exp (v + h e_j) exp (v)^-1 = exp (J h e_j) */
      for (gint j = 0; j < 3; j++) {
        gdouble h = 1e-6, w[2][3];

        for (gint s = 0; s < 2; s++) {
          gdouble p[3] = { v[0], v[1], v[2] }, P[9], D[9];

          p[j] += s ? h : -h;
          cloth_rotation_from_vector (p, P);
          for (gint i = 0; i < 9; i++)
            D[i] = P[i / 3 * 3] * R[i % 3 * 3]
                + P[i / 3 * 3 + 1] * R[i % 3 * 3 + 1]
                + P[i / 3 * 3 + 2] * R[i % 3 * 3 + 2];
          cloth_rotation_to_vector (D, w[s]);
        }
        for (gint i = 0; i < 3; i++)
          assert_near ((w[1][i] - w[0][i]) / (2 * h), J[3 * i + j], 1e-8);
      }
    }
  }
}

static void
test_figures (gconstpointer data)
{
  const Figures *f = data;
  ClothCamera camera;
  gdouble worst = 0;

  make_camera (&camera, f);
  for (gint i = 0; i < 4; i++) {
    gdouble px[2], d[36];

    g_assert_true (cloth_camera_project (&camera, world[i], px, NULL, d));
    for (gint j = 0; j < 2; j++) {
      worst = fmax (worst, fabs (px[j] - f->px[i][j]));
      if (i == 3 && !isnan (f->d_pose[0][0])) {
        for (gint c = 0; c < 6; c++)
          assert_near (d[18 * j + 12 + c], f->d_pose[j][c], 1e-8);
      }
    }
  }
  g_test_message ("%s: largest difference from OpenCV %.1e px", f->name, worst);
  g_assert_cmpfloat (worst, <, 1e-11);
}

static void
test_derivatives (gconstpointer data)
{
  const Figures *f = data;
  ClothCamera camera;
  guint n = cloth_lens_n_coefficients (f->lens);
  gdouble worst = 0;

  make_camera (&camera, f);
  for (gint i = 0; i < 5; i++) {
    static const gdouble centre[3] = { 0.0, 0.08, 0.01 };
    const gdouble *X = i < 4 ? world[i] : centre;
    gdouble px[2], dX[6], dp[36], pose[3], a[2], b[2], h = 1e-6;

    g_assert_true (cloth_camera_project (&camera, X, px, dX, dp));
    for (gint j = 0; j < 3; j++) {
      gdouble P[3] = { X[0], X[1], X[2] };

      P[j] = X[j] + h;
      cloth_camera_project (&camera, P, a, NULL, NULL);
      P[j] = X[j] - h;
      cloth_camera_project (&camera, P, b, NULL, NULL);
      for (gint c = 0; c < 2; c++)
        worst = fmax (worst, fabs ((a[c] - b[c]) / (2 * h) - dX[3 * c + j])
            / (1 + fabs (dX[3 * c + j])));
    }
    cloth_rotation_to_vector (camera.R, pose);
    for (guint j = 0; j < CLOTH_CAMERA_N_PARAMETERS; j++) {
      for (gint s = 0; s < 2; s++) {
        static const gint k_index[4] = { 0, 4, 2, 5 };
        ClothCamera c = camera;
        gdouble step = s ? -h : h;

        if (j < 4) {
          c.K[k_index[j]] += step;
        } else if (j < 12) {
          if (j - 4 < n)
            c.k[j - 4] += step;
        } else if (j < 15) {
          gdouble r[3] = { pose[0], pose[1], pose[2] };

          r[j - 12] += step;
          cloth_rotation_from_vector (r, c.R);
        } else {
          c.t[j - 15] += step;
        }
        cloth_camera_project (&c, X, s ? b : a, NULL, NULL);
      }
      for (gint c = 0; c < 2; c++)
        worst = fmax (worst, fabs ((a[c] - b[c]) / (2 * h) - dp[18 * c + j])
            / (1 + fabs (dp[18 * c + j])));
    }
  }
  g_test_message ("%s: largest relative error of a derivative %.1e", f->name,
      worst);
  g_assert_cmpfloat (worst, <, 2e-7);
}

/* Every fourth pixel of the picture and a rim around it. */
static void
test_round_trip (gconstpointer data)
{
  const Figures *f = data;
  ClothCamera camera;
  gint columns = 170, rows = 130, n = columns * rows;
  g_autofree gdouble *u = g_new (gdouble, n), *v = g_new (gdouble, n);
  g_autofree gdouble *x = g_new (gdouble, n), *y = g_new (gdouble, n);
  g_autofree gdouble *J = g_new (gdouble, 4 * n);
  gdouble worst = 0, worst_jacobian = 0;

  make_camera (&camera, f);
  camera.K[1] = 0.7;            /* skew too */
  for (gint i = 0; i < n; i++) {
    u[i] = 4 * (i % columns) - 20;
    v[i] = 4 * (i / columns) - 20;
  }
  g_assert_cmpuint (cloth_camera_undistort_points (&camera, n, u, v, x, y, J),
      ==, n);
  for (gint i = 0; i < n; i++) {
    gdouble xy[2] = { x[i], y[i] }, px[2], D[4];

    cloth_camera_distort (&camera, xy, px, D);
    worst = fmax (worst, hypot (px[0] - u[i], px[1] - v[i]));
    worst_jacobian = fmax (worst_jacobian,
        fabs (D[0] * J[i] + D[1] * J[2 * n + i] - 1)
        + fabs (D[0] * J[n + i] + D[1] * J[3 * n + i])
        + fabs (D[2] * J[i] + D[3] * J[2 * n + i])
        + fabs (D[2] * J[n + i] + D[3] * J[3 * n + i] - 1));
  }
  g_test_message ("%s: round trip %.1e px, Jacobian %.1e", f->name, worst,
      worst_jacobian);
  g_assert_cmpfloat (worst, <, 1e-11);
  g_assert_cmpfloat (worst_jacobian, <, 1e-12);

  /* In place gives the same bytes. */
  {
    g_autofree gdouble *a = g_memdup2 (u, n * sizeof *u);
    g_autofree gdouble *b = g_memdup2 (v, n * sizeof *v);

    cloth_camera_undistort_points (&camera, n, a, b, a, b, NULL);
    g_assert_cmpmem (a, n * sizeof *a, x, n * sizeof *x);
    g_assert_cmpmem (b, n * sizeof *b, y, n * sizeof *y);
  }
}

/* x (1 − 0.3 x²) climbs to 0.7027 at x = 1.054 and falls: beyond it no inverse. */
static void
test_no_inverse (void)
{
  ClothCamera camera = {.K = {100, 0, 0, 0, 100, 0, 0, 0, 1},
  .lens = CLOTH_LENS_BROWN5,.k = {-0.3},.R = {1, 0, 0, 0, 1, 0, 0, 0, 1}
  };
  gdouble u[5] = { 70.2, 70.3, 5000, NAN, 0 };
  gdouble v[5] = { 0, 0, 5000, 3, 0 }, x[5], y[5], J[20];

  g_assert_cmpuint (cloth_camera_undistort_points (&camera, 5, u, v, x, y, J),
      ==, 2);
  g_assert_cmpfloat (x[0], >, 0.99);
  g_assert_cmpfloat (x[0], <, 1.0541);
  assert_near (x[0] * (1 - 0.3 * x[0] * x[0]), 0.702, 1e-13);
  for (gint i = 1; i < 4; i++) {
    g_assert_true (isnan (x[i]) && isnan (y[i]));
    for (gint j = 0; j < 4; j++)
      g_assert_true (isnan (J[5 * j + i]));
  }
  g_assert_cmpfloat (x[4], ==, 0);
  g_assert_cmpfloat (J[4], ==, 0.01);

  /* So far off that squares overflow. */
  for (ClothLens lens = CLOTH_LENS_BROWN5; lens <= CLOTH_LENS_FISHEYE; lens++) {
    gdouble far[4] = { 1e300, -1e300, INFINITY, 0 };
    gdouble off[4] = { 0, 1e300, 0, -INFINITY };

    camera.lens = lens;
    g_assert_cmpuint (cloth_camera_undistort_points (&camera, 4, far, off, x, y,
            J), ==, 0);
    for (gint i = 0; i < 4; i++)
      g_assert_true (isnan (x[i]) && isnan (y[i]) && isnan (J[i]));
  }

  /* The rational model's pole, and a fisheye that would need more than 90°. */
  camera.lens = CLOTH_LENS_BROWN8;
  memset (camera.k, 0, sizeof camera.k);
  camera.k[5] = -1;
  u[0] = 90;
  cloth_camera_undistort_points (&camera, 5, u, v, x, y, NULL);
  g_assert_cmpfloat (x[0], <, 1);
  g_assert_true (isfinite (x[0]));
  camera.lens = CLOTH_LENS_FISHEYE;
  camera.k[5] = 0;
  u[0] = 100 * G_PI / 3;
  u[1] = 158;
  cloth_camera_undistort_points (&camera, 5, u, v, x, y, NULL);
  assert_near (x[0], tan (G_PI / 3), 1e-12);
  g_assert_true (isnan (x[1]));

  /* A lens of NaN coefficients ends, with nothing. */
  for (gint lens = CLOTH_LENS_BROWN5; lens <= CLOTH_LENS_FISHEYE; lens++) {
    camera.lens = lens;
    camera.k[0] = NAN;
    cloth_camera_undistort_points (&camera, 2, u, v, x, y, NULL);
    g_assert_true (isnan (x[0]));
  }
}

static void
test_behind (void)
{
  ClothCamera camera;
  gdouble px[2] = { 1, 2 };
  gdouble X[3] = { 0, 0, -5 };

  make_camera (&camera, &figures[0]);
  g_assert_false (cloth_camera_project (&camera, X, px, NULL, NULL));
  X[2] = NAN;
  g_assert_false (cloth_camera_project (&camera, X, px, NULL, NULL));
  g_assert_true (px[0] == 1 && px[1] == 2);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/camera/rotation", test_rotation);
  for (guint i = 0; i < G_N_ELEMENTS (figures); i++) {
    static const struct
    {
      const gchar *name;
      GTestDataFunc function;
    } tests[] = {
      {"figures", test_figures}, {"derivatives", test_derivatives},
      {"round-trip", test_round_trip}
    };

    for (guint j = 0; j < G_N_ELEMENTS (tests); j++) {
      g_autofree gchar *path = g_strdup_printf ("/camera/%s/%s",
          tests[j].name, figures[i].name);

      g_test_add_data_func (path, &figures[i], tests[j].function);
    }
  }
  g_test_add_func ("/camera/no-inverse", test_no_inverse);
  g_test_add_func ("/camera/behind", test_behind);
  return g_test_run ();
}
