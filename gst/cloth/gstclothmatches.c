/* Places of a print that a picture shows, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothmatches.h"
#include "gst/cloth/gstclothpayload.h"

/* The points follow the matches: both are of 32-bit numbers. */
struct _GstClothMatches
{
  GstClothPayload payload;
  guint columns, rows;
  guint n_features;
  gboolean on_surface;
  guint n_matches, n_points;
  GstClothMatch matches[];
};

G_STATIC_ASSERT (sizeof (GstClothMatchesMeta) == sizeof (GstClothPayloadMeta));
G_STATIC_ASSERT (G_ALIGNOF (GstClothMatch) == G_ALIGNOF (GstClothGridPoint));

G_DEFINE_BOXED_TYPE (GstClothMatch, gst_cloth_match, gst_cloth_match_copy,
    gst_cloth_match_free);
G_DEFINE_BOXED_TYPE (GstClothGridPoint, gst_cloth_grid_point,
    gst_cloth_grid_point_copy, gst_cloth_grid_point_free);
G_DEFINE_BOXED_TYPE (GstClothMatches, gst_cloth_matches,
    gst_cloth_matches_ref, gst_cloth_matches_unref);

/**
 * gst_cloth_match_copy:
 * @match: a match
 *
 * Returns: (transfer full): a copy
 *
 * Since: 0.1
 */
GstClothMatch *
gst_cloth_match_copy (const GstClothMatch * match)
{
  return g_memdup2 (match, sizeof *match);
}

/**
 * gst_cloth_match_free:
 * @match: (transfer full): a match
 *
 * Frees a copy.
 *
 * Since: 0.1
 */
void
gst_cloth_match_free (GstClothMatch * match)
{
  g_free (match);
}

/**
 * gst_cloth_grid_point_copy:
 * @point: a point
 *
 * Returns: (transfer full): a copy
 *
 * Since: 0.1
 */
GstClothGridPoint *
gst_cloth_grid_point_copy (const GstClothGridPoint * point)
{
  return g_memdup2 (point, sizeof *point);
}

/**
 * gst_cloth_grid_point_free:
 * @point: (transfer full): a point
 *
 * Frees a copy.
 *
 * Since: 0.1
 */
void
gst_cloth_grid_point_free (GstClothGridPoint * point)
{
  g_free (point);
}

static GstClothGridPoint *
get_points (const GstClothMatches * matches)
{
  return (GstClothGridPoint *) (matches->matches + matches->n_matches);
}

static void
matches_scale (GstClothPayload * payload, gdouble scale_x, gdouble scale_y)
{
  GstClothMatches *matches = (GstClothMatches *) payload;
  const gdouble scale = sqrt (scale_x * scale_y);

  for (guint i = 0; i < matches->n_matches; i++) {
    GstClothMatch *m = &matches->matches[i];

    gst_cloth_scale_place (&m->x, &m->y, scale_x, scale_y);
    m->scale = (gfloat) (m->scale * scale);
  }
  for (guint i = 0; i < matches->n_points; i++) {
    GstClothGridPoint *p = &get_points (matches)[i];

    gst_cloth_scale_place (&p->x, &p->y, scale_x, scale_y);
    gst_cloth_scale_covariance (&p->cov_xx, &p->cov_xy, &p->cov_yy, scale_x,
        scale_y);
  }
}

/**
 * gst_cloth_matches_new:
 * @camera: (nullable): name of the camera in the rig, UTF-8 of at most
 *   #GST_CLOTH_MAX_CAMERA_NAME bytes; %NULL or "" when it isn't known
 * @sequence: number of the frame, counted by the camera
 * @columns: vertices in a row of the whole pattern
 * @rows: vertices in a column of the whole pattern
 * @n_features: how many features of the picture were looked at, at most
 *   #GST_CLOTH_MAX_FEATURES
 * @on_surface: whether distances were measured along a known surface, and not in the picture
 *   only
 * @matches: (array length=n_matches) (nullable): what was found of the features, copied
 * @n_matches: how many, at most #GST_CLOTH_MAX_FEATURES
 * @points: (array length=n_points) (nullable): the vertices that the picture shows, copied
 * @n_points: how many, at most #GST_CLOTH_MAX_FEATURES
 *
 * What one picture shows of a print. Immutable; no matches mean that nothing of the print was
 * recognised.
 *
 * Returns: (transfer full): new matches
 *
 * Since: 0.1
 */
GstClothMatches *
gst_cloth_matches_new (const gchar * camera, guint64 sequence, guint columns,
    guint rows, guint n_features, gboolean on_surface,
    const GstClothMatch * matches, guint n_matches,
    const GstClothGridPoint * points, guint n_points)
{
  GstClothMatches *payload;

  g_return_val_if_fail (gst_cloth_camera_is_valid (camera), NULL);
  g_return_val_if_fail (matches || !n_matches, NULL);
  g_return_val_if_fail (points || !n_points, NULL);
  g_return_val_if_fail (n_features <= GST_CLOTH_MAX_FEATURES
      && n_matches <= GST_CLOTH_MAX_FEATURES
      && n_points <= GST_CLOTH_MAX_FEATURES, NULL);
  g_return_val_if_fail (columns <= GST_CLOTH_MAX_FEATURES
      && rows <= GST_CLOTH_MAX_FEATURES, NULL);

  payload = gst_cloth_payload_new (sizeof *payload
      + n_matches * sizeof *matches + n_points * sizeof *points, camera,
      sequence, matches_scale);
  if (!payload)
    return NULL;
  payload->columns = columns;
  payload->rows = rows;
  payload->n_features = n_features;
  payload->on_surface = on_surface != FALSE;
  payload->n_matches = n_matches;
  payload->n_points = n_points;
  if (n_matches)
    memcpy (payload->matches, matches, n_matches * sizeof *matches);
  if (n_points)
    memcpy (get_points (payload), points, n_points * sizeof *points);
  return payload;
}

/**
 * gst_cloth_matches_ref:
 * @matches: matches
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothMatches *
gst_cloth_matches_ref (GstClothMatches * matches)
{
  return g_atomic_rc_box_acquire (matches);
}

/**
 * gst_cloth_matches_unref:
 * @matches: (transfer full): matches
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_matches_unref (GstClothMatches * matches)
{
  gst_cloth_payload_release (matches);
}

/**
 * gst_cloth_matches_get_camera:
 * @matches: matches
 *
 * Returns: (transfer none): name of the camera, "" when it isn't known
 *
 * Since: 0.1
 */
const gchar *
gst_cloth_matches_get_camera (const GstClothMatches * matches)
{
  return matches->payload.camera;
}

/**
 * gst_cloth_matches_get_sequence:
 * @matches: matches
 *
 * Returns: number of the frame, counted by the camera
 *
 * Since: 0.1
 */
guint64
gst_cloth_matches_get_sequence (const GstClothMatches * matches)
{
  return matches->payload.sequence;
}

/**
 * gst_cloth_matches_get_columns:
 * @matches: matches
 *
 * Returns: vertices in a row of the whole pattern
 *
 * Since: 0.1
 */
guint
gst_cloth_matches_get_columns (const GstClothMatches * matches)
{
  return matches->columns;
}

/**
 * gst_cloth_matches_get_rows:
 * @matches: matches
 *
 * Returns: vertices in a column of the whole pattern
 *
 * Since: 0.1
 */
guint
gst_cloth_matches_get_rows (const GstClothMatches * matches)
{
  return matches->rows;
}

/**
 * gst_cloth_matches_get_n_features:
 * @matches: matches
 *
 * Returns: how many features of the picture were looked at
 *
 * Since: 0.1
 */
guint
gst_cloth_matches_get_n_features (const GstClothMatches * matches)
{
  return matches->n_features;
}

/**
 * gst_cloth_matches_get_on_surface:
 * @matches: matches
 *
 * Returns: whether distances were measured along a known surface, and not in the picture only
 *
 * Since: 0.1
 */
gboolean
gst_cloth_matches_get_on_surface (const GstClothMatches * matches)
{
  return matches->on_surface;
}

/**
 * gst_cloth_matches_get_n_matches:
 * @matches: matches
 *
 * Returns: how many matches there are, verified or not
 *
 * Since: 0.1
 */
guint
gst_cloth_matches_get_n_matches (const GstClothMatches * matches)
{
  return matches->n_matches;
}

/**
 * gst_cloth_matches_get_n_points:
 * @matches: matches
 *
 * Returns: how many of the pattern's vertices the picture shows
 *
 * Since: 0.1
 */
guint
gst_cloth_matches_get_n_points (const GstClothMatches * matches)
{
  return matches->n_points;
}

/**
 * gst_cloth_matches_get_matches:
 * @matches: matches
 * @n_matches: (out) (optional): how many
 *
 * Returns: (array length=n_matches) (transfer none): the matches, valid as long as @matches
 *   is
 *
 * Since: 0.1
 */
const GstClothMatch *
gst_cloth_matches_get_matches (const GstClothMatches * matches,
    guint * n_matches)
{
  if (n_matches)
    *n_matches = matches->n_matches;
  return matches->matches;
}

/**
 * gst_cloth_matches_get_match:
 * @matches: matches
 * @index: which
 * @match: (out caller-allocates): its copy
 *
 * Returns: %FALSE when @index is past the end
 *
 * Since: 0.1
 */
gboolean
gst_cloth_matches_get_match (const GstClothMatches * matches, guint index,
    GstClothMatch * match)
{
  if (index >= matches->n_matches)
    return FALSE;
  *match = matches->matches[index];
  return TRUE;
}

/**
 * gst_cloth_matches_get_points:
 * @matches: matches
 * @n_points: (out) (optional): how many
 *
 * Returns: (array length=n_points) (transfer none): the vertices that the picture shows, valid
 *   as long as @matches is
 *
 * Since: 0.1
 */
const GstClothGridPoint *
gst_cloth_matches_get_points (const GstClothMatches * matches, guint * n_points)
{
  if (n_points)
    *n_points = matches->n_points;
  return get_points (matches);
}

/**
 * gst_cloth_matches_get_point:
 * @matches: matches
 * @index: which
 * @point: (out caller-allocates): its copy
 *
 * Returns: %FALSE when @index is past the end
 *
 * Since: 0.1
 */
gboolean
gst_cloth_matches_get_point (const GstClothMatches * matches, guint index,
    GstClothGridPoint * point)
{
  if (index >= matches->n_points)
    return FALSE;
  *point = get_points (matches)[index];
  return TRUE;
}

/**
 * gst_cloth_matches_get_table:
 * @matches: matches
 *
 * What is measured of each match as an array of 32 bit floats of the host, shape
 * (n_matches, 7): x, y, u, v, scale, distance, 1 when it is verified and 0 when not.
 *
 * Returns: (transfer full): new bytes
 *
 * Since: 0.1
 */
GBytes *
gst_cloth_matches_get_table (GstClothMatches * matches)
{
  gfloat *table = g_new (gfloat, 7 * matches->n_matches);
  gfloat *t = table;

  for (guint i = 0; i < matches->n_matches; i++) {
    const GstClothMatch *m = &matches->matches[i];

    *t++ = m->x;
    *t++ = m->y;
    *t++ = m->u;
    *t++ = m->v;
    *t++ = m->scale;
    *t++ = m->distance;
    *t++ = m->verified ? 1 : 0;
  }
  return g_bytes_new_take (table, 7 * matches->n_matches * sizeof (gfloat));
}

/**
 * gst_cloth_matches_scale:
 * @matches: matches
 * @scale_x: new width over old width, over 0
 * @scale_y: new height over old height, over 0
 *
 * The matches of the same picture at another size: x' = (x + ½)·@scale_x − ½, the covariances
 * in the new pixels, the features' scales by the mean of both (geometric).
 *
 * Returns: (transfer full): new matches
 *
 * Since: 0.1
 */
GstClothMatches *
gst_cloth_matches_scale (const GstClothMatches * matches, gdouble scale_x,
    gdouble scale_y)
{
  return gst_cloth_payload_scale ((const GstClothPayload *) matches, scale_x,
      scale_y);
}

/**
 * gst_cloth_matches_meta_api_get_type: (skip)
 *
 * Returns: the type of the meta's API
 *
 * Since: 0.1
 */
GType
gst_cloth_matches_meta_api_get_type (void)
{
  static GType type;

  return gst_cloth_payload_register_api (&type, "GstClothMatchesMetaAPI", TRUE);
}

/**
 * gst_cloth_matches_meta_get_info: (skip)
 *
 * Returns: (transfer none): the meta's implementation
 *
 * Since: 0.1
 */
const GstMetaInfo *
gst_cloth_matches_meta_get_info (void)
{
  static const GstMetaInfo *info;

  return gst_cloth_payload_register_meta (&info,
      gst_cloth_matches_meta_api_get_type (), "GstClothMatchesMeta");
}

/**
 * gst_buffer_add_cloth_matches_meta:
 * @buffer: a writable buffer
 * @matches: (transfer full): what its picture shows of the print
 *
 * Puts @matches on @buffer, in place of those it may have had.
 *
 * Returns: (transfer none): the meta that now holds @matches
 *
 * Since: 0.1
 */
GstClothMatchesMeta *
gst_buffer_add_cloth_matches_meta (GstBuffer * buffer,
    GstClothMatches * matches)
{
  return gst_cloth_payload_attach (matches, buffer,
      gst_cloth_matches_meta_get_info ());
}

/**
 * gst_buffer_get_cloth_matches:
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the matches on @buffer, owned by it; %NULL when it has
 *   none
 *
 * Since: 0.1
 */
GstClothMatches *
gst_buffer_get_cloth_matches (GstBuffer * buffer)
{
  return gst_cloth_payload_find (buffer,
      gst_cloth_matches_meta_api_get_type ());
}
