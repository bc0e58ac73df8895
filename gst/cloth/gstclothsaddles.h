/* Saddle points of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

typedef struct _GstClothSaddles GstClothSaddles;
typedef struct _GstClothSaddle GstClothSaddle;
typedef struct _GstClothCandidate GstClothCandidate;
typedef struct _GstClothSaddlesMeta GstClothSaddlesMeta;

/* Layout equals ClothSaddle of gst/vision/saddle.h. */
struct _GstClothSaddle {
  gfloat x, y;
  gfloat response;
  gfloat axis;
  gfloat cov_xx, cov_xy, cov_yy;
};

struct _GstClothCandidate {
  gfloat x, y;
  gfloat response;
};

struct _GstClothSaddlesMeta {
  GstMeta meta;
  GstClothSaddles *saddles;
};

#define GST_TYPE_CLOTH_SADDLES (gst_cloth_saddles_get_type ())

GST_CLOTH_API GType gst_cloth_saddles_get_type (void);
GST_CLOTH_API GstClothSaddles *gst_cloth_saddles_new (const gchar * camera,
    guint64 sequence, const GstClothSaddle * refined, guint n_refined,
    const GstClothCandidate * candidates, guint n_candidates);
GST_CLOTH_API GstClothSaddles *gst_cloth_saddles_ref (GstClothSaddles * saddles);
GST_CLOTH_API void gst_cloth_saddles_unref (GstClothSaddles * saddles);
GST_CLOTH_API const gchar *gst_cloth_saddles_get_camera (const GstClothSaddles * saddles);
GST_CLOTH_API guint64 gst_cloth_saddles_get_sequence (const GstClothSaddles * saddles);
GST_CLOTH_API const GstClothSaddle *gst_cloth_saddles_get_refined (const GstClothSaddles * saddles, guint * n_refined);
GST_CLOTH_API const GstClothCandidate *gst_cloth_saddles_get_candidates (const GstClothSaddles * saddles, guint * n_candidates);

GST_CLOTH_API GType gst_cloth_saddles_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_saddles_meta_get_info (void);
/* takes the reference */
GST_CLOTH_API GstClothSaddlesMeta *gst_buffer_add_cloth_saddles_meta (GstBuffer * buffer, GstClothSaddles * saddles);
/* borrowed; NULL when the buffer has none */
GST_CLOTH_API GstClothSaddles *gst_buffer_get_cloth_saddles (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothSaddles, gst_cloth_saddles_unref)
G_END_DECLS
