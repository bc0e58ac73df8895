/* Reading small text files that nobody vouches for.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/textfile.h"

#include <glib/gstdio.h>

#define MAX_BYTES (16 * 1024 * 1024)

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
    if (st.st_size > MAX_BYTES) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
          "%s: %" G_GINT64_FORMAT " bytes are more than the %d allowed", path,
          (gint64) st.st_size, MAX_BYTES);
      return NULL;
    }
  }
  if (!g_file_get_contents (path, &data, length, error))
    return NULL;
  if (*length > MAX_BYTES) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%s: grew beyond the %d bytes allowed", path, MAX_BYTES);
    g_free (data);
    return NULL;
  }
  return data;
}
