/* Fuzz target: the points that say where a rig's world is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <math.h>

#include "gst/rig/world.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (ClothRig) rig = cloth_rig_new (2);
  g_autoptr (GError) error = NULL;
  g_autoptr (GArray) points = NULL;
  gdouble rms, scale;
  ClothWorld world;

  for (guint c = 0; c < 2; c++) {
    ClothCamera *camera = &rig->cameras[c];

    camera->name = g_strdup (c ? "b" : "a");
    camera->width = 640;
    camera->height = 480;
    camera->K[0] = camera->K[4] = 500;
    camera->K[2] = 320;
    camera->K[5] = 240;
    camera->t[0] = -0.1 * c;
  }
  points = cloth_world_points_parse (rig, (const gchar *) data, size, &error);
  g_assert_true (!points != !error);
  /* Time grows with the square of their number. */
  if (!points || points->len > 200)
    return 0;
  if (cloth_world_of_points (rig, points->len,
          (const ClothWorldPoint *) points->data, &world, &rms, &scale,
          &error)) {
    for (guint i = 0; i < 9; i++)
      g_assert_true (fabs (world.R[i]) < 1.001);
  } else {
    g_assert_nonnull (error);
  }
  return 0;
}
