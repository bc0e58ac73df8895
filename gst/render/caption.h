/* Words over a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/render/draw.h"

G_BEGIN_DECLS

/* Bytes of a caption that are drawn at most. */
#define CLOTH_CAPTION_MAX 200

gfloat cloth_caption_draw (const ClothCanvas * canvas, const gchar * text,
    gint x, gint y, gint size, gint room, gfloat opacity);

G_END_DECLS
