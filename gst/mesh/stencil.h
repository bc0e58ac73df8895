/* What bends in a mesh: its neighbours and the second differences of a thin plate.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* Most vertices of one stencil. */
#define CLOTH_STENCIL_SIZE 4

/* @vertex: its vertices, the last one %CLOTH_NO_VERTEX when it has three
 * @weight: their weights, which sum up to 0
 *
 * A second difference of positions: what the weights make of the vertices is 0 where the
 * cloth is flat and unstretched, or evenly stretched. Its square is its part of the
 * plate's energy, in units in which that of a regular grid is
 * (p−1 − 2 p0 + p+1)² along both lines and twice the twist's square.
 */
typedef struct {
  guint32 vertex[CLOTH_STENCIL_SIZE];
  gfloat weight[CLOTH_STENCIL_SIZE];
} ClothStencil;

/* @n_vertices: vertices of the mesh
 * @same: for each vertex the lowest one that it is sewn to, or itself; all else knows only
 *   those
 * @edge_m: mean length of an edge on the flat cloth, metres; 1 when uv is not known
 * @n: number of stencils
 * @stencils: the stencils, by their first vertices
 * @of_start: (array): n_vertices + 1: where a vertex's entries in @of begin
 * @of: numbers of the stencils that a vertex is in
 * @near_start: (array): n_vertices + 1: where a vertex's entries in @near begin
 * @near: its neighbours along edges of faces (of a grid: horizontal and vertical)
 * @line_start: (array): n_vertices + 1: where a vertex's entries in @line begin
 * @line: pairs of neighbours that the vertex lies between on a line of quads; none at a
 *   corner or among triangles
 * @length: the edge's length on the flat cloth, metres, one for each of @near; 0 when uv
 *   is not known
 */
typedef struct {
  guint n_vertices;
  guint *same;
  gdouble edge_m;
  guint n;
  ClothStencil *stencils;
  guint *of_start;
  guint *of;
  guint *near_start;
  guint *near;
  guint *line_start;
  guint *line;
  gfloat *length;
} ClothStencils;

ClothStencils *cloth_stencils_new (const ClothTopology * topology,
    const GArray * seams);
void cloth_stencils_free (ClothStencils * stencils);
void cloth_stencil_apply (const ClothStencil * stencil,
    const gfloat * positions, gdouble value[3]);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothStencils, cloth_stencils_free)
G_END_DECLS
