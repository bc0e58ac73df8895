/* Which place of the flat cloth each pixel shows: between matched places, along the surface.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/vision/uv/params.h"

G_BEGIN_DECLS

typedef struct _ClothUV ClothUV;

ClothUVParams cloth_uv_default_params (void);
ClothUV *cloth_uv_new (void);
void cloth_uv_free (ClothUV * self);
void cloth_uv_run (ClothUV * self, const ClothUVParams * params,
    const ClothUVMatch * matches, guint n_matches,
    const ClothMatchSurface * surface, ClothPool * pool, gfloat * uv,
    ClothUVCounts * counts);
gdouble cloth_uv_get_sigma (const ClothUV * self, guint32 pixel);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothUV, cloth_uv_free)
G_END_DECLS
