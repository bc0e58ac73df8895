/* Shared inside libgstcloth-1.0: what the payloads of buffer metadata have in common.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cloth/gstclothprivate.h"

G_BEGIN_DECLS

typedef struct _GstClothPayload GstClothPayload;

/* Changes a copy that nobody else holds yet to what it is in a picture of @scale_x times
 * the width and @scale_y times the height. */
typedef void (*GstClothPayloadScale) (GstClothPayload * payload,
    gdouble scale_x, gdouble scale_y);

/* Gives back what a payload shares with others, before its memory goes. */
typedef void (*GstClothPayloadClear) (GstClothPayload * payload);

/* What every payload begins with. A payload is one allocation of GLib's atomically counted
 * boxes; its items follow its struct. It never changes once it has been handed out. */
struct _GstClothPayload
{
  guint64 sequence;
  GstClothPayloadScale scale;   /* NULL: not of a picture, so it has no scale */
  GstClothPayloadClear clear;   /* NULL: it shares nothing; else it must keep its size */
  gboolean per_camera;          /* a buffer has one of each camera, not one in all */
  gchar camera[GST_CLOTH_MAX_CAMERA_NAME + 1];
};

/* Every meta that holds a payload is one of these under a name of its own. */
typedef struct
{
  GstMeta meta;
  GstClothPayload *payload;
} GstClothPayloadMeta;

/* @camera: (nullable): UTF-8 of at most #GST_CLOTH_MAX_CAMERA_NAME bytes */
static inline gboolean
gst_cloth_camera_is_valid (const gchar * camera)
{
  return camera == NULL || (strlen (camera) <= GST_CLOTH_MAX_CAMERA_NAME
      && g_utf8_validate (camera, -1, NULL));
}

gpointer gst_cloth_payload_new (gsize size, const gchar * camera,
    guint64 sequence, GstClothPayloadScale scale);
void gst_cloth_payload_release (gpointer payload);
void gst_cloth_payload_keep_size (GstClothPayload * payload, gdouble scale_x,
    gdouble scale_y);
gpointer gst_cloth_payload_scale (const GstClothPayload * payload,
    gdouble scale_x, gdouble scale_y);

GType gst_cloth_payload_register_api (GType * type, const gchar * name,
    gboolean of_picture);
const GstMetaInfo *gst_cloth_payload_register_meta (const GstMetaInfo ** info,
    GType api, const gchar * name);
gpointer gst_cloth_payload_attach (gpointer payload, GstBuffer * buffer,
    const GstMetaInfo * info);
gpointer gst_cloth_payload_find (GstBuffer * buffer, GType api);
gpointer gst_cloth_payload_find_of_camera (GstBuffer * buffer, GType api,
    const gchar * camera);
gpointer gst_cloth_payload_find_nth (GstBuffer * buffer, GType api,
    guint index);

/* Places keep to pixel centres, so the picture's edge stays its edge. */
static inline void
gst_cloth_scale_place (gfloat * x, gfloat * y, gdouble scale_x, gdouble scale_y)
{
  *x = (gfloat) ((*x + 0.5) * scale_x - 0.5);
  *y = (gfloat) ((*y + 0.5) * scale_y - 0.5);
}

static inline void
gst_cloth_scale_covariance (gfloat * xx, gfloat * xy, gfloat * yy,
    gdouble scale_x, gdouble scale_y)
{
  *xx = (gfloat) (*xx * scale_x * scale_x);
  *xy = (gfloat) (*xy * scale_x * scale_y);
  *yy = (gfloat) (*yy * scale_y * scale_y);
}

G_END_DECLS
