/* Fuzz target: pattern.json of colour-coded dots.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/pattern/marray.h"

#include <string.h>

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMArray) array =
      cloth_m_array_load_data ((const gchar *) data, size, &error);

  g_assert_true ((array != NULL) == (error == NULL));
  if (array) {
    /* What was read is written and reads back the same. */
    g_autofree gchar *text = cloth_m_array_to_json (array);
    g_autoptr (ClothMArray) again =
        cloth_m_array_load_data (text, strlen (text), &error);
    g_autofree gchar *same = NULL;

    g_assert_no_error (error);
    same = cloth_m_array_to_json (again);
    g_assert_cmpstr (same, ==, text);
  }
  return 0;
}
