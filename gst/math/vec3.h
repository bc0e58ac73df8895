/* Vectors of three doubles.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>
#include <math.h>

G_BEGIN_DECLS

/* a · b */
static inline gdouble
cloth_vec3_dot (const gdouble a[3], const gdouble b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* @c: (out): a × b; neither @a nor @b */
static inline void
cloth_vec3_cross (const gdouble a[3], const gdouble b[3], gdouble c[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* @c: (out): a − b; may be @a or @b */
static inline void
cloth_vec3_subtract (const gdouble a[3], const gdouble b[3], gdouble c[3])
{
  for (guint k = 0; k < 3; k++)
    c[k] = a[k] - b[k];
}

/* @a: (inout): becomes a + s b */
static inline void
cloth_vec3_add_scaled (gdouble a[3], gdouble s, const gdouble b[3])
{
  for (guint k = 0; k < 3; k++)
    a[k] += s * b[k];
}

/* |a| */
static inline gdouble
cloth_vec3_length (const gdouble a[3])
{
  return sqrt (cloth_vec3_dot (a, a));
}

/* @a: (inout): becomes a / |a|, or stays what it is when |a| is not above 0
 *
 * Returns: what |a| was
 */
static inline gdouble
cloth_vec3_normalise (gdouble a[3])
{
  const gdouble length = cloth_vec3_length (a);

  for (guint k = 0; k < 3 && length > 0; k++)
    a[k] /= length;
  return length;
}

G_END_DECLS
