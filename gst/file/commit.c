/* Parts are begun, and get their names, all or none.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/parts-private.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Two seconds or so, in which any other commit has ended. */
#define MOST_WAITS 200
#define LONGEST_WAIT_US 20000

/* Makes the hidden folder with its lock. 0, or what the system says. ENOENT, EWOULDBLOCK: a
 * cleaner was quicker. */
static gint
make_folder (const gchar * path, const gchar * head, const gchar * note,
    ClothParts ** made)
{
  g_autofree gchar *text = g_strconcat (CLOTH_PARTS_MAGIC, note, "\n", NULL);
  g_autofree gchar *template = g_strdup (path);
  g_autofree gchar *lock = NULL, *whole = NULL;
  gint fd, code;

  if (!g_mkdtemp_full (template, 0777))
    return errno;
  lock = g_build_filename (template, CLOTH_PARTS_LOCK, NULL);
  whole = g_build_filename (template, "new", NULL);
  do
    fd = g_open (lock, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
  while (fd < 0 && errno == EINTR);
  code = fd < 0 ? errno : cloth_file_lock_new (fd);
  if (!code)
    code = cloth_file_append (fd, text, strlen (text));
  if (!code && g_mkdir (whole, 0777) < 0)
    code = errno;
  if (code)
    cloth_remove_parts (template, fd);
  else
    *made = cloth_parts_wrap (template, head, fd);
  return code;
}

/* @head: the file that readers open first; its folder must exist. Or, of numbered files,
 *   their stem with the ending
 * @note: what is to be known for going on after a kill; at most 63 bytes
 * @error: #GIOErrorEnum; %CLOTH_FILE_ERROR_INVALID: another program was killed while its
 *   files got these names
 *
 * Starts files that get their names together.
 *
 * Returns: (transfer full): the parts, or %NULL
 */
ClothParts *
cloth_parts_new (const gchar * head, const gchar * note, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (head);
  g_autofree gchar *base = g_path_get_basename (head);
  g_autofree gchar *hidden = g_strconcat (".", base, CLOTH_PART_MARK, NULL);
  g_autofree gchar *path = g_build_filename (folder, hidden, NULL);
  ClothParts *parts = NULL;
  gint code = 0;

  if (!cloth_parts_check_ended (folder, base, error))
    return NULL;
  for (guint i = 0; i < CLOTH_MOST_TRIES; i++) {
    code = make_folder (path, base, note, &parts);
    /* Without its parent, no folder can be made however often. */
    if (!code || (code != EWOULDBLOCK && (code != ENOENT
                || !cloth_is_folder (folder))))
      break;
  }
  /* The hidden name is some bytes longer than the file's. */
  if (code)
    cloth_file_fail (error, code, "write",
        code == ENAMETOOLONG ? head : folder);
  return parts;
}

/* All files of a folder to the disk at once, where the system can. */
static gboolean
sync_files (const gchar * folder, GError ** error)
{
#ifdef __linux__
  gint fd, failed = -1, code;

  do
    fd = g_open (folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0);
  while (fd < 0 && errno == EINTR);
  do
    failed = fd < 0 ? -1 : syncfs (fd);
  while (fd >= 0 && failed && errno == EINTR);
  code = errno;
  if (fd >= 0)
    close (fd);
  if (failed)
    return cloth_file_fail (error, code, "write", folder);
  return TRUE;
#else
  sync ();
  return TRUE;
#endif
}

gboolean
cloth_parts_move (const gchar * from, const gchar * to, const gchar * shown,
    GError ** error)
{
  const gint code = cloth_file_rename (from, to);

  if (code)
    return cloth_file_fail (error, code, "write", shown);
  return TRUE;
}

static gboolean
move_away (const ClothParts * parts, const gchar * name, GError ** error)
{
  g_autofree gchar *from = cloth_parts_target (parts, name);
  g_autofree gchar *to = cloth_parts_inside (parts, "old", name);
  gint code;

  if (!cloth_parts_check_target (from, error))
    return FALSE;
  code = cloth_file_rename (from, to);
  if (code && code != ENOENT)
    return cloth_file_fail (error, code, "write", from);
  return TRUE;
}

/* Whether nothing is where these shall be, but for what is the parts' own. */
static gboolean
check_free (const ClothParts * parts, const GPtrArray * names, GError ** error)
{
  for (guint i = 0; i < names->len; i++) {
    g_autofree gchar *path = cloth_parts_target (parts, names->pdata[i]);
    g_autofree gchar *shown = g_filename_display_name (path);

    if (cloth_parts_is_own (names->pdata[i]) || !cloth_is_there (path))
      continue;
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS,
        "“%s” is there and would be overwritten", shown);
    return FALSE;
  }
  return TRUE;
}

/* Whether another program is giving its files these names. */
static gboolean
is_another_committing (const ClothParts * parts)
{
  g_autoptr (GPtrArray) found = cloth_parts_find (parts->folder, parts->head,
      NULL);

  for (guint i = 0; found && i < found->len; i++)
    if (!g_str_equal (found->pdata[i], parts->path) &&
        cloth_parts_is_committing (found->pdata[i]))
      return TRUE;
  return FALSE;
}

/* Makes `old`. Of two programs each has made its own before it looks for the other's: at
 * most one goes on, the other one waits. */
static gboolean
begin (const ClothParts * parts, GError ** error)
{
  g_autofree gchar *old = cloth_parts_inside (parts, "old", NULL);

  for (guint i = 0; i < MOST_WAITS; i++) {
    if (g_mkdir (old, 0777) < 0)
      return cloth_file_fail (error, errno, "write", old);
    if (!is_another_committing (parts))
      return TRUE;
    g_rmdir (old);
    if (!cloth_parts_check_ended (parts->folder, parts->head, error))
      return FALSE;
    g_usleep (g_random_int_range (1000, LONGEST_WAIT_US));
  }
  g_set_error (error, G_IO_ERROR, G_IO_ERROR_BUSY,
      "another program is giving its files the name “%s”, or was killed "
      "doing so: then “gst-cloth-take-1.0 recover” ends that first",
      parts->head);
  return FALSE;
}

/* What was free when the parts were reopened may be taken by now. From here on no other
 * program takes it. */
static gboolean
check_still_free (const ClothParts * parts, const GPtrArray * names,
    GError ** error)
{
  return !parts->reopened || parts->overwrite ||
      (check_free (parts, names, error) && check_free (parts, parts->replaced,
          error));
}

/* The head goes first: without it readers find nothing. Of numbered files the last ones
 * go first: what a reader then finds is a beginning. */
static gboolean
move_all_away (const ClothParts * parts, const GPtrArray * names,
    GError ** error)
{
  if (!begin (parts, error) || !check_still_free (parts, names, error) ||
      !cloth_folder_sync (parts->path, error))
    return FALSE;
  for (guint i = names->len; i-- > 0;) {
    if (!move_away (parts, names->pdata[i], error))
      return FALSE;
    for (guint k = parts->replaced->len; i + 1 == names->len && k-- > 0;)
      if (!move_away (parts, parts->replaced->pdata[k], error))
        return FALSE;
  }
  return cloth_folder_sync (parts->folder, error);
}

static gboolean
place (const ClothParts * parts, const GPtrArray * names, GError ** error)
{
  for (guint i = 0; i < names->len; i++) {
    g_autofree gchar *from =
        cloth_parts_inside (parts, "placing", names->pdata[i]);
    g_autofree gchar *to = cloth_parts_target (parts, names->pdata[i]);

    if ((i > 0 && i + 1 == names->len &&
            !cloth_folder_sync (parts->folder, error)) ||
        !cloth_parts_move (from, to, to, error))
      return FALSE;
  }
  return cloth_folder_sync (parts->folder, error);
}

static gboolean
begin_placing (const ClothParts * parts, GError ** error)
{
  g_autofree gchar *whole = cloth_parts_inside (parts, "new", NULL);
  g_autofree gchar *placing = cloth_parts_inside (parts, "placing", NULL);

  return cloth_parts_move (whole, placing, parts->folder, error) &&
      cloth_folder_sync (parts->path, error);
}

static gboolean
put_back (const ClothParts * parts, GError ** error)
{
  g_autofree gchar *old = cloth_parts_inside (parts, "old", NULL);
  g_autoptr (GPtrArray) names = cloth_parts_list_names (parts, "old", error);

  for (guint i = 0; names && i < names->len; i++) {
    g_autofree gchar *from = cloth_parts_inside (parts, "old", names->pdata[i]);
    g_autofree gchar *to = cloth_parts_target (parts, names->pdata[i]);

    if (!cloth_parts_move (from, to, to, error))
      return FALSE;
  }
  if (!names || !cloth_folder_sync (parts->folder, error))
    return FALSE;
  if (g_rmdir (old) < 0)
    return cloth_file_fail (error, errno, "write", old);
  return TRUE;
}

/* As it was before the commit, as far as that can be had. */
static gboolean
roll_back (const ClothParts * parts, const GPtrArray * names)
{
  g_autofree gchar *placing = cloth_parts_inside (parts, "placing", NULL);
  g_autofree gchar *whole = cloth_parts_inside (parts, "new", NULL);

  if (cloth_is_folder (placing)) {
    for (guint i = names->len; i-- > 0;) {
      g_autofree gchar *from = cloth_parts_target (parts, names->pdata[i]);
      g_autofree gchar *to =
          cloth_parts_inside (parts, "placing", names->pdata[i]);

      if (!cloth_is_there (to) && cloth_file_rename (from, to))
        return FALSE;
    }
    if (cloth_file_rename (placing, whole))
      return FALSE;
  }
  return !cloth_parts_has_folder (parts, "old") || put_back (parts, NULL);
}

/* What others, who are gone, left of files of these names goes if nothing can be recovered
 * of it. */
static void
clear_older (const ClothParts * parts)
{
  g_autoptr (GPtrArray) found = cloth_parts_find (parts->folder, parts->head,
      NULL);

  for (guint i = 0; found && i < found->len; i++) {
    const gchar *path = found->pdata[i];
    gint fd = cloth_parts_open_lock (path);
    gboolean has_frame;

    if (fd < 0)
      continue;
    /* One's own may be without a lock, where the system has none. */
    if (!g_str_equal (path, parts->path) && !cloth_parts_is_foreign (path) &&
        !cloth_file_lock_old (fd) && cloth_parts_read_lock (fd, NULL,
            &has_frame) && !has_frame)
      cloth_remove_parts (path, fd);
    else
      close (fd);
  }
}

/* What is left of a commit. Readers wait until it is gone, but for the last two names. */
gboolean
cloth_parts_remove (ClothParts * parts, GError ** error)
{
  const gboolean removed = cloth_remove_parts (parts->path, parts->lock)
      || !cloth_parts_is_committing (parts->path);
  g_autofree gchar *shown = g_filename_display_name (parts->path);

  parts->lock = -1;
  parts->keep = TRUE;
  parts->has_frame = FALSE;
  if (!removed)
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED,
        "all files are in place, but readers will not take them until “%s” "
        "is removed, which can't be done", shown);
  return removed;
}

/* @parts: parts whose files were all committed
 * @error: #GIOErrorEnum
 *
 * Gives the files their names, the head last, in place of earlier ones. What another
 * program left of such files when it was killed goes if nothing can be recovered of it,
 * unless these are such themselves. When a file can't get its name, all earlier ones have
 * theirs again.
 *
 * Returns: %TRUE when all have their names
 */
gboolean
cloth_parts_commit (ClothParts * parts, GError ** error)
{
  g_autofree gchar *whole = cloth_parts_inside (parts, "new", NULL);
  g_autoptr (GPtrArray) names = cloth_parts_list_names (parts, "new", error);

  if (!names || (parts->unsynced && !sync_files (whole, error)) ||
      !cloth_folder_sync (whole, error))
    return FALSE;
  if (!move_all_away (parts, names, error) || !begin_placing (parts, error) ||
      !place (parts, names, error)) {
    if (!roll_back (parts, names)) {
      parts->keep = TRUE;
      g_prefix_error (error,
          "some files have their names and others not, which "
          "“gst-cloth-take-1.0 recover” ends: ");
    }
    return FALSE;
  }
  if (!parts->reopened)
    clear_older (parts);
  return cloth_parts_remove (parts, error);
}

/* None of the files, whole or not, has got its name meanwhile. */
static gboolean
check_all_free (const ClothParts * parts, GError ** error)
{
  static const gchar *const subs[] = { "new", "." };

  for (guint i = 0; i < G_N_ELEMENTS (subs); i++) {
    g_autoptr (GPtrArray) names = NULL;

    if (!cloth_parts_has_folder (parts, subs[i]))
      continue;
    names = cloth_parts_list_names (parts, subs[i], error);
    if (!names || !check_free (parts, names, error))
      return FALSE;
  }
  return TRUE;
}

/* Ends or undoes a commit that was cut off. */
gboolean
cloth_parts_resume (ClothParts * parts, gboolean overwrite,
    ClothRemains * remains, GError ** error)
{
  const gboolean placing = cloth_parts_has_folder (parts, "placing");
  g_autoptr (GPtrArray) names = NULL;

  *remains = parts->lock >= 0 && cloth_parts_has_folder (parts, "new") ?
      CLOTH_REMAINS_UNFINISHED : CLOTH_REMAINS_NOTHING;
  if (!placing && !cloth_parts_has_folder (parts, "old"))
    return overwrite || check_all_free (parts, error);
  names = cloth_parts_list_names (parts, placing ? "placing" : "old", error);
  if (names && (placing || names->len > 0) && is_another_committing (parts)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_BUSY,
        "another program is giving its files the same names, or was killed "
        "doing so");
    return FALSE;
  }
  if (!names || (!overwrite && !check_free (parts, names, error)))
    return FALSE;
  if (!placing)
    return put_back (parts, error) &&
        (overwrite || check_all_free (parts, error));
  if (!place (parts, names, error))
    return FALSE;
  *remains = CLOTH_REMAINS_PLACED;
  return cloth_parts_remove (parts, error);
}
