/* A cloth that touches itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/contactmesh.h"

G_BEGIN_DECLS

typedef struct _ClothContact ClothContact;

ClothContact *cloth_contact_new (const ClothContactMesh * mesh,
    gboolean single);
void cloth_contact_free (ClothContact * contact);
void cloth_contact_reset (ClothContact * contact, const gdouble * positions);
gboolean cloth_contact_act (ClothContact * contact, gdouble thickness,
    gdouble friction, gdouble seconds, gdouble ahead,
    const gdouble * inverse_mass, gdouble * x, gdouble * v);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothContact, cloth_contact_free)
G_END_DECLS
