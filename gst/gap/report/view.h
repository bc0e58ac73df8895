/* A page on which recordings move beside each other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gio/gio.h>

G_BEGIN_DECLS

/* More would be too small to look at. */
#define CLOTH_VIEW_MAX_TAKES 8

gboolean cloth_view_write (const gchar * const *locations, guint n,
    const gchar * path, GError ** error);

G_END_DECLS
