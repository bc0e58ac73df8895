/* What a diagnosis found, in words and plain numbers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/report/result.h"

G_BEGIN_DECLS

gchar *cloth_gap_result_summary (const ClothGapResult * result);
gchar *cloth_gap_limit_text (const ClothGapLimit * limit);
gchar *cloth_gap_change_text (const gchar * name, gdouble before,
    gdouble after, const gchar * unit);

G_END_DECLS
