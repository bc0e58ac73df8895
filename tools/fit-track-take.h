/* What trackers saw, as a take that a cloth is fitted to.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/rig.h"
#include "gst/vision/mask/mask.h"
#include "gst/vision/track/flat.h"
#include "gst/vision/track/tracker.h"

G_BEGIN_DECLS

/* @folder: of the take
 * @columns: of the grid
 * @rows: of it
 * @held: (array zero-terminated=0): vertices that hands hold, whose paths nobody knows
 * @n_held: how many
 */
typedef struct {
  const gchar *folder;
  guint columns, rows;
  const guint *held;
  guint n_held;
} FitTrackTakeOptions;

typedef struct _FitTrackTake FitTrackTake;

FitTrackTake *fit_track_take_new (const FitTrackTakeOptions * options,
    const ClothRig * rig, const ClothFlatPose * pose);
void fit_track_take_free (FitTrackTake * take);
gboolean fit_track_take_check (const gchar * folder, GError ** error);
gboolean fit_track_take_add (FitTrackTake * take, gdouble time_s,
    const ClothTrackedFeature * features, guint n_features,
    const GArray * const *silhouettes, GError ** error);
gboolean fit_track_take_write (FitTrackTake * take, GError ** error);

G_END_DECLS
