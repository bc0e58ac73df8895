/* Base of the elements that join several streams by running time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsyncpad.h"

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_SYNC (gst_cloth_sync_get_type ())
G_DECLARE_DERIVABLE_TYPE (GstClothSync, gst_cloth_sync, GST, CLOTH_SYNC,
    GstAggregator)

/* @parent_class: the parent class
 * @set_pad_caps: the caps of pad @index have changed, or, with @caps %NULL, the pad is
 *   gone. The subclass posts an element error and returns %FALSE when it can't work
 *   with them. The source pad is negotiated again before the next set.
 * @negotiate_src: puts the source caps into @caps (transfer full) and returns
 *   %GST_FLOW_OK, or returns %GST_AGGREGATOR_FLOW_NEED_DATA when a pad without caps
 *   has to give its own first. @downstream is what the peer allows. Optional: without
 *   it the source pad takes what the peer allows.
 * @look: looks at the frames that are next, or the gaps, @heads, as @views of @process_set, which may set pads' offsets:
 *   %GST_AGGREGATOR_FLOW_NEED_DATA when it did. Optional.
 * @process_set: one set of frames of the same instant. @views has @n entries, one for
 *   every pad index up to the highest in use; %NULL where the pad has no frame in this
 *   set. Bit i of @mask is set when @views[i] is there. @pts and @duration are the
 *   set's, in the source segment. The buffers are borrowed; to keep one or write into
 *   it without a copy take it and put %NULL in its place. @out takes the result; left
 *   %NULL a GAP event is sent for this set. The base sets its time stamps.
 * @reset: forgets what earlier frames have left (flush, stop). Optional.
 * @get_camera: (nullable): name of the camera whose frames come to pad @index, for messages.
 *   Optional.
 * @prefix: of the element messages "<prefix>/silent" and "<prefix>/back", which say that a
 *   pad of a live pipeline gives nothing for a while, and that it gives again; both have
 *   camera, pad and seconds. %NULL: they are not posted.
 *
 * All methods are called from the streaming thread, with no lock held.
 */
struct _GstClothSyncClass {
  GstAggregatorClass parent_class;

  gboolean (*set_pad_caps) (GstClothSync * sync, guint index, GstCaps * caps);
  GstFlowReturn (*negotiate_src) (GstClothSync * sync, GstCaps * downstream,
      GstCaps ** caps);
  GstFlowReturn (*look) (GstClothSync * sync, GstBuffer ** heads, guint n);
  GstFlowReturn (*process_set) (GstClothSync * sync, GstBuffer ** views, guint n,
      guint64 mask, GstClockTime pts, GstClockTime duration, GstBuffer ** out);
  void (*reset) (GstClothSync * sync);
  const gchar *(*get_camera) (GstClothSync * sync, guint index);
  const gchar *prefix;

  gpointer _reserved[2];
};

/* @sync: the element, in its instance init
 * @templ_name: name of an always sink pad template of its class
 *
 * Adds the pad of an always template; it takes the lowest free index.
 */
void gst_cloth_sync_add_always_pad (GstClothSync * sync,
    const gchar * templ_name);

/* @sync: the element
 * @index: pad index, below %GST_CLOTH_SYNC_MAX_PADS
 * @offset: the stream's time minus the common time, ns (`offset_s` of rig.json)
 *
 * Running times of the pad are lowered by @offset before the streams are joined; the
 * sets carry the common time. Frames that come to lie before time 0 are dropped.
 */
void gst_cloth_sync_set_pad_offset (GstClothSync * sync, guint index,
    GstClockTimeDiff offset);

/* @sync: the element, in its process_set
 * @index: of a view of the set
 *
 * Returns: (transfer none): the segment of the view's own time stamps. Its pad may be gone.
 */
const GstSegment *gst_cloth_sync_get_segment (GstClothSync * sync,
    guint index);

G_END_DECLS
