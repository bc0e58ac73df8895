/* The effects that have a part in the lanes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/hooks.h"

#define LANES(name) \
    extern const ClothEffect cloth_effect_##name; \
    extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_##name);
#include "gst/effect/list.h"

const ClothLanePart
CLOTH_LANE_NAME (cloth_lane_parts)[] = {
#define LANES(name) \
  { &cloth_effect_##name, &CLOTH_LANE_NAME (cloth_hooks_##name) },
#include "gst/effect/list.h"
  {NULL, NULL}
};
