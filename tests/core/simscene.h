/* Sheets and runs that the tests of the simulator share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <math.h>
#include <string.h>

#include "gst/sim/sim.h"

#define LANES(name) extern const ClothEffect cloth_effect_##name;
#define SCENE(name) LANES (name)
#include "gst/effect/list.h"

G_GNUC_UNUSED static ClothScene *
sheet_new (guint columns, guint rows, gdouble width, gdouble height)
{
  return cloth_scene_new (cloth_topology_new_grid (columns, rows,
          (gfloat) width, (gfloat) height), 50., 2);
}

/* Stretch k, shear 0.3 k, no bending and no damping unless the test adds them. */
G_GNUC_UNUSED static ClothModel *
model_new (gdouble density, gdouble stretch)
{
  ClothModel *model = cloth_model_new ();

  model->areal_density = density;
  model->stretch_warp = model->stretch_weft = stretch;
  model->shear = 0.3 * stretch;
  model->bending_warp = model->bending_weft = 0.;
  model->damping_mass = model->damping_stiffness = 0.;
  return model;
}

G_GNUC_UNUSED static ClothSim *
run_new (const ClothScene * scene, const ClothModel * model)
{
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  g_autoptr (GError) error = NULL;
  ClothSim *sim = cloth_sim_new (scene, &model, 1, &options, &error);

  g_assert_no_error (error);
  return sim;
}

/* Advances in frames of 20 ms, as its users do. */
G_GNUC_UNUSED static void
run_for (ClothSim * sim, gdouble seconds)
{
  gdouble start = cloth_sim_get_time (sim);
  guint n = (guint) ceil (seconds / 0.02 - 1e-9);

  for (guint i = 1; i <= n; i++)
    cloth_sim_advance (sim, start + seconds * i / n);
  for (guint i = 0; i < cloth_sim_get_n_models (sim); i++)
    g_assert_cmpint (cloth_sim_get_state (sim, i, NULL), ==, CLOTH_SIM_OK);
}

G_GNUC_UNUSED static gdouble *
positions_of (const ClothSim * sim, guint model)
{
  gdouble *x = g_new (gdouble, 3 * (gsize) cloth_sim_get_n_vertices (sim));

  cloth_sim_get_positions (sim, model, x);
  return x;
}

G_GNUC_UNUSED static gdouble *
velocities_of (const ClothSim * sim, guint model)
{
  gdouble *v = g_new (gdouble, 3 * (gsize) cloth_sim_get_n_vertices (sim));

  cloth_sim_get_velocities (sim, model, v);
  return v;
}

G_GNUC_UNUSED static gdouble *
state_at (const ClothScene * scene, const ClothModel * model, gdouble seconds)
{
  g_autoptr (ClothSim) sim = run_new (scene, model);

  run_for (sim, seconds);
  return positions_of (sim, 0);
}

#define assert_within(value, expected, tolerance) \
  g_assert_cmpfloat_with_epsilon (value, expected, tolerance)

/* The sway of the takes: two corners close and move to and fro. */
G_GNUC_UNUSED static ClothScene *
sway_scene (guint columns, guint rows)
{
  ClothScene *scene =
      cloth_scene_new (cloth_topology_new_grid (columns, rows, 0.63f, 0.67f),
      50., 101);

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, columns - 1);
  for (guint frame = 0; frame < 101; frame++) {
    gdouble t = 0.02 * frame, s = MIN (t / 0.6, 1.);

    for (guint h = 0; h < 2; h++) {
      scene->clamps[6 * frame + 3 * h] += (h ? -1. : 1.) * 0.065 * s;
      scene->clamps[6 * frame + 3 * h + 1] =
          0.06 * s * sin (2. * G_PI * 0.6 * t);
    }
  }
  return scene;
}

/* A strip 3 × 21 of length 1 m hung by its upper edge is stretched by ρ g (L − z)/k at
 * depth z. */
G_GNUC_UNUSED static ClothScene *
hung_strip (void)
{
  ClothScene *scene = sheet_new (3, 21, 0.1, 1.);

  for (guint i = 0; i < 3; i++)
    cloth_scene_hold (scene, i);
  return scene;
}

G_GNUC_UNUSED static void
assert_hung (const ClothSim * sim, gdouble density, gdouble stretch,
    gdouble tolerance)
{
  g_autofree gdouble *x = positions_of (sim, 0);

  for (guint row = 0; row < 20; row++) {
    gdouble z = (row + 0.5) / 20.;
    gdouble length = x[3 * (3 * row + 1) + 2] - x[3 * (3 * row + 4) + 2];

    assert_within (length * 20. - 1., density * 9.81 * (1. - z) / stretch,
        tolerance);
  }
}
