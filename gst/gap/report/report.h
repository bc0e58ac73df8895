/* What a diagnosis writes: gap.json, and the page that shows it, which is one file and works
 * without a network.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/report/result.h"
#include "gst/gap/report/words.h"

G_BEGIN_DECLS

gchar *cloth_gap_result_to_json (const ClothGapResult * result);
gboolean cloth_gap_result_write_json (const ClothGapResult * result,
    const gchar * path, GError ** error);
gboolean cloth_gap_report_write (const ClothGapResult * result,
    const gchar * path, GError ** error);
gboolean cloth_gap_result_write (const ClothGapResult * result,
    const gchar * folder, GError ** error);

G_END_DECLS
