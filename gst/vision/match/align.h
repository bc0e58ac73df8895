/* Where a film shows a place of a flat picture, as exactly as the print around it tells.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/vision/image.h"
#include "gst/vision/match/planes.h"
#include "gst/vision/match/stretch.h"
#include "gst/vision/match/warp.h"

G_BEGIN_DECLS

/* Largest half edge of a window, px. */
#define CLOTH_ALIGN_MAX_RADIUS 31

/* @radius: of the window, px: it is 2·@radius + 1 wide and high, 3 to 31
 * @bend: standard deviation of half the second derivatives of places in the film, by which
 *   the cloth's bending and perspective show, 1/px
 * @blur: of the film, standard deviation, px
 * @reference_blur: of the flat picture, px of it
 * @outlier: a pixel that differs by so many standard deviations counts half
 * @rounds: most steps towards the place
 * @done: a step so short is the last one, px
 * @shift: farther from where it was looked for it isn't taken, px
 * @likeness: least share of the window's variance that the print explains, outliers aside,
 *   0 to 1
 * @all: the same of all pixels
 * @contrast: least standard deviation of a window, grey levels
 * @share: least share of the window that counts, 0 to 1
 * @centre: by which factor the variance of the differences in the middle may be above that
 *   of the window; beyond, something hides the place
 * @model: share of the bending over half the window by which a place may be off beyond what
 *   second order tells: a sharp crease at the place would be 3/16
 * @correlation: by which factor the variance of a place is larger than of differences that
 *   know nothing of one another
 * @floor: standard deviation that is left of a place in the sharpest picture, px
 * @depth_step: by more than this between neighbouring pixels the surface is broken, m
 */
typedef struct {
  gint radius;
  gdouble bend, blur, reference_blur, outlier;
  guint rounds;
  gdouble done, shift;
  gdouble likeness, all, contrast, share, centre;
  gdouble model, correlation, floor, depth_step;
} ClothAlignParams;

/* @film: the picture
 * @mask: (nullable): where it isn't 0 the film shows cloth, of the film's size
 * @surface: (nullable): under the film's pixels
 */
typedef struct {
  const ClothImage *film, *mask;
  const ClothMatchSurface *surface;
} ClothAlignView;

/* @at: column and row in the film, px
 * @xx: covariance, px²
 * @xy: covariance
 * @yy: covariance
 * @likeness: share of the window's variance that the print explains
 * @noise: standard deviation of the differences, grey levels
 */
typedef struct {
  gdouble at[2];
  gdouble xx, xy, yy;
  gdouble likeness, noise;
} ClothAlignment;

/* @CLOTH_ALIGN_FOUND: the film shows the print there
 * @CLOTH_ALIGN_PLAIN: there is too little print to tell
 * @CLOTH_ALIGN_UNLIKE: the film shows something else
 */
typedef enum {
  CLOTH_ALIGN_FOUND,
  CLOTH_ALIGN_PLAIN,
  CLOTH_ALIGN_UNLIKE
} ClothAlignResult;

typedef struct _ClothAligner ClothAligner;

ClothAlignParams cloth_align_default_params (void);
ClothAlignParams cloth_align_clamp_params (const ClothAlignParams * params);
ClothAligner *cloth_aligner_new (void);
void cloth_aligner_free (ClothAligner * aligner);
ClothAlignResult cloth_align_run (ClothAligner * aligner,
    const ClothAlignParams * params, const ClothPlanes * print,
    const ClothAlignView * view, const gdouble place[2], ClothWarp * warp,
    ClothAlignment * alignment, ClothSimd level);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothAligner, cloth_aligner_free)
G_END_DECLS
