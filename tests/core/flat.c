/* A flat cloth found by its silhouettes: drawn ones, whose truth is that of the drawing, in closed
 * form and by annealing; and what is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/vision/track/anneal.h"

#define N 4
#define WIDTH 320
#define HEIGHT 240
#define W 0.63
#define H 0.5

typedef struct
{
  ClothCamera cameras[N];
  guint8 *masks[N];
  ClothFlatView views[N];
} Scene;

/* A camera at @eye that looks at the origin. */
static ClothCamera
look (const gdouble eye[3], gboolean bends)
{
  const gdouble far = sqrt (eye[0] * eye[0] + eye[1] * eye[1] + eye[2] *
      eye[2]);
  const gdouble z[3] = { -eye[0] / far, -eye[1] / far, -eye[2] / far };
  const gdouble flat = hypot (z[0], z[1]);
  const gdouble x[3] = { z[1] / flat, -z[0] / flat, 0. };
  const gdouble y[3] = { z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2],
    z[0] * x[1] - z[1] * x[0]
  };
  ClothCamera c = {.width = WIDTH,.height = HEIGHT,
    .K = {340, 0, 159.5, 0, 340, 119.5, 0, 0, 1}
  };

  for (guint k = 0; k < 3; k++) {
    c.R[k] = x[k];
    c.R[3 + k] = y[k];
    c.R[6 + k] = z[k];
  }
  for (guint k = 0; k < 3; k++)
    c.t[k] = -(c.R[3 * k] * eye[0] + c.R[3 * k + 1] * eye[1] +
        c.R[3 * k + 2] * eye[2]);
  if (bends) {
    c.lens = CLOTH_LENS_BROWN5;
    c.k[0] = -0.25;
    c.k[1] = 0.05;
  }
  return c;
}

/* Each pixel whose ray meets the plane inside the cloth is cloth. Vertex 0 is at @at, u points to
 * @angle. */
static void
draw (const ClothCamera * c, const gdouble at[2], gdouble angle, gdouble w,
    gdouble h, gdouble ground, guint8 * mask)
{
  const gdouble *R = c->R;
  gdouble eye[3];

  for (guint k = 0; k < 3; k++)
    eye[k] = -(R[k] * c->t[0] + R[3 + k] * c->t[1] + R[6 + k] * c->t[2]);
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      const gdouble px[2] = { x, y };
      gdouble a, b, d[3], s, X, Y, u, v;

      cloth_camera_undistort_points (c, 1, &px[0], &px[1], &a, &b, NULL);
      for (guint k = 0; k < 3; k++)
        d[k] = R[k] * a + R[3 + k] * b + R[6 + k];
      s = (ground - eye[2]) / d[2];
      X = eye[0] + s * d[0] - at[0];
      Y = eye[1] + s * d[1] - at[1];
      /* u to the right, v downwards, both turned */
      u = cos (angle) * X + sin (angle) * Y;
      v = sin (angle) * X - cos (angle) * Y;
      mask[y * WIDTH + x] = s > 0 && u >= 0 && u <= w && v >= 0
          && v <= h ? 255 : 0;
    }
}

static void
scene_init (Scene * scene, const gdouble at[2], gdouble angle, gdouble w,
    gdouble h, gdouble ground, gboolean bends)
{
  for (guint c = 0; c < N; c++) {
    const gdouble phi = 0.4 + c * G_PI / 2;
    const gdouble eye[3] = { 1.5 * cos (phi), 1.5 * sin (phi), 0.9 + 0.1 * c };

    scene->cameras[c] = look (eye, bends);
    scene->masks[c] = g_malloc0 (WIDTH * HEIGHT);
    draw (&scene->cameras[c], at, angle, w, h, ground, scene->masks[c]);
    scene->views[c] = (ClothFlatView) {
      &scene->cameras[c], {
      scene->masks[c], WIDTH, HEIGHT, WIDTH}
    };
  }
}

static void
scene_clear (Scene * scene)
{
  for (guint c = 0; c < N; c++)
    g_free (scene->masks[c]);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Scene, scene_clear);

static const gdouble place[2] = { -0.31, 0.2 };

#define ANGLE 0.37

static void
assert_pose (const ClothFlatPose * pose, const gdouble at[2], gdouble angle,
    gdouble metres, gdouble radians)
{
  g_assert_cmpfloat_with_epsilon (pose->x, at[0], metres);
  g_assert_cmpfloat_with_epsilon (pose->y, at[1], metres);
  g_assert_cmpfloat_with_epsilon (remainder (pose->angle - angle, 2 * G_PI),
      0., radians);
}

/* A pixel is 4 mm on the ground here: a quarter of one. */
static void
test_corners (gconstpointer bends)
{
  g_auto (Scene) scene = { 0 };
  ClothFlatParams params = cloth_flat_default_params (W, H);
  const gdouble near[2] = { place[0] + 0.2, place[1] - 0.1 };
  /* the opposite corner */
  const gdouble other[2] = { place[0] + cos (ANGLE) * W + sin (ANGLE) * H,
    place[1] + sin (ANGLE) * W - cos (ANGLE) * H
  };
  g_autoptr (GError) error = NULL;
  ClothFlatPoses poses;

  scene_init (&scene, place, ANGLE, W, H, 0.1, GPOINTER_TO_INT (bends));
  params.ground = 0.1;
  g_assert_true (cloth_flat_find (&params, N, scene.views, near, &poses,
          &error));
  g_assert_no_error (error);
  g_assert_cmpuint (poses.n, ==, 2);
  assert_pose (&poses.poses[0], place, ANGLE, 0.001, 0.003);
  assert_pose (&poses.poses[1], other, ANGLE + G_PI, 0.001, 0.003);
  g_assert_cmpfloat (poses.poses[0].residual, <, 0.001);
  /* the hint turns them about */
  g_assert_true (cloth_flat_find (&params, N, scene.views, other, &poses,
          &error));
  assert_pose (&poses.poses[0], other, ANGLE + G_PI, 0.001, 0.003);
}

/* One camera is enough, and half a pixel off. */
static void
test_one (void)
{
  g_auto (Scene) scene = { 0 };
  const ClothFlatParams params = cloth_flat_default_params (W, H);
  g_autoptr (GError) error = NULL;
  ClothFlatPoses poses;

  scene_init (&scene, place, ANGLE, W, H, 0., FALSE);
  g_assert_true (cloth_flat_find (&params, 1, scene.views, place, &poses,
          &error));
  assert_pose (&poses.poses[0], place, ANGLE, 0.002, 0.005);
}

/* Of a square any corner may be the first. */
static void
test_square (void)
{
  g_auto (Scene) scene = { 0 };
  const ClothFlatParams params = cloth_flat_default_params (0.5, 0.5);
  g_autoptr (GError) error = NULL;
  ClothFlatPoses poses;

  scene_init (&scene, place, ANGLE, 0.5, 0.5, 0., FALSE);
  g_assert_true (cloth_flat_find (&params, N, scene.views, place, &poses,
          &error));
  g_assert_cmpuint (poses.n, ==, 4);
  assert_pose (&poses.poses[0], place, ANGLE, 0.001, 0.003);
}

/* A corner may be outside the picture: 10 px are, seen over that corner. */
static void
test_outside (void)
{
  static const gdouble at[2] = { -0.05, 0.4 };
  const gdouble angle = ANGLE - G_PI / 4;
  g_auto (Scene) scene = { 0 };
  const ClothFlatParams params = cloth_flat_default_params (W, H);
  const ClothAnnealParams annealing = cloth_anneal_default_params ();
  g_autoptr (GError) error = NULL;
  ClothFlatPoses poses;

  scene_init (&scene, at, angle, W, H, 0., FALSE);
  for (guint c = 0; c < N; c++) {
    gint bottom = HEIGHT - 1;

    while (!memchr (scene.masks[c] + bottom * WIDTH, 255, WIDTH))
      bottom--;
    /* the picture ends above the lowest corner */
    scene.views[c].mask.height = scene.cameras[c].height = bottom - 10;
  }
  cloth_flat_find (&params, N, scene.views, at, &poses, &error);
  g_assert_no_error (error);
  assert_pose (&poses.poses[0], at, angle, 0.002, 0.005);
  cloth_anneal_find (&annealing, &params, N, scene.views, at, &poses, &error);
  g_assert_no_error (error);
  assert_pose (&poses.poses[0], at, angle, 0.002, 0.005);
}

static void
test_anneal (gconstpointer seed)
{
  g_auto (Scene) scene = { 0 };
  const ClothFlatParams params = cloth_flat_default_params (W, H);
  ClothAnnealParams annealing = cloth_anneal_default_params ();
  g_autoptr (GError) error = NULL;
  ClothFlatPoses poses, again;

  annealing.seed = GPOINTER_TO_UINT (seed);
  scene_init (&scene, place, ANGLE, W, H, 0., TRUE);
  g_assert_true (cloth_anneal_find (&annealing, &params, N, scene.views, place,
          &poses, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (poses.n, ==, 2);
  g_test_message ("%.2f mm %.2f mm %.3f mrad, E %.4f", 1e3 * (poses.poses[0].x -
          place[0]), 1e3 * (poses.poses[0].y - place[1]),
      1e3 * (poses.poses[0].angle - ANGLE), poses.poses[0].residual);
  assert_pose (&poses.poses[0], place, ANGLE, 0.002, 0.005);
  g_assert_cmpfloat (poses.poses[0].residual, <, 0.02);
  g_assert_true (cloth_anneal_find (&annealing, &params, N, scene.views, place,
          &again, &error));
  g_assert_cmpmem (poses.poses, 2 * sizeof poses.poses[0], again.poses,
      2 * sizeof again.poses[0]);
}

/* Pixels to places of the cloth and back. */
static void
test_places (void)
{
  g_auto (Scene) scene = { 0 };
  const ClothFlatPose pose = { place[0], place[1], ANGLE, {W, H}, 0.1, 0. };
  const gdouble uv[2] = { 0.2, 0.3 }, outside[2] = { W + 0.01, 0.3 };
  gdouble X[3], px[2], back[2];

  scene_init (&scene, place, ANGLE, W, H, 0.1, TRUE);
  cloth_flat_place (&pose, uv, X);
  g_assert_cmpfloat_with_epsilon (X[0], place[0] + 0.2 * cos (ANGLE) +
      0.3 * sin (ANGLE), 1e-12);
  g_assert_cmpfloat_with_epsilon (X[1], place[1] + 0.2 * sin (ANGLE) -
      0.3 * cos (ANGLE), 1e-12);
  g_assert_true (cloth_camera_project (&scene.cameras[1], X, px, NULL, NULL));
  g_assert_true (cloth_flat_uv (&pose, &scene.cameras[1], px, back));
  g_assert_cmpfloat_with_epsilon (back[0], uv[0], 1e-9);
  g_assert_cmpfloat_with_epsilon (back[1], uv[1], 1e-9);
  cloth_flat_place (&pose, outside, X);
  g_assert_true (cloth_camera_project (&scene.cameras[1], X, px, NULL, NULL));
  g_assert_false (cloth_flat_uv (&pose, &scene.cameras[1], px, back));
}

typedef void (*Harm) (Scene * scene, ClothFlatParams * params);

static void
empty (Scene * scene, ClothFlatParams * params)
{
  memset (scene->masks[2], 0, WIDTH * HEIGHT);
}

static void
full (Scene * scene, ClothFlatParams * params)
{
  memset (scene->masks[1], 255, WIDTH * HEIGHT);
}

static void
two (Scene * scene, ClothFlatParams * params)
{
  for (gint y = 0; y < 40; y++)
    memset (scene->masks[0] + (y + 2) * WIDTH + 3, 1, 40);
}

static void
cut (Scene * scene, ClothFlatParams * params)
{
  /* over the edge to the left */
  const gdouble at[2] = { -0.31, 0.9 };

  draw (&scene->cameras[0], at, ANGLE, W, H, 0., scene->masks[0]);
}

static void
round_one (Scene * scene, ClothFlatParams * params)
{
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++)
      scene->masks[3][y * WIDTH + x] = hypot (x - 160., 1.6 * (y - 120.)) < 80.;
}

static void
speck (Scene * scene, ClothFlatParams * params)
{
  memset (scene->masks[3], 0, WIDTH * HEIGHT);
  scene->masks[3][100 * WIDTH + 100] = 1;
}

/* All but a hole: every end of it lies on the picture's edge. */
static void
ring (Scene * scene, ClothFlatParams * params)
{
  memset (scene->masks[1], 1, WIDTH * HEIGHT);
  for (gint y = 100; y < 130; y++)
    memset (scene->masks[1] + y * WIDTH + 140, 0, 30);
}

static void
small (Scene * scene, ClothFlatParams * params)
{
  params->size[0] = 0.9;
}

static void
moved (Scene * scene, ClothFlatParams * params)
{
  const gdouble at[2] = { place[0] + 0.06, place[1] };

  draw (&scene->cameras[2], at, ANGLE, W, H, 0., scene->masks[2]);
}

static void
below (Scene * scene, ClothFlatParams * params)
{
  params->ground = 5.;
}

static void
other_size (Scene * scene, ClothFlatParams * params)
{
  scene->views[1].mask.width = 300;
}

static void
no_size (Scene * scene, ClothFlatParams * params)
{
  params->size[1] = -1.;
}

static const struct
{
  const gchar *name;
  Harm harm;
  ClothFlatError code;
  const gchar *words;
  gboolean of_both;
} harms[] = {
  {"empty", empty, CLOTH_FLAT_ERROR_SILHOUETTE, "*cam2*empty*", TRUE},
  {"full", full, CLOTH_FLAT_ERROR_SILHOUETTE, "*cam1*whole picture*", TRUE},
  {"two", two, CLOTH_FLAT_ERROR_SILHOUETTE, "*cam0*more than one piece*", TRUE},
  {"cut", cut, CLOTH_FLAT_ERROR_SHAPE, "*cam0*edge of its picture*", FALSE},
  {"round", round_one, CLOTH_FLAT_ERROR_SHAPE, "*cam3*straight sides*", FALSE},
  {"ring", ring, CLOTH_FLAT_ERROR_SHAPE, "*cam1*straight sides*", FALSE},
  {"speck", speck, CLOTH_FLAT_ERROR_SHAPE, "*cam3*", FALSE},
  {"small", small, CLOTH_FLAT_ERROR_SHAPE, "*0.63*0.50*0.9*", FALSE},
  {"moved", moved, CLOTH_FLAT_ERROR_DISAGREE, "*cam2*6? mm*", FALSE},
  {"below", below, CLOTH_FLAT_ERROR_SHAPE, "*cam0*horizon*", TRUE},
  {"other-size", other_size, CLOTH_FLAT_ERROR_PARAMETER, "*cam1*300*320*",
      TRUE},
  {"no-size", no_size, CLOTH_FLAT_ERROR_PARAMETER, "*0.63 × -1 m*", TRUE},
};

static void
test_refused (gconstpointer data)
{
  static const gchar *const names[N] = { "cam0", "cam1", "cam2", "cam3" };
  const ClothAnnealParams annealing = cloth_anneal_default_params ();
  const guint i = GPOINTER_TO_UINT (data);
  ClothFlatParams params = cloth_flat_default_params (W, H);

  for (guint way = 0; way < (harms[i].of_both ? 2 : 1); way++) {
    g_auto (Scene) scene = { 0 };
    g_autoptr (GError) error = NULL;
    ClothFlatPoses poses;

    scene_init (&scene, place, ANGLE, W, H, 0., FALSE);
    for (guint c = 0; c < N; c++)
      scene.cameras[c].name = (gchar *) names[c];
    harms[i].harm (&scene, &params);
    if (way == 0)
      g_assert_false (cloth_flat_find (&params, N, scene.views, NULL, &poses,
              &error));
    else
      g_assert_false (cloth_anneal_find (&annealing, &params, N, scene.views,
              NULL, &poses, &error));
    g_assert_error (error, CLOTH_FLAT_ERROR, (gint) harms[i].code);
    g_test_message ("%s", error->message);
    g_assert_true (g_pattern_match_simple (harms[i].words, error->message));
    g_assert_cmpuint (poses.n, ==, 0);
  }
}

static void
test_parameters (void)
{
  g_auto (Scene) scene = { 0 };
  const ClothFlatParams params = cloth_flat_default_params (W, H);
  ClothAnnealParams annealing = cloth_anneal_default_params ();
  g_autoptr (GError) error = NULL;
  ClothFlatPoses poses;

  scene_init (&scene, place, ANGLE, W, H, 0., FALSE);
  annealing.cold = 1.;
  g_assert_false (cloth_anneal_find (&annealing, &params, N, scene.views, NULL,
          &poses, &error));
  g_assert_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_PARAMETER);
  g_clear_error (&error);
  annealing = cloth_anneal_default_params ();
  for (guint i = 0; i < 2; i++) {
    ClothFlatParams other = params;

    /* centimetres for metres: behind the cameras */
    other.size[0] = i ? 63. : 0.9;
    other.size[1] = i ? 67. : params.size[1];
    g_assert_false (cloth_anneal_find (&annealing, &other, N, scene.views, NULL,
            &poses, &error));
    g_assert_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_SHAPE);
    g_test_message ("%s", error->message);
    g_assert_cmpuint (poses.n, ==, 0);
    g_clear_error (&error);
  }
  g_assert_false (cloth_flat_find (&params, 0, NULL, NULL, &poses, &error));
  g_assert_error (error, CLOTH_FLAT_ERROR, CLOTH_FLAT_ERROR_PARAMETER);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_data_func ("/flat/corners", GINT_TO_POINTER (FALSE), test_corners);
  g_test_add_data_func ("/flat/lens", GINT_TO_POINTER (TRUE), test_corners);
  g_test_add_func ("/flat/one", test_one);
  g_test_add_func ("/flat/square", test_square);
  g_test_add_func ("/flat/outside", test_outside);
  g_test_add_func ("/flat/places", test_places);
  for (guint seed = 0; seed < 5; seed++) {
    g_autofree gchar *name = g_strdup_printf ("/flat/anneal/%u", seed);

    g_test_add_data_func (name, GUINT_TO_POINTER (seed), test_anneal);
  }
  for (guint i = 0; i < G_N_ELEMENTS (harms); i++) {
    g_autofree gchar *name = g_strdup_printf ("/flat/refused/%s",
        harms[i].name);

    g_test_add_data_func (name, GUINT_TO_POINTER (i), test_refused);
  }
  g_test_add_func ("/flat/parameters", test_parameters);
  return g_test_run ();
}
