/* Files that appear whole or not at all.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

/* Behind the final name of an unfinished file, whose own name begins with a point. */
#define CLOTH_PART_MARK ".part-XXXXXX"
/* As often a name is looked for, when a cleaner is quicker each time. */
#define CLOTH_MOST_TRIES 100

/* A file that has a temporary name until it is whole. */
typedef struct _ClothOutput ClothOutput;

ClothOutput *cloth_output_new (const gchar * path, GError ** error);
ClothOutput *cloth_output_new_at (const gchar * temporary, const gchar * path,
    const gchar * shown, gboolean sync, GError ** error);
ClothOutput *cloth_output_continue (const gchar * temporary,
    const gchar * path, const gchar * shown, guint64 size, GError ** error);
gboolean cloth_output_write (ClothOutput * output, gconstpointer data,
    gsize size, GError ** error);
gboolean cloth_output_printf (ClothOutput * output, GError ** error,
    const gchar * format, ...) G_GNUC_PRINTF (3, 4);
gboolean cloth_output_write_at (ClothOutput * output, guint64 offset,
    gconstpointer data, gsize size, GError ** error);
gboolean cloth_output_flush (ClothOutput * output, GError ** error);
gboolean cloth_output_copy (ClothOutput * from, ClothOutput * to,
    GError ** error);
gboolean cloth_output_commit (ClothOutput * output, GError ** error);
void cloth_output_free (ClothOutput * output);
gboolean cloth_file_write (const gchar * path, gconstpointer data, gsize size,
    GError ** error);
gboolean cloth_file_write_text (const gchar * path, const gchar * text,
    GError ** error);

/* What outputs and parts have in common. */
gboolean cloth_file_check_target (const gchar * path, GError ** error);
gint cloth_file_lock_new (gint fd);
gint cloth_file_lock_old (gint fd);
gint cloth_file_append (gint fd, gconstpointer data, gsize size);
gint cloth_file_rename (const gchar * from, const gchar * to);
gboolean cloth_folder_make (const gchar * folder, GError ** error);
gboolean cloth_folder_sync (const gchar * folder, GError ** error);
gboolean cloth_file_fail (GError ** error, gint code, const gchar * doing,
    const gchar * path);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothOutput, cloth_output_free)
G_END_DECLS
