/* The lanes' half of each effect.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/random.h"
#include "gst/sim/lanes/fold.h"
#include "gst/sim/lanes/strain.h"

void CLOTH_LANE_NAME (cloth_lane_wind) (ClothLaneState * state,
    const ClothLane wind[3], ClothLane coefficient, ClothLane turbulence);

/* exp, for setting up: exactly 1 at 0. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_exp (ClothLane a)
{
  for (guint l = 0; l < CLOTH_N_LANES; l++)
    CLOTH_LANE_AT (&a, l) = (ClothReal) exp (CLOTH_LANE_AT (&a, l));
  return a;
}
