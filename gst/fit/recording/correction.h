/* Recordings without what was wrong with all of them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"
#include "gst/sim/model.h"
#include "gst/take/measurement.h"

G_BEGIN_DECLS

gboolean cloth_recording_find_measurement (const ClothRecording * recording,
    const ClothModel * model, ClothMeasurement * measurement, GError ** error);
ClothRecording *cloth_recording_correct (const ClothRecording * recording,
    const ClothMeasurement * measurement);
void cloth_recording_measure (const ClothRecording * recording,
    gdouble * positions, const ClothMeasurement * measurement);

G_END_DECLS
