/* Which printed dot each dot of a film is, by colours that adapt to the camera.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/marray.h"
#include "gst/vision/dot/dot.h"
#include "gst/vision/label/dot-label.h"

G_BEGIN_DECLS

/* How the colour of a dot is told.
 *
 * @CLOTH_LABEL_BY_LIKELIHOOD: by the likelihood of the dot's mean chroma over its luma
 * @CLOTH_LABEL_BY_HUE: every pixel votes for the nearest hue (Scholz et al. 2005)
 */
typedef enum {
  CLOTH_LABEL_BY_LIKELIHOOD,
  CLOTH_LABEL_BY_HUE
} ClothLabelColours;

/* @label: how dots are given their place in the array
 * @colours: how their colours are told apart
 * @learn: whether the colours as the camera sees them are learnt from the film; else they
 *   stay as they start
 */
typedef struct {
  ClothDotLabelParams label;
  ClothLabelColours colours;
  gboolean learn;
} ClothFilmLabelParams;

typedef struct _ClothFilmLabeller ClothFilmLabeller;

ClothFilmLabelParams cloth_film_label_default_params (void);

ClothFilmLabeller *cloth_film_labeller_new (const ClothMArray * array,
    GError ** error);
void cloth_film_labeller_free (ClothFilmLabeller * labeller);
void cloth_film_labeller_reset (ClothFilmLabeller * labeller);

void cloth_film_labeller_start_colours (ClothFilmLabeller * labeller,
    gfloat kr, gfloat kb);
gboolean cloth_film_labeller_learn_chart (ClothFilmLabeller * labeller,
    const ClothDotLabelParams * params, const ClothDot * dots, guint n_dots);

guint cloth_film_labeller_run (ClothFilmLabeller * labeller,
    const ClothFilmLabelParams * params, const ClothPlanarImage * image,
    const ClothDot * dots, guint n_dots);
const ClothDotLabel *cloth_film_labeller_get_labels (const ClothFilmLabeller *
    labeller, guint * n_labels);
const gfloat *cloth_film_labeller_get_likelihoods (const ClothFilmLabeller *
    labeller);

gboolean cloth_film_labeller_is_in_vain (const ClothFilmLabeller * labeller,
    gboolean at_end);
gboolean cloth_film_labeller_find_swap (const ClothFilmLabeller * labeller,
    gint * a, gint * b);
gboolean cloth_film_labeller_try_swaps (ClothFilmLabeller * labeller,
    const ClothDotLabelParams * params, const ClothDot * dots, guint n_dots,
    gint * a, gint * b);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothFilmLabeller, cloth_film_labeller_free)
G_END_DECLS
