/* A scene: what a take says of one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/scene.h"

#include <math.h>
#include <string.h>

#include "gst/mesh/hold.h"

/* A rate for one frame alone, which has none. */
#define FALLBACK_FPS 30.
/* Two lines of a seam may differ by this part of the longer one, as cut cloth does. */
#define SEAM_EASE 0.02

static gdouble
line_length (const ClothTopology * topology, const guint * line, guint n)
{
  gdouble length = 0;

  for (guint i = 1; i < n; i++) {
    const gfloat *a = topology->uv + 2 * (gsize) line[i - 1];
    const gfloat *b = topology->uv + 2 * (gsize) line[i];

    length += hypot ((gdouble) b[0] - a[0], (gdouble) b[1] - a[1]);
  }
  return length;
}

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

  for (guint side = 0; side < 2; side++) {
    for (guint i = 0; i < line->n_vertices; i++)
      if (line->lines[side][i] >= scene->topology->n_vertices)
        return cloth_file_invalid (error,
            "vertex %u of a seam is not in the mesh (there are %u)",
            line->lines[side][i], scene->topology->n_vertices);
    lengths[side] =
        line_length (scene->topology, line->lines[side], line->n_vertices);
  }
  if (fabs (lengths[0] - lengths[1]) > SEAM_EASE * MAX (lengths[0], lengths[1]))
    return cloth_file_invalid (error,
        "the lines of the seam from vertex %u and from "
        "vertex %u are %g m and %g m long on the flat cloth; they may differ "
        "by %g%%", line->lines[0][0], line->lines[1][0], lengths[0], lengths[1],
        100 * SEAM_EASE);
  for (guint i = 0; i < line->n_vertices; i++) {
    const ClothSeam seam = { line->lines[0][i], line->lines[1][i] };

    /* The tip of a dart is sewn to itself. */
    if (seam.a != seam.b)
      g_array_append_val (scene->seams, seam);
  }
  return TRUE;
}

static gboolean
is_held (const ClothHeld * held, gdouble time)
{
  return time >= held->from_s && time < held->until_s;
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
        "take.json says that %u vertices are held, but "
        "there is no clamps.npy with their paths", scene->held->len);
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

    if (!is_held (held, scene->times[0]))
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
  guint n = scene->topology->n_vertices;
  g_autofree gfloat *seen = g_new (gfloat, 3 * (gsize) n);
  g_autoptr (ClothHold) hold = cloth_hold_new (scene->topology);
  const gfloat *filled;
  gboolean any = FALSE;

  if (!cloth_take_read_positions (take, 0, seen, error))
    return FALSE;
  for (gsize i = 0; i < n && !any; i++)
    any = isfinite (seen[3 * i]);
  if (!any) {
    hang_flat (scene);
    return TRUE;
  }
  filled = cloth_hold_apply (hold, seen);
  for (gsize i = 0; i < 3 * (gsize) n; i++)
    scene->positions[i] = filled[i];
  for (guint i = 0; i < scene->held->len; i++) {
    const ClothHeld *held = &g_array_index (scene->held, ClothHeld, i);

    if (is_held (held, scene->times[0]))
      memcpy (scene->positions + 3 * (gsize) held->vertex,
          scene->clamps + 3 * i, 3 * sizeof *scene->positions);
  }
  return TRUE;
}

/* @take: a take
 * @error: #ClothFileError, #GIOErrorEnum; an element that is wrong is named
 *
 * The scene that was filmed: its mesh, clamps, obstacles, gravity and times. The cloth
 * starts at rest where the first frame saw it; vertices not seen then lie between their
 * neighbours, held ones where their clamps are. When nothing was seen, the sheet hangs
 * flat from its clamps, u along x and v downwards. The scene is checked.
 *
 * Returns: (transfer full): the scene, or %NULL
 */
ClothScene *
cloth_scene_new_from_take (ClothTake * take, GError ** error)
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
  if (!cloth_scene_check (scene, error))
    return NULL;
  return g_steal_pointer (&scene);
}
