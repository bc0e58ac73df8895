/* Calibration: against OpenCV's on the same corners, against truth, against scatter.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"
#include "gst/rig/calibrate.h"
#include "gst/rig/rotation.h"

/* A problem that owns its arrays. */
typedef struct
{
  ClothCamera cameras[4];
  gdouble *board;
  GArray *views;
  ClothCalibrateInput input;
} Problem;

static void
problem_init (Problem * p, guint n_cameras, guint columns, guint rows,
    gdouble square, guint n_poses)
{
  memset (p, 0, sizeof *p);
  p->board = g_new0 (gdouble, 3 * columns * rows);
  for (guint i = 0; i < columns * rows; i++) {
    p->board[3 * i] = i % columns * square;
    p->board[3 * i + 1] = i / columns * square;
  }
  p->views = g_array_new (FALSE, TRUE, sizeof (ClothBundleView));
  p->input.n_cameras = n_cameras;
  p->input.cameras = p->cameras;
  p->input.n_vertices = columns * rows;
  p->input.board = p->board;
  p->input.n_poses = n_poses;
  for (guint c = 0; c < n_cameras; c++) {
    ClothCamera *camera = &p->cameras[c];

    camera->name = g_strdup_printf ("cam%u", c);
    camera->width = 640;
    camera->height = 480;
    camera->lens = CLOTH_LENS_BROWN5;
    camera->K[8] = camera->R[0] = camera->R[4] = camera->R[8] = 1;
  }
}

static ClothBundleView *
problem_add (Problem * p, guint camera, guint pose)
{
  guint n = p->input.n_vertices;
  ClothBundleView view = { camera, pose, TRUE, 0, g_new0 (guint, n),
    g_new0 (gdouble, n), g_new0 (gdouble, n), NULL
  };

  g_array_append_val (p->views, view);
  p->input.n_views = p->views->len;
  p->input.views = (const ClothBundleView *) p->views->data;
  return &g_array_index (p->views, ClothBundleView, p->views->len - 1);
}

static void
problem_clear (Problem * p)
{
  for (guint v = 0; v < p->views->len; v++) {
    ClothBundleView *view = &g_array_index (p->views, ClothBundleView, v);

    g_free ((gpointer) view->vertex);
    g_free ((gpointer) view->x);
    g_free ((gpointer) view->y);
    g_free ((gpointer) view->cov);
  }
  g_array_unref (p->views);
  for (guint c = 0; c < p->input.n_cameras; c++)
    cloth_camera_clear (&p->cameras[c]);
  g_free (p->board);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Problem, problem_clear)
/* Corners that OpenCV found, camera by camera. */
     static void load_corners (Problem * p, const gint * cameras)
{
  g_autofree gchar *text = NULL;
  gchar *line;
  ClothBundleView *view = NULL;

  g_assert_true (g_file_get_contents (TEST_DATA
          "/opencv_boards/corners_cv2.txt", &text, NULL, NULL));
  for (line = text; line && *line; line = strchr (line, '\n') + 1) {
    gint side, pose, vertex;
    gdouble x, y;

    g_assert_cmpint (sscanf (line, "%d %d %d %lf %lf", &side, &pose, &vertex,
            &x, &y), ==, 5);
    if (cameras[side] < 0)
      continue;
    if (vertex == 0)
      view = problem_add (p, (guint) cameras[side], (guint) pose);
    /* OpenCV holds corners as floats. */
    ((guint *) view->vertex)[view->n] = (guint) vertex;
    ((gdouble *) view->x)[view->n] = (gfloat) x;
    ((gdouble *) view->y)[view->n++] = (gfloat) y;
  }
}

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

static gdouble
parameter (const ClothCamera * c, guint i, gdouble * sd)
{
  static const guint k_index[4] = { 0, 4, 2, 5 };

  *sd = i < 4 ? c->K_sd[i] : i < 12 ? c->k_sd[i - 4] : i < 15 ?
      c->r_sd[i - 12] : c->t_sd[i - 15];
  if (i < 4)
    return c->K[k_index[i]];
  if (i < 12)
    return c->k[i - 4];
  return i < 15 ? 0 : c->t[i - 15];
}

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

/* Four cameras on an arc, each with another lens; each sees a part of the poses. */
static void
true_rig (ClothCamera * cameras)
{
  static const ClothLens lenses[4] = { CLOTH_LENS_BROWN5, CLOTH_LENS_NONE,
    CLOTH_LENS_FISHEYE, CLOTH_LENS_BROWN8
  };
  static const gdouble k[4][8] = {
    {-.28, .11, .0013, -.0007, -.02}, {0}, {.031, -.012, .004, -.0021},
    {.31, -.22, -.0009, .0011, .05, .6, -.18, .03}
  };

  for (gint c = 0; c < 4; c++) {
    gdouble r[3] = { 0.05 * c, 0.3 * c, 0.02 * c };
    ClothCamera *camera = &cameras[c];

    camera->lens = lenses[c];
    memcpy (camera->k, k[c], sizeof camera->k);
    camera->K[0] = 520 + 10 * c;
    camera->K[4] = 523 + 9 * c;
    camera->K[2] = 320 + 3 * c;
    camera->K[5] = 236 - 2 * c;
    cloth_rotation_from_vector (r, camera->R);
    camera->t[0] = -0.3 * c;
    camera->t[1] = 0.02 * c;
    camera->t[2] = 0.06 * c;
  }
}

/* A board about half a metre from the first camera, tilted every way. */
static void
true_pose (ClothRandom * random, gdouble tilt, gdouble pose[12])
{
  gdouble r[3], c[3], Rc[3];

  for (gint j = 0; j < 3; j++)
    r[j] = tilt * (2 * cloth_random_uniform (random) - 1);
  cloth_rotation_from_vector (r, pose);
  c[0] = 0.1 + 0.25 * (2 * cloth_random_uniform (random) - 1);
  c[1] = 0.18 * (2 * cloth_random_uniform (random) - 1);
  c[2] = 0.6 + 0.15 * (2 * cloth_random_uniform (random) - 1);
  cloth_mat3_vec (pose, (const gdouble[3]) { 0.12, 0.09, 0 }, Rc);
  for (gint j = 0; j < 3; j++)
    pose[9 + j] = c[j] - Rc[j];
}

/* Adds what the camera sees of the board, with noise of @sigma px. With @cov corners at
 * the rim of the picture are noisier, and say so. */
static void
see (Problem * p, const ClothCamera * truth, guint camera, guint pose,
    const gdouble * P, ClothRandom * random, gdouble sigma, gboolean cov)
{
  ClothBundleView *view = problem_add (p, camera, pose);

  if (cov)
    view->cov = g_new (gdouble, 3 * p->input.n_vertices);
  for (guint i = 0; i < p->input.n_vertices; i++) {
    gdouble X[3], px[2], s = sigma, e[2];

    cloth_mat3_vec (P, p->board + 3 * i, X);
    for (gint j = 0; j < 3; j++)
      X[j] += P[9 + j];
    if (!cloth_camera_project (truth, X, px, NULL, NULL) || px[0] < 0
        || px[1] < 0 || px[0] > 639 || px[1] > 479)
      continue;
    if (cov)
      s *= 0.5 + hypot (px[0] - 320, px[1] - 240) / 250;
    e[0] = s * cloth_random_gaussian (random);
    e[1] = s * cloth_random_gaussian (random);
    ((guint *) view->vertex)[view->n] = i;
    ((gdouble *) view->x)[view->n] = px[0] + e[0];
    ((gdouble *) view->y)[view->n] = px[1] + e[1] + 0.5 * e[0];
    if (cov) {
      gdouble *c = (gdouble *) view->cov + 3 * view->n;

      c[0] = s * s;
      c[1] = 0.5 * s * s;
      c[2] = 1.25 * s * s;
    }
    view->n++;
  }
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
  gdouble worst = 0;

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
        if (cloth_random_uniform (&random) < 1. / 30)
          ((gdouble *) view->x)[i] += 10 + 20 * cloth_random_uniform (&random);
      }
    }
  }
  cloth_calibrate_params_init (&params);
  result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  for (guint c = 0; c < 2; c++) {
    for (guint i = 0; i < 12; i++) {
      gdouble sd, zero;
      gdouble value = parameter (&result->rig->cameras[c], i, &sd);

      if (sd > 0)
        worst = fmax (worst, fabs (value - parameter (&truth[c], i, &zero))
            / sd);
    }
  }
  g_test_message ("RMS with outliers %.2f px, scatter without %.3f px, "
      "parameters within %.1f σ", result->rms, result->cameras[0].excess,
      worst);
  g_assert_cmpfloat (worst, <, 4);
  g_assert_cmpfloat (fabs (result->cameras[0].excess - 0.11), <, 0.02);

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

static void
assert_fails (Problem * p, const ClothCalibrateParams * custom,
    const gchar * says)
{
  ClothCalibrateParams params;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothCalibration) result = NULL;

  cloth_calibrate_params_init (&params);
  result = cloth_calibrate (&p->input, custom ? custom : &params, NULL, NULL,
      NULL, &error);
  g_assert_null (result);
  g_test_message ("%s", error->message);
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
  g_assert_nonnull (strstr (error->message, says));
}

/* A square board that looks the same after each quarter turn, numbered by each camera from
 * whichever corner. */
static void
test_symmetric (void)
{
  ClothRandom random;
  ClothCamera truth[4] = { 0, };
  guint turns[3][64];
  g_auto (Problem) p;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothCalibration) result = NULL;
  ClothCalibrateParams params;
  gdouble R[9], Rt[3], worst = 0;

  cloth_random_init (&random, 11);
  problem_init (&p, 3, 8, 8, 0.03, 15);
  true_rig (p.cameras);
  memcpy (truth, p.cameras, 3 * sizeof *truth);
  for (guint i = 0; i < 64; i++) {
    turns[0][i] = i % 8 * 8 + 7 - i / 8;
    turns[1][i] = 63 - i;
    turns[2][i] = (7 - i % 8) * 8 + i / 8;
  }
  for (guint v = 0; v < 15; v++) {
    gdouble P[12];

    true_pose (&random, 0.7, P);
    for (guint c = 0; c < 3; c++) {
      guint turn = cloth_random_below (&random, 4);
      ClothBundleView *view;

      see (&p, &truth[c], c, v, P, &random, 0.05, FALSE);
      view = &g_array_index (p.views, ClothBundleView, p.views->len - 1);
      for (guint i = 0; turn > 0 && i < view->n; i++)
        ((guint *) view->vertex)[i] = turns[turn - 1][view->vertex[i]];
    }
  }
  cloth_calibrate_params_init (&params);
  g_assert_null (cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error));
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
  g_clear_error (&error);
  p.input.n_symmetries = 3;
  p.input.symmetries = turns[0];
  result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  for (guint c = 1; c < 3; c++) {
    const ClothCamera *a = &result->rig->cameras[0];
    const ClothCamera *b = &result->rig->cameras[c];

    cloth_mat3_mul_nt (b->R, a->R, R);
    cloth_mat3_vec (R, a->t, Rt);
    for (gint i = 0; i < 3; i++)
      worst = fmax (worst, fabs (b->t[i] - Rt[i] - truth[c].t[i])
          / b->t_sd[i]);
  }
  g_test_message ("RMS %.4f px, cameras placed within %.1f σ", result->rms,
      worst);
  g_assert_cmpfloat (result->rms, <, 0.1);
  g_assert_cmpfloat (worst, <, 4);
  turns[2][5] = 64;
  assert_fails (&p, NULL, "symmetry 2: vertex 64 is out of range");
}

/* The rational lens from few corners: without care the fits of these seeds end in poles
 * between the corners, with coefficients of thousands. */
static void
test_rational (void)
{
  static const guint64 seeds[] = { 7, 8, 20, 31, 33 };
  gdouble worst = 0;

  for (guint s = 0; s < G_N_ELEMENTS (seeds); s++) {
    ClothRandom random;
    ClothCamera four[4] = { 0, };
    ClothCamera truth;
    g_auto (Problem) p;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothCalibration) result = NULL;
    ClothCalibrateParams params;

    cloth_random_init (&random, seeds[s]);
    problem_init (&p, 1, 9, 6, 0.03, 10);
    true_rig (four);
    p.cameras[0].lens = CLOTH_LENS_BROWN8;
    memcpy (p.cameras[0].k, four[3].k, sizeof four[3].k);
    memcpy (p.cameras[0].K, four[0].K, sizeof four[0].K);
    p.cameras[0].K[8] = 1;
    truth = p.cameras[0];
    for (guint v = 0; v < 10; v++) {
      gdouble P[12];

      true_pose (&random, 0.6, P);
      P[9] += 0.1;
      see (&p, &truth, 0, v, P, &random, 0.2, TRUE);
    }
    cloth_calibrate_params_init (&params);
    params.leave_out = 0;
    result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
    g_assert_no_error (error);
    for (guint i = 0; i < 4; i++) {
      gdouble sd, zero;
      gdouble value = parameter (&result->rig->cameras[0], i, &sd);

      worst = fmax (worst, fabs (value - parameter (&truth, i, &zero)) / sd);
    }
  }
  g_test_message ("focal lengths and centres within %.1f σ", worst);
  g_assert_cmpfloat (worst, <, 4);
}

/* Boards that reach out of the picture, down to shreds of few corners. */
static void
test_shreds (void)
{
  ClothRandom random;
  ClothCamera truth[4] = { 0, };
  g_auto (Problem) p;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothCalibration) result = NULL;
  ClothCalibrateParams params;
  gdouble worst = 0;
  guint least = 99;

  cloth_random_init (&random, 3);
  problem_init (&p, 2, 12, 9, 0.03, 50);
  true_rig (p.cameras);
  memcpy (truth, p.cameras, 2 * sizeof *truth);
  for (guint v = 0; v < 50; v++) {
    gdouble P[12];

    true_pose (&random, 0.7, P);
    P[9] += 0.5 * (cloth_random_uniform (&random) - 0.5);
    P[10] += 0.4 * (cloth_random_uniform (&random) - 0.5);
    for (guint c = 0; c < 2; c++)
      see (&p, &truth[c], c, v, P, &random, 0.1, TRUE);
  }
  for (guint v = 0; v < p.views->len; v++)
    least = MIN (least, p.input.views[v].n);
  cloth_calibrate_params_init (&params);
  result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  for (guint c = 0; c < 2; c++) {
    for (guint i = 0; i < 12; i++) {
      gdouble sd, zero;
      gdouble value = parameter (&result->rig->cameras[c], i, &sd);

      if (sd > 0)
        worst = fmax (worst, fabs (value - parameter (&truth[c], i, &zero))
            / sd);
    }
  }
  g_test_message ("least view %u corners, %u and %u views used, RMS %.3f px, "
      "parameters within %.1f σ", least, result->cameras[0].n_views,
      result->cameras[1].n_views, result->rms, worst);
  g_assert_cmpuint (least, <, 10);
  g_assert_cmpuint (result->cameras[0].n_views, >, 40);
  g_assert_cmpfloat (worst, <, 4);
}

/* The board as world: its first pose is the plane z = 0, the cameras above it. */
static void
test_world (void)
{
  const gint use[2] = { 0, 1 };
  g_auto (Problem) p;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothCalibration) result = NULL;
  ClothCalibrateParams params;

  problem_init (&p, 2, 9, 6, 0.025, 13);
  load_corners (&p, use);
  cloth_calibrate_params_init (&params);
  params.world = CLOTH_CALIBRATE_WORLD_BOARD;
  params.share_lens = TRUE;
  params.leave_out = 0;
  result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  for (guint c = 0; c < 2; c++) {
    const ClothCamera *camera = &result->rig->cameras[c];
    const ClothBundleView *view = &p.input.views[13 * c];
    gdouble centre[3], worst = 0;

    cloth_mat3_vec_t (camera->R, camera->t, centre);
    g_assert_cmpfloat (-centre[2], >, 0.2);
    g_assert_cmpuint (view->pose, ==, 0);
    for (guint i = 0; i < view->n; i++) {
      gdouble X[3], px[2];

      cloth_mat3_vec (result->poses, p.board + 3 * view->vertex[i], X);
      for (gint j = 0; j < 3; j++)
        X[j] += result->poses[9 + j];
      g_assert_cmpfloat (fabs (X[2]), <, 1e-12);
      g_assert_true (cloth_camera_project (camera, X, px, NULL, NULL));
      worst = fmax (worst, hypot (px[0] - view->x[i], px[1] - view->y[i]));
    }
    g_assert_cmpfloat (worst, <, 2);
    g_assert_cmpmem (camera->k, sizeof camera->k, result->rig->cameras[0].k,
        sizeof camera->k);
  }
  g_assert_true (isnan (result->left_out_rms));
}

/* Poses @first to @last of the corners of both cameras of the real pair. */
static void
real_pair (Problem * p, guint last_left, guint first_right)
{
  const gint use[2] = { 0, 1 };

  problem_init (p, 2, 9, 6, 0.025, 13);
  load_corners (p, use);
  for (guint v = p->views->len; v-- > 0;) {
    ClothBundleView *view = &g_array_index (p->views, ClothBundleView, v);

    if (view->camera == 0 ? view->pose > last_left : view->pose < first_right)
      view->n = 0;
  }
}

static void
test_bad (void)
{
  ClothCalibrateParams params;

  cloth_calibrate_params_init (&params);
  {
    g_auto (Problem) p;

    problem_init (&p, 1, 9, 6, 0.025, 13);
    assert_fails (&p, NULL, "camera cam0: the board was found in 0 views");
  }
  {
    g_auto (Problem) p;

    real_pair (&p, 0, 0);
    assert_fails (&p, NULL, "camera cam0: the board was found in 1 views");
  }
  {
    g_auto (Problem) p;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothCalibration) result = NULL;

    real_pair (&p, 5, 6);
    assert_fails (&p, NULL,
        "cameras cam1 share no view of the board with cam0");
    /* But each can be calibrated. */
    params.intrinsics_only = TRUE;
    result = cloth_calibrate (&p.input, &params, NULL, NULL, NULL, &error);
    g_assert_no_error (error);
    g_assert_false (result->placed);
    g_assert_cmpfloat (fabs (result->rig->cameras[0].K[0] - 533), <, 5);
    g_assert_cmpfloat (result->rig->cameras[1].t[0], ==, 0);
    params.intrinsics_only = FALSE;
  }
  {
    g_auto (Problem) p;

    /* Pictures of the second camera one pose late. */
    real_pair (&p, 12, 0);
    for (guint v = 13; v < 26; v++) {
      ClothBundleView *view = &g_array_index (p.views, ClothBundleView, v);

      view->pose = (view->pose + 1) % 13;
    }
    assert_fails (&p, NULL, "taken at the same moment");
  }
  {
    g_auto (Problem) p;

    real_pair (&p, 12, 0);
    ((gdouble *) p.input.views[3].x)[7] = NAN;
    assert_fails (&p, NULL, "view 3: corner 7 is not finite");
  }
  {
    g_auto (Problem) p;
    gdouble *cov;

    real_pair (&p, 12, 0);
    cov = g_new0 (gdouble, 3 * 54);
    cov[1] = 1;
    g_array_index (p.views, ClothBundleView, 2).cov = cov;
    assert_fails (&p, NULL, "view 2: corner 0 has no valid covariance");
  }
  {
    g_auto (Problem) p;

    real_pair (&p, 12, 0);
    g_array_index (p.views, ClothBundleView, 2).pose = 1;
    assert_fails (&p, NULL, "camera cam0 sees pose 1 twice");
    g_array_index (p.views, ClothBundleView, 2).pose = 77;
    assert_fails (&p, NULL, "out of range");
    g_array_index (p.views, ClothBundleView, 2).pose = 2;
    ((guint *) p.input.views[3].vertex)[7] = 54;
    assert_fails (&p, NULL, "vertex 54 is out of range");
    ((guint *) p.input.views[3].vertex)[7] = 7;
    p.cameras[1].width = 0;
    assert_fails (&p, NULL, "camera cam1: impossible size");
    p.cameras[1].width = 640;
    p.board[5] = 0.01;
    assert_fails (&p, NULL, "vertex 1 of the board");
  }
}

/* All boards alike: straight on, or all tilted the same way. */
static void
test_parallel (gconstpointer data)
{
  const gdouble tilt = *(const gdouble *) data;
  ClothRandom random;
  ClothCamera truth[4] = { 0, };
  g_auto (Problem) p;

  cloth_random_init (&random, 5);
  problem_init (&p, 1, 9, 7, 0.03, 12);
  true_rig (p.cameras);
  truth[0] = p.cameras[0];
  for (guint v = 0; v < 12; v++) {
    gdouble P[12], r[3] = { tilt, 0, 0 };

    true_pose (&random, 0, P);
    cloth_rotation_from_vector (r, P);
    see (&p, truth, 0, v, P, &random, 0.1, FALSE);
  }
  assert_fails (&p, NULL, "20° to 45°");
}

static void
test_cancel (void)
{
  const gint use[2] = { 0, 1 };
  g_auto (Problem) p;
  g_autoptr (GError) error = NULL;
  g_autoptr (GCancellable) cancellable = g_cancellable_new ();
  ClothCalibrateParams params;

  problem_init (&p, 2, 9, 6, 0.025, 13);
  load_corners (&p, use);
  cloth_calibrate_params_init (&params);
  g_cancellable_cancel (cancellable);
  g_assert_null (cloth_calibrate (&p.input, &params, NULL, NULL, cancellable,
          &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
}

int
main (int argc, char **argv)
{
  static const gdouble straight = 0, tilted = 0.5;

  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/calibrate/opencv-one", test_opencv_one);
  g_test_add_func ("/calibrate/opencv-stereo", test_opencv_stereo);
  g_test_add_func ("/calibrate/exact", test_exact);
  g_test_add_func ("/calibrate/deviations", test_deviations);
  g_test_add_func ("/calibrate/outliers", test_outliers);
  g_test_add_func ("/calibrate/symmetric", test_symmetric);
  g_test_add_func ("/calibrate/rational", test_rational);
  g_test_add_func ("/calibrate/shreds", test_shreds);
  g_test_add_func ("/calibrate/world", test_world);
  g_test_add_func ("/calibrate/bad", test_bad);
  g_test_add_data_func ("/calibrate/straight", &straight, test_parallel);
  g_test_add_data_func ("/calibrate/tilted", &tilted, test_parallel);
  g_test_add_func ("/calibrate/cancel", test_cancel);
  return g_test_run ();
}
