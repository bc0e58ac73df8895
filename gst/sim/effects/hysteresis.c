/* Threads that rub: tension that depends on the way there.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "damping_stiffness", "plasticity", "biphasic_stretch", "bending_softening",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_hysteresis = {
  .id = "hysteresis",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "A tension that follows Dahl’s law of friction on the strains of "
      "warp and weft: it tends to ±tension over about one strain of "
      "loading, and turns with it.",
  .source =
      "Dahl, A solid friction model, Aerospace Corporation TOR-0158, "
      "1968; pulls on knits, whose first differs from the later ones.",
  .regressor =
      "A force within the plane of bounded size that has the sign of "
      "the rate of strain, not its size, unlike damping_stiffness.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "tension", .unit = "N/m", .null_value = 0, .min = 0, .max = 200,
        .prior = 1, .one_sided = TRUE,
        .blurb = "Tension at which the threads slide"},
    {.name = "strain", .unit = "1", .null_value = 0.01, .min = 1e-05, .max = 1,
        .prior = 0.01, .shapes = TRUE,
        .blurb = "Strain over which the tension builds up; without tension it "
            "means nothing"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* Of a triangle: tension over its limit, and the strain it belongs to. */
typedef struct
{
  ClothLane load[2], strain[2];
} Thread;

static void
rate (const ClothLaneState * state, const ClothLaneEffect * effect,
    ClothLane * omega2, ClothLane * friction)
{
  *omega2 += *omega2 * effect->p[0] / effect->p[1] /
      cloth_lane_min (state->stretch_warp, state->stretch_weft);
}

static void
reset (ClothLaneState * state, ClothLaneEffect * effect, ClothMask lanes)
{
  Thread *threads = effect->state;
  ClothLane zero = cloth_lane_set (0.);

  for (guint i = 0; i < state->body->n_triangles; i++) {
    ClothLaneStrain strain;

    cloth_lane_strain (state, &state->triangles[i], &strain);
    for (guint k = 0; k < 2; k++) {
      threads[i].load[k] = cloth_lane_select (lanes, zero, threads[i].load[k]);
      threads[i].strain[k] = cloth_lane_select (lanes,
          k ? strain.weft : strain.warp, threads[i].strain[k]);
    }
  }
}

/* dT/dE = (limit − T sgn Ė) / strain, implicit in T over a step. */
static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  Thread *threads = effect->state;
  ClothLane one = cloth_lane_set (1.);

  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    Thread *thread = &threads[i];
    ClothLaneStrain strain;

    cloth_lane_strain (state, t, &strain);
    for (guint k = 0; k < 2; k++) {
      ClothLane now = k ? strain.weft : strain.warp;
      ClothLane move = (now - thread->strain[k]) / effect->p[1];

      thread->load[k] = (thread->load[k] + move) /
          (one + cloth_lane_abs (move));
      thread->strain[k] = now;
    }
    cloth_lane_pull (state, t, &strain, effect->p[0] * thread->load[0],
        effect->p[0] * thread->load[1]);
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_hysteresis) = {
  .order = CLOTH_LANE_ORDER_THREADS,
  .triangle_size = sizeof (Thread),
  .rate = rate,
  .force = force,
  .reset = reset,
};
#endif
