/* Recordings of labelled points: what the formats have in common.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/markers.h"

#include <math.h>
#include <string.h>

/* @n_frames: frames
 * @n_markers: markers
 * @error: #ClothFileError
 *
 * Returns: (transfer full): a recording in which nothing is seen, without names and times, or
 *   %NULL when it is empty or too large
 */
ClothMarkers *
cloth_markers_new (guint64 n_frames, guint64 n_markers, GError ** error)
{
  ClothMarkers *markers;

  if (n_frames == 0 || n_markers == 0) {
    cloth_file_invalid (error, "there is no %s in it",
        n_frames == 0 ? "frame" : "marker");
    return NULL;
  }
  if (n_markers > CLOTH_MAX_VERTICES ||
      n_frames > CLOTH_MAX_MARKER_POSITIONS / n_markers) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%" G_GUINT64_FORMAT " frames of %" G_GUINT64_FORMAT
        " markers; %u markers and %" G_GSIZE_FORMAT
        " positions are accepted: import the recording in parts", n_frames,
        n_markers, CLOTH_MAX_VERTICES, CLOTH_MAX_MARKER_POSITIONS);
    return NULL;
  }
  markers = g_new0 (ClothMarkers, 1);
  markers->n_frames = (guint) n_frames;
  markers->n_markers = (guint) n_markers;
  markers->positions = g_new (gfloat, 3 * n_frames * n_markers);
  for (gsize i = 0; i < 3 * n_frames * n_markers; i++)
    markers->positions[i] = NAN;
  return markers;
}

/* @markers: a recording
 * @name: a name
 *
 * Returns: the marker that is called so, −1 without one
 */
gint
cloth_markers_find (const ClothMarkers * markers, const gchar * name)
{
  for (guint i = 0; markers->names && i < markers->names->len; i++)
    if (g_str_equal (markers->names->pdata[i], name))
      return (gint) i;
  return -1;
}

/* @markers: (transfer full) (nullable): a recording */
void
cloth_markers_free (ClothMarkers * markers)
{
  if (!markers)
    return;
  g_clear_pointer (&markers->names, g_ptr_array_unref);
  g_free (markers->times);
  g_free (markers->numbers);
  g_free (markers->positions);
  g_free (markers->ignored);
  g_free (markers);
}
