/* Which place of the flat cloth each pixel of a picture shows, as metadata of its mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothuv.h"
#include "gst/cloth/gstclothpayload.h"

struct _GstClothUV
{
  GstClothPayload payload;
  guint width, height;
  gfloat uv[];
};

G_STATIC_ASSERT (sizeof (GstClothUVMeta) == sizeof (GstClothPayloadMeta));

G_DEFINE_BOXED_TYPE (GstClothUV, gst_cloth_uv, gst_cloth_uv_ref,
    gst_cloth_uv_unref);

/**
 * gst_cloth_uv_new:
 * @camera: (nullable): name of the camera in the rig, UTF-8 of at most
 *   #GST_CLOTH_MAX_CAMERA_NAME bytes; %NULL or "" when it isn't known
 * @sequence: number of the frame, counted by the camera
 * @width: columns of its picture as filmed, 1 to #GST_CLOTH_MAX_UV_SIZE
 * @height: its rows; at most #GST_CLOTH_MAX_UV_AREA pixels in all
 * @uv: (array length=n_floats): u and v of what each pixel shows, row by row, m on the flat
 *   cloth; NaN where that isn't known; copied
 * @n_floats: floats of @uv, two a pixel
 *
 * Which place of the flat cloth each pixel shows. A pixel has both or none: where one isn't
 * finite, the copy's two are NaN.
 *
 * Returns: (transfer full): a new map, immutable
 *
 * Since: 0.1
 */
GstClothUV *
gst_cloth_uv_new (const gchar * camera, guint64 sequence, guint width,
    guint height, const gfloat * uv, guint n_floats)
{
  GstClothUV *payload;

  g_return_val_if_fail (gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (width >= 1 && width <= GST_CLOTH_MAX_UV_SIZE
      && height >= 1 && height <= GST_CLOTH_MAX_UV_SIZE
      && width * height <= GST_CLOTH_MAX_UV_AREA, NULL);
  g_return_val_if_fail (uv != NULL && n_floats == 2 * width * height, NULL);

  payload = gst_cloth_payload_new (sizeof *payload + n_floats * sizeof *uv,
      camera, sequence, NULL);
  payload->payload.per_camera = TRUE;
  payload->width = width;
  payload->height = height;
  for (guint i = 0; i < n_floats; i += 2) {
    const gboolean known = isfinite (uv[i]) && isfinite (uv[i + 1]);

    payload->uv[i] = known ? uv[i] : NAN;
    payload->uv[i + 1] = known ? uv[i + 1] : NAN;
  }
  return payload;
}

/**
 * gst_cloth_uv_ref:
 * @uv: a map of places
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothUV *
gst_cloth_uv_ref (GstClothUV * uv)
{
  return g_atomic_rc_box_acquire (uv);
}

/**
 * gst_cloth_uv_unref:
 * @uv: (transfer full): a map of places
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_uv_unref (GstClothUV * uv)
{
  gst_cloth_payload_release (uv);
}

/**
 * gst_cloth_uv_get_camera:
 * @uv: a map of places
 *
 * Returns: (transfer none): name of the camera, "" when it isn't known
 *
 * Since: 0.1
 */
const gchar *
gst_cloth_uv_get_camera (const GstClothUV * uv)
{
  return uv->payload.camera;
}

/**
 * gst_cloth_uv_get_sequence:
 * @uv: a map of places
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.1
 */
guint64
gst_cloth_uv_get_sequence (const GstClothUV * uv)
{
  return uv->payload.sequence;
}

/**
 * gst_cloth_uv_get_width:
 * @uv: a map of places
 *
 * Returns: columns of the picture as filmed
 *
 * Since: 0.1
 */
guint
gst_cloth_uv_get_width (const GstClothUV * uv)
{
  return uv->width;
}

/**
 * gst_cloth_uv_get_height:
 * @uv: a map of places
 *
 * Returns: rows of the picture as filmed
 *
 * Since: 0.1
 */
guint
gst_cloth_uv_get_height (const GstClothUV * uv)
{
  return uv->height;
}

/**
 * gst_cloth_uv_get_uv:
 * @uv: a map of places
 * @n_floats: (out) (optional): two a pixel
 *
 * Returns: (array length=n_floats) (transfer none): u and v of what each pixel shows, row by
 *   row, m on the flat cloth; both NaN where that isn't known; valid as long as @uv is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_uv_get_uv (const GstClothUV * uv, guint * n_floats)
{
  if (n_floats)
    *n_floats = 2 * uv->width * uv->height;
  return uv->uv;
}

/**
 * gst_cloth_uv_get_map:
 * @uv: a map of places
 *
 * The places as 32 bit floats of the host, shape (height, width, 2), without a copy. From
 * Python: `numpy.frombuffer (uv.get_map ().get_data (), numpy.float32).reshape
 * (uv.get_height (), uv.get_width (), 2)`.
 *
 * Returns: (transfer full): bytes that hold a reference to @uv
 *
 * Since: 0.1
 */
GBytes *
gst_cloth_uv_get_map (GstClothUV * uv)
{
  return g_bytes_new_with_free_func (uv->uv,
      2 * sizeof (gfloat) * uv->width * uv->height,
      (GDestroyNotify) gst_cloth_uv_unref, gst_cloth_uv_ref (uv));
}

/**
 * gst_cloth_uv_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_uv_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothUVMetaAPI", FALSE);
}

/**
 * gst_cloth_uv_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_uv_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_uv_meta_api_get_type (), "GstClothUVMeta");
}

/**
 * gst_buffer_add_cloth_uv_meta:
 * @buffer: a writable buffer
 * @uv: (transfer full): of a camera that saw its mesh
 *
 * Puts @uv on @buffer, in place of the one of the same camera that it may have had.
 *
 * Returns: (transfer none): the meta that now holds @uv
 *
 * Since: 0.1
 */
GstClothUVMeta *
gst_buffer_add_cloth_uv_meta (GstBuffer * buffer, GstClothUV * uv)
{
  return gst_cloth_payload_attach (uv, buffer, gst_cloth_uv_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_uv:
 * @buffer: a buffer
 * @camera: (nullable): name of the camera; %NULL: whichever is the first
 *
 * Returns: (transfer none) (nullable): the map of @camera on @buffer, owned by it; %NULL when
 *   it has none
 *
 * Since: 0.1
 */
GstClothUV *
gst_buffer_get_cloth_uv (GstBuffer * buffer, const gchar * camera)
{
  return gst_cloth_payload_find_of_camera (buffer,
      gst_cloth_uv_meta_api_get_type (), camera);
}

/**
 * gst_buffer_get_nth_cloth_uv:
 * @buffer: a buffer
 * @index: which, from 0, in the order in which they were put there
 *
 * Returns: (transfer none) (nullable): that map on @buffer, owned by it; %NULL when it has not
 *   so many
 *
 * Since: 0.1
 */
GstClothUV *
gst_buffer_get_nth_cloth_uv (GstBuffer * buffer, guint index)
{
  return gst_cloth_payload_find_nth (buffer, gst_cloth_uv_meta_api_get_type (),
      index);
}
