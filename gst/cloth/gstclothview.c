/* What one of the cameras that a mesh was made of saw, as metadata of the mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cloth/gstclothview.h"
#include "gst/cloth/gstclothpayload.h"

struct _GstClothView
{
  GstClothPayload payload;
  GstBuffer *observation;
};

G_STATIC_ASSERT (sizeof (GstClothViewMeta) == sizeof (GstClothPayloadMeta));

G_DEFINE_BOXED_TYPE (GstClothView, gst_cloth_view, gst_cloth_view_ref,
    gst_cloth_view_unref);

static void
view_clear (GstClothPayload * payload)
{
  gst_buffer_unref (((GstClothView *) payload)->observation);
}

/**
 * gst_cloth_view_new:
 * @camera: name of the camera in the rig, UTF-8 of at most #GST_CLOTH_MAX_CAMERA_NAME
 *   bytes; it may differ from the one in @observation, which may be ""
 * @sequence: number of the frame, counted by the camera
 * @observation: (transfer full): a buffer of the camera's observation stream. Its time stamp is
 *   that of the picture in the segment of the mesh's stream, by the camera's clock
 *
 * Returns: (transfer full): a new view, immutable
 *
 * Since: 0.2
 */
GstClothView *
gst_cloth_view_new (const gchar * camera, guint64 sequence,
    GstBuffer * observation)
{
  GstClothView *view;

  g_return_val_if_fail (camera != NULL
      && gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (GST_IS_BUFFER (observation), NULL);

  view = gst_cloth_payload_new (sizeof *view, camera, sequence, NULL);
  view->payload.per_camera = TRUE;
  view->payload.clear = view_clear;
  view->observation = observation;
  return view;
}

/**
 * gst_cloth_view_ref:
 * @view: a view
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.2
 */
GstClothView *
gst_cloth_view_ref (GstClothView * view)
{
  return g_atomic_rc_box_acquire (view);
}

/**
 * gst_cloth_view_unref:
 * @view: (transfer full): a view
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.2
 */
void
gst_cloth_view_unref (GstClothView * view)
{
  gst_cloth_payload_release (view);
}

/**
 * gst_cloth_view_get_camera:
 * @view: a view
 *
 * Returns: (transfer none): name of the camera in the rig; valid as long as @view is
 *
 * Since: 0.2
 */
const gchar *
gst_cloth_view_get_camera (const GstClothView * view)
{
  return view->payload.camera;
}

/**
 * gst_cloth_view_get_sequence:
 * @view: a view
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.2
 */
guint64
gst_cloth_view_get_sequence (const GstClothView * view)
{
  return view->payload.sequence;
}

/**
 * gst_cloth_view_get_observation:
 * @view: a view
 *
 * Returns: (transfer none): what the camera saw, for gst_cloth_observations_unpack(); not to be
 *   written to
 *
 * Since: 0.2
 */
GstBuffer *
gst_cloth_view_get_observation (const GstClothView * view)
{
  return view->observation;
}

/**
 * gst_cloth_view_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.2
 */
GType
gst_cloth_view_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothViewMetaAPI", FALSE);
}

/**
 * gst_cloth_view_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.2
 */
const GstMetaInfo *
gst_cloth_view_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_view_meta_api_get_type (), "GstClothViewMeta");
}

/**
 * gst_buffer_add_cloth_view_meta:
 * @buffer: a writable buffer
 * @view: (transfer full): what a camera saw of its mesh
 *
 * Puts @view on @buffer, in place of the one of this camera that it may have had.
 *
 * Returns: (transfer none): the meta that now holds @view
 *
 * Since: 0.2
 */
GstClothViewMeta *
gst_buffer_add_cloth_view_meta (GstBuffer * buffer, GstClothView * view)
{
  return gst_cloth_payload_attach (view, buffer,
      gst_cloth_view_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_view:
 * @buffer: a buffer
 * @camera: (nullable): name of the camera; %NULL: whichever is the first
 *
 * Returns: (transfer none) (nullable): what @camera saw of the mesh on @buffer, owned by it;
 *   %NULL when that isn't there
 *
 * Since: 0.2
 */
GstClothView *
gst_buffer_get_cloth_view (GstBuffer * buffer, const gchar * camera)
{
  return gst_cloth_payload_find_of_camera (buffer,
      gst_cloth_view_meta_api_get_type (), camera);
}

/**
 * gst_buffer_get_nth_cloth_view:
 * @buffer: a buffer
 * @index: which, from 0, in the order in which they were put there
 *
 * Returns: (transfer none) (nullable): that view on @buffer, owned by it; %NULL when it has
 *   not so many
 *
 * Since: 0.2
 */
GstClothView *
gst_buffer_get_nth_cloth_view (GstBuffer * buffer, guint index)
{
  return gst_cloth_payload_find_nth (buffer,
      gst_cloth_view_meta_api_get_type (), index);
}
