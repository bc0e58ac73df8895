/* Saddle points of image intensity: the corners of a checkerboard.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* The most refined saddles, and the most candidates, that one picture may give. */
#define CLOTH_SADDLE_MAX 65536

/* @x: column of the saddle, px, centre of the top-left pixel at 0
 * @y: row of the saddle, px
 * @response: −Det of the Hessian of the smoothed intensity there, grey levels² / px⁴
 * @axis: angle in [0, π) of the axis along which the intensity has its *maximum curvature
 *   upwards*, i.e. the bisector that runs through the two bright quadrants, radians,
 *   from +x towards +y
 * @cov: covariance xx, xy, yy of (@x, @y), px²
 */
typedef struct {
  gfloat x, y;
  gfloat response;
  gfloat axis;
  gfloat cov[3];
} ClothSaddle;

/* A pixel with Det(I * G) < -epsilon: where a corner may be put (paper 3.4). Its place is
 * whole in the picture that was searched, and need not be in one that was scaled since. */
typedef struct {
  gfloat x, y;
  gfloat response;
} ClothSaddleCandidate;

/* @CLOTH_SADDLE_REFINE_NONE: candidates only
 * @CLOTH_SADDLE_REFINE_STREAM: the saddle of the smoothed intensity, by Newton's method
 * @CLOTH_SADDLE_REFINE_MODEL: after that a fit of the corner model of
 *   gst/vision/corner/corner.h; slower and more exact
 *
 * How the sub-pixel position is found.
 */
typedef enum {
  CLOTH_SADDLE_REFINE_NONE,
  CLOTH_SADDLE_REFINE_STREAM,
  CLOTH_SADDLE_REFINE_MODEL
} ClothSaddleRefine;

/* @sigma: width of the Gaussian that smooths the picture, px, 0.5 to 5
 * @epsilon: a pixel is a candidate when the determinant of the Hessian is below
 *   −@epsilon, grey levels² / px⁴, >= 0
 * @relative: the same bound as a share of the response that a sharp corner with the
 *   picture's own contrast (5th to 95th percentile) would have, 0 to 1; the larger of
 *   both bounds holds
 * @roi_x: left column of the region searched
 * @roi_y: top row of the region searched
 * @roi_width: columns searched, 0: all
 * @roi_height: rows searched, 0: all
 * @refine: how the sub-pixel position is found
 * @radius: window radius of the model fit, px, 2 to 12; no more than half the distance to
 *   the next saddle is used. On bent cloth 4 to 5 px is best, on a flat board 8 to 10
 * @max_candidates: when more pixels than this pass, the strongest are listed, at most
 *   %CLOTH_SADDLE_MAX; refined saddles are not affected
 * @max_saddles: the most refined saddles, at most %CLOTH_SADDLE_MAX
 *
 * Values out of range are brought into it; the region is cut to the picture.
 */
typedef struct {
  gfloat sigma;
  gfloat epsilon;
  gfloat relative;
  gint roi_x, roi_y, roi_width, roi_height;
  ClothSaddleRefine refine;
  gfloat radius;
  guint max_candidates;
  guint max_saddles;
} ClothSaddleParams;

typedef struct _ClothSaddleDetector ClothSaddleDetector;

ClothSaddleParams cloth_saddle_default_params (void);

ClothSaddleDetector *cloth_saddle_detector_new (void);
void cloth_saddle_detector_free (ClothSaddleDetector * detector);

void cloth_saddle_detector_run (ClothSaddleDetector * detector,
    const ClothSaddleParams * params, const ClothImage * image,
    ClothSimd level);

const ClothSaddleCandidate
    * cloth_saddle_detector_get_candidates (const ClothSaddleDetector *
    detector, guint * n_candidates);
const ClothSaddle *cloth_saddle_detector_get_saddles (const
    ClothSaddleDetector * detector, guint * n_saddles);
gboolean cloth_saddle_detector_was_cut (const ClothSaddleDetector * detector);
gfloat cloth_saddle_detector_get_epsilon (const ClothSaddleDetector *
    detector);
gfloat cloth_saddle_detector_get_noise (const ClothSaddleDetector * detector);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSaddleDetector, cloth_saddle_detector_free)
G_END_DECLS
