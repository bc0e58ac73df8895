/* What may be wrong with cameras, as directions in which to change them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/estimate.h"
#include "gst/rig/rig.h"

G_BEGIN_DECLS

/* The step of a finite difference is this share of the prior's standard deviation. */
#define CLOTH_CAMERA_STEP 0.05

ClothCandidates *cloth_camera_candidates_new (const ClothRig * rig,
    const gchar * const *effects);
guint cloth_camera_of_candidate (const ClothCandidate * candidate);
guint cloth_camera_n_columns (void);
const ClothEffect *cloth_camera_column (guint column, guint * parameter);

G_END_DECLS
