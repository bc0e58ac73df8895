/* Calibration: OpenCV's results on the same corners, exact geometry, the scatter it
 * claims.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/core/calibrateproblem.h"

/* Printed by OpenCV 4.6.0: cv2.calibrateCameraExtended with no flags on the corners of
 * corners_cv2.txt (findChessboardCorners, cornerSubPix 5×5, rounded to 0.001 px), run to
 * 1e-14. fx fy cx cy k1 k2 p1 p2 k3. */
static const gdouble cv_rms[2] = { 0.19541704366608184, 0.20701087095182996 };

static const gdouble cv_value[2][9] = {
  {532.8283830744607, 532.9473463543289, 342.48645787387755,
        233.85586430345188, -0.28089623949312625, 0.025281321424902393,
      0.0012165005268731672, -0.00013520424266884727, 0.16320075432646472},
  {537.4536437406815, 536.9696271782618, 327.58522633048767,
        248.8820908390286, -0.29754908496470506, 0.14969501072733585,
      -0.0007596083247760403, 0.0003267306992441348, -0.06603432281318863}
};

static const gdouble cv_sd[2][9] = {
  {0.6408, 0.671356, 0.676125, 0.745777, 0.00793981, 0.0608455, 0.000163483,
      0.00020551, 0.129851},
  {0.705731, 0.684585, 0.762792, 0.768546, 0.00495008, 0.0228156,
      0.000155547, 0.000362418, 0.0331495}
};

static const gdouble cv_view[2][13] = {
  {0.189257, 0.170748, 0.207288, 0.196065, 0.206418, 0.176279, 0.197001,
      0.255865, 0.197847, 0.162668, 0.201554, 0.190616, 0.171864},
  {0.20178, 0.209447, 0.183935, 0.211964, 0.209473, 0.179717, 0.19169,
      0.223669, 0.233901, 0.196725, 0.230561, 0.208248, 0.202152}
};

static void
test_opencv_one (void)
{
  for (gint side = 0; side < 2; side++) {
    const gint use[2] = { side ? -1 : 0, side ? 0 : -1 };
    g_auto (Problem) p;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothCalibration) result = NULL;
    ClothCalibrateParams params;
    gdouble worst = 0, worst_sd = 0;

    problem_init (&p, 1, 9, 6, 0.025, 13);
    load_corners (&p, use);
    cloth_calibrate_params_init (&params);
    params.huber = 1e9;         /* OpenCV has no outliers */
    result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
    g_assert_no_error (error);
    g_assert_cmpfloat (fabs (result->rms - cv_rms[side]), <, 1e-7);
    for (guint v = 0; v < 13; v++)
      g_assert_cmpfloat (fabs (result->view_rms[v] - cv_view[side][v]), <,
          2e-6);
    for (guint i = 0; i < 9; i++) {
      gdouble sd, value = parameter (&result->rig->cameras[0], i, &sd);

      worst = fmax (worst, fabs (value - cv_value[side][i]) / sd);
      /* OpenCV counts points where residuals, two a point, are to be counted; the
       * scatter of many calibrations below says which is right. */
      worst_sd = fmax (worst_sd, fabs (sd / cv_sd[side][i]
              * sqrt ((2 * 702. - 87) / (702 - 87)) - 1));
    }
    g_test_message ("%s: RMS %.6f px, left out %.4f px; parameters within %.1e "
        "σ of OpenCV's, σ within %.3f%%", side ? "right" : "left",
        result->rms, result->left_out_rms, worst, 100 * worst_sd);
    g_assert_cmpfloat (worst, <, 1e-3);
    g_assert_cmpfloat (worst_sd, <, 0.001);
    /* What was left out fits nearly as well, not better by luck or much worse. */
    g_assert_cmpfloat (result->left_out_rms, >, 0.8 * result->rms);
    g_assert_cmpfloat (result->left_out_rms, <, 1.3 * result->rms);
  }
}

/* cv2.stereoCalibrate with all intrinsics free, from the results above. */
static void
test_opencv_stereo (void)
{
  static const gdouble cv[2][9] = {
    {533.417245034785, 533.4425290232963, 342.5344509709647, 234.7246581198131,
          -0.2819853798707701, 0.03896823273749508, 0.0012092081509453532,
        -0.00012612802050512782, 0.11884157310539749},
    {537.0237470177291, 536.6040037852422, 327.4347206328471,
          249.88836787872302, -0.29622441311944964, 0.13921292391600448,
          -0.0005001888973914278, 9.900594120899093e-05,
        -0.049333641320321926}
  };
  static const gdouble cv_r[3] = { 0.007127682377234854, 0.004199006557664919,
    -0.0035191813170821653
  };
  static const gdouble cv_t[3] = { -0.08317629932842528,
    0.0009198526875505414, -0.00011794913529581705
  };
  const gint use[2] = { 0, 1 };
  g_auto (Problem) p;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothCalibration) result = NULL;
  ClothCalibrateParams params;
  const ClothCamera *a, *b;
  gdouble R[9], r[3], Rt[3], worst = 0;

  problem_init (&p, 2, 9, 6, 0.025, 13);
  load_corners (&p, use);
  cloth_calibrate_params_init (&params);
  params.huber = 1e9;
  result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  a = &result->rig->cameras[0];
  b = &result->rig->cameras[1];
  cloth_mat3_mul_nt (b->R, a->R, R);
  cloth_rotation_to_vector (R, r);
  cloth_mat3_vec (R, a->t, Rt);
  for (gint i = 0; i < 3; i++) {
    gdouble t = b->t[i] - Rt[i];

    g_test_message ("r%d %.6f ± %.6f (OpenCV %.6f), t%d %.4f ± %.4f mm "
        "(%.4f)", i, r[i], b->r_sd[i], cv_r[i], i, 1e3 * t, 1e3 * b->t_sd[i],
        1e3 * cv_t[i]);
    worst = fmax (worst, fabs (r[i] - cv_r[i]) / b->r_sd[i]);
    worst = fmax (worst, fabs (t - cv_t[i]) / b->t_sd[i]);
  }
  for (guint c = 0; c < 2; c++) {
    for (guint i = 0; i < 9; i++) {
      gdouble sd, value = parameter (&result->rig->cameras[c], i, &sd);

      worst = fmax (worst, fabs (value - cv[c][i]) / sd);
    }
  }
  g_test_message ("RMS %.6f px (OpenCV 0.215037); all within %.3f σ",
      result->rms, worst);
  /* OpenCV weighs both cameras alike, we by their scatter. */
  g_assert_cmpfloat (fabs (result->rms - 0.21503718797470922), <, 2e-4);
  g_assert_cmpfloat (worst, <, 0.3);
}

static void
test_exact (void)
{
  ClothRandom random;
  ClothCamera truth[4] = { 0, };
  g_auto (Problem) p;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothCalibration) result = NULL;
  ClothCalibrateParams params;
  gdouble worst_K = 0, worst_px = 0;

  cloth_random_init (&random, 1);
  problem_init (&p, 4, 9, 7, 0.03, 40);
  true_rig (p.cameras);
  for (guint c = 0; c < 4; c++)
    truth[c] = p.cameras[c];
  for (guint v = 0; v < 40; v++) {
    gdouble P[12];

    true_pose (&random, 0.7, P);
    for (guint c = 0; c < 4; c++) {
      /* Camera 3 never shares a pose with camera 0. */
      if (c == 3 ? v % 2 == 0 : c == 0 ? v % 2 == 1 : v % 5 != c)
        see (&p, &truth[c], c, v, P, &random, 0, FALSE);
    }
  }
  cloth_calibrate_params_init (&params);
  result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  g_assert_true (result->placed);
  for (guint c = 0; c < 4; c++) {
    const ClothCamera *got = &result->rig->cameras[c];
    /* World of the result: x right, y forward, z up of the first camera. */
    static const gdouble W[9] = { 1, 0, 0, 0, 0, -1, 0, 1, 0 };

    g_test_message ("%s (%s): f %.6f (true %.6f), RMS %.1e px", got->name,
        cloth_lens_to_string (got->lens), got->K[0], truth[c].K[0],
        result->cameras[c].rms);
    worst_K = fmax (worst_K, fabs (got->K[0] / truth[c].K[0] - 1));
    /* Points of the world, not of the board, appear where they should. */
    for (gint i = 0; i < 27; i++) {
      gdouble X[3] = { 0.1 + 0.2 * (i % 3 - 1), 0.12 * (i / 3 % 3 - 1),
        0.6 + 0.15 * (i / 9 - 1)
      };
      gdouble Y[3], a[2], b[2];

      cloth_mat3_vec_t (W, X, Y);
      cloth_camera_project (&truth[c], X, a, NULL, NULL);
      cloth_camera_project (got, Y, b, NULL, NULL);
      if (a[0] > 0 && a[0] < 639 && a[1] > 0 && a[1] < 479)
        worst_px = fmax (worst_px, hypot (a[0] - b[0], a[1] - b[1]));
    }
  }
  g_test_message ("focal lengths within %.1e, new points within %.1e px",
      worst_K, worst_px);
  g_assert_cmpfloat (result->rms, <, 1e-5);
  g_assert_cmpfloat (worst_px, <, 1e-4);
  g_assert_cmpfloat (worst_K, <, 1e-6);
}

#define RUNS 120

/* Predicted standard deviations against the scatter of many calibrations. */
static void
test_deviations (void)
{
  ClothCamera truth[4] = { 0, };
  static gdouble value[RUNS][36], predicted[36];
  gdouble ratios[36], worst = 0;
  gdouble poses[10][12], left_out = 0;
  ClothRandom random;
  guint n = 0;

  cloth_random_init (&random, 7);
  for (guint v = 0; v < 10; v++)
    true_pose (&random, 0.7, poses[v]);
  for (guint run = 0; run < RUNS; run++) {
    g_auto (Problem) p;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothCalibration) result = NULL;
    ClothCalibrateParams params;

    problem_init (&p, 2, 9, 7, 0.03, 10);
    true_rig (p.cameras);
    memcpy (truth, p.cameras, 2 * sizeof *truth);
    for (guint v = 0; v < 10; v++) {
      for (guint c = 0; c < 2; c++)
        see (&p, &truth[c], c, v, poses[v], &random, 0.1, TRUE);
    }
    cloth_calibrate_params_init (&params);
    params.leave_out = run == 0 ? 5 : 0;
    result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
    g_assert_no_error (error);
    if (run == 0)
      left_out = result->left_out_rms / result->rms;
    for (guint c = 0; c < 2; c++) {
      for (guint i = 0; i < 18; i++) {
        gdouble sd;

        value[run][18 * c + i] = parameter (&result->rig->cameras[c], i, &sd);
        predicted[18 * c + i] += sd * sd / RUNS;
      }
      /* A small rotation about the camera's axes, away from the truth. */
      {
        static const gdouble W[9] = { 1, 0, 0, 0, 0, -1, 0, 1, 0 };
        gdouble T[9], D[9];

        cloth_mat3_mul (truth[c].R, W, T);
        cloth_mat3_mul_nt (result->rig->cameras[c].R, T, D);
        cloth_rotation_to_vector (D, value[run] + 18 * c + 12);
      }
    }
  }
  for (guint i = 0; i < 36; i++) {
    gdouble mean = 0, variance = 0;

    for (guint run = 0; run < RUNS; run++)
      mean += value[run][i] / RUNS;
    for (guint run = 0; run < RUNS; run++)
      variance += (value[run][i] - mean) * (value[run][i] - mean)
          / (RUNS - 1);
    if (predicted[i] == 0)
      continue;
    ratios[i] = sqrt (variance / predicted[i]);
    g_test_message ("camera %u, parameter %2u: scatter %.3e, predicted %.3e, "
        "ratio %.3f", i / 18, i % 18, sqrt (variance), sqrt (predicted[i]),
        ratios[i]);
    worst = fmax (worst, fabs (ratios[i] - 1));
    n++;
  }
  g_test_message ("%u parameters, %d runs: worst ratio off by %.0f%%; left out "
      "over fitted RMS %.2f", n, RUNS, 100 * worst, left_out);
  g_assert_cmpuint (n, ==, 9 + 4 + 6);
  g_assert_cmpfloat (worst, <, 0.2);
  g_assert_cmpfloat (left_out, >, 0.9);
  g_assert_cmpfloat (left_out, <, 1.3);
}

/* One corner in thirty is somewhere else. */
static void
test_outliers (void)
{
  ClothRandom random;
  ClothCamera truth[4] = { 0, };
  g_auto (Problem) p;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothCalibration) result = NULL, again = NULL;
  ClothCalibrateParams params;
  gdouble worst;
  g_autoptr (GArray) bad = g_array_new (FALSE, FALSE, sizeof (gboolean));
  guint n_bad = 0, n_found = 0, n_false = 0;

  cloth_random_init (&random, 3);
  problem_init (&p, 2, 9, 7, 0.03, 15);
  true_rig (p.cameras);
  memcpy (truth, p.cameras, 2 * sizeof *truth);
  for (guint v = 0; v < 15; v++) {
    gdouble P[12];

    true_pose (&random, 0.7, P);
    for (guint c = 0; c < 2; c++) {
      ClothBundleView *view;

      see (&p, &truth[c], c, v, P, &random, 0.1, FALSE);
      view = &g_array_index (p.views, ClothBundleView, p.views->len - 1);
      for (guint i = 0; i < view->n; i++) {
        gboolean off = cloth_random_uniform (&random) < 1. / 30;

        if (off)
          ((gdouble *) view->x)[i] += 10 + 20 * cloth_random_uniform (&random);
        g_array_append_val (bad, off);
      }
    }
  }
  cloth_calibrate_params_init (&params);
  result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  worst = worst_deviation (result->rig, truth, 12);
  g_test_message ("RMS with outliers %.2f px, scatter without %.3f px, "
      "parameters within %.1f σ", result->rms, result->cameras[0].excess,
      worst);
  g_assert_cmpfloat (worst, <, 4);
  g_assert_cmpfloat (fabs (result->cameras[0].excess - 0.11), <, 0.02);

  /* Those that are off are found, and no others. */
  for (guint i = 0; i < bad->len; i++) {
    gboolean off = g_array_index (bad, gboolean, i);

    n_bad += off;
    n_found += off && result->outlier[i];
    n_false += !off && result->outlier[i];
  }
  g_test_message ("%u of %u outliers found, %u false", n_found, n_bad, n_false);
  g_assert_cmpuint (n_bad, >, 30);
  g_assert_cmpuint (n_found, ==, n_bad);
  g_assert_cmpuint (n_false, ==, 0);
  g_assert_cmpuint (result->cameras[0].n_outliers
      + result->cameras[1].n_outliers, ==, n_bad);

  /* Equal input, equal bytes. */
  again = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  for (guint c = 0; c < 2; c++) {
    g_assert_cmpmem (result->rig->cameras[c].K, 9 * sizeof (gdouble),
        again->rig->cameras[c].K, 9 * sizeof (gdouble));
    g_assert_cmpmem (result->rig->cameras[c].k_sd, 8 * sizeof (gdouble),
        again->rig->cameras[c].k_sd, 8 * sizeof (gdouble));
    g_assert_cmpmem (result->rig->cameras[c].t, 3 * sizeof (gdouble),
        again->rig->cameras[c].t, 3 * sizeof (gdouble));
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/calibrate/opencv-one", test_opencv_one);
  g_test_add_func ("/calibrate/opencv-stereo", test_opencv_stereo);
  g_test_add_func ("/calibrate/exact", test_exact);
  g_test_add_func ("/calibrate/deviations", test_deviations);
  g_test_add_func ("/calibrate/outliers", test_outliers);
  return g_test_run ();
}
