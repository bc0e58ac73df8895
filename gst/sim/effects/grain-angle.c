/* Cloth cut askew to its threads.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "stretch_anisotropy", "bending_anisotropy", "shear",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_grain_angle = {
  .id = "grain_angle",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "The threads are turned against u and v by an angle.",
  .source =
      "Prior: own choice, a few degrees of skew.",
  .regressor =
      "Forces within the plane that couple stretch and shear, of "
      "opposite sign left and right of the middle.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "angle", .unit = "°", .null_value = 0, .min = -90, .max = 90,
        .prior = 3,
        .blurb = "From u to the warp, positive towards v"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* ∂x/∂warp = cos ∂x/∂u + sin ∂x/∂v, ∂x/∂weft at a right angle to it. */
static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane c, s, *r = state->rest;

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    gdouble angle = CLOTH_LANE_AT (&effect->p[0], l) * (G_PI / 180.);

    CLOTH_LANE_AT (&c, l) = (ClothReal) cos (angle);
    CLOTH_LANE_AT (&s, l) = (ClothReal) sin (angle);
  }
  for (guint row = 0; row < 4; row += 2) {
    ClothLane a = r[row], b = r[row + 1];

    r[row] = a * c + b * s;
    r[row + 1] = b * c - a * s;
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_grain_angle) = {
  .order = CLOTH_LANE_ORDER_DIRECTIONS,
  .changes_rest = TRUE,
  .setup = setup,
};
#endif
