/* The paper's Laplacian smoothing of meshes, in space and in time.
 *
 * V. Scholz et al., “Garment Motion Capture Using Color-Coded Patterns” (2005), section 4.4:
 * p + w L(p), with the neighbours that hole filling has, or the frames before and after.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/fill/smooth.h"

#include <math.h>

/* @stencils: the mesh's
 * @weight: part of the way to the mean of its neighbours that a vertex goes, 0 to 1
 * @positions: 3 numbers a vertex, metres, NaN when not seen
 * @smoothed: (out): the same, smoothed; a vertex with a neighbour that isn't seen stays
 *
 * The neighbours are those on both sides of a vertex, of a vertex at the border those
 * along it: the mean of all would draw it in.
 */
void
cloth_smooth_space (const ClothStencils * stencils, gdouble weight,
    const gfloat * positions, gfloat * smoothed)
{
  for (guint v = 0; v < stencils->n_vertices; v++) {
    guint n = stencils->line_start[v + 1] - stencils->line_start[v];
    gdouble sum[3] = { 0, };

    for (guint i = stencils->line_start[v]; i < stencils->line_start[v + 1];
        i++)
      for (guint c = 0; c < 3; c++)
        sum[c] += positions[3 * stencils->line[i] + c];
    for (guint c = 0; c < 3; c++) {
      gdouble p = positions[3 * v + c], way = weight * (sum[c] / n - p);

      smoothed[3 * v + c] = (gfloat) (isfinite (way) ? p + way : p);
    }
  }
}

/* @n_vertices: number of vertices
 * @weight: part of the way to the mean of the frames beside that a vertex goes, 0 to 1
 * @before: positions of the frame before
 * @after: positions of the frame after, as far away in time
 * @positions: (inout): positions of the frame; a vertex that either doesn't see stays
 */
void
cloth_smooth_time (guint n_vertices, gdouble weight, const gfloat * before,
    const gfloat * after, gfloat * positions)
{
  for (gsize i = 0; i < 3 * (gsize) n_vertices; i++) {
    gdouble p = positions[i];
    gdouble way = weight * (((gdouble) before[i] + after[i]) / 2 - p);

    if (isfinite (way))
      positions[i] = (gfloat) (p + way);
  }
}
