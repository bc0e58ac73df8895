/* Base of elements that look at pictures and leave what they see as metas.
 *
 * Pictures go through as they are: their memory is mapped for reading only, so that
 * buffers shared after a tee stay shared. QoS is off: a late picture is late, not lost. What a
 * live picture takes is told to the latency query, so that those downstream wait for it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstclothfilter.h"

#include <gst/cloth/cloth.h>

#include "elements/gstclothproperties.h"
#include "elements/gstclothutil.h"

GST_DEBUG_CATEGORY_STATIC (cloth_filter_debug);
#define GST_CAT_DEFAULT cloth_filter_debug

typedef struct
{
  gchar *camera;                /* protected by the object lock */
  GstVideoInfo info;
  guint64 count;
  guint8 *planes[3];            /* of a packed film: what a picture is taken apart to */
  gboolean told_encoded;        /* that upstream has nothing but encoded pictures */
  GstClockTime last_span;       /* how long the last picture took */

  /* object lock */
  gboolean is_live;
  GstClockTime latency;         /* what pictures take, as was said to the latency query */
} GstClothFilterPrivate;

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"camera", "Camera",
    "Name of the camera in the rig, which is written into the metadata",
    G_TYPE_STRING, GST_CLOTH_SETTING (GstClothFilterPrivate, camera),
    GST_PARAM_MUTABLE_PLAYING},
};
/* *INDENT-ON* */

/* So finely what pictures take is told: each change makes the pipeline ask anew. */
#define LATENCY_STEP (5 * GST_MSECOND)
#define SIZES ", width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ]"
#define FILTER_CAPS GST_VIDEO_CAPS_MAKE (GST_CLOTH_FILTER_FORMATS) SIZES "; " \
    GST_VIDEO_CAPS_MAKE (GST_CLOTH_FILTER_PACKED_FORMATS) SIZES

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (FILTER_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (FILTER_CAPS));

G_DEFINE_ABSTRACT_TYPE_WITH_PRIVATE (GstClothFilter, gst_cloth_filter,
    GST_TYPE_BASE_TRANSFORM);

static gboolean
is_packed (const GstVideoInfo * info)
{
  return GST_VIDEO_INFO_COMP_PSTRIDE (info, 0) > 1;
}

GstVideoFormat
gst_cloth_filter_get_planar_format (const GstVideoInfo * info)
{
  return is_packed (info) ? GST_VIDEO_FORMAT_Y42B :
      GST_VIDEO_INFO_FORMAT (info);
}

/* Room for the planes of a packed film, none for others. */
static void
gst_cloth_filter_prepare_planes (GstClothFilterPrivate * priv)
{
  for (guint k = 0; k < 3; k++) {
    g_clear_pointer (&priv->planes[k], g_free);
    if (priv->info.finfo && is_packed (&priv->info))
      priv->planes[k] =
          g_malloc_n ((gsize) GST_VIDEO_INFO_COMP_WIDTH (&priv->info, k),
          (gsize) GST_VIDEO_INFO_COMP_HEIGHT (&priv->info, k));
  }
}

/* The picture itself stays as it is. */
static void
take_apart (const GstVideoFrame * video, guint8 * const *planes,
    ClothPlanarImage * image)
{
  for (guint k = 0; k < 3; k++) {
    const gint width = GST_VIDEO_FRAME_COMP_WIDTH (video, k);
    const gint height = GST_VIDEO_FRAME_COMP_HEIGHT (video, k);
    const gint step = GST_VIDEO_FRAME_COMP_PSTRIDE (video, k);
    const gint stride = GST_VIDEO_FRAME_COMP_STRIDE (video, k);
    const guint8 *from = GST_VIDEO_FRAME_COMP_DATA (video, k);

    for (gint y = 0; y < height; y++) {
      guint8 *to = planes[k] + (gsize) y * (gsize) width;
      const guint8 *row = from + (gssize) y * stride;

      for (gint x = 0; x < width; x++)
        to[x] = row[step * x];
    }
  }
  *image = (ClothPlanarImage) {
    .luma = { planes[0], GST_VIDEO_FRAME_WIDTH (video),
      GST_VIDEO_FRAME_HEIGHT (video), GST_VIDEO_FRAME_WIDTH (video)
    }
    ,.chroma = { planes[1], planes[2] }
    ,.chroma_stride = GST_VIDEO_FRAME_COMP_WIDTH (video, 1),.chroma_step =
        1,.chroma_shift = { 1, 0 }
  };
}

static void
gst_cloth_filter_reset (GstClothFilter * self)
{
  GstClothFilterClass *klass = GST_CLOTH_FILTER_GET_CLASS (self);

  if (klass->reset)
    klass->reset (self);
}

static gboolean
gst_cloth_filter_start (GstBaseTransform * trans)
{
  GstClothFilter *self = GST_CLOTH_FILTER (trans);
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);
  GstClothFilterClass *klass = GST_CLOTH_FILTER_GET_CLASS (self);

  priv->count = 0;
  priv->told_encoded = FALSE;
  priv->last_span = 0;
  GST_OBJECT_LOCK (self);
  priv->is_live = FALSE;
  priv->latency = 0;
  GST_OBJECT_UNLOCK (self);
  return klass->start ? klass->start (self) : TRUE;
}

static gboolean
gst_cloth_filter_stop (GstBaseTransform * trans)
{
  GstClothFilter *self = GST_CLOTH_FILTER (trans);
  GstClothFilterClass *klass = GST_CLOTH_FILTER_GET_CLASS (self);

  if (klass->stop)
    klass->stop (self);
  return TRUE;
}

static gboolean
gst_cloth_filter_set_caps (GstBaseTransform * trans, GstCaps * in,
    GstCaps * out)
{
  GstClothFilter *self = GST_CLOTH_FILTER (trans);
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);
  GstVideoInfo info;

  if (!gst_video_info_from_caps (&info, in)) {
    GST_ERROR_OBJECT (self, "can't read caps %" GST_PTR_FORMAT, in);
    return FALSE;
  }
  priv->info = info;
  gst_cloth_filter_prepare_planes (priv);
  gst_cloth_filter_reset (self);
  return TRUE;
}

static gboolean
gst_cloth_filter_sink_event (GstBaseTransform * trans, GstEvent * event)
{
  GstClothFilter *self = GST_CLOTH_FILTER (trans);
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);

  switch (GST_EVENT_TYPE (event)) {
    case GST_EVENT_FLUSH_STOP:
    case GST_EVENT_SEGMENT:
      priv->count = 0;
      gst_cloth_filter_reset (self);
      break;
    default:
      break;
  }
  return GST_BASE_TRANSFORM_CLASS (gst_cloth_filter_parent_class)->sink_event
      (trans, event);
}

static GstClockTime
get_clock_time (GstElement * element)
{
  g_autoptr (GstClock) clock = gst_element_get_clock (element);

  return clock ? gst_clock_get_time (clock) : GST_CLOCK_TIME_NONE;
}

/* A live picture took from @start until now. Two in a row count: one may be an accident. */
static void
gst_cloth_filter_note_span (GstClothFilter * self, GstClockTime start)
{
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);
  const GstClockTime end = get_clock_time (GST_ELEMENT (self));
  GstClockTime span, both;
  gboolean rises;

  if (!GST_CLOCK_TIME_IS_VALID (start) || !GST_CLOCK_TIME_IS_VALID (end)
      || end < start)
    return;
  span = end - start;
  both = MIN (span, priv->last_span);
  priv->last_span = span;
  GST_OBJECT_LOCK (self);
  rises = priv->is_live && both > priv->latency;
  if (rises)
    priv->latency = (both / LATENCY_STEP + 1) * LATENCY_STEP;
  GST_OBJECT_UNLOCK (self);
  if (rises)
    gst_element_post_message (GST_ELEMENT (self),
        gst_message_new_latency (GST_OBJECT (self)));
}

static GstFlowReturn
gst_cloth_filter_transform_ip (GstBaseTransform * trans, GstBuffer * buffer)
{
  GstClothFilter *self = GST_CLOTH_FILTER (trans);
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);
  GstClothFilterFrame frame;
  GstVideoFrame video;
  GstFlowReturn flow;
  GstClockTime time;
  const GstClockTime start = get_clock_time (GST_ELEMENT (self));
  g_autofree gchar *camera = NULL;

  GST_OBJECT_LOCK (self);
  camera = g_strdup (priv->camera ? priv->camera : "");
  GST_OBJECT_UNLOCK (self);
  if (strlen (camera) > GST_CLOTH_MAX_CAMERA_NAME
      || !g_utf8_validate (camera, -1, NULL)) {
    GST_ELEMENT_ERROR (self, RESOURCE, SETTINGS,
        ("The camera's name does not fit into the metadata."),
        ("Set camera to UTF-8 of at most %d bytes, as in the rig.",
            GST_CLOTH_MAX_CAMERA_NAME));
    return GST_FLOW_ERROR;
  }
  time = gst_cloth_stream_time (&trans->segment, buffer);
  if (GST_CLOCK_TIME_IS_VALID (time))
    gst_object_sync_values (GST_OBJECT (self), time);

  /* No reference for the map: the buffer must stay writable for its metas. */
  if (!gst_video_frame_map (&video, &priv->info, buffer,
          GST_MAP_READ | GST_VIDEO_FRAME_MAP_FLAG_NO_REF)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("A picture is smaller than its caps say."),
        ("%" G_GSIZE_FORMAT " bytes for %dx%d; put videoconvert before %s, or "
            "mend the element that made it", gst_buffer_get_size (buffer),
            GST_VIDEO_INFO_WIDTH (&priv->info),
            GST_VIDEO_INFO_HEIGHT (&priv->info), GST_OBJECT_NAME (self)));
    return GST_FLOW_ERROR;
  }
  if (is_packed (&priv->info))
    take_apart (&video, priv->planes, &frame.planes);
  else
    gst_cloth_filter_view_planes (&video, &frame.planes);
  frame.luma = frame.planes.luma;
  frame.video = &video;
  frame.sequence = gst_cloth_number_picture (&trans->segment,
      GST_VIDEO_INFO_FPS_N (&priv->info), GST_VIDEO_INFO_FPS_D (&priv->info),
      buffer, priv->count);
  frame.camera = camera;
  frame.buffer = buffer;
  flow = GST_CLOTH_FILTER_GET_CLASS (self)->analyse (self, &frame);
  priv->count++;
  gst_video_frame_unmap (&video);
  gst_cloth_filter_note_span (self, start);
  return flow;
}

void
gst_cloth_filter_view_planes (const GstVideoFrame * frame,
    ClothPlanarImage * image)
{
  *image = (ClothPlanarImage) { {
      GST_VIDEO_FRAME_COMP_DATA (frame, 0), GST_VIDEO_FRAME_WIDTH (frame),
          GST_VIDEO_FRAME_HEIGHT (frame), GST_VIDEO_FRAME_COMP_STRIDE (frame, 0)
  }
  };
  if (GST_VIDEO_FRAME_N_COMPONENTS (frame) < 3)
    return;
  for (guint k = 0; k < 2; k++)
    image->chroma[k] = GST_VIDEO_FRAME_COMP_DATA (frame, k + 1);
  image->chroma_stride = GST_VIDEO_FRAME_COMP_STRIDE (frame, 1);
  image->chroma_step = GST_VIDEO_FRAME_COMP_PSTRIDE (frame, 1);
  image->chroma_shift[0] =
      (gint) GST_VIDEO_FORMAT_INFO_W_SUB (frame->info.finfo, 1);
  image->chroma_shift[1] =
      (gint) GST_VIDEO_FORMAT_INFO_H_SUB (frame->info.finfo, 1);
}

/* What decodes pictures of these caps; NULL when they are no such pictures. */
static const gchar *
find_decoder (const GstCaps * caps)
{
  static const gchar *const decoders[][2] = {
    {"image/jpeg", "jpegdec"}, {"video/x-h264", "h264parse ! avdec_h264"},
    {"video/x-h265", "h265parse ! avdec_h265"}
  };

  for (guint i = 0; i < G_N_ELEMENTS (decoders) && !gst_caps_is_any (caps)
      && !gst_caps_is_empty (caps); i++)
    if (gst_structure_has_name (gst_caps_get_structure (caps, 0),
            decoders[i][0]))
      return decoders[i][1];
  return NULL;
}

static void
gst_cloth_filter_tell_latency (GstClothFilter * self, GstQuery * query)
{
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);
  GstClockTime own;
  gboolean is_live;

  gst_query_parse_latency (query, &is_live, NULL, NULL);
  GST_OBJECT_LOCK (self);
  priv->is_live = is_live;
  own = is_live ? priv->latency : 0;
  GST_OBJECT_UNLOCK (self);
  gst_cloth_add_latency (query, own);
}

/* Where negotiation fails upstream says no more than that: with caps that are refused, or with an
 * end before there were any. When it has nothing but encoded pictures the user is told so. */
static GstPadProbeReturn
look_for_encoded (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  GstClothFilter *self = data;
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);
  GstEvent *event = GST_PAD_PROBE_INFO_EVENT (info);
  g_autoptr (GstCaps) taken = gst_pad_get_pad_template_caps (pad);
  g_autoptr (GstCaps) offered = NULL;
  const gchar *decoder;

  if (GST_EVENT_TYPE (event) == GST_EVENT_CAPS) {
    GstCaps *caps;

    gst_event_parse_caps (event, &caps);
    offered = gst_caps_ref (caps);
  } else if (GST_EVENT_TYPE (event) == GST_EVENT_EOS
      && !gst_pad_has_current_caps (pad))
    offered = gst_pad_peer_query_caps (pad, NULL);
  decoder = offered ? find_decoder (offered) : NULL;
  if (!decoder || gst_caps_can_intersect (offered, taken)
      || priv->told_encoded)
    return GST_PAD_PROBE_OK;
  priv->told_encoded = TRUE;
  GST_ELEMENT_ERROR (self, STREAM, FORMAT,
      ("What comes is %s, which has to be decoded first.",
          gst_structure_get_name (gst_caps_get_structure (offered, 0))),
      ("Put %s before %s.", decoder, GST_OBJECT_NAME (self)));
  return GST_PAD_PROBE_OK;
}

static gboolean
gst_cloth_filter_query (GstBaseTransform * trans, GstPadDirection direction,
    GstQuery * query)
{
  GstClothFilter *self = GST_CLOTH_FILTER (trans);
  const gboolean answered =
      GST_BASE_TRANSFORM_CLASS (gst_cloth_filter_parent_class)->query (trans,
      direction, query);

  if (answered && GST_QUERY_TYPE (query) == GST_QUERY_LATENCY
      && direction == GST_PAD_SRC)
    gst_cloth_filter_tell_latency (self, query);
  return answered;
}

static void
gst_cloth_filter_finalize (GObject * object)
{
  GstClothFilterPrivate *priv =
      gst_cloth_filter_get_instance_private (GST_CLOTH_FILTER (object));

  for (guint k = 0; k < 3; k++)
    g_free (priv->planes[k]);
  gst_cloth_clear_settings (properties, G_N_ELEMENTS (properties), priv);
  G_OBJECT_CLASS (gst_cloth_filter_parent_class)->finalize (object);
}

static void
gst_cloth_filter_class_init (GstClothFilterClass * klass)
{
  GObjectClass *object_class = G_OBJECT_CLASS (klass);
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseTransformClass *trans_class = GST_BASE_TRANSFORM_CLASS (klass);
  const GstClothFilterPrivate defaults = { NULL };

  GST_DEBUG_CATEGORY_INIT (cloth_filter_debug, "clothfilter", 0,
      "base of elements that look at pictures");
  object_class->finalize = gst_cloth_filter_finalize;
  gst_cloth_install_properties (object_class, properties,
      G_N_ELEMENTS (properties), &defaults,
      g_type_class_get_instance_private_offset (klass));
  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  trans_class->start = gst_cloth_filter_start;
  trans_class->stop = gst_cloth_filter_stop;
  trans_class->set_caps = gst_cloth_filter_set_caps;
  trans_class->sink_event = gst_cloth_filter_sink_event;
  trans_class->query = gst_cloth_filter_query;
  trans_class->transform_ip = gst_cloth_filter_transform_ip;
  trans_class->transform_ip_on_passthrough = FALSE;
  gst_type_mark_as_plugin_api (GST_TYPE_CLOTH_FILTER, 0);
}

static void
gst_cloth_filter_init (GstClothFilter * self)
{
  GstBaseTransform *trans = GST_BASE_TRANSFORM (self);

  gst_base_transform_set_in_place (trans, TRUE);
  gst_base_transform_set_qos_enabled (trans, FALSE);
  gst_pad_add_probe (GST_BASE_TRANSFORM_SINK_PAD (trans),
      GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, look_for_encoded, self, NULL);
}
