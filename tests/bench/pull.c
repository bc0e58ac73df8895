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

#define N_TURNS 7
#define N_MODELS 16

typedef struct
{
  ClothScene *scene;
  ClothModel *models[N_MODELS];
  guint n_models;
  gdouble *still;               /* velocities */
  gdouble *weights;
  ClothPull *pulls[RAYS + 1];
} Bench;

static void
bench_init (Bench * b, guint columns, guint rows, guint n_models, gdouble step)
{
  const guint n = columns * rows;

  b->scene = cloth_scene_new (cloth_topology_new_grid (columns, rows, 0.63f,
          0.67f), 25., FRAMES + 1);
  cloth_scene_hold (b->scene, 0);
  cloth_scene_hold (b->scene, columns - 1);
  b->n_models = n_models;
  b->still = g_new0 (gdouble, 3 * n);
  b->weights = g_new (gdouble, n);
  for (guint i = 0; i < n; i++)
    b->weights[i] = 1.;
  for (Kind kind = VERTICES; kind <= RAYS; kind++) {
    b->pulls[kind] = g_new (ClothPull, n);
    for (guint i = 0; i < n; i++)
      fill (&b->pulls[kind][i], i, columns, kind, b->scene->positions);
  }
  for (guint i = 0; i < n_models; i++) {
    b->models[i] = cloth_model_new ();
    b->models[i]->stretch_warp = b->models[i]->stretch_weft = 200. + i;
    b->models[i]->shear = 60.;
    b->models[i]->damping_stiffness = 1e-4;
    b->models[i]->time_step = step;
  }
}

static void
bench_clear (Bench * b)
{
  for (guint i = 0; i < b->n_models; i++)
    cloth_model_free (b->models[i]);
  for (Kind kind = VERTICES; kind <= RAYS; kind++)
    g_free (b->pulls[kind]);
  g_free (b->weights);
  g_free (b->still);
  cloth_scene_free (b->scene);
}

/* Processor time of a second, ms. */
static gdouble
run (const Bench * b, Kind kind)
{
  const ClothSimOptions options = { b->n_models > 1, 1, CLOTH_SIMD_BEST, 0 };
  const ClothPullOptions pull_options = { CLOTH_PULL_LINEAR, 1.,
    CLOTH_PULL_BALANCED, SIGMA
  };
  const gdouble *x = b->scene->positions;
  const guint n = b->scene->topology->n_vertices;
  gdouble gains[N_MODELS], dampings[N_MODELS], start;
  g_autoptr (ClothSim) sim = cloth_sim_new (b->scene,
      (const ClothModel * const *) b->models, b->n_models, &options, NULL);

  for (guint i = 0; i < b->n_models; i++) {
    gains[i] = 100.;
    dampings[i] = 10.;
  }
  start = cpu_ms ();
  for (guint frame = 0; frame < FRAMES; frame++) {
    const gdouble now = frame / 25., next = (frame + 1) / 25.;

    if (kind == TARGETS)
      cloth_sim_set_all_targets (sim, x, x, b->still, b->still, b->weights,
          NULL, gains, dampings, now, next);
    else if (kind != FREE)
      cloth_sim_set_pulls (sim, b->pulls[kind], n, &pull_options, gains,
          dampings, now, next, NULL);
    cloth_sim_advance (sim, next);
  }
  return cpu_ms () - start;
}

/* All kinds in turn, so that a machine that slows down does so for all. */
static void
measure (guint columns, guint rows, guint n_models, gdouble step)
{
  gdouble best[RAYS + 1] = { G_MAXDOUBLE, G_MAXDOUBLE, G_MAXDOUBLE,
    G_MAXDOUBLE
  };
  Bench b;

  bench_init (&b, columns, rows, n_models, step);
  for (guint turn = 0; turn < N_TURNS; turn++)
    for (Kind kind = FREE; kind <= RAYS; kind++)
      best[kind] = MIN (best[kind], run (&b, kind));
  bench_clear (&b);
  for (Kind kind = FREE; kind <= RAYS; kind++) {
    printf ("%u × %u vertices, %2u models, %s step, %-27s %6.1f ms a second",
        columns, rows, n_models, step > 0. ? "0.2 ms" : "automatic",
        names[kind], best[kind]);
    printf (kind > TARGETS ? ", %.2f × that of targets\n" : "\n",
        best[kind] / best[TARGETS]);
  }
}

int
main (int argc, char **argv)
{
  for (guint n_models = 1; n_models <= N_MODELS; n_models += N_MODELS - 1)
    for (guint fixed = 0; fixed < 2; fixed++)
      measure (33, 35, n_models, fixed ? 2e-4 : 0.);
  return 0;
}
