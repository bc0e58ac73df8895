/* Simulator: seconds of cloth a second of one processor core, single models and lanes.
 * The sheet of the reference scene (0.63 × 0.67 m, 0.187 kg/m², 200 N/m) hung by two
 * corners.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "gst/sim/sim.h"
#include "tests/bench/clock.h"

#define LANES(name) extern const ClothEffect cloth_effect_##name;
#include "gst/effect/list.h"

/* What Blender's cloth simulation took for 2.5 s of the reference scene, s: measured on
 * another machine (2 cores of Zen 5) when the simulator was planned. */
#define BLENDER_FAST 4.
#define BLENDER_SLOW 6.
/* Damping by stiffness, s: that binds no step, and that of most fabrics, which is found in stages. */
#define LITTLE 1e-4
#define MUCH 1e-3

static ClothScene *
hung_sheet (guint columns, guint rows)
{
  ClothScene *scene =
      cloth_scene_new (cloth_topology_new_grid (columns, rows, 0.63f, 0.67f),
      50., 51);

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, columns - 1);
  for (guint frame = 0; frame < 51; frame++) {
    gdouble s = MIN (frame / 30., 1.) * 0.065;

    scene->clamps[6 * frame] += s;
    scene->clamps[6 * frame + 3] -= s;
  }
  return scene;
}

static gdouble
measure (guint columns, guint rows, guint n_models, ClothSimOptions options,
    gdouble time_step, gdouble damping, const gchar * name)
{
  g_autoptr (ClothScene) scene = hung_sheet (columns, rows);
  ClothModel **models = g_new (ClothModel *, n_models);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = NULL;
  gdouble best = G_MAXDOUBLE, factor;
  guint frames = 0;

  for (guint i = 0; i < n_models; i++) {
    models[i] = cloth_model_new ();
    models[i]->stretch_warp = models[i]->stretch_weft = 200. + i;
    models[i]->shear = 60.;
    models[i]->damping_stiffness = damping;
    models[i]->time_step = time_step;
  }
  sim = cloth_sim_new (scene, (const ClothModel * const *) models, n_models,
      &options, &error);
  if (!sim)
    g_error ("%s", error->message);
  /* one frame of 20 ms at a time: the fastest is the one that nobody disturbed */
  for (gdouble start = cpu_ms ();
      frames < 5 || cpu_ms () - start < 1500; frames++) {
    gdouble t = cpu_ms ();

    cloth_sim_advance (sim, cloth_sim_get_time (sim) + 0.02);
    best = MIN (best, cpu_ms () - t);
  }
  factor = 20 * n_models / best;
  printf
      ("%-18s %4u vertices × %2u models, step %.3f ms: %6.1f × real time in "
      "sum, %.1f µs a step\n", name, columns * rows, n_models,
      1e3 * cloth_sim_get_time_step (sim), factor,
      1e3 * best / ceil (0.02 / cloth_sim_get_time_step (sim) - 1e-9));
  for (guint i = 0; i < n_models; i++)
    cloth_model_free (models[i]);
  g_free (models);
  return factor;
}

/* A sheet hung over a line: its halves fall against each other and stay so. Returns the
 * processor time of a second of it, ms. */
static gdouble
fold (guint columns, guint rows, guint n_models, ClothSimOptions options,
    gdouble thickness)
{
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (columns, rows, 0.63f, 0.67f),
      50., 51);
  gdouble best = G_MAXDOUBLE;
  ClothModel *models[16];

  for (guint i = 0; i < columns; i++)
    cloth_scene_hold (scene, rows / 2 * columns + i);
  for (guint i = 0; i < columns * rows; i++) {
    gdouble z = 0.67 * ((gdouble) (i / columns) - rows / 2) / (rows - 1);

    scene->positions[3 * i + 1] = 0.2 * z;
    scene->positions[3 * i + 2] = -sqrt (0.96) * fabs (z);
  }
  for (guint frame = 0; frame < 51; frame++)
    for (guint i = 0; i < columns; i++)
      memcpy (scene->clamps + 3 * (frame * columns + i), scene->positions +
          3 * (rows / 2 * columns + i), 3 * sizeof (gdouble));
  for (guint i = 0; i < n_models; i++) {
    models[i] = cloth_model_new ();
    models[i]->stretch_warp = models[i]->stretch_weft = 200. + i;
    models[i]->shear = 60.;
    models[i]->damping_stiffness = 1e-4;
    cloth_model_set_effect (models[i], &cloth_effect_self_contact, &thickness);
  }
  for (guint run = 0; run < 3; run++) {
    g_autoptr (ClothSim) sim = cloth_sim_new (scene,
        (const ClothModel * const *) models, n_models, &options, NULL);
    gdouble start = cpu_ms ();

    for (guint frame = 1; frame <= 50; frame++)
      cloth_sim_advance (sim, 0.02 * frame);
    best = MIN (best, cpu_ms () - start);
  }
  for (guint i = 0; i < n_models; i++)
    cloth_model_free (models[i]);
  return best;
}

static void
measure_fold (guint columns, guint rows, guint n_models,
    ClothSimOptions options, const gchar * name)
{
  gdouble plain = fold (columns, rows, n_models, options, 0.);
  gdouble contact = fold (columns, rows, n_models, options, 1e-3);

  printf
      ("%-18s %4u vertices × %2u models, folded: %6.1f × real time in sum, "
      "with contact %5.1f, %.2f times the time\n", name, columns * rows,
      n_models, 1e3 * n_models / plain, 1e3 * n_models / contact,
      contact / plain);
}

int
main (int argc, char **argv)
{
  const ClothSimOptions one = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  const ClothSimOptions avx2 = { TRUE, 1, CLOTH_SIMD_AVX2, 0 };
  const ClothSimOptions avx512 = { TRUE, 1, CLOTH_SIMD_AVX512, 0 };
  const ClothSimOptions generic = { TRUE, 1, CLOTH_SIMD_SCALAR, 0 };
  const ClothSimOptions wide = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  struct rusage usage;
  gdouble alone;

  measure (17, 18, 1, one, 0., LITTLE, "one");
  alone = measure (33, 35, 1, one, 0., LITTLE, "one");
  printf
      ("2.5 s of this scene in %.2f s; Blender's cloth took %.0f s to %.0f s "
      "of them: %.1f times as fast as the faster\n", 2.5 / alone, BLENDER_FAST,
      BLENDER_SLOW, alone * BLENDER_FAST / 2.5);
  measure (59, 59, 1, one, 0., LITTLE, "one");
  measure (33, 35, 1, one, 2e-4, LITTLE, "one");
  measure (33, 35, 16, generic, 2e-4, LITTLE, "single, generic");
  measure (33, 35, 16, avx2, 2e-4, LITTLE, "single, AVX2");
  measure (33, 35, 16, avx512, 2e-4, LITTLE, "single, AVX-512");
  /* half as many lanes cost more than half of the time: gst/sim/group.c */
  measure (33, 35, 8, avx512, 2e-4, LITTLE, "single, AVX-512");
  measure (33, 35, 8, wide, 2e-4, LITTLE, "double, best");
  printf ("gain of 16 lanes at the automatic step: × %.1f\n",
      measure (33, 35, 16, avx512, 0., LITTLE, "single, AVX-512") / alone);
  measure (59, 59, 16, avx512, 0., LITTLE, "single, AVX-512");
  measure (33, 35, 16, avx512, 0., MUCH, "in stages, AVX-512");
  getrusage (RUSAGE_SELF, &usage);
  printf ("peak memory %.1f MB\n", (gdouble) usage.ru_maxrss / 1024.);
  measure_fold (33, 35, 1, one, "one");
  measure_fold (33, 35, 16, avx512, "single, AVX-512");
  getrusage (RUSAGE_SELF, &usage);
  printf ("peak memory %.1f MB\n", (gdouble) usage.ru_maxrss / 1024.);
  return 0;
}
