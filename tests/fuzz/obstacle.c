/* Fuzz target: an obstacle's mesh, and cloth that falls on it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzz.h"

#include <math.h>

#include "gst/sim/sim.h"

/* A file of more triangles than that says nothing that a smaller one doesn't. */
#define MAX_TRIANGLES 500
#define COLUMNS 4
#define ROWS 4

static const gchar *const names[] = { "ball.obj", NULL };

static void
fall (const ClothScene * scene)
{
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 1 };
  g_autoptr (ClothModel) model = cloth_model_new ();
  const ClothModel *models[] = { model };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = NULL;
  gdouble positions[3 * COLUMNS * ROWS], since;

  g_assert_true (cloth_scene_check (scene, NULL));
  model->time_step = 1e-4;
  sim = cloth_sim_new (scene, models, 1, &options, &error);
  g_assert_true ((sim == NULL) == (error != NULL));
  if (!sim)
    return;
  cloth_sim_advance (sim, scene->times[1]);
  if (cloth_sim_get_state (sim, 0, &since) != CLOTH_SIM_OK)
    return;
  cloth_sim_get_positions (sim, 0, positions);
  for (guint i = 0; i < G_N_ELEMENTS (positions); i++)
    g_assert_true (isfinite (positions[i]));
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  gchar *folder = fuzz_folder_new (names, &bytes);
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (COLUMNS, ROWS, 0.3f, 0.3f),
      500, 2);
  g_autoptr (GError) error = NULL;
  ClothObstacle ball = { CLOTH_OBSTACLE_MESH };
  gboolean good;

  ball.friction = 0.3;
  ball.mesh = g_strdup (names[0]);
  good = cloth_obstacle_load_mesh (&ball, folder, &error);
  g_assert_true (good == (error == NULL));
  g_array_append_val (scene->obstacles, ball);
  if (good && ball.n_triangles <= MAX_TRIANGLES)
    fall (scene);
  fuzz_folder_free (names, folder);
  return 0;
}
