/* How squares are cut into triangles.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

static const gchar *const confusions[] = {
  "shear", "mesh_resolution",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_mesh_diagonals = {
  .id = "mesh_diagonals",
  .side = CLOTH_EFFECT_NUMERICS,
  .blurb =
      "Squares of the mesh are cut along other diagonals: 0 leaves "
      "them (in a grid they alternate), 1 takes the other diagonal of each, "
      "2 lets all of a grid run the same way.",
  .source =
      "The diagonals alone moved a swaying sheet by 43 mm.",
  .regressor =
      "Forces within the plane in proportion to shear, of a sign that "
      "the direction of the diagonals sets.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_TRIAL,
  .untested =
      "It is part of the simulator’s own error, which is projected out.",
  .n_parameters = 1,
  .parameters = {
    {.name = "pattern", .unit = "1", .null_value = 0, .min = 0, .max = 2,
        .prior = 1, .one_sided = TRUE, .n_tried = 1, .tried = {1},
        .blurb = "0, 1 or 2"},
  }
};
/* *INDENT-ON* */
