/* The lanes' half of each effect.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/lanes/state.h"

extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_air_drag);
