/* What can be wrong with the contents of a file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/error.h"

#include <gio/gio.h>
#include <stdarg.h>

GQuark
cloth_file_error_quark (void)
{
  return g_quark_from_static_string ("cloth-file-error-quark");
}

/* @error: (out): set to %CLOTH_FILE_ERROR_INVALID
 * @format: what is wrong and how to mend it
 *
 * Returns: %FALSE, so that a check may end with it
 */
gboolean
cloth_file_invalid (GError ** error, const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_set_error_literal (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID, text);
  return FALSE;
}

/* @fault: (transfer full): why the beginning of a file could not be read
 * @error: (out): set to @fault unless the file is missing or too short
 *
 * Returns: whether it is, so that its program was killed before it had written that
 */
gboolean
cloth_file_is_unwritten (GError * fault, GError ** error)
{
  if (g_error_matches (fault, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED) ||
      g_error_matches (fault, G_IO_ERROR, G_IO_ERROR_NOT_FOUND)) {
    g_error_free (fault);
    return TRUE;
  }
  g_propagate_error (error, fault);
  return FALSE;
}
