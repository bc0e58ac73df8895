/* The diagnosis: a sheet of 33×35 vertices over 250 frames, swayed by two corners, made by
 * the mass–spring model with air drag and noise; diagnosed by the membrane model with all
 * effects, without and with a baseline. Wall time on all processors.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gst/gap/diagnose.h"
#include "gst/math/random.h"
#include "gst/sim/effect-table.h"
#include "gst/sim/sim.h"

#define COLUMNS 33
#define ROWS 35
#define N (COLUMNS * ROWS)
#define N_FRAMES 250
#define FPS 50.
#define NOISE 4e-4

static ClothModel *
model_new (ClothForceModel force_model)
{
  static const gchar *const names[] = {
    "stretch.warp", "stretch.weft", "shear", "bending.warp", "bending.weft",
    "damping.mass", "damping.stiffness"
  };
  ClothModel *model = cloth_model_new ();

  model->force_model = force_model;
  model->damping_mass = 0.3;
  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    ClothModelFree f = { g_strdup (names[i]) };
    gdouble value;

    cloth_model_get (model, names[i], &value, NULL);
    f.range[0] = value / 30.;
    f.range[1] = value * 30.;
    g_array_append_val (model->free, f);
  }
  return model;
}

static void
clamp_at (guint held, gdouble t, gfloat p[3])
{
  gdouble close = 0.065 * MIN (1., t / 0.6);

  p[0] = (gfloat) (held ? 0.63 - close : close);
  p[1] = (gfloat) (0.06 * sin (2. * G_PI * 0.6 * t));
  p[2] = 0.f;
}

static ClothTake *
record (const gchar * folder, const gchar * name, gdouble drag, guint64 seed)
{
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 1 };
  const gdouble values[CLOTH_EFFECT_MAX_PARAMETERS] = { drag };
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MASS_SPRING);
  const ClothModel *models[1] = { model };
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (name);
  ClothTopology *topology = cloth_topology_new_grid (COLUMNS, ROWS, 0.63f,
      0.67f);
  g_autoptr (ClothScene) scene = cloth_scene_new (topology, FPS, N_FRAMES);
  g_autofree gchar *path = g_build_filename (folder, name, NULL);
  g_autofree gdouble *x = g_new (gdouble, 3 * N);
  g_autofree gfloat *positions = g_new (gfloat, 3 * N);
  g_autofree guint8 *states = g_new (guint8, N);
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autoptr (ClothSim) sim = NULL;
  ClothRandom random;

  cloth_model_set_effect (model, cloth_effect_find ("air_drag"), values);
  for (guint held = 0; held < 2; held++) {
    ClothHeld h = { held ? COLUMNS - 1 : 0, -INFINITY, INFINITY };

    cloth_scene_hold (scene, h.vertex);
    g_array_append_val (info->held, h);
  }
  for (guint f = 0; f < N_FRAMES; f++)
    for (guint held = 0; held < 2; held++) {
      gfloat p[3];

      clamp_at (held, f / FPS, p);
      for (guint k = 0; k < 3; k++)
        scene->clamps[6 * f + 3 * held + k] = p[k];
    }
  sim = cloth_sim_new (scene, models, 1, &options, NULL);
  info->fps = FPS;
  info->columns = COLUMNS;
  info->rows = ROWS;
  info->width_m = 0.63;
  info->height_m = 0.67;
  info->noise_sigma_m = NOISE;
  writer = cloth_take_writer_new (path, info, topology, NULL);
  cloth_random_init (&random, seed);
  memset (states, CLOTH_VERTEX_MEASURED, N);
  for (guint f = 0; f < N_FRAMES; f++) {
    gfloat clamps[6];

    cloth_sim_advance (sim, f / FPS);
    cloth_sim_get_positions (sim, 0, x);
    for (guint i = 0; i < 3 * N; i++)
      positions[i] = (gfloat) (x[i] + NOISE * cloth_random_gaussian (&random));
    for (guint held = 0; held < 2; held++)
      clamp_at (held, f / FPS, clamps + 3 * held);
    cloth_take_writer_append (writer, f / FPS, positions, states, NULL, clamps,
        NULL);
  }
  cloth_take_writer_close (writer, NULL);
  return cloth_take_open (path, NULL);
}

static void
measure (const gchar * what, ClothTake * take, ClothTake * baseline)
{
  const ClothGapOptions options = {
    .baselines = &baseline,.n_baselines = baseline ? 1 : 0
  };
  g_autoptr (ClothModel) model = model_new (CLOTH_FORCE_MEMBRANE);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGapResult) result = cloth_gap_diagnose (&take, 1, model,
      &options, &error);
  g_autofree gchar *summary = NULL;

  if (!result) {
    printf ("%s: %s\n", what, error->message);
    return;
  }
  summary = cloth_gap_result_summary (result);
  printf ("%s, %u effects: %.1f s (asked: 60), %" G_GUINT64_FORMAT
      " simulations of 5 s, %.1f × real time in sum\n  %s\n", what,
      result->effects->len, result->seconds, result->simulations,
      result->simulations * (N_FRAMES / FPS) / result->seconds, summary);
  for (guint i = 0; i < MIN (3, result->effects->len); i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);

    printf ("  %s %.3f, p = %.1g: %.3g ± %.2g\n", e->effect->id,
        e->probability, e->p_value, e->values[0], e->sigmas[0]);
  }
}

int
main (void)
{
  g_autofree gchar *folder = g_dir_make_tmp ("cloth-bench-XXXXXX", NULL);
  const gchar *const names[] = { "plain", "drag" };
  const gchar *const files[] = { "take.json", "positions.npy", "clamps.npy",
    "times.npy", "states.npy", "mesh.obj"
  };
  g_autoptr (ClothTake) plain = record (folder, names[0], 0., 1);
  g_autoptr (ClothTake) drag = record (folder, names[1], 2., 2);

  printf ("33×35 vertices, 250 frames, %u processors\n",
      g_get_num_processors ());
  measure ("without a baseline", drag, NULL);
  measure ("with a baseline of the same size", drag, plain);
  for (guint i = 0; i < 2; i++) {
    g_autofree gchar *path = g_build_filename (folder, names[i], NULL);

    for (guint k = 0; k < G_N_ELEMENTS (files); k++) {
      g_autofree gchar *file = g_build_filename (path, files[k], NULL);

      g_remove (file);
    }
    g_rmdir (path);
  }
  return g_rmdir (folder);
}
