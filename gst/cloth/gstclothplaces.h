/* Shared inside libgstcloth-1.0: features of a picture and their places in the pattern.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

guint64 gst_cloth_place (gint column, gint row, guint columns, guint number);
gboolean gst_cloth_places_sort (guint64 * places, guint n);
void gst_cloth_places_mark_repeated (guint64 * places, guint n,
    guint8 * left_out);

G_END_DECLS
