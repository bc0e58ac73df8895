/* Cloth that touches itself: it rests at its thickness, slides by Coulomb's law, and never
 * goes through itself, which all pairs of triangles are asked for; momentum, energy and
 * bits are as they should be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simcrossings.h"
#include "simscene.h"

#define THICKNESS 1e-3

static void
touch (ClothModel * model, gdouble thickness)
{
  cloth_model_set_effect (model, &cloth_effect_self_contact, &thickness);
}

/* Grids side by side on the flat cloth; where they start is for the test to say. */
static ClothScene *
sheets_new (guint n_sheets, guint columns, guint rows, gdouble width,
    gdouble height)
{
  guint each = columns * rows, quads = (columns - 1) * (rows - 1);
  ClothTopology *t = cloth_topology_new (n_sheets * each, n_sheets * quads);
  ClothScene *scene;

  for (guint s = 0; s < n_sheets; s++) {
    for (guint i = 0; i < each; i++) {
      t->uv[2 * (s * each + i)] = (gfloat) (width * (i % columns) /
          (columns - 1) + 2. * width * s);
      t->uv[2 * (s * each + i) + 1] = (gfloat) (height * (i / columns) /
          (rows - 1));
    }
    for (guint i = 0; i < quads; i++) {
      guint32 a = s * each + i / (columns - 1) * columns + i % (columns - 1);
      guint32 face[4] = { a, a + 1, a + columns + 1, a + columns };

      memcpy (t->faces + 4 * (s * quads + i), face, sizeof face);
    }
  }
  scene = cloth_scene_new (t, 50., 2);
  for (guint s = 0; s < n_sheets; s++) {
    for (guint i = 0; i < each; i++) {
      gdouble *x = scene->positions + 3 * (s * each + i);

      x[0] = width * (i % columns) / (columns - 1);
      x[1] = height * (i / columns) / (rows - 1);
      x[2] = 0.;
    }
  }
  return scene;
}

static void
shift (ClothScene * scene, guint first, guint n, gdouble x, gdouble y,
    gdouble z)
{
  for (guint i = first; i < first + n; i++) {
    scene->positions[3 * i] += x;
    scene->positions[3 * i + 1] += y;
    scene->positions[3 * i + 2] += z;
  }
}

/* What the tests for crossings rely on. */
static void
test_count (void)
{
  g_autoptr (ClothScene) scene = sheets_new (2, 3, 3, 0.1, 0.1);

  shift (scene, 9, 9, 0.013, 0.007, 0.01);
  g_assert_cmpuint (count_crossings (scene->topology, scene->positions), ==, 0);
  /* one corner of the upper sheet through the lower one */
  scene->positions[3 * 9 + 2] = -0.001;
  g_assert_cmpuint (count_crossings (scene->topology, scene->positions), >, 0);
}

/* A sheet falls flat on another, which is held or lies on a table. */
static void
test_rest (void)
{
  enum
  { COLUMNS = 7, ROWS = 6, N = COLUMNS * ROWS };

  for (guint table = 0; table < 2; table++) {
    g_autoptr (ClothScene) scene = sheets_new (2, COLUMNS, ROWS, 0.12, 0.1);
    g_autoptr (ClothModel) model = model_new (0.2, 100.);
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *x = NULL;

    shift (scene, N, N, 0.0043, 0.0031, 0.01);
    model->damping_mass = 2.;
    model->bending_warp = model->bending_weft = 2e-5;
    touch (model, THICKNESS);
    if (table) {
      ClothObstacle plane = { CLOTH_OBSTACLE_PLANE, {0., 0., 0.}
      };

      plane.normal[2] = 1.;
      plane.friction = 0.5;
      g_array_append_val (scene->obstacles, plane);
    } else {
      for (guint i = 0; i < N; i++)
        cloth_scene_hold (scene, i);
    }
    sim = run_new (scene, model);
    run_for (sim, 1.);
    x = positions_of (sim, 0);
    for (guint i = 0; i < N; i++) {
      /* corners of the upper sheet above the lower one */
      if (i % COLUMNS == COLUMNS - 1 || i / COLUMNS == ROWS - 1)
        continue;
      assert_within (x[3 * (N + i) + 2] - x[3 * i + 2], THICKNESS,
          (table ? 0.05 : 0.01) * THICKNESS);
    }
  }
}

/* A hanging strip is let down on a great ball, on which it folds over itself, over and
 * over: by its weight, layer on layer. */
static ClothScene *
folding (guint columns, guint rows)
{
  ClothScene *scene =
      cloth_scene_new (cloth_topology_new_grid (columns, rows, 0.1f, 0.4f),
      50., 76);
  ClothObstacle ball = { CLOTH_OBSTACLE_SPHERE, {0.05, 0., 0.}
  };
  gdouble low = INFINITY;

  for (guint i = 0; i < columns * rows; i++)
    low = MIN (low, scene->positions[3 * i + 2]);
  ball.radius_m = 1.;
  ball.point[2] = low - 1.005;
  ball.friction = 0.5;
  g_array_append_val (scene->obstacles, ball);
  for (guint i = 0; i < columns; i++)
    cloth_scene_hold (scene, i);
  for (guint frame = 0; frame < scene->n_frames; frame++)
    for (guint i = 0; i < columns; i++)
      scene->clamps[3 * (frame * columns + i) + 2] -=
          0.25 * scene->times[frame];
  /* so that it knows which way to fold, and none of its corners meets another one */
  for (guint i = 0; i < columns * rows; i++)
    scene->positions[3 * i + 1] += 0.004 * sin (20. *
        scene->positions[3 * i + 2] + 7. * scene->positions[3 * i]);
  return scene;
}

static ClothModel *
folding_model (gdouble thickness)
{
  ClothModel *model = model_new (0.2, 200.);

  model->bending_warp = model->bending_weft = 2e-5;
  model->damping_mass = 0.3;
  model->damping_stiffness = 3e-4;
  touch (model, thickness);
  return model;
}

/* It never crosses itself at any frame; without the effect it does. */
static void
test_fold (void)
{
  const struct
  {
    gdouble thickness;
    ClothIntegrator integrator;
    gboolean single;
  } cases[] = {
    {0., CLOTH_INTEGRATOR_EXPLICIT, FALSE},
    {THICKNESS, CLOTH_INTEGRATOR_EXPLICIT, FALSE},
    {3. * THICKNESS, CLOTH_INTEGRATOR_EXPLICIT, FALSE},
    {THICKNESS, CLOTH_INTEGRATOR_EXPLICIT, TRUE},
    {THICKNESS, CLOTH_INTEGRATOR_IMPLICIT, FALSE},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (ClothScene) scene = folding (6, 21);
    g_autoptr (ClothModel) model = folding_model (cases[i].thickness);
    const ClothModel *models[1] = { model };
    const ClothSimOptions options = { cases[i].single, 1, CLOTH_SIMD_BEST, 0 };
    g_autoptr (ClothSim) sim = NULL;
    guint crossings = 0;

    model->integrator = cases[i].integrator;
    sim = cloth_sim_new (scene, models, 1, &options, NULL);
    for (guint frame = 0; frame < 75; frame++) {
      g_autofree gdouble *x = NULL;

      run_for (sim, 0.02);
      x = positions_of (sim, 0);
      crossings += count_crossings (scene->topology, x);
    }
    g_test_message ("case %u: %u crossings", i, crossings);
    if (cases[i].thickness > 0.)
      g_assert_cmpuint (crossings, ==, 0);
    else
      g_assert_cmpuint (crossings, >, 10);
  }
}

/* Two small sheets in free space that meet at an angle. Their uv are binary fractions. */
#define SIDE 5
#define SHEET (SIDE * SIDE)

static ClothScene *
meeting (gdouble speed)
{
  ClothScene *scene = sheets_new (2, SIDE, SIDE, 0.125, 0.125);

  scene->gravity[2] = 0.;
  scene->velocities = g_new0 (gdouble, 6 * SHEET);
  for (guint i = SHEET; i < 2 * SHEET; i++) {
    gdouble *x = scene->positions + 3 * i;

    /* turned about y, then about x; 0.6² + 0.8² = 0.28² + 0.96² = 1 */
    x[2] = 0.28 * x[0];
    x[0] = 0.96 * x[0] + 0.031;
    x[2] = 0.8 * x[2] + 0.6 * x[1] + 0.01;
    x[1] = 0.8 * x[1] - 0.6 * 0.28 / 0.96 * (x[0] - 0.031) + 0.017;
    scene->velocities[3 * i + 2] = -speed;
  }
  return scene;
}

/* Sums of m v, over ρ, of each sheet. */
static void
momenta (const ClothSim * sim, gdouble momentum[2][3])
{
  g_autofree gdouble *v = velocities_of (sim, 0);

  memset (momentum, 0, 6 * sizeof (gdouble));
  for (guint i = 0; i < 2 * SHEET; i++) {
    guint column = i % SIDE, row = i % SHEET / SIDE;
    gdouble m = (column % (SIDE - 1) ? 1. : 0.5) *
        (row % (SIDE - 1) ? 1. : 0.5) / SHEET;

    for (guint k = 0; k < 3; k++)
      momentum[i / SHEET][k] += m * v[3 * i + k];
  }
}

/* What one sheet loses the other one gets. At the greater speed a step is longer than
 * three times the thickness, so that zones are needed. Energy never rises. */
static void
test_momentum (void)
{
  const gdouble speeds[2] = { 1., 20. };

  for (guint c = 0; c < 4; c++) {
    g_autoptr (ClothScene) scene = meeting (speeds[c % 2]);
    g_autoptr (ClothModel) model = model_new (0.2, 100.);
    const gdouble friction = 0.5;
    g_autoptr (ClothSim) sim = NULL;
    gdouble before[2][3], after[2][3], energy, first;
    ClothSimEnergy e;

    touch (model, THICKNESS);
    if (c > 1)
      cloth_model_set (model, "effects.friction.coefficient", friction, NULL);
    sim = run_new (scene, model);
    momenta (sim, before);
    e = cloth_sim_get_energy (sim, 0);
    first = e.kinetic + e.elastic;
    for (guint i = 0; i < 100; i++) {
      g_autofree gdouble *x = NULL;

      run_for (sim, 2e-3);
      e = cloth_sim_get_energy (sim, 0);
      energy = e.kinetic + e.elastic;
      /* symplectic steps let it waver */
      g_assert_cmpfloat (energy, <, 1.001 * first);
      x = positions_of (sim, 0);
      g_assert_cmpuint (count_crossings (scene->topology, x), ==, 0);
    }
    momenta (sim, after);
    g_test_message ("at %g m/s: %.3g of %.3g goes over, energy %.3g", speeds[c %
            2], after[0][2], before[1][2], energy / first);
    for (guint k = 0; k < 3; k++)
      assert_within (after[0][k] + after[1][k], before[0][k] + before[1][k],
          1e-12 * speeds[c % 2]);
    g_assert_cmpfloat (after[0][2], <, 0.1 * before[1][2]);
    g_assert_cmpfloat (energy, <, 0.95 * first);
  }
}

/* The mirror image moves as the image, to the bit: it has the same numbers. */
static void
test_mirror (void)
{
  g_autofree gdouble *x[2] = { NULL, NULL };
  gdouble turned = 0.;

  for (guint m = 0; m < 2; m++) {
    g_autoptr (ClothScene) scene = meeting (2.);
    g_autoptr (ClothModel) model = model_new (0.2, 100.);
    g_autoptr (ClothSim) sim = NULL;

    touch (model, THICKNESS);
    for (guint i = 0; m && i < 2 * SHEET; i++) {
      scene->positions[3 * i] *= -1.;
      scene->velocities[3 * i] *= -1.;
    }
    sim = run_new (scene, model);
    run_for (sim, 0.1);
    x[m] = positions_of (sim, 0);
  }
  for (guint i = 0; i < 2 * SHEET; i++) {
    g_assert_true (x[0][3 * i] == -x[1][3 * i]);
    g_assert_true (x[0][3 * i + 1] == x[1][3 * i + 1]);
    g_assert_true (x[0][3 * i + 2] == x[1][3 * i + 2]);
    turned = MAX (turned, fabs (x[0][3 * i + 2] - x[0][2]));
  }
  g_assert_cmpfloat (turned, >, 1e-3);
  g_clear_pointer (&x[0], g_free);
  g_clear_pointer (&x[1], g_free);
}

static void
run_models (const ClothScene * scene, ClothModel * const *models, guint n,
    ClothSimOptions options, gdouble seconds, gdouble * result)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSim) sim = cloth_sim_new (scene,
      (const ClothModel * const *) models, n, &options, &error);

  g_assert_no_error (error);
  run_for (sim, seconds);
  for (guint i = 0; i < n; i++)
    cloth_sim_get_positions (sim, i, result +
        3 * (gsize) i * scene->topology->n_vertices);
}

/* Every fifth model is the same; each other one has none, or another thickness. */
static void
test_bits (void)
{
  enum
  { N_MODELS = 21, N = 3 * 6 * 21 };
  g_autoptr (ClothScene) scene = folding (6, 21);
  ClothModel *models[N_MODELS];
  const struct
  {
    guint threads;
    ClothSimd simd;
  } ways[] = {
    {1, CLOTH_SIMD_BEST}, {3, CLOTH_SIMD_BEST}, {1, CLOTH_SIMD_AVX2},
    {2, CLOTH_SIMD_SCALAR}
  };
  g_autofree gdouble *first = g_new (gdouble, N_MODELS * N);
  g_autofree gdouble *other = g_new (gdouble, N_MODELS * N);

  for (guint i = 0; i < N_MODELS; i++) {
    models[i] = folding_model (i % 5 == 1 ? 0. : i % 5 ? 2e-3 : THICKNESS);
    models[i]->time_step = 2e-4;
    if (i % 5 == 2)
      g_array_set_size (models[i]->effects, 0);
  }
  for (guint single = 0; single < 2; single++) {
    for (guint w = 0; w < G_N_ELEMENTS (ways); w++) {
      const ClothSimOptions options = { single, ways[w].threads, ways[w].simd,
        0
      };

      run_models (scene, models, N_MODELS, options, 0.5, w ? other : first);
      if (w)
        g_assert_cmpmem (first, N_MODELS * N * sizeof *first, other,
            N_MODELS * N * sizeof *first);
    }
    for (guint i = 5; i < N_MODELS; i += 5)
      g_assert_cmpmem (first, N * sizeof *first, first + i * N,
          N * sizeof *first);
    /* at null as without it, and not as with it */
    g_assert_cmpmem (first + N, N * sizeof *first, first + 2 * N,
        N * sizeof *first);
    g_assert_cmpint (memcmp (first, first + N, N * sizeof *first), !=, 0);
    /* alone */
    run_models (scene, models, 1, (ClothSimOptions) {
        single, 1, CLOTH_SIMD_BEST, 0}
        , 0.5, other);
    g_assert_cmpmem (first, N * sizeof *first, other, N * sizeof *first);
  }
  for (guint i = 0; i < N_MODELS; i++)
    cloth_model_free (models[i]);
}

/* A small sheet on a great one that slopes: by Coulomb's law it sticks, or slides with
 * g (sin θ − μ cos θ). */
static void
test_slope (void)
{
  const gdouble angle = 0.4, frictions[3] = { 0., 0.2, 0.6 };
  const gdouble c = cos (angle), s = sin (angle);

  for (guint f = 0; f < 3; f++) {
    g_autoptr (ClothScene) scene = sheets_new (2, 9, 5, 0.4, 0.1);
    g_autoptr (ClothModel) model = model_new (0.2, 500.);
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *x = NULL;
    gdouble a = MAX (9.81 * (s - frictions[f] * c), 0.), way = 0.;

    for (guint i = 45; i < 90; i++) {
      scene->positions[3 * i] = 0.013 + 0.3 * scene->positions[3 * i];
      scene->positions[3 * i + 1] = 0.02 + 0.5 * scene->positions[3 * i + 1];
      scene->positions[3 * i + 2] = THICKNESS;
      scene->topology->uv[2 * i] *= 0.3f;
      scene->topology->uv[2 * i] += 1.f;
      scene->topology->uv[2 * i + 1] *= 0.5f;
    }
    scene->gravity[0] = 9.81 * s;
    scene->gravity[2] = -9.81 * c;
    for (guint i = 0; i < 45; i++)
      cloth_scene_hold (scene, i);
    touch (model, THICKNESS);
    model->damping_stiffness = 1e-4;
    cloth_model_set (model, "effects.friction.coefficient", frictions[f], NULL);
    sim = run_new (scene, model);
    run_for (sim, 0.25);
    x = positions_of (sim, 0);
    for (guint i = 135; i < 270; i += 3)
      way += (x[i] - scene->positions[i]) / 45.;
    g_test_message ("friction %g: %.5f m, Coulomb %.5f m", frictions[f], way,
        0.5 * a * 0.25 * 0.25);
    assert_within (way, 0.5 * a * 0.25 * 0.25, 5e-4);
  }
}

/* A sheet shot at another one by up to 4 cm a step does not come through it. */
static void
test_shot (void)
{
  for (guint integrator = 0; integrator < 2; integrator++) {
    g_autoptr (ClothScene) scene = meeting (40.);
    g_autoptr (ClothModel) model = model_new (0.2, 50.);
    g_autoptr (ClothSim) sim = NULL;

    for (guint i = 0; i < SIDE; i++) {
      cloth_scene_hold (scene, i);
      cloth_scene_hold (scene, SHEET - 1 - i);
    }
    model->integrator = integrator;
    model->time_step = integrator ? 1e-3 : 2e-4;
    model->damping_stiffness = 1e-3;
    touch (model, THICKNESS);
    sim = run_new (scene, model);
    for (guint i = 0; i < 100; i++) {
      g_autofree gdouble *x = NULL;

      run_for (sim, 1e-3);
      x = positions_of (sim, 0);
      g_assert_cmpuint (count_crossings (scene->topology, x), ==, 0);
    }
  }
}

/* Neighbours are no contacts, however thick the cloth is said to be: not of sewn panels,
 * whose corners at the seam are one, and not across a slit, where two edges lie on each
 * other on the flat cloth. Nothing touches here, so no bit changes. */
static void
test_neighbours (void)
{
  enum
  { COLUMNS = 7, ROWS = 6, N = 2 * COLUMNS * ROWS };

  for (guint sewn = 0; sewn < 2; sewn++) {
    g_autoptr (ClothScene) scene = sheets_new (2, COLUMNS, ROWS, 0.1, 0.1);
    g_autofree gdouble *x = g_new (gdouble, 6 * N);
    ClothModel *models[2];

    for (guint i = N / 2; i < N; i++) {
      scene->positions[3 * i] += 0.1;
      if (!sewn)
        scene->topology->uv[2 * i] -= 0.1f;
    }
    for (guint row = 0; row < ROWS; row++) {
      const ClothSeam seam = { row * COLUMNS + COLUMNS - 1, N / 2 +
            row * COLUMNS
      };

      if (sewn || row == ROWS - 1)
        g_array_append_val (scene->seams, seam);
      /* the slit ends at its lowest row: there it is one panel */
      for (guint i = 0; !sewn && row == ROWS - 1 && i <
          4 * scene->topology->n_faces; i++)
        if (scene->topology->faces[i] == seam.b)
          scene->topology->faces[i] = seam.a;
    }
    scene->gravity[1] = 9.81;
    scene->gravity[2] = 0.;
    for (guint i = 0; i < COLUMNS; i++) {
      cloth_scene_hold (scene, i);
      cloth_scene_hold (scene, N / 2 + i);
    }
    for (guint i = 0; i < 2; i++) {
      models[i] = model_new (0.2, 100.);
      models[i]->time_step = 2e-4;
      if (i)
        touch (models[i], 0.01);
    }
    run_models (scene, models, 2, (ClothSimOptions) {
        FALSE, 1, CLOTH_SIMD_BEST, 0}
        , 0.2, x);
    g_assert_cmpmem (x, 3 * N * sizeof *x, x + 3 * N, 3 * N * sizeof *x);
    for (guint i = 0; i < 2; i++)
      cloth_model_free (models[i]);
  }
}

/* A tube of two panels sewn along two sides, of which one falls on the other. */
static void
test_tube (void)
{
  enum
  { COLUMNS = 7, ROWS = 6, N = 2 * COLUMNS * ROWS };
  g_autoptr (ClothScene) scene = sheets_new (2, COLUMNS, ROWS, 0.12, 0.1);
  g_autoptr (ClothModel) model = model_new (0.2, 100.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL;
  gdouble least = INFINITY;

  for (guint i = 0; i < N / 2; i++) {
    guint column = i % COLUMNS;

    if (column == 0 || column == COLUMNS - 1) {
      const ClothSeam seam = { i, N / 2 + i };

      g_array_append_val (scene->seams, seam);
    } else {
      scene->positions[3 * (N / 2 + i) + 2] = 0.005;
    }
    cloth_scene_hold (scene, i);
  }
  /* the other panel is inside out, as a tube's is */
  for (guint i = N / 2; i < N; i++)
    scene->topology->uv[2 * i] *= -1.f;
  for (guint i = scene->topology->n_faces / 2; i < scene->topology->n_faces;
      i++) {
    guint32 *face = scene->topology->faces + 4 * i, swap = face[1];

    face[1] = face[3];
    face[3] = swap;
  }
  model->damping_mass = 5.;
  touch (model, THICKNESS);
  sim = run_new (scene, model);
  run_for (sim, 1.);
  x = positions_of (sim, 0);
  for (guint i = 0; i < N / 2; i++) {
    guint column = i % COLUMNS, row = i / COLUMNS;

    if (column > 1 && column < COLUMNS - 2 && row > 0 && row < ROWS - 1)
      least = MIN (least, x[3 * (N / 2 + i) + 2]);
  }
  assert_within (least, THICKNESS, 0.02 * THICKNESS);
}

/* Thickness at most half the height of the triangles about: here 5 mm. */
static void
test_thick (void)
{
  enum
  { N = 25 };
  g_autoptr (ClothScene) scene = sheets_new (2, 5, 5, 0.04, 0.04);
  g_autoptr (ClothModel) model = model_new (0.2, 100.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL;
  /* triangles with legs of 10 mm are 7.07 mm high */
  const gdouble kept = 0.01 * sqrt (0.5) / 2.;

  shift (scene, N, N, 0.004, 0.003, 0.01);
  for (guint i = 0; i < N; i++)
    cloth_scene_hold (scene, i);
  model->damping_mass = 5.;
  touch (model, 0.01);
  sim = run_new (scene, model);
  run_for (sim, 0.2);
  x = positions_of (sim, 0);
  for (guint i = N; i < 2 * N; i++)
    if (i % 5 < 4 && i < 2 * N - 5)
      assert_within (x[3 * i + 2], kept, 0.03 * kept);
}

/* What thickness cannot be. */
static void
test_refused (void)
{
  const struct
  {
    const gchar *value, *text;
  } cases[] = {
    {"-0.001", "effects.self_contact.thickness"},
    {"0.02", "effects.self_contact.thickness"},
    {"1e300", "effects.self_contact.thickness"},
    {"NaN", ""}, {"\"thick\"", "thickness"}, {"null", "thickness"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *json = g_strdup_printf ("{\"version\": 1, \"effects\": "
        "{\"self_contact\": {\"thickness\": %s}}}", cases[i].value);
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothModel) model = cloth_model_parse (json, strlen (json),
        &error);

    g_assert_null (model);
    g_assert_nonnull (error);
    g_test_message ("%s", error->message);
    g_assert_nonnull (strstr (error->message, cases[i].text));
  }
}

/* A state that crosses itself, one in a point and one far away: nothing breaks, and what
 * crossed stays crossed. */
static void
test_bad_states (void)
{
  g_autoptr (ClothScene) scene = folding (6, 21);
  g_autoptr (ClothModel) model = folding_model (THICKNESS);
  g_autoptr (ClothSim) sim = run_new (scene, model);
  g_autofree gdouble *x = positions_of (sim, 0);

  for (guint i = 0; i < 3 * 6 * 21; i++)
    x[i] = i % 3 == 2 ? -0.1 + 0.01 * sin (i) : 0.05 * cos (i * i);
  cloth_sim_set_state (sim, 0, x, NULL, 0.);
  cloth_sim_advance (sim, 0.004);
  for (guint i = 0; i < 3 * 6 * 21; i++)
    x[i] = 0.1;
  cloth_sim_set_state (sim, 0, x, NULL, 0.);
  cloth_sim_advance (sim, 0.004);
  for (guint i = 0; i < 3 * 6 * 21; i++)
    x[i] = 1e6 * sin (i);
  cloth_sim_set_state (sim, 0, x, NULL, 0.);
  cloth_sim_advance (sim, 0.004);
  cloth_sim_get_positions (sim, 0, x);
  for (guint i = 0; i < 3 * 6 * 21; i++)
    g_assert_true (isfinite (x[i]));
}

/* A sheet at rest on another one: how it moves with its thickness, by steps of 1e-3 and
 * 1e-5 of a millimetre. */
static void
test_derivative (void)
{
  enum
  { COLUMNS = 9, ROWS = 8, N = COLUMNS * ROWS };
  g_autoptr (ClothScene) scene = sheets_new (2, COLUMNS, ROWS, 0.16, 0.14);
  g_autoptr (ClothSim) start = NULL, sim = NULL;
  g_autofree gdouble *x0 = NULL, *v0 = NULL;
  const gdouble steps[3] = { 0., 1e-6, 1e-8 };
  gdouble *x[3], square = 0., apart = 0.;
  ClothModel *models[3];

  shift (scene, N, N, 0.0043, 0.0031, 2e-3);
  for (guint i = 0; i < N; i++)
    cloth_scene_hold (scene, i);
  for (guint i = 0; i < 3; i++) {
    models[i] = model_new (0.2, 100.);
    models[i]->damping_mass = 1.;
    models[i]->damping_stiffness = 1e-3;
    models[i]->bending_warp = models[i]->bending_weft = 2e-5;
    touch (models[i], THICKNESS + steps[i]);
  }
  start = run_new (scene, models[0]);
  run_for (start, 1.);
  x0 = positions_of (start, 0);
  v0 = velocities_of (start, 0);
  sim = cloth_sim_new (scene, (const ClothModel * const *) models, 3, NULL,
      NULL);
  for (guint i = 0; i < 3; i++)
    cloth_sim_set_state (sim, i, x0, v0, 1.);
  run_for (sim, 0.4);
  for (guint i = 0; i < 3; i++)
    x[i] = positions_of (sim, i);
  for (guint i = 0; i < 6 * N; i++) {
    gdouble a = (x[1][i] - x[0][i]) / steps[1];
    gdouble b = (x[2][i] - x[0][i]) / steps[2];

    square += b * b;
    apart += (a - b) * (a - b);
  }
  g_test_message ("RMS %.3g, steps disagree by %.4f", sqrt (square / N), sqrt
      (apart / square));
  g_assert_cmpfloat (sqrt (square / N), >, 0.5);
  g_assert_cmpfloat (sqrt (apart / square), <, 0.1);
  for (guint i = 0; i < 3; i++) {
    cloth_model_free (models[i]);
    g_free (x[i]);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/contact/count", test_count);
  g_test_add_func ("/sim/contact/rest", test_rest);
  g_test_add_func ("/sim/contact/fold", test_fold);
  g_test_add_func ("/sim/contact/momentum", test_momentum);
  g_test_add_func ("/sim/contact/mirror", test_mirror);
  g_test_add_func ("/sim/contact/bits", test_bits);
  g_test_add_func ("/sim/contact/slope", test_slope);
  g_test_add_func ("/sim/contact/shot", test_shot);
  g_test_add_func ("/sim/contact/neighbours", test_neighbours);
  g_test_add_func ("/sim/contact/tube", test_tube);
  g_test_add_func ("/sim/contact/thick", test_thick);
  g_test_add_func ("/sim/contact/refused", test_refused);
  g_test_add_func ("/sim/contact/bad-states", test_bad_states);
  g_test_add_func ("/sim/contact/derivative", test_derivative);
  return g_test_run ();
}
