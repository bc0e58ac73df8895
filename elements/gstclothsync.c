/* Base of the elements that join several streams by running time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsync-private.h"

#include <gst/video/video.h>

GST_DEBUG_CATEGORY (cloth_sync_debug);
#define GST_CAT_DEFAULT cloth_sync_debug

/* Half a frame at 30 Hz, when no pad says how fast its frames come. */
#define FALLBACK_TOLERANCE (GST_SECOND / 60)
#define DEFAULT_TOLERANCE GST_CLOCK_TIME_NONE
#define DEFAULT_MIN_VIEWS 1
/* Keeps sums of times far from overflow. */
#define MAX_TOLERANCE (3600 * GST_SECOND)

G_DEFINE_TYPE (GstClothSyncPad, gst_cloth_sync_pad, GST_TYPE_AGGREGATOR_PAD);

G_DEFINE_ABSTRACT_TYPE_WITH_CODE (GstClothSync, gst_cloth_sync,
    GST_TYPE_AGGREGATOR, G_ADD_PRIVATE (GstClothSync)
    GST_DEBUG_CATEGORY_INIT (cloth_sync_debug, "clothsync", 0,
        "joining of streams by running time"));

GstClothSyncPrivate *
gst_cloth_sync_get_private (GstClothSync * self)
{
  return gst_cloth_sync_get_instance_private (self);
}

enum
{
  PROP_0,
  PROP_TOLERANCE,
  PROP_MIN_VIEWS,
  PROP_STATS
};

/* What was looked at before the flush, to know the deadline, is still held. */
static GstFlowReturn
gst_cloth_sync_pad_flush (GstAggregatorPad * pad, GstAggregator * agg)
{
  gst_aggregator_pad_drop_buffer (pad);
  return GST_FLOW_OK;
}

static void
gst_cloth_sync_pad_class_init (GstClothSyncPadClass * klass)
{
  GST_AGGREGATOR_PAD_CLASS (klass)->flush = gst_cloth_sync_pad_flush;
}

static void
gst_cloth_sync_pad_init (GstClothSyncPad * pad)
{
  pad->period = GST_CLOCK_TIME_NONE;
}

/* Tolerance and latency follow from the pads' frame rates and offsets. */
static void
gst_cloth_sync_update_timing (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
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
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
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
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);

  g_return_if_fail (index < GST_CLOTH_SYNC_MAX_PADS);

  GST_OBJECT_LOCK (self);
  priv->offset[index] = offset;
  GST_OBJECT_UNLOCK (self);
  gst_cloth_sync_update_timing (self);
}

static void
gst_cloth_sync_release_pad (GstElement * element, GstPad * pad)
{
  GstClothSync *self = GST_CLOTH_SYNC (element);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  guint64 bit = G_GUINT64_CONSTANT (1) << GST_CLOTH_SYNC_PAD (pad)->index;

  g_mutex_lock (&priv->release_lock);
  GST_ELEMENT_CLASS (gst_cloth_sync_parent_class)->release_pad (element, pad);
  g_mutex_unlock (&priv->release_lock);

  GST_OBJECT_LOCK (self);
  priv->taken &= ~bit;
  priv->released |= bit;
  GST_OBJECT_UNLOCK (self);
  gst_cloth_sync_update_timing (self);
}

/* Tells the subclass, from the streaming thread, of the pads that have gone. */
void
gst_cloth_sync_forget_released (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
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

static GstClockTime
gst_cloth_sync_period_of_caps (const GstCaps * caps)
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

static gboolean
gst_cloth_sync_sink_event (GstAggregator * agg, GstAggregatorPad * aggpad,
    GstEvent * event)
{
  GstClothSync *self = GST_CLOTH_SYNC (agg);
  GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (self);
  GstClothSyncPad *pad = GST_CLOTH_SYNC_PAD (aggpad);

  if (GST_EVENT_TYPE (event) == GST_EVENT_CAPS) {
    GstCaps *caps;

    gst_cloth_sync_forget_released (self);
    gst_event_parse_caps (event, &caps);
    GST_OBJECT_LOCK (self);
    pad->period = gst_cloth_sync_period_of_caps (caps);
    GST_OBJECT_UNLOCK (self);
    gst_cloth_sync_update_timing (self);
    if (klass->set_pad_caps && !klass->set_pad_caps (self, pad->index, caps)) {
      gst_event_unref (event);
      return FALSE;
    }
    gst_pad_mark_reconfigure (GST_AGGREGATOR_SRC_PAD (self));
  } else if (GST_EVENT_TYPE (event) == GST_EVENT_SEGMENT) {
    const GstSegment *segment;

    gst_event_parse_segment (event, &segment);
    if (segment->format != GST_FORMAT_TIME) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("Pad %s has a segment in %s, not in time.", GST_PAD_NAME (pad),
              gst_format_get_name (segment->format)),
          ("Streams are joined by running time. Put a parser or decoder that gives "
              "times before this element, or a source with format=time."));
      gst_event_unref (event);
      return FALSE;
    }
  }
  return GST_AGGREGATOR_CLASS (gst_cloth_sync_parent_class)->sink_event (agg,
      aggpad, event);
}

static GstBuffer *
gst_cloth_sync_clip (GstAggregator * agg, GstAggregatorPad * aggpad,
    GstBuffer * buffer)
{
  GstClockTime start = GST_BUFFER_PTS (buffer);
  GstClockTime stop = GST_CLOCK_TIME_NONE;
  guint64 new_start, new_stop;

  if (!GST_CLOCK_TIME_IS_VALID (start)
      || aggpad->segment.format != GST_FORMAT_TIME) {
    return buffer;
  }
  if (GST_BUFFER_DURATION_IS_VALID (buffer)) {
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
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);
  GstClothSyncClass *klass = GST_CLOTH_SYNC_GET_CLASS (self);

  priv->has_last = FALSE;
  GST_OBJECT_LOCK (self);
  GST_AGGREGATOR_PAD (GST_AGGREGATOR_SRC_PAD (self))->segment.position =
      GST_CLOCK_TIME_NONE;
  GST_OBJECT_UNLOCK (self);
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
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);

  GST_OBJECT_LOCK (self);
  priv->n_sets = priv->n_incomplete = priv->n_dropped = 0;
  GST_OBJECT_UNLOCK (self);
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
gst_cloth_sync_set_property (GObject * object, guint id, const GValue * value,
    GParamSpec * pspec)
{
  GstClothSync *self = GST_CLOTH_SYNC (object);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);

  switch (id) {
    case PROP_TOLERANCE:
      GST_OBJECT_LOCK (self);
      priv->tolerance = g_value_get_uint64 (value);
      GST_OBJECT_UNLOCK (self);
      gst_cloth_sync_update_timing (self);
      break;
    case PROP_MIN_VIEWS:
      GST_OBJECT_LOCK (self);
      priv->min_views = g_value_get_uint (value);
      GST_OBJECT_UNLOCK (self);
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
      break;
  }
}

static void
gst_cloth_sync_get_property (GObject * object, guint id, GValue * value,
    GParamSpec * pspec)
{
  GstClothSync *self = GST_CLOTH_SYNC (object);
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);

  GST_OBJECT_LOCK (self);
  switch (id) {
    case PROP_TOLERANCE:
      g_value_set_uint64 (value, priv->tolerance);
      break;
    case PROP_MIN_VIEWS:
      g_value_set_uint (value, priv->min_views);
      break;
    case PROP_STATS:
      g_value_take_boxed (value, gst_structure_new ("stats",
              "sets", G_TYPE_UINT64, priv->n_sets,
              "incomplete", G_TYPE_UINT64, priv->n_incomplete,
              "dropped", G_TYPE_UINT64, priv->n_dropped, NULL));
      break;
    default:
      G_OBJECT_WARN_INVALID_PROPERTY_ID (object, id, pspec);
      break;
  }
  GST_OBJECT_UNLOCK (self);
}

static void
gst_cloth_sync_finalize (GObject * object)
{
  GstClothSyncPrivate *priv =
      gst_cloth_sync_get_private (GST_CLOTH_SYNC (object));

  g_mutex_clear (&priv->release_lock);
  G_OBJECT_CLASS (gst_cloth_sync_parent_class)->finalize (object);
}

static void
gst_cloth_sync_class_init (GstClothSyncClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstAggregatorClass *agg_class = GST_AGGREGATOR_CLASS (klass);

  object_class->set_property = gst_cloth_sync_set_property;
  object_class->get_property = gst_cloth_sync_get_property;
  object_class->finalize = gst_cloth_sync_finalize;
  element_class->release_pad = gst_cloth_sync_release_pad;
  agg_class->create_new_pad = gst_cloth_sync_create_new_pad;
  agg_class->sink_event = gst_cloth_sync_sink_event;
  agg_class->clip = gst_cloth_sync_clip;
  agg_class->get_next_time = gst_cloth_sync_get_next_time;
  agg_class->aggregate = gst_cloth_sync_aggregate;
  agg_class->update_src_caps = gst_cloth_sync_update_src_caps;
  agg_class->propose_allocation = gst_cloth_sync_propose_allocation;
  agg_class->flush = gst_cloth_sync_flush;
  agg_class->start = gst_cloth_sync_start;
  agg_class->stop = gst_cloth_sync_stop;

  /**
   * GstClothSync:tolerance:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_TOLERANCE,
      g_param_spec_uint64 ("tolerance", "Tolerance",
          "Frames at most this long after the earliest frame of a set belong to "
          "it, in ns; less than a frame period. Default (the largest value): half "
          "the frame period of the fastest pad, or 1/60 s when no pad has a "
          "frame rate", 0, G_MAXUINT64, DEFAULT_TOLERANCE,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_PLAYING));
  /**
   * GstClothSync:min-views:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_MIN_VIEWS,
      g_param_spec_uint ("min-views", "Minimum views",
          "Sets with frames from fewer pads than this are dropped", 1,
          GST_CLOTH_SYNC_MAX_PADS, DEFAULT_MIN_VIEWS,
          G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS |
          GST_PARAM_MUTABLE_PLAYING));
  /**
   * GstClothSync:stats:
   *
   * Since: 0.1
   */
  g_object_class_install_property (object_class, PROP_STATS,
      g_param_spec_boxed ("stats", "Statistics",
          "Counts since the start: sets processed, sets dropped as incomplete "
          "(fewer than min-views frames), frames dropped as late",
          GST_TYPE_STRUCTURE, G_PARAM_READABLE | G_PARAM_STATIC_STRINGS));

  gst_type_mark_as_plugin_api (GST_TYPE_CLOTH_SYNC, 0);
  gst_type_mark_as_plugin_api (GST_TYPE_CLOTH_SYNC_PAD, 0);
}

static void
gst_cloth_sync_init (GstClothSync * self)
{
  GstClothSyncPrivate *priv = gst_cloth_sync_get_private (self);

  g_mutex_init (&priv->release_lock);
  priv->tolerance = DEFAULT_TOLERANCE;
  priv->min_views = DEFAULT_MIN_VIEWS;
  priv->effective = FALLBACK_TOLERANCE;
}
