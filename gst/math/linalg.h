/* Small dense linear algebra: 3×3, symmetric eigenproblems, Cholesky, least squares.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Greatest order that cloth_sym_eigen () takes. */
#define CLOTH_EIGEN_MAX 16

void cloth_mat3_mul (const gdouble a[9], const gdouble b[9], gdouble ab[9]);
void cloth_mat3_mul_tn (const gdouble a[9], const gdouble b[9],
    gdouble atb[9]);
void cloth_mat3_mul_nt (const gdouble a[9], const gdouble b[9],
    gdouble abt[9]);
void cloth_mat3_vec (const gdouble a[9], const gdouble x[3], gdouble ax[3]);
void cloth_mat3_vec_t (const gdouble a[9], const gdouble x[3],
    gdouble atx[3]);
gdouble cloth_mat3_det (const gdouble a[9]);
gboolean cloth_mat3_inverse (const gdouble a[9], gdouble inverse[9]);
gboolean cloth_mat3_nearest_rotation (const gdouble a[9], gdouble r[9]);

gboolean cloth_sym_eigen (guint n, const gdouble * a, gdouble * values,
    gdouble * vectors);

gboolean cloth_cholesky_factor (guint n, gdouble * a);
void cloth_cholesky_solve (guint n, const gdouble * l, gdouble * b);
void cloth_cholesky_inverse (guint n, const gdouble * l, gdouble * inverse);

gboolean cloth_least_squares (guint m, guint n, gdouble * a, gdouble * b);

G_END_DECLS
