/* PFM: pictures of floats.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/error.h"

G_BEGIN_DECLS

gboolean cloth_pfm_write (const gchar * path, const gfloat * floats,
    gint width, gint height, GError ** error);

G_END_DECLS
