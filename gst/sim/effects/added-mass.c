/* Air that has to move with the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "areal_mass", "gravity_scale",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_added_mass = {
  .id = "added_mass",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Air that is carried along adds inertia, but no weight, to motion "
      "along the normal.",
  .source =
      "Plate of width b: π ρ b/4 on each unit of area, 0.04 to 0.5 "
      "kg/m² for folds to whole sheets: Lamb, Hydrodynamics, 1932.",
  .regressor =
      "A force against the normal acceleration, in proportion to it.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "mass", .unit = "kg/m²", .null_value = 0, .min = 0, .max = 5,
        .prior = 0.2, .one_sided = TRUE,
        .blurb = "Mass of the air that moves with each unit of area"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* The mass (m + M n nᵀ) of a particle leaves of the acceleration along n only the share
 * m / (m + M): what is missing is the force. Acts last, when the others are known. */
static void
inertia (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane3 *normals = effect->state;
  ClothLane one = cloth_lane_set (1.);
  ClothLane tiny = cloth_lane_set (1e-30);

  memset (normals, 0, state->n * sizeof *normals);
  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    const gdouble *g = state->body->triangles[i].g;
    /* corners go round either way: all normals are along x_u × x_v */
    ClothLane third =
        cloth_lane_set ((g[0] * g[3] > g[1] * g[2] ? 1. : -1.) / 3.);
    ClothLane normal[3], velocity[3], area;

    cloth_lane_face (state, t, normal, &area, velocity);
    for (guint corner = 0; corner < 3; corner++)
      for (guint k = 0; k < 3; k++)
        normals[t->particle[corner]][k] += normal[k] * third;
  }
  for (guint i = 0; i < state->n; i++) {
    ClothLane area2 = cloth_lane_dot (normals[i], normals[i]);
    ClothLane ratio = effect->p[0] * (ClothReal) state->body->area[i] *
        state->inverse_mass[i];
    ClothLane along = cloth_lane_set (0.);

    for (guint k = 0; k < 3; k++)
      along += normals[i][k] * (state->f[i][k] * state->inverse_mass[i] +
          state->gravity[k] - state->alpha * state->v[i][k]);
    along *= state->mass[i] * ratio / ((one + ratio) * cloth_lane_max (area2,
            tiny));
    for (guint k = 0; k < 3; k++)
      state->f[i][k] -= along * normals[i][k];
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_added_mass) = {
  .state_size = sizeof (ClothLane3),
  .inertia = inertia,
};
#endif
