/* clothcamera's free view: without a rig, from a side that properties choose.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstclothcamera.h"

#define DEFAULT_AZIMUTH 0
#define DEFAULT_ELEVATION 15
#define DEFAULT_DISTANCE 0
#define DEFAULT_WIDTH 1280
#define DEFAULT_HEIGHT 720

static const struct
{
  const gchar *name, *blurb;
  gdouble least, most, value;
} settings[GST_CLOTH_CAMERA_VIEW_SETTINGS] = {
  {"azimuth",
      "Free view: side from which the cloth is seen, degrees counter-clockwise "
        "from above; 0: from −y, 90: from +x", -3600, 3600, DEFAULT_AZIMUTH},
  {"elevation",
        "Free view: height from which the cloth is seen, degrees above the horizon",
      -90, 90, DEFAULT_ELEVATION},
  {"distance",
      "Free view: distance from the middle of the first mesh, m; 0: so far that "
        "all of that mesh is seen from any side", 0, 1000, DEFAULT_DISTANCE}
};

void
gst_cloth_camera_view_init (GstClothCameraView * view)
{
  view->framed = FALSE;
  for (guint i = 0; i < GST_CLOTH_CAMERA_VIEW_SETTINGS; i++)
    view->settings[i] = settings[i].value;
  cloth_orbit_init (&view->orbit);
}

/* The properties, from @id on. */
void
gst_cloth_camera_view_install (GObjectClass * klass, guint id)
{
  for (guint i = 0; i < GST_CLOTH_CAMERA_VIEW_SETTINGS; i++)
    g_object_class_install_property (klass, id + i,
        g_param_spec_double (settings[i].name, settings[i].name,
            settings[i].blurb, settings[i].least, settings[i].most,
            settings[i].value, G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
            GST_PARAM_CONTROLLABLE | GST_PARAM_MUTABLE_PLAYING));
}

/* About where the cloth was when it was first seen, from where the settings say. */
void
gst_cloth_camera_view_aim (GstClothCameraView * view, guint n_vertices,
    const gdouble * positions, gint width, gint height, ClothCamera * camera)
{
  if (!view->framed)
    view->framed = cloth_orbit_frame (&view->orbit, n_vertices, positions);
  view->orbit.azimuth = view->settings[0];
  view->orbit.elevation = view->settings[1];
  view->orbit.distance = view->settings[2];
  cloth_orbit_camera (&view->orbit, width, height, camera);
}

/* Pictures of any size. */
GstCaps *
gst_cloth_camera_view_fixate (GstCaps * caps)
{
  GstStructure *structure;

  caps = gst_caps_make_writable (gst_caps_truncate (caps));
  structure = gst_caps_get_structure (caps, 0);
  gst_structure_fixate_field_nearest_int (structure, "width", DEFAULT_WIDTH);
  gst_structure_fixate_field_nearest_int (structure, "height", DEFAULT_HEIGHT);
  return caps;
}
