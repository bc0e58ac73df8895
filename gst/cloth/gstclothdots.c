/* Coloured dots of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cloth/gstclothdots.h"
#include "gst/cloth/gstclothpayload.h"

struct _GstClothDots
{
  GstClothPayload payload;
  guint columns, rows;
  guint n_colours;
  guint n_dots;
  GstClothDot dots[];
};

G_STATIC_ASSERT (sizeof (GstClothDotsMeta) == sizeof (GstClothPayloadMeta));

G_DEFINE_BOXED_TYPE (GstClothDot, gst_cloth_dot, gst_cloth_dot_copy,
    gst_cloth_dot_free);
G_DEFINE_BOXED_TYPE (GstClothDots, gst_cloth_dots, gst_cloth_dots_ref,
    gst_cloth_dots_unref);

/**
 * gst_cloth_dot_copy:
 * @dot: a dot
 *
 * Returns: (transfer full): a copy
 *
 * Since: 0.1
 */
GstClothDot *
gst_cloth_dot_copy (const GstClothDot * dot)
{
  return g_memdup2 (dot, sizeof *dot);
}

/**
 * gst_cloth_dot_free:
 * @dot: (transfer full): a dot
 *
 * Frees a copy.
 *
 * Since: 0.1
 */
void
gst_cloth_dot_free (GstClothDot * dot)
{
  g_free (dot);
}

/**
 * gst_cloth_dot_get_log_likelihood:
 * @dot: a dot
 * @colour: which colour of the pattern
 * @log_likelihood: (out): how likely its colour is under it, natural logarithm
 *
 * For languages that can't read arrays inside a struct.
 *
 * Returns: %FALSE when @colour is not below #GST_CLOTH_DOT_MAX_COLOURS
 *
 * Since: 0.1
 */
gboolean
gst_cloth_dot_get_log_likelihood (const GstClothDot * dot, guint colour,
    gfloat * log_likelihood)
{
  if (colour >= GST_CLOTH_DOT_MAX_COLOURS)
    return FALSE;
  *log_likelihood = dot->log_likelihood[colour];
  return TRUE;
}

/**
 * gst_cloth_dot_set_log_likelihood:
 * @dot: a dot
 * @colour: which colour of the pattern
 * @log_likelihood: how likely its colour is under it, natural logarithm
 *
 * For languages that can't write arrays inside a struct.
 *
 * Returns: %FALSE when @colour is not below #GST_CLOTH_DOT_MAX_COLOURS
 *
 * Since: 0.1
 */
gboolean
gst_cloth_dot_set_log_likelihood (GstClothDot * dot, guint colour,
    gfloat log_likelihood)
{
  if (colour >= GST_CLOTH_DOT_MAX_COLOURS)
    return FALSE;
  dot->log_likelihood[colour] = log_likelihood;
  return TRUE;
}

static void
dots_scale (GstClothPayload * payload, gdouble scale_x, gdouble scale_y)
{
  GstClothDots *dots = (GstClothDots *) payload;

  for (guint i = 0; i < dots->n_dots; i++) {
    GstClothDot *d = &dots->dots[i];

    gst_cloth_scale_place (&d->x, &d->y, scale_x, scale_y);
    gst_cloth_scale_covariance (&d->cov_xx, &d->cov_xy, &d->cov_yy, scale_x,
        scale_y);
  }
}

/**
 * gst_cloth_dots_new:
 * @camera: (nullable): name of the camera in the rig, UTF-8 of at most
 *   #GST_CLOTH_MAX_CAMERA_NAME bytes; %NULL or "" when it isn't known
 * @sequence: number of the frame, counted by the camera
 * @columns: dots in a row of the whole pattern
 * @rows: dots in a column of the whole pattern
 * @n_colours: colours of the pattern, at most #GST_CLOTH_DOT_MAX_COLOURS
 * @dots: (array length=n_dots) (nullable): the dots, copied
 * @n_dots: how many, at most #GST_CLOTH_MAX_FEATURES
 *
 * The dots that one picture shows. Immutable; none seen is a valid payload and says so.
 *
 * Returns: (transfer full): new dots
 *
 * Since: 0.1
 */
GstClothDots *
gst_cloth_dots_new (const gchar * camera, guint64 sequence, guint columns,
    guint rows, guint n_colours, const GstClothDot * dots, guint n_dots)
{
  GstClothDots *payload;

  g_return_val_if_fail (gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (dots || !n_dots, NULL);
  g_return_val_if_fail (n_dots <= GST_CLOTH_MAX_FEATURES, NULL);
  g_return_val_if_fail (columns <= GST_CLOTH_MAX_FEATURES
      && rows <= GST_CLOTH_MAX_FEATURES, NULL);
  g_return_val_if_fail (n_colours <= GST_CLOTH_DOT_MAX_COLOURS, NULL);

  payload = gst_cloth_payload_new (sizeof *payload + n_dots * sizeof *dots,
      camera, sequence, dots_scale);
  if (!payload)
    return NULL;
  payload->columns = columns;
  payload->rows = rows;
  payload->n_colours = n_colours;
  payload->n_dots = n_dots;
  if (n_dots)
    memcpy (payload->dots, dots, n_dots * sizeof *dots);
  return payload;
}

/**
 * gst_cloth_dots_ref:
 * @dots: dots
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothDots *
gst_cloth_dots_ref (GstClothDots * dots)
{
  return g_atomic_rc_box_acquire (dots);
}

/**
 * gst_cloth_dots_unref:
 * @dots: (transfer full): dots
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_dots_unref (GstClothDots * dots)
{
  gst_cloth_payload_release (dots);
}

/**
 * gst_cloth_dots_get_camera:
 * @dots: dots
 *
 * Returns: (transfer none): name of the camera, "" when it isn't known
 *
 * Since: 0.1
 */
const gchar *
gst_cloth_dots_get_camera (const GstClothDots * dots)
{
  return dots->payload.camera;
}

/**
 * gst_cloth_dots_get_sequence:
 * @dots: dots
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.1
 */
guint64
gst_cloth_dots_get_sequence (const GstClothDots * dots)
{
  return dots->payload.sequence;
}

/**
 * gst_cloth_dots_get_columns:
 * @dots: dots
 *
 * Returns: dots in a row of the whole pattern
 *
 * Since: 0.1
 */
guint
gst_cloth_dots_get_columns (const GstClothDots * dots)
{
  return dots->columns;
}

/**
 * gst_cloth_dots_get_rows:
 * @dots: dots
 *
 * Returns: dots in a column of the whole pattern
 *
 * Since: 0.1
 */
guint
gst_cloth_dots_get_rows (const GstClothDots * dots)
{
  return dots->rows;
}

/**
 * gst_cloth_dots_get_n_colours:
 * @dots: dots
 *
 * Returns: colours of the pattern: how many log-likelihoods of a dot count
 *
 * Since: 0.1
 */
guint
gst_cloth_dots_get_n_colours (const GstClothDots * dots)
{
  return dots->n_colours;
}

/**
 * gst_cloth_dots_get_n_dots:
 * @dots: dots
 *
 * Returns: how many dots there are
 *
 * Since: 0.1
 */
guint
gst_cloth_dots_get_n_dots (const GstClothDots * dots)
{
  return dots->n_dots;
}

/**
 * gst_cloth_dots_get_dots:
 * @dots: dots
 * @n_dots: (out) (optional): how many
 *
 * Returns: (array length=n_dots) (transfer none): the dots, valid as long as @dots
 *   is
 *
 * Since: 0.1
 */
const GstClothDot *
gst_cloth_dots_get_dots (const GstClothDots * dots, guint * n_dots)
{
  if (n_dots)
    *n_dots = dots->n_dots;
  return dots->dots;
}

/**
 * gst_cloth_dots_get_dot:
 * @dots: dots
 * @index: which
 * @dot: (out caller-allocates): its copy
 *
 * Returns: %FALSE when @index is past the end
 *
 * Since: 0.1
 */
gboolean
gst_cloth_dots_get_dot (const GstClothDots * dots, guint index,
    GstClothDot * dot)
{
  if (index >= dots->n_dots)
    return FALSE;
  *dot = dots->dots[index];
  return TRUE;
}

/**
 * gst_cloth_dots_get_points:
 * @dots: dots
 *
 * What is measured of each dot as an array of 32 bit floats of the host, shape
 * (n_dots, 8): column, row (−1 without a label), x, y, cov_xx, cov_xy, cov_yy,
 * confidence.
 *
 * Returns: (transfer full): new bytes
 *
 * Since: 0.1
 */
GBytes *
gst_cloth_dots_get_points (GstClothDots * dots)
{
  gfloat *points = g_new (gfloat, 8 * dots->n_dots);
  gfloat *p = points;

  for (guint i = 0; i < dots->n_dots; i++) {
    const GstClothDot *d = &dots->dots[i];

    *p++ = (gfloat) d->column;
    *p++ = (gfloat) d->row;
    *p++ = d->x;
    *p++ = d->y;
    *p++ = d->cov_xx;
    *p++ = d->cov_xy;
    *p++ = d->cov_yy;
    *p++ = d->confidence;
  }
  return g_bytes_new_take (points, 8 * dots->n_dots * sizeof (gfloat));
}

/**
 * gst_cloth_dots_scale:
 * @dots: dots
 * @scale_x: new width over old width, over 0
 * @scale_y: new height over old height, over 0
 *
 * The dots of the same picture at another size: x' = (x + ½)·@scale_x − ½, the
 * covariances in the new pixels.
 *
 * Returns: (transfer full): new dots
 *
 * Since: 0.1
 */
GstClothDots *
gst_cloth_dots_scale (const GstClothDots * dots, gdouble scale_x,
    gdouble scale_y)
{
  return gst_cloth_payload_scale ((const GstClothPayload *) dots, scale_x,
      scale_y);
}

/**
 * gst_cloth_dots_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_dots_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothDotsMetaAPI", TRUE);
}

/**
 * gst_cloth_dots_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_dots_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_dots_meta_api_get_type (), "GstClothDotsMeta");
}

/**
 * gst_buffer_add_cloth_dots_meta:
 * @buffer: a writable buffer
 * @dots: (transfer full): what was seen in its picture
 *
 * Puts @dots on @buffer, in place of those it may have had.
 *
 * Returns: (transfer none): the meta that now holds @dots
 *
 * Since: 0.1
 */
GstClothDotsMeta *
gst_buffer_add_cloth_dots_meta (GstBuffer * buffer, GstClothDots * dots)
{
  return gst_cloth_payload_attach (dots, buffer,
      gst_cloth_dots_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_dots:
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the dots on @buffer, owned by it; %NULL when it
 *   has none
 *
 * Since: 0.1
 */
GstClothDots *
gst_buffer_get_cloth_dots (GstBuffer * buffer)
{
  return gst_cloth_payload_find (buffer, gst_cloth_dots_meta_api_get_type ());
}
