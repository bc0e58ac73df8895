/* Fuzz target: mrcal's .cameramodel. What imports must pass the rig's check; what is written
 * of it reads as the same.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <math.h>
#include <string.h>

#include "gst/rig/cameramodel.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothRig) rig = cloth_rig_import_mrcal_data (
      (const gchar *) data, size, &error), again = NULL;
  g_autofree gchar *text = NULL;

  g_assert_true (!rig != !error);
  if (!rig)
    return 0;
  g_assert_true (cloth_rig_check (rig, &error));
  text = cloth_cameramodel_to_text (&rig->cameras[0], &error);
  g_assert_no_error (error);
  again = cloth_rig_import_mrcal_data (text, strlen (text), &error);
  g_assert_no_error (error);
  g_assert_cmpmem (again->cameras[0].K, sizeof again->cameras[0].K,
      rig->cameras[0].K, sizeof rig->cameras[0].K);
  g_assert_cmpmem (again->cameras[0].k, sizeof again->cameras[0].k,
      rig->cameras[0].k, sizeof rig->cameras[0].k);
  for (guint i = 0; i < 9; i++)
    g_assert_cmpfloat (fabs (again->cameras[0].R[i] - rig->cameras[0].R[i]), <,
        1e-6);
  return 0;
}
