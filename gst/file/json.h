/* JSON that nobody vouches for.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <json-glib/json-glib.h>

#include "gst/file/textfile.h"

G_BEGIN_DECLS

JsonParser *cloth_json_parse (const gchar * data, gsize length,
    GError ** error);

G_END_DECLS
