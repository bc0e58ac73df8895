/* JSON that nobody vouches for: one object, within limits, no key twice.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/json.h"

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

G_GNUC_PRINTF (3, 4)
     static gboolean
         refuse (GError ** error, ClothFileError code, const gchar * format,
    ...)
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
    return rest > 1 && at[1] != 0 && strchr ("\"\\/bfnrt", at[1]) ? 2 : 0;
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
    if (c != 0 && strchr (" \t\r\n", c))
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
  if (!json_parser_get_root (parser)
      || !JSON_NODE_HOLDS_OBJECT (json_parser_get_root (parser))) {
    refuse (error, CLOTH_FILE_ERROR_INVALID, "the file must hold one object");
    return NULL;
  }
  if (members.twice) {
    refuse (error, CLOTH_FILE_ERROR_INVALID, "an object has a key twice");
    return NULL;
  }
  return g_steal_pointer (&parser);
}
