/* Features of prints, looked at once for all elements that follow the same one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/match/match.h"

G_BEGIN_DECLS

const ClothReference *gst_cloth_print_acquire (const ClothReferenceParams *
    params, const ClothCvPicture * picture, ClothPool * pool, GError ** error);
void gst_cloth_print_release (const ClothReference * reference);

G_END_DECLS
