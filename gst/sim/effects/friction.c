/* Friction on obstacles.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "air_drag_tangential", "self_contact",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_friction = {
  .id = "friction",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Obstacles hold on to cloth that slides on them, by Coulomb’s "
      "law; with self_contact the cloth does so too.",
  .source =
      "Cloth on wood, plastic or skin: 0.2 to 0.8.",
  .regressor =
      "A tangential force at contacts, against sliding and bounded by "
      "the normal force.",
  .confusions = confusions,
  .needs_obstacles = TRUE,
  .n_parameters = 2,
  .parameters = {
    {.name = "coefficient", .unit = "1", .null_value = 0, .min = 0, .max = 2,
        .prior = 0.4, .one_sided = TRUE,
        .blurb = "What is added to the friction of every obstacle, of which one "
            "that is not known is 0; and the friction of cloth on itself"},
    {.name = "floor", .unit = "m", .null_value = -1000, .min = -1000, .max = 1000,
        .prior = 1, .shapes = TRUE,
        .blurb = "Height z of a level floor that the scene doesn’t state; −1000: "
            "there is none"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  state->obstacle_friction += effect->p[0];
  state->floor = effect->p[1];
  state->has_floor = TRUE;
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_friction) = {
  .setup = setup,
};
#endif
