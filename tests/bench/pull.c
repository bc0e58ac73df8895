/* Pulls: what a step of a sheet that is drawn costs, beside one that the observer's springs
 * draw and one that nothing draws.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gst/sim/sim.h"
#include "tests/bench/clock.h"

#define FRAMES 25
#define SIGMA 0.001

typedef enum
{ FREE, TARGETS, VERTICES, RAYS } Kind;

static const gchar *const names[] =
    { "free", "targets at vertices", "pulls at vertices",
  "pulls of rays in triangles"
};

static void
fill (ClothPull * pull, guint v, guint columns, Kind kind, const gdouble * y)
{
  const guint32 other[2] = { v % columns ? v - 1 : v + 1,
    v >= columns ? v - columns : v + columns
  };

  *pull = (ClothPull) { {
  v, v, v}, {
  1., 0., 0.}};
  for (guint k = 0; k < 3; k++) {
    pull->now.target[k] = y[3 * v + k];
    pull->now.information[k] = 1. / (SIGMA * SIGMA);
  }
  if (kind == RAYS) {
    memcpy (pull->corner + 1, other, sizeof other);
    memcpy (pull->weight, (const gdouble[]) { 0.4, 0.3, 0.3 },
        sizeof pull->weight);
    pull->now.information[1] = 0.;
  }
  pull->next = pull->now;
}

/* Processor time of a second, ms. */
static gdouble
run (Kind kind, guint columns, guint rows, guint n_models, gdouble step)
{
  const ClothSimOptions options = { n_models > 1, 1, CLOTH_SIMD_BEST, 0 };
  const ClothPullOptions pull_options = { CLOTH_PULL_LINEAR, 1.,
    CLOTH_PULL_BALANCED, SIGMA
  };
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (columns, rows, 0.63f, 0.67f),
      25., FRAMES + 1);
  const guint n = columns * rows;
  g_autofree gdouble *u = g_new0 (gdouble, 3 * n);
  g_autofree gdouble *weights = g_new (gdouble, n);
  g_autofree ClothPull *pulls = g_new (ClothPull, n);
  ClothModel *models[16];
  gdouble gains[16], dampings[16], best = G_MAXDOUBLE;

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, columns - 1);
  for (guint i = 0; i < n; i++) {
    weights[i] = 1.;
    fill (&pulls[i], i, columns, kind, scene->positions);
  }
  for (guint i = 0; i < n_models; i++) {
    models[i] = cloth_model_new ();
    models[i]->stretch_warp = models[i]->stretch_weft = 200. + i;
    models[i]->shear = 60.;
    models[i]->damping_stiffness = 1e-4;
    models[i]->time_step = step;
    gains[i] = 100.;
    dampings[i] = 10.;
  }
  for (guint turn = 0; turn < 5; turn++) {
    g_autoptr (ClothSim) sim = cloth_sim_new (scene,
        (const ClothModel * const *) models, n_models, &options, NULL);
    gdouble start = cpu_ms ();

    for (guint frame = 0; frame < FRAMES; frame++) {
      gdouble now = frame / 25., next = (frame + 1) / 25.;

      if (kind == TARGETS)
        cloth_sim_set_all_targets (sim, scene->positions, scene->positions, u,
            u, weights, NULL, gains, dampings, now, next);
      else if (kind != FREE)
        cloth_sim_set_pulls (sim, pulls, n, &pull_options, gains, dampings,
            now, next, NULL);
      cloth_sim_advance (sim, next);
    }
    best = MIN (best, cpu_ms () - start);
  }
  for (guint i = 0; i < n_models; i++)
    cloth_model_free (models[i]);
  return best;
}

int
main (int argc, char **argv)
{
  for (guint n_models = 1; n_models <= 16; n_models += 15)
    for (guint fixed = 0; fixed < 2; fixed++) {
      gdouble targets = 0.;

      for (Kind kind = FREE; kind <= RAYS; kind++) {
        gdouble ms = run (kind, 33, 35, n_models, fixed ? 2e-4 : 0.);

        if (kind == TARGETS)
          targets = ms;
        printf ("33 × 35 vertices, %2u models, %s step, %-27s %6.1f ms a "
            "second", n_models, fixed ? "0.2 ms" : "automatic", names[kind],
            ms);
        printf (kind > TARGETS ? ", %.2f × that of targets\n" : "\n",
            ms / targets);
      }
    }
  return 0;
}
