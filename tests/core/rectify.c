/* Rectified pairs: points of the world on one row of both, whose disparity is f·b/z; maps as
 * OpenCV's; what can't be rectified.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/rectify.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"
#include "gst/rig/rig.h"
#include "gst/rig/rotation.h"
#include "tests/reference/reference.h"

#define NEAR 0.8
#define FAR 4

/* A camera at @place, turned by the rotation vector @turn, looking along z. */
static ClothCamera
make_camera (const gchar * name, const gdouble place[3], const gdouble turn[3])
{
  ClothCamera camera = {.width = 320,.height = 240,.K = {400, 0, 159.5, 0,
      404, 119.5, 0, 0, 1}
  };

  camera.name = (gchar *) name;
  cloth_rotation_from_vector (turn, camera.R);
  cloth_mat3_vec (camera.R, place, camera.t);
  for (gint i = 0; i < 3; i++)
    camera.t[i] = -camera.t[i];
  return camera;
}

static void
give_lens (ClothCamera * camera, ClothLens lens)
{
  static const gdouble k[][8] = { {0}, {-0.21, 0.08, 1e-3, -5e-4, -0.01},
  {-0.1, 0.05, 1e-3, -5e-4, 0.01, 0.1, 0.02, 0.003}, {-0.02, 0.004, -1e-3, 2e-4}
  };

  camera->lens = lens;
  memcpy (camera->k, k[lens], sizeof (camera->k));
}

/* Where the rectified picture of a camera shows a point of the world; z: its depth there. */
static void
place (const ClothRectification * pair, const ClothCamera * camera,
    const gdouble rotation[9], const gdouble X[3], gdouble at[2], gdouble * z)
{
  gdouble own[3], turned[3];

  cloth_mat3_vec (camera->R, X, own);
  for (gint i = 0; i < 3; i++)
    own[i] += camera->t[i];
  cloth_mat3_vec (rotation, own, turned);
  for (gint i = 0; i < 2; i++)
    at[i] = pair->focal * turned[i] / turned[2] + pair->centre[i];
  *z = turned[2];
}

static gdouble
sample (const gfloat * map, gint width, gdouble x, gdouble y)
{
  const gint left = (gint) floor (x), top = (gint) floor (y);
  const gdouble u = x - left, v = y - top;
  const gfloat *at = map + top * width + left;

  return (1 - v) * ((1 - u) * at[0] + u * at[1])
      + v * ((1 - u) * at[width] + u * at[width + 1]);
}

/* @offset: of the partner, m; @turn: of it */
static void
check_pair (const gdouble offset[3], const gdouble turn[3], ClothLens lens)
{
  static const gdouble origin[3] = { 0.3, -0.2, 0.1 };
  static const gdouble still[3] = { 0.02, -0.04, 0.01 };
  gdouble there[3] = { origin[0] + offset[0], origin[1] + offset[1], origin[2]
        + offset[2]
  };
  ClothCamera cameras[2] = { make_camera ("one", origin, still),
    make_camera ("two", there, turn)
  };
  ClothRectification pair;
  g_autoptr (GError) error = NULL;
  g_autofree gfloat *x[2], *y[2];
  gsize n;
  guint n_seen = 0;
  ClothRandom random;

  x[0] = x[1] = y[0] = y[1] = NULL;
  for (guint i = 0; i < 2; i++)
    give_lens (&cameras[i], lens);
  g_assert_true (cloth_rectify_pair (&cameras[0], &cameras[1], NEAR, FAR,
          &pair, &error));
  g_assert_no_error (error);
  g_assert_cmpfloat_with_epsilon (pair.baseline, sqrt (offset[0] * offset[0]
          + offset[1] * offset[1] + offset[2] * offset[2]), 1e-12);
  g_assert_cmpint (pair.range % 16, ==, 0);
  g_assert_cmpfloat (pair.least, <=, pair.focal * pair.baseline / FAR);
  g_assert_cmpfloat (pair.least + pair.range - 1, >=,
      pair.focal * pair.baseline / NEAR);
  n = (gsize) pair.width * (gsize) pair.height;
  for (guint i = 0; i < 2; i++) {
    x[i] = g_new (gfloat, n);
    y[i] = g_new (gfloat, n);
    cloth_rectify_map (&pair, &cameras[i], i ? pair.partner : pair.head, x[i],
        y[i]);
  }
  cloth_random_init (&random, 7);
  for (guint k = 0; k < 400; k++) {
    gdouble X[3], px[2][2], at[2][2], z[2];
    gboolean seen = TRUE;

    for (gint i = 0; i < 3; i++)
      X[i] = origin[i] + 1.2 * (cloth_random_uniform (&random) - 0.5);
    X[2] = origin[2] + NEAR + (FAR - NEAR) * cloth_random_uniform (&random);
    for (guint i = 0; i < 2; i++) {
      seen &= cloth_camera_project (&cameras[i], X, px[i], NULL, NULL)
          && px[i][0] > 1 && px[i][1] > 1 && px[i][0] < 318 && px[i][1] < 238;
      place (&pair, &cameras[i], i ? pair.partner : pair.head, X, at[i], &z[i]);
    }
    if (!seen || z[0] < NEAR || z[0] > FAR)
      continue;
    n_seen++;
    /* one row, and what the depth says along it */
    g_assert_cmpfloat_with_epsilon (at[0][1], at[1][1], 1e-9);
    g_assert_cmpfloat_with_epsilon (at[0][0] - at[1][0],
        pair.focal * pair.baseline / z[0], 1e-9);
    g_assert_cmpfloat_with_epsilon (z[0], z[1], 1e-12);
    /* the maps lead back to where each camera has filmed it */
    for (guint i = 0; i < 2; i++) {
      g_assert_cmpfloat (at[i][0], >=, i ? 0 : pair.least + pair.range - 1);
      g_assert_cmpfloat (at[i][0], <, pair.width - (i ? pair.least
              + pair.range : 1));
      g_assert_cmpfloat_with_epsilon (sample (x[i], pair.width, at[i][0],
              at[i][1]), px[i][0], 0.01);
      g_assert_cmpfloat_with_epsilon (sample (y[i], pair.width, at[i][0],
              at[i][1]), px[i][1], 0.01);
    }
  }
  g_assert_cmpuint (n_seen, >, 60);
}

static void
test_rows (void)
{
  static const gdouble offsets[][3] = { {0.1, 0, 0}, {-0.1, 0, 0}, {0, 0.1, 0},
  {0, -0.12, 0}, {0.07, 0.07, 0.02}, {-0.15, 0.03, -0.05}
  };
  static const gdouble turns[][3] = { {0.02, -0.04, 0.01}, {0.05, 0.02, -0.1},
  {0, 0, 0.7}
  };

  for (guint i = 0; i < G_N_ELEMENTS (offsets); i++)
    for (guint j = 0; j < G_N_ELEMENTS (turns); j++)
      for (ClothLens lens = CLOTH_LENS_NONE; lens <= CLOTH_LENS_FISHEYE; lens++)
        check_pair (offsets[i], turns[j], lens);
}

/* ---- OpenCV ---- */

static void
compare_map (const ClothRectification * pair, const ClothCamera * camera,
    const gdouble rotation[9])
{
  const gsize n = (gsize) pair->width * (gsize) pair->height;
  g_autofree gfloat *x = g_new (gfloat, n), *y = g_new (gfloat, n);
  g_autofree gfloat *u = g_new (gfloat, n), *v = g_new (gfloat, n);
  gsize n_shown = 0;

  cloth_rectify_map (pair, camera, rotation, x, y);
  g_assert_true (cloth_cv_undistort_rectify_map (camera->K, camera->k,
          cloth_lens_n_coefficients (camera->lens),
          camera->lens == CLOTH_LENS_FISHEYE, rotation, pair->focal,
          pair->centre, pair->width, pair->height, u, v));
  for (gsize i = 0; i < n; i++) {
    if (isnan (x[i]))
      continue;
    n_shown++;
    g_assert_cmpfloat_with_epsilon (x[i], u[i], 2e-3);
    g_assert_cmpfloat_with_epsilon (y[i], v[i], 2e-3);
  }
  g_assert_cmpuint (n_shown, >, 50000);
}

static void
test_opencv (void)
{
  static const gdouble origin[3], right[3] = { 0.1, 0.01, -0.01 };
  static const gdouble one[3] = { 0.01, 0.05, -0.02 };
  static const gdouble other[3] = { -0.02, -0.03, 0.03 };

  for (ClothLens lens = CLOTH_LENS_NONE; lens <= CLOTH_LENS_FISHEYE; lens++) {
    ClothCamera cameras[2] = { make_camera ("one", origin, one),
      make_camera ("two", right, other)
    };
    ClothRectification pair;
    gdouble turn[9], move[3], R1[9], R2[9];

    for (guint i = 0; i < 2; i++)
      give_lens (&cameras[i], lens);
    g_assert_true (cloth_rectify_pair (&cameras[0], &cameras[1], NEAR, FAR,
            &pair, NULL));
    compare_map (&pair, &cameras[0], pair.head);
    compare_map (&pair, &cameras[1], pair.partner);
    cloth_mat3_mul_nt (cameras[1].R, cameras[0].R, turn);
    cloth_mat3_vec (turn, cameras[0].t, move);
    for (gint i = 0; i < 3; i++)
      move[i] = cameras[1].t[i] - move[i];
    g_assert_true (cloth_cv_stereo_rectify (cameras[0].K, 320, 240, turn, move,
            R1, R2));
    /* its frame may be turned about the baseline, by less than the cameras are */
    for (gint i = 0; i < 3; i++) {
      g_assert_cmpfloat_with_epsilon (R1[i], pair.head[i], 1e-9);
      g_assert_cmpfloat_with_epsilon (R2[i], pair.partner[i], 1e-9);
      g_assert_cmpfloat_with_epsilon (R1[6 + i], pair.head[6 + i], 0.02);
    }
  }
}

/* Cameras that are rectified as they are: pixels are moved by whole ones. */
static void
test_parallel (void)
{
  static const gdouble origin[3], still[3], right[3] = { 0.1, 0, 0 };
  static const gdouble left[3] = { -0.1, 0, 0 };

  for (gint side = 0; side < 2; side++) {
    ClothCamera cameras[2] = { make_camera ("one", origin, still),
      make_camera ("two", side ? left : right, still)
    };
    ClothRectification pair;
    g_autofree gfloat *x = NULL, *y = NULL;
    gsize n;

    cameras[0].K[4] = cameras[1].K[4] = 400;
    g_assert_true (cloth_rectify_pair (&cameras[0], &cameras[1], NEAR, FAR,
            &pair, NULL));
    n = (gsize) pair.width * (gsize) pair.height;
    x = g_new (gfloat, n);
    y = g_new (gfloat, n);
    cloth_rectify_map (&pair, &cameras[0], pair.head, x, y);
    g_assert_cmpint (pair.height, ==, 240);
    g_assert_cmpint (pair.width, ==, 320 + pair.least + 2 * pair.range);
    for (gint row = 0; row < 240; row++)
      for (gint column = 0; column < 320; column++) {
        const gsize at = (gsize) (row * pair.width + pair.least + pair.range
            + column);

        /* a partner to the left turns the picture upside down */
        g_assert_cmpfloat_with_epsilon (x[at], side ? 319 - column : column,
            1e-3);
        g_assert_cmpfloat_with_epsilon (y[at], side ? 239 - row : row, 1e-3);
      }
    g_assert_true (isnan (x[pair.least + pair.range - 1]));
    g_assert_true (isnan (x[pair.least + pair.range + 320]));
  }
}

/* Far apart, turned to one place: each sees what the other does, at the right side. */
static void
test_converging (void)
{
  static const gdouble places[2][3] = { {0, 0, 0}, {1, 0, 0} };
  static const gdouble turns[2][3] = { {0, -0.45, 0}, {0, 0.45, 0} };
  const ClothCamera head = make_camera ("one", places[0], turns[0]);
  const ClothCamera partner = make_camera ("two", places[1], turns[1]);
  ClothRectification pair;
  g_autoptr (GError) error = NULL;

  g_assert_true (cloth_rectify_pair (&head, &partner, NEAR, FAR, &pair,
          &error));
  g_assert_no_error (error);
}

/* ---- pairs among each other ---- */

static void
test_relations (void)
{
  static const gdouble origin[3], still[3] = { 0.01, -0.02, 0.1 };
  static const gdouble places[2][3] = { {0.1, 0.01, 0.004}, {0.02, -0.14,
      -0.03}
  };
  static const gdouble turns[2][3] =
      { {0.02, -0.04, 0.01}, {0.05, 0.02, -0.1} };
  ClothCamera head = make_camera ("one", origin, still), partners[2];
  ClothRectification pairs[2];
  gdouble to[9], unit[3], rotation[9], shift[2], forward;
  g_autofree gfloat *rays = g_new (gfloat, 2 * 320 * 240);
  g_autofree gfloat *x = g_new (gfloat, 320 * 240);
  g_autofree gfloat *y = g_new (gfloat, 320 * 240);
  ClothRandom random;

  give_lens (&head, CLOTH_LENS_BROWN5);
  for (guint i = 0; i < 2; i++) {
    partners[i] = make_camera ("two", places[i], turns[i]);
    g_assert_true (cloth_rectify_pair (&head, &partners[i], NEAR, FAR,
            &pairs[i], NULL));
  }
  cloth_rectify_relate (&pairs[0], &pairs[1], to, unit);
  cloth_rectify_view (&pairs[0], &head, &partners[1], rotation, shift,
      &forward);
  cloth_rectify_rays (&head, rays);
  cloth_rectify_places (&pairs[0], rays, 320 * 240, x, y);
  cloth_random_init (&random, 11);
  for (guint k = 0; k < 300; k++) {
    const gint column = (gint) (320 * cloth_random_uniform (&random));
    const gint row = (gint) (240 * cloth_random_uniform (&random));
    const gsize pixel = (gsize) (row * 320 + column);
    const gdouble depth = NEAR + (FAR - NEAR) * cloth_random_uniform (&random);
    const gdouble own[3] = { depth * (gdouble) rays[2 * pixel],
      depth * (gdouble) rays[2 * pixel + 1], depth
    };
    gdouble X[3], px[2], at[3][2], z[3], d[2], mapped[3], seen[2];

    cloth_mat3_vec_t (head.R, own, X);  /* at the origin: t is 0 */
    g_assert_true (cloth_camera_project (&head, X, px, NULL, NULL));
    g_assert_cmpfloat_with_epsilon (px[0], column, 1e-3);
    g_assert_cmpfloat_with_epsilon (px[1], row, 1e-3);
    for (guint i = 0; i < 2; i++) {
      place (&pairs[i], &head, pairs[i].head, X, at[i], &z[i]);
      d[i] = pairs[i].focal * pairs[i].baseline / z[i];
    }
    g_assert_cmpfloat_with_epsilon (x[pixel], at[0][0], 1e-3);
    g_assert_cmpfloat_with_epsilon (y[pixel], at[0][1], 1e-3);
    for (gint i = 0; i < 3; i++)
      mapped[i] = to[3 * i] * at[0][0] + to[3 * i + 1] * at[0][1]
          + to[3 * i + 2];
    g_assert_cmpfloat_with_epsilon (mapped[0] / mapped[2], at[1][0], 1e-6);
    g_assert_cmpfloat_with_epsilon (mapped[1] / mapped[2], at[1][1], 1e-6);
    g_assert_cmpfloat_with_epsilon (d[1] * (unit[0] * at[0][0]
            + unit[1] * at[0][1] + unit[2]), d[0], 1e-9);
    place (&pairs[0], &partners[1], rotation, X, at[2], &z[2]);
    for (gint i = 0; i < 2; i++) {
      seen[i] = pairs[0].centre[i] + (at[0][i] - pairs[0].centre[i]
          + d[0] * shift[i]) / (1 + d[0] * forward);
      g_assert_cmpfloat_with_epsilon (seen[i], at[2][i], 1e-6);
    }
  }
}

/* ---- what can't be ---- */

static void
refuse (const ClothCamera * head, const ClothCamera * partner, gdouble near,
    gdouble far, const gchar * word)
{
  ClothRectification pair;
  g_autoptr (GError) error = NULL;

  g_assert_false (cloth_rectify_pair (head, partner, near, far, &pair, &error));
  g_assert_nonnull (error);
  g_assert_cmpuint (error->domain, ==, CLOTH_RIG_ERROR);
  if (!strstr (error->message, word))
    g_error ("“%s” says nothing of “%s”", error->message, word);
}

static void
test_refused (void)
{
  static const gdouble origin[3], still[3], right[3] = { 0.1, 0, 0 };
  static const gdouble ahead[3] = { 0.01, 0, 0.1 };
  static const gdouble hair[3] = { 1e-4, 0, 0 }, far[3] = { 60, 0, 0 };
  static const gdouble back[3] = { 0, 3, 0 };
  static const gdouble out[2][3] = { {0, 0.5, 0}, {0, -0.45, 0} };
  ClothCamera head = make_camera ("one", origin, still);
  ClothCamera same = make_camera ("two", origin, still);
  ClothCamera before = make_camera ("two", ahead, still);
  ClothCamera turned = make_camera ("two", right, back);
  ClothCamera leftwards = make_camera ("one", origin, out[0]);
  ClothCamera rightwards = make_camera ("two", right, out[1]);
  ClothCamera close = make_camera ("two", hair, still);
  ClothCamera remote = make_camera ("two", far, still);
  ClothCamera good = make_camera ("two", right, still);

  refuse (&head, &same, NEAR, FAR, "one place");
  refuse (&head, &head, NEAR, FAR, "one place");
  refuse (&head, &before, NEAR, FAR, "6° off");
  refuse (&head, &turned, NEAR, FAR, "172° apart");
  refuse (&leftwards, &rightwards, NEAR, FAR, "shows 0%");
  refuse (&head, &close, NEAR, FAR, "too near");
  refuse (&head, &remote, NEAR, FAR, "Raise near");
  refuse (&head, &good, 0.01, FAR, "Raise near");
  refuse (&head, &good, FAR, NEAR, "far more than near");
  refuse (&head, &good, 0, FAR, "near more than 0");
  refuse (&head, &good, NAN, FAR, "near more than 0");
  refuse (&head, &good, NEAR, INFINITY, "far more than near");
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/rectify/rows", test_rows);
  g_test_add_func ("/rectify/opencv", test_opencv);
  g_test_add_func ("/rectify/parallel", test_parallel);
  g_test_add_func ("/rectify/converging", test_converging);
  g_test_add_func ("/rectify/relations", test_relations);
  g_test_add_func ("/rectify/refused", test_refused);
  return g_test_run ();
}
