/* extrinsic_drift: A camera that was turned after its calibration.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

#include <string.h>

#include "gst/math/linalg.h"
#include "gst/rig/rotation.h"

static const gchar *const confusions[] =
    { "focal_length", "gravity_tilt", NULL };

void
cloth_capture_extrinsic_drift (const gdouble * values, ClothCapture * capture)
{
  ClothCamera *camera = &capture->camera;
  gdouble D[9], R[9], t[3];

  if (values[0] == 0 && values[1] == 0 && values[2] == 0)
    return;
  cloth_rotation_from_vector (values, D);
  cloth_mat3_mul_tn (D, camera->R, R);
  cloth_mat3_vec_t (D, camera->t, t);
  memcpy (camera->R, R, sizeof R);
  memcpy (camera->t, t, sizeof t);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_extrinsic_drift = {
  .id = "extrinsic_drift",
  .side = CLOTH_EFFECT_CAMERA,
  .blurb =
      "The camera has turned since it was calibrated, as by a touch or a "
      "warming stand.",
  .source =
      "A turn of 1 mrad moves the picture by 1.4 px at a focal length of "
      "1,400 px.",
  .regressor =
      "All points of one camera are off by nearly the same number of pixels, "
      "moving or not; rays of different cameras miss each other.",
  .confusions = confusions,
  .n_parameters = 3,
  .parameters = {
    {.name = "tilt", .unit = "rad", .null_value = 0, .min = -0.2, .max = 0.2,
        .prior = 0.002,
        .blurb = "Turn about the camera's x axis: positive looks up"},
    {.name = "pan", .unit = "rad", .null_value = 0, .min = -0.2, .max = 0.2,
        .prior = 0.002,
        .blurb = "Turn about its y axis: positive looks right"},
    {.name = "roll", .unit = "rad", .null_value = 0, .min = -0.2, .max = 0.2,
        .prior = 0.002,
        .blurb =
            "Turn about its line of sight: positive turns the picture "
            "counter-clockwise"},
  }
};
/* *INDENT-ON* */
