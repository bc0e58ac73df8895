/* From a scene to what the lanes share: triangles, areas, bounds, springs and paths.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/bodybuild.h"

#include <math.h>
#include <string.h>

#include "gst/sim/bodybending.h"
#include "gst/sim/types.h"

static guint32
root (guint32 * parent, guint32 i)
{
  while (parent[i] != i)
    i = parent[i] = parent[parent[i]];
  return i;
}

/* @seams: (element-type ClothSeam): what is sewn together
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
}

/* Whether a grid's rows and columns are evenly apart, as near as files and single
 * precision say. */
static gboolean
is_even (const ClothBody * body)
{
  const gdouble tolerance = 1e-4;       /* of a cell */
  guint columns = body->columns, rows = body->rows;
  const gdouble *uv = body->uv;
  gdouble step[2];

  if (columns < 2 || rows < 2)
    return FALSE;
  step[0] = (uv[2 * (columns - 1)] - uv[0]) / (columns - 1);
  step[1] = (uv[2 * columns * (gsize) (rows - 1) + 1] - uv[1]) / (rows - 1);
  for (guint i = 0; i < body->n_vertices; i++) {
    const guint at[2] = { i % columns, i / columns };

    for (guint k = 0; k < 2; k++)
      if (!(fabs (uv[2 * i + k] - uv[k] - at[k] * step[k]) <=
              tolerance * step[k]))
        return FALSE;
  }
  return TRUE;
}

static void
take_clamps (ClothBody * body, const ClothScene * scene)
{
  gsize n_path = 3 * (gsize) scene->n_frames * scene->held->len;

  body->n_frames = scene->n_frames;
  body->epoch = scene->times[0];
  body->times = g_new (gdouble, scene->n_frames);
  for (guint f = 0; f < scene->n_frames; f++)
    body->times[f] = scene->times[f] - body->epoch;
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
    h->from_s = held->from_s - body->epoch;
    h->until_s = held->until_s - body->epoch;
    while (h->first + 1 < body->n_frames && body->times[h->first] < h->from_s)
      h->first++;
    h->last = body->n_frames - 1;
    while (h->last > h->first && body->times[h->last] >= h->until_s)
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

static ClothBodySpring *
add_spring (ClothBody * body, guint a, guint b)
{
  ClothBodySpring *s = &body->springs[body->n_springs++];

  *s = (ClothBodySpring) { {
  body->particle[a], body->particle[b]},
      body->uv[2 * b] - body->uv[2 * a],
      body->uv[2 * b + 1] - body->uv[2 * a + 1]
  };
  return s;
}

/* Each cell gives its four sides half of its width of cloth, and has two diagonals: they
 * resist shear as the membrane does. */
static void
grid_springs (ClothBody * body)
{
  guint columns = body->columns, rows = body->rows;

  for (guint row = 0; row < rows; row++) {
    for (guint column = 0; column < columns; column++) {
      guint i = row * columns + column;
      gboolean right = column + 1 < columns, down = row + 1 < rows;
      gdouble width = right ? fabs (body->uv[2 * i + 2] - body->uv[2 * i]) : 0.;
      gdouble height = down ? fabs (body->uv[2 * (i + columns) + 1] -
          body->uv[2 * i + 1]) : 0.;

      if (right) {
        gdouble above = row ? fabs (body->uv[2 * i + 1] -
            body->uv[2 * (i - columns) + 1]) : 0.;

        add_spring (body, i, i + 1)->warp = (above + height) / (2. * width);
      }
      if (down) {
        gdouble before = column ? fabs (body->uv[2 * i] -
            body->uv[2 * i - 2]) : 0.;

        add_spring (body, i, i + columns)->weft =
            (before + width) / (2. * height);
      }
      if (right && down) {
        gdouble shear = (width * width + height * height) /
            (2. * width * height);

        add_spring (body, i, i + columns + 1)->shear = shear;
        add_spring (body, i + 1, i + columns)->shear = shear;
      }
    }
  }
}

/* A side of a triangle is a spring of stiffness modulus · area / length² (Van Gelder
 * 1998), the modulus that of its direction. Sides that triangles share are springs side
 * by side. */
static void
mesh_springs (ClothBody * body)
{
  for (guint i = 0; i < body->n_triangles; i++) {
    const ClothBodyTriangle *t = &body->triangles[i];
    gdouble det = t->g[0] * t->g[3] - t->g[1] * t->g[2];
    /* edges from corner 0 on the flat cloth */
    gdouble e[3][2] = { {0., 0.}, {t->g[3] / det, -t->g[2] / det},
    {-t->g[1] / det, t->g[0] / det}
    };

    for (guint k = 0; k < 3; k++) {
      guint a = k, b = (k + 1) % 3;
      gdouble u = e[b][0] - e[a][0], v = e[b][1] - e[a][1];
      gdouble square = u * u + v * v, share = t->area / square;
      gdouble uu = u * u / square, vv = v * v / square;

      body->springs[body->n_springs++] = (ClothBodySpring) {
        {
        t->particle[a], t->particle[b]}
      , u, v, share * uu * uu, share * vv * vv, share * 4. * uu * vv};
    }
  }
}

/* Fills the springs of a body whose triangles are known, and their part of the bounds. */
static void
make_springs (ClothBody * body)
{
  body->springs = g_new (ClothBodySpring,
      4 * (gsize) body->n_vertices + 3 * (gsize) body->n_triangles);
  if (body->columns > 1 && body->n_particles == body->n_vertices)
    grid_springs (body);
  else
    mesh_springs (body);
  for (guint i = 0; i < body->n_springs; i++) {
    const ClothBodySpring *s = &body->springs[i];
    gdouble square = s->u * s->u + s->v * s->v, uv = fabs (s->u * s->v);
    gdouble row[2] = { 2. * (s->u * s->u + uv) / square,
      2. * (s->v * s->v + uv) / square
    };

    for (guint end = 0; end < 2; end++) {
      for (guint k = 0; k < 2; k++) {
        gdouble *bound = body->bounds[s->particle[end]].springs[k];

        bound[0] += row[k] * s->warp;
        bound[1] += row[k] * s->weft;
        bound[2] += row[k] * s->shear;
      }
    }
  }
}

/* @scene: a scene that cloth_scene_check () accepts
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
  body->even = is_even (body);
  body->particle = cloth_body_merge_seams (scene->seams, n, &body->n_particles);
  body->area = g_new0 (gdouble, body->n_particles);
  if (!make_triangles (body, topology, corners, error))
    return NULL;
  for (guint i = 0; i < n; i++) {
    if (!(body->area[body->particle[i]] > 0.)) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE,
          "vertex %u belongs to no face, so it has no mass; leave it out of the "
          "mesh", i);
      return NULL;
    }
  }
  make_bounds (body);
  if (!cloth_body_make_hinges (body, corners, error))
    return NULL;
  make_springs (body);
  take_clamps (body, scene);
  take_obstacles (body, scene);
  body->positions = g_memdup2 (scene->positions, 3 * n * sizeof (gdouble));
  body->velocities = scene->velocities ?
      g_memdup2 (scene->velocities, 3 * n * sizeof (gdouble)) :
      g_new0 (gdouble, 3 * (gsize) n);
  memcpy (body->gravity, scene->gravity, sizeof body->gravity);
  return g_steal_pointer (&body);
}
