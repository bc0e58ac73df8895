/* Recordings whose cause is known: a simulated sheet held at two corners, with noise.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/take/take.h"
#include "gst/sim/model.h"

G_BEGIN_DECLS

/* Where corner @held (0 the first column's, 1 the last one's) is at @t seconds. */
typedef void (*TestGapClamp) (guint held, gdouble t, gfloat p[3]);

/* Where what is at @p is filmed at @t seconds. */
typedef void (*TestGapFilm) (gdouble t, gfloat p[3]);

/* @logged: where the log has the corners, %NULL: where they are; @film: %NULL: where it is. */
typedef struct {
  guint columns, rows, n_frames;
  gdouble width_m, height_m, fps, noise_m;
  TestGapClamp logged;
  TestGapFilm film;
} TestGapSheet;

/* Frees stretch, shear, bending and damping of @model, each within a factor of 30. */
void test_gap_free_parameters (ClothModel * model);
/* A take in @parent/@name of what @model does when its corners move as @clamp says. */
ClothTake *test_gap_record (const TestGapSheet * sheet, const ClothModel * model,
    TestGapClamp clamp, const gchar * parent, const gchar * name, guint64 seed);
/* Removes a folder with all that is in it. */
void test_gap_remove (const gchar * path);

G_END_DECLS
