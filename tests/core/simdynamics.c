/* Moving cloth against closed forms of mechanics.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#define G 9.81

/* A strip down from the origin, 2 vertices wide, its upper edge held; its rows are moved
 * by amplitude·shape(depth) along y. */
typedef gdouble (*Shape) (gdouble depth);

static ClothScene *
strip_new (guint rows, gdouble length, Shape shape, gdouble amplitude)
{
  ClothScene *scene = sheet_new (2, rows, length / (rows - 1), length);

  for (guint i = 0; i < 2 * rows; i++)
    scene->positions[3 * i + 1] =
        amplitude * shape ((i / 2) / (gdouble) (rows - 1));
  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, 1);
  return scene;
}

/* Of the lowest row, the time between the first and the second passage of the middle:
 * half a period. */
static gdouble
half_period (ClothSim * sim, guint n_vertices, gdouble until)
{
  gdouble crossing[2] = { 0., 0. }, before = 0.;
  guint n = 0;

  for (guint step = 0; n < 2; step++) {
    g_autofree gdouble *x = positions_of (sim, 0);
    gdouble y = x[3 * n_vertices - 2];

    if (step && y * before < 0.)
      crossing[n++] = cloth_sim_get_time (sim) - 2e-3 * y / (y - before);
    before = y;
    g_assert_cmpfloat (cloth_sim_get_time (sim), <, until);
    cloth_sim_advance (sim, 2e-3 * (step + 1));
  }
  return crossing[1] - crossing[0];
}

static gdouble
straight (gdouble depth)
{
  return depth;
}

/* A stiff strip about its upper edge: ω = √(3g/2L). */
static void
test_pendulum (void)
{
  const gdouble length = 0.5;
  g_autoptr (ClothScene) scene = strip_new (17, length, straight, 5e-3);
  g_autoptr (ClothModel) model = model_new (0.2, 2e4);
  g_autoptr (ClothSim) sim = NULL;

  model->bending_warp = model->bending_weft = 5.;
  sim = run_new (scene, model);
  assert_within (G_PI / half_period (sim, 34, 2.) / sqrt (1.5 * G / length),
      1., 2e-3);
}

/* J0(2.4048 √(height/L)): the first mode of a hanging chain (Daniel Bernoulli). */
static gdouble
chain_mode (gdouble depth)
{
  return j0 (2.404825557695773 * sqrt (1. - depth));
}

static void
test_chain (void)
{
  const gdouble length = 1.;
  g_autoptr (ClothScene) scene = strip_new (61, length, chain_mode, 1e-3);
  g_autoptr (ClothModel) model = model_new (0.2, 4000.);
  g_autoptr (ClothSim) sim = NULL;

  /* Undamped, what the first jerk shakes along the chain throws it sideways from the last
   * digit of a place. */
  model->damping_stiffness = 1e-4;
  sim = run_new (scene, model);
  assert_within (G_PI / half_period (sim, 122, 3.) / (1.2024 * sqrt (G /
              length)), 1., 5e-3);
}

/* Mass damping alone: each mode decays with exp(−αt/2). */
static void
test_decay (void)
{
  const gdouble length = 0.5, alpha = 1.5, t = 1.4;
  const gdouble omega = 1.2024 * sqrt (G / length);
  const guint n = 62;
  g_autoptr (ClothScene) scene = strip_new (31, length, chain_mode, 1e-3);
  g_autoptr (ClothModel) model = model_new (0.2, 2000.);
  g_autoptr (ClothSim) sim = NULL;
  gdouble envelope[2];

  model->damping_mass = alpha;
  sim = run_new (scene, model);
  for (guint end = 0; end < 2; end++) {
    g_autofree gdouble *x = positions_of (sim, 0), *v = velocities_of (sim, 0);
    gdouble q = 0., dq = 0.;

    for (guint i = 0; i < n; i++) {
      q += chain_mode ((i / 2) / 30.) * x[3 * i + 1];
      dq += chain_mode ((i / 2) / 30.) * v[3 * i + 1];
    }
    envelope[end] = q * q + (dq + alpha / 2. * q) * (dq + alpha / 2. * q) /
        (omega * omega - alpha * alpha / 4.);
    if (!end)
      run_for (sim, t);
  }
  assert_within (sqrt (envelope[1] / envelope[0]) / exp (-alpha * t / 2.), 1.,
      1e-2);
}

/* The first mode along a strip damped by βK. Its shortest modes are overdamped, so the
 * step is one in stages; of a chain of masses the mode is a sine all the same. */
static void
test_damped_stretch (void)
{
  const guint rows = 33;
  const gdouble length = 0.5, k = 200., beta = 3e-3, amplitude = 1e-4;
  const gdouble h = length / (rows - 1), speed = sqrt (k / 0.2);
  const gdouble omega = 2. * speed / h * sin (G_PI / 4. / (rows - 1));
  const gdouble gamma = beta * omega * omega / 2.;
  const gdouble damped = sqrt (omega * omega - gamma * gamma);
  g_autoptr (ClothScene) scene = sheet_new (2, rows, h, length);
  g_autoptr (ClothModel) model = model_new (0.2, k);
  g_autoptr (ClothSim) sim = NULL;
  gdouble rest[3];

  scene->gravity[2] = 0.;
  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, 1);
  memcpy (rest, scene->positions + 6 * rows - 3, sizeof rest);
  for (guint i = 0; i < 2 * rows; i++)
    scene->positions[3 * i + 2] -= amplitude *
        sin (G_PI / 2. * (i / 2) / (rows - 1));
  model->damping_stiffness = beta;
  model->compression_ratio = 1.;
  sim = run_new (scene, model);
  /* a plain step would have to be shorter: 2 h c < 4 of the fastest mode */
  g_assert_cmpfloat (cloth_sim_get_time_step (sim), >,
      2. / (beta * 4. * speed * speed / (h * h)));
  for (guint frame = 1; frame < 10; frame++) {
    gdouble t = 0.01 * frame, expected;
    g_autofree gdouble *x = NULL;

    cloth_sim_advance (sim, t);
    x = positions_of (sim, 0);
    expected = exp (-gamma * t) * (cos (damped * t) +
        gamma / damped * sin (damped * t));
    assert_within ((rest[2] - x[6 * rows - 1]) / amplitude, expected, 2e-2);
  }
}

/* Air that moves along with cloth weighs nothing and has inertia M along the
 * normal only, so a flat sheet falls at m / (m + M) of gravity there, stages or not. */
static void
test_added_mass (void)
{
  const gdouble k = 200., m = 0.2, added = 0.3, t = 0.2;
  const gdouble h = 0.5 / 16, gravity[3] = { 2., -3., -4. };

  for (guint staged = 0; staged < 2; staged++) {
    g_autoptr (ClothScene) scene = sheet_new (9, 17, 0.25, 0.5);
    g_autoptr (ClothModel) model = model_new (m, k);
    g_autoptr (ClothSim) sim = NULL;
    g_autofree gdouble *v = NULL;
    gdouble middle;             /* of the last step: velocities are its */

    memcpy (scene->gravity, gravity, sizeof gravity);
    model->damping_stiffness = staged ? 1e-2 : 1e-5;
    cloth_model_set_effect (model, &cloth_effect_added_mass, &added);
    sim = run_new (scene, model);
    /* a plain step would have to be shorter: 2 h c < 4 of the fastest mode */
    g_assert_cmpint (cloth_sim_get_time_step (sim) >
        2. / (model->damping_stiffness * 4. * k / (m * h * h)), ==, staged);
    cloth_sim_advance (sim, t);
    v = velocities_of (sim, 0);
    middle = t - t / ceil (t / cloth_sim_get_time_step (sim) - 1e-9) / 2.;
    for (guint i = 0; i < 3 * 9 * 17; i++)
      assert_within (v[i],
          gravity[i % 3] * middle * (i % 3 == 1 ? m / (m + added) : 1.), 1e-9);
  }
}

/* Held by both ends cloth that does not bend hangs as a cosh. */
static void
test_catenary (void)
{
  const guint cells = 40;
  const gdouble span = 0.8, length = 1.;
  g_autoptr (ClothScene) scene =
      sheet_new (cells + 1, 2, length, length / cells);
  g_autoptr (ClothModel) model = model_new (0.2, 4000.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL;
  gdouble a = 0.3;

  for (guint i = 0; i < 2 * (cells + 1); i++) {
    gdouble s = (gdouble) (i % (cells + 1)) / cells;
    gdouble along = 1. - fabs (1. - 2. * s);

    scene->positions[3 * i] = s < 0.5 ? along * span / 2. :
        span - along * span / 2.;
    scene->positions[3 * i + 1] = i / (cells + 1) * length / cells;
    scene->positions[3 * i + 2] =
        -along * sqrt (length * length - span * span) / 2.;
  }
  for (guint i = 0; i < 4; i++)
    cloth_scene_hold (scene, (i % 2) * cells + i / 2 * (cells + 1));
  model->damping_mass = 12.;
  sim = run_new (scene, model);
  run_for (sim, 2.5);
  x = positions_of (sim, 0);
  /* 2 a sinh (span/2a) = length by Newton */
  for (guint i = 0; i < 50; i++) {
    gdouble u = span / (2. * a);

    a -= (2. * a * sinh (u) - length) / (2. * sinh (u) - 2. * u * cosh (u));
  }
  for (guint i = 0; i <= cells; i++) {
    gdouble s = ((gdouble) i / cells - 0.5) * length;

    assert_within (x[3 * i], span / 2. + a * asinh (s / a), 1e-3);
    assert_within (x[3 * i + 2], sqrt (a * a + s * s) - sqrt (a * a +
            length * length / 4.), 1e-3);
  }
}

/* A strip clamped level at one end sinks by H over a reach of W, a function of
 * Γ = ρgL³/B alone (heavy elastica); H/W over that function. */
static gdouble
sink (ClothScene * scene, guint columns, gdouble cell, ClothForceModel force,
    guint i)
{
  const gdouble gamma[4] = { 0.1, 1., 10., 100. };
  const gdouble ratio[4] = { 0.0125, 0.1247, 1.067, 5.88 };
  const gdouble density = 0.2, length = (columns - 1.5) * cell;
  const gdouble b = density * G * length * length * length / gamma[i];
  g_autoptr (ClothModel) model = model_new (density, 1000.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL;
  guint n = scene->topology->n_vertices, rows = n / columns;
  gdouble down = 0., right = 0.;

  for (guint k = 0; k < n; k++) {
    scene->positions[3 * k + 1] = scene->positions[3 * k + 2];
    scene->positions[3 * k + 2] = 0.;
  }
  for (guint row = 0; row < rows; row++) {
    cloth_scene_hold (scene, row * columns);
    cloth_scene_hold (scene, row * columns + 1);
  }
  model->bending_warp = model->bending_weft = b;
  model->force_model = force;
  /* about twice the slowest frequency */
  model->damping_mass = 2. * MAX (3.516 * sqrt (b / density) / (length *
          length), 1.2024 * sqrt (G / length));
  sim = run_new (scene, model);
  run_for (sim, i < 2 ? 0.6 : 1.6);
  x = positions_of (sim, 0);
  for (guint row = 0; row < rows; row++) {
    guint end = row * columns + columns - 1;

    down -= x[3 * end + 2] / rows;
    /* half of the clamped cell bends with its free neighbour */
    right += (x[3 * end] - cell / 2.) / rows;
  }
  g_test_message ("Γ = %g: H/W %.4f of the closed form's", gamma[i],
      down / right / ratio[i]);
  return down / right / ratio[i];
}

static void
test_cantilever (gconstpointer data)
{
  const gdouble cell = 0.3 / 29.5;

  for (guint i = 0; i < 4; i++) {
    g_autoptr (ClothScene) scene = sheet_new (31, 3, 30. * cell, 2. * cell);

    assert_within (sink (scene, 31, cell, GPOINTER_TO_UINT (data), i), 1.,
        0.02);
  }
}

/* Cells cut along diagonals at random; what is no corner is moved by up to @jitter cells,
 * along the rim on it. */
static ClothScene *
cut_strip (guint columns, guint rows, gdouble cell, gdouble jitter)
{
  g_autoptr (GRand) random = g_rand_new_with_seed (7);
  ClothTopology *topology =
      cloth_topology_new (columns * rows, 2 * (columns - 1) * (rows - 1));
  guint32 *face = topology->faces;

  for (guint i = 0; i < columns * rows; i++) {
    guint column = i % columns, row = i / columns;
    gdouble right = jitter * g_rand_double_range (random, -1., 1.);
    gdouble down = jitter * g_rand_double_range (random, -1., 1.);

    if (column < 2 || column + 1 == columns)
      right = down = 0.;
    if (row == 0 || row + 1 == rows)
      down = 0.;
    topology->uv[2 * i] = (gfloat) (cell * (column + right));
    topology->uv[2 * i + 1] = (gfloat) (cell * (row + down));
  }
  for (guint row = 0; row + 1 < rows; row++) {
    for (guint column = 0; column + 1 < columns; column++) {
      const guint32 i = row * columns + column;
      const guint32 c[4] = { i, i + 1, i + columns + 1, i + columns };
      guint first = g_rand_boolean (random) ? 1 : 0;

      for (guint half = 0; half < 2; half++, face += 4) {
        face[0] = c[first];
        face[1] = c[first + 1 + half];
        face[2] = c[(first + 2 + half) % 4];
        face[3] = CLOTH_NO_VERTEX;
      }
    }
  }
  return cloth_scene_new (topology, 50., 2);
}

/* Not only in grids: narrow strips, which are nearly all rim, and wide ones. */
static void
test_cantilever_cut (void)
{
  static const struct
  {
    guint cells, wide;
    gdouble jitter;
  } cut[] = { {30, 2, 0.}, {30, 2, 0.25}, {20, 8, 0.25} };

  for (guint c = 0; c < G_N_ELEMENTS (cut); c++) {
    const gdouble cell = 0.3 / (cut[c].cells - 0.5);

    for (guint i = 0; i < 4; i++) {
      g_autoptr (ClothScene) scene = cut_strip (cut[c].cells + 1,
          cut[c].wide + 1, cell, cut[c].jitter);

      g_test_message ("%u × %u cells, jitter %g:", cut[c].cells, cut[c].wide,
          cut[c].jitter);
      assert_within (sink (scene, cut[c].cells + 1, cell,
              CLOTH_FORCE_MEMBRANE, i), 1., 0.02);
    }
  }
}

/* Its bending too is the same to the last bit on any instruction set. */
static void
test_cut_variants (gconstpointer single)
{
  g_autoptr (ClothScene) scene = cut_strip (11, 4, 0.02, 0.25);
  g_autoptr (ClothModel) model = model_new (0.2, 100.);
  const ClothModel *models[2] = { model, model };
  g_autofree gdouble *first = NULL;

  cloth_scene_hold (scene, 0);
  model->bending_warp = 2e-5;
  model->bending_weft = 1e-5;
  model->damping_stiffness = 1e-4;
  for (ClothSimd simd = CLOTH_SIMD_SCALAR; simd <= CLOTH_SIMD_AVX512; simd++) {
    const ClothSimOptions options = { GPOINTER_TO_UINT (single), 1, simd, 0 };
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothSim) sim = cloth_sim_new (scene, models, 2, &options,
        &error);
    g_autofree gdouble *x = NULL;

    g_assert_no_error (error);
    run_for (sim, 0.2);
    x = positions_of (sim, 1);
    if (first)
      g_assert_cmpmem (x, 99 * sizeof *x, first, 99 * sizeof *x);
    else
      first = g_steal_pointer (&x);
  }
}

/* Soft cloth held at two corners falls, and is stretched to twice its length about them. Steps found at rest are too long
 * then, above all where damping binds them, so that they have stages. What they make is held against steps so short that
 * nothing binds them. */
static void
test_far_stretched (gconstpointer data)
{
  const ClothForceModel force_model = GPOINTER_TO_UINT (data);
  const guint n = 21;
  g_autoptr (ClothScene) scene = sheet_new (n, n, 0.2, 0.2);
  g_autoptr (ClothModel) model = model_new (0.18, 3.);
  g_autoptr (ClothModel) careful = NULL;
  g_autoptr (ClothSim) sim = NULL, truth = NULL;
  g_autofree gdouble *x = NULL, *y = NULL;
  gdouble most = 0., off = 0.;

  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, n - 1);
  model->force_model = force_model;
  model->damping_stiffness = 3e-3;
  model->damping_mass = 0.5;
  careful = cloth_model_copy (model);
  careful->time_step = 1e-5;
  sim = run_new (scene, model);
  truth = run_new (scene, careful);
  for (guint frame = 0; frame < 20; frame++) {
    run_for (sim, 0.02);
    run_for (truth, 0.02);
    g_clear_pointer (&x, g_free);
    g_clear_pointer (&y, g_free);
    x = positions_of (sim, 0);
    y = positions_of (truth, 0);
    /* the thread down from the corner */
    most = MAX (most, sqrt (pow (y[3 * n] - y[0], 2.) + pow (y[3 * n + 1] -
                y[1], 2.) + pow (y[3 * n + 2] - y[2], 2.)) / 0.01);
    for (guint i = 0; i < 3 * n * n; i++)
      off = MAX (off, fabs (x[i] - y[i]));
  }
  g_test_message ("stretched %.2f times, %.3g mm off", most, 1e3 * off);
  g_assert_cmpfloat (most, >, 1.8);
  g_assert_cmpfloat (off, <, 2e-4);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/pendulum", test_pendulum);
  g_test_add_func ("/sim/chain", test_chain);
  g_test_add_func ("/sim/decay", test_decay);
  g_test_add_func ("/sim/damped-stretch", test_damped_stretch);
  g_test_add_func ("/sim/added-mass", test_added_mass);
  g_test_add_func ("/sim/catenary", test_catenary);
  g_test_add_data_func ("/sim/cantilever",
      GUINT_TO_POINTER (CLOTH_FORCE_MEMBRANE), test_cantilever);
  g_test_add_data_func ("/sim/cantilever-mass-spring",
      GUINT_TO_POINTER (CLOTH_FORCE_MASS_SPRING), test_cantilever);
  g_test_add_func ("/sim/cantilever-cut", test_cantilever_cut);
  g_test_add_data_func ("/sim/cut-variants", GUINT_TO_POINTER (FALSE),
      test_cut_variants);
  g_test_add_data_func ("/sim/cut-variants-single", GUINT_TO_POINTER (TRUE),
      test_cut_variants);
  g_test_add_data_func ("/sim/far-stretched/membrane",
      GUINT_TO_POINTER (CLOTH_FORCE_MEMBRANE), test_far_stretched);
  g_test_add_data_func ("/sim/far-stretched/springs",
      GUINT_TO_POINTER (CLOTH_FORCE_MASS_SPRING), test_far_stretched);
  return g_test_run ();
}
