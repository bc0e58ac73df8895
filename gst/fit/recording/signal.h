/* Recordings as signals in time: their derivative and their noise.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

/* Frames of the polynomial that the velocity comes from, and its order. */
#define CLOTH_RECORDING_WINDOW 7
#define CLOTH_RECORDING_ORDER 4

void cloth_recording_find_weights (const gdouble * times, guint mask,
    gdouble at, guint order, gdouble * weights);
void cloth_recording_differentiate (ClothRecording * recording);
void cloth_recording_straighten (ClothRecording * recording,
    const gdouble * drawn);
gdouble cloth_recording_estimate_sigma (const ClothRecording * recording);

G_END_DECLS
