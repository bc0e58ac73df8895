/* Simulations that weak springs draw to what was recorded: live, over whole recordings, and let
 * go in windows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/nudge/observed.h"
#include "gst/fit/nudge/observer.h"
#include "gst/fit/nudge/paths.h"
#include "gst/fit/nudge/rollout.h"
#include "gst/fit/nudge/windows.h"
