/* What the two files of GstClothSync share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsync.h"

G_BEGIN_DECLS

GST_DEBUG_CATEGORY_EXTERN (cloth_sync_debug);

typedef struct {
  /* Held while a pad is released and while the streaming thread takes frames from pads:
   * GstAggregator drops the frame that a subclass has looked at without the pad's
   * lock. Taken before all of the aggregator's own locks. */
  GMutex release_lock;

  /* with the object lock */
  GstClockTime tolerance;
  guint min_views;
  GstClockTimeDiff offset[GST_CLOTH_SYNC_MAX_PADS];
  GstClockTime effective;       /* the tolerance in force */
  guint64 taken;                /* indices in use */
  guint64 released;             /* of pads that the subclass still believes in */
  guint64 n_sets, n_incomplete, n_dropped;

  /* streaming thread */
  gboolean has_last;
  GstClockTimeDiff last_time, last_tolerance;
  guint64 last_mask;
} GstClothSyncPrivate;

GstClothSyncPrivate *gst_cloth_sync_get_private (GstClothSync * self);
void gst_cloth_sync_forget_released (GstClothSync * self);

GstClockTime gst_cloth_sync_get_next_time (GstAggregator * agg);
GstFlowReturn gst_cloth_sync_aggregate (GstAggregator * agg, gboolean timeout);

G_END_DECLS
