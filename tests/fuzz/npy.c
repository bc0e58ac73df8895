/* Fuzz target: .npy files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/file/npy.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (ClothNpyReader) reader =
      cloth_npy_reader_new (cloth_input_new_memory (data, size), NULL);
  const ClothNpyInfo *info;
  gdouble sum = 0;

  if (!reader)
    return 0;
  info = cloth_npy_reader_get_info (reader);
  if (info->row_items == 0 || info->n_rows == 0)
    return 0;
  {
    g_autofree gdouble *row = g_new (gdouble, info->row_items);

    /* The header was accepted: every row it promises must be readable. */
    g_assert_true (cloth_npy_reader_read_double (reader, 0, 1, row, NULL));
    g_assert_true (cloth_npy_reader_read_double (reader, info->n_rows - 1, 1,
            row, NULL));
    sum += row[0];
  }
  return sum > 1e300;
}
