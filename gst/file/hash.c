/* Hashes of files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/hash.h"

#include <string.h>

#include "gst/file/file.h"

/* Bytes that are read at a time. */
#define PIECE (64u << 10)

/* @path: a regular file of any size
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full) (nullable): SHA-256 of its bytes, 64 hexadecimal digits
 */
gchar *
cloth_file_sha256 (const gchar * path, GError ** error)
{
  g_autoptr (ClothInput) input = cloth_input_open (path, error);
  g_autoptr (GChecksum) sum = g_checksum_new (G_CHECKSUM_SHA256);
  g_autofree guint8 *piece = g_malloc (PIECE);
  guint64 size = input ? cloth_input_get_size (input) : 0;

  for (guint64 at = 0; at < size; at += PIECE) {
    gsize n = (gsize) MIN (PIECE, size - at);

    if (!cloth_input_read_at (input, at, piece, n, error)) {
      g_prefix_error (error, "%s: ", path);
      return NULL;
    }
    g_checksum_update (sum, piece, (gssize) n);
  }
  return input ? g_strdup (g_checksum_get_string (sum)) : NULL;
}

static gint
compare_names (gconstpointer a, gconstpointer b)
{
  return strcmp (*(const gchar * const *) a, *(const gchar * const *) b);
}

/* @folder: a folder
 * @names: (element-type filename): files in it; sorted by this
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * One hash of several files: that of what `sha256sum` prints of them, sorted by the
 * bytes of their names. Each counts once.
 *
 * Returns: (transfer full) (nullable): 64 hexadecimal digits
 */
gchar *
cloth_files_sha256 (const gchar * folder, GPtrArray * names, GError ** error)
{
  g_autoptr (GChecksum) sum = g_checksum_new (G_CHECKSUM_SHA256);

  g_ptr_array_sort (names, compare_names);
  for (guint i = 0; i < names->len; i++) {
    const gchar *name = g_ptr_array_index (names, i);
    g_autofree gchar *path = NULL, *digits = NULL, *line = NULL;

    if (i > 0 && strcmp (name, g_ptr_array_index (names, i - 1)) == 0)
      continue;
    path = cloth_path_inside (folder, name, error);
    digits = path ? cloth_file_sha256 (path, error) : NULL;
    if (!digits)
      return NULL;
    line = g_strdup_printf ("%s  %s\n", digits, name);
    g_checksum_update (sum, (const guchar *) line, -1);
  }
  return g_strdup (g_checksum_get_string (sum));
}
