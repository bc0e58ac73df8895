/* The frames at the heads of all pads of an element that joins several streams.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsyncpad.h"

G_BEGIN_DECLS

/* By the pads' index. @n: the highest in use + 1; @n_pads: pads there are; @n_heads: pads with a
 * head, a frame or a gap; @n_eos: without one for ever; @n_waiting: without one as yet. */
typedef struct {
  GstClothSyncPad *pad[GST_CLOTH_SYNC_MAX_PADS];
  GstBuffer *head[GST_CLOTH_SYNC_MAX_PADS];
  GstClockTimeDiff time[GST_CLOTH_SYNC_MAX_PADS];
  gboolean gap[GST_CLOTH_SYNC_MAX_PADS];
  guint n, n_pads, n_heads, n_eos, n_waiting;
} GstClothSyncHeads;

/* Whether @time is at most @span after @since; nothing overflows. */
gboolean gst_cloth_sync_is_within (GstClockTimeDiff time,
    GstClockTimeDiff since, guint64 span);

/* @offset: of every pad index, with the object lock of @element
 *
 * Returns: time of a frame on the common clock, the largest one where it is beyond all that
 * 64 bits hold; GST_CLOCK_STIME_NONE when it has none
 */
GstClockTimeDiff gst_cloth_sync_pad_get_time (GstClothSyncPad * pad,
    GstElement * element, const GstClockTimeDiff * offset, GstBuffer * buffer);

/* @heads: (out caller-allocates): the heads as they are now; release them */
void gst_cloth_sync_heads_gather (GstClothSyncHeads * heads,
    GstElement * element, const GstClockTimeDiff * offset);
void gst_cloth_sync_heads_release (GstClothSyncHeads * heads);

/* Returns: when what head @i says ends: of a gap, not before its frames may come */
GstClockTimeDiff gst_cloth_sync_heads_get_end (const GstClothSyncHeads * heads,
    guint i);

/* Returns: when the first of the gaps ends; the largest time when there is none */
GstClockTimeDiff gst_cloth_sync_heads_get_gap_end (const GstClothSyncHeads *
    heads);

/* Returns: when pad @i will have been silent for long; GST_CLOCK_STIME_NONE: there is none, or
 * it has a head, or nothing is expected of it, or its silence is said already */
GstClockTimeDiff gst_cloth_sync_heads_silent_at (const GstClothSyncHeads *
    heads, guint i);

/* @last_time: common time of the last set; @time: that of a frame which comes now
 *
 * Returns: how long after the deadline of its set it comes; 0 when it doesn't */
GstClockTime gst_cloth_sync_get_lateness (GstAggregator * agg,
    GstClockTimeDiff last_time, GstClockTimeDiff time);

G_END_DECLS
