/* Vertices that stand still are averaged over time; those that move are left alone.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/match/grid.h"

G_BEGIN_DECLS

/* Most pictures that are averaged: each takes 40 bytes of memory a vertex. */
#define CLOTH_STEADY_MAX 100

typedef struct _ClothSteady ClothSteady;

ClothSteady *cloth_steady_new (guint n_vertices, guint most);
void cloth_steady_free (ClothSteady * steady);
void cloth_steady_reset (ClothSteady * steady);
void cloth_steady_run (ClothSteady * steady, ClothGridVertex * vertices);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSteady, cloth_steady_free)
G_END_DECLS
