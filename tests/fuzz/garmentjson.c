/* Fuzz target: garment.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/mesh/garment/garment.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (ClothGarment) garment = cloth_garment_parse ((const gchar *) data,
      size, cloth_topology_new_grid (3, 2, 1, 1), NULL);

  if (garment) {
    g_autofree gchar *json = cloth_garment_to_json (garment);

    g_assert_nonnull (json);
  }
  return 0;
}
