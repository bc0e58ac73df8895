/* Symmetric banded matrices: Cholesky, solutions, the inverse's diagonal.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @a: a banded matrix
 * @bandwidth: its bandwidth
 * @i: row
 * @j: column, @i − @bandwidth to @i
 *
 * An element of the lower triangle. Each row holds @bandwidth + 1 numbers, its diagonal
 * last.
 */
#define CLOTH_BAND(a, bandwidth, i, j) \
    ((a)[(gsize) (i) * ((bandwidth) + 1) + (bandwidth) + (j) - (i)])

gboolean cloth_band_factor (guint n, guint bandwidth, gdouble * a);
void cloth_band_solve (guint n, guint bandwidth, const gdouble * l,
    guint columns, gdouble * b);
void cloth_band_inverse_diagonal (guint n, guint bandwidth,
    const gdouble * l, gdouble * diagonal);

G_END_DECLS
