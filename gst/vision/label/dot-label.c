/* Labelling of coloured dots: the array they are printed from and what lasts from picture
 * to picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/label/dot-label.h"

#include <gio/gio.h>
#include <math.h>
#include <string.h>

#include "gst/vision/label/dot-label-private.h"

#define LEAST_EDGE 3
#define GREATEST_EDGE 400
/* Dots of each of two colours that must look like the other to say that they are
 * swapped. */
#define SWAPPED 5.0f

/* Returns: parameters: change of lattice vectors 0.4, colour errors 0.1, lead 6, seen
 *   from both sides, not the paper's way; its regions of 20 dots
 */
ClothDotLabelParams
cloth_dot_label_default_params (void)
{
  return (ClothDotLabelParams) {
  .c = 0.4f,.colour_error = 0.1f,.lead = 6,.mirrored = TRUE,.least_region = 20};
}

static guint8 *
pad_matrix (const ClothDotLabeller * labeller)
{
  const gsize pad = CLOTH_DOT_LABEL_PAD, columns = (gsize) labeller->columns;
  const gsize rows = (gsize) labeller->rows, stride = columns + 2 * pad;
  guint8 *padded = g_malloc (stride * (rows + 2 * pad));

  memset (padded, labeller->n_colours, stride * (rows + 2 * pad));
  for (gsize row = 0; row < rows; row++)
    memcpy (padded + (row + pad) * stride + pad,
        labeller->matrix + row * columns, columns);
  return padded;
}

static void
sort_cells (ClothDotLabeller * labeller)
{
  const gint n = labeller->columns * labeller->rows;
  guint k = 0;

  labeller->cells = g_new (ClothLatticeCell, n);
  for (gint colour = 0; colour < labeller->n_colours; colour++) {
    labeller->of_colour[colour] = k;
    for (gint i = 0; i < n; i++)
      if (labeller->matrix[i] == colour)
        labeller->cells[k++] = (ClothLatticeCell) {
        (gint16) (i % labeller->columns), (gint16) (i / labeller->columns)};
  }
  labeller->of_colour[labeller->n_colours] = k;
}

/* @columns: dots in a row of the array, 3 to 400
 * @rows: dots in a column, 3 to 400
 * @n_colours: how many colours, 2 to %CLOTH_DOT_COLOURS_MAX
 * @matrix: (array): @rows·@columns bytes: which colour each dot has
 * @error: return location
 *
 * Returns: (transfer full): a labeller for one camera's pictures; %NULL with
 *   %G_IO_ERROR_INVALID_ARGUMENT when a number is out of its range
 */
ClothDotLabeller *
cloth_dot_labeller_new (gint columns, gint rows, gint n_colours,
    const guint8 * matrix, GError ** error)
{
  ClothDotLabeller *labeller;
  gsize n;

  if (columns < LEAST_EDGE || columns > GREATEST_EDGE || rows < LEAST_EDGE
      || rows > GREATEST_EDGE) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
        "%d by %d dots: use %d to %d each way", columns, rows, LEAST_EDGE,
        GREATEST_EDGE);
    return NULL;
  }
  if (n_colours < 2 || n_colours > CLOTH_DOT_COLOURS_MAX) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
        "%d colours of dots: use 2 to %d", n_colours, CLOTH_DOT_COLOURS_MAX);
    return NULL;
  }
  n = (gsize) columns *(gsize) rows;
  for (gsize k = 0; k < n; k++) {
    if (matrix[k] >= n_colours) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
          "the array has a colour %d in row %d, column %d: there are 0 to %d",
          matrix[k], (gint) k / columns, (gint) k % columns, n_colours - 1);
      return NULL;
    }
  }
  labeller = g_new0 (ClothDotLabeller, 1);
  labeller->columns = columns;
  labeller->rows = rows;
  labeller->n_colours = n_colours;
  labeller->matrix = g_memdup2 (matrix, n);
  labeller->padded = pad_matrix (labeller);
  sort_cells (labeller);
  labeller->holders = g_new (gint32, n);
  labeller->doubtful = g_new (guint8, n);
  labeller->former = g_new0 (ClothLatticeFormer, n);
  labeller->grid = cloth_point_grid_new ();
  labeller->patches = g_array_new (FALSE, FALSE, sizeof (ClothLatticePatch));
  labeller->candidates = g_array_new (FALSE, FALSE,
      sizeof (ClothLatticeCandidate));
  return labeller;
}

/* @labeller: (nullable) (transfer full): a labeller
 */
void
cloth_dot_labeller_free (ClothDotLabeller * labeller)
{
  if (!labeller)
    return;
  cloth_point_grid_free (labeller->grid);
  g_array_unref (labeller->patches);
  g_array_unref (labeller->candidates);
  g_free (labeller->matrix);
  g_free (labeller->padded);
  g_free (labeller->cells);
  g_free (labeller->holders);
  g_free (labeller->doubtful);
  g_clear_pointer (&labeller->windows, g_hash_table_unref);
  g_free (labeller->former);
  g_free (labeller->predicted);
  g_free (labeller->nodes);
  g_free (labeller->around);
  g_free (labeller->gains);
  g_free (labeller->labels);
  g_free (labeller->members);
  g_free (labeller->queue);
  g_free (labeller->frames);
  g_free (labeller->scratch);
  g_free (labeller);
}

static void
make_room (ClothDotLabeller * labeller, guint n)
{
  labeller->n = n;
  if (n <= labeller->n_room)
    return;
  n += n / 2;
  labeller->n_room = n;
  labeller->nodes = g_renew (ClothLatticeNode, labeller->nodes, n);
  labeller->around = g_renew (ClothLatticeAround, labeller->around, n);
  labeller->gains = g_renew (gfloat, labeller->gains,
      (gsize) n * (gsize) (labeller->n_colours + 1));
  labeller->labels = g_renew (ClothDotLabel, labeller->labels, n);
  labeller->predicted = g_renew (gint32, labeller->predicted, n);
  labeller->members = g_renew (guint, labeller->members, n);
  labeller->queue = g_renew (guint, labeller->queue, n);
  labeller->frames = g_renew (ClothLatticeFrame, labeller->frames, n);
  labeller->scratch = g_renew (gfloat, labeller->scratch, 3 * (gsize) n);
}

static gfloat
within (gfloat value, gfloat least, gfloat most)
{
  return value >= least ? MIN (value, most) : least;
}

/* @labeller: a labeller
 * @params: constants
 * @dots: (array length=n_dots): the dots of the next picture
 * @n_dots: how many, at most %CLOTH_DOT_MAX (those beyond get no label)
 * @log_likelihoods: for each dot the log-likelihood of each colour, from
 *   cloth_dot_colour_model_classify() for one
 *
 * Labels dots. Neighbours are found by where they lie in the measure of the dots' own
 * ellipses; links join dots to patches; the placing of a patch in the array, over all
 * turns and shifts and mirrored, is the one that the colours of all its dots together
 * make likeliest. It counts when it leads by @params->lead before the next best and
 * before random colours. Dots that together contradict it are cut off and placed anew.
 * Where the former picture's labels predict a placing, that one is tried first; the
 * colours of its dots must say so too. Then dots next to labelled ones are labelled where
 * both place and colour agree, and labels taken away from dots that lie elsewhere.
 *
 * Each label is given at most once. Dots that are in no patch, and patches that no
 * placing explains well enough, get none.
 */
void
cloth_dot_labeller_run (ClothDotLabeller * labeller,
    const ClothDotLabelParams * params, const ClothDot * dots, guint n_dots,
    const gfloat * log_likelihoods)
{
  labeller->params = *params;
  labeller->params.c = within (params->c, 0, 1);
  labeller->params.colour_error = within (params->colour_error, 0.001f, 0.9f);
  labeller->params.least_region = MAX (3, params->least_region);
  labeller->params.lead = within (params->lead, 0, G_MAXFLOAT);
  if (labeller->error <= 0)
    labeller->error = labeller->params.colour_error;
  make_room (labeller, MIN (n_dots, CLOTH_DOT_MAX));
  cloth_dot_label_start (labeller, dots);
  cloth_dot_label_weigh (labeller, log_likelihoods);
  if (params->paper) {
    cloth_dot_label_as_paper (labeller);
    return;
  }
  cloth_dot_label_link (labeller, dots);
  cloth_dot_label_grow (labeller);
  cloth_dot_label_predict (labeller);
  cloth_dot_label_place (labeller);
  cloth_dot_label_compare (labeller);
  cloth_dot_label_prune (labeller);
  cloth_dot_label_extend (labeller);
  cloth_dot_label_remember (labeller);
}

/* @labeller: a labeller
 * @n_labels: (out): how many: one for each dot
 *
 * Returns: (transfer none) (array length=n_labels): labels of the dots of the last
 *   picture, in their order, until the next one
 */
const ClothDotLabel *
cloth_dot_labeller_get_labels (const ClothDotLabeller * labeller,
    guint * n_labels)
{
  *n_labels = labeller->n;
  return labeller->labels;
}

/* @labeller: a labeller
 * @a: (out): a colour
 * @b: (out): another
 *
 * Looks for two colours of which most dots of the last pictures look like the other one,
 * going by their labels: the pattern's description has them in the wrong order. A label
 * does not hang on the colour of its own dot alone, so that some are found all the same.
 *
 * Returns: whether two colours are swapped
 */
gboolean
cloth_dot_labeller_find_swap (const ClothDotLabeller * labeller, gint * a,
    gint * b)
{
  const gint n = labeller->n_colours;

  for (*a = 0; *a < n; (*a)++) {
    for (*b = *a + 1; *b < n; (*b)++) {
      gfloat all[2] = { 0 };

      for (gint k = 0; k < n; k++) {
        all[0] += labeller->looks[*a][k];
        all[1] += labeller->looks[*b][k];
      }
      if (labeller->looks[*a][*b] >= SWAPPED
          && labeller->looks[*b][*a] >= SWAPPED
          && 2 * labeller->looks[*a][*b] > all[0]
          && 2 * labeller->looks[*b][*a] > all[1])
        return TRUE;
    }
  }
  return FALSE;
}

/* @labeller: a labeller
 *
 * Forgets the former pictures: the next one is of another film, or another part of it.
 */
void
cloth_dot_labeller_reset (ClothDotLabeller * labeller)
{
  labeller->n = 0;
  labeller->error = 0;
  memset (labeller->looks, 0, sizeof labeller->looks);
  memset (labeller->former, 0, (gsize) labeller->columns
      * (gsize) labeller->rows * sizeof *labeller->former);
}
