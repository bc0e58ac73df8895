/* A pair of parts of a cloth that are near each other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/contactpairs.h"

G_BEGIN_DECLS

/* Nearer than this there is no direction, m. */
#define CLOTH_CONTACT_NEAR 1e-9

/* A pair that may come within its thickness. */
typedef struct
{
  const ClothContactPair *pair;
  gboolean acts;                /* no other pair speaks for it */
  gboolean flat;                /* within a face, or within two edges */
  gdouble weight[4];            /* of the nearest points' difference */
  gdouble normal[3];            /* from the other part to the first */
  gdouble distance;
  gdouble least;                /* to be kept, m */
  gdouble mass;                 /* that an impulse between them moves */
} ClothContactTouch;

void cloth_contact_touch_look (const ClothContactPair * pair,
    const gdouble * positions, ClothContactTouch * touch);
void cloth_contact_touch_between (const ClothContactTouch * touch,
    const gdouble * values, gdouble difference[3]);
gboolean cloth_contact_pair_is_parted (const ClothContactPair * pair,
    const gdouble * x, const gdouble normal[3]);
gdouble cloth_contact_touch_part (const ClothContactTouch * touch,
    const gdouble * before, gdouble friction, gdouble seconds,
    const gdouble * inverse_mass, gdouble * x, gdouble * v);

G_END_DECLS
