/* Triangulation against exact geometry, its own predicted scatter, and a printed cylinder
 * measured by others (MultiDIC).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/core/triangulatescene.h"

/* Points filmed without noise come back, through every lens, by 2 to 8 cameras. */
static void
test_exact (void)
{
  static const gchar *const names[] = { "none", "brown5", "brown8", "fisheye" };

  for (guint lens = 0; lens < 4; lens++) {
    gdouble worst = 0., worst_chi2 = 0.;

    for (guint n = 2; n <= MAX_VIEWS; n++) {
      ClothCamera cameras[MAX_VIEWS];
      ClothRandom random;
      g_auto (Scene) scene = { 0 };
      g_autofree gdouble *truth = g_new (gdouble, 3 * 501);
      g_autoptr (ClothTriangulator) triangulator = NULL;
      const ClothTriangulation *r;

      cloth_random_init (&random, n);
      scene_init (&scene, n, 501);
      for (guint i = 0; i < n; i++)
        make_camera (&cameras[i], i, n, (ClothLens) lens);
      for (guint k = 0; k < scene.n_points; k++) {
        random_point (&random, truth + 3 * k);
        film (&scene, cameras, k, truth + 3 * k);
      }
      triangulator = make (cameras, n);
      r = run (triangulator, &scene);
      for (guint k = 0; k < scene.n_points; k++) {
        g_assert_cmpuint (r->state[k], ==,
            n > 2 ? CLOTH_POINT_MEASURED : CLOTH_POINT_TWO_VIEWS);
        g_assert_cmpuint (r->reason[k], ==, CLOTH_POINT_FINE);
        g_assert_cmpuint (r->n_views[k], ==, n);
        g_assert_cmpuint (r->n_rejected[k], ==, 0);
        g_assert_cmpuint (r->views[k], ==, (1u << n) - 1);
        worst = fmax (worst, distance (r, k, truth + 3 * k));
        worst_chi2 = fmax (worst_chi2, r->chi2[k]);
      }
    }
    g_test_message ("%s: greatest error %.2g m, greatest chi2 %.2g",
        names[lens], worst, worst_chi2);
    g_assert_cmpfloat (worst, <, 1e-12);
    g_assert_cmpfloat (worst_chi2, <, 1e-16);
  }
}

/* Short focal lengths and points all around: up to the border of the picture, beyond it,
 * and beyond the angle up to which vector instructions undistort. */
static void
test_wide (void)
{
  for (guint lens = 1; lens < 4; lens++) {
    enum
    { N = 2003 };
    ClothCamera cameras[4];
    ClothRandom random;
    g_auto (Scene) scene = { 0 };
    g_autofree gdouble *truth = g_new (gdouble, 3 * N);
    g_autoptr (ClothTriangulator) triangulator = NULL;
    const ClothTriangulation *r;
    guint n_border = 0, n_outside = 0, n_steep = 0;
    gdouble worst = 0.;

    cloth_random_init (&random, lens);
    scene_init (&scene, 4, N);
    for (guint i = 0; i < 4; i++) {
      make_camera (&cameras[i], i, 4, (ClothLens) lens);
      cameras[i].K[0] = lens == CLOTH_LENS_FISHEYE ? 500. : 1200.;
      cameras[i].K[4] = lens == CLOTH_LENS_FISHEYE ? 490. : 1190.;
    }
    for (guint k = 0; k < N; k++) {
      gdouble *X = truth + 3 * k, px[2];
      gboolean seen = FALSE;

      while (!seen) {
        seen = TRUE;
        for (gint j = 0; j < 3; j++)
          X[j] = (j == 0 ? 10. : j == 1 ? -5. : 1.) +
              (lens == CLOTH_LENS_FISHEYE ? 3.4 : 2.2) *
              (cloth_random_uniform (&random) - 0.5);
        for (guint i = 0; i < 4; i++)
          seen = seen && cloth_camera_project (&cameras[i], X, px, NULL, NULL)
              && fabs (px[0] - 960.) < 1160. && fabs (px[1] - 540.) < 740.;
      }
      film (&scene, cameras, k, X);
      for (guint i = 0; i < 4; i++) {
        const gdouble *R = cameras[i].R + 6;
        gdouble x = plane (&scene, i, 0)[k], y = plane (&scene, i, 1)[k], d2 =
            0.;
        gdouble z = cameras[i].t[2];

        for (gint j = 0; j < 3; j++) {
          gdouble c = X[j] + cameras[i].R[j] * cameras[i].t[0] +
              cameras[i].R[3 + j] * cameras[i].t[1] + R[j] * cameras[i].t[2];

          d2 += c * c;
          z += R[j] * X[j];
        }
        n_steep += z < 0.05 * sqrt (d2);
        if (x < 0. || y < 0. || x > 1919. || y > 1079.)
          n_outside++;
        else
          n_border += x < 50. || y < 50. || x > 1869. || y > 1029.;
      }
    }
    triangulator = make (cameras, 4);
    r = run (triangulator, &scene);
    for (guint k = 0; k < N; k++) {
      g_assert_cmpuint (r->views[k], ==, 15);
      worst = fmax (worst, distance (r, k, truth + 3 * k));
    }
    g_test_message
        ("lens %u: greatest error %.2g m; %u places near the border, %u "
        "outside, %u beyond 87 degrees", lens, worst, n_border, n_outside,
        n_steep);
    g_assert_cmpuint (n_border, >, 50);
    g_assert_cmpuint (n_outside, >, 50);
    g_assert_cmpuint (n_steep, >=, lens == CLOTH_LENS_FISHEYE ? 5 : 0);
    g_assert_cmpfloat (worst, <, 1e-12);
  }
}

/* A draw of a bivariate normal of covariance c. */
static void
draw (ClothRandom * random, const gdouble c[3], gdouble e[2])
{
  gdouble a = cloth_random_gaussian (random), b =
      cloth_random_gaussian (random);
  gdouble l = sqrt (c[0]);

  e[0] = l * a;
  e[1] = c[1] / l * a + sqrt (c[2] - c[1] * c[1] / c[0]) * b;
}

/* The scatter of many noisy takes is the covariance predicted, in every direction. */
static void
test_covariance (void)
{
  static const guint counts[] = { 2, 3, 5, 8 };
  enum
  { N = 20000 };

  for (guint c = 0; c < G_N_ELEMENTS (counts); c++) {
    for (guint lens = 0; lens < 3; lens += 2) {
      guint n = counts[c], used = 0;
      ClothCamera cameras[MAX_VIEWS];
      ClothRandom random;
      g_auto (Scene) scene = { 0 };
      g_autoptr (ClothTriangulator) triangulator = NULL;
      const ClothTriangulation *r;
      const gdouble X[3] = { 10.2, -4.9, 1.15 };
      gdouble mean[3] = { 0. }, scatter[6] = { 0. }, predicted[6] = { 0. };
      gdouble chi2 = 0., mahalanobis = 0.;
      ClothTriangulateParameters p = CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;

      cloth_random_init (&random, 100 + n);
      scene_init (&scene, n, N);
      for (guint i = 0; i < n; i++)
        make_camera (&cameras[i], i, n, (ClothLens) lens);
      for (guint k = 0; k < N; k++) {
        film (&scene, cameras, k, X);
        for (guint i = 0; i < n; i++) {
          /* each camera its own, half of it by way of the error floor */
          gdouble s = 0.04 * (i + 1), floor = 0.01, e[2];
          gdouble cov[3] = { s * s + floor, -0.4 * s * s,
            0.5 * s * s + floor
          };

          draw (&random, cov, e);
          plane (&scene, i, 0)[k] += e[0];
          plane (&scene, i, 1)[k] += e[1];
          plane (&scene, i, 2)[k] = s * s;
          plane (&scene, i, 3)[k] = cov[1];
          plane (&scene, i, 4)[k] = 0.5 * s * s;
        }
      }
      triangulator = make (cameras, n);
      p.error_floor = 0.01;
      cloth_triangulator_set_parameters (triangulator, &p);
      r = run (triangulator, &scene);
      for (guint k = 0; k < N; k++) {
        gdouble e[3], w[3], l[9];
        guint at = 0;

        if (r->n_views[k] < n)
          continue;
        used++;
        for (gint j = 0; j < 3; j++)
          w[j] = e[j] = r->position[j][k] - X[j];
        for (gint i = 0; i < 3; i++) {
          mean[i] += e[i];
          for (gint j = i; j < 3; j++, at++) {
            scatter[at] += e[i] * e[j];
            predicted[at] += r->covariance[at][k];
            l[3 * j + i] = r->covariance[at][k];
          }
        }
        g_assert_true (cloth_cholesky_factor (3, l));
        cloth_cholesky_solve (3, l, w);
        mahalanobis += e[0] * w[0] + e[1] * w[1] + e[2] * w[2];
        chi2 += r->chi2[k];
      }
      g_test_message ("%u views, lens %u: scatter/predicted %.3f %.3f %.3f, "
          "mahalanobis²/3 %.3f, chi2/dof %.3f, σ %.3f %.3f %.3f mm, "
          "rejected %.2f%%", n, lens, scatter[0] / predicted[0],
          scatter[3] / predicted[3], scatter[5] / predicted[5],
          mahalanobis / used / 3., chi2 / used / (2. * n - 3.),
          1e3 * sqrt (predicted[0] / used), 1e3 * sqrt (predicted[3] / used),
          1e3 * sqrt (predicted[5] / used), 100. - 100. * (gdouble) used / N);
      g_assert_cmpfloat ((gdouble) used, >, N * 0.99);
      for (guint k = 0; k < 6; k++) {
        static const guint diagonal[6][2] = { {0, 0}, {0, 3}, {0, 5}, {3, 3},
        {3, 5}, {5, 5}
        };
        gdouble size = sqrt (predicted[diagonal[k][0]] *
            predicted[diagonal[k][1]]);

        g_assert_cmpfloat (fabs (scatter[k] - predicted[k]), <, 0.05 * size);
      }
      for (gint j = 0; j < 3; j++)
        g_assert_cmpfloat (fabs (mean[j]), <,
            5. * sqrt (predicted[j == 0 ? 0 : j == 1 ? 3 : 5]));
      g_assert_cmpfloat_with_epsilon (mahalanobis / used / 3., 1., 0.05);
      g_assert_cmpfloat_with_epsilon (chi2 / used / (2. * n - 3.), 1., 0.05);
    }
  }
}

/* One to three wrong views among the others: found, named and left out. */
static void
test_outliers (void)
{
  static const struct
  {
    guint n_views, n_wrong;
  } cases[] = { {3, 1}, {4, 1}, {5, 2}, {8, 1}, {8, 2}, {8, 3}, {20, 1},
  {20, 6}
  };

  for (guint c = 0; c < G_N_ELEMENTS (cases); c++) {
    guint n = cases[c].n_views, n_points = 500;
    guint found = 0, false_point = 0, given_up = 0, exact = 0;
    ClothCamera cameras[MAX_VIEWS];
    ClothRandom random;
    g_auto (Scene) scene = { 0 };
    g_autofree gdouble *truth = g_new (gdouble, 3 * n_points);
    g_autofree guint *wrong = g_new0 (guint, n_points);
    g_autoptr (ClothTriangulator) triangulator = NULL;
    const ClothTriangulation *r;

    cloth_random_init (&random, 7 + c);
    scene_init (&scene, n, n_points);
    for (guint i = 0; i < n; i++)
      make_camera (&cameras[i], i, n, CLOTH_LENS_BROWN5);
    for (guint k = 0; k < n_points; k++) {
      random_point (&random, truth + 3 * k);
      film (&scene, cameras, k, truth + 3 * k);
      for (guint i = 0; i < n; i++) {
        plane (&scene, i, 0)[k] += 0.1 * cloth_random_gaussian (&random);
        plane (&scene, i, 1)[k] += 0.1 * cloth_random_gaussian (&random);
      }
      for (guint w = 0; w < cases[c].n_wrong; w++) {
        guint view;
        gdouble angle = 2. * G_PI * cloth_random_uniform (&random);
        gdouble size = 3. + 40. * cloth_random_uniform (&random);

        do {
          view = cloth_random_below (&random, n);
        } while (wrong[k] & (1u << view));
        wrong[k] |= 1u << view;
        plane (&scene, view, 0)[k] += size * cos (angle);
        plane (&scene, view, 1)[k] += size * sin (angle);
      }
    }
    triangulator = make (cameras, n);
    r = run (triangulator, &scene);
    for (guint k = 0; k < n_points; k++) {
      if (r->state[k] == CLOTH_POINT_UNSEEN)
        given_up++;
      else if (r->views[k] & wrong[k])
        false_point++;
      else
        found++;
      if (r->state[k] != CLOTH_POINT_UNSEEN && !(r->views[k] & wrong[k])) {
        /* 0.1 px is 0.13 mm at 2 m; two views see depth three times worse */
        g_assert_cmpfloat (distance (r, k, truth + 3 * k), <, 4e-3);
        g_assert_cmpuint (r->n_views[k] + r->n_rejected[k], ==, n);
        /* of the others one in some hundred points is beyond 4 σ by chance */
        if (r->views[k] == (((1u << n) - 1) & ~wrong[k]))
          exact++;
      }
    }
    g_test_message
        ("%u views, %u of them wrong: %u of %u points right, %u from all "
        "good views, %u given up, %u with a wrong view", n, cases[c].n_wrong,
        found, n_points, exact, given_up, false_point);
    g_assert_cmpuint (false_point, <=, n_points / 100);
    g_assert_cmpuint (found, >=, n_points * (n == 3 ? 80 : n == 5 ? 80 : 97)
        / 100);
    g_assert_cmpuint (exact, >=, found * 97 / 100);
  }
}

/* max_error alone also removes a view. */
static void
test_max_error (void)
{
  ClothCamera cameras[4];
  g_auto (Scene) scene = { 0 };
  g_autoptr (ClothTriangulator) triangulator = NULL;
  ClothTriangulateParameters p = CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;
  const ClothTriangulation *r;
  const gdouble X[3] = { 10., -5., 1. };

  scene_init (&scene, 4, 1);
  for (guint i = 0; i < 4; i++)
    make_camera (&cameras[i], i, 4, CLOTH_LENS_NONE);
  film (&scene, cameras, 0, X);
  plane (&scene, 2, 0)[0] += 3.;
  for (guint i = 0; i < 4; i++)
    plane (&scene, i, 2)[0] = plane (&scene, i, 4)[0] = 9.;
  triangulator = make (cameras, 4);
  r = run (triangulator, &scene);
  g_assert_cmpuint (r->views[0], ==, 15);
  p.max_error = 1.;
  cloth_triangulator_set_parameters (triangulator, &p);
  r = run (triangulator, &scene);
  g_assert_cmpuint (r->views[0], ==, 11);
  g_assert_cmpuint (r->n_rejected[0], ==, 1);
  g_assert_cmpfloat (distance (r, 0, X), <, 1e-12);
  p.min_views = 4;
  cloth_triangulator_set_parameters (triangulator, &p);
  r = run (triangulator, &scene);
  assert_unseen (r, 0, CLOTH_POINT_FEW_VIEWS);
}

static guint
read_csv (const gchar * name, guint n_columns, gdouble * rows, guint max_rows)
{
  g_autofree gchar *path = g_build_filename (TEST_DATA, "multidic", name, NULL);
  g_autofree gchar *text = NULL;
  g_autoptr (GError) error = NULL;
  g_auto (GStrv) lines = NULL;
  guint n = 0;

  g_file_get_contents (path, &text, NULL, &error);
  g_assert_no_error (error);
  lines = g_strsplit (text, "\n", -1);
  for (guint i = 0; lines[i] != NULL; i++) {
    g_auto (GStrv) fields = g_strsplit (lines[i], ",", -1);

    if (g_strv_length (fields) != n_columns || g_ascii_isalpha (lines[i][0]))
      continue;
    g_assert_cmpuint (n, <, max_rows);
    for (guint j = 0; j < n_columns; j++)
      rows[n * n_columns + j] = g_ascii_strtod (fields[j], NULL);
    n++;
  }
  return n;
}

/* MultiDIC's printed cylinder: its centroids and DLT parameters, its own reconstruction
 * to compare with, and the printed truth. No alignment: the DLT's world is the
 * cylinder's. */
static void
test_multidic (void)
{
  static gdouble centroids[2][200 * 4], truth[300 * 5], reference[120 * 6];
  gdouble projections[24], rms[2], reference_sum = 0.;
  guint n[2], n_truth, n_reference, at = 0;
  g_auto (Scene) scene = { 0 };
  g_autoptr (ClothTriangulator) triangulator = NULL;
  g_autoptr (GError) error = NULL;
  static gdouble points[200][3];

  n[0] = read_csv ("reference_centroids_201.csv", 4, centroids[0], 200);
  n[1] = read_csv ("reference_centroids_202.csv", 4, centroids[1], 200);
  n_truth = read_csv ("cylinder_true_points_mm.csv", 5, truth, 300);
  n_reference = read_csv ("reference_reconstruction_mm.csv", 6, reference, 120);
  g_assert_cmpuint (n_truth, ==, 280);
  g_assert_cmpuint (n_reference, ==, 100);
  g_assert_cmpuint (read_csv ("reference_DLT_201.csv", 12, projections, 1), ==,
      1);
  g_assert_cmpuint (read_csv ("reference_DLT_202.csv", 12, projections + 12, 1),
      ==, 1);

  scene_init (&scene, 2, 100);
  for (guint i = 0; i < n[0]; i++) {
    const gdouble *a = centroids[0] + 4 * i;

    for (guint j = 0; j < n[1]; j++) {
      const gdouble *b = centroids[1] + 4 * j;

      if (a[0] != b[0] || a[1] != b[1])
        continue;
      g_assert_cmpuint (at, <, 100);
      plane (&scene, 0, 0)[at] = a[2];
      plane (&scene, 0, 1)[at] = a[3];
      plane (&scene, 1, 0)[at] = b[2];
      plane (&scene, 1, 1)[at] = b[3];
      for (guint k = 0; k < n_truth; k++)
        if (truth[5 * k] == a[0] && truth[5 * k + 1] == a[1])
          memcpy (points[at], truth + 5 * k + 2, sizeof (points[at]));
      at++;
    }
  }
  g_assert_cmpuint (at, ==, 100);
  for (guint i = 0; i < n_reference; i++)
    for (gint j = 3; j < 6; j++)
      reference_sum += pow (reference[6 * i + j], 2) / 100.;

  triangulator = cloth_triangulator_new_projections (2, projections, &error);
  g_assert_no_error (error);
  for (guint weighted = 0; weighted < 2; weighted++) {
    /* the RMS residual of each camera's own DLT fit */
    static const gdouble sigma[2][2] = { {0.35, 0.35}, {0.367, 0.322} };
    gdouble sum[3] = { 0. }, worst = 0., difference = 0.;
    const ClothTriangulation *r;

    for (guint i = 0; i < 2; i++)
      for (guint k = 0; k < 100; k++)
        plane (&scene, i, 2)[k] = plane (&scene, i, 4)[k] =
            sigma[weighted][i] * sigma[weighted][i];
    r = run (triangulator, &scene);
    for (guint k = 0; k < 100; k++) {
      gdouble nearest = G_MAXDOUBLE;

      g_assert_cmpuint (r->state[k], ==, CLOTH_POINT_TWO_VIEWS);
      for (gint j = 0; j < 3; j++)
        sum[j] += pow (r->position[j][k] - points[k][j], 2) / 100.;
      worst = fmax (worst, distance (r, k, points[k]));
      for (guint i = 0; i < n_reference; i++)
        nearest = fmin (nearest, distance (r, k, reference + 6 * i));
      difference += nearest * nearest / 100.;
    }
    rms[weighted] = sqrt (sum[0] + sum[1] + sum[2]);
    g_test_message ("%s: 100 points, RMS %.5f mm (%.4f %.4f %.4f per axis), "
        "greatest %.4f; MultiDIC's RMS %.5f; RMS difference from it %.5f mm",
        weighted ? "each camera its own sigma" : "equal sigma", rms[weighted],
        sqrt (sum[0]), sqrt (sum[1]), sqrt (sum[2]), worst,
        sqrt (reference_sum), sqrt (difference));
  }
  g_assert_cmpfloat (rms[0], <, sqrt (reference_sum));
  g_assert_cmpfloat (rms[1], <=, 0.0598);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/triangulate/exact", test_exact);
  g_test_add_func ("/triangulate/wide", test_wide);
  g_test_add_func ("/triangulate/covariance", test_covariance);
  g_test_add_func ("/triangulate/outliers", test_outliers);
  g_test_add_func ("/triangulate/max-error", test_max_error);
  g_test_add_func ("/triangulate/multidic", test_multidic);
  return g_test_run ();
}
