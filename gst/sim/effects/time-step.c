/* The time step.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

static const gchar *const confusions[] = {
  "damping_stiffness", "mesh_resolution",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_time_step = {
  .id = "time_step",
  .side = CLOTH_EFFECT_NUMERICS,
  .blurb =
      "The simulator’s time step is multiplied by a factor.",
  .source =
      "The step alone moved a swaying sheet by 15 mm; compare h with "
      "h/4.",
  .regressor =
      "Damping of high modes that changes with the step, unlike "
      "damping_stiffness.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_TRIAL,
  .untested =
      "It is part of the simulator’s own error, which is projected out.",
  .n_parameters = 1,
  .parameters = {
    {.name = "factor", .unit = "1", .null_value = 1, .min = 1. / 64, .max = 64,
        .prior = 0.5, .n_tried = 1, .tried = {0.5},
        .blurb = "What the time step is multiplied with; an explicit step beyond "
            "the stable one is cut back to it, an automatic one to a frame"},
  }
};
/* *INDENT-ON* */
