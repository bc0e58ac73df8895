/* What reading a pattern.json begins with.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/patternjson.h"

#include "gst/pattern/pattern.h"

const ClothJsonFile cloth_pattern_json =
    { "pattern.json", cloth_pattern_error_quark, CLOTH_PATTERN_ERROR_FORMAT };

/* @kind: that it has to be of
 * @data: (array length=size): the text of a pattern.json, not ended by 0
 * @size: its bytes
 * @object: (out) (transfer none): what it holds, as long as the parser is there
 * @error: return location
 *
 * Returns: (transfer full): the parser of a file of version 1 and this kind, without other keys;
 *   %NULL with a #ClothPatternError
 */
JsonParser *
cloth_pattern_json_open (const ClothPatternKind * kind, const gchar * data,
    gsize size, JsonObject ** object, GError ** error)
{
  g_autoptr (GError) fault = NULL;
  g_autoptr (JsonParser) parser = cloth_json_parse (data, size, &fault);
  g_autofree gchar *found = NULL;
  gdouble version = 1;

  if (!parser) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_FORMAT,
        "no pattern.json: %s", fault->message);
    return NULL;
  }
  *object = json_node_get_object (json_parser_get_root (parser));
  if (!cloth_json_get_number (&cloth_pattern_json, *object, "version", 0, 1e9,
          &version, error)
      || !cloth_json_get_string (&cloth_pattern_json, *object, "pattern",
          &found, error))
    return NULL;
  if (version != 1) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_UNSUPPORTED,
        "version %g of pattern.json: this build reads version 1", version);
    return NULL;
  }
  if (g_strcmp0 (found, kind->kind)) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_UNSUPPORTED,
        "a pattern of kind \"%.40s\": %s read from one of kind \"%s\"",
        found ? found : "", kind->are, kind->kind);
    return NULL;
  }
  if (!cloth_json_check_keys (&cloth_pattern_json, *object, kind->name,
          kind->keys, error))
    return NULL;
  return g_steal_pointer (&parser);
}
