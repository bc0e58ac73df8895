/* Base of the elements that join several streams by running time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsync.h"

#include <gst/video/video.h>

#include "elements/gstclothproperties.h"
#include "elements/gstclothsyncgaps.h"
#include "elements/gstclothsyncheads.h"
#include "elements/gstclothsyncmessages.h"
#include "elements/gstclothsyncqueries.h"

GST_DEBUG_CATEGORY_STATIC (cloth_sync_debug);
#define GST_CAT_DEFAULT cloth_sync_debug

/* Half a frame at 30 Hz, when no pad says how fast its frames come. */
#define FALLBACK_TOLERANCE (GST_SECOND / 60)
/* Keeps sums of times far from overflow. */
#define MAX_TOLERANCE (3600 * GST_SECOND)
#define MAX_JUMP (10 * GST_SECOND)
/* What detectors before this element take for a picture, on a machine that does much else:
 * frames that are all there don't wait for it. */
#define LATENCY (200 * GST_MSECOND)

typedef struct
{
  /* Held while a pad is released and while the streaming thread takes frames from pads:
   * GstAggregator drops the frame that a subclass has looked at without the pad's
   * lock. Taken before all of the aggregator's own locks. */
  GMutex release_lock;

  /* with the object lock */
  GstClockTime tolerance, max_jump;
  guint min_views;
  GstClockTimeDiff offset[GST_CLOTH_SYNC_MAX_PADS];
  GstClockTime effective;       /* the tolerance in force */
  guint64 taken;                /* indices in use */
  guint64 released;             /* of pads that the subclass still believes in */
  guint64 n_sets, n_incomplete, n_skipped, n_dropped, n_implausible;
  gboolean is_playing;          /* while paused no camera gives anything */

  /* streaming thread */
  guint64 n_lately, n_lacking;  /* sets since the last flush, of them incomplete ones */
  gboolean is_live;
  gboolean has_last;
  GstClockTimeDiff last_time;
  GstClockTime last_tolerance;
  guint64 last_mask;
  GstClothSyncGaps gaps;
  GstSegment segment[GST_CLOTH_SYNC_MAX_PADS];  /* of the set's views */
} GstClothSyncPrivate;

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"tolerance", "Tolerance",
    "Frames at most this long after the earliest frame of a set belong to "
    "it, in ns; less than a frame period. Default (the largest value): half "
    "the frame period of the fastest pad, or 1/60 s when no pad has a "
    "frame rate",
    G_TYPE_UINT64, GST_CLOTH_SETTING (GstClothSyncPrivate, tolerance),
    GST_PARAM_MUTABLE_PLAYING},
  {"min-views", "Minimum views",
    "Sets with frames from fewer pads than this are dropped",
    G_TYPE_UINT, GST_CLOTH_SETTING (GstClothSyncPrivate, min_views),
    GST_PARAM_MUTABLE_PLAYING, 1, GST_CLOTH_SYNC_MAX_PADS},
  {"max-jump", "Largest jump in time",
    "A frame farther than this ahead of the one before it on its pad, in ns, "
    "and twice as far as that one was from its own, waits until the next "
    "one's time bears it out or contradicts it: then it is dropped. The "
    "largest value believes every time stamp",
    G_TYPE_UINT64, GST_CLOTH_SETTING (GstClothSyncPrivate, max_jump),
    GST_PARAM_MUTABLE_PLAYING},
};
/* *INDENT-ON* */

/* The counts follow the properties of the table. */
#define PROP_STATS (G_N_ELEMENTS (properties) + 1)

static const GstClothSyncPrivate defaults = {
  .tolerance = GST_CLOCK_TIME_NONE,
  .max_jump = MAX_JUMP,
  .min_views = 1,
  .effective = FALLBACK_TOLERANCE
};

G_DEFINE_ABSTRACT_TYPE_WITH_CODE (GstClothSync, gst_cloth_sync,
    GST_TYPE_AGGREGATOR, G_ADD_PRIVATE (GstClothSync)
    GST_DEBUG_CATEGORY_INIT (cloth_sync_debug, "clothsync", 0,
        "joining of streams by running time"));

/* Tolerance and latency follow from the pads' number, frame rates and offsets. */
static void
gst_cloth_sync_update_timing (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstClockTime fastest = GST_CLOCK_TIME_NONE, latency;
  GstClockTimeDiff latest = 0;
  GList *l;
  guint i;

  GST_OBJECT_LOCK (self);
  for (l = GST_ELEMENT (self)->sinkpads; l; l = l->next) {
    /* NONE is the largest value */
    fastest = MIN (fastest, GST_CLOTH_SYNC_PAD (l->data)->period);
  }
  if (GST_CLOCK_TIME_IS_VALID (priv->tolerance)) {
    priv->effective = MIN (priv->tolerance, MAX_TOLERANCE);
  } else if (GST_CLOCK_TIME_IS_VALID (fastest)) {
    priv->effective = fastest / 2;
  } else {
    priv->effective = FALLBACK_TOLERANCE;
  }
  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    latest = MAX (latest, priv->offset[i]);
  }
  /* one stream alone waits for nothing */
  latency =
      latest + (GST_ELEMENT (self)->numsinkpads > 1 ? priv->effective : 0);
  GST_OBJECT_UNLOCK (self);

  gst_aggregator_set_latency (GST_AGGREGATOR (self), latency, latency);
}

static gboolean
gst_cloth_sync_take_index (GstClothSync * self, guint index)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  gboolean is_free;

  GST_OBJECT_LOCK (self);
  is_free = !(priv->taken & (G_GUINT64_CONSTANT (1) << index));
  priv->taken |= G_GUINT64_CONSTANT (1) << index;
  GST_OBJECT_UNLOCK (self);
  return is_free;
}

static gint
gst_cloth_sync_take_free_index (GstClothSync * self)
{
  guint i;

  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS; i++) {
    if (gst_cloth_sync_take_index (self, i)) {
      return (gint) i;
    }
  }
  return -1;
}

static GstAggregatorPad *
gst_cloth_sync_create_new_pad (GstAggregator * agg, GstPadTemplate * templ,
    const gchar * req_name, const GstCaps * caps)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClothSyncPad *pad;
  g_autofree gchar *name = NULL;
  gint index;

  if (templ->direction != GST_PAD_SINK || templ->presence != GST_PAD_REQUEST) {
    return NULL;
  }
  if (!strchr (templ->name_template, '%')) {
    g_autoptr (GstPad) present =
        gst_element_get_static_pad (GST_ELEMENT (self), templ->name_template);

    if (present) {
      GST_WARNING_OBJECT (self, "pad %s is there already",
          templ->name_template);
      return NULL;
    }
    index = gst_cloth_sync_take_free_index (self);
    name = g_strdup (templ->name_template);
  } else if (req_name && !strchr (req_name, '%')) {
    const gchar *digits = req_name + strcspn (templ->name_template, "%");
    guint64 number;

    /* gst_element_request_pad has matched the name against the template */
    if (!g_ascii_string_to_unsigned (digits, 10, 0,
            GST_CLOTH_SYNC_MAX_PADS - 1, &number, NULL)) {
      GST_WARNING_OBJECT (self, "no pad %s: pads are numbered 0 to %d",
          req_name, GST_CLOTH_SYNC_MAX_PADS - 1);
      return NULL;
    }
    if (!gst_cloth_sync_take_index (self, (guint) number)) {
      GST_WARNING_OBJECT (self, "pad %s is there already", req_name);
      return NULL;
    }
    index = (gint) number;
    name = g_strdup (req_name);
  } else {
    index = gst_cloth_sync_take_free_index (self);
    name = g_strdup_printf ("%.*s%d", (int) strcspn (templ->name_template, "%"),
        templ->name_template, index);
  }
  if (index < 0) {
    GST_WARNING_OBJECT (self, "no more than %d pads", GST_CLOTH_SYNC_MAX_PADS);
    return NULL;
  }

  pad = g_object_new (g_type_is_a (GST_PAD_TEMPLATE_GTYPE (templ),
          GST_TYPE_CLOTH_SYNC_PAD) ? GST_PAD_TEMPLATE_GTYPE (templ) :
      GST_TYPE_CLOTH_SYNC_PAD, "name", name, "direction", GST_PAD_SINK,
      "template", templ, NULL);
  pad->index = (guint) index;
  return GST_AGGREGATOR_PAD (pad);
}

/* The deadline of one stream is not that of several. */
static GstPad *
gst_cloth_sync_request_new_pad (GstElement * element, GstPadTemplate * templ,
    const gchar * name, const GstCaps * caps)
{
  GstPad *pad =
      GST_ELEMENT_CLASS (gst_cloth_sync_parent_class)->request_new_pad (element,
      templ, name, caps);

  if (pad) {
    gst_cloth_sync_update_timing (GST_CLOTH_SYNC (element));
    gst_element_post_message (element,
        gst_message_new_latency (GST_OBJECT (element)));
  }
  return pad;
}

void
gst_cloth_sync_add_always_pad (GstClothSync * self, const gchar * templ_name)
{
  GstPadTemplate *templ =
      gst_element_get_pad_template (GST_ELEMENT (self), templ_name);
  GstClothSyncPad *pad = g_object_new (GST_TYPE_CLOTH_SYNC_PAD, "name",
      templ_name, "direction", GST_PAD_SINK, "template", templ, NULL);

  pad->index = (guint) gst_cloth_sync_take_free_index (self);
  gst_element_add_pad (GST_ELEMENT (self), GST_PAD (pad));
}

void
gst_cloth_sync_set_pad_offset (GstClothSync * self, guint index,
    GstClockTimeDiff offset)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstClockTimeDiff before;

  g_return_if_fail (index < GST_CLOTH_SYNC_MAX_PADS);

  GST_OBJECT_LOCK (self);
  before = priv->offset[index];
  priv->offset[index] = offset;
  GST_OBJECT_UNLOCK (self);
  gst_cloth_sync_pads_shift_held (GST_ELEMENT (self), index, before, offset);
  gst_cloth_sync_update_timing (self);
}

const GstSegment *
gst_cloth_sync_get_segment (GstClothSync * self, guint index)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);

  return &priv->segment[index];
}

static void
gst_cloth_sync_release_pad (GstElement * element, GstPad * pad)
{
  GstClothSync *self = GST_CLOTH_SYNC (element);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  guint64 bit = G_GUINT64_CONSTANT (1) << GST_CLOTH_SYNC_PAD (pad)->index;

  g_mutex_lock (&priv->release_lock);
  GST_ELEMENT_CLASS (gst_cloth_sync_parent_class)->release_pad (element, pad);
  g_mutex_unlock (&priv->release_lock);

  GST_OBJECT_LOCK (self);
  priv->taken &= ~bit;
  priv->released |= bit;
  GST_OBJECT_UNLOCK (self);
  gst_cloth_sync_update_timing (self);
  gst_element_post_message (element,
      gst_message_new_latency (GST_OBJECT (element)));
}

/* Tells the subclass, from the streaming thread, of the pads that have gone. */
static void
gst_cloth_sync_forget_released (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (self);
  guint64 released;
  guint i;

  GST_OBJECT_LOCK (self);
  released = priv->released;
  priv->released = 0;
  GST_OBJECT_UNLOCK (self);
  if (!released) {
    return;
  }
  for (i = 0; i < GST_CLOTH_SYNC_MAX_PADS && klass->set_pad_caps; i++) {
    if (released >> i & 1) {
      klass->set_pad_caps (self, i, NULL);
    }
  }
  priv->last_mask &= ~released;
  gst_pad_mark_reconfigure (GST_AGGREGATOR_SRC_PAD (self));
}

static gboolean
gst_cloth_sync_sink_event (GstAggregator * agg, GstAggregatorPad * aggpad,
    GstEvent * event)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (self);
  GstClothSyncPad *pad = GST_CLOTH_SYNC_PAD (aggpad);

  if (GST_EVENT_TYPE (event) == GST_EVENT_CAPS) {
    GstCaps *caps;

    gst_clear_event (&pad->caps);
    if (gst_cloth_sync_pad_is_holding (pad)) {
      /* what is held is of the caps before */
      pad->caps = event;
      return TRUE;
    }
    gst_cloth_sync_forget_released (self);
    gst_event_parse_caps (event, &caps);
    gst_cloth_sync_pad_set_period (pad, GST_ELEMENT (self), caps);
    gst_cloth_sync_update_timing (self);
    if (klass->set_pad_caps && !klass->set_pad_caps (self, pad->index, caps)) {
      gst_event_unref (event);
      return FALSE;
    }
    gst_pad_mark_reconfigure (GST_AGGREGATOR_SRC_PAD (self));
  }
  return GST_AGGREGATOR_CLASS (gst_cloth_sync_parent_class)->sink_event (agg,
      aggpad, event);
}

/* Before it is queued: the base class computes with the queue's last segment. */
static GstFlowReturn
gst_cloth_sync_sink_event_pre_queue (GstAggregator * agg,
    GstAggregatorPad * aggpad, GstEvent * event)
{
  if (GST_EVENT_TYPE (event) == GST_EVENT_SEGMENT &&
      !gst_cloth_sync_pad_check_segment (GST_CLOTH_SYNC_PAD (aggpad),
          GST_ELEMENT (agg), event)) {
    gst_event_unref (event);
    return GST_FLOW_ERROR;
  }
  return GST_AGGREGATOR_CLASS
      (gst_cloth_sync_parent_class)->sink_event_pre_queue (agg, aggpad, event);
}

/* Handles the caps that have waited for a held frame to go, or to be flushed. Where there are any
 * the source pad has to be negotiated before a set is made: more data are needed. */
static GstFlowReturn
gst_cloth_sync_take_caps (GstClothSync * self)
{
  g_autoptr (GList) pads = gst_cloth_sync_pad_list (GST_ELEMENT (self));
  GstFlowReturn ret = GST_FLOW_OK;

  for (GList * l = pads; l; l = l->next) {
    g_autoptr (GstClothSyncPad) pad = l->data;

    if (pad->caps && !gst_cloth_sync_pad_is_holding (pad)) {
      if (!gst_cloth_sync_sink_event (GST_AGGREGATOR (self),
              GST_AGGREGATOR_PAD (pad), g_steal_pointer (&pad->caps))) {
        ret = GST_FLOW_NOT_NEGOTIATED;
      } else if (ret == GST_FLOW_OK) {
        ret = GST_AGGREGATOR_FLOW_NEED_DATA;
      }
    }
  }
  return ret;
}

static GstFlowReturn
gst_cloth_sync_update_src_caps (GstAggregator * agg, GstCaps * downstream,
    GstCaps ** caps)
{
  GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (agg);

  if (klass->negotiate_src) {
    return klass->negotiate_src (GST_CLOTH_SYNC (agg), downstream, caps);
  }
  *caps = gst_caps_ref (downstream);
  return GST_FLOW_OK;
}

/* Any stride and plane offset is fine: frames are read through GstVideoMeta. */
static gboolean
gst_cloth_sync_propose_allocation (GstAggregator * agg, GstAggregatorPad * pad,
    GstQuery * decide_query, GstQuery * query)
{
  gst_query_add_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL);
  return TRUE;
}

static void
gst_cloth_sync_restart (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (self);
  g_autoptr (GList) pads = gst_cloth_sync_pad_list (GST_ELEMENT (self));

  priv->has_last = FALSE;
  priv->gaps.told = GST_CLOCK_STIME_NONE;
  GST_OBJECT_LOCK (self);
  priv->n_lately = priv->n_lacking = 0;
  GST_AGGREGATOR_PAD (GST_AGGREGATOR_SRC_PAD (self))->segment.position =
      GST_CLOCK_TIME_NONE;
  GST_OBJECT_UNLOCK (self);
  for (GList * l = pads; l; l = l->next) {
    gst_cloth_sync_pad_restart (GST_CLOTH_SYNC_PAD (l->data),
        GST_ELEMENT (self));
    gst_object_unref (l->data);
  }
  if (klass->reset) {
    klass->reset (self);
  }
}

static GstFlowReturn
gst_cloth_sync_flush (GstAggregator * agg)
{
  gst_cloth_sync_restart (GST_CLOTH_SYNC (agg));
  return GST_FLOW_OK;
}

static gboolean
gst_cloth_sync_start (GstAggregator * agg)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);

  GST_OBJECT_LOCK (self);
  priv->n_sets = priv->n_incomplete = priv->n_skipped = 0;
  priv->n_dropped = priv->n_implausible = 0;
  for (GList * l = GST_ELEMENT (self)->sinkpads; l; l = l->next) {
    GstClothSyncPad *pad = GST_CLOTH_SYNC_PAD (l->data);

    pad->warned_ahead = pad->warned_back = FALSE;
    pad->warned_untimed = pad->warned_late = FALSE;
    pad->used = pad->missing = pad->dropped = pad->implausible = 0;
    gst_clear_event (&pad->caps);
  }
  GST_OBJECT_UNLOCK (self);
  priv->is_live = FALSE;
  gst_cloth_sync_restart (self);
  return TRUE;
}

static gboolean
gst_cloth_sync_stop (GstAggregator * agg)
{
  gst_cloth_sync_restart (GST_CLOTH_SYNC (agg));
  return TRUE;
}

static void
gst_cloth_sync_set_playing (GstClothSync * self, gboolean is_playing)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);

  GST_OBJECT_LOCK (self);
  priv->is_playing = is_playing;
  GST_OBJECT_UNLOCK (self);
  if (is_playing) {
    /* The streaming thread may wait without a deadline: the aggregator wakes it when it is
     * asked for its latency. */
    g_autoptr (GstQuery) query = gst_query_new_latency ();

    gst_pad_query (GST_AGGREGATOR_SRC_PAD (self), query);
  }
}

static GstStateChangeReturn
gst_cloth_sync_change_state (GstElement * element, GstStateChange transition)
{
  GstStateChangeReturn ret;

  if (transition == GST_STATE_CHANGE_PLAYING_TO_PAUSED) {
    gst_cloth_sync_set_playing (GST_CLOTH_SYNC (element), FALSE);
  }
  ret =
      GST_ELEMENT_CLASS (gst_cloth_sync_parent_class)->change_state (element,
      transition);
  if (transition == GST_STATE_CHANGE_PAUSED_TO_PLAYING
      && ret != GST_STATE_CHANGE_FAILURE) {
    gst_cloth_sync_set_playing (GST_CLOTH_SYNC (element), TRUE);
  }
  return ret;
}

/* ---- the joining of streams ----
 *
 * How a set is made. The earliest frame at the head of any pad gives the set its time
 * t; every head of running time <= t + tolerance belongs to it, one frame a pad. When
 * not live the base waits until every pad that is not at EOS has a head, so the sets
 * depend on the time stamps alone and not on which thread came first. When live it
 * waits no longer than clock time t + latency (upstream's, the tolerance and the
 * latency property) and goes on with what is there. A GAP says that a pad has nothing
 * for a while: it is never a view, but it spares the wait. */

/* What to do about the time of the head of pad @i. A live stream may have been silent until
 * now, and its frames come when they are made. */
static GstClothSyncVerdict
gst_cloth_sync_judge (GstClothSync * self, const GstClothSyncHeads * heads,
    guint i, gboolean is_live)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstClockTimeDiff start = priv->has_last ? priv->last_time : 0;
  GstClockTime max_jump, now;

  GST_OBJECT_LOCK (self);
  max_jump = priv->max_jump;
  GST_OBJECT_UNLOCK (self);
  if (is_live) {
    now = gst_element_get_current_running_time (GST_ELEMENT (self));
    if (GST_CLOCK_TIME_IS_VALID (now)) {
      start = MAX (start, (GstClockTimeDiff) MIN (now, (guint64) G_MAXINT64));
    }
  }
  return gst_cloth_sync_pad_judge (heads->pad[i],
      heads->head[i] ? heads->time[i] : GST_CLOCK_STIME_NONE, start, max_jump);
}

/* Counts silence from now on where it isn't counted yet. Returns whether it is to be told of. */
static gboolean
gst_cloth_sync_count_silence (GstClothSync * self,
    const GstClothSyncHeads * heads)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  const GstClockTime now =
      gst_element_get_current_running_time (GST_ELEMENT (self));
  gboolean is_playing;
  guint i;

  GST_OBJECT_LOCK (self);
  is_playing = priv->is_playing;
  GST_OBJECT_UNLOCK (self);
  if (!is_playing || !GST_CLOCK_TIME_IS_VALID (now)
      || !GST_CLOTH_SYNC_GET_CLASS (self)->prefix) {
    return FALSE;
  }
  for (i = 0; i < heads->n; i++) {
    if (heads->pad[i]) {
      gst_cloth_sync_pad_expect (heads->pad[i],
          (GstClockTimeDiff) MIN (now, (guint64) G_MAXINT64));
    }
  }
  return TRUE;
}

/* Notes which camera the pad's frames are of, as the subclass knows by now. */
static void
gst_cloth_sync_name_camera (GstClothSync * self, GstClothSyncPad * pad)
{
  GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (self);

  gst_cloth_sync_pad_set_camera (pad, GST_ELEMENT (self),
      klass->get_camera ? klass->get_camera (self, pad->index) : NULL);
}

static void
gst_cloth_sync_set_silent (GstClothSync * self, GstClothSyncPad * pad,
    gboolean silent, GstClockTimeDiff now)
{
  gst_cloth_sync_name_camera (self, pad);
  gst_cloth_sync_pad_set_silent (pad, GST_ELEMENT (self),
      GST_CLOTH_SYNC_GET_CLASS (self)->prefix, silent, now);
}

/* Tells of the pads of a live stream that have given nothing for long at the common time
 * @now; NONE: by the clock, no set says what time it is. */
static void
gst_cloth_sync_look_for_silence (GstClothSync * self,
    const GstClothSyncHeads * heads, GstClockTimeDiff now)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  const gboolean minds = priv->is_live
      && gst_cloth_sync_count_silence (self, heads);
  guint i;

  if (!GST_CLOCK_STIME_IS_VALID (now)) {
    const GstClockTime clock =
        gst_element_get_current_running_time (GST_ELEMENT (self));

    /* none is before all times */
    now = GST_CLOCK_TIME_IS_VALID (clock) ?
        (GstClockTimeDiff) MIN (clock, (guint64) G_MAXINT64) : now;
  }
  for (i = 0; i < heads->n && minds; i++) {
    const GstClockTimeDiff time = gst_cloth_sync_heads_silent_at (heads, i);

    if (GST_CLOCK_STIME_IS_VALID (time) && time <= now) {
      gst_cloth_sync_set_silent (self, heads->pad[i], TRUE, now);
    }
  }
}

/* The running time from which the live deadline counts: the next set's, or, while there is no
 * frame at all, that at which silence has lasted long. NONE makes the aggregator wait without
 * a deadline. It matters for live streams only. */
static GstClockTime
gst_cloth_sync_get_next_time (GstAggregator * agg)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstClockTimeDiff first = 0;
  gboolean has_first = FALSE, minds;
  GstClothSyncHeads heads;
  guint i;

  /* the aggregator calls us with the lock that releasing a pad takes */
  gst_cloth_sync_heads_gather (&heads, GST_ELEMENT (self), priv->offset);
  for (i = 0; i < heads.n; i++) {
    if (heads.head[i]) {
      /* a frame without a time, and one that is doubted, is dealt with at once */
      const GstClockTimeDiff time = GST_CLOCK_STIME_IS_VALID (heads.time[i])
          && gst_cloth_sync_judge (self, &heads, i, TRUE) ==
          GST_CLOTH_SYNC_KEEP ? MAX (heads.time[i], 0) : 0;

      first = has_first ? MIN (first, time) : time;
      has_first = TRUE;
    }
  }
  minds = gst_cloth_sync_count_silence (self, &heads);
  for (i = 0; i < heads.n && heads.n_heads == 0 && minds; i++) {
    const GstClockTimeDiff time = gst_cloth_sync_heads_silent_at (&heads, i);

    if (GST_CLOCK_STIME_IS_VALID (time)) {
      first = has_first ? MIN (first, time) : time;
      has_first = TRUE;
    }
  }
  gst_cloth_sync_heads_release (&heads);
  return has_first ? (GstClockTime) first : GST_CLOCK_TIME_NONE;
}

/* Takes the head of a pad; see the release lock. */
static GstBuffer *
gst_cloth_sync_pop (GstClothSync * self, GstClothSyncPad * pad)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstBuffer *buffer;

  g_mutex_lock (&priv->release_lock);
  buffer = gst_cloth_sync_pad_take (pad);
  g_mutex_unlock (&priv->release_lock);
  return buffer;
}

static void
gst_cloth_sync_count_implausible (GstClothSync * self, GstClothSyncPad * pad)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);

  GST_OBJECT_LOCK (self);
  priv->n_implausible++;
  pad->implausible++;
  GST_OBJECT_UNLOCK (self);
}

/* Drops a frame whose time its successor, if any, contradicts. */
static void
gst_cloth_sync_refuse (GstClothSync * self, GstClothSyncPad * pad,
    gboolean is_last)
{
  gst_cloth_sync_count_implausible (self, pad);
  gst_cloth_sync_say_refused (GST_ELEMENT (self), pad, is_last);
  gst_cloth_sync_pad_refuse (pad);
}

/* Drops a frame without a time on a pad that has had times, among others. */
static void
gst_cloth_sync_refuse_untimed (GstClothSync * self, GstClothSyncPad * pad)
{
  GstBuffer *buffer = gst_cloth_sync_pop (self, pad);

  gst_clear_buffer (&buffer);
  gst_cloth_sync_count_implausible (self, pad);
  gst_cloth_sync_say_untimed (GST_ELEMENT (self), pad);
}

/* Believes in a jump, and says so where the others have not jumped: they go on without. */
static void
gst_cloth_sync_believe (GstClothSync * self, const GstClothSyncHeads * heads,
    guint i)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstClothSyncPad *pad = heads->pad[i];
  gboolean alone = FALSE;
  GstClockTime max_jump;

  GST_OBJECT_LOCK (self);
  max_jump = priv->max_jump;
  GST_OBJECT_UNLOCK (self);
  for (guint k = 0; k < heads->n; k++) {
    alone |= k != i && heads->head[k] && !heads->gap[k]
        && !gst_cloth_sync_pad_is_holding (heads->pad[k])
        && !gst_cloth_sync_is_within (pad->held_time, heads->time[k], max_jump);
  }
  if (alone && GST_CLOCK_STIME_IS_VALID (pad->last)) {
    gst_cloth_sync_say_jump (GST_ELEMENT (self), pad);
  }
  gst_cloth_sync_pad_believe (pad);
}

/* Looks whether the heads' times can be believed. TRUE when a head has changed: they have
 * to be looked at anew. */
static gboolean
gst_cloth_sync_settle_times (GstClothSync * self, GstClothSyncHeads * heads)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  gboolean changed = FALSE;
  guint i;

  for (i = 0; i < heads->n; i++) {
    GstClothSyncPad *pad = heads->pad[i];
    const GstClockTimeDiff time = heads->time[i];
    GstBuffer *buffer;
    guint n_flushes;

    if (!pad) {
      continue;
    }
    if (heads->head[i] && !GST_CLOCK_STIME_IS_VALID (time)) {
      if (heads->n_pads > 1 && GST_CLOCK_STIME_IS_VALID (pad->last)) {
        gst_clear_buffer (&heads->head[i]);
        gst_cloth_sync_refuse_untimed (self, pad);
        changed = TRUE;
      }
      continue;
    }
    switch (gst_cloth_sync_judge (self, heads, i, priv->is_live)) {
      case GST_CLOTH_SYNC_KEEP:
        if (heads->head[i]) {
          if (pad->silent) {
            gst_cloth_sync_set_silent (self, pad, FALSE, time);
          }
          gst_cloth_sync_pad_note (pad, time,
              gst_cloth_sync_heads_get_end (heads, i));
        }
        continue;
      case GST_CLOTH_SYNC_HOLD:
        n_flushes = gst_cloth_sync_pad_count_flushes (pad);
        buffer = gst_cloth_sync_pop (self, pad);
        /* flushed meanwhile, it is not there or another one, which may be held as well */
        if (buffer && buffer != heads->head[i]) {
          n_flushes = gst_cloth_sync_pad_count_flushes (pad);
        }
        if (buffer) {
          gst_cloth_sync_pad_hold (pad, buffer,
              gst_cloth_sync_pad_get_time (pad, GST_ELEMENT (self),
                  priv->offset, buffer), n_flushes);
        }
        break;
      case GST_CLOTH_SYNC_BELIEVE:
        gst_cloth_sync_believe (self, heads, i);
        break;
      case GST_CLOTH_SYNC_REFUSE:
        gst_cloth_sync_refuse (self, pad, !heads->head[i]);
        break;
    }
    changed = TRUE;
  }
  return changed;
}

static void
gst_cloth_sync_discard_head (GstClothSync * self, GstClothSyncPad * pad)
{
  g_autoptr (GstBuffer) buffer = gst_cloth_sync_pop (self, pad);

  GST_LOG_OBJECT (pad, "discarded %" GST_PTR_FORMAT, buffer);
}

static void
gst_cloth_sync_drop (GstClothSync * self, GstClothSyncPad * pad,
    GstBuffer * buffer, GstClockTimeDiff time)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  const GstClockTime late = priv->has_last ?
      gst_cloth_sync_get_lateness (GST_AGGREGATOR (self), priv->last_time,
      time) : 0;
  GstClockTime max_jump, latency;

  g_object_get (self, "latency", &latency, NULL);
  GST_OBJECT_LOCK (self);
  max_jump = priv->max_jump;
  priv->n_dropped++;
  pad->dropped++;
  GST_OBJECT_UNLOCK (self);
  gst_cloth_sync_say_dropped (GST_ELEMENT (self), pad, buffer);
  if (priv->has_last
      && !gst_cloth_sync_is_within (priv->last_time, time, max_jump)) {
    gst_cloth_sync_say_far_back (GST_ELEMENT (self), pad, time,
        priv->last_time);
  } else if (late > 0) {
    GST_OBJECT_LOCK (self);
    pad->late++;
    GST_OBJECT_UNLOCK (self);
    gst_cloth_sync_say_late (GST_ELEMENT (self), pad, late, latency);
  }
  gst_cloth_sync_discard_head (self, pad);
}

/* Takes away heads that no set will want: frames too late for a set that has gone, and
 * gaps that end before the set at @first closes, or with @first %NULL those that end first. TRUE
 * when one was taken: what follows it has to be looked at first. */
static gboolean
gst_cloth_sync_discard (GstClothSync * self, GstClothSyncHeads * heads,
    const GstClockTimeDiff * first, GstClockTime tolerance)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  const GstClockTimeDiff gap_end = gst_cloth_sync_heads_get_gap_end (heads);
  gboolean discarded = FALSE;
  guint i;

  for (i = 0; i < heads->n; i++) {
    GstClockTimeDiff time = heads->time[i];
    gboolean late;

    if (!heads->head[i] || !GST_CLOCK_STIME_IS_VALID (time)) {
      continue;
    }
    if (heads->gap[i]) {
      const GstClockTimeDiff end = gst_cloth_sync_heads_get_end (heads, i);

      if (first ? gst_cloth_sync_is_within (end, *first, tolerance) :
          end == gap_end) {
        gst_cloth_sync_discard_head (self, heads->pad[i]);
        discarded = TRUE;
      }
      continue;
    }
    late = time < 0;
    if (priv->has_last) {
      late |= time <= priv->last_time;
      late |= !(priv->last_mask >> i & 1)
          && gst_cloth_sync_is_within (time, priv->last_time,
          priv->last_tolerance);
    }
    if (late) {
      gst_cloth_sync_drop (self, heads->pad[i], heads->head[i], time);
      discarded = TRUE;
    }
  }
  return discarded;
}

/* Pops the heads of the set and hands them to the subclass. */
static GstFlowReturn
gst_cloth_sync_emit (GstClothSync * self, GstClothSyncHeads * heads,
    guint64 mask, GstClockTimeDiff time)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  GstAggregator *agg = GST_AGGREGATOR (self);
  GstSegment *segment = &GST_AGGREGATOR_PAD (agg->srcpad)->segment;
  GstBuffer *views[GST_CLOTH_SYNC_MAX_PADS] = { NULL };
  GstBuffer *out = NULL;
  GstClockTime duration = GST_CLOCK_TIME_NONE, pts = GST_CLOCK_TIME_NONE;
  GstFlowReturn ret = GST_FLOW_OK;
  gboolean enough, inside = TRUE;
  guint i, n_views = 0, n_missing = 0;

  for (i = 0; i < heads->n; i++) {
    if (!(mask >> i & 1)) {
      n_missing += gst_cloth_sync_pad_count_missing (heads->pad[i],
          GST_ELEMENT (self));
      continue;
    }
    /* only one reference must be left, so that the subclass can write in place */
    gst_clear_buffer (&heads->head[i]);
    views[i] = gst_cloth_sync_pop (self, heads->pad[i]);
    if (!views[i]) {
      mask &= ~(G_GUINT64_CONSTANT (1) << i);   /* flushed meanwhile */
      n_missing += gst_cloth_sync_pad_count_missing (heads->pad[i],
          GST_ELEMENT (self));
      continue;
    }
    n_views++;
    GST_OBJECT_LOCK (heads->pad[i]);
    priv->segment[i] = GST_AGGREGATOR_PAD (heads->pad[i])->segment;
    GST_OBJECT_UNLOCK (heads->pad[i]);
    duration = MIN (duration, GST_BUFFER_DURATION (views[i]));
    GST_OBJECT_LOCK (self);
    heads->pad[i]->used++;
    if (!GST_CLOCK_TIME_IS_VALID (duration)) {
      duration = heads->pad[i]->period;
    }
    GST_OBJECT_UNLOCK (self);
  }
  if (GST_CLOCK_STIME_IS_VALID (time)) {
    gst_cloth_sync_gaps_note (&priv->gaps, time, duration);
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
  priv->n_incomplete += n_missing > 0;
  priv->n_lately++;
  priv->n_lacking += n_missing > 0;
  if (!enough || !inside) {
    priv->n_skipped++;
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
    for (i = 0; i < heads->n; i++) {
      if (heads->pad[i]) {
        gst_cloth_sync_name_camera (self, heads->pad[i]);
      }
    }
  }
  for (i = 0; i < heads->n; i++) {
    gst_clear_buffer (&views[i]);
  }
  if (ret != GST_FLOW_OK || !out) {
    gst_clear_buffer (&out);
    if (ret == GST_FLOW_OK && GST_CLOCK_TIME_IS_VALID (pts)) {
      gst_cloth_sync_gaps_say (&priv->gaps, agg, pts, duration);
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
gst_cloth_sync_end (GstClothSync * self, const GstClothSyncHeads * heads)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  guint64 n_sets;
  gboolean all_skipped;
  guint min_views, i;

  GST_OBJECT_LOCK (self);
  n_sets = priv->n_sets;
  all_skipped = n_sets == 0 && priv->n_skipped > 0;
  min_views = priv->min_views;
  GST_OBJECT_UNLOCK (self);
  if (all_skipped) {
    GST_ELEMENT_WARNING (self, STREAM, FAILED,
        ("No instant had frames from %u pads, so nothing was sent.", min_views),
        ("Lower min-views, raise tolerance, or check that the streams' times "
            "overlap."));
  }
  for (i = 0; i < heads->n && GST_CLOTH_SYNC_GET_CLASS (self)->prefix; i++) {
    if (heads->pad[i] && n_sets > 0) {
      gst_cloth_sync_name_camera (self, heads->pad[i]);
      gst_cloth_sync_say_unused (GST_ELEMENT (self), heads->pad[i]);
    }
  }
  if (priv->is_live && n_sets > 0) {
    gst_cloth_sync_say_lost (GST_ELEMENT (self), heads->pad, heads->n,
        priv->n_lately, priv->n_lacking);
  }
  return GST_FLOW_EOS;
}

static GstFlowReturn
gst_cloth_sync_aggregate (GstAggregator * agg, gboolean timeout)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);
  const GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (self);
  GstFlowReturn ret;
  GstClockTimeDiff first = 0;
  gboolean has_first = FALSE;
  GstClockTime tolerance;
  guint64 mask = 0;
  gint untimed = -1;
  GstClothSyncHeads heads;
  guint i;

  gst_cloth_sync_forget_released (self);
  ret = gst_cloth_sync_take_caps (self);
  if (ret != GST_FLOW_OK) {
    return ret;
  }
  ret = GST_AGGREGATOR_FLOW_NEED_DATA;
  GST_OBJECT_LOCK (self);
  tolerance = priv->effective;
  GST_OBJECT_UNLOCK (self);
  priv->is_live = GST_CLOCK_TIME_IS_VALID (gst_aggregator_get_latency (agg));

  g_mutex_lock (&priv->release_lock);
  gst_cloth_sync_heads_gather (&heads, GST_ELEMENT (self), priv->offset);
  g_mutex_unlock (&priv->release_lock);
  if (gst_cloth_sync_settle_times (self, &heads)) {
    goto done;
  }
  if (heads.n_eos == heads.n_pads) {
    ret = gst_cloth_sync_end (self, &heads);
    goto done;
  }
  if (heads.n_waiting > 0 && !timeout) {
    goto done;                  /* what came was clipped away, or the pad is new */
  }
  if (klass->look) {
    ret = klass->look (self, heads.head, heads.n);
    if (ret != GST_FLOW_OK) {
      goto done;
    }
    ret = GST_AGGREGATOR_FLOW_NEED_DATA;
  }
  if (heads.n_heads == 0) {
    gst_cloth_sync_look_for_silence (self, &heads, GST_CLOCK_STIME_NONE);
  }
  for (i = 0; i < heads.n; i++) {
    if (!heads.head[i]) {
      continue;
    }
    if (!GST_CLOCK_STIME_IS_VALID (heads.time[i])) {
      untimed = (gint) i;
    } else if (!heads.gap[i]) {
      first = has_first ? MIN (first, heads.time[i]) : heads.time[i];
      has_first = TRUE;
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
  if (!has_first && heads.n_waiting == 0) {
    gst_cloth_sync_gaps_pass (&priv->gaps, agg, &heads);
  }
  if (gst_cloth_sync_discard (self, &heads, has_first ? &first : NULL,
          tolerance) || !has_first) {
    goto done;
  }

  for (i = 0; i < heads.n; i++) {
    if (heads.head[i] && !heads.gap[i]
        && gst_cloth_sync_is_within (heads.time[i], first, tolerance)) {
      mask |= G_GUINT64_CONSTANT (1) << i;
    }
  }
  priv->has_last = TRUE;
  gst_cloth_sync_look_for_silence (self, &heads, first);
  priv->last_time = first;
  priv->last_tolerance = tolerance;
  priv->last_mask = mask;
  if (timeout) {
    GST_DEBUG_OBJECT (self, "deadline: set at %" GST_STIME_FORMAT
        " goes without the missing views", GST_STIME_ARGS (first));
  }
  ret = gst_cloth_sync_emit (self, &heads, mask, first);

done:
  gst_cloth_sync_heads_release (&heads);
  return ret;
}

/* ---- GObject ---- */

static void
gst_cloth_sync_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  gst_cloth_set_property (object, id, value, pspec);
  if (g_str_equal (pspec->name, "tolerance")) {
    gst_cloth_sync_update_timing (GST_CLOTH_SYNC (object));
  }
}

static void
gst_cloth_sync_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * pspec)
{
  GstClothSyncPrivate *priv =
      gst_cloth_sync_get_instance_private (GST_CLOTH_SYNC (object));
  GstStructure *stats;
  GList *l;

  if (id != PROP_STATS) {
    gst_cloth_get_property (object, id, value, pspec);
    return;
  }
  GST_OBJECT_LOCK (object);
  stats = gst_structure_new ("stats",
      "sets", G_TYPE_UINT64, priv->n_sets,
      "incomplete", G_TYPE_UINT64, priv->n_incomplete,
      "skipped", G_TYPE_UINT64, priv->n_skipped,
      "dropped", G_TYPE_UINT64, priv->n_dropped,
      "implausible", G_TYPE_UINT64, priv->n_implausible, NULL);
  for (l = GST_ELEMENT (object)->sinkpads; l; l = l->next) {
    g_autoptr (GstStructure) pad = gst_cloth_sync_pad_get_stats (l->data);

    gst_structure_set (stats, gst_structure_get_name (pad), GST_TYPE_STRUCTURE,
        pad, NULL);
  }
  GST_OBJECT_UNLOCK (object);
  g_value_take_boxed (value, stats);
}

static void
gst_cloth_sync_finalize (GObject * object)
{
  GstClothSyncPrivate *priv =
      gst_cloth_sync_get_instance_private (GST_CLOTH_SYNC (object));

  gst_cloth_sync_gaps_clear (&priv->gaps);
  g_mutex_clear (&priv->release_lock);
  G_OBJECT_CLASS (gst_cloth_sync_parent_class)->finalize (object);
}

static void
gst_cloth_sync_class_init (GstClothSyncClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstAggregatorClass *agg_class = GST_AGGREGATOR_CLASS (klass);

  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      g_type_class_get_instance_private_offset (klass));
  object_class->set_property = gst_cloth_sync_set_property;
  object_class->get_property = gst_cloth_sync_get_property;
  object_class->finalize = gst_cloth_sync_finalize;
  element_class->request_new_pad = gst_cloth_sync_request_new_pad;
  element_class->release_pad = gst_cloth_sync_release_pad;
  element_class->change_state = gst_cloth_sync_change_state;
  agg_class->create_new_pad = gst_cloth_sync_create_new_pad;
  agg_class->sink_event = gst_cloth_sync_sink_event;
  agg_class->sink_event_pre_queue = gst_cloth_sync_sink_event_pre_queue;
  agg_class->clip = gst_cloth_sync_pad_clip;
  agg_class->get_next_time = gst_cloth_sync_get_next_time;
  agg_class->src_query = gst_cloth_sync_src_query;
  agg_class->aggregate = gst_cloth_sync_aggregate;
  agg_class->update_src_caps = gst_cloth_sync_update_src_caps;
  agg_class->propose_allocation = gst_cloth_sync_propose_allocation;
  agg_class->flush = gst_cloth_sync_flush;
  agg_class->start = gst_cloth_sync_start;
  agg_class->stop = gst_cloth_sync_stop;

  g_object_class_install_property (object_class, PROP_STATS,
      g_param_spec_boxed ("stats", "Statistics",
          "Counts since the start: sets processed, sets that lacked the frame "
          "of a pad (incomplete), sets dropped for fewer than min-views frames "
          "(skipped), frames dropped as late, and as implausible (max-jump); "
          "under each pad's name its camera, the frames used, missing, dropped "
          "and implausible, and whether it is silent",
          GST_TYPE_STRUCTURE, G_PARAM_READABLE | G_PARAM_STATIC_STRINGS));

  gst_type_mark_as_plugin_api (GST_TYPE_CLOTH_SYNC, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_CLOTH_SYNC_PAD, 0);
}

static void
gst_cloth_sync_init (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_instance_private (self);

  *priv = defaults;
  g_mutex_init (&priv->release_lock);
  gst_cloth_sync_gaps_init (&priv->gaps, GST_AGGREGATOR_SRC_PAD (self));
  g_object_set (self, "latency", (guint64) LATENCY, NULL);
}
