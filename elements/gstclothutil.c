/* What several elements do alike: caps, times, the camera of a rig, what comes as a mesh
 * stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothutil.h"

#include "gst/rig/rigfile.h"

/* What of @caps (taken) the asker of a caps query wants, in the asker's order. */
GstCaps *
gst_cloth_filter_caps (GstCaps * caps, GstCaps * filter)
{
  GstCaps *both;

  if (!filter)
    return caps;
  both = gst_caps_intersect_full (filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref (caps);
  return both;
}

/* Caps of the one pad from those of the other, where the pads are of different media: for
 * each of @caps the structure of @other (taken) with the @fields of it, as far as it has
 * them. */
GstCaps *
gst_cloth_carry_caps (const GstCaps * caps, const gchar * const *fields,
    GstCaps * other, GstCaps * filter)
{
  GstCaps *result = gst_caps_new_empty ();

  for (guint i = 0; i < gst_caps_get_size (caps); i++) {
    const GstStructure *from = gst_caps_get_structure (caps, i);
    GstStructure *to = gst_structure_copy (gst_caps_get_structure (other, 0));

    for (guint k = 0; fields[k]; k++)
      if (gst_structure_has_field (from, fields[k]))
        gst_structure_set_value (to, fields[k], gst_structure_get_value (from,
                fields[k]));
    gst_caps_append_structure_full (result, to,
        gst_caps_features_copy (gst_caps_get_features (other, 0)));
  }
  gst_caps_unref (other);
  return gst_cloth_filter_caps (result, filter);
}

/* NONE when the buffer has no time, or the stream doesn't count in time, as that of an appsrc
 * left at its default. */
GstClockTime
gst_cloth_stream_time (const GstSegment * segment, GstBuffer * buffer)
{
  if (segment->format != GST_FORMAT_TIME || !GST_BUFFER_PTS_IS_VALID (buffer))
    return GST_CLOCK_TIME_NONE;
  return gst_segment_to_stream_time (segment, GST_FORMAT_TIME,
      GST_BUFFER_PTS (buffer));
}

/* Numbers pictures alike in all cameras: by the buffer's own number, else by its time, else by
 * @count, how many came before. */
guint64
gst_cloth_number_picture (const GstSegment * segment, gint fps_n, gint fps_d,
    GstBuffer * buffer, guint64 count)
{
  const GstClockTime time = gst_cloth_stream_time (segment, buffer);

  if (GST_BUFFER_OFFSET_IS_VALID (buffer))
    return GST_BUFFER_OFFSET (buffer);
  if (fps_n <= 0 || fps_d <= 0 || !GST_CLOCK_TIME_IS_VALID (time))
    return count;
  return gst_util_uint64_scale_round (time, (guint64) fps_n,
      (guint64) fps_d * GST_SECOND);
}

/* To what upstream has answered to a latency query. */
void
gst_cloth_add_latency (GstQuery * query, GstClockTime own)
{
  GstClockTime least, most;
  gboolean live;

  gst_query_parse_latency (query, &live, &least, &most);
  gst_query_set_latency (query, live, least + own,
      GST_CLOCK_TIME_IS_VALID (most) ? most + own : most);
}

/* The rig of the file @path (nullable) and in it the camera @name, which may be NULL when
 * there is one camera. NULL when an error was posted. */
ClothRig *
gst_cloth_open_rig (GstElement * element, const gchar * path,
    const gchar * name, const ClothCamera ** camera)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = NULL;
  g_autoptr (GString) names = NULL;

  if (!path) {
    GST_ELEMENT_ERROR (element, RESOURCE, SETTINGS,
        ("No rig to take a camera from."),
        ("Set rig= to a rig.json and camera= to the name of the camera there."));
    return NULL;
  }
  rig = cloth_rig_load (path, &error);
  if (!rig) {
    GST_ELEMENT_ERROR (element, RESOURCE, OPEN_READ,
        ("Can't read the rig: %s", error->message), ("rig=%s", path));
    return NULL;
  }
  if (name)
    *camera = cloth_rig_find (rig, name);
  else
    *camera = rig->n_cameras == 1 ? &rig->cameras[0] : NULL;
  if (*camera)
    return g_steal_pointer (&rig);
  names = g_string_new (NULL);
  for (guint i = 0; i < rig->n_cameras; i++)
    g_string_append_printf (names, "%s%s", i ? ", " : "",
        rig->cameras[i].name ? rig->cameras[i].name : "(unnamed)");
  GST_ELEMENT_ERROR (element, RESOURCE, SETTINGS,
      ("%s has no camera “%s”.", path, name ? name : ""),
      ("Set camera= to one of: %s", names->str));
  return NULL;
}

/* The topology of a mesh stream's caps; NULL when an error was posted. */
GstClothTopology *
gst_cloth_read_topology (GstElement * element, const GstCaps * caps)
{
  g_autoptr (GError) error = NULL;
  GstClothTopology *topology = gst_cloth_topology_from_caps (caps, &error);

  if (!topology)
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("The caps hold no valid mesh: %s", error->message),
        ("%" GST_PTR_FORMAT, caps));
  return topology;
}

/* A frame of a mesh stream of @n_vertices. */
GstClothMesh *
gst_cloth_parse_mesh (GstBuffer * buffer, guint n_vertices, GError ** error)
{
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, error);

  if (!mesh)
    return NULL;
  if (gst_cloth_mesh_get_n_vertices (mesh) != n_vertices) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "A mesh of %u vertices in a stream of %u",
        gst_cloth_mesh_get_n_vertices (mesh), n_vertices);
    return NULL;
  }
  return g_steal_pointer (&mesh);
}

/* The same for what ends at a damaged frame; NULL when an error was posted. */
GstClothMesh *
gst_cloth_read_mesh (GstElement * element, GstBuffer * buffer, guint n_vertices)
{
  g_autoptr (GError) error = NULL;
  GstClothMesh *mesh = gst_cloth_parse_mesh (buffer, n_vertices, &error);

  if (!mesh)
    GST_ELEMENT_ERROR (element, STREAM, DECODE,
        ("A buffer holds no valid mesh: %s", error->message),
        ("See what makes these meshes, and what lies between it and this "
            "element."));
  return mesh;
}
