/* The printed pattern that triangulate joins its cameras by.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulateboard.h"

#include "gst/cloth-io/points.h"
#include "gst/vision/match/match.h"

static const struct
{
  const gchar *features, *detector;
  guint outer;                  /* vertices of the mesh beyond the features, each way */
} kinds[GST_TRIANGULATE_N_KINDS] = {
  {"squares", "saddledetect ! quadtrack", 1}, {"dots", "dotlabel", 0},
  {"matches", "siftmatch", 0}
};

static GstClothTopology *
make_topology (const GstTriangulateBoard * board, const gdouble origin_m[2],
    GError ** error)
{
  guint columns = board->grid.columns, rows = board->grid.rows;
  const gdouble *edge_m = board->grid.edge_m;
  g_autofree gfloat *uv = g_new (gfloat, 2 * (gsize) columns * rows);
  g_autoptr (GstClothTopology) grid = NULL;
  const guint32 *faces;
  guint n_indices, i;

  for (i = 0; i < columns * rows; i++) {
    uv[2 * i] = (gfloat) (origin_m[0] + (i % columns) * edge_m[0]);
    uv[2 * i + 1] = (gfloat) (origin_m[1] + (i / columns) * edge_m[1]);
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

void
gst_triangulate_board_free (GstTriangulateBoard * board)
{
  if (!board) {
    return;
  }
  g_clear_pointer (&board->pattern, cloth_any_pattern_free);
  g_clear_pointer (&board->topology, gst_cloth_topology_unref);
  g_free (board->seen);
  g_free (board);
}

/* A checkerboard has a vertex for each corner of its squares. */
static const gdouble *
board_set_checker (GstTriangulateBoard * board, const ClothPattern * checker)
{
  board->kind = GST_TRIANGULATE_SQUARES;
  board->grid.columns = (guint) checker->columns + 1;
  board->grid.rows = (guint) checker->rows + 1;
  board->grid.edge_m[0] = board->grid.edge_m[1] = checker->square_m;
  return checker->origin_uv_m;
}

/* An M-array one for each dot. */
static const gdouble *
board_set_dots (GstTriangulateBoard * board, const ClothMArray * dots)
{
  board->kind = GST_TRIANGULATE_DOTS;
  board->grid.columns = (guint) dots->columns;
  board->grid.rows = (guint) dots->rows;
  board->grid.edge_m[0] = board->grid.edge_m[1] = dots->pitch_m;
  board->grid.dot_m = dots->diameter_m;
  board->seen = g_malloc (board->grid.columns * board->grid.rows);
  return dots->origin_uv_m;
}

/* A picture those of the grid that is laid over it, from edge to edge. */
static const gdouble *
board_set_picture (GstTriangulateBoard * board,
    const ClothPicturePattern * picture)
{
  static const gdouble origin_m[2] = { 0., 0. };

  board->kind = GST_TRIANGULATE_MATCHES;
  board->grid.columns = (guint) picture->columns;
  board->grid.rows = (guint) picture->rows;
  cloth_picture_pattern_get_edges (picture, board->grid.edge_m);
  board->grid.window_px = cloth_align_default_params ().radius;
  return origin_m;
}

GstTriangulateBoard *
gst_triangulate_board_load (const gchar * path, GError ** error)
{
  GstTriangulateBoard *board;
  ClothAnyPattern *pattern = cloth_any_pattern_load (path, error);
  const gdouble *origin_m;

  if (!pattern) {
    return NULL;
  }
  board = g_new0 (GstTriangulateBoard, 1);
  board->pattern = pattern;
  origin_m = pattern->picture ? board_set_picture (board, pattern->picture) :
      pattern->dots ? board_set_dots (board, pattern->dots) :
      board_set_checker (board, pattern->checker);
  board->features = kinds[board->kind].features;
  board->detector = kinds[board->kind].detector;
  board->topology = make_topology (board, origin_m, error);
  if (!board->topology) {
    g_clear_pointer (&board, gst_triangulate_board_free);
  }
  return board;
}

/* What of @buffer is of this kind. */
static gboolean
see_kind (GstBuffer * buffer, GstTriangulateKind kind,
    GstTriangulateSeen * seen)
{
  memset (seen, 0, sizeof (*seen));
  seen->kind = kind;
  if (kind == GST_TRIANGULATE_SQUARES
      && (seen->quads = gst_buffer_get_cloth_quads (buffer))) {
    seen->camera = gst_cloth_quads_get_camera (seen->quads);
    seen->sequence = gst_cloth_quads_get_sequence (seen->quads);
    seen->columns = gst_cloth_quads_get_columns (seen->quads);
    seen->rows = gst_cloth_quads_get_rows (seen->quads);
  } else if (kind == GST_TRIANGULATE_DOTS
      && (seen->dots = gst_buffer_get_cloth_dots (buffer))) {
    seen->camera = gst_cloth_dots_get_camera (seen->dots);
    seen->sequence = gst_cloth_dots_get_sequence (seen->dots);
    seen->columns = gst_cloth_dots_get_columns (seen->dots);
    seen->rows = gst_cloth_dots_get_rows (seen->dots);
  } else if (kind == GST_TRIANGULATE_MATCHES
      && (seen->matches = gst_buffer_get_cloth_matches (buffer))) {
    seen->camera = gst_cloth_matches_get_camera (seen->matches);
    seen->sequence = gst_cloth_matches_get_sequence (seen->matches);
    seen->columns = gst_cloth_matches_get_columns (seen->matches);
    seen->rows = gst_cloth_matches_get_rows (seen->matches);
  }
  return seen->camera != NULL;
}

gboolean
gst_triangulate_board_see (const GstTriangulateBoard * board,
    GstBuffer * buffer, GstTriangulateSeen * seen)
{
  GstTriangulateKind kind;

  if (see_kind (buffer, board->kind, seen)) {
    return TRUE;
  }
  for (kind = GST_TRIANGULATE_SQUARES; kind < GST_TRIANGULATE_N_KINDS; kind++) {
    if (see_kind (buffer, kind, seen)) {
      return TRUE;
    }
  }
  return FALSE;
}

gboolean
gst_triangulate_board_fits (const GstTriangulateBoard * board,
    const GstTriangulateSeen * seen)
{
  const guint outer = kinds[board->kind].outer;

  return seen->kind == board->kind
      && seen->columns + outer == board->grid.columns
      && seen->rows + outer == board->grid.rows;
}

gboolean
gst_triangulate_board_take (GstTriangulateBoard * board, GstElement * self,
    guint index, const GstTriangulateSeen * seen, ClothMerge * merge)
{
  const guint outer = kinds[board->kind].outer;

  if (seen->kind != board->kind) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The pictures on sink_%u carry %s, but pattern has %s.", index,
            kinds[seen->kind].features, board->features),
        ("Set pattern to the pattern.json of what is filmed, or put %s before "
            "the pad.", board->detector));
    return FALSE;
  }
  if (!gst_triangulate_board_fits (board, seen)) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The %s on sink_%u are of a pattern of %u×%u, but pattern has %u×%u.",
            board->features, index, seen->columns, seen->rows,
            board->grid.columns - outer, board->grid.rows - outer),
        ("Give the detector and this element the same pattern."));
    return FALSE;
  }
  if (seen->matches) {
    gst_cloth_io_points_add_matches (seen->matches, board->grid.columns,
        board->grid.rows, merge);
  } else if (seen->dots) {
    gst_cloth_io_points_add_dots (seen->dots, board->grid.columns,
        board->grid.rows, board->seen, merge);
  } else {
    gst_cloth_io_points_add_quads (seen->quads, board->grid.columns,
        board->grid.rows, merge);
  }
  return TRUE;
}
