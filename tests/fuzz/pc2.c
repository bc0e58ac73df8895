/* Fuzz target: PC2 point caches.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/mesh/formats/pc2.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (ClothPc2Reader) reader =
      cloth_pc2_reader_new (cloth_input_new_memory (data, size), NULL);
  const ClothPc2Info *info;

  if (!reader)
    return 0;
  info = cloth_pc2_reader_get_info (reader);
  if (info->n_samples > 0) {
    g_autofree gfloat *positions = g_new (gfloat, 3 * info->n_points);

    /* The header was accepted: every sample it promises must be readable. */
    g_assert_true (cloth_pc2_reader_read (reader, info->n_samples - 1,
            positions, NULL));
  }
  return 0;
}
