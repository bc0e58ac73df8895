/* Gusts: a wind that comes and goes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "wind", "gravity_tilt",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_gust = {
  .id = "gust",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "A wind of random speed, an Ornstein–Uhlenbeck process of mean 0 "
      "that follows from the seed, pushes the cloth along its normal "
      "with the law of wind.",
  .source =
      "Uhlenbeck and Ornstein, Physical Review 36, 1930; intensities "
      "are 10 to 30% of the mean wind.",
  .regressor =
      "A force along the normal, alike for all of the cloth at a time, "
      "whose sign and size change with a correlation time; a steady "
      "wind fitted to parts of the take would not stay the same.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_STOCHASTIC,
  .varies = "wind",
  .untested =
      "Gusts are winds that change: they are tested where wind is.",
  .is_moving_air = TRUE,
  .n_parameters = 5,
  .parameters = {
    {.name = "intensity", .unit = "m/s", .null_value = 0, .min = 0, .max = 20,
        .prior = 0.3, .one_sided = TRUE,
        .blurb = "Standard deviation of the speed"},
    {.name = "time", .unit = "s", .null_value = 0.5, .min = 0.01, .max = 60,
        .prior = 0.5, .shapes = TRUE,
        .blurb = "Correlation time: after it 37% of a gust are left"},
    {.name = "azimuth", .unit = "°", .null_value = 90, .min = -180, .max = 180,
        .prior = 90, .shapes = TRUE,
        .blurb = "Horizontal direction that positive gusts blow to: 0 is x, 90 is "
            "y"},
    {.name = "coefficient", .unit = "1", .null_value = 1.5, .min = 0, .max = 20,
        .prior = 0.5, .shapes = TRUE,
        .blurb = "C_N of the cloth in this wind; at any value no wind means no "
            "force; in a model that has air_drag give both the same"},
    {.name = "turbulence", .unit = "m/s", .null_value = 0.5, .min = 0.01, .max = 10,
        .prior = 0.3, .shapes = TRUE,
        .blurb = "Speed below which the force is in proportion to the wind, for "
            "air that is never still; about 1.6 times the standard deviation "
            "of its fluctuations"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* The process of variance 1 at multiples of this time; even in between. */
#define KNOT 0.01

typedef struct
{
  ClothLane before, after;      /* at knots next − 1 and next */
  guint64 next;
  ClothRandom random;
} Gust;

/* Draws the process up to the knot at or after the state's time, counted from the first frame. */
static ClothLane
draw (ClothLaneState * state, ClothLaneEffect * effect)
{
  Gust *gust = effect->state;
  ClothLane keep, kick;
  gdouble knots = MAX (state->time, 0.) / KNOT;

  if (gust->next && knots + 1. < (gdouble) gust->next)
    gust->next = 0;
  if (!gust->next) {
    cloth_random_init (&gust->random, state->seed);
    gust->before = gust->after =
        cloth_lane_set (cloth_random_gaussian (&gust->random));
  }
  if (!gust->next || knots > (gdouble) gust->next) {
    for (guint l = 0; l < CLOTH_N_LANES; l++) {
      gdouble share = exp (-KNOT / CLOTH_LANE_AT (&effect->p[1], l));

      CLOTH_LANE_AT (&keep, l) = (ClothReal) share;
      CLOTH_LANE_AT (&kick, l) = (ClothReal) sqrt (1. - share * share);
    }
    while (!gust->next || knots > (gdouble) gust->next) {
      gust->next++;
      gust->before = gust->after;
      gust->after = keep * gust->before +
          kick * cloth_lane_set (cloth_random_gaussian (&gust->random));
    }
  }
  return gust->after + (gust->after - gust->before) *
      cloth_lane_set (knots - (gdouble) gust->next);
}

static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane speed = effect->p[0] * draw (state, effect), wind[3];

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    gdouble azimuth = CLOTH_LANE_AT (&effect->p[2], l) * (G_PI / 180.);

    CLOTH_LANE_AT (&wind[0], l) = (ClothReal) cos (azimuth);
    CLOTH_LANE_AT (&wind[1], l) = (ClothReal) sin (azimuth);
  }
  wind[0] *= speed;
  wind[1] *= speed;
  wind[2] = cloth_lane_set (0.);
  CLOTH_LANE_NAME (cloth_lane_wind) (state, wind, effect->p[3], effect->p[4]);
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_gust) = {
  .order = CLOTH_LANE_ORDER_AIR,
  .fixed_size = sizeof (Gust),
  .force = force,
};
#endif
