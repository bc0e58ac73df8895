/* What an element that joins several streams says of times for which it sends nothing.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsyncheads.h"

G_BEGIN_DECLS

/* @mark: a buffer that never goes downstream
 * @told: until which common time downstream knows what comes; %GST_CLOCK_STIME_NONE: nothing yet */
typedef struct
{
  GstBuffer *mark;
  GstClockTimeDiff told;
} GstClothSyncGaps;

void gst_cloth_sync_gaps_init (GstClothSyncGaps * gaps, GstPad * srcpad);
void gst_cloth_sync_gaps_clear (GstClothSyncGaps * gaps);

/* A set of @time and @duration, which may be NONE, is dealt with. */
void gst_cloth_sync_gaps_note (GstClothSyncGaps * gaps, GstClockTimeDiff time,
    GstClockTime duration);

/* Says downstream that nothing comes for a set. Without it an element that joins this stream with
 * another one would wait, and fill the queues of the other, for ever. */
void gst_cloth_sync_gaps_say (GstClothSyncGaps * gaps, GstAggregator * agg,
    GstClockTime pts, GstClockTime duration);

/* Every pad has a gap or has ended: says downstream what they have in common, from what it was
 * told last. */
void gst_cloth_sync_gaps_pass (GstClothSyncGaps * gaps, GstAggregator * agg,
    const GstClothSyncHeads * heads);

G_END_DECLS
