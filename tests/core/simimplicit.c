/* Linearly implicit steps: the recurrences of backward differences at any step, closed
 * forms of physics at short ones, the explicit integrator's result in the limit, second
 * order, and lanes that do not know of each other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

static ClothModel *
implicit_new (gdouble density, gdouble stretch, gdouble time_step)
{
  ClothModel *model = model_new (density, stretch);

  model->integrator = CLOTH_INTEGRATOR_IMPLICIT;
  model->time_step = time_step;
  return model;
}

/* A single mass stepped as the simulator is to: backward differences of first and second
 * order, by how much of the change of velocity the step before foretold. */
typedef struct
{
  gdouble x, v, last_x, last_v;
  gdouble smooth;
  guint n;
} Mass;

/* x″ = g − c x′ − ω² x. */
static void
step_mass (Mass * mass, gdouble h, gdouble g, gdouble c, gdouble omega2)
{
  gdouble a = mass->smooth / 3., gamma = h * (1. - a);
  gdouble x = mass->x + a * (mass->x - mass->last_x), before = mass->v;
  gdouble v = mass->v + a * (mass->v - mass->last_v), unforeseen;

  mass->last_x = mass->x;
  v = (v + gamma * (g - omega2 * x)) / (1. + gamma * (c + gamma * omega2));
  mass->x = x + gamma * v;
  unforeseen = fabs (v - before - (before - mass->last_v)) / fabs (v - before);
  mass->smooth = mass->n++ == 0 ? 0. : CLAMP (4. - 4. * unforeseen, 0., 1.);
  mass->last_v = before;
  mass->v = v;
}

/* v = g t, and x of backward differences, to the solver's tolerance and without any
 * strain. */
static void
test_free_fall (void)
{
  g_autoptr (ClothScene) scene = sheet_new (5, 6, 0.25, 0.3125);

  for (guint automatic = 0; automatic < 2; automatic++) {
    gdouble h = automatic ? 0. : 5e-3, t = 0.5;
    g_autoptr (ClothModel) model = implicit_new (0.2, 4000., h);
    g_autoptr (ClothSim) sim = run_new (scene, model);
    g_autofree gdouble *x = NULL, *v = NULL;
    Mass mass = { 0. };

    run_for (sim, t);
    x = positions_of (sim, 0);
    v = velocities_of (sim, 0);
    for (guint i = 0; i < 100; i++)
      step_mass (&mass, 5e-3, -9.81, 0., 0.);
    for (guint i = 0; i < 30; i++) {
      gdouble fallen = x[3 * i + 2] - scene->positions[3 * i + 2];

      assert_within (v[3 * i + 2] / (-9.81 * t), 1., 1e-6);
      assert_within (fallen / (-0.5 * 9.81 * t * t), 1., automatic ? 1e-3 :
          3e-4);
      if (!automatic)
        assert_within (fallen / mass.x, 1., 1e-6);
      assert_within (x[3 * i], scene->positions[3 * i], 1e-6);
    }
  }
}

/* One quad held at one edge, the opposite one moved a little along warp or weft: a spring
 * of ω² = 2 k/(ρ L²). */
static ClothScene *
oscillator_new (ClothModel * model, gboolean weft, gdouble side, gdouble x)
{
  ClothScene *scene = sheet_new (2, 2, side, side);
  guint way = weft ? 2 : 0;

  /* else it would be another spring when pushed */
  model->compression_ratio = 1.;
  memset (scene->gravity, 0, sizeof scene->gravity);
  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, weft ? 1 : 2);
  for (guint i = weft ? 2 : 1; i < 4; i += weft ? 1 : 2)
    scene->positions[3 * i + way] += weft ? -x : x;
  return scene;
}

/* The steps are those of the backward differences, however long they are, to the solver's
 * tolerance. */
static void
test_oscillator (void)
{
  const gdouble side = 0.125, density = 0.2, alpha = 1.5;
  const gdouble beta[] = { 0., 2e-3 }, steps[] = { 2e-4, 2e-3, 0.02 };

  for (guint weft = 0; weft < 2; weft++) {
    for (guint b = 0; b < 2; b++) {
      for (guint s = 0; s < G_N_ELEMENTS (steps); s++) {
        g_autoptr (ClothModel) model = implicit_new (density, 4000., steps[s]);
        g_autoptr (ClothScene) scene = oscillator_new (model, weft, side, 1e-7);
        g_autoptr (ClothSim) sim = NULL;
        gdouble stiffness = weft ? 4000. : 3000., h = steps[s];
        gdouble omega2 = 2. * stiffness / (density * side * side);
        guint n = h < 0.02 ? 100 : 5, way = weft ? 2 : 0;
        Mass mass = { 1e-7, 0., 0., 0., 0., 0 };

        model->damping_mass = alpha;
        model->damping_stiffness = beta[b];
        model->stretch_warp = 3000.;
        sim = run_new (scene, model);
        for (guint i = 0; i < n; i++) {
          g_autofree gdouble *got = NULL;

          step_mass (&mass, h, 0., alpha + beta[b] * omega2, omega2);
          cloth_sim_advance (sim, (i + 1) * h);
          got = positions_of (sim, 0);
          assert_within (fabs (got[9 + way]) - side, mass.x, 3e-11);
        }
      }
    }
  }
}

/* x = exp (−c t/2) (cos ω₁t + c/(2 ω₁) sin ω₁t): half the step, a quarter of the error. */
static void
test_second_order (void)
{
  const gdouble side = 0.125, density = 0.2, start = 1e-6, end = 0.04;
  gdouble before = 0.;

  for (guint n = 80; n <= 640; n *= 2) {
    g_autoptr (ClothModel) model = implicit_new (density, 20., end / n);
    g_autoptr (ClothScene) scene = oscillator_new (model, FALSE, side, start);
    gdouble omega2 = 2. * 20. / (density * side * side), worst = 0.;
    gdouble c = 2. + 1e-3 * omega2, omega = sqrt (omega2 - c * c / 4.);
    g_autoptr (ClothSim) sim = NULL;

    model->damping_mass = 2.;
    model->damping_stiffness = 1e-3;
    sim = run_new (scene, model);
    for (guint i = 1; i <= 40; i++) {
      gdouble t = end * i / 40.;
      gdouble x = start * exp (-c * t / 2.) * (cos (omega * t) + c / (2. *
              omega) * sin (omega * t));
      g_autofree gdouble *got = NULL;

      for (guint k = 1; k <= n / 40; k++)
        cloth_sim_advance (sim, end * ((i - 1) * (n / 40) + k) / n);
      got = positions_of (sim, 0);
      worst = MAX (worst, fabs (got[9] - side - x) / start);
    }
    g_test_message ("%u steps: %g, ratio %.2f", n, worst, before / worst);
    if (n > 160) {
      g_assert_cmpfloat (before / worst, >, 3.5);
      g_assert_cmpfloat (before / worst, <, 4.6);
    }
    before = worst;
  }
  g_assert_cmpfloat (before, <, 2e-4);
}

/* Clamps that give: a sheet at rest hangs m g c/2 below two of them, one held everywhere
 * swings by the springs' frequency. */
static void
test_compliance (gconstpointer data)
{
  ClothIntegrator integrator = GPOINTER_TO_UINT (data);
  const gdouble compliance = 0.01, density = 0.2;
  gdouble mass = density * 0.25 * 0.3125;

  for (guint swings = 0; swings < 2; swings++) {
    g_autoptr (ClothScene) scene = swings ? sheet_new (2, 2, 0.25, 0.3125) :
        sheet_new (5, 6, 0.25, 0.3125);
    g_autoptr (ClothModel) model = model_new (density, 400.);
    g_autoptr (ClothSim) sim = NULL;
    guint n = scene->topology->n_vertices;

    model->integrator = integrator;
    if (swings)
      model->time_step = 1e-4;
    else if (integrator == CLOTH_INTEGRATOR_IMPLICIT)
      model->time_step = 5e-3;
    model->damping_mass = swings ? 0. : 20.;
    cloth_model_set_effect (model, &cloth_effect_clamp_compliance, &compliance);
    for (guint i = 0; i < n; i++)
      if (swings || i == 0 || i == 4)
        cloth_scene_hold (scene, i);
    sim = run_new (scene, model);
    if (swings) {
      gdouble omega2 = 4. / (compliance * mass);

      for (guint i = 1; i <= 10; i++) {
        gdouble t = i * 2e-3;
        g_autofree gdouble *x = NULL;

        cloth_sim_advance (sim, t);
        x = positions_of (sim, 0);
        for (guint k = 0; k < n; k++)
          assert_within ((scene->positions[3 * k + 2] - x[3 * k + 2]) /
              (9.81 / omega2), 1. - cos (sqrt (omega2) * t), 0.03);
      }
    } else {
      g_autofree gdouble *x = NULL;

      run_for (sim, 3.);
      x = positions_of (sim, 0);
      for (guint k = 0; k < 5; k += 4)
        assert_within ((scene->positions[3 * k + 2] - x[3 * k + 2]) / (mass *
                9.81 * compliance / 2.), 1., 1e-3);
    }
  }
}

/* The effect time_step scales automatic steps as far as a frame, those of a model
 * without bounds. */
static void
test_time_step (void)
{
  const gdouble factors[] = { 1., 0.25, 4. };
  gdouble usual = 0.;

  for (guint k = 0; k < G_N_ELEMENTS (factors); k++) {
    for (guint automatic = 0; automatic < 2; automatic++) {
      g_autoptr (ClothScene) scene = sheet_new (6, 7, 0.3, 0.35);
      g_autoptr (ClothModel) model =
          implicit_new (0.2, 4000., automatic ? 0. : 0.01);
      g_autoptr (ClothSim) sim = NULL;
      gdouble longest = 0.;

      cloth_scene_hold (scene, 0);
      cloth_model_set_effect (model, &cloth_effect_time_step, &factors[k]);
      sim = run_new (scene, model);
      if (!automatic) {
        assert_within (cloth_sim_get_time_step (sim), 0.01 * factors[k], 1e-12);
        continue;
      }
      for (guint i = 0; i < 20; i++) {
        run_for (sim, 0.02);
        longest = MAX (longest, cloth_sim_get_time_step (sim));
      }
      g_test_message ("factor %g: %g s", factors[k], longest);
      if (k == 0)
        usual = longest;
      g_assert_cmpfloat (longest, >=, MIN (usual * factors[k], 0.02) / 2.01);
      g_assert_cmpfloat (longest, <=, MIN (usual * factors[k] * 2.01,
              0.02 + 1e-12));
    }
  }
}

/* A woven strip hung by its upper edge, as the explicit one. */
static void
test_hanging_strain (void)
{
  g_autoptr (ClothScene) scene = hung_strip ();
  g_autoptr (ClothModel) model = implicit_new (0.2, 4000., 5e-3);
  g_autoptr (ClothSim) sim = NULL;

  model->damping_mass = 20.;
  sim = run_new (scene, model);
  run_for (sim, 2.);
  assert_hung (sim, 0.2, 4000., 2e-6);
}

static ClothScene *
swing (guint columns, guint rows)
{
  ClothScene *scene = sheet_new (columns, rows, 0.3, 0.35);

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, columns - 1);
  for (guint i = 0; i < columns * rows; i++) {
    scene->positions[3 * i + 1] = 0.5 * scene->positions[3 * i + 2];
    scene->positions[3 * i + 2] *= sqrt (0.75);
  }
  return scene;
}

static void
set_up (ClothModel * model, ClothForceModel force_model)
{
  const gdouble drag = 1.5, shrinkage[2] = { 0.02, 0.01 };

  model->force_model = force_model;
  model->bending_warp = 1e-5;
  model->bending_weft = 3e-5;
  model->damping_mass = 0.3;
  model->damping_stiffness = 2e-3;
  cloth_model_set_effect (model, &cloth_effect_air_drag, &drag);
  cloth_model_set_effect (model, &cloth_effect_shrinkage, shrinkage);
}

/* Half the step, a quarter of the distance from what the explicit integrator tends to. */
static void
test_order (gconstpointer data)
{
  ClothForceModel force_model = GPOINTER_TO_UINT (data);
  g_autoptr (ClothScene) scene = swing (6, 7);
  g_autofree gdouble *truth = NULL;
  gdouble before = 0.;

  for (guint k = 0; k < 5; k++) {
    gdouble h = k == 0 ? 5e-7 : 4e-3 / (1 << k), error = 0.;
    g_autoptr (ClothModel) model = implicit_new (0.2, 60., h);
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *x = NULL;

    set_up (model, force_model);
    if (k == 0)
      model->integrator = CLOTH_INTEGRATOR_EXPLICIT;
    sim = run_new (scene, model);
    run_for (sim, 0.1);
    x = positions_of (sim, 0);
    if (k == 0) {
      truth = g_steal_pointer (&x);
      continue;
    }
    for (guint i = 0; i < 3 * 42; i++)
      error += (x[i] - truth[i]) * (x[i] - truth[i]) / 42.;
    error = sqrt (error);
    g_test_message ("step %g s: %g m, ratio %.2f", h, error, before / error);
    if (k > 2) {
      g_assert_cmpfloat (before / error, >, 3.2);
      g_assert_cmpfloat (before / error, <, 5.5);
    }
    before = error;
  }
  g_assert_cmpfloat (before, <, 1e-4);
}

static void
run_models (const ClothScene * scene, ClothModel * const *models, guint n,
    ClothSimOptions options, gdouble * x)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = cloth_sim_new (scene,
      (const ClothModel * const *) models, n, &options, &error);

  g_assert_no_error (error);
  run_for (sim, 0.2);
  for (guint i = 0; i < n; i++)
    cloth_sim_get_positions (sim, i, x + 126 * (gsize) i);
}

/* Models that need very different numbers of iterations; 2, 8 and 16 are equal. */
static void
test_lanes (gconstpointer data)
{
  const ClothSimd sets[] =
      { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2, CLOTH_SIMD_AVX512 };
  g_autoptr (ClothScene) scene = swing (6, 7);
  gdouble all[17 * 126], other[17 * 126];
  gsize n = 126 * sizeof *all;
  ClothModel *models[17];

  for (guint i = 0; i < 17; i++) {
    guint kind = i == 8 || i == 16 ? 2 : i;

    models[i] = implicit_new (0.2, 20. * pow (1.4, kind), 4e-3);
    set_up (models[i], GPOINTER_TO_UINT (data));
  }
  for (guint single = 0; single < 2; single++) {
    for (guint s = 0; s < G_N_ELEMENTS (sets); s++) {
      run_models (scene, models, 17, (ClothSimOptions) {
          single != 0, 1 + s, sets[s], 0}
          , s ? other : all);
      if (s)
        g_assert_cmpmem (all, 17 * n, other, 17 * n);
    }
    g_assert_cmpmem (all + 2 * 126, n, all + 8 * 126, n);
    g_assert_cmpmem (all + 2 * 126, n, all + 16 * 126, n);
    g_assert_cmpint (memcmp (all, all + 126, n), !=, 0);
    for (guint i = 0; i < 17; i += 3) {
      run_models (scene, models + i, 1, (ClothSimOptions) {
          single != 0, 1, CLOTH_SIMD_BEST, 0}
          , other);
      g_assert_cmpmem (all + i * 126, n, other, n);
    }
  }
  for (guint i = 0; i < 17; i++)
    cloth_model_free (models[i]);
}

/* A woven cloth takes long steps, its threads hardly stretch, and its energy only falls. */
static void
test_woven (void)
{
  g_autoptr (ClothScene) scene = swing (13, 15);
  g_autoptr (ClothModel) model = implicit_new (0.2, 4000., 0.);
  g_autoptr (ClothModel) explicit = model_new (0.2, 4000.);
  g_autoptr (ClothSim) sim = NULL, other = NULL;
  gdouble before = INFINITY;

  model->bending_warp = model->bending_weft = 1e-5;
  sim = run_new (scene, model);
  other = run_new (scene, explicit);
  for (guint frame = 0; frame < 50; frame++) {
    ClothSimEnergy e;
    gdouble sum;

    run_for (sim, 0.02);
    e = cloth_sim_get_energy (sim, 0);
    sum = e.kinetic + e.elastic + e.gravity;
    g_assert_cmpfloat (sum, <, before + 1e-5);
    before = sum;
    g_assert_cmpfloat (e.elastic, <, 0.01);
  }
  g_test_message ("step %g s, the explicit one %g s",
      cloth_sim_get_time_step (sim), cloth_sim_get_time_step (other));
  g_assert_cmpfloat (cloth_sim_get_time_step (sim), >,
      10. * cloth_sim_get_time_step (other));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/implicit/free-fall", test_free_fall);
  g_test_add_func ("/sim/implicit/oscillator", test_oscillator);
  g_test_add_func ("/sim/implicit/second-order", test_second_order);
  g_test_add_data_func ("/sim/implicit/compliance",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_IMPLICIT), test_compliance);
  g_test_add_data_func ("/sim/implicit/compliance-explicit",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_EXPLICIT), test_compliance);
  g_test_add_func ("/sim/implicit/time-step", test_time_step);
  g_test_add_func ("/sim/implicit/hanging-strain", test_hanging_strain);
  g_test_add_data_func ("/sim/implicit/order",
      GUINT_TO_POINTER (CLOTH_FORCE_MEMBRANE), test_order);
  g_test_add_data_func ("/sim/implicit/order-mass-spring",
      GUINT_TO_POINTER (CLOTH_FORCE_MASS_SPRING), test_order);
  g_test_add_data_func ("/sim/implicit/lanes",
      GUINT_TO_POINTER (CLOTH_FORCE_MEMBRANE), test_lanes);
  g_test_add_data_func ("/sim/implicit/lanes-mass-spring",
      GUINT_TO_POINTER (CLOTH_FORCE_MASS_SPRING), test_lanes);
  g_test_add_func ("/sim/implicit/woven", test_woven);
  return g_test_run ();
}
