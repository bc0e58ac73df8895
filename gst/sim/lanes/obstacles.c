/* What the cloth may touch. A particle that a step took into an obstacle is put on its
 * surface and loses as much of its speed as took it in: what it would have had if the
 * surface had pushed during the step. Coulomb's friction takes from its sliding at most
 * the coefficient times that. So cloth at rest on a slope feels exactly m g cos θ, and
 * sticks or slides by that. One that was inside before the step is put out without
 * being thrown.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/state.h"
#include "gst/take/take.h"

/* How far behind a mesh that isn't closed the cloth counts as having come through it, m,
 * beside the way of the step. */
#define SHEET_DEPTH 0.01
/* Nearer than this the direction to the nearest point is rounding, m. */
#define NEAR 1e-5

/* Where the cloth is known not to touch a mesh: within a distance of a place. */
typedef struct
{
  ClothLane3 *place;
  ClothLane *distance;
} Clear;

struct _ClothLaneObstacles
{
  Clear *clear;                 /* of each obstacle; NULL but for meshes */
};

/* Of one particle: how far outside it is, less than 0 inside, and the way out. */
typedef struct
{
  ClothLane gap;
  ClothLane normal[3];
} Touch;

ClothLaneObstacles *CLOTH_LANE_NAME (cloth_lane_obstacles_new) (const
    ClothLaneState * state)
{
  const ClothBody * body = state->body;
  ClothLaneObstacles *obstacles = g_new0 (ClothLaneObstacles, 1);

  obstacles->clear = g_new0 (Clear, body->obstacles->len + 1);
  for (guint i = 0; i < body->obstacles->len; i++) {
    if (!body->bvhs[i])
      continue;
    obstacles->clear[i].place =
        g_aligned_alloc0 (state->n, sizeof (ClothLane3), 64);
    obstacles->clear[i].distance =
        g_aligned_alloc0 (state->n, sizeof (ClothLane), 64);
  }
  return obstacles;
}

void CLOTH_LANE_NAME (cloth_lane_obstacles_free) (ClothLaneState * state)
{
  ClothLaneObstacles *obstacles = state->obstacles;

  for (guint i = 0; obstacles && i < state->body->obstacles->len; i++) {
    g_aligned_free (obstacles->clear[i].place);
    g_aligned_free (obstacles->clear[i].distance);
  }
  if (obstacles)
    g_free (obstacles->clear);
  g_free (obstacles);
}

CLOTH_LANE_INLINE void
respond (ClothLaneState * state, guint i, const Touch * touch,
    ClothLane friction)
{
  ClothLane zero = cloth_lane_set (0.), tiny = cloth_lane_set (1e-18);
  ClothLane *x = state->x[i], *v = state->v[i];
  ClothMask in = cloth_lane_less (touch->gap, zero);
  ClothLane depth = -touch->gap;
  ClothLane along = cloth_lane_dot (v, touch->normal), slide[3];
  ClothLane stop = cloth_lane_min (depth / state->reach,
      cloth_lane_max (-along, zero));
  ClothLane brake;

  for (guint k = 0; k < 3; k++)
    slide[k] = v[k] - along * touch->normal[k];
  brake = cloth_lane_min (friction * stop /
      cloth_lane_sqrt (cloth_lane_max (cloth_lane_dot (slide, slide), tiny)),
      cloth_lane_set (1.));
  for (guint k = 0; k < 3; k++) {
    ClothLane drag = brake * slide[k];

    v[k] = cloth_lane_select (in, v[k] + stop * touch->normal[k] - drag, v[k]);
    x[k] = cloth_lane_select (in, x[k] + depth * touch->normal[k] -
        state->reach * drag, x[k]);
  }
}

/* The nearest point of the capsule's line from point to point + axis; of a sphere the
 * axis is 0. */
CLOTH_LANE_INLINE void
touch_round (const ClothObstacle * o, const ClothLane x[3], Touch * touch)
{
  gdouble square = 0.;
  ClothLane zero = cloth_lane_set (0.), share, length;
  ClothLane axis[3];

  for (guint k = 0; k < 3; k++) {
    gdouble a = o->kind == CLOTH_OBSTACLE_CAPSULE ? o->end[k] - o->point[k] :
        0.;

    axis[k] = cloth_lane_set (a);
    square += a * a;
    touch->normal[k] = x[k] - cloth_lane_set (o->point[k]);
  }
  share = cloth_lane_dot (axis, touch->normal) *
      cloth_lane_set (square > 0. ? 1. / square : 0.);
  share = cloth_lane_min (cloth_lane_max (share, zero), cloth_lane_set (1.));
  for (guint k = 0; k < 3; k++)
    touch->normal[k] -= share * axis[k];
  length = cloth_lane_sqrt (cloth_lane_dot (touch->normal, touch->normal));
  touch->gap = length - cloth_lane_set (o->radius_m);
  length = cloth_lane_max (length, cloth_lane_set (1e-12));
  for (guint k = 0; k < 3; k++)
    touch->normal[k] /= length;
}

CLOTH_LANE_INLINE void
touch_plane (const ClothObstacle * o, const ClothLane x[3], Touch * touch)
{
  ClothLane from[3];

  for (guint k = 0; k < 3; k++) {
    touch->normal[k] = cloth_lane_set (o->normal[k]);
    from[k] = x[k] - cloth_lane_set (o->point[k]);
  }
  touch->gap = cloth_lane_dot (from, touch->normal);
}

/* Asks for the nearest point in one lane. */
static void
touch_mesh_lane (ClothLaneState * state, const ClothBvh * bvh, guint i,
    guint lane, Clear * clear, Touch * touch)
{
  gdouble x[3], depth = G_MAXDOUBLE, free_m;
  ClothBvhHit hit;

  for (guint k = 0; k < 3; k++) {
    x[k] = CLOTH_LANE_AT (&state->x[i][k], lane);
    CLOTH_LANE_AT (&clear->place[i][k], lane) = (ClothReal) x[k];
  }
  CLOTH_LANE_AT (&touch->gap, lane) = 1;
  CLOTH_LANE_AT (&clear->distance[i], lane) = 0;
  if (!cloth_bvh_nearest (bvh, x, &hit))
    return;
  if (!cloth_bvh_is_closed (bvh)) {
    gdouble square = 0.;

    for (guint k = 0; k < 3; k++) {
      gdouble v = CLOTH_LANE_AT (&state->v[i][k], lane);

      square += v * v;
    }
    depth = SHEET_DEPTH + sqrt (square) * state->dt;
  }
  free_m = hit.inside ? hit.distance - depth : hit.distance;
  if (free_m > 0. || hit.border || !hit.inside) {
    /* a hair less for rounding */
    CLOTH_LANE_AT (&clear->distance[i], lane) =
        (ClothReal) (0.999 * MAX (free_m, 0.));
    return;
  }
  CLOTH_LANE_AT (&touch->gap, lane) = (ClothReal) - hit.distance;
  for (guint k = 0; k < 3; k++)
    CLOTH_LANE_AT (&touch->normal[k], lane) = (ClothReal)
        (hit.face || hit.distance < NEAR ? hit.normal[k] :
        (hit.point[k] - x[k]) / hit.distance);
}

static void
touch_mesh (ClothLaneState * state, const ClothBvh * bvh, guint i,
    Clear * clear, Touch * touch)
{
  ClothLane moved[3];
  ClothMask ask;

  cloth_lane_subtract (state->x[i], clear->place[i], moved);
  ask = ~cloth_lane_less (cloth_lane_dot (moved, moved),
      clear->distance[i] * clear->distance[i]);
  touch->gap = cloth_lane_set (1.);
  for (guint k = 0; k < 3; k++)
    touch->normal[k] = cloth_lane_set (0.);
  if (cloth_lane_any (ask))
    for (guint l = 0; l < CLOTH_N_LANES; l++)
      if (CLOTH_LANE_AT (&ask, l))
        touch_mesh_lane (state, bvh, i, l, clear, touch);
}

CLOTH_LANE_INLINE void
particles (ClothLaneState * state, guint index, ClothObstacleKind kind)
{
  const ClothObstacle *o =
      &g_array_index (state->body->obstacles, ClothObstacle, index);
  ClothLane zero = cloth_lane_set (0.);
  /* the coefficient of an obstacle of which nobody knows it is an effect's alone */
  ClothLane friction = state->obstacle_friction +
      cloth_lane_set (isnan (o->friction) ? 0. : o->friction);

  for (guint i = 0; i < state->n; i++) {
    Touch touch;

    if (kind == CLOTH_OBSTACLE_PLANE)
      touch_plane (o, state->x[i], &touch);
    else if (kind == CLOTH_OBSTACLE_MESH)
      touch_mesh (state, state->body->bvhs[index], i,
          &state->obstacles->clear[index], &touch);
    else
      touch_round (o, state->x[i], &touch);
    if (cloth_lane_any (cloth_lane_less (touch.gap, zero)))
      respond (state, i, &touch, friction);
  }
}

/* A floor that the models have and the scene has not. */
static void
stand_on_floor (ClothLaneState * state)
{
  ClothLane zero = cloth_lane_set (0.);
  Touch touch = {.normal = {zero, zero, cloth_lane_set (1.)} };

  for (guint i = 0; i < state->n; i++) {
    touch.gap = state->x[i][2] - state->floor;
    if (cloth_lane_any (cloth_lane_less (touch.gap, zero)))
      respond (state, i, &touch, state->obstacle_friction);
  }
}

/* Takes the particles out of the obstacles. */
void CLOTH_LANE_NAME (cloth_lane_obstacles) (ClothLaneState * state)
{
  const GArray *obstacles = state->body->obstacles;

  for (guint i = 0; i < obstacles->len; i++) {
    switch (g_array_index (obstacles, ClothObstacle, i).kind) {
      case CLOTH_OBSTACLE_PLANE:
        particles (state, i, CLOTH_OBSTACLE_PLANE);
        break;
      case CLOTH_OBSTACLE_MESH:
        particles (state, i, CLOTH_OBSTACLE_MESH);
        break;
      default:
        particles (state, i, CLOTH_OBSTACLE_SPHERE);
        break;
    }
  }
  if (state->has_floor)
    stand_on_floor (state);
}
