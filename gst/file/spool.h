/* Bytes that wait until what stands before them in a file is known.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/file.h"

G_BEGIN_DECLS

typedef struct _ClothSpool ClothSpool;

ClothSpool *cloth_spool_new (const gchar * stem, GError ** error);
gboolean cloth_spool_write (ClothSpool * spool, gconstpointer data,
    gsize size, GError ** error);
gboolean cloth_spool_copy (ClothSpool * spool, ClothOutput * output,
    GError ** error);
void cloth_spool_free (ClothSpool * spool);

G_END_DECLS
