/* Matched places, each with its neighbours: which of them contradict the others, and how uv
 * goes on around each.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/uv/dense.h"

G_BEGIN_DECLS

/* @at: column and row, px
 * @uv: on the flat cloth, m
 * @point: on the surface, m
 * @sigma: standard deviation of uv along u or v, by how well the places around fit, m
 * @slope: du and dv of a step on the surface, by rows; 0 where too few neighbours say
 */
typedef struct {
  gdouble at[2], uv[2];
  gdouble point[3];
  gdouble sigma;
  gdouble slope[6];
} ClothUVPlace;

/* @places: (array length=n): the caller's until the next call
 * @triangles: (array): three places each, of a positive area
 * @n_triangles: those whose edges all lie on the surface
 */
typedef struct {
  const ClothUVPlace *places;
  const guint *triangles;
  guint n, n_triangles;
} ClothUVNet;

typedef struct _ClothUVPlaces ClothUVPlaces;

ClothUVPlaces *cloth_uv_places_new (void);
void cloth_uv_places_free (ClothUVPlaces * self);
void cloth_uv_places_run (ClothUVPlaces * self, const ClothUVParams * params,
    const ClothUVMatch * matches, guint n_matches,
    const ClothMatchSurface * surface, ClothUVNet * net,
    ClothUVCounts * counts);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothUVPlaces, cloth_uv_places_free)
G_END_DECLS
