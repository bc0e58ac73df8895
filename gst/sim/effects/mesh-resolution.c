/* The size of the triangles.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

static const gchar *const confusions[] = {
  "bending", "mesh_diagonals", "time_step",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_mesh_resolution = {
  .id = "mesh_resolution",
  .side = CLOTH_EFFECT_NUMERICS,
  .blurb =
      "The mesh is finer: its edges are halved once or twice.",
  .source =
      "Compare h with h/2.",
  .regressor =
      "Folds finer than the mesh, and a coarse mesh’s false stiffness "
      "in bending and shear.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_TRIAL,
  .untested =
      "It is part of the simulator’s own error, which is projected out.",
  .n_parameters = 1,
  .parameters = {
    {.name = "factor", .unit = "1", .null_value = 1, .min = 1, .max = 4,
        .prior = 1, .one_sided = TRUE, .n_tried = 1, .tried = {2},
        .blurb = "How many times as many edges lie along a length: 1, 2 or 4"},
  }
};
/* *INDENT-ON* */
