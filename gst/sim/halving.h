/* Meshes of half the edge length, for what the numerics effects do to a scene.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/scene.h"

G_BEGIN_DECLS

/* A scene on a mesh of half the edge length, and how its vertices came about: each is the
 * mean of four old ones, of one or two of them where the same are named twice. */
typedef struct
{
  ClothScene *scene;
  guint n_old;
  guint32 *kept;                /* new index of each old vertex */
  guint32 (*from)[4];           /* old vertices of each new one */
} ClothHalving;

ClothHalving *cloth_halving_new (const ClothScene * scene);
void cloth_halving_spread (const ClothHalving * halving, guint stride,
    const gdouble * old, gdouble * values);
void cloth_halving_free (ClothHalving * halving);
ClothScene *cloth_scene_turn_diagonals (const ClothScene * scene,
    gboolean all_one_way);

G_END_DECLS
