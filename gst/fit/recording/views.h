/* What each camera saw at any time, between its pictures too.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/observations.h"
#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

/* @observations: the pictures; borrowed
 * @n: number of vertices
 * @frame_s: usual distance of frames, s: pictures further apart say nothing of the time between
 * @views: of each camera what was found last, element i of vertex i; NaN where nothing was seen
 */
typedef struct {
  const ClothObservations *observations;
  guint n;
  gdouble frame_s;
  ClothTriangulateView *views;

  /*< private >*/
  gdouble *seen;
  gdouble *between;
  guint *first;
  guint *order;
} ClothViews;

ClothViews *cloth_views_new (const ClothObservations * observations,
    gdouble frame_s);
void cloth_views_find (ClothViews * views, guint camera, gdouble time_s);
gdouble *cloth_views_variance (ClothViews * views, guint camera, guint axis);
void cloth_views_free (ClothViews * views);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothViews, cloth_views_free)
G_END_DECLS
