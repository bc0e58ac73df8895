/* take.json: what a take says of itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/take/obstacle.h"
#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* Limit on untrusted input. */
#define CLOTH_MAX_SEAMS 1024

/* @vertex: a vertex that a clamp holds
 * @from_s: held from here on, seconds; −∞ when from the beginning
 * @until_s: let go here, seconds; ∞ when held to the end
 */
typedef struct {
  guint vertex;
  gdouble from_s;
  gdouble until_s;
} ClothHeld;

/* Whether a clamp holds what it holds at a time, seconds. */
static inline gboolean
cloth_held_holds (const ClothHeld * held, gdouble time)
{
  return time >= held->from_s && time < held->until_s;
}

/* How long two clamps hold at once, seconds; below 0: how long neither does between them. */
static inline gdouble
cloth_held_overlap (const ClothHeld * a, const ClothHeld * b)
{
  return MIN (a->until_s, b->until_s) - MAX (a->from_s, b->from_s);
}

/* @name: its name
 * @fps: frames a second, 0 when only times.npy says
 * @columns: vertices of a row of the grid, 0 with a mesh file
 * @rows: rows of vertices of the grid
 * @width_m: width of the grid, metres
 * @height_m: its height, metres
 * @mesh: (nullable): name of the OBJ file in the folder, when it is no grid
 * @held: (element-type ClothHeld): what clamps hold, in the order of clamps.npy
 * @noise_sigma_m: standard deviation of a coordinate, metres; NaN: estimate it
 * @gravity: m/s²
 * @obstacles: (element-type ClothObstacle): what the cloth may touch
 * @seams: (element-type ClothSeamLine): what is sewn together, for a mesh file
 * @notes: (nullable): for people
 *
 * The contents of take.json.
 */
typedef struct {
  gchar *name;
  gdouble fps;
  guint columns;
  guint rows;
  gdouble width_m;
  gdouble height_m;
  gchar *mesh;
  GArray *held;
  gdouble noise_sigma_m;
  gdouble gravity[3];
  GArray *obstacles;
  GArray *seams;
  gchar *notes;
} ClothTakeInfo;

ClothTakeInfo *cloth_take_info_new (const gchar * name);
ClothTakeInfo *cloth_take_info_parse (const gchar * json, gsize size,
    GError ** error);
void cloth_take_info_set_mesh (ClothTakeInfo * info,
    const ClothTopology * topology);
gchar *cloth_take_info_to_json (const ClothTakeInfo * info);
ClothTakeInfo *cloth_take_info_copy (const ClothTakeInfo * info);
void cloth_take_info_free (ClothTakeInfo * info);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTakeInfo, cloth_take_info_free)
G_END_DECLS
