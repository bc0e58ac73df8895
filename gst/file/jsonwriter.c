/* JSON that people read as well: lists of numbers on one line, short numbers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/jsonwriter.h"

#include <math.h>
#include <string.h>

struct _ClothJsonWriter
{
  GString *text;
  guint depth;
  gboolean first;               /* nothing yet in this object or list */
  gboolean exact;
  gboolean one_line;
};

static void
add_quoted (GString * text, const gchar * value)
{
  g_autofree gchar *valid = g_utf8_make_valid (value, -1);

  g_string_append_c (text, '"');
  for (const gchar * at = valid; *at; at = g_utf8_next_char (at)) {
    gunichar c = g_utf8_get_char (at);

    if (c == '"' || c == '\\')
      g_string_append_printf (text, "\\%c", (gchar) c);
    else if (c == '\n')
      g_string_append (text, "\\n");
    else if (c < 0x20 || c == 0x7f || c == '<' || c == '>' || c == '&' ||
        c == 0x2028 || c == 0x2029)
      g_string_append_printf (text, "\\u%04x", c);
    else
      g_string_append_unichar (text, c);
  }
  g_string_append_c (text, '"');
}

/* Seven digits are more than any measured figure carries; what is to be read again
 * takes as many as it needs. */
static void
add_number (ClothJsonWriter * writer, gdouble value)
{
  gchar digits[G_ASCII_DTOSTR_BUF_SIZE], format[8];

  if (!isfinite (value)) {
    g_string_append (writer->text, "null");
    return;
  }
  /* of what is large thousandths stay: times may count from 1970 */
  for (guint n = (guint) CLAMP (3. + ceil (log10 (fabs (value))), 7., 17.);
      n <= 17; n++) {
    g_snprintf (format, sizeof format, "%%.%ug", n);
    g_ascii_formatd (digits, sizeof digits, format, value == 0 ? 0 : value);
    if (!writer->exact || g_ascii_strtod (digits, NULL) == value)
      break;
  }
  g_string_append (writer->text, digits);
}

static void
break_line (ClothJsonWriter * writer)
{
  if (writer->one_line)
    return;
  g_string_append_c (writer->text, '\n');
  for (guint i = 0; i < writer->depth; i++)
    g_string_append (writer->text, "  ");
}

static void
start_item (ClothJsonWriter * writer, const gchar * key)
{
  if (!writer->first)
    g_string_append (writer->text, writer->one_line ? ", " : ",");
  if (writer->text->len > 0)
    break_line (writer);
  writer->first = FALSE;
  if (key) {
    add_quoted (writer->text, key);
    g_string_append (writer->text, ": ");
  }
}

static void
begin (ClothJsonWriter * writer, const gchar * key, gchar bracket)
{
  start_item (writer, key);
  g_string_append_c (writer->text, bracket);
  writer->depth++;
  writer->first = TRUE;
}

static void
end (ClothJsonWriter * writer, gchar bracket)
{
  writer->depth--;
  if (!writer->first)
    break_line (writer);
  g_string_append_c (writer->text, bracket);
  writer->first = FALSE;
}

/* Returns: (transfer full): a writer of an empty text
 */
ClothJsonWriter *
cloth_json_writer_new (void)
{
  ClothJsonWriter *writer = g_new0 (ClothJsonWriter, 1);

  writer->text = g_string_new (NULL);
  writer->first = TRUE;
  return writer;
}

/* @writer: a writer
 *
 * Numbers written from now on are, when read, the very same.
 */
void
cloth_json_writer_set_exact (ClothJsonWriter * writer)
{
  writer->exact = TRUE;
}

/* @writer: a writer
 * @one_line: whether what is written from now on stays on one line; what is ended with it must
 *   have been begun with it
 */
void
cloth_json_writer_set_one_line (ClothJsonWriter * writer, gboolean one_line)
{
  writer->one_line = one_line;
}

/* @writer: a writer
 * @key: (nullable): its key; %NULL in a list and at the top
 */
void
cloth_json_writer_begin_object (ClothJsonWriter * writer, const gchar * key)
{
  begin (writer, key, '{');
}

/* @writer: a writer
 */
void
cloth_json_writer_end_object (ClothJsonWriter * writer)
{
  end (writer, '}');
}

/* @writer: a writer
 * @key: (nullable): its key; %NULL in a list
 */
void
cloth_json_writer_begin_array (ClothJsonWriter * writer, const gchar * key)
{
  begin (writer, key, '[');
}

/* @writer: a writer
 */
void
cloth_json_writer_end_array (ClothJsonWriter * writer)
{
  end (writer, ']');
}

/* @writer: a writer
 * @key: (nullable): its key; %NULL in a list
 * @value: (nullable): any bytes; %NULL writes null
 */
void
cloth_json_writer_string (ClothJsonWriter * writer, const gchar * key,
    const gchar * value)
{
  start_item (writer, key);
  if (value)
    add_quoted (writer->text, value);
  else
    g_string_append (writer->text, "null");
}

/* @writer: a writer
 * @key: (nullable): its key; %NULL in a list
 * @value: written with seven digits, or exactly; null unless finite
 */
void
cloth_json_writer_number (ClothJsonWriter * writer, const gchar * key,
    gdouble value)
{
  start_item (writer, key);
  add_number (writer, value);
}

/* @writer: a writer
 * @key: (nullable): its key; %NULL in a list
 * @value: a whole number
 */
void
cloth_json_writer_count (ClothJsonWriter * writer, const gchar * key,
    guint64 value)
{
  start_item (writer, key);
  g_string_append_printf (writer->text, "%" G_GUINT64_FORMAT, value);
}

/* @writer: a writer
 * @key: (nullable): its key; %NULL in a list
 * @value: true or false
 */
void
cloth_json_writer_boolean (ClothJsonWriter * writer, const gchar * key,
    gboolean value)
{
  start_item (writer, key);
  g_string_append (writer->text, value ? "true" : "false");
}

/* @writer: a writer
 * @key: (nullable): its key; %NULL in a list
 * @values: (nullable): numbers; %NULL writes null
 * @n: how many
 *
 * A list of numbers, on one line.
 */
void
cloth_json_writer_numbers (ClothJsonWriter * writer, const gchar * key,
    const gdouble * values, gsize n)
{
  start_item (writer, key);
  if (!values) {
    g_string_append (writer->text, "null");
    return;
  }
  g_string_append_c (writer->text, '[');
  for (gsize i = 0; i < n; i++) {
    if (i > 0)
      g_string_append (writer->text, ", ");
    add_number (writer, values[i]);
  }
  g_string_append_c (writer->text, ']');
}

/* @writer: a writer whose objects and lists are all ended
 *
 * Returns: (transfer full): the text, with a line break at its end; the writer can then
 *   only be freed
 */
gchar *
cloth_json_writer_finish (ClothJsonWriter * writer)
{
  g_return_val_if_fail (writer->text && writer->depth == 0, NULL);

  g_string_append_c (writer->text, '\n');
  return g_string_free (g_steal_pointer (&writer->text), FALSE);
}

/* @writer: (transfer full) (nullable): a writer
 */
void
cloth_json_writer_free (ClothJsonWriter * writer)
{
  if (!writer)
    return;
  if (writer->text)
    g_string_free (writer->text, TRUE);
  g_free (writer);
}
