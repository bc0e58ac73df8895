/* A page that is one file: it loads nothing, and runs and wears only what it brings along.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gio/gio.h>

G_BEGIN_DECLS

/* @id: by which the script finds it
 * @json: what the script reads; its strings have no “<”, as #ClothJsonWriter writes them
 */
typedef struct {
  const gchar *id;
  const gchar *json;
} ClothPagePart;

gboolean cloth_page_write (const gchar * path, const gchar * name,
    const gchar * title, const gchar * without_script,
    const ClothPagePart * parts, guint n_parts, GError ** error);

G_END_DECLS
