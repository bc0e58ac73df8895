/* The disparities of the cloth in one picture of a stereo head, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothdisparity.h"
#include "gst/cloth/gstclothpayload.h"

struct _GstClothStereo
{
  guint width, height;
  guint n_cameras;
  gdouble normal[3];
  gdouble focal_baseline;
  gdouble rotation[9], translation[3];
  gfloat rays[];
};

/* The states follow the disparities. */
struct _GstClothDisparity
{
  GstClothPayload payload;
  GstClothStereo *stereo;
  gfloat sigma;
  gfloat disparities[];
};

G_STATIC_ASSERT (sizeof (GstClothDisparityMeta) ==
    sizeof (GstClothPayloadMeta));

G_DEFINE_BOXED_TYPE (GstClothStereo, gst_cloth_stereo, gst_cloth_stereo_ref,
    gst_cloth_stereo_unref);
G_DEFINE_BOXED_TYPE (GstClothDisparity, gst_cloth_disparity,
    gst_cloth_disparity_ref, gst_cloth_disparity_unref);

static gboolean
all_finite (const gdouble * values, guint n)
{
  for (guint i = 0; i < n; i++)
    if (!isfinite (values[i]))
      return FALSE;
  return TRUE;
}

static guint
count_pixels (const GstClothStereo * stereo)
{
  return stereo->width * stereo->height;
}

/**
 * gst_cloth_stereo_new:
 * @width: columns of the picture as filmed, 1 to #GST_CLOTH_MAX_DISPARITY_SIZE
 * @height: its rows; at most #GST_CLOTH_MAX_DISPARITY_AREA pixels in all
 * @rays: (array length=n_rays): x/z and y/z of what each pixel sees, in the camera's frame,
 *   the lens undone; NaN where a pixel sees nothing; copied
 * @n_rays: floats of @rays, two a pixel
 * @normal: (array fixed-size=3): unit vector along which depth is measured, in the camera's
 *   frame
 * @focal_baseline: focal length times baseline, px·m, over 0
 * @rotation: (array fixed-size=9): pose of the camera, row by row, as in
 *   x_camera = @rotation · X + @translation
 * @translation: (array fixed-size=3): the same, m
 * @n_cameras: of the stereo head, 2 or more
 *
 * What a stereo head's pictures have in common: what makes points of disparities.
 *
 * Returns: (transfer full): a new stereo head, immutable
 *
 * Since: 0.1
 */
GstClothStereo *
gst_cloth_stereo_new (guint width, guint height, const gfloat * rays,
    guint n_rays, const gdouble normal[3], gdouble focal_baseline,
    const gdouble rotation[9], const gdouble translation[3], guint n_cameras)
{
  GstClothStereo *stereo;

  g_return_val_if_fail (width >= 1 && width <= GST_CLOTH_MAX_DISPARITY_SIZE
      && height >= 1 && height <= GST_CLOTH_MAX_DISPARITY_SIZE
      && width * height <= GST_CLOTH_MAX_DISPARITY_AREA, NULL);
  g_return_val_if_fail (rays != NULL && n_rays == 2 * width * height, NULL);
  g_return_val_if_fail (normal != NULL && all_finite (normal, 3), NULL);
  g_return_val_if_fail (fabs (normal[0] * normal[0] + normal[1] * normal[1]
          + normal[2] * normal[2] - 1) < 1e-6, NULL);
  g_return_val_if_fail (isfinite (focal_baseline) && focal_baseline > 0, NULL);
  g_return_val_if_fail (rotation != NULL && all_finite (rotation, 9), NULL);
  g_return_val_if_fail (translation != NULL && all_finite (translation, 3),
      NULL);
  g_return_val_if_fail (n_cameras >= 2, NULL);

  stereo = g_atomic_rc_box_alloc (sizeof *stereo + n_rays * sizeof *rays);
  stereo->width = width;
  stereo->height = height;
  stereo->n_cameras = n_cameras;
  stereo->focal_baseline = focal_baseline;
  memcpy (stereo->normal, normal, sizeof stereo->normal);
  memcpy (stereo->rotation, rotation, sizeof stereo->rotation);
  memcpy (stereo->translation, translation, sizeof stereo->translation);
  memcpy (stereo->rays, rays, n_rays * sizeof *rays);
  return stereo;
}

/**
 * gst_cloth_stereo_ref:
 * @stereo: a stereo head
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothStereo *
gst_cloth_stereo_ref (GstClothStereo * stereo)
{
  return g_atomic_rc_box_acquire (stereo);
}

/**
 * gst_cloth_stereo_unref:
 * @stereo: (transfer full): a stereo head
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_stereo_unref (GstClothStereo * stereo)
{
  g_atomic_rc_box_release (stereo);
}

/**
 * gst_cloth_stereo_get_width:
 * @stereo: a stereo head
 *
 * Returns: columns of the picture as filmed
 *
 * Since: 0.1
 */
guint
gst_cloth_stereo_get_width (const GstClothStereo * stereo)
{
  return stereo->width;
}

/**
 * gst_cloth_stereo_get_height:
 * @stereo: a stereo head
 *
 * Returns: rows of the picture as filmed
 *
 * Since: 0.1
 */
guint
gst_cloth_stereo_get_height (const GstClothStereo * stereo)
{
  return stereo->height;
}

/**
 * gst_cloth_stereo_get_n_cameras:
 * @stereo: a stereo head
 *
 * Returns: how many cameras it has
 *
 * Since: 0.1
 */
guint
gst_cloth_stereo_get_n_cameras (const GstClothStereo * stereo)
{
  return stereo->n_cameras;
}

/**
 * gst_cloth_stereo_get_rays:
 * @stereo: a stereo head
 * @n_rays: (out) (optional): floats, two a pixel
 *
 * Returns: (array length=n_rays) (transfer none): x/z and y/z of what each pixel sees, in the
 *   camera's frame; NaN where it sees nothing; valid as long as @stereo is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_stereo_get_rays (const GstClothStereo * stereo, guint * n_rays)
{
  if (n_rays)
    *n_rays = 2 * count_pixels (stereo);
  return stereo->rays;
}

/**
 * gst_cloth_stereo_get_normal:
 * @stereo: a stereo head
 *
 * Returns: (array fixed-size=3) (transfer none): unit vector along which depth is measured, in
 *   the camera's frame
 *
 * Since: 0.1
 */
const gdouble *
gst_cloth_stereo_get_normal (const GstClothStereo * stereo)
{
  return stereo->normal;
}

/**
 * gst_cloth_stereo_get_focal_baseline:
 * @stereo: a stereo head
 *
 * Returns: focal length times baseline, px·m: depth times disparity
 *
 * Since: 0.1
 */
gdouble
gst_cloth_stereo_get_focal_baseline (const GstClothStereo * stereo)
{
  return stereo->focal_baseline;
}

/**
 * gst_cloth_stereo_get_rotation:
 * @stereo: a stereo head
 *
 * Returns: (array fixed-size=9) (transfer none): from the world's to the camera's frame, row by
 *   row
 *
 * Since: 0.1
 */
const gdouble *
gst_cloth_stereo_get_rotation (const GstClothStereo * stereo)
{
  return stereo->rotation;
}

/**
 * gst_cloth_stereo_get_translation:
 * @stereo: a stereo head
 *
 * Returns: (array fixed-size=3) (transfer none): the world's origin in the camera's frame, m
 *
 * Since: 0.1
 */
const gdouble *
gst_cloth_stereo_get_translation (const GstClothStereo * stereo)
{
  return stereo->translation;
}

static void
disparity_clear (GstClothPayload * payload)
{
  gst_cloth_stereo_unref (((GstClothDisparity *) payload)->stereo);
}

static guint8 *
get_states (const GstClothDisparity * disparity)
{
  return (guint8 *) (disparity->disparities + count_pixels (disparity->stereo));
}

/**
 * gst_cloth_disparity_new:
 * @camera: (nullable): name of the camera in the rig, UTF-8 of at most
 *   #GST_CLOTH_MAX_CAMERA_NAME bytes; %NULL or "" when it isn't known
 * @sequence: number of the frame, counted by the camera
 * @stereo: the stereo head, which also says how large the picture is; the disparities keep a
 *   reference of their own
 * @sigma: standard deviation of a measured disparity, px, 0 or more; NaN when it isn't known
 * @disparities: (array length=n_disparities): of each pixel of the picture as filmed, row by
 *   row, px; NaN where there is none; copied
 * @n_disparities: the pixels
 * @states: (array length=n_states): a #GstClothDisparityState of each; copied
 * @n_states: the pixels
 *
 * The disparities of one picture. A pixel that is measured or filled has a disparity: where it
 * isn't finite and over 0, the copy's state is that of a hole. Other pixels have none: the
 * copy's is NaN. An unknown state counts as outside.
 *
 * Returns: (transfer full): new disparities, immutable
 *
 * Since: 0.1
 */
GstClothDisparity *
gst_cloth_disparity_new (const gchar * camera, guint64 sequence,
    GstClothStereo * stereo, gfloat sigma, const gfloat * disparities,
    guint n_disparities, const guint8 * states, guint n_states)
{
  GstClothDisparity *disparity;
  guint8 *to;

  g_return_val_if_fail (gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (stereo != NULL, NULL);
  g_return_val_if_fail (isnan (sigma) || (isfinite (sigma) && sigma >= 0),
      NULL);
  g_return_val_if_fail (disparities != NULL
      && n_disparities == count_pixels (stereo), NULL);
  g_return_val_if_fail (states != NULL && n_states == n_disparities, NULL);

  disparity = gst_cloth_payload_new (sizeof *disparity
      + n_disparities * (sizeof *disparities + sizeof *states), camera,
      sequence, gst_cloth_payload_keep_size);
  disparity->payload.clear = disparity_clear;
  disparity->stereo = gst_cloth_stereo_ref (stereo);
  disparity->sigma = sigma;
  to = get_states (disparity);
  for (guint i = 0; i < n_disparities; i++) {
    const gboolean has = states[i] == GST_CLOTH_DISPARITY_MEASURED
        || states[i] == GST_CLOTH_DISPARITY_FILLED;
    const gboolean valid = has && isfinite (disparities[i])
        && disparities[i] > 0;

    disparity->disparities[i] = valid ? disparities[i] : NAN;
    to[i] = valid ? states[i] : has || states[i] == GST_CLOTH_DISPARITY_HOLE ?
        GST_CLOTH_DISPARITY_HOLE : GST_CLOTH_DISPARITY_OUTSIDE;
  }
  return disparity;
}

/**
 * gst_cloth_disparity_ref:
 * @disparity: disparities
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothDisparity *
gst_cloth_disparity_ref (GstClothDisparity * disparity)
{
  return g_atomic_rc_box_acquire (disparity);
}

/**
 * gst_cloth_disparity_unref:
 * @disparity: (transfer full): disparities
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_disparity_unref (GstClothDisparity * disparity)
{
  gst_cloth_payload_release (disparity);
}

/**
 * gst_cloth_disparity_get_camera:
 * @disparity: disparities
 *
 * Returns: (transfer none): name of the camera, "" when it isn't known
 *
 * Since: 0.1
 */
const gchar *
gst_cloth_disparity_get_camera (const GstClothDisparity * disparity)
{
  return disparity->payload.camera;
}

/**
 * gst_cloth_disparity_get_sequence:
 * @disparity: disparities
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.1
 */
guint64
gst_cloth_disparity_get_sequence (const GstClothDisparity * disparity)
{
  return disparity->payload.sequence;
}

/**
 * gst_cloth_disparity_get_width:
 * @disparity: disparities
 *
 * Returns: columns of the picture as filmed; the one that carries the disparities may have
 *   been scaled since
 *
 * Since: 0.1
 */
guint
gst_cloth_disparity_get_width (const GstClothDisparity * disparity)
{
  return disparity->stereo->width;
}

/**
 * gst_cloth_disparity_get_height:
 * @disparity: disparities
 *
 * Returns: rows of the picture as filmed
 *
 * Since: 0.1
 */
guint
gst_cloth_disparity_get_height (const GstClothDisparity * disparity)
{
  return disparity->stereo->height;
}

/**
 * gst_cloth_disparity_get_stereo:
 * @disparity: disparities
 *
 * Returns: (transfer none): the stereo head, the same of all its pictures
 *
 * Since: 0.1
 */
GstClothStereo *
gst_cloth_disparity_get_stereo (const GstClothDisparity * disparity)
{
  return disparity->stereo;
}

/**
 * gst_cloth_disparity_get_sigma:
 * @disparity: disparities
 *
 * Returns: standard deviation of a measured disparity, px; NaN when it isn't known
 *
 * Since: 0.1
 */
gfloat
gst_cloth_disparity_get_sigma (const GstClothDisparity * disparity)
{
  return disparity->sigma;
}

/**
 * gst_cloth_disparity_get_disparities:
 * @disparity: disparities
 * @n_disparities: (out) (optional): the pixels
 *
 * Returns: (array length=n_disparities) (transfer none): the disparity of each pixel, row by
 *   row, px; NaN where there is none; valid as long as @disparity is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_disparity_get_disparities (const GstClothDisparity * disparity,
    guint * n_disparities)
{
  if (n_disparities)
    *n_disparities = count_pixels (disparity->stereo);
  return disparity->disparities;
}

/**
 * gst_cloth_disparity_get_states:
 * @disparity: disparities
 * @n_states: (out) (optional): the pixels
 *
 * Returns: (array length=n_states) (transfer none): a #GstClothDisparityState of each pixel,
 *   row by row; valid as long as @disparity is
 *
 * Since: 0.1
 */
const guint8 *
gst_cloth_disparity_get_states (const GstClothDisparity * disparity,
    guint * n_states)
{
  if (n_states)
    *n_states = count_pixels (disparity->stereo);
  return get_states (disparity);
}

/**
 * gst_cloth_disparity_get_points: (skip)
 * @disparity: disparities
 * @points: (out caller-allocates): three floats a pixel
 *
 * Where the cloth under each pixel is: x, y and z in the camera's frame, m, row by row. With
 * the pixel's ray r = (x/z, y/z, 1) it is at s·r, and s = focal_baseline / (disparity ·
 * (normal · r)). NaN where there is no disparity, or where that isn't in front of the camera.
 *
 * Since: 0.1
 */
void
gst_cloth_disparity_get_points (const GstClothDisparity * disparity,
    gfloat * points)
{
  const GstClothStereo *stereo = disparity->stereo;
  const guint n = count_pixels (stereo);

  for (guint i = 0; i < n; i++) {
    const gdouble x = stereo->rays[2 * (gsize) i];
    const gdouble y = stereo->rays[2 * (gsize) i + 1];
    const gdouble s = stereo->focal_baseline / (disparity->disparities[i]
        * (stereo->normal[0] * x + stereo->normal[1] * y + stereo->normal[2]));
    const gboolean valid = isfinite (s) && s > 0;
    gfloat *point = points + 3 * (gsize) i;

    point[0] = valid ? (gfloat) (s * x) : NAN;
    point[1] = valid ? (gfloat) (s * y) : NAN;
    point[2] = valid ? (gfloat) s : NAN;
  }
}

/**
 * gst_cloth_disparity_dup_points: (rename-to gst_cloth_disparity_get_points)
 * @disparity: disparities
 *
 * gst_cloth_disparity_get_points() for languages that have no arrays to write into: 32 bit
 * floats of the host, shape (height, width, 3).
 *
 * Returns: (transfer full): new bytes
 *
 * Since: 0.1
 */
GBytes *
gst_cloth_disparity_dup_points (GstClothDisparity * disparity)
{
  const gsize n = 3 * (gsize) count_pixels (disparity->stereo);
  gfloat *points = g_new (gfloat, n);

  gst_cloth_disparity_get_points (disparity, points);
  return g_bytes_new_take (points, n * sizeof *points);
}

/**
 * gst_cloth_disparity_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_disparity_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothDisparityMetaAPI",
      TRUE);
}

/**
 * gst_cloth_disparity_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_disparity_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_disparity_meta_api_get_type (), "GstClothDisparityMeta");
}

/**
 * gst_buffer_add_cloth_disparity_meta:
 * @buffer: a writable buffer
 * @disparity: (transfer full): of its picture
 *
 * Puts @disparity on @buffer, in place of the one it may have had.
 *
 * Returns: (transfer none): the meta that now holds @disparity
 *
 * Since: 0.1
 */
GstClothDisparityMeta *
gst_buffer_add_cloth_disparity_meta (GstBuffer * buffer,
    GstClothDisparity * disparity)
{
  return gst_cloth_payload_attach (disparity, buffer,
      gst_cloth_disparity_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_disparity:
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the disparities on @buffer, owned by it; %NULL when it
 *   has none
 *
 * Since: 0.1
 */
GstClothDisparity *
gst_buffer_get_cloth_disparity (GstBuffer * buffer)
{
  return gst_cloth_payload_find (buffer,
      gst_cloth_disparity_meta_api_get_type ());
}
