/* clothmetapay: what was seen in pictures, as an observation stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>

#include "elements/gstclothmetapay.h"
#include "elements/gstclothutil.h"

GST_DEBUG_CATEGORY_STATIC (cloth_meta_pay_debug);
#define GST_CAT_DEFAULT cloth_meta_pay_debug

/* Of the time in an observation's header: docs/streams.md. */
#define TIME_AT 16

/**
 * SECTION:element-clothmetapay
 *
 * Takes pictures with the metas of saddledetect, quadtrack and dotlabel and gives the
 * metas without the pictures, one buffer a picture. `gdppay` and `rtpgstpay` carry them to
 * another process or host, where clothmetadepay undoes this. Straight into a `filesink` the
 * observations are what a take keeps of a camera; the times in such a file are running
 * times.
 *
 * ## Example
 * ```
 * gst-launch-1.0 videotestsrc num-buffers=10 ! clothmetapay ! gdppay !
 *     filesink location=cam0.gdp
 * ```
 */
struct _GstClothMetaPay
{
  GstBaseTransform parent;

  guint n_clocks;               /* of the last picture that was looked at */
  gboolean told;                /* of a clock that is left out */
};

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS ("video/x-raw(ANY), "
        "width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ]"));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (GST_CLOTH_OBSERVATIONS_CAPS));

G_DEFINE_TYPE (GstClothMetaPay, gst_cloth_meta_pay, GST_TYPE_BASE_TRANSFORM);
GST_ELEMENT_REGISTER_DEFINE (clothmetapay, "clothmetapay", GST_RANK_NONE,
    GST_TYPE_CLOTH_META_PAY);

/* Size and rate go through; all else belongs to the pixels. */
static GstCaps *
gst_cloth_meta_pay_transform_caps (GstBaseTransform * trans,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter)
{
  static const gchar *const kept[] = { "width", "height", "framerate", NULL };
  GstCaps *other = gst_static_pad_template_get_caps (direction ==
      GST_PAD_SINK ? &src_template : &sink_template);

  if (direction == GST_PAD_SINK) {
    /* pictures need not say their rate */
    other = gst_caps_make_writable (other);
    gst_caps_set_simple (other, "framerate", GST_TYPE_FRACTION, 0, 1, NULL);
  }
  return gst_cloth_carry_caps (caps, kept, other, filter);
}

/* A file has no segment: its times are running times, as those of a recorded mesh are. */
static void
write_running_time (const GstSegment * segment, GstBuffer * observation)
{
  GstClockTime time = GST_BUFFER_PTS (observation);
  guint8 bytes[8];

  if (segment->format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID (time))
    return;
  time = gst_segment_to_running_time (segment, GST_FORMAT_TIME, time);
  GST_WRITE_UINT64_LE (bytes, time);
  gst_buffer_fill (observation, TIME_AT, bytes, sizeof bytes);
}

/* Says once that the times of a clock go no further. */
static void
tell_of_clocks (GstClothMetaPay * self, GstBuffer * picture,
    GstBuffer * observation)
{
  const guint n =
      gst_buffer_get_n_meta (picture, GST_REFERENCE_TIMESTAMP_META_API_TYPE);
  g_autoptr (GstBuffer) unpacked = NULL;

  if (n == self->n_clocks || self->told)
    return;
  self->n_clocks = n;
  unpacked = gst_buffer_new ();
  if (!gst_cloth_observations_unpack (observation, unpacked, NULL) ||
      gst_buffer_get_n_meta (unpacked,
          GST_REFERENCE_TIMESTAMP_META_API_TYPE) == n)
    return;
  self->told = TRUE;
  GST_ELEMENT_WARNING (self, STREAM, FORMAT,
      ("Pictures have times of a clock that observations can't carry: these "
          "times are left out"), ("docs/streams.md lists the clocks."));
}

static GstFlowReturn
gst_cloth_meta_pay_prepare_output_buffer (GstBaseTransform * trans,
    GstBuffer * picture, GstBuffer ** observation)
{
  *observation = gst_cloth_observations_pack (picture);
  tell_of_clocks (GST_CLOTH_META_PAY (trans), picture, *observation);
  write_running_time (&trans->segment, *observation);
  GST_LOG_OBJECT (trans, "%" GST_PTR_FORMAT, *observation);
  return GST_FLOW_OK;
}

/* The buffer is whole already. */
static GstFlowReturn
gst_cloth_meta_pay_transform (GstBaseTransform * trans, GstBuffer * picture,
    GstBuffer * observation)
{
  return GST_FLOW_OK;
}

static gboolean
gst_cloth_meta_pay_start (GstBaseTransform * trans)
{
  GST_CLOTH_META_PAY (trans)->told = FALSE;
  GST_CLOTH_META_PAY (trans)->n_clocks = 0;
  return TRUE;
}

/* The metas ride on whatever memory upstream likes; only nothing of ours does. */
static gboolean
gst_cloth_meta_pay_propose_allocation (GstBaseTransform * trans,
    GstQuery * decide_query, GstQuery * query)
{
  gst_query_add_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL);
  return TRUE;
}

static void
gst_cloth_meta_pay_class_init (GstClothMetaPayClass * klass)
{
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseTransformClass *trans_class = GST_BASE_TRANSFORM_CLASS (klass);

  trans_class->start = gst_cloth_meta_pay_start;
  trans_class->transform_caps = gst_cloth_meta_pay_transform_caps;
  trans_class->prepare_output_buffer = gst_cloth_meta_pay_prepare_output_buffer;
  trans_class->transform = gst_cloth_meta_pay_transform;
  trans_class->propose_allocation = gst_cloth_meta_pay_propose_allocation;

  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class,
      "Cloth metadata payloader", "Codec/Payloader",
      "Turns the saddles, quads, dots, silhouettes and matches on pictures into an observation "
      "stream without pixels", "The gst-cloth developers");
  GST_DEBUG_CATEGORY_INIT (cloth_meta_pay_debug, "clothmetapay", 0,
      "metadata without pixels");
}

static void
gst_cloth_meta_pay_init (GstClothMetaPay * self)
{
  gst_base_transform_set_qos_enabled (GST_BASE_TRANSFORM (self), FALSE);
}
