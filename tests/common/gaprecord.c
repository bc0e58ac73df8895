/* Recordings whose cause is known: see gaprecord.h.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gaprecord.h"

#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/sim/sim.h"

void
test_gap_free_parameters (ClothModel * model)
{
  static const gchar *const names[] = {
    "stretch.warp", "stretch.weft", "shear", "bending.warp", "bending.weft",
    "damping.mass", "damping.stiffness"
  };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    ClothModelFree f = { g_strdup (names[i]) };
    gdouble value;

    g_assert_true (cloth_model_get (model, names[i], &value, NULL));
    f.range[0] = value / 30.;
    f.range[1] = value * 30.;
    g_array_append_val (model->free, f);
  }
}

static void
clamps_at (TestGapClamp clamp, gdouble t, gfloat * clamps)
{
  for (guint held = 0; held < 2; held++)
    clamp (held, t, clamps + 3 * held);
}

ClothTake *
test_gap_record (const TestGapSheet * sheet, const ClothModel * model,
    TestGapClamp clamp, const gchar * parent, const gchar * name, guint64 seed)
{
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 1 };
  const guint n = sheet->columns * sheet->rows;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (name);
  ClothTopology *topology = cloth_topology_new_grid (sheet->columns,
      sheet->rows, (gfloat) sheet->width_m, (gfloat) sheet->height_m);
  g_autoptr (ClothScene) scene = cloth_scene_new (topology, sheet->fps,
      sheet->n_frames);
  g_autofree gchar *folder = g_build_filename (parent, name, NULL);
  g_autofree gdouble *x = g_new (gdouble, 3 * n);
  g_autofree gfloat *positions = g_new (gfloat, 3 * n);
  g_autofree guint8 *states = g_malloc (n);
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autoptr (ClothSim) sim = NULL;
  ClothTake *take;
  ClothRandom random;

  for (guint held = 0; held < 2; held++) {
    ClothHeld h = { held ? sheet->columns - 1 : 0, -INFINITY, INFINITY };

    cloth_scene_hold (scene, h.vertex);
    g_array_append_val (info->held, h);
  }
  for (guint f = 0; f < sheet->n_frames; f++) {
    gfloat clamps[6];

    clamps_at (clamp, f / sheet->fps, clamps);
    for (guint k = 0; k < 6; k++)
      scene->clamps[6 * f + k] = clamps[k];
  }
  sim = cloth_sim_new (scene, &model, 1, &options, &error);
  g_assert_no_error (error);
  info->fps = sheet->fps;
  info->columns = sheet->columns;
  info->rows = sheet->rows;
  info->width_m = sheet->width_m;
  info->height_m = sheet->height_m;
  info->noise_sigma_m = sheet->noise_m;
  writer = cloth_take_writer_new (folder, info, topology, &error);
  g_assert_no_error (error);
  cloth_random_init (&random, seed);
  memset (states, CLOTH_VERTEX_MEASURED, n);
  for (guint f = 0; f < sheet->n_frames; f++) {
    gfloat clamps[6];

    if (f)
      cloth_sim_advance (sim, f / sheet->fps);
    cloth_sim_get_positions (sim, 0, x);
    for (guint i = 0; i < 3 * n; i++)
      positions[i] = (gfloat) (x[i] +
          sheet->noise_m * cloth_random_gaussian (&random));
    for (guint v = 0; v < n && sheet->film; v++)
      sheet->film (f / sheet->fps, positions + 3 * v);
    clamps_at (sheet->logged ? sheet->logged : clamp, f / sheet->fps, clamps);
    cloth_take_writer_append (writer, f / sheet->fps, positions, states, NULL,
        clamps, &error);
    g_assert_no_error (error);
  }
  g_assert_cmpint (cloth_sim_get_state (sim, 0, NULL), ==, CLOTH_SIM_OK);
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
  take = cloth_take_open (folder, &error);
  g_assert_no_error (error);
  return take;
}

void
test_gap_remove (const gchar * path)
{
  GDir *dir = g_dir_open (path, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *item = g_build_filename (path, name, NULL);

    test_gap_remove (item);
  }
  if (dir)
    g_dir_close (dir);
  g_remove (path);
}
