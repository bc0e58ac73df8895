/* A place for every vertex, for formats whose viewers cannot show NaN.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

typedef struct _ClothHold ClothHold;

ClothHold *cloth_hold_new (const ClothTopology * topology);
const gfloat *cloth_hold_apply (ClothHold * hold, const gfloat * positions);
void cloth_hold_free (ClothHold * hold);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothHold, cloth_hold_free)
G_END_DECLS
