/* Where the centre of gravity of a dot on bent cloth lies beside the dot's centre.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

typedef struct _ClothDotBend ClothDotBend;

ClothDotBend *cloth_dot_bend_new (guint columns, guint rows, gdouble pitch,
    gdouble diameter);
void cloth_dot_bend_free (ClothDotBend * self);

guint cloth_dot_bend_set_positions (ClothDotBend * self,
    const gfloat * positions);
void cloth_dot_bend_correct (ClothDotBend * self, guint index,
    const ClothCamera * camera, const ClothTriangulateView * view,
    ClothTriangulateView * corrected);
void cloth_dot_bend_add_doubt (const ClothDotBend * self,
    const gfloat * positions, gfloat * covariances);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothDotBend, cloth_dot_bend_free)
G_END_DECLS
