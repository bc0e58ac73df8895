/* The printed pattern as triangulate sees it: squares or dots in, a grid of vertices out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulateboard.h"

#include "gst/cloth-io/points.h"

static GstClothTopology *
make_topology (const GstTriangulateBoard * board, const gdouble origin_m[2],
    GError ** error)
{
  guint columns = board->columns, rows = board->rows;
  g_autofree gfloat *uv = g_new (gfloat, 2 * (gsize) columns * rows);
  g_autoptr (GstClothTopology) grid = NULL;
  const guint32 *faces;
  guint n_indices, i;

  for (i = 0; i < columns * rows; i++) {
    uv[2 * i] = (gfloat) (origin_m[0] + (i % columns) * board->edge_m);
    uv[2 * i + 1] = (gfloat) (origin_m[1] + (i / columns) * board->edge_m);
  }
  /* its faces, at another place */
  grid = gst_cloth_topology_new_grid (columns, rows, 1.0f, 1.0f, error);
  if (!grid) {
    return NULL;
  }
  faces = gst_cloth_topology_get_faces (grid, &n_indices);
  return gst_cloth_topology_new (columns * rows, columns, rows, uv, faces,
      n_indices / 4, error);
}

GstTriangulateBoard *
gst_triangulate_board_load (const gchar * path, GError ** error)
{
  GstTriangulateBoard *board = g_new0 (GstTriangulateBoard, 1);
  g_autoptr (GError) other = NULL;
  const gdouble *origin_m = NULL;

  board->dots = cloth_m_array_load (path, &other);
  if (board->dots) {
    board->columns = (guint) board->dots->columns;
    board->rows = (guint) board->dots->rows;
    board->edge_m = board->dots->pitch_m;
    board->features = "dots";
    board->detector = "dotlabel";
    board->seen = g_malloc (board->columns * board->rows);
    origin_m = board->dots->origin_uv_m;
  } else if (g_error_matches (other, CLOTH_PATTERN_ERROR,
          CLOTH_PATTERN_ERROR_UNSUPPORTED)) {
    board->checker = cloth_pattern_load (path, error);
    if (board->checker) {
      board->columns = (guint) board->checker->columns + 1;
      board->rows = (guint) board->checker->rows + 1;
      board->edge_m = board->checker->square_m;
      board->features = "squares";
      board->detector = "saddledetect ! quadtrack";
      origin_m = board->checker->origin_uv_m;
    }
  } else {
    g_propagate_error (error, g_steal_pointer (&other));
  }
  if (origin_m) {
    board->topology = make_topology (board, origin_m, error);
  }
  if (!board->topology) {
    g_clear_pointer (&board, gst_triangulate_board_free);
  }
  return board;
}

void
gst_triangulate_board_free (GstTriangulateBoard * board)
{
  if (!board) {
    return;
  }
  g_clear_pointer (&board->checker, cloth_pattern_free);
  g_clear_pointer (&board->dots, cloth_m_array_free);
  g_clear_pointer (&board->topology, gst_cloth_topology_unref);
  g_free (board->seen);
  g_free (board);
}

gboolean
gst_triangulate_board_see (const GstTriangulateBoard * board,
    GstBuffer * buffer, GstTriangulateSeen * seen)
{
  seen->quads = gst_buffer_get_cloth_quads (buffer);
  seen->dots = gst_buffer_get_cloth_dots (buffer);
  if (board->dots && seen->dots) {
    seen->quads = NULL;
  } else if (board->checker && seen->quads) {
    seen->dots = NULL;
  }
  return seen->quads || seen->dots;
}

const gchar *
gst_triangulate_seen_camera (const GstTriangulateSeen * seen)
{
  return seen->dots ? gst_cloth_dots_get_camera (seen->dots) :
      gst_cloth_quads_get_camera (seen->quads);
}

guint64
gst_triangulate_seen_sequence (const GstTriangulateSeen * seen)
{
  return seen->dots ? gst_cloth_dots_get_sequence (seen->dots) :
      gst_cloth_quads_get_sequence (seen->quads);
}

gboolean
gst_triangulate_board_take (GstTriangulateBoard * board,
    GstElement * self, guint index, const GstTriangulateSeen * seen,
    ClothMerge * merge)
{
  guint squares = board->checker ? 1 : 0;       /* corners are one more */
  guint columns = board->columns - squares, rows = board->rows - squares;
  guint seen_columns, seen_rows;

  if (seen->dots ? !board->dots : !board->checker) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The pictures on sink_%u carry %s, but pattern has %s.", index,
            seen->dots ? "dots" : "squares", board->features),
        ("Set pattern to the pattern.json of what is filmed, or put %s before "
            "the pad.", board->detector));
    return FALSE;
  }
  seen_columns = seen->dots ? gst_cloth_dots_get_columns (seen->dots) :
      gst_cloth_quads_get_columns (seen->quads);
  seen_rows = seen->dots ? gst_cloth_dots_get_rows (seen->dots) :
      gst_cloth_quads_get_rows (seen->quads);
  if (seen_columns != columns || seen_rows != rows) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The %s on sink_%u are of a pattern of %u×%u, but pattern has %u×%u.",
            board->features, index, seen_columns, seen_rows, columns, rows),
        ("Give the detector and this element the same pattern."));
    return FALSE;
  }
  if (seen->dots) {
    gst_cloth_io_points_add_dots (seen->dots, board->columns, board->rows,
        board->seen, merge);
  } else {
    gst_cloth_io_points_add_quads (seen->quads, board->columns, board->rows,
        merge);
  }
  return TRUE;
}
