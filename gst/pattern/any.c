/* A pattern.json of whichever kind.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/any.h"

#include <string.h>

#include "gst/pattern/patternjson.h"

/* What the file says that it is of; %NULL where it doesn't. */
static gchar *
find_kind (const gchar * path, GError ** error)
{
  g_autoptr (GError) fault = NULL;
  g_autoptr (JsonParser) parser = NULL;
  g_autofree gchar *data = NULL;
  gchar *kind = NULL;
  JsonObject *object;
  gsize size;

  if (!(data = cloth_text_file_load (path, &size, error)))
    return NULL;
  if (!(parser = cloth_json_parse (data, size, &fault))) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_FORMAT,
        "%s: no pattern.json: %s", path, fault->message);
    return NULL;
  }
  object = json_node_get_object (json_parser_get_root (parser));
  if (!cloth_json_get_string (&cloth_pattern_json, object, "pattern", &kind,
          error))
    g_prefix_error (error, "%s: ", path);
  else if (!kind)
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_FORMAT,
        "%s: no pattern.json: it has no “pattern”, the name of a kind: "
        "\"checker\", \"m-array\" or \"picture\"", path);
  return kind;
}

/* @path: (type filename): a pattern.json
 * @error: return location
 *
 * Reads a pattern of the kind that the file names. The error's message begins with @path.
 *
 * Returns: (transfer full): the pattern; free with cloth_any_pattern_free(). %NULL with a
 *   #ClothPatternError or what the kind's own loader says
 */
ClothAnyPattern *
cloth_any_pattern_load (const gchar * path, GError ** error)
{
  g_autoptr (ClothAnyPattern) pattern = g_new0 (ClothAnyPattern, 1);
  g_autofree gchar *kind = find_kind (path, error);

  if (!kind)
    return NULL;
  if (!strcmp (kind, "checker"))
    pattern->checker = cloth_pattern_load (path, error);
  else if (!strcmp (kind, "m-array"))
    pattern->dots = cloth_m_array_load (path, error);
  else if (!strcmp (kind, "picture"))
    pattern->picture = cloth_picture_pattern_load (path, error);
  else
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_UNSUPPORTED,
        "%s: a pattern of kind \"%.40s\": this build reads \"checker\", "
        "\"m-array\" and \"picture\"", path, kind);
  if (!pattern->checker && !pattern->dots && !pattern->picture)
    return NULL;
  return g_steal_pointer (&pattern);
}

/* @pattern: (nullable) (transfer full): a pattern
 */
void
cloth_any_pattern_free (ClothAnyPattern * pattern)
{
  if (!pattern)
    return;
  cloth_pattern_free (pattern->checker);
  cloth_m_array_free (pattern->dots);
  cloth_picture_pattern_free (pattern->picture);
  g_free (pattern);
}
