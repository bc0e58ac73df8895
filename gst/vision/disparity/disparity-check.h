/* Sizes that can be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/disparity/disparity.h"

G_BEGIN_DECLS

static inline gboolean
cloth_disparity_check_size (gint width, gint height, gint stride,
    GError ** error)
{
  if (width >= 1 && height >= 1 && width <= CLOTH_DISPARITY_MAX_SIZE
      && height <= CLOTH_DISPARITY_MAX_SIZE && stride >= width)
    return TRUE;
  g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP,
      "A map of %d × %d disparities, %d from row to row: make it 1 × 1 to %d "
      "× %d, with rows of at least the width", width, height, stride,
      CLOTH_DISPARITY_MAX_SIZE, CLOTH_DISPARITY_MAX_SIZE);
  return FALSE;
}

G_END_DECLS
