/* frame_drop: Pictures that are lost.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] = { "sync_offset", NULL };

void
cloth_capture_frame_drop (const gdouble * values, ClothCapture * capture)
{
  if (values[0] != 0)
    capture->drop_rate = 1 - (1 - capture->drop_rate) * (1 - values[0]);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_frame_drop = {
  .id = "frame_drop",
  .side = CLOTH_EFFECT_CAMERA,
  .blurb =
      "Pictures are lost now and then, and the one before stands in for each.",
  .source =
      "Recorders that hold a constant rate repeat the last picture.",
  .regressor =
      "Single frames show the cloth of the frame before: the residual is the "
      "velocity times one interval, in bursts.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_REPEAT,
  .n_parameters = 1,
  .parameters = {
    {.name = "rate", .unit = "1", .null_value = 0, .min = 0, .max = 0.9,
        .prior = 0.02, .one_sided = TRUE,
        .blurb = "Share of the pictures that are lost, each by itself"},
  }
};
/* *INDENT-ON* */
