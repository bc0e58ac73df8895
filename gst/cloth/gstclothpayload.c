/* What the payloads of buffer metadata have in common: one counted allocation, and a meta
 * that holds it, copies it by reference and scales it with the picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include <gst/video/video.h>
#include <gst/video/gstvideometa.h>

#include "gst/cloth/gstclothpayload.h"

/* @size: bytes of the payload's struct and items
 * @camera: (nullable): a name that gst_cloth_camera_is_valid()
 * @sequence: number of the frame
 * @scale: (nullable): how it is scaled
 *
 * Returns: (transfer full): a payload; what follows its #GstClothPayload is not set
 */
gpointer
gst_cloth_payload_new (gsize size, const gchar * camera, guint64 sequence,
    GstClothPayloadScale scale)
{
  GstClothPayload *payload = g_atomic_rc_box_alloc (size);

  payload->sequence = sequence;
  payload->scale = scale;
  payload->clear = NULL;
  payload->per_camera = FALSE;
  g_strlcpy (payload->camera, camera ? camera : "", sizeof payload->camera);
  return payload;
}

static void
payload_clear (gpointer payload)
{
  GstClothPayload *cleared = payload;

  if (cleared->clear)
    cleared->clear (cleared);
}

/* @payload: (transfer full): gives a reference back; the last one frees
 */
void
gst_cloth_payload_release (gpointer payload)
{
  g_atomic_rc_box_release_full (payload, payload_clear);
}

/* The scale of a payload that has a size of its own: nothing changes, so that one payload
 * serves every size of the picture.
 */
void
gst_cloth_payload_keep_size (GstClothPayload * payload, gdouble scale_x,
    gdouble scale_y)
{
}

/* Returns: (transfer full): the payload of the same picture at another size
 */
gpointer
gst_cloth_payload_scale (const GstClothPayload * payload, gdouble scale_x,
    gdouble scale_y)
{
  GstClothPayload *source = (GstClothPayload *) payload;
  GstClothPayload *scaled;

  g_return_val_if_fail (payload != NULL, NULL);
  g_return_val_if_fail (scale_x > 0 && scale_y > 0, NULL);

  if (source->scale == gst_cloth_payload_keep_size)
    return g_atomic_rc_box_acquire (source);
  scaled = g_atomic_rc_box_dup (g_atomic_rc_box_get_size (source), source);
  scaled->scale (scaled, scale_x, scale_y);
  return scaled;
}

static gboolean
meta_init (GstMeta * meta, gpointer params, GstBuffer * buffer)
{
  ((GstClothPayloadMeta *) meta)->payload = NULL;
  return TRUE;
}

static void
meta_free (GstMeta * meta, GstBuffer * buffer)
{
  g_clear_pointer (&((GstClothPayloadMeta *) meta)->payload,
      gst_cloth_payload_release);
}

/* Whether a picture is displayed in one shape before and after, but for sizes in whole pixels */
static gboolean
keeps_shape (const GstVideoInfo * in, const GstVideoInfo * out)
{
  const gdouble shape = (gdouble) in->width * in->par_n * out->par_d /
      ((gdouble) in->height * in->par_d * out->par_n);

  return fabs (out->height * shape - out->width) < 1
      || fabs (out->width / shape - out->height) < 1;
}

/* TRUE when a meta's transformation is a change of the picture's size, and that of the whole
 * picture. What scales to another shape adds borders, or distorts, and doesn't say which. */
static gboolean
get_scale (GQuark type, gpointer data, gdouble * scale_x, gdouble * scale_y)
{
  static gint told = FALSE;
  const GstVideoMetaTransform *scale = data;

  if (!GST_VIDEO_META_TRANSFORM_IS_SCALE (type))
    return FALSE;
  if (GST_VIDEO_INFO_WIDTH (scale->in_info) <= 0
      || GST_VIDEO_INFO_HEIGHT (scale->in_info) <= 0)
    return FALSE;
  if (!keeps_shape (scale->in_info, scale->out_info)) {
    if (g_atomic_int_compare_and_exchange (&told, FALSE, TRUE))
      GST_WARNING
          ("Pictures of %dx%d are scaled to %dx%d, another shape, maybe "
          "with borders: what was seen in them is dropped. Leave "
          "pixel-aspect-ratio out of the caps, or detect behind the scaling.",
          GST_VIDEO_INFO_WIDTH (scale->in_info),
          GST_VIDEO_INFO_HEIGHT (scale->in_info),
          GST_VIDEO_INFO_WIDTH (scale->out_info),
          GST_VIDEO_INFO_HEIGHT (scale->out_info));
    return FALSE;
  }
  *scale_x = (gdouble) GST_VIDEO_INFO_WIDTH (scale->out_info)
      / GST_VIDEO_INFO_WIDTH (scale->in_info);
  *scale_y = (gdouble) GST_VIDEO_INFO_HEIGHT (scale->out_info)
      / GST_VIDEO_INFO_HEIGHT (scale->in_info);
  return *scale_x > 0 && *scale_y > 0;
}

/* A part of a mesh is no mesh: what is not of a picture stays with whole buffers only. */
static gboolean
meta_transform (GstBuffer * target, GstMeta * meta, GstBuffer * buffer,
    GQuark type, gpointer data)
{
  GstClothPayload *payload = ((GstClothPayloadMeta *) meta)->payload;
  gdouble sx, sy;

  if (!payload)
    return FALSE;
  if (GST_META_TRANSFORM_IS_COPY (type)) {
    if (!payload->scale && ((GstMetaTransformCopy *) data)->region)
      return FALSE;
    g_atomic_rc_box_acquire (payload);
  } else if (payload->scale && get_scale (type, data, &sx, &sy)) {
    payload = gst_cloth_payload_scale (payload, sx, sy);
  } else {
    return FALSE;
  }
  return gst_cloth_payload_attach (payload, target, meta->info) != NULL;
}

/* @type: where the type is kept, 0 at first
 * @name: its name
 * @of_picture: whether it changes with the picture's format, orientation and size
 *
 * Returns: the type of a meta's API, registered once
 */
GType
gst_cloth_payload_register_api (GType * type, const gchar * name,
    gboolean of_picture)
{
  static const gchar *tags[] = { GST_META_TAG_VIDEO_STR,
    GST_META_TAG_VIDEO_ORIENTATION_STR, GST_META_TAG_VIDEO_SIZE_STR, NULL
  };

  if (g_once_init_enter (type))
    g_once_init_leave (type,
        gst_meta_api_type_register (name, of_picture ? tags : tags + 3));
  return *type;
}

/* @info: where the meta is kept, %NULL at first
 * @api: the type of its API
 * @name: its name
 *
 * Returns: (transfer none): a meta's implementation, registered once
 */
const GstMetaInfo *
gst_cloth_payload_register_meta (const GstMetaInfo ** info, GType api,
    const gchar * name)
{
  if (g_once_init_enter (info))
    g_once_init_leave (info, gst_meta_register (api, name,
            sizeof (GstClothPayloadMeta), meta_init, meta_free,
            meta_transform));
  return *info;
}

/* Returns: (transfer none) (nullable): the meta of @buffer under @api; of @camera, unless
 *   that is %NULL
 */
static GstMeta *
find_meta (GstBuffer * buffer, GType api, const gchar * camera)
{
  gpointer iterator = NULL;
  GstMeta *meta;

  while ((meta = gst_buffer_iterate_meta_filtered (buffer, &iterator, api))) {
    const GstClothPayload *payload = ((GstClothPayloadMeta *) meta)->payload;

    if (!camera || (payload && strcmp (payload->camera, camera) == 0))
      return meta;
  }
  return NULL;
}

/* @payload: (transfer full): what to put on @buffer
 * @buffer: a writable buffer
 * @info: of the meta that holds it
 *
 * Puts @payload on @buffer, in place of the one it may have had; of a kind that is there for
 * each camera, in place of the one of its camera.
 *
 * Returns: (transfer none): the meta that now holds @payload
 */
gpointer
gst_cloth_payload_attach (gpointer payload, GstBuffer * buffer,
    const GstMetaInfo * info)
{
  const GstClothPayload *added = payload;
  GstMeta *meta;

  g_return_val_if_fail (GST_IS_BUFFER (buffer), NULL);
  g_return_val_if_fail (gst_buffer_is_writable (buffer), NULL);
  g_return_val_if_fail (payload != NULL, NULL);

  meta = find_meta (buffer, info->api, added->per_camera ? added->camera :
      NULL);
  if (!meta)
    meta = gst_buffer_add_meta (buffer, info, NULL);
  if (!meta) {
    gst_cloth_payload_release (payload);
    return NULL;
  }
  meta_free (meta, buffer);
  ((GstClothPayloadMeta *) meta)->payload = payload;
  return meta;
}

/* Returns: (transfer none) (nullable): the payload that @buffer has under @api
 */
gpointer
gst_cloth_payload_find (GstBuffer * buffer, GType api)
{
  return gst_cloth_payload_find_of_camera (buffer, api, NULL);
}

/* Returns: (transfer none) (nullable): the payload of @camera that @buffer has under @api;
 *   the first one when @camera is %NULL
 */
gpointer
gst_cloth_payload_find_of_camera (GstBuffer * buffer, GType api,
    const gchar * camera)
{
  GstMeta *meta;

  g_return_val_if_fail (GST_IS_BUFFER (buffer), NULL);

  meta = find_meta (buffer, api, camera);
  return meta ? ((GstClothPayloadMeta *) meta)->payload : NULL;
}

/* Returns: (transfer none) (nullable): the payload number @index that @buffer has under
 *   @api, in the order in which they were put there
 */
gpointer
gst_cloth_payload_find_nth (GstBuffer * buffer, GType api, guint index)
{
  gpointer iterator = NULL;
  GstMeta *meta;

  g_return_val_if_fail (GST_IS_BUFFER (buffer), NULL);

  while ((meta = gst_buffer_iterate_meta_filtered (buffer, &iterator, api)))
    if (index-- == 0)
      return ((GstClothPayloadMeta *) meta)->payload;
  return NULL;
}
