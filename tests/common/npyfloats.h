/* A whole array of numbers from a file of the test data.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/npy.h"

/* Returns: (transfer full): the numbers in C order; %NULL with @error set */
static inline gfloat *
load_npy_floats (const gchar * path, ClothNpyInfo * info, GError ** error)
{
  g_autoptr (ClothNpyReader) reader = cloth_npy_reader_open (path, error);
  g_autofree gfloat *items = NULL;

  *info = (ClothNpyInfo) { 0 };
  if (!reader)
    return NULL;
  *info = *cloth_npy_reader_get_info (reader);
  items = g_new (gfloat, MAX (info->n_rows * info->row_items, 1));
  if (!cloth_npy_reader_read_float (reader, 0, info->n_rows, items, error))
    return NULL;
  return g_steal_pointer (&items);
}
