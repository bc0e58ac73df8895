/* Squares given to quadtrack by hand: the property, and what keeps one from starting.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

#include "gst/pattern/pattern.h"
#include "gst/vision/quad/quad.h"

G_BEGIN_DECLS

/* Four corners, column, row; these are -1 when not known. */
#define GST_QUAD_TRACK_SEED_NUMBERS 10

/* What was said already; all FALSE at the start. */
typedef struct {
  gboolean of_seed, of_start;
} GstQuadTrackWarned;

/* Reads "x0,y0,…,y3" or "x0,y0,…,y3,column,row". */
gboolean gst_quad_track_seed_parse (const gchar * text,
    gfloat seed[GST_QUAD_TRACK_SEED_NUMBERS]);

/* Each posts a warning, once, for who isn't told waits in vain: if nothing can be found
 * without a seed and there is none; if the square that a seed is said to be can't be
 * tracked; and, after the picture, if no square started from its seeds. */
void gst_quad_track_seed_check_start (GstElement * element,
    GstQuadTrackWarned * warned, const ClothPattern * pattern,
    const ClothQuadParams * params, guint n_seeds);
void gst_quad_track_seed_check (GstElement * element,
    GstQuadTrackWarned * warned, const ClothPattern * pattern,
    const ClothQuadParams * params, gint column, gint row);
void gst_quad_track_seed_check_tracked (GstElement * element,
    GstQuadTrackWarned * warned, const ClothQuadParams * params,
    guint n_seeds, guint n_tracked);

G_END_DECLS
