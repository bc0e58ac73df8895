/* Cloth at rest and bodies in free motion, against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

/* x = ½ g t² whatever the step is; velocities are those of half a step ago. */
static void
test_free_fall (void)
{
  g_autoptr (ClothScene) scene = sheet_new (5, 6, 0.2, 0.25);
  g_autoptr (ClothModel) model = model_new (0.2, 50.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL, *v = NULL;
  gdouble t = 0.5, h;

  sim = run_new (scene, model);
  run_for (sim, t);
  h = 0.02 / ceil (0.02 / cloth_sim_get_time_step (sim) - 1e-9);
  x = positions_of (sim, 0);
  v = velocities_of (sim, 0);
  for (guint i = 0; i < 30; i++) {
    gdouble fallen = x[3 * i + 2] - scene->positions[3 * i + 2];

    assert_within (fallen / (-0.5 * 9.81 * t * t), 1., 1e-6);
    assert_within (v[3 * i + 2] / (-9.81 * (t - h / 2.)), 1., 1e-6);
    assert_within (x[3 * i], scene->positions[3 * i], 1e-12);
    assert_within (x[3 * i + 1], 0., 1e-12);
  }
}

/* Of Green's strain E the force in the strip is k E λ, λ = √(1 + 2E). */
static void
test_hanging_strain (void)
{
  g_autoptr (ClothScene) scene = hung_strip ();
  g_autoptr (ClothModel) model = model_new (0.2, 2000.);
  g_autoptr (ClothSim) sim = NULL;

  model->damping_mass = 40.;
  sim = run_new (scene, model);
  run_for (sim, 2.);
  assert_hung (sim, 0.2, 2000., 2e-6);
}

/* The same strip of springs, whose force is linear in their stretch. */
static void
test_hanging_springs (void)
{
  g_autoptr (ClothScene) scene = hung_strip ();
  g_autoptr (ClothModel) model = model_new (0.2, 40.);
  g_autoptr (ClothSim) sim = NULL;
  gdouble elastic = 0.;

  model->force_model = CLOTH_FORCE_MASS_SPRING;
  model->shear = 0.;
  model->damping_mass = 10.;
  sim = run_new (scene, model);
  run_for (sim, 6.);
  assert_hung (sim, 0.2, 40., 1e-6);
  for (guint row = 0; row < 20; row++) {
    gdouble strain = 0.2 * 9.81 * (1. - (row + 0.5) / 20.) / 40.;

    elastic += 0.5 * 40. * strain * strain * 0.1 / 20.;
  }
  assert_within (cloth_sim_get_energy (sim, 0).elastic / elastic, 1., 1e-4);
}

/* A cell of springs sheared by γ has the energy ½ shear γ² area, as the membrane has. */
static void
test_shear (void)
{
  const gdouble shift = 1e-3, height = 0.15, width = 0.1;

  for (guint springs = 0; springs < 2; springs++) {
    g_autoptr (ClothScene) scene = sheet_new (2, 2, width, height);
    g_autoptr (ClothModel) model = model_new (0.2, 0.);
    g_autoptr (ClothSim) sim = NULL;

    model->force_model =
        springs ? CLOTH_FORCE_MASS_SPRING : CLOTH_FORCE_MEMBRANE;
    model->shear = 30.;
    model->compression_ratio = 1.;
    scene->positions[6] += shift;
    scene->positions[9] += shift;
    sim = run_new (scene, model);
    assert_within (cloth_sim_get_energy (sim, 0).elastic / (0.5 * 30. *
            shift * shift / height * width), 1., 1e-3);
  }
}

/* m g = ½ ρ_air C A v²: a level sheet falls at √(2 ρ g/(ρ_air C)). */
static void
test_terminal_speed (void)
{
  g_autoptr (ClothScene) scene = sheet_new (5, 5, 0.2, 0.2);
  g_autoptr (ClothModel) model = model_new (0.1, 50.);
  const gdouble coefficient = 1.3;
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *v = NULL;

  for (guint i = 0; i < 25; i++) {
    scene->positions[3 * i + 1] = scene->positions[3 * i + 2];
    scene->positions[3 * i + 2] = 0.;
  }
  model->damping_stiffness = 1e-3;
  model->bending_warp = model->bending_weft = 1e-3;
  cloth_model_set_effect (model, &cloth_effect_air_drag, &coefficient);
  sim = run_new (scene, model);
  run_for (sim, 2.);
  v = velocities_of (sim, 0);
  for (guint i = 0; i < 25; i++)
    assert_within (v[3 * i + 2] / -sqrt (2. * 0.1 * 9.81 / (1.2 * 1.3)), 1.,
        2e-3);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/free-fall", test_free_fall);
  g_test_add_func ("/sim/hanging-strain", test_hanging_strain);
  g_test_add_func ("/sim/hanging-springs", test_hanging_springs);
  g_test_add_func ("/sim/shear", test_shear);
  g_test_add_func ("/sim/terminal-speed", test_terminal_speed);
  return g_test_run ();
}
