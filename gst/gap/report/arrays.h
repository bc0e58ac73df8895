/* The arrays of the report, packed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/report/result.h"

G_BEGIN_DECLS

gchar *cloth_gap_report_arrays (const ClothGapResult * result);

G_END_DECLS
