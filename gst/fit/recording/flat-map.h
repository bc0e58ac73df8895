/* Where places of the flat cloth lie on a mesh of it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

typedef struct _ClothFlatMap ClothFlatMap;

/* @corners: of the face that it lies in
 * @weights: of the corners, with sum 1; 0 of those that don't count
 * @outside: how far beside the mesh it is, m
 */
typedef struct {
  guint32 corners[4];
  gdouble weights[4];
  gdouble outside;
} ClothFlatPlace;

ClothFlatMap *cloth_flat_map_new (const ClothTopology * topology, gdouble slack);
ClothFlatPlace cloth_flat_map_locate (const ClothFlatMap * map,
    const gfloat * uv);
void cloth_flat_map_find_extent (const ClothTopology * topology,
    gdouble low[2], gdouble high[2]);
void cloth_flat_map_free (ClothFlatMap * map);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothFlatMap, cloth_flat_map_free)
G_END_DECLS
