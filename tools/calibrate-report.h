/* The table that gst-cloth-calibrate-1.0 prints.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "calibrate-shots.h"
#include "gst/rig/calibrate.h"

G_BEGIN_DECLS

gchar *cloth_calibrate_report (const ClothCalibrateInput * input,
    const ClothCalibration * result, GPtrArray * cameras);

guint cloth_calibrate_view_outliers (const ClothCalibrateInput * input,
    const ClothCalibration * result, guint view);
GPtrArray *cloth_calibrate_warnings (const ClothCalibration * result,
    guint camera);

G_END_DECLS
