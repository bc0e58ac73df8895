/* The errors of a film's observations that their covariances know nothing of.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

/* @floor: variance on top of each observation's own, px², as estimated so far
 * @weight: degrees of freedom that @floor rests on
 */
typedef struct {
  gdouble floor;
  gdouble weight;
} ClothErrorFloor;

gdouble cloth_error_floor_add (ClothErrorFloor * self, guint n_views,
    const ClothTriangulateView * views, const ClothTriangulation * result);

G_END_DECLS
