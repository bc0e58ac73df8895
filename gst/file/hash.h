/* Hashes of files, as sha256sum prints them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

gchar *cloth_file_sha256 (const gchar * path, GError ** error);
gchar *cloth_files_sha256 (const gchar * folder, GPtrArray * names,
    GError ** error);

G_END_DECLS
