/* Printed patterns: what is on the cloth; reading and writing pattern.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/pattern.h"

#include <math.h>
#include <string.h>

#include "gst/file/json.h"
#include "gst/file/output.h"

/* Sizes of cloth beyond these are a mistake of the unit. */
#define MIN_METRES 1e-6
#define MAX_METRES 1000.0
/* Rounding of decimal sizes that should add up exactly. */
#define SLACK 1e-9

GQuark
cloth_pattern_error_quark (void)
{
  return g_quark_from_static_string ("cloth-pattern-error-quark");
}

/* @pattern: a pattern
 * @error: return location
 *
 * Checks every limit: 1 to %CLOTH_PATTERN_MAX_SQUARES squares each way, sizes from a
 * micrometre to a kilometre, the board within the cloth, a dot smaller than its square, code
 * bytes 0 or 1.
 *
 * Returns: %TRUE when @pattern is sound, else %FALSE with %CLOTH_PATTERN_ERROR_VALUE
 */
gboolean
cloth_pattern_check (const ClothPattern * pattern, GError ** error)
{
  const gdouble size[2] = { pattern->columns * pattern->square_m,
    pattern->rows * pattern->square_m
  };

  if (pattern->columns < 1 || pattern->columns > CLOTH_PATTERN_MAX_SQUARES
      || pattern->rows < 1 || pattern->rows > CLOTH_PATTERN_MAX_SQUARES) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "a board of %d by %d squares: use 1 to %d each way", pattern->columns,
        pattern->rows, CLOTH_PATTERN_MAX_SQUARES);
    return FALSE;
  }
  if (!(pattern->square_m >= MIN_METRES && pattern->square_m <= MAX_METRES)) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "square_m is %g: give the edge of a square in metres, from %g to %g",
        pattern->square_m, MIN_METRES, MAX_METRES);
    return FALSE;
  }
  for (gint i = 0; i < 2; i++) {
    if (!(pattern->origin_uv_m[i] >= 0)) {
      g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
          "origin_uv_m has %g: the board starts on the cloth, at 0 or more",
          pattern->origin_uv_m[i]);
      return FALSE;
    }
    if (!(pattern->cloth_m[i] > 0 && pattern->cloth_m[i] <= MAX_METRES)) {
      g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
          "cloth_m has %g: give the width and height of the cloth in metres, "
          "more than 0 and at most %g", pattern->cloth_m[i], MAX_METRES);
      return FALSE;
    }
    if (!(pattern->origin_uv_m[i] + size[i] <= pattern->cloth_m[i] + SLACK)) {
      g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
          "the board's %s goes from %g m to %g m but the cloth from 0 to %g m: "
          "move origin_uv_m, make the squares smaller or cloth_m larger",
          i == 0 ? "width" : "height", pattern->origin_uv_m[i],
          pattern->origin_uv_m[i] + size[i], pattern->cloth_m[i]);
      return FALSE;
    }
  }
  if (pattern->code) {
    if (!(pattern->dot_ratio > 0 && pattern->dot_ratio < 1)) {
      g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
          "dot_ratio is %g: give a dot's diameter over its square's edge, "
          "between 0 and 1", pattern->dot_ratio);
      return FALSE;
    }
    for (gint i = 0; i < pattern->columns * pattern->rows; i++) {
      if (pattern->code[i] > 1) {
        g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
            "the code has a value of %d: only 0 and 1 are known",
            pattern->code[i]);
        return FALSE;
      }
    }
  }
  return TRUE;
}

/* @columns: squares in a row
 * @rows: squares in a column
 * @square_m: edge of a square, metres
 * @margin_m: plain cloth around the board, metres, 0 or more
 * @first_black: whether the top-left square is black
 * @error: return location
 *
 * A plain checkerboard in the middle of a cloth that leaves @margin_m on every side.
 *
 * Returns: (transfer full): the pattern; free with cloth_pattern_free(). %NULL with
 *   %CLOTH_PATTERN_ERROR_VALUE when a number is outside its limits
 */
ClothPattern *
cloth_pattern_new_checker (gint columns, gint rows, gdouble square_m,
    gdouble margin_m, gboolean first_black, GError ** error)
{
  g_autoptr (ClothPattern) pattern = g_new0 (ClothPattern, 1);

  pattern->columns = columns;
  pattern->rows = rows;
  pattern->square_m = square_m;
  pattern->origin_uv_m[0] = pattern->origin_uv_m[1] = margin_m;
  pattern->cloth_m[0] = columns * square_m + 2 * margin_m;
  pattern->cloth_m[1] = rows * square_m + 2 * margin_m;
  pattern->first_black = first_black;
  if (!(margin_m >= 0 && margin_m <= MAX_METRES)) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "a margin of %g m: use 0 to %g m", margin_m, MAX_METRES);
    return NULL;
  }
  return cloth_pattern_check (pattern,
      error) ? g_steal_pointer (&pattern) : NULL;
}

/* @pattern: (nullable) (transfer full): a pattern
 */
void
cloth_pattern_free (ClothPattern * pattern)
{
  if (!pattern)
    return;
  g_free (pattern->code);
  g_free (pattern);
}

/* --- reading ------------------------------------------------------------------ */

static const gchar *const known_keys[] = { "version", "pattern", "columns",
  "rows", "square_m", "origin_uv_m", "cloth_m", "first_square", "code",
  "dot_ratio", NULL
};

static gboolean
bad (GError ** error, const gchar * key, const gchar * wanted)
{
  g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_FORMAT,
      "\"%s\" must be %s", key, wanted);
  return FALSE;
}

static gboolean
node_number (JsonNode * node, gdouble * value)
{
  GType type;

  if (!node || !JSON_NODE_HOLDS_VALUE (node))
    return FALSE;
  type = json_node_get_value_type (node);
  if (type != G_TYPE_DOUBLE && type != G_TYPE_INT64)
    return FALSE;
  *value = json_node_get_double (node);
  return isfinite (*value);
}

static gboolean
read_number (JsonObject * object, const gchar * key, gdouble * value,
    GError ** error)
{
  if (!node_number (json_object_get_member (object, key), value))
    return bad (error, key, "a finite number");
  return TRUE;
}

static gboolean
read_count (JsonObject * object, const gchar * key, gint * value,
    GError ** error)
{
  JsonNode *node = json_object_get_member (object, key);
  gint64 count;

  if (!node || !JSON_NODE_HOLDS_VALUE (node)
      || json_node_get_value_type (node) != G_TYPE_INT64)
    return bad (error, key, "a whole number");
  count = json_node_get_int (node);
  *value = (gint) CLAMP (count, -1, G_MAXINT16);
  return TRUE;
}

static gboolean
read_pair (JsonObject * object, const gchar * key, gdouble value[2],
    GError ** error)
{
  JsonNode *node = json_object_get_member (object, key);
  JsonArray *array;

  if (!node)
    return TRUE;
  if (!JSON_NODE_HOLDS_ARRAY (node))
    return bad (error, key, "a list of two numbers, metres");
  array = json_node_get_array (node);
  if (json_array_get_length (array) != 2
      || !node_number (json_array_get_element (array, 0), &value[0])
      || !node_number (json_array_get_element (array, 1), &value[1]))
    return bad (error, key, "a list of two finite numbers, metres");
  return TRUE;
}

static const gchar *
read_string (JsonObject * object, const gchar * key)
{
  JsonNode *node = json_object_get_member (object, key);

  if (!node || !JSON_NODE_HOLDS_VALUE (node)
      || json_node_get_value_type (node) != G_TYPE_STRING)
    return NULL;
  return json_node_get_string (node);
}

/* @pattern's columns and rows have been checked. */
static gboolean
read_code (JsonObject * object, ClothPattern * pattern, GError ** error)
{
  JsonNode *node = json_object_get_member (object, "code");
  JsonArray *array;

  if (!node) {
    if (json_object_has_member (object, "dot_ratio"))
      return bad (error, "dot_ratio", "absent where there is no \"code\"");
    return TRUE;
  }
  if (!JSON_NODE_HOLDS_ARRAY (node)
      || json_array_get_length (array = json_node_get_array (node))
      != (guint) pattern->rows)
    return bad (error, "code", "a list of strings, one for each row");
  pattern->code = g_malloc0 ((gsize) pattern->columns * pattern->rows);
  for (gint row = 0; row < pattern->rows; row++) {
    JsonNode *item = json_array_get_element (array, (guint) row);
    const gchar *bits = NULL;

    if (JSON_NODE_HOLDS_VALUE (item)
        && json_node_get_value_type (item) == G_TYPE_STRING)
      bits = json_node_get_string (item);
    if (!bits || strspn (bits, "01") != (gsize) pattern->columns
        || bits[pattern->columns])
      return bad (error, "code",
          "strings of 0 and 1, one character for each column");
    for (gint column = 0; column < pattern->columns; column++)
      pattern->code[row * pattern->columns + column] = bits[column] == '1';
  }
  return read_number (object, "dot_ratio", &pattern->dot_ratio, error);
}

static gboolean
read_checker (JsonObject * object, ClothPattern * pattern, GError ** error)
{
  if (!read_count (object, "columns", &pattern->columns, error)
      || !read_count (object, "rows", &pattern->rows, error)
      || !read_number (object, "square_m", &pattern->square_m, error))
    return FALSE;
  pattern->cloth_m[0] = pattern->columns * pattern->square_m;
  pattern->cloth_m[1] = pattern->rows * pattern->square_m;
  if (!read_pair (object, "origin_uv_m", pattern->origin_uv_m, error))
    return FALSE;
  if (!json_object_has_member (object, "cloth_m")) {
    pattern->cloth_m[0] += pattern->origin_uv_m[0];
    pattern->cloth_m[1] += pattern->origin_uv_m[1];
  } else if (!read_pair (object, "cloth_m", pattern->cloth_m, error)) {
    return FALSE;
  }
  pattern->first_black = TRUE;
  if (json_object_has_member (object, "first_square")) {
    const gchar *first = read_string (object, "first_square");

    if (g_strcmp0 (first, "black") && g_strcmp0 (first, "white"))
      return bad (error, "first_square", "\"black\" or \"white\"");
    pattern->first_black = !strcmp (first, "black");
  }
  return cloth_pattern_check (pattern, error)
      && read_code (object, pattern, error)
      && cloth_pattern_check (pattern, error);
}

static gboolean
read_version (JsonObject * object, GError ** error)
{
  gint version;

  if (!json_object_has_member (object, "version"))
    return TRUE;
  if (!read_count (object, "version", &version, error))
    return FALSE;
  if (version != 1) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_UNSUPPORTED,
        "version %d of pattern.json: this build reads version 1", version);
    return FALSE;
  }
  return TRUE;
}

/* @data: (array length=size): the text of a pattern.json, not ended by 0
 * @size: its bytes
 * @error: return location
 *
 * Reads a pattern from memory. Keys: `version` (1; may be missing), `pattern`
 * ("checker"), `columns`, `rows`, `square_m`, `origin_uv_m` (default 0, 0), `cloth_m`
 * (default: the cloth ends with the board), `first_square` ("black", the default, or
 * "white"); a coded board has `code`, a list of a string of 0 and 1 for each row, and
 * `dot_ratio`. Other keys are an error.
 *
 * Returns: (transfer full): the pattern, or %NULL with a #ClothPatternError
 */
ClothPattern *
cloth_pattern_load_data (const gchar * data, gsize size, GError ** error)
{
  g_autoptr (GError) fault = NULL;
  g_autoptr (JsonParser) parser = cloth_json_parse (data, size, &fault);
  g_autoptr (ClothPattern) pattern = NULL;
  g_autoptr (GList) members = NULL;
  JsonObject *object;
  const gchar *kind;

  if (!parser) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_FORMAT,
        "no pattern.json: %s", fault->message);
    return NULL;
  }
  object = json_node_get_object (json_parser_get_root (parser));
  if (!read_version (object, error))
    return NULL;
  if (!(kind = read_string (object, "pattern"))) {
    bad (error, "pattern", "the name of a kind of pattern: \"checker\"");
    return NULL;
  }
  if (strcmp (kind, "checker")) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_UNSUPPORTED,
        "a pattern of kind \"%.40s\": a board is read from one of kind "
        "\"checker\"", kind);
    return NULL;
  }
  members = json_object_get_members (object);
  for (GList * l = members; l; l = l->next) {
    if (!g_strv_contains (known_keys, l->data)) {
      g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_FORMAT,
          "unknown key \"%.40s\": remove or correct it",
          (const gchar *) l->data);
      return NULL;
    }
  }
  pattern = g_new0 (ClothPattern, 1);
  return read_checker (object, pattern,
      error) ? g_steal_pointer (&pattern) : NULL;
}

/* @path: (type filename): a pattern.json
 * @error: return location
 *
 * Reads a pattern; see cloth_pattern_load_data() for what the file holds. The error's
 * message begins with @path.
 *
 * Returns: (transfer full): the pattern, or %NULL with a #ClothPatternError,
 *   #ClothFileError when the file is too large, or #GFileError
 */
ClothPattern *
cloth_pattern_load (const gchar * path, GError ** error)
{
  g_autofree gchar *data = NULL;
  ClothPattern *pattern;
  gsize size;

  if (!(data = cloth_text_file_load (path, &size, error)))
    return NULL;
  pattern = cloth_pattern_load_data (data, size, error);
  if (!pattern)
    g_prefix_error (error, "%s: ", path);
  return pattern;
}

/* --- writing ------------------------------------------------------------------ */

/* The shortest decimal that reads back as the same number: 0.05, where json-glib
 * would write 0.050000000000000003. */
static void
put_number (GString * text, gdouble value)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE];
  static const gchar *const formats[] = { "%.15g", "%.16g", "%.17g" };

  for (gint i = 0; i < 3; i++) {
    g_ascii_formatd (digits, sizeof digits, formats[i], value);
    if (g_ascii_strtod (digits, NULL) == value)
      break;
  }
  g_string_append (text, digits);
}

static void
put_pair (GString * text, const gchar * key, const gdouble value[2])
{
  g_string_append_printf (text, " \"%s\": [", key);
  put_number (text, value[0]);
  g_string_append (text, ", ");
  put_number (text, value[1]);
  g_string_append (text, "],\n");
}

/* @pattern: a sound pattern
 *
 * Returns: (transfer full): the text of its pattern.json; equal patterns give equal
 *   bytes and every number reads back as it was
 */
gchar *
cloth_pattern_to_json (const ClothPattern * pattern)
{
  GString *text = g_string_new ("{\n \"version\": 1,\n");

  g_string_append_printf (text, " \"pattern\": \"checker\",\n"
      " \"columns\": %d,\n \"rows\": %d,\n \"square_m\": ",
      pattern->columns, pattern->rows);
  put_number (text, pattern->square_m);
  g_string_append (text, ",\n");
  put_pair (text, "origin_uv_m", pattern->origin_uv_m);
  put_pair (text, "cloth_m", pattern->cloth_m);
  g_string_append_printf (text, " \"first_square\": \"%s\"",
      pattern->first_black ? "black" : "white");
  if (pattern->code) {
    g_string_append (text, ",\n \"dot_ratio\": ");
    put_number (text, pattern->dot_ratio);
    g_string_append (text, ",\n \"code\": [");
    for (gint row = 0; row < pattern->rows; row++) {
      g_string_append (text, row ? ",\n  \"" : "\n  \"");
      for (gint column = 0; column < pattern->columns; column++)
        g_string_append_c (text,
            cloth_pattern_has_dot (pattern, column, row) ? '1' : '0');
      g_string_append_c (text, '"');
    }
    g_string_append (text, "\n ]");
  }
  g_string_append (text, "\n}\n");
  return g_string_free (text, FALSE);
}

/* @pattern: a pattern
 * @path: (type filename): where to
 * @error: return location
 *
 * Writes pattern.json; the file appears whole or not at all.
 *
 * Returns: %FALSE with %CLOTH_PATTERN_ERROR_VALUE or a #GIOErrorEnum
 */
gboolean
cloth_pattern_save (const ClothPattern * pattern, const gchar * path,
    GError ** error)
{
  g_autofree gchar *text = NULL;

  if (!cloth_pattern_check (pattern, error))
    return FALSE;
  text = cloth_pattern_to_json (pattern);
  return cloth_file_write_text (path, text, error);
}
