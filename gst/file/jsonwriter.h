/* JSON that people read as well: lists of numbers on one line, short numbers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Text that grows. Keys are %NULL in lists. Strings that are not UTF-8 are made so;
 * what could end a script of HTML (`<`, `>`, `&`) is written as an escape, so that the
 * text may stand in a page. Objects and lists must be ended by whom began them.
 */
typedef struct _ClothJsonWriter ClothJsonWriter;

ClothJsonWriter *cloth_json_writer_new (void);
void cloth_json_writer_set_exact (ClothJsonWriter * writer);
void cloth_json_writer_set_one_line (ClothJsonWriter * writer,
    gboolean one_line);
void cloth_json_writer_begin_object (ClothJsonWriter * writer,
    const gchar * key);
void cloth_json_writer_end_object (ClothJsonWriter * writer);
void cloth_json_writer_begin_array (ClothJsonWriter * writer,
    const gchar * key);
void cloth_json_writer_end_array (ClothJsonWriter * writer);
void cloth_json_writer_string (ClothJsonWriter * writer, const gchar * key,
    const gchar * value);
void cloth_json_writer_number (ClothJsonWriter * writer, const gchar * key,
    gdouble value);
void cloth_json_writer_count (ClothJsonWriter * writer, const gchar * key,
    guint64 value);
void cloth_json_writer_boolean (ClothJsonWriter * writer, const gchar * key,
    gboolean value);
void cloth_json_writer_numbers (ClothJsonWriter * writer, const gchar * key,
    const gdouble * values, gsize n);
gchar *cloth_json_writer_finish (ClothJsonWriter * writer);
void cloth_json_writer_free (ClothJsonWriter * writer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothJsonWriter, cloth_json_writer_free)
G_END_DECLS
