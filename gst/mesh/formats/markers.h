/* Recordings of labelled points, as motion capture and robots write them: CSV and C3D.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* Most positions of a recording, frames times markers, that are held in memory. */
#define CLOTH_MAX_MARKER_POSITIONS ((gsize) 40000000)

/* @n_frames: frames, at least 1
 * @n_markers: markers, at least 1
 * @names: (nullable) (element-type utf8): name of each marker, %NULL where they are only counted
 * @times: (nullable): seconds, rising
 * @numbers: (nullable): what the file counts the frames by, rising
 * @fps: frames a second that the file names, else 0
 * @unit_m: metres a unit of length that the file names, else 0
 * @positions: 3 numbers a marker, frame by frame; NaN where it was not seen
 * @layout: how the file is laid out, for people
 * @ignored: (nullable): columns that were not used, for people
 *
 * A recording, in the file's own axes and unit of length.
 */
typedef struct {
  guint n_frames;
  guint n_markers;
  GPtrArray *names;
  gdouble *times;
  gdouble *numbers;
  gdouble fps;
  gdouble unit_m;
  gfloat *positions;
  const gchar *layout;
  gchar *ignored;
} ClothMarkers;

ClothMarkers *cloth_markers_new (guint64 n_frames, guint64 n_markers,
    GError ** error);
ClothMarkers *cloth_markers_parse_csv (gchar * text, gsize size,
    GError ** error);
ClothMarkers *cloth_markers_parse_c3d (const guint8 * bytes, gsize size,
    GError ** error);
ClothMarkers *cloth_markers_read (const gchar * path, GError ** error);
gint cloth_markers_find (const ClothMarkers * markers, const gchar * name);
void cloth_markers_free (ClothMarkers * markers);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothMarkers, cloth_markers_free)
G_END_DECLS
