/* Which vector instructions the running processor offers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/simd.h"

/* @text: (nullable): a level by its name
 * @level: (out): the level
 *
 * Returns: whether it is the name of one
 */
gboolean
cloth_simd_from_string (const gchar * text, ClothSimd * level)
{
  static const gchar *const names[] = { "scalar", "avx2", "avx512" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++)
    if (g_strcmp0 (text, names[i]) == 0) {
      *level = (ClothSimd) i;
      return TRUE;
    }
  return FALSE;
}

static ClothSimd
look_at_processor (void)
{
#ifdef __x86_64__
  __builtin_cpu_init ();
  if (!__builtin_cpu_supports ("avx2") || !__builtin_cpu_supports ("fma"))
    return CLOTH_SIMD_SCALAR;
  return __builtin_cpu_supports ("bmi2") && __builtin_cpu_supports ("avx512f")
      && __builtin_cpu_supports ("avx512bw")
      && __builtin_cpu_supports ("avx512dq")
      && __builtin_cpu_supports ("avx512vl") ? CLOTH_SIMD_AVX512 :
      CLOTH_SIMD_AVX2;
#else
  return CLOTH_SIMD_SCALAR;
#endif
}

/* @wanted: the instruction set asked for
 *
 * Returns: the highest instruction set, not above @wanted, that this processor has and
 *   that the environment allows: CLOTH_SIMD lowers it to scalar, avx2 or avx512
 */
ClothSimd
cloth_simd_resolve (ClothSimd wanted)
{
  static gsize best = 0;        /* the level, plus 1 once it is known */

  if (g_once_init_enter (&best)) {
    const gchar *text = g_getenv ("CLOTH_SIMD");
    ClothSimd most = CLOTH_SIMD_BEST;

    if (text && !cloth_simd_from_string (text, &most))
      g_warning ("CLOTH_SIMD=%s is ignored: it may be scalar, avx2 or avx512",
          text);
    g_once_init_leave (&best, MIN (most, look_at_processor ()) + 1);
  }
  return MIN (wanted, (ClothSimd) (best - 1));
}
