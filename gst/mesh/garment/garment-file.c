/* garment.json and garment.obj.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/garment/garment.h"

#include <math.h>
#include <string.h>

#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"
#include "gst/mesh/formats/formats.h"

/* Limits on untrusted input. */
#define MOST_PANELS 64
#define MOST_SEAMS 1024
#define MOST_DOTS 65536

static const ClothJsonFile garment_json = { "garment.json",
  cloth_file_error_quark, CLOTH_FILE_ERROR_INVALID
};

/* A whole number from @least to @most. */
static gboolean
read_index (JsonNode * node, gint least, guint most, gint * value)
{
  gdouble number;

  if (!cloth_json_number (node, &number) || number != floor (number)
      || number < least || number > most)
    return FALSE;
  *value = (gint) number;
  return TRUE;
}

static gboolean
parse_panels (JsonObject * root, ClothGarment * garment, GError ** error)
{
  static const gchar *const keys[] = { "name", "first", "vertices", "border",
    NULL
  };
  guint n = garment->topology->n_vertices;
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&garment_json, root, "panels",
      MOST_PANELS, &bad, error);

  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object = cloth_json_item_object (&garment_json, list, i,
        "panels", error);
    ClothPanel *panel;

    g_array_set_size (garment->panels, i + 1);
    panel = &g_array_index (garment->panels, ClothPanel, i);
    if (!object
        || !cloth_json_check_keys (&garment_json, object, "“panels”", keys,
            error)
        || !cloth_json_get_string (&garment_json, object, "name", &panel->name,
            error)
        || !cloth_json_get_count (&garment_json, object, "first", 0, n - 1,
            &panel->first, error)
        || !cloth_json_get_count (&garment_json, object, "vertices", 0,
            n - panel->first, &panel->n_vertices, error)
        || !cloth_json_get_count (&garment_json, object, "border", 0,
            panel->n_vertices, &panel->n_border, error))
      return FALSE;
    if (!panel->name)
      panel->name = g_strdup ("");
  }
  return !bad;
}

static gboolean
parse_dots (JsonObject * root, ClothGarment * garment, GError ** error)
{
  guint n = garment->topology->n_vertices;
  guint most = garment->columns * garment->rows;
  g_autofree guint8 *taken = g_malloc0 (most);
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&garment_json, root, "dots", n, &bad,
      error);

  if (bad)
    return FALSE;
  if (!list || json_array_get_length (list) != n)
    return cloth_json_invalid (&garment_json, error,
        "“dots” must have a number for each of the %u vertices of the mesh",
        n);
  garment->dots = g_new (gint, n);
  for (guint v = 0; v < n; v++) {
    gint dot;

    if (!read_index (json_array_get_element (list, v), CLOTH_NO_DOT, most - 1,
            &dot))
      return cloth_json_invalid (&garment_json, error,
          "the dot of vertex %u is no whole number from -1 to %u", v, most - 1);
    if (dot != CLOTH_NO_DOT && taken[dot]++)
      return cloth_json_invalid (&garment_json, error,
          "dot %d is two vertices", dot);
    garment->dots[v] = dot;
  }
  return TRUE;
}

static gboolean
parse_seam (JsonObject * object, guint i, ClothGarment * garment,
    GError ** error)
{
  static const gchar *const keys[] = { "name", "lines", NULL };
  guint n = garment->topology->n_vertices;
  ClothSeamLine *line;
  JsonArray *lines;
  gchar *name = NULL;
  gboolean bad;

  if (!object || !cloth_json_check_keys (&garment_json, object, "“seams”",
          keys, error)
      || !cloth_json_get_string (&garment_json, object, "name", &name, error))
    return FALSE;
  g_ptr_array_add (garment->seam_names, name ? name : g_strdup (""));
  g_array_set_size (garment->seams, i + 1);
  line = &g_array_index (garment->seams, ClothSeamLine, i);
  lines = cloth_json_get_list (&garment_json, object, "lines", 2, &bad, error);
  if (bad)
    return FALSE;
  for (guint side = 0; side < 2; side++) {
    JsonNode *node = lines && json_array_get_length (lines) == 2
        ? json_array_get_element (lines, side) : NULL;
    JsonArray *array = node && JSON_NODE_HOLDS_ARRAY (node)
        ? json_node_get_array (node) : NULL;
    guint length = array ? json_array_get_length (array) : 0;

    if (length < 2 || (side == 1 && length != line->n_vertices))
      return cloth_json_invalid (&garment_json, error, "seam %u needs "
          "“lines”, two lists of as many vertices, two at least", i);
    line->n_vertices = length;
    line->lines[side] = g_new (guint, length);
    for (guint k = 0; k < length; k++) {
      gint vertex;

      if (!read_index (json_array_get_element (array, k), 0, n - 1, &vertex))
        return cloth_json_invalid (&garment_json, error, "a vertex of seam %u "
            "is not in the mesh (there are %u)", i, n);
      line->lines[side][k] = (guint) vertex;
    }
  }
  return TRUE;
}

static gboolean
parse_root (JsonObject * root, ClothGarment * garment, GError ** error)
{
  static const gchar *const keys[] = { "version", "mesh", "columns", "rows",
    "panels", "dots", "seams", NULL
  };
  guint version = 0;
  gboolean bad;
  JsonArray *seams;

  if (!cloth_json_check_keys (&garment_json, root, "garment.json", keys, error)
      || !cloth_json_get_count (&garment_json, root, "version", 0, G_MAXINT,
          &version, error)
      || !cloth_json_get_count (&garment_json, root, "columns", 1, MOST_DOTS,
          &garment->columns, error)
      || !cloth_json_get_count (&garment_json, root, "rows", 1, MOST_DOTS,
          &garment->rows, error))
    return FALSE;
  if (version != 1) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
        "garment.json: version %u is not read, only 1", version);
    return FALSE;
  }
  if (garment->columns == 0 || garment->rows == 0
      || (guint64) garment->columns * garment->rows > CLOTH_MAX_VERTICES)
    return cloth_json_invalid (&garment_json, error,
        "give “columns” and “rows”, the dots of the print");
  if (!parse_panels (root, garment, error) || !parse_dots (root, garment,
          error))
    return FALSE;
  seams = cloth_json_get_list (&garment_json, root, "seams", MOST_SEAMS, &bad,
      error);
  for (guint i = 0; seams && i < json_array_get_length (seams); i++)
    if (!parse_seam (cloth_json_item_object (&garment_json, seams, i, "seams",
                error), i, garment, error))
      return FALSE;
  return !bad;
}

/* @json: the text of garment.json
 * @size: its bytes
 * @topology: (transfer full): the mesh that it speaks of, checked
 * @error: #ClothFileError
 *
 * Returns: (transfer full): the garment, or %NULL
 */
ClothGarment *
cloth_garment_parse (const gchar * json, gsize size, ClothTopology * topology,
    GError ** error)
{
  g_autoptr (ClothGarment) garment = cloth_garment_new ();
  g_autoptr (GError) fault = NULL;
  g_autoptr (JsonParser) parser = cloth_json_parse (json, size, &fault);

  garment->topology = topology;
  if (!parser) {
    cloth_json_invalid (&garment_json, error, "%s", fault->message);
    return NULL;
  }
  if (!parse_root (json_node_get_object (json_parser_get_root (parser)),
          garment, error))
    return NULL;
  return g_steal_pointer (&garment);
}

/* @path: a garment.json with its garment.obj beside it
 * @error: #ClothFileError, #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full): the garment, or %NULL
 */
ClothGarment *
cloth_garment_load (const gchar * path, GError ** error)
{
  gsize size;
  ClothPlaced placed;
  g_autofree gchar *json =
      cloth_parts_begin_reading (path, &placed, error) ?
      cloth_text_file_load (path, &size, error) : NULL;
  g_autofree gchar *folder = g_path_get_dirname (path);
  g_autofree gchar *mesh = NULL;
  g_autoptr (ClothObj) obj = NULL;

  if (!json)
    return NULL;
  mesh = cloth_path_inside (folder, "garment.obj", error);
  obj = mesh ? cloth_obj_read (mesh, error) : NULL;
  if (!obj || !cloth_parts_end_reading (path, &placed, error) ||
      !cloth_topology_check (obj->topology, error))
    return NULL;
  return cloth_garment_parse (json, size, g_steal_pointer (&obj->topology),
      error);
}

static void
write_lines (ClothJsonWriter * writer, const ClothGarment * garment)
{
  cloth_json_writer_begin_array (writer, "seams");
  for (guint s = 0; s < garment->seams->len; s++) {
    const ClothSeamLine *line = &g_array_index (garment->seams, ClothSeamLine,
        s);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name",
        g_ptr_array_index (garment->seam_names, s));
    cloth_json_writer_begin_array (writer, "lines");
    for (guint side = 0; side < 2; side++) {
      cloth_json_writer_begin_array (writer, NULL);
      for (guint i = 0; i < line->n_vertices; i++)
        cloth_json_writer_count (writer, NULL, line->lines[side][i]);
      cloth_json_writer_end_array (writer);
    }
    cloth_json_writer_end_array (writer);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

/* @garment: a garment
 *
 * Returns: (transfer full): the text of garment.json (docs/formats.md)
 */
gchar *
cloth_garment_to_json (const ClothGarment * garment)
{
  ClothJsonWriter *writer = cloth_json_writer_new ();
  gchar *text;

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_count (writer, "version", 1);
  cloth_json_writer_string (writer, "mesh", "garment.obj");
  cloth_json_writer_count (writer, "columns", garment->columns);
  cloth_json_writer_count (writer, "rows", garment->rows);
  cloth_json_writer_begin_array (writer, "panels");
  for (guint p = 0; p < garment->panels->len; p++) {
    const ClothPanel *panel = &g_array_index (garment->panels, ClothPanel, p);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", panel->name);
    cloth_json_writer_count (writer, "first", panel->first);
    cloth_json_writer_count (writer, "vertices", panel->n_vertices);
    cloth_json_writer_count (writer, "border", panel->n_border);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_begin_array (writer, "dots");
  for (guint v = 0; v < garment->topology->n_vertices; v++)
    cloth_json_writer_number (writer, NULL, garment->dots[v]);
  cloth_json_writer_end_array (writer);
  write_lines (writer, garment);
  cloth_json_writer_end_object (writer);
  text = cloth_json_writer_finish (writer);
  cloth_json_writer_free (writer);
  return text;
}

/* @garment: a garment
 * @folder: a folder, which is there
 * @error: #ClothFileError or #GIOErrorEnum
 *
 * Writes garment.json and garment.obj, the panels flat as they lie on the cloth: x = u,
 * z = −v, uv in metres.
 *
 * Returns: %FALSE when they can't be written; then neither is there
 */
gboolean
cloth_garment_save (const ClothGarment * garment, const gchar * folder,
    GError ** error)
{
  const ClothTopology *topology = garment->topology;
  g_autofree gchar *head = g_build_filename (folder, "garment.json", NULL);
  g_autofree gchar *text = cloth_garment_to_json (garment);
  g_autofree gfloat *positions =
      g_new0 (gfloat, 3 * (gsize) topology->n_vertices);
  g_autoptr (ClothParts) parts = cloth_parts_new (head, "", error);
  g_autoptr (ClothOutput) json = NULL;
  g_autoptr (ClothOutput) obj = NULL;

  json = parts ? cloth_parts_open (parts, "garment.json", error) : NULL;
  obj = json ? cloth_parts_open (parts, "garment.obj", error) : NULL;
  if (!obj)
    return FALSE;
  for (guint v = 0; v < topology->n_vertices; v++) {
    positions[3 * v] = topology->uv[2 * v];
    positions[3 * v + 2] = -topology->uv[2 * v + 1];
  }
  return cloth_output_write (json, text, strlen (text), error)
      && cloth_obj_write (obj, "garment", topology, positions, 0, 1, error)
      && cloth_output_commit (json, error) && cloth_output_commit (obj, error)
      && cloth_parts_commit (parts, error);
}
