/* Which place of the flat picture a place of the film shows, near one place of it: a
 * polynomial of second order.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Terms of a polynomial: 1, s, t, s², st, t². */
#define CLOTH_WARP_TERMS 6

/* @centre: column and row in the film, px
 * @unit: of s and t, px: s = (x − centre) / unit
 * @terms: column and row in the flat picture, px, each as coefficients of 1, s, t, s², st, t²
 */
typedef struct {
  gdouble centre[2], unit;
  gdouble terms[2][CLOTH_WARP_TERMS];
} ClothWarp;

void cloth_warp_get_terms (const ClothWarp * warp, gdouble x, gdouble y,
    gdouble terms[CLOTH_WARP_TERMS]);
void cloth_warp_apply (const ClothWarp * warp, gdouble x, gdouble y,
    gdouble to[2]);
void cloth_warp_get_slopes (const ClothWarp * warp, gdouble x, gdouble y,
    gdouble slopes[4]);
gboolean cloth_warp_find (const ClothWarp * warp, const gdouble to[2],
    gdouble at[2]);
void cloth_warp_move (ClothWarp * warp, gdouble x, gdouble y, gdouble unit);

G_END_DECLS
