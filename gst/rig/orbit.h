/* A camera that looks at something from a chosen side.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* @centre: what is looked at, m, world
 * @radius: of the sphere about it that is to fill the picture, m
 * @azimuth: where the camera stands, degrees counter-clockwise seen from above; 0 is
 *   at −y, 90 at +x
 * @elevation: degrees above the horizon, −90 to 90
 * @distance: from @centre, m; 0: so far that the sphere just fits into the picture
 *
 * A place on a sphere about what is looked at.
 */
typedef struct {
  gdouble centre[3];
  gdouble radius;
  gdouble azimuth, elevation, distance;
} ClothOrbit;

void cloth_orbit_init (ClothOrbit * orbit);
gboolean cloth_orbit_frame (ClothOrbit * orbit, guint n_points,
    const gdouble * points);
void cloth_orbit_camera (const ClothOrbit * orbit, gint width, gint height,
    ClothCamera * camera);

G_END_DECLS
