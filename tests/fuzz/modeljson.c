/* Fuzz target: model.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <string.h>

#include "gst/sim/model.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autofree gchar *text = g_malloc (size + 1);
  g_autoptr (ClothModel) model = NULL;

  if (size > 0)
    memcpy (text, data, size);
  text[size] = 0;
  model = cloth_model_parse (text, size, NULL);
  if (model) {
    g_autofree gchar *json = cloth_model_to_json (model);
    g_autoptr (ClothModel) again =
        cloth_model_parse (json, strlen (json), NULL);

    g_assert_nonnull (again);
  }
  return 0;
}
