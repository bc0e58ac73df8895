/* The table that gst-cloth-calibrate-1.0 prints.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "calibrate-shots.h"
#include "gst/rig/calibrate.h"

G_BEGIN_DECLS

/* Of the residuals. Good views give about 1, a board of other squares than said 6. */
#define CLOTH_CALIBRATE_MAX_VARIANCE 2.5

const gchar *cloth_calibrate_coefficient_name (ClothLens lens, guint i);
gchar *cloth_calibrate_report (const ClothCalibrateInput * input,
    const ClothCalibration * result, GPtrArray * cameras);

guint cloth_calibrate_view_outliers (const ClothCalibrateInput * input,
    const ClothCalibration * result, guint view);
GPtrArray *cloth_calibrate_warnings (const ClothCalibration * result,
    guint camera);

G_END_DECLS
