/* A described feature found again in a part of a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/cv.h"

G_BEGIN_DECLS

/* In place of a feature: none was found. */
#define CLOTH_SEEK_NONE G_MAXUINT32

/* Features this near to each other are one, described in several directions, px. */
#define CLOTH_SEEK_SAME_PX 2.

guint32 cloth_seek_distance (const guint8 * a, const guint8 * b);
guint cloth_seek_run (const ClothCvFeatures * features,
    const gdouble middle[2], gdouble reach, gdouble ratio, guint n,
    const guint8 * const *descriptors, guint32 * distance);

G_END_DECLS
