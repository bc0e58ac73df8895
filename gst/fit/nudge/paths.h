/* Paths of clamps that nobody logged, as the cloth that hangs from them has them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/nudge/rollout.h"

G_BEGIN_DECLS

gboolean cloth_recording_refine_paths (ClothRecording * recording,
    const ClothModel * model, gdouble gain,
    const ClothRolloutOptions * options, GError ** error);

G_END_DECLS
