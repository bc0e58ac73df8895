/* Threads that rub: tension that depends on the way there.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

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
        .prior = 0.01,
        .blurb = "Strain over which the tension builds up; without tension it "
            "means nothing"},
  }
};
/* *INDENT-ON* */
#endif
