/* The joining of streams: which frames make a set, and when.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/* How a set is made. The earliest frame at the head of any pad gives the set its time
 * t; every head of running time <= t + tolerance belongs to it, one frame a pad. When
 * not live the base waits until every pad that is not at EOS has a head, so the sets
 * depend on the time stamps alone and not on which thread came first. When live it
 * waits no longer than clock time t + latency (upstream's, the tolerance and the
 * latency property) and goes on with what is there. A GAP says that a pad has nothing
 * for a while: it is never a view, but it spares the wait. */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsync-private.h"

#define GST_CAT_DEFAULT cloth_sync_debug

/* The heads of all pads, by index. */
typedef struct
{
  GstClothSyncPad *pad[GST_CLOTH_SYNC_MAX_PADS];
  GstBuffer *head[GST_CLOTH_SYNC_MAX_PADS];
  GstClockTimeDiff time[GST_CLOTH_SYNC_MAX_PADS];
  gboolean gap[GST_CLOTH_SYNC_MAX_PADS];
  guint n, n_pads, n_eos, n_waiting;
} Heads;

/* Time of a frame on the common clock; GST_CLOCK_STIME_NONE when it has none. */
static GstClockTimeDiff
gst_cloth_sync_time (GstClothSync * self, GstClothSyncPad * pad,
    GstBuffer * buffer)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  GstSegment *segment = &GST_AGGREGATOR_PAD_CAST (pad)->segment;
  guint64 running = GST_CLOCK_TIME_NONE;
  GstClockTimeDiff offset;

  GST_OBJECT_LOCK (self);
  offset = priv->offset[pad->index];
  GST_OBJECT_UNLOCK (self);
  GST_OBJECT_LOCK (pad);
  if (GST_BUFFER_PTS_IS_VALID (buffer) && segment->format == GST_FORMAT_TIME) {
    running = gst_segment_to_running_time (segment, GST_FORMAT_TIME,
        GST_BUFFER_PTS (buffer));
  }
  GST_OBJECT_UNLOCK (pad);
  if (!GST_CLOCK_TIME_IS_VALID (running)) {
    return GST_CLOCK_STIME_NONE;
  }
  return (GstClockTimeDiff) running - offset;
}

static void
gst_cloth_sync_gather (GstClothSync * self, Heads * heads)
{
  GList *l;
  guint i;

  memset (heads, 0, sizeof (*heads));
  GST_OBJECT_LOCK (self);
  for (l = GST_ELEMENT (self)->sinkpads; l; l = l->next) {
    i = GST_CLOTH_SYNC_PAD (l->data)->index;
    heads->pad[i] = gst_object_ref (l->data);
    heads->n = MAX (heads->n, i + 1);
    heads->n_pads++;
  }
  GST_OBJECT_UNLOCK (self);

  for (i = 0; i < heads->n; i++) {
    GstAggregatorPad *pad = GST_AGGREGATOR_PAD_CAST (heads->pad[i]);
    GstBuffer *head;

    if (!pad) {
      continue;
    }
    head = heads->head[i] = gst_aggregator_pad_peek_buffer (pad);
    if (!head) {
      if (gst_aggregator_pad_is_eos (pad)) {
        heads->n_eos++;
      } else {
        heads->n_waiting++;
      }
      continue;
    }
    heads->gap[i] = GST_BUFFER_FLAG_IS_SET (head, GST_BUFFER_FLAG_GAP);
    heads->time[i] = gst_cloth_sync_time (self, heads->pad[i], head);
  }
}

static void
gst_cloth_sync_release_heads (Heads * heads)
{
  guint i;

  for (i = 0; i < heads->n; i++) {
    gst_clear_buffer (&heads->head[i]);
    gst_clear_object (&heads->pad[i]);
  }
}

/* The running time from which the live deadline counts: the next set's. NONE makes the
 * aggregator wait without a deadline, right while there is no frame at all. */
GstClockTime
gst_cloth_sync_get_next_time (GstAggregator * agg)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClockTimeDiff first = G_MAXINT64;
  Heads heads;
  guint i;

  /* the aggregator calls us with the lock that releasing a pad takes */
  gst_cloth_sync_gather (self, &heads);
  for (i = 0; i < heads.n; i++) {
    if (heads.head[i]) {
      /* a frame without a time is dealt with at once: its time is the least value */
      first = MIN (first, heads.time[i]);
    }
  }
  gst_cloth_sync_release_heads (&heads);
  return first == G_MAXINT64 ? GST_CLOCK_TIME_NONE : (GstClockTime) MAX (first,
      0);
}

/* Takes the head of a pad; see the release lock. */
static GstBuffer *
gst_cloth_sync_pop (GstClothSync * self, GstClothSyncPad * pad)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  GstBuffer *buffer;

  g_mutex_lock (&priv->release_lock);
  buffer = gst_aggregator_pad_pop_buffer (GST_AGGREGATOR_PAD_CAST (pad));
  g_mutex_unlock (&priv->release_lock);
  return buffer;
}

static void
gst_cloth_sync_discard_head (GstClothSync * self, GstClothSyncPad * pad)
{
  g_autoptr (GstBuffer) buffer = gst_cloth_sync_pop (self, pad);

  GST_LOG_OBJECT (pad, "discarded %" GST_PTR_FORMAT, buffer);
}

static void
gst_cloth_sync_drop (GstClothSync * self, GstClothSyncPad * pad,
    GstBuffer * buffer)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  GstAggregatorPad *aggpad = GST_AGGREGATOR_PAD (pad);
  GstClockTime pts = GST_BUFFER_PTS (buffer);
  GstMessage *message;

  GST_OBJECT_LOCK (self);
  priv->n_dropped++;
  pad->dropped++;
  GST_OBJECT_UNLOCK (self);
  GST_DEBUG_OBJECT (pad, "late frame dropped: %" GST_PTR_FORMAT, buffer);
  message = gst_message_new_qos (GST_OBJECT (self), TRUE,
      gst_segment_to_running_time (&aggpad->segment, GST_FORMAT_TIME, pts),
      gst_segment_to_stream_time (&aggpad->segment, GST_FORMAT_TIME, pts), pts,
      GST_BUFFER_DURATION (buffer));
  gst_message_set_qos_stats (message, GST_FORMAT_BUFFERS, pad->used,
      pad->dropped);
  gst_element_post_message (GST_ELEMENT (self), message);
  gst_cloth_sync_discard_head (self, pad);
}

/* Takes away heads that no set will want: frames too late for a set that has gone, and
 * gaps that end before the set at @first closes. TRUE when one was taken: what follows
 * it has to be looked at first. */
static gboolean
gst_cloth_sync_discard (GstClothSync * self, Heads * heads,
    GstClockTimeDiff first, GstClockTimeDiff tolerance)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  gboolean discarded = FALSE;
  guint i;

  for (i = 0; i < heads->n; i++) {
    GstClockTimeDiff time = heads->time[i];
    gboolean late;

    if (!heads->head[i] || !GST_CLOCK_STIME_IS_VALID (time)) {
      continue;
    }
    if (heads->gap[i]) {
      if (GST_BUFFER_DURATION_IS_VALID (heads->head[i])) {
        time += (GstClockTimeDiff) GST_BUFFER_DURATION (heads->head[i]);
      }
      if (first == G_MAXINT64 || time <= first + tolerance) {
        gst_cloth_sync_discard_head (self, heads->pad[i]);
        discarded = TRUE;
      }
      continue;
    }
    late = time < 0;
    if (priv->has_last) {
      late |= time <= priv->last_time;
      late |= !(priv->last_mask >> i & 1)
          && time <= priv->last_time + priv->last_tolerance;
    }
    if (late) {
      gst_cloth_sync_drop (self, heads->pad[i], heads->head[i]);
      discarded = TRUE;
    }
  }
  return discarded;
}

/* Says downstream that nothing comes for this set. Without it an element that joins our
 * stream with another one would wait, and fill the queues of the other, for ever. */
static void
gst_cloth_sync_push_gap (GstClothSync * self, GstClockTime pts,
    GstClockTime duration)
{
  GstPad *srcpad = GST_AGGREGATOR_SRC_PAD (self);
  g_autoptr (GstEvent) segment = NULL;

  if (!gst_pad_has_current_caps (srcpad)) {
    return;
  }
  segment = gst_pad_get_sticky_event (srcpad, GST_EVENT_SEGMENT, 0);
  if (!segment) {
    /* the aggregator sends it with its first buffer only */
    gst_pad_push_event (srcpad,
        gst_event_new_segment (&GST_AGGREGATOR_PAD (srcpad)->segment));
  }
  gst_pad_push_event (srcpad, gst_event_new_gap (pts, duration));
}

/* Pops the heads of the set and hands them to the subclass. */
static GstFlowReturn
gst_cloth_sync_emit (GstClothSync * self, Heads * heads, guint64 mask,
    GstClockTimeDiff time)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  GstAggregator *agg = GST_AGGREGATOR (self);
  GstSegment *segment = &GST_AGGREGATOR_PAD (agg->srcpad)->segment;
  GstBuffer *views[GST_CLOTH_SYNC_MAX_PADS] = { NULL };
  GstBuffer *out = NULL;
  GstClockTime duration = GST_CLOCK_TIME_NONE, pts = GST_CLOCK_TIME_NONE;
  GstFlowReturn ret = GST_FLOW_OK;
  gboolean enough, inside = TRUE;
  guint i, n_views = 0;

  for (i = 0; i < heads->n; i++) {
    if (!(mask >> i & 1)) {
      continue;
    }
    /* only one reference must be left, so that the subclass can write in place */
    gst_clear_buffer (&heads->head[i]);
    views[i] = gst_cloth_sync_pop (self, heads->pad[i]);
    if (!views[i]) {
      mask &= ~(G_GUINT64_CONSTANT (1) << i);   /* flushed meanwhile */
      continue;
    }
    n_views++;
    duration = MIN (duration, GST_BUFFER_DURATION (views[i]));
    GST_OBJECT_LOCK (self);
    heads->pad[i]->used++;
    if (!GST_CLOCK_TIME_IS_VALID (duration)) {
      duration = heads->pad[i]->period;
    }
    GST_OBJECT_UNLOCK (self);
  }
  if (GST_CLOCK_STIME_IS_VALID (time)) {
    GST_OBJECT_LOCK (self);
    pts = gst_segment_position_from_running_time (segment, GST_FORMAT_TIME,
        (guint64) time);
    inside = GST_CLOCK_TIME_IS_VALID (pts);
    if (inside) {
      segment->position = pts;
    }
    GST_OBJECT_UNLOCK (self);
  }

  GST_OBJECT_LOCK (self);
  enough = n_views > 0 && n_views >= priv->min_views;
  if (!enough || !inside) {
    priv->n_incomplete++;
  } else {
    priv->n_sets++;
  }
  GST_OBJECT_UNLOCK (self);
  GST_LOG_OBJECT (self, "set at %" GST_STIME_FORMAT ", views %#"
      G_GINT64_MODIFIER "x%s", GST_STIME_ARGS (time), mask,
      enough ? "" : ": too few");

  /* without caps (a live deadline before any pad had them) there is nothing to send */
  if (enough && inside && gst_pad_has_current_caps (agg->srcpad)) {
    ret =
        GST_CLOTH_SYNC_GET_CLASS (self)->process_set (self, views, heads->n,
        mask, pts, duration, &out);
  }
  for (i = 0; i < heads->n; i++) {
    gst_clear_buffer (&views[i]);
  }
  if (ret != GST_FLOW_OK || !out) {
    gst_clear_buffer (&out);
    if (ret == GST_FLOW_OK && GST_CLOCK_TIME_IS_VALID (pts)) {
      gst_cloth_sync_push_gap (self, pts, duration);
    }
    return ret;
  }
  if (GST_BUFFER_PTS (out) != pts || GST_BUFFER_DURATION (out) != duration) {
    out = gst_buffer_make_writable (out);
    GST_BUFFER_PTS (out) = pts;
    GST_BUFFER_DURATION (out) = duration;
  }
  return gst_aggregator_finish_buffer (agg, out);
}

static GstFlowReturn
gst_cloth_sync_end (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  gboolean all_incomplete;
  guint min_views;

  GST_OBJECT_LOCK (self);
  all_incomplete = priv->n_sets == 0 && priv->n_incomplete > 0;
  min_views = priv->min_views;
  GST_OBJECT_UNLOCK (self);
  if (all_incomplete) {
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("No instant had frames from %u pads, so nothing was sent.", min_views),
        ("Lower min-views, raise tolerance, or check that the streams' times "
            "overlap."));
  }
  return GST_FLOW_EOS;
}

GstFlowReturn
gst_cloth_sync_aggregate (GstAggregator * agg, gboolean timeout)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  GstFlowReturn ret = GST_AGGREGATOR_FLOW_NEED_DATA;
  GstClockTimeDiff first = G_MAXINT64, tolerance;
  guint64 mask = 0;
  gint untimed = -1;
  Heads heads;
  guint i;

  gst_cloth_sync_forget_released (self);
  GST_OBJECT_LOCK (self);
  tolerance = (GstClockTimeDiff) priv->effective;
  GST_OBJECT_UNLOCK (self);

  g_mutex_lock (&priv->release_lock);
  gst_cloth_sync_gather (self, &heads);
  g_mutex_unlock (&priv->release_lock);
  if (heads.n_eos == heads.n_pads) {
    ret = gst_cloth_sync_end (self);
    goto done;
  }
  if (heads.n_waiting > 0 && !timeout) {
    goto done;                  /* what came was clipped away, or the pad is new */
  }
  for (i = 0; i < heads.n; i++) {
    if (!heads.head[i]) {
      continue;
    }
    if (!GST_CLOCK_STIME_IS_VALID (heads.time[i])) {
      untimed = (gint) i;
    } else if (!heads.gap[i]) {
      first = MIN (first, heads.time[i]);
    }
  }
  if (untimed >= 0) {
    if (heads.n_pads > 1) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("A frame on pad %s has no time stamp.",
              GST_PAD_NAME (heads.pad[untimed])),
          ("Streams are joined by running time. Let the source stamp its frames "
              "(do-timestamp=true) or put videorate before this pad."));
      ret = GST_FLOW_ERROR;
    } else {
      /* nothing to join with: order is enough */
      ret =
          gst_cloth_sync_emit (self, &heads, G_GUINT64_CONSTANT (1) << untimed,
          GST_CLOCK_STIME_NONE);
    }
    goto done;
  }
  if (gst_cloth_sync_discard (self, &heads, first, tolerance)
      || first == G_MAXINT64) {
    goto done;
  }

  for (i = 0; i < heads.n; i++) {
    if (heads.head[i] && !heads.gap[i] && heads.time[i] <= first + tolerance) {
      mask |= G_GUINT64_CONSTANT (1) << i;
    }
  }
  priv->has_last = TRUE;
  priv->last_time = first;
  priv->last_tolerance = tolerance;
  priv->last_mask = mask;
  if (timeout) {
    GST_DEBUG_OBJECT (self, "deadline: set at %" GST_STIME_FORMAT
        " goes without the missing views", GST_STIME_ARGS (first));
  }
  ret = gst_cloth_sync_emit (self, &heads, mask, first);

done:
  gst_cloth_sync_release_heads (&heads);
  return ret;
}
