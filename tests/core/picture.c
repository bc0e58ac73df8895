/* pattern.json of any print: what is read, written, refused; of which kind a file is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/any.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static const gdouble tablecloth[2] = { 1.2, 0.9 };

/* A folder with a file that stands for a picture: only its name matters here. */
typedef struct
{
  gchar *dir, *reference, *path;
} Folder;

static Folder
folder_new (void)
{
  Folder folder;

  folder.dir = g_dir_make_tmp ("picture-XXXXXX", NULL);
  folder.reference = g_build_filename (folder.dir, "scan.png", NULL);
  folder.path = g_build_filename (folder.dir, "pattern.json", NULL);
  g_assert_true (g_file_set_contents (folder.reference, "", 0, NULL));
  return folder;
}

static void
folder_clear (Folder * folder)
{
  g_unlink (folder->path);
  g_unlink (folder->reference);
  g_assert_cmpint (g_rmdir (folder->dir), ==, 0);
  g_free (folder->dir);
  g_free (folder->reference);
  g_free (folder->path);
}

/* The lineart cloth of the rendered films has 35 by 33 vertices on 0.63 m by 0.67 m; nobody
 * asked, it has 0.63 / 0.02 = 31.5 → 32 cells and 0.67 / 0.02 = 33.5 → 34. */
static void
test_new (void)
{
  const struct
  {
    gdouble cloth_m[2];
    gint columns, rows, made_columns, made_rows;
  } cases[] = {
    {{0.63, 0.67}, 35, 33, 35, 33}, {{0.63, 0.67}, 0, 0, 33, 35},
    {{0.2, 0.3}, 0, 0, 11, 16}, {{0.02, 0.021}, 0, 2, 2, 2},
    {{0.001, 9.98}, 0, 0, 2, 500}, {{1000, 1e-6}, 0, 0, 500, 2},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothPicturePattern) pattern =
        cloth_picture_pattern_new ("a.png", cases[i].cloth_m,
        cases[i].columns, cases[i].rows, 1, &error);

    g_assert_no_error (error);
    g_assert_cmpint (pattern->columns, ==, cases[i].made_columns);
    g_assert_cmpint (pattern->rows, ==, cases[i].made_rows);
  }
}

/* 1.2 m in 24 cells, 0.9 m in 30. */
static void
test_edges (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPicturePattern) pattern =
      cloth_picture_pattern_new ("a.png", tablecloth, 25, 31, 2, &error);
  gdouble edge_m[2];

  g_assert_no_error (error);
  cloth_picture_pattern_get_edges (pattern, edge_m);
  g_assert_cmpfloat_with_epsilon (edge_m[0], 0.05, 1e-15);
  g_assert_cmpfloat_with_epsilon (edge_m[1], 0.03, 1e-15);
}

static void
test_new_refused (void)
{
  const struct
  {
    const gchar *reference;
    gdouble cloth_m[2];
    gint columns, rows, sides;
    const gchar *says;
  } cases[] = {
    {NULL, {1, 1}, 9, 9, 1, "no reference"},
    {"", {1, 1}, 9, 9, 1, "no reference"},
    {"a.png", {0, 1}, 9, 9, 1, "cloth_m has 0"},
    {"a.png", {1, -2}, 9, 9, 1, "cloth_m has -2"},
    {"a.png", {NAN, 1}, 0, 0, 1, "cloth_m has nan"},
    {"a.png", {1, NAN}, 9, 9, 1, "cloth_m has nan"},
    {"a.png", {INFINITY, 1}, 0, 0, 1, "cloth_m has inf"},
    {"a.png", {1, 1e4}, 0, 0, 1, "cloth_m has 10000"},
    {"a.png", {9e-7, 1}, 0, 0, 1, "cloth_m has 9e-07"},
    {"a.png", {1, 1}, 1, 9, 1, "1 by 9 vertices"},
    {"a.png", {1, 1}, 9, 1, 1, "9 by 1 vertices"},
    {"a.png", {1, 1}, 501, 9, 1, "2 to 500"},
    {"a.png", {1, 1}, 9, 501, 1, "2 to 500"},
    {"a.png", {1, 1}, 257, 256, 1, "65536 in all"},
    {"a.png", {1, 1}, G_MININT, 9, 1, "vertices"},
    {"a.png", {1, 1}, 9, G_MAXINT, 1, "vertices"},
    {"a.png", {1, 1}, 9, 9, 0, "0 sides"},
    {"a.png", {1, 1}, 9, 9, 3, "3 sides"},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_picture_pattern_new (cases[i].reference,
            cases[i].cloth_m, cases[i].columns, cases[i].rows, cases[i].sides,
            &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
    g_test_message ("→ %s", error->message);
    g_assert_nonnull (strstr (error->message, cases[i].says));
    g_assert_null (cloth_picture_pattern_new (cases[i].reference,
            cases[i].cloth_m, cases[i].columns, cases[i].rows, cases[i].sides,
            NULL));
  }
}

/* Written with the picture's name from the file's folder; read, it can be opened from
 * here. */
static void
test_round_trip (void)
{
  Folder folder = folder_new ();
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPicturePattern) pattern =
      cloth_picture_pattern_new (folder.reference, tablecloth, 0, 7, 2, &error);
  g_autoptr (ClothPicturePattern) read = NULL;
  g_autofree gchar *text = NULL;

  g_assert_no_error (error);
  pattern->cloth_m[1] = 1. / 3;
  g_assert_true (cloth_picture_pattern_save (pattern, folder.path, &error));
  g_assert_no_error (error);
  g_assert_true (g_file_get_contents (folder.path, &text, NULL, NULL));
  g_assert_nonnull (strstr (text, "\"reference\": \"scan.png\""));
  read = cloth_picture_pattern_load (folder.path, &error);
  g_assert_no_error (error);
  g_assert_cmpstr (read->reference, ==, folder.reference);
  g_assert_cmpfloat (read->cloth_m[0], ==, 1.2);
  g_assert_cmpfloat (read->cloth_m[1], ==, 1. / 3);
  g_assert_cmpint (read->columns, ==, 61);
  g_assert_cmpint (read->rows, ==, 7);
  g_assert_cmpint (read->sides, ==, 2);
  folder_clear (&folder);
}

#define HEAD "{\"version\":1,\"pattern\":\"picture\","
#define SCAN "\"reference\":\"scan.png\","
#define SIZE "\"cloth_m\":[1,2],"
#define GRID "\"columns\":3,\"rows\":4"

static void
test_defaults (void)
{
  static const gchar text[] = "{\"pattern\":\"picture\"," SCAN SIZE GRID "}";
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPicturePattern) pattern =
      cloth_picture_pattern_load_data (text, strlen (text), &error);

  g_assert_no_error (error);
  g_assert_cmpint (pattern->sides, ==, 1);
  g_assert_cmpstr (pattern->reference, ==, "scan.png");
}

static void
test_read_refused (void)
{
  const struct
  {
    const gchar *text;
    gint code;
    const gchar *says;
  } cases[] = {
    {"", CLOTH_PATTERN_ERROR_FORMAT, "no pattern.json"},
    {"[]", CLOTH_PATTERN_ERROR_FORMAT, "no pattern.json"},
    {"{}", CLOTH_PATTERN_ERROR_UNSUPPORTED, "\"picture\""},
    {"{\"pattern\":\"checker\"}", CLOTH_PATTERN_ERROR_UNSUPPORTED,
        "kind \"checker\""},
    {"{\"pattern\":7}", CLOTH_PATTERN_ERROR_FORMAT, "“pattern” must be"},
    {"{\"version\":2,\"pattern\":\"picture\"}",
        CLOTH_PATTERN_ERROR_UNSUPPORTED, "version 2"},
    {"{\"version\":\"1\",\"pattern\":\"picture\"}",
        CLOTH_PATTERN_ERROR_FORMAT, "version"},
    {HEAD SIZE SCAN GRID ",\"scale\":2}", CLOTH_PATTERN_ERROR_FORMAT,
        "unknown key “scale”"},
    {HEAD SIZE SCAN GRID ",\"rows\":4}", CLOTH_PATTERN_ERROR_FORMAT, "twice"},
    {HEAD SCAN GRID "}", CLOTH_PATTERN_ERROR_FORMAT, "without a size"},
    {HEAD SCAN GRID ",\"cloth_m\":null}", CLOTH_PATTERN_ERROR_FORMAT,
        "without a size"},
    {HEAD SCAN GRID ",\"cloth_m\":1}", CLOTH_PATTERN_ERROR_FORMAT, "cloth_m"},
    {HEAD SCAN GRID ",\"cloth_m\":[1]}", CLOTH_PATTERN_ERROR_FORMAT,
        "two numbers"},
    {HEAD SCAN GRID ",\"cloth_m\":[1,2,3]}", CLOTH_PATTERN_ERROR_FORMAT,
        "cloth_m"},
    {HEAD SCAN GRID ",\"cloth_m\":[\"1\",2]}", CLOTH_PATTERN_ERROR_FORMAT,
        "two numbers"},
    {HEAD SCAN GRID ",\"cloth_m\":[1,null]}", CLOTH_PATTERN_ERROR_FORMAT,
        "two numbers"},
    {HEAD SCAN GRID ",\"cloth_m\":[630,-1]}", CLOTH_PATTERN_ERROR_VALUE,
        "metres"},
    {HEAD SCAN GRID ",\"cloth_m\":[1,6300]}", CLOTH_PATTERN_ERROR_VALUE,
        "metres"},
    {HEAD SIZE GRID "}", CLOTH_PATTERN_ERROR_FORMAT, "no “reference”"},
    {HEAD SIZE GRID ",\"reference\":\"\"}", CLOTH_PATTERN_ERROR_FORMAT,
        "no “reference”"},
    {HEAD SIZE GRID ",\"reference\":3}", CLOTH_PATTERN_ERROR_FORMAT,
        "reference"},
    {HEAD SIZE SCAN "\"columns\":3}", CLOTH_PATTERN_ERROR_FORMAT, "rows"},
    {HEAD SIZE SCAN "\"rows\":3}", CLOTH_PATTERN_ERROR_FORMAT, "columns"},
    {HEAD SIZE SCAN "\"columns\":3,\"rows\":1}", CLOTH_PATTERN_ERROR_FORMAT,
        "2 to 500"},
    {HEAD SIZE SCAN "\"columns\":501,\"rows\":3}", CLOTH_PATTERN_ERROR_FORMAT,
        "2 to 500"},
    {HEAD SIZE SCAN "\"columns\":3.5,\"rows\":3}", CLOTH_PATTERN_ERROR_FORMAT,
        "columns"},
    {HEAD SIZE SCAN GRID ",\"sides\":0}", CLOTH_PATTERN_ERROR_FORMAT, "sides"},
    {HEAD SIZE SCAN GRID ",\"sides\":3}", CLOTH_PATTERN_ERROR_FORMAT, "1 to 2"},
    {HEAD SIZE SCAN GRID ",\"sides\":true}", CLOTH_PATTERN_ERROR_FORMAT,
        "sides"},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;

    g_test_message ("%s", cases[i].text);
    g_assert_null (cloth_picture_pattern_load_data (cases[i].text,
            strlen (cases[i].text), &error));
    g_test_message ("→ %s", error->message);
    g_assert_error (error, CLOTH_PATTERN_ERROR, cases[i].code);
    g_assert_nonnull (strstr (error->message, cases[i].says));
  }
}

/* A picture that isn't there, and names that lead elsewhere. */
static void
test_load_refused (void)
{
  static const gchar *const names[] = { "other.png", "../scan.png",
    "/etc/passwd", "folder/scan.png", "."
  };
  Folder folder = folder_new ();
  g_autoptr (GError) error = NULL;

  for (gsize i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *text = g_strdup_printf (HEAD SIZE GRID
        ",\"reference\":\"%s\"}", names[i]);
    g_autoptr (GError) fault = NULL;

    g_assert_true (g_file_set_contents (folder.path, text, -1, NULL));
    g_assert_null (cloth_picture_pattern_load (folder.path, &fault));
    g_test_message ("→ %s", fault->message);
    g_assert_true (g_str_has_prefix (fault->message, folder.path));
    g_assert_nonnull (strstr (fault->message, names[i]));
  }
  g_assert_null (cloth_picture_pattern_load ("/nowhere/pattern.json", &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  g_clear_error (&error);
  g_assert_null (cloth_picture_pattern_load (TEST_DATA
          "/checker_pair/pattern.json", &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_UNSUPPORTED);
  g_assert_true (g_str_has_prefix (error->message, TEST_DATA));
  folder_clear (&folder);
}

/* Nothing is written that could not be read. */
static void
test_save_refused (void)
{
  Folder folder = folder_new ();
  const struct
  {
    const gchar *reference;
    gint sides;
    const gchar *path;
  } cases[] = {
    {TEST_DATA "/checker_pair/pattern.json", 1, folder.path},
    {"nowhere.png", 1, folder.path},
    {folder.dir, 1, folder.path},
    {folder.reference, 7, folder.path},
    {folder.reference, 1, "/nowhere/pattern.json"},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothPicturePattern) pattern =
        cloth_picture_pattern_new (cases[i].reference, tablecloth, 0, 0, 1,
        &error);

    g_assert_no_error (error);
    pattern->sides = cases[i].sides;
    g_assert_false (cloth_picture_pattern_save (pattern, cases[i].path,
            &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
    g_test_message ("→ %s", error->message);
    g_assert_false (g_file_test (cases[i].path, G_FILE_TEST_EXISTS));
  }
  folder_clear (&folder);
}

/* Files of each kind are recognised; those of none are told what there is. */
static void
test_any (void)
{
  const ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;
  Folder folder = folder_new ();
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMArray) array =
      cloth_m_array_new (5, 4, 5, 0.02, 0.013, 0.01, &code, &error);
  g_autoptr (ClothPicturePattern) picture =
      cloth_picture_pattern_new (folder.reference, tablecloth, 0, 0, 1, &error);
  g_autoptr (ClothAnyPattern) any =
      cloth_any_pattern_load (TEST_DATA "/checker_pair/pattern.json", &error);

  g_assert_no_error (error);
  g_assert_true (any->checker && !any->dots && !any->picture);
  cloth_any_pattern_free (any);
  g_assert_true (cloth_m_array_save (array, folder.path, &error));
  any = cloth_any_pattern_load (folder.path, &error);
  g_assert_no_error (error);
  g_assert_true (any->dots && !any->checker && !any->picture);
  cloth_any_pattern_free (any);
  g_assert_true (cloth_picture_pattern_save (picture, folder.path, &error));
  any = cloth_any_pattern_load (folder.path, &error);
  g_assert_no_error (error);
  g_assert_true (any->picture && !any->dots && !any->checker);
  cloth_any_pattern_free (NULL);
  folder_clear (&folder);
}

static void
test_any_refused (void)
{
  const struct
  {
    const gchar *text;
    gint code;
    const gchar *says;
  } cases[] = {
    {"", CLOTH_PATTERN_ERROR_FORMAT, "no pattern.json"},
    {"{}", CLOTH_PATTERN_ERROR_FORMAT, "\"checker\", \"m-array\" or"},
    {"{\"pattern\":null}", CLOTH_PATTERN_ERROR_FORMAT, "\"picture\""},
    {"{\"pattern\":[]}", CLOTH_PATTERN_ERROR_FORMAT, "“pattern” must be"},
    {"{\"pattern\":\"stripes\"}", CLOTH_PATTERN_ERROR_UNSUPPORTED,
        "kind \"stripes\""},
    {"{\"pattern\":\"\"}", CLOTH_PATTERN_ERROR_UNSUPPORTED, "kind \"\""},
    {"{\"pattern\":\"checker\"}", CLOTH_PATTERN_ERROR_FORMAT, "columns"},
    {"{\"pattern\":\"m-array\"}", CLOTH_PATTERN_ERROR_FORMAT, "colours"},
    {"{\"pattern\":\"picture\"}", CLOTH_PATTERN_ERROR_FORMAT, "reference"},
  };
  Folder folder = folder_new ();
  g_autoptr (GError) error = NULL;

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) fault = NULL;

    g_assert_true (g_file_set_contents (folder.path, cases[i].text, -1, NULL));
    g_assert_null (cloth_any_pattern_load (folder.path, &fault));
    g_test_message ("→ %s", fault->message);
    g_assert_error (fault, CLOTH_PATTERN_ERROR, cases[i].code);
    g_assert_true (g_str_has_prefix (fault->message, folder.path));
    g_assert_nonnull (strstr (fault->message, cases[i].says));
  }
  g_assert_null (cloth_any_pattern_load ("/nowhere/pattern.json", &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  folder_clear (&folder);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/picture/new", test_new);
  g_test_add_func ("/picture/edges", test_edges);
  g_test_add_func ("/picture/new-refused", test_new_refused);
  g_test_add_func ("/picture/round-trip", test_round_trip);
  g_test_add_func ("/picture/defaults", test_defaults);
  g_test_add_func ("/picture/read-refused", test_read_refused);
  g_test_add_func ("/picture/load-refused", test_load_refused);
  g_test_add_func ("/picture/save-refused", test_save_refused);
  g_test_add_func ("/picture/any", test_any);
  g_test_add_func ("/picture/any-refused", test_any_refused);
  return g_test_run ();
}
