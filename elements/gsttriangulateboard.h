/* The printed pattern as triangulate sees it: squares or dots in, a grid of vertices out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/pattern/marray.h"
#include "gst/rig/merge.h"

G_BEGIN_DECLS

typedef struct {
  ClothPattern *checker;        /* one of these two */
  ClothMArray *dots;
  GstClothTopology *topology;
  guint columns, rows;          /* of vertices */
  gdouble edge_m;               /* between neighbours on the flat cloth */
  guint8 *seen;                 /* whether a picture shows a dot */
  const gchar *features;        /* what is seen of it: squares or dots */
  const gchar *detector;        /* elements that find them */
} GstTriangulateBoard;

/* What one picture carries: one of the two, or neither. */
typedef struct {
  GstClothQuads *quads;
  GstClothDots *dots;
} GstTriangulateSeen;

/* Reads a pattern.json. A checkerboard has a vertex for each corner of its squares, an
 * M-array one for each dot; uv is their place on the cloth. */
GstTriangulateBoard *gst_triangulate_board_load (const gchar * path,
    GError ** error);
void gst_triangulate_board_free (GstTriangulateBoard * board);
/* What of @buffer is of this kind of board, else of the other; FALSE: none of both. */
gboolean gst_triangulate_board_see (const GstTriangulateBoard * board,
    GstBuffer * buffer, GstTriangulateSeen * seen);
const gchar *gst_triangulate_seen_camera (const GstTriangulateSeen * seen);
guint64 gst_triangulate_seen_sequence (const GstTriangulateSeen * seen);
/* Adds the places that pad @index measures to @merge; %FALSE, after an element error,
 * when they are of another pattern. */
gboolean gst_triangulate_board_take (GstTriangulateBoard * board,
    GstElement * self, guint index, const GstTriangulateSeen * seen,
    ClothMerge * merge);

G_END_DECLS
