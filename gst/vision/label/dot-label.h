/* Which dot of the printed array each dot in the picture is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/dot/dot.h"

G_BEGIN_DECLS

/* Most colours of dots.
 */
#define CLOTH_DOT_COLOURS_MAX 8

/* @column: of the array, -1 for no label
 * @row: of the array, -1 for no label
 * @confidence: log-odds of the label, nats: of the placing of its patch against the next
 *   best and against dots of random colours, the lesser; 0 without a label
 * @mirrored: whether the print is seen from behind
 * @patch: which connected piece of the lattice it lies in, from 0; %G_MAXUINT without a
 *   label
 */
typedef struct {
  gint column, row;
  gfloat confidence;
  gboolean mirrored;
  guint patch;
} ClothDotLabel;

/* @c: greatest change of a lattice vector from dot to dot, as a share of its length:
 *   ‖u′−u‖ < c‖u‖, 0 to 1; 0.4
 * @colour_error: share of the dots that are taken for having any colour at all, 0.001 to
 *   0.9, until labels have shown how many look like another colour; 0.1, the worst of the
 *   paper's 5 to 10 percent
 * @lead: least log-odds of a placing, nats, at least 0; 6
 * @mirrored: whether the print may be seen from behind; it may
 * @paper: label by seeds of three hypotheses, windows that occur in the array and growing
 *   of regions (Scholz et al. 2005, 4.2), picture by picture, rather than by the
 *   likelihood of whole patches
 * @least_region: fewest dots of a region that the paper's way keeps, at least 3; 20
 *
 * Values out of range are brought into it.
 */
typedef struct {
  gfloat c;
  gfloat colour_error;
  gfloat lead;
  gboolean mirrored;
  gboolean paper;
  guint least_region;
} ClothDotLabelParams;

typedef struct _ClothDotLabeller ClothDotLabeller;

ClothDotLabelParams cloth_dot_label_default_params (void);

ClothDotLabeller *cloth_dot_labeller_new (gint columns, gint rows,
    gint n_colours, const guint8 * matrix, GError ** error);
void cloth_dot_labeller_free (ClothDotLabeller * labeller);

void cloth_dot_labeller_run (ClothDotLabeller * labeller,
    const ClothDotLabelParams * params, const ClothDot * dots, guint n_dots,
    const gfloat * log_likelihoods);
const ClothDotLabel *cloth_dot_labeller_get_labels (const ClothDotLabeller *
    labeller, guint * n_labels);
gboolean cloth_dot_labeller_find_swap (const ClothDotLabeller * labeller,
    gint * a, gint * b);
void cloth_dot_labeller_reset (ClothDotLabeller * labeller);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothDotLabeller, cloth_dot_labeller_free)
G_END_DECLS
