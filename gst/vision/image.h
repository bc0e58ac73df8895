/* Views of 8-bit pictures, grey and in colour; they own nothing.
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

/* @luma: the picture's luma, or a grey picture
 * @chroma: (nullable): top-left Cb and Cr sample; %NULL for a grey picture
 * @chroma_stride: bytes from one chroma row to the next
 * @chroma_step: bytes from one chroma sample to the next in a row: 1 for planes of their
 *   own, 2 for NV12
 * @chroma_shift: chroma is halved this many times across and down: 1, 1 for 4:2:0
 *
 * A view of a planar picture; owns nothing.
 */
typedef struct {
  ClothImage luma;
  const guint8 *chroma[2];
  gint chroma_stride;
  gint chroma_step;
  gint chroma_shift[2];
} ClothPlanarImage;

G_END_DECLS
