/* Features of several cameras that show the same place of a cloth that lies flat.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* In place of a group: the feature is in none. */
#define CLOTH_COMBINE_NONE G_MAXUINT32

/* @camera: which saw it
 * @place: where it is on the cloth, m
 * @descriptor: (array fixed-size=128): what it looks like
 */
typedef struct {
  guint camera;
  gdouble place[2];
  const guint8 *descriptor;
} ClothCombineItem;

guint cloth_combine_run (guint n, const ClothCombineItem * items,
    gdouble radius, guint32 * groups);

G_END_DECLS
