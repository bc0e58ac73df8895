/* How far a cloth is stretched and sheared against lying flat.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* Numbers of one strain. */
#define CLOTH_STRAIN_SIZE 3

/* @CLOTH_STRAIN_WARP: E_uu, along the threads that run along u
 * @CLOTH_STRAIN_WEFT: E_vv, along those that run along v
 * @CLOTH_STRAIN_SHEAR: E_uv, half of what engineers call the shear strain
 */
typedef enum {
  CLOTH_STRAIN_WARP,
  CLOTH_STRAIN_WEFT,
  CLOTH_STRAIN_SHEAR
} ClothStrainComponent;

typedef struct _ClothStrains ClothStrains;

ClothStrains *cloth_strains_new (const ClothTopology * topology);
void cloth_strains_free (ClothStrains * strains);
void cloth_strains_measure (ClothStrains * strains, const gfloat * positions,
    const guint8 * states);
const gfloat *cloth_strains_get_faces (const ClothStrains * strains);
const gfloat *cloth_strains_get_vertices (const ClothStrains * strains);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothStrains, cloth_strains_free)
G_END_DECLS
