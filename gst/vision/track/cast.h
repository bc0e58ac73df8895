/* Where a feature without (u, v) is on a simulated cloth, and where it is drawn to.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/render/coverage.h"
#include "gst/vision/track/marker.h"

G_BEGIN_DECLS

/* @corner: vertices of the triangle that the feature's ray hits
 * @weight: barycentric place of the hit in it; sum 1
 * @ray: of the feature in the next frame, world: what the hit is drawn to
 *
 * What a pull of rank 2 is made of.
 */
typedef struct {
  guint32 corner[3];
  gdouble weight[3];
  ClothRay ray;
} ClothCast;

gboolean cloth_cast_feature (const ClothCoverage * coverage,
    const ClothCamera * camera, const gdouble * positions,
    const gdouble before[2], const gdouble px[2], ClothCast * cast);

G_END_DECLS
