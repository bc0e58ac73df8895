/* Reading small text files that nobody vouches for.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

gchar *cloth_text_file_load (const gchar * path, gsize * length,
    GError ** error);

G_END_DECLS
