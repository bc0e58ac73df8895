/* Bytes that wait until what stands before them in a file is known.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <unistd.h>

#include "gst/file/spool.h"

struct _ClothSpool
{
  FILE *file;
};

static gboolean
fail_errno (GError ** error)
{
  gint code = errno;

  g_set_error (error, G_IO_ERROR, g_io_error_from_errno (code),
      "cannot keep what is to be written: %s", g_strerror (code));
  return FALSE;
}

/* @stem: what the names of the files begin with: the bytes wait on the same disk
 * @error: #GIOErrorEnum
 *
 * Starts a file without a name, which is gone with the process.
 *
 * Returns: (transfer full): an empty spool, or %NULL
 */
ClothSpool *
cloth_spool_new (const gchar * stem, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (stem);
  g_autofree gchar *path = g_build_filename (folder, ".spool.XXXXXX", NULL);
  gint fd = g_mkstemp_full (path, O_RDWR | O_CLOEXEC, 0600);
  FILE *file;
  ClothSpool *spool;

  if (fd < 0) {
    fail_errno (error);
    return NULL;
  }
  g_unlink (path);
  file = fdopen (fd, "w+b");
  if (!file) {
    fail_errno (error);
    close (fd);
    return NULL;
  }
  spool = g_new (ClothSpool, 1);
  spool->file = file;
  return spool;
}

/* @spool: a spool
 * @data: bytes to append
 * @size: how many
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when they were taken
 */
gboolean
cloth_spool_write (ClothSpool * spool, gconstpointer data, gsize size,
    GError ** error)
{
  return size == 0 || fwrite (data, size, 1, spool->file) == 1 ||
      fail_errno (error);
}

/* @spool: a spool, which takes no more after this
 * @output: where to append all that it holds
 * @error: #GIOErrorEnum
 *
 * Returns: %TRUE when all was taken
 */
gboolean
cloth_spool_copy (ClothSpool * spool, ClothOutput * output, GError ** error)
{
  gchar block[1 << 14];
  gsize n;

  if (fflush (spool->file) != 0 || fseeko (spool->file, 0, SEEK_SET) < 0)
    return fail_errno (error);
  while ((n = fread (block, 1, sizeof block, spool->file)) > 0)
    if (!cloth_output_write (output, block, n, error))
      return FALSE;
  return !ferror (spool->file) || fail_errno (error);
}

/* @spool: (transfer full) (nullable): a spool
 */
void
cloth_spool_free (ClothSpool * spool)
{
  if (!spool)
    return;
  fclose (spool->file);
  g_free (spool);
}
