/* Time to make a code and to place a patch of 20 by 20 squares on a board of 60 by 60.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/random.h"
#include "gst/pattern/code.h"

int
main (void)
{
  const gint sizes[] = { 16, 60, 100, 250 };

  for (gsize s = 0; s < G_N_ELEMENTS (sizes); s++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothPattern) pattern =
        cloth_pattern_new_checker (sizes[s], sizes[s], 0.01, 0, TRUE, NULL);
    gint64 start = g_get_monotonic_time (), made, placed;
    g_autoptr (ClothCodeLocator) locator = NULL;
    gfloat llr[400];
    ClothCodePlacement best, second;
    ClothRandom random;
    gint window, extent = MIN (20, sizes[s]), runs = 50;

    if (!cloth_code_generate (pattern, CLOTH_CODE_DOT_RATIO, 1, &window,
            &error)) {
      g_printerr ("%s\n", error->message);
      return 1;
    }
    made = g_get_monotonic_time ();
    locator = cloth_code_locator_new (pattern);
    cloth_random_init (&random, 1);
    for (gint i = 0; i < extent * extent; i++)
      llr[i] = (gfloat) cloth_random_gaussian (&random) * 2 +
          (cloth_pattern_has_dot (pattern, i % extent, i / extent) ? 3 : -3);
    for (gint run = 0; run < runs; run++)
      cloth_code_locate (locator, llr, extent, extent, TRUE, &best, &second);
    placed = g_get_monotonic_time ();
    g_print
        ("%d by %d squares: window %d, code made in %.1f ms; patch of %d by "
        "%d placed in %.3f ms, margin %.0f nats\n", sizes[s], sizes[s], window,
        (made - start) / 1e3, extent, extent, (placed - made) / 1e3 / runs,
        best.score - second.score);
  }
  return 0;
}
