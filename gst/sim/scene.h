/* A scene: the cloth at rest, what holds it and what it may touch.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/take/take.h"

G_BEGIN_DECLS

/* @a: a vertex
 * @b: the vertex sewn to it
 *
 * Two vertices that are one particle.
 */
typedef struct {
  guint a;
  guint b;
} ClothSeam;

/* @topology: vertices, faces and where they lie on the flat cloth (metres)
 * @positions: where the vertices are at the start, n_vertices · 3, metres
 * @velocities: (nullable): how fast they are then, m/s; %NULL: at rest
 * @held: (element-type ClothHeld): what clamps hold
 * @clamps: paths of the clamps, [n_frames][held][3], metres
 * @clamps_sd: (nullable): of places in @clamps that nobody logged and that were found from what was seen of
 *   the cloth the standard deviation of a coordinate, [n_frames][held], metres; 0 of logged ones; %NULL:
 *   all were logged
 * @n_frames: number of frames
 * @times: their times, seconds, growing
 * @fps: frames a second
 * @gravity: m/s²
 * @obstacles: (element-type ClothObstacle): what the cloth may touch
 * @seams: (element-type ClothSeam): what is sewn together
 *
 * All that a simulation needs but the model. World coordinates, z up. The
 * simulation starts at @times[0].
 */
typedef struct {
  ClothTopology *topology;
  gdouble *positions;
  gdouble *velocities;
  GArray *held;
  gdouble *clamps;
  gdouble *clamps_sd;
  guint n_frames;
  gdouble *times;
  gdouble fps;
  gdouble gravity[3];
  GArray *obstacles;
  GArray *seams;
} ClothScene;

/* Whether the path of a clamp was found in the cloth there, instead of logged; @at: frame · held + clamp. */
static inline gboolean
cloth_scene_is_found (const ClothScene * scene, gsize at)
{
  return scene->clamps_sd && scene->clamps_sd[at] > 0.;
}

ClothScene *cloth_scene_new (ClothTopology * topology, gdouble fps,
    guint n_frames);
ClothScene *cloth_scene_new_from_take (ClothTake * take, GError ** error);
ClothScene *cloth_scene_new_with_open_paths (ClothTake * take, GError ** error);
guint cloth_scene_hold (ClothScene * scene, guint vertex);
gboolean cloth_scene_sew (ClothScene * scene, const ClothSeamLine * line,
    GError ** error);
gboolean cloth_scene_check (const ClothScene * scene, GError ** error);
gboolean cloth_scene_check_paths (const ClothScene * scene, GError ** error);
ClothScene *cloth_scene_copy (const ClothScene * scene);
void cloth_scene_free (ClothScene * scene);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothScene, cloth_scene_free)
G_END_DECLS
