/* Strain of a mesh against what is known in closed form.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/mesh/strain.h"

#define COLUMNS 7
#define ROWS 5
#define N (COLUMNS * ROWS)
#define WIDTH 0.3
#define HEIGHT 0.16

/* A grid of quads, or of triangles whose diagonals turn. */
static ClothTopology *
make_mesh (gboolean triangles)
{
  ClothTopology *grid = cloth_topology_new_grid (COLUMNS, ROWS, (gfloat) WIDTH,
      (gfloat) HEIGHT);
  ClothTopology *mesh;

  if (!triangles)
    return grid;
  mesh = cloth_topology_new (N, 2 * grid->n_faces);
  for (guint i = 0; i < 2 * N; i++)
    mesh->uv[i] = grid->uv[i];
  for (guint f = 0; f < grid->n_faces; f++) {
    const guint32 *q = grid->faces + 4 * f;
    const guint turn = f % 2;

    for (guint k = 0; k < 2; k++) {
      guint32 *face = mesh->faces + 4 * (2 * f + k);

      face[0] = q[turn + 2 * k];
      face[1] = q[(turn + 2 * k + 1) % 4];
      face[2] = q[(turn + 2 * k + 2) % 4];
      face[3] = CLOTH_NO_VERTEX;
    }
  }
  cloth_topology_free (grid);
  return mesh;
}

/* x = F uv + t for every vertex; F is 3×2, row by row. */
static void
map (const ClothTopology * mesh, const gdouble F[6], const gdouble t[3],
    gfloat * positions)
{
  for (guint i = 0; i < mesh->n_vertices; i++)
    for (guint k = 0; k < 3; k++)
      positions[3 * i + k] = (gfloat) (F[2 * k] * mesh->uv[2 * i] +
          F[2 * k + 1] * mesh->uv[2 * i + 1] + t[k]);
}

static void
expect_all (const ClothTopology * mesh, const ClothStrains * strains,
    gdouble warp, gdouble weft, gdouble shear, gdouble tolerance)
{
  const gdouble wanted[3] = { warp, weft, shear };
  const gfloat *faces = cloth_strains_get_faces (strains);
  const gfloat *vertices = cloth_strains_get_vertices (strains);

  for (guint i = 0; i < 3 * mesh->n_faces; i++)
    g_assert_cmpfloat_with_epsilon (faces[i], wanted[i % 3], tolerance);
  for (guint i = 0; i < 3 * mesh->n_vertices; i++)
    g_assert_cmpfloat_with_epsilon (vertices[i], wanted[i % 3], tolerance);
}

/* Everything that is the same over the cloth, in quads and in triangles. */
static void
test_even (void)
{
  const gdouble c = cos (0.3), s = sin (0.3), gamma = 0.2;
  /* a turn about x of what a turn about z made of the sheet, and a mirrored one */
  const struct
  {
    gdouble F[6], t[3], warp, weft, shear;
  } cases[] = {
    {{1, 0, 0, 1, 0, 0}, {0, 0, 0}, 0, 0, 0},
    {{c, -s, s * c, c * c, s * s, c * s}, {0.7, -1.2, 2}, 0, 0, 0},
    {{0, 0, -1, 0, 0, 1}, {3, 2, 1}, 0, 0, 0},
    {{1.1, 0, 0, 1, 0, 0}, {0, 0, 0}, (1.1 * 1.1 - 1) / 2, 0, 0},
    {{0, 1, 0.9, 0, 0, 0}, {0, 0, 0}, (0.81 - 1) / 2, 0, 0},
    {{0, 0, 1, 0, 0, 1.3}, {0, 0, 1}, 0, 0.69 / 2, 0},
    /* simple shear: the weft leans over and gets longer */
    {{1, 0.2, 0, 1, 0, 0}, {0, 0, 0}, 0, 0.02, 0.1},
    /* a trellis: the threads keep their lengths, the angle closes by gamma */
    {{1, sin (gamma), 0, cos (gamma), 0, 0}, {0, 0, 0}, 0, 0, sin (gamma) / 2},
    {{1, -sin (gamma), 0, cos (gamma), 0, 0}, {0, 0, 0}, 0, 0, -sin (gamma)
        / 2},
    /* shrunk to a point: E is −½ */
    {{0, 0, 0, 0, 0, 0}, {1, 1, 1}, -0.5, -0.5, 0},
  };

  for (guint triangles = 0; triangles < 2; triangles++) {
    g_autoptr (ClothTopology) mesh = make_mesh (triangles);
    g_autoptr (ClothStrains) strains = cloth_strains_new (mesh);
    gfloat positions[3 * N];

    for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
      map (mesh, cases[i].F, cases[i].t, positions);
      cloth_strains_measure (strains, positions, NULL);
      expect_all (mesh, strains, cases[i].warp, cases[i].weft, cases[i].shear,
          2e-5);
    }
  }
}

/* Where uv points does not matter: a sheet that lies at an angle in uv, far off. */
static void
test_uv_elsewhere (void)
{
  g_autoptr (ClothTopology) mesh = make_mesh (FALSE);
  g_autoptr (ClothStrains) strains = NULL;
  gfloat positions[3 * N];
  const gdouble c = cos (0.25 * G_PI);
  const gdouble F[6] = { 1.2, 0, 0, 1, 0, 0 }, none[3] = { 0, 0, 0 };

  /* stretched along the old u, which runs between warp and weft now */
  map (mesh, F, none, positions);
  for (guint i = 0; i < N; i++) {
    const gdouble u = mesh->uv[2 * i], v = mesh->uv[2 * i + 1];

    mesh->uv[2 * i] = (gfloat) (c * u - c * v + 1);
    mesh->uv[2 * i + 1] = (gfloat) (c * u + c * v - 2);
  }
  strains = cloth_strains_new (mesh);
  cloth_strains_measure (strains, positions, NULL);
  /* E = 0.22 along (1, 1) / √2 */
  expect_all (mesh, strains, 0.11, 0.11, 0.11, 1e-4);
}

/* Bent to a cylinder a sheet is not stretched. The mesh cuts its arcs short: a chord of
 * an arc h is 2 r sin (h / 2r). */
static void
test_cylinder (void)
{
  const gdouble r = 0.1, h = WIDTH / (COLUMNS - 1);
  const gdouble lambda = 2 * r / h * sin (h / 2 / r);
  g_autoptr (ClothTopology) mesh = make_mesh (FALSE);
  g_autoptr (ClothStrains) strains = cloth_strains_new (mesh);
  gfloat positions[3 * N];

  for (guint i = 0; i < N; i++) {
    positions[3 * i] = (gfloat) (r * sin (mesh->uv[2 * i] / r));
    positions[3 * i + 1] = mesh->uv[2 * i + 1];
    positions[3 * i + 2] = (gfloat) (r * (1 - cos (mesh->uv[2 * i] / r)));
  }
  cloth_strains_measure (strains, positions, NULL);
  expect_all (mesh, strains, (lambda * lambda - 1) / 2, 0, 0, 1e-5);
  /* second order in the size of the mesh, where one of first order had h / r */
  g_assert_cmpfloat (fabs (lambda * lambda - 1) / 2, <, h * h / r / r / 23);
}

/* Only faces that are seen whole count; a vertex lives on its other faces. */
static void
test_unseen (void)
{
  g_autoptr (ClothTopology) mesh = make_mesh (FALSE);
  g_autoptr (ClothStrains) strains = cloth_strains_new (mesh);
  const gdouble F[6] = { 1.1, 0, 0, 1, 0, 0 }, none[3] = { 0, 0, 0 };
  const guint lost = 2 * COLUMNS + 2;
  gfloat positions[3 * N];
  guint8 states[N];

  for (guint by_state = 0; by_state < 2; by_state++) {
    const gfloat *faces, *vertices;

    map (mesh, F, none, positions);
    memset (states, CLOTH_VERTEX_MEASURED, sizeof states);
    if (by_state) {
      /* held at a place that is far off */
      states[lost] = CLOTH_VERTEX_UNSEEN;
      positions[3 * lost] = 5;
    } else {
      positions[3 * lost + 1] = NAN;
    }
    cloth_strains_measure (strains, positions, by_state ? states : NULL);
    faces = cloth_strains_get_faces (strains);
    vertices = cloth_strains_get_vertices (strains);
    for (guint f = 0; f < mesh->n_faces; f++) {
      const guint32 *face = mesh->faces + 4 * f;
      gboolean whole = TRUE;

      for (guint k = 0; k < 4; k++)
        whole = whole && face[k] != lost;
      if (whole)
        g_assert_cmpfloat_with_epsilon (faces[3 * f], 0.105, 1e-5);
      else
        g_assert_true (isnan (faces[3 * f]) && isnan (faces[3 * f + 2]));
    }
    for (guint i = 0; i < N; i++) {
      if (i == lost)
        g_assert_true (isnan (vertices[3 * i]));
      else
        g_assert_cmpfloat_with_epsilon (vertices[3 * i], 0.105, 1e-5);
    }
  }
}

/* Without uv nothing is known, without faces neither. */
static void
test_no_uv (void)
{
  g_autoptr (ClothTopology) mesh = make_mesh (FALSE);
  g_autoptr (ClothTopology) points = cloth_topology_new (4, 0);
  gsize i;

  for (i = 0; i < 2 * N; i++)
    mesh->uv[i] = 0;
  g_assert_null (cloth_strains_new (mesh));
  /* all on one line */
  for (i = 0; i < N; i++)
    mesh->uv[2 * i] = (gfloat) i;
  g_assert_null (cloth_strains_new (mesh));
  g_assert_null (cloth_strains_new (points));
}

/* A triangle that is flat on the cloth has no strain and takes no part in that of others. */
static void
test_degenerate (void)
{
  g_autoptr (ClothTopology) mesh = cloth_topology_new (4, 2);
  g_autoptr (ClothStrains) strains = NULL;
  const gfloat uv[] = { 0, 0, 1, 0, 0, 1, 2, 0 };
  const guint32 faces[] =
      { 0, 1, 2, CLOTH_NO_VERTEX, 0, 1, 3, CLOTH_NO_VERTEX };
  const gfloat positions[] = { 0, 0, 0, 1.2f, 0, 0, 0, 1, 0, 9, 9, 9 };
  const gfloat *got;

  memcpy (mesh->uv, uv, sizeof uv);
  memcpy (mesh->faces, faces, sizeof faces);
  strains = cloth_strains_new (mesh);
  cloth_strains_measure (strains, positions, NULL);
  got = cloth_strains_get_faces (strains);
  g_assert_cmpfloat_with_epsilon (got[0], 0.22, 1e-6);
  g_assert_true (isnan (got[3]));
  got = cloth_strains_get_vertices (strains);
  g_assert_cmpfloat_with_epsilon (got[0], 0.22, 1e-6);
  g_assert_cmpfloat_with_epsilon (got[3], 0.22, 1e-6);
  g_assert_true (isnan (got[9]));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/strain/even", test_even);
  g_test_add_func ("/strain/uv-elsewhere", test_uv_elsewhere);
  g_test_add_func ("/strain/cylinder", test_cylinder);
  g_test_add_func ("/strain/unseen", test_unseen);
  g_test_add_func ("/strain/no-uv", test_no_uv);
  g_test_add_func ("/strain/degenerate", test_degenerate);
  return g_test_run ();
}
