/* The printed pattern that triangulate joins its cameras by.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/pattern/any.h"
#include "gst/rig/merge.h"
#include "gst/rig/reconstruct.h"

G_BEGIN_DECLS

/* What pictures carry: GstClothQuads, GstClothDots or GstClothMatches. */
typedef enum {
  GST_TRIANGULATE_SQUARES,
  GST_TRIANGULATE_DOTS,
  GST_TRIANGULATE_MATCHES,
  GST_TRIANGULATE_N_KINDS
} GstTriangulateKind;

/* What is seen of the pattern goes in, a grid of vertices comes out. */
typedef struct {
  ClothAnyPattern *pattern;
  GstTriangulateKind kind;
  const gchar *features;        /* what is seen of the pattern */
  const gchar *detector;        /* elements that find them */
  GstClothTopology *topology;
  ClothReconstructionGrid grid;
  guint8 *seen;                 /* whether a picture shows a dot */
} GstTriangulateBoard;

/* What one picture carries; of the payloads the one of the kind. They are the buffer's. */
typedef struct {
  GstTriangulateKind kind;
  GstClothQuads *quads;
  GstClothDots *dots;
  GstClothMatches *matches;
  const gchar *camera;
  guint64 sequence;
  guint columns, rows;          /* squares, dots, vertices */
} GstTriangulateSeen;

/* Reads a pattern.json; uv of its topology is the vertices' place on the cloth. */
GstTriangulateBoard *gst_triangulate_board_load (const gchar * path,
    GError ** error);
void gst_triangulate_board_free (GstTriangulateBoard * board);
/* What of @buffer is of this kind of board, else of another; FALSE: none of all. */
gboolean gst_triangulate_board_see (const GstTriangulateBoard * board,
    GstBuffer * buffer, GstTriangulateSeen * seen);
/* Whether what is seen is of the pattern's kind and size. */
gboolean gst_triangulate_board_fits (const GstTriangulateBoard * board,
    const GstTriangulateSeen * seen);
/* Adds the places that pad @index measures to @merge; FALSE, after an element error, when
 * they are of another pattern. */
gboolean gst_triangulate_board_take (GstTriangulateBoard * board,
    GstElement * self, guint index, const GstTriangulateSeen * seen,
    ClothMerge * merge);

G_END_DECLS
