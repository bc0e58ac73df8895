/* Parts that programs who are gone left are gone on with.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/parts-private.h"

#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Why what a writer made can't be had. */
static gboolean
fail_locked (gint code, const gchar * path, GError ** error)
{
  if (code == EWOULDBLOCK)
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_BUSY,
        "another program is writing or finishing it: wait for it, or end it");
  else if (code == ENOENT)
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
        "another program has just finished or removed it");
  else
    g_set_error (error, G_IO_ERROR, g_io_error_from_errno (code),
        "whether its program lives can't be told, as its file can't be locked "
        "(%s): copy the folder to a disk where that can be done",
        g_strerror (code));
  return FALSE;
}

/* @path: a lone file with the name of a part
 * @error: #GIOErrorEnum; %G_IO_ERROR_BUSY: its writer lives
 *
 * Removes it when its writer is gone.
 *
 * Returns: whether that was so
 */
gboolean
cloth_parts_remove_lone (const gchar * path, GError ** error)
{
  gint fd = cloth_parts_open_lock (path);
  gboolean removed = FALSE;
  gint code;

  if (fd < 0)
    return cloth_file_fail (error, errno, "open", path);
  code = cloth_file_lock_old (fd);
  if (code)
    fail_locked (code, path, error);
  else if (g_unlink (path) == 0)
    removed = TRUE;
  else
    cloth_file_fail (error, errno, "remove", path);
  close (fd);
  return removed;
}

/* Whether there is no file in a folder, nor in those that a part has. */
static gboolean
holds_nothing (const gchar * path)
{
  GDir *dir = cloth_is_folder (path) ? g_dir_open (path, 0, NULL) : NULL;
  gboolean nothing = dir != NULL;
  const gchar *name;

  while (nothing && (name = g_dir_read_name (dir))) {
    g_autofree gchar *sub = g_build_filename (path, name, NULL);

    nothing = holds_nothing (sub);
  }
  g_clear_pointer (&dir, g_dir_close);
  return nothing;
}

/* Whether it is what a writer made: at the very first it had not said so yet. */
static gboolean
is_recording (ClothParts * parts)
{
  g_autoptr (GPtrArray) names = NULL;
  struct stat info;

  if (cloth_parts_read_lock (parts->lock, &parts->note, &parts->has_frame))
    return TRUE;
  parts->note = g_strdup ("");
  names = cloth_parts_list_names (parts, NULL, NULL);
  return names && names->len == 1 && fstat (parts->lock, &info) == 0 &&
      info.st_size < (off_t) strlen (CLOTH_PARTS_MAGIC);
}

/* @path: a folder that cloth_parts_find() found
 * @overwrite: whether files may be replaced that got the names since
 * @remains: (out): how far the writer had come
 * @error: #GIOErrorEnum; %G_IO_ERROR_BUSY: the writer lives; %G_IO_ERROR_EXISTS: files
 *   would be replaced
 *
 * Locks what a killed program left. A commit that was cut off is ended, or undone.
 *
 * Returns: (transfer full): the parts, or %NULL
 */
ClothParts *
cloth_parts_reopen (const gchar * path, gboolean overwrite,
    ClothRemains * remains, GError ** error)
{
  g_autofree gchar *head = cloth_parts_get_head (path);
  g_autoptr (ClothParts) parts = NULL;
  gint fd = cloth_parts_open_lock (path);
  gint code = fd < 0 ? errno : cloth_file_lock_old (fd);

  /* Without its lock the folder may be anybody's, unless nothing is in it. */
  if (fd < 0 && (code != ENOENT || !holds_nothing (path))) {
    g_autofree gchar *lock = g_build_filename (path, CLOTH_PARTS_LOCK, NULL);

    cloth_file_fail (error, code, "open", lock);
    return NULL;
  }
  parts = cloth_parts_wrap (path, head, fd);
  parts->reopened = TRUE;
  parts->overwrite = overwrite;
  parts->keep = TRUE;
  /* Nobody vouches for what a computer that lost its power had brought to the disk. */
  parts->unsynced = TRUE;
  if (fd >= 0 && code) {
    fail_locked (code, path, error);
    return NULL;
  }
  if (fd >= 0 && !is_recording (parts)) {
    cloth_file_invalid (error, "it is not what a recording leaves");
    return NULL;
  }
  if (!cloth_parts_resume (parts, overwrite, remains, error))
    return NULL;
  return g_steal_pointer (&parts);
}

/* @parts: parts that were reopened
 * @error: #GIOErrorEnum
 *
 * Removes their files.
 *
 * Returns: %TRUE when nothing is left
 */
gboolean
cloth_parts_discard (ClothParts * parts, GError ** error)
{
  const gboolean removed = cloth_remove_parts (parts->path, parts->lock);

  parts->lock = -1;
  if (!removed)
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED,
        "not all of it can be removed");
  return removed;
}

/* @parts: parts that were reopened
 *
 * Returns: whether their writer had something to recover
 */
gboolean
cloth_parts_had_frame (const ClothParts * parts)
{
  return parts->has_frame;
}

/* @parts: parts that were reopened
 *
 * Returns: (transfer none): what their writer noted
 */
const gchar *
cloth_parts_get_note (const ClothParts * parts)
{
  return parts->note;
}

/* @parts: parts
 * @name: of one of its files
 *
 * Returns: whether it was whole
 */
gboolean
cloth_parts_is_whole (const ClothParts * parts, const gchar * name)
{
  g_autofree gchar *whole = cloth_parts_inside (parts, "new", name);

  return cloth_is_there (whole);
}

/* @parts: parts
 * @name: of one of its files
 *
 * Returns: (transfer full) (type filename): where it lies, be it whole or not
 */
gchar *
cloth_parts_get_path (const ClothParts * parts, const gchar * name)
{
  return cloth_parts_is_whole (parts, name) ? cloth_parts_inside (parts, "new",
      name) : cloth_parts_inside (parts, name, NULL);
}

/* @parts: parts
 *
 * Returns: whether a file was being written
 */
gboolean
cloth_parts_has_unfinished (const ClothParts * parts)
{
  g_autoptr (GPtrArray) names = cloth_parts_list_names (parts, NULL, NULL);

  for (guint i = 0; names && i < names->len; i++)
    if (!cloth_parts_is_own (names->pdata[i]))
      return TRUE;
  return FALSE;
}

/* Frames behind one that is not whole would be lost with it. */
static gboolean
check_last (const ClothParts * parts, const gchar * stem, guint64 number,
    const gchar * ending, GError ** error)
{
  g_autofree gchar *broken = cloth_parts_number (stem, number, ending);

  for (guint64 i = number + 1;; i++) {
    g_autofree gchar *name = cloth_parts_number (stem, i, ending);
    g_autofree gchar *path = cloth_parts_inside (parts, "new", name);
    GStatBuf info;

    if (g_lstat (path, &info) < 0)
      return TRUE;
    if (S_ISREG (info.st_mode) && info.st_size > 0)
      return cloth_file_invalid (error,
          "%s is not whole, but %s is: put the frame before it in the place of "
          "the broken one, or remove it with all later ones, and call again",
          broken, name);
  }
}

/* @parts: parts
 * @stem: what the names begin with, without the folder
 * @ending: what the names end with
 * @n: (out): how many numbered files, from 0 on, are whole. One without a byte is not: so
 *   they look when the computer lost its power
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when that can be told
 */
gboolean
cloth_parts_count_numbered (const ClothParts * parts, const gchar * stem,
    const gchar * ending, guint64 * n, GError ** error)
{
  for (*n = 0;; (*n)++) {
    g_autofree gchar *name = cloth_parts_number (stem, *n, ending);
    g_autofree gchar *path = cloth_parts_inside (parts, "new", name);
    GStatBuf info;
    const gboolean there = g_lstat (path, &info) == 0;

    if (!there && errno == ENOENT)
      return TRUE;
    if (!there)
      return cloth_file_fail (error, errno, "read", path);
    if (!S_ISREG (info.st_mode) || info.st_size == 0)
      return check_last (parts, stem, *n, ending, error);
  }
}

/* @parts: parts
 * @stem: what the names begin with, without the folder
 * @first: the first number that is not kept
 * @ending: what the names end with
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when no such file is left
 */
gboolean
cloth_parts_drop_numbered (ClothParts * parts, const gchar * stem,
    guint64 first, const gchar * ending, GError ** error)
{
  for (;; first++) {
    g_autofree gchar *name = cloth_parts_number (stem, first, ending);
    g_autofree gchar *path = cloth_parts_inside (parts, "new", name);

    const gboolean removed = g_unlink (path) == 0;

    if (!removed && errno == ENOENT)
      return TRUE;
    if (!removed)
      return cloth_file_fail (error, errno, "remove", path);
  }
}

/* @parts: parts that were reopened
 * @name: of one of its files
 * @size: how much of it is kept
 * @error: #GIOErrorEnum
 *
 * Returns: (transfer full): the file, to be gone on with, or %NULL
 */
ClothOutput *
cloth_parts_continue (ClothParts * parts, const gchar * name, guint64 size,
    GError ** error)
{
  g_autofree gchar *part = cloth_parts_inside (parts, name, NULL);
  g_autofree gchar *whole = cloth_parts_inside (parts, "new", name);
  g_autofree gchar *path = cloth_parts_target (parts, name);

  if (cloth_is_there (whole) && !cloth_parts_move (whole, part, path, error))
    return NULL;
  return cloth_output_continue (part, whole, path, size, error);
}

/* @parts: parts
 * @name: of a file that is not kept
 */
void
cloth_parts_drop (ClothParts * parts, const gchar * name)
{
  g_autofree gchar *path = cloth_parts_get_path (parts, name);

  g_unlink (path);
}
