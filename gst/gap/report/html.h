/* The page that shows a diagnosis: one file, which works without a network.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/report/result.h"

G_BEGIN_DECLS

gboolean cloth_gap_report_write (const ClothGapResult * result,
    const gchar * path, GError ** error);

G_END_DECLS
