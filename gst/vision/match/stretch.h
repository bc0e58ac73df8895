/* How far apart two places of a cloth are along its surface, and how far apart that lets
 * them be on the flat cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @points: top-left point: x, y and z in metres, z away from the camera; NaN where the
 *   surface isn't known
 * @width: points a row
 * @height: rows
 * @stride: points from one row to the next, >= @width
 *
 * A view of the surface under each pixel of a picture; owns nothing.
 */
typedef struct {
  const gfloat *points;
  gint width, height, stride;
} ClothMatchSurface;

/* @stretch: k_s, by what share a distance on the cloth may be longer or shorter than on the
 *   flat cloth, 0 to 0.9
 * @slack: standard uncertainty of a distance in the picture, px, >= 0
 * @depth_step: by more than this between two samples 2 px apart the surface is broken, m
 * @hidden: most cloth that a break may hide, m, >= 0
 * @metres_per_pixel: without a surface: of cloth that faces the camera; 0: told by the
 *   scales of the features
 * @foreshortening: without a surface: how often longer a distance may be than it looks, >= 1
 *
 * Values out of range are brought into it.
 */
typedef struct {
  gdouble stretch, slack, depth_step, hidden;
  gdouble metres_per_pixel, foreshortening;
} ClothStretchParams;

/* @least: least distance on the flat cloth, m
 * @most: greatest, m
 * @broken: whether the surface is broken between the two: then what is hidden isn't known
 */
typedef struct {
  gdouble least, most;
  gboolean broken;
} ClothStretchRange;

ClothStretchParams cloth_stretch_default_params (void);
ClothStretchParams cloth_stretch_clamp_params (const ClothStretchParams *
    params);
gboolean cloth_surface_get_point (const ClothMatchSurface * surface,
    gdouble x, gdouble y, gdouble depth_step, gdouble point[3]);
gboolean cloth_surface_measure (const ClothMatchSurface * surface,
    const gfloat from[2], const gfloat to[2], gdouble depth_step,
    gdouble * length, gboolean * broken);
gboolean cloth_stretch_get_range (const ClothStretchParams * params,
    const ClothMatchSurface * surface, const gfloat from[2],
    const gfloat to[2], gdouble by_scale, ClothStretchRange * range);
gboolean cloth_stretch_get_least (const ClothStretchParams * params,
    const ClothMatchSurface * surface, const gfloat from[2],
    const gfloat to[2], gdouble by_scale, gdouble * least);

G_END_DECLS
