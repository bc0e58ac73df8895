/* Calibration: boards and pictures that tell too little, what is refused, and the same
 * bytes from any number of threads.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/core/calibrateproblem.h"

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
    worst = fmax (worst, worst_deviation (result->rig, &truth, 4));
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
  gdouble worst;
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
  worst = worst_deviation (result->rig, truth, 12);
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
