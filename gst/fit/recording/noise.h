/* Noise of a recording that differs from place to place and from direction to direction.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

gboolean cloth_recording_noise_set (ClothRecordingNoise * noise, gsize at,
    const gdouble information[6], gdouble least);
void cloth_recording_noise_add (const ClothRecordingNoise * noise, gsize at,
    gdouble information[6]);
ClothRecordingNoise *cloth_recording_noise_map (const ClothRecordingNoise * noise,
    const gdouble matrix[9]);
gdouble cloth_recording_noise_solve (const ClothRecordingNoise * noise,
    gsize at, const gdouble pull[3], gdouble way[3]);
gdouble cloth_recording_noise_finish (ClothRecordingNoise * noise,
    const gdouble * seen);
gdouble cloth_recording_noise_square (const ClothRecording * recording);
void cloth_recording_whiten (const ClothRecording * recording, gsize at,
    const gdouble off[3], gdouble white[3]);
void cloth_recording_cut_blind (const ClothRecording * recording, gsize at,
    gdouble off[3]);
void cloth_recording_add_noise (const ClothRecording * recording, gsize at,
    gdouble scale, ClothRandom * random, gdouble place[3]);

G_END_DECLS
