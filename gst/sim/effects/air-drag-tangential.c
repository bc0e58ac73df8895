/* Friction of air along the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "air_drag", "air_drag_linear", "damping_mass",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_air_drag_tangential = {
  .id = "air_drag_tangential",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Air rubs along the cloth: force −c v_t on each unit of area, v_t "
      "the velocity within the plane of the cloth.",
  .source =
      "Skin friction of a plate, 0.01 to 0.1 N s/m³: Schlichting, "
      "Boundary-Layer Theory.",
  .regressor =
      "A force against the velocity within the plane of the cloth, in "
      "proportion to it, none along the normal.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "coefficient", .unit = "N s/m³", .null_value = 0, .min = 0, .max = 2,
        .prior = 0.05, .one_sided = TRUE,
        .blurb = "Force on each unit of area over the tangential velocity"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* F = −c A (v − (v·n) n). */
static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane tiny = cloth_lane_set (1e-30);

  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLane normal[3], velocity[3], push[3], area, through, drag;

    cloth_lane_face (state, t, normal, &area, velocity);
    drag = effect->p[0] * area;
    through = cloth_lane_dot (velocity, normal) /
        cloth_lane_max (area * area, tiny);
    for (guint k = 0; k < 3; k++)
      push[k] = drag * (through * normal[k] - velocity[k]);
    cloth_lane_push_face (state, t, push);
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_air_drag_tangential) = {
  .order = CLOTH_LANE_ORDER_AIR,
  .force = force,
};
#endif
