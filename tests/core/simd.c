/* Levels of instruction sets by their names, and lowered by the environment.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/simd.h"

static void
test_names (void)
{
  static const gchar *const wrong[] = { "", "AVX2", "avx2 ", "avx", "avx5122",
    "scalar,avx2", "0"
  };
  ClothSimd level = CLOTH_SIMD_BEST;

  g_assert_true (cloth_simd_from_string ("scalar", &level));
  g_assert_cmpint (level, ==, CLOTH_SIMD_SCALAR);
  g_assert_true (cloth_simd_from_string ("avx2", &level));
  g_assert_cmpint (level, ==, CLOTH_SIMD_AVX2);
  g_assert_true (cloth_simd_from_string ("avx512", &level));
  g_assert_cmpint (level, ==, CLOTH_SIMD_AVX512);
  for (guint i = 0; i < G_N_ELEMENTS (wrong); i++)
    g_assert_false (cloth_simd_from_string (wrong[i], &level));
  g_assert_false (cloth_simd_from_string (NULL, &level));
  g_assert_cmpint (level, ==, CLOTH_SIMD_AVX512);
}

static const struct
{
  const gchar *name, *path;
  gint most;
} levels[] = {
  {"scalar", "/simd/lowered/subprocess/scalar", CLOTH_SIMD_SCALAR},
  {"avx2", "/simd/lowered/subprocess/avx2", CLOTH_SIMD_AVX2},
  {"avx512", "/simd/lowered/subprocess/avx512", CLOTH_SIMD_AVX512},
};

/* What is asked for bounds what is given; the environment bounds both. */
static void
test_lowered (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (levels); i++) {
    g_setenv ("CLOTH_SIMD", levels[i].name, TRUE);
    g_test_trap_subprocess (levels[i].path, 0, 0);
    g_test_trap_assert_passed ();
  }
  g_setenv ("CLOTH_SIMD", "sse9", TRUE);
  g_test_trap_subprocess (levels[2].path, 0, 0);
  g_test_trap_assert_failed ();
  g_test_trap_assert_stderr ("*CLOTH_SIMD=sse9 is ignored*");
}

static void
test_level (gconstpointer data)
{
  const gint most = GPOINTER_TO_INT (data);

  for (gint wanted = 0; wanted <= CLOTH_SIMD_AVX512; wanted++) {
    const gint got = cloth_simd_resolve ((ClothSimd) wanted);

    g_assert_cmpint (got, <=, MIN (wanted, most));
#ifdef __x86_64__
    if (__builtin_cpu_supports ("avx2") && __builtin_cpu_supports ("fma"))
      g_assert_cmpint (got, >=, MIN (MIN (wanted, most), CLOTH_SIMD_AVX2));
#endif
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/simd/names", test_names);
  g_test_add_func ("/simd/lowered", test_lowered);
  for (guint i = 0; i < G_N_ELEMENTS (levels); i++)
    g_test_add_data_func (levels[i].path, GINT_TO_POINTER (levels[i].most),
        test_level);
  return g_test_run ();
}
