/* Sink pads of triangulate, and which camera of the rig each belongs to.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulatepad.h"

#include <gst/cloth/cloth.h>

#include "elements/gstclothproperties.h"

/* What phones call 30 frames a second is off by so much. */
#define NEAR_RATE 0.01

struct _GstTriangulatePad
{
  GstClothSyncPad parent;

  gchar *camera;                /* object lock of the pad */
};

G_DEFINE_TYPE (GstTriangulatePad, gst_triangulate_pad, GST_TYPE_CLOTH_SYNC_PAD);

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"camera", "Camera",
    "Name of the pad's camera in rig; by default the one that the metadata "
    "names, else the camera at the pad's place in the order of pads",
    G_TYPE_STRING, GST_CLOTH_SETTING (GstTriangulatePad, camera),
    GST_PARAM_MUTABLE_PLAYING},
};
/* *INDENT-ON* */

static void
gst_triangulate_pad_finalize (GObject * object)
{
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties), object);
  G_OBJECT_CLASS (gst_triangulate_pad_parent_class)->finalize (object);
}

static void
gst_triangulate_pad_class_init (GstTriangulatePadClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  const GstTriangulatePad defaults = {.camera = NULL };

  object_class->finalize = gst_triangulate_pad_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults, 0);
}

static void
gst_triangulate_pad_init (GstTriangulatePad * pad)
{
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

/* ---- which camera each pad belongs to ---- */

GstPad *
gst_triangulate_pad_request_new (GstElement * element, GstPadTemplate * templ,
    const gchar * name, const GstCaps * caps)
{
  GstElementClass *parent =
      g_type_class_peek_parent (GST_ELEMENT_GET_CLASS (element));
  GstPad *pad = parent->request_new_pad (element, templ, name, caps);

  if (pad) {
    gst_child_proxy_child_added (GST_CHILD_PROXY (element), G_OBJECT (pad),
        GST_OBJECT_NAME (pad));
  }
  return pad;
}

void
gst_triangulate_pad_release (GstElement * element, GstPad * pad)
{
  GstElementClass *parent =
      g_type_class_peek_parent (GST_ELEMENT_GET_CLASS (element));

  gst_child_proxy_child_removed (GST_CHILD_PROXY (element), G_OBJECT (pad),
      GST_OBJECT_NAME (pad));
  parent->release_pad (element, pad);
}

void
gst_triangulate_view_forget (GstTriangulateView * view)
{
  GstClockTimeDiff offset = view->offset;       /* the base still has it */

  g_free (view->property);
  g_free (view->meta);
  memset (view, 0, sizeof (*view));
  view->camera = -1;
  view->offset = offset;
}

gboolean
gst_triangulate_view_set_caps (GstTriangulateView * view, GstElement * element,
    guint index, const GstCaps * caps)
{
  const GstStructure *s;

  gst_triangulate_view_forget (view);
  if (!caps) {
    return TRUE;
  }
  s = gst_caps_get_structure (caps, 0);
  view->observations =
      gst_structure_has_name (s, GST_CLOTH_OBSERVATIONS_MEDIA_TYPE);
  if (!gst_structure_get_int (s, "width", &view->width)
      || !gst_structure_get_int (s, "height", &view->height)) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("Caps on sink_%u do not give the size of the picture.", index),
        ("They are %" GST_PTR_FORMAT, caps));
    return FALSE;
  }
  if (!gst_structure_get_fraction (s, "framerate", &view->fps_n, &view->fps_d)) {
    view->fps_n = 0;
    view->fps_d = 1;
  }
  view->has_caps = TRUE;
  return TRUE;
}

/* Notes which pads there are and the cameras that their properties name. */
static guint
look_at_pads (GstClothSync * self, GstTriangulateView * views)
{
  guint i, n_pads = 0;
  GList *l;

  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    views[i].present = FALSE;
    views[i].camera = -1;
  }
  GST_OBJECT_LOCK (self);
  for (l = GST_ELEMENT (self)->sinkpads; l; l = l->next) {
    GstTriangulatePad *pad = GST_TRIANGULATE_PAD (l->data);
    GstTriangulateView *view = &views[GST_CLOTH_SYNC_PAD (pad)->index];

    view->present = TRUE;
    n_pads++;
    GST_OBJECT_LOCK (pad);
    if (g_strcmp0 (view->property, pad->camera) != 0) {
      g_free (view->property);
      view->property = g_strdup (pad->camera);
    }
    GST_OBJECT_UNLOCK (pad);
  }
  GST_OBJECT_UNLOCK (self);
  return n_pads;
}

/* What to do about pictures of another size than the camera's. */
static const gchar *
size_hint (const GstTriangulateView * view, const ClothCamera * camera)
{
  if (view->width == camera->height && view->height == camera->width) {
    return "Width and height are exchanged: the film is stored turned, as "
        "phones do. Put videoflip video-direction=auto before the detector.";
  }
  if ((gint64) view->width * camera->height ==
      (gint64) view->height * camera->width) {
    return "Film at the calibrated size, put videoscale after the detector, or "
        "calibrate at this size.";
  }
  return "Film at the calibrated size, or calibrate at this size; another part "
      "of the picture can't be scaled to it.";
}

gboolean
gst_triangulate_views_map (GstClothSync * self, GstTriangulateView * views,
    const ClothRig * rig, gboolean * moved)
{
  guint n_pads = look_at_pads (self, views);
  gint taken[CLOTH_RIG_MAX_CAMERAS];
  guint i, rank = 0;

  *moved = FALSE;
  for (i = 0; i < rig->n_cameras; i++) {
    taken[i] = -1;
  }
  if (n_pads > rig->n_cameras) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("There are %u sink pads but rig has %u cameras.", n_pads,
            rig->n_cameras),
        ("Link one pad a camera, or set rig to one with all of them."));
    return FALSE;
  }
  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    GstTriangulateView *view = &views[i];
    const gchar *name = view->property ? view->property : view->meta;
    const ClothCamera *camera;
    GstClockTimeDiff offset;

    if (!view->present) {
      continue;
    }
    if (name) {
      camera = cloth_rig_find (rig, name);
      if (!camera) {
        GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
            ("Pad sink_%u is of camera \"%s\", which rig does not have.", i,
                name),
            ("Set sink_%u::camera to a name in rig, the first of which is "
                "\"%s\".", i, rig->cameras[0].name));
        return FALSE;
      }
    } else if (n_pads != rig->n_cameras) {
      if (!view->carries) {
        continue;               /* nothing to place; its metadata may still say */
      }
      GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
          ("There are %u sink pads for %u cameras, so which is pad sink_%u's "
              "can't be told.", n_pads, rig->n_cameras, i),
          ("Set sink_%u::camera, or camera on the detector before it, to a name "
              "in rig.", i));
      return FALSE;
    } else {
      camera = &rig->cameras[rank];
    }
    rank++;
    view->camera = (gint) (camera - rig->cameras);
    if (taken[view->camera] >= 0) {
      GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
          ("Pads sink_%d and sink_%u are both of camera \"%s\".",
              taken[view->camera], i, camera->name),
          ("Set the pads' property camera to different names in rig."));
      return FALSE;
    }
    taken[view->camera] = (gint) i;
    if (view->has_caps && (view->width != camera->width
            || view->height != camera->height)) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("Pictures on sink_%u are %d×%d, but camera \"%s\" was calibrated at "
              "%d×%d.", i, view->width, view->height, camera->name,
              camera->width, camera->height), ("%s", size_hint (view, camera)));
      return FALSE;
    }
    offset = (GstClockTimeDiff) (camera->offset_s * GST_SECOND);
    if (view->offset != offset) {
      view->offset = offset;
      *moved = TRUE;
      gst_cloth_sync_set_pad_offset (self, i, offset);
    }
  }
  return TRUE;
}

gboolean
gst_triangulate_views_check_rates (const GstTriangulateView * views,
    GstElement * element)
{
  const GstTriangulateView *first = NULL;

  for (guint i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    const GstTriangulateView *view = &views[i];

    if (!view->has_caps || view->fps_n == 0) {
      continue;
    }
    if (!first) {
      first = view;
    } else if (ABS ((gdouble) view->fps_n * first->fps_d / ((gdouble)
                first->fps_n * view->fps_d) - 1) > NEAR_RATE) {
      GST_ELEMENT_WARNING (element, STREAM, FORMAT,
          ("Frame rates differ: %d/%d on sink_%u, %d/%d on sink_%u.",
              first->fps_n, first->fps_d, (guint) (first - views),
              view->fps_n, view->fps_d, i),
          ("Only pictures of one instant make a mesh. Film at one rate."));
      return FALSE;
    }
  }
  return TRUE;
}

/* While the cameras differ what was said before stands: one that joins with another rate
 * must not end a recording. */
gboolean
gst_triangulate_views_rate (const GstTriangulateView * views, gint * fps_n,
    gint * fps_d)
{
  gboolean agreed = TRUE;
  gint n = -1, d = 1;
  guint i;

  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    if (!views[i].has_caps) {
      continue;
    }
    if (n >= 0 && (n != views[i].fps_n || d != views[i].fps_d)) {
      agreed = FALSE;
    }
    n = views[i].fps_n;
    d = views[i].fps_d;
  }
  if (n < 0) {
    return FALSE;
  }
  if (agreed) {
    *fps_n = n;
    *fps_d = d;
  } else if (*fps_n < 0) {
    *fps_n = 0;                 /* sets come when they come */
    *fps_d = 1;
  }
  return TRUE;
}
