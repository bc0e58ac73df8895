/* Masks of one bit a pixel: rows of ⌈width / 64⌉ words, the first column in the lowest bit.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

void cloth_bits_pack (const guint8 * bytes, gint width, guint64 * bits);
void cloth_bits_erode (guint64 * bits, guint64 * spare, gint width,
    gint height, gint radius);
void cloth_bits_open (guint64 * bits, guint64 * spare, gint width,
    gint height, gint radius);

G_END_DECLS
