/* Order statistics and the χ² distribution.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* From the median of absolute values to the standard deviation of a normal distribution. */
#define CLOTH_MEDIAN_TO_SIGMA 1.4826

gint cloth_compare_doubles (gconstpointer a, gconstpointer b);
gdouble cloth_median (gdouble * values, gsize n);
gdouble cloth_chi_square_tail (gdouble x, guint n);
guint cloth_coprime_step (guint least, guint n);

G_END_DECLS
