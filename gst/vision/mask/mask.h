/* Which pixels of a picture are not the background that is known.
 *
 * A plain cloth before a plain wall looks like a shadow on it, but for its chroma or for a
 * range of luma that the wall has not.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/math/simd.h"
#include "gst/vision/image.h"
#include "gst/vision/mask/runs.h"

G_BEGIN_DECLS

/* The widest window, px. */
#define CLOTH_MASK_MAX_RADIUS 7

/* Pictures that a background is learnt from: the last ones. */
#define CLOTH_MASK_SAMPLES 15

/* @radius: of the window that is held against the background, px, 1 to
 *   %CLOTH_MASK_MAX_RADIUS
 * @shadow: least light of the background in the film, as a share of that in its own
 *   picture, 0 to 1
 * @glow: greatest, 1 to 10
 * @significance: by how many standard deviations of noise the residual of a window must
 *   exceed its mean for another thing than the background, 0 to 1000
 * @thin: what is thinner than 2·@thin + 1 px is dropped, 0 to 32
 * @least: pieces of fewer pixels are dropped
 * @hole: holes of at most so many pixels are filled
 * @low: least luma, Cb and Cr of the cloth
 * @high: greatest
 * @disparities: (nullable): of each pixel, rows without gaps, px; NaN where there is none
 * @least_disparity: least of the cloth
 * @most_disparity: greatest
 *
 * Values out of range are brought into it. What is below @low or above @high is not cloth,
 * whatever the background; Cb and Cr of grey pictures are not looked at. With @disparities
 * what has none or one beyond the two isn't either.
 */
typedef struct {
  gint radius;
  gdouble shadow, glow, significance;
  gint thin;
  guint least, hole;
  gint low[3], high[3];
  const gfloat *disparities;
  gdouble least_disparity, most_disparity;
} ClothMaskParams;

typedef struct _ClothMask ClothMask;

ClothMaskParams cloth_mask_default_params (void);

ClothMask *cloth_mask_new (void);
void cloth_mask_free (ClothMask * mask);
void cloth_mask_set_background (ClothMask * mask,
    const ClothPlanarImage * image);
void cloth_mask_learn (ClothMask * mask, const ClothPlanarImage * image,
    ClothSimd level);
void cloth_mask_forget (ClothMask * mask);
gboolean cloth_mask_has_background (const ClothMask * mask,
    const ClothPlanarImage * image);
void cloth_mask_run (ClothMask * mask, const ClothMaskParams * params,
    const ClothPlanarImage * image, ClothPool * pool, ClothSimd level);

const ClothRun *cloth_mask_get_runs (const ClothMask * mask, guint * n_runs);
gboolean cloth_mask_was_cut (const ClothMask * mask);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothMask, cloth_mask_free)
G_END_DECLS
