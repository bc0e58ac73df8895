/* Start values of a calibration: each camera alone, then the cameras' places.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/bundle.h"

G_BEGIN_DECLS

gboolean cloth_calibrate_alone (ClothCamera * camera, guint n_views,
    const ClothBundleView * views, const gdouble * board, gdouble huber,
    guint max_iterations, gdouble * poses, gboolean * used, gdouble * excess,
    GCancellable * cancellable, GError ** error);
gboolean cloth_calibrate_place (ClothBundle * bundle, gdouble * view_poses,
    guint n_turns, const gdouble * turns, guint * turned, GError ** error);
guint cloth_calibrate_lens_bits (ClothLens lens);

G_END_DECLS
