/* Cloth that touches itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "friction", "bending",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_self_contact = {
  .id = "self_contact",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Parts of the cloth that are not neighbours keep a distance.",
  .source =
      "Thickness of cloth, 0.5 to 3 mm; Bridson, Fedkiw and Anderson, "
      "ACM Transactions on Graphics 21(3), 2002.",
  .regressor =
      "Pairs of equal and opposite forces along the normal where two "
      "parts of the cloth are as near as its thickness.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "thickness", .unit = "m", .null_value = 0, .min = 0, .max = 0.01,
        .prior = 0.001, .one_sided = TRUE,
        .blurb = "Distance that parts keep; 0 lets them pass through each other"},
  }
};
/* *INDENT-ON* */
#endif
