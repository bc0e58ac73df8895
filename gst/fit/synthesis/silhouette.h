/* The silhouettes of a synthesised cloth, and those that were filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"

G_BEGIN_DECLS

void cloth_synthesis_compare_silhouettes (const ClothRecording * recording,
    const gfloat * positions, const ClothObservations * observations,
    guint threads, gdouble * overlaps, gdouble * differences);

G_END_DECLS
