/* A hierarchy of boxes about triangles at rest: which point of them is the nearest.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

typedef struct _ClothBvh ClothBvh;

/* @distance: how far away the nearest point is, m
 * @point: the nearest point
 * @normal: where outside is there: of the face, or of an edge or corner the mean of its
 *   faces', each in proportion to its angle; unit length
 * @inside: the asking point lies behind it
 * @face: the nearest point lies within a face, not on an edge or corner
 * @border: it lies on an edge that has no second triangle
 */
typedef struct {
  gdouble distance;
  gdouble point[3];
  gdouble normal[3];
  gboolean inside;
  gboolean face;
  gboolean border;
} ClothBvhHit;

ClothBvh *cloth_bvh_new (const gdouble * points, guint n_points,
    const guint32 * triangles, guint n_triangles);
void cloth_bvh_free (ClothBvh * bvh);
gboolean cloth_bvh_is_closed (const ClothBvh * bvh);
gboolean cloth_bvh_nearest (const ClothBvh * bvh, const gdouble point[3],
    ClothBvhHit * hit);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothBvh, cloth_bvh_free)
G_END_DECLS
