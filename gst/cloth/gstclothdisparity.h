/* The disparities of the cloth in one picture of a stereo head, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GST_CLOTH_MAX_DISPARITY_SIZE:
 *
 * Largest width and height of a map of disparities, px.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_DISPARITY_SIZE 16384

/**
 * GST_CLOTH_MAX_DISPARITY_AREA:
 *
 * Most pixels of a map of disparities.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_DISPARITY_AREA (4096 * 4096)

/**
 * GstClothDisparity:
 *
 * Of each pixel of a stereo head's picture its disparity, and how it came to it. Counted by
 * reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothDisparity GstClothDisparity;

/**
 * GstClothStereo:
 *
 * What turns the disparities of a stereo head into points: its cameras' places and rays. All
 * pictures of a head share one. Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothStereo GstClothStereo;
typedef struct _GstClothDisparityMeta GstClothDisparityMeta;

/**
 * GstClothDisparityState:
 * @GST_CLOTH_DISPARITY_OUTSIDE: no cloth
 * @GST_CLOTH_DISPARITY_HOLE: cloth whose disparity isn't known
 * @GST_CLOTH_DISPARITY_MEASURED: with a measured disparity
 * @GST_CLOTH_DISPARITY_FILLED: with one that follows from those around
 *
 * What is known of a pixel.
 *
 * Since: 0.1
 */
typedef enum {
  GST_CLOTH_DISPARITY_OUTSIDE,
  GST_CLOTH_DISPARITY_HOLE,
  GST_CLOTH_DISPARITY_MEASURED,
  GST_CLOTH_DISPARITY_FILLED
} GstClothDisparityState;

/**
 * GstClothDisparityMeta:
 * @meta: parent
 * @disparity: the payload, owned by the meta
 *
 * Puts disparities on a picture. Tagged video, orientation and size: it is copied by
 * reference. Disparities have a size of their own, so that they stay as they are when the
 * picture is scaled; any other transformation drops them.
 *
 * Since: 0.1
 */
struct _GstClothDisparityMeta {
  GstMeta meta;
  GstClothDisparity *disparity;
};

#define GST_TYPE_CLOTH_DISPARITY (gst_cloth_disparity_get_type ())
#define GST_TYPE_CLOTH_STEREO (gst_cloth_stereo_get_type ())

GST_CLOTH_API GType gst_cloth_stereo_get_type (void);
GST_CLOTH_API GstClothStereo *gst_cloth_stereo_new (guint width, guint height,
    const gfloat * rays, guint n_rays, const gdouble normal[3],
    gdouble focal_baseline, const gdouble rotation[9], const gdouble translation[3],
    guint n_cameras);
GST_CLOTH_API GstClothStereo *gst_cloth_stereo_ref (GstClothStereo * stereo);
GST_CLOTH_API void gst_cloth_stereo_unref (GstClothStereo * stereo);
GST_CLOTH_API guint gst_cloth_stereo_get_width (const GstClothStereo * stereo);
GST_CLOTH_API guint gst_cloth_stereo_get_height (const GstClothStereo * stereo);
GST_CLOTH_API guint gst_cloth_stereo_get_n_cameras (const GstClothStereo * stereo);
GST_CLOTH_API const gfloat *gst_cloth_stereo_get_rays (const GstClothStereo * stereo, guint * n_rays);
GST_CLOTH_API const gdouble *gst_cloth_stereo_get_normal (const GstClothStereo * stereo);
GST_CLOTH_API gdouble gst_cloth_stereo_get_focal_baseline (const GstClothStereo * stereo);
GST_CLOTH_API const gdouble *gst_cloth_stereo_get_rotation (const GstClothStereo * stereo);
GST_CLOTH_API const gdouble *gst_cloth_stereo_get_translation (const GstClothStereo * stereo);

GST_CLOTH_API GType gst_cloth_disparity_get_type (void);
GST_CLOTH_API GstClothDisparity *gst_cloth_disparity_new (const gchar * camera,
    guint64 sequence, GstClothStereo * stereo, gfloat sigma, const gfloat * disparities,
    guint n_disparities, const guint8 * states, guint n_states);
GST_CLOTH_API GstClothDisparity *gst_cloth_disparity_ref (GstClothDisparity * disparity);
GST_CLOTH_API void gst_cloth_disparity_unref (GstClothDisparity * disparity);
GST_CLOTH_API const gchar *gst_cloth_disparity_get_camera (const GstClothDisparity * disparity);
GST_CLOTH_API guint64 gst_cloth_disparity_get_sequence (const GstClothDisparity * disparity);
GST_CLOTH_API guint gst_cloth_disparity_get_width (const GstClothDisparity * disparity);
GST_CLOTH_API guint gst_cloth_disparity_get_height (const GstClothDisparity * disparity);
GST_CLOTH_API GstClothStereo *gst_cloth_disparity_get_stereo (const GstClothDisparity * disparity);
GST_CLOTH_API gfloat gst_cloth_disparity_get_sigma (const GstClothDisparity * disparity);
GST_CLOTH_API const gfloat *gst_cloth_disparity_get_disparities (const GstClothDisparity * disparity, guint * n_disparities);
GST_CLOTH_API const guint8 *gst_cloth_disparity_get_states (const GstClothDisparity * disparity, guint * n_states);
GST_CLOTH_API void gst_cloth_disparity_get_points (const GstClothDisparity * disparity, gfloat * points);
GST_CLOTH_API GBytes *gst_cloth_disparity_dup_points (GstClothDisparity * disparity);

GST_CLOTH_API GType gst_cloth_disparity_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_disparity_meta_get_info (void);
GST_CLOTH_API GstClothDisparityMeta *gst_buffer_add_cloth_disparity_meta (GstBuffer * buffer, GstClothDisparity * disparity);
GST_CLOTH_API GstClothDisparity *gst_buffer_get_cloth_disparity (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothStereo, gst_cloth_stereo_unref)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothDisparity, gst_cloth_disparity_unref)
G_END_DECLS
