/* One hole of a mesh: a thin plate held by the vertices around it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/stencil.h"

G_BEGIN_DECLS

/* @n: unknown vertices
 * @found: the unknown vertices, as the search found them
 * @vertices: the same in the order of the system
 * @n_ring: known vertices that hold it
 * @ring: those vertices, each within two rings around the hole
 * @anchored: whether the ring holds the plate at all; without, no more is known of it
 * @variance: (array n): the variance that a vertex has when every second difference has
 *   1: diagonal of the inverse
 * @leverage: (array n): the same when every vertex of the ring has 1
 * @n_region: vertices around the hole, the ring first
 * @region: what its statistics are taken from
 * @n_around: second differences around the hole
 * @around: their numbers in the mesh's stencils
 *
 * The system depends on which vertices are unknown, not on where the others are, and so
 * is factored once and used as long as the hole stays.
 */
typedef struct {
  guint n;
  guint *found;
  guint *vertices;
  guint n_ring;
  guint *ring;
  gboolean anchored;
  gdouble *variance;
  gdouble *leverage;
  guint n_region;
  guint *region;
  guint n_around;
  guint *around;
  /*< private >*/
  guint n_stencils;
  gint *local;
  gfloat *weight;
  guint bandwidth;
  gdouble *factor;
} ClothHole;

ClothHole *cloth_hole_new (const ClothStencils * stencils, guint n,
    const guint * found, gint * index);
void cloth_hole_solve (const ClothHole * hole, const gdouble * ring,
    gdouble * solution);
void cloth_hole_free (ClothHole * hole);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothHole, cloth_hole_free)
G_END_DECLS
