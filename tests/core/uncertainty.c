/* The uncertainty of projections: mrcal's on the same corners, and the scatter of many
 * calibrations of known cameras.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/core/calibrateproblem.h"

#define COLUMNS CLOTH_UNCERTAINTY_COLUMNS
#define ROWS CLOTH_UNCERTAINTY_ROWS
#define NODES CLOTH_UNCERTAINTY_NODES

static ClothCalibration *
calibrate_board (const Problem * p, gboolean warp)
{
  g_autoptr (GError) error = NULL;
  ClothCalibrateParams params;
  ClothCalibration *result;

  cloth_calibrate_params_init (&params);
  params.huber = 1e9;           /* nor has mrcal outliers in these files */
  params.leave_out = 0;
  params.warp = warp;
  result = cloth_calibrate (&p->input, &params, NULL, NULL, NULL, &error);
  g_assert_no_error (error);
  return result;
}

static ClothCalibration *
calibrate (const Problem * p)
{
  return calibrate_board (p, FALSE);
}

/* mrcal.txt holds what mrcal says of the same corners. It divides the squares of residuals
 * by their number, we by the degrees of freedom. */
static void
compare_with_mrcal (gint n, const gint * use, gdouble limit)
{
  g_autofree gchar *text = NULL;
  g_auto (Problem) p;
  g_autoptr (ClothCalibration) result = NULL;
  gdouble worst = 0, centre = 0, corner = 0, measured = n * 2 * 702;
  gdouble dof = measured - n * 9 - (n - 1) * 6 - 13 * 6;
  gdouble numbers = 0;
  guint n_lines = 0, n_cameras = 0;

  problem_init (&p, (guint) n, 9, 6, 0.025, 13);
  load_corners (&p, use);
  result = calibrate (&p);
  g_assert_true (g_file_get_contents (TEST_DATA "/opencv_boards/mrcal.txt",
          &text, NULL, NULL));
  for (gchar * line = text; line && *line; line = strchr (line, '\n') + 1) {
    gint count, side, column, row;
    gdouble k[10], x, y, near, far, got[2];
    const ClothUncertaintyMap *map;

    if (sscanf (line, "lens %d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf",
            &count, &side, k, k + 1, k + 2, k + 3, k + 4, k + 5, k + 6, k + 7,
            k + 8, k + 9) == 12) {
      if (count == n && use[side] >= 0)
        g_assert_cmpfloat (fabs (result->cameras[use[side]].map.distance / k[9]
                - 1), <, 1e-3);
      continue;
    }
    if (sscanf (line, "sd %d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf", &count,
            &side, k, k + 1, k + 2, k + 3, k + 4, k + 5, k + 6, k + 7, k + 8)
        == 11 && count == n && use[side] >= 0) {
      for (guint i = 0; i < 9; i++) {
        gdouble sd;

        parameter (&result->rig->cameras[use[side]], i, &sd);
        g_assert_true (isfinite (sd));
        numbers = fmax (numbers, fabs (sd * sqrt (dof / measured) / k[i] - 1));
      }
      n_cameras++;
      continue;
    }
    if (sscanf (line, "px %d %d %lf %lf %lf %lf", &count, &side, &x, &y, &near,
            &far) != 6 || count != n || use[side] < 0)
      continue;
    map = &result->cameras[use[side]].map;
    column = (gint) lround (x / 639 * (COLUMNS - 1));
    row = (gint) lround (y / 479 * (ROWS - 1));
    got[0] = map->near[row * COLUMNS + column] * sqrt (dof / measured);
    got[1] = map->far[row * COLUMNS + column] * sqrt (dof / measured);
    worst = fmax (worst, fabs (got[0] / near - 1));
    worst = fmax (worst, fabs (got[1] / far - 1));
    if (column == COLUMNS / 2 && row == ROWS / 2)
      centre = got[1] / far;
    else if (column == 0 && row == 0)
      corner = got[1] / far;
    n_lines++;
  }
  g_test_message ("%d cameras, %u places: within %.2f%% of mrcal's (centre "
      "%.4f, corner %.4f times), deviations of the numbers within %.2f%%", n,
      n_lines, 100 * worst, centre, corner, 100 * numbers);
  g_assert_cmpuint (n_cameras, ==, (guint) n);
  g_assert_cmpfloat (numbers, <, limit);
  g_assert_cmpuint (n_lines, ==, (guint) n * 25);
  g_assert_cmpfloat (worst, <, limit);
}

static void
test_mrcal_one (void)
{
  const gint left[2] = { 0, -1 }, right[2] = { -1, 0 };

  compare_with_mrcal (1, left, 0.001);
  compare_with_mrcal (1, right, 0.001);
}

/* mrcal weighs both cameras alike, we by their scatter. */
static void
test_mrcal_pair (void)
{
  const gint both[2] = { 0, 1 };

  compare_with_mrcal (2, both, 0.1);
}

static void
compare_bent (gint side, const gdouble k[9], const gdouble warp[2], gdouble far)
{
  const gint use[2] = { side ? -1 : 0, side ? 0 : -1 };
  gdouble dof = 2 * 702 - 9 - 13 * 6 - 2, worst = 0, sd;
  g_auto (Problem) p;
  g_autoptr (ClothCalibration) result = NULL;

  problem_init (&p, 1, 9, 6, 0.025, 13);
  load_corners (&p, use);
  result = calibrate_board (&p, TRUE);
  for (guint i = 0; i < 9; i++) {
    gdouble value = parameter (&result->rig->cameras[0], i, &sd);

    worst = fmax (worst, fabs (value - k[i]) / sd);
  }
  for (guint i = 0; i < 2; i++)
    worst = fmax (worst, fabs (result->warp[i] - warp[i])
        / result->warp_sd[i]);
  g_test_message ("warp %.4f ± %.4f, %.4f ± %.4f mm; all within %.1e σ of "
      "mrcal's", 1e3 * result->warp[0], 1e3 * result->warp_sd[0],
      1e3 * result->warp[1], 1e3 * result->warp_sd[1], worst);
  g_assert_cmpfloat (worst, <, 0.01);
  g_assert_cmpfloat (fabs (result->cameras[0].map.far[NODES / 2]
          * sqrt (dof / (2 * 702)) / far - 1), <, 0.001);
}

/* The same where the board may be bent. */
static void
test_mrcal_bent (void)
{
  g_autofree gchar *text = NULL;
  guint n_lines = 0;

  g_assert_true (g_file_get_contents (TEST_DATA "/opencv_boards/mrcal.txt",
          &text, NULL, NULL));
  for (gchar * line = text; line && *line; line = strchr (line, '\n') + 1) {
    gint count, side;
    gdouble k[9], warp[2], far;

    if (sscanf (line, "bent %d %d %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf "
            "%lf", &count, &side, k, k + 1, k + 2, k + 3, k + 4, k + 5, k + 6,
            k + 7, k + 8, warp, warp + 1, &far) != 14 || count != 1)
      continue;
    compare_bent (side, k, warp, far);
    n_lines++;
  }
  g_assert_cmpuint (n_lines, ==, 2);
}

#define RUNS 100
#define PLACES 5

/* Where cameras see points that are known beside the boards: the scatter of many
 * calibrations against the map. The second camera misses some poses. */
static void
test_scatter (void)
{
  static const guint places[PLACES] = { 0, COLUMNS - 1, NODES / 2,
    NODES - COLUMNS, NODES - 1 - 6 * COLUMNS - 8
  };
  static gdouble seen[RUNS][2][PLACES][2][2];
  static ClothUncertaintyMap predicted[2];
  ClothCamera truth[2];
  gdouble poses[12][12], worst = 0;
  ClothRandom random;

  cloth_random_init (&random, 11);
  for (guint v = 0; v < 12; v++)
    true_pose (&random, 0.7, poses[v]);
  for (guint run = 0; run < RUNS; run++) {
    g_auto (Problem) p;
    g_autoptr (ClothCalibration) result = NULL;

    problem_init (&p, 2, 9, 7, 0.03, 12);
    true_rig (p.cameras);
    memcpy (truth, p.cameras, sizeof truth);
    for (guint v = 0; v < 12; v++) {
      for (guint c = 0; c < 2; c++) {
        if (c == 0 || v % 3)
          see (&p, &truth[c], c, v, poses[v], &random, 0.1, TRUE);
      }
    }
    result = calibrate (&p);
    for (guint c = 0; c < 2; c++) {
      const ClothUncertaintyMap *map = &result->cameras[c].map;

      for (guint i = 0; i < NODES; i++) {
        predicted[c].near[i] += map->near[i] * map->near[i] / RUNS;
        predicted[c].far[i] += map->far[i] * map->far[i] / RUNS;
      }
      for (guint i = 0; i < 2 * PLACES; i++) {
        gboolean far = i & 1;
        gdouble px[2], ray[3] = { 0, 0, 1 }, d[3], X[3], Y[3] = { 0, 0, 0 };
        ClothCamera camera = result->rig->cameras[c];
        guint n = 0;

        /* In the true world, then beside each board, then in the world of the result. */
        cloth_uncertainty_node (&truth[c], places[i / 2], px);
        g_assert_cmpuint (cloth_camera_undistort_points (&truth[c], 1, px,
                px + 1, ray, ray + 1, NULL), ==, 1);
        for (guint j = 0; j < 3; j++)
          d[j] = far ? ray[j] : 0.6 * ray[j]
              / sqrt (ray[0] * ray[0] + ray[1] * ray[1] + 1) - truth[c].t[j];
        cloth_mat3_vec_t (truth[c].R, d, X);
        for (guint v = 0; v < 12; v++) {
          const gdouble *P = result->poses + 12 * v;
          gdouble a[3], b[3];

          if (c == 1 && v % 3 == 0)
            continue;
          for (guint j = 0; j < 3; j++)
            a[j] = far ? X[j] : X[j] - poses[v][9 + j];
          cloth_mat3_vec_t (poses[v], a, b);
          cloth_mat3_vec (P, b, a);
          for (guint j = 0; j < 3; j++)
            Y[j] += far ? a[j] : a[j] + P[9 + j];
          n++;
        }
        for (guint j = 0; j < 3; j++)
          Y[j] /= n;
        if (far)
          memset (camera.t, 0, sizeof camera.t);
        g_assert_true (cloth_camera_project (&camera, Y, px, NULL, NULL));
        memcpy (seen[run][c][i / 2][far], px, sizeof px);
      }
      predicted[c].distance += map->distance / RUNS;
    }
  }
  for (guint i = 0; i < 4 * PLACES; i++) {
    guint c = i & 1, far = i >> 1 & 1, place = i / 4;
    gdouble mean[2] = { 0, 0 }, V[3] = { 0, 0, 0 }, largest, sd;

    for (guint run = 0; run < RUNS; run++) {
      for (guint j = 0; j < 2; j++)
        mean[j] += seen[run][c][place][far][j] / RUNS;
    }
    for (guint run = 0; run < RUNS; run++) {
      const gdouble *px = seen[run][c][place][far];

      V[0] += (px[0] - mean[0]) * (px[0] - mean[0]) / (RUNS - 1);
      V[1] += (px[0] - mean[0]) * (px[1] - mean[1]) / (RUNS - 1);
      V[2] += (px[1] - mean[1]) * (px[1] - mean[1]) / (RUNS - 1);
    }
    largest = sqrt (0.5 * (V[0] + V[2]) + hypot (0.5 * (V[0] - V[2]), V[1]));
    sd = sqrt ((far ? predicted[c].far : predicted[c].near)[places[place]]);
    g_test_message ("camera %u, node %3u, %s: scatter %.4f, predicted %.4f px, "
        "ratio %.3f", c, places[place], far ? "far " : "near", largest, sd,
        largest / sd);
    worst = fmax (worst, fabs (largest / sd - 1));
  }
  g_test_message ("boards %.2f and %.2f m away; worst ratio off by %.0f%%",
      predicted[0].distance, predicted[1].distance, 100 * worst);
  g_assert_cmpfloat (worst, <, 0.25);
}

/* A camera whose boards stay in the left half knows its right half less. */
static void
test_coverage (void)
{
  ClothRandom random;
  ClothCamera truth[4] = { 0, };
  g_auto (Problem) p;
  g_autoptr (ClothCalibration) result = NULL;
  const ClothUncertaintyMap *map;
  guint left = (ROWS / 2) * COLUMNS, right = left + COLUMNS - 1;

  cloth_random_init (&random, 5);
  problem_init (&p, 1, 9, 7, 0.03, 12);
  true_rig (p.cameras);
  truth[0] = p.cameras[0];
  for (guint v = 0; v < 12; v++) {
    gdouble P[12];

    true_pose (&random, 0.7, P);
    P[9] -= 0.28;
    see (&p, &truth[0], 0, v, P, &random, 0.1, FALSE);
  }
  result = calibrate (&p);
  map = &result->cameras[0].map;
  g_test_message ("left %.3f px, right %.3f px", map->near[left],
      map->near[right]);
  g_assert_cmpfloat (map->near[right], >, 3 * map->near[left]);
}

#define TRIALS 24

/* Views that only noise tells apart agree. Those of a board that bulges by a sixtieth of its
 * length, taken for flat, do not: their parameters are off by more than they say. */
static void
test_disagreement (void)
{
  const gdouble bulges[2] = { 0, 0.004 };
  ClothRandom random;
  gdouble middle[2] = { 0, 0 }, missed[2] = { 0, 0 };
  guint n_disagree[2] = { 0, 0 };

  cloth_random_init (&random, 17);
  for (guint run = 0; run < 2 * TRIALS; run++) {
    guint bent = run & 1;
    g_auto (Problem) p;
    g_autoptr (ClothCalibration) result = NULL;
    const ClothUncertaintyMap *map;
    ClothCamera truth;

    problem_init (&p, 1, 9, 7, 0.03, 10);
    true_rig (p.cameras);
    truth = p.cameras[0];
    for (guint i = 0; i < p.input.n_vertices; i++) {
      gdouble u = 2 * (i % 9) / 8. - 1, v = 2 * (i / 9) / 6. - 1;

      p.board[3 * i + 2] = bulges[bent] * (1 - u * u) * (1 - v * v);
    }
    for (guint v = 0; v < 10; v++) {
      gdouble P[12];

      true_pose (&random, 0.7, P);
      see (&p, &truth, 0, v, P, &random, 0.1, FALSE);
    }
    for (guint i = 0; i < p.input.n_vertices; i++)
      p.board[3 * i + 2] = 0;
    result = calibrate (&p);
    map = &result->cameras[0].map;
    middle[bent] += map->disagreement / TRIALS;
    missed[bent] += worst_deviation (result->rig, &truth, 4) / TRIALS;
    n_disagree[bent] += cloth_uncertainty_disagrees (map, 10);
  }
  g_test_message ("flat: %.2f, %u of %d disagree, off by %.1f σ at the worst; "
      "bent: %.2f, %u, %.1f σ", middle[0], n_disagree[0], TRIALS, missed[0],
      middle[1], n_disagree[1], missed[1]);
  g_assert_cmpfloat (middle[0], >, 0.8);
  g_assert_cmpfloat (middle[0], <, 1.25);
  g_assert_cmpuint (n_disagree[0], <=, TRIALS / 6);
  g_assert_cmpfloat (missed[1], >, 4);
  g_assert_cmpuint (n_disagree[1], >=, TRIALS - TRIALS / 6);
}

/* What the warp is known to, against the scatter of many calibrations. */
static void
test_warp_scatter (void)
{
  enum
  { N = 48 };
  gdouble warp[N][2], predicted[2] = { 0, 0 };
  gdouble poses[8][12];
  ClothRandom random;

  cloth_random_init (&random, 29);
  for (guint v = 0; v < 8; v++)
    true_pose (&random, 0.7, poses[v]);
  for (guint run = 0; run < N; run++) {
    g_auto (Problem) p;
    g_autoptr (ClothCalibration) result = NULL;
    ClothCamera truth;

    problem_init (&p, 1, 9, 7, 0.03, 8);
    true_rig (p.cameras);
    truth = p.cameras[0];
    for (guint v = 0; v < 8; v++)
      see (&p, &truth, 0, v, poses[v], &random, 0.1, FALSE);
    result = calibrate_board (&p, TRUE);
    for (guint i = 0; i < 2; i++) {
      warp[run][i] = result->warp[i];
      predicted[i] += result->warp_sd[i] * result->warp_sd[i] / N;
    }
  }
  for (guint i = 0; i < 2; i++) {
    gdouble sum = 0, ratio;

    /* The true board is flat. */
    for (guint run = 0; run < N; run++)
      sum += warp[run][i] * warp[run][i] / N;
    ratio = sqrt (sum / predicted[i]);
    g_test_message ("warp %u: scatter %.4f mm, ratio %.2f", i, 1e3 * sqrt (sum),
        ratio);
    g_assert_cmpfloat (fabs (log (ratio)), <, 0.3);
  }
}

/* How a board is bent is found with two cameras, and what the views say then agrees. */
static void
test_bent (void)
{
  const gdouble warp[2] = { 0.004, -0.0015 };
  ClothRandom random;
  ClothCamera truth[4] = { 0, };
  g_auto (Problem) p;
  g_autoptr (ClothCalibration) flat = NULL, bent = NULL;
  gdouble worst = 0;

  cloth_random_init (&random, 23);
  problem_init (&p, 2, 9, 7, 0.03, 12);
  true_rig (p.cameras);
  memcpy (truth, p.cameras, 2 * sizeof *truth);
  for (guint i = 0; i < p.input.n_vertices; i++) {
    gdouble u = 2 * (i % 9) / 8. - 1, v = 2 * (i / 9) / 6. - 1;

    p.board[3 * i + 2] = warp[0] * (1 - u * u) + warp[1] * (1 - v * v);
  }
  for (guint v = 0; v < 12; v++) {
    gdouble P[12];

    true_pose (&random, 0.7, P);
    for (guint c = 0; c < 2; c++)
      see (&p, &truth[c], c, v, P, &random, 0.1, FALSE);
  }
  for (guint i = 0; i < p.input.n_vertices; i++)
    p.board[3 * i + 2] = 0;
  flat = calibrate (&p);
  bent = calibrate_board (&p, TRUE);
  for (guint i = 0; i < 2; i++) {
    worst = fmax (worst, fabs (bent->warp[i] - warp[i]) / bent->warp_sd[i]);
    g_assert_cmpfloat (bent->warp_sd[i], <, 1e-4);
    g_assert_cmpfloat (flat->warp[i], ==, 0);
    g_assert_cmpfloat (flat->warp_sd[i], ==, 0);
  }
  g_test_message
      ("warp within %.1f σ; disagreement %.2f, flat %.2f; parameters "
      "within %.1f σ, flat %.1f", worst, bent->cameras[0].map.disagreement,
      flat->cameras[0].map.disagreement, worst_deviation (bent->rig, truth, 12),
      worst_deviation (flat->rig, truth, 12));
  g_assert_cmpfloat (worst, <, 4);
  g_assert_cmpfloat (worst_deviation (bent->rig, truth, 12), <, 4);
  g_assert_cmpfloat (worst_deviation (flat->rig, truth, 12), >, 4);
  for (guint c = 0; c < 2; c++) {
    g_assert_false (cloth_uncertainty_disagrees (&bent->cameras[c].map, 12));
    g_assert_true (cloth_uncertainty_disagrees (&flat->cameras[c].map, 12));
  }
}

/* Three views of the shipped boards put the centre 5 px beside that of all of them. */
static void
test_three_views (void)
{
  const gint left[2] = { 0, -1 };
  gdouble centre[2], sd;
  guint least = cloth_uncertainty_least_views ();

  for (guint few = 0; few < 2; few++) {
    g_auto (Problem) p;
    g_autoptr (ClothCalibration) result = NULL;
    const ClothCalibrateCamera *camera;
    gdouble away[2], share;

    problem_init (&p, 1, 9, 6, 0.025, 13);
    load_corners (&p, left);
    if (few)
      p.input.n_views = 3;
    result = calibrate (&p);
    camera = &result->cameras[0];
    centre[few] = result->rig->cameras[0].K[2];
    sd = result->rig->cameras[0].K_sd[2];
    share = cloth_uncertainty_thin (&camera->map, camera->rms / G_SQRT2, away);
    g_test_message
        ("%u views: cx %.2f ± %.2f, %.1f times more scatter, %.0f%% "
        "less certain than a corner, around %.2f %.2f", camera->n_views,
        centre[few], sd, camera->map.disagreement, 100 * share, away[0],
        away[1]);
    /* The boards were at the right of the left camera's pictures. */
    g_assert_cmpfloat (away[0], <, -0.1);
    g_assert_cmpfloat (share, >, few ? 0.4 : 0.2);
    g_assert_cmpfloat (share, <, few ? 0.7 : 0.4);
    if (few)
      g_assert_true (cloth_uncertainty_disagrees (&camera->map, 3));
  }
  g_assert_cmpfloat (fabs (centre[1] - centre[0]), >, 3 * sd);
  /* Quantiles of the tables: 9 · 1.635 / 6 > 12.59 / 6, 9 · 1.145 / 5 < 11.07 / 5. */
  g_assert_cmpuint (least, ==, 7);
}

/* Where the lens folds back there is no projection to be certain of, nor behind it. */
static void
test_unknown (void)
{
  static gdouble board[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0 };
  static const guint vertex[4] = { 0, 1, 2, 3 };
  static const gdouble x[4] = { 100, 150, 100, 151 }, y[4] = { 10, 11, 61, 60 };
  static const gdouble behind[3] = { 0, 0, -1 }, ahead[3] = { 0, 0, 1 };
  gdouble pose[12] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, -2, -2, 10 }, cov[3];
  gdouble disagreement;
  gdouble excess = 0.1;
  guint none = 0, all = CLOTH_BUNDLE_FOCAL | CLOTH_BUNDLE_CENTRE;
  ClothCamera camera = { NULL, 640, 480, {500, 0, 200, 0, 500, 110, 0, 0, 1},
  CLOTH_LENS_BROWN5, {-0.5,}, {1, 0, 0, 0, 1, 0, 0, 0, 1}
  };
  const ClothBundleView view = { 0, 0, TRUE, 4, vertex, x, y, NULL };
  ClothBundle bundle = { 1, &camera, &none, FALSE, 1, pose, 1, &view, board,
    &excess, 3, 10, NULL
  };
  g_autoptr (ClothBundleSpread) spread = NULL;
  g_autoptr (GError) error = NULL;
  static ClothUncertaintyMap map;

  spread = cloth_bundle_spread_new (&bundle, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_bundle_spread_project (spread, 0, ahead, TRUE, cov,
          &disagreement));
  g_assert_false (cloth_bundle_spread_project (spread, 0, behind, TRUE, cov,
          &disagreement));
  g_assert_false (cloth_bundle_spread_project (spread, 0, behind, FALSE, cov,
          &disagreement));
  cloth_uncertainty_map (&bundle, spread, 0, &map);
  g_assert_false (isnan (map.near[NODES / 4]));
  g_assert_true (isnan (map.near[NODES - 1]) && isnan (map.far[NODES - 1]));
  g_clear_pointer (&spread, cloth_bundle_spread_free);

  /* One board does not determine a camera. */
  bundle.free = &all;
  spread = cloth_bundle_spread_new (&bundle, &error);
  g_assert_null (spread);
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/uncertainty/mrcal-one", test_mrcal_one);
  g_test_add_func ("/uncertainty/mrcal-pair", test_mrcal_pair);
  g_test_add_func ("/uncertainty/mrcal-bent", test_mrcal_bent);
  g_test_add_func ("/uncertainty/scatter", test_scatter);
  g_test_add_func ("/uncertainty/coverage", test_coverage);
  g_test_add_func ("/uncertainty/disagreement", test_disagreement);
  g_test_add_func ("/uncertainty/warp-scatter", test_warp_scatter);
  g_test_add_func ("/uncertainty/bent", test_bent);
  g_test_add_func ("/uncertainty/three-views", test_three_views);
  g_test_add_func ("/uncertainty/unknown", test_unknown);
  return g_test_run ();
}
