/* From what the cameras of triangulate saw to places in space.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gsttriangulateboard.h"
#include "gst/mesh/isometry.h"
#include "gst/rig/dotbend.h"
#include "gst/rig/errorfloor.h"
#include "gst/rig/rig.h"

G_BEGIN_DECLS

/* All 0 at the start, but for what the properties say. */
typedef struct {
  ClothTriangulateParameters parameters;        /* error_floor < 0: the film tells */
  gdouble min_length, max_length;

  ClothTriangulator *triangulator;
  guint n_vertices;
  ClothDotBend *bend;           /* of dots */
  ClothErrorFloor floor;
  gboolean *wrong;
  gdouble *denials;
  /* of the last set */
  gfloat *positions, *covariances;
  const ClothTriangulation *result;     /* states are those of GstClothVertexState */
  ClothTriangulateView views[CLOTH_RIG_MAX_CAMERAS];
} GstTriangulateSolve;

void gst_triangulate_solve_set_board (GstTriangulateSolve * self,
    const GstTriangulateBoard * board);
void gst_triangulate_solve_clear (GstTriangulateSolve * self);
/* The error floor of the next set, px². */
gdouble gst_triangulate_solve_get_floor (const GstTriangulateSolve * self);
/* Triangulates what the cameras of @rig saw; dots a second time, after their bend is known
 * from the first. Vertices that no cloth allows become unseen. */
gboolean gst_triangulate_solve_run (GstTriangulateSolve * self,
    const ClothRig * rig, const GstTriangulateBoard * board,
    const ClothTriangulateView * views, GError ** error);

G_END_DECLS
