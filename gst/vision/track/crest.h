/* Points of a moving cloth that lie in a fold's crest instead of on the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @crowding: points nearer to each other than this share of what is usual about them have piled
 *   up (0.3)
 * @tear: points further from each other than this many times what is usual about them lie on both
 *   sides of a step of depth (2.5)
 * @turned: a point of which at least this share of its triangles is turned over is not seen from
 *   the side that it was seen from (0.5)
 */
typedef struct {
  gdouble crowding, tear, turned;
} ClothCrestParams;

typedef struct _ClothCrest ClothCrest;

ClothCrestParams cloth_crest_default_params (void);
ClothCrest *cloth_crest_new (void);
void cloth_crest_free (ClothCrest * crest);
guint cloth_crest_run (ClothCrest * crest, const ClothCrestParams * params,
    guint n, const gdouble * uv, const gdouble * px, guint8 * lost);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCrest, cloth_crest_free)
G_END_DECLS
