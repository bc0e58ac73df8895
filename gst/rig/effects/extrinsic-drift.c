/* extrinsic_drift: A camera that was turned after its calibration.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

#include <string.h>

#include "gst/math/linalg.h"
#include "gst/rig/rotation.h"

static const gchar *const confusions[] =
    { "focal_length", "gravity_tilt", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
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

const ClothCaptureEffect cloth_capture_extrinsic_drift = {
  {
        "extrinsic_drift",
        CLOTH_EFFECT_CAMERA,
        "The camera has turned since it was calibrated, as by a touch or a "
        "warming stand.",
        "A turn of 1 mrad moves the picture by 1.4 px at a focal length of "
        "1,400 px.",
        "All points of one camera are off by nearly the same number of "
        "pixels, moving or not; rays of different cameras miss each other.",
        confusions,
        3,
        {
              {"tilt", "rad", 0, -0.2, 0.2, 0.002, FALSE,
                  "Turn about the camera's x axis: positive looks up"},
              {"pan", "rad", 0, -0.2, 0.2, 0.002, FALSE,
                  "Turn about its y axis: positive looks right"},
              {"roll", "rad", 0, -0.2, 0.2, 0.002, FALSE,
                  "Turn about its line of sight: positive turns the picture "
                    "counter-clockwise"},
            }
      },
  apply
};
