/* Reading small text files that nobody vouches for.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/**
 * ClothFileError:
 * @CLOTH_FILE_ERROR_SYNTAX: the text is not what it should be
 * @CLOTH_FILE_ERROR_LIMIT: it is larger, deeper or longer than allowed
 *
 * Since: 0.1
 */
typedef enum {
  CLOTH_FILE_ERROR_SYNTAX,
  CLOTH_FILE_ERROR_LIMIT
} ClothFileError;

#define CLOTH_FILE_ERROR (cloth_file_error_quark ())
GQuark cloth_file_error_quark (void);

gchar *cloth_text_file_load (const gchar * path, gsize * length,
    GError ** error);

G_END_DECLS
