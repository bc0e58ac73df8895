/* The effects of numerics: against meshes and steps that are the same without them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "simscene.h"

#include "gst/sim/halving.h"

/* Sizes are binary fractions: half of a float is the same float on both ways. */
#define COLUMNS 6
#define ROWS 5
#define N (COLUMNS * ROWS)
#define CELL 0.03125

static ClothModel *
fabric (void)
{
  ClothModel *model = model_new (0.2, 50.);

  model->stretch_weft = 70.;
  model->bending_warp = 2e-5;
  model->bending_weft = 1e-5;
  model->damping_stiffness = 1e-3;
  model->time_step = 2e-5;
  return model;
}

static void
set_numerics (ClothModel * model, const ClothEffect * effect, gdouble value)
{
  cloth_model_set_effect (model, effect, &value);
}

/* Where the sheet is: bilinear between the vertices of a coarse grid, whose places are a
 * smooth function, so that finer grids of it have the same places. */
static void
bulge (gdouble column, gdouble row, gdouble place[3])
{
  gdouble c = floor (column), r = floor (row), s = column - c, t = row - r;

  memset (place, 0, 3 * sizeof *place);
  for (guint k = 0; k < 4; k++) {
    gdouble a = c + k % 2, b = r + k / 2;
    gdouble weight = (k % 2 ? s : 1. - s) * (k / 2 ? t : 1. - t);

    if (weight == 0.)
      continue;
    place[0] += weight * (CELL * a + 0.001 * b * b / 16.);
    place[1] += weight * 0.01 * sin (0.7 * a + 0.4 * b);
    place[2] += weight * (-CELL * b + 0.001 * a);
  }
}

/* A sheet of factor times as many edges; its top edge is held along a path. */
static ClothScene *
bulging (guint factor)
{
  guint columns = factor * (COLUMNS - 1) + 1, rows = factor * (ROWS - 1) + 1;
  ClothScene *scene = cloth_scene_new (cloth_topology_new_grid (columns, rows,
          CELL * (COLUMNS - 1), CELL * (ROWS - 1)), 50., 6);

  for (guint i = 0; i < columns * rows; i++)
    bulge ((gdouble) (i % columns) / factor, (gdouble) (i / columns) / factor,
        scene->positions + 3 * i);
  /* old corners first: effects count clamps in the scene's order */
  for (guint i = 0; i < COLUMNS; i++)
    cloth_scene_hold (scene, i * factor);
  for (guint i = 0; i < columns; i++)
    if (i % factor)
      cloth_scene_hold (scene, i);
  for (guint frame = 0; frame < 6; frame++)
    for (guint i = 0; i < columns; i++)
      scene->clamps[3 * (columns * frame + i) + 1] += 0.00390625 * frame;
  return scene;
}

static void
assert_same_bits (const gdouble * x, const gdouble * y, gsize n)
{
  g_assert_cmpmem (x, n * sizeof *x, y, n * sizeof *y);
}

/* At null nothing changes, to the last bit. */
static void
test_null (void)
{
  g_autoptr (ClothScene) scene = bulging (1);
  g_autoptr (ClothModel) model = fabric ();
  g_autofree gdouble *x = state_at (scene, model, 0.1), *y = NULL;

  cloth_model_set_effect (model, &cloth_effect_time_step, NULL);
  cloth_model_set_effect (model, &cloth_effect_mesh_resolution, NULL);
  cloth_model_set_effect (model, &cloth_effect_mesh_diagonals, NULL);
  y = state_at (scene, model, 0.1);
  assert_same_bits (x, y, 3 * N);
}

/* The effect on a grid is the simulation of the finer grid, seen at the old vertices. */
static void
test_resolution (gconstpointer data)
{
  guint factor = GPOINTER_TO_UINT (data);
  g_autoptr (ClothScene) scene = bulging (1), fine = bulging (factor);
  g_autoptr (ClothModel) model = fabric ();
  g_autofree gdouble *x = NULL, *y = state_at (fine, model, 0.1), *null = NULL;
  guint columns = factor * (COLUMNS - 1) + 1;
  gdouble moved = 0.;

  null = state_at (scene, model, 0.1);
  set_numerics (model, &cloth_effect_mesh_resolution, factor);
  x = state_at (scene, model, 0.1);
  for (guint i = 0; i < N; i++) {
    guint j = i / COLUMNS * factor * columns + i % COLUMNS * factor;

    for (guint k = 0; k < 3; k++) {
      assert_within (x[3 * i + k], y[3 * j + k], 1e-12);
      moved = MAX (moved, fabs (x[3 * i + k] - null[3 * i + k]));
    }
  }
  g_test_message ("edges / %u move vertices by up to %.2f mm", factor,
      1e3 * moved);
  g_assert_cmpfloat (moved, >, 1e-5);
}

/* What is put in and drawn to is spread over the finer grid. */
static void
test_state (void)
{
  g_autoptr (ClothScene) scene = bulging (1), fine = bulging (2);
  g_autoptr (ClothModel) model = fabric ();
  g_autoptr (ClothSim) one = NULL, two = run_new (fine, model);
  const guint n = fine->topology->n_vertices;
  g_autofree gdouble *v = g_new0 (gdouble, 3 * n), *target = NULL;
  g_autofree gdouble *weights = g_new0 (gdouble, n), *x = NULL, *y = NULL;

  set_numerics (model, &cloth_effect_mesh_resolution, 2.);
  one = run_new (scene, model);
  for (guint side = 0; side < 2; side++) {
    ClothScene *at = side ? fine : scene;
    ClothSim *sim = side ? two : one;
    guint factor = side + 1, columns = factor * (COLUMNS - 1) + 1;

    g_free (target);
    target = g_memdup2 (at->positions,
        3 * at->topology->n_vertices * sizeof *target);
    for (guint i = 0; i < at->topology->n_vertices; i++) {
      gdouble column = (gdouble) (i % columns) / factor;

      v[3 * i + 1] = 0.25 * column;
      target[3 * i + 1] += 0.125 * column;
      weights[i] = 1.;
      /* one vertex is not seen; what lies between it and its neighbours isn't either */
      if (fabs (column - 3.) < 1. && fabs ((gdouble) (i / columns) / factor -
              3.) < 1.)
        weights[i] = column == 3. ? NAN : 0.;
    }
    cloth_sim_set_state (sim, 0, at->positions, v, 0.);
    cloth_sim_set_targets (sim, 0, target, target, v, v, weights, NULL, 1600.,
        40., 0., 1.);
    run_for (sim, 0.06);
  }
  x = positions_of (one, 0);
  y = positions_of (two, 0);
  g_assert_cmpuint (cloth_sim_get_n_vertices (one), ==, N);
  for (guint i = 0; i < N; i++)
    for (guint k = 0; k < 3; k++)
      assert_within (x[3 * i + k], y[3 * (i / COLUMNS * 2 * (2 * COLUMNS - 1) +
                  i % COLUMNS * 2) + k], 1e-12);
}

/* The grid as a mesh of faces like any other; as triangles. */
static ClothScene *
unruled (const ClothScene * grid, gboolean triangles)
{
  const ClothTopology *old = grid->topology;
  ClothTopology *topology = cloth_topology_new (old->n_vertices,
      old->n_faces * (triangles ? 2 : 1));
  ClothScene *scene;

  memcpy (topology->uv, old->uv, 2 * old->n_vertices * sizeof *old->uv);
  for (guint i = 0; i < old->n_faces; i++) {
    const guint32 *f = old->faces + 4 * i;
    const guint32 two[8] = { f[0], f[1], f[2], CLOTH_NO_VERTEX,
      f[0], f[2], f[3], CLOTH_NO_VERTEX
    };

    if (triangles)
      memcpy (topology->faces + 8 * i, two, sizeof two);
    else
      memcpy (topology->faces + 4 * i, f, 4 * sizeof *f);
  }
  scene = cloth_scene_new (topology, 50., 2);
  memcpy (scene->positions, grid->positions,
      3 * old->n_vertices * sizeof (gdouble));
  for (guint i = 0; i < COLUMNS; i++)
    cloth_scene_hold (scene, i);
  return scene;
}

/* All diagonals one way: as a mesh that is no grid, whose faces are cut from their first
 * corner. Bending knows no diagonals of a grid, so here is none. */
static void
test_one_way (void)
{
  g_autoptr (ClothScene) scene = bulging (1), mesh = unruled (scene, FALSE);
  g_autoptr (ClothScene) triangles = unruled (scene, TRUE);
  g_autoptr (ClothModel) model = fabric ();
  g_autofree gdouble *x = NULL, *y = NULL, *z = NULL, *null = NULL;
  gdouble moved = 0.;

  model->bending_warp = model->bending_weft = 0.;
  for (guint i = 0; i < 6 * 3 * COLUMNS; i++)
    scene->clamps[i] = scene->clamps[i % (3 * COLUMNS)];
  y = state_at (mesh, model, 0.1);
  null = state_at (scene, model, 0.1);
  set_numerics (model, &cloth_effect_mesh_diagonals, 2.);
  x = state_at (scene, model, 0.1);
  for (guint i = 0; i < 3 * N; i++) {
    assert_within (x[i], y[i], 1e-12);
    moved = MAX (moved, fabs (x[i] - null[i]));
  }
  g_assert_cmpfloat (moved, >, 1e-5);
  g_clear_pointer (&x, g_free);
  g_clear_pointer (&y, g_free);
  /* halving keeps the direction */
  set_numerics (model, &cloth_effect_mesh_resolution, 2.);
  x = state_at (scene, model, 0.1);
  set_numerics (model, &cloth_effect_mesh_diagonals, 0.);
  y = state_at (mesh, model, 0.1);
  z = state_at (triangles, model, 0.1);
  for (guint i = 0; i < 3 * N; i++) {
    assert_within (x[i], y[i], 1e-12);
    /* triangles share their mass out another way, and lines of quads are bilinear */
    assert_within (x[i], z[i], 4e-3);
  }
}

/* A mirror turns diagonals. With an odd number of cells in a row it leaves it to pattern 1
 * to turn them back. */
static void
test_mirror (void)
{
  g_autoptr (ClothScene) scene = bulging (1), image = bulging (1);
  g_autoptr (ClothModel) model = fabric ();
  g_autofree gdouble *x = NULL, *y = NULL, *z = NULL;
  gdouble moved = 0.;

  for (guint i = 0; i < N; i++) {
    guint j = i / COLUMNS * COLUMNS + COLUMNS - 1 - i % COLUMNS;

    for (guint k = 0; k < 3; k++)
      image->positions[3 * j + k] = (k ? 1. : -1.) *
          scene->positions[3 * i + k];
  }
  for (guint frame = 0; frame < 6; frame++)
    for (guint i = 0; i < COLUMNS; i++)
      for (guint k = 0; k < 3; k++)
        image->clamps[3 * (COLUMNS * frame + COLUMNS - 1 - i) + k] =
            (k ? 1. : -1.) * scene->clamps[3 * (COLUMNS * frame + i) + k];
  x = state_at (scene, model, 0.1);
  z = state_at (image, model, 0.1);
  set_numerics (model, &cloth_effect_mesh_diagonals, 1.);
  y = state_at (image, model, 0.1);
  for (guint i = 0; i < N; i++) {
    guint j = i / COLUMNS * COLUMNS + COLUMNS - 1 - i % COLUMNS;

    for (guint k = 0; k < 3; k++) {
      gdouble sign = k ? 1. : -1.;

      assert_within (y[3 * j + k], sign * x[3 * i + k], 1e-9);
      moved = MAX (moved, fabs (z[3 * j + k] - sign * x[3 * i + k]));
    }
  }
  g_assert_cmpfloat (moved, >, 1e-5);
}

/* Steps: those of a model with that step; never longer than stable ones. */
static void
test_step (void)
{
  g_autoptr (ClothScene) scene = bulging (1);
  g_autoptr (ClothModel) model = fabric ();
  g_autoptr (ClothSim) sim = NULL;
  g_autofree gdouble *x = NULL, *y = NULL;
  gdouble stable;

  model->time_step = 2.5e-5;
  x = state_at (scene, model, 0.1);
  model->time_step = 1e-4;
  set_numerics (model, &cloth_effect_time_step, 0.25);
  y = state_at (scene, model, 0.1);
  assert_same_bits (x, y, 3 * N);

  model->time_step = 0.;
  sim = run_new (scene, model);
  stable = 4. * cloth_sim_get_time_step (sim);
  for (guint i = 0; i < 2; i++) {
    g_clear_pointer (&sim, cloth_sim_free);
    model->time_step = i ? 0.5 * stable : 0.;
    set_numerics (model, &cloth_effect_time_step, 64.);
    sim = run_new (scene, model);
    /* the automatic step is the cheapest one, not the longest */
    if (i)
      g_assert_cmpfloat (cloth_sim_get_time_step (sim), >=, stable);
    else
      assert_within (cloth_sim_get_time_step (sim), stable, 1e-15);
    g_assert_cmpfloat (cloth_sim_get_time_step (sim), <, 0.02);
  }
  run_for (sim, 0.1);
}

/* Two squares sewn along two edges: the middles of these are sewn too. */
static void
test_seams (void)
{
  ClothTopology *topology = cloth_topology_new (8, 2);
  const guint32 faces[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const ClothSeam seams[3] = { {3, 4}, {2, 5}, {1, 6} };
  g_autoptr (ClothScene) scene = NULL;
  ClothHalving *halving;
  GArray *sewn;

  for (guint i = 0; i < 8; i++) {
    topology->uv[2 * i] = (gfloat) (i / 4) + (i % 4 > 1 ? 0.5f : 0.f);
    topology->uv[2 * i + 1] = i % 4 % 3 ? 0.5f : 0.f;
  }
  memcpy (topology->faces, faces, sizeof faces);
  scene = cloth_scene_new (topology, 50., 2);
  g_array_append_vals (scene->seams, seams, 3);
  cloth_scene_hold (scene, 0);
  cloth_scene_hold (scene, 3);
  halving = cloth_halving_new (scene);
  sewn = halving->scene->seams;
  g_assert_cmpuint (halving->scene->topology->n_vertices, ==, 18);
  g_assert_cmpuint (halving->scene->topology->n_faces, ==, 8);
  g_assert_cmpuint (halving->scene->held->len, ==, 3);
  g_assert_cmpuint (sewn->len, ==, 5);
  for (guint i = 3; i < 5; i++) {
    const ClothSeam *seam = &g_array_index (sewn, ClothSeam, i);
    const guint32 *a = halving->from[seam->a], *b = halving->from[seam->b];

    /* sums of the ends: 3 + 2 with 4 + 5, 2 + 1 with 5 + 6 */
    g_assert_cmpuint (a[0] + a[2], ==, i == 3 ? 5 : 3);
    g_assert_cmpuint (b[0] + b[2], ==, i == 3 ? 9 : 11);
  }
  g_assert_true (cloth_scene_check (halving->scene, NULL));
  cloth_halving_free (halving);
}

/* Two corners of a square are held, let go and held again: so is the middle between them, and never meanwhile. */
static void
test_held_again (void)
{
  const gdouble spans[4][2] = { {0., 1.}, {0.5, 1.5}, {2., 3.}, {2., 2.5} };
  g_autoptr (ClothScene) scene = sheet_new (2, 2, 1., 1.);
  ClothHalving *halving;
  guint n = 0;

  for (guint i = 0; i < 4; i++) {
    cloth_scene_hold (scene, i % 2);
    g_array_index (scene->held, ClothHeld, i).from_s = spans[i][0];
    g_array_index (scene->held, ClothHeld, i).until_s = spans[i][1];
  }
  halving = cloth_halving_new (scene);
  g_assert_cmpuint (halving->scene->held->len, ==, 6);
  for (guint i = 4; i < 6; i++) {
    const ClothHeld *held = &g_array_index (halving->scene->held, ClothHeld, i);
    const guint32 *from = halving->from[held->vertex];

    g_assert_cmpuint (from[0] + from[1] + from[2] + from[3], ==, 2);
    n += held->from_s == 0.5 && held->until_s == 1.;
    n += held->from_s == 2. && held->until_s == 2.5;
  }
  g_assert_cmpuint (n, ==, 2);
  cloth_halving_free (halving);
}

static void
assert_refused (const ClothScene * scene, const ClothEffect * effect,
    gdouble value, gboolean one_differs, const gchar * text)
{
  g_autoptr (ClothModel) model = fabric (), other = fabric ();
  const ClothModel *models[2] = { model, one_differs ? other : model };
  g_autoptr (GError) error = NULL;

  set_numerics (model, effect, value);
  g_assert_null (cloth_sim_new (scene, models, 2, NULL, &error));
  g_assert_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL);
  g_test_message ("%s", error->message);
  g_assert_nonnull (strstr (error->message, effect->id));
  g_assert_nonnull (strstr (error->message, text));
}

static void
test_refused (void)
{
  g_autoptr (ClothScene) scene = bulging (1), mesh = unruled (scene, FALSE);
  g_autoptr (ClothScene) triangles = unruled (scene, TRUE), large = NULL;

  assert_refused (scene, &cloth_effect_time_step, 0.5, TRUE, "0 and 1");
  assert_refused (scene, &cloth_effect_mesh_resolution, 2., TRUE, "0 and 1");
  assert_refused (scene, &cloth_effect_mesh_diagonals, 1., TRUE, "0 and 1");
  assert_refused (scene, &cloth_effect_mesh_resolution, 3., FALSE, "2 or 4");
  assert_refused (scene, &cloth_effect_mesh_resolution, 1.5, FALSE, "1.5");
  assert_refused (scene, &cloth_effect_mesh_diagonals, 0.5, FALSE, "0.5");
  assert_refused (mesh, &cloth_effect_mesh_diagonals, 2., FALSE, "columns");
  assert_refused (triangles, &cloth_effect_mesh_diagonals, 1., FALSE, "four");
  large = sheet_new (300, 300, 1., 1.);
  assert_refused (large, &cloth_effect_mesh_resolution, 4., FALSE, "too fine");
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/sim/numerics/null", test_null);
  g_test_add_data_func ("/sim/numerics/halved", GUINT_TO_POINTER (2),
      test_resolution);
  g_test_add_data_func ("/sim/numerics/quartered", GUINT_TO_POINTER (4),
      test_resolution);
  g_test_add_func ("/sim/numerics/state", test_state);
  g_test_add_func ("/sim/numerics/one-way", test_one_way);
  g_test_add_func ("/sim/numerics/mirror", test_mirror);
  g_test_add_func ("/sim/numerics/step", test_step);
  g_test_add_func ("/sim/numerics/seams", test_seams);
  g_test_add_func ("/sim/numerics/held-again", test_held_again);
  g_test_add_func ("/sim/numerics/refused", test_refused);
  return g_test_run ();
}
