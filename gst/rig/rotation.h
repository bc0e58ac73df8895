/* Rotation vectors and matrices (Rodrigues), with derivatives.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

void cloth_rotation_from_vector (const gdouble r[3], gdouble R[9]);
void cloth_rotation_to_vector (const gdouble R[9], gdouble r[3]);
void cloth_rotation_left_jacobian (const gdouble r[3], gdouble J[9]);

G_END_DECLS
