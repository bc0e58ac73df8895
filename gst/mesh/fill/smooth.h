/* The paper's Laplacian smoothing of meshes, in space and in time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/stencil.h"

G_BEGIN_DECLS

void cloth_smooth_space (const ClothStencils * stencils, gdouble weight,
    const gfloat * positions, gfloat * smoothed);
void cloth_smooth_time (guint n_vertices, gdouble weight,
    const gfloat * before, const gfloat * after, gfloat * positions);

G_END_DECLS
