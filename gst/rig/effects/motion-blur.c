/* motion_blur: A shutter that stays open.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] =
    { "sync_offset", "defocus", "clamp_delay", NULL };

void
cloth_capture_motion_blur (const gdouble * values, ClothCapture * capture)
{
  capture->exposure_s += values[0];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_motion_blur = {
  .id = "motion_blur",
  .side = CLOTH_EFFECT_IMAGE,
  .blurb =
      "The shutter is open for a while from the frame's time on, and a moving "
      "point is smeared.",
  .source =
      "The middle of a streak lies half the exposure later; its spread is "
      "that of a uniform distribution.",
  .regressor =
      "The residual is the velocity times half the exposure, and points that "
      "move fast across the picture scatter more along their way.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "exposure", .unit = "s", .null_value = 0, .min = 0, .max = 0.1,
        .prior = 0.01, .one_sided = TRUE,
        .blurb = "How long the shutter is open"},
  }
};
/* *INDENT-ON* */
