/* JSON that nobody vouches for: one object, within limits, no key twice.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/json.h"

#include <math.h>
#include <string.h>

#define MAX_BYTES (16 * 1024 * 1024)
/* json-glib descends by recursion: this guards its stack. */
#define MAX_DEPTH 16
/* Each takes json-glib some 100 bytes. */
#define MAX_VALUES 200000

typedef struct
{
  guint n_members[MAX_DEPTH + 1];
  guint depth;
  gboolean twice;
} Members;

/* *INDENT-OFF* */
static gboolean refuse (GError ** error, ClothFileError code,
    const gchar * format, ...) G_GNUC_PRINTF (3, 4);
/* *INDENT-ON* */

static gboolean
refuse (GError ** error, ClothFileError code, const gchar * format, ...)
{
  va_list args;
  g_autofree gchar *what = NULL;

  va_start (args, format);
  what = g_strdup_vprintf (format, args);
  va_end (args);
  g_set_error (error, CLOTH_FILE_ERROR, (gint) code, "not JSON: %s", what);
  return FALSE;
}

/* Four hexadecimal digits behind \u, or -1. */
static gint
unicode_escape (const gchar * at, gsize rest)
{
  gint code = 0;

  if (rest < 6 || at[0] != '\\' || at[1] != 'u')
    return -1;
  for (guint i = 2; i < 6; i++) {
    gint digit = g_ascii_xdigit_value (at[i]);

    if (digit < 0)
      return -1;
    code = 16 * code + digit;
  }
  return code;
}

/* Bytes of the escape at @at; 0 for one that is no JSON or no character: json-glib would
 * make invalid UTF-8 of half a surrogate pair or an octal number, and end a text at
 * \u0000. */
static gsize
check_escape (const gchar * at, gsize rest)
{
  gint code = unicode_escape (at, rest), second;

  if (code < 0)
    return rest > 1 && strchr ("\"\\/bfnrt", at[1]) ? 2 : 0;
  if (code < 0xd800 || code > 0xdfff)
    return code ? 6 : 0;
  second = unicode_escape (at + 6, rest - 6);
  return code < 0xdc00 && second >= 0xdc00 && second <= 0xdfff ? 12 : 0;
}

/* Counts before the parser sees a byte. Comments and single quotes, which json-glib takes
 * beyond JSON, could hide brackets from the count; after the object it would take further
 * values. */
static gboolean
check_text (const gchar * data, gsize length, GError ** error)
{
  guint depth = 0, n_values = 0;
  gboolean quoted = FALSE, ended = FALSE;

  if (length > MAX_BYTES)
    return refuse (error, CLOTH_FILE_ERROR_LIMIT,
        "%" G_GSIZE_FORMAT " bytes are more than the %d allowed", length,
        MAX_BYTES);
  /* A 0 is not, either. */
  if (!g_utf8_validate_len (data, length, NULL))
    return refuse (error, CLOTH_FILE_ERROR_INVALID, "it is not UTF-8 text");
  for (gsize i = 0; i < length; i++) {
    gchar c = data[i];

    if (quoted) {
      if (c == '\\') {
        gsize n = check_escape (data + i, length - i);

        if (n == 0)
          return refuse (error, CLOTH_FILE_ERROR_INVALID,
              "the escape at offset %" G_GSIZE_FORMAT " is no character", i);
        i += n - 1;
      } else if (c == '"') {
        quoted = FALSE;
      }
      continue;
    }
    if (strchr (" \t\r\n", c))
      continue;
    if (ended || (depth == 0 && c != '{'))
      return refuse (error, CLOTH_FILE_ERROR_INVALID,
          "byte 0x%02x at offset %" G_GSIZE_FORMAT "; the file must hold one "
          "object and nothing else", (guchar) c, i);
    if (c == '"') {
      quoted = TRUE;
    } else if (c == '[' || c == '{') {
      if (++depth > MAX_DEPTH)
        return refuse (error, CLOTH_FILE_ERROR_LIMIT,
            "nested deeper than %d levels", MAX_DEPTH);
      n_values++;
    } else if (c == ']' || c == '}') {
      ended = --depth == 0;
    } else if (c == ',') {
      n_values++;
    } else if (!strchr (":+-.", c) && !g_ascii_isalnum (c)) {
      return refuse (error, CLOTH_FILE_ERROR_INVALID,
          "byte 0x%02x at offset %" G_GSIZE_FORMAT, (guchar) c, i);
    }
    if (n_values > MAX_VALUES)
      return refuse (error, CLOTH_FILE_ERROR_LIMIT,
          "more than %d values", MAX_VALUES);
  }
  return ended || refuse (error, CLOTH_FILE_ERROR_INVALID,
      "the file must hold one object, with all its brackets closed");
}

static void
object_start (JsonParser * parser, Members * self)
{
  self->n_members[self->depth++] = 0;
}

static void
object_member (JsonParser * parser, JsonObject * object, const gchar * key,
    Members * self)
{
  self->n_members[self->depth - 1]++;
}

static void
object_end (JsonParser * parser, JsonObject * object, Members * self)
{
  if (self->n_members[--self->depth] != json_object_get_size (object))
    self->twice = TRUE;
}

/* @data: the text, not necessarily ended by 0
 * @length: its bytes
 * @error: #ClothFileError
 *
 * Reads a file's text that holds one JSON object and nothing else. More than 16 MiB,
 * 16 levels or 200000 values are refused, as are comments, which json-glib would take,
 * and keys that an object has twice, of which it would silently take the last.
 *
 * Returns: (transfer full): a parser whose root is an object, or %NULL
 */
JsonParser *
cloth_json_parse (const gchar * data, gsize length, GError ** error)
{
  g_autoptr (JsonParser) parser = NULL;
  g_autoptr (GError) fault = NULL;
  Members members = { {0}, };

  if (!check_text (data, length, error))
    return NULL;
  parser = json_parser_new_immutable ();
  g_signal_connect (parser, "object-start", G_CALLBACK (object_start),
      &members);
  g_signal_connect (parser, "object-member", G_CALLBACK (object_member),
      &members);
  g_signal_connect (parser, "object-end", G_CALLBACK (object_end), &members);
  if (!json_parser_load_from_data (parser, data, (gssize) length, &fault)) {
    refuse (error, CLOTH_FILE_ERROR_INVALID, "%s", fault->message);
    return NULL;
  }
  g_signal_handlers_disconnect_by_data (parser, &members);
  if (members.twice) {
    refuse (error, CLOTH_FILE_ERROR_INVALID, "an object has a key twice");
    return NULL;
  }
  return g_steal_pointer (&parser);
}

/* @file: whose value it is
 * @error: (out): set to say so, behind the name of the file
 * @format: what is wrong and how to mend it
 *
 * Returns: %FALSE, so that a check may end with it
 */
gboolean
cloth_json_invalid (const ClothJsonFile * file, GError ** error,
    const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_set_error (error, file->domain (), file->code, "%s: %s", file->name, text);
  return FALSE;
}

/* @file: whose object it is
 * @object: an object
 * @where: what messages call it
 * @allowed: the keys it may have, %NULL-terminated
 * @error: as @file says
 *
 * An unknown key is an error: a misspelt one would silently take its default.
 *
 * Returns: %TRUE when it has no others
 */
gboolean
cloth_json_check_keys (const ClothJsonFile * file, JsonObject * object,
    const gchar * where, const gchar * const *allowed, GError ** error)
{
  g_autoptr (GList) members = json_object_get_members (object);

  for (GList * at = members; at; at = at->next) {
    if (!g_strv_contains (allowed, at->data)) {
      g_autofree gchar *list = g_strjoinv (", ", (gchar **) allowed);

      return cloth_json_invalid (file, error,
          "unknown key “%s” in %s; the keys are %s",
          (const gchar *) at->data, where, list);
    }
  }
  return TRUE;
}

/* @object: an object
 * @key: a key
 *
 * Returns: (transfer none) (nullable): its value; %NULL when absent or null
 */
JsonNode *
cloth_json_find (JsonObject * object, const gchar * key)
{
  JsonNode *node = json_object_get_member (object, key);

  return node && !JSON_NODE_HOLDS_NULL (node) ? node : NULL;
}

/* @node: a value
 * @value: (out): it
 *
 * Returns: %TRUE when it is a finite number
 */
gboolean
cloth_json_number (JsonNode * node, gdouble * value)
{
  GType type = JSON_NODE_HOLDS_VALUE (node) ? json_node_get_value_type (node) :
      G_TYPE_INVALID;

  if (type == G_TYPE_INT64)
    *value = (gdouble) json_node_get_int (node);
  else if (type == G_TYPE_DOUBLE)
    *value = json_node_get_double (node);
  else
    return FALSE;
  return isfinite (*value);
}

/* @file: whose object it is
 * @object: an object
 * @key: a key
 * @least: least value allowed
 * @most: greatest value allowed
 * @value: (inout): left alone when the key is absent or null
 * @error: as @file says
 *
 * Returns: %TRUE unless the key holds something else
 */
gboolean
cloth_json_get_number (const ClothJsonFile * file, JsonObject * object,
    const gchar * key, gdouble least, gdouble most, gdouble * value,
    GError ** error)
{
  JsonNode *node = cloth_json_find (object, key);
  gdouble number;

  if (!node)
    return TRUE;
  if (!cloth_json_number (node, &number) || number < least || number > most)
    return cloth_json_invalid (file, error,
        "“%s” must be a number from %g to %g", key, least, most);
  *value = number;
  return TRUE;
}

/* @file: whose object it is
 * @object: an object
 * @key: a key that must be there
 * @least: least value allowed
 * @most: greatest value allowed
 * @value: (out): it
 * @error: as @file says
 *
 * Returns: %TRUE when it is a whole number in range
 */
gboolean
cloth_json_get_count (const ClothJsonFile * file, JsonObject * object,
    const gchar * key, guint least, guint most, guint * value, GError ** error)
{
  JsonNode *node = cloth_json_find (object, key);
  gdouble number;

  if (!node || !cloth_json_number (node, &number) || number != floor (number) ||
      number < least || number > most)
    return cloth_json_invalid (file, error,
        "“%s” must be a whole number from %u to %u", key, least, most);
  *value = (guint) number;
  return TRUE;
}

/* @file: whose object it is
 * @object: an object
 * @key: a key
 * @value: (inout) (transfer full): left alone when the key is absent or null
 * @error: as @file says
 *
 * Returns: %TRUE unless the key holds something else
 */
gboolean
cloth_json_get_string (const ClothJsonFile * file, JsonObject * object,
    const gchar * key, gchar ** value, GError ** error)
{
  JsonNode *node = cloth_json_find (object, key);

  if (!node)
    return TRUE;
  if (!JSON_NODE_HOLDS_VALUE (node) ||
      json_node_get_value_type (node) != G_TYPE_STRING)
    return cloth_json_invalid (file, error, "“%s” must be a text", key);
  *value = g_strdup (json_node_get_string (node));
  return TRUE;
}

/* @file: whose object it is
 * @object: an object
 * @key: a key
 * @needed: whether it must be there
 * @value: (inout): three numbers of at most 1e6; left alone when the key is absent or null
 * @error: as @file says
 *
 * Returns: %TRUE unless the key holds something else
 */
gboolean
cloth_json_get_vector (const ClothJsonFile * file, JsonObject * object,
    const gchar * key, gboolean needed, gdouble * value, GError ** error)
{
  JsonNode *node = cloth_json_find (object, key);
  JsonArray *array;

  if (!node && !needed)
    return TRUE;
  array = node && JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) :
      NULL;
  if (!array || json_array_get_length (array) != 3)
    return cloth_json_invalid (file, error,
        "“%s” must be a list of three numbers", key);
  for (guint i = 0; i < 3; i++) {
    if (!cloth_json_number (json_array_get_element (array, i), &value[i]) ||
        fabs (value[i]) > 1e6)
      return cloth_json_invalid (file, error,
          "“%s” must be a list of three numbers", key);
  }
  return TRUE;
}

/* @file: whose object it is
 * @object: an object
 * @key: a key
 * @most: greatest length allowed
 * @bad: (out): whether it is something else, or longer
 * @error: as @file says
 *
 * Returns: (transfer none) (nullable): the list, %NULL when absent, null or bad
 */
JsonArray *
cloth_json_get_list (const ClothJsonFile * file, JsonObject * object,
    const gchar * key, guint most, gboolean * bad, GError ** error)
{
  JsonNode *node = cloth_json_find (object, key);
  JsonArray *array;

  *bad = FALSE;
  if (!node)
    return NULL;
  array = JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) : NULL;
  if (!array || json_array_get_length (array) > most) {
    *bad = TRUE;
    cloth_json_invalid (file, error,
        "“%s” must be a list of at most %u items", key, most);
    return NULL;
  }
  return array;
}

/* @file: whose list it is
 * @array: a list
 * @i: an item
 * @key: what messages call the list
 * @error: as @file says
 *
 * Returns: (transfer none) (nullable): the item when it is an object
 */
JsonObject *
cloth_json_item_object (const ClothJsonFile * file, JsonArray * array, guint i,
    const gchar * key, GError ** error)
{
  JsonNode *node = json_array_get_element (array, i);

  if (JSON_NODE_HOLDS_OBJECT (node))
    return json_node_get_object (node);
  cloth_json_invalid (file, error, "item %u of “%s” must be an object", i,
      key);
  return NULL;
}

/* @builder: is within an object
 * @key: a key
 * @value: its value; null when not finite, without a point when whole
 */
void
cloth_json_add_number (JsonBuilder * builder, const gchar * key, gdouble value)
{
  json_builder_set_member_name (builder, key);
  if (!isfinite (value))
    json_builder_add_null_value (builder);
  else if (value == floor (value) && fabs (value) < 1e15)
    json_builder_add_int_value (builder, (gint64) value);
  else
    json_builder_add_double_value (builder, value);
}

/* @builder: is within an object
 * @key: a key
 * @value: three numbers
 */
void
cloth_json_add_vector (JsonBuilder * builder, const gchar * key,
    const gdouble * value)
{
  json_builder_set_member_name (builder, key);
  json_builder_begin_array (builder);
  for (guint i = 0; i < 3; i++)
    json_builder_add_double_value (builder, value[i]);
  json_builder_end_array (builder);
}

/* @builder: is within an object
 * @key: a key
 * @value: its value
 */
void
cloth_json_add_string (JsonBuilder * builder, const gchar * key,
    const gchar * value)
{
  json_builder_set_member_name (builder, key);
  json_builder_add_string_value (builder, value);
}
