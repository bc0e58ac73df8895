/* Recordings that can't be what they say they are: other units, other axes, other vertices.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

gdouble cloth_recording_longest_side (const ClothRecording * recording);
gdouble cloth_recording_find_scale (const ClothRecording * recording,
    guint corner, gdouble sigma);
gboolean cloth_recording_check_cloth (const ClothRecording * recording,
    gboolean told, GError ** error);
gboolean cloth_recording_check_clamps (const ClothRecording * recording,
    GError ** error);
gboolean cloth_recording_check (const ClothRecording * recording,
    gboolean told, GError ** error);
gboolean cloth_recording_check_paths (const ClothRecording * recording,
    GError ** error);
gboolean cloth_recording_check_other (const ClothRecording * recording,
    const ClothRecording * other, GError ** error);

G_END_DECLS
