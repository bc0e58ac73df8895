/* Several estimates of the same points in one picture become one each.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

typedef struct _ClothMerge ClothMerge;

ClothMerge *cloth_merge_new (guint n_points);
void cloth_merge_free (ClothMerge * self);
void cloth_merge_clear (ClothMerge * self);
void cloth_merge_add (ClothMerge * self, guint point, gdouble x, gdouble y,
    const gdouble cov[3]);
void cloth_merge_finish (ClothMerge * self, gdouble threshold,
    gdouble error_floor, ClothTriangulateView * view);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothMerge, cloth_merge_free)
G_END_DECLS
