/* JSON that nobody vouches for: what RFC 8259 allows is read, what it forbids or the limits
 * forbid is refused, and each reader of a value refuses every other kind.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/json.h"

#include <math.h>
#include <string.h>

static const ClothJsonFile file = { "test.json", cloth_file_error_quark,
  CLOTH_FILE_ERROR_INVALID
};

static void
refuse (const gchar * text, gsize length, gint code)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (JsonParser) parser = cloth_json_parse (text, length, &error);

  g_assert_null (parser);
  g_assert_error (error, CLOTH_FILE_ERROR, code);
}

static void
test_texts (void)
{
  static const gchar *const good[] = {
    "{}", " \t\r\n{ \"a\" :\t1\r\n} \n",
    "{\"a\":[1,-2.5e-3,true,false,null,{}]}",
    "{\"a\":\"\\\"\\\\\\/\\b\\f\\n\\r\\t\\u00e4\"}",
    "{\"a\":\"\\ud83d\\uDE00\"}",
    "{\"a\":\"[{,\"}", "{\"a\":{\"a\":1}}"
  };
  static const gchar *const bad[] = {
    "", " ", "[1]", "1", "\"a\"", "{", "{\"a\":1", "{\"a\":[1}", "{\"a\":1}}",
    "{} {}", "{}x", "{}\"", "{\"a\":1,}", "{\"a\" 1}", "{\"a\"}", "{a:1}",
    "{'a':1}", "{\"a\":1/**/}", "{\"a\":1}//", "{\"a\":\"", "{\"a\":\"\\",
    "{\"a\":\"\\x41\"}", "{\"a\":\"\\101\"}", "{\"a\":\"\\u12g4\"}",
    "{\"a\":\"\\u12", "{\"a\":\"\\u0000\"}", "{\"a\":\"\\ud83d\"}",
    "{\"a\":\"\\ud83d\\u0041\"}", "{\"a\":\"\\ud83d\\ue000\"}",
    "{\"a\":\"\\ud83dx\"}", "{\"a\":\"\\ud83d, and more\"}",
    "{\"a\":\"\\ud83d\\nand more\"}",
    "{\"a\":\"\\udc00\\udc00\"}", "{\"a\":\"\\udfff\"}",
    "{\"a\":1,\"a\":1}", "{\"a\":{\"b\":1,\"b\":2}}", "{\"a\":\"\xff\"}", "}",
    "]"
  };

  for (guint i = 0; i < G_N_ELEMENTS (good); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (JsonParser) parser =
        cloth_json_parse (good[i], strlen (good[i]), &error);

    g_assert_no_error (error);
    g_assert_true (JSON_NODE_HOLDS_OBJECT (json_parser_get_root (parser)));
  }
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++)
    refuse (bad[i], strlen (bad[i]), CLOTH_FILE_ERROR_INVALID);
  /* A 0 ends no file. */
  refuse ("{}\0{}", 5, CLOTH_FILE_ERROR_INVALID);
  refuse ("{\"a\":\"\0\"}", 9, CLOTH_FILE_ERROR_INVALID);
}

/* 16 levels, 200,000 values, 16 MiB: the last that are taken and the first that aren't. */
static void
test_limits (void)
{
  for (guint over = 0; over < 2; over++) {
    g_autoptr (GString) deep = g_string_new ("{\"a\":");
    g_autoptr (GString) many = g_string_new ("{\"a\":[0");
    g_autoptr (GString) large = g_string_new ("{}");
    const GString *texts[] = { deep, many, large };

    for (guint i = 0; i < 15 + over; i++)
      g_string_append_c (deep, '[');
    for (guint i = 0; i < 15 + over; i++)
      g_string_append_c (deep, ']');
    g_string_append_c (deep, '}');
    /* An object, a list, and each value but the first behind a comma. */
    for (guint i = 0; i < 199998 + over; i++)
      g_string_append (many, ",0");
    g_string_append (many, "]}");
    while (large->len < (16 << 20) + over)
      g_string_append_c (large, ' ');
    for (guint i = 0; i < G_N_ELEMENTS (texts); i++) {
      g_autoptr (JsonParser) parser = NULL;

      if (over) {
        refuse (texts[i]->str, texts[i]->len, CLOTH_FILE_ERROR_LIMIT);
        continue;
      }
      parser = cloth_json_parse (texts[i]->str, texts[i]->len, NULL);
      g_assert_nonnull (parser);
    }
  }
}

/* What "v" may be, and what each reader must refuse. */
enum
{ NUMBER = 1, COUNT = 2, STRING = 4, VECTOR = 8, LIST = 16, NEEDED = 32 };

static void
test_values (void)
{
  static const struct
  {
    const gchar *text;
    guint taken;
  } cases[] = {
    {"{\"v\":2}", NUMBER | COUNT},
    {"{\"v\":2.0}", NUMBER | COUNT},
    {"{\"v\":2.5}", NUMBER},
    {"{\"v\":0.5}", 0},
    {"{\"v\":9}", 0},
    {"{\"v\":-2}", 0},
    {"{\"v\":1e999}", 0},
    {"{\"v\":true}", 0},
    {"{\"v\":\"2\"}", STRING},
    {"{\"v\":{}}", 0},
    {"{\"v\":[]}", LIST},
    {"{\"v\":[1,2]}", LIST},
    {"{\"v\":[1,2,3]}", LIST | VECTOR | NEEDED},
    {"{\"v\":[1,2,-1e6]}", LIST | VECTOR | NEEDED},
    {"{\"v\":[1,2,1.1e6]}", LIST},
    {"{\"v\":[1,2,\"3\"]}", LIST},
    {"{\"v\":[1,2,null]}", LIST},
    {"{\"v\":[1,2,3,4]}", 0},
    /* Absent, what must not be there is left alone. */
    {"{\"v\":null}", NUMBER | STRING | VECTOR | LIST},
    {"{}", NUMBER | STRING | VECTOR | LIST},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (JsonParser) parser =
        cloth_json_parse (cases[i].text, strlen (cases[i].text), NULL);
    JsonObject *object;
    guint taken = 0, count = 0;
    gdouble number = 7, vector[3] = { 7, 7, 7 };
    g_autofree gchar *text = NULL;
    gboolean bad;

    g_assert_nonnull (parser);
    object = json_node_get_object (json_parser_get_root (parser));
    if (cloth_json_get_number (&file, object, "v", 1, 5, &number, NULL))
      taken |= NUMBER;
    if (cloth_json_get_count (&file, object, "v", 1, 5, &count, NULL))
      taken |= COUNT;
    if (cloth_json_get_string (&file, object, "v", &text, NULL))
      taken |= STRING;
    if (cloth_json_get_vector (&file, object, "v", FALSE, vector, NULL))
      taken |= VECTOR;
    if (cloth_json_get_vector (&file, object, "v", TRUE, vector, NULL))
      taken |= NEEDED;
    cloth_json_get_list (&file, object, "v", 3, &bad, NULL);
    if (!bad)
      taken |= LIST;
    g_test_message ("%s", cases[i].text);
    g_assert_cmpuint (taken, ==, cases[i].taken);
  }
}

/* A refusal names the file and the key. */
static void
test_message (void)
{
  g_autoptr (JsonParser) parser = cloth_json_parse ("{\"v\":[1]}", 9, NULL);
  JsonObject *object = json_node_get_object (json_parser_get_root (parser));
  g_autoptr (GError) error = NULL;
  gdouble vector[3];

  g_assert_false (cloth_json_get_vector (&file, object, "v", TRUE, vector,
          &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "test.json"));
  g_assert_nonnull (strstr (error->message, "“v”"));
}

/* Whole numbers have no point, and what a reader would take for another number has one. */
static void
test_added_numbers (void)
{
  static const struct
  {
    gdouble value;
    const gchar *text;
  } cases[] = {
    {2, "{\"v\":2}"}, {-0.5, "{\"v\":-0.5}"}, {0, "{\"v\":0}"},
    {-999999999999999., "{\"v\":-999999999999999}"},
    {1e15, "{\"v\":1000000000000000.0}"},
    {NAN, "{\"v\":null}"}, {-INFINITY, "{\"v\":null}"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (JsonBuilder) builder = json_builder_new ();
    g_autoptr (JsonNode) root = NULL;
    g_autofree gchar *text = NULL;

    json_builder_begin_object (builder);
    cloth_json_add_number (builder, "v", cases[i].value);
    json_builder_end_object (builder);
    root = json_builder_get_root (builder);
    text = json_to_string (root, FALSE);
    g_assert_cmpstr (text, ==, cases[i].text);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/json/texts", test_texts);
  g_test_add_func ("/json/limits", test_limits);
  g_test_add_func ("/json/values", test_values);
  g_test_add_func ("/json/message", test_message);
  g_test_add_func ("/json/added-numbers", test_added_numbers);
  return g_test_run ();
}
