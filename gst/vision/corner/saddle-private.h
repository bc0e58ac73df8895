/* The sub-pixel place of a saddle from the pixels around its strongest one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/corner/saddle.h"

G_BEGIN_DECLS

typedef struct _ClothSaddleRefiner ClothSaddleRefiner;

ClothSaddleRefiner *cloth_saddle_refiner_new (void);
void cloth_saddle_refiner_free (ClothSaddleRefiner * refiner);
void cloth_saddle_refiner_set (ClothSaddleRefiner * refiner, gfloat sigma);
gboolean cloth_saddle_refiner_run (const ClothSaddleRefiner * refiner,
    const ClothImage * image, const ClothSaddleCandidate * peak, gfloat noise,
    ClothSaddle * saddle, gfloat theta[2], ClothSimd level);

G_END_DECLS
