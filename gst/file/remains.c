/* What programs that are gone left of parts.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/parts-private.h"

#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

gint
cloth_parts_open_lock (const gchar * path)
{
  g_autofree gchar *lock = g_build_filename (path, CLOTH_PARTS_LOCK, NULL);
  gint fd;

  do
    fd = g_open (cloth_is_folder (path) ? lock : path,
        O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0);
  while (fd < 0 && errno == EINTR);
  return fd;
}

/* @fd: of `recording`
 * @note: (out) (nullable) (transfer full): what the writer noted
 * @has_frame: (out): whether there is something to recover
 *
 * Returns: %FALSE when its head is not what a writer of parts writes
 */
gboolean
cloth_parts_read_lock (gint fd, gchar ** note, gboolean * has_frame)
{
  gchar text[sizeof CLOTH_PARTS_MAGIC + CLOTH_PARTS_MAX_NOTE +
      sizeof CLOTH_PARTS_FRAME] = "";
  g_auto (GStrv) lines = NULL;
  gssize n;

  do
    n = pread (fd, text, sizeof text - 1, 0);
  while (n < 0 && errno == EINTR);
  *has_frame = FALSE;
  if (n < 0 || !g_str_has_prefix (text, CLOTH_PARTS_MAGIC))
    return FALSE;
  lines = g_strsplit (text, "\n", -1);
  *has_frame = g_strv_length (lines) > 3;
  if (note)
    *note = g_strdup (g_strv_length (lines) > 2 ? lines[1] : "");
  return TRUE;
}

gboolean
cloth_parts_is_committing (const gchar * path)
{
  g_autofree gchar *folder = g_path_get_dirname (path);
  g_autofree gchar *old = g_build_filename (path, "old", NULL);
  g_autofree gchar *placing = g_build_filename (path, "placing", NULL);
  GStatBuf info = { 0 };

  /* Where nobody may replace another's files, as in /tmp, nobody shall be hindered either. */
  g_stat (folder, &info);
  if ((info.st_mode & S_ISVTX) && cloth_parts_is_foreign (path))
    return FALSE;
  return cloth_is_folder (old) || cloth_is_folder (placing);
}

/* @path: one that cloth_parts_find() found
 *
 * Returns: whether it is another user's
 */
gboolean
cloth_parts_is_foreign (const gchar * path)
{
  GStatBuf info;

  return g_lstat (path, &info) == 0 && info.st_uid != geteuid ();
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

static gint64
changed_ns (const GStatBuf * info)
{
  return (gint64) info->st_mtim.tv_sec * G_GINT64_CONSTANT (1000000000) +
      info->st_mtim.tv_nsec;
}

/* When a file, or one in a folder, was written to last. What vanishes meanwhile is the
 * oldest. */
static gint64
last_change (const gchar * path, gboolean deeper)
{
  GDir *dir = deeper ? g_dir_open (path, 0, NULL) : NULL;
  const gchar *name;
  GStatBuf info;
  gint64 last_ns = g_lstat (path, &info) == 0 ? changed_ns (&info) : 0;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *file = g_build_filename (path, name, NULL);

    last_ns = MAX (last_ns, last_change (file, FALSE));
  }
  g_clear_pointer (&dir, g_dir_close);
  return last_ns;
}

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
 * Finds parts, whether their writers live or not, and whose ever they are.
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
    Found item;

    if (!base || (head && !g_str_equal (base, head)))
      continue;
    item.path = g_build_filename (folder, name, NULL);
    /* Links lead elsewhere, and files are of one write each. */
    if (!cloth_is_folder (item.path)) {
      g_free (item.path);
      continue;
    }
    item.changed_ns = last_change (item.path, TRUE);
    g_array_append_val (found, item);
  }
  g_dir_close (dir);
  g_array_sort (found, compare_ages);
  paths = g_ptr_array_new_with_free_func (g_free);
  for (guint i = 0; i < found->len; i++)
    g_ptr_array_add (paths, g_array_index (found, Found, i).path);
  return paths;
}

/* @head: a file that readers open first
 * @error: #GFileError
 *
 * Returns: (transfer full) (element-type filename) (nullable): as cloth_parts_find()
 */
GPtrArray *
cloth_parts_find_for (const gchar * head, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (head);
  g_autofree gchar *base = g_path_get_basename (head);

  return cloth_parts_find (folder, base, error);
}

/* @path: one that cloth_parts_find() found
 *
 * Returns: whether its writer is gone
 */
gboolean
cloth_parts_is_dead (const gchar * path)
{
  gint fd = cloth_parts_open_lock (path);
  gboolean dead = fd >= 0 && !cloth_file_lock_old (fd);

  if (fd >= 0)
    close (fd);
  return dead;
}

/* @path: one that cloth_parts_find() found
 *
 * Returns: whether there is something to recover
 */
gboolean
cloth_parts_has_frame (const gchar * path)
{
  gint fd = cloth_parts_open_lock (path);
  gboolean has_frame = FALSE;

  if (fd >= 0) {
    cloth_parts_read_lock (fd, NULL, &has_frame);
    close (fd);
  }
  return has_frame;
}

/* @folder: where files shall be
 * @head: the one that readers open first
 * @error: %CLOTH_FILE_ERROR_INVALID
 *
 * Returns: %FALSE when a program was killed while its files got these names: what it had
 *   placed must not be mixed with others
 */
gboolean
cloth_parts_check_ended (const gchar * folder, const gchar * head,
    GError ** error)
{
  g_autoptr (GPtrArray) found = cloth_parts_find (folder, head, NULL);

  for (guint i = 0; found && i < found->len; i++)
    if (cloth_parts_is_committing (found->pdata[i]) &&
        cloth_parts_is_dead (found->pdata[i]))
      return cloth_file_invalid (error,
          "a program was killed while its files got the name “%s”: "
          "“gst-cloth-take-1.0 recover” ends that first", head);
  return TRUE;
}

/* @path: a file that others may replace
 *
 * Returns: what is there; of nothing, zeros
 */
ClothPlaced
cloth_parts_look_at (const gchar * path)
{
  GStatBuf info;
  ClothPlaced placed = { 0 };

  if (g_stat (path, &info) == 0) {
    placed.device = info.st_dev;
    placed.inode = info.st_ino;
    placed.changed_ns = changed_ns (&info);
  }
  return placed;
}

/* @head: what a reader opens first
 * @placed: (out): for cloth_parts_end_reading()
 * @error: %CLOTH_FILE_ERROR_INVALID
 *
 * Returns: %FALSE when a writer that lives, or one that was killed, may have given some of
 *   its files their names and others not
 */
gboolean
cloth_parts_begin_reading (const gchar * head, ClothPlaced * placed,
    GError ** error)
{
  g_autoptr (GPtrArray) found = NULL;

  *placed = cloth_parts_look_at (head);
  found = cloth_parts_find_for (head, NULL);
  for (guint i = 0; found && i < found->len; i++) {
    g_autofree gchar *shown = g_filename_display_name (head);

    if (cloth_parts_is_committing (found->pdata[i]))
      return cloth_file_invalid (error,
          "only a part of what belongs to “%s” is "
          "in place: a program is just writing it, or was killed; for the latter "
          "there is “gst-cloth-take-1.0 recover”", shown);
  }
  return TRUE;
}

/* @path: a file that others may replace
 * @placed: what cloth_parts_look_at() saw
 * @error: %CLOTH_FILE_ERROR_INVALID
 *
 * Returns: whether it is still that
 */
gboolean
cloth_parts_check_same (const gchar * path, const ClothPlaced * placed,
    GError ** error)
{
  const ClothPlaced now = cloth_parts_look_at (path);
  g_autofree gchar *shown = g_filename_display_name (path);

  if (memcmp (&now, placed, sizeof now) == 0)
    return TRUE;
  return cloth_file_invalid (error,
      "“%s” was replaced while it was read: try again", shown);
}

/* @head: what a reader opened first, before its other files
 * @placed: what cloth_parts_begin_reading() saw
 * @error: %CLOTH_FILE_ERROR_INVALID
 *
 * Returns: %FALSE when not all that was opened meanwhile need be of one commit
 */
gboolean
cloth_parts_end_reading (const gchar * head, const ClothPlaced * placed,
    GError ** error)
{
  ClothPlaced now;

  return cloth_parts_begin_reading (head, &now, error) &&
      cloth_parts_check_same (head, placed, error);
}
