/* garment.json and garment.obj.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/garment.h"

#include <string.h>

#include "gst/file/jsonwriter.h"
#include "gst/mesh/obj.h"

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

/**
 * cloth_garment_to_json:
 * @garment: a garment
 *
 * Returns: (transfer full): the text of garment.json (docs/formats.md)
 *
 * Since: 0.1
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

/**
 * cloth_garment_save:
 * @garment: a garment
 * @folder: a folder, which is there
 * @error: #ClothMeshError or #GIOErrorEnum
 *
 * Writes garment.json and garment.obj, the panels flat as they lie on the cloth: x = u,
 * z = −v, uv in metres.
 *
 * Returns: %FALSE when they can't be written; then neither is there
 *
 * Since: 0.1
 */
gboolean
cloth_garment_save (const ClothGarment * garment, const gchar * folder,
    GError ** error)
{
  const ClothTopology *topology = garment->topology;
  g_autofree gchar *json_path = g_build_filename (folder, "garment.json", NULL);
  g_autofree gchar *obj_path = g_build_filename (folder, "garment.obj", NULL);
  g_autofree gchar *text = cloth_garment_to_json (garment);
  g_autofree gfloat *positions =
      g_new0 (gfloat, 3 * (gsize) topology->n_vertices);
  g_autoptr (ClothOutput) json = cloth_output_new (json_path, error);
  g_autoptr (ClothOutput) obj = NULL;
  ClothOutput *outputs[2];

  if (!json)
    return FALSE;
  obj = cloth_output_new (obj_path, error);
  if (!obj)
    return FALSE;
  for (guint v = 0; v < topology->n_vertices; v++) {
    positions[3 * v] = topology->uv[2 * v];
    positions[3 * v + 2] = -topology->uv[2 * v + 1];
  }
  outputs[0] = json;
  outputs[1] = obj;
  return cloth_output_write (json, text, strlen (text), error)
      && cloth_obj_write (obj, "garment", topology, positions, 0, 1, error)
      && cloth_output_finish (json, error) && cloth_output_finish (obj, error)
      && cloth_output_commit (outputs, 2, error);
}
