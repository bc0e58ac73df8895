/* Seedable random numbers, the same on every machine.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/random.h"

#include <math.h>

static inline guint64
rotate_left (guint64 x, gint k)
{
  return (x << k) | (x >> (64 - k));
}

/* @random: (out): generator
 * @seed: any number; equal seeds give equal sequences
 *
 * The state is filled by splitmix64, as the authors of xoshiro advise.
 */
void
cloth_random_init (ClothRandom * random, guint64 seed)
{
  for (gint i = 0; i < 4; i++) {
    guint64 z = seed += G_GUINT64_CONSTANT (0x9e3779b97f4a7c15);

    z = (z ^ (z >> 30)) * G_GUINT64_CONSTANT (0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * G_GUINT64_CONSTANT (0x94d049bb133111eb);
    random->s[i] = z ^ (z >> 31);
  }
  random->spare = 0.;
  random->has_spare = FALSE;
}

/* @random: generator
 *
 * Returns: 64 random bits: xoshiro256++ (Blackman & Vigna, Scrambled linear
 *   pseudorandom number generators, 2021)
 */
guint64
cloth_random_bits (ClothRandom * random)
{
  guint64 *s = random->s;
  guint64 result = rotate_left (s[0] + s[3], 23) + s[0];
  guint64 t = s[1] << 17;

  s[2] ^= s[0];
  s[3] ^= s[1];
  s[1] ^= s[2];
  s[0] ^= s[3];
  s[2] ^= t;
  s[3] = rotate_left (s[3], 45);
  return result;
}

/* @random: generator
 *
 * Returns: a number of [0, 1), a multiple of 2⁻⁵³
 */
gdouble
cloth_random_uniform (ClothRandom * random)
{
  return (gdouble) (cloth_random_bits (random) >> 11) * 0x1p-53;
}

/* @random: generator
 * @bound: >= 1
 *
 * Returns: an integer of [0, @bound), each equally likely to 2⁻³²
 */
guint
cloth_random_below (ClothRandom * random, guint bound)
{
  return (guint) (((cloth_random_bits (random) >> 32) * bound) >> 32);
}

/* @random: generator
 *
 * Returns: a normal deviate of mean 0 and standard deviation 1 (Marsaglia's polar
 *   method)
 */
gdouble
cloth_random_gaussian (ClothRandom * random)
{
  gdouble x, y, s;

  if (random->has_spare) {
    random->has_spare = FALSE;
    return random->spare;
  }
  do {
    x = 2. * cloth_random_uniform (random) - 1.;
    y = 2. * cloth_random_uniform (random) - 1.;
    s = x * x + y * y;
  } while (s >= 1. || s == 0.);
  s = sqrt (-2. * log (s) / s);
  random->spare = y * s;
  random->has_spare = TRUE;
  return x * s;
}
