/* Drag of still air on cloth that moves across itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "air_drag_linear", "air_drag_tangential", "damping_mass",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_air_drag = {
  .id = "air_drag",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Still air brakes cloth that moves along its normal, by the "
      "square of the speed: force −½ρ C |v_n| v_n n on each unit of "
      "area, ρ the model’s air_density.",
  .source =
      "Normal force of a plate across the flow, C_N 1.1 to 2: Hoerner, "
      "Fluid-Dynamic Drag, 1965, chapter 3.",
  .regressor =
      "A force against the normal velocity that grows with its square, "
      "none at rest, most at the free edge; sensitivities of "
      "air_drag_linear have a cosine of 0.93 with it.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "coefficient", .unit = "1", .null_value = 0, .min = 0, .max = 20,
        .prior = 1.5, .one_sided = TRUE,
        .blurb = "C_N of the cloth as a plate; a drag without the factor ½ has "
            "twice the number"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* F = −½ ρ C A |v_n| v_n n = −½ ρ C |v·N| (v·N) N / A², N the normal of length A. */
static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane factor = effect->p[0] * state->air_density * cloth_lane_set (-0.5);

  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLane normal[3], velocity[3], push[3], area, through;

    cloth_lane_face (state, t, normal, &area, velocity);
    through = cloth_lane_dot (velocity, normal);
    through = factor * cloth_lane_abs (through) * through /
        cloth_lane_max (area * area, cloth_lane_set (1e-30));
    for (guint k = 0; k < 3; k++)
      push[k] = through * normal[k];
    cloth_lane_push_face (state, t, push);
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_air_drag) = {
  .order = CLOTH_LANE_ORDER_AIR,
  .force = force,
};
#endif
