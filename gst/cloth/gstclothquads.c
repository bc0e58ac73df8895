/* Tracked squares of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cloth/gstclothquads.h"
#include "gst/cloth/gstclothpayload.h"

struct _GstClothQuads
{
  GstClothPayload payload;
  guint columns, rows;
  guint n_quads;
  GstClothQuad quads[];
};

G_STATIC_ASSERT (sizeof (GstClothQuadsMeta) == sizeof (GstClothPayloadMeta));

G_DEFINE_BOXED_TYPE (GstClothQuad, gst_cloth_quad, gst_cloth_quad_copy,
    gst_cloth_quad_free);
G_DEFINE_BOXED_TYPE (GstClothQuads, gst_cloth_quads, gst_cloth_quads_ref,
    gst_cloth_quads_unref);

/**
 * gst_cloth_quad_copy:
 * @quad: a quad
 *
 * Returns: (transfer full): a copy
 *
 * Since: 0.1
 */
GstClothQuad *
gst_cloth_quad_copy (const GstClothQuad * quad)
{
  return g_memdup2 (quad, sizeof *quad);
}

/**
 * gst_cloth_quad_free:
 * @quad: (transfer full): a quad
 *
 * Frees a copy.
 *
 * Since: 0.1
 */
void
gst_cloth_quad_free (GstClothQuad * quad)
{
  g_free (quad);
}

/**
 * gst_cloth_quad_get_corner:
 * @quad: a quad
 * @corner: 0..3: top-left, top-right, bottom-right, bottom-left on the flat cloth
 * @x: (out) (optional): column, px
 * @y: (out) (optional): row, px
 * @cov_xx: (out) (optional): variance of @x, px²
 * @cov_xy: (out) (optional): covariance of @x and @y, px²
 * @cov_yy: (out) (optional): variance of @y, px²
 *
 * For languages that can't read arrays inside a struct.
 *
 * Returns: %FALSE when there is no such corner
 *
 * Since: 0.1
 */
gboolean
gst_cloth_quad_get_corner (const GstClothQuad * quad, guint corner, gfloat * x,
    gfloat * y, gfloat * cov_xx, gfloat * cov_xy, gfloat * cov_yy)
{
  if (corner > 3)
    return FALSE;
  if (x)
    *x = quad->x[corner];
  if (y)
    *y = quad->y[corner];
  if (cov_xx)
    *cov_xx = quad->cov_xx[corner];
  if (cov_xy)
    *cov_xy = quad->cov_xy[corner];
  if (cov_yy)
    *cov_yy = quad->cov_yy[corner];
  return TRUE;
}

/**
 * gst_cloth_quad_set_corner:
 * @quad: a quad
 * @corner: 0..3: top-left, top-right, bottom-right, bottom-left on the flat cloth
 * @x: column, px
 * @y: row, px
 * @cov_xx: variance of @x, px²
 * @cov_xy: covariance of @x and @y, px²
 * @cov_yy: variance of @y, px²
 *
 * For languages that can't write arrays inside a struct.
 *
 * Returns: %FALSE when there is no such corner
 *
 * Since: 0.1
 */
gboolean
gst_cloth_quad_set_corner (GstClothQuad * quad, guint corner, gfloat x,
    gfloat y, gfloat cov_xx, gfloat cov_xy, gfloat cov_yy)
{
  if (corner > 3)
    return FALSE;
  quad->x[corner] = x;
  quad->y[corner] = y;
  quad->cov_xx[corner] = cov_xx;
  quad->cov_xy[corner] = cov_xy;
  quad->cov_yy[corner] = cov_yy;
  return TRUE;
}

static void
quads_scale (GstClothPayload * payload, gdouble scale_x, gdouble scale_y)
{
  GstClothQuads *quads = (GstClothQuads *) payload;

  for (guint i = 0; i < quads->n_quads; i++) {
    GstClothQuad *q = &quads->quads[i];

    for (guint c = 0; c < 4; c++) {
      gst_cloth_scale_place (&q->x[c], &q->y[c], scale_x, scale_y);
      gst_cloth_scale_covariance (&q->cov_xx[c], &q->cov_xy[c], &q->cov_yy[c],
          scale_x, scale_y);
    }
  }
}

/**
 * gst_cloth_quads_new:
 * @camera: (nullable): name of the camera in the rig, UTF-8 of at most
 *   #GST_CLOTH_MAX_CAMERA_NAME bytes; %NULL or "" when it isn't known
 * @sequence: number of the frame, counted by the camera
 * @columns: squares in a row of the whole board
 * @rows: squares in a column of the whole board
 * @quads: (array length=n_quads) (nullable): the quads, copied
 * @n_quads: how many, at most #GST_CLOTH_MAX_FEATURES
 *
 * The squares of a board that one picture shows. Immutable; none seen is a valid
 * payload and says so.
 *
 * Returns: (transfer full): new quads
 *
 * Since: 0.1
 */
GstClothQuads *
gst_cloth_quads_new (const gchar * camera, guint64 sequence, guint columns,
    guint rows, const GstClothQuad * quads, guint n_quads)
{
  GstClothQuads *payload;

  g_return_val_if_fail (gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (quads || !n_quads, NULL);
  g_return_val_if_fail (n_quads <= GST_CLOTH_MAX_FEATURES, NULL);
  g_return_val_if_fail (columns <= GST_CLOTH_MAX_FEATURES
      && rows <= GST_CLOTH_MAX_FEATURES, NULL);

  payload = gst_cloth_payload_new (sizeof *payload + n_quads * sizeof *quads,
      camera, sequence, quads_scale);
  if (!payload)
    return NULL;
  payload->columns = columns;
  payload->rows = rows;
  payload->n_quads = n_quads;
  if (n_quads)
    memcpy (payload->quads, quads, n_quads * sizeof *quads);
  return payload;
}

/**
 * gst_cloth_quads_ref:
 * @quads: quads
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothQuads *
gst_cloth_quads_ref (GstClothQuads * quads)
{
  return g_atomic_rc_box_acquire (quads);
}

/**
 * gst_cloth_quads_unref:
 * @quads: (transfer full): quads
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_quads_unref (GstClothQuads * quads)
{
  gst_cloth_payload_release (quads);
}

/**
 * gst_cloth_quads_get_camera:
 * @quads: quads
 *
 * Returns: (transfer none): name of the camera, "" when it isn't known
 *
 * Since: 0.1
 */
const gchar *
gst_cloth_quads_get_camera (const GstClothQuads * quads)
{
  return quads->payload.camera;
}

/**
 * gst_cloth_quads_get_sequence:
 * @quads: quads
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.1
 */
guint64
gst_cloth_quads_get_sequence (const GstClothQuads * quads)
{
  return quads->payload.sequence;
}

/**
 * gst_cloth_quads_get_columns:
 * @quads: quads
 *
 * Returns: squares in a row of the whole board
 *
 * Since: 0.1
 */
guint
gst_cloth_quads_get_columns (const GstClothQuads * quads)
{
  return quads->columns;
}

/**
 * gst_cloth_quads_get_rows:
 * @quads: quads
 *
 * Returns: squares in a column of the whole board
 *
 * Since: 0.1
 */
guint
gst_cloth_quads_get_rows (const GstClothQuads * quads)
{
  return quads->rows;
}

/**
 * gst_cloth_quads_get_n_quads:
 * @quads: quads
 *
 * Returns: how many quads there are
 *
 * Since: 0.1
 */
guint
gst_cloth_quads_get_n_quads (const GstClothQuads * quads)
{
  return quads->n_quads;
}

/**
 * gst_cloth_quads_get_quads:
 * @quads: quads
 * @n_quads: (out) (optional): how many
 *
 * Returns: (array length=n_quads) (transfer none): the quads, valid as long as @quads
 *   is
 *
 * Since: 0.1
 */
const GstClothQuad *
gst_cloth_quads_get_quads (const GstClothQuads * quads, guint * n_quads)
{
  if (n_quads)
    *n_quads = quads->n_quads;
  return quads->quads;
}

/**
 * gst_cloth_quads_get_quad:
 * @quads: quads
 * @index: which
 * @quad: (out caller-allocates): its copy
 *
 * Returns: %FALSE when @index is past the end
 *
 * Since: 0.1
 */
gboolean
gst_cloth_quads_get_quad (const GstClothQuads * quads, guint index,
    GstClothQuad * quad)
{
  if (index >= quads->n_quads)
    return FALSE;
  *quad = quads->quads[index];
  return TRUE;
}

/**
 * gst_cloth_quads_get_points:
 * @quads: quads
 *
 * The corners as an array of 32 bit floats of the host, shape (n_quads, 4, 2): x, y of
 * corners 0..3.
 *
 * Returns: (transfer full): new bytes
 *
 * Since: 0.1
 */
GBytes *
gst_cloth_quads_get_points (GstClothQuads * quads)
{
  gfloat *points = g_new (gfloat, 8 * quads->n_quads);
  gfloat *p = points;

  for (guint i = 0; i < quads->n_quads; i++) {
    for (guint c = 0; c < 4; c++) {
      *p++ = quads->quads[i].x[c];
      *p++ = quads->quads[i].y[c];
    }
  }
  return g_bytes_new_take (points, 8 * quads->n_quads * sizeof (gfloat));
}

/**
 * gst_cloth_quads_scale:
 * @quads: quads
 * @scale_x: new width over old width, over 0
 * @scale_y: new height over old height, over 0
 *
 * The quads of the same picture at another size: x' = (x + ½)·@scale_x − ½, the
 * covariances in the new pixels.
 *
 * Returns: (transfer full): new quads
 *
 * Since: 0.1
 */
GstClothQuads *
gst_cloth_quads_scale (const GstClothQuads * quads, gdouble scale_x,
    gdouble scale_y)
{
  return gst_cloth_payload_scale ((const GstClothPayload *) quads, scale_x,
      scale_y);
}

/**
 * gst_cloth_quads_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_quads_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothQuadsMetaAPI", TRUE);
}

/**
 * gst_cloth_quads_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_quads_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_quads_meta_api_get_type (), "GstClothQuadsMeta");
}

/**
 * gst_buffer_add_cloth_quads_meta:
 * @buffer: a writable buffer
 * @quads: (transfer full): what was seen in its picture
 *
 * Puts @quads on @buffer, in place of those it may have had.
 *
 * Returns: (transfer none): the meta that now holds @quads
 *
 * Since: 0.1
 */
GstClothQuadsMeta *
gst_buffer_add_cloth_quads_meta (GstBuffer * buffer, GstClothQuads * quads)
{
  return gst_cloth_payload_attach (quads, buffer,
      gst_cloth_quads_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_quads:
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the quads on @buffer, owned by it; %NULL when it
 *   has none
 *
 * Since: 0.1
 */
GstClothQuads *
gst_buffer_get_cloth_quads (GstBuffer * buffer)
{
  return gst_cloth_payload_find (buffer, gst_cloth_quads_meta_api_get_type ());
}
