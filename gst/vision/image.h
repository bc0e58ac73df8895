/* A view of an 8-bit grey picture; owns nothing.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @data: (not nullable): top-left pixel
 * @width: pixels a row, >= 1
 * @height: rows, >= 1
 * @stride: bytes from one row to the next, >= @width
 *
 * The luma plane of a frame. The centre of the top-left pixel is (0, 0).
 */
typedef struct {
  const guint8 *data;
  gint width;
  gint height;
  gint stride;
} ClothImage;

G_END_DECLS
