/* Least squares of a function that is dear and has no derivatives of its own.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @data: the caller's
 * @x: (array): where
 * @z: (out) (array): the residual there, each of variance 1
 * @error: %CLOTH_FIT_ERROR_MODEL: there is none at @x; anything else ends the fit
 *
 * Returns: whether it could be found
 */
typedef gboolean (*ClothBroydenResidual) (gpointer data, const gdouble * x,
    gdouble * z, GError ** error);

/* @n: number of unknowns
 * @size: of the residual
 * @low: (array length=n): least values
 * @high: (array length=n): greatest values
 * @precisions: (array length=n): of their priors, centred at the start
 * @guess: (nullable) (array length=n): where the first step leads, however long it is; %NULL:
 *   where the derivatives say
 * @longest: no unknown moves further in a step
 * @shortest: a step in which none moves this far ends the fit
 * @n_calls: at most so many residuals are asked for
 */
typedef struct {
  guint n;
  gsize size;
  const gdouble *low;
  const gdouble *high;
  const gdouble *precisions;
  const gdouble *guess;
  gdouble longest;
  gdouble shortest;
  guint n_calls;
} ClothBroydenOptions;

gboolean cloth_broyden_run (ClothBroydenResidual residual, gpointer data,
    const ClothBroydenOptions * options, gdouble * x, gdouble * z,
    gdouble * columns, GError ** error);

G_END_DECLS
