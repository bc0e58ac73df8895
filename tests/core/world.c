/* Where a world lies: rigs that are moved must see what they saw, where it is said to be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/core/calibrateproblem.h"

#include "gst/rig/world.h"

/* The rig of tests/core/calibrateproblem.h somewhere else, turned any way. */
static ClothRig *
some_rig (ClothRandom * random)
{
  ClothRig *rig = cloth_rig_new (4);
  ClothWorld world;
  gdouble r[3];

  true_rig (rig->cameras);
  for (guint c = 0; c < 4; c++) {
    rig->cameras[c].name = g_strdup_printf ("cam%u", c);
    rig->cameras[c].width = 640;
    rig->cameras[c].height = 480;
  }
  for (guint i = 0; i < 3; i++) {
    r[i] = 2 * cloth_random_gaussian (random);
    world.t[i] = cloth_random_gaussian (random);
  }
  cloth_rotation_from_vector (r, world.R);
  cloth_world_move_rig (&world, rig);
  return rig;
}

/* The largest distance between where cameras see points and where they are said to see
 * them, px. */
static gdouble
worst (const ClothRig * rig, guint n, const ClothWorldPoint * points)
{
  gdouble most = 0;

  for (guint i = 0; i < n; i++) {
    gdouble px[2];

    g_assert_true (cloth_camera_project (&rig->cameras[points[i].camera],
            points[i].world, px, NULL, NULL));
    most = fmax (most, hypot (px[0] - points[i].px[0],
            px[1] - points[i].px[1]));
  }
  return most;
}

/* Two cameras' views of points before the rig of true_rig(), in its own frame. */
static guint
look (ClothRandom * random, guint n, const gdouble * X,
    ClothWorldPoint * points)
{
  ClothCamera cameras[4] = { 0, };
  guint m = 0;

  true_rig (cameras);
  for (guint i = 0; i < n; i++) {
    for (guint c = 0; c < 2; c++) {
      cameras[c].K[8] = 1;
      points[m].camera = c;
      memcpy (points[m].world, X + 3 * i, 3 * sizeof (gdouble));
      g_assert_true (cloth_camera_project (&cameras[c], X + 3 * i,
              points[m++].px, NULL, NULL));
    }
  }
  return m;
}

static void
test_points (void)
{
  /* In space, in a plane, on a line. */
  static const gdouble X[3][12] = {
    {0, 0, 0.6, 0.1, 0, 0.7, 0.1, 0.1, 0.6, 0, 0.1, 0.65},
    {0, 0, 0.6, 0.1, 0, 0.6, 0.1, 0.1, 0.6, 0, 0.1, 0.6},
    {0, 0, 0.6, 0.05, 0.05, 0.6, 0.1, 0.1, 0.6, 0.15, 0.15, 0.6},
  };
  ClothRandom random;

  cloth_random_init (&random, 1);
  for (guint kind = 0; kind < 3; kind++) {
    g_autoptr (ClothRig) rig = some_rig (&random);
    g_autoptr (GError) error = NULL;
    ClothWorldPoint points[8];
    guint n = look (&random, 4, X[kind], points);
    gdouble before = worst (rig, 0, points), rms, scale;
    ClothWorld world;

    g_assert_cmpfloat (before, ==, 0);
    g_assert_true (cloth_world_of_points (rig, n, points, &world, &rms, &scale,
            &error));
    g_assert_no_error (error);
    g_assert_cmpfloat (rms, <, 1e-7);
    g_assert_cmpfloat (fabs (scale - 1), <, 1e-6);
    cloth_world_move_rig (&world, rig);
    g_test_message ("kind %u: within %.1e px", kind, worst (rig, n, points));
    g_assert_cmpfloat (worst (rig, n, points), <, 1e-4);
  }
}

/* A plumb line of unknown length says which way is up all the same. */
static void
test_plumb (void)
{
  static const gdouble X[6] = { 0, -0.1, 0.6, 0.02, 0.1, 0.65 };
  ClothRandom random;
  g_autoptr (ClothRig) rig = NULL;
  g_autoptr (GError) error = NULL;
  ClothWorldPoint points[4];
  gdouble rms, scale, length = sqrt (0.02 * 0.02 + 0.04 + 0.05 * 0.05);
  ClothWorld world;

  cloth_random_init (&random, 2);
  rig = some_rig (&random);
  look (&random, 2, X, points);
  for (guint i = 0; i < 4; i++) {
    memset (points[i].world, 0, sizeof points[i].world);
    points[i].world[2] = i < 2;
  }
  g_assert_true (cloth_world_of_points (rig, 4, points, &world, &rms, &scale,
          &error));
  g_assert_no_error (error);
  g_assert_cmpfloat (fabs (scale - length), <, 1e-6);
  cloth_world_move_rig (&world, rig);
  /* Of its true length it fits. */
  for (guint i = 0; i < 4; i++)
    points[i].world[2] = 0.5 + length * (points[i].world[2] - 0.5);
  g_assert_cmpfloat (worst (rig, 4, points), <, 1e-4);
}

static void
test_board (void)
{
  ClothRandom random;
  g_auto (Problem) p;
  g_autoptr (ClothRig) rig = NULL;
  g_autoptr (GError) error = NULL;
  ClothCamera truth[4] = { 0, };
  ClothWorld world;
  gdouble P[12], most = 0;

  cloth_random_init (&random, 3);
  rig = some_rig (&random);
  problem_init (&p, 4, 9, 7, 0.03, 1);
  true_rig (truth);
  true_pose (&random, 0.5, P);
  for (guint c = 0; c < 2; c++) {
    truth[c].K[8] = 1;
    see (&p, &truth[c], c, 0, P, &random, 0, FALSE);
    g_assert_cmpuint (p.input.views[c].n, >, 20);
  }
  g_assert_true (cloth_world_of_board (rig, 2, p.input.views, p.board, &world,
          &error));
  g_assert_no_error (error);
  cloth_world_move_rig (&world, rig);
  for (guint c = 0; c < 2; c++) {
    const ClothBundleView *view = &p.input.views[c];
    const ClothCamera *camera = &rig->cameras[c];
    gdouble height = 0;

    for (guint i = 0; i < view->n; i++) {
      gdouble X[3], px[2];

      /* z is off the board, towards the camera; x along its rows. */
      memcpy (X, p.board + 3 * view->vertex[i], sizeof X);
      X[1] = -X[1];
      g_assert_true (cloth_camera_project (camera, X, px, NULL, NULL));
      most = fmax (most, hypot (px[0] - view->x[i], px[1] - view->y[i]));
    }
    for (guint i = 0; i < 3; i++)
      height -= camera->R[3 * i + 2] * camera->t[i];
    g_assert_cmpfloat (height, >, 0.3);
  }
  g_test_message ("board within %.1e px", most);
  g_assert_cmpfloat (most, <, 1e-4);

  /* What shows nothing. */
  ((ClothBundleView *) p.input.views)[0].n = 3;
  g_assert_false (cloth_world_of_board (rig, 1, p.input.views, p.board, &world,
          &error));
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
}

static void
test_camera (void)
{
  ClothRandom random;
  g_autoptr (ClothRig) rig = NULL;
  ClothWorld world;
  gdouble above[3] = { 0, 1, 0.1 }, px[2];
  const gdouble tilt[3] = { 1e-3, 0, 0 };

  cloth_random_init (&random, 4);
  rig = some_rig (&random);
  g_assert_null (cloth_world_camera (rig));
  rig->cameras[2].r_sd[0] = 0.01;
  rig->cameras[2].t_sd[1] = 0.001;
  cloth_world_of_camera (&rig->cameras[1], &world);
  cloth_world_move_rig (&world, rig);
  g_assert_true (cloth_world_camera (rig) == &rig->cameras[1]);
  /* Ahead and a little up is above the centre of the picture. */
  g_assert_true (cloth_camera_project (&rig->cameras[1], above, px, NULL,
          NULL));
  g_assert_cmpfloat (fabs (px[0] - rig->cameras[1].K[2]), <, 1);
  g_assert_cmpfloat (px[1], <, rig->cameras[1].K[5] - 40);
  g_assert_cmpfloat (rig->cameras[2].t_sd[1], >, 0.001);
  /* That of OpenCV, too, whose y is down; not one that is a thousandth beside it. */
  memset (world.t, 0, sizeof world.t);
  memcpy (world.R, rig->cameras[1].R, sizeof world.R);
  for (guint i = 0; i < 3; i++) {
    for (guint j = 0; j < 3; j++)
      world.R[3 * i + j] = rig->cameras[1].R[3 * j + i];
  }
  cloth_world_move_rig (&world, rig);
  g_assert_cmpfloat (rig->cameras[1].R[4], >, 0.999999);
  g_assert_true (cloth_world_camera (rig) == &rig->cameras[1]);
  cloth_rotation_from_vector (tilt, world.R);
  cloth_world_move_rig (&world, rig);
  g_assert_null (cloth_world_camera (rig));
}

static void
test_bad (void)
{
  static const struct
  {
    const gchar *text, *says;
  } lines[] = {
    {"cam0,1,2,3,4", "line 1: give camera,x,y,X,Y,Z"},
    {"\n# none\ncam0,1,2,3,4,5,6", "line 3"},
    {"cam9,1,2,3,4,5", "no \"cam9\""},
    {"cam0,1,2,3,4,5m", "\"5m\" is not a number"},
    {"cam0,1,,3,4,5", "not a number"},
    {"cam0,1,nan,3,4,5", "not a number"},
    {"cam0,1,1e300,3,4,5", "within"},
  }, sets[] = {
    {"", "two at different places"},
    {"cam0,320,240,0,0,0\ncam1,100,240,0,0,0", "two at different places"},
    {"cam0,320,240,0,0,0", "two cameras"},
    {"cam0,320,240,0,0,0\ncam0,320,240,0,0,0", "two cameras"},
  };
  ClothRandom random;
  g_autoptr (ClothRig) rig = NULL;
  g_autoptr (GString) many = g_string_new (NULL);
  g_autoptr (GArray) good = NULL;
  g_autoptr (GError) error = NULL;

  cloth_random_init (&random, 5);
  rig = some_rig (&random);
  for (guint i = 0; i < G_N_ELEMENTS (lines); i++) {
    g_autoptr (GError) wrong = NULL;

    g_assert_null (cloth_world_points_parse (rig, lines[i].text,
            strlen (lines[i].text), &wrong));
    g_assert_error (wrong, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
    if (!strstr (wrong->message, lines[i].says))
      g_error ("“%s” lacks “%s”", wrong->message, lines[i].says);
  }
  for (guint i = 0; i < G_N_ELEMENTS (sets); i++) {
    g_autoptr (GError) wrong = NULL;
    g_autoptr (GArray) points = cloth_world_points_parse (rig, sets[i].text,
        strlen (sets[i].text), &wrong);
    gdouble rms, scale;
    ClothWorld world;

    g_assert_no_error (wrong);
    g_assert_false (cloth_world_of_points (rig, points->len,
            (const ClothWorldPoint *) points->data, &world, &rms, &scale,
            &wrong));
    if (!strstr (wrong->message, sets[i].says))
      g_error ("“%s” lacks “%s”", wrong->message, sets[i].says);
  }
  for (guint i = 0; i <= CLOTH_WORLD_MAX_POINTS; i++)
    g_string_append (many, "cam0,1,2,3,4,5\n");
  g_assert_null (cloth_world_points_parse (rig, many->str, many->len, &error));
  g_assert_nonnull (strstr (error->message, "more than"));
  good = cloth_world_points_parse (rig, " cam1 , 1, 2.5,3,-4,5e-1 # x\r\n", 31,
      NULL);
  g_assert_cmpuint (good->len, ==, 1);
  g_assert_cmpuint (g_array_index (good, ClothWorldPoint, 0).camera, ==, 1);
  g_assert_cmpfloat (g_array_index (good, ClothWorldPoint, 0).world[2], ==,
      0.5);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/world/points", test_points);
  g_test_add_func ("/world/plumb", test_plumb);
  g_test_add_func ("/world/board", test_board);
  g_test_add_func ("/world/camera", test_camera);
  g_test_add_func ("/world/bad", test_bad);
  return g_test_run ();
}
