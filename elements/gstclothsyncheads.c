/* The frames at the heads of all pads of an element that joins several streams.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsyncheads.h"

gboolean
gst_cloth_sync_is_within (GstClockTimeDiff time, GstClockTimeDiff since,
    guint64 span)
{
  return time <= since || (guint64) time - (guint64) since <= span;
}

GstClockTimeDiff
gst_cloth_sync_pad_get_time (GstClothSyncPad * pad, GstElement * element,
    const GstClockTimeDiff * offsets, GstBuffer * buffer)
{
  GstSegment *segment = &GST_AGGREGATOR_PAD_CAST (pad)->segment;
  guint64 running = GST_CLOCK_TIME_NONE;
  GstClockTimeDiff offset;

  GST_OBJECT_LOCK (element);
  offset = offsets[pad->index];
  GST_OBJECT_UNLOCK (element);
  GST_OBJECT_LOCK (pad);
  if (GST_BUFFER_PTS_IS_VALID (buffer) && segment->format == GST_FORMAT_TIME) {
    running = gst_segment_to_running_time (segment, GST_FORMAT_TIME,
        GST_BUFFER_PTS (buffer));
  }
  GST_OBJECT_UNLOCK (pad);
  if (!GST_CLOCK_TIME_IS_VALID (running)) {
    return GST_CLOCK_STIME_NONE;
  }
  running = MIN (running, (guint64) G_MAXINT64);
  if (offset < 0 && running > (guint64) (G_MAXINT64 + offset)) {
    return G_MAXINT64;
  }
  return (GstClockTimeDiff) running - offset;
}

void
gst_cloth_sync_heads_gather (GstClothSyncHeads * heads, GstElement * element,
    const GstClockTimeDiff * offset)
{
  GList *l;
  guint i;

  memset (heads, 0, sizeof (*heads));
  GST_OBJECT_LOCK (element);
  for (l = element->sinkpads; l; l = l->next) {
    i = GST_CLOTH_SYNC_PAD (l->data)->index;
    heads->pad[i] = gst_object_ref (l->data);
    heads->n = MAX (heads->n, i + 1);
    heads->n_pads++;
  }
  GST_OBJECT_UNLOCK (element);

  for (i = 0; i < heads->n; i++) {
    GstAggregatorPad *pad = GST_AGGREGATOR_PAD_CAST (heads->pad[i]);
    GstBuffer *head;

    if (!pad) {
      continue;
    }
    head = heads->head[i] =
        gst_cloth_sync_pad_look (heads->pad[i], &heads->time[i]);
    if (!head) {
      if (gst_aggregator_pad_is_eos (pad)) {
        heads->n_eos++;
      } else {
        heads->n_waiting++;
      }
      continue;
    }
    heads->n_heads++;
    heads->gap[i] = GST_BUFFER_FLAG_IS_SET (head, GST_BUFFER_FLAG_GAP);
    if (!GST_CLOCK_STIME_IS_VALID (heads->time[i])) {
      heads->time[i] =
          gst_cloth_sync_pad_get_time (heads->pad[i], element, offset, head);
    }
  }
}

void
gst_cloth_sync_heads_release (GstClothSyncHeads * heads)
{
  guint i;

  for (i = 0; i < heads->n; i++) {
    gst_clear_buffer (&heads->head[i]);
    gst_clear_object (&heads->pad[i]);
  }
}

GstClockTimeDiff
gst_cloth_sync_heads_get_end (const GstClothSyncHeads * heads, guint i)
{
  const GstClockTimeDiff time = heads->time[i];
  const guint64 room = (guint64) G_MAXINT64 - (guint64) time;

  if (!heads->gap[i] || !GST_BUFFER_DURATION_IS_VALID (heads->head[i])) {
    return time;
  }
  return time + (GstClockTimeDiff) MIN (GST_BUFFER_DURATION (heads->head[i]),
      MIN (room, (guint64) G_MAXINT64));
}

GstClockTimeDiff
gst_cloth_sync_heads_get_gap_end (const GstClothSyncHeads * heads)
{
  GstClockTimeDiff end = G_MAXINT64;

  for (guint i = 0; i < heads->n; i++) {
    if (heads->gap[i] && GST_CLOCK_STIME_IS_VALID (heads->time[i])) {
      end = MIN (end, gst_cloth_sync_heads_get_end (heads, i));
    }
  }
  return end;
}

GstClockTimeDiff
gst_cloth_sync_heads_silent_at (const GstClothSyncHeads * heads, guint i)
{
  GstClothSyncPad *pad = heads->pad[i];
  GstClockTimeDiff since;

  if (!pad || heads->head[i] || pad->silent) {
    return GST_CLOCK_STIME_NONE;
  }
  since = gst_cloth_sync_pad_silent_since (pad);
  if (!GST_CLOCK_STIME_IS_VALID (since)) {
    return since;
  }
  since = MAX (since, 0);
  return since + (GstClockTimeDiff) MIN (gst_cloth_sync_pad_patience (pad),
      (guint64) (G_MAXINT64 - since));
}

GstClockTime
gst_cloth_sync_get_lateness (GstAggregator * agg, GstClockTimeDiff last_time,
    GstClockTimeDiff time)
{
  const GstClockTime latency = gst_aggregator_get_latency (agg);
  const GstClockTime now =
      gst_element_get_current_running_time (GST_ELEMENT (agg));
  GstClockTime set;

  if (!GST_CLOCK_TIME_IS_VALID (latency) || !GST_CLOCK_TIME_IS_VALID (now)
      || time < 0) {
    return 0;
  }
  set = (GstClockTime) MIN (time, MAX (last_time, 0));
  return now > set && now - set > latency ? now - set - latency : 0;
}
