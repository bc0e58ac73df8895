/* Fuzz target: drawings of garments.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/mesh/garment/garment.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  const ClothDotGrid grid = { 20, 20, 0.02, {0.01, 0.01}, {0.4, 0.4} };
  g_autoptr (ClothGarment) garment =
      cloth_garment_new_from_svg ((const gchar *) data, size, &grid, NULL);

  if (garment) {
    g_autofree gchar *json = cloth_garment_to_json (garment);

    g_assert_true (cloth_topology_check (garment->topology, NULL));
    g_assert_nonnull (json);
  }
  return 0;
}
