/* Disparities of a cloth: out of one or two baselines, without holes, with a fraction.
 *
 * The order is cloth_disparity_check () of each baseline, cloth_disparity_merge (),
 * cloth_disparity_fill (), cloth_disparity_smooth ().
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/math/simd.h"

G_BEGIN_DECLS

/* Largest width and height of a map, px, and the greatest disparity: what is beyond counts
 * as unknown. */
#define CLOTH_DISPARITY_MAX_SIZE 16384
#define CLOTH_DISPARITY_MOST 32767

/* @CLOTH_DISPARITY_ERROR_MAP: sizes or strides that can't be
 * @CLOTH_DISPARITY_ERROR_PARAMETER: a parameter is out of its range
 */
typedef enum {
  CLOTH_DISPARITY_ERROR_MAP,
  CLOTH_DISPARITY_ERROR_PARAMETER
} ClothDisparityError;

#define CLOTH_DISPARITY_ERROR (cloth_disparity_error_quark ())
GQuark cloth_disparity_error_quark (void);

/* @CLOTH_DISPARITY_OUTSIDE: not of the cloth's mask
 * @CLOTH_DISPARITY_HOLE: of the mask, but without a disparity
 * @CLOTH_DISPARITY_MEASURED: with a measured one
 * @CLOTH_DISPARITY_FILLED: with one that follows from those around
 */
typedef enum {
  CLOTH_DISPARITY_OUTSIDE,
  CLOTH_DISPARITY_HOLE,
  CLOTH_DISPARITY_MEASURED,
  CLOTH_DISPARITY_FILLED
} ClothDisparityState;

/* @disparities: (not nullable): of the top-left pixel, px; NaN where there is none
 * @states: (not nullable): a ClothDisparityState of each; any other number counts as
 *   %CLOTH_DISPARITY_MEASURED, so that a mask will do
 * @width: pixels a row, 1 to %CLOTH_DISPARITY_MAX_SIZE
 * @height: rows, 1 to %CLOTH_DISPARITY_MAX_SIZE
 * @stride: elements from one row to the next of either, >= @width
 *
 * A view of a map; owns nothing.
 */
typedef struct {
  gfloat *disparities;
  guint8 *states;
  gint width, height, stride;
} ClothDisparityMap;

/* ---- baselines ---- */

/* @disparities: (not nullable): of the left picture of a rectified pair, 1/@steps px
 * @width: pixels a row
 * @height: rows
 * @stride: elements from one row to the next, >= @width
 * @steps: steps of one pixel, 1 to 256
 * @none: what stands for no disparity
 * @place: a homography, by rows: from pixels of the map to pixels of this picture. Mirrored
 *   pictures (the other camera lies to the left) and those whose rows are columns (it lies
 *   above or below) are such too
 * @unit: disparities of this pair times @unit[0]·x + @unit[1]·y + @unit[2] are disparities
 *   of the first pair at the map's pixel (x, y). Pairs that are turned alike: 0, 0 and the
 *   ratio of focal length times baseline, of the first over this. Else the first two say by
 *   how much its depth, along another axis, is another one
 * @offset: added before, px: of rectified pictures with unlike principal points
 */
typedef struct {
  const gint16 *disparities;
  gint width, height, stride;
  gint steps;
  gint16 none;
  gdouble place[9], unit[3];
  gdouble offset;
} ClothDisparityPair;

/* @least: share of the disparities of a pair that lie within a pixel of the least that was
 *   looked for
 * @most: of the greatest
 *
 * Much of either says that the range is too small.
 */
typedef struct {
  gdouble least, most;
} ClothDisparityBorder;

ClothDisparityPair cloth_disparity_pair (const gint16 * disparities,
    gint width, gint height);
gboolean cloth_disparity_check (gint16 * left, const gint16 * right,
    gint width, gint height, gint16 none, gint most, GError ** error);
gboolean cloth_disparity_border (const ClothDisparityPair * pair, gint least,
    gint range, ClothDisparityBorder * border, GError ** error);
gboolean cloth_disparity_merge (const ClothDisparityPair * pairs,
    guint n_pairs, gdouble most, ClothDisparityMap * map, GError ** error);

/* ---- surfaces ---- */

/* @step: greatest difference of neighbours on one surface, px, 1e-6 to
 *   %CLOTH_DISPARITY_MOST; more is an edge of depth
 * @hole: pixels of the largest hole that is filled
 * @tolerance: of the filling's equations, relative to their right side, 1e-7 to 1
 * @half_width: how far a measured disparity may be moved, px, 0 to 64: half of the quantum
 *   and the noise. The paper's 0.5 is for whole numbers
 * @narrowing: factor of the half-width each time the picture is halved, 0.1 to 1. The error
 *   of whole numbers is that of a whole stair, as large after blurring: 1. Noise grows less
 * @sweeps: how often each level of the pyramid is relaxed, 0 to 10000
 * @relaxation: factor of a correction, 0.01 to 1.99
 *
 * Of the sixteenths of cloth_cv_stereo_run () a half-width of 0.4 px with a narrowing of 0.7
 * came out best (film of a rendered cloth at 18 mm a pixel). With a narrowing of 1 that is
 * 0.2 px: wider bounds flatten folds.
 */
typedef struct {
  gdouble step;
  guint hole;
  gdouble tolerance;
  gdouble half_width, narrowing;
  guint sweeps;
  gdouble relaxation;
} ClothDisparityParams;

typedef struct _ClothDisparity ClothDisparity;

ClothDisparityParams cloth_disparity_default_params (void);
ClothDisparity *cloth_disparity_new (void);
void cloth_disparity_free (ClothDisparity * self);
gboolean cloth_disparity_fill (ClothDisparity * self,
    const ClothDisparityParams * params, ClothDisparityMap * map,
    ClothPool * pool, ClothSimd level, GError ** error);
gboolean cloth_disparity_smooth (ClothDisparity * self,
    const ClothDisparityParams * params, ClothDisparityMap * map,
    ClothPool * pool, ClothSimd level, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothDisparity, cloth_disparity_free)
G_END_DECLS
