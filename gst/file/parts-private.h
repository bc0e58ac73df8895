/* Shared by the files of parts, not installed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/parts.h"

G_BEGIN_DECLS

#define CLOTH_PARTS_LOCK "recording"
#define CLOTH_PARTS_MAGIC "gst-cloth recording 1\n"
#define CLOTH_PARTS_FRAME "frame\n"
#define CLOTH_PARTS_MAX_NOTE 64

struct _ClothParts
{
  gchar *folder;                /* where the files shall be */
  gchar *head;                  /* the file that readers open first */
  gchar *path;                  /* the hidden folder */
  gchar *note;
  gint lock;
  gboolean has_frame;           /* something is worth to be recovered */
  gboolean reopened, overwrite;
  gboolean unsynced;            /* files were not brought to the disk one by one */
  gboolean keep;                /* nothing is to be removed */
  GPtrArray *replaced;          /* names that are not written, but go */
};

gchar *cloth_parts_inside (const ClothParts * parts, const gchar * sub, const
    gchar * name);
gchar *cloth_parts_target (const ClothParts * parts, const gchar * name);
gboolean cloth_is_folder (const gchar * path);
gboolean cloth_parts_has_folder (const ClothParts * parts, const gchar * sub);
gboolean cloth_is_there (const gchar * path);
GPtrArray *cloth_parts_list_names (const ClothParts * parts, const gchar *
    sub, GError ** error);
gboolean cloth_parts_is_own (const gchar * name);
gboolean cloth_remove_parts (const gchar * path, gint lock);
ClothParts *cloth_parts_wrap (const gchar * path, const gchar * head, gint
    lock);
gboolean cloth_parts_check_target (const gchar * path, GError ** error);
gchar *cloth_parts_number (const gchar * stem, guint64 number, const gchar *
    ending);
gboolean cloth_parts_move (const gchar * from, const gchar * to, const gchar *
    shown, GError ** error);
gboolean cloth_parts_remove (ClothParts * parts, GError ** error);
gboolean cloth_parts_resume (ClothParts * parts, gboolean overwrite,
    ClothRemains * remains, GError ** error);
gint cloth_parts_open_lock (const gchar * path);
gboolean cloth_parts_read_lock (gint fd, gchar ** note, gboolean * has_frame);
gboolean cloth_parts_is_committing (const gchar * path);
gboolean cloth_parts_check_ended (const gchar * folder, const gchar * head,
    GError ** error);

G_END_DECLS
