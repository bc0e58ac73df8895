/* Sink pads of triangulate: each has a camera.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulatepad.h"

struct _GstTriangulatePad
{
  GstClothSyncPad parent;

  gchar *camera;                /* object lock of the pad */
};

G_DEFINE_TYPE (GstTriangulatePad, gst_triangulate_pad, GST_TYPE_CLOTH_SYNC_PAD);

enum
{
  PROP_PAD_0,
  PROP_PAD_CAMERA
};

static void
gst_triangulate_pad_set_property (GObject * object, guint id,
    const GValue * value, GParamSpec * pspec)
{
  GstTriangulatePad *self = GST_TRIANGULATE_PAD (object);

  switch (id) {
    case PROP_PAD_CAMERA:
      GST_OBJECT_LOCK (self);
      g_free (self->camera);
      self->camera = g_value_dup_string (value);
      GST_OBJECT_UNLOCK (self);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
      break;
  }
}

static void
gst_triangulate_pad_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * pspec)
{
  GstTriangulatePad *self = GST_TRIANGULATE_PAD (object);

  switch (id) {
    case PROP_PAD_CAMERA:
      GST_OBJECT_LOCK (self);
      g_value_set_string (value, self->camera);
      GST_OBJECT_UNLOCK (self);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
      break;
  }
}

static void
gst_triangulate_pad_finalize (GObject * object)
{
  g_free (GST_TRIANGULATE_PAD (object)->camera);
  G_OBJECT_CLASS (gst_triangulate_pad_parent_class)->finalize (object);
}

static void
gst_triangulate_pad_class_init (GstTriangulatePadClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);

  object_class->set_property = gst_triangulate_pad_set_property;
  object_class->get_property = gst_triangulate_pad_get_property;
  object_class->finalize = gst_triangulate_pad_finalize;

  /**
   * GstTriangulatePad:camera:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_PAD_CAMERA,
      g_param_spec_string ("camera", "Camera",
          "Name of the pad's camera in rig; by default the one that the metadata "
          "names, else the camera at the pad's place in the order of pads",
          NULL,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_PLAYING));
}

static void
gst_triangulate_pad_init (GstTriangulatePad * pad)
{
}

void
gst_triangulate_pad_update_camera (GstTriangulatePad * pad, gchar ** camera)
{
  GST_OBJECT_LOCK (pad);
  if (g_strcmp0 (*camera, pad->camera) != 0) {
    g_free (*camera);
    *camera = g_strdup (pad->camera);
  }
  GST_OBJECT_UNLOCK (pad);
}

static GObject *
gst_triangulate_get_child_by_index (GstChildProxy * proxy, guint index)
{
  GObject *child;

  GST_OBJECT_LOCK (proxy);
  child = g_list_nth_data (GST_ELEMENT (proxy)->sinkpads, index);
  if (child) {
    gst_object_ref (child);
  }
  GST_OBJECT_UNLOCK (proxy);
  return child;
}

static guint
gst_triangulate_get_children_count (GstChildProxy * proxy)
{
  guint count;

  GST_OBJECT_LOCK (proxy);
  count = GST_ELEMENT (proxy)->numsinkpads;
  GST_OBJECT_UNLOCK (proxy);
  return count;
}

void
gst_triangulate_pad_child_proxy_init (gpointer iface, gpointer data)
{
  GstChildProxyInterface *proxy = iface;

  proxy->get_child_by_index = gst_triangulate_get_child_by_index;
  proxy->get_children_count = gst_triangulate_get_children_count;
}
