/* Import of OpenCV's and Kalibr's calibrations, good and bad.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/rig/rigyaml.h"

#define BOARDS TEST_DATA "/opencv_boards/"

static void
test_opencv_intrinsics (void)
{
  const gchar *paths[] = { BOARDS "left_intrinsics.yml", NULL };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_import_opencv (paths, 0, 0, &error);
  const ClothCamera *c;

  g_assert_no_error (error);
  g_assert_cmpuint (rig->n_cameras, ==, 1);
  c = cloth_rig_find (rig, "left_intrinsics");
  g_assert_nonnull (c);
  g_assert_cmpint (c->width, ==, 640);
  g_assert_cmpint (c->height, ==, 480);
  g_assert_cmpfloat (c->K[0], ==, 5.3591573396163199e+02);
  g_assert_cmpfloat (c->K[5], ==, 2.3557082909788173e+02);
  g_assert_cmpint (c->lens, ==, CLOTH_LENS_BROWN5);
  g_assert_cmpfloat (c->k[3], ==, -2.8122100441115472e-04);
  g_assert_cmpfloat (c->k[4], ==, 2.3839153080878486e-01);
  g_assert_cmpfloat (c->R[0], ==, 1);
  g_clear_pointer (&rig, cloth_rig_free);

  g_assert_null (cloth_rig_import_opencv (paths, 320, 240, &error));
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
  g_assert_nonnull (strstr (error->message, "640×480, not 320×240"));
}

/* OpenCV's stereo sample writes two files and no picture size. */
static void
test_opencv_stereo (void)
{
  static const gchar extrinsics[] = "%YAML:1.0\n---\n"
      "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 0., -1., 0., 1., 0., 0., 0., 0., 1. ]\n"
      "T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n"
      "   data: [ -3.5e-01, .5, 1e-3 ]\n";
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = NULL;
  g_autofree gchar *dir = g_dir_make_tmp ("rigXXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (dir, "extrinsics.yml", NULL);
  const gchar *paths[] = { BOARDS "intrinsics.yml", path, NULL };
  const gchar *alone[] = { BOARDS "intrinsics.yml", NULL };

  g_assert_true (g_file_set_contents (path, extrinsics, -1, NULL));
  rig = cloth_rig_import_opencv (paths, 640, 480, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (rig->n_cameras, ==, 2);
  g_assert_cmpfloat (cloth_rig_find (rig, "left")->k[0], ==,
      2.9589439552724328e-01);
  g_assert_cmpfloat (cloth_rig_find (rig, "left")->t[0], ==, 0);
  g_assert_cmpfloat (cloth_rig_find (rig, "right")->K[2], ==,
      3.3455744527912015e+02);
  g_assert_cmpfloat (cloth_rig_find (rig, "right")->R[1], ==, -1);
  g_assert_cmpfloat (cloth_rig_find (rig, "right")->t[1], ==, 0.5);

  g_assert_null (cloth_rig_import_opencv (paths, 0, 0, &error));
  g_assert_nonnull (strstr (error->message, "no picture size"));
  g_clear_error (&error);
  g_assert_null (cloth_rig_import_opencv (alone, 640, 480, &error));
  g_assert_nonnull (strstr (error->message, "R: is missing"));
  g_clear_error (&error);
  g_unlink (path);
  g_assert_null (cloth_rig_import_opencv (paths, 640, 480, &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  g_rmdir (dir);
}

static const gchar mono[] = "%YAML:1.0\n---\ncamera_name: top\n"
    "image_width: 640\nimage_height: 480\nfisheye_model: 1\n"
    "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 500., 0., 320., 0., 501., 240., 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n"
    "   dt: d\n   data: [ 1e-1, -2e-2, 3e-3, 4e-4 ]\n";

static void
test_opencv_fisheye (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_import_opencv_data (mono,
      strlen (mono), 0, 0, &error);
  const ClothCamera *c;

  g_assert_no_error (error);
  c = cloth_rig_find (rig, "top");
  g_assert_nonnull (c);
  g_assert_cmpint (c->lens, ==, CLOTH_LENS_FISHEYE);
  g_assert_cmpfloat (c->k[3], ==, 4e-4);
}

/* The layout of Kalibr's own documentation. */
static const gchar chain[] = "cam0:\n  camera_model: pinhole\n"
    "  intrinsics: [461.629, 460.152, 362.680, 246.049]\n"
    "  distortion_model: radtan\n"
    "  distortion_coeffs: [-0.27695, 0.06712, 0.00087, 0.00011]\n"
    "  T_cam_imu:\n  - [1.0, 0.0, 0.0, 0.0]\n"
    "  timeshift_cam_imu: -8.1e-05\n"
    "  rostopic: /cam0/image_raw\n  resolution: [752, 480]\n"
    "cam1:\n  camera_model: pinhole\n  distortion_model: equidistant\n"
    "  intrinsics: [460, 461, 370, 250]\n"
    "  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]\n"
    "  resolution: [752, 480]\n"
    "  T_cn_cnm1:\n  - [0.0, -1.0, 0.0, 0.1]\n  - [1.0, 0.0, 0.0, 0.2]\n"
    "  - [0.0, 0.0, 1.0, 0.3]\n  - [0.0, 0.0, 0.0, 1.0]\n"
    "cam2:\n  camera_model: pinhole\n  distortion_model: none\n"
    "  distortion_coeffs: []\n  intrinsics: [460, 461, 370, 250]\n"
    "  resolution: [752, 480]\n"
    "  T_cn_cnm1:\n  - [0.0, -1.0, 0.0, 0.1]\n  - [1.0, 0.0, 0.0, 0.2]\n"
    "  - [0.0, 0.0, 1.0, 0.3]\n  - [0.0, 0.0, 0.0, 1.0]\n";

static void
test_kalibr (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_import_kalibr_data (chain,
      strlen (chain), &error);
  const ClothCamera *c;
  /* A quarter turn twice is a half turn; (0.1, 0.2) turned is (−0.2, 0.1). */
  static const gdouble R[9] = { -1, 0, 0, 0, -1, 0, 0, 0, 1 };
  static const gdouble t[3] = { -0.1, 0.3, 0.6 };

  g_assert_no_error (error);
  g_assert_cmpuint (rig->n_cameras, ==, 3);
  c = cloth_rig_find (rig, "cam0");
  g_assert_cmpint (c->lens, ==, CLOTH_LENS_BROWN5);
  g_assert_cmpfloat (c->k[2], ==, 0.00087);
  g_assert_cmpfloat (c->k[4], ==, 0);
  g_assert_cmpfloat (c->K[4], ==, 460.152);
  c = cloth_rig_find (rig, "cam1");
  g_assert_cmpint (c->lens, ==, CLOTH_LENS_FISHEYE);
  g_assert_cmpfloat (c->t[2], ==, 0.3);
  c = cloth_rig_find (rig, "cam2");
  g_assert_cmpint (c->lens, ==, CLOTH_LENS_NONE);
  for (gint i = 0; i < 9; i++)
    g_assert_cmpfloat (c->R[i], ==, R[i]);
  for (gint i = 0; i < 3; i++)
    g_assert_cmpfloat (fabs (c->t[i] - t[i]), <, 1e-15);
}

typedef struct
{
  const gchar *from, *to;
  ClothRigError code;
  const gchar *says;
} Bad;

static const Bad bad_opencv[] = {
  {"501.", ".Nan", CLOTH_RIG_ERROR_VALUE, "camera_matrix"},
  {"501.", "1e999", CLOTH_RIG_ERROR_VALUE, "camera_matrix"},
  {"501.", "{a: 1}", CLOTH_RIG_ERROR_VALUE, "camera_matrix"},
  {"501.", "-501.", CLOTH_RIG_ERROR_VALUE, "K"},
  {"501.,", "", CLOTH_RIG_ERROR_VALUE, "holds 8"},
  {"501.,", "1,2,3,", CLOTH_RIG_ERROR_VALUE, "more than 9"},
  {"501.,", "*x,", CLOTH_RIG_ERROR_SYNTAX, "aliases"},
  {"rows: 3", "rows: 4", CLOTH_RIG_ERROR_VALUE, "says 4×3"},
  {"501.", "''", CLOTH_RIG_ERROR_VALUE, "\"\" is not a finite number"},
  {"501.", "5 01.", CLOTH_RIG_ERROR_VALUE, "not a finite number"},
  {"[ 500., 0., 320., 0., 501., 240., 0., 0., 1. ]", "7",
      CLOTH_RIG_ERROR_VALUE, "camera_matrix: must be a list of numbers"},
  {"500., 0., 320.,", "[ 500., x, 320. ],", CLOTH_RIG_ERROR_VALUE,
      "\"x\" is not a finite number"},
  {"rows: 3", "rows: x", CLOTH_RIG_ERROR_VALUE, "rows, cols and data"},
  {"cols: 3", "cols: [3]", CLOTH_RIG_ERROR_VALUE, "rows, cols and data"},
  {"camera_matrix", "matrix", CLOTH_RIG_ERROR_VALUE, "camera_matrix"},
  {"distortion_coefficients", "k", CLOTH_RIG_ERROR_VALUE,
      "distortion_coefficients"},
  {"fisheye_model: 1", "fisheye_model: 0\nimage_width: 3",
      CLOTH_RIG_ERROR_VALUE, "twice"},
  {"rows: 4", "rows: 1", CLOTH_RIG_ERROR_VALUE, "says 1×1"},
  {", 4e-4", "", CLOTH_RIG_ERROR_VALUE, "says 4×1 but holds 3"},
  {"rows: 4\n   cols: 1\n   dt: d\n   data: [ ",
        "rows: 5\n   cols: 1\n   dt: d\n   data: [ 7, ",
      CLOTH_RIG_ERROR_VALUE, "coefficient 5"},
  {"rows: 4\n   cols: 1\n   dt: d\n   data: [ 1e-1, ",
        "rows: 3\n   cols: 1\n   dt: d\n   data: [ ",
      CLOTH_RIG_ERROR_VALUE, "holds 3 coefficients; a fisheye has 4"},
  {"fisheye_model: 1\ncamera_matrix", "matrix", CLOTH_RIG_ERROR_VALUE,
      "camera_matrix: is missing"},
  {"image_height: 480", "image_height: high", CLOTH_RIG_ERROR_VALUE,
      "numbers"},
  {"image_height: 480", "image_height: 480.5", CLOTH_RIG_ERROR_VALUE,
      "480.5 must be"},
  {"image_width: 640", "image_width: 0", CLOTH_RIG_ERROR_VALUE, "0 must be"},
  {"image_width: 640", "image_width: 6e9", CLOTH_RIG_ERROR_VALUE, "6e+09"},
  {"image_width: 640", "image_width: wide", CLOTH_RIG_ERROR_VALUE, "numbers"},
  {"image_width: 640\n", "", CLOTH_RIG_ERROR_VALUE, "no picture size"},
  {"camera_name: top", "camera_name: a/b", CLOTH_RIG_ERROR_VALUE, "slash"},
  {"camera_name: top", "camera_name: [top", CLOTH_RIG_ERROR_SYNTAX, "line"},
  {"camera_name: top", "? [a]\n: top", CLOTH_RIG_ERROR_SYNTAX, "plain text"},
  {"camera_name: top", "camera_name: \"t\\0p\"", CLOTH_RIG_ERROR_SYNTAX,
      "line 3: text holds a 0"},
};

static const Bad bad_kalibr[] = {
  {"cam0", "camera0", CLOTH_RIG_ERROR_VALUE, "cam0: is missing"},
  {"pinhole", "omni", CLOTH_RIG_ERROR_VALUE, "\"omni\""},
  {"camera_model: pinhole", "a: b", CLOTH_RIG_ERROR_VALUE,
      "cam0.camera_model"},
  {"camera_model: pinhole", "camera_model: [a]", CLOTH_RIG_ERROR_VALUE,
      "cam0.camera_model: is missing or no text"},
  {"distortion_model: radtan", "a: b", CLOTH_RIG_ERROR_VALUE,
      "cam0.distortion_model: is missing or no text"},
  {"[752, 480]", "[752, 0]", CLOTH_RIG_ERROR_VALUE, "0 must be"},
  {"[752, 480]", "[1e9, 480]", CLOTH_RIG_ERROR_VALUE, "1e+09 must be"},
  {"- [0.0, 0.0, 0.0, 1.0]", "- [0.1, 0.0, 0.0, 1.0]", CLOTH_RIG_ERROR_VALUE,
      "last row"},
  {"- [0.0, 0.0, 0.0, 1.0]", "- [0.0, 0.1, 0.0, 1.0]", CLOTH_RIG_ERROR_VALUE,
      "last row"},
  {"- [0.0, 0.0, 0.0, 1.0]", "- [0.0, 0.0, 0.1, 1.0]", CLOTH_RIG_ERROR_VALUE,
      "last row"},
  {"radtan", "fov", CLOTH_RIG_ERROR_VALUE, "\"fov\""},
  {"0.00087,", "", CLOTH_RIG_ERROR_VALUE, "cam0.distortion_coeffs"},
  {"461.629", "0", CLOTH_RIG_ERROR_VALUE, "cameras[0].K"},
  {"461.629", ".inf", CLOTH_RIG_ERROR_VALUE, "cam0.intrinsics"},
  {"[752, 480]", "[752]", CLOTH_RIG_ERROR_VALUE, "cam0.resolution"},
  {"[752, 480]", "[752.5, 480]", CLOTH_RIG_ERROR_VALUE, "cam0.resolution"},
  {"T_cn_cnm1", "T", CLOTH_RIG_ERROR_VALUE, "cam1.T_cn_cnm1: is missing"},
  {"[0.0, -1.0, 0.0, 0.1]", "[0.0, -1.1, 0.0, 0.1]", CLOTH_RIG_ERROR_VALUE,
      "cameras[1].R"},
  {"[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.0, 2.0]", CLOTH_RIG_ERROR_VALUE,
      "last row"},
  {"[0.0, 0.0, 0.0, 1.0]", "[0.0, 0.0, 0.0]", CLOTH_RIG_ERROR_VALUE,
      "15 numbers, not 16"},
};

static void
assert_refused (gboolean kalibr, const gchar * text, ClothRigError code,
    const gchar * says)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = kalibr ?
      cloth_rig_import_kalibr_data (text, strlen (text), &error)
      : cloth_rig_import_opencv_data (text, strlen (text), 0, 0, &error);

  g_assert_null (rig);
  g_test_message ("%s", error->message);
  g_assert_error (error, CLOTH_RIG_ERROR, (gint) code);
  g_assert_nonnull (strstr (error->message, says));
}

static void
test_bad (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (bad_opencv); i++) {
    g_auto (GStrv) parts = g_strsplit (mono, bad_opencv[i].from, 2);
    g_autofree gchar *text = g_strjoinv (bad_opencv[i].to, parts);

    g_assert_cmpuint (g_strv_length (parts), ==, 2);
    assert_refused (FALSE, text, bad_opencv[i].code, bad_opencv[i].says);
  }
  for (guint i = 0; i < G_N_ELEMENTS (bad_kalibr); i++) {
    g_auto (GStrv) parts = g_strsplit (chain, bad_kalibr[i].from, 2);
    g_autofree gchar *text = g_strjoinv (bad_kalibr[i].to, parts);

    g_assert_cmpuint (g_strv_length (parts), ==, 2);
    assert_refused (TRUE, text, bad_kalibr[i].code, bad_kalibr[i].says);
  }
}

/* The second camera's turn as a vector along its axis, as long as the angle: a quarter about
 * z takes x to y. Nothing else that is short of a matrix is taken. */
static void
test_rotation_vector (void)
{
  static const gchar format[] = "%%YAML:1.0\n---\n"
      "image_width: 640\nimage_height: 480\n"
      "M1: [ 500, 0, 320, 0, 500, 240, 0, 0, 1 ]\nD1: [ 0, 0, 0, 0 ]\n"
      "M2: [ 500, 0, 320, 0, 500, 240, 0, 0, 1 ]\nD2: [ 0, 0, 0, 0 ]\n"
      "R: %s\nT: [ 1, 2, 3 ]\n";
  static const gdouble quarter[9] = { 0, -1, 0, 1, 0, 0, 0, 0, 1 };
  static const gchar *const bad[][2] = {
    {"[ 1, 0 ]", "2 numbers, not 9 or 3"},
    {"[ 0, 0, 0, 1 ]", "4 numbers, not 9 or 3"},
    {"[ 0, 0, .nan ]", "not a finite number"},
    {"[ 0, 0, {a: 1} ]", "not a finite number"},
    {"[ 1, 0, 0, 0, 1, 0, 0, 0, 1, 0 ]", "more than 9 numbers"},
    {"1", "rows, cols and data"},
    {"{ rows: 3, data: [ 0, 0, 1 ] }", "rows, cols and data"},
  };
  g_autofree gchar *text =
      g_strdup_printf (format, "[ 0, 0, 1.5707963267948966 ]");
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig =
      cloth_rig_import_opencv_data (text, strlen (text), 0, 0, &error);

  g_assert_no_error (error);
  for (guint i = 0; i < 9; i++)
    g_assert_cmpfloat_with_epsilon (rig->cameras[1].R[i], quarter[i], 1e-12);
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_autofree gchar *worse = g_strdup_printf (format, bad[i][0]);

    assert_refused (FALSE, worse, CLOTH_RIG_ERROR_VALUE, bad[i][1]);
  }
}

/* The lens that a file's coefficients mean, whatever they are called. */
static void
test_opencv_lenses (void)
{
  static const struct
  {
    const gchar *line, *coefficients;
    ClothLens lens;
    const gchar *says;
  } cases[] = {
    {"a: b", "[]", CLOTH_LENS_NONE, NULL},
    {"a: b", "[ .1, .2, .3, .4 ]", CLOTH_LENS_BROWN5, NULL},
    {"a: b", "[ .1, .2, .3, .4, .5 ]", CLOTH_LENS_BROWN5, NULL},
    {"a: b", "[ .1, .2, .3, .4, .5, .6, .7, .8 ]", CLOTH_LENS_BROWN8, NULL},
    {"a: b", "[ .1, 0, 0, 0, 0, .6, 0, 0, 0, 0, 0, 0 ]", CLOTH_LENS_BROWN8,
        NULL},
    {"a: b", "[ .1, 0, 0, 0, 0, .6, 0, 0, 0, 0, 0, 0, 0, 0 ]",
        CLOTH_LENS_BROWN8, NULL},
    {"fisheye_model: 0", "[ .1, .2, .3, .4 ]", CLOTH_LENS_BROWN5, NULL},
    {"fisheye_model: no", "[ .1, .2, .3, .4 ]", CLOTH_LENS_BROWN5, NULL},
    {"distortion_model: plumb_bob", "[ .1, .2, .3, .4, .5 ]",
        CLOTH_LENS_BROWN5, NULL},
    {"distortion_model: [ fisheye ]", "[ .1, .2, .3, .4 ]", CLOTH_LENS_BROWN5,
        NULL},
    {"distortion_model: equidistant", "[ .1, .2, .3, .4 ]", CLOTH_LENS_FISHEYE,
        NULL},
    {"distortion_model: fisheye", "[ .1, .2, .3, .4 ]", CLOTH_LENS_FISHEYE,
        NULL},
    {"a: b", "[ 1, 0, 0 ]", 0, "holds 3 coefficients; OpenCV knows 4, 5, 8, "},
    {"a: b", "[ 1, 0, 0, 0, 0, 0, 0, 0, 0 ]", 0, "holds 9 coefficients"},
    {"a: b", "[ .1, 0, 0, 0, 0, 0, 0, 0, .5, 0, 0, 0 ]", 0,
        "coefficient 9 is 0.5; a Brown lens of at most 8"},
    {"a: b", "[ 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 ]", 0,
        "more than 14 numbers"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *text = g_strdup_printf ("%s\ncamera_name: [ top ]\n"
        "image_width: 640\nimage_height: 480\nK: [ 500, 0, 320, 0, 500, 240, "
        "0, 0, 1 ]\nD: %s\n", cases[i].line, cases[i].coefficients);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRig) rig = NULL;

    if (cases[i].says) {
      assert_refused (FALSE, text, CLOTH_RIG_ERROR_VALUE, cases[i].says);
      continue;
    }
    rig = cloth_rig_import_opencv_data (text, strlen (text), 640, 480, &error);
    g_assert_no_error (error);
    g_assert_cmpint (rig->cameras[0].lens, ==, cases[i].lens);
    g_assert_cmpfloat (rig->cameras[0].k[0], ==, i ? .1 : 0);
    /* A list is no name. */
    g_assert_cmpstr (rig->cameras[0].name, ==, "camera");
    g_clear_pointer (&rig, cloth_rig_free);
    g_assert_null (cloth_rig_import_opencv_data (text, strlen (text), 640, 240,
            &error));
    g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
    g_assert_nonnull (strstr (error->message, "640×480, not 640×240"));
  }
}

/* What a stereo file lacks is named. */
static void
test_bad_stereo (void)
{
  static const gchar good[] = "M1: [ 500, 0, 320, 0, 500, 240, 0, 0, 1 ]\n"
      "D1: [ 0, 0, 0, 0 ]\nM2: [ 500, 0, 320, 0, 500, 240, 0, 0, 1 ]\n"
      "D2: [ 0, 0, 0, 0 ]\nR: [ 0, 0, 0 ]\nT: [ 1, 2, 3 ]\n"
      "image_width: 640\nimage_height: 480\n";
  static const gchar *const cases[][3] = {
    {"M2", "N2", "M2: is missing"},
    {"M2: [ 500", "M2: [ x", "M2: \"x\" is not a finite number"},
    {"D1", "E", "D1: is missing"},
    {"D2: [ 0,", "D2: [", "D2: holds 3 coefficients"},
    {"image_width", "w", "no picture size"},
    {"R: ", "S: ", "R: is missing; give the file"},
    {"T: ", "U: ", "T: is missing; give the file"},
    {"T: [ 1,", "T: [", "T: holds 2 numbers, not 3"},
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig =
      cloth_rig_import_opencv_data (good, strlen (good), 0, 0, &error);

  g_assert_no_error (error);
  g_assert_cmpfloat (rig->cameras[1].t[2], ==, 3);
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_auto (GStrv) parts = g_strsplit (good, cases[i][0], 2);
    g_autofree gchar *text = g_strjoinv (cases[i][1], parts);

    g_assert_cmpuint (g_strv_length (parts), ==, 2);
    assert_refused (FALSE, text, CLOTH_RIG_ERROR_VALUE, cases[i][2]);
  }
}

/* Messages begin with the file; a camera without a name has that of its file. */
static void
test_files (void)
{
  static const struct
  {
    const gchar *name, *camera;
  } named[] = { {"front.yml", "front"}, {"front", "front"}, {".yml", ".yml"} };
  const gchar *none[] = { NULL };
  g_autofree gchar *dir = g_dir_make_tmp ("rigXXXXXX", NULL);
  g_autofree gchar *missing = g_build_filename (dir, "missing", NULL);
  g_auto (GStrv) parts = g_strsplit (mono, "camera_name: top\n", 2);
  g_autofree gchar *text = g_strjoinv ("", parts);
  g_autoptr (GError) error = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (named); i++) {
    g_autofree gchar *path = g_build_filename (dir, named[i].name, NULL);
    const gchar *paths[] = { path, NULL };
    g_autoptr (ClothRig) rig = NULL;

    g_assert_true (g_file_set_contents (path, text, -1, NULL));
    rig = cloth_rig_import_opencv (paths, 0, 0, &error);
    g_assert_no_error (error);
    g_assert_cmpstr (rig->cameras[0].name, ==, named[i].camera);
    g_clear_pointer (&rig, cloth_rig_free);

    g_assert_true (g_file_set_contents (path, chain, -1, NULL));
    rig = cloth_rig_import_kalibr (path, &error);
    g_assert_no_error (error);
    g_assert_cmpuint (rig->n_cameras, ==, 3);

    g_assert_true (g_file_set_contents (path, "a: [", -1, NULL));
    g_assert_null (cloth_rig_import_opencv (paths, 0, 0, &error));
    g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_SYNTAX);
    g_assert_true (g_str_has_prefix (error->message, path));
    g_clear_error (&error);
    g_assert_null (cloth_rig_import_kalibr (path, &error));
    g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_SYNTAX);
    g_assert_true (g_str_has_prefix (error->message, path));
    g_clear_error (&error);
    g_unlink (path);
  }
  g_assert_null (cloth_rig_import_kalibr (missing, &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  g_clear_error (&error);
  g_assert_null (cloth_rig_import_opencv (none, 640, 480, &error));
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
  g_assert_true (g_str_has_prefix (error->message, "no file: "));
  g_rmdir (dir);
}

static void
test_hostile (void)
{
  g_autofree gchar *deep = g_strnfill (100000, '[');
  g_autoptr (GString) long_list = g_string_new ("a: [");
  g_autoptr (GString) keys = g_string_new ("");
  g_autoptr (GString) cameras = g_string_new ("");

  /* The one that hangs OpenCV 4.6's own reader for ever. */
  assert_refused (FALSE, "%YAML:1.0\n---a: 1\nb<!--\nc: 2\n",
      CLOTH_RIG_ERROR_SYNTAX, "line");
  assert_refused (FALSE, deep, CLOTH_RIG_ERROR_LIMIT, "nested");
  for (guint i = 0; i < 300000; i++)
    g_string_append (long_list, "1,");
  g_string_append (long_list, "1]");
  assert_refused (FALSE, long_list->str, CLOTH_RIG_ERROR_LIMIT, "200000");
  for (guint i = 0; i < 1500; i++)
    g_string_append_printf (keys, "k%u: 1\n", i);
  assert_refused (FALSE, keys->str, CLOTH_RIG_ERROR_LIMIT, "1000 keys");
  for (guint i = 0; i <= CLOTH_RIG_MAX_CAMERAS; i++)
    g_string_append_printf (cameras, "cam%u: 1\n", i);
  /* A bomb of aliases. */
  assert_refused (TRUE, "a: &a [x,x]\nb: &b [*a,*a]\n",
      CLOTH_RIG_ERROR_SYNTAX, "aliases");
  assert_refused (TRUE, cameras->str, CLOTH_RIG_ERROR_VALUE,
      "more than 64 cameras");
  assert_refused (TRUE, "", CLOTH_RIG_ERROR_SYNTAX, "no YAML document");
  assert_refused (FALSE, "%YAML:1.0", CLOTH_RIG_ERROR_SYNTAX,
      "no YAML document");
  assert_refused (FALSE, "just text", CLOTH_RIG_ERROR_VALUE, "camera_matrix");
  assert_refused (FALSE, "\xff\xfe\xfd", CLOTH_RIG_ERROR_SYNTAX, "not YAML");
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/rigyaml/opencv-intrinsics", test_opencv_intrinsics);
  g_test_add_func ("/rigyaml/opencv-stereo", test_opencv_stereo);
  g_test_add_func ("/rigyaml/opencv-fisheye", test_opencv_fisheye);
  g_test_add_func ("/rigyaml/kalibr", test_kalibr);
  g_test_add_func ("/rigyaml/bad", test_bad);
  g_test_add_func ("/rigyaml/rotation-vector", test_rotation_vector);
  g_test_add_func ("/rigyaml/opencv-lenses", test_opencv_lenses);
  g_test_add_func ("/rigyaml/bad-stereo", test_bad_stereo);
  g_test_add_func ("/rigyaml/files", test_files);
  g_test_add_func ("/rigyaml/hostile", test_hostile);
  return g_test_run ();
}
