/* A pair of parts of a cloth that are near each other: where, and what takes them apart.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/contacttouch.h"

#include <math.h>

#include "gst/math/vec3.h"
#include "gst/sim/nearest.h"

/* Parts that lie on each other still touch when they are farther apart than the thickness
 * by this share of it. */
#define BAND 0.02
/* Parts that slide by less than this share of the thickness between two acts are at rest. */
#define REST 0.1

/* Finds the nearest points of a pair: their difference, and whether this pair is the one to
 * keep them apart. Where several pairs have the same nearest points only one of them does. */
void
cloth_contact_touch_look (const ClothContactPair * pair,
    const gdouble * positions, ClothContactTouch * touch)
{
  const gdouble *x[4];
  gdouble s, t, scale;

  touch->pair = pair;
  for (guint k = 0; k < 4; k++)
    x[k] = positions + 3 * (gsize) pair->particle[k];
  if (pair->n_first == 1) {
    guint feature = cloth_nearest_on_triangle (x[1], x[2], x[3], x[0],
        touch->weight + 1);

    /* two corners are nearest to each other from both sides */
    touch->acts = feature == CLOTH_NEAREST_FACE || (pair->owns >> feature & 1
        && (feature > 2 || pair->particle[0] < pair->particle[1 + feature]));
    touch->flat = feature == CLOTH_NEAREST_FACE;
    touch->weight[0] = 1.;
    for (guint k = 1; k < 4; k++)
      touch->weight[k] = -touch->weight[k];
  } else {
    touch->acts = cloth_nearest_of_edges (x[0], x[1], x[2], x[3], &s, &t);
    touch->flat = touch->acts;
    touch->weight[0] = 1. - s;
    touch->weight[1] = s;
    touch->weight[2] = t - 1.;
    touch->weight[3] = -t;
  }
  for (guint c = 0; c < 3; c++)
    touch->normal[c] = touch->weight[0] * x[0][c] + touch->weight[1] * x[1][c] +
        touch->weight[2] * x[2][c] + touch->weight[3] * x[3][c];
  touch->distance = sqrt (cloth_vec3_dot (touch->normal, touch->normal));
  scale = 1. / MAX (touch->distance, CLOTH_CONTACT_NEAR);
  for (guint c = 0; c < 3; c++)
    touch->normal[c] *= scale;
}

/* Σ weight · values, a difference between the parts. */
void
cloth_contact_touch_between (const ClothContactTouch * touch,
    const gdouble * values, gdouble difference[3])
{
  const gdouble *a = values + 3 * (gsize) touch->pair->particle[0];
  const gdouble *b = values + 3 * (gsize) touch->pair->particle[1];
  const gdouble *c = values + 3 * (gsize) touch->pair->particle[2];
  const gdouble *d = values + 3 * (gsize) touch->pair->particle[3];

  for (guint k = 0; k < 3; k++)
    difference[k] = touch->weight[0] * a[k] + touch->weight[1] * b[k] +
        touch->weight[2] * c[k] + touch->weight[3] * d[k];
}

/* Whether a plane of this normal is between the parts. */
gboolean
cloth_contact_pair_is_parted (const ClothContactPair * pair, const gdouble * x,
    const gdouble normal[3])
{
  gdouble low = INFINITY, high = -INFINITY;

  for (guint k = 0; k < 4; k++) {
    gdouble along = cloth_vec3_dot (normal, x + 3 * (gsize) pair->particle[k]);

    if (k < pair->n_first)
      low = MIN (low, along);
    else
      high = MAX (high, along);
  }
  return low > high;
}

/* Equal and opposite pushes on the two parts. */
static void
push (const ClothContactTouch * touch, const gdouble * inverse_mass,
    const gdouble by[3], gdouble * values)
{
  for (guint k = 0; k < 4; k++) {
    gdouble share = touch->weight[k] * touch->mass *
        inverse_mass[touch->pair->particle[k]];
    gdouble *value = values + 3 * (gsize) touch->pair->particle[k];

    for (guint c = 0; c < 3; c++)
      value[c] += share * by[c];
  }
}

/* Moves the parts of one pair to the distance that they are to keep, and stops their
 * approach. Coulomb's friction reduces their sliding velocity by at most the coefficient
 * times the change that stopped the approach. It also takes back the way they slid: all of
 * it when they stick, half of the same share of it when they slide on. Returns by how much
 * they were too near, or would have been. */
gdouble
cloth_contact_touch_part (const ClothContactTouch * touch,
    const gdouble * before, gdouble friction, gdouble seconds,
    const gdouble * inverse_mass, gdouble * x, gdouble * v)
{
  const gdouble *n = touch->normal;
  gdouble h = touch->pair->thickness, apart[3], u[3], was[3], dx[3], dv[3];
  gdouble depth, along, stop, slide;

  cloth_contact_touch_between (touch, x, apart);
  depth = touch->least - cloth_vec3_dot (n, apart);
  if (!(depth > -BAND * h) || !(touch->mass > 0.))
    return 0.;
  cloth_contact_touch_between (touch, v, u);
  along = cloth_vec3_dot (n, u);
  slide = sqrt (MAX (cloth_vec3_dot (u, u) - along * along, 0.));
  /* past a corner or an edge what comes nearer may only slide by */
  if (depth < 0. && !touch->flat && slide * seconds > REST * h)
    return 0.;
  depth = MAX (depth, 0.);
  stop = MAX (-along, 0.);
  for (guint k = 0; k < 3; k++) {
    dx[k] = depth * n[k];
    dv[k] = stop * n[k];
    u[k] -= along * n[k];
  }
  if (friction > 0. && stop > 0. && slide > 0.) {
    gdouble brake = MIN (friction * stop / slide, 1.);

    cloth_contact_touch_between (touch, before, was);
    for (guint k = 0; k < 3; k++)
      was[k] = apart[k] - was[k];
    along = cloth_vec3_dot (n, was);
    for (guint k = 0; k < 3; k++) {
      dv[k] -= brake * u[k];
      dx[k] -= 0.5 * (brake + brake * brake) * (was[k] - along * n[k]);
    }
  }
  push (touch, inverse_mass, dx, x);
  push (touch, inverse_mass, dv, v);
  return MAX (depth, stop * seconds);
}
