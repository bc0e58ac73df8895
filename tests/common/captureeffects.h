/* All camera and image effects, for programs that link with no simulator.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/effect/effect.h"

#define CAPTURE(name) extern const ClothEffect cloth_effect_##name;
#include "gst/effect/list.h"

static const ClothEffect *const capture_effects[] = {
#define CAPTURE(name) &cloth_effect_##name,
#include "gst/effect/list.h"
  NULL
};
