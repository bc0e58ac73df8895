/* Maps that can be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/map.h"

GQuark
cloth_disparity_error_quark (void)
{
  return g_quark_from_static_string ("cloth-disparity-error-quark");
}

/* @width: pixels a row
 * @height: rows
 * @stride: elements from row to row
 * @error: (out): set to %CLOTH_DISPARITY_ERROR_MAP
 *
 * Returns: %FALSE if there is no such map
 */
gboolean
cloth_disparity_check_size (gint width, gint height, gint stride,
    GError ** error)
{
  if (width >= 1 && height >= 1 && width <= CLOTH_DISPARITY_MAX_SIZE
      && height <= CLOTH_DISPARITY_MAX_SIZE
      && width * height <= CLOTH_DISPARITY_MAX_AREA && stride >= width)
    return TRUE;
  g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP,
      "A map of %d × %d disparities, %d from row to row: make it 1 × 1 to %d "
      "× %d, %d pixels at most, with rows of at least the width", width,
      height, stride, CLOTH_DISPARITY_MAX_SIZE, CLOTH_DISPARITY_MAX_SIZE,
      CLOTH_DISPARITY_MAX_AREA);
  return FALSE;
}
