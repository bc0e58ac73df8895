/* A map of disparities: what each pixel of a cloth has, and how it came to it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Largest width and height of a map, px, and the most pixels of it: each takes about 70 bytes
 * of memory. */
#define CLOTH_DISPARITY_MAX_SIZE 16384
#define CLOTH_DISPARITY_MAX_AREA (4096 * 4096)

/* The greatest disparity, px: what is beyond counts as unknown. */
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
 * @height: rows, 1 to %CLOTH_DISPARITY_MAX_SIZE; at most %CLOTH_DISPARITY_MAX_AREA pixels
 * @stride: elements from one row to the next of either, >= @width
 *
 * A view of a map; owns nothing.
 */
typedef struct {
  gfloat *disparities;
  guint8 *states;
  gint width, height, stride;
} ClothDisparityMap;

gboolean cloth_disparity_check_size (gint width, gint height, gint stride,
    GError ** error);

G_END_DECLS
