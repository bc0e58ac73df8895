/* Fuzz target: a camera's file of observations, for a grid of 9 × 9 vertices.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <gst/cloth/cloth.h>
#include <math.h>

#include "gst/cloth-io/observations.h"

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothInput) input = cloth_input_new_memory (data, size);
  ClothRig *rig = cloth_rig_new (1);
  g_autoptr (ClothObservations) observations = cloth_observations_new (rig, 81);
  gboolean good;

  if (!gst_is_initialized ())
    gst_init (NULL, NULL);
  rig->cameras[0].name = g_strdup ("cam0");
  rig->cameras[0].width = 640;
  rig->cameras[0].height = 480;
  good = gst_cloth_io_observations_read (observations, 0, 9, 9, input, &error);
  g_assert_true (good == !error);
  for (guint i = 0; i < observations->list->len; i++) {
    const ClothObservation *observation =
        &g_array_index (observations->list, ClothObservation, i);

    for (guint k = 0; k < observation->n; k++)
      g_assert_true (observation->vertices[k] < 81
          && isfinite (observation->px[2 * k]));
  }
  return 0;
}
