/* The outline of a simulated cloth in a picture, and the filmed one beside it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"

G_BEGIN_DECLS

/* How far apart they are looked for, m on the cloth. */
#define CLOTH_OUTLINE_REACH_M 0.05

/* @n: number of vertices
 * @counts: (array length=n): pixels of the outline that are nearest to each vertex and have a counterpart
 * @offsets: (array length=n): how far outwards the filmed outline lies there, px
 * @gradients: (array): how fast the vertex moves outwards in the picture, [n][3], px/m
 *
 * One picture. Vertices inside of the outline, and those whose counterpart is not found, have the
 * count 0.
 */
typedef struct {
  guint n;
  guint *counts;
  gdouble *offsets;
  gdouble *gradients;
} ClothOutline;

ClothOutline *cloth_outline_new (const ClothRecording * recording,
    const ClothObservations * observations, guint threads);
gboolean cloth_outline_find (ClothOutline * outline, guint camera,
    guint frame, const gdouble * positions);
void cloth_outline_free (ClothOutline * outline);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothOutline, cloth_outline_free)
G_END_DECLS
