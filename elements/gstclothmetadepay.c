/* clothmetadepay: an observation stream as black pictures with metas.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>

#include "elements/gstclothmetadepay.h"
#include "elements/gstclothutil.h"

GST_DEBUG_CATEGORY_STATIC (cloth_meta_depay_debug);
#define GST_CAT_DEFAULT cloth_meta_depay_debug

/**
 * SECTION:element-clothmetadepay
 *
 * Undoes clothmetapay: gives black pictures of the size that the camera filmed, with
 * the metas on them, so that every element that takes pictures with metas takes them.
 * All pictures share one read-only memory: black costs nothing.
 *
 * ## Example
 * ```
 * gst-launch-1.0 filesrc location=cam0.gdp ! gdpdepay ! clothmetadepay !
 *     clothoverlay ! videoconvert ! autovideosink
 * ```
 */
struct _GstClothMetaDepay
{
  GstBaseTransform parent;

  GstMemory *black;
};

/* In all of these zero bytes are black. */
#define FORMATS "{ GRAY8, BGRx, RGBx, xRGB, xBGR, RGB, BGR }"

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS,
    GST_STATIC_CAPS (GST_CLOTH_OBSERVATIONS_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS ("video/x-raw, format="
        FORMATS ", width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ], "
        "framerate=(fraction)[ 0/1, max ]"));

G_DEFINE_TYPE (GstClothMetaDepay, gst_cloth_meta_depay,
    GST_TYPE_BASE_TRANSFORM);
GST_ELEMENT_REGISTER_DEFINE (clothmetadepay, "clothmetadepay", GST_RANK_NONE,
    GST_TYPE_CLOTH_META_DEPAY);

static GstCaps *
gst_cloth_meta_depay_transform_caps (GstBaseTransform * trans,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter)
{
  static const gchar *const kept[] = { "width", "height", "framerate", NULL };

  return gst_cloth_carry_caps (caps, kept,
      gst_static_pad_template_get_caps (direction == GST_PAD_SINK ?
          &src_template : &sink_template), filter);
}

static gboolean
gst_cloth_meta_depay_set_caps (GstBaseTransform * trans, GstCaps * in,
    GstCaps * out)
{
  GstClothMetaDepay *self = GST_CLOTH_META_DEPAY (trans);
  GstVideoInfo info;
  gpointer zeros;

  g_clear_pointer (&self->black, gst_memory_unref);
  if (!gst_video_info_from_caps (&info, out))
    return FALSE;
  /* pages that nobody reads are never there, however large the caps say */
  zeros = g_try_malloc0 (GST_VIDEO_INFO_SIZE (&info));
  if (!zeros)
    return FALSE;
  self->black = gst_memory_new_wrapped (GST_MEMORY_FLAG_READONLY, zeros,
      GST_VIDEO_INFO_SIZE (&info), 0, GST_VIDEO_INFO_SIZE (&info), zeros,
      g_free);
  return TRUE;
}

static GstFlowReturn
gst_cloth_meta_depay_prepare_output_buffer (GstBaseTransform * trans,
    GstBuffer * observation, GstBuffer ** picture)
{
  GstClothMetaDepay *self = GST_CLOTH_META_DEPAY (trans);
  g_autoptr (GstBuffer) made = gst_buffer_new ();
  g_autoptr (GError) error = NULL;

  gst_buffer_append_memory (made, gst_memory_ref (self->black));
  gst_buffer_copy_into (made, observation, GST_BUFFER_COPY_FLAGS
      | GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
  if (!gst_cloth_observations_unpack (observation, made, &error)) {
    GST_ELEMENT_ERROR (self, STREAM, DECODE,
        ("The observation stream is damaged: %s. Write it anew with "
            "clothmetapay.", error->message), (NULL));
    return GST_FLOW_ERROR;
  }
  *picture = g_steal_pointer (&made);
  return GST_FLOW_OK;
}

/* The picture is whole already. */
static GstFlowReturn
gst_cloth_meta_depay_transform (GstBaseTransform * trans,
    GstBuffer * observation, GstBuffer * picture)
{
  return GST_FLOW_OK;
}

static gboolean
gst_cloth_meta_depay_stop (GstBaseTransform * trans)
{
  GstClothMetaDepay *self = GST_CLOTH_META_DEPAY (trans);

  g_clear_pointer (&self->black, gst_memory_unref);
  return TRUE;
}

static void
gst_cloth_meta_depay_class_init (GstClothMetaDepayClass * klass)
{
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseTransformClass *trans_class = GST_BASE_TRANSFORM_CLASS (klass);

  trans_class->transform_caps = gst_cloth_meta_depay_transform_caps;
  trans_class->set_caps = gst_cloth_meta_depay_set_caps;
  trans_class->prepare_output_buffer =
      gst_cloth_meta_depay_prepare_output_buffer;
  trans_class->transform = gst_cloth_meta_depay_transform;
  trans_class->stop = gst_cloth_meta_depay_stop;

  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class,
      "Cloth metadata depayloader", "Codec/Depayloader",
      "Turns an observation stream into black pictures with the saddles, "
      "quads and dots on them", "The gst-cloth developers");
  GST_DEBUG_CATEGORY_INIT (cloth_meta_depay_debug, "clothmetadepay", 0,
      "metadata without pixels, back on pictures");
}

static void
gst_cloth_meta_depay_init (GstClothMetaDepay * self)
{
  gst_base_transform_set_qos_enabled (GST_BASE_TRANSFORM (self), FALSE);
}
