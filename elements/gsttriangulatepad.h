/* Sink pads of elements that join the cameras of a rig, and which camera each belongs to.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsync.h"
#include "gst/rig/rig.h"

G_BEGIN_DECLS

#define GST_TYPE_TRIANGULATE_PAD (gst_triangulate_pad_get_type ())
G_DECLARE_FINAL_TYPE (GstTriangulatePad, gst_triangulate_pad, GST,
    TRIANGULATE_PAD, GstClothSyncPad)

/* Makes sink_0::camera work on a gst-launch line: the interface of the element. */
void gst_triangulate_pad_child_proxy_init (gpointer iface, gpointer data);

/* request_new_pad and release_pad of these elements: as the parent class has them, with the
 * pad a child of the element. The element's class must have none that is derived from it. */
GstPad *gst_triangulate_pad_request_new (GstElement * element,
    GstPadTemplate * templ, const gchar * name, const GstCaps * caps);
void gst_triangulate_pad_release (GstElement * element, GstPad * pad);

/* What is known of a pad; streaming thread. */
typedef struct {
  gboolean has_caps, observations;
  gint width, height;
  gint fps_n, fps_d;
  gchar *property;              /* the pad's property, of this set */
  gchar *meta;                  /* the name that the metadata carries */
  gboolean present, carries;
  gboolean looked;              /* at its first picture */
  gboolean trusted;             /* its packets have been of the rig and of the pattern */
  gint camera;                  /* in rig; -1 when not known */
  GstClockTimeDiff offset;
} GstTriangulateView;

void gst_triangulate_view_forget (GstTriangulateView * view);
/* Takes over the size and rate of pad @index, and whether it brings observations; FALSE after an
 * element error. @caps: (nullable): %NULL forgets the pad. */
gboolean gst_triangulate_view_set_caps (GstTriangulateView * view,
    GstElement * element, guint index, const GstCaps * caps);
/* Finds each pad its camera: by its property, by the name in the metadata, by the order
 * of pads; %FALSE after an element error. @views: one for every pad index. @moved: a
 * camera's clock turned out to be another than the set was joined by. */
gboolean gst_triangulate_views_map (GstClothSync * sync,
    GstTriangulateView * views, const ClothRig * rig, gboolean * moved);

/* FALSE after a warning that two cameras' caps have rates that are more than 1% apart. */
gboolean gst_triangulate_views_check_rates (const GstTriangulateView * views,
    GstElement * element);

/* The rate of the mesh as far as the cameras' caps tell; *fps_n: the one said before, -1
 * for none. FALSE when no caps are known yet. */
gboolean gst_triangulate_views_rate (const GstTriangulateView * views,
    gint * fps_n, gint * fps_d);

G_END_DECLS
