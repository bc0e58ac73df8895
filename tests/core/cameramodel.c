/* mrcal's .cameramodel: files that mrcal wrote, what we write, and files that are wrong.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/rig/cameramodel.h"
#include "gst/rig/rotation.h"

#define BOARDS TEST_DATA "/opencv_boards/"

static ClothRig *
load_pair (void)
{
  const gchar *paths[] = { BOARDS "left.cameramodel",
    BOARDS "right.cameramodel", NULL
  };
  g_autoptr (GError) error = NULL;
  ClothRig *rig = cloth_rig_import_mrcal (paths, &error);

  g_assert_no_error (error);
  return rig;
}

/* As mrcal.txt has them, and cv2.stereoCalibrate the baseline. */
static void
test_import (void)
{
  static const gdouble intrinsics[2][9] = {
    {533.417273, 533.442561, 342.534475, 234.724703, -0.28198542,
        0.0389675253, 0.00120919728, -0.000126132761, 0.118845248},
    {537.023758, 536.604015, 327.43471, 249.888395, -0.296224069,
        0.139211596, -0.000500198224, 9.90183142e-05, -0.0493319962}
  };
  static const gdouble baseline[3] = { -0.0831763, 0.00091985, -0.00011795 };
  g_autoptr (ClothRig) rig = load_pair ();

  g_assert_cmpuint (rig->n_cameras, ==, 2);
  g_assert_cmpstr (rig->cameras[0].name, ==, "left");
  g_assert_cmpstr (rig->cameras[1].name, ==, "right");
  for (guint c = 0; c < 2; c++) {
    const ClothCamera *camera = &rig->cameras[c];
    const gdouble *v = intrinsics[c];

    g_assert_cmpint (camera->width, ==, 640);
    g_assert_cmpint (camera->height, ==, 480);
    g_assert_cmpint (camera->lens, ==, CLOTH_LENS_BROWN5);
    g_assert_cmpfloat (fabs (camera->K[0] - v[0]), <, 1e-5);
    g_assert_cmpfloat (fabs (camera->K[4] - v[1]), <, 1e-5);
    g_assert_cmpfloat (fabs (camera->K[2] - v[2]), <, 1e-5);
    g_assert_cmpfloat (fabs (camera->K[5] - v[3]), <, 1e-5);
    for (guint i = 0; i < 5; i++)
      g_assert_cmpfloat (fabs (camera->k[i] - v[4 + i]), <, 1e-8);
  }
  g_assert_cmpfloat (rig->cameras[0].R[0], ==, 1);
  for (guint i = 0; i < 3; i++)
    g_assert_cmpfloat (fabs (rig->cameras[1].t[i] - baseline[i]), <, 1e-4);
}

static void
test_round (void)
{
  static const gdouble r[3] = { 0.3, -1.2, 2.1 };
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = g_dir_make_tmp ("cloth-mrcal-XXXXXX", NULL);
  g_autofree gchar *inner = g_build_filename (folder, "new", NULL);
  g_autofree gchar *left = g_build_filename (inner, "left.cameramodel", NULL);
  g_autofree gchar *right = g_build_filename (inner, "right.cameramodel", NULL);
  const gchar *paths[] = { left, right, NULL };
  g_autoptr (ClothRig) rig = load_pair (), again = NULL;

  rig->cameras[1].lens = CLOTH_LENS_BROWN8;
  rig->cameras[1].k[6] = -0.0123;
  cloth_rotation_from_vector (r, rig->cameras[1].R);
  g_assert_true (cloth_rig_export_mrcal (rig, inner, &error));
  g_assert_no_error (error);
  again = cloth_rig_import_mrcal (paths, &error);
  g_assert_no_error (error);
  for (guint c = 0; c < 2; c++) {
    const ClothCamera *a = &rig->cameras[c], *b = &again->cameras[c];

    g_assert_cmpint (a->lens, ==, b->lens);
    g_assert_cmpmem (a->K, sizeof a->K, b->K, sizeof b->K);
    g_assert_cmpmem (a->k, sizeof a->k, b->k, sizeof b->k);
    g_assert_cmpmem (a->t, sizeof a->t, b->t, sizeof b->t);
    for (guint i = 0; i < 9; i++)
      g_assert_cmpfloat (fabs (a->R[i] - b->R[i]), <, 1e-12);
  }
  g_unlink (left);
  g_unlink (right);

  /* What mrcal lacks is refused before anything is written. */
  rig->cameras[1].lens = CLOTH_LENS_FISHEYE;
  g_assert_false (cloth_rig_export_mrcal (rig, inner, &error));
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
  g_assert_nonnull (strstr (error->message, "fisheye"));
  g_assert_false (g_file_test (left, G_FILE_TEST_EXISTS));
  g_clear_error (&error);
  rig->cameras[1].lens = CLOTH_LENS_NONE;
  rig->cameras[0].K[1] = 0.5;
  g_assert_false (cloth_rig_export_mrcal (rig, inner, &error));
  g_assert_nonnull (strstr (error->message, "skew"));
  g_clear_error (&error);
  rig->cameras[0].K[1] = 0;
  g_assert_false (cloth_rig_export_mrcal (rig, "/dev/null/x", &error));
  g_assert_nonnull (error);
  g_rmdir (inner);
  g_rmdir (folder);
}

#define GOOD "'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [500, 501, 320, 240,],"
#define PLACE "'extrinsics': [0, 0, 0, 1, 2, 3], 'imagersize': [640, 480]"

static void
test_good (void)
{
  static const gchar text[] =
      "# it's\n{ 'n': 'no # comment b', 'x': b'{#,\"[', 'lensmodel': "
      "'LENSMODEL_OPENCV4', 'intrinsics': [500, 501, 320, 240, -.1, .02, 1e-3, "
      "-2e-3], " PLACE ", 'y': b\"'\" }";
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_import_mrcal_data (text, strlen (text),
      &error);

  g_assert_no_error (error);
  g_assert_cmpint (rig->cameras[0].lens, ==, CLOTH_LENS_BROWN5);
  g_assert_cmpfloat (rig->cameras[0].k[3], ==, -2e-3);
  g_assert_cmpfloat (rig->cameras[0].k[4], ==, 0);
  g_assert_cmpfloat (rig->cameras[0].t[2], ==, 3);
}

static void
test_bad (void)
{
  static const struct
  {
    const gchar *text, *says;
  } bad[] = {
    {"", "YAML"},
    {"{ 'a': b'never ends", "YAML"},
    {"[1]", "no .cameramodel"},
    {"{ 'lensmodel': [], " PLACE "}", "no .cameramodel"},
    {"{ 'lensmodel': 'LENSMODEL_CAHVORE_linearity=0.00', " PLACE "}",
        "mrcal-convert-lensmodel"},
    {"{ 'lensmodel': 'LENSMODEL_PINHOLE', " PLACE "}", "intrinsics"},
    {"{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [1, 2, 3], " PLACE "}",
        "holds 3 numbers, not 4"},
    {"{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [1, 2, 3, 4, 5], "
          PLACE "}", "holds more than 4"},
    {"{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [1, 2, nan, 4], "
          PLACE "}", "number 3"},
    {"{ " GOOD " 'imagersize': [640, 480] }", "extrinsics"},
    {"{ " GOOD " 'extrinsics': [0, 0, 0, 1, 2], 'imagersize': [640, 480] }",
        "holds 5 numbers, not 6"},
    {"{ " GOOD " 'extrinsics': [1e300, 0, 0, 1, 2, 3], 'imagersize': "
          "[640, 480] }", "no angle"},
    {"{ " GOOD " 'extrinsics': [0, 0, 0, 1, 2, 3] }", "imagersize"},
    {"{ " GOOD " 'extrinsics': [0, 0, 0, 1, 2, 3], 'imagersize': [640.5, 480] "
          "}", "whole number"},
    {"{ " GOOD " 'extrinsics': [0, 0, 0, 1, 2, 3], 'imagersize': [640, 99999] "
          "}", "whole number"},
    {"{ 'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': [-1, 2, 3, 4], " PLACE
          "}", "K"},
  };
  const gchar *none[] = { NULL };
  const gchar *missing[] = { BOARDS "none.cameramodel", NULL };
  const gchar *other[] = { BOARDS "left_intrinsics.yml", NULL };
  g_autoptr (GError) error = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_autoptr (GError) wrong = NULL;

    g_assert_null (cloth_rig_import_mrcal_data (bad[i].text,
            strlen (bad[i].text), &wrong));
    g_assert_nonnull (wrong);
    if (!strstr (wrong->message, bad[i].says))
      g_error ("%s: “%s” lacks “%s”", bad[i].text, wrong->message,
          bad[i].says);
  }
  g_assert_null (cloth_rig_import_mrcal (none, &error));
  g_assert_nonnull (strstr (error->message, "0 files"));
  g_clear_error (&error);
  g_assert_null (cloth_rig_import_mrcal (missing, &error));
  g_assert_nonnull (strstr (error->message, "none.cameramodel"));
  g_clear_error (&error);
  g_assert_null (cloth_rig_import_mrcal (other, &error));
  g_assert_nonnull (strstr (error->message, "left_intrinsics.yml: lensmodel"));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/cameramodel/import", test_import);
  g_test_add_func ("/cameramodel/round", test_round);
  g_test_add_func ("/cameramodel/good", test_good);
  g_test_add_func ("/cameramodel/bad", test_bad);
  return g_test_run ();
}
