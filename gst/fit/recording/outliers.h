/* Seen vertices that would have to be torn off the cloth to be where they are.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

typedef struct _ClothTears ClothTears;

ClothTears *cloth_tears_new (const ClothTopology * topology);
guint cloth_tears_remove (ClothTears * tears, gdouble slack_m,
    gdouble * positions);
void cloth_tears_free (ClothTears * tears);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTears, cloth_tears_free)
G_END_DECLS
