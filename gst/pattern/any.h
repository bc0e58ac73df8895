/* A pattern.json of whichever kind.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/marray.h"
#include "gst/pattern/picture.h"

G_BEGIN_DECLS

/* @checker: (nullable): a checkerboard, plain or coded
 * @dots: (nullable): an M-array
 * @picture: (nullable): any print
 *
 * One of the three; the others are %NULL.
 */
typedef struct {
  ClothPattern *checker;
  ClothMArray *dots;
  ClothPicturePattern *picture;
} ClothAnyPattern;

ClothAnyPattern *cloth_any_pattern_load (const gchar * path, GError ** error);
void cloth_any_pattern_free (ClothAnyPattern * pattern);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothAnyPattern, cloth_any_pattern_free)
G_END_DECLS
