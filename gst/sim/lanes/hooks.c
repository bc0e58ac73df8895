/* The effects that have a part in the lanes, in the order in which they act.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/hooks.h"

const ClothLaneHooks *const
CLOTH_LANE_NAME (cloth_lane_hooks)[] = {
  &CLOTH_LANE_NAME (cloth_hooks_air_drag),
  NULL
};
