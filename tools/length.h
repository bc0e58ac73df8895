/* Lengths of the command line.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* "50mm", "5cm", "0.05m" or "2in", the value of --@option, in metres. */
gboolean parse_length (const gchar * option, const gchar * text,
    gdouble * metres, GError ** error);

G_END_DECLS
