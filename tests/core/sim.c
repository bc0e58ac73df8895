/* The simulator's promises: lanes, threads and instruction sets change no bit, clamps
 * hold and let go, a model that blows up takes nobody with it, and nonsense is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#define N_MODELS 19
/* As many as fill the widest lanes. */
#define N_WIDE 16

/* Nineteen models of a small sheet held by two corners; 3, 8 and 17 are equal. Some have
 * drag, two are shrunk; the others have neither, or both at their null. */
static void
make_models (ClothModel * models[N_MODELS], gboolean null)
{
  for (guint i = 0; i < N_MODELS; i++) {
    guint kind = i == 8 || i == 17 ? 3 : i;
    gdouble drag = 0.3 * (kind % 4), shrink = kind % 7 == 5 ? 0.01 : 0.;
    const gdouble shrinkage[CLOTH_EFFECT_MAX_PARAMETERS] = { shrink, shrink };

    models[i] = model_new (0.2, 30. + kind);
    models[i]->bending_warp = 1e-5 * (1 + kind % 3);
    models[i]->bending_weft = 2e-5;
    models[i]->damping_mass = 0.1 * (kind % 5);
    models[i]->damping_stiffness = 1e-4;
    if (null || kind % 4)
      cloth_model_set_effect (models[i], &cloth_effect_air_drag, &drag);
    if (null || shrink > 0.)
      cloth_model_set_effect (models[i], &cloth_effect_shrinkage, shrinkage);
  }
}

static ClothScene *
swing (void)
{
  ClothScene *scene = sheet_new (6, 7, 0.3, 0.35);

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, 5);
  for (guint i = 0; i < 42; i++) {
    scene->positions[3 * i + 1] = 0.5 * scene->positions[3 * i + 2];
    scene->positions[3 * i + 2] *= sqrt (0.75);
  }
  return scene;
}

static gdouble *
run_all (const ClothScene * scene, ClothModel * const *models, guint n_models,
    ClothSimOptions options)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = cloth_sim_new (scene,
      (const ClothModel * const *) models, n_models, &options, &error);
  guint n = 3 * scene->topology->n_vertices;
  gdouble *result = g_new (gdouble, 2 * n * (gsize) n_models);

  g_assert_no_error (error);
  run_for (sim, 0.2);
  for (guint i = 0; i < n_models; i++) {
    cloth_sim_get_positions (sim, i, result + 2 * n * (gsize) i);
    cloth_sim_get_velocities (sim, i, result + 2 * n * (gsize) i + n);
  }
  return result;
}

/* Every instruction set, thread count, place in the groups and neighbour there. */
static void
test_lanes (void)
{
  const ClothSimd sets[] =
      { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2, CLOTH_SIMD_AVX512 };
  g_autoptr (ClothScene) scene = swing ();
  gsize n = 6 * scene->topology->n_vertices;
  ClothModel *models[N_MODELS], *alike[N_MODELS];

  make_models (models, FALSE);
  make_models (alike, TRUE);
  for (guint kind = 0; kind < 4; kind++) {
    g_autofree gdouble *reference = NULL;
    guint single = kind % 2;

    for (guint i = 0; i < N_MODELS; i++) {
      models[i]->force_model = alike[i]->force_model =
          kind / 2 ? CLOTH_FORCE_MASS_SPRING : CLOTH_FORCE_MEMBRANE;
      /* one step for all, however they are grouped */
      models[i]->time_step = alike[i]->time_step = 5e-4;
    }
    for (guint s = 0; s < G_N_ELEMENTS (sets); s++) {
      for (guint threads = 1; threads <= 3; threads += 2) {
        g_autofree gdouble *got = run_all (scene, models, N_MODELS,
            (ClothSimOptions) { single != 0, threads, sets[s], 0 }
        );

        /* these need not be parted, so that their lanes are as wide as they can be */
        g_autofree gdouble *wide = run_all (scene, alike, N_WIDE,
            (ClothSimOptions) { single != 0, threads, sets[s], 0 }
        );

        g_assert_cmpmem (got, N_WIDE * n * sizeof (gdouble), wide,
            N_WIDE * n * sizeof (gdouble));
        if (!reference)
          reference = g_steal_pointer (&got);
        else
          g_assert_cmpmem (reference, N_MODELS * n * sizeof (gdouble), got,
              N_MODELS * n * sizeof (gdouble));
      }
    }
    for (guint i = 8; i < 18; i += 9)
      g_assert_cmpmem (reference + 3 * n, n * sizeof (gdouble),
          reference + i * n, n * sizeof (gdouble));
    g_assert_cmpint (memcmp (reference, reference + n, n * sizeof (gdouble)),
        !=, 0);
    /* each alone: in the single double for one of them */
    for (guint i = 0; i < N_MODELS; i++) {
      g_autofree gdouble *alone = run_all (scene, models + i, 1,
          (ClothSimOptions) { single != 0, 1, CLOTH_SIMD_BEST, 0 }
      );

      g_assert_cmpmem (reference + i * n, n * sizeof (gdouble), alone,
          n * sizeof (gdouble));
    }
  }
  for (guint i = 0; i < N_MODELS; i++) {
    cloth_model_free (models[i]);
    cloth_model_free (alike[i]);
  }
}

/* Single precision follows double precision. */
static void
test_single (void)
{
  g_autoptr (ClothScene) scene = swing ();
  gsize n = 6 * scene->topology->n_vertices;
  g_autofree gdouble *one = NULL, *two = NULL;
  ClothModel *models[N_MODELS];

  make_models (models, FALSE);
  one = run_all (scene, models, N_MODELS, (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_BEST, 0});
  two = run_all (scene, models, N_MODELS, (ClothSimOptions) {
      TRUE, 1, CLOTH_SIMD_BEST, 0});
  for (guint i = 0; i < N_MODELS; i++)
    for (guint k = 0; k < n / 2; k++)
      assert_within (two[i * n + k], one[i * n + k], 1e-4);
  for (guint i = 0; i < N_MODELS; i++)
    cloth_model_free (models[i]);
}

/* An effect at its null leaves no trace. */
static void
test_null (void)
{
  g_autoptr (ClothScene) scene = swing ();
  g_autoptr (ClothModel) without = model_new (0.2, 40.);
  g_autoptr (ClothModel) with = model_new (0.2, 40.);
  ClothModel *models[2] = { without, with };
  gsize n = 6 * scene->topology->n_vertices;
  g_autofree gdouble *got = NULL, *alone = NULL;

  cloth_model_set_effect (with, &cloth_effect_air_drag, NULL);
  got = run_all (scene, models, 2, (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_BEST, 0});
  alone = run_all (scene, models, 1, (ClothSimOptions) {
      FALSE, 1, CLOTH_SIMD_BEST, 0});
  g_assert_cmpmem (got, n * sizeof (gdouble), got + n, n * sizeof (gdouble));
  g_assert_cmpmem (got, n * sizeof (gdouble), alone, n * sizeof (gdouble));
}

/* A clamp follows its path exactly at frames, lets go when told, and grips again gently. */
static void
test_clamps (void)
{
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_new_grid (4, 4, 0.1f, 0.1f), 50., 41);
  g_autoptr (ClothModel) model = model_new (0.2, 40.);
  g_autoptr (ClothSim) sim = NULL;
  ClothHeld *held;

  model->damping_mass = 2.;
  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, 3);
  for (guint frame = 0; frame < 41; frame++)
    for (guint h = 0; h < 2; h++)
      scene->clamps[6 * frame + 3 * h + 1] = 0.05 * sin (0.02 * frame * 9.);
  held = &g_array_index (scene->held, ClothHeld, 1);
  held->until_s = 0.4;
  /* what comes after the release means nothing */
  for (guint frame = 20; frame < 41; frame++)
    scene->clamps[6 * frame + 3] = 1e30;
  sim = run_new (scene, model);
  for (guint frame = 1; frame < 41; frame++) {
    g_autofree gdouble *x = NULL;

    cloth_sim_advance (sim, 0.02 * frame);
    x = positions_of (sim, 0);
    for (guint k = 0; k < 3; k++) {
      assert_within (x[k], scene->clamps[6 * frame + k], 1e-15);
      if (frame < 20)
        assert_within (x[9 + k], scene->clamps[6 * frame + 3 + k], 1e-15);
    }
    if (frame == 30)
      g_assert_cmpfloat (x[11], <, -0.02);
  }
  g_assert_cmpint (cloth_sim_get_state (sim, 0, NULL), ==, CLOTH_SIM_OK);
}

/* Model 1 takes steps far too long for its stiffness. */
static void
test_divergence (void)
{
  g_autoptr (ClothScene) scene = swing ();
  g_autoptr (ClothModel) calm = model_new (0.2, 40.);
  g_autoptr (ClothModel) wild = model_new (0.2, 1e6);
  const ClothModel *models[2] = { calm, wild };
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  g_autoptr (ClothSim) sim = NULL, alone = NULL;
  g_autofree gdouble *start = g_memdup2 (scene->positions,
      3 * scene->topology->n_vertices * sizeof (gdouble));
  g_autofree gdouble *v = NULL, *x = NULL, *y = NULL;
  gdouble since;
  guint n = scene->topology->n_vertices;

  calm->time_step = wild->time_step = 5e-4;
  sim = cloth_sim_new (scene, models, 2, &options, NULL);
  alone = cloth_sim_new (scene, models, 1, &options, NULL);
  for (guint frame = 1; frame <= 10; frame++) {
    cloth_sim_advance (sim, 0.02 * frame);
    cloth_sim_advance (alone, 0.02 * frame);
  }
  g_assert_cmpint (cloth_sim_get_state (sim, 0, &since), ==, CLOTH_SIM_OK);
  g_assert_true (isnan (since));
  g_assert_cmpint (cloth_sim_get_state (sim, 1, &since), ==,
      CLOTH_SIM_DIVERGED);
  g_assert_cmpfloat (since, <, 0.1);
  x = positions_of (sim, 0);
  y = positions_of (alone, 0);
  g_assert_cmpmem (x, 3 * n * sizeof *x, y, 3 * n * sizeof *y);
  g_free (x);
  x = positions_of (sim, 1);
  v = velocities_of (sim, 1);
  for (guint i = 0; i < 3 * n; i++) {
    g_assert_true (isfinite (x[i]));
    g_assert_cmpfloat (v[i], ==, 0.);
  }
  /* it can be set going again */
  cloth_sim_set_state (sim, 1, start, NULL, cloth_sim_get_time (sim));
  g_assert_cmpint (cloth_sim_get_state (sim, 1, NULL), ==, CLOTH_SIM_OK);
}

/* One model is set to where it is. Its clamps grip anew; those of its neighbour don't notice, nor do the steps, which are
 * shorter as both are stretched far. */
static void
test_set_beside (void)
{
  const ClothSimOptions options = { TRUE, 1, CLOTH_SIMD_BEST, 0 };
  g_autoptr (ClothScene) scene = swing ();
  g_autoptr (ClothModel) one = model_new (0.2, 40.);
  const ClothModel *models[2] = { one, one };
  const gsize size = 3 * scene->topology->n_vertices * sizeof (gdouble);

  for (guint i = 1; i < 5; i++)
    cloth_scene_hold (scene, i);
  for (guint i = 6; i < 42; i++)
    scene->positions[3 * i + 2] -= 0.15;
  for (guint k = 0; k < 2; k++) {
    gdouble *x[2], step[2];

    one->time_step = k ? 2e-4 : 0.;
    for (guint set = 0; set < 2; set++) {
      g_autoptr (ClothSim) sim = cloth_sim_new (scene, models, 2, &options,
          NULL);

      cloth_sim_advance (sim, 0.002);
      if (set) {
        g_autofree gdouble *at = positions_of (sim, 0);
        g_autofree gdouble *v = velocities_of (sim, 0);

        cloth_sim_set_state (sim, 0, at, v, cloth_sim_get_time (sim));
      }
      cloth_sim_advance (sim, 0.004);
      step[set] = cloth_sim_get_time_step (sim);
      x[set] = positions_of (sim, 1);
    }
    g_assert_cmpfloat (step[0], ==, step[1]);
    g_assert_cmpmem (x[0], size, x[1], size);
    g_free (x[0]);
    g_free (x[1]);
  }
}

static void
test_disagree (void)
{
  g_autoptr (ClothScene) scene = swing ();
  g_autoptr (ClothModel) one = model_new (0.2, 40.);
  g_autoptr (ClothModel) two = model_new (0.2, 40.);
  const ClothModel *models[2] = { one, two };
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_sim_new (scene, models, 0, NULL, &error));
  g_assert_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL);
  g_clear_error (&error);
  two->time_step = 1e-3;
  g_assert_null (cloth_sim_new (scene, models, 2, NULL, &error));
  g_assert_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL);
  g_assert_nonnull (strstr (error->message, "time_step"));
  g_clear_error (&error);
  two->time_step = 0.;
  two->integrator = CLOTH_INTEGRATOR_IMPLICIT;
  g_assert_null (cloth_sim_new (scene, models, 2, NULL, &error));
  g_assert_nonnull (strstr (error->message, "integrator"));
  g_clear_error (&error);
  two->integrator = one->integrator;
  two->force_model = CLOTH_FORCE_MASS_SPRING;
  g_assert_null (cloth_sim_new (scene, models, 2, NULL, &error));
  g_assert_nonnull (strstr (error->message, "force_model"));
}

/* Steps so short that a simulation would never end are refused, by what asks for them. */
static void
test_short_steps (void)
{
  static const struct
  {
    gdouble time_step, stretch, damping_stiffness;
    const gchar *said;
  } cases[] = {
    {1e-12, 40., 0., "“time_step” is 1e-12"}, {1e-8, 40., 0., NULL},
    {0., 1e7, 1., "“stretch” is 1e+07"}, {0., 40., 0., NULL}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (ClothScene) scene = swing ();
    g_autoptr (ClothModel) calm = model_new (0.2, 40.);
    g_autoptr (ClothModel) model = model_new (0.2, cases[i].stretch);
    const ClothModel *models[2] = { calm, model };
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothSim) sim = NULL;

    calm->time_step = model->time_step = cases[i].time_step;
    model->damping_stiffness = cases[i].damping_stiffness;
    sim = cloth_sim_new (scene, models, 2, NULL, &error);
    if (!cases[i].said) {
      g_assert_no_error (error);
      continue;
    }
    g_assert_null (sim);
    g_assert_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL);
    g_assert_nonnull (strstr (error->message, cases[i].said));
  }
}

/* Numbers that no cloth has, in the scene or in one of the models. */
static void
test_numbers (void)
{
  for (guint i = 0; i < 3; i++) {
    g_autoptr (ClothScene) scene = swing ();
    g_autoptr (ClothModel) one = model_new (0.2, 40.), two =
        model_new (0.2, 40.);
    const ClothModel *models[2] = { one, two };
    g_autoptr (GError) error = NULL;

    if (i == 0)
      two->stretch_warp = -40.;
    else if (i == 1)
      two->areal_density = NAN;
    else
      scene->positions[4] = INFINITY;
    g_assert_null (cloth_sim_new (scene, models, 2, NULL, &error));
    g_assert_error (error, CLOTH_SIM_ERROR, (i < 2 ? CLOTH_SIM_ERROR_MODEL :
            CLOTH_SIM_ERROR_SCENE));
    g_test_message ("%s", error->message);
    g_assert_nonnull (strstr (error->message,
            i == 0 ? "model 1: “stretch.warp”" : i ==
            1 ? "model 1: “areal_density”" : "vertex 1 along y is inf"));
  }
}

/* Meshes that are no cloth. */
static void
test_scene (void)
{
  g_autoptr (ClothModel) model = model_new (0.2, 40.);
  const ClothModel *models[1] = { model };
  const struct
  {
    guint faces;
    guint32 corners[12];
    const gchar *says;
  } cases[] = {
    {1, {0, 1, 1, CLOTH_NO_VERTEX}, "face 0 has vertex 1 twice"},
    {1, {0, 1, 2, CLOTH_NO_VERTEX}, "vertex 3"},
    {3, {0, 1, 2, CLOTH_NO_VERTEX, 1, 2, 3, CLOTH_NO_VERTEX, 2, 1, 3,
            CLOTH_NO_VERTEX}, "faces 1 and 2 are the same"},
  };
  const gfloat uv[8] = { 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 1.f };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    ClothTopology *topology = cloth_topology_new (4, cases[i].faces);
    g_autoptr (ClothScene) scene = NULL;
    g_autoptr (GError) error = NULL;

    memcpy (topology->uv, uv, sizeof uv);
    memcpy (topology->faces, cases[i].corners,
        4 * cases[i].faces * sizeof (guint32));
    scene = cloth_scene_new (topology, 50., 1);
    g_assert_null (cloth_sim_new (scene, models, 1, NULL, &error));
    g_assert_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE);
    g_assert_nonnull (strstr (error->message, cases[i].says));
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/lanes", test_lanes);
  g_test_add_func ("/sim/single", test_single);
  g_test_add_func ("/sim/null", test_null);
  g_test_add_func ("/sim/clamps", test_clamps);
  g_test_add_func ("/sim/divergence", test_divergence);
  g_test_add_func ("/sim/set-beside", test_set_beside);
  g_test_add_func ("/sim/disagree", test_disagree);
  g_test_add_func ("/sim/short-steps", test_short_steps);
  g_test_add_func ("/sim/numbers", test_numbers);
  g_test_add_func ("/sim/scene", test_scene);
  return g_test_run ();
}
