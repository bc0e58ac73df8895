/* From a scene to what the lanes share: triangles, hinges, areas, bounds and paths.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/body.h"

#include <math.h>
#include <string.h>

#include "gst/sim/sim.h"

typedef struct
{
  guint32 a, b;                 /* a < b */
  guint32 triangle, opposite;
} Edge;

static guint32
root (guint32 * parent, guint32 i)
{
  while (parent[i] != i)
    i = parent[i] = parent[parent[i]];
  return i;
}

/*
 * cloth_body_merge_seams:
 * @seams: (element-type ClothSeam): what is sewn together
 * @n: number of vertices
 * @n_particles: (out): number of particles
 *
 * Sewn vertices become one particle, numbered in the order of their first vertex.
 *
 * Returns: (transfer full): the particle of each vertex
 */
guint32 *
cloth_body_merge_seams (const GArray * seams, guint n, guint * n_particles)
{
  g_autofree guint32 *parent = g_new (guint32, n);
  guint32 *particle = g_new (guint32, n);

  for (guint32 i = 0; i < n; i++)
    parent[i] = i;
  for (guint i = 0; i < seams->len; i++) {
    const ClothSeam *seam = &g_array_index (seams, ClothSeam, i);
    guint32 a = root (parent, seam->a), b = root (parent, seam->b);

    parent[MAX (a, b)] = MIN (a, b);
  }
  *n_particles = 0;
  for (guint32 i = 0; i < n; i++) {
    guint32 first = root (parent, i);

    particle[i] = first == i ? (*n_particles)++ : particle[first];
  }
  return particle;
}

/* The corner opposite the longest side first; along u and v when it is square to them. */
static void
turn_corners (const gdouble * uv, guint32 corner[3])
{
  for (guint k = 0; k < 3; k++) {
    guint32 a = corner[k], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];

    if (uv[2 * a + 1] == uv[2 * b + 1] && uv[2 * a] == uv[2 * c]) {
      corner[0] = a, corner[1] = b, corner[2] = c;
      return;
    }
    if (uv[2 * a] == uv[2 * b] && uv[2 * a + 1] == uv[2 * c + 1]) {
      corner[0] = a, corner[1] = c, corner[2] = b;
      return;
    }
  }
}

static gboolean
make_triangle (ClothBody * body, guint face, guint32 corner[3],
    ClothBodyTriangle * triangle, GError ** error)
{
  const gdouble *uv = body->uv;
  gdouble e[4], det, longest = 0.;

  turn_corners (uv, corner);
  for (guint k = 0; k < 2; k++) {
    e[k] = uv[2 * corner[1] + k] - uv[2 * corner[0] + k];
    e[2 + k] = uv[2 * corner[2] + k] - uv[2 * corner[0] + k];
  }
  det = e[0] * e[3] - e[1] * e[2];
  for (guint k = 0; k < 4; k++)
    longest = MAX (longest, fabs (e[k]));
  if (!(fabs (det) > 1e-6 * longest * longest)) {
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE,
        "face %u has no area on the flat cloth: give its vertices %u, %u, %u "
        "other uv", face, corner[0], corner[1], corner[2]);
    return FALSE;
  }
  for (guint k = 0; k < 3; k++) {
    triangle->vertex[k] = corner[k];
    triangle->particle[k] = body->particle[corner[k]];
    if (triangle->particle[k] == body->particle[corner[(k + 1) % 3]]) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE,
          "vertices %u and %u of face %u are one: no seam may join two corners "
          "of a face", corner[k], corner[(k + 1) % 3], face);
      return FALSE;
    }
  }
  triangle->area = fabs (det) / 2.;
  triangle->g[0] = e[3] / det;
  triangle->g[1] = -e[2] / det;
  triangle->g[2] = -e[1] / det;
  triangle->g[3] = e[0] / det;
  return TRUE;
}

static void
add_mass (ClothBody * body, const guint32 * corner, guint n, gdouble area)
{
  for (guint k = 0; k < n; k++)
    body->area[body->particle[corner[k]]] += area / n;
}

/* Quads are cut along alternating diagonals, which favour no direction; the corners of a
 * quad have equal shares of its mass. */
static gboolean
make_triangles (ClothBody * body, const ClothTopology * topology,
    guint32 * corners, GError ** error)
{
  g_autofree ClothBodyTriangle *all =
      g_new (ClothBodyTriangle, 2 * (gsize) topology->n_faces + 1);
  g_autofree guint32 *order =
      g_new (guint32, 6 * (gsize) topology->n_faces + 1);
  guint n = 0, at = 0;

  for (guint i = 0; i < topology->n_faces; i++) {
    const guint32 *face = topology->faces + 4 * (gsize) i;
    gboolean quad = face[3] != CLOTH_NO_VERTEX;
    gboolean odd = topology->columns > 1 &&
        (i / (topology->columns - 1) + i % (topology->columns - 1)) % 2;
    guint first = odd ? 1 : 0, pieces = quad ? 2 : 1;
    gdouble area = 0.;

    for (guint piece = 0; piece < pieces; piece++, n++) {
      guint32 *corner = order + 3 * n;

      for (guint k = 0; k < 3; k++)
        corner[k] = quad ? face[(first + (k ? k + piece : 0)) % 4] : face[k];
      if (!make_triangle (body, i, corner, &all[n], error))
        return FALSE;
      area += all[n].area;
    }
    add_mass (body, face, quad ? 4 : 3, area);
  }
  body->n_triangles = n;
  body->triangles = g_new (ClothBodyTriangle, n + 1);
  for (guint right = 2; right-- > 0;) {
    for (guint i = 0; i < n; i++) {
      if ((all[i].g[1] == 0. && all[i].g[2] == 0.) != (right == 1))
        continue;
      memcpy (corners + 3 * at, order + 3 * i, 3 * sizeof *corners);
      body->triangles[at++] = all[i];
    }
    if (right)
      body->n_right = at;
  }
  return TRUE;
}

static gint
compare_edges (gconstpointer a, gconstpointer b)
{
  const Edge *p = a, *q = b;

  if (p->a != q->a)
    return p->a < q->a ? -1 : 1;
  if (p->b != q->b)
    return p->b < q->b ? -1 : 1;
  return p->triangle < q->triangle ? -1 : p->triangle > q->triangle;
}

/* Where the corner opposite an edge lies from the edge's start, along and across it; the
 * way across is positive from u towards v. */
static void
lay_out (const gdouble * uv, const guint32 * corner, guint from, guint to,
    guint opposite, gdouble * along, gdouble * across, gdouble * length,
    gdouble direction[2])
{
  const gdouble *a = uv + 2 * corner[from], *b = uv + 2 * corner[to];
  const gdouble *c = uv + 2 * corner[opposite];
  gdouble du = b[0] - a[0], dv = b[1] - a[1];

  *length = hypot (du, dv);
  direction[0] = du / *length;
  direction[1] = dv / *length;
  *along = (c[0] - a[0]) * direction[0] + (c[1] - a[1]) * direction[1];
  *across = (c[0] - a[0]) * -direction[1] + (c[1] - a[1]) * direction[0];
}

static guint
corner_of (const ClothBodyTriangle * triangle, guint32 particle)
{
  for (guint k = 0; k < 2; k++)
    if (triangle->particle[k] == particle)
      return k;
  return 2;
}

/* The isometric bending of Bergou, Wardetzky, Harmon, Zorin and Grinspun (2006): the
 * sum y = Σ c x with cotangents c is a linear measure of the fold. Of a sheet of
 * curvature κ it is a linear form in (κ_uu, κ_vv, √2 κ_uv); a hinge's energy is scaled by
 * the area of its triangles over the square of that form, so that over all hinges and
 * ways to bend ½ Σ k y² gives ½ B ∫ |κ|² on the mean; by a third more or less for one way
 * on meshes of one kind of triangles. */
static void
make_hinge (const ClothBody * body, const guint32 * corners, const Edge * one,
    const Edge * two, ClothBodyHinge * hinge)
{
  gdouble along[2], across[2], length[2], direction[4], area = 0.;
  gdouble *form = hinge->form, part[3], square, cot[2][2], x[4][2];
  const Edge *side[2] = { one, two };

  for (guint s = 0; s < 2; s++) {
    const ClothBodyTriangle *triangle = &body->triangles[side[s]->triangle];

    lay_out (body->uv, corners + 3 * side[s]->triangle, corner_of (triangle,
            one->a), corner_of (triangle, one->b), side[s]->opposite,
        &along[s], &across[s], &length[s], direction + 2 * s);
    if (s == 0)
      hinge->side = across[s] > 0. ? 1. : -1.;
    across[s] = fabs (across[s]);
    cot[s][0] = along[s] / across[s];
    cot[s][1] = (length[s] - along[s]) / across[s];
    area += triangle->area;
    hinge->particle[2 + s] = triangle->particle[side[s]->opposite];
  }
  hinge->particle[0] = one->a;
  hinge->particle[1] = one->b;
  hinge->c[0] = cot[0][1] + cot[1][1];
  hinge->c[1] = cot[0][0] + cot[1][0];
  hinge->c[2] = -cot[0][0] - cot[0][1];
  hinge->c[3] = -cot[1][0] - cot[1][1];
  form[0] = form[1] = form[2] = 0.;
  x[0][0] = x[0][1] = x[1][1] = 0.;
  x[1][0] = length[0];
  for (guint s = 0; s < 2; s++) {
    x[2 + s][0] = along[s];
    x[2 + s][1] = s ? -across[s] : across[s];
  }
  for (guint k = 0; k < 4; k++) {
    /* in the frame of the first triangle */
    gdouble u = x[k][0] * direction[0] - x[k][1] * direction[1];
    gdouble v = x[k][0] * direction[1] + x[k][1] * direction[0];

    form[0] += 0.5 * hinge->c[k] * u * u;
    form[1] += 0.5 * hinge->c[k] * v * v;
    form[2] += M_SQRT1_2 * hinge->c[k] * u * v;
  }
  for (guint k = 0; k < 3; k++)
    part[k] = form[k] * form[k];
  square = part[0] + part[1] + part[2];
  hinge->warp = area / (square * square) * (part[0] + 0.5 * part[2]);
  hinge->weft = area / (square * square) * (part[1] + 0.5 * part[2]);
}

/* Between two right angles an edge's hinge has only three particles: they go first. */
static void
sort_hinges (ClothBody * body)
{
  g_autofree ClothBodyHinge *all =
      g_memdup2 (body->hinges, body->n_hinges * sizeof *all);
  guint at = 0;

  for (guint i = 0; i < body->n_hinges; i++) {
    ClothBodyHinge *h = &all[i];
    gdouble largest = fabs (h->c[2]) + fabs (h->c[3]);
    guint zero = fabs (h->c[0]) < 1e-6 * largest ? 0 : 1;

    if (fabs (h->c[zero]) < 1e-6 * largest) {
      const ClothBodyHinge old = *h;

      for (guint k = 0; k < 4; k++) {
        guint from = k == 3 ? zero : k == 2 ? 1 - zero : k + 2;

        h->particle[k] = old.particle[from];
        h->c[k] = k == 3 ? 0. : old.c[from];
      }
      if (zero == 1)
        h->side = -old.side;
      body->hinges[at++] = *h;
    }
  }
  body->n_straight = at;
  for (guint i = 0; i < body->n_hinges; i++)
    if (all[i].c[3] != 0.)
      body->hinges[at++] = all[i];
}

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
  .side = side_of (body, vertex)};
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

static gboolean
make_hinges (ClothBody * body, const guint32 * corners, GError ** error)
{
  guint n = 3 * body->n_triangles;
  g_autofree Edge *edges = NULL;

  if (body->columns > 1 && body->n_particles == body->n_vertices) {
    make_grid_hinges (body);
    return TRUE;
  }
  edges = g_new (Edge, n + 1);
  for (guint i = 0; i < body->n_triangles; i++) {
    const guint32 *p = body->triangles[i].particle;

    for (guint k = 0; k < 3; k++) {
      guint32 a = p[(k + 1) % 3], b = p[(k + 2) % 3];

      edges[3 * i + k] = (Edge) {
      MIN (a, b), MAX (a, b), i, k};
    }
  }
  qsort (edges, n, sizeof *edges, compare_edges);
  body->hinges = g_new (ClothBodyHinge, n / 2 + 1);
  for (guint i = 0; i + 1 < n; i++) {
    if (edges[i].a != edges[i + 1].a || edges[i].b != edges[i + 1].b)
      continue;
    if (i + 2 < n && edges[i].a == edges[i + 2].a
        && edges[i].b == edges[i + 2].b) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE,
          "more than two triangles meet at the edge of vertices %u and %u",
          corners[3 * edges[i].triangle + (edges[i].opposite + 1) % 3],
          corners[3 * edges[i].triangle + (edges[i].opposite + 2) % 3]);
      return FALSE;
    }
    make_hinge (body, corners, &edges[i], &edges[i + 1],
        &body->hinges[body->n_hinges++]);
  }
  sort_hinges (body);
  return TRUE;
}

/* Gershgorin's rows: Σ_j |K_ij| bounds the eigenvalues of K. */
static void
make_bounds (ClothBody * body)
{
  body->bounds = g_new0 (ClothBodyBound, body->n_particles);
  for (guint i = 0; i < body->n_triangles; i++) {
    const ClothBodyTriangle *t = &body->triangles[i];
    gdouble u[3] = { -t->g[0] - t->g[2], t->g[0], t->g[2] };
    gdouble v[3] = { -t->g[1] - t->g[3], t->g[1], t->g[3] };
    gdouble sum_u = fabs (u[0]) + fabs (u[1]) + fabs (u[2]);
    gdouble sum_v = fabs (v[0]) + fabs (v[1]) + fabs (v[2]);

    for (guint k = 0; k < 3; k++) {
      ClothBodyBound *bound = &body->bounds[t->particle[k]];

      bound->warp += t->area * fabs (u[k]) * sum_u;
      bound->weft += t->area * fabs (v[k]) * sum_v;
      bound->shear_u += t->area * fabs (v[k]) * (sum_u + sum_v);
      bound->shear_v += t->area * fabs (u[k]) * (sum_u + sum_v);
    }
  }
  for (guint i = 0; i < body->n_hinges; i++) {
    const ClothBodyHinge *h = &body->hinges[i];
    gdouble sum = 0.;

    for (guint k = 0; k < 4; k++)
      sum += fabs (h->c[k]);
    for (guint k = 0; k < 4; k++) {
      ClothBodyBound *bound = &body->bounds[h->particle[k]];

      bound->bend_warp += h->warp * fabs (h->c[k]) * sum;
      bound->bend_weft += h->weft * fabs (h->c[k]) * sum;
    }
  }
}

static void
take_clamps (ClothBody * body, const ClothScene * scene)
{
  gsize n_path = 3 * (gsize) scene->n_frames * scene->held->len;

  body->n_frames = scene->n_frames;
  body->times = g_memdup2 (scene->times, scene->n_frames * sizeof (gdouble));
  body->clamps = g_memdup2 (scene->clamps, n_path * sizeof (gdouble));
  body->frame_s = scene->n_frames > 1 ?
      (scene->times[scene->n_frames - 1] - scene->times[0]) /
      (scene->n_frames - 1) : 1. / scene->fps;
  body->n_held = scene->held->len;
  body->held = g_new0 (ClothBodyHeld, body->n_held + 1);
  for (guint i = 0; i < body->n_held; i++) {
    const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);
    ClothBodyHeld *h = &body->held[i];

    h->particle = body->particle[held->vertex];
    h->from_s = held->from_s;
    h->until_s = held->until_s;
    while (h->first + 1 < body->n_frames
        && body->times[h->first] < held->from_s)
      h->first++;
    h->last = body->n_frames - 1;
    while (h->last > h->first && body->times[h->last] >= held->until_s)
      h->last--;
  }
}

static void
take_obstacles (ClothBody * body, const ClothScene * scene)
{
  body->obstacles = cloth_obstacles_copy (scene->obstacles);
  body->bvhs = g_new0 (ClothBvh *, body->obstacles->len + 1);
  for (guint i = 0; i < body->obstacles->len; i++) {
    const ClothObstacle *o = &g_array_index (body->obstacles, ClothObstacle, i);

    if (o->kind == CLOTH_OBSTACLE_MESH)
      body->bvhs[i] = cloth_bvh_new (o->points, o->n_points, o->triangles,
          o->n_triangles);
  }
}

/*
 * cloth_body_path:
 * @held: index of what is held
 *
 * The place of a clamp on its logged path: a cubic through the frames' places whose slope
 * at a frame is that between its neighbours (Catmull and Rom 1974), so that the clamp's
 * speed has no jumps, which would shake the cloth at the frame rate. Straight on beyond
 * the ends.
 */
void
cloth_body_path (const ClothBody * body, guint held, gdouble time_s,
    gdouble position[3])
{
  const ClothBodyHeld *h = &body->held[held];
  const gdouble *t = body->times;
  guint low = h->first, high = h->last;

  while (high - low > 1) {
    guint middle = (low + high) / 2;

    if (t[middle] <= time_s)
      low = middle;
    else
      high = middle;
  }
  for (guint k = 0; k < 3; k++) {
#define AT(frame) body->clamps[3 * ((gsize) (frame) * body->n_held + held) + k]
    gdouble span = t[high] - t[low], s, slope[2], rise;

    if (high == low) {
      position[k] = AT (low);
      continue;
    }
    s = (time_s - t[low]) / span;
    rise = AT (high) - AT (low);
    for (guint end = 0; end < 2; end++) {
      guint at = end ? high : low;
      guint a = at > h->first ? at - 1 : at, b = at < h->last ? at + 1 : at;

      slope[end] = (AT (b) - AT (a)) / (t[b] - t[a]) * span;
    }
    if (s < 0.)
      position[k] = AT (low) + s * slope[0];
    else if (s > 1.)
      position[k] = AT (high) + (s - 1.) * slope[1];
    else
      position[k] = AT (low) + s * (slope[0] + s * (3. * rise - 2. * slope[0] -
              slope[1] + s * (slope[0] + slope[1] - 2. * rise)));
#undef AT
  }
}

/*
 * cloth_body_new:
 * @scene: a scene that cloth_scene_check () accepts
 * @error: #ClothSimError
 *
 * Returns: (transfer full) (nullable): what the lanes share of @scene
 */
ClothBody *
cloth_body_new (const ClothScene * scene, GError ** error)
{
  g_autoptr (ClothBody) body = g_new0 (ClothBody, 1);
  const ClothTopology *topology = scene->topology;
  g_autofree guint32 *corners = g_new (guint32, 6 * (gsize) topology->n_faces);
  guint n = topology->n_vertices;

  body->n_vertices = n;
  body->columns = topology->columns;
  body->rows = topology->rows;
  body->uv = g_new (gdouble, 2 * (gsize) n);
  for (guint i = 0; i < 2 * n; i++)
    body->uv[i] = topology->uv[i];
  body->particle = cloth_body_merge_seams (scene->seams, n, &body->n_particles);
  body->area = g_new0 (gdouble, body->n_particles);
  if (!make_triangles (body, topology, corners, error)
      || !make_hinges (body, corners, error))
    return NULL;
  for (guint i = 0; i < n; i++) {
    if (!(body->area[body->particle[i]] > 0.)) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE,
          "vertex %u belongs to no face, so it has no mass", i);
      return NULL;
    }
  }
  make_bounds (body);
  cloth_body_make_springs (body);
  take_clamps (body, scene);
  take_obstacles (body, scene);
  body->positions = g_memdup2 (scene->positions, 3 * n * sizeof (gdouble));
  body->velocities = scene->velocities ?
      g_memdup2 (scene->velocities, 3 * n * sizeof (gdouble)) :
      g_new0 (gdouble, 3 * (gsize) n);
  memcpy (body->gravity, scene->gravity, sizeof body->gravity);
  return g_steal_pointer (&body);
}

/*
 * cloth_body_free:
 * @body: (nullable) (transfer full): a body
 */
void
cloth_body_free (ClothBody * body)
{
  if (!body)
    return;
  for (guint i = 0; body->obstacles && i < body->obstacles->len; i++)
    cloth_bvh_free (body->bvhs[i]);
  g_clear_pointer (&body->obstacles, g_array_unref);
  g_free (body->bvhs);
  g_free (body->particle);
  g_free (body->uv);
  g_free (body->area);
  g_free (body->triangles);
  g_free (body->hinges);
  g_free (body->springs);
  g_free (body->bounds);
  g_free (body->held);
  g_free (body->times);
  g_free (body->clamps);
  g_free (body->positions);
  g_free (body->velocities);
  g_free (body);
}
