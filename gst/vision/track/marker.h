/* A point of the cloth in space: where the rays of several cameras meet.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* @origin: the camera's centre, m, world
 * @direction: unit vector towards what it sees
 */
typedef struct {
  gdouble origin[3];
  gdouble direction[3];
} ClothRay;

/* @distance: greatest shortest distance of any two of the rays, m (0.005)
 * @spread: greatest standard deviation of the midpoints along each axis of the world, m
 *   (0.005); looked at from three rays on
 * @angle: rays that enclose less than this are parallel, rad (0.02)
 */
typedef struct {
  gdouble distance, spread, angle;
} ClothMarkerParams;

/* @CLOTH_MARKER_FOUND: there is a marker
 * @CLOTH_MARKER_FEW: fewer than two rays
 * @CLOTH_MARKER_PARALLEL: no two rays enclose an angle
 * @CLOTH_MARKER_BEHIND: two rays come nearest behind a camera
 * @CLOTH_MARKER_DISTANT: two rays are too far from each other
 * @CLOTH_MARKER_SPREAD: the midpoints are too far from each other
 *
 * What came of some rays.
 */
typedef enum {
  CLOTH_MARKER_FOUND,
  CLOTH_MARKER_FEW,
  CLOTH_MARKER_PARALLEL,
  CLOTH_MARKER_BEHIND,
  CLOTH_MARKER_DISTANT,
  CLOTH_MARKER_SPREAD
} ClothMarkerResult;

/* @position: mean of the midpoints, m, world
 * @distance: greatest shortest distance of two rays, m
 * @spread: greatest standard deviation of the midpoints along an axis, m; 0 of one midpoint
 * @n_pairs: pairs of rays that are not parallel
 */
typedef struct {
  gdouble position[3];
  gdouble distance, spread;
  guint n_pairs;
} ClothMarker;

ClothMarkerParams cloth_marker_default_params (void);
gboolean cloth_marker_cast (const ClothCamera * camera, const gdouble px[2],
    ClothRay * ray);
ClothMarkerResult cloth_marker_find (const ClothMarkerParams * params, guint n,
    const ClothRay * rays, ClothMarker * marker);

G_END_DECLS
