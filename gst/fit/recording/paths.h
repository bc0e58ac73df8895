/* Paths of clamps that nobody logged, as what was seen of the cloth has them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

gboolean cloth_recording_find_paths (ClothRecording * recording,
    GError ** error);
void cloth_recording_open_paths (ClothRecording * recording);
void cloth_recording_place_held (ClothRecording * recording);

G_END_DECLS
