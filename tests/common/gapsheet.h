/* A diagnosis of a waving sheet, made up: what the report and gap.json are tested with.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/report/result.h"

ClothGapResult *gap_sheet_new (guint columns, guint rows, guint n_frames);
ClothGapResult *gap_sheet_new_spare (void);
ClothGapResult *gap_sheet_new_unknown (void);
ClothGapResult *gap_sheet_new_calm (void);
ClothGapResult *gap_sheet_new_hostile (const gchar * text);
