/* What every front of the diagnosis needs alike: names of effects as people type them,
 * cloths that must be the same, the folder of a result.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnose.h"

G_BEGIN_DECLS

gchar **cloth_gap_effects_parse (const gchar * list, GError ** error);
gboolean cloth_gap_check_same_cloth (const gchar * name,
    const ClothTopology * cloth, const gchar * other_name,
    const ClothTopology * other, GError ** error);
gboolean cloth_gap_result_write (const ClothGapResult * result,
    const gchar * folder, GError ** error);

G_END_DECLS
