/* The code of a coded checkerboard: dots that tell where on the board a patch lies.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"

G_BEGIN_DECLS

/* Least number of dots by which any two windows of a generated code differ, in all
 * rotations.
 */
#define CLOTH_CODE_DISTANCE 3

/* Default diameter of a dot over the edge of its square. A dot takes 7% of its square,
 * so the confidence of a black square that carries one is still 0.93.
 */
#define CLOTH_CODE_DOT_RATIO 0.3

gboolean cloth_code_generate (ClothPattern * pattern, gdouble dot_ratio,
    guint64 seed, gint * window, GError ** error);

G_END_DECLS
