/* Fuzz target: OBJ files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <string.h>

#include "gst/mesh/formats/obj.h"
#include "gst/mesh/seam.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autofree gchar *text = g_malloc (size + 1);
  g_autoptr (ClothObj) obj = NULL;

  if (size > 0)
    memcpy (text, data, size);
  text[size] = 0;
  obj = cloth_obj_parse (text, size, NULL);
  if (obj)
    g_assert_true (cloth_topology_check (obj->topology, NULL));
  if (obj && obj->corner_uv) {
    g_autoptr (ClothSplit) split = cloth_split_new (obj->topology,
        obj->corner_uv, NULL);

    g_assert_true (!split || cloth_topology_check (split->topology, NULL));
  }
  return 0;
}
