/* Fuzz target: a take's folder as a whole, as diagnose and simulate open it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <gst/cloth/cloth.h>
#include <math.h>

#include "gst/cloth-io/observations.h"
#include "gst/sim/scene.h"

#define MAX_READ 8

static const gchar *const names[] = {
  "take.json", "positions.npy", "times.npy", "states.npy", "covariance.npy",
  "clamps.npy", "mesh.obj", "obstacle-0.obj", "rig.json",
  "observations/cam0.obs", NULL
};

static void
read_frames (ClothTake * take)
{
  const gsize n = cloth_take_get_topology (take)->n_vertices;
  const gsize held = cloth_take_get_info (take)->held->len;
  g_autofree gfloat *positions = g_new (gfloat, 3 * n);
  g_autofree gfloat *covariances = g_new (gfloat, 6 * n);
  g_autofree gfloat *clamps = g_new (gfloat, 3 * held + 1);
  g_autofree guint8 *states = g_malloc (n);

  for (guint f = 0; f < MIN (cloth_take_get_n_frames (take), MAX_READ); f++) {
    g_assert_true (isfinite (cloth_take_get_time (take, f)));
    if (!cloth_take_read_positions (take, f, positions, NULL))
      continue;
    if (cloth_take_read_states (take, f, positions, states, NULL))
      for (gsize i = 0; i < n; i++)
        g_assert_cmpuint (states[i], <=, CLOTH_VERTEX_PREDICTED);
    if (cloth_take_has_covariances (take))
      cloth_take_read_covariances (take, f, covariances, NULL);
    if (cloth_take_has_clamps (take))
      cloth_take_read_clamps (take, f, clamps, NULL);
  }
}

static void
open_take (const gchar * folder)
{
  g_autoptr (GError) error = NULL, scene_error = NULL;
  g_autoptr (ClothTake) take = cloth_take_open (folder, &error);
  g_autoptr (ClothScene) scene = NULL;
  ClothObservations *observations = NULL;
  g_autofree gchar *hash = NULL;

  g_assert_true ((take == NULL) == (error != NULL));
  if (!take)
    return;
  g_assert_true (cloth_topology_check (cloth_take_get_topology (take), NULL));
  read_frames (take);
  scene = cloth_scene_new_from_take (take, &scene_error);
  g_assert_true ((scene == NULL) == (scene_error != NULL));
  if (scene)
    g_assert_true (cloth_scene_check (scene, NULL));
  g_assert_true (gst_cloth_io_observations_load_take (take, NULL, &observations,
          &error) == (error == NULL));
  cloth_observations_free (observations);
  hash = cloth_take_sha256 (take, NULL);
  g_assert_nonnull (hash);
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  gchar *folder = fuzz_folder_new (names, &bytes);

  if (!gst_is_initialized ())
    gst_init (NULL, NULL);
  open_take (folder);
  fuzz_folder_free (names, folder);
  return 0;
}
