/* clothjson: what was found as JSON Lines.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include <gst/video/video.h>
#include <gst/cloth/cloth.h>

#include "elements/gstclothjson.h"
#include "elements/gstclothutil.h"
#include "gst/cloth-io/jsonlines.h"

GST_DEBUG_CATEGORY_STATIC (cloth_json_debug);
#define GST_CAT_DEFAULT cloth_json_debug

/**
 * SECTION:element-clothjson
 *
 * Gives the squares, dots and matches on pictures, or the meshes of a mesh stream, as JSON
 * Lines: one object a frame, each on a line of its own, for programs in any language. Times are
 * running times in seconds. docs/formats.md has the keys and a schema.
 *
 * ## Example
 * ```
 * gst-launch-1.0 filesrc location=cam0.mp4 ! decodebin ! videoconvert ! saddledetect !
 *     quadtrack pattern=pattern.json ! clothjson ! filesink location=squares.jsonl
 * ```
 */
struct _GstClothJson
{
  GstBaseTransform parent;

  GstClothTopology *topology;   /* NULL for pictures */
};

#define JSON_CAPS "application/x-ndjson"

static GstStaticPadTemplate sink_template = GST_STATIC_PAD_TEMPLATE ("sink",
    GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS ("video/x-raw(ANY), "
        "width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ]; "
        GST_CLOTH_MESH_CAPS));
static GstStaticPadTemplate src_template = GST_STATIC_PAD_TEMPLATE ("src",
    GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS (JSON_CAPS));

G_DEFINE_TYPE (GstClothJson, gst_cloth_json, GST_TYPE_BASE_TRANSFORM);
GST_ELEMENT_REGISTER_DEFINE (clothjson, "clothjson", GST_RANK_NONE,
    GST_TYPE_CLOTH_JSON);

/* Text says nothing of what it was made of. */
static GstCaps *
gst_cloth_json_transform_caps (GstBaseTransform * trans,
    GstPadDirection direction, GstCaps * caps, GstCaps * filter)
{
  GstCaps *other = gst_static_pad_template_get_caps (direction ==
      GST_PAD_SINK ? &src_template : &sink_template);

  return gst_cloth_filter_caps (other, filter);
}

static gboolean
gst_cloth_json_set_caps (GstBaseTransform * trans, GstCaps * in, GstCaps * out)
{
  GstClothJson *self = GST_CLOTH_JSON (trans);

  g_clear_pointer (&self->topology, gst_cloth_topology_unref);
  if (!gst_structure_has_name (gst_caps_get_structure (in, 0),
          GST_CLOTH_MESH_MEDIA_TYPE))
    return TRUE;
  self->topology = gst_cloth_read_topology (GST_ELEMENT (self), in);
  return self->topology != NULL;
}

static gdouble
running_time_s (const GstSegment * segment, GstBuffer * buffer)
{
  GstClockTime time = GST_BUFFER_PTS (buffer);

  if (segment->format != GST_FORMAT_TIME || !GST_CLOCK_TIME_IS_VALID (time))
    return NAN;
  time = gst_segment_to_running_time (segment, GST_FORMAT_TIME, time);
  return GST_CLOCK_TIME_IS_VALID (time) ? (gdouble) time / GST_SECOND : NAN;
}

static GstFlowReturn
gst_cloth_json_prepare_output_buffer (GstBaseTransform * trans,
    GstBuffer * buffer, GstBuffer ** text)
{
  GstClothJson *self = GST_CLOTH_JSON (trans);
  const gdouble time_s = running_time_s (&trans->segment, buffer);
  gchar *line;

  if (self->topology) {
    g_autoptr (GstClothMesh) mesh = gst_cloth_read_mesh (GST_ELEMENT (self),
        buffer, gst_cloth_topology_get_n_vertices (self->topology));

    if (!mesh)
      return GST_FLOW_ERROR;
    line = gst_cloth_io_json_of_mesh (mesh, self->topology, time_s);
  } else {
    line = gst_cloth_io_json_of_picture (buffer, time_s);
  }
  *text = gst_buffer_new_wrapped (line, strlen (line));
  gst_buffer_copy_into (*text, buffer, GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
  return GST_FLOW_OK;
}

/* The buffer is whole already. */
static GstFlowReturn
gst_cloth_json_transform (GstBaseTransform * trans, GstBuffer * buffer,
    GstBuffer * text)
{
  return GST_FLOW_OK;
}

static gboolean
gst_cloth_json_stop (GstBaseTransform * trans)
{
  g_clear_pointer (&GST_CLOTH_JSON (trans)->topology, gst_cloth_topology_unref);
  return TRUE;
}

/* The metas ride on whatever memory upstream likes. */
static gboolean
gst_cloth_json_propose_allocation (GstBaseTransform * trans,
    GstQuery * decide_query, GstQuery * query)
{
  gst_query_add_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL);
  return TRUE;
}

static void
gst_cloth_json_class_init (GstClothJsonClass * klass)
{
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstBaseTransformClass *trans_class = GST_BASE_TRANSFORM_CLASS (klass);

  trans_class->transform_caps = gst_cloth_json_transform_caps;
  trans_class->set_caps = gst_cloth_json_set_caps;
  trans_class->prepare_output_buffer = gst_cloth_json_prepare_output_buffer;
  trans_class->transform = gst_cloth_json_transform;
  trans_class->stop = gst_cloth_json_stop;
  trans_class->propose_allocation = gst_cloth_json_propose_allocation;

  gst_element_class_add_static_pad_template (element_class, &sink_template);
  gst_element_class_add_static_pad_template (element_class, &src_template);
  gst_element_class_set_static_metadata (element_class,
      "Cloth metadata as JSON Lines", "Codec/Encoder/Metadata",
      "Turns the squares, dots and matches on pictures, or meshes, into one JSON object a "
      "frame", "The gst-cloth developers");
  GST_DEBUG_CATEGORY_INIT (cloth_json_debug, "clothjson", 0,
      "metadata and meshes as JSON Lines");
}

static void
gst_cloth_json_init (GstClothJson * self)
{
  gst_base_transform_set_qos_enabled (GST_BASE_TRANSFORM (self), FALSE);
}
