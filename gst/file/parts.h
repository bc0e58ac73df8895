/* Files that get their names together, and what a killed program left of them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/output.h"

G_BEGIN_DECLS

/* Unfinished files in a hidden folder beside where they shall be. */
typedef struct _ClothParts ClothParts;

ClothParts *cloth_parts_new (const gchar * head, const gchar * note,
    GError ** error);
ClothOutput *cloth_parts_open (ClothParts * parts, const gchar * name,
    GError ** error);
ClothOutput *cloth_parts_open_numbered (ClothParts * parts,
    const gchar * stem, guint64 number, const gchar * ending, GError ** error);
void cloth_parts_replace (ClothParts * parts, const gchar * name);
gboolean cloth_parts_replace_numbered (ClothParts * parts,
    const gchar * stem, guint64 first, const gchar * ending, GError ** error);
gboolean cloth_parts_note_frame (ClothParts * parts, GError ** error);
gboolean cloth_parts_leave (ClothParts * parts);
gboolean cloth_parts_commit (ClothParts * parts, GError ** error);
void cloth_parts_free (ClothParts * parts);

/* @CLOTH_REMAINS_NOTHING: nothing was whole
 * @CLOTH_REMAINS_UNFINISHED: its files can be gone on with
 * @CLOTH_REMAINS_PLACED: all was whole, and by now has its names
 *
 * What a writer that is gone had come to.
 */
typedef enum {
  CLOTH_REMAINS_NOTHING,
  CLOTH_REMAINS_UNFINISHED,
  CLOTH_REMAINS_PLACED
} ClothRemains;

/* What had the name of a head: to tell whether it is still that. */
typedef struct {
  guint64 device, inode;
  gint64 changed_ns;
} ClothPlaced;

GPtrArray *cloth_parts_find (const gchar * folder, const gchar * head,
    GError ** error);
GPtrArray *cloth_parts_find_for (const gchar * head, GError ** error);
gboolean cloth_parts_is_dead (const gchar * path);
gboolean cloth_parts_is_foreign (const gchar * path);
gboolean cloth_parts_has_frame (const gchar * path);
ClothPlaced cloth_parts_look_at (const gchar * path);
gboolean cloth_parts_check_same (const gchar * path,
    const ClothPlaced * placed, GError ** error);
gboolean cloth_parts_begin_reading (const gchar * head, ClothPlaced * placed,
    GError ** error);
gboolean cloth_parts_end_reading (const gchar * head,
    const ClothPlaced * placed, GError ** error);
gchar *cloth_parts_get_head (const gchar * path);
ClothParts *cloth_parts_reopen (const gchar * path, gboolean overwrite,
    ClothRemains * remains, GError ** error);
gboolean cloth_parts_remove_lone (const gchar * path, GError ** error);
gboolean cloth_parts_discard (ClothParts * parts, GError ** error);
gboolean cloth_parts_had_frame (const ClothParts * parts);
const gchar *cloth_parts_get_note (const ClothParts * parts);
gchar *cloth_parts_get_path (const ClothParts * parts, const gchar * name);
gboolean cloth_parts_is_whole (const ClothParts * parts, const gchar * name);
gboolean cloth_parts_has_unfinished (const ClothParts * parts);
gboolean cloth_parts_count_numbered (const ClothParts * parts,
    const gchar * stem, const gchar * ending, guint64 * n, GError ** error);
gboolean cloth_parts_drop_numbered (ClothParts * parts, const gchar * stem,
    guint64 first, const gchar * ending, GError ** error);
ClothOutput *cloth_parts_continue (ClothParts * parts, const gchar * name,
    guint64 size, GError ** error);
void cloth_parts_drop (ClothParts * parts, const gchar * name);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothParts, cloth_parts_free)
G_END_DECLS
