/* The luma of a film as the decoder gives it, as the elements would see it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @path: a file with H.264 in MP4, of just @n_frames pictures of just @width by @height px.
 * Returns: (transfer full): all of them, one after the other, without padding */
guint8 *test_luma_decode (const gchar * path, gint width, gint height,
    guint n_frames);

G_END_DECLS
