/* Files that get their names together, and what a killed program left of them.
 *
 * The hidden folder `.HEAD.part-XXXXXX` stands beside the files that shall be:
 *
 * - `recording` is locked for as long as the writer lives; its lines are MAGIC, a note, and
 *   FRAME once there is something to recover
 * - files that are not whole yet
 * - `new` has those that are whole
 * - `old` is there while a commit goes on: what had the names before
 * - `placing` is what `new` is called when all old ones are away
 *
 * So a program that is killed leaves one of three things. Without `old` and `placing` the
 * old files are untouched. With `old` alone these are put back. With `placing` the rest of
 * the new ones is placed. A reader that looks for `old` and `placing` never takes files of
 * two commits for one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/parts-private.h"

#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

gchar *
cloth_parts_inside (const ClothParts * parts, const gchar * sub,
    const gchar * name)
{
  return g_build_filename (parts->path, sub, name, NULL);
}

gchar *
cloth_parts_target (const ClothParts * parts, const gchar * name)
{
  return g_build_filename (parts->folder, name, NULL);
}

/* What can't be looked at may be there: nothing is removed or replaced for that. */
static gboolean
is_missing (gint code)
{
  return code == ENOENT || code == ENOTDIR;
}

/* Links are not followed: what nobody vouches for must not lead elsewhere. */
gboolean
cloth_is_folder (const gchar * path)
{
  GStatBuf info;

  if (g_lstat (path, &info) < 0)
    return !is_missing (errno);
  return S_ISDIR (info.st_mode);
}

gboolean
cloth_parts_has_folder (const ClothParts * parts, const gchar * sub)
{
  g_autofree gchar *path = cloth_parts_inside (parts, sub, NULL);

  return cloth_is_folder (path);
}

gboolean
cloth_is_there (const gchar * path)
{
  GStatBuf info;

  return g_lstat (path, &info) == 0 || !is_missing (errno);
}

static gint
compare_names (gconstpointer a, gconstpointer b)
{
  const gchar *one = *(const gchar * const *) a;
  const gchar *other = *(const gchar * const *) b;

  /* Numbers of more digits come later. */
  if (strlen (one) != strlen (other))
    return strlen (one) < strlen (other) ? -1 : 1;
  return strcmp (one, other);
}

/* The names in a sub-folder, sorted, but the head last. */
GPtrArray *
cloth_parts_list_names (const ClothParts * parts, const gchar * sub,
    GError ** error)
{
  g_autofree gchar *path = cloth_parts_inside (parts, sub, NULL);
  g_autoptr (GPtrArray) names = g_ptr_array_new_with_free_func (g_free);
  GDir *dir = g_dir_open (path, 0, error);
  const gchar *name;
  gboolean has_head = FALSE;

  if (!dir)
    return NULL;
  while ((name = g_dir_read_name (dir))) {
    if (g_str_equal (name, parts->head))
      has_head = TRUE;
    else
      g_ptr_array_add (names, g_strdup (name));
  }
  g_dir_close (dir);
  g_ptr_array_sort (names, compare_names);
  if (has_head)
    g_ptr_array_add (names, g_strdup (parts->head));
  return g_steal_pointer (&names);
}

gboolean
cloth_parts_is_own (const gchar * name)
{
  return g_str_equal (name, CLOTH_PARTS_LOCK) || g_str_equal (name, "new");
}

/* Removes the files of a folder, the lock last: what stays can be told from others' files. */
static gboolean
empty_folder (const gchar * path)
{
  g_autofree gchar *lock = g_build_filename (path, CLOTH_PARTS_LOCK, NULL);
  GDir *dir = cloth_is_folder (path) ? g_dir_open (path, 0, NULL) : NULL;
  gboolean empty = dir != NULL;
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *file = g_build_filename (path, name, NULL);

    if (!g_str_equal (name, CLOTH_PARTS_LOCK) && g_unlink (file) < 0)
      empty = FALSE;
  }
  g_clear_pointer (&dir, g_dir_close);
  return empty && (g_unlink (lock) == 0 || errno == ENOENT);
}

/* `placing` goes after `old`: alone, the old ones would be put back over the new. */
static gboolean
remove_subs (const gchar * path)
{
  static const gchar *const subs[] = { "old", "placing", "new" };

  for (guint i = 0; i < G_N_ELEMENTS (subs); i++) {
    g_autofree gchar *sub = g_build_filename (path, subs[i], NULL);

    if (!(empty_folder (sub) && g_rmdir (sub) == 0) && cloth_is_folder (sub))
      return FALSE;
  }
  return TRUE;
}

/* @lock: of the folder, which is closed: some file systems keep a file that is open under
 *   another name. −1: none
 */
gboolean
cloth_remove_parts (const gchar * path, gint lock)
{
  const gboolean empty = remove_subs (path) && empty_folder (path);

  if (lock >= 0)
    close (lock);
  return empty && g_rmdir (path) == 0;
}

ClothParts *
cloth_parts_wrap (const gchar * path, const gchar * head, gint lock)
{
  ClothParts *parts = g_new0 (ClothParts, 1);

  parts->folder = g_path_get_dirname (path);
  parts->head = g_strdup (head);
  parts->path = g_strdup (path);
  parts->lock = lock;
  parts->replaced = g_ptr_array_new_with_free_func (g_free);
  return parts;
}

/* @parts: the parts
 * @error: #GIOErrorEnum
 *
 * Notes that there is something to recover: from now on it outlives the program, and
 * cloth_parts_leave().
 *
 * Returns: %TRUE when it is noted
 */
gboolean
cloth_parts_note_frame (ClothParts * parts, GError ** error)
{
  const gint code = parts->has_frame ? 0 :
      cloth_file_append (parts->lock, CLOTH_PARTS_FRAME,
      strlen (CLOTH_PARTS_FRAME));

  if (code)
    return cloth_file_fail (error, code, "write", parts->path);
  parts->has_frame = TRUE;
  return TRUE;
}

/* @parts: parts that could not be committed
 *
 * When they are freed their files stay, to be recovered, if that is worth it.
 *
 * Returns: whether it is
 */
gboolean
cloth_parts_leave (ClothParts * parts)
{
  parts->keep |= parts->has_frame;
  return parts->keep;
}

/* Files that belong together are in one folder. */
gboolean
cloth_parts_check_target (const gchar * path, GError ** error)
{
  g_autofree gchar *shown = NULL;
  GStatBuf info;

  if (g_lstat (path, &info) < 0 || !S_ISLNK (info.st_mode))
    return cloth_file_check_target (path, error);
  shown = g_filename_display_name (path);
  g_set_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE,
      "“%s” is a link: name the file that it leads to, or remove it",
      shown);
  return FALSE;
}

static ClothOutput *
open_part (ClothParts * parts, const gchar * name, gboolean sync,
    GError ** error)
{
  g_autofree gchar *part = cloth_parts_inside (parts, name, NULL);
  g_autofree gchar *whole = cloth_parts_inside (parts, "new", name);
  g_autofree gchar *path = cloth_parts_target (parts, name);

  return cloth_parts_check_target (path, error) ?
      cloth_output_new_at (part, whole, path, sync, error) : NULL;
}

/* @parts: the parts
 * @name: of the file, without its folder
 * @error: #GIOErrorEnum
 *
 * Returns: (transfer full): a file; by its commit it becomes one of those that get their
 *   names. Or %NULL
 */
ClothOutput *
cloth_parts_open (ClothParts * parts, const gchar * name, GError ** error)
{
  return open_part (parts, name, TRUE, error);
}

gchar *
cloth_parts_number (const gchar * stem, guint64 number, const gchar * ending)
{
  return g_strdup_printf ("%s_%05" G_GUINT64_FORMAT "%s", stem, number, ending);
}

/* @parts: the parts
 * @stem: what the name begins with, without its folder
 * @number: of the file
 * @ending: what the name ends with, with its point
 * @error: #GIOErrorEnum
 *
 * Returns: (transfer full): `stem_00000.ending` and so on, one of so many that they go to
 *   the disk all at once. Or %NULL
 */
ClothOutput *
cloth_parts_open_numbered (ClothParts * parts, const gchar * stem,
    guint64 number, const gchar * ending, GError ** error)
{
  g_autofree gchar *name = cloth_parts_number (stem, number, ending);

  parts->unsynced = TRUE;
  return open_part (parts, name, FALSE, error);
}

/* @parts: the parts
 * @name: of a file that is not written. One of an earlier commit would be read with the
 *   others: it goes
 */
void
cloth_parts_replace (ClothParts * parts, const gchar * name)
{
  g_ptr_array_add (parts->replaced, g_strdup (name));
}

/* @parts: the parts
 * @stem: what the names begin with, without the folder
 * @first: the first number that is not written
 * @ending: what the names end with
 * @error: #GIOErrorEnum
 *
 * The rest of a longer sequence of this name goes.
 *
 * Returns: %TRUE when it is known
 */
gboolean
cloth_parts_replace_numbered (ClothParts * parts, const gchar * stem,
    guint64 first, const gchar * ending, GError ** error)
{
  for (;; first++) {
    g_autofree gchar *name = cloth_parts_number (stem, first, ending);
    g_autofree gchar *path = cloth_parts_target (parts, name);
    GStatBuf info;
    const gboolean there = g_lstat (path, &info) == 0;

    if (!there && is_missing (errno))
      return TRUE;
    if (!there)
      return cloth_file_fail (error, errno, "read", path);
    cloth_parts_replace (parts, name);
  }
}

/* @parts: (transfer full) (nullable): parts
 *
 * Frees them. Files that were not committed are removed; those of parts that were
 * reopened stay.
 */
void
cloth_parts_free (ClothParts * parts)
{
  if (!parts)
    return;
  if (!parts->keep)
    cloth_remove_parts (parts->path, parts->lock);
  else if (parts->lock >= 0)
    close (parts->lock);
  g_ptr_array_unref (parts->replaced);
  g_free (parts->folder);
  g_free (parts->head);
  g_free (parts->path);
  g_free (parts->note);
  g_free (parts);
}
