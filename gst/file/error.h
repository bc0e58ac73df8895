/* What can be wrong with the contents of a file, whatever its format.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* INVALID: the bytes break the rules of the format. TRUNCATED: fewer bytes than the header
 * promises. LIMIT: larger, deeper or longer than this library accepts. UNSUPPORTED: a valid
 * file of a kind that is not read here. Failures of the system come as GIOErrorEnum. */
typedef enum {
  CLOTH_FILE_ERROR_INVALID,
  CLOTH_FILE_ERROR_TRUNCATED,
  CLOTH_FILE_ERROR_LIMIT,
  CLOTH_FILE_ERROR_UNSUPPORTED
} ClothFileError;

#define CLOTH_FILE_ERROR (cloth_file_error_quark ())
GQuark cloth_file_error_quark (void);
gboolean cloth_file_is_unwritten (GError * fault, GError ** error);
gboolean cloth_file_invalid (GError ** error, const gchar * format, ...)
    G_GNUC_PRINTF (2, 3);

G_END_DECLS
