/* What OpenCV offers for the same tasks, for benchmarks and tests to compare with.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

typedef struct _ClothCvSaddle ClothCvSaddle;

ClothCvSaddle *cloth_cv_saddle_new (void);
void cloth_cv_saddle_free (ClothCvSaddle * self);
gboolean cloth_cv_saddle_mask (ClothCvSaddle * self, const guint8 * data,
    gint width, gint height, gint stride, gdouble sigma, gdouble epsilon,
    guint * n_below);

gboolean cloth_cv_corner_sub_pix (const guint8 * data, gint width,
    gint height, gint stride, gint half_window, gfloat * xy, guint n);

gboolean cloth_cv_dots (const guint8 * bgr, gint width, gint height,
    gint stride, gdouble min_area, gdouble max_area, guint * n_dots);

G_END_DECLS
