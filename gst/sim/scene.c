/* A scene: made by hand or of a take, and what no simulation could make sense of.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/mesh/fill/fill.h"
#include "gst/mesh/seam.h"
#include "gst/mesh/side.h"

/* A rate for one frame alone, which has none. */
#define FALLBACK_FPS 30.
/* Nothing that holds a cloth moves faster than sound, m/s; a path that does is broken. */
#define MAX_CLAMP_SPEED 340.

/* @topology: (transfer full): the cloth; its uv are metres on the flat cloth
 * @fps: frames a second
 * @n_frames: number of frames, at least 1
 *
 * A sheet that nothing holds: it hangs flat in the plane y = 0 with u along x and v
 * downwards from z = 0, at rest, under 9.81 m/s².
 *
 * Returns: (transfer full): a scene
 */
ClothScene *
cloth_scene_new (ClothTopology * topology, gdouble fps, guint n_frames)
{
  ClothScene *scene = g_new0 (ClothScene, 1);

  scene->topology = topology;
  scene->positions = g_new0 (gdouble, 3 * (gsize) topology->n_vertices + 1);
  for (guint i = 0; i < topology->n_vertices; i++) {
    scene->positions[3 * i] = topology->uv[2 * i];
    scene->positions[3 * i + 2] = -topology->uv[2 * i + 1];
  }
  scene->held = g_array_new (FALSE, TRUE, sizeof (ClothHeld));
  scene->obstacles = cloth_obstacles_new ();
  scene->seams = g_array_new (FALSE, TRUE, sizeof (ClothSeam));
  scene->n_frames = n_frames;
  scene->times = g_new0 (gdouble, n_frames);
  for (guint i = 0; i < n_frames; i++)
    scene->times[i] = i / fps;
  scene->fps = fps;
  scene->gravity[2] = -9.81;
  return scene;
}

/* @scene: a scene
 * @vertex: a vertex
 *
 * Holds a vertex where it is at the start, from the beginning to the end; change
 * @scene's held and clamps for anything else.
 *
 * Returns: its place in the held array
 */
guint
cloth_scene_hold (ClothScene * scene, guint vertex)
{
  ClothHeld held = { vertex, -INFINITY, INFINITY };
  guint n = scene->held->len;
  gdouble *clamps = g_new (gdouble, 3 * (gsize) scene->n_frames * (n + 1));

  for (guint frame = 0; frame < scene->n_frames; frame++) {
    gdouble *row = clamps + 3 * (gsize) frame * (n + 1);

    if (n)
      memcpy (row, scene->clamps + 3 * (gsize) frame * n, 3 * n * sizeof *row);
    memcpy (row + 3 * n, scene->positions + 3 * vertex, 3 * sizeof *row);
  }
  g_free (scene->clamps);
  scene->clamps = clamps;
  g_array_append_val (scene->held, held);
  return n;
}

/* @scene: a scene
 *
 * Returns: (transfer full): a deep copy
 */
ClothScene *
cloth_scene_copy (const ClothScene * scene)
{
  const gsize all = 3 * (gsize) scene->topology->n_vertices;
  ClothScene *copy = cloth_scene_new (cloth_topology_copy (scene->topology),
      scene->fps, scene->n_frames);

  memcpy (copy->times, scene->times, scene->n_frames * sizeof *scene->times);
  memcpy (copy->positions, scene->positions, all * sizeof *scene->positions);
  if (scene->velocities)
    copy->velocities =
        g_memdup2 (scene->velocities, all * sizeof *scene->velocities);
  memcpy (copy->gravity, scene->gravity, sizeof scene->gravity);
  g_array_append_vals (copy->held, scene->held->data, scene->held->len);
  copy->clamps = g_memdup2 (scene->clamps,
      3 * (gsize) scene->n_frames * scene->held->len * sizeof *scene->clamps);
  copy->clamps_sd = g_memdup2 (scene->clamps_sd,
      (gsize) scene->n_frames * scene->held->len * sizeof *scene->clamps_sd);
  g_array_unref (copy->obstacles);
  copy->obstacles = cloth_obstacles_copy (scene->obstacles);
  g_array_append_vals (copy->seams, scene->seams->data, scene->seams->len);
  return copy;
}

/* @scene: (nullable) (transfer full): a scene
 */
void
cloth_scene_free (ClothScene * scene)
{
  if (!scene)
    return;
  cloth_topology_free (scene->topology);
  g_free (scene->positions);
  g_free (scene->velocities);
  g_array_unref (scene->held);
  g_free (scene->clamps);
  g_free (scene->clamps_sd);
  g_free (scene->times);
  g_array_unref (scene->obstacles);
  g_array_unref (scene->seams);
  g_free (scene);
}

/* ---- from a take ---- */

/* @scene: a scene
 * @line: two lines of vertices
 * @error: #ClothFileError
 *
 * Sews the lines together, vertex by vertex.
 *
 * Returns: %TRUE when all vertices are there and the lines are equally long on the flat
 *   cloth, to 2%
 */
gboolean
cloth_scene_sew (ClothScene * scene, const ClothSeamLine * line,
    GError ** error)
{
  gdouble lengths[2];

  for (guint side = 0; side < 2; side++)
    for (guint i = 0; i < line->n_vertices; i++)
      if (line->lines[side][i] >= scene->topology->n_vertices)
        return cloth_file_invalid (error,
            "vertex %u of a seam is not in the mesh (there are %u)",
            line->lines[side][i], scene->topology->n_vertices);
  if (!cloth_seam_fits (scene->topology, line, lengths))
    return cloth_file_invalid (error,
        "the lines of the seam from vertex %u and from "
        "vertex %u are %g m and %g m long on the flat cloth; they may differ "
        "by %g%%", line->lines[0][0], line->lines[1][0], lengths[0], lengths[1],
        100 * CLOTH_SEAM_EASE);
  for (guint i = 0; i < line->n_vertices; i++) {
    const ClothSeam seam = { line->lines[0][i], line->lines[1][i] };

    /* The tip of a dart is sewn to itself. */
    if (seam.a != seam.b)
      g_array_append_val (scene->seams, seam);
  }
  return TRUE;
}

static gboolean
read_clamps (ClothScene * scene, ClothTake * take, GError ** error)
{
  gsize n = 3 * (gsize) scene->held->len;
  g_autofree gfloat *row = NULL;

  if (n == 0)
    return TRUE;
  if (!cloth_take_has_clamps (take))
    return cloth_file_invalid (error,
        "%s: take.json says that %u vertices are held, but there is no clamps.npy "
        "with their paths: float32 of the shape [%u][%u][3], or [1][%u][3] when "
        "the clamps stand still; NaN where nobody logged them",
        cloth_take_get_folder (take),
        scene->held->len, scene->n_frames, scene->held->len, scene->held->len);
  if (n * scene->n_frames > CLOTH_MAX_BUFFER / sizeof (gdouble))
    return cloth_file_invalid (error,
        "clamps.npy: %u held vertices in %u frames are "
        "more than a simulation takes", scene->held->len, scene->n_frames);
  row = g_new (gfloat, n);
  scene->clamps = g_new (gdouble, n * scene->n_frames);
  for (guint frame = 0; frame < scene->n_frames; frame++) {
    if (!cloth_take_read_clamps (take, frame, row, error))
      return FALSE;
    for (gsize i = 0; i < n; i++)
      scene->clamps[n * frame + i] = row[i];
  }
  return TRUE;
}

/* Moves the flat sheet so that the clamps are where their paths begin, in the mean. */
static void
hang_flat (ClothScene * scene)
{
  gdouble shift[3] = { 0 };
  guint n = 0;

  for (guint i = 0; i < scene->held->len; i++) {
    const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);

    if (!cloth_held_holds (held, scene->times[0])
        || isnan (scene->clamps[3 * i]))
      continue;
    for (guint k = 0; k < 3; k++)
      shift[k] += scene->clamps[3 * i + k] -
          scene->positions[3 * (gsize) held->vertex + k];
    n++;
  }
  for (gsize i = 0; n > 0 && i < 3 * (gsize) scene->topology->n_vertices; i++)
    scene->positions[i] += shift[i % 3] / n;
}

static gboolean
read_start (ClothScene * scene, ClothTake * take, GError ** error)
{
  const ClothTakeInfo *info = cloth_take_get_info (take);
  guint n = scene->topology->n_vertices;
  g_autofree gfloat *seen = g_new (gfloat, 3 * (gsize) n);
  gboolean any = FALSE;

  if (cloth_take_get_n_positions (take) > 0
      && !cloth_take_read_positions (take, 0, seen, error))
    return FALSE;
  for (gsize i = 0; i < n && cloth_take_get_n_positions (take) > 0 && !any; i++)
    any = isfinite (seen[3 * i]);
  if (!any) {
    hang_flat (scene);
    return TRUE;
  }
  /* what is held was seen by its log: the cloth beside it begins there */
  for (guint i = 0; i < scene->held->len; i++) {
    const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);

    for (guint k = 0; k < 3 && cloth_held_holds (held, scene->times[0])
        && !isnan (scene->clamps[3 * i]); k++)
      seen[3 * (gsize) held->vertex + k] = (gfloat) scene->clamps[3 * i + k];
  }
  cloth_fill_close (scene->topology, info->seams, info->noise_sigma_m, NULL,
      seen);
  for (gsize i = 0; i < 3 * (gsize) n; i++)
    scene->positions[i] = seen[i];
  return TRUE;
}

static gboolean check_all (const ClothScene * scene, gboolean open,
    GError ** error);

/* @open: whether a clamp may have no place where it holds */
static ClothScene *
scene_new (ClothTake * take, gboolean open, GError ** error)
{
  const ClothTakeInfo *info = cloth_take_get_info (take);
  guint n = cloth_take_get_n_frames (take);
  gdouble span = cloth_take_get_time (take, n - 1) -
      cloth_take_get_time (take, 0);
  gdouble fps = info->fps > 0 ? info->fps :
      n > 1 ? (n - 1) / span : FALLBACK_FPS;
  g_autoptr (ClothScene) scene =
      cloth_scene_new (cloth_topology_copy (cloth_take_get_topology (take)),
      fps, n);

  for (guint i = 0; i < n; i++)
    scene->times[i] = cloth_take_get_time (take, i);
  memcpy (scene->gravity, info->gravity, sizeof scene->gravity);
  g_array_append_vals (scene->held, info->held->data, info->held->len);
  g_array_unref (scene->obstacles);
  scene->obstacles = cloth_obstacles_copy (info->obstacles);
  if (!read_clamps (scene, take, error) || !read_start (scene, take, error))
    return NULL;
  for (guint i = 0; i < info->seams->len; i++) {
    if (!cloth_scene_sew (scene, &g_array_index (info->seams, ClothSeamLine,
                i), error)) {
      g_prefix_error (error, "seam %u: ", i);
      return NULL;
    }
  }
  if (!check_all (scene, open, error))
    return NULL;
  return g_steal_pointer (&scene);
}

/* @take: a take
 * @error: #ClothFileError, #GIOErrorEnum; an element that is wrong is named
 *
 * The scene that was filmed: its mesh, clamps, obstacles, gravity and times. The cloth
 * starts at rest where the first frame saw it, held vertices where their clamps are; those
 * not seen then go on as the cloth around them does. When nothing was seen, the sheet hangs
 * flat from its clamps, u along x and v downwards. The scene is checked.
 *
 * Returns: (transfer full): the scene, or %NULL
 */
ClothScene *
cloth_scene_new_from_take (ClothTake * take, GError ** error)
{
  return scene_new (take, FALSE, error);
}

/* @take: a take
 * @error: as of cloth_scene_new_from_take ()
 *
 * The same of a take whose clamps' paths need not be logged: where nobody did they are NaN, and have to
 * be found before anything is simulated.
 *
 * Returns: (transfer full): the scene, or %NULL
 */
ClothScene *
cloth_scene_new_with_open_paths (ClothTake * take, GError ** error)
{
  return scene_new (take, TRUE, error);
}

/* ---- what can be simulated ---- */

typedef struct
{
  guint32 corner[4];            /* sorted */
  guint face;
} Corners;

/* Twice the signed area on the flat cloth. */
static gdouble
flat_area (const ClothTopology * topology, guint face)
{
  const guint32 *corner = topology->faces + 4 * (gsize) face;
  guint n = cloth_face_corners (corner);
  gdouble area = 0;

  for (guint k = 0; k < n; k++) {
    const gfloat *o = topology->uv + 2 * (gsize) corner[0];
    const gfloat *a = topology->uv + 2 * (gsize) corner[k];
    const gfloat *b = topology->uv + 2 * (gsize) corner[(k + 1) % n];

    area += ((gdouble) a[0] - o[0]) * ((gdouble) b[1] - o[1]) -
        ((gdouble) a[1] - o[1]) * ((gdouble) b[0] - o[0]);
  }
  return area;
}

static gdouble
flat_size (const ClothTopology * topology, guint face)
{
  const guint32 *corner = topology->faces + 4 * (gsize) face;
  guint n = cloth_face_corners (corner);
  gdouble size = 0;

  for (guint k = 0; k < n; k++) {
    const gfloat *a = topology->uv + 2 * (gsize) corner[k];
    const gfloat *b = topology->uv + 2 * (gsize) corner[(k + 1) % n];

    size = MAX (size, hypot ((gdouble) b[0] - a[0], (gdouble) b[1] - a[1]));
  }
  return size;
}

static gint
compare_indices (gconstpointer a, gconstpointer b)
{
  const guint32 *x = a, *y = b;

  return (*x > *y) - (*x < *y);
}

static gint
compare_corners (gconstpointer a, gconstpointer b)
{
  const Corners *x = a, *y = b;

  for (guint k = 0; k < 4; k++)
    if (x->corner[k] != y->corner[k])
      return x->corner[k] < y->corner[k] ? -1 : 1;
  return (x->face > y->face) - (x->face < y->face);
}

static gboolean
check_faces (const ClothTopology * topology, GError ** error)
{
  g_autofree Corners *all = g_new (Corners, topology->n_faces);

  for (guint face = 0; face < topology->n_faces; face++) {
    const guint32 *corner = topology->faces + 4 * (gsize) face;
    guint n = cloth_face_corners (corner);
    gdouble size = flat_size (topology, face);

    memcpy (all[face].corner, corner, sizeof all[face].corner);
    all[face].face = face;
    qsort (all[face].corner, 4, sizeof *corner, compare_indices);
    for (guint k = 1; k < n; k++)
      if (all[face].corner[k] == all[face].corner[k - 1])
        return cloth_file_invalid (error, "face %u has vertex %u twice", face,
            all[face].corner[k]);
    if (!(fabs (flat_area (topology, face)) > 1e-6 * size * size))
      return cloth_file_invalid (error,
          "face %u (vertices %u, %u, %u) has no area on the "
          "flat cloth: its uv lie on a line", face, corner[0], corner[1],
          corner[2]);
  }
  qsort (all, topology->n_faces, sizeof *all, compare_corners);
  for (guint i = 1; i < topology->n_faces; i++)
    if (memcmp (all[i].corner, all[i - 1].corner, sizeof all[i].corner) == 0)
      return cloth_file_invalid (error, "faces %u and %u are the same",
          all[i - 1].face, all[i].face);
  return TRUE;
}

/* The vertex that the face comes from along its side. */
static guint32
starts_at (const ClothTopology * topology, const ClothSide * side)
{
  return topology->faces[4 * (gsize) side->face + side->number];
}

/* Neighbours must run along their common edge in opposite directions and be turned
 * alike on the flat cloth. */
static gboolean
check_edges (const ClothTopology * topology, GError ** error)
{
  g_autofree ClothSide *all = g_new (ClothSide, 4 * (gsize) topology->n_faces);
  gsize n = 0;

  for (guint face = 0; face < topology->n_faces; face++) {
    const guint32 *corner = topology->faces + 4 * (gsize) face;
    guint sides = cloth_face_corners (corner);

    for (guint k = 0; k < sides; k++)
      all[n++] = cloth_side (corner[k], corner[(k + 1) % sides], face, k);
  }
  qsort (all, n, sizeof *all, cloth_side_compare);
  for (gsize i = 1; i < n; i++) {
    const ClothSide *a = &all[i - 1], *b = &all[i];

    if (!cloth_side_same_edge (a, b))
      continue;
    if (i + 1 < n && cloth_side_same_edge (a, b + 1))
      return cloth_file_invalid (error,
          "the edge from vertex %u to vertex %u belongs to "
          "more than two faces, %u, %u and %u among them", a->a, a->b,
          a->face, b->face, b[1].face);
    if (starts_at (topology, a) == starts_at (topology, b))
      return cloth_file_invalid (error,
          "face %u is inverted against face %u: they run "
          "the same way along the edge from vertex %u to vertex %u", b->face,
          a->face, a->a, a->b);
    if ((flat_area (topology, a->face) > 0) != (flat_area (topology,
                b->face) > 0))
      return cloth_file_invalid (error,
          "face %u is inverted against face %u: on the flat "
          "cloth it lies folded over the edge from vertex %u to vertex %u",
          b->face, a->face, a->a, a->b);
  }
  return TRUE;
}

static gboolean
check_numbers (const ClothScene * scene, GError ** error)
{
  static const gchar axes[] = "xyz";
  const gdouble *arrays[] = { scene->positions, scene->velocities };
  static const gchar *const names[] = { "position", "velocity" };

  for (guint k = 0; k < 3; k++)
    if (!isfinite (scene->gravity[k]))
      return cloth_file_invalid (error, "gravity along %c is %g", axes[k],
          scene->gravity[k]);
  for (guint a = 0; a < 2; a++) {
    for (gsize i = 0; arrays[a] &&
        i < 3 * (gsize) scene->topology->n_vertices; i++)
      if (!isfinite (arrays[a][i]))
        return cloth_file_invalid (error,
            "the %s of vertex %u along %c is %g at the start", names[a],
            (guint) (i / 3), axes[i % 3], arrays[a][i]);
  }
  if (!(scene->fps > 0) || !isfinite (scene->fps))
    return cloth_file_invalid (error, "a frame rate of %g", scene->fps);
  if (scene->n_frames == 0)
    return cloth_file_invalid (error, "a scene needs at least one frame");
  for (guint i = 0; i < scene->n_frames; i++)
    if (!isfinite (scene->times[i]) ||
        (i > 0 && scene->times[i] <= scene->times[i - 1]))
      return cloth_file_invalid (error,
          "the time of frame %u, %g s, is not finite or does not rise", i,
          scene->times[i]);
  return TRUE;
}

static gboolean
check_held (const ClothScene * scene, gboolean open, GError ** error)
{
  g_autoptr (GHashTable) last = g_hash_table_new (NULL, NULL);

  for (guint i = 0; i < scene->held->len; i++) {
    const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);
    const ClothHeld *other;

    if (held->vertex >= scene->topology->n_vertices)
      return cloth_file_invalid (error,
          "held vertex %u is not in the mesh (there are %u)", held->vertex,
          scene->topology->n_vertices);
    if (!(held->from_s < held->until_s))
      return cloth_file_invalid (error,
          "held vertex %u is let go at %g s, before it is held at %g s",
          held->vertex, held->until_s, held->from_s);
    other = g_hash_table_lookup (last, GUINT_TO_POINTER (held->vertex));
    if (other && held->from_s < other->until_s && other->from_s < held->until_s)
      return cloth_file_invalid (error, "vertex %u is held twice at a time",
          held->vertex);
    g_hash_table_insert (last, GUINT_TO_POINTER (held->vertex),
        (gpointer) held);
    for (guint frame = 0; frame < scene->n_frames; frame++) {
      const gdouble *place = scene->clamps +
          3 * ((gsize) frame * scene->held->len + i);

      if (cloth_held_holds (held, scene->times[frame]) &&
          !(isfinite (place[0] + place[1] + place[2]) || (open
                  && isnan (place[0]))))
        return cloth_file_invalid (error,
            "the clamp of vertex %u has no place in frame %u: a simulation by "
            "itself needs its whole path; gst-cloth-fit-1.0 and a diagnosis find it from "
            "what was seen of the cloth", held->vertex, frame);
    }
  }
  return TRUE;
}

static gboolean
check_obstacles (const ClothScene * scene, GError ** error)
{
  for (guint i = 0; i < scene->obstacles->len; i++) {
    const ClothObstacle *item =
        &g_array_index (scene->obstacles, ClothObstacle, i);
    gboolean round = item->kind == CLOTH_OBSTACLE_SPHERE ||
        item->kind == CLOTH_OBSTACLE_CAPSULE;

    if (round && !(item->radius_m > 0 && isfinite (item->radius_m)))
      return cloth_file_invalid (error, "obstacle %u has the radius %g m", i,
          item->radius_m);
    for (guint k = 0; k < 3; k++)
      if (!isfinite (item->point[k] + item->end[k] + item->normal[k]))
        return cloth_file_invalid (error, "obstacle %u has no finite place", i);
    if (!(isnan (item->friction) || item->friction >= 0))
      return cloth_file_invalid (error, "obstacle %u has the friction %g", i,
          item->friction);
    for (gsize k = 0; k < 3 * (gsize) item->n_points; k++)
      if (!isfinite (item->points[k]))
        return cloth_file_invalid (error,
            "point %u of obstacle %u is %g along %c", (guint) (k / 3), i,
            item->points[k], "xyz"[k % 3]);
    if (item->kind == CLOTH_OBSTACLE_MESH && item->n_triangles == 0)
      return cloth_file_invalid (error,
          "obstacle %u is a mesh without triangles", i);
    for (gsize k = 0; k < 3 * (gsize) item->n_triangles; k++)
      if (item->triangles[k] >= item->n_points)
        return cloth_file_invalid (error,
            "triangle %u of obstacle %u names a point that is not there",
            (guint) (k / 3), i);
  }
  return TRUE;
}

static gboolean
check_all (const ClothScene * scene, gboolean open, GError ** error)
{
  if (!cloth_topology_check (scene->topology, error))
    return FALSE;
  if (scene->topology->n_faces == 0)
    return cloth_file_invalid (error, "a mesh without faces");
  if (!check_faces (scene->topology, error) ||
      !check_edges (scene->topology, error) ||
      !check_numbers (scene, error) || !check_held (scene, open, error) ||
      !check_obstacles (scene, error))
    return FALSE;
  for (guint i = 0; i < scene->seams->len; i++) {
    const ClothSeam *seam = &g_array_index (scene->seams, ClothSeam, i);
    guint n = scene->topology->n_vertices;

    if (seam->a >= n || seam->b >= n || seam->a == seam->b)
      return cloth_file_invalid (error,
          "vertices %u and %u cannot be sewn together: " "there are %u",
          seam->a, seam->b, n);
  }
  return TRUE;
}

/* @scene: a scene, perhaps made by hand
 * @error: #ClothFileError, naming the element and its value
 *
 * Refuses what no simulation could make sense of: faces that are degenerate, there
 * twice or inverted against a neighbour, edges of more than two faces, numbers that
 * are not finite, times that do not rise, what names vertices that are not there.
 *
 * Returns: %TRUE when there is nothing of the kind
 */
gboolean
cloth_scene_check (const ClothScene * scene, GError ** error)
{
  return check_all (scene, FALSE, error);
}

/* Between frames through which it holds, a clamp goes along its path. */
static gboolean
check_path (const ClothScene * scene, guint i, GError ** error)
{
  const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);
  const gsize step = 3 * (gsize) scene->held->len;

  for (guint frame = 1; frame < scene->n_frames; frame++) {
    const gdouble *a = scene->clamps + step * (frame - 1) + 3 * i, *b =
        a + step;
    const gdouble way =
        sqrt ((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]) +
        (b[2] - a[2]) * (b[2] - a[2]));
    const gdouble span = scene->times[frame] - scene->times[frame - 1];

    if (cloth_held_holds (held, scene->times[frame - 1])
        && cloth_held_holds (held, scene->times[frame])
        && !(way <= MAX_CLAMP_SPEED * span))
      return cloth_file_invalid (error,
          "the clamp of vertex %u jumps %g m between frames %u and %u, in %g s; "
          "nothing moves faster than %g m/s: mend its path, which is in metres, "
          "or let it go (until_s) before the jump", held->vertex, way,
          frame - 1, frame, span, MAX_CLAMP_SPEED);
  }
  return TRUE;
}

/* @scene: a scene that cloth_scene_check () accepts
 * @error: #ClothFileError, naming the clamp and the frames
 *
 * Refuses clamps that jump, which no simulation survives, before one is run. Clamps in
 * millimetres jump too: a diagnosis looks for these first.
 *
 * Returns: %TRUE when no clamp moves faster than sound
 */
gboolean
cloth_scene_check_paths (const ClothScene * scene, GError ** error)
{
  for (guint i = 0; i < scene->held->len; i++)
    if (!check_path (scene, i, error))
      return FALSE;
  return TRUE;
}
