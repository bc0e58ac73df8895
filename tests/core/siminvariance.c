/* What must not change: momentum, energy, and the motion under mirrors, turns and gauges;
 * and what must change smoothly: the motion with the step and with the parameters.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#include "gst/math/random.h"

#define COLUMNS 9
#define ROWS 11
#define N (COLUMNS * ROWS)

/* A crumpled sheet in motion, symmetric neither way; its uv are binary fractions, so that its
 * mirror image has the very same ones. */
static ClothScene *
crumpled (guint64 seed)
{
  ClothScene *scene = sheet_new (COLUMNS, ROWS, 0.25, 0.3125);
  ClothRandom random;

  cloth_random_init (&random, seed);
  scene->velocities = g_new (gdouble, 3 * N);
  for (guint i = 0; i < 3 * N; i++) {
    scene->positions[i] += 2e-3 * cloth_random_gaussian (&random);
    scene->velocities[i] = 0.3 * cloth_random_gaussian (&random);
  }
  return scene;
}

static ClothModel *
fabric (void)
{
  ClothModel *model = model_new (0.2, 50.);

  model->stretch_weft = 70.;
  model->bending_warp = 2e-5;
  model->bending_weft = 1e-5;
  model->damping_stiffness = 1e-4;
  return model;
}

/* Sums of m v and m x × v, over ρ: corners of the grid have a quarter of the mass. */
static void
momenta (const ClothSim * sim, gdouble momentum[6])
{
  g_autofree gdouble *x = positions_of (sim, 0), *v = velocities_of (sim, 0);

  memset (momentum, 0, 6 * sizeof *momentum);
  for (guint i = 0; i < N; i++) {
    guint column = i % COLUMNS, row = i / COLUMNS;
    gdouble m = (column % (COLUMNS - 1) ? 1. : 0.5) *
        (row % (ROWS - 1) ? 1. : 0.5) / N;

    for (guint k = 0; k < 3; k++) {
      guint a = (k + 1) % 3, b = (k + 2) % 3;

      momentum[k] += m * v[3 * i + k];
      momentum[3 + k] += m * (x[3 * i + a] * v[3 * i + b] -
          x[3 * i + b] * v[3 * i + a]);
    }
  }
}

/* Inner forces move no centre and turn nothing. Bending damping alone, which is linear,
 * turns folded cloth a little: here it is without. */
static void
test_momentum (gconstpointer data)
{
  g_autoptr (ClothScene) scene = crumpled (1);
  g_autoptr (ClothModel) model = fabric ();
  g_autoptr (ClothSim) sim = NULL;
  gdouble before[6], after[6];

  scene->gravity[2] = 0.;
  for (guint damped = 0; damped < 2; damped++) {
    g_clear_pointer (&sim, cloth_sim_free);
    model->damping_stiffness = damped ? 1e-4 : 0.;
    model->bending_warp = model->bending_weft = damped ? 0. : 2e-5;
    model->force_model = GPOINTER_TO_UINT (data);
    sim = run_new (scene, model);
    momenta (sim, before);
    run_for (sim, 0.4);
    momenta (sim, after);
    for (guint k = 0; k < 6; k++)
      assert_within (after[k], before[k], 1e-11);
  }
}

/* The same cells, cut along the same diagonals, of a mesh that says nothing of rows and
 * columns. */
static ClothTopology *
forget_grid (const ClothTopology * grid)
{
  ClothTopology *mesh = cloth_topology_new (grid->n_vertices, grid->n_faces);

  memcpy (mesh->uv, grid->uv, 2 * grid->n_vertices * sizeof *mesh->uv);
  for (guint i = 0; i < grid->n_faces; i++) {
    guint turn = (i / (grid->columns - 1) + i % (grid->columns - 1)) % 2;

    for (guint k = 0; k < 4; k++)
      mesh->faces[4 * i + k] = grid->faces[4 * i + (k + turn) % 4];
  }
  return mesh;
}

/* A grid, which goes row by row, moves as its triangles one by one do; also when its rows
 * and columns are not evenly apart, so that it goes by triangles itself, and when they are
 * as even as a file's digits. */
static void
test_grid (void)
{
  for (guint uneven = 0; uneven < 3; uneven++) {
    g_autoptr (ClothScene) grid = crumpled (2), mesh = crumpled (2);
    g_autoptr (ClothModel) model = fabric ();
    g_autoptr (ClothSim) one = NULL, other = NULL;
    g_autofree gdouble *x = NULL, *y = NULL;

    for (guint i = 0; uneven == 2 && i < N; i++) {
      grid->topology->uv[2 * i] += 1e-6f * (gfloat) (i % COLUMNS % 3);
      grid->topology->uv[2 * i + 1] += 1e-6f * (gfloat) (i / COLUMNS % 2);
    }
    if (uneven == 1)
      for (guint i = 0; i < 2 * N; i++)
        grid->topology->uv[i] += 0.8f * grid->topology->uv[i] *
            grid->topology->uv[i];
    cloth_topology_free (mesh->topology);
    mesh->topology = forget_grid (grid->topology);
    model->bending_warp = model->bending_weft = 0.;
    model->damping_mass = 0.3;
    model->time_step = 2e-4;
    one = run_new (grid, model);
    other = run_new (mesh, model);
    run_for (one, 0.04);
    run_for (other, 0.04);
    x = positions_of (one, 0);
    y = positions_of (other, 0);
    for (guint i = 0; i < 3 * N; i++)
      assert_within (x[i], y[i], uneven == 2 ? 1e-5 : 1e-10);
  }
}

/* Forces are minus the slope of the energy: from rest the first step's velocities are those of half
 * a step, and their kinetic energy is a quarter of a step times what the elastic energy falls by along the
 * velocities. */
static void
test_gradient (void)
{
  for (guint run = 0; run < 4; run++) {
    gboolean bent = run % 2, uneven = run / 2;
    g_autoptr (ClothScene) scene = crumpled (3);
    g_autoptr (ClothModel) model = fabric ();
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *x = NULL, *v = NULL;
    const gdouble h = 1e-7;
    gdouble slope = 0., kinetic, way = bent ? 1. : 1e-4;        /* s */

    scene->gravity[2] = 0.;
    memset (scene->velocities, 0, 3 * N * sizeof (gdouble));
    for (guint i = 0; uneven && i < 2 * N; i++)
      scene->topology->uv[i] += 0.8f * scene->topology->uv[i] *
          scene->topology->uv[i];
    model->damping_mass = 0.;
    if (bent) {
      model->stretch_warp = model->stretch_weft = model->shear = 1e-9;
      model->bending_warp = 3e-5;
    }
    model->time_step = h;
    sim = run_new (scene, model);
    cloth_sim_advance (sim, h);
    kinetic = cloth_sim_get_energy (sim, 0).kinetic;
    v = velocities_of (sim, 0);
    x = g_new (gdouble, 3 * N);
    for (guint end = 0; end < 2; end++) {
      for (guint i = 0; i < 3 * N; i++)
        x[i] = scene->positions[i] + (end ? way : -way) * v[i];
      cloth_sim_set_state (sim, 0, x, NULL, 0.);
      slope += (end ? 1. : -1.) * cloth_sim_get_energy (sim, 0).elastic /
          (2. * way);
    }
    assert_within (-slope * h / (4. * kinetic), 1., 1e-5);
  }
}

/* Without damping the energy of a swinging sheet keeps within 0.1% for 10 s. */
static void
test_energy (void)
{
  g_autoptr (ClothScene) scene = sheet_new (4, 5, 0.2, 0.3);
  g_autoptr (ClothModel) model = model_new (0.2, 50.);
  g_autoptr (ClothSim) sim = NULL;
  gdouble sum[2] = { 0., 0. }, swing = 0.;

  model->compression_ratio = 1.;
  for (guint i = 0; i < 4; i++)
    cloth_scene_hold (scene, i);
  for (guint i = 0; i < 20; i++) {
    scene->positions[3 * i + 1] = -0.5 * scene->positions[3 * i + 2];
    scene->positions[3 * i + 2] *= sqrt (0.75);
  }
  sim = run_new (scene, model);
  for (guint end = 0; end < 2; end++) {
    for (guint i = 0; i < 500; i++) {
      ClothSimEnergy e;

      cloth_sim_advance (sim, cloth_sim_get_time (sim) + 2e-3);
      e = cloth_sim_get_energy (sim, 0);
      sum[end] += (e.kinetic + e.elastic + e.gravity) / 500.;
      swing = MAX (swing, e.kinetic);
    }
    if (!end)
      run_for (sim, 9. - cloth_sim_get_time (sim));
  }
  g_assert_cmpfloat (swing, >, 1e-3);
  assert_within ((sum[1] - sum[0]) / swing, 0., 1e-3);
}

/* The mirror image moves as the image. */
static void
test_mirror (void)
{
  g_autoptr (ClothScene) scene = crumpled (2), image = crumpled (2);
  g_autoptr (ClothModel) model = fabric ();
  g_autofree gdouble *x = NULL, *y = NULL;

  for (guint i = 0; i < N; i++) {
    guint j = i / COLUMNS * COLUMNS + COLUMNS - 1 - i % COLUMNS;

    for (guint k = 0; k < 3; k++) {
      gdouble sign = k ? 1. : -1.;

      image->positions[3 * j + k] = sign * scene->positions[3 * i + k];
      image->velocities[3 * j + k] = sign * scene->velocities[3 * i + k];
    }
  }
  x = state_at (scene, model, 0.1);
  y = state_at (image, model, 0.1);
  for (guint i = 0; i < N; i++) {
    guint j = i / COLUMNS * COLUMNS + COLUMNS - 1 - i % COLUMNS;

    assert_within (y[3 * j], -x[3 * i], 1e-9);
    assert_within (y[3 * j + 1], x[3 * i + 1], 1e-9);
    assert_within (y[3 * j + 2], x[3 * i + 2], 1e-9);
  }
}

/* The turned cloth under turned gravity moves as the turned. */
static void
test_rotation (void)
{
  const gdouble c[3] = { 0.48, 0.64, 0.6 };
  const gdouble r[9] = {
    0.36, 0.48, -0.8, -0.8, 0.6, 0., c[0], c[1], c[2]
  };
  g_autoptr (ClothScene) scene = crumpled (3), turned = crumpled (3);
  g_autoptr (ClothModel) model = fabric ();
  g_autofree gdouble *x = NULL, *y = NULL;

  for (guint k = 0; k < 3; k++) {
    turned->gravity[k] = -9.81 * r[3 * k + 2];
    for (guint i = 0; i < N; i++) {
      const gdouble *p = scene->positions + 3 * i;
      const gdouble *v = scene->velocities + 3 * i;

      turned->positions[3 * i + k] =
          r[3 * k] * p[0] + r[3 * k + 1] * p[1] + r[3 * k + 2] * p[2];
      turned->velocities[3 * i + k] =
          r[3 * k] * v[0] + r[3 * k + 1] * v[1] + r[3 * k + 2] * v[2];
    }
  }
  x = state_at (scene, model, 0.1);
  y = state_at (turned, model, 0.1);
  for (guint i = 0; i < N; i++)
    for (guint k = 0; k < 3; k++)
      assert_within (y[3 * i + k], r[3 * k] * x[3 * i] + r[3 * k +
              1] * x[3 * i + 1] + r[3 * k + 2] * x[3 * i + 2], 1e-9);
}

/* Mass, stiffness and drag times a number: nothing changes, to the bit for a power of
 * two. */
static void
test_gauge (void)
{
  g_autoptr (ClothScene) scene = crumpled (4);
  const gdouble factor[3] = { 1., 4., 3. };
  g_autofree gdouble *x[3] = { NULL };

  for (guint i = 0; i < 3; i++) {
    g_autoptr (ClothModel) model = fabric ();
    const gdouble coefficient = 1.2;

    model->areal_density *= factor[i];
    model->stretch_warp *= factor[i];
    model->stretch_weft *= factor[i];
    model->shear *= factor[i];
    model->bending_warp *= factor[i];
    model->bending_weft *= factor[i];
    model->air_density *= factor[i];
    model->damping_mass = 0.3;
    cloth_model_set_effect (model, &cloth_effect_air_drag, &coefficient);
    x[i] = state_at (scene, model, 0.2);
  }
  g_assert_cmpmem (x[0], 3 * N * sizeof (gdouble), x[1],
      3 * N * sizeof (gdouble));
  for (guint i = 0; i < 3 * N; i++)
    assert_within (x[2][i], x[0][i], 1e-8);
  for (guint i = 0; i < 3; i++)
    g_clear_pointer (&x[i], g_free);
}

/* Half the step, a quarter of the error: leapfrog is of second order. Where velocities of half a
 * step ago damp it is of first: half the error. */
static void
test_convergence (gconstpointer data)
{
  const guint force_model = GPOINTER_TO_UINT (data) % 2, damped =
      GPOINTER_TO_UINT (data) / 2;
  g_autoptr (ClothScene) scene = sheet_new (4, 5, 0.2, 0.3);
  g_autofree gdouble *x[3] = { NULL };
  gdouble difference[2] = { 0., 0. };

  for (guint i = 0; i < 4; i++)
    cloth_scene_hold (scene, i);
  for (guint i = 0; i < 20; i++)
    scene->positions[3 * i + 1] = 0.05 * sin (5. * scene->positions[3 * i + 2]);
  for (guint i = 0; i < 3; i++) {
    g_autoptr (ClothModel) model = model_new (0.2, 30.);

    model->force_model = force_model;
    model->compression_ratio = 1.;
    model->damping_stiffness = damped ? 2e-3 : 0.;
    model->time_step = 4e-4 / (1 << i);
    x[i] = state_at (scene, model, 0.3);
  }
  for (guint i = 0; i < 60; i++)
    for (guint k = 0; k < 2; k++)
      difference[k] += (x[k + 1][i] - x[k][i]) * (x[k + 1][i] - x[k][i]);
  assert_within (0.5 * log2 (difference[0] / difference[1]), damped ? 1. : 2.,
      0.1);
  for (guint i = 0; i < 3; i++)
    g_clear_pointer (&x[i], g_free);
}

/* How far a free sheet is from where an observer should have it: one that is drawn to y = u t with
 * gain g and damping c = 2ζ√g, from x = 0 at rest, lags by r = u t − x = u e^{−ζwt} sin (w't)/w' with
 * w = √g and w' = w √(1 − ζ²). */
static gdouble
draw_off (gdouble time_step, gboolean staged, gboolean pulled)
{
  const gdouble g = 1600., zeta = 0.7, w = sqrt (g), damped =
      w * sqrt (1. - zeta * zeta), u[3] = { 0.5, -1., 2. }, damping =
      2. * zeta * w;
  g_autoptr (ClothScene) scene = sheet_new (3, 3, 0.1, 0.1);
  g_autoptr (ClothModel) model = model_new (0.2, 5.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL, *y = g_new (gdouble, 27), *next =
      g_new (gdouble, 27), *v = g_new (gdouble, 27);
  g_autofree ClothPull *pulls = g_new0 (ClothPull, 9);
  gdouble weights[9], off = 0., t = 0.;

  scene->gravity[2] = 0.;
  model->time_step = time_step;
  model->damping_stiffness = staged ? 5e-3 : 0.;
  sim = run_new (scene, model);
  for (guint frame = 0; frame < 4; frame++, t += 0.01) {
    for (guint i = 0; i < 27; i++) {
      y[i] = scene->positions[i] + u[i % 3] * t;
      next[i] = scene->positions[i] + u[i % 3] * (t + 0.01);
      v[i] = u[i % 3];
      weights[i / 3] = 1.;
    }
    for (guint i = 0; i < 9; i++) {
      pulls[i] = (ClothPull) {
        .corner = { i, i, i },.weight = { 1., 0., 0. }
      };
      for (guint k = 0; k < 3; k++) {
        pulls[i].now.target[k] = y[3 * i + k];
        pulls[i].next.target[k] = next[3 * i + k];
        pulls[i].now.velocity[k] = pulls[i].next.velocity[k] = u[k];
        pulls[i].now.information[k] = pulls[i].next.information[k] = 1.;
      }
    }
    if (pulled) {
      const ClothPullOptions options = { CLOTH_PULL_LINEAR, 1.,
        CLOTH_PULL_BALANCED, 1.
      };

      g_assert_true (cloth_sim_set_pulls (sim, pulls, 9, &options, &g, &damping,
              t, t + 0.01, NULL));
    } else {
      cloth_sim_set_targets (sim, 0, y, next, v, v, weights, NULL, g, damping,
          t, t + 0.01);
    }
    cloth_sim_advance (sim, t + 0.01);
  }
  x = positions_of (sim, 0);
  for (guint i = 0; i < 27; i++) {
    gdouble lag = u[i % 3] * exp (-zeta * w * t) * sin (damped * t) / damped;

    off = MAX (off, fabs (x[i] - scene->positions[i] - u[i % 3] * t + lag));
  }
  return off;
}

/* The observer's springs and pulls are of second order, damping and all. */
static void
test_drawn (gconstpointer data)
{
  const gboolean staged = GPOINTER_TO_UINT (data) == 1;
  const gboolean pulled = GPOINTER_TO_UINT (data) == 2;
  const gdouble coarse = draw_off (5e-4, staged, pulled);
  const gdouble fine = draw_off (2.5e-4, staged, pulled);

  assert_within (log2 (coarse / fine), 2., 0.15);
  /* the lag itself is 10 mm */
  g_assert_cmpfloat (coarse, <, 5e-6);
}

/* A falling sheet whose observer comes late falls on as one whose observer had nothing to say until
 * then. */
static void
test_drawn_late (void)
{
  gdouble *x[2];

  for (guint late = 0; late < 2; late++) {
    g_autoptr (ClothScene) scene = sheet_new (3, 3, 0.1, 0.1);
    g_autoptr (ClothModel) model = model_new (0.2, 5.);
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *v = g_new0 (gdouble, 27);
    gdouble weights[9] = { 0. };

    model->damping_stiffness = 5e-2;
    model->time_step = 2e-3;
    sim = run_new (scene, model);
    for (guint frame = 0; frame < 12; frame++) {
      for (guint i = 0; i < 9; i++)
        weights[i] = frame >= 10 ? 1. : 0.;
      if (frame >= 10 || !late)
        cloth_sim_set_targets (sim, 0, scene->positions, scene->positions, v, v,
            weights, NULL, 1., 60., 0.01 * frame, 0.01 * (frame + 1));
      cloth_sim_advance (sim, 0.01 * (frame + 1));
    }
    x[late] = positions_of (sim, 0);
  }
  for (guint i = 0; i < 27; i++)
    assert_within (x[0][i], x[1][i], 1e-9);
  for (guint late = 0; late < 2; late++)
    g_free (x[late]);
}

/* A copy goes on as the original does. */
static void
test_copy (void)
{
  for (guint implicit = 0; implicit < 2; implicit++) {
    g_autoptr (ClothScene) scene = crumpled (3);
    g_autoptr (ClothModel) model = fabric ();
    g_autoptr (ClothSim) one = NULL, other = NULL;
    g_autofree gdouble *x = NULL, *y = NULL;

    model->integrator = implicit ? CLOTH_INTEGRATOR_IMPLICIT :
        CLOTH_INTEGRATOR_EXPLICIT;
    model->time_step = 2e-4;
    one = run_new (scene, model);
    other = run_new (scene, model);
    run_for (one, 0.04);
    cloth_sim_copy_state (other, 0, one, 0);
    g_assert_cmpfloat (cloth_sim_get_time (other), ==,
        cloth_sim_get_time (one));
    run_for (one, 0.04);
    run_for (other, 0.04);
    x = positions_of (one, 0);
    y = positions_of (other, 0);
    /* implicit steps begin anew with one of first order */
    for (guint i = 0; i < 3 * N; i++)
      assert_within (x[i], y[i], implicit ? 1e-4 : 1e-12);
  }
}

/* Clocks that began in 1970 count as those that begin with the scene: clamps, springs, slips and gusts, whose times
 * are moments, in single numbers too. Frames are a 64th of a second, which numbers as large hold exactly. */
static void
test_epoch (gconstpointer data)
{
  const ClothSimOptions options = { GPOINTER_TO_UINT (data), 1,
    CLOTH_SIMD_BEST, 0
  };
  const gdouble slip[5] = { 0.01, 0., 0.02, 0.25, -1. };
  const gdouble gust[5] = { 2., 0.3, 40., 1.2, 0.1 };
  gdouble *x[2] = { NULL };
  const guint n = 9 * 10;

  for (guint late = 0; late < 2; late++) {
    const gdouble epoch = late ? ldexp (1., 31) : 0.;
    g_autoptr (ClothScene) scene = sway_scene (9, 10);
    g_autoptr (ClothModel) model = fabric ();
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *y = g_memdup2 (scene->positions,
        3 * n * sizeof (gdouble));
    g_autofree gdouble *speed = g_new0 (gdouble, 3 * n);
    g_autofree gdouble *weights = g_new (gdouble, n);
    const ClothModel *models[1] = { model };
    g_autoptr (GError) error = NULL;
    gdouble values[5];

    for (guint f = 0; f < scene->n_frames; f++)
      scene->times[f] = epoch + f / 64.;
    g_array_index (scene->held, ClothHeld, 1).until_s = epoch + 0.5;
    memcpy (values, slip, sizeof values);
    values[3] += epoch;
    model->damping_stiffness = 1e-3;
    cloth_model_set_effect (model, &cloth_effect_clamp_slip, values);
    cloth_model_set_effect (model, &cloth_effect_gust, gust);
    for (guint i = 0; i < n; i++)
      weights[i] = i % 3 == 0;
    sim = cloth_sim_new (scene, models, 1, &options, &error);
    g_assert_no_error (error);
    g_assert_cmpfloat (cloth_sim_get_time (sim), ==, epoch);
    for (guint f = 0; f < 64; f++) {
      const gdouble now = epoch + f / 64., next = epoch + (f + 1) / 64.;

      cloth_sim_set_targets (sim, 0, y, y, speed, speed, weights, NULL, 50.,
          8., now, next);
      cloth_sim_advance (sim, next);
      g_assert_cmpfloat (cloth_sim_get_time (sim), ==, next);
    }
    x[late] = positions_of (sim, 0);
  }
  g_assert_cmpmem (x[0], 3 * n * sizeof (gdouble), x[1],
      3 * n * sizeof (gdouble));
  g_free (x[0]);
  g_free (x[1]);
}

/* Central differences over 0.4 s with steps of 1e-3 and 1e-5 agree within 10%, for the
 * parameters of the fabric in the takes. */
static void
test_derivatives (void)
{
  enum
  { N_KEYS = 7, N_RUNS = 1 + 2 * N_KEYS };
  const gsize offset[N_KEYS] = {
    G_STRUCT_OFFSET (ClothModel, stretch_warp),
    G_STRUCT_OFFSET (ClothModel, stretch_weft),
    G_STRUCT_OFFSET (ClothModel, shear),
    G_STRUCT_OFFSET (ClothModel, bending_warp),
    G_STRUCT_OFFSET (ClothModel, bending_weft),
    G_STRUCT_OFFSET (ClothModel, damping_mass),
    G_STRUCT_OFFSET (ClothModel, damping_stiffness),
  };
  g_autoptr (ClothScene) scene = sway_scene (17, 18);
  const guint n = 3 * 17 * 18;
  g_autofree gdouble *x0 = NULL, *v0 = NULL;
  ClothModel *models[N_RUNS];
  gdouble *x[N_RUNS];
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  g_autoptr (ClothSim) start = NULL, sim = NULL;

  for (guint i = 0; i < N_RUNS; i++) {
    models[i] = cloth_model_new ();
    if (i) {
      gdouble step = (i - 1) % 2 ? 1e-5 : 1e-3;

      G_STRUCT_MEMBER (gdouble, models[i], offset[(i - 1) / 2]) *= 1. + step;
    }
  }
  start = run_new (scene, models[0]);
  run_for (start, 1.);
  x0 = positions_of (start, 0);
  v0 = velocities_of (start, 0);
  sim = cloth_sim_new (scene, (const ClothModel * const *) models, N_RUNS,
      &options, NULL);
  for (guint i = 0; i < N_RUNS; i++)
    cloth_sim_set_state (sim, i, x0, v0, 1.);
  run_for (sim, 0.4);
  for (guint i = 0; i < N_RUNS; i++)
    x[i] = positions_of (sim, i);
  for (guint key = 0; key < N_KEYS; key++) {
    gdouble square = 0., error = 0.;

    for (guint i = 0; i < n; i++) {
      gdouble coarse = (x[1 + 2 * key][i] - x[0][i]) / 1e-3;
      gdouble fine = (x[2 + 2 * key][i] - x[0][i]) / 1e-5;

      square += fine * fine;
      error += (coarse - fine) * (coarse - fine);
    }
    g_test_message ("key %u: |∂x| = %.4g m, steps disagree by %.3f", key,
        sqrt (square), sqrt (error / square));
    g_assert_cmpfloat (square, >, 0.);
    g_assert_cmpfloat (sqrt (error / square), <, 0.1);
  }
  for (guint i = 0; i < N_RUNS; i++) {
    cloth_model_free (models[i]);
    g_free (x[i]);
  }
}

/* A sheet drawn as a whole to a target is a damped oscillator, of its own gain in each
 * lane; a target that is no number draws nothing. */
static void
test_targets (gconstpointer data)
{
  gboolean implicit = GPOINTER_TO_UINT (data) == CLOTH_INTEGRATOR_IMPLICIT;
  g_autoptr (ClothScene) scene = sheet_new (COLUMNS, ROWS, 0.25, 0.3125);
  g_autoptr (ClothModel) model = fabric ();
  const ClothModel *models[3] = { model, model, model };
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  const gdouble gain[2] = { 100., 1600. }, speed = 0.1, offset = 0.01, t = 0.3;
  const gdouble weight[2] = { 1., 0.25 };
  g_autoptr (ClothSim) sim = NULL;
  gdouble now[3 * N], next[3 * N], velocity[3 * N], weights[N], nan[3 * N];

  scene->gravity[2] = 0.;
  model->integrator = GPOINTER_TO_UINT (data);
  model->time_step = implicit ? 2e-3 : 1e-4;
  sim = cloth_sim_new (scene, models, 3, &options, NULL);
  for (guint i = 0; i < 3 * N; i++) {
    now[i] = scene->positions[i] + (i % 3 == 1 ? offset : 0.);
    next[i] = now[i] + (i % 3 == 1 ? speed * t : 0.);
    velocity[i] = i % 3 == 1 ? speed : 0.;
    nan[i] = NAN;
  }
  for (guint k = 0; k < 2; k++) {
    for (guint i = 0; i < N; i++)
      weights[i] = weight[k];
    cloth_sim_set_targets (sim, k, now, next, velocity, velocity, weights, NULL,
        gain[k], sqrt (gain[k]), 0., t);
  }
  cloth_sim_set_targets (sim, 2, nan, next, velocity, velocity, weights, NULL,
      100., 10., 0., t);
  run_for (sim, t);
  for (guint k = 0; k < 3; k++) {
    g_autofree gdouble *x = positions_of (sim, k);
    gdouble y = 0.;

    if (k < 2) {
      /* e″ + w d e′ + w g e = 0 for e = target − x, e(0) = offset, e′(0) = speed */
      gdouble c = weight[k] * sqrt (gain[k]) / 2.;
      gdouble omega = sqrt (weight[k] * gain[k] - c * c);

      y = offset + speed * t - exp (-c * t) * (offset * cos (omega * t) +
          (speed + c * offset) / omega * sin (omega * t));
    }
    for (guint i = 0; i < N; i++) {
      assert_within (x[3 * i], scene->positions[3 * i], 1e-8);
      assert_within (x[3 * i + 1], y, 1e-4);
    }
  }
}

/* Models of unlike effects, each with gains of its own, drawn one by one and all at once. */
static void
test_all_targets (void)
{
  g_autoptr (ClothScene) scene = crumpled (5);
  const ClothSimOptions options = { TRUE, 2, CLOTH_SIMD_BEST, 0 };
  const gdouble gains[5] = { 0., 100., 400., 1600., 900. };
  const gdouble dampings[5] = { 0., 10., 20., 30., 40. };
  const gdouble drag = 1.;
  ClothModel *models[5];
  g_autoptr (ClothSim) one = NULL, all = NULL;
  gdouble now[3 * N], next[3 * N], velocity[3 * N], weights[N];

  for (guint m = 0; m < 5; m++) {
    models[m] = fabric ();
    models[m]->stretch_warp += m;
    if (m % 2)
      cloth_model_set_effect (models[m], &cloth_effect_air_drag, &drag);
  }
  one = cloth_sim_new (scene, (const ClothModel * const *) models, 5, &options,
      NULL);
  all = cloth_sim_new (scene, (const ClothModel * const *) models, 5, &options,
      NULL);
  for (guint i = 0; i < 3 * N; i++) {
    now[i] = i % 50 ? scene->positions[i] : NAN;
    next[i] = scene->positions[i] + 0.01 * (i % 3);
    velocity[i] = 0.1;
    weights[i / 3] = i / 3 % 7 ? 1. : 0.;
  }
  for (guint m = 0; m < 5; m++)
    cloth_sim_set_targets (one, m, now, next, velocity, velocity, weights, NULL,
        gains[m], dampings[m], 0., 0.1);
  cloth_sim_set_all_targets (all, now, next, velocity, velocity, weights, NULL,
      gains, dampings, 0., 0.1);
  run_for (one, 0.1);
  run_for (all, 0.1);
  for (guint m = 0; m < 5; m++) {
    g_autofree gdouble *x = positions_of (one, m), *y = positions_of (all, m);

    g_assert_cmpmem (x, 3 * N * sizeof *x, y, 3 * N * sizeof *y);
    cloth_model_free (models[m]);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_data_func ("/sim/momentum",
      GUINT_TO_POINTER (CLOTH_FORCE_MEMBRANE), test_momentum);
  g_test_add_data_func ("/sim/momentum-mass-spring",
      GUINT_TO_POINTER (CLOTH_FORCE_MASS_SPRING), test_momentum);
  g_test_add_func ("/sim/grid", test_grid);
  g_test_add_func ("/sim/gradient", test_gradient);
  g_test_add_func ("/sim/energy", test_energy);
  g_test_add_func ("/sim/mirror", test_mirror);
  g_test_add_func ("/sim/rotation", test_rotation);
  g_test_add_func ("/sim/gauge", test_gauge);
  g_test_add_data_func ("/sim/convergence",
      GUINT_TO_POINTER (CLOTH_FORCE_MEMBRANE), test_convergence);
  g_test_add_data_func ("/sim/convergence-mass-spring",
      GUINT_TO_POINTER (CLOTH_FORCE_MASS_SPRING), test_convergence);
  g_test_add_data_func ("/sim/convergence-damped",
      GUINT_TO_POINTER (2 + CLOTH_FORCE_MEMBRANE), test_convergence);
  g_test_add_data_func ("/sim/convergence-damped-mass-spring",
      GUINT_TO_POINTER (2 + CLOTH_FORCE_MASS_SPRING), test_convergence);
  g_test_add_data_func ("/sim/drawn", GUINT_TO_POINTER (0), test_drawn);
  g_test_add_data_func ("/sim/drawn-staged", GUINT_TO_POINTER (1), test_drawn);
  g_test_add_data_func ("/sim/drawn-pulls", GUINT_TO_POINTER (2), test_drawn);
  g_test_add_func ("/sim/drawn-late", test_drawn_late);
  g_test_add_func ("/sim/copy", test_copy);
  g_test_add_data_func ("/sim/epoch", GUINT_TO_POINTER (FALSE), test_epoch);
  g_test_add_data_func ("/sim/epoch-single", GUINT_TO_POINTER (TRUE),
      test_epoch);
  g_test_add_data_func ("/sim/targets",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_EXPLICIT), test_targets);
  g_test_add_data_func ("/sim/targets-implicit",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_IMPLICIT), test_targets);
  g_test_add_func ("/sim/targets-all", test_all_targets);
  g_test_add_func ("/sim/derivatives", test_derivatives);
  return g_test_run ();
}
