/* Which parts of a cloth may come near each other: the broad phase of its contact.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/contactmesh.h"

G_BEGIN_DECLS

/* A corner and a triangle (n_first = 1) or two edges (n_first = 2): the first part's
 * particles, then the other's. */
typedef struct
{
  guint32 particle[4];
  guint16 n_first;
  guint16 owns;                 /* of the triangle, see ClothContactFace */
  gdouble thickness;            /* to be kept between them, m */
} ClothContactPair;

/* Grows, never shrinks. */
typedef struct
{
  const ClothContactMesh *mesh;
  gdouble *reach;               /* boxes of the particles: low, high */
  gdouble *boxes;               /* of the nodes */
  ClothContactPair *pairs;
  gdouble *limits;              /* of each, for contact.c; 0 of new ones */
  gsize n_pairs, n_allocated;
} ClothContactPairs;

void cloth_contact_pairs_init (ClothContactPairs * pairs,
    const ClothContactMesh * mesh);
void cloth_contact_pairs_clear (ClothContactPairs * pairs);
void cloth_contact_pairs_find (ClothContactPairs * pairs, const gdouble * from,
    const gdouble * to, gdouble thickness, gdouble margin);

G_END_DECLS
