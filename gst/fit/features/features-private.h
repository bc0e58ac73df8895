/* The waves of what is off in a frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/features/features.h"
#include "gst/math/simd.h"

G_BEGIN_DECLS

#define CLOTH_FEATURES_MAX_WAVES \
    (CLOTH_FEATURES_MAX_WAVES_EACH * CLOTH_FEATURES_MAX_WAVES_EACH)

/* @project: (@positions − recorded) / σ on each wave, for each axis; vertices that were not
 *   seen are left out. @begin: the frame's first vertex in the recording */
typedef struct {
  void (*project) (const ClothFeatures * features,
      const ClothRecording * recording, gsize begin,
      const gdouble * positions, gdouble sums[3][CLOTH_FEATURES_MAX_WAVES]);
} ClothProjection;

CLOTH_SIMD_TABLES (ClothProjection, cloth_projection);

G_END_DECLS
