/* Numbered files that get their names together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/file.h"

G_BEGIN_DECLS

typedef struct _ClothFileSet ClothFileSet;

ClothFileSet *cloth_file_set_new (const gchar * stem, const gchar * ending,
    GError ** error);
ClothOutput *cloth_file_set_begin (ClothFileSet * set, GError ** error);
gboolean cloth_file_set_end (ClothFileSet * set, ClothOutput * output,
    GError ** error);
gboolean cloth_file_set_commit (ClothFileSet * set, GError ** error);
void cloth_file_set_free (ClothFileSet * set);

G_END_DECLS
