/* Dot detection: spots above a local threshold, cut apart where they run together, then
 * the grey-weighted centre of each.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot.h"

#include "gst/vision/dot/dot-private.h"
#include "gst/vision/dot/dot-spots.h"

#define TILE CLOTH_DOT_TILE
/* Runs keep their places in 16 bits. */
#define MAX_EDGE 32767
/* Spots this round are not looked into for several dots: noise alone takes that much of
 * a small dot. */
#define SURELY_ROUND 0.95
/* How often the threshold of a spot is raised to cut it apart, by which share of what is
 * left up to its peak. */
#define STEPS 5
#define STEP_SHARE 0.2

/* Returns: parameters for dots of 2 to 20 px radius: contrast 20, share 0.2, area from
 *   10 px on, diameter to 40 px, roundness 0.9
 */
ClothDotParams
cloth_dot_default_params (void)
{
  return (ClothDotParams) {
  20, 0.2f, 10, 40, 0.9f};
}

/* Returns: (transfer full): a detector; its memory is used again for each picture
 */
ClothDotDetector *
cloth_dot_detector_new (void)
{
  ClothDotDetector *detector = g_new0 (ClothDotDetector, 1);

  detector->runs = g_array_new (FALSE, FALSE, sizeof (ClothDotRun));
  detector->spots = g_array_new (FALSE, FALSE, sizeof (ClothDotSpot));
  detector->candidates = g_array_new (FALSE, FALSE, sizeof (ClothDotCandidate));
  detector->sorted = g_array_new (FALSE, FALSE, sizeof (ClothDotPlace));
  detector->dots = g_array_new (FALSE, FALSE, sizeof (ClothDot));
  return detector;
}

/* @detector: (nullable) (transfer full): a detector
 */
void
cloth_dot_detector_free (ClothDotDetector * detector)
{
  if (!detector)
    return;
  g_array_unref (detector->runs);
  g_array_unref (detector->spots);
  g_array_unref (detector->candidates);
  g_array_unref (detector->sorted);
  g_array_unref (detector->dots);
  g_free (detector->bounds);
  g_free (detector->bits);
  g_free (detector->heads);
  g_free (detector);
}

static gfloat
within (gfloat value, gfloat least, gfloat most)
{
  return value >= least ? MIN (value, most) : least;
}

static void
start (ClothDotDetector * detector, const ClothDotParams * params,
    const ClothPlanarImage * image)
{
  gsize n;

  detector->image = image;
  detector->params = (ClothDotParams) {
    within (params->contrast, 1, 254), within (params->share, 0, 0.9f),
        within (params->min_area, 4, G_MAXINT16),
        CLAMP (params->max_diameter, 4, CLOTH_DOT_MAX_DIAMETER),
        within (params->roundness, 0, 1)
  };
  detector->columns = (image->luma.width + TILE - 1) / TILE;
  detector->rows = (image->luma.height + TILE - 1) / TILE;
  n = (gsize) detector->columns * (gsize) detector->rows;
  if (n > detector->n_tiles) {
    detector->bounds = g_realloc (detector->bounds, 4 * n);
    detector->bits = g_renew (guint16, detector->bits, n);
    detector->heads = g_renew (gint32, detector->heads, n + 1);
    detector->n_tiles = n;
  }
  detector->least = detector->bounds;
  detector->most = detector->least + n;
  detector->low = detector->most + n;
  detector->threshold = detector->low + n;
  detector->noise = 0;
  detector->cut = FALSE;
  g_array_set_size (detector->runs, 0);
  g_array_set_size (detector->spots, 0);
  g_array_set_size (detector->candidates, 0);
  g_array_set_size (detector->dots, 0);
}

/* --- the local threshold ------------------------------------------------------- */

/* Least luma within @reach tiles along a row of tiles or down a column. */
static void
spread_least (const guint8 * from, guint8 * to, gint n, gint stride, gint reach)
{
  for (gint i = 0; i < n; i++) {
    guint8 least = 255;

    for (gint k = MAX (0, i - reach); k <= MIN (n - 1, i + reach); k++)
      least = MIN (least, from[k * stride]);
    to[i * stride] = least;
  }
}

/* The threshold of a tile, by its ground; the brightest is looked for next to it only, so
 * that a bright wall behind the cloth does little. */
static void
set_threshold (ClothDotDetector * detector, gint column, gint row)
{
  const ClothDotParams *params = &detector->params;
  const gint columns = detector->columns, rows = detector->rows;
  const gint tile = row * columns + column;
  const gint low = detector->low[tile];
  gint high = 0;
  gfloat above;

  for (gint j = MAX (0, row - 1); j <= MIN (rows - 1, row + 1); j++)
    for (gint i = MAX (0, column - 1); i <= MIN (columns - 1, column + 1); i++)
      high = MAX (high, detector->most[j * columns + i]);
  above = MAX (params->contrast, params->share * (gfloat) (high - low));
  detector->threshold[tile] = (gfloat) (high - low) < params->contrast ? 255
      : (guint8) MIN (255, low + (gint) above);
}

#define BRIGHT 1
#define NO_DOT 2

/* Marks the bright tiles of a row or a column of them that follow each other for longer
 * than a dot is wide. */
static void
mark_lines (guint16 * marks, gint n, gint stride, gint longer)
{
  for (gint i = 0, line = 0; i < n; i++) {
    line = marks[i * stride] & BRIGHT ? line + 1 : 0;
    for (gint k = 0; line >= longer && k < (line == longer ? line : 1); k++)
      marks[(i - k) * stride] |= NO_DOT;
  }
}

/* Where more than a dot is bright all over, the ground that was found is of something
 * else: of the cloth before a wall, of a shadow. There it is the tile's own. */
static void
take_near_ground (ClothDotDetector * detector)
{
  const gint columns = detector->columns, rows = detector->rows;
  const gint longer = detector->params.max_diameter / TILE + 1;
  guint16 *marks = detector->bits;

  for (gint k = 0; k < columns * rows; k++)
    marks[k] = detector->least[k] > detector->threshold[k] ? BRIGHT : 0;
  for (gint row = 0; row < rows; row++)
    mark_lines (marks + row * columns, columns, 1, longer);
  for (gint column = 0; column < columns; column++)
    mark_lines (marks + column, rows, columns, longer);
  for (gint row = 0; row < rows; row++) {
    for (gint column = 0; column < columns; column++) {
      const gint tile = row * columns + column;

      if (!(marks[tile] & NO_DOT))
        continue;
      detector->low[tile] = detector->least[tile];
      set_threshold (detector, column, row);
    }
  }
}

/* The ground is the darkest within reach of a dot. */
static void
set_thresholds (ClothDotDetector * detector)
{
  const ClothDotParams *params = &detector->params;
  const gint columns = detector->columns, rows = detector->rows;
  const gint reach = (params->max_diameter / 2 + TILE - 1) / TILE;

  for (gint row = 0; row < rows; row++)
    spread_least (detector->least + row * columns,
        detector->threshold + row * columns, columns, 1, reach);
  for (gint column = 0; column < columns; column++)
    spread_least (detector->threshold + column, detector->low + column, rows,
        columns, reach);
  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++)
      set_threshold (detector, column, row);
  take_near_ground (detector);
}

static void
find_runs (ClothDotDetector * detector)
{
  const ClothImage *luma = &detector->image->luma;
  const gint columns = detector->columns;

  for (gint row = 0; row < detector->rows; row++)
    detector->kernels->find_bounds (luma, row,
        detector->least + row * columns, detector->most + row * columns);
  set_thresholds (detector);
  for (gint y = 0; y < luma->height; y++) {
    detector->kernels->find_bits (luma->data +
        (gsize) y * (gsize) luma->stride, luma->width,
        detector->threshold + y / TILE * columns, detector->bits);
    cloth_dot_runs_of_bits (detector->runs, detector->bits, columns, y);
  }
  detector->cut = detector->runs->len >= CLOTH_DOT_MAX_RUNS;
}

/* --- from spots to candidates ----------------------------------------------------- */

static void
bounds_of_spot (const ClothDotDetector * detector, const ClothDotSpot * spot,
    guint8 * least, guint8 * most)
{
  const ClothImage *luma = &detector->image->luma;

  *least = 255;
  *most = 0;
  for (gint32 k = spot->first; k >= 0;) {
    const ClothDotRun *run = &g_array_index (detector->runs, ClothDotRun, k);
    const guint8 *row = luma->data + (gsize) run->y * (gsize) luma->stride;

    for (gint x = run->start; x < run->end; x++) {
      *least = MIN (*least, row[x]);
      *most = MAX (*most, row[x]);
    }
    k = run->next;
  }
}

static void judge_spot (ClothDotDetector * detector, ClothDotSpot spot,
    guint8 threshold);

/* Looks for dots in @spot above higher thresholds; whether it became several. */
static gboolean
cut_spot (ClothDotDetector * detector, const ClothDotSpot * spot,
    guint8 threshold)
{
  const guint n_runs = detector->runs->len, n_spots = detector->spots->len;
  const guint n_candidates = detector->candidates->len;
  guint8 step = spot->step, raised = threshold, least, most;

  bounds_of_spot (detector, spot, &least, &most);
  /* A wall stays whole for long. */
  do
    raised += (guint8) MAX (1, (gint) (STEP_SHARE * (most - raised)));
  while (++step < STEPS && raised < least);
  if (raised < least)
    return FALSE;
  cloth_dot_runs_of_spot (detector->runs, spot, &detector->image->luma, raised);
  cloth_dot_spots (detector->runs, n_runs, detector->spots);
  for (guint i = n_spots; i < detector->spots->len; i++) {
    ClothDotSpot part = g_array_index (detector->spots, ClothDotSpot, i);

    part.step = step;
    judge_spot (detector, part, raised);
  }
  g_array_set_size (detector->spots, n_spots);
  g_array_set_size (detector->runs, n_runs);
  return detector->candidates->len - n_candidates >= 2;
}

static void
judge_spot (ClothDotDetector * detector, ClothDotSpot spot, guint8 threshold)
{
  const ClothDotParams *params = &detector->params;
  const gint extent = 1 + MAX (spot.right - spot.left, spot.bottom - spot.top);
  const guint n_candidates = detector->candidates->len;
  /* What the first, low threshold joins lies apart all the same. */
  ClothDotCandidate whole = {.threshold = threshold,.touches = spot.step > 1 };
  gdouble roundness;
  gboolean is_dot;

  if ((gfloat) spot.n < params->min_area)
    return;
  roundness = cloth_dot_spot_shape (&spot,
      &g_array_index (detector->runs, ClothDotRun, 0), &whole.x, &whole.y,
      whole.shape);
  is_dot = extent <= params->max_diameter && roundness >= params->roundness;
  if ((!is_dot || roundness < SURELY_ROUND) && spot.step < STEPS) {
    if (cut_spot (detector, &spot, threshold) || !is_dot)
      return;
    g_array_set_size (detector->candidates, n_candidates);
  }
  if (!is_dot)
    return;
  if (detector->candidates->len < CLOTH_DOT_MAX)
    g_array_append_val (detector->candidates, whole);
  else
    detector->cut = TRUE;
}

static void
find_candidates (ClothDotDetector * detector)
{
  guint n_spots;

  cloth_dot_spots (detector->runs, 0, detector->spots);
  n_spots = detector->spots->len;
  for (guint i = 0; i < n_spots; i++) {
    const ClothDotSpot *spot =
        &g_array_index (detector->spots, ClothDotSpot, i);
    const gint tile = spot->top / TILE * detector->columns
        + g_array_index (detector->runs, ClothDotRun, spot->first).start / TILE;

    judge_spot (detector, *spot, detector->threshold[tile]);
  }
}

/* @detector: a detector
 * @params: thresholds
 * @image: a picture, at most 32767 px each way (what lies beyond is not looked at)
 * @level: instruction set; all give the same
 *
 * Finds bright dots on dark ground, such as those of an M-array. The luma is compared
 * with a threshold between the ground's and the brightest nearby; connected spots that
 * are not as round as an ellipse are cut apart at higher thresholds. The centre is the
 * mean of the pixels around weighed by their luma above the ground, which is what the
 * centre of gravity of a filled contour (Scholz et al. 2005, 4.1) is without its
 * rounding to whole pixels. Weights end at 10 and 90 percent of the dot's contrast.
 *
 * Dots that the picture's border cuts are left out: their centres are not known. The
 * dots are in the order of their topmost pixels, row by row, but for those that were cut
 * from one spot, which follow each other.
 */
void
cloth_dot_detector_run (ClothDotDetector * detector,
    const ClothDotParams * params, const ClothPlanarImage * image,
    ClothSimd level)
{
  ClothPlanarImage within_reach = *image;

  within_reach.luma.width = MIN (image->luma.width, MAX_EDGE);
  within_reach.luma.height = MIN (image->luma.height, MAX_EDGE);
  start (detector, params, &within_reach);
  detector->kernels = CLOTH_SIMD_TABLE (cloth_dot_kernels, level);
  find_runs (detector);
  find_candidates (detector);
  cloth_dot_measure (detector);
  detector->image = NULL;
}

/* @detector: a detector
 * @n_dots: (out): how many
 *
 * Returns: (transfer none) (array length=n_dots): the dots of the last picture, until
 *   the next one
 */
const ClothDot *
cloth_dot_detector_get_dots (const ClothDotDetector * detector, guint * n_dots)
{
  *n_dots = detector->dots->len;
  return (const ClothDot *) (gpointer) detector->dots->data;
}

/* @detector: a detector
 *
 * Returns: whether the last picture had more dots than %CLOTH_DOT_MAX, or more specks
 *   than are looked at
 */
gboolean
cloth_dot_detector_was_cut (const ClothDotDetector * detector)
{
  return detector->cut;
}

/* @detector: a detector
 *
 * Returns: standard deviation of the last picture's noise, grey levels, from the insides
 *   of its dots; 0 where none is wide enough to tell
 */
gfloat
cloth_dot_detector_get_noise (const ClothDotDetector * detector)
{
  return detector->noise;
}
