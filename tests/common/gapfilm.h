/* What a ring of cameras sees of a recorded sheet, and takes that have nothing else.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

/* @n_cameras: on a circle of 1.5 m about the cloth's middle, at two heights
 * @noise_px: standard deviation of each coordinate
 * @hidden: whether a camera sees a vertex not; %NULL: all see all
 * @late_s: by how much each camera's pictures are after the frames, NULL: not at all
 */
typedef struct {
  guint n_cameras;
  gdouble noise_px;
  gboolean (*hidden) (guint camera, guint vertex, guint frame);
  const gdouble *late_s;
} TestGapFilming;

ClothRig *test_gap_ring (guint n_cameras, const gdouble middle[3]);
/* The pictures of @positions, [n_frames][n][3], through cameras @rig has not been told the truth
 * of: they are as @truth says. */
ClothObservations *test_gap_film (const ClothRig * rig, const ClothRig * truth,
    const gdouble * positions, const gdouble * times, guint n_frames, guint n,
    const TestGapFilming * filming, guint64 seed);
/* Reads all positions of a take. */
gdouble *test_gap_positions (ClothTake * take);
/* Takes its positions away, but for the first frame's if @keep_start, and opens it again. */
ClothTake *test_gap_forget_positions (ClothTake * take, gboolean keep_start);

G_END_DECLS
