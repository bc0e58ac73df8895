/* Fuzz target: PLY files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <string.h>

#include "gst/mesh/formats/ply.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autofree gchar *bytes = g_malloc (size + 1);
  g_autoptr (ClothPly) ply = cloth_ply_new ();

  if (size > 0)
    memcpy (bytes, data, size);
  bytes[size] = 0;
  if (!cloth_ply_parse (ply, bytes, size, NULL))
    return 0;
  for (guint i = 0; i < 4 * ply->n_faces; i++) {
    guint32 index = g_array_index (ply->faces, guint32, i);

    g_assert_true (index < ply->n_vertices || (i % 4 == 3
            && index == CLOTH_NO_VERTEX));
  }
  return 0;
}
