/* Fuzz target: take.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <string.h>

#include "gst/take/take-info.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autofree gchar *text = g_malloc (size + 1);
  g_autoptr (ClothTakeInfo) info = NULL;

  if (size > 0)
    memcpy (text, data, size);
  text[size] = 0;
  info = cloth_take_info_parse (text, size, NULL);
  if (info) {
    g_autofree gchar *json = cloth_take_info_to_json (info);
    g_autoptr (ClothTakeInfo) again =
        cloth_take_info_parse (json, strlen (json), NULL);

    g_assert_nonnull (again);
  }
  return 0;
}
