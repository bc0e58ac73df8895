/* Fuzz target: rig.json. What loads must pass its own check.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/rig/rigfile.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig =
      cloth_rig_load_data ((const gchar *) data, size, &error);

  g_assert_true (!rig != !error);
  if (rig)
    g_assert_true (cloth_rig_check (rig, &error));
  return 0;
}
