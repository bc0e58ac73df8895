/* pattern.json: what is read, what is written, what is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/pattern.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static void
test_real_file (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_load (TEST_DATA "/checker_pair/pattern.json", &error);

  g_assert_no_error (error);
  g_assert_cmpint (pattern->columns, ==, 8);
  g_assert_cmpint (pattern->rows, ==, 8);
  g_assert_cmpfloat (pattern->square_m, ==, 0.05);
  g_assert_cmpfloat (pattern->origin_uv_m[0], ==, 0.115);
  g_assert_cmpfloat (pattern->origin_uv_m[1], ==, 0.135);
  g_assert_cmpfloat (pattern->cloth_m[0], ==, 0.63);
  g_assert_cmpfloat (pattern->cloth_m[1], ==, 0.67);
  g_assert_true (pattern->first_black);
  g_assert_null (pattern->code);
  g_assert_true (cloth_pattern_is_black (pattern, 0, 0));
  g_assert_false (cloth_pattern_is_black (pattern, 1, 0));
  g_assert_true (cloth_pattern_is_black (pattern, 1, 1));
}

static void
test_new (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (7, 5, 0.03, 0.02, FALSE, &error);

  g_assert_no_error (error);
  g_assert_cmpfloat_with_epsilon (pattern->cloth_m[0], 0.25, 1e-12);
  g_assert_cmpfloat_with_epsilon (pattern->cloth_m[1], 0.19, 1e-12);
  g_assert_cmpfloat (pattern->origin_uv_m[1], ==, 0.02);
  g_assert_false (cloth_pattern_is_black (pattern, 0, 0));
}

static void
test_new_refused (void)
{
  const struct
  {
    gint columns, rows;
    gdouble square_m, margin_m;
  } cases[] = {
    {0, 8, 0.05, 0}, {8, -1, 0.05, 0}, {501, 8, 0.05, 0}, {8, 501, 0.05, 0},
    {8, 8, 0, 0}, {8, 8, -0.05, 0}, {8, 8, NAN, 0}, {8, 8, INFINITY, 0},
    {8, 8, 0.05, -0.01}, {8, 8, 0.05, NAN}, {8, 8, 0.05, INFINITY},
    {500, 500, 10, 0}, {G_MAXINT, G_MININT, 1e-300, 0},
    {8, 8, 1e-300, 0.1}, {8, 8, 0.99e-6, 0}, {8, 8, G_MINDOUBLE, 0},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_pattern_new_checker (cases[i].columns, cases[i].rows,
            cases[i].square_m, cases[i].margin_m, TRUE, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  }
}

/* The finest print and the largest tarpaulin. */
static void
test_new_extremes (void)
{
  const gdouble squares[] = { 1e-6, 1e-5, 1, 1000. / 8 };

  for (gsize i = 0; i < G_N_ELEMENTS (squares); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothPattern) pattern =
        cloth_pattern_new_checker (8, 8, squares[i], 0, TRUE, &error);

    g_assert_no_error (error);
    g_assert_nonnull (pattern);
  }
}

static void
test_round_trip (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (9, 6, 1.0 / 3, 0.1, FALSE, &error);
  g_autoptr (ClothPattern) read = NULL;
  g_autofree gchar *dir = g_dir_make_tmp ("pattern-XXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (dir, "pattern.json", NULL);
  g_autofree gchar *text = NULL, *again = NULL;

  pattern->code = g_malloc0 (54);
  for (gint i = 0; i < 54; i++)
    pattern->code[i] = (guint8) (i * 7 % 5 < 2);
  pattern->dot_ratio = 0.3;
  g_assert_true (cloth_pattern_save (pattern, path, &error));
  read = cloth_pattern_load (path, &error);
  g_assert_no_error (error);
  g_assert_cmpfloat (read->square_m, ==, 1.0 / 3);
  g_assert_cmpfloat (read->cloth_m[0], ==, pattern->cloth_m[0]);
  g_assert_false (read->first_black);
  g_assert_cmpmem (read->code, 54, pattern->code, 54);
  g_assert_cmpfloat (read->dot_ratio, ==, 0.3);
  text = cloth_pattern_to_json (pattern);
  again = cloth_pattern_to_json (read);
  g_assert_cmpstr (text, ==, again);
  g_assert_nonnull (strstr (text, "\"dot_ratio\": 0.3,"));
  g_unlink (path);
  g_rmdir (dir);
}

static void
test_defaults (void)
{
  static const gchar text[] =
      "{\"pattern\":\"checker\",\"columns\":4,\"rows\":3,\"square_m\":1,"
      "\"origin_uv_m\":[0.5,2]}";
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_load_data (text, strlen (text), &error);

  g_assert_no_error (error);
  g_assert_true (pattern->first_black);
  g_assert_cmpfloat (pattern->cloth_m[0], ==, 4.5);
  g_assert_cmpfloat (pattern->cloth_m[1], ==, 5);
}

#define HEAD "{\"version\":1,\"pattern\":\"checker\","
#define SIZE "\"columns\":2,\"rows\":2,\"square_m\":0.1"

static void
test_refused (void)
{
  const struct
  {
    const gchar *text;
    gint code;
    const gchar *says;
  } cases[] = {
    {"", CLOTH_PATTERN_ERROR_FORMAT, "pattern.json"},
    {"  ", CLOTH_PATTERN_ERROR_FORMAT, "pattern.json"},
    {"[]", CLOTH_PATTERN_ERROR_FORMAT, "one object"},
    {"{}{}", CLOTH_PATTERN_ERROR_FORMAT, "one object"},
    {"{\"a\":\"}\\\"}", CLOTH_PATTERN_ERROR_FORMAT, "one object"},
    {"{", CLOTH_PATTERN_ERROR_FORMAT, "pattern.json"},
    {"\xff\xfe{}", CLOTH_PATTERN_ERROR_FORMAT, "UTF-8"},
    {"{\"a\":[[[[[[[[[[[[[[[[[[[[[[", CLOTH_PATTERN_ERROR_FORMAT, "16 levels"},
    {"{}", CLOTH_PATTERN_ERROR_FORMAT, "\"pattern\""},
    {HEAD SIZE ",\"rows\":2}", CLOTH_PATTERN_ERROR_FORMAT, "twice"},
    {"{\"pattern\":7}", CLOTH_PATTERN_ERROR_FORMAT, "\"pattern\""},
    {"{\"pattern\":\"m-array\"}", CLOTH_PATTERN_ERROR_UNSUPPORTED, "m-array"},
    {"{\"version\":2,\"pattern\":\"checker\"}",
        CLOTH_PATTERN_ERROR_UNSUPPORTED, "version 2"},
    {"{\"version\":\"1\",\"pattern\":\"checker\"}",
        CLOTH_PATTERN_ERROR_FORMAT, "\"version\""},
    {HEAD "\"rows\":2,\"square_m\":1}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"columns\""},
    {HEAD "\"columns\":2.5,\"rows\":2,\"square_m\":1}",
        CLOTH_PATTERN_ERROR_FORMAT, "\"columns\""},
    {HEAD "\"columns\":99999999999,\"rows\":2,\"square_m\":1e-9}",
        CLOTH_PATTERN_ERROR_VALUE, "1 to 500"},
    {HEAD "\"columns\":2,\"rows\":2}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"square_m\""},
    {HEAD "\"columns\":2,\"rows\":2,\"square_m\":1e999}",
        CLOTH_PATTERN_ERROR_FORMAT, "\"square_m\""},
    {HEAD "\"columns\":2,\"rows\":2,\"square_m\":1e-300}",
        CLOTH_PATTERN_ERROR_VALUE, "from 1e-06 to 1000"},
    {HEAD "\"columns\":2,\"rows\":2,\"square_m\":\"5\"}",
        CLOTH_PATTERN_ERROR_FORMAT, "\"square_m\""},
    {HEAD SIZE ",\"first_square\":\"red\"}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"first_square\""},
    {HEAD SIZE ",\"first_sqare\":\"black\"}", CLOTH_PATTERN_ERROR_FORMAT,
        "first_sqare"},
    {HEAD SIZE ",\"origin_uv_m\":[1]}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"origin_uv_m\""},
    {HEAD SIZE ",\"origin_uv_m\":[0,\"1\"]}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"origin_uv_m\""},
    {HEAD SIZE ",\"origin_uv_m\":[0,-1]}", CLOTH_PATTERN_ERROR_VALUE,
        "origin_uv_m"},
    {HEAD SIZE ",\"cloth_m\":[0.19,1]}", CLOTH_PATTERN_ERROR_VALUE, "width"},
    {HEAD SIZE ",\"cloth_m\":{}}", CLOTH_PATTERN_ERROR_FORMAT, "\"cloth_m\""},
    {HEAD SIZE ",\"code\":[\"01\"],\"dot_ratio\":0.3}",
        CLOTH_PATTERN_ERROR_FORMAT, "each row"},
    {HEAD SIZE ",\"code\":[\"01\",\"0\"],\"dot_ratio\":0.3}",
        CLOTH_PATTERN_ERROR_FORMAT, "each column"},
    {HEAD SIZE ",\"code\":[\"01\",\"012\"],\"dot_ratio\":0.3}",
        CLOTH_PATTERN_ERROR_FORMAT, "each column"},
    {HEAD SIZE ",\"code\":[\"01\",17],\"dot_ratio\":0.3}",
        CLOTH_PATTERN_ERROR_FORMAT, "each column"},
    {HEAD SIZE ",\"code\":[\"01\",\"10\"]}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"dot_ratio\""},
    {HEAD SIZE ",\"code\":[\"01\",\"10\"],\"dot_ratio\":1}",
        CLOTH_PATTERN_ERROR_VALUE, "dot_ratio"},
    {HEAD SIZE ",\"dot_ratio\":0.3}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"dot_ratio\""},
    {HEAD SIZE ",\"code\":[\"01\",\"10\"],\"dot_ratio\":0}",
        CLOTH_PATTERN_ERROR_VALUE, "dot_ratio is 0"},
    {HEAD SIZE ",\"code\":7}", CLOTH_PATTERN_ERROR_FORMAT, "each row"},
    {HEAD SIZE ",\"code\":[\"01\",[\"10\"]]}", CLOTH_PATTERN_ERROR_FORMAT,
        "each column"},
    {HEAD SIZE ",\"code\":[\"01\",true]}", CLOTH_PATTERN_ERROR_FORMAT,
        "each column"},
    {HEAD SIZE ",\"cloth_m\":[0,1]}", CLOTH_PATTERN_ERROR_VALUE,
        "cloth_m has 0"},
    {HEAD SIZE ",\"cloth_m\":[1,1001]}", CLOTH_PATTERN_ERROR_VALUE,
        "at most 1000"},
    {HEAD SIZE ",\"cloth_m\":[1,0.19]}", CLOTH_PATTERN_ERROR_VALUE,
        "the board's height goes from 0 m to 0.2 m"},
    {HEAD SIZE ",\"cloth_m\":[\"1\",1]}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"cloth_m\""},
    {HEAD "\"columns\":-7,\"rows\":2,\"square_m\":1}",
        CLOTH_PATTERN_ERROR_VALUE, "1 to 500"},
    {HEAD "\"columns\":[2],\"rows\":2,\"square_m\":1}",
        CLOTH_PATTERN_ERROR_FORMAT, "\"columns\""},
    {HEAD "\"columns\":2,\"rows\":\"2\",\"square_m\":1}",
        CLOTH_PATTERN_ERROR_FORMAT, "\"rows\""},
    {HEAD "\"columns\":2,\"rows\":2,\"square_m\":[1]}",
        CLOTH_PATTERN_ERROR_FORMAT, "\"square_m\""},
    {"{\"pattern\":[\"checker\"]}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"pattern\""},
    {HEAD SIZE ",\"first_square\":null}", CLOTH_PATTERN_ERROR_FORMAT,
        "\"first_square\""},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autofree gchar *shown = g_strescape (cases[i].text, "\"");

    g_assert_null (cloth_pattern_load_data (cases[i].text,
            strlen (cases[i].text), &error));
    g_test_message ("%s: %s", shown, error ? error->message : "no error");
    g_assert_error (error, CLOTH_PATTERN_ERROR, cases[i].code);
    g_assert_nonnull (strstr (error->message, cases[i].says));
  }
}

static void
test_bad_file (void)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *dir = g_dir_make_tmp ("pattern-XXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (dir, "pattern.json", NULL);

  g_assert_true (g_file_set_contents (path, "{", 1, NULL));
  g_assert_null (cloth_pattern_load (path, &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_FORMAT);
  g_assert_true (g_str_has_prefix (error->message, path));
  g_unlink (path);
  g_rmdir (dir);
}

static void
test_missing_file (void)
{
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_pattern_load ("/nowhere/pattern.json", &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  g_clear_error (&error);
  /* which has no end */
  g_assert_null (cloth_pattern_load ("/dev/zero", &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_INVAL);
}

static void
test_save_refused (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (4, 4, 0.05, 0, TRUE, NULL);

  g_assert_false (cloth_pattern_save (pattern, "/nowhere/pattern.json",
          &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_clear_error (&error);
  pattern->square_m = NAN;
  g_assert_false (cloth_pattern_save (pattern, "/nowhere/pattern.json",
          &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  g_clear_error (&error);
  pattern->square_m = 0.05;
  pattern->dot_ratio = 0.3;
  pattern->code = g_malloc0 (16);
  pattern->code[15] = 2;
  g_assert_false (cloth_pattern_save (pattern, "/nowhere/pattern.json",
          &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  g_assert_nonnull (strstr (error->message, "a value of 2"));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/pattern/real-file", test_real_file);
  g_test_add_func ("/pattern/new", test_new);
  g_test_add_func ("/pattern/new-refused", test_new_refused);
  g_test_add_func ("/pattern/new-extremes", test_new_extremes);
  g_test_add_func ("/pattern/round-trip", test_round_trip);
  g_test_add_func ("/pattern/defaults", test_defaults);
  g_test_add_func ("/pattern/refused", test_refused);
  g_test_add_func ("/pattern/bad-file", test_bad_file);
  g_test_add_func ("/pattern/missing-file", test_missing_file);
  g_test_add_func ("/pattern/save-refused", test_save_refused);
  return g_test_run ();
}
