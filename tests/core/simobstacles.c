/* Cloth on obstacles: Coulomb's law on a slope, nothing goes in, nothing changes that
 * isn't touched; and the nearest points of meshes against boxes' closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#include "gst/math/random.h"
#include "gst/sim/bvh.h"

#define N 7

/* Quads of boxes, counter-clockwise from outside. */
static const guint32 box_quads[6][4] = {
  {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1},
  {4, 5, 7, 6}
};

/* A box about the origin, each face with points of its own as files have it, cut into
 * cells of triangles. */
static void
add_box (ClothScene * scene, const gdouble half[3], gdouble friction,
    guint cells, gboolean top_only)
{
  ClothObstacle o = { CLOTH_OBSTACLE_MESH };
  guint n = cells + 1;

  o.friction = friction;
  o.points = g_new (gdouble, 3 * 6 * n * n);
  o.triangles = g_new (guint32, 3 * 12 * cells * cells);
  for (guint q = top_only ? 5 : 0; q < 6; q++) {
    guint32 first = o.n_points;

    for (guint i = 0; i < n * n; i++) {
      for (guint k = 0; k < 3; k++) {
        gdouble c[4], s = (gdouble) (i % n) / cells, t = (gdouble) (i / n) /
            cells;

        for (guint j = 0; j < 4; j++)
          c[j] = box_quads[q][j] >> k & 1 ? half[k] : -half[k];
        o.points[3 * o.n_points + k] = c[0] + (c[1] - c[0]) * s +
            (c[3] - c[0]) * t;
      }
      o.n_points++;
    }
    for (guint i = 0; i < cells * cells; i++) {
      guint32 a = first + i / cells * n + i % cells;
      guint32 t[6] = { a, a + 1, a + n + 1, a, a + n + 1, a + n };

      memcpy (o.triangles + 3 * o.n_triangles, t, sizeof t);
      o.n_triangles += 2;
    }
  }
  g_array_append_val (scene->obstacles, o);
}

static gdouble
box_distance (const gdouble half[3], const gdouble x[3])
{
  gdouble outside = 0., inside = -INFINITY;

  for (guint k = 0; k < 3; k++) {
    gdouble d = fabs (x[k]) - half[k];

    outside += d > 0. ? d * d : 0.;
    inside = MAX (inside, d);
  }
  return outside > 0. ? sqrt (outside) : inside;
}

static void
test_nearest (void)
{
  g_autoptr (ClothScene) scene = sheet_new (2, 2, 1., 1.);
  const gdouble half[3] = { 0.2, 0.3, 0.1 };
  const ClothObstacle *o;
  g_autoptr (ClothBvh) bvh = NULL;
  ClothRandom random;

  add_box (scene, half, NAN, 5, FALSE);
  o = &g_array_index (scene->obstacles, ClothObstacle, 0);
  bvh = cloth_bvh_new (o->points, o->n_points, o->triangles, o->n_triangles);
  g_assert_true (cloth_bvh_is_closed (bvh));
  cloth_random_init (&random, 3);
  for (guint i = 0; i < 20000; i++) {
    ClothBvhHit hit;
    gdouble x[3], expected, square = 0.;

    for (guint k = 0; k < 3; k++)
      x[k] = cloth_random_uniform (&random) - 0.5;
    g_assert_true (cloth_bvh_nearest (bvh, x, &hit));
    expected = box_distance (half, x);
    assert_within (hit.distance, fabs (expected), 1e-14);
    g_assert_cmpint (hit.inside, ==, expected < 0.);
    assert_within (box_distance (half, hit.point), 0., 1e-14);
    for (guint k = 0; k < 3; k++)
      square += (x[k] - hit.point[k]) * (x[k] - hit.point[k]);
    assert_within (sqrt (square), hit.distance, 1e-14);
    g_assert_false (hit.border);
  }
}

/* What no hierarchy can do anything with. */
static void
test_nearest_bad (void)
{
  const gdouble points[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, NAN, 0, 0 };
  const guint32 bad[6] = { 0, 1, 1, 0, 1, 3 };
  const guint32 mixed[6] = { 0, 1, 3, 0, 1, 2 };
  const gdouble x[3] = { 0.2, 0.2, 2. }, nowhere[3] = { NAN, 0., 0. };
  g_autoptr (ClothBvh) none = cloth_bvh_new (points, 4, bad, 2);
  g_autoptr (ClothBvh) empty = cloth_bvh_new (NULL, 0, NULL, 0);
  g_autoptr (ClothBvh) one = cloth_bvh_new (points, 4, mixed, 2);
  ClothBvhHit hit;

  g_assert_false (cloth_bvh_nearest (none, x, &hit));
  g_assert_false (cloth_bvh_is_closed (none));
  g_assert_false (cloth_bvh_nearest (empty, x, &hit));
  g_assert_true (cloth_bvh_nearest (one, x, &hit));
  assert_within (hit.distance, 2., 1e-15);
  g_assert_false (cloth_bvh_is_closed (one));
  g_assert_false (cloth_bvh_nearest (one, nowhere, &hit));
}

static void
add_plane (ClothScene * scene, gdouble angle, gdouble friction)
{
  ClothObstacle o = { CLOTH_OBSTACLE_PLANE };

  o.normal[0] = sin (angle);
  o.normal[2] = cos (angle);
  o.friction = friction;
  g_array_append_val (scene->obstacles, o);
}

/* Turns the sheet into the plane through the origin that falls along x by an angle,
 * its middle at a height above it. */
static void
lay (ClothScene * scene, gdouble angle, gdouble height)
{
  for (guint i = 0; i < scene->topology->n_vertices; i++) {
    gdouble *x = scene->positions + 3 * i, u = x[0] - 0.1, v = x[2] + 0.1;

    x[0] = u * cos (angle) + height * sin (angle);
    x[1] = v;
    x[2] = -u * sin (angle) + height * cos (angle);
  }
}

static gdouble
slide (gdouble angle, gdouble own, gdouble added, gdouble seconds,
    ClothIntegrator integrator, gdouble * h)
{
  g_autoptr (ClothScene) scene = sheet_new (N, N, 0.2, 0.2);
  g_autoptr (ClothModel) model = model_new (0.2, 50.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL;
  gdouble way = 0.;

  add_plane (scene, angle, own);
  lay (scene, angle, 0.);
  if (added > 0.)
    cloth_model_set (model, "effects.friction.coefficient", added, NULL);
  model->integrator = integrator;
  if (integrator == CLOTH_INTEGRATOR_IMPLICIT)
    model->time_step = 2.5e-3;
  sim = run_new (scene, model);
  run_for (sim, seconds);
  *h = 0.02 / ceil (0.02 / cloth_sim_get_time_step (sim) - 1e-9);
  x = positions_of (sim, 0);
  for (guint i = 0; i < N * N; i++) {
    gdouble dx = x[3 * i] - scene->positions[3 * i];
    gdouble dz = x[3 * i + 2] - scene->positions[3 * i + 2];

    assert_within (dx * sin (angle) + dz * cos (angle), 0., 1e-12);
    way += (dx * cos (angle) - dz * sin (angle)) / (N * N);
  }
  return way;
}

/* On a slope cloth sticks when tan θ < μ; else it slides by g (sin θ − μ cos θ). */
static void
test_slope (gconstpointer data)
{
  ClothIntegrator integrator = GPOINTER_TO_UINT (data);
  gboolean implicit = integrator == CLOTH_INTEGRATOR_IMPLICIT;
  const gdouble angle = G_PI / 6., edge = tan (angle), t = 0.4;
  const gdouble own[] = { edge - 0.01, 0.3, NAN, 0.2, 0. };
  const gdouble added[] = { 0., 0., 0.3, 0.2, 0. };
  /* an implicit step is solved to 1e-3 */
  const gdouble more = implicit ? 0.01 : 1e-3;
  gdouble h;

  assert_within (slide (angle, edge + more, 0., t, integrator, &h), 0., 1e-12);
  assert_within (slide (angle, NAN, edge + more, t, integrator, &h), 0., 1e-12);
  for (guint i = 0; i < G_N_ELEMENTS (own); i++) {
    gdouble mu = (isnan (own[i]) ? 0. : own[i]) + added[i];
    gdouble way = slide (angle, own[i], added[i], t, integrator, &h);
    gdouble slope = 9.81 * (sin (angle) - mu * cos (angle));

    /* explicit steps are exact, an implicit one at most half a step ahead */
    if (implicit)
      assert_within (way, 0.5 * slope * t * (t + h / 2.), slope * t * h / 4. +
          1e-4 * 9.81 * t * t);
    else
      assert_within (way / (0.5 * slope * t * t), 1., 1e-9);
  }
}

typedef gdouble (*Distance) (const gdouble x[3]);

static gdouble
from_sphere (const gdouble x[3])
{
  return sqrt (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) - 0.08;
}

static gdouble
from_capsule (const gdouble x[3])
{
  gdouble y = x[1] - CLAMP (x[1], -0.05, 0.05);

  return sqrt (x[0] * x[0] + y * y + x[2] * x[2]) - 0.04;
}

static gdouble
from_plane (const gdouble x[3])
{
  return x[2];
}

static const gdouble table[3] = { 0.06, 0.05, 0.03 };

static gdouble
from_box (const gdouble x[3])
{
  return box_distance (table, x);
}

/* The top of a wider box alone. */
static const gdouble wide[3] = { 0.3, 0.3, 0.03 };

static gdouble
from_sheet (const gdouble x[3])
{
  return x[2] - wide[2];
}

static const struct
{
  const gchar *name;
  Distance distance;
  gdouble height;
} shapes[] = {
  {"sphere", from_sphere, 0.0801},
  {"plane", from_plane, 0.02},
  {"capsule", from_capsule, 0.041},
  {"box", from_box, 0.031},
  {"sheet", from_sheet, 0.031},
};

static ClothScene *
drop (guint shape, gdouble friction)
{
  ClothScene *scene = sheet_new (N, N, 0.2, 0.2);
  ClothObstacle o = { CLOTH_OBSTACLE_SPHERE };

  lay (scene, 0., shapes[shape].height);
  o.friction = friction;
  if (shape == 0) {
    o.radius_m = 0.08;
    g_array_append_val (scene->obstacles, o);
  } else if (shape == 1) {
    add_plane (scene, 0., friction);
  } else if (shape == 2) {
    o.kind = CLOTH_OBSTACLE_CAPSULE;
    o.radius_m = 0.04;
    o.point[1] = -0.05;
    o.end[1] = 0.05;
    g_array_append_val (scene->obstacles, o);
  } else {
    add_box (scene, shape == 4 ? wide : table, friction, 3, shape == 4);
  }
  return scene;
}

static ClothModel *
soft (guint i)
{
  ClothModel *model = model_new (0.2, 40. + i);
  gdouble friction = 0.1 * i;

  model->bending_warp = model->bending_weft = 1e-5;
  model->damping_mass = 1.;
  model->damping_stiffness = 2e-4;
  model->time_step = 4e-4;
  cloth_model_set (model, "effects.friction.coefficient", friction, NULL);
  return model;
}

/* No particle is ever deeper in than rounding, and the cloth does lie on the obstacle. */
static void
test_rest (void)
{
  for (guint shape = 0; shape < G_N_ELEMENTS (shapes); shape++) {
    g_autoptr (ClothScene) scene = drop (shape, 0.4);
    g_autoptr (ClothModel) model = soft (0);
    g_autoptr (ClothSim) sim = run_new (scene, model);
    gdouble deepest = INFINITY, nearest = INFINITY;

    for (guint frame = 1; frame <= 50; frame++) {
      g_autofree gdouble *x = NULL;

      run_for (sim, 0.02);
      x = positions_of (sim, 0);
      nearest = INFINITY;
      for (guint i = 0; i < N * N; i++)
        nearest = MIN (nearest, shapes[shape].distance (x + 3 * i));
      deepest = MIN (deepest, nearest);
    }
    g_test_message ("%s: deepest %g m, at the end %g m away",
        shapes[shape].name, deepest, nearest);
    g_assert_cmpfloat (deepest, >, -1e-12);
    g_assert_cmpfloat (nearest, <, 1e-6);
  }
}

/* Without friction a level floor takes the momentum along its normal and no other. */
static void
test_momentum (void)
{
  g_autoptr (ClothScene) scene = drop (1, NAN);
  g_autoptr (ClothModel) model = model_new (0.2, 40.);
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *v = NULL;
  gdouble p[3] = { 0., 0., 0. };

  scene->velocities = g_new0 (gdouble, 3 * N * N);
  for (guint i = 0; i < N * N; i++) {
    scene->velocities[3 * i] = 0.3;
    scene->velocities[3 * i + 1] = -0.2;
  }
  sim = run_new (scene, model);
  run_for (sim, 0.5);
  v = velocities_of (sim, 0);
  /* the sheet is level all the time: means of equal weights are its momentum */
  for (guint i = 0; i < 3 * N * N; i++)
    p[i % 3] += v[i] / (N * N);
  assert_within (p[0], 0.3, 1e-12);
  assert_within (p[1], -0.2, 1e-12);
  assert_within (p[2], 0., 1e-12);
}

static void
run_models (const ClothScene * scene, ClothModel * const *models, guint n,
    ClothSimOptions options, gdouble * x)
{
  g_autoptr (ClothSim) sim = cloth_sim_new (scene,
      (const ClothModel * const *) models, n, &options, NULL);

  run_for (sim, 0.3);
  for (guint i = 0; i < n; i++)
    cloth_sim_get_positions (sim, i, x + 3 * N * N * (gsize) i);
}

/* The friction of a neighbour, or where a neighbour lies, changes no bit. */
static void
test_lanes (void)
{
  const ClothSimd sets[] =
      { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2, CLOTH_SIMD_AVX512 };
  gsize n = 3 * N * N;
  g_autofree gdouble *all = g_new (gdouble, 9 * n);
  g_autofree gdouble *other = g_new (gdouble, 9 * n);
  ClothModel *models[9];

  for (guint i = 0; i < 9; i++)
    models[i] = soft (i % 6);
  for (guint shape = 0; shape < G_N_ELEMENTS (shapes); shape++) {
    g_autoptr (ClothScene) scene = drop (shape, 0.1);

    for (guint single = 0; single < 2; single++) {
      for (guint s = 0; s < G_N_ELEMENTS (sets); s++) {
        run_models (scene, models, 9, (ClothSimOptions) {
            single != 0, 1, sets[s], 0}
            , s ? other : all);
        if (s)
          g_assert_cmpmem (all, 9 * n * sizeof *all, other,
              9 * n * sizeof *all);
      }
      g_assert_cmpmem (all, n * sizeof *all, all + 6 * n, n * sizeof *all);
      run_models (scene, models + 4, 1, (ClothSimOptions) {
          single != 0, 1, CLOTH_SIMD_BEST, 0}
          , other);
      g_assert_cmpmem (all + 4 * n, n * sizeof *all, other, n * sizeof *all);
      if (shape == 0 || shape == 2 || shape == 3)
        g_assert_cmpint (memcmp (all, all + n, n * sizeof *all), !=, 0);
    }
  }
  for (guint i = 0; i < 9; i++)
    cloth_model_free (models[i]);
}

/* Obstacles out of reach leave no trace, nor does the effect at its null. */
static void
test_untouched (void)
{
  gsize n = 3 * N * N;

  for (guint shape = 0; shape < G_N_ELEMENTS (shapes); shape++) {
    g_autoptr (ClothScene) with = drop (shape, 0.4);
    g_autoptr (ClothScene) without = drop (shape, 0.4);
    g_autoptr (ClothModel) null = soft (0);
    g_autoptr (ClothModel) plain = soft (0);
    ClothModel *models[2] = { null, plain };
    g_autofree gdouble *a = g_new (gdouble, 2 * n);
    g_autofree gdouble *b = g_new (gdouble, 2 * n);

    g_array_set_size (plain->effects, 0);
    run_models (with, models, 2, (ClothSimOptions) {
        FALSE, 1, CLOTH_SIMD_BEST, 0}
        , a);
    g_assert_cmpmem (a, n * sizeof *a, a + n, n * sizeof *a);
    for (guint i = 0; i < N * N; i++) {
      with->positions[3 * i + 2] -= 3.;
      without->positions[3 * i + 2] -= 3.;
    }
    if (shape == 1)
      g_array_index (with->obstacles, ClothObstacle, 0).point[2] = -9.;
    g_array_set_size (without->obstacles, 0);
    run_models (with, models, 2, (ClothSimOptions) {
        FALSE, 1, CLOTH_SIMD_BEST, 0}
        , a);
    run_models (without, models + 1, 1, (ClothSimOptions) {
        FALSE, 1, CLOTH_SIMD_BEST, 0}
        , b);
    g_assert_cmpmem (a, n * sizeof *a, b, n * sizeof *b);
  }
}

/* A floor that a model has does what a plane of the scene does, at its height, and nothing to its
 * neighbours, which fall past it. */
static void
test_floor (void)
{
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  const gdouble height = 0.125;
  gsize n = 3 * N * N;
  g_autoptr (ClothScene) stated = drop (1, NAN);
  g_autoptr (ClothScene) empty = drop (1, NAN);
  g_autofree gdouble *a = g_new (gdouble, 3 * n);
  g_autofree gdouble *b = g_new (gdouble, 3 * n);
  ClothModel *models[3];

  g_array_set_size (empty->obstacles, 0);
  g_array_index (stated->obstacles, ClothObstacle, 0).point[2] = height;
  for (guint i = 0; i < N * N; i++) {
    stated->positions[3 * i + 2] += height;
    empty->positions[3 * i + 2] += height;
  }
  for (guint i = 0; i < 3; i++)
    models[i] = soft (i);
  run_models (stated, models, 3, options, a);
  cloth_model_set (models[0], "effects.friction.floor", height, NULL);
  cloth_model_set (models[2], "effects.friction.floor", height, NULL);
  run_models (empty, models, 3, options, b);
  for (gsize i = 0; i < n; i++) {
    assert_within (b[i], a[i], 1e-12);
    assert_within (b[2 * n + i], a[2 * n + i], 1e-12);
  }
  for (guint i = 0; i < N * N; i++) {
    g_assert_cmpfloat (b[3 * i + 2], >, height - 1e-9);
    g_assert_cmpfloat (b[n + 3 * i + 2], <, height - 0.2);
  }
  for (guint i = 0; i < 3; i++)
    cloth_model_free (models[i]);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/obstacles/nearest", test_nearest);
  g_test_add_func ("/sim/obstacles/nearest-bad", test_nearest_bad);
  g_test_add_data_func ("/sim/obstacles/slope",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_EXPLICIT), test_slope);
  g_test_add_data_func ("/sim/obstacles/slope-implicit",
      GUINT_TO_POINTER (CLOTH_INTEGRATOR_IMPLICIT), test_slope);
  g_test_add_func ("/sim/obstacles/rest", test_rest);
  g_test_add_func ("/sim/obstacles/momentum", test_momentum);
  g_test_add_func ("/sim/obstacles/lanes", test_lanes);
  g_test_add_func ("/sim/obstacles/untouched", test_untouched);
  g_test_add_func ("/sim/obstacles/floor", test_floor);
  return g_test_run ();
}
