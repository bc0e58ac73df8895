/* The reference clocks that observations may name.
 *
 * GStreamer keeps the name of every caps and of every field that it has ever parsed until the
 * process ends, so a stranger's text never reaches its parser: only the names of this table
 * do, as constants.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <string.h>

#include "gst/cloth/gstclothclock.h"

#define MAX_FIELDS 2

/* One field of a clock's caps: a string, or an integer from @least to @most. */
typedef struct
{
  const gchar *name;
  GType type;
  gint least, most;
} Field;

typedef struct
{
  const gchar *name;
  Field fields[MAX_FIELDS];
} Clock;

/* Those that GStreamer 1.22 to 1.26 and its own plugins put on pictures; docs/streams.md says
 * which of them. */
static const Clock clocks[] = {
  {"timestamp/x-ntp", {{"host", G_TYPE_STRING, 0, 0},
          {"port", G_TYPE_INT, 1, 65535}}},
  {"timestamp/x-ptp", {{"version", G_TYPE_STRING, 0, 0},
          {"domain", G_TYPE_INT, 0, 255}}},
  {"timestamp/x-unix", {{NULL, 0, 0, 0}}},
  {"timestamp/x-decklink-stream", {{NULL, 0, 0, 0}}},
  {"timestamp/x-decklink-hardware", {{NULL, 0, 0, 0}}},
  {"timestamp/x-aja-stream", {{NULL, 0, 0, 0}}},
  {"timestamp/x-ndi-timecode", {{NULL, 0, 0, 0}}},
  {"timestamp/x-ndi-timestamp", {{NULL, 0, 0, 0}}},
};

/* What is left of a text. */
typedef struct
{
  const gchar *at, *end;
} Rest;

static gboolean
take (Rest * rest, const gchar * text)
{
  const gsize n = strlen (text);

  if ((gsize) (rest->end - rest->at) < n || memcmp (rest->at, text, n) != 0)
    return FALSE;
  rest->at += n;
  return TRUE;
}

/* What runs to the next comma or to the end: at least one of the characters that need no
 * quotes in caps. */
static gboolean
take_value (Rest * rest, const gchar ** value, gsize * length)
{
  *value = rest->at;
  while (rest->at < rest->end && (g_ascii_isalnum (*rest->at)
          || (*rest->at && strchr ("_-+/.:", *rest->at))))
    rest->at++;
  *length = (gsize) (rest->at - *value);
  return *length > 0;
}

/* Digits without a sign or a needless zero, as caps are written. */
static gboolean
parse_integer (const gchar * text, gsize length, const Field * field,
    gint * value)
{
  gint sum = 0;

  if (length > 5 || (length > 1 && text[0] == '0'))
    return FALSE;
  for (gsize i = 0; i < length; i++) {
    if (!g_ascii_isdigit (text[i]))
      return FALSE;
    sum = 10 * sum + (text[i] - '0');
  }
  *value = sum;
  return sum >= field->least && sum <= field->most;
}

static gboolean
take_field (Rest * rest, const Field * field, GstStructure * structure)
{
  const gboolean is_string = field->type == G_TYPE_STRING;
  const gchar *text;
  gsize length;
  gint number;

  if (!take (rest, field->name)
      || !take (rest, is_string ? "=(string)" : "=(int)")
      || !take_value (rest, &text, &length))
    return FALSE;
  if (is_string) {
    g_autofree gchar *value = g_strndup (text, length);

    gst_structure_set (structure, field->name, G_TYPE_STRING, value, NULL);
    return TRUE;
  }
  if (!parse_integer (text, length, field, &number))
    return FALSE;
  gst_structure_set (structure, field->name, G_TYPE_INT, number, NULL);
  return TRUE;
}

/* Any of the clock's fields that @structure hasn't yet. */
static gboolean
take_some_field (Rest * rest, const Clock * clock, GstStructure * structure)
{
  for (guint i = 0; i < MAX_FIELDS && clock->fields[i].name; i++) {
    const Rest before = *rest;

    if (!gst_structure_has_field (structure, clock->fields[i].name)
        && take_field (rest, &clock->fields[i], structure))
      return TRUE;
    *rest = before;
  }
  return FALSE;
}

/* @text: caps as gst_caps_to_string() writes them; any bytes
 * @length: of @text
 *
 * Returns: (transfer full) (nullable): the caps of a clock of the table, with some of its
 *   fields in any order; %NULL when @text names no such clock
 */
GstCaps *
gst_cloth_clock_from_text (const gchar * text, gsize length)
{
  for (guint i = 0; i < G_N_ELEMENTS (clocks); i++) {
    Rest rest = { text, text + length };
    g_autoptr (GstCaps) caps = NULL;
    GstStructure *structure;

    if (!take (&rest, clocks[i].name)
        || (rest.at < rest.end && *rest.at != ','))
      continue;
    caps = gst_caps_new_empty_simple (clocks[i].name);
    structure = gst_caps_get_structure (caps, 0);
    while (rest.at < rest.end)
      if (!take (&rest, ", ") || !take_some_field (&rest, &clocks[i],
              structure))
        return NULL;
    return g_steal_pointer (&caps);
  }
  return NULL;
}
