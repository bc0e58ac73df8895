/* The features of the flat picture that is printed on a cloth, also as they look obliquely
 * and from behind.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/cv/cv.h"
#include "gst/math/pool.h"
#include "gst/vision/feature/nearest.h"

G_BEGIN_DECLS

/* Views of a side: the flat picture; squeezed to half across, down, along +45° and along
 * −45°; squeezed to a quarter, in the same order. */
#define CLOTH_REFERENCE_VIEWS 9

/* From which share of repeated features on a print counts as repeated: then a seed is more
 * likely than not to be put at the wrong place. */
#define CLOTH_REFERENCE_REPEATED 0.5

/* @sides: 1, or 2 where the print shows through or is on both: the back shows it mirrored
 * @oblique: 0: the flat view alone, 1: also the views of half, 2: also those of a quarter
 * @cloth_m: width and height of the picture on the cloth, metres, > 0
 * @least_scale: features of smaller scale are left out, px of the flat picture: a film that
 *   is coarser than the flat picture doesn't show them
 * @seed_scale: features of smaller scale are not compared with seeds, which are large
 * @sift: how features are found
 * @noise: of a film, standard deviation in grey levels, 0 to 64: what is as near to another
 *   place as to itself under this noise is repeated
 */
typedef struct {
  gint sides;
  gint oblique;
  gdouble cloth_m[2];
  gdouble least_scale, seed_scale;
  ClothCvSiftParams sift;
  gdouble noise;
} ClothReferenceParams;

/* @n: features
 * @width: of the flat picture, px
 * @height: of the flat picture, px
 * @x: (array length=n): columns in the flat picture, px
 * @y: (array length=n): rows, px
 * @scale: (array length=n): blur, px of the flat picture
 * @angle: (array length=n): radians from +x towards +y, in the flat picture
 * @view: (array length=n): 0 to %CLOTH_REFERENCE_VIEWS − 1
 * @side: (array length=n): 0, or 1 for those of the back
 * @descriptors: (array): @n times %CLOTH_CV_SIFT_BYTES
 *
 * Features of all views, merged.
 */
typedef struct {
  guint n;
  gint width, height;
  const gfloat *x, *y, *scale, *angle;
  const guint8 *view, *side;
  const guint8 *descriptors;
} ClothReferenceFeatures;

typedef struct _ClothReference ClothReference;

ClothReferenceParams cloth_reference_default_params (void);
ClothReference *cloth_reference_new (const ClothReferenceParams * params,
    const ClothCvPicture * picture, ClothPool * pool, GError ** error);
ClothReference *cloth_reference_new_from_features (const
    ClothReferenceFeatures * features, const gdouble cloth_m[2],
    gdouble seed_scale, GError ** error);
void cloth_reference_free (ClothReference * reference);

const ClothReferenceFeatures *cloth_reference_get_features (const
    ClothReference * reference);
gdouble cloth_reference_get_metres_per_pixel (const ClothReference *
    reference);
gdouble cloth_reference_get_repeated (const ClothReference * reference);
gdouble cloth_reference_find_repeated (const ClothReference * reference,
    guint32 distance, ClothPool * pool);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothReference, cloth_reference_free)
G_END_DECLS
