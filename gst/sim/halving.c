/* Meshes of half the edge length, and squares cut the other way.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/halving.h"

#include <string.h>

#include "gst/sim/bodybuild.h"

typedef struct
{
  ClothHalving *halving;
  const ClothTopology *old;
  guint columns;                /* of the new grid, 0 = no grid */
  guint n;                      /* new vertices so far */
  GHashTable *midpoints;        /* edge → new index, of meshes that are no grid */
} Maker;

static guint64 *
edge_key (guint32 a, guint32 b)
{
  guint64 key = (guint64) MIN (a, b) << 32 | MAX (a, b);

  return g_memdup2 (&key, sizeof key);
}

static guint32
grid_vertex (const Maker * maker, guint32 a, guint32 b)
{
  guint columns = maker->old->columns;

  return (a / columns + b / columns) * maker->columns + a % columns +
      b % columns;
}

/* The new vertex half-way between two old ones. */
static guint32
midpoint (Maker * maker, guint32 a, guint32 b)
{
  guint64 *key;
  gpointer known;
  guint32 at;

  if (maker->columns)
    return grid_vertex (maker, a, b);
  key = edge_key (a, b);
  if (g_hash_table_lookup_extended (maker->midpoints, key, NULL, &known)) {
    g_free (key);
    return GPOINTER_TO_UINT (known);
  }
  at = maker->n++;
  g_hash_table_insert (maker->midpoints, key, GUINT_TO_POINTER (at));
  return at;
}

static void
set_from (const Maker * maker, guint32 at, guint32 a, guint32 b, guint32 c,
    guint32 d)
{
  const guint32 from[4] = { a, b, c, d };

  memcpy (maker->halving->from[at], from, sizeof from);
}

static void
add_face (ClothTopology * topology, guint32 a, guint32 b, guint32 c, guint32 d)
{
  const guint32 face[4] = { a, b, c, d };

  memcpy (topology->faces + 4 * (gsize) topology->n_faces++, face, sizeof face);
}

/* Each face becomes four. The four of a square are cut along the same diagonal as it was.
 * The faces of a grid have been made already. */
static void
cut_faces (Maker * maker, ClothTopology * topology)
{
  const ClothTopology *old = maker->old;
  const guint32 *kept = maker->halving->kept;

  for (guint i = 0; i < old->n_faces; i++) {
    const guint32 *f = old->faces + 4 * (gsize) i;
    guint sides = cloth_face_corners (f);
    guint32 m[4] = { 0 };

    for (guint k = 0; k < sides; k++) {
      guint32 a = f[k], b = f[(k + 1) % sides];

      m[k] = midpoint (maker, a, b);
      set_from (maker, m[k], MIN (a, b), MIN (a, b), MAX (a, b), MAX (a, b));
    }
    if (sides == 4) {
      guint32 c = maker->columns ? grid_vertex (maker, f[0], f[2]) : maker->n++;

      set_from (maker, c, f[0], f[1], f[2], f[3]);
      if (maker->columns)
        continue;
      add_face (topology, kept[f[0]], m[0], c, m[3]);
      add_face (topology, m[0], kept[f[1]], m[1], c);
      add_face (topology, c, m[1], kept[f[2]], m[2]);
      add_face (topology, m[3], c, m[2], kept[f[3]]);
    } else {
      add_face (topology, kept[f[0]], m[0], m[2], CLOTH_NO_VERTEX);
      add_face (topology, m[0], kept[f[1]], m[1], CLOTH_NO_VERTEX);
      add_face (topology, m[2], m[1], kept[f[2]], CLOTH_NO_VERTEX);
      add_face (topology, m[0], m[1], m[2], CLOTH_NO_VERTEX);
    }
  }
}

static ClothTopology *
halve_topology (Maker * maker)
{
  const ClothTopology *old = maker->old;
  ClothHalving *halving = maker->halving;
  guint n = old->n_vertices;
  ClothTopology *topology;
  g_autofree gdouble *uv = g_new (gdouble, 2 * (gsize) n);
  g_autofree gdouble *fine = NULL;

  halving->n_old = n;
  halving->kept = g_new (guint32, n);
  if (old->columns) {
    maker->columns = 2 * old->columns - 1;
    topology = cloth_topology_new_grid (maker->columns, 2 * old->rows - 1, 1.f,
        1.f);
    maker->n = topology->n_vertices;
  } else {
    /* no face has more than four sides, so there are no more midpoints and centres */
    topology = cloth_topology_new (n + 5 * old->n_faces, 4 * old->n_faces);
    topology->n_faces = 0;
    maker->n = n;
  }
  halving->from = g_malloc (sizeof *halving->from * topology->n_vertices);
  for (guint32 i = 0; i < n; i++) {
    halving->kept[i] = maker->columns ? grid_vertex (maker, i, i) : i;
    set_from (maker, halving->kept[i], i, i, i, i);
  }
  cut_faces (maker, topology);
  topology->n_vertices = maker->n;
  fine = g_new (gdouble, 2 * (gsize) maker->n);
  for (gsize i = 0; i < 2 * (gsize) n; i++)
    uv[i] = old->uv[i];
  halving->scene = cloth_scene_new (topology, 1., 1);
  cloth_halving_spread (halving, 2, uv, fine);
  for (gsize i = 0; i < 2 * (gsize) maker->n; i++)
    topology->uv[i] = (gfloat) fine[i];
  return topology;
}

/* The old clamps: of each vertex the first one, and of each the next of its vertex, counted from 1; 0: none. */
typedef struct
{
  const ClothScene *old;
  ClothScene *scene;
  guint *first, *next;
  GArray *from;                 /* of each new clamp the four old ones that it is the mean of */
} Clamps;

/* Clamps of a vertex from its corner @k on: whenever clamps of all corners hold at once. */
static void
hold_between (Clamps * c, const guint32 corner[4], guint k, ClothHeld held,
    guint parents[4])
{
  if (k == 4) {
    g_array_append_val (c->scene->held, held);
    g_array_append_vals (c->from, parents, 1);
    return;
  }
  for (guint i = c->first[corner[k]]; i; i = c->next[i]) {
    const ClothHeld *parent = &g_array_index (c->old->held, ClothHeld, i - 1);
    ClothHeld both = held;

    both.from_s = MAX (held.from_s, parent->from_s);
    both.until_s = MIN (held.until_s, parent->until_s);
    parents[k] = i - 1;
    if (both.from_s < both.until_s)
      hold_between (c, corner, k + 1, both, parents);
  }
}

/* A vertex between held ones is held on the mean of their paths. Old clamps keep their
 * indices in the list, by which effects name them. */
static void
halve_clamps (const ClothScene * old, const ClothHalving * halving)
{
  ClothScene *scene = halving->scene;
  guint n = halving->n_old, n_old_held = old->held->len;
  g_autofree guint *first = g_new0 (guint, n + 1);
  g_autofree guint *next = g_new0 (guint, n_old_held + 1);
  g_autoptr (GArray) from = g_array_new (FALSE, FALSE, 4 * sizeof (guint));
  Clamps c = { old, scene, first, next, from };

  for (guint i = 0; i < n_old_held; i++) {
    ClothHeld held = g_array_index (old->held, ClothHeld, i);
    const guint same[4] = { i, i, i, i };

    next[i + 1] = first[held.vertex];
    first[held.vertex] = i + 1;
    held.vertex = halving->kept[held.vertex];
    g_array_append_val (scene->held, held);
    g_array_append_vals (from, same, 1);
  }
  for (guint i = 0; n_old_held && i < scene->topology->n_vertices; i++) {
    ClothHeld held = { i, -G_MAXDOUBLE, G_MAXDOUBLE };
    const guint32 *corner = halving->from[i];
    guint parents[4];

    if (corner[0] != corner[2])
      hold_between (&c, corner, 0, held, parents);
  }
  scene->clamps = g_new (gdouble, 3 * (gsize) old->n_frames *
      scene->held->len + 1);
  for (guint frame = 0; frame < old->n_frames; frame++) {
    const gdouble *path = n_old_held ?
        old->clamps + 3 * (gsize) frame * n_old_held : NULL;
    gdouble *to = scene->clamps + 3 * (gsize) frame * scene->held->len;

    for (guint i = 0; i < scene->held->len; i++) {
      const guint *p = &g_array_index (from, guint, 4 * i);

      for (guint k = 0; k < 3; k++)
        to[3 * i + k] = 0.25 * (path[3 * p[0] + k] + path[3 * p[1] + k] +
            path[3 * p[2] + k] + path[3 * p[3] + k]);
    }
  }
}

/* Of two edges whose ends are sewn together the middles are too. */
static void
halve_seams (const ClothScene * old, Maker * maker)
{
  ClothScene *scene = maker->halving->scene;
  g_autoptr (GHashTable) first = g_hash_table_new_full (g_int64_hash,
      g_int64_equal, g_free, NULL);
  g_autofree guint32 *particle = NULL;
  guint n_particles;

  for (guint i = 0; i < old->seams->len; i++) {
    ClothSeam seam = g_array_index (old->seams, ClothSeam, i);

    seam.a = maker->halving->kept[seam.a];
    seam.b = maker->halving->kept[seam.b];
    g_array_append_val (scene->seams, seam);
  }
  if (old->seams->len == 0)
    return;
  particle = cloth_body_merge_seams (old->seams, old->topology->n_vertices,
      &n_particles);
  for (guint i = 0; i < old->topology->n_faces; i++) {
    const guint32 *f = old->topology->faces + 4 * (gsize) i;
    guint sides = cloth_face_corners (f);

    for (guint k = 0; k < sides; k++) {
      guint32 a = f[k], b = f[(k + 1) % sides];
      ClothSeam seam = { 0, midpoint (maker, a, b) };
      guint64 *key = edge_key (particle[a], particle[b]);
      gpointer known;

      if (!g_hash_table_lookup_extended (first, key, NULL, &known)) {
        g_hash_table_insert (first, key, GUINT_TO_POINTER (seam.b));
        continue;
      }
      g_free (key);
      seam.a = GPOINTER_TO_UINT (known);
      if (seam.a != seam.b)
        g_array_append_val (scene->seams, seam);
    }
  }
}

/* Takes over from @old what does not depend on the mesh. */
static void
copy_rest (const ClothScene * old, ClothScene * scene)
{
  g_free (scene->times);
  scene->n_frames = old->n_frames;
  scene->times = g_memdup2 (old->times, old->n_frames * sizeof (gdouble));
  scene->fps = old->fps;
  memcpy (scene->gravity, old->gravity, sizeof scene->gravity);
  g_array_unref (scene->obstacles);
  scene->obstacles = cloth_obstacles_copy (old->obstacles);
}

/* @scene: a scene that cloth_scene_check () accepts
 *
 * Cuts each face into four. New vertices lie on the straight lines between old ones at
 * the start, so nothing is stretched. A grid stays a grid.
 *
 * Returns: (transfer full): @scene on the finer mesh
 */
ClothHalving *
cloth_halving_new (const ClothScene * scene)
{
  ClothHalving *halving = g_new0 (ClothHalving, 1);
  Maker maker = { halving, scene->topology, 0, 0, NULL };
  gsize n;

  maker.midpoints = g_hash_table_new_full (g_int64_hash, g_int64_equal, g_free,
      NULL);
  n = halve_topology (&maker)->n_vertices;
  copy_rest (scene, halving->scene);
  g_free (halving->scene->positions);
  halving->scene->positions = g_new (gdouble, 3 * n);
  cloth_halving_spread (halving, 3, scene->positions,
      halving->scene->positions);
  if (scene->velocities) {
    halving->scene->velocities = g_new (gdouble, 3 * n);
    cloth_halving_spread (halving, 3, scene->velocities,
        halving->scene->velocities);
  }
  halve_clamps (scene, halving);
  halve_seams (scene, &maker);
  g_hash_table_unref (maker.midpoints);
  return halving;
}

/* @halving: a halving
 * @stride: numbers of a vertex
 * @old: numbers of the old vertices
 * @values: (out caller-allocates): numbers of the new ones; kept vertices keep theirs to
 *   the bit
 */
void
cloth_halving_spread (const ClothHalving * halving, guint stride,
    const gdouble * old, gdouble * values)
{
  for (gsize i = 0; i < halving->scene->topology->n_vertices; i++) {
    const guint32 *p = halving->from[i];

    for (guint k = 0; k < stride; k++)
      values[stride * i + k] = 0.25 * (old[(gsize) stride * p[0] + k] +
          old[(gsize) stride * p[1] + k] + old[(gsize) stride * p[2] + k] +
          old[(gsize) stride * p[3] + k]);
  }
}

/* @halving: (nullable) (transfer full): a halving
 */
void
cloth_halving_free (ClothHalving * halving)
{
  if (!halving)
    return;
  cloth_scene_free (halving->scene);
  g_free (halving->kept);
  g_free (halving->from);
  g_free (halving);
}

/* @scene: a scene with faces of four vertices
 * @all_one_way: let all diagonals of a grid run the same way; else each is turned
 *
 * A square is cut from its first corner, in a grid every second one from its next
 * corner: so turning a face turns the diagonal.
 *
 * Returns: (transfer full): @scene with other diagonals
 */
ClothScene *
cloth_scene_turn_diagonals (const ClothScene * scene, gboolean all_one_way)
{
  const ClothTopology *old = scene->topology;
  gsize n = 3 * (gsize) old->n_vertices;
  ClothScene *copy = cloth_scene_new (cloth_topology_copy (old), 1., 1);

  copy_rest (scene, copy);
  memcpy (copy->positions, scene->positions, n * sizeof *copy->positions);
  copy->velocities = g_memdup2 (scene->velocities,
      scene->velocities ? n * sizeof *copy->velocities : 0);
  g_array_append_vals (copy->held, scene->held->data, scene->held->len);
  copy->clamps = g_memdup2 (scene->clamps, 3 * (gsize) scene->n_frames *
      scene->held->len * sizeof *copy->clamps);
  g_array_append_vals (copy->seams, scene->seams->data, scene->seams->len);
  for (guint i = 0; i < old->n_faces; i++) {
    guint32 *f = copy->topology->faces + 4 * (gsize) i, first = f[0];
    gboolean odd = old->columns > 1 &&
        (i / (old->columns - 1) + i % (old->columns - 1)) % 2;

    if (f[3] == CLOTH_NO_VERTEX || (all_one_way && !odd))
      continue;
    memmove (f, f + 1, 3 * sizeof *f);
    f[3] = first;
  }
  return copy;
}
