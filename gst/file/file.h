/* Files that nobody vouches for: bounded reads.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

/* Most bytes of a file that are read at once: a limit on untrusted input. */
#define CLOTH_MAX_BUFFER (512u << 20)

/* Bytes that can be read at any offset: a regular file or memory. */
typedef struct _ClothInput ClothInput;

ClothInput *cloth_input_open (const gchar * path, GError ** error);
ClothInput *cloth_input_new_memory (const guint8 * data, gsize size);
guint64 cloth_input_get_size (const ClothInput * input);
gboolean cloth_input_read_at (ClothInput * input, guint64 offset,
    gpointer destination, gsize size, GError ** error);
gboolean cloth_input_load (ClothInput * input, gsize limit,
    GByteArray * bytes, GError ** error);
void cloth_input_free (ClothInput * input);

gchar *cloth_text_file_load (const gchar * path, gsize * length,
    GError ** error);
gchar *cloth_path_inside (const gchar * folder, const gchar * name,
    GError ** error);
void cloth_swap_little_endian (gpointer items, gsize item_size, gsize n_items);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothInput, cloth_input_free)
G_END_DECLS
