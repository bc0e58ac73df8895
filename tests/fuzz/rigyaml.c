/* Fuzz target: OpenCV's and Kalibr's YAML. What imports must pass the rig's check.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include "gst/rig/rigyaml.h"

static void
check (const ClothRig * rig, const GError * error)
{
  g_autoptr (GError) wrong = NULL;

  g_assert_true (!rig != !error);
  if (rig)
    g_assert_true (cloth_rig_check (rig, &wrong));
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) opencv_error = NULL;
  g_autoptr (GError) kalibr_error = NULL;
  g_autoptr (ClothRig) opencv = cloth_rig_import_opencv_data (
      (const gchar *) data, size, 640, 480, &opencv_error);
  g_autoptr (ClothRig) kalibr = cloth_rig_import_kalibr_data (
      (const gchar *) data, size, &kalibr_error);

  check (opencv, opencv_error);
  check (kalibr, kalibr_error);
  return 0;
}
