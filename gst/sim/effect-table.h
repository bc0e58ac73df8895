/* All effects, whatever their side.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/effect.h"

G_BEGIN_DECLS

const ClothEffect *const *cloth_effect_table (guint * n_effects);
const ClothEffect *cloth_effect_find (const gchar * id);
const gchar *cloth_effect_side_name (ClothEffectSide side);

G_END_DECLS
