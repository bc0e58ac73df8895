/* How well four corners delineate a square: the cross template.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

gfloat cloth_quad_confidence (const ClothImage * image, const gfloat x[4],
    const gfloat y[4], gfloat alpha, gboolean black);
gfloat cloth_quad_shade (const ClothImage * image, const gfloat x[4],
    const gfloat y[4], gboolean black);
gfloat cloth_quad_light (const ClothImage * image, const gfloat x[4],
    const gfloat y[4], gboolean black);

G_END_DECLS
