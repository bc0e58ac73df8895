/* What an element that joins several streams says of times for which it sends nothing.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsyncgaps.h"

static GstPadProbeReturn
drop_mark (GstPad * pad, GstPadProbeInfo * info, gpointer mark)
{
  return GST_PAD_PROBE_INFO_BUFFER (info) == mark ? GST_PAD_PROBE_DROP :
      GST_PAD_PROBE_OK;
}

void
gst_cloth_sync_gaps_init (GstClothSyncGaps * gaps, GstPad * srcpad)
{
  gaps->mark = gst_buffer_new ();
  gaps->told = GST_CLOCK_STIME_NONE;
  gst_pad_add_probe (srcpad, GST_PAD_PROBE_TYPE_BUFFER, drop_mark, gaps->mark,
      NULL);
}

void
gst_cloth_sync_gaps_clear (GstClothSyncGaps * gaps)
{
  gst_clear_buffer (&gaps->mark);
}

void
gst_cloth_sync_gaps_note (GstClothSyncGaps * gaps, GstClockTimeDiff time,
    GstClockTime duration)
{
  gaps->told = time;
  if (GST_CLOCK_TIME_IS_VALID (duration)) {
    gaps->told += (GstClockTimeDiff) MIN (duration,
        (guint64) (G_MAXINT64 - MAX (time, 0)));
  }
}

void
gst_cloth_sync_gaps_say (GstClothSyncGaps * gaps, GstAggregator * agg,
    GstClockTime pts, GstClockTime duration)
{
  GstPad *srcpad = GST_AGGREGATOR_SRC_PAD (agg);
  g_autoptr (GstEvent) segment = NULL;
  GstEvent *gap;

  if (!gst_pad_has_current_caps (srcpad)) {
    return;
  }
  /* the aggregator sends its segment, which has the seek's number, with a buffer only */
  gst_aggregator_finish_buffer (agg, gst_buffer_ref (gaps->mark));
  segment = gst_pad_get_sticky_event (srcpad, GST_EVENT_SEGMENT, 0);
  if (!segment) {
    return;                     /* flushing */
  }
  gap = gst_event_new_gap (pts, duration);
  gst_event_set_seqnum (gap, gst_event_get_seqnum (segment));
  gst_pad_push_event (srcpad, gap);
}

void
gst_cloth_sync_gaps_pass (GstClothSyncGaps * gaps, GstAggregator * agg,
    const GstClothSyncHeads * heads)
{
  const GstSegment *segment =
      &GST_AGGREGATOR_PAD (GST_AGGREGATOR_SRC_PAD (agg))->segment;
  const GstClockTimeDiff end = gst_cloth_sync_heads_get_gap_end (heads);
  GstClockTimeDiff start = end;
  GstClockTime pts;

  for (guint i = 0; i < heads->n; i++) {
    if (heads->head[i]) {
      start = MIN (start, heads->time[i]);
    }
  }
  /* NONE is before all times */
  start = MAX (MAX (start, gaps->told), 0);
  if (start > end) {
    return;
  }
  gaps->told = end;
  GST_OBJECT_LOCK (agg);
  pts = gst_segment_position_from_running_time (segment, GST_FORMAT_TIME,
      (guint64) start);
  GST_OBJECT_UNLOCK (agg);
  if (GST_CLOCK_TIME_IS_VALID (pts)) {
    gst_cloth_sync_gaps_say (gaps, agg, pts,
        end > start ? (GstClockTime) (end - start) : GST_CLOCK_TIME_NONE);
  }
}
