/* Files that get their names together, and what a killed program left of them.
 *
 * The hidden folder `.HEAD.part-XXXXXX` stands beside the files that shall be:
 *
 * - `recording` is locked for as long as the writer lives; a note is in it
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
#include "gst/file/parts.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LOCK "recording"
#define MAX_NOTE 64

struct _ClothParts
{
  gchar *folder;                /* where the files shall be */
  gchar *head;                  /* the file that readers open first */
  gchar *path;                  /* the hidden folder */
  gchar *note;
  gint lock;
  gboolean reopened, overwrite;
  gboolean unsynced;            /* files were not brought to the disk one by one */
  gboolean keep;                /* nothing is to be removed */
  GPtrArray *replaced;          /* names that are not written, but go */
};

static gchar *
inside (const ClothParts * parts, const gchar * sub, const gchar * name)
{
  return g_build_filename (parts->path, sub, name, NULL);
}

static gchar *
target (const ClothParts * parts, const gchar * name)
{
  return g_build_filename (parts->folder, name, NULL);
}

/* Links are not followed: what nobody vouches for must not lead elsewhere. */
static gboolean
is_folder (const gchar * path)
{
  GStatBuf info;

  return g_lstat (path, &info) == 0 && S_ISDIR (info.st_mode);
}

static gboolean
has_folder (const ClothParts * parts, const gchar * sub)
{
  g_autofree gchar *path = inside (parts, sub, NULL);

  return is_folder (path);
}

static gboolean
is_there (const gchar * path)
{
  GStatBuf info;

  return g_lstat (path, &info) == 0;
}

static gint
compare_names (gconstpointer a, gconstpointer b)
{
  return strcmp (*(const gchar * const *) a, *(const gchar * const *) b);
}

/* The names in a sub-folder, sorted, but the head last. */
static GPtrArray *
list_names (const ClothParts * parts, const gchar * sub, GError ** error)
{
  g_autofree gchar *path = inside (parts, sub, NULL);
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

static gboolean
is_own (const gchar * name)
{
  return g_str_equal (name, LOCK) || g_str_equal (name, "new");
}

/* Removes the files of a folder and the folder. */
static gboolean
remove_folder (const gchar * path)
{
  GDir *dir = is_folder (path) ? g_dir_open (path, 0, NULL) : NULL;
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *file = g_build_filename (path, name, NULL);

    g_unlink (file);
  }
  g_clear_pointer (&dir, g_dir_close);
  return g_rmdir (path) == 0;
}

/* `placing` goes after `old`: alone, the old ones would be put back over the new. */
static void
remove_parts (const gchar * path)
{
  static const gchar *const subs[] = { "old", "placing", "new" };

  for (guint i = 0; i < G_N_ELEMENTS (subs); i++) {
    g_autofree gchar *sub = g_build_filename (path, subs[i], NULL);

    if (!remove_folder (sub) && is_folder (sub))
      return;
  }
  remove_folder (path);
}

static ClothParts *
wrap (const gchar * path, const gchar * head, gint lock)
{
  ClothParts *parts = g_new0 (ClothParts, 1);

  parts->folder = g_path_get_dirname (path);
  parts->head = g_strdup (head);
  parts->path = g_strdup (path);
  parts->lock = lock;
  parts->replaced = g_ptr_array_new_with_free_func (g_free);
  return parts;
}

/* Makes the hidden folder with its lock. 1: done; 0: a cleaner was quicker; −1: @error. */
static gint
make_folder (const gchar * path, const gchar * folder, const gchar * head,
    const gchar * note, ClothParts ** made, GError ** error)
{
  g_autofree gchar *template = g_strdup (path);
  g_autofree gchar *lock = NULL, *whole = NULL;
  gint fd, code;

  if (!g_mkdtemp_full (template, 0777)) {
    cloth_file_fail (error, errno, "write", folder);
    return -1;
  }
  lock = g_build_filename (template, LOCK, NULL);
  whole = g_build_filename (template, "new", NULL);
  do
    fd = g_open (lock, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
  while (fd < 0 && errno == EINTR);
  code = fd < 0 ? errno : 0;
  if (code == ENOENT || (fd >= 0 && !cloth_file_lock_new (fd))) {
    remove_folder (template);
    if (fd >= 0)
      close (fd);
    return 0;
  }
  if (fd >= 0)
    code = cloth_file_append (fd, note, strlen (note));
  if (!code && g_mkdir (whole, 0777) < 0)
    code = errno;
  if (code) {
    cloth_file_fail (error, code, "write", folder);
    remove_parts (template);
    if (fd >= 0)
      close (fd);
    return -1;
  }
  *made = wrap (template, head, fd);
  return 1;
}

/* @head: the file that readers open first; its folder must exist. Or, of numbered files,
 *   their stem with the ending
 * @note: what is to be known for going on after a kill; at most 63 bytes
 * @error: #GIOErrorEnum
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

  while (make_folder (path, folder, base, note, &parts, error) == 0);
  return parts;
}

static ClothOutput *
open_part (ClothParts * parts, const gchar * name, gboolean sync,
    GError ** error)
{
  g_autofree gchar *part = inside (parts, name, NULL);
  g_autofree gchar *whole = inside (parts, "new", name);
  g_autofree gchar *path = target (parts, name);

  return cloth_file_check_target (path, error) ?
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

static gchar *
numbered (const gchar * stem, guint64 number, const gchar * ending)
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
  g_autofree gchar *name = numbered (stem, number, ending);

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
 *
 * The rest of a longer sequence of this name goes.
 */
void
cloth_parts_replace_numbered (ClothParts * parts, const gchar * stem,
    guint64 first, const gchar * ending)
{
  for (;; first++) {
    g_autofree gchar *name = numbered (stem, first, ending);
    g_autofree gchar *path = target (parts, name);

    if (!is_there (path))
      return;
    cloth_parts_replace (parts, name);
  }
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

static gboolean
move (const gchar * from, const gchar * to, const gchar * shown,
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
  g_autofree gchar *from = target (parts, name);
  g_autofree gchar *to = inside (parts, "old", name);
  gint code;

  if (!cloth_file_check_target (from, error))
    return FALSE;
  code = cloth_file_rename (from, to);
  if (code && code != ENOENT)
    return cloth_file_fail (error, code, "write", from);
  return TRUE;
}

/* The head goes first: without it readers find nothing. Of numbered files the last ones
 * go first: what a reader then finds is a beginning. */
static gboolean
move_all_away (const ClothParts * parts, const GPtrArray * names,
    GError ** error)
{
  g_autofree gchar *old = inside (parts, "old", NULL);

  if (g_mkdir (old, 0777) < 0)
    return cloth_file_fail (error, errno, "write", old);
  if (!cloth_folder_sync (parts->path, error))
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
    g_autofree gchar *from = inside (parts, "placing", names->pdata[i]);
    g_autofree gchar *to = target (parts, names->pdata[i]);

    if ((i > 0 && i + 1 == names->len &&
            !cloth_folder_sync (parts->folder, error)) ||
        !move (from, to, to, error))
      return FALSE;
  }
  return cloth_folder_sync (parts->folder, error);
}

static gboolean
begin_placing (const ClothParts * parts, GError ** error)
{
  g_autofree gchar *whole = inside (parts, "new", NULL);
  g_autofree gchar *placing = inside (parts, "placing", NULL);

  return move (whole, placing, parts->folder, error) &&
      cloth_folder_sync (parts->path, error);
}

static gboolean
put_back (const ClothParts * parts, GError ** error)
{
  g_autofree gchar *old = inside (parts, "old", NULL);
  g_autoptr (GPtrArray) names = list_names (parts, "old", error);

  for (guint i = 0; names && i < names->len; i++) {
    g_autofree gchar *from = inside (parts, "old", names->pdata[i]);
    g_autofree gchar *to = target (parts, names->pdata[i]);

    if (!move (from, to, to, error))
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
  g_autofree gchar *placing = inside (parts, "placing", NULL);
  g_autofree gchar *whole = inside (parts, "new", NULL);

  if (is_folder (placing)) {
    for (guint i = names->len; i-- > 0;) {
      g_autofree gchar *from = target (parts, names->pdata[i]);
      g_autofree gchar *to = inside (parts, "placing", names->pdata[i]);

      if (!is_there (to) && cloth_file_rename (from, to))
        return FALSE;
    }
    if (cloth_file_rename (placing, whole))
      return FALSE;
  }
  return !has_folder (parts, "old") || put_back (parts, NULL);
}

/* What others, who are gone, left of files of these names is older than these. */
static void
clear_older (const ClothParts * parts)
{
  g_autoptr (GPtrArray) found = cloth_parts_find (parts->folder, parts->head,
      NULL);

  for (guint i = 0; found && i < found->len; i++) {
    g_autofree gchar *lock = g_build_filename (found->pdata[i], LOCK, NULL);
    gint fd = g_open (lock, O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0);

    if (fd >= 0 && cloth_file_lock_old (fd))
      remove_parts (found->pdata[i]);
    if (fd >= 0)
      close (fd);
  }
}

/* Whether nothing is where these shall be, but for what is the parts' own. */
static gboolean
check_free (const ClothParts * parts, const GPtrArray * names, GError ** error)
{
  for (guint i = 0; i < names->len; i++) {
    g_autofree gchar *path = target (parts, names->pdata[i]);
    g_autofree gchar *shown = g_filename_display_name (path);

    if (is_own (names->pdata[i]) || !is_there (path))
      continue;
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS,
        "“%s” is there and would be overwritten", shown);
    return FALSE;
  }
  return TRUE;
}

/* @parts: parts whose files were all committed
 * @error: #GIOErrorEnum
 *
 * Gives the files their names, the head last, in place of earlier ones. What another
 * program left of such files when it was killed goes, unless these are such themselves.
 * When a file can't get its name, all earlier ones have theirs again.
 *
 * Returns: %TRUE when all have their names
 */
gboolean
cloth_parts_commit (ClothParts * parts, GError ** error)
{
  g_autofree gchar *whole = inside (parts, "new", NULL);
  g_autoptr (GPtrArray) names = list_names (parts, "new", error);

  if (!names || (parts->reopened && !parts->overwrite
          && !check_free (parts, parts->replaced, error))
      || (parts->unsynced && !sync_files (whole, error)) ||
      !cloth_folder_sync (whole, error))
    return FALSE;
  if (!move_all_away (parts, names, error) || !begin_placing (parts, error) ||
      !place (parts, names, error)) {
    if (!roll_back (parts, names)) {
      parts->keep = TRUE;
      g_prefix_error (error, "what was there waits in “%s”: ", parts->path);
    }
    return FALSE;
  }
  if (!parts->reopened)
    clear_older (parts);
  /* Readers wait for this. */
  remove_parts (parts->path);
  parts->keep = TRUE;
  return TRUE;
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
    remove_parts (parts->path);
  if (parts->lock >= 0)
    close (parts->lock);
  g_ptr_array_unref (parts->replaced);
  g_free (parts->folder);
  g_free (parts->head);
  g_free (parts->path);
  g_free (parts->note);
  g_free (parts);
}

/* @path: a path
 *
 * Returns: (transfer full) (nullable): the name for which it holds a part, or %NULL when it
 *   is none
 */
gchar *
cloth_parts_get_head (const gchar * path)
{
  g_autofree gchar *base = g_path_get_basename (path);
  const gsize n = strlen (base), mark = strlen (CLOTH_PART_MARK);
  const gsize digits = strlen ("XXXXXX");

  if (*base != '.' || n < mark + 2 ||
      strncmp (base + n - mark, CLOTH_PART_MARK, mark - digits) != 0)
    return NULL;
  return g_strndup (base + 1, n - mark - 1);
}

typedef struct
{
  gchar *path;
  gint64 changed_ns;
} Found;

static gint
compare_ages (gconstpointer a, gconstpointer b)
{
  const Found *one = a, *other = b;

  if (one->changed_ns != other->changed_ns)
    return one->changed_ns < other->changed_ns ? 1 : -1;
  return strcmp (one->path, other->path);
}

/* @folder: where to look
 * @head: (nullable): for what, or all
 * @error: #GFileError
 *
 * Finds parts, whether their writers live or not. A lone file is a part of its own.
 *
 * Returns: (transfer full) (element-type filename) (nullable): their paths, the one that
 *   was written to last first
 */
GPtrArray *
cloth_parts_find (const gchar * folder, const gchar * head, GError ** error)
{
  g_autoptr (GArray) found = g_array_new (FALSE, FALSE, sizeof (Found));
  GPtrArray *paths;
  GDir *dir = g_dir_open (folder, 0, error);
  const gchar *name;

  if (!dir)
    return NULL;
  while ((name = g_dir_read_name (dir))) {
    g_autofree gchar *base = cloth_parts_get_head (name);
    GStatBuf info = { 0 };
    Found item;

    if (!base || (head && !g_str_equal (base, head)))
      continue;
    item.path = g_build_filename (folder, name, NULL);
    /* Links lead elsewhere, and others' files are not ours to end or remove. */
    if (g_lstat (item.path, &info) == 0 && (S_ISLNK (info.st_mode)
            || info.st_uid != geteuid ())) {
      g_free (item.path);
      continue;
    }
    /* One that vanishes meanwhile is the oldest. */
    item.changed_ns = (gint64) info.st_mtim.tv_sec * G_GINT64_CONSTANT
        (1000000000) + info.st_mtim.tv_nsec;
    g_array_append_val (found, item);
  }
  g_dir_close (dir);
  g_array_sort (found, compare_ages);
  paths = g_ptr_array_new_with_free_func (g_free);
  for (guint i = 0; i < found->len; i++)
    g_ptr_array_add (paths, g_array_index (found, Found, i).path);
  return paths;
}

/* @path: one that cloth_parts_find() found
 *
 * Returns: whether its writer is gone
 */
gboolean
cloth_parts_is_dead (const gchar * path)
{
  g_autofree gchar *lock = g_build_filename (path, LOCK, NULL);
  gint fd = g_open (is_folder (path) ? lock : path,
      O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0);
  gboolean dead = fd >= 0 && cloth_file_lock_old (fd);

  if (fd >= 0)
    close (fd);
  return dead;
}

/* @head: what a reader opens first
 * @error: %CLOTH_FILE_ERROR_INVALID
 *
 * Returns: %FALSE when a writer that lives, or one that was killed, may have given some of
 *   its files their names and others not
 */
gboolean
cloth_parts_check_placed (const gchar * head, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (head);
  g_autofree gchar *base = g_path_get_basename (head);
  g_autoptr (GPtrArray) found = cloth_parts_find (folder, base, NULL);

  for (guint i = 0; found && i < found->len; i++) {
    g_autofree gchar *old = g_build_filename (found->pdata[i], "old", NULL);
    g_autofree gchar *placing = g_build_filename (found->pdata[i], "placing",
        NULL);
    g_autofree gchar *shown = g_filename_display_name (head);

    if (is_folder (old) || is_folder (placing))
      return cloth_file_invalid (error,
          "only a part of what belongs to “%s” is "
          "in place: a program is just writing it, or was killed; for the latter "
          "there is “gst-cloth-take-1.0 recover”", shown);
  }
  return TRUE;
}

static gboolean
fail_busy (GError ** error)
{
  g_set_error (error, G_IO_ERROR, G_IO_ERROR_BUSY,
      "it is being written: end that program first");
  return FALSE;
}

/* @path: a lone file that cloth_parts_find() found
 * @error: #GIOErrorEnum; %G_IO_ERROR_BUSY: its writer lives
 *
 * Removes it when its writer is gone.
 *
 * Returns: whether that was so
 */
gboolean
cloth_parts_remove_lone (const gchar * path, GError ** error)
{
  gint fd = g_open (path, O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0);
  gboolean removed;

  if (fd < 0)
    return cloth_file_fail (error, errno, "open", path);
  if (!cloth_file_lock_old (fd))
    removed = fail_busy (error);
  else
    removed = TRUE;
  if (removed && g_unlink (path) < 0)
    removed = cloth_file_fail (error, errno, "remove", path);
  close (fd);
  return removed;
}

/* None of the files, whole or not, has got its name meanwhile. */
static gboolean
check_all_free (const ClothParts * parts, GError ** error)
{
  static const gchar *const subs[] = { "new", "." };

  for (guint i = 0; i < G_N_ELEMENTS (subs); i++) {
    g_autoptr (GPtrArray) names = has_folder (parts, subs[i]) ?
        list_names (parts, subs[i], error) : NULL;

    if (names && !check_free (parts, names, error))
      return FALSE;
  }
  return TRUE;
}

/* Whether there is no file in a folder, nor in those that a part has. */
static gboolean
holds_nothing (const gchar * path)
{
  GDir *dir = is_folder (path) ? g_dir_open (path, 0, NULL) : NULL;
  gboolean nothing = dir != NULL;
  const gchar *name;

  while (nothing && (name = g_dir_read_name (dir))) {
    g_autofree gchar *sub = g_build_filename (path, name, NULL);

    nothing = holds_nothing (sub);
  }
  g_clear_pointer (&dir, g_dir_close);
  return nothing;
}

/* Ends or undoes a commit that was cut off. */
static gboolean
resume (ClothParts * parts, gboolean overwrite, ClothRemains * remains,
    GError ** error)
{
  const gboolean placing = has_folder (parts, "placing");
  g_autoptr (GPtrArray) names = NULL;

  *remains = parts->lock >= 0 && has_folder (parts, "new") ?
      CLOTH_REMAINS_UNFINISHED : CLOTH_REMAINS_NOTHING;
  if (!placing && !has_folder (parts, "old"))
    return overwrite || check_all_free (parts, error);
  names = list_names (parts, placing ? "placing" : "old", error);
  if (!names || (!overwrite && !check_free (parts, names, error)))
    return FALSE;
  if (!placing)
    return put_back (parts, error) &&
        (overwrite || check_all_free (parts, error));
  if (!place (parts, names, error))
    return FALSE;
  *remains = CLOTH_REMAINS_PLACED;
  remove_parts (parts->path);
  return TRUE;
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
  g_autofree gchar *lock = g_build_filename (path, LOCK, NULL);
  g_autofree gchar *head = cloth_parts_get_head (path);
  g_autoptr (ClothParts) parts = NULL;
  gchar note[MAX_NOTE] = "";
  gint fd;

  do
    fd = g_open (lock, O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0);
  while (fd < 0 && errno == EINTR);
  /* Without it the folder may be anybody's, unless nothing is in it. */
  if (fd < 0 && (errno != ENOENT || !holds_nothing (path))) {
    cloth_file_fail (error, errno, "open", lock);
    return NULL;
  }
  if (fd >= 0 && !cloth_file_lock_old (fd)) {
    close (fd);
    fail_busy (error);
    return NULL;
  }
  parts = wrap (path, head, fd);
  parts->reopened = TRUE;
  parts->overwrite = overwrite;
  parts->keep = TRUE;
  while (fd >= 0 && pread (fd, note, sizeof note - 1, 0) < 0 && errno == EINTR);
  parts->note = g_strdup (note);
  if (!resume (parts, overwrite, remains, error))
    return NULL;
  return g_steal_pointer (&parts);
}

/* Returns: bytes of the files that are not whole */
guint64
cloth_parts_count_bytes (const ClothParts * parts)
{
  GDir *dir = g_dir_open (parts->path, 0, NULL);
  const gchar *name;
  guint64 n = 0;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *path = inside (parts, name, NULL);
    GStatBuf info;

    if (g_lstat (path, &info) == 0 && S_ISREG (info.st_mode))
      n += (guint64) info.st_size;
  }
  g_clear_pointer (&dir, g_dir_close);
  return n;
}

/* @parts: parts that were reopened; their files go when they are freed
 */
void
cloth_parts_discard (ClothParts * parts)
{
  parts->keep = FALSE;
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
  g_autofree gchar *whole = inside (parts, "new", name);

  return is_there (whole);
}

/* @parts: parts
 * @name: of one of its files
 *
 * Returns: (transfer full) (type filename): where it lies, be it whole or not
 */
gchar *
cloth_parts_get_path (const ClothParts * parts, const gchar * name)
{
  return cloth_parts_is_whole (parts, name) ? inside (parts, "new", name) :
      inside (parts, name, NULL);
}

/* @parts: parts
 *
 * Returns: whether a file was being written
 */
gboolean
cloth_parts_has_unfinished (const ClothParts * parts)
{
  g_autoptr (GPtrArray) names = list_names (parts, NULL, NULL);

  for (guint i = 0; names && i < names->len; i++)
    if (!is_own (names->pdata[i]))
      return TRUE;
  return FALSE;
}

/* @parts: parts
 * @stem: what the names begin with, without the folder
 * @ending: what the names end with
 *
 * Returns: how many numbered files, from 0 on, are whole
 */
guint64
cloth_parts_count_numbered (const ClothParts * parts, const gchar * stem,
    const gchar * ending)
{
  for (guint64 i = 0;; i++) {
    g_autofree gchar *name = numbered (stem, i, ending);

    if (!cloth_parts_is_whole (parts, name))
      return i;
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
  g_autofree gchar *part = inside (parts, name, NULL);
  g_autofree gchar *whole = inside (parts, "new", name);
  g_autofree gchar *path = target (parts, name);

  if (is_there (whole) && !move (whole, part, path, error))
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
