/* How one camera takes its pictures: its calibration, and what a calibration doesn't
 * tell. The camera and image effects change it; what it then makes of moving points is
 * predicted here, what it makes of a whole cloth is drawn by gst/render/render.c.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/camera.h"
#include "gst/effect/effect.h"
#include "gst/rig/motion.h"

G_BEGIN_DECLS

/* @contrast: bright minus dark, grey levels
 * @noise: standard deviation of a pixel without any effect, grey levels
 * @blur_px: standard deviation of the picture's blur without any effect, px
 * @window_px: half the side of the window that a point is refined in, px
 * @dot_radius_m: radius of the dots whose centres are measured, m; 0 for corners
 *
 * What is looked for in the pictures, and how: it decides what blur, noise and shading do
 * to a measured point.
 */
typedef struct {
  gdouble contrast;
  gdouble noise;
  gdouble blur_px;
  gdouble window_px;
  gdouble dot_radius_m;
} ClothCaptureTarget;

/* @camera: the camera as it really is; its strings are %NULL
 * @exposure_s: how long the shutter is open, from the frame's time on, s
 * @drop_rate: share of the pictures that are lost; the one before stands in for them
 * @defocus_px: standard deviation of the Gaussian point spread, px
 * @light_gradient: relative change of the light along a row and down a column, 1/px
 * @crosstalk: share of each colour channel that is taken from the two others
 * @read_noise: standard deviation in black, grey levels
 * @shot_noise: standard deviation that light adds in full white, grey levels; its square
 *   grows with the light
 * @target: what is looked for in the pictures
 *
 * A picture of time T shows at row y (of h) the cloth of time
 * T − camera.offset_s + camera.rolling_shutter_s·y/(h − 1), and of the @exposure_s from
 * then on.
 */
typedef struct {
  ClothCamera camera;
  gdouble exposure_s;
  gdouble drop_rate;
  gdouble defocus_px;
  gdouble light_gradient[2];
  gdouble crosstalk;
  gdouble read_noise;
  gdouble shot_noise;
  ClothCaptureTarget target;
} ClothCapture;

/* What each effect changes in a capture; null @values leave every bit of it as it is. */
#define CAPTURE(name) \
    void cloth_capture_##name (const gdouble * values, ClothCapture * capture);
#include "gst/effect/list.h"

void cloth_capture_init (ClothCapture * capture, const ClothCamera * camera);

gboolean cloth_capture_add_effect (ClothCapture * capture, const gchar * id,
    const gdouble * values, GError ** error);
gboolean cloth_capture_add_effects (ClothCapture * capture,
    const gchar * text, GError ** error);

gboolean cloth_capture_is_dropped (const ClothCapture * capture,
    guint64 frame, guint64 seed);
gboolean cloth_capture_project (const ClothCapture * capture,
    const ClothMotion * motion, guint n_parents, const guint * parents,
    const gdouble * weights, gdouble time_s, gdouble px[2], gdouble seen[3]);
guint cloth_capture_observe (const ClothCapture * capture,
    const ClothMotion * motion, gdouble time_s, gdouble * px,
    gdouble * covariances);

G_END_DECLS
