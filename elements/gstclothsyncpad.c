/* Sink pads of the elements that join several streams.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsyncpad.h"

G_DEFINE_TYPE (GstClothSyncPad, gst_cloth_sync_pad, GST_TYPE_AGGREGATOR_PAD);

GstBuffer *
gst_cloth_sync_pad_look (GstClothSyncPad * pad)
{
  GstBuffer *head = NULL;

  GST_OBJECT_LOCK (pad);
  if (pad->believed) {
    head = gst_buffer_ref (pad->held);
  }
  GST_OBJECT_UNLOCK (pad);
  return head ? head :
      gst_aggregator_pad_peek_buffer (GST_AGGREGATOR_PAD_CAST (pad));
}

GstBuffer *
gst_cloth_sync_pad_take (GstClothSyncPad * pad)
{
  GstBuffer *head = NULL;

  GST_OBJECT_LOCK (pad);
  if (pad->believed) {
    head = g_steal_pointer (&pad->held);
    pad->believed = FALSE;
  }
  GST_OBJECT_UNLOCK (pad);
  return head ? head :
      gst_aggregator_pad_pop_buffer (GST_AGGREGATOR_PAD_CAST (pad));
}

static GstClothSyncVerdict
judge (const GstClothSyncPad * pad, GstClockTimeDiff time, gboolean is_eos,
    GstClockTimeDiff start, GstClockTime max_jump)
{
  const gboolean first = !GST_CLOCK_STIME_IS_VALID (pad->last);
  const GstClockTimeDiff last = MAX (first ? 0 : pad->last, start);
  const gboolean is_head = GST_CLOCK_STIME_IS_VALID (time);
  GstClockTime most = MAX (max_jump, pad->interval < G_MAXUINT64 / 2 ?
      2 * pad->interval : G_MAXUINT64);

  if (pad->believed) {
    return GST_CLOTH_SYNC_KEEP;
  }
  if (!pad->held) {
    return is_head && time > last && (guint64) time - (guint64) last > most ?
        GST_CLOTH_SYNC_HOLD : GST_CLOTH_SYNC_KEEP;
  }
  if (is_head) {
    most = MAX (most, (guint64) pad->held_time - (guint64) last);
    return time > pad->held_time
        && (guint64) time - (guint64) pad->held_time <= most ?
        GST_CLOTH_SYNC_BELIEVE : GST_CLOTH_SYNC_REFUSE;
  }
  if (!is_eos) {
    return GST_CLOTH_SYNC_KEEP;
  }
  /* The only frame of its pad is contradicted by none. */
  return first ? GST_CLOTH_SYNC_BELIEVE : GST_CLOTH_SYNC_REFUSE;
}

GstClothSyncVerdict
gst_cloth_sync_pad_judge (GstClothSyncPad * pad, GstClockTimeDiff time,
    GstClockTimeDiff start, GstClockTime max_jump)
{
  const gboolean is_eos =
      gst_aggregator_pad_is_eos (GST_AGGREGATOR_PAD_CAST (pad));
  GstClothSyncVerdict verdict;

  GST_OBJECT_LOCK (pad);
  verdict = judge (pad, time, is_eos, start, max_jump);
  GST_OBJECT_UNLOCK (pad);
  return verdict;
}

void
gst_cloth_sync_pad_note (GstClothSyncPad * pad, GstClockTimeDiff time)
{
  GST_OBJECT_LOCK (pad);
  if (!GST_CLOCK_STIME_IS_VALID (pad->last)) {
    pad->last = time;
  } else if (time > pad->last) {
    pad->interval = (guint64) time - (guint64) pad->last;
    pad->last = time;
  }
  GST_OBJECT_UNLOCK (pad);
}

void
gst_cloth_sync_pad_hold (GstClothSyncPad * pad, GstBuffer * buffer,
    GstClockTimeDiff time)
{
  GST_OBJECT_LOCK (pad);
  gst_clear_buffer (&pad->held);
  pad->held = buffer;
  pad->held_time = time;
  GST_OBJECT_UNLOCK (pad);
}

void
gst_cloth_sync_pad_believe (GstClothSyncPad * pad)
{
  GST_OBJECT_LOCK (pad);
  pad->believed = pad->held != NULL;
  GST_OBJECT_UNLOCK (pad);
}

void
gst_cloth_sync_pad_refuse (GstClothSyncPad * pad)
{
  GST_OBJECT_LOCK (pad);
  gst_clear_buffer (&pad->held);
  GST_OBJECT_UNLOCK (pad);
}

void
gst_cloth_sync_pad_reset (GstClothSyncPad * pad)
{
  GST_OBJECT_LOCK (pad);
  gst_clear_buffer (&pad->held);
  pad->believed = FALSE;
  pad->last = GST_CLOCK_STIME_NONE;
  pad->interval = 0;
  GST_OBJECT_UNLOCK (pad);
}

/* What was looked at before the flush, to know the deadline, is still held. */
static GstFlowReturn
gst_cloth_sync_pad_flush (GstAggregatorPad * pad, GstAggregator * agg)
{
  gst_aggregator_pad_drop_buffer (pad);
  gst_cloth_sync_pad_reset (GST_CLOTH_SYNC_PAD (pad));
  return GST_FLOW_OK;
}

static void
gst_cloth_sync_pad_finalize (GObject * object)
{
  gst_cloth_sync_pad_reset (GST_CLOTH_SYNC_PAD (object));
  G_OBJECT_CLASS (gst_cloth_sync_pad_parent_class)->finalize (object);
}

static void
gst_cloth_sync_pad_class_init (GstClothSyncPadClass * klass)
{
  G_OBJECT_CLASS (klass)->finalize = gst_cloth_sync_pad_finalize;
  GST_AGGREGATOR_PAD_CLASS (klass)->flush = gst_cloth_sync_pad_flush;
}

static void
gst_cloth_sync_pad_init (GstClothSyncPad * pad)
{
  pad->period = GST_CLOCK_TIME_NONE;
  pad->last = GST_CLOCK_STIME_NONE;
}
