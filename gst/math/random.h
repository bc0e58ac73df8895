/* Seedable random numbers, the same on every machine.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* State of a generator; initialise it with cloth_random_init ().
 */
typedef struct {
  /*< private > */
  guint64 s[4];
  gdouble spare;
  gboolean has_spare;
} ClothRandom;

void cloth_random_init (ClothRandom * random, guint64 seed);
guint64 cloth_random_bits (ClothRandom * random);
gdouble cloth_random_uniform (ClothRandom * random);
guint cloth_random_below (ClothRandom * random, guint bound);
gdouble cloth_random_gaussian (ClothRandom * random);

G_END_DECLS
