/* Masks as runs of pixels, by row and column; the pieces that they form.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* The most runs of a mask. */
#define CLOTH_RUNS_MAX (1 << 20)

/* Columns @begin to before @end of a row. */
typedef struct {
  guint16 row, begin, end;
} ClothRun;

GArray *cloth_runs_new_pieces (void);
gboolean cloth_runs_of_bits (GArray * runs, const guint64 * bits, gint width,
    gint height);
void cloth_runs_complement (const GArray * runs, GArray * others, gint width,
    gint height);
void cloth_runs_drop (GArray * runs, GArray * pieces, guint least);
void cloth_runs_fill (GArray * runs, GArray * gaps, GArray * pieces,
    guint most, gint width, gint height);

G_END_DECLS
