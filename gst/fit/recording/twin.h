/* What another simulator made of a recorded scene, at the recording's vertices and times.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

ClothRecording *cloth_recording_new_twin (ClothTake * simulated,
    const ClothRecording * recorded, GError ** error);
void cloth_recording_see_alike (ClothRecording * a, ClothRecording * b);

G_END_DECLS
