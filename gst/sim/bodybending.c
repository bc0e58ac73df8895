/* How a body bends: linear measures of its curvature, on grids and on other meshes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/bodybending.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"
#include "gst/mesh/side.h"
#include "gst/sim/types.h"

/* ---- grids ---- */

static gdouble
uv_distance (const ClothBody * body, guint a, guint b)
{
  return hypot (body->uv[2 * a] - body->uv[2 * b],
      body->uv[2 * a + 1] - body->uv[2 * b + 1]);
}

/* The share of a line of the grid in the direction across it. */
static gdouble
line_width (const ClothBody * body, guint vertex, guint at, guint n,
    guint stride)
{
  gdouble width = 0.;

  if (at > 0)
    width += uv_distance (body, vertex, vertex - stride) / 2.;
  if (at + 1 < n)
    width += uv_distance (body, vertex, vertex + stride) / 2.;
  return width;
}

/* Which way x_u × x_v is of (x3 − x2) × (x1 − x0). */
static gdouble
side_of (const ClothBody * body, const guint vertex[4])
{
  const gdouble *uv = body->uv;
  gdouble along[2], across[2];

  for (guint k = 0; k < 2; k++) {
    along[k] = uv[2 * vertex[3] + k] - uv[2 * vertex[2] + k];
    across[k] = uv[2 * vertex[1] + k] - uv[2 * vertex[0] + k];
  }
  return along[0] * across[1] > along[1] * across[0] ? 1. : -1.;
}

static ClothBodyHinge *
add_grid_hinge (ClothBody * body, const guint vertex[4])
{
  ClothBodyHinge *h = &body->hinges[body->n_hinges++];

  *h = (ClothBodyHinge) {
  .n = 4,.side = side_of (body, vertex)};
  for (guint k = 0; k < 4; k++)
    h->particle[k] = body->particle[vertex[k]];
  return h;
}

/* aside: a vertex beside the row, which gives the fold a normal. */
static void
add_row_of_three (ClothBody * body, guint vertex, guint stride, guint aside,
    gdouble width, gboolean along_u)
{
  const guint all[4] = { vertex, vertex - stride, vertex + stride, aside };
  gdouble one = uv_distance (body, vertex, vertex - stride);
  gdouble two = uv_distance (body, vertex, vertex + stride);
  ClothBodyHinge *h = add_grid_hinge (body, all);

  h->c[0] = 1. / one + 1. / two;
  h->c[1] = -1. / one;
  h->c[2] = -1. / two;
  h->form[along_u ? 0 : 1] = -(one + two) / 2.;
  *(along_u ? &h->warp : &h->weft) = 2. * width / (one + two);
}

static void
add_cell (ClothBody * body, guint vertex)
{
  const guint all[4] = { vertex, vertex + body->columns + 1, vertex + 1,
    vertex + body->columns
  };
  gdouble area = uv_distance (body, vertex, vertex + 1) *
      uv_distance (body, vertex, vertex + body->columns);
  ClothBodyHinge *h = add_grid_hinge (body, all);

  h->c[0] = h->c[1] = 1.;
  h->c[2] = h->c[3] = -1.;
  h->form[2] = M_SQRT1_2 * area;
  h->warp = h->weft = 1. / area;
}

/* A plate's energy ½ ∫ B_warp κ_uu² + B_weft κ_vv² + (B_warp + B_weft) κ_uv² by finite
 * differences on the grid: independent of the diagonals, and free of forces inside a
 * sheet of constant curvature. */
static void
make_grid_hinges (ClothBody * body)
{
  guint columns = body->columns, rows = body->rows;

  body->hinges = g_new (ClothBodyHinge, 3 * (gsize) body->n_vertices);
  for (guint row = 0; row < rows; row++) {
    for (guint column = 0; column < columns; column++) {
      guint i = row * columns + column;

      if (column > 0 && column + 1 < columns)
        add_row_of_three (body, i, 1, row ? i - columns : i + columns,
            line_width (body, i, row, rows, columns), TRUE);
      if (row > 0 && row + 1 < rows)
        add_row_of_three (body, i, columns, column ? i - 1 : i + 1,
            line_width (body, i, column, columns, 1), FALSE);
    }
  }
  body->n_straight = body->n_hinges;
  for (guint row = 0; row + 1 < rows; row++)
    for (guint column = 0; column + 1 < columns; column++)
      add_cell (body, row * columns + column);
}

/* ---- other meshes ---- */

/* A triangle's corner stands for its edge opposite. */
#define NONE G_MAXUINT32

/* The slope across an edge in its middle, Σ weight x; seen from its first triangle it is
 * the slope towards it. */
#define PATCH 8
typedef struct
{
  guint first;                  /* triangle */
  guint n;
  guint32 particle[PATCH];
  gdouble weight[PATCH];
} Slope;

/* Particles about an edge of length 1 along (1, 0) whose middle is the origin, unfolded
 * into its plane. */
typedef struct
{
  guint n;
  guint32 particle[PATCH];
  gdouble at[PATCH][2];
} Patch;

typedef struct
{
  const ClothBody *body;
  const guint32 *corners;       /* vertices of each triangle */
  guint32 *twin;                /* of each corner: the one across its edge, or NONE */
  guint32 *slope;               /* of each corner, or NONE */
  Slope *slopes;
} Mesh;

static gboolean
make_twins (Mesh * mesh, guint * n_slopes, GError ** error)
{
  const ClothBody *body = mesh->body;
  const guint32 *corners = mesh->corners;
  guint n = 3 * body->n_triangles;
  g_autofree ClothSide *sides = g_new (ClothSide, n + 1);

  for (guint i = 0; i < n; i++) {
    const guint32 *p = body->triangles[i / 3].particle;
    guint32 a = p[(i + 1) % 3], b = p[(i + 2) % 3];

    sides[i] = cloth_side (a, b, i / 3, i % 3);
    mesh->twin[i] = mesh->slope[i] = NONE;
  }
  qsort (sides, n, sizeof *sides, cloth_side_compare);
  *n_slopes = 0;
  for (guint i = 0; i + 1 < n; i++) {
    const ClothSide *one = &sides[i], *two = &sides[i + 1];
    guint32 half[2] = { 3 * one->face + one->number,
      3 * two->face + two->number
    };

    if (!cloth_side_same_edge (one, two))
      continue;
    if (i + 2 < n && cloth_side_same_edge (one, two + 1)) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE,
          "more than two triangles meet at the edge of vertices %u and %u",
          corners[3 * one->face + (one->number + 1) % 3],
          corners[3 * one->face + (one->number + 2) % 3]);
      return FALSE;
    }
    mesh->twin[half[0]] = half[1];
    mesh->twin[half[1]] = half[0];
    mesh->slope[half[0]] = mesh->slope[half[1]] = (*n_slopes)++;
  }
  return TRUE;
}

static guint32
particle_of (const Mesh * mesh, guint32 half, guint offset)
{
  return mesh->body->triangles[half / 3].particle[(half % 3 + offset) % 3];
}

static const gdouble *
uv_of (const Mesh * mesh, guint triangle, guint corner)
{
  return mesh->body->uv + 2 * mesh->corners[3 * triangle + corner % 3];
}

/* Adds the corner @half of a triangle whose next two corners are at @from and @to. It lies
 * on the other side of their edge than @away. The corners across the triangle's other two
 * edges follow. */
static void
unfold (const Mesh * mesh, guint32 half, const gdouble from[2],
    const gdouble to[2], const gdouble away[2], guint more, Patch * patch)
{
  guint triangle = half / 3, k = half % 3;
  const guint32 *particle = mesh->body->triangles[triangle].particle;
  const gdouble *a = uv_of (mesh, triangle, k + 1);
  const gdouble *b = uv_of (mesh, triangle, k + 2);
  const gdouble *c = uv_of (mesh, triangle, k);
  gdouble edge[2] = { b[0] - a[0], b[1] - a[1] };
  gdouble rest[2] = { c[0] - a[0], c[1] - a[1] };
  gdouble here[2] = { to[0] - from[0], to[1] - from[1] }, at[2];
  gdouble square = edge[0] * edge[0] + edge[1] * edge[1];
  gdouble along = (rest[0] * edge[0] + rest[1] * edge[1]) / square;
  gdouble across = fabs (edge[0] * rest[1] - edge[1] * rest[0]) / square;
  guint i = 0;

  if (here[0] * (away[1] - from[1]) > here[1] * (away[0] - from[0]))
    across = -across;
  at[0] = from[0] + along * here[0] - across * here[1];
  at[1] = from[1] + along * here[1] + across * here[0];
  while (i < patch->n && patch->particle[i] != particle[k])
    i++;
  if (i == patch->n && i < PATCH) {
    patch->particle[i] = particle[k];
    memcpy (patch->at[i], at, sizeof at);
    patch->n++;
  }
  for (guint side = 1; more > 0 && side < 3; side++) {
    guint32 next = mesh->twin[3 * triangle + (k + side) % 3];
    /* the ends of that edge: the new corner, and from or to */
    const gdouble *other = side == 1 ? to : from;

    if (next == NONE)
      continue;
    if (particle_of (mesh, next, 1) == particle[k])
      unfold (mesh, next, at, other, side == 1 ? from : to, more - 1, patch);
    else
      unfold (mesh, next, other, at, side == 1 ? from : to, more - 1, patch);
  }
}

/* Of the slopes of the two triangles the mean that is right where the cloth bends across
 * the edge; then the least change of the weights that makes it right for every quadratic
 * surface, as far as the triangles about determine one. */
static void
make_slope (const Mesh * mesh, guint32 half, Slope * slope)
{
  static const gdouble ends[2][2] = { {-0.5, 0.}, {0.5, 0.} };
  static const gdouble below[2] = { 0., -1. }, above[2] = { 0., 1. };
  guint32 twin = mesh->twin[half];
  Patch patch = { 2, {particle_of (mesh, half, 1), particle_of (mesh, half,
          2)}, {{-0.5, 0.}, {0.5, 0.}}
  };
  gboolean same = particle_of (mesh, twin, 1) == patch.particle[0];
  gdouble matrix[36] = { 0. }, change[6] = { 0. }, term[PATCH][6], sum = 0.;
  const gdouble *a = uv_of (mesh, half / 3, half % 3 + 1);
  const gdouble *b = uv_of (mesh, half / 3, half % 3 + 2);
  gdouble length = hypot (b[0] - a[0], b[1] - a[1]), height = 0.;

  for (guint more = 0; more < 2; more++) {
    unfold (mesh, half, ends[0], ends[1], below, more, &patch);
    unfold (mesh, twin, ends[!same], ends[same], above, more, &patch);
  }
  slope->first = half / 3;
  slope->n = patch.n;
  memcpy (slope->particle, patch.particle, sizeof slope->particle);
  memset (slope->weight, 0, sizeof slope->weight);
  for (guint side = 2; side < 4 && side < patch.n; side++)
    height += fabs (patch.at[side][1]);
  for (guint side = 2; side < 4 && side < patch.n; side++) {
    const gdouble *at = patch.at[side];
    gdouble part = (1. - fabs (at[1]) / height) / at[1];

    slope->weight[side] += part;
    slope->weight[0] -= part * (0.5 - at[0]);
    slope->weight[1] -= part * (0.5 + at[0]);
  }
  for (guint i = 0; i < patch.n; i++) {
    gdouble x = patch.at[i][0], y = patch.at[i][1];
    const gdouble all[6] = { 1., x, y, x * x, x * y, y * y };

    memcpy (term[i], all, sizeof all);
    for (guint k = 0; k < 6; k++) {
      if (k >= 3)
        change[k] -= slope->weight[i] * all[k];
      for (guint l = 0; l < 6; l++)
        matrix[6 * k + l] += all[k] * all[l];
    }
  }
  for (guint k = 3; k < 6; k++)
    sum += matrix[7 * k];
  for (guint k = 3; k < 6; k++)
    matrix[7 * k] += 1e-6 * sum;
  if (cloth_cholesky_factor (6, matrix)) {
    cloth_cholesky_solve (6, matrix, change);
    for (guint i = 0; i < patch.n; i++)
      for (guint k = 0; k < 6; k++)
        slope->weight[i] += term[i][k] * change[k];
  }
  for (guint i = 0; i < patch.n; i++)
    slope->weight[i] /= length;
}

/* The curvatures of a triangle, Σ c x. */
typedef struct
{
  guint n;
  guint32 particle[CLOTH_HINGE_CORNERS];
  gdouble c[3][CLOTH_HINGE_CORNERS];
} Curvature;

static void
add_weight (Curvature * curvature, guint32 particle, gdouble weight,
    const gdouble form[3])
{
  guint i = 0;

  while (i < curvature->n && curvature->particle[i] != particle)
    i++;
  g_assert (i < CLOTH_HINGE_CORNERS);
  if (i == curvature->n)
    curvature->particle[curvature->n++] = particle;
  for (guint r = 0; r < 3; r++)
    curvature->c[r][i] += weight * form[r];
}

/* Makes @form orthogonal to @basis and of length 1; FALSE if nothing of it is left. */
static gboolean
make_square (gdouble basis[3][3], guint n, gdouble form[3])
{
  for (guint i = 0; i < n; i++) {
    const gdouble dot = cloth_vec3_dot (basis[i], form);

    cloth_vec3_add_scaled (form, -dot, basis[i]);
  }
  return cloth_vec3_normalise (form) >= 1e-3;
}

/* The mean curvature of a triangle by Gauss's theorem, from the slopes at its edges (Oñate
 * and Zárate 2000; the slopes are corrected, so that irregular meshes do as well). As
 * neighbours share these, a sheet of constant curvature is free of forces inside on any
 * mesh. No moment acts across a free edge, so the curvature across it is the one of least
 * energy and adds nothing to it. */
static void
add_triangle_hinges (ClothBody * body, const Mesh * mesh, guint triangle)
{
  const ClothBodyTriangle *t = &body->triangles[triangle];
  Curvature all = { 4, {t->particle[0], t->particle[1], t->particle[2],
      t->particle[0]}, {{0.}}
  };
  gdouble free[3][3], share[3][3] = { {1., 0., 0.}, {0., 1., 0.}, {0., 0.,
      1.}
  };
  const gdouble *uv[3];
  guint n_free = 0;

  for (guint k = 0; k < 3; k++)
    uv[k] = uv_of (mesh, triangle, k);
  for (guint k = 0; k < 3; k++) {
    const gdouble *a = uv[(k + 1) % 3], *b = uv[(k + 2) % 3];
    gdouble du = b[0] - a[0], dv = b[1] - a[1], length = hypot (du, dv);
    gdouble along[2] = { du / length, dv / length };
    gdouble out[2] = { along[1], -along[0] };
    guint32 slope = mesh->slope[3 * triangle + k];
    gdouble square[3], mixed[3];

    if (out[0] * (uv[k][0] - a[0]) + out[1] * (uv[k][1] - a[1]) > 0.)
      out[0] = -out[0], out[1] = -out[1];
    square[0] = out[0] * out[0];
    square[1] = out[1] * out[1];
    square[2] = G_SQRT2 * out[0] * out[1];
    mixed[0] = out[0] * along[0];
    mixed[1] = out[1] * along[1];
    mixed[2] = (out[0] * along[1] + out[1] * along[0]) / G_SQRT2;
    add_weight (&all, t->particle[(k + 1) % 3], -1. / t->area, mixed);
    add_weight (&all, t->particle[(k + 2) % 3], 1. / t->area, mixed);
    if (slope == NONE) {
      memcpy (free[n_free], square, sizeof square);
      if (make_square (free, n_free, free[n_free]))
        n_free++;
      continue;
    }
    for (guint i = 0; i < mesh->slopes[slope].n; i++) {
      const Slope *s = &mesh->slopes[slope];

      add_weight (&all, s->particle[i], (s->first == triangle ? -1. : 1.) *
          s->weight[i] * length / t->area, square);
    }
  }
  for (guint r = 0; r < 3; r++)
    for (guint i = 0; i < n_free; i++)
      for (guint s = 0; s < 3; s++)
        share[r][s] -= free[i][r] * free[i][s];
  for (guint r = 0; r < 3; r++) {
    ClothBodyHinge *h = &body->hinges[body->n_hinges];

    if (share[r][r] < 1e-6)
      continue;
    body->n_hinges++;
    *h = (ClothBodyHinge) {
    .n = all.n,.warp = t->area * (r == 0 ? 1. : r == 1 ? 0. : 0.5),.weft =
          t->area * (r == 1 ? 1. : r == 0 ? 0. : 0.5)};
    memcpy (h->particle, all.particle, sizeof h->particle);
    memcpy (h->form, share[r], sizeof h->form);
    for (guint i = 0; i < all.n; i++)
      for (guint s = 0; s < 3; s++)
        h->c[i] += share[r][s] * all.c[s][i];
    h->side = (uv[0][0] - uv[2][0]) * (uv[1][1] - uv[0][1]) >
        (uv[0][1] - uv[2][1]) * (uv[1][0] - uv[0][0]) ? 1. : -1.;
  }
}

/* The matrix of all hinges, row by row. Multiplying by it is a fraction of the work of
 * going through the hinges one by one. */
static void
make_bends (ClothBody * body)
{
  guint n = body->n_particles;
  g_autofree guint32 *first = g_new0 (guint32, n + 1);
  g_autofree guint32 *slot = g_new (guint32, n);
  g_autofree guint32 *hinge = NULL;
  GArray *bends = g_array_new (FALSE, FALSE, sizeof (ClothBodyBend));

  for (guint i = 0; i < body->n_hinges; i++)
    for (guint k = 0; k < body->hinges[i].n; k++)
      first[body->hinges[i].particle[k]]++;
  for (guint32 i = 0, sum = 0; i <= n; i++) {
    sum += i < n ? first[i] : 0;
    first[i] = sum;
  }
  hinge = g_new (guint32, first[n] + 1);
  for (guint i = body->n_hinges; i-- > 0;)
    for (guint k = 0; k < body->hinges[i].n; k++)
      hinge[--first[body->hinges[i].particle[k]]] = i;
  for (guint i = 0; i < n; i++)
    slot[i] = NONE;
  body->first_bend = g_new (guint32, n + 1);
  for (guint32 i = 0; i < n; i++) {
    guint32 row = body->first_bend[i] = bends->len;

    for (guint32 m = first[i]; m < first[i + 1]; m++) {
      const ClothBodyHinge *h = &body->hinges[hinge[m]];
      gdouble own = 0.;

      /* a corner may be there twice */
      if (m > first[i] && hinge[m] == hinge[m - 1])
        continue;
      for (guint k = 0; k < h->n; k++)
        own += h->particle[k] == i ? h->c[k] : 0.;
      for (guint k = 0; k < h->n; k++) {
        guint32 other = h->particle[k];
        gdouble product = own * h->c[k];
        ClothBodyBend *bend;

        if (other == i || product == 0.)
          continue;
        if (slot[other] == NONE || slot[other] < row) {
          ClothBodyBend new = { other, 0., 0. };

          slot[other] = bends->len;
          g_array_append_val (bends, new);
        }
        bend = &g_array_index (bends, ClothBodyBend, slot[other]);
        bend->warp += h->warp * product;
        bend->weft += h->weft * product;
      }
    }
  }
  body->n_bends = body->first_bend[n] = bends->len;
  body->bends = (ClothBodyBend *) g_array_free (bends, FALSE);
}

/* ½ ∫ B_warp κ_uu² + B_weft κ_vv² + (B_warp + B_weft) κ_uv² triangle by triangle. */
static gboolean
make_mesh_hinges (ClothBody * body, const guint32 * corners, GError ** error)
{
  gsize n = 3 * (gsize) body->n_triangles;
  g_autofree guint32 *twin = g_new (guint32, n + 1);
  g_autofree guint32 *slope = g_new (guint32, n + 1);
  g_autofree Slope *slopes = NULL;
  Mesh mesh = { body, corners, twin, slope, NULL };
  guint n_slopes;

  if (!make_twins (&mesh, &n_slopes, error))
    return FALSE;
  mesh.slopes = slopes = g_new (Slope, n_slopes + 1);
  for (guint32 i = 0; i < n; i++)
    if (twin[i] != NONE && i < twin[i])
      make_slope (&mesh, i, &slopes[slope[i]]);
  body->hinges = g_new (ClothBodyHinge, n + 1);
  for (guint i = 0; i < body->n_triangles; i++)
    add_triangle_hinges (body, &mesh, i);
  make_bends (body);
  return TRUE;
}

static void
make_bounds (ClothBody * body)
{
  for (guint i = 0; i < body->n_particles && body->bends; i++) {
    ClothBodyBound *bound = &body->bounds[i];

    for (guint k = body->first_bend[i]; k < body->first_bend[i + 1]; k++) {
      const ClothBodyBend *bend = &body->bends[k];

      /* the row's sum is 0, so its diagonal is − Σ of the others */
      bound->bend_warp += fabs (bend->warp) - bend->warp;
      bound->bend_weft += fabs (bend->weft) - bend->weft;
    }
  }
  for (guint i = 0; i < body->n_hinges && !body->bends; i++) {
    const ClothBodyHinge *h = &body->hinges[i];
    gdouble sum = 0.;

    for (guint k = 0; k < h->n; k++)
      sum += fabs (h->c[k]);
    for (guint k = 0; k < h->n; k++) {
      ClothBodyBound *bound = &body->bounds[h->particle[k]];

      bound->bend_warp += h->warp * fabs (h->c[k]) * sum;
      bound->bend_weft += h->weft * fabs (h->c[k]) * sum;
    }
  }
}

/* @body: a body whose triangles and bounds of stretch are known
 * @corners: vertices of each triangle
 * @error: #ClothSimError
 *
 * Fills hinges, bends and the bounds of bending.
 *
 * Returns: %FALSE if more than two triangles meet at an edge
 */
gboolean
cloth_body_make_hinges (ClothBody * body, const guint32 * corners,
    GError ** error)
{
  if (body->columns > 1 && body->n_particles == body->n_vertices)
    make_grid_hinges (body);
  else if (!make_mesh_hinges (body, corners, error))
    return FALSE;
  make_bounds (body);
  return TRUE;
}
