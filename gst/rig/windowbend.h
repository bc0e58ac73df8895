/* Where a window of a print on bent cloth is found beside its middle.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/rig.h"
#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

void cloth_window_bend_correct (guint columns, guint rows, gdouble radius_px,
    const ClothRig * rig, const ClothTriangulateView * views,
    gfloat * positions, gfloat * covariances, gdouble * room);

G_END_DECLS
