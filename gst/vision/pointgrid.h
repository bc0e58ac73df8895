/* The nearest of many points in the picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @distance2: squared distance, px²
 * @index: of the point
 */
typedef struct {
  gfloat distance2;
  gint index;
} ClothNear;

typedef struct _ClothPointGrid ClothPointGrid;

ClothPointGrid *cloth_point_grid_new (void);
void cloth_point_grid_free (ClothPointGrid * grid);
void cloth_point_grid_clear (ClothPointGrid * grid, gint width, gint height,
    guint n_expected);
void cloth_point_grid_add (ClothPointGrid * grid, gfloat x, gfloat y);
guint cloth_point_grid_nearest (const ClothPointGrid * grid, gfloat x,
    gfloat y, gfloat radius, ClothNear * near, guint n_near);
guint cloth_point_grid_within (const ClothPointGrid * grid, gfloat x, gfloat y,
    gfloat radius, gint * indices, guint n_indices);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPointGrid, cloth_point_grid_free)
G_END_DECLS
