/* Base of elements that look at pictures and leave what they see as metas.
 *
 * Pictures go through as they are: their memory is mapped for reading only, so that
 * buffers shared after a tee stay shared. QoS is off: a late picture is late, not lost.
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
} GstClothFilterPrivate;

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  {"camera", "Camera",
    "Name of the camera in the rig, which is written into the metadata",
    G_TYPE_STRING, GST_CLOTH_SETTING (GstClothFilterPrivate, camera),
    GST_PARAM_MUTABLE_PLAYING},
};
/* *INDENT-ON* */

#define FILTER_CAPS GST_VIDEO_CAPS_MAKE (GST_CLOTH_FILTER_FORMATS) \
    ", width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ]"

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS (FILTER_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (FILTER_CAPS));

G_DEFINE_ABSTRACT_TYPE_WITH_PRIVATE (GstClothFilter, gst_cloth_filter,
    GST_TYPE_BASE_TRANSFORM);

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

static GstFlowReturn
gst_cloth_filter_transform_ip (GstBaseTransform * trans, GstBuffer * buffer)
{
  GstClothFilter *self = GST_CLOTH_FILTER (trans);
  GstClothFilterPrivate *priv = gst_cloth_filter_get_instance_private (self);
  GstClothFilterFrame frame;
  GstVideoFrame video;
  GstFlowReturn flow;
  GstClockTime time;
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
  frame.luma.data = GST_VIDEO_FRAME_COMP_DATA (&video, 0);
  frame.luma.width = GST_VIDEO_FRAME_WIDTH (&video);
  frame.luma.height = GST_VIDEO_FRAME_HEIGHT (&video);
  frame.luma.stride = GST_VIDEO_FRAME_COMP_STRIDE (&video, 0);
  frame.video = &video;
  frame.sequence = gst_cloth_number_picture (&trans->segment,
      GST_VIDEO_INFO_FPS_N (&priv->info), GST_VIDEO_INFO_FPS_D (&priv->info),
      buffer, priv->count);
  frame.camera = camera;
  frame.buffer = buffer;
  flow = GST_CLOTH_FILTER_GET_CLASS (self)->analyse (self, &frame);
  priv->count++;
  gst_video_frame_unmap (&video);
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

static void
gst_cloth_filter_finalize (GObject * object)
{
  GstClothFilterPrivate *priv =
      gst_cloth_filter_get_instance_private (GST_CLOTH_FILTER (object));

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
}
