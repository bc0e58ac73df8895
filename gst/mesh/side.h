/* Sides of faces, sorted so that faces find their neighbours.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

typedef struct
{
  guint32 a, b;                 /* its ends, a ≤ b */
  guint32 face, number;         /* which of that face's sides */
} ClothSide;

ClothSide cloth_side (guint32 from, guint32 to, guint32 face, guint32 number);
gboolean cloth_side_same_edge (const ClothSide * x, const ClothSide * y);
gint cloth_side_compare (gconstpointer x, gconstpointer y);

G_END_DECLS
