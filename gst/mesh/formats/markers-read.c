/* Recordings of labelled points: which format a file has.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/markers.h"

/* @path: a file whose name ends in .c3d, or a table
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full): the recording, or %NULL
 */
ClothMarkers *
cloth_markers_read (const gchar * path, GError ** error)
{
  g_autofree gchar *lower = g_ascii_strdown (path, -1);
  g_autoptr (ClothInput) input = cloth_input_open (path, error);
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  ClothMarkers *markers;

  if (!input || !cloth_input_load (input, CLOTH_MAX_BUFFER, bytes, error))
    return NULL;
  /* Loaded with a zero behind. */
  markers = g_str_has_suffix (lower, ".c3d") ?
      cloth_markers_parse_c3d (bytes->data, bytes->len - 1, error) :
      cloth_markers_parse_csv ((gchar *) bytes->data, bytes->len - 1, error);
  if (!markers)
    g_prefix_error (error, "%s: ", path);
  return markers;
}
