/* What single cameras saw of a cloth's vertices: rays, and points on them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

/* @n: number of vertices
 * @centres: (array): where each ray begins, 3 numbers a vertex, metres, world frame
 * @directions: (array): 3 numbers a vertex, length 1; NaN when not seen
 * @spreads: (array): standard deviation of each direction, the same all round, radians;
 *   NaN when not seen
 *
 * One picture, or the pictures of one instant. A ray says nothing of how far away its vertex is.
 */
typedef struct {
  guint n;
  gdouble *centres;
  gdouble *directions;
  gdouble *spreads;

  /*< private >*/
  gdouble *scratch;
} ClothRays;

ClothRays *cloth_rays_new (guint n);
void cloth_rays_clear (ClothRays * rays);
void cloth_rays_cast (ClothRays * rays, const ClothCamera * camera,
    const ClothTriangulateView * view);
void cloth_rays_take (ClothRays * rays, const ClothRays * from, guint vertex);
void cloth_rays_drop (ClothRays * rays, guint vertex);
void cloth_rays_copy (ClothRays * to, const ClothRays * from);
gboolean cloth_rays_has (const ClothRays * rays, guint vertex);
void cloth_rays_lift (const ClothRays * rays, const gdouble * reference,
    gdouble * positions);
gdouble cloth_rays_split (const ClothRays * rays, guint vertex,
    const gdouble v[3], gdouble across[3]);
void cloth_rays_free (ClothRays * rays);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRays, cloth_rays_free)
G_END_DECLS
