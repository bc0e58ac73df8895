/* The posterior of a linear Gaussian model.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @n: number of unknowns
 * @precision: n·n; once solved, its Cholesky factor L in the lower triangle
 * @mean: the precision times the mean; once solved, the mean
 */
typedef struct {
  guint n;
  gdouble *precision;
  gdouble *mean;
} ClothPosterior;

void cloth_posterior_init (ClothPosterior * posterior, guint n);
void cloth_posterior_add_data (ClothPosterior * posterior, const gdouble * g,
    const gdouble * s, gdouble phi);
void cloth_posterior_add_prior (ClothPosterior * posterior,
    const gdouble * precisions, const gdouble * means);
gboolean cloth_posterior_solve (ClothPosterior * posterior);
void cloth_posterior_apply (const ClothPosterior * posterior, gdouble * x);
gdouble cloth_posterior_log_determinant (const ClothPosterior * posterior);
void cloth_posterior_covariance (const ClothPosterior * posterior,
    gdouble * covariance);
void cloth_posterior_clear (ClothPosterior * posterior);

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (ClothPosterior, cloth_posterior_clear)
G_END_DECLS
