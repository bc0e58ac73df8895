/* Labels of a film's dots, and what is kept of its colours from picture to picture.
 *
 * A picture is classified by the colours known so far and labelled. Each label says which
 * colour its dot has in print; what such dots look like corrects the colours for the next
 * picture. Before the first label there is nothing to learn from: then the one change of
 * light is looked for that makes the colours of all the dots likeliest, and kept if it
 * leads to labels.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/label/label.h"

#include <string.h>

#include "gst/vision/label/dot-colour.h"

/* Dots of one window: fewer say nothing of whether the array is there. */
#define WINDOW 9
/* Pictures with dots and without a label, after which the array is taken for another. */
#define PATIENCE 25
/* Labels that two colours taken for each other must give: those of a few windows. */
#define SWAP_LABELS (4 * WINDOW)
/* At a chart: the first look may know the colours badly; what it teaches finds more. */
#define CHART_LOOKS 2

struct _ClothFilmLabeller
{
  const ClothMArray *array;     /* borrowed */
  ClothDotLabeller *labeller;
  ClothDotColourModel colours;
  gboolean adapted;             /* colours to this camera: they gave labels */
  guint n_in_vain;              /* pictures with dots and no label, in a row */
  guint n_room;
  gfloat *likelihoods;          /* n_colours for each dot */
  gint8 *labelled_as;           /* colour that a dot's label says it has; -1: no label */
};

/* Returns: as cloth_dot_label_default_params(), by likelihood, learning
 */
ClothFilmLabelParams
cloth_film_label_default_params (void)
{
  return (ClothFilmLabelParams) {
  cloth_dot_label_default_params (), CLOTH_LABEL_BY_LIKELIHOOD, TRUE};
}

/* @array: what is printed; borrowed until the labeller is freed
 * @error: return location
 *
 * Its colours must be started before the first picture.
 *
 * Returns: (transfer full): a labeller for one camera's film; %NULL with
 *   %G_IO_ERROR_INVALID_ARGUMENT when the array is too small or too large
 */
ClothFilmLabeller *
cloth_film_labeller_new (const ClothMArray * array, GError ** error)
{
  ClothDotLabeller *of_pictures = cloth_dot_labeller_new (array->columns,
      array->rows, array->n_colours, array->matrix, error);
  ClothFilmLabeller *labeller;

  if (!of_pictures)
    return NULL;
  labeller = g_new0 (ClothFilmLabeller, 1);
  labeller->array = array;
  labeller->labeller = of_pictures;
  return labeller;
}

/* @labeller: (nullable) (transfer full): a labeller
 */
void
cloth_film_labeller_free (ClothFilmLabeller * labeller)
{
  if (!labeller)
    return;
  cloth_dot_labeller_free (labeller->labeller);
  g_free (labeller->likelihoods);
  g_free (labeller->labelled_as);
  g_free (labeller);
}

/* @labeller: a labeller
 *
 * Forgets where dots were: the next picture is of another part of the film. What was
 * learnt of the colours stays, since it is of the camera.
 */
void
cloth_film_labeller_reset (ClothFilmLabeller * labeller)
{
  cloth_dot_labeller_reset (labeller->labeller);
}

/* @labeller: a labeller
 * @kr: share of red in the pictures' luma
 * @kb: share of blue in the pictures' luma
 *
 * Starts the colours from those of the print.
 */
void
cloth_film_labeller_start_colours (ClothFilmLabeller * labeller, gfloat kr,
    gfloat kb)
{
  guint8 rgb[CLOTH_M_ARRAY_MAX_COLOURS][3];

  for (gint i = 0; i < labeller->array->n_colours; i++)
    memcpy (rgb[i], labeller->array->colours[i].rgb, 3);
  cloth_dot_colour_model_init (&labeller->colours, labeller->array->n_colours,
      (const guint8 (*)[3]) rgb, kr, kb);
  labeller->adapted = FALSE;
}

static void
make_room (ClothFilmLabeller * labeller, guint n)
{
  if (n <= labeller->n_room)
    return;
  labeller->n_room = n + n / 2;
  labeller->likelihoods = g_renew (gfloat, labeller->likelihoods,
      (gsize) labeller->n_room * (gsize) labeller->array->n_colours);
  labeller->labelled_as = g_renew (gint8, labeller->labelled_as,
      labeller->n_room);
}

/* Labels by the likelihoods. Returns how many dots have a label. */
static guint
label (ClothFilmLabeller * labeller, ClothDotLabeller * with,
    const ClothDotLabelParams * params, const ClothDot * dots, guint n_dots)
{
  const ClothMArray *array = labeller->array;
  const ClothDotLabel *labels;
  guint n, n_labelled = 0;

  cloth_dot_labeller_run (with, params, dots, n_dots, labeller->likelihoods);
  labels = cloth_dot_labeller_get_labels (with, &n);
  for (guint k = 0; k < n; k++) {
    const gboolean known = labels[k].column >= 0;

    n_labelled += known;
    labeller->labelled_as[k] = known ? (gint8) array->matrix[labels[k].row *
        array->columns + labels[k].column] : -1;
  }
  return n_labelled;
}

static guint
classify_and_label (ClothFilmLabeller * labeller,
    const ClothFilmLabelParams * params, const ClothPlanarImage * image,
    const ClothDot * dots, guint n)
{
  if (params->colours == CLOTH_LABEL_BY_HUE)
    cloth_dot_colour_model_vote (&labeller->colours, image, dots, n,
        labeller->likelihoods);
  else
    cloth_dot_colour_model_classify (&labeller->colours, dots, n,
        labeller->likelihoods);
  return label (labeller, labeller->labeller, &params->label, dots, n);
}

/* Looks at the picture once more, in the light that makes its dots likeliest. */
static guint
adapt (ClothFilmLabeller * labeller, const ClothFilmLabelParams * params,
    const ClothPlanarImage * image, const ClothDot * dots, guint n)
{
  const ClothDotColourModel before = labeller->colours;
  guint n_labelled;

  /* Dots of another print are looked at so closely now and then only; a few dots may be of
   * any colour. */
  if ((labeller->n_in_vain > PATIENCE && labeller->n_in_vain % PATIENCE)
      || n < WINDOW * (guint) labeller->array->n_colours
      || !cloth_dot_colour_model_adapt (&labeller->colours, dots, n))
    return 0;
  n_labelled = classify_and_label (labeller, params, image, dots, n);
  if (n_labelled == 0)
    labeller->colours = before;
  return n_labelled;
}

/* @labeller: a labeller whose colours were started
 * @params: constants
 * @image: the next picture; read by %CLOTH_LABEL_BY_HUE only
 * @dots: (array length=n_dots): its dots
 * @n_dots: how many, at most %CLOTH_DOT_MAX
 *
 * Labels the dots, and learns from the labels for the next picture.
 *
 * Returns: how many dots have a label
 */
guint
cloth_film_labeller_run (ClothFilmLabeller * labeller,
    const ClothFilmLabelParams * params, const ClothPlanarImage * image,
    const ClothDot * dots, guint n_dots)
{
  guint n_labelled;

  make_room (labeller, n_dots);
  n_labelled = classify_and_label (labeller, params, image, dots, n_dots);
  if (n_labelled == 0 && params->learn && !labeller->adapted)
    n_labelled = adapt (labeller, params, image, dots, n_dots);
  labeller->adapted |= n_labelled > 0;
  if (params->learn)
    cloth_dot_colour_model_learn (&labeller->colours, dots, n_dots,
        labeller->labelled_as);
  if (n_labelled > 0)
    labeller->n_in_vain = 0;
  else if (n_dots >= WINDOW)
    labeller->n_in_vain++;
  return n_labelled;
}

/* @labeller: a labeller
 * @n_labels: (out): how many: one for each dot
 *
 * Returns: (transfer none) (array length=n_labels): labels of the last picture's dots, in
 *   their order, until the next one
 */
const ClothDotLabel *
cloth_film_labeller_get_labels (const ClothFilmLabeller * labeller,
    guint * n_labels)
{
  return cloth_dot_labeller_get_labels (labeller->labeller, n_labels);
}

/* @labeller: a labeller
 *
 * Returns: (transfer none): for each of the last picture's dots the log-likelihood of each
 *   colour of the array, until the next picture
 */
const gfloat *
cloth_film_labeller_get_likelihoods (const ClothFilmLabeller * labeller)
{
  return labeller->likelihoods;
}

/* @labeller: a labeller whose colours were started
 * @params: how dots are given their place
 * @dots: (array length=n_dots): dots of a still picture of the print by this camera
 * @n_dots: how many
 *
 * Learns the colours from the dots that can be labelled. When none can, the colours stay as
 * they are.
 *
 * Returns: whether anything was learnt
 */
gboolean
cloth_film_labeller_learn_chart (ClothFilmLabeller * labeller,
    const ClothDotLabelParams * params, const ClothDot * dots, guint n_dots)
{
  const ClothMArray *array = labeller->array;
  const ClothDotColourModel before = labeller->colours;
  /* of its own: where the chart's dots are says nothing of the film's */
  g_autoptr (ClothDotLabeller) of_chart = cloth_dot_labeller_new
      (array->columns, array->rows, array->n_colours, array->matrix, NULL);
  gboolean adapted = FALSE;
  guint n_learnt = 0;

  make_room (labeller, n_dots);
  while (n_learnt < CHART_LOOKS) {
    cloth_dot_colour_model_classify (&labeller->colours, dots, n_dots,
        labeller->likelihoods);
    cloth_dot_labeller_reset (of_chart);
    if (label (labeller, of_chart, params, dots, n_dots) > 0) {
      cloth_dot_colour_model_learn (&labeller->colours, dots, n_dots,
          labeller->labelled_as);
      n_learnt++;
    } else if (n_learnt > 0 || adapted
        || !cloth_dot_colour_model_adapt (&labeller->colours, dots, n_dots)) {
      labeller->colours = before;
      return FALSE;
    } else {
      adapted = TRUE;
    }
  }
  return TRUE;
}

/* @labeller: a labeller
 * @at_end: whether the film is over
 *
 * Returns: whether now is the time to say that dots are seen that fit nowhere into the
 *   array: when that has gone on for a while, or at the end of a film without a label
 */
gboolean
cloth_film_labeller_is_in_vain (const ClothFilmLabeller * labeller,
    gboolean at_end)
{
  return at_end ? labeller->n_in_vain > 0 && !labeller->adapted :
      labeller->n_in_vain == PATIENCE;
}

/* @labeller: a labeller
 * @a: (out): a colour
 * @b: (out): another
 *
 * Returns: whether dots labelled lately as having one of the colours look like the other;
 *   some are labelled all the same where two colours of the print are in another order
 */
gboolean
cloth_film_labeller_find_swap (const ClothFilmLabeller * labeller, gint * a,
    gint * b)
{
  return cloth_dot_labeller_find_swap (labeller->labeller, a, b);
}

/* @labeller: a labeller
 * @params: how dots are given their place
 * @dots: (array length=n_dots): dots that can't be labelled
 * @n_dots: how many
 * @a: (out): a colour
 * @b: (out): another
 *
 * Looks for the two colours that, taken for each other, give the dots the most labels.
 * Forgets where dots were.
 *
 * Returns: whether there are such
 */
gboolean
cloth_film_labeller_try_swaps (ClothFilmLabeller * labeller,
    const ClothDotLabelParams * params, const ClothDot * dots, guint n_dots,
    gint * a, gint * b)
{
  const ClothDotColourModel colours = labeller->colours;
  guint most = SWAP_LABELS;
  gboolean found = FALSE;

  make_room (labeller, n_dots);
  for (gint i = 0; i < colours.n; i++) {
    for (gint j = 0; j < i; j++) {
      ClothDotColourModel swapped = colours;
      guint n_labelled;

      swapped.classes[i] = colours.classes[j];
      swapped.classes[j] = colours.classes[i];
      cloth_dot_colour_model_classify (&swapped, dots, n_dots,
          labeller->likelihoods);
      cloth_dot_labeller_reset (labeller->labeller);
      n_labelled = label (labeller, labeller->labeller, params, dots, n_dots);
      if (n_labelled < most)
        continue;
      most = n_labelled;
      *a = j;
      *b = i;
      found = TRUE;
    }
  }
  cloth_dot_labeller_reset (labeller->labeller);
  return found;
}
