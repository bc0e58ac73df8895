/* The page that shows a calibration.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "calibrate-shots.h"
#include "gst/rig/calibrate.h"

G_BEGIN_DECLS

gboolean cloth_calibrate_page_write (const ClothCalibrateInput * input,
    const ClothCalibration * result, const ClothPattern * pattern,
    GPtrArray * cameras, const gchar * path, GError ** error);

G_END_DECLS
