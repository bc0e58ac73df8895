/* Triangulation: the same bytes however it runs, and everything that is not a measurement.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/core/triangulatescene.h"

/* Any instructions and any number of threads: the same bytes. */
static void
test_same_bytes (void)
{
  static const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2,
    CLOTH_SIMD_AVX512
  };
  enum
  { N = 1003, SIZE = N * (10 * sizeof (gdouble) + 4 + 8) };

  for (guint lens = 0; lens < 4; lens++) {
    ClothCamera cameras[MAX_VIEWS];
    ClothRandom random;
    g_auto (Scene) scene = { 0 };
    g_autofree guint8 *first = NULL;

    cloth_random_init (&random, 3);
    scene_init (&scene, MAX_VIEWS, N);
    for (guint i = 0; i < MAX_VIEWS; i++) {
      make_camera (&cameras[i], i, MAX_VIEWS, (ClothLens) lens);
      if (lens == CLOTH_LENS_FISHEYE)
        cameras[i].K[0] = cameras[i].K[4] = 500.;
    }
    for (guint k = 0; k < N; k++) {
      gdouble X[3];

      /* up to where the lens takes more steps, and farther */
      random_point (&random, X);
      X[0] += 1.5 * (X[0] - 10.);
      X[1] += 1.5 * (X[1] + 5.);
      film (&scene, cameras, k, X);
      for (guint i = 0; i < MAX_VIEWS; i++) {
        plane (&scene, i, 0)[k] += 0.1 * cloth_random_gaussian (&random);
        plane (&scene, i, 3)[k] = 0.002 * cloth_random_gaussian (&random);
        if (cloth_random_below (&random, 4) == 0)
          plane (&scene, i, 1)[k] = NAN;
        if (cloth_random_below (&random, 20) == 0)
          plane (&scene, i, 1)[k] += 50.;
      }
    }
    for (guint l = 0; l < G_N_ELEMENTS (levels); l++) {
      for (guint threads = 1; threads <= 3; threads++) {
        g_autoptr (ClothPool) pool = cloth_pool_new (threads);
        g_autoptr (ClothTriangulator) triangulator = make (cameras, MAX_VIEWS);
        g_autofree guint8 *bytes = g_malloc (SIZE);
        const ClothTriangulation *r;
        guint8 *p = bytes;

        cloth_triangulator_set_pool (triangulator, pool);
        cloth_triangulator_set_simd (triangulator, levels[l]);
        r = run (triangulator, &scene);
        for (gint j = 0; j < 3; j++, p += N * 8)
          memcpy (p, r->position[j], N * 8);
        for (gint j = 0; j < 6; j++, p += N * 8)
          memcpy (p, r->covariance[j], N * 8);
        memcpy (p, r->chi2, N * 8);
        memcpy (p + N * 8, r->views, N * 8);
        memcpy (p + N * 16, r->state, N);
        memcpy (p + N * 17, r->reason, N);
        memcpy (p + N * 18, r->n_views, N);
        memcpy (p + N * 19, r->n_rejected, N);
        if (first == NULL)
          first = g_steal_pointer (&bytes);
        else
          g_assert_cmpmem (first, SIZE, bytes, SIZE);
      }
    }
  }
}

static void
test_wrong_counts (void)
{
  ClothCamera cameras[3];
  ClothTriangulateView views[3] = { {NULL} };
  g_autoptr (ClothTriangulator) triangulator = NULL;
  g_autoptr (GError) error = NULL;
  const ClothTriangulation *r;

  for (guint i = 0; i < 3; i++)
    make_camera (&cameras[i], i, 3, CLOTH_LENS_NONE);
  for (guint n = 0; n < 2; n++) {
    g_assert_null (cloth_triangulator_new (n, cameras, &error));
    g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
        CLOTH_TRIANGULATE_ERROR_CAMERAS);
    g_clear_error (&error);
  }
  g_assert_null (cloth_triangulator_new (65, cameras, &error));
  g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
      CLOTH_TRIANGULATE_ERROR_CAMERAS);
  g_clear_error (&error);

  triangulator = make (cameras, 3);
  g_assert_false (cloth_triangulator_run (triangulator, 2, views, 1, &r,
          &error));
  g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
      CLOTH_TRIANGULATE_ERROR_VIEWS);
  g_clear_error (&error);
  g_assert_false (cloth_triangulator_run (triangulator, 3, views, 1000001, &r,
          &error));
  g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
      CLOTH_TRIANGULATE_ERROR_POINTS);
  g_clear_error (&error);

  /* no points and no camera with anything are fine */
  g_assert_true (cloth_triangulator_run (triangulator, 3, views, 0, &r,
          &error));
  g_assert_cmpuint (r->n_points, ==, 0);
  g_assert_true (cloth_triangulator_run (triangulator, 3, views, 9, &r,
          &error));
  for (guint k = 0; k < 9; k++)
    assert_unseen (r, k, CLOTH_POINT_FEW_VIEWS);
}

static void
test_bad_cameras (void)
{
  ClothCamera cameras[2];
  g_autoptr (GError) error = NULL;
  gdouble P[24] = { 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 1.,
    1., 0., 0., -1., 0., 1., 0., 0., 0., 0., 1., 1.
  };
  ClothTriangulator *triangulator;

  for (guint fault = 0; fault < 7; fault++) {
    for (guint i = 0; i < 2; i++)
      make_camera (&cameras[i], i, 2, CLOTH_LENS_NONE);
    switch (fault) {
      case 0:
        cameras[1].K[0] = 0.;
        break;
      case 1:
        cameras[1].K[4] = -3.;
        break;
      case 2:
        cameras[1].t[1] = NAN;
        break;
      case 3:
        cameras[1].k[0] = INFINITY;
        break;
      case 4:
        cameras[1].R[0] *= -1.;
        break;
      case 5:
        memset (cameras[1].R, 0, sizeof (cameras[1].R));
        break;
      default:
        cameras[1].K[2] = NAN;
        break;
    }
    g_assert_null (cloth_triangulator_new (2, cameras, &error));
    g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
        CLOTH_TRIANGULATE_ERROR_CAMERA);
    g_clear_error (&error);
  }

  triangulator = cloth_triangulator_new_projections (2, P, &error);
  g_assert_no_error (error);
  cloth_triangulator_free (triangulator);
  for (guint j = 0; j < 2; j++) {
    /* an affine camera, then not a number */
    if (j == 0)
      P[22] = 0.;
    else
      P[22] = NAN;
    g_assert_null (cloth_triangulator_new_projections (2, P, &error));
    g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
        CLOTH_TRIANGULATE_ERROR_CAMERA);
    g_clear_error (&error);
  }
  g_assert_null (cloth_triangulator_new_projections (1, P, &error));
  g_assert_error (error, CLOTH_TRIANGULATE_ERROR,
      CLOTH_TRIANGULATE_ERROR_CAMERAS);
  g_clear_error (&error);
  cloth_triangulator_free (NULL);
}

/* What counts as not seen, for every lens: NaN and infinite places, covariances that are
 * none. The others of the same block are not touched by it. */
static void
test_not_seen (void)
{
  for (guint lens = 0; lens < 4; lens++) {
    ClothCamera cameras[3];
    g_auto (Scene) scene = { 0 };
    g_autoptr (ClothTriangulator) triangulator = NULL;
    const ClothTriangulation *r;
    const gdouble X[3] = { 10.1, -5.1, 1.1 };
    enum
    { N = 14 };

    scene_init (&scene, 3, N);
    for (guint i = 0; i < 3; i++)
      make_camera (&cameras[i], i, 3, (ClothLens) lens);
    for (guint k = 0; k < N; k++)
      film (&scene, cameras, k, X);
    /* two of three views spoilt */
    for (guint i = 0; i < 2; i++) {
      plane (&scene, i, 0)[0] = NAN;
      plane (&scene, i, 1)[1] = NAN;
      plane (&scene, i, 0)[2] = INFINITY;
      plane (&scene, i, 1)[3] = -INFINITY;
      plane (&scene, i, 2)[4] = NAN;
      plane (&scene, i, 2)[5] = INFINITY;
      plane (&scene, i, 4)[6] = INFINITY;
      plane (&scene, i, 2)[7] = 0.;
      plane (&scene, i, 4)[8] = -1.;
      plane (&scene, i, 3)[9] = 0.01;
      plane (&scene, i, 3)[10] = NAN;
    }
    /* one of three */
    plane (&scene, 2, 3)[12] = INFINITY;
    triangulator = make (cameras, 3);
    r = run (triangulator, &scene);
    for (guint k = 0; k < 11; k++)
      assert_unseen (r, k, CLOTH_POINT_FEW_VIEWS);
    for (guint k = 11; k < N; k++) {
      g_assert_cmpuint (r->views[k], ==, k == 12 ? 3 : 7);
      g_assert_cmpuint (r->state[k], ==,
          k == 12 ? CLOTH_POINT_TWO_VIEWS : CLOTH_POINT_MEASURED);
      g_assert_cmpfloat (distance (r, k, X), <, 1e-12);
    }
  }
}

/* Equal cameras, parallel rays, rays that meet behind, two views that contradict each
 * other: never a point. */
static void
test_degenerate (void)
{
  ClothCamera cameras[3];
  g_auto (Scene) scene = { 0 };
  g_autoptr (ClothTriangulator) triangulator = NULL;
  const ClothTriangulation *r;
  const gdouble X[3] = { 10., -5., 1. };
  ClothRandom random;

  cloth_random_init (&random, 5);
  scene_init (&scene, 3, 64);
  for (guint i = 0; i < 3; i++)
    make_camera (&cameras[i], 1, 3, CLOTH_LENS_BROWN5);
  for (guint k = 0; k < 64; k++) {
    film (&scene, cameras, k, X);
    for (guint i = 0; i < 3 && k >= 8; i++) {
      plane (&scene, i, 0)[k] += 0.1 * cloth_random_gaussian (&random);
      plane (&scene, i, 1)[k] += 0.1 * cloth_random_gaussian (&random);
    }
  }
  triangulator = make (cameras, 3);
  r = run (triangulator, &scene);
  for (guint k = 0; k < 64; k++)
    assert_unseen (r, k, CLOTH_POINT_PARALLEL);
  g_clear_pointer (&triangulator, cloth_triangulator_free);
  scene_clear (&scene);

  /* two cameras side by side, 0.2 mm apart, and one point 2 m away: with 0.1 px nothing
   * is known of its distance */
  scene_init (&scene, 2, 3);
  for (guint i = 0; i < 2; i++) {
    make_camera (&cameras[i], 0, 1, CLOTH_LENS_NONE);
    cameras[i].t[0] += 0.0002 * i;
    cameras[i].K[1] = 0.;
  }
  for (guint k = 0; k < 3; k++)
    film (&scene, cameras, k, X);
  /* 0.1 m apart: rays that diverge, they meet behind; and rays 20 px off their epipolar
   * line */
  cameras[1].t[0] += 0.0998;
  triangulator = make (cameras, 2);
  film (&scene, cameras, 0, X);
  film (&scene, cameras, 2, X);
  plane (&scene, 1, 1)[2] += 20.;
  plane (&scene, 1, 0)[1] = plane (&scene, 0, 0)[1] - 75.;
  r = run (triangulator, &scene);
  g_assert_cmpuint (r->state[0], ==, CLOTH_POINT_TWO_VIEWS);
  assert_unseen (r, 1, CLOTH_POINT_BEHIND);
  assert_unseen (r, 2, CLOTH_POINT_DISAGREE);
  g_clear_pointer (&triangulator, cloth_triangulator_free);

  cameras[1].t[0] -= 0.0998;
  triangulator = make (cameras, 2);
  for (guint k = 0; k < 3; k++)
    film (&scene, cameras, k, X);
  r = run (triangulator, &scene);
  for (guint k = 0; k < 3; k++)
    assert_unseen (r, k, CLOTH_POINT_PARALLEL);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/triangulate/same-bytes", test_same_bytes);
  g_test_add_func ("/triangulate/wrong-counts", test_wrong_counts);
  g_test_add_func ("/triangulate/bad-cameras", test_bad_cameras);
  g_test_add_func ("/triangulate/not-seen", test_not_seen);
  g_test_add_func ("/triangulate/degenerate", test_degenerate);
  return g_test_run ();
}
