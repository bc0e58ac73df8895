/* Small pictures of what a calibration saw, as JPEG.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

typedef struct _ClothPictureMaker ClothPictureMaker;

ClothPictureMaker *cloth_picture_maker_new (void);
GBytes *cloth_picture_maker_make (ClothPictureMaker * maker,
    const ClothImage * image);
void cloth_picture_maker_free (ClothPictureMaker * maker);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPictureMaker, cloth_picture_maker_free)
G_END_DECLS
