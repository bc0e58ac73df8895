/* OpenCV's functions for the tasks of this project, as plain C functions: the peer that the
 * benchmarks and some tests are held against. Pictures may have any stride; what OpenCV
 * throws becomes FALSE. What the product has of OpenCV is in gst/cv.
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

gboolean cloth_cv_triangulate_points (const gdouble projections[24], guint n,
    const gdouble * x0, const gdouble * y0, const gdouble * x1,
    const gdouble * y1, gdouble * points);

gboolean cloth_cv_undistort_rectify_map (const gdouble K[9],
    const gdouble * k, guint n_k, gboolean fisheye, const gdouble R[9],
    gdouble focal, const gdouble centre[2], gint width, gint height,
    gfloat * x, gfloat * y);
gboolean cloth_cv_stereo_rectify (const gdouble K[9], gint width, gint height,
    const gdouble R[9], const gdouble t[3], gdouble R1[9], gdouble R2[9]);
gboolean cloth_cv_read_floats (const gchar * path, gint width, gint height,
    gfloat * floats);

typedef struct _ClothCvMatcher ClothCvMatcher;

ClothCvMatcher *cloth_cv_matcher_new (const guint8 * descriptors, guint n,
    gboolean flann);
void cloth_cv_matcher_free (ClothCvMatcher * self);
gboolean cloth_cv_matcher_run (ClothCvMatcher * self, const guint8 * queries,
    guint n, guint32 * nearest);

gboolean cloth_cv_fill (guint8 * mask, gint width, gint height,
    const gdouble * corners, guint n_corners, guint n);

G_END_DECLS
