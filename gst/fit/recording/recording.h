/* Recordings made ready for a fit: what nobody saw is filled in, velocities and noise are
 * estimated, and what can't be a recording of this cloth is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/correction.h"
#include "gst/fit/recording/imitation.h"
#include "gst/fit/recording/interpolation.h"
#include "gst/fit/recording/noise.h"
#include "gst/fit/recording/observations.h"
#include "gst/fit/recording/outliers.h"
#include "gst/fit/recording/paths.h"
#include "gst/fit/recording/plausibility.h"
#include "gst/fit/recording/rays.h"
#include "gst/fit/recording/recording-type.h"
#include "gst/fit/recording/signal.h"
#include "gst/fit/recording/twin.h"
#include "gst/fit/recording/start.h"
#include "gst/fit/recording/views.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

ClothRecording *cloth_recording_new (ClothTake * take, GError ** error);
gint cloth_recording_find_frame (const ClothRecording * recording,
    gdouble time);
guint cloth_recording_find_between (const ClothRecording * recording,
    gdouble time, guint frame, gdouble * share);
void cloth_recording_find_silhouettes (const ClothRecording * recording,
    const ClothObservations * observations, guint camera, gint * pictures);
gsize cloth_recording_remove_torn (ClothRecording * recording);
ClothRecording *cloth_recording_resample (const ClothRecording * recording,
    guint most);

G_END_DECLS
