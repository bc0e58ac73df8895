/* Files that appear whole or not at all.
 *
 * Written by system calls, not by stdio, which gives up when a signal interrupts it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/output.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define OUTPUT_BUFFER (1u << 18)

struct _ClothOutput
{
  gchar *path;
  gchar *temporary;             /* NULL once renamed */
  gchar *shown;                 /* what messages call it */
  gint fd;                      /* -1 once it has its name */
  gboolean alone;               /* its folder is brought to the disk with it */
  gboolean sync;
  gsize used;
  guint8 *buffer;
};

/* @error: (out): set to a #GIOErrorEnum
 * @code: of the system
 * @doing: what can't be done
 * @path: to which file
 *
 * Returns: %FALSE, so that a function may end with it
 */
gboolean
cloth_file_fail (GError ** error, gint code, const gchar * doing,
    const gchar * path)
{
  g_autofree gchar *shown = g_filename_display_name (path);

  g_set_error (error, G_IO_ERROR, g_io_error_from_errno (code),
      "cannot %s “%s”: %s", doing, shown, g_strerror (code));
  return FALSE;
}

/* @folder: a folder
 * @error: #GIOErrorEnum
 *
 * Makes it, and those that it is in, where they are not there yet.
 *
 * Returns: whether it is there
 */
gboolean
cloth_folder_make (const gchar * folder, GError ** error)
{
  return g_mkdir_with_parents (folder, 0777) == 0
      || cloth_file_fail (error, errno, "make the folder", folder);
}

/* @path: what a file shall be called
 * @error: #GIOErrorEnum
 *
 * A rename would replace a device, a pipe or a socket by a file.
 *
 * Returns: whether there is nothing yet, or a regular file
 */
gboolean
cloth_file_check_target (const gchar * path, GError ** error)
{
  g_autofree gchar *shown = NULL;
  GStatBuf info;

  if (g_stat (path, &info) < 0 || S_ISREG (info.st_mode))
    return TRUE;
  if (S_ISDIR (info.st_mode))
    return cloth_file_fail (error, EISDIR, "write", path);
  shown = g_filename_display_name (path);
  g_set_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE,
      "“%s” is a device, a pipe or a socket: name a regular file", shown);
  return FALSE;
}

static gint
lock (gint fd)
{
  struct stat info;
  gint failed;

  do
    failed = flock (fd, LOCK_EX | LOCK_NB);
  while (failed && errno == EINTR);
  if (failed)
    return errno;
  return fstat (fd, &info) == 0 && info.st_nlink == 0 ? ENOENT : 0;
}

/* @fd: a file just made, under a name that nobody knows
 *
 * Locks it for as long as it is open, which tells that its writer lives. Where the system
 * has no locks it stays without; there cloth_file_lock_old() never has one either.
 *
 * Returns: 0, or what the system says: a cleaner was quicker, make another file
 */
gint
cloth_file_lock_new (gint fd)
{
  const gint code = lock (fd);

  return code == EWOULDBLOCK || code == ENOENT ? code : 0;
}

/* @fd: a file that a writer made
 *
 * Returns: 0 when the writer is gone: then the file is locked for as long as it is open.
 *   EWOULDBLOCK: it lives; ENOENT: the file has been removed; others: this can't be told
 */
gint
cloth_file_lock_old (gint fd)
{
  return lock (fd);
}

static gint
sync_fd (gint fd)
{
  gint failed;

  do
    failed = fsync (fd);
  while (failed && errno == EINTR);
  return failed;
}

/* @fd: a file
 * @data: bytes to append
 * @size: how many
 *
 * Returns: 0 when all were taken, or what the system says
 */
gint
cloth_file_append (gint fd, gconstpointer data, gsize size)
{
  const guint8 *from = data;

  while (size > 0) {
    gssize n = write (fd, from, size);

    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0)
      return errno;
    from += n;
    size -= (gsize) n;
  }
  return 0;
}

/* @from: a file or folder
 * @to: its new name, in the same file system
 *
 * Returns: 0 when it is called so, or what the system says
 */
gint
cloth_file_rename (const gchar * from, const gchar * to)
{
  gint failed;

  do
    failed = g_rename (from, to);
  while (failed && errno == EINTR);
  return failed ? errno : 0;
}

/* @folder: a folder
 * @error: #GIOErrorEnum
 *
 * Brings the names in it to the disk. A folder that may not be read, and a file system
 * that can't, are no errors.
 *
 * Returns: %TRUE when they are there
 */
gboolean
cloth_folder_sync (const gchar * folder, GError ** error)
{
  gint fd, code = 0;

  do
    fd = g_open (folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0);
  while (fd < 0 && errno == EINTR);
  if (fd < 0 && errno == EACCES)
    return TRUE;
  if (fd < 0)
    return cloth_file_fail (error, errno, "open", folder);
  if (sync_fd (fd) && errno != EINVAL)
    code = errno;
  close (fd);
  if (code)
    return cloth_file_fail (error, code, "write", folder);
  return TRUE;
}

static ClothOutput *
wrap (gint fd, const gchar * temporary, const gchar * path, const gchar * shown)
{
  ClothOutput *output = g_new0 (ClothOutput, 1);

  output->path = g_strdup (path);
  output->temporary = g_strdup (temporary);
  output->shown = g_strdup (shown);
  output->fd = fd;
  output->sync = TRUE;
  output->buffer = g_malloc (OUTPUT_BUFFER);
  return output;
}

/* A rename would replace a link, not the file that it leads to. */
static gchar *
follow_links (const gchar * path, GError ** error)
{
  GStatBuf info;
  gchar *real, *copy;

  if (g_lstat (path, &info) < 0 || !S_ISLNK (info.st_mode))
    return g_strdup (path);
  real = realpath (path, NULL);
  if (!real) {
    cloth_file_fail (error, errno, "follow the link", path);
    return NULL;
  }
  copy = g_strdup (real);
  free (real);
  return copy;
}

/* @path: the final name; its folder must exist. Of a link, the file that it leads to is
 *   replaced
 * @error: #GIOErrorEnum
 *
 * Starts a file under a hidden temporary name in the same folder, so that a later
 * rename cannot cross file systems. It is locked. Free without commit removes it.
 *
 * Returns: (transfer full): the output, or %NULL
 */
ClothOutput *
cloth_output_new (const gchar * path, GError ** error)
{
  g_autofree gchar *real = cloth_file_check_target (path, error) ?
      follow_links (path, error) : NULL;
  g_autofree gchar *folder = NULL;
  g_autofree gchar *base = NULL;
  g_autofree gchar *hidden = NULL;
  gint fd, code = 0;

  if (!real)
    return NULL;
  folder = g_path_get_dirname (real);
  base = g_path_get_basename (real);
  hidden = g_strconcat (".", base, CLOTH_PART_MARK, NULL);
  for (guint i = 0; i < CLOTH_MOST_TRIES; i++) {
    g_autofree gchar *temporary = g_build_filename (folder, hidden, NULL);

    fd = g_mkstemp_full (temporary, O_RDWR | O_CLOEXEC, 0666);
    code = fd < 0 ? errno : cloth_file_lock_new (fd);
    if (!code) {
      ClothOutput *output = wrap (fd, temporary, real, path);

      output->alone = TRUE;
      return output;
    }
    if (fd >= 0) {
      g_unlink (temporary);
      close (fd);
    } else if (code != EINTR) {
      break;
    }
  }
  cloth_file_fail (error, code, "write", path);
  return NULL;
}

static gint
open_at (const gchar * temporary, gint flags)
{
  gint fd;

  do
    fd = g_open (temporary, flags | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666);
  while (fd < 0 && errno == EINTR);
  return fd;
}

/* @temporary: the name until it is whole, which must be free
 * @path: the name from then on
 * @shown: what messages call it
 * @sync: whether its bytes go to the disk with the commit
 * @error: #GIOErrorEnum
 *
 * Starts a file in a folder of parts, which has the lock.
 *
 * Returns: (transfer full): the output, or %NULL
 */
ClothOutput *
cloth_output_new_at (const gchar * temporary, const gchar * path,
    const gchar * shown, gboolean sync, GError ** error)
{
  gint fd = open_at (temporary, O_CREAT | O_EXCL);
  ClothOutput *output;

  if (fd < 0) {
    cloth_file_fail (error, errno, "write", shown);
    return NULL;
  }
  output = wrap (fd, temporary, path, shown);
  output->sync = sync;
  return output;
}

/* @temporary: an unfinished file that is there
 * @path: its name when it is whole
 * @shown: what messages call it
 * @size: how much of it is kept; the rest is cut off
 * @error: #GIOErrorEnum
 *
 * Goes on behind what is kept. Free without commit leaves it.
 *
 * Returns: (transfer full): the output, or %NULL
 */
ClothOutput *
cloth_output_continue (const gchar * temporary, const gchar * path,
    const gchar * shown, guint64 size, GError ** error)
{
  gint fd = open_at (temporary, 0);
  gint failed;

  if (fd < 0) {
    cloth_file_fail (error, errno, "write", shown);
    return NULL;
  }
  do
    failed = ftruncate (fd, (off_t) size);
  while (failed && errno == EINTR);
  if (failed || lseek (fd, 0, SEEK_END) < 0) {
    cloth_file_fail (error, errno, "write", shown);
    close (fd);
    return NULL;
  }
  return wrap (fd, temporary, path, shown);
}

static gboolean
write_all (ClothOutput * output, const guint8 * data, gsize size,
    GError ** error)
{
  const gint code = cloth_file_append (output->fd, data, size);

  if (code)
    return cloth_file_fail (error, code, "write", output->shown);
  return TRUE;
}

/* @output: an output not yet committed
 * @error: #GIOErrorEnum
 *
 * Hands all bytes to the system: they outlive the program, if not the computer.
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_output_flush (ClothOutput * output, GError ** error)
{
  gsize size = output->used;

  output->used = 0;
  return write_all (output, output->buffer, size, error);
}

/* @output: an output not yet committed
 * @data: bytes to append
 * @size: how many
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_output_write (ClothOutput * output, gconstpointer data, gsize size,
    GError ** error)
{
  if (size > OUTPUT_BUFFER - output->used) {
    if (!cloth_output_flush (output, error))
      return FALSE;
    if (size > OUTPUT_BUFFER)
      return write_all (output, data, size, error);
  }
  if (size > 0)
    memcpy (output->buffer + output->used, data, size);
  output->used += size;
  return TRUE;
}

/* @output: an output not yet committed
 * @error: #GIOErrorEnum
 * @format: as for printf. No floating point: its decimal point follows the locale
 *
 * Returns: %TRUE when the text was taken
 */
gboolean
cloth_output_printf (ClothOutput * output, GError ** error,
    const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  return cloth_output_write (output, text, strlen (text), error);
}

/* @output: an output not yet committed
 * @offset: where in what is already written
 * @data: bytes that replace those there
 * @size: how many
 * @error: #GIOErrorEnum
 *
 * Mends a header whose counts are known at the end only; the next write appends
 * again.
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_output_write_at (ClothOutput * output, guint64 offset,
    gconstpointer data, gsize size, GError ** error)
{
  const guint8 *from = data;

  if (!cloth_output_flush (output, error))
    return FALSE;
  while (size > 0) {
    gssize n = pwrite (output->fd, from, size, (off_t) offset);

    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0)
      return cloth_file_fail (error, errno, "write", output->shown);
    from += n;
    offset += (guint64) n;
    size -= (gsize) n;
  }
  return TRUE;
}

/* @from: an output that held bytes back until what stands before them was known
 * @to: where to append all that it holds
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when all was taken
 */
gboolean
cloth_output_copy (ClothOutput * from, ClothOutput * to, GError ** error)
{
  gchar block[1 << 14];
  off_t offset = 0;

  if (!cloth_output_flush (from, error))
    return FALSE;
  for (;;) {
    gssize n = pread (from->fd, block, sizeof block, offset);

    if (n == 0)
      return TRUE;
    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0)
      return cloth_file_fail (error, errno, "read", from->shown);
    if (!cloth_output_write (to, block, (gsize) n, error))
      return FALSE;
    offset += n;
  }
}

/* @output: an output
 * @error: #GIOErrorEnum
 *
 * Brings every byte to the disk and gives the file its name, and only then lets go of
 * its lock.
 *
 * Returns: %TRUE when the file is there
 */
gboolean
cloth_output_commit (ClothOutput * output, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (output->path);
  gboolean closed;
  gint failed;

  if (!cloth_output_flush (output, error))
    return FALSE;
  if (output->sync && sync_fd (output->fd))
    return cloth_file_fail (error, errno, "write", output->shown);
  if (output->alone && !cloth_file_check_target (output->path, error))
    return FALSE;
  failed = cloth_file_rename (output->temporary, output->path);
  if (failed)
    return cloth_file_fail (error, failed, "write", output->shown);
  g_free (output->temporary);
  output->temporary = NULL;
  /* After an interrupted close the file is closed, too. */
  closed = close (output->fd) == 0 || errno == EINTR;
  output->fd = -1;
  if (!closed)
    return cloth_file_fail (error, errno, "write", output->shown);
  return !output->alone || cloth_folder_sync (folder, error);
}

/* @path: where the file shall be
 * @data: what is in it
 * @size: how many bytes
 * @error: #GIOErrorEnum
 *
 * The file appears whole or not at all.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_file_write (const gchar * path, gconstpointer data, gsize size,
    GError ** error)
{
  g_autoptr (ClothOutput) output = cloth_output_new (path, error);

  return output && cloth_output_write (output, data, size, error) &&
      cloth_output_commit (output, error);
}

/* @path: where the file shall be
 * @text: what is in it
 * @error: #GIOErrorEnum
 *
 * The file appears whole or not at all.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_file_write_text (const gchar * path, const gchar * text, GError ** error)
{
  return cloth_file_write (path, text, strlen (text), error);
}

/* @output: (transfer full) (nullable): an output
 *
 * Frees it, and removes the file unless it was committed; one in a folder of parts goes
 * with that.
 */
void
cloth_output_free (ClothOutput * output)
{
  if (!output)
    return;
  if (output->alone && output->temporary)
    g_unlink (output->temporary);
  if (output->fd >= 0)
    close (output->fd);
  g_free (output->buffer);
  g_free (output->temporary);
  g_free (output->shown);
  g_free (output->path);
  g_free (output);
}
