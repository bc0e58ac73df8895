/* Which of the accepted effects bring the simulation nearer to the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* A gap can be told from the floor when what is above it is this share of all, in variance. */
#define CLOTH_GAP_LEAST_ABOVE_SHARE 0.1

guint cloth_gap_choose_subset (const gdouble * squares,
    const gdouble * draws, guint n_draws, guint n_effects, guint kept,
    gdouble floor);

G_END_DECLS
