/* Which vector instructions the running processor offers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/simd.h"

/* @wanted: the instruction set asked for
 *
 * Returns: the highest instruction set, not above @wanted, that this processor has.
 */
ClothSimd
cloth_simd_resolve (ClothSimd wanted)
{
  ClothSimd best = CLOTH_SIMD_SCALAR;

#ifdef __x86_64__
  __builtin_cpu_init ();
  if (__builtin_cpu_supports ("avx2") && __builtin_cpu_supports ("fma")) {
    best = CLOTH_SIMD_AVX2;
    if (__builtin_cpu_supports ("bmi2") && __builtin_cpu_supports ("avx512f")
        && __builtin_cpu_supports ("avx512bw")
        && __builtin_cpu_supports ("avx512dq")
        && __builtin_cpu_supports ("avx512vl"))
      best = CLOTH_SIMD_AVX512;
  }
#endif
  return MIN (wanted, best);
}
