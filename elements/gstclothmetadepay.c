/* clothmetadepay: an observation stream as black pictures with metas.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>

#include "elements/gstclothdamage.h"
#include "elements/gstclothmetadepay.h"
#include "elements/gstclothproperties.h"
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
 * A damaged packet is dropped and counted in `dropped`; the first gives a warning, the end
 * of the stream an info message with their number. With `strict`, for files, the first is an
 * error.
 *
 * ## Example
 * ```
 * gst-launch-1.0 filesrc location=cam0.gdp ! gdpdepay ! clothmetadepay !
 *     clothoverlay ! videoconvert ! autovideosink
 * ```
 */
typedef struct
{
  GstClothDamage damage;
} Settings;

struct _GstClothMetaDepay
{
  GstBaseTransform parent;

  Settings settings;            /* object lock */
  GstMemory *black;
};

/* *INDENT-OFF* */
static const GstClothProperty properties[] = {
  GST_CLOTH_DAMAGE_PROPERTIES (Settings, damage),
};
/* *INDENT-ON* */

static const Settings defaults = { {FALSE, 0, 0} };

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
  GstBuffer *made = gst_buffer_new ();

  gst_buffer_append_memory (made, gst_memory_ref (self->black));
  gst_buffer_copy_into (made, observation, GST_BUFFER_COPY_FLAGS
      | GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
  *picture = made;
  return GST_FLOW_OK;
}

static GstFlowReturn
gst_cloth_meta_depay_transform (GstBaseTransform * trans,
    GstBuffer * observation, GstBuffer * picture)
{
  GstClothMetaDepay *self = GST_CLOTH_META_DEPAY (trans);
  g_autoptr (GError) error = NULL;
  GstFlowReturn flow;

  if (gst_cloth_observations_unpack (observation, picture, &error))
    return GST_FLOW_OK;
  flow = gst_cloth_damage_add (&self->settings.damage, GST_ELEMENT (self),
      error);
  return flow == GST_FLOW_OK ? GST_BASE_TRANSFORM_FLOW_DROPPED : flow;
}

static gboolean
gst_cloth_meta_depay_start (GstBaseTransform * trans)
{
  GstClothMetaDepay *self = GST_CLOTH_META_DEPAY (trans);

  gst_cloth_damage_reset (&self->settings.damage, GST_ELEMENT (self));
  return TRUE;
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

  gst_cloth_install_properties (G_OBJECT_CLASS (klass), properties,
      G_N_ELEMENTS (properties), &defaults,
      G_STRUCT_OFFSET (GstClothMetaDepay, settings));
  trans_class->transform_caps = gst_cloth_meta_depay_transform_caps;
  trans_class->set_caps = gst_cloth_meta_depay_set_caps;
  trans_class->prepare_output_buffer =
      gst_cloth_meta_depay_prepare_output_buffer;
  trans_class->transform = gst_cloth_meta_depay_transform;
  trans_class->start = gst_cloth_meta_depay_start;
  trans_class->stop = gst_cloth_meta_depay_stop;

  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class,
      "Cloth metadata depayloader", "Codec/Depayloader",
      "Turns an observation stream into black pictures with the saddles, "
      "quads, dots, silhouettes and matches on them",
      "The gst-cloth developers");
  GST_DEBUG_CATEGORY_INIT (cloth_meta_depay_debug, "clothmetadepay", 0,
      "metadata without pixels, back on pictures");
}

static void
gst_cloth_meta_depay_init (GstClothMetaDepay * self)
{
  self->settings = defaults;
  gst_cloth_damage_watch (&self->settings.damage, GST_ELEMENT (self),
      GST_BASE_TRANSFORM_SRC_PAD (self));
  gst_base_transform_set_qos_enabled (GST_BASE_TRANSFORM (self), FALSE);
}
