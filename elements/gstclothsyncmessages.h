/* What the joining of streams says: on the bus, and in the counts of each stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsyncpad.h"

G_BEGIN_DECLS

/* A frame held was dropped: its successor contradicts its time, or it @is_last. */
void gst_cloth_sync_say_refused (GstElement * element, GstClothSyncPad * pad,
    gboolean is_last);

/* A frame without a time was dropped on a pad that has had times. */
void gst_cloth_sync_say_untimed (GstElement * element, GstClothSyncPad * pad);

/* The pad's times have jumped, and the others' have not. */
void gst_cloth_sync_say_jump (GstElement * element, GstClothSyncPad * pad);

/* @buffer is dropped: it came too late for its set. */
void gst_cloth_sync_say_dropped (GstElement * element, GstClothSyncPad * pad,
    GstBuffer * buffer);

/* A frame of @time is dropped, which is far from the set at @last_time. */
void gst_cloth_sync_say_far_back (GstElement * element, GstClothSyncPad * pad,
    GstClockTimeDiff time, GstClockTimeDiff last_time);

/* A live stream's frame came @late after the deadline of its set. @latency: the element's
 * own property, which would have to be greater by as much */
void gst_cloth_sync_say_late (GstElement * element, GstClothSyncPad * pad,
    GstClockTime late, GstClockTime latency);

/* Marks whether the pad is silent and says so: element message "<prefix>/silent" or
 * "<prefix>/back". @now: common time */
void gst_cloth_sync_pad_set_silent (GstClothSyncPad * pad,
    GstElement * element, const gchar * prefix, gboolean silent,
    GstClockTimeDiff now);

/* The streams have ended: warns where no frame of the pad came into any of the sets. */
void gst_cloth_sync_say_unused (GstElement * element, GstClothSyncPad * pad);

/* Live streams have ended: sums up which of them the sets lacked, when pictures came too late or
 * a stream fell silent. @pads has %NULL where there is none */
void gst_cloth_sync_say_lost (GstElement * element,
    GstClothSyncPad * const *pads, guint n_pads, guint64 n_sets,
    guint64 n_incomplete);

/* Returns: (transfer full): the counts of the pad; take the element's object lock */
GstStructure *gst_cloth_sync_pad_get_stats (GstClothSyncPad * pad);

G_END_DECLS
