/* Sink pads of the elements that join several streams.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsyncpad.h"

/* Pauses of a film are shorter, and one damaged time stamp of 200,000 is. */
#define LONGEST_PAUSE (24 * 3600 * GST_SECOND)
/* A camera that gives nothing for so long, and for so many of its frames, is silent: longer
 * than a stutter, and soon enough that an operator can act. */
#define PATIENCE GST_SECOND
#define PATIENT_FRAMES 5

G_DEFINE_TYPE (GstClothSyncPad, gst_cloth_sync_pad, GST_TYPE_AGGREGATOR_PAD);

GList *
gst_cloth_sync_pad_list (GstElement * element)
{
  GList *pads;

  GST_OBJECT_LOCK (element);
  pads = g_list_copy_deep (element->sinkpads,
      (GCopyFunc) (gpointer) gst_object_ref, NULL);
  GST_OBJECT_UNLOCK (element);
  return pads;
}

GstBuffer *
gst_cloth_sync_pad_look (GstClothSyncPad * pad, GstClockTimeDiff * time)
{
  GstBuffer *head = NULL;

  *time = GST_CLOCK_STIME_NONE;
  GST_OBJECT_LOCK (pad);
  if (pad->believed) {
    head = gst_buffer_ref (pad->held);
    *time = pad->held_time;
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

gboolean
gst_cloth_sync_pad_is_holding (GstClothSyncPad * pad)
{
  gboolean is_holding;

  GST_OBJECT_LOCK (pad);
  is_holding = pad->held != NULL;
  GST_OBJECT_UNLOCK (pad);
  return is_holding;
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
    /* live, the clock may have gone past it meanwhile */
    most = MAX (most, pad->held_time > last ?
        (guint64) pad->held_time - (guint64) last : 0);
    return time > pad->held_time
        && (guint64) time - (guint64) pad->held_time <= most ?
        GST_CLOTH_SYNC_BELIEVE : GST_CLOTH_SYNC_REFUSE;
  }
  if (!is_eos) {
    return GST_CLOTH_SYNC_KEEP;
  }
  /* The only frame of its pad is contradicted by none. */
  return first || pad->held_time <= last
      || (guint64) pad->held_time - (guint64) last <= LONGEST_PAUSE ?
      GST_CLOTH_SYNC_BELIEVE : GST_CLOTH_SYNC_REFUSE;
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
gst_cloth_sync_pad_note (GstClothSyncPad * pad, GstClockTimeDiff time,
    GstClockTimeDiff end)
{
  GST_OBJECT_LOCK (pad);
  if (!GST_CLOCK_STIME_IS_VALID (pad->last)) {
    pad->last = end;
  } else if (end > pad->last) {
    if (time > pad->last) {
      pad->interval = (guint64) time - (guint64) pad->last;
    }
    pad->last = end;
  }
  GST_OBJECT_UNLOCK (pad);
}

void
gst_cloth_sync_pad_expect (GstClothSyncPad * pad, GstClockTimeDiff now)
{
  GST_OBJECT_LOCK (pad);
  if (!GST_CLOCK_STIME_IS_VALID (pad->expected)) {
    pad->expected = now;
  }
  GST_OBJECT_UNLOCK (pad);
}

GstClockTimeDiff
gst_cloth_sync_pad_silent_since (GstClothSyncPad * pad)
{
  GstClockTimeDiff since;

  GST_OBJECT_LOCK (pad);
  /* none is before all times */
  since = MAX (pad->expected, pad->last);
  GST_OBJECT_UNLOCK (pad);
  return since;
}

GstClockTime
gst_cloth_sync_pad_patience (const GstClothSyncPad * pad)
{
  return pad->period < G_MAXUINT64 / PATIENT_FRAMES ?
      MAX (PATIENCE, PATIENT_FRAMES * pad->period) : PATIENCE;
}

void
gst_cloth_sync_pad_hold (GstClothSyncPad * pad, GstBuffer * buffer,
    GstClockTimeDiff time, guint n_flushes)
{
  g_autoptr (GstBuffer) taken = buffer;

  GST_OBJECT_LOCK (pad);
  if (pad->n_flushes == n_flushes) {
    pad->held = g_steal_pointer (&taken);
    pad->held_time = time;
  }
  GST_OBJECT_UNLOCK (pad);
}

GstBuffer *
gst_cloth_sync_pad_clip (GstAggregator * agg, GstAggregatorPad * aggpad,
    GstBuffer * buffer)
{
  GstClockTime start = GST_BUFFER_PTS (buffer);
  GstClockTime stop = GST_CLOCK_TIME_NONE;
  guint64 new_start, new_stop;

  if (!GST_CLOCK_TIME_IS_VALID (start)
      || aggpad->segment.format != GST_FORMAT_TIME) {
    return buffer;
  }
  if (GST_BUFFER_DURATION_IS_VALID (buffer)
      && GST_BUFFER_DURATION (buffer) < GST_CLOCK_TIME_NONE - start) {
    stop = start + GST_BUFFER_DURATION (buffer);
  }
  if (!gst_segment_clip (&aggpad->segment, GST_FORMAT_TIME, start, stop,
          &new_start, &new_stop)) {
    gst_buffer_unref (buffer);
    return NULL;
  }
  if (new_start != start) {
    buffer = gst_buffer_make_writable (buffer);
    GST_BUFFER_PTS (buffer) = new_start;
    GST_BUFFER_DURATION (buffer) =
        GST_CLOCK_TIME_IS_VALID (new_stop) ? new_stop - new_start : new_stop;
  }
  return buffer;
}

gboolean
gst_cloth_sync_pad_check_segment (GstClothSyncPad * pad, GstElement * element,
    GstEvent * event)
{
  const GstSegment *segment;

  gst_event_parse_segment (event, &segment);
  if (segment->format != GST_FORMAT_TIME) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("Pad %s has a segment in %s, not in time.", GST_PAD_NAME (pad),
            gst_format_get_name (segment->format)),
        ("Streams are joined by running time. Put a parser or decoder that gives "
            "times before this element, or a source with format=time."));
    return FALSE;
  }
  if (segment->rate < 0 && (!GST_CLOCK_TIME_IS_VALID (segment->stop)
          || segment->stop < segment->offset)) {
    GST_ELEMENT_ERROR (element, STREAM, FORMAT,
        ("Pad %s has a segment that is played backwards from no end, or from "
            "before its beginning.", GST_PAD_NAME (pad)),
        ("Seek with a stop position, or play forwards."));
    return FALSE;
  }
  return TRUE;
}

guint
gst_cloth_sync_pad_count_flushes (GstClothSyncPad * pad)
{
  guint n_flushes;

  GST_OBJECT_LOCK (pad);
  n_flushes = pad->n_flushes;
  GST_OBJECT_UNLOCK (pad);
  return n_flushes;
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
  g_autoptr (GstBuffer) held = NULL;

  GST_OBJECT_LOCK (pad);
  held = g_steal_pointer (&pad->held);
  GST_OBJECT_UNLOCK (pad);
}

void
gst_cloth_sync_pads_shift_held (GstElement * element, guint index,
    GstClockTimeDiff before, GstClockTimeDiff after)
{
  g_autoptr (GstClothSyncPad) pad = NULL;
  GstClockTimeDiff time = GST_CLOCK_STIME_NONE;

  GST_OBJECT_LOCK (element);
  for (GList * l = element->sinkpads; l; l = l->next) {
    if (GST_CLOTH_SYNC_PAD (l->data)->index == index) {
      pad = gst_object_ref (l->data);
    }
  }
  GST_OBJECT_UNLOCK (element);
  if (!pad) {
    return;
  }
  GST_OBJECT_LOCK (pad);
  if (pad->held && GST_CLOCK_STIME_IS_VALID (pad->held_time)
      && (__builtin_add_overflow (pad->held_time, before, &time)
          || __builtin_sub_overflow (time, after, &time))) {
    time = after < 0 ? G_MAXINT64 : G_MININT64 + 1;
  }
  if (GST_CLOCK_STIME_IS_VALID (time)) {
    pad->held_time = time;
  }
  GST_OBJECT_UNLOCK (pad);
}

guint
gst_cloth_sync_pad_count_missing (GstClothSyncPad * pad, GstElement * element)
{
  if (!pad) {
    return 0;
  }
  GST_OBJECT_LOCK (element);
  pad->missing++;
  pad->lacked++;
  GST_OBJECT_UNLOCK (element);
  return 1;
}

/* Forgets all times, and what is held. */
static void
gst_cloth_sync_pad_reset (GstClothSyncPad * pad)
{
  /* freed without the lock: who made it may do anything then */
  g_autoptr (GstBuffer) held = NULL;

  GST_OBJECT_LOCK (pad);
  held = g_steal_pointer (&pad->held);
  pad->believed = FALSE;
  pad->expected = pad->last = GST_CLOCK_STIME_NONE;
  pad->interval = 0;
  pad->n_flushes++;
  GST_OBJECT_UNLOCK (pad);
}

void
gst_cloth_sync_pad_restart (GstClothSyncPad * pad, GstElement * element)
{
  gst_cloth_sync_pad_reset (pad);
  GST_OBJECT_LOCK (element);
  pad->silent = pad->was_silent = FALSE;
  pad->lacked = pad->late = 0;
  GST_OBJECT_UNLOCK (element);
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
  gst_clear_event (&GST_CLOTH_SYNC_PAD (object)->caps);
  g_free (GST_CLOTH_SYNC_PAD (object)->camera_name);
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
  pad->expected = pad->last = GST_CLOCK_STIME_NONE;
}

static GstClockTime
period_of_caps (const GstCaps * caps)
{
  const GstStructure *s = gst_caps_get_structure (caps, 0);
  gint n, d;

  if (gst_structure_get_fraction (s, "framerate", &n, &d) && n > 0 && d > 0) {
    return gst_util_uint64_scale (GST_SECOND, (guint64) d, (guint64) n);
  }
  if (gst_structure_get_fraction (s, "max-framerate", &n, &d) && n > 0 && d > 0) {
    return gst_util_uint64_scale (GST_SECOND, (guint64) d, (guint64) n);
  }
  return GST_CLOCK_TIME_NONE;
}

void
gst_cloth_sync_pad_set_period (GstClothSyncPad * pad, GstElement * element,
    const GstCaps * caps)
{
  GST_OBJECT_LOCK (element);
  pad->period = period_of_caps (caps);
  GST_OBJECT_UNLOCK (element);
}

void
gst_cloth_sync_pad_set_camera (GstClothSyncPad * pad, GstElement * element,
    const gchar * name)
{
  if (g_strcmp0 (pad->camera_name, name) != 0) {
    GST_OBJECT_LOCK (element);
    g_free (pad->camera_name);
    pad->camera_name = g_strdup (name);
    GST_OBJECT_UNLOCK (element);
  }
}
