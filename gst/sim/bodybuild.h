/* From a scene to what the lanes share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/body.h"
#include "gst/sim/scene.h"

G_BEGIN_DECLS

ClothBody *cloth_body_new (const ClothScene * scene, GError ** error);
guint32 *cloth_body_merge_seams (const GArray * seams, guint n,
    guint * n_particles);

G_END_DECLS
