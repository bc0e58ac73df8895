/* Saddle points of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GstClothSaddles:
 *
 * The corners of checkerboards in one picture, and the candidates for them. Counted by
 * reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothSaddles GstClothSaddles;
typedef struct _GstClothSaddle GstClothSaddle;
typedef struct _GstClothCandidate GstClothCandidate;
typedef struct _GstClothSaddlesMeta GstClothSaddlesMeta;

/**
 * GstClothSaddle:
 * @x: column, px, centre of the top-left pixel at 0
 * @y: row, px
 * @response: −Det of the Hessian of the smoothed intensity, grey levels² / px⁴
 * @axis: angle in [0, π) of the axis that runs through the two bright quadrants,
 *   radians, from +x towards +y
 * @cov_xx: variance of @x, px²
 * @cov_xy: covariance of @x and @y, px²
 * @cov_yy: variance of @y, px²
 *
 * A saddle of the intensity (the corner of a checkerboard) refined to a fraction of a
 * pixel. The layout equals that of the detector's own struct.
 *
 * Since: 0.1
 */
struct _GstClothSaddle {
  gfloat x, y;
  gfloat response;
  gfloat axis;
  gfloat cov_xx, cov_xy, cov_yy;
};

/**
 * GstClothCandidate:
 * @x: column, px, centre of the top-left pixel at 0
 * @y: row, px
 * @response: −Det of the Hessian of the smoothed intensity, grey levels² / px⁴
 *
 * A pixel where a corner may be put.
 *
 * Since: 0.1
 */
struct _GstClothCandidate {
  gfloat x, y;
  gfloat response;
};

/**
 * GstClothSaddlesMeta:
 * @meta: parent
 * @saddles: the payload, owned by the meta
 *
 * Puts saddles on a picture. Tagged video, orientation and size: it is copied by
 * reference and scaled with the picture; any other transformation drops it.
 *
 * Since: 0.1
 */
struct _GstClothSaddlesMeta {
  GstMeta meta;
  GstClothSaddles *saddles;
};

#define GST_TYPE_CLOTH_SADDLES (gst_cloth_saddles_get_type ())
#define GST_TYPE_CLOTH_SADDLE (gst_cloth_saddle_get_type ())
#define GST_TYPE_CLOTH_CANDIDATE (gst_cloth_candidate_get_type ())

GST_CLOTH_API GType gst_cloth_saddle_get_type (void);
GST_CLOTH_API GstClothSaddle *gst_cloth_saddle_copy (const GstClothSaddle * saddle);
GST_CLOTH_API void gst_cloth_saddle_free (GstClothSaddle * saddle);
GST_CLOTH_API GType gst_cloth_candidate_get_type (void);
GST_CLOTH_API GstClothCandidate *gst_cloth_candidate_copy (const GstClothCandidate * candidate);
GST_CLOTH_API void gst_cloth_candidate_free (GstClothCandidate * candidate);

GST_CLOTH_API GType gst_cloth_saddles_get_type (void);
GST_CLOTH_API GstClothSaddles *gst_cloth_saddles_new (const gchar * camera,
    guint64 sequence, const GstClothSaddle * refined, guint n_refined,
    const GstClothCandidate * candidates, guint n_candidates);
GST_CLOTH_API GstClothSaddles *gst_cloth_saddles_ref (GstClothSaddles * saddles);
GST_CLOTH_API void gst_cloth_saddles_unref (GstClothSaddles * saddles);
GST_CLOTH_API const gchar *gst_cloth_saddles_get_camera (const GstClothSaddles * saddles);
GST_CLOTH_API guint64 gst_cloth_saddles_get_sequence (const GstClothSaddles * saddles);
GST_CLOTH_API guint gst_cloth_saddles_get_n_refined (const GstClothSaddles * saddles);
GST_CLOTH_API guint gst_cloth_saddles_get_n_candidates (const GstClothSaddles * saddles);
GST_CLOTH_API const GstClothSaddle *gst_cloth_saddles_get_refined (const GstClothSaddles * saddles, guint * n_refined);
GST_CLOTH_API const GstClothCandidate *gst_cloth_saddles_get_candidates (const GstClothSaddles * saddles, guint * n_candidates);
GST_CLOTH_API gboolean gst_cloth_saddles_get_saddle (const GstClothSaddles * saddles, guint index, GstClothSaddle * saddle);
GST_CLOTH_API gboolean gst_cloth_saddles_get_candidate (const GstClothSaddles * saddles, guint index, GstClothCandidate * candidate);
GST_CLOTH_API GBytes *gst_cloth_saddles_get_points (GstClothSaddles * saddles);
GST_CLOTH_API GstClothSaddles *gst_cloth_saddles_scale (const GstClothSaddles * saddles, gdouble scale_x, gdouble scale_y);

GST_CLOTH_API GType gst_cloth_saddles_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_saddles_meta_get_info (void);
GST_CLOTH_API GstClothSaddlesMeta *gst_buffer_add_cloth_saddles_meta (GstBuffer * buffer, GstClothSaddles * saddles);
GST_CLOTH_API GstClothSaddles *gst_buffer_get_cloth_saddles (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothSaddles, gst_cloth_saddles_unref)
G_END_DECLS
