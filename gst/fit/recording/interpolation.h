/* Where vertices may have been while nobody saw them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

void cloth_recording_interpolate (ClothRecording * recording);

G_END_DECLS
