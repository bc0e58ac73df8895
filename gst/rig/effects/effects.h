/* The camera and image effects: what each is, and what it changes in a capture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/capture.h"

G_BEGIN_DECLS

/* @apply leaves every bit of the capture as it is when all @values are null. */
typedef struct {
  ClothEffect effect;
  void (*apply) (const gdouble * values, ClothCapture * capture);
} ClothCaptureEffect;

extern const ClothCaptureEffect cloth_capture_lens_distortion,
    cloth_capture_focal_length, cloth_capture_extrinsic_drift,
    cloth_capture_sync_offset, cloth_capture_rolling_shutter,
    cloth_capture_frame_drop, cloth_capture_motion_blur,
    cloth_capture_defocus, cloth_capture_shading_shift,
    cloth_capture_colour_crosstalk, cloth_capture_noise;

G_END_DECLS
