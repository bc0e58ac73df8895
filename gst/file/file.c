/* Files that nobody vouches for: bounded reads.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/file.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gst/file/output.h"

#define MAX_TEXT (16 * 1024 * 1024)

struct _ClothInput
{
  gint fd;                      /* -1: memory */
  const guint8 *data;
  guint64 size;
};

/* @path: a regular file
 * @error: #GIOErrorEnum
 *
 * Opens @path for reading. Pipes, devices and folders are refused, so that a name
 * in a hostile manifest can neither block nor read without end.
 *
 * Returns: (transfer full): the input, or %NULL
 */
ClothInput *
cloth_input_open (const gchar * path, GError ** error)
{
  ClothInput *input;
  struct stat info;
  gint fd;

  do
    fd = g_open (path, O_RDONLY | O_CLOEXEC | O_NONBLOCK, 0);
  while (fd < 0 && errno == EINTR);
  if (fd < 0 || fstat (fd, &info) < 0) {
    cloth_file_fail (error, errno, "open", path);
    if (fd >= 0)
      close (fd);
    return NULL;
  }
  if (!S_ISREG (info.st_mode)) {
    g_autofree gchar *shown = g_filename_display_name (path);

    close (fd);
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE,
        "“%s” is not a regular file", shown);
    return NULL;
  }
  input = g_new0 (ClothInput, 1);
  input->fd = fd;
  input->size = (guint64) info.st_size;
  return input;
}

/* @data: @size bytes, borrowed: they must outlive the input
 * @size: how many
 *
 * Returns: (transfer full): an input over memory
 */
ClothInput *
cloth_input_new_memory (const guint8 * data, gsize size)
{
  ClothInput *input = g_new0 (ClothInput, 1);

  input->fd = -1;
  input->data = data;
  input->size = size;
  return input;
}

/* @input: an input
 *
 * Returns: its size in bytes when it was opened
 */
guint64
cloth_input_get_size (const ClothInput * input)
{
  return input->size;
}

/* @input: an input
 * @offset: first byte
 * @destination: room for @size bytes
 * @size: how many bytes
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads exactly @size bytes. A file that shrank meanwhile is an error, not a crash
 * (the reason for not mapping it).
 *
 * Returns: %TRUE when all were read
 */
gboolean
cloth_input_read_at (ClothInput * input, guint64 offset, gpointer destination,
    gsize size, GError ** error)
{
  guint8 *to = destination;

  if (offset > input->size || size > input->size - offset) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED,
        "%" G_GSIZE_FORMAT " bytes wanted at %" G_GUINT64_FORMAT
        ", the file has %" G_GUINT64_FORMAT, size, offset, input->size);
    return FALSE;
  }
  if (input->fd < 0) {
    if (size > 0)
      memcpy (to, input->data + offset, size);
    return TRUE;
  }
  while (size > 0) {
    gssize n = pread (input->fd, to, size, (off_t) offset);

    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0) {
      g_set_error (error, G_IO_ERROR, g_io_error_from_errno (errno),
          "cannot read: %s", g_strerror (errno));
      return FALSE;
    }
    if (n == 0) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED,
          "the file became shorter while it was read");
      return FALSE;
    }
    to += n;
    offset += (guint64) n;
    size -= (gsize) n;
  }
  return TRUE;
}

/* @input: an input
 * @limit: the most bytes accepted
 * @bytes: set to the contents with one 0 byte behind them (`bytes->len` counts it)
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads everything. @bytes is reused, so that a sequence of files allocates once.
 *
 * Returns: %TRUE when all was read
 */
gboolean
cloth_input_load (ClothInput * input, gsize limit, GByteArray * bytes,
    GError ** error)
{
  if (input->size > MIN (limit, CLOTH_MAX_BUFFER)) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%" G_GUINT64_FORMAT " bytes are more than the %" G_GSIZE_FORMAT
        " accepted", input->size, (gsize) MIN (limit, CLOTH_MAX_BUFFER));
    return FALSE;
  }
  g_byte_array_set_size (bytes, (guint) input->size + 1);
  bytes->data[input->size] = 0;
  return cloth_input_read_at (input, 0, bytes->data, (gsize) input->size,
      error);
}

/* @input: (transfer full) (nullable): an input
 */
void
cloth_input_free (ClothInput * input)
{
  if (!input)
    return;
  if (input->fd >= 0)
    close (input->fd);
  g_free (input);
}

/* @path: a file
 * @length: (out): its bytes
 * @error: #GFileError, or #ClothFileError when it exceeds 16 MiB
 *
 * Looks at the size before it reads. Devices and pipes are refused: they may never end.
 *
 * Returns: (transfer full): the bytes and a 0, or %NULL.
 */
gchar *
cloth_text_file_load (const gchar * path, gsize * length, GError ** error)
{
  GStatBuf st;
  gchar *data = NULL;

  if (g_stat (path, &st) == 0) {
    if (!S_ISREG (st.st_mode)) {
      g_set_error (error, G_FILE_ERROR, G_FILE_ERROR_INVAL,
          "%s: not a regular file", path);
      return NULL;
    }
    if (st.st_size > MAX_TEXT) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
          "%s: %" G_GINT64_FORMAT " bytes are more than the %d allowed", path,
          (gint64) st.st_size, MAX_TEXT);
      return NULL;
    }
  }
  if (!g_file_get_contents (path, &data, length, error))
    return NULL;
  if (*length > MAX_TEXT) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%s: grew beyond the %d bytes allowed", path, MAX_TEXT);
    g_free (data);
    return NULL;
  }
  return data;
}

/* @folder: the folder of a manifest
 * @name: a file name that the manifest gives
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Joins the two and makes sure that the file exists and lies inside @folder, after
 * every symbolic link was followed.
 *
 * Returns: (transfer full) (type filename): the path, or %NULL
 */
gchar *
cloth_path_inside (const gchar * folder, const gchar * name, GError ** error)
{
  g_autofree gchar *path = NULL;
  char *root = NULL, *real = NULL;
  gboolean inside = FALSE;

  if (!*name || g_path_is_absolute (name) || strstr (name, "..")) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "“%s” is no path inside the folder: name a file below it", name);
    return NULL;
  }
  path = g_build_filename (folder, name, NULL);
  root = realpath (folder, NULL);
  real = realpath (path, NULL);
  if (!root || !real) {
    cloth_file_fail (error, errno, "open", path);
  } else {
    gsize length = strlen (root);

    inside = g_str_has_prefix (real, root) &&
        (real[length] == '/' || g_str_equal (root, "/"));
    if (!inside)
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
          "“%s” leads out of its folder", name);
  }
  free (root);
  free (real);
  return inside ? g_steal_pointer (&path) : NULL;
}

/* @items: numbers as they stand in a little-endian file, or are to stand there
 * @item_size: 1, 2, 4 or 8 bytes each
 * @n_items: how many
 *
 * Turns them in place into the processor's byte order, or back.
 */
void
cloth_swap_little_endian (gpointer items, gsize item_size, gsize n_items)
{
#if G_BYTE_ORDER != G_LITTLE_ENDIAN
  guint8 *p = items;

  for (gsize i = 0; i < n_items; i++, p += item_size) {
    for (gsize a = 0, b = item_size - 1; a < b; a++, b--) {
      guint8 kept = p[a];

      p[a] = p[b];
      p[b] = kept;
    }
  }
#endif
}
