/* rig.json: reading, writing and refusing.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "gst/file/file.h"
#include "gst/rig/rigfile.h"

static const gchar good[] =
    "{\"version\":1,\"cameras\":[{\"name\":\"left\",\"size\":[640,480],"
    "\"K\":[[500.5,0,320],[0,501,240],[0,0,1]],"
    "\"distortion\":{\"model\":\"fisheye\",\"coefficients\":[0.1,0.2,-3e-3,4]},"
    "\"R\":[[0,-1,0],[1,0,0],[0,0,1]],\"t\":[0.1,0.2,3],"
    "\"device\":\"/dev/video0\",\"rolling_shutter_s\":0.02,\"offset_s\":-0.5,"
    "\"standard_deviations\":{\"K\":[1,2,3,4],\"rotation\":[1,2,3]}}]}";

static void
test_load (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_load_data (good, strlen (good), &error);
  const ClothCamera *c;

  g_assert_no_error (error);
  g_assert_cmpuint (rig->n_cameras, ==, 1);
  g_assert_null (cloth_rig_find (rig, "right"));
  c = cloth_rig_find (rig, "left");
  g_assert_nonnull (c);
  g_assert_cmpint (c->width, ==, 640);
  g_assert_cmpint (c->height, ==, 480);
  g_assert_cmpfloat (c->K[0], ==, 500.5);
  g_assert_cmpfloat (c->K[5], ==, 240);
  g_assert_cmpint (c->lens, ==, CLOTH_LENS_FISHEYE);
  g_assert_cmpfloat (c->k[2], ==, -3e-3);
  g_assert_cmpfloat (c->R[1], ==, -1);
  g_assert_cmpfloat (c->t[2], ==, 3);
  g_assert_cmpstr (c->device, ==, "/dev/video0");
  g_assert_cmpfloat (c->rolling_shutter_s, ==, 0.02);
  g_assert_cmpfloat (c->offset_s, ==, -0.5);
  g_assert_cmpfloat (c->K_sd[3], ==, 4);
  g_assert_cmpfloat (c->r_sd[2], ==, 3);
  g_assert_cmpfloat (c->t_sd[2], ==, 0);
}

static void
test_rendered (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig =
      cloth_rig_load (TEST_DATA "/checker_pair/rig.json", &error);

  g_assert_no_error (error);
  g_assert_cmpuint (rig->n_cameras, ==, 2);
  g_assert_cmpfloat (cloth_rig_find (rig, "cam1")->t[1], ==,
      0.8496097922325134);
  g_assert_cmpint (rig->cameras[0].lens, ==, CLOTH_LENS_NONE);
}

/* What is saved loads as the same doubles, and saving again gives the same bytes. */
static void
test_save (void)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *dir = g_dir_make_tmp ("rigXXXXXX", NULL);
  g_autofree gchar *a = g_build_filename (dir, "a.json", NULL);
  g_autofree gchar *b = g_build_filename (dir, "b.json", NULL);
  g_autofree gchar *text_a = NULL, *text_b = NULL;
  g_autoptr (ClothRig) rig =
      cloth_rig_load (TEST_DATA "/checker_pair/rig.json", &error);
  g_autoptr (ClothRig) again = NULL;
  g_autofree gchar *missing = g_build_filename (dir, "no", "a.json", NULL);

  g_assert_no_error (error);
  rig->cameras[1].lens = CLOTH_LENS_BROWN8;
  rig->cameras[1].k[7] = 1. / 3;
  rig->cameras[1].t_sd[0] = 1e-7 / 3;
  rig->cameras[0].offset_sd = 1e-3 / 3;
  rig->cameras[0].device = g_strdup ("quote \" and ü");
  g_assert_true (cloth_rig_save (rig, a, &error));
  again = cloth_rig_load (a, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < 2; i++) {
    g_assert_cmpmem (rig->cameras[i].K, sizeof rig->cameras[i].K,
        again->cameras[i].K, sizeof rig->cameras[i].K);
    g_assert_cmpmem (rig->cameras[i].R, sizeof rig->cameras[i].R,
        again->cameras[i].R, sizeof rig->cameras[i].R);
    g_assert_cmpmem (rig->cameras[i].t, sizeof rig->cameras[i].t,
        again->cameras[i].t, sizeof rig->cameras[i].t);
    g_assert_cmpmem (rig->cameras[i].k, sizeof rig->cameras[i].k,
        again->cameras[i].k, sizeof rig->cameras[i].k);
  }
  g_assert_cmpfloat (again->cameras[1].t_sd[0], ==, 1e-7 / 3);
  g_assert_cmpfloat (again->cameras[0].offset_sd, ==, 1e-3 / 3);
  g_assert_cmpstr (again->cameras[0].device, ==, rig->cameras[0].device);
  g_assert_true (cloth_rig_save (again, b, &error));
  g_assert_true (g_file_get_contents (a, &text_a, NULL, NULL));
  g_assert_true (g_file_get_contents (b, &text_b, NULL, NULL));
  g_assert_cmpstr (text_a, ==, text_b);

  g_assert_false (cloth_rig_save (rig, missing, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);

  /* A rig that could not be read back is not written over a good one. */
  again->cameras[0].K[0] = NAN;
  g_assert_false (cloth_rig_save (again, b, &error));
  g_assert_error (error, CLOTH_RIG_ERROR, CLOTH_RIG_ERROR_VALUE);
  g_clear_pointer (&text_b, g_free);
  g_assert_true (g_file_get_contents (b, &text_b, NULL, NULL));
  g_assert_cmpstr (text_a, ==, text_b);
  g_unlink (a);
  g_unlink (b);
  g_assert_cmpint (g_rmdir (dir), ==, 0);
}

/* The example of docs/formats.md is what the writer writes, and where it says the cameras are. */
static void
test_example (void)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = g_dir_make_tmp ("cloth-rig-XXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (folder, "rig.json", NULL);
  g_autofree gchar *page = NULL, *text = NULL;
  g_autoptr (ClothRig) rig = NULL;
  gchar *begin, *end;

  g_assert_true (g_file_get_contents (TEST_DATA "/../../docs/formats.md", &page,
          NULL, &error));
  begin = strstr (strstr (page, "## rig.json"), "```json\n") + 8;
  end = strstr (begin, "```");
  *end = 0;
  rig = cloth_rig_load_data (begin, strlen (begin), &error);
  g_assert_no_error (error);
  g_assert_true (cloth_rig_save (rig, path, &error));
  g_assert_true (g_file_get_contents (path, &text, NULL, &error));
  g_assert_cmpstr (text, ==, begin);
  for (guint i = 0; i < 2; i++) {
    const ClothCamera *c = &rig->cameras[i];
    gdouble centre[3];

    for (guint k = 0; k < 3; k++)
      centre[k] = -(c->R[k] * c->t[0] + c->R[3 + k] * c->t[1] +
          c->R[6 + k] * c->t[2]);
    g_assert_cmpfloat_with_epsilon (centre[0], i == 0 ? -0.15 : 0.15, 1e-12);
    g_assert_cmpfloat_with_epsilon (centre[1], -2, 1e-12);
    g_assert_cmpfloat_with_epsilon (centre[2], 1.2, 1e-12);
    /* the third row is where it looks */
    g_assert_cmpfloat (c->R[7], ==, 1);
  }
  g_remove (path);
  g_rmdir (folder);
}

static void
test_save_some (void)
{
  g_autofree gchar *dir = g_dir_make_tmp ("rigXXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (dir, "a.json", NULL);

  for (guint i = 0; i < 5; i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRig) rig = cloth_rig_load_data (good, strlen (good),
        &error);
    g_autoptr (ClothRig) again = NULL;
    ClothCamera *c = &rig->cameras[0];
    const ClothCamera *d;

    g_assert_no_error (error);
    memset (c->K_sd, 0, sizeof c->K_sd);
    memset (c->r_sd, 0, sizeof c->r_sd);
    c->rolling_shutter_s = i == 0 ? 0.02 : 0;
    c->offset_s = i == 0 ? 0 : -0.5;
    if (i > 0)
      (i == 1 ? c->K_sd : i == 2 ? c->k_sd : i == 3 ? c->r_sd : c->t_sd)[2] = 3;
    g_assert_true (cloth_rig_save (rig, path, &error));
    again = cloth_rig_load (path, &error);
    g_assert_no_error (error);
    d = &again->cameras[0];
    g_assert_cmpfloat (d->rolling_shutter_s, ==, c->rolling_shutter_s);
    g_assert_cmpfloat (d->offset_s, ==, c->offset_s);
    g_assert_cmpfloat (d->K_sd[2], ==, i == 1 ? 3 : 0);
    g_assert_cmpfloat (d->k_sd[2], ==, i == 2 ? 3 : 0);
    g_assert_cmpfloat (d->r_sd[2], ==, i == 3 ? 3 : 0);
    g_assert_cmpfloat (d->t_sd[2], ==, i == 4 ? 3 : 0);
  }
  g_unlink (path);
  g_rmdir (dir);
}

/* A lens without coefficients may have an empty list of them, or none. */
static void
test_no_lens (void)
{
  static const gchar *const lenses[] = { "{\"model\":\"none\"}",
    "{\"model\":\"none\",\"coefficients\":[]}"
  };

  for (guint i = 0; i < G_N_ELEMENTS (lenses); i++) {
    g_auto (GStrv) parts = g_strsplit (good,
        "{\"model\":\"fisheye\",\"coefficients\":[0.1,0.2,-3e-3,4]}", 2);
    g_autofree gchar *text = g_strjoinv (lenses[i], parts);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothRig) rig = cloth_rig_load_data (text, strlen (text),
        &error);

    g_assert_no_error (error);
    g_assert_cmpint (rig->cameras[0].lens, ==, CLOTH_LENS_NONE);
  }
}

/* A matrix typed with five digits is a rotation again once loaded. */
static void
test_mend (void)
{
  g_autofree gchar *text = NULL;
  g_auto (GStrv) parts = g_strsplit (good, "[[0,-1,0],[1,0,0],[0,0,1]]", 2);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = NULL;
  const gdouble *R;

  text = g_strjoin ("[[0.81340,-0.50232,-0.29335],[0.42737,0.85816,-0.28446],"
      "[0.39463,0.10601,0.91270]]", parts[0], parts[1], NULL);
  rig = cloth_rig_load_data (text, strlen (text), &error);
  g_assert_no_error (error);
  R = rig->cameras[0].R;
  g_assert_cmpfloat (fabs (R[0] - 0.8134), <, 1e-5);
  g_assert_cmpfloat (fabs (R[0] * R[0] + R[1] * R[1] + R[2] * R[2] - 1), <,
      1e-15);
  g_assert_cmpfloat (fabs (R[0] * R[3] + R[1] * R[4] + R[2] * R[5]), <, 1e-15);
}

/* Codes of CLOTH_FILE_ERROR, apart from those of CLOTH_RIG_ERROR. */
enum
{
  NOT_JSON = 100 + CLOTH_FILE_ERROR_INVALID,
  TOO_MUCH = 100 + CLOTH_FILE_ERROR_LIMIT
};

/* What is replaced in the good text, by what, the code, and what the message says. */
typedef struct
{
  const gchar *from, *to;
  gint code;
  const gchar *says;
} Bad;

static const Bad bads[] = {
  {"{\"version\":1,", "{", CLOTH_RIG_ERROR_VALUE, "version"},
  {"\"version\":1", "\"version\":2", CLOTH_RIG_ERROR_VALUE, "version: 2"},
  {"\"version\":1", "\"version\":\"1\"", CLOTH_RIG_ERROR_VALUE, "version"},
  {"{\"version\":1,", "{\"version\":1,\"camera\":[],", CLOTH_RIG_ERROR_VALUE,
      "camera: unknown key"},
  {"\"name\":\"left\"", "\"name\":\"\"", CLOTH_RIG_ERROR_VALUE, "name"},
  {"\"name\":\"left\"", "\"name\":\"../x\"", CLOTH_RIG_ERROR_VALUE, "slash"},
  {"\"name\":\"left\"", "\"name\":\"..\"", CLOTH_RIG_ERROR_VALUE, "\"..\""},
  {"\"name\":\"left\"", "\"name\":\"a\\nb\"", CLOTH_RIG_ERROR_VALUE,
      "name"},
  {"\"name\":\"left\"", "\"name\":7", CLOTH_RIG_ERROR_VALUE, "name"},
  {"\"name\":\"left\",", "", CLOTH_RIG_ERROR_VALUE, "name"},
  {"[640,480]", "[640]", CLOTH_RIG_ERROR_VALUE, "cameras[0].size"},
  {"[640,480]", "[640,480,3]", CLOTH_RIG_ERROR_VALUE, "cameras[0].size"},
  {"[640,480]", "[640,0]", CLOTH_RIG_ERROR_VALUE, "cameras[0].size: 0"},
  {"[640,480]", "[640,-4]", CLOTH_RIG_ERROR_VALUE, "cameras[0].size"},
  {"[640,480]", "[640,480.5]", CLOTH_RIG_ERROR_VALUE, "cameras[0].size"},
  {"[640,480]", "[20000,480]", CLOTH_RIG_ERROR_VALUE, "20000"},
  {"[640,480]", "[9999999999999,480]", CLOTH_RIG_ERROR_VALUE, "size"},
  {"500.5,0,320", "0,0,320", CLOTH_RIG_ERROR_VALUE, "cameras[0].K"},
  {"500.5,0,320", "-500,0,320", CLOTH_RIG_ERROR_VALUE, "cameras[0].K"},
  {"500.5,0,320", "1e-300,0,320", CLOTH_RIG_ERROR_VALUE, "6.4 to 6.4e+06 px"},
  {"500.5,0,320", "6.39,0,320", CLOTH_RIG_ERROR_VALUE, "6.4 to 6.4e+06 px"},
  {"500.5,0,320", "6.5e6,0,320", CLOTH_RIG_ERROR_VALUE, "6.4 to 6.4e+06 px"},
  {"[0,501,240]", "[0,1e300,240]", CLOTH_RIG_ERROR_VALUE, "cameras[0].K"},
  {"[0,501,240]", "[0,1e-300,240]", CLOTH_RIG_ERROR_VALUE, "cameras[0].K"},
  {"500.5,0,320", "1e999,0,320", CLOTH_RIG_ERROR_VALUE, "cameras[0].K[0]"},
  {"500.5,0,320", "NaN,0,320", NOT_JSON, "not JSON"},
  {"500.5,0,320", "500.5,0", CLOTH_RIG_ERROR_VALUE, "cameras[0].K[0]"},
  {"500.5,0,320", "500.5,0,null", CLOTH_RIG_ERROR_VALUE, "cameras[0].K[0]"},
  {"[0,501,240]", "[0.1,501,240]", CLOTH_RIG_ERROR_VALUE, "cameras[0].K"},
  {",[0,501,240]", "", CLOTH_RIG_ERROR_VALUE, "cameras[0].K"},
  {"\"K\":[[500.5,0,320],[0,501,240],[0,0,1]],", "", CLOTH_RIG_ERROR_VALUE,
      "cameras[0].K: is missing"},
  {"[[500.5,0,320],[0,501,240],[0,0,1]]", "7", CLOTH_RIG_ERROR_VALUE,
      "cameras[0].K: must be 3 rows"},
  {"\"R\":[[0,-1,0],[1,0,0],[0,0,1]],", "", CLOTH_RIG_ERROR_VALUE,
      "cameras[0].R: is missing"},
  {"\"distortion\":{\"model\":\"fisheye\",\"coefficients\":[0.1,0.2,-3e-3,4]},",
      "", CLOTH_RIG_ERROR_VALUE, "cameras[0].distortion: is missing"},
  {"{\"model\":\"fisheye\",\"coefficients\":[0.1,0.2,-3e-3,4]}", "\"none\"",
      CLOTH_RIG_ERROR_VALUE, "cameras[0].distortion: must be an object"},
  {"{\"model\":\"fisheye\"", "{\"model\":\"fisheye\",\"k\":1",
      CLOTH_RIG_ERROR_VALUE, "cameras[0].distortion.k: unknown key"},
  {"\"model\":\"fisheye\",", "", CLOTH_RIG_ERROR_VALUE,
      "cameras[0].distortion.model: is missing"},
  {"\"model\":\"fisheye\"", "\"model\":[]", CLOTH_RIG_ERROR_VALUE,
      "cameras[0].distortion.model: must be a string"},
  {"{\"K\":[1,2,3,4],\"rotation\":[1,2,3]}", "[]", CLOTH_RIG_ERROR_VALUE,
      "cameras[0].standard_deviations: must be an object"},
  {"0.02", "\"0.02\"", CLOTH_RIG_ERROR_VALUE, "rolling_shutter_s"},
  {"\"fisheye\"", "\"fish\"", CLOTH_RIG_ERROR_VALUE, "\"fish\""},
  {"\"fisheye\"", "\"brown5\"", CLOTH_RIG_ERROR_VALUE, "4 numbers, not 5"},
  {"\"fisheye\"", "\"none\"", CLOTH_RIG_ERROR_VALUE, "4 numbers, not 0"},
  {"\"distortion\"", "\"distorsion\"", CLOTH_RIG_ERROR_VALUE, "distorsion"},
  {"[[0,-1,0],[1,0,0],", "[[0,1,0],[1,0,0],", CLOTH_RIG_ERROR_VALUE,
      "reflection"},
  {"[[0,-1,0],", "[[0.01,-1,0],", CLOTH_RIG_ERROR_VALUE, "not a rotation"},
  {"[[0,-1,0],", "[[0,0,0],", CLOTH_RIG_ERROR_VALUE, "not a rotation"},
  {"[0.1,0.2,3]", "[0.1,0.2]", CLOTH_RIG_ERROR_VALUE, "cameras[0].t"},
  {"[0.1,0.2,3]", "{}", CLOTH_RIG_ERROR_VALUE, "cameras[0].t"},
  {"\"t\":[0.1,0.2,3],", "", CLOTH_RIG_ERROR_VALUE, "cameras[0].t: is missing"},
  {"-0.5", "true", CLOTH_RIG_ERROR_VALUE, "offset_s"},
  {"-0.5", "1e10", CLOTH_RIG_ERROR_VALUE, "offset_s of 1e+10 s"},
  {"-0.5", "-1e300", CLOTH_RIG_ERROR_VALUE, "offset_s"},
  {"0.02", "2e9", CLOTH_RIG_ERROR_VALUE, "rolling_shutter_s of 2e+09 s"},
  {"\"/dev/video0\"", "[]", CLOTH_RIG_ERROR_VALUE, "device"},
  {"[1,2,3,4]", "[1,2,3]", CLOTH_RIG_ERROR_VALUE, "standard_deviations"},
  {"[1,2,3,4]", "[1,2,-3,4]", CLOTH_RIG_ERROR_VALUE, "-3"},
  {"[1,2,3]}", "[1,2,3],\"offset_s\":-1}", CLOTH_RIG_ERROR_VALUE,
      "standard_deviations.offset_s: is negative"},
  {"[1,2,3]}", "[1,2,3],\"offset_s\":[1]}", CLOTH_RIG_ERROR_VALUE,
      "standard_deviations.offset_s"},
  {"[1,2,3]}", "[1,2,3],\"R\":3}", CLOTH_RIG_ERROR_VALUE, "unknown key"},
  {"}]}", "}", NOT_JSON, "not JSON"},
  {"{\"version\"", "/* */{\"version\"", NOT_JSON, "0x2f"},
  {"{\"version\"", "{/* */\"version\"", NOT_JSON, "0x2f"},
  {"{\"version\"", "{}{\"version\"", NOT_JSON, "offset 2"},
  {"}]}", "}]},{}", NOT_JSON, "nothing else"},
  {"}]}", "}]} x", NOT_JSON, "nothing else"},
  {"}]}", "}}]}", NOT_JSON, "not JSON"},
  {"{\"version\":1", "{\"version\":2,\"version\":1",
      NOT_JSON, "twice"},
  {"\"name\":\"left\"", "\"name\":\"a\",\"name\":\"left\"",
      NOT_JSON, "twice"},
  {"{\"version\"", "\xff{\"version\"", NOT_JSON, "not JSON"},
  {"\"left\"", "\"\xc3\x28\"", NOT_JSON, "UTF-8"},
};

static void
assert_refused (const gchar * text, gssize length, gint code,
    const gchar * says)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_load_data (text,
      length < 0 ? strlen (text) : (gsize) length, &error);

  g_assert_null (rig);
  g_test_message ("%s", error->message);
  if (code < NOT_JSON)
    g_assert_error (error, CLOTH_RIG_ERROR, code);
  else
    g_assert_error (error, CLOTH_FILE_ERROR, code - NOT_JSON);
  g_assert_nonnull (strstr (error->message, says));
}

static void
test_bad (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (bads); i++) {
    g_auto (GStrv) parts = g_strsplit (good, bads[i].from, 2);
    g_autofree gchar *text = g_strjoinv (bads[i].to, parts);

    g_assert_cmpuint (g_strv_length (parts), ==, 2);
    assert_refused (text, -1, bads[i].code, bads[i].says);
  }
  assert_refused ("", -1, NOT_JSON, "one object");
  assert_refused ("[]", -1, NOT_JSON, "one object");
  assert_refused ("{\"version\":1,\"cameras\":[]}", -1, CLOTH_RIG_ERROR_VALUE,
      "0 of them");
  assert_refused ("{\"version\":1}", -1, CLOTH_RIG_ERROR_VALUE,
      "cameras: must be a list");
  assert_refused ("{\"version\":1,\"cameras\":{}}", -1, CLOTH_RIG_ERROR_VALUE,
      "cameras: must be a list");
  assert_refused ("{\"version\":1,\"cameras\":[[]]}", -1,
      CLOTH_RIG_ERROR_VALUE, "cameras[0]");
  assert_refused ("{\"a\0\"}", 6, NOT_JSON, "not JSON");
}

static void
test_limits (void)
{
  g_autoptr (GString) many = g_string_new ("{\"version\":1,\"cameras\":[");
  g_autofree gchar *deep = g_strnfill (1000000, '[');
  g_autofree gchar *objects = g_strconcat ("{\"a\":", deep, NULL);
  g_autoptr (GString) twice = g_string_new ("");
  g_autoptr (GError) error = NULL;
  g_autofree gchar *dir = g_dir_make_tmp ("rigXXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (dir, "big.json", NULL);
  g_autofree gchar *pipe = g_build_filename (dir, "pipe", NULL);
  const gchar *camera = strchr (good, '[') + 1;
  gsize camera_length = strlen (camera) - 2;
  g_autofree gchar *commas = g_strnfill (300000, ',');
  g_autofree gchar *list = g_strconcat ("{\"cameras\":[0", commas, "0]}", NULL);

  assert_refused (objects, -1, TOO_MUCH, "nested");
  assert_refused (list, -1, TOO_MUCH, "200000 values");
  for (guint i = 0; i < 65; i++)
    g_string_append (many, i ? ",{}" : "{}");
  g_string_append (many, "]}");
  assert_refused (many->str, -1, CLOTH_RIG_ERROR_VALUE, "65 of them");

  g_string_append_len (twice, good, strlen (good) - 2);
  g_string_append_c (twice, ',');
  g_string_append_len (twice, camera, camera_length);
  g_string_append (twice, "]}");
  assert_refused (twice->str, -1, CLOTH_RIG_ERROR_VALUE,
      "cameras[1].name: \"left\" is also the name of cameras[0]");

  g_assert_null (cloth_rig_load (path, &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  g_clear_error (&error);
  g_assert_null (cloth_rig_load (dir, &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_INVAL);
  g_clear_error (&error);
  g_assert_cmpint (mkfifo (pipe, 0600), ==, 0);
  g_assert_null (cloth_rig_load (pipe, &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_INVAL);
  g_clear_error (&error);
  g_assert_true (g_file_set_contents (path, good, 40, NULL));
  g_assert_null (cloth_rig_load (path, &error));
  g_assert_true (g_str_has_prefix (error->message, path));
  g_clear_error (&error);
  g_assert_cmpint (truncate (path, 16 * 1024 * 1024 + 1), ==, 0);
  g_assert_null (cloth_rig_load (path, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
  g_unlink (path);
  g_unlink (pipe);
  g_rmdir (dir);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/rigfile/load", test_load);
  g_test_add_func ("/rigfile/rendered", test_rendered);
  g_test_add_func ("/rigfile/save", test_save);
  g_test_add_func ("/rigfile/example", test_example);
  g_test_add_func ("/rigfile/save-some", test_save_some);
  g_test_add_func ("/rigfile/no-lens", test_no_lens);
  g_test_add_func ("/rigfile/mend", test_mend);
  g_test_add_func ("/rigfile/bad", test_bad);
  g_test_add_func ("/rigfile/limits", test_limits);
  return g_test_run ();
}
