/* A scene: making one by hand.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/scene.h"

#include <math.h>
#include <string.h>

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
  g_free (scene->times);
  g_array_unref (scene->obstacles);
  g_array_unref (scene->seams);
  g_free (scene);
}
