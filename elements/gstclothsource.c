/* Base of the sources of a mesh stream whose frames are all known at the start.
 *
 * Caps, duration, time stamps and seeks by time; the subclass makes the meshes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothsource.h"

#include "elements/gstclothutil.h"

GST_DEBUG_CATEGORY_STATIC (cloth_source_debug);
#define GST_CAT_DEFAULT cloth_source_debug

/* Of a single frame without a rate. */
#define FALLBACK_DURATION (GST_SECOND / 30)
/* Whole nanoseconds that a double still counts. */
#define MAX_TIME_S 4e6

typedef struct
{
  /* from start to stop; caps with the object lock */
  GstCaps *caps;
  const gdouble *times;         /* NULL: fps says */
  gdouble origin;
  gint fps_n, fps_d;
  gint64 n_frames;
  gint64 next;                  /* frame; n_frames or -1 behind the last one */
  gint flushing;                /* atomic */
} GstClothSourcePrivate;

static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_MESH_CAPS));

G_DEFINE_ABSTRACT_TYPE_WITH_PRIVATE (GstClothSource, gst_cloth_source,
    GST_TYPE_PUSH_SRC);

/* Time of a frame; of n_frames, the end of the stream. */
static GstClockTime
frame_time (const GstClothSourcePrivate * priv, gint64 frame)
{
  GstClockTime last;

  if (!priv->times)
    return gst_util_uint64_scale ((guint64) frame,
        (guint64) priv->fps_d * GST_SECOND, (guint64) priv->fps_n);
  if (frame < priv->n_frames)
    return (GstClockTime) ((priv->times[frame] - priv->origin) * GST_SECOND +
        0.5);
  /* The last frame lasts as long as the one before. */
  last = frame_time (priv, priv->n_frames - 1);
  if (priv->n_frames > 1)
    return 2 * last - frame_time (priv, priv->n_frames - 2);
  return last + (priv->fps_n > 0 ? gst_util_uint64_scale_int (GST_SECOND,
          priv->fps_d, priv->fps_n) : FALLBACK_DURATION);
}

/* The number of frames that begin before @time. */
static gint64
frames_before (const GstClothSourcePrivate * priv, GstClockTime time)
{
  gint64 low = 0, high = priv->n_frames;

  while (low < high) {
    gint64 middle = (low + high) / 2;

    if (frame_time (priv, middle) < time)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The frame that is shown at @time; n_frames behind the end. */
static gint64
frame_at (const GstClothSourcePrivate * priv, GstClockTime time)
{
  if (time >= frame_time (priv, priv->n_frames))
    return priv->n_frames;
  return MAX (frames_before (priv, time + 1) - 1, 0);
}

static gboolean
check_times (GstClothSource * self, const GstClothSourceStream * stream)
{
  const GstClothSourcePrivate *priv =
      gst_cloth_source_get_instance_private (self);

  for (gint64 i = 0; priv->times && i < priv->n_frames; i++) {
    const gdouble time = priv->times[i] - priv->origin;

    if (!(time >= 0 && time <= MAX_TIME_S) ||
        (i > 0 && frame_time (priv, i) <= frame_time (priv, i - 1))) {
      GST_ELEMENT_ERROR (self, STREAM, FORMAT,
          ("The time of frame %" G_GINT64_FORMAT
              " in “%s” cannot be played: "
              "times must start at 0 or later, rise by a nanosecond at least and "
              "stay below %g s%s", i, stream->location, MAX_TIME_S,
              stream->advice), ("Mend times.npy of the take."));
      return FALSE;
    }
  }
  return TRUE;
}

/* @source: the source, in its open method
 * @stream: what it is going to send
 *
 * Checks the stream and tells its caps.
 *
 * Returns: %FALSE when the stream can't be sent; an error was posted
 */
gboolean
gst_cloth_source_publish (GstClothSource * source,
    const GstClothSourceStream * stream)
{
  GstClothSourcePrivate *priv = gst_cloth_source_get_instance_private (source);
  const ClothTopology *topology = stream->topology;
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) sent = NULL;
  GstCaps *caps;

  priv->times = stream->times;
  priv->origin = stream->origin;
  priv->fps_n = stream->fps_n;
  priv->fps_d = stream->fps_d;
  priv->n_frames = stream->n_frames;
  priv->next = 0;
  if (!check_times (source, stream))
    return FALSE;
  sent = gst_cloth_topology_new (topology->n_vertices, topology->columns,
      topology->rows, topology->uv, topology->faces, topology->n_faces, &error);
  if (!sent) {
    GST_ELEMENT_ERROR (source, STREAM, FORMAT,
        ("The mesh of “%s” is not valid: %s", stream->location,
            error->message),
        ("Write it anew from the program that it comes from."));
    return FALSE;
  }
  caps = gst_cloth_topology_to_caps (sent, priv->fps_n, priv->fps_d);
  GST_OBJECT_LOCK (source);
  gst_caps_take (&priv->caps, caps);
  GST_OBJECT_UNLOCK (source);
  GST_INFO_OBJECT (source, "%" G_GINT64_FORMAT " frames, %" GST_TIME_FORMAT,
      priv->n_frames, GST_TIME_ARGS (frame_time (priv, priv->n_frames)));
  return TRUE;
}

/* @source: the source, in its make_mesh method
 *
 * Returns: %TRUE when the mesh isn't wanted any more: a seek or a stop waits
 */
gboolean
gst_cloth_source_is_flushing (GstClothSource * source)
{
  GstClothSourcePrivate *priv = gst_cloth_source_get_instance_private (source);

  return g_atomic_int_get (&priv->flushing);
}

static gboolean
gst_cloth_source_unlock (GstBaseSrc * src)
{
  GstClothSourcePrivate *priv =
      gst_cloth_source_get_instance_private (GST_CLOTH_SOURCE (src));

  g_atomic_int_set (&priv->flushing, TRUE);
  return TRUE;
}

static gboolean
gst_cloth_source_unlock_stop (GstBaseSrc * src)
{
  GstClothSourcePrivate *priv =
      gst_cloth_source_get_instance_private (GST_CLOTH_SOURCE (src));

  g_atomic_int_set (&priv->flushing, FALSE);
  return TRUE;
}

static gboolean
gst_cloth_source_stop (GstBaseSrc * src)
{
  GstClothSource *self = GST_CLOTH_SOURCE (src);
  GstClothSourcePrivate *priv = gst_cloth_source_get_instance_private (self);

  GST_OBJECT_LOCK (self);
  gst_clear_caps (&priv->caps);
  src->segment.duration = GST_CLOCK_TIME_NONE;
  GST_OBJECT_UNLOCK (self);
  priv->times = NULL;
  GST_CLOTH_SOURCE_GET_CLASS (self)->close (self);
  return TRUE;
}

/* The base has begun a segment. A pad that was deactivated, and is activated again, starts without
 * a change of state. */
static gboolean
gst_cloth_source_start (GstBaseSrc * src)
{
  GstClothSource *self = GST_CLOTH_SOURCE (src);
  GstClothSourcePrivate *priv = gst_cloth_source_get_instance_private (self);

  if (!priv->caps && !GST_CLOTH_SOURCE_GET_CLASS (self)->open (self)) {
    gst_cloth_source_stop (src);
    return FALSE;
  }
  GST_OBJECT_LOCK (src);
  src->segment.duration = frame_time (priv, priv->n_frames);
  GST_OBJECT_UNLOCK (src);
  return TRUE;
}

/* What is wrong is said here, before the base starts: after that the base would say that it was
 * not. */
static GstStateChangeReturn
gst_cloth_source_change_state (GstElement * element, GstStateChange transition)
{
  GstStateChangeReturn result = GST_STATE_CHANGE_FAILURE;
  gboolean opens = transition == GST_STATE_CHANGE_READY_TO_PAUSED;

  if (!opens
      ||
      GST_CLOTH_SOURCE_GET_CLASS (element)->open (GST_CLOTH_SOURCE (element)))
    result =
        GST_ELEMENT_CLASS (gst_cloth_source_parent_class)->change_state
        (element, transition);
  /* nobody else does when the start has failed */
  if (opens && result == GST_STATE_CHANGE_FAILURE)
    gst_cloth_source_stop (GST_BASE_SRC (element));
  return result;
}

static GstCaps *
gst_cloth_source_get_caps (GstBaseSrc * src, GstCaps * filter)
{
  GstClothSourcePrivate *priv =
      gst_cloth_source_get_instance_private (GST_CLOTH_SOURCE (src));
  GstCaps *caps;

  GST_OBJECT_LOCK (src);
  caps = priv->caps ? gst_caps_ref (priv->caps) : NULL;
  GST_OBJECT_UNLOCK (src);
  if (!caps)
    caps = gst_pad_get_pad_template_caps (src->srcpad);
  return gst_cloth_filter_caps (caps, filter);
}

static gboolean
gst_cloth_source_is_seekable (GstBaseSrc * src)
{
  GstClothSourcePrivate *priv =
      gst_cloth_source_get_instance_private (GST_CLOTH_SOURCE (src));
  gboolean is_open;

  GST_OBJECT_LOCK (src);
  is_open = priv->caps != NULL;
  GST_OBJECT_UNLOCK (src);
  return is_open && !gst_base_src_is_live (src);
}

/* Whether the segment can be what the seek wants, by the arithmetic that the base class will
 * use. */
static gboolean
can_seek (GstClothSource * self, GstEvent * event)
{
  GstSeekType start_type, stop_type;
  GstSeekFlags flags;
  gint64 start, stop;
  GstFormat format;
  GstSegment segment;
  gdouble rate;

  gst_event_parse_seek (event, &rate, &format, &flags, &start_type, &start,
      &stop_type, &stop);
  if (format != GST_FORMAT_TIME
      || (rate < 0 && !GST_CLOTH_SOURCE_GET_CLASS (self)->backwards)
      || (start_type == GST_SEEK_TYPE_SET && stop_type == GST_SEEK_TYPE_SET
          && stop >= 0 && start > stop))
    return FALSE;
  GST_OBJECT_LOCK (self);
  gst_segment_copy_into (&GST_BASE_SRC (self)->segment, &segment);
  GST_OBJECT_UNLOCK (self);
  if (segment.format != GST_FORMAT_TIME)
    return TRUE;                /* it is none yet */
  return gst_segment_do_seek (&segment, rate, format, flags, start_type,
      (guint64) start, stop_type, (guint64) stop, NULL);
}

/* The base class flushes first and asks then; after a refusal the stream would go on without
 * a segment. */
static gboolean
gst_cloth_source_event (GstBaseSrc * src, GstEvent * event)
{
  if (GST_EVENT_TYPE (event) == GST_EVENT_SEEK
      && !can_seek (GST_CLOTH_SOURCE (src), event)) {
    GST_INFO_OBJECT (src, "refused: %" GST_PTR_FORMAT, event);
    return FALSE;
  }
  return GST_BASE_SRC_CLASS (gst_cloth_source_parent_class)->event (src, event);
}

/* What comes here was let through by can_seek (), or is the start of the stream. */
static gboolean
gst_cloth_source_do_seek (GstBaseSrc * src, GstSegment * segment)
{
  GstClothSourcePrivate *priv =
      gst_cloth_source_get_instance_private (GST_CLOTH_SOURCE (src));

  segment->time = segment->start;
  if (segment->rate >= 0)
    priv->next = frame_at (priv, segment->position);
  else if (GST_CLOCK_TIME_IS_VALID (segment->stop))
    priv->next = frames_before (priv, segment->stop) - 1;
  else
    priv->next = priv->n_frames - 1;
  return TRUE;
}

/* A live frame is sent when its time has come. */
static void
gst_cloth_source_get_times (GstBaseSrc * src, GstBuffer * buffer,
    GstClockTime * start, GstClockTime * end)
{
  if (!gst_base_src_is_live (src))
    return;
  *start = GST_BUFFER_PTS (buffer);
  *end = *start + GST_BUFFER_DURATION (buffer);
}

static gboolean
is_at_end (const GstClothSourcePrivate * priv, const GstSegment * segment)
{
  if (priv->next < 0 || priv->next >= priv->n_frames)
    return TRUE;
  if (segment->rate >= 0)
    return GST_CLOCK_TIME_IS_VALID (segment->stop) &&
        frame_time (priv, priv->next) >= segment->stop;
  return frame_time (priv, priv->next + 1) <= segment->start;
}

static GstFlowReturn
gst_cloth_source_create (GstPushSrc * src, GstBuffer ** buffer)
{
  GstClothSource *self = GST_CLOTH_SOURCE (src);
  GstClothSourcePrivate *priv = gst_cloth_source_get_instance_private (self);
  const GstSegment *segment = &GST_BASE_SRC (src)->segment;
  g_autoptr (GstClothMesh) mesh = NULL;

  if (is_at_end (priv, segment))
    return GST_FLOW_EOS;
  mesh = GST_CLOTH_SOURCE_GET_CLASS (self)->make_mesh (self,
      (guint) priv->next);
  if (!mesh)
    return gst_cloth_source_is_flushing (self) ? GST_FLOW_FLUSHING :
        GST_FLOW_ERROR;
  *buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (*buffer) = frame_time (priv, priv->next);
  GST_BUFFER_DURATION (*buffer) = frame_time (priv, priv->next + 1) -
      GST_BUFFER_PTS (*buffer);
  GST_BUFFER_OFFSET (*buffer) = (guint64) priv->next;
  GST_BUFFER_OFFSET_END (*buffer) = (guint64) priv->next + 1;
  priv->next += segment->rate >= 0 ? 1 : -1;
  return GST_FLOW_OK;
}

static void
gst_cloth_source_class_init (GstClothSourceClass * klass)
{
  GstBaseSrcClass *src_class = GST_BASE_SRC_CLASS (klass);

  GST_DEBUG_CATEGORY_INIT (cloth_source_debug, "clothsource", 0,
      "base of sources of mesh streams");
  gst_element_class_add_static_pad_template (GST_ELEMENT_CLASS (klass),
      &src_template);
  GST_ELEMENT_CLASS (klass)->change_state = gst_cloth_source_change_state;
  src_class->start = gst_cloth_source_start;
  src_class->stop = gst_cloth_source_stop;
  src_class->unlock = gst_cloth_source_unlock;
  src_class->unlock_stop = gst_cloth_source_unlock_stop;
  src_class->get_caps = gst_cloth_source_get_caps;
  src_class->get_times = gst_cloth_source_get_times;
  src_class->is_seekable = gst_cloth_source_is_seekable;
  src_class->event = gst_cloth_source_event;
  src_class->do_seek = gst_cloth_source_do_seek;
  GST_PUSH_SRC_CLASS (klass)->create = gst_cloth_source_create;
  gst_type_mark_as_plugin_api (GST_TYPE_CLOTH_SOURCE, 0);
}

static void
gst_cloth_source_init (GstClothSource * self)
{
  gst_base_src_set_format (GST_BASE_SRC (self), GST_FORMAT_TIME);
}
