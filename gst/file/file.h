/* Files: bounded reads, writes that appear whole or not at all.
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

/* A file that has a temporary name, beside its final one, until it is whole. */
typedef struct _ClothOutput ClothOutput;

ClothOutput *cloth_output_new (const gchar * path, GError ** error);
gboolean cloth_output_write (ClothOutput * output, gconstpointer data,
    gsize size, GError ** error);
gboolean cloth_output_printf (ClothOutput * output, GError ** error,
    const gchar * format, ...) G_GNUC_PRINTF (3, 4);
gboolean cloth_output_write_at (ClothOutput * output, guint64 offset,
    gconstpointer data, gsize size, GError ** error);
gboolean cloth_output_finish (ClothOutput * output, GError ** error);
gboolean cloth_output_commit (ClothOutput * const *outputs, guint n_outputs,
    GError ** error);
void cloth_output_free (ClothOutput * output);
gboolean cloth_file_write_text (const gchar * path, const gchar * text,
    GError ** error);

/* Numbered files that get their names together. */
typedef struct _ClothFileSet ClothFileSet;

ClothFileSet *cloth_file_set_new (const gchar * stem, const gchar * ending,
    GError ** error);
ClothOutput *cloth_file_set_begin (ClothFileSet * set, GError ** error);
gboolean cloth_file_set_end (ClothFileSet * set, ClothOutput * output,
    GError ** error);
gboolean cloth_file_set_commit (ClothFileSet * set, GError ** error);
void cloth_file_set_free (ClothFileSet * set);

/* Bytes that wait until what stands before them in a file is known. */
typedef struct _ClothSpool ClothSpool;

ClothSpool *cloth_spool_new (const gchar * stem, GError ** error);
gboolean cloth_spool_write (ClothSpool * spool, gconstpointer data,
    gsize size, GError ** error);
gboolean cloth_spool_copy (ClothSpool * spool, ClothOutput * output,
    GError ** error);
void cloth_spool_free (ClothSpool * spool);

gchar *cloth_text_file_load (const gchar * path, gsize * length,
    GError ** error);
gchar *cloth_path_inside (const gchar * folder, const gchar * name,
    GError ** error);
void cloth_swap_little_endian (gpointer items, gsize item_size, gsize n_items);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothInput, cloth_input_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothOutput, cloth_output_free)
G_END_DECLS
