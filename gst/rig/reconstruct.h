/* From what the cameras of a rig saw of a cloth at one instant to where its vertices are.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/rig.h"
#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

/* @columns: vertices in a row of the grid; vertex = row·columns + column
 * @rows: vertices in a column
 * @edge_m: distance of neighbours in a row and in a column on the flat cloth, metres
 * @dot_m: diameter of the dots whose centres of gravity are seen, metres; 0: what is seen
 *   are corners, or any points of a print; dots are as far apart in a row as in a column
 * @window_px: half the edge of the windows by which places of a print were found, px of the
 *   film; 0: they are points
 *
 * The grid of vertices that is printed on the cloth.
 */
typedef struct {
  guint columns, rows;
  gdouble edge_m[2];
  gdouble dot_m;
  gdouble window_px;
} ClothReconstructionGrid;

/* @triangulate: of each vertex alone; an error floor below 0 stands for the one that the
 *   film's own residuals tell
 * @shortest: least distance of neighbours in space over that on the flat cloth, 0 for no
 *   limit: bent into a fold an edge is a chord
 * @longest: largest such distance, 0 for no limit: woven cloth stretches a little
 */
typedef struct {
  ClothTriangulateParameters triangulate;
  gdouble shortest, longest;
} ClothReconstructionParameters;

#define CLOTH_RECONSTRUCTION_PARAMETERS_DEFAULT { \
  { .min_views = 2, .threshold = 4, .max_error = 0, .error_floor = -1, .huber = 2 }, \
  .shortest = 0.8, .longest = 1.05 }

/* @n_vertices: columns·rows of the grid
 * @positions: 3 a vertex, metres, world frame; NaN where unseen
 * @covariances: 6 a vertex: xx, xy, xz, yy, yz, zz, m²
 * @states: a #ClothPointState a vertex
 * @error_floor: variance on top of what each observation states, px², as known after
 *   this set
 * @n_compared: for each camera, the vertices it saw that enough cameras saw
 * @n_left_out: for each camera, those of them at which it contradicts the others
 */
typedef struct {
  guint n_vertices;
  gfloat *positions, *covariances;
  guint8 *states;
  gdouble error_floor;
  guint n_compared[CLOTH_RIG_MAX_CAMERAS], n_left_out[CLOTH_RIG_MAX_CAMERAS];
} ClothReconstructed;

typedef struct _ClothReconstruction ClothReconstruction;

ClothReconstruction *cloth_reconstruction_new (const ClothRig * rig,
    GError ** error);
void cloth_reconstruction_free (ClothReconstruction * self);

void cloth_reconstruction_set_grid (ClothReconstruction * self,
    const ClothReconstructionGrid * grid);
void cloth_reconstruction_set_parameters (ClothReconstruction * self,
    const ClothReconstructionParameters * parameters);
void cloth_reconstruction_set_pool (ClothReconstruction * self,
    ClothPool * pool);

gdouble cloth_reconstruction_get_error_floor (const ClothReconstruction * self);
gdouble cloth_reconstruction_get_stretch (const ClothReconstruction * self);
gboolean cloth_reconstruction_allows (const ClothReconstruction * self,
    gdouble stretch);
const ClothReconstructed *cloth_reconstruction_run (ClothReconstruction * self,
    const ClothTriangulateView * views, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothReconstruction, cloth_reconstruction_free)
G_END_DECLS
