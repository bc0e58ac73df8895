/* What meshsink and meshsrc share: the formats and how a file's error is told.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstmeshformat.h"

#include <gio/gio.h>
#include <gst/cloth/cloth.h>
#include <string.h>

G_STATIC_ASSERT ((int) CLOTH_VERTEX_PREDICTED ==
    (int) GST_CLOTH_VERTEX_PREDICTED);
G_STATIC_ASSERT (CLOTH_NO_VERTEX == GST_CLOTH_NO_VERTEX);

const GEnumValue gst_mesh_format_values[] = {
  {CLOTH_MESH_FORMAT_AUTO, "What the location's ending says, else OBJ + PC2",
      "auto"},
  {CLOTH_MESH_FORMAT_OBJ_PC2, "OBJ mesh with a PC2 point cache", "obj-pc2"},
  {CLOTH_MESH_FORMAT_PLY, "One PLY file a frame", "ply"},
  {CLOTH_MESH_FORMAT_TAKE, "Folder of a take", "take"},
  {CLOTH_MESH_FORMAT_GLTF, "glTF 2.0 (.glb), for short clips; written only",
      "gltf"},
  {CLOTH_MESH_FORMAT_USD, "USD as text (.usda); written only", "usd"},
  {CLOTH_MESH_FORMAT_VTP, "VTK PolyData (.pvd and .vtp); written only",
      "vtp"},
  {CLOTH_MESH_FORMAT_C3D, "C3D, vertices as markers; written only", "c3d"},
  {CLOTH_MESH_FORMAT_CSV, "Table as text (.csv); written only", "csv"},
  {0, NULL, NULL}
};

/* Whether @message names the file, or one in the folder, itself. */
static gboolean
says_where (const gchar * message, const gchar * location)
{
  g_autofree gchar *file = g_strdup_printf ("“%s”", location);
  g_autofree gchar *inside = g_strdup_printf ("“%s/", location);
  g_autofree gchar *first = g_strdup_printf ("%s:", location);

  return strstr (message, file) || strstr (message, inside)
      || g_str_has_prefix (message, first);
}

/* What to do about an error. */
static const gchar *
find_remedy (const GError * error, gboolean writing)
{
  if (error->domain == CLOTH_FILE_ERROR)
    return writing ? "Change location or format, or what is sent here." :
        "See that location is a file or folder that meshsink wrote, or an OBJ, "
        "PC2 or PLY file that keeps to its format.";
  if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
    return writing ? "Make the folder first, or change location." :
        "See that location is spelled as the file is, and from which folder the "
        "program was started.";
  if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_NO_SPACE))
    return "Make room, or record to another disk.";
  if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_PERMISSION_DENIED))
    return writing ? "Choose a folder that you may write to." :
        "Choose a file that you may read.";
  return "See whether the disk works, or choose another location.";
}

/* The system's failures are of the resource, wrong contents of the stream. */
void
gst_mesh_post_error (GstElement * element, const gchar * doing,
    const gchar * location, gboolean writing, const GError * error)
{
  GQuark domain = GST_RESOURCE_ERROR;
  gint code = writing ? GST_RESOURCE_ERROR_WRITE : GST_RESOURCE_ERROR_READ;

  if (error->domain == CLOTH_FILE_ERROR) {
    domain = GST_STREAM_ERROR;
    code = GST_STREAM_ERROR_FORMAT;
  } else if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND)) {
    code = writing ? GST_RESOURCE_ERROR_OPEN_WRITE :
        GST_RESOURCE_ERROR_NOT_FOUND;
  } else if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_NO_SPACE)) {
    code = GST_RESOURCE_ERROR_NO_SPACE_LEFT;
  } else if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_PERMISSION_DENIED)) {
    code = GST_RESOURCE_ERROR_NOT_AUTHORIZED;
  }
  gst_element_message_full (element, GST_MESSAGE_ERROR, domain, code,
      says_where (error->message, location) ? g_strdup (error->message) :
      g_strdup_printf ("Cannot %s “%s”: %s", doing, location,
          error->message), g_strdup (find_remedy (error, writing)), __FILE__,
      GST_FUNCTION, __LINE__);
}

/* What the rooms work with, from what came with the caps. */
ClothTopology *
gst_mesh_copy_topology (const GstClothTopology * from)
{
  guint n_indices;
  const guint32 *faces = gst_cloth_topology_get_faces (from, &n_indices);
  guint n_vertices = gst_cloth_topology_get_n_vertices (from);
  ClothTopology *to = cloth_topology_new (n_vertices, n_indices / 4);

  to->columns = gst_cloth_topology_get_columns (from);
  to->rows = gst_cloth_topology_get_rows (from);
  memcpy (to->uv, gst_cloth_topology_get_uv (from, NULL),
      2 * sizeof (gfloat) * n_vertices);
  memcpy (to->faces, faces, sizeof (guint32) * n_indices);
  return to;
}
