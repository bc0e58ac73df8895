/* The push of moving air, of the effects wind and gust.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/hooks.h"

/* √(u² + turbulence²) u: a pressure in proportion to u when the air is never still. */
CLOTH_LANE_INLINE ClothLane
pressure (ClothLane u, ClothLane turbulence)
{
  return cloth_lane_sqrt (u * u + turbulence * turbulence) * u;
}

/* Adds what wind of a velocity changes in the air's force along the normal:
 * ½ρC (p(w_n − v_n) + p(v_n)) n on each unit of area, exactly 0 without wind. */
void
CLOTH_LANE_NAME (cloth_lane_wind) (ClothLaneState * state,
    const ClothLane wind[3], ClothLane coefficient, ClothLane turbulence)
{
  ClothLane factor = coefficient * state->air_density * cloth_lane_set (0.5);
  ClothLane tiny = cloth_lane_set (1e-30);

  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLane normal[3], velocity[3], push[3], area, wind_n, velocity_n, p;

    cloth_lane_face (state, t, normal, &area, velocity);
    area = cloth_lane_sqrt (cloth_lane_max (area * area, tiny));
    velocity_n = cloth_lane_dot (velocity, normal) / area;
    wind_n = cloth_lane_dot (wind, normal) / area;
    p = factor * (pressure (wind_n - velocity_n, turbulence) +
        pressure (velocity_n, turbulence));
    for (guint k = 0; k < 3; k++)
      push[k] = p * normal[k];
    cloth_lane_push_face (state, t, push);
  }
}
