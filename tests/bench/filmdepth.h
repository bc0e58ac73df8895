/* The depth of a cloth out of the pictures of three rectified cameras on a line, as benchmarks
 * of disparities and of what stands on them need it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/cv.h"
#include "gst/vision/disparity/disparity.h"

G_BEGIN_DECLS

/* @map: states in, those of the mask; disparities of the middle picture
 * @pool: two threads
 *
 * Disparities of 32 to 160 px.
 */
typedef struct
{
  gint width, height;
  ClothDisparityMap map;
  ClothPool *pool;
  ClothCvStereo *stereo;
  ClothDisparity *surface;
  ClothRefine *refine;
  gint16 *found[2];
  guint8 *mirrored[2];
} FilmDepth;

void film_depth_init (FilmDepth * depth, gint width, gint height);
void film_depth_clear (FilmDepth * depth);

ClothDisparityParams film_depth_sixteenths (void);
ClothDisparityParams film_depth_polish (void);

void film_depth_match (FilmDepth * depth, const guint8 * const pictures[3]);
void film_depth_merge (FilmDepth * depth, guint n_pairs);
void film_depth_fill (FilmDepth * depth, const ClothDisparityParams * params);
void film_depth_smooth (FilmDepth * depth, const ClothDisparityParams * params);
void film_depth_refine (FilmDepth * depth, const guint8 * const pictures[3]);

G_END_DECLS
