/* M-arrays: what is made, read, written and refused. That windows are unique is checked
 * by marrayunique.py.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/texture.h"

#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

static ClothMArray *
made (gint columns, gint rows, guint64 seed)
{
  const ClothMArrayCode code = { 1, FALSE, seed };
  g_autoptr (GError) error = NULL;
  ClothMArray *array = cloth_m_array_new (columns, rows, 5, 0.02, 0.013, 0.01,
      &code, &error);

  g_assert_no_error (error);
  return array;
}

static void
test_new (void)
{
  g_autoptr (ClothMArray) array = made (9, 7, 1);
  gboolean seen[5] = { FALSE };

  g_assert_cmpfloat_with_epsilon (array->cloth_m[0], 0.18, 1e-12);
  g_assert_cmpfloat_with_epsilon (array->cloth_m[1], 0.14, 1e-12);
  g_assert_cmpfloat (array->origin_uv_m[1], ==, 0.01);
  g_assert_cmpstr (array->colours[0].name, ==, "cyan");
  g_assert_cmpstr (array->colours[4].name, ==, "green");
  for (gint i = 0; i < 63; i++)
    seen[array->matrix[i]] = TRUE;
  for (gint i = 0; i < 5; i++)
    g_assert_true (seen[i]);
}

static void
test_deterministic (void)
{
  g_autoptr (ClothMArray) a = made (30, 20, 7);
  g_autoptr (ClothMArray) b = made (30, 20, 7);
  g_autoptr (ClothMArray) c = made (30, 20, 8);

  g_assert_cmpmem (a->matrix, 600, b->matrix, 600);
  g_assert_cmpint (memcmp (a->matrix, c->matrix, 600), !=, 0);
}

/* Limits, and sizes that cannot exist or are not found. */
static void
test_generate_refused (void)
{
  const struct
  {
    gint columns, rows, colours, distance;
    gboolean two_sided;
    gint code;
    const gchar *says;
  } cases[] = {
    {2, 9, 5, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "columns"},
    {9, 2, 5, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "rows"},
    {401, 9, 5, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "3 to 400"},
    {G_MININT, 9, 5, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "columns"},
    {9, G_MAXINT, 5, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "rows"},
    {9, 9, 1, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "colours"},
    {9, 9, 9, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "2 to 8"},
    {9, 9, 5, 0, FALSE, CLOTH_PATTERN_ERROR_VALUE, "distance"},
    {9, 9, 5, 6, FALSE, CLOTH_PATTERN_ERROR_VALUE, "distance"},
    /* 512 words of two colours are at most 64 windows in 8 turns, 32 on two sides. */
    {11, 10, 2, 1, FALSE, CLOTH_PATTERN_ERROR_VALUE, "at most 64"},
    {8, 8, 2, 1, TRUE, CLOTH_PATTERN_ERROR_VALUE, "at most 32 seen from both"},
    /* The bound leaves room; only 30 necklaces of 8 in two colours have no period, with
     * either centre 60 windows. */
    {10, 10, 2, 1, FALSE, CLOTH_PATTERN_ERROR_CODE, "more colours"},
    {40, 40, 5, 4, FALSE, CLOTH_PATTERN_ERROR_CODE, "less distance"},
    {7, 7, 2, 1, TRUE, CLOTH_PATTERN_ERROR_CODE, "was found for both sides"},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    const ClothMArrayCode code = { cases[i].distance, cases[i].two_sided, 1 };
    g_autofree guint8 *matrix = g_malloc (2500);
    g_autoptr (GError) error = NULL;

    g_assert_false (cloth_m_array_generate (cases[i].columns, cases[i].rows,
            cases[i].colours, &code, matrix, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, cases[i].code);
    g_test_message ("%s", error->message);
    g_assert_nonnull (strstr (error->message, cases[i].says));
  }
}

static void
test_new_refused (void)
{
  const gdouble cases[][3] = { {0, 0.013, 0.01}, {-0.02, 0.013, 0.01},
  {NAN, 0.013, 0.01}, {INFINITY, 0.013, 0.01}, {0.02, 0, 0.01},
  {0.02, 0.02, 0.01}, {0.02, NAN, 0.01}, {0.02, 0.013, 0.006},
  {0.02, 0.013, -1}, {0.02, 0.013, NAN}, {200, 0.013, 0.01},
  {0.02, 0.013, 1e9}, {1e-300, 5e-301, 0.01}, {0.9e-6, 0.5e-6, 0.01},
  {0.02, 1e-300, 0.01}, {0.02, 0.000199, 0.01}
  };
  const ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_m_array_new (9, 9, 5, cases[i][0], cases[i][1],
            cases[i][2], &code, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  }
}

static void
test_round_trip (void)
{
  g_autoptr (ClothMArray) array = made (6, 4, 3);
  g_autoptr (ClothMArray) read = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *dir = g_dir_make_tmp ("marray-XXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (dir, "pattern.json", NULL);
  g_autofree gchar *text = NULL, *again = NULL;

  array->pitch_m = 1.0 / 60;
  g_assert_true (cloth_m_array_save (array, path, &error));
  read = cloth_m_array_load (path, &error);
  g_assert_no_error (error);
  g_assert_cmpfloat (read->pitch_m, ==, 1.0 / 60);
  g_assert_cmpmem (read->matrix, 24, array->matrix, 24);
  g_assert_cmpint (read->colours[3].rgb[1], ==, 120);
  text = cloth_m_array_to_json (array);
  again = cloth_m_array_to_json (read);
  g_assert_cmpstr (text, ==, again);
  /* Unsound: nothing is written over what is there. */
  array->matrix[5] = 5;
  g_assert_false (cloth_m_array_save (array, path, &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  cloth_m_array_free (g_steal_pointer (&read));
  read = cloth_m_array_load (path, NULL);
  g_assert_nonnull (read);
  g_unlink (path);
  g_rmdir (dir);
}

/* What can be made can be read. */
static void
test_largest (void)
{
  const ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;
  const gint n = CLOTH_M_ARRAY_MAX;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMArray) array =
      cloth_m_array_new (n, n, 8, 0.02, 0.013, 0.01, &code, &error);
  g_autoptr (ClothMArray) read = NULL;
  g_autofree gchar *text = NULL;

  g_assert_no_error (error);
  text = cloth_m_array_to_json (array);
  read = cloth_m_array_load_data (text, strlen (text), &error);
  g_assert_no_error (error);
  g_assert_cmpmem (read->matrix, n * n, array->matrix, n * n);
}

#define HEAD "{\"pattern\":\"m-array\",\"colours\":[\"red\",\"blue\"]," \
    "\"rgb\":[[255,0,0],[0,0,255]],"
#define SIZE "\"pitch_m\":0.02,\"diameter_m\":0.01,\"origin_uv_m\":[0.01,0.01]," \
    "\"cloth_m\":[0.06,0.06],"
#define COUNT "\"columns\":3,\"rows\":3,"
#define MATRIX "\"matrix\":[[0,1,1],[0,0,1],[1,0,1]]}"

static void
test_read (void)
{
  static const gchar text[] = HEAD SIZE COUNT MATRIX;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMArray) array =
      cloth_m_array_load_data (text, strlen (text), &error);

  g_assert_no_error (error);
  g_assert_cmpint (array->n_colours, ==, 2);
  g_assert_cmpint (array->matrix[5], ==, 1);
  g_assert_cmpint (array->matrix[7], ==, 0);
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
    {"", CLOTH_PATTERN_ERROR_FORMAT, "pattern.json"},
    {"[]", CLOTH_PATTERN_ERROR_FORMAT, "pattern.json"},
    {"{}", CLOTH_PATTERN_ERROR_UNSUPPORTED, "m-array"},
    {"{\"pattern\":\"checker\"}", CLOTH_PATTERN_ERROR_UNSUPPORTED, "checker"},
    {"{\"pattern\":7}", CLOTH_PATTERN_ERROR_FORMAT, "pattern"},
    {"{\"version\":2,\"pattern\":\"m-array\"}",
        CLOTH_PATTERN_ERROR_UNSUPPORTED, "version 2"},
    {HEAD SIZE COUNT "\"hue\":1," MATRIX, CLOTH_PATTERN_ERROR_FORMAT, "hue"},
    {HEAD SIZE COUNT "\"rows\":3," MATRIX, CLOTH_PATTERN_ERROR_FORMAT,
        "twice"},
    {HEAD SIZE MATRIX, CLOTH_PATTERN_ERROR_FORMAT, "columns"},
    {HEAD COUNT MATRIX, CLOTH_PATTERN_ERROR_FORMAT, "origin_uv_m"},
    {HEAD SIZE "\"columns\":3,\"rows\":4," MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "4 items"},
    {HEAD SIZE "\"columns\":4,\"rows\":3," MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "list of 4"},
    {HEAD SIZE "\"columns\":3,\"rows\":401," MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "3 to 400"},
    {HEAD SIZE COUNT "\"matrix\":[[0,1,2],[0,0,1],[1,0,1]]}",
        CLOTH_PATTERN_ERROR_FORMAT, "0 to 1"},
    {HEAD SIZE COUNT "\"matrix\":[[0,1,0.5],[0,0,1],[1,0,1]]}",
        CLOTH_PATTERN_ERROR_FORMAT, "matrix"},
    {HEAD SIZE COUNT "\"matrix\":[[0,1,-1],[0,0,1],[1,0,1]]}",
        CLOTH_PATTERN_ERROR_FORMAT, "matrix"},
    {HEAD SIZE COUNT "\"matrix\":[[0,1,null],[0,0,1],[1,0,1]]}",
        CLOTH_PATTERN_ERROR_FORMAT, "matrix"},
    {HEAD SIZE COUNT "\"matrix\":[[0,0,0],[0,0,0],[0,0,0]]}",
        CLOTH_PATTERN_ERROR_VALUE, "all dots of the matrix are red"},
    {HEAD SIZE COUNT "\"matrix\":[[1,1,1],[1,1,1],[1,1,1]]}",
        CLOTH_PATTERN_ERROR_VALUE, "all dots of the matrix are blue"},
    {HEAD "\"pitch_m\":1e-300,\"diameter_m\":5e-301,"
          "\"origin_uv_m\":[0.01,0.01],\"cloth_m\":[0.06,0.06]," COUNT MATRIX,
        CLOTH_PATTERN_ERROR_VALUE, "from 1e-06 to 1000"},
    {HEAD SIZE COUNT "\"matrix\":[7,7,7]}", CLOTH_PATTERN_ERROR_FORMAT,
        "matrix"},
    {HEAD SIZE COUNT "\"matrix\":{}}", CLOTH_PATTERN_ERROR_FORMAT, "matrix"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\"],\"rgb\":[[1,2,3]],"
          SIZE COUNT MATRIX, CLOTH_PATTERN_ERROR_FORMAT, "2 to 8"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\",\"red\"],"
          "\"rgb\":[[1,2,3],[4,5,6]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_VALUE, "\"red\""},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\",\"blue\"],"
          "\"rgb\":[[1,2,3],[1,2,3]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_VALUE, "red and blue"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\",5],"
          "\"rgb\":[[1,2,3],[4,5,6]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "name"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\",\"\"],"
          "\"rgb\":[[1,2,3],[4,5,6]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "name"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\","
          "\"a colour whose name is longer than it\"],"
          "\"rgb\":[[1,2,3],[4,5,6]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "1 to 31"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\",\"blue\"],"
          "\"rgb\":[[1,2,3]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "2 items"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\",\"blue\"],"
          "\"rgb\":[[1,2,3],[4,5,256]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "rgb"},
    {"{\"version\":\"1\",\"pattern\":\"m-array\"}", CLOTH_PATTERN_ERROR_FORMAT,
        "version"},
    {"{\"pattern\":\"m-array\",\"colours\":[\"red\",[\"blue\"]],"
          "\"rgb\":[[1,2,3],[4,5,6]]," SIZE COUNT MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "item 1 of “colours”"},
    {HEAD SIZE COUNT "\"matrix\":[[0,1,1],[0,0],[1,0,1]]}",
        CLOTH_PATTERN_ERROR_FORMAT, "item 1 of “matrix”"},
    {HEAD COUNT "\"pitch_m\":0.02,\"diameter_m\":\"x\"," MATRIX,
        CLOTH_PATTERN_ERROR_FORMAT, "diameter_m"},
    {HEAD COUNT "\"pitch_m\":1,\"diameter_m\":0.5,\"origin_uv_m\":[\"0\",0]}",
        CLOTH_PATTERN_ERROR_FORMAT, "“origin_uv_m” must be a list of two"},
    {HEAD COUNT "\"pitch_m\":1,\"diameter_m\":0.5,\"origin_uv_m\":[0,null]}",
        CLOTH_PATTERN_ERROR_FORMAT, "“origin_uv_m” must be a list of two"},
    {HEAD COUNT "\"pitch_m\":1,\"diameter_m\":0.5,\"origin_uv_m\":[0,0],"
          "\"cloth_m\":[1]}", CLOTH_PATTERN_ERROR_FORMAT, "cloth_m"},
    {HEAD "\"pitch_m\":0.02,\"diameter_m\":0.01,\"origin_uv_m\":[0.01,0.01],"
          "\"cloth_m\":[0.06,0.05]," COUNT MATRIX, CLOTH_PATTERN_ERROR_VALUE,
        "height"},
    {HEAD "\"pitch_m\":\"wide\"," COUNT MATRIX, CLOTH_PATTERN_ERROR_FORMAT,
        "pitch_m"},
    {HEAD "\"pitch_m\":0.02,\"diameter_m\":0.03,\"origin_uv_m\":[0.01,0.01],"
          "\"cloth_m\":[0.06,0.06]," COUNT MATRIX, CLOTH_PATTERN_ERROR_VALUE,
        "diameter_m"},
    {HEAD "\"pitch_m\":0.02,\"diameter_m\":0.01,\"origin_uv_m\":[0.01,0.01],"
          "\"cloth_m\":[0.05,0.06]," COUNT MATRIX, CLOTH_PATTERN_ERROR_VALUE,
        "width"},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;

    g_test_message ("%s", cases[i].text);
    g_assert_null (cloth_m_array_load_data (cases[i].text,
            strlen (cases[i].text), &error));
    g_test_message ("→ %s", error->message);
    g_assert_error (error, CLOTH_PATTERN_ERROR, cases[i].code);
    g_assert_nonnull (strstr (error->message, cases[i].says));
  }
}

/* Counts that no file can have. */
static void
test_check_refused (void)
{
  static const struct
  {
    gint columns, rows, n_colours;
    const gchar *says;
  } cases[] = {
    {2, 4, 5, "2 by 4 dots"}, {401, 4, 5, "401 by 4 dots"},
    {6, 2, 5, "6 by 2 dots"}, {6, 401, 5, "6 by 401 dots"},
    {6, 4, 1, "1 colours"}, {6, 4, 9, "9 colours"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (ClothMArray) array = made (6, 4, 3);
    g_autoptr (GError) error = NULL;

    array->columns = cases[i].columns;
    array->rows = cases[i].rows;
    array->n_colours = cases[i].n_colours;
    g_assert_false (cloth_m_array_check (array, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
    g_assert_nonnull (strstr (error->message, cases[i].says));
  }
}

static void
test_load_refused (void)
{
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_m_array_load ("/nowhere/pattern.json", &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  g_clear_error (&error);
  g_assert_null (cloth_m_array_load (TEST_DATA "/checker_pair/pattern.json",
          &error));
  g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_UNSUPPORTED);
  g_assert_true (g_str_has_prefix (error->message, TEST_DATA));
}

/* Each dot has its ink, the area of a disc, and its centre of gravity at its place. */
static void
test_texture (void)
{
  static const guint8 inks[5][3] = { {250, 20, 40}, {90, 250, 30}, {30, 60,
      250}, {200, 220, 40}, {120, 30, 230}
  };
  const gdouble scale = 1713;   /* dots lie anywhere in their pixels */
  g_autoptr (ClothMArray) array = made (6, 5, 4);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTexture) texture =
      cloth_m_array_texture (array, scale, 10, inks, &error);

  g_assert_no_error (error);
  g_assert_cmpint (texture->n_channels, ==, 3);
  g_assert_cmpint (texture->width, ==, (gint) (0.12 * scale + 0.5));
  g_assert_cmpint (texture->height, ==, (gint) (0.10 * scale + 0.5));
  for (gint dot = 0; dot < 30; dot++) {
    const gdouble u = (0.01 + 0.02 * (dot % 6)) * scale;
    const gdouble v = (0.01 + 0.02 * (dot / 6)) * scale;
    const gdouble area = G_PI * pow (0.0065 * scale, 2);
    const guint8 *ink = inks[array->matrix[dot]];

    for (gint c = 0; c < 3; c++) {
      gdouble sum = 0, x = 0, y = 0;

      for (gint j = (gint) (v - 16); j < MIN (v + 16, texture->height); j++)
        for (gint i = (gint) (u - 16); i < MIN (u + 16, texture->width); i++) {
          const gint at = 3 * (j * texture->width + i) + c;
          const gdouble value = texture->data[at] - 10;

          sum += value;
          x += value * (i + 0.5);
          y += value * (j + 0.5);
        }
      g_assert_cmpfloat_with_epsilon (sum / (ink[c] - 10), area, 0.01 * area);
      g_assert_cmpfloat_with_epsilon (x / sum, u, 0.02);
      g_assert_cmpfloat_with_epsilon (y / sum, v, 0.02);
    }
  }
}

static void
test_texture_refused (void)
{
  static const gdouble scales[] = { 0, -1, NAN, INFINITY, 1e6 };
  static const guint8 inks[5][3];
  g_autoptr (ClothMArray) array = made (6, 5, 4);

  for (guint i = 0; i < G_N_ELEMENTS (scales); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_m_array_texture (array, scales[i], 0, inks, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  }
  array->matrix[3] = 5;
  g_assert_false (cloth_m_array_check (array, NULL));
  {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_m_array_texture (array, 1000, 0, inks, &error));
    g_assert_nonnull (error);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/m-array/new", test_new);
  g_test_add_func ("/m-array/deterministic", test_deterministic);
  g_test_add_func ("/m-array/generate-refused", test_generate_refused);
  g_test_add_func ("/m-array/new-refused", test_new_refused);
  g_test_add_func ("/m-array/round-trip", test_round_trip);
  g_test_add_func ("/m-array/largest", test_largest);
  g_test_add_func ("/m-array/read", test_read);
  g_test_add_func ("/m-array/read-refused", test_read_refused);
  g_test_add_func ("/m-array/check-refused", test_check_refused);
  g_test_add_func ("/m-array/load-refused", test_load_refused);
  g_test_add_func ("/m-array/texture", test_texture);
  g_test_add_func ("/m-array/texture-refused", test_texture_refused);
  return g_test_run ();
}
