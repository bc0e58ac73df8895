/* Simulator: explicit against implicit steps, knitted and woven cloth. The sheet of the
 * reference scene (0.63 × 0.67 m, 0.187 kg/m²) hung by two corners that come together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <stdio.h>

#include "gst/sim/sim.h"
#include "tests/bench/clock.h"

#define FRAMES 25

static gdouble
measure (ClothIntegrator integrator, gdouble stretch, gdouble damping,
    gdouble time_step, guint n_models)
{
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (33, 35, 0.63f, 0.67f), 50.,
      FRAMES + 1);
  const ClothSimOptions options = { n_models > 1, 1, CLOTH_SIMD_BEST, 0 };
  ClothModel *models[16];
  g_autoptr (ClothSim) sim = NULL;
  gdouble start, factor;

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, 32);
  for (guint frame = 0; frame <= FRAMES; frame++) {
    scene->clamps[6 * frame] += 0.065 * frame / FRAMES;
    scene->clamps[6 * frame + 3] -= 0.065 * frame / FRAMES;
  }
  for (guint i = 0; i < n_models; i++) {
    models[i] = cloth_model_new ();
    models[i]->stretch_warp = models[i]->stretch_weft = stretch + i;
    models[i]->shear = 60.;
    models[i]->damping_stiffness = damping;
    models[i]->integrator = integrator;
    models[i]->time_step = time_step;
  }
  sim = cloth_sim_new (scene, (const ClothModel * const *) models, n_models,
      &options, NULL);
  start = cpu_ms ();
  for (guint frame = 1; frame <= FRAMES; frame++)
    cloth_sim_advance (sim, 0.02 * frame);
  factor = 20. * FRAMES * n_models / (cpu_ms () - start);
  printf ("%s, %4.0f N/m, β %.0e s, %2u models, step %.3f ms%s: "
      "%6.2f × real time%s\n",
      integrator == CLOTH_INTEGRATOR_IMPLICIT ? "implicit" : "explicit",
      stretch, damping, n_models, 1e3 * cloth_sim_get_time_step (sim),
      time_step > 0. ? "" : " at the end", factor,
      cloth_sim_get_state (sim, 0, NULL) == CLOTH_SIM_OK ? "" : ", diverged");
  for (guint i = 0; i < n_models; i++)
    cloth_model_free (models[i]);
  return factor;
}

int
main (int argc, char **argv)
{
  /* the usual damping and the least that fabrics have */
  const gdouble cloth[][2] = {
    {200., 1e-4}, {200., 1e-3}, {4000., 1e-4}, {4000., 1e-3}
  };

  for (guint k = 0; k < G_N_ELEMENTS (cloth); k++) {
    for (guint n = 1; n <= 16; n += 15) {
      gdouble explicit = measure (CLOTH_INTEGRATOR_EXPLICIT, cloth[k][0],
          cloth[k][1], 0., n);
      gdouble implicit = measure (CLOTH_INTEGRATOR_IMPLICIT, cloth[k][0],
          cloth[k][1], 0., n);
      gdouble fixed = measure (CLOTH_INTEGRATOR_IMPLICIT, cloth[k][0],
          cloth[k][1], 5e-3, n);

      printf ("implicit over explicit: automatic × %.2f, 5 ms × %.2f\n",
          implicit / explicit, fixed / explicit);
    }
  }
  return 0;
}
