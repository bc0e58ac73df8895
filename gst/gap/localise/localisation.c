/* Decides which vertices a residual is significantly at, and from when on.
 *
 * Model: the place is a box on the flat cloth, the excess of its vertices (excess.c) has a mean
 * above zero, that of all others none. Boxes of all sizes are scanned (Kulldorff 1997,
 * Communications in Statistics 26) over all of the take and over its later parts.
 * Formula: score of a box of k vertices = (Σ excess)²/k. The best score is significant when it is
 * larger than 95% of the best scores of blocks of time of the null, drawn by chance.
 * The place's edges are where inside and outside differ most (Otsu 1979). Its onset is where the
 * cumulative sum of log (mean square/2 null) begins to rise (Page 1954, Biometrika 41).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/localise/localisation.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/math/statistics.h"

/* Lines of the flat cloth each way that boxes lie between, for significance and place. */
#define COARSE_LINES 16
#define FINE_LINES 36
/* No place is smaller: of one vertex the measurement itself may be off. */
#define LEAST_VERTICES 2
/* Where the outside is this much of the inside, the place is no place: it is all that is
 * above the null. */
#define EVERYWHERE 0.6
/* Excesses are of two parts, across and along the cloth, each 1 less than its square. */
#define PARTS 2.
/* Blocks of the null that happen to be quiet count as this much of its mean. */
#define LEAST_UNDER 0.5
/* Of one frame no more counts for the onset, logarithm. */
#define MOST_OF_ONE 1.5
/* Least of a square, for its logarithm. */
#define LEAST_SQUARE 1e-3
/* The onset is where the residual leaves what it was before, this quantile and more. */
#define BEFORE_QUANTILE 0.8
#define BEFORE_MARGIN 1.1
/* Place and onset sharpen each other so often. */
#define N_PASSES 2

/* The flat cloth between lines: in which cell each vertex lies. */
typedef struct
{
  guint columns;
  guint rows;
  guint n;
  guint *cell;
} Cells;

typedef struct
{
  guint top, bottom, left, right;       /* [top, bottom) × [left, right) */
  gdouble score;
} Box;

static void
cells_clear (Cells * cells)
{
  g_free (cells->cell);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Cells, cells_clear);

static void
cells_init (Cells * cells, const ClothTopology * t, guint most)
{
  guint lines[2] = { t->columns, t->rows };

  cells->n = t->n_vertices;
  cells->cell = g_new0 (guint, t->n_vertices);
  for (guint k = 0; k < 2; k++) {
    gdouble low = INFINITY, high = -INFINITY;
    guint n = MIN (most, t->columns ? lines[k] :
        MAX (2, (guint) sqrt (t->n_vertices)));

    for (gsize v = 0; v < t->n_vertices; v++) {
      low = MIN (low, t->uv[2 * v + k]);
      high = MAX (high, t->uv[2 * v + k]);
    }
    for (gsize v = 0; v < t->n_vertices; v++) {
      gdouble at = high > low ? (t->uv[2 * v + k] - low) / (high - low) : 0.;
      guint line = MIN ((guint) (at * n + 1e-4), n - 1);

      cells->cell[v] += k ? line * cells->columns : line;
    }
    *(k ? &cells->rows : &cells->columns) = n;
  }
}

/* Sums over all cells above and left of each corner, [rows + 1][columns + 1]. */
static void
integrate (const Cells * cells, const gdouble * x, gdouble * sums,
    gdouble * counts)
{
  guint across = cells->columns + 1;
  gsize all = (gsize) across * (cells->rows + 1);

  memset (sums, 0, all * sizeof *sums);
  memset (counts, 0, all * sizeof *counts);
  for (guint v = 0; v < cells->n; v++) {
    guint row = cells->cell[v] / cells->columns;
    gsize at = (gsize) (row + 1) * across + cells->cell[v] % cells->columns + 1;

    if (isnan (x[v]))
      continue;
    sums[at] += x[v];
    counts[at] += 1.;
  }
  for (gsize at = across + 1; at < all; at++) {
    if (at % across == 0)
      continue;
    sums[at] += sums[at - 1] + sums[at - across] - sums[at - across - 1];
    counts[at] += counts[at - 1] + counts[at - across] - counts[at - across -
        1];
  }
}

static inline gdouble
inside (const gdouble * sums, guint across, guint top, guint bottom,
    guint left, guint right)
{
  return sums[bottom * across + right] - sums[top * across + right] -
      sums[bottom * across + left] + sums[top * across + left];
}

/* The best box. Either the outside is taken to be the null, that is 0, and the score is
 * the square that the box accounts for; or it has a mean of its own (@contrast). */
static Box
scan (const Cells * cells, const gdouble * x, gboolean contrast)
{
  guint across = cells->columns + 1, down = cells->rows + 1;
  g_autofree gdouble *sums = g_new (gdouble, 2 * (gsize) across * down);
  gdouble *counts = sums + (gsize) across * down;
  gdouble all, n;
  Box best = { 0, cells->rows, 0, cells->columns, -1. };

  integrate (cells, x, sums, counts);
  all = sums[(gsize) across * down - 1];
  n = counts[(gsize) across * down - 1];
  for (guint top = 0; top < cells->rows; top++)
    for (guint bottom = top + 1; bottom <= cells->rows; bottom++)
      for (guint left = 0; left < cells->columns; left++)
        for (guint right = left + 1; right <= cells->columns; right++) {
          gdouble k = inside (counts, across, top, bottom, left, right);
          gdouble sum = inside (sums, across, top, bottom, left, right);
          gdouble score = sum * sum / k;

          if (k < LEAST_VERTICES || (contrast && k >= n))
            continue;
          if (contrast) {
            gdouble over = sum / k - (all - sum) / (n - k);

            score = over > 0. ? k * (n - k) / n * over * over : 0.;
          }
          if (score > best.score)
            best = (Box) {
            top, bottom, left, right, score};
        }
  return best;
}

static gboolean
box_holds (const Box * box, const Cells * cells, guint v)
{
  guint row = cells->cell[v] / cells->columns;
  guint column = cells->cell[v] % cells->columns;

  return row >= box->top && row < box->bottom && column >= box->left &&
      column < box->right;
}

/* Mean excess of each vertex from a frame on, what is below the null counting as none; NaN
 * where too little is known. */
static void
average (const ClothExcess * excess, guint from, gdouble * x)
{
  g_autofree guint *counts = g_new0 (guint, excess->n);

  memset (x, 0, excess->n * sizeof *x);
  for (guint frame = from; frame < excess->n_frames; frame++)
    for (guint v = 0; v < excess->n; v++) {
      gsize at = (gsize) frame * excess->n + v;

      counts[v] += excess->known[at];
      x[v] += excess->known[at] ? excess->values[at] : 0.;
    }
  for (guint v = 0; v < excess->n; v++)
    x[v] = 4 * counts[v] < excess->n_frames - from ? NAN :
        MAX (x[v] / counts[v], 0.);
}

/* The best score over parts of the take that reach to its end; the mean over a shorter one
 * varies by more. @x is at hand; a place must be there. */
static gdouble
score_of (const Cells * cells, const gdouble * x, guint n_blocks, guint n_all)
{
  return scan (cells, x, FALSE).score * n_blocks / n_all;
}

/* Adds a block of time, drawn by chance. */
static void
draw_block (const gdouble * sums, const gdouble * counts, gsize row,
    guint block_frames, guint n_starts, ClothRandom * random, gdouble * sum,
    gdouble * count)
{
  gsize begin = (1 + cloth_random_below (random, n_starts)) * row;
  gsize end = begin + block_frames * row;

  for (gsize v = 0; v < row; v++) {
    sum[v] += sums[end + v] - sums[begin + v];
    count[v] += counts[end + v] - counts[begin + v];
  }
}

/* Blocks of time of the null, drawn by chance, over such blocks: a take over a null that is
 * known by as much of it. What the best box reaches no more often than @significance. */
static gdouble
find_threshold (const ClothExcess * null, const Cells * cells,
    guint block_frames, guint n_blocks, const ClothLocalisationOptions * o)
{
  guint n_starts, n_of_null;
  gsize row = null->n, last = null->n_frames * row;
  g_autofree gdouble *sums = g_new0 (gdouble, (null->n_frames + 1) * row);
  g_autofree gdouble *counts = g_new0 (gdouble, (null->n_frames + 1) * row);
  g_autofree gdouble *part = g_new (gdouble, 5 * row);
  g_autofree gdouble *best = g_new0 (gdouble, o->draws);
  gdouble *count = part + row, *under = part + 2 * row;
  gdouble *under_count = part + 3 * row, *x = part + 4 * row;
  gdouble wider;
  ClothRandom random;

  block_frames = MIN (block_frames, null->n_frames - 1);
  n_starts = null->n_frames - block_frames;
  n_of_null = MAX (2, null->n_frames / block_frames);
  /* few blocks lie closer to their own mean than to the true one */
  wider = sqrt (n_of_null / (n_of_null - 1.));
  for (guint frame = 0; frame < null->n_frames; frame++)
    for (gsize v = 0; v < row; v++) {
      gsize at = frame * row + v;

      sums[at + row] = sums[at] + (null->known[at] ? null->values[at] : 0.);
      counts[at + row] = counts[at] + null->known[at];
    }
  cloth_random_init (&random, o->seed);
  for (guint d = 0; d < o->draws; d++) {
    memset (part, 0, 4 * row * sizeof *part);
    for (guint b = 0; b < n_of_null; b++)
      draw_block (sums, counts, row, block_frames, n_starts, &random, under,
          under_count);
    for (guint b = 1; b <= n_blocks; b++) {
      draw_block (sums, counts, row, block_frames, n_starts, &random, part,
          count);
      for (gsize v = 0; v < row; v++) {
        gdouble mean = sums[last + v] / counts[last + v];
        gdouble over = PARTS + mean + wider * (part[v] / count[v] - mean);
        gdouble below = PARTS + mean + wider * (under[v] / under_count[v] -
            mean);

        x[v] = count[v] > 0. && under_count[v] > 0. ? MAX (0., PARTS * over /
            MAX (below, LEAST_UNDER * PARTS) - PARTS) : NAN;
      }
      best[d] = MAX (best[d], score_of (cells, x, b, n_blocks));
    }
  }
  qsort (best, o->draws, sizeof *best, cloth_compare_doubles);
  return best[MIN (o->draws - 1, (guint) ((1. - o->significance) * o->draws))];
}

/* Vertices of a place: of the box that stands out most, or of all that is above the null
 * when the rest of the cloth is, too. */
static void
find_place (const Cells * cells, const gdouble * x, gboolean * in)
{
  Box box = scan (cells, x, TRUE);
  gdouble sums[2] = { 0. };
  guint counts[2] = { 0 };

  for (guint v = 0; v < cells->n; v++) {
    in[v] = box_holds (&box, cells, v);
    if (isnan (x[v]))
      continue;
    sums[in[v]] += x[v];
    counts[in[v]]++;
  }
  if (counts[0] && sums[0] * counts[1] <= EVERYWHERE * sums[1] * counts[0])
    return;
  box = scan (cells, x, FALSE);
  for (guint v = 0; v < cells->n; v++)
    in[v] = box_holds (&box, cells, v);
}

/* Mean of the residual's square over the null in a place, frame by frame; NaN: not seen. */
static gdouble *
follow (const ClothExcess * excess, const gboolean * in)
{
  gdouble *series = g_new (gdouble, excess->n_frames);

  for (guint frame = 0; frame < excess->n_frames; frame++) {
    gdouble sum = 0.;
    guint count = 0;

    for (guint v = 0; v < excess->n; v++) {
      gsize at = (gsize) frame * excess->n + v;

      if (in[v] && excess->known[at]) {
        sum += 1. + excess->values[at] / PARTS;
        count++;
      }
    }
    series[frame] = count ? sum / count : NAN;
  }
  return series;
}

/* Where it left what it was before, going back from a frame where it surely had. */
static guint
go_back (const gdouble * series, guint frame)
{
  g_autoptr (GArray) before = g_array_new (FALSE, FALSE, sizeof (gdouble));
  gdouble least;

  for (guint i = 1; i < frame; i++)
    if (!isnan (series[i]))
      g_array_append_val (before, series[i]);
  if (!before->len)
    return frame;
  g_array_sort (before, cloth_compare_doubles);
  least = BEFORE_MARGIN * g_array_index (before, gdouble, (guint)
      (BEFORE_QUANTILE * (before->len - 1)));
  while (frame > 1 && !(series[frame - 1] <= least)
      && !isnan (series[frame - 1]))
    frame--;
  return frame;
}

/* Cumulative sum of what speaks for a gap (Page 1954, Biometrika 41); it begins where the
 * sum was last 0 when it reaches enough. */
static guint
find_onset (const ClothExcess * excess, const gdouble * times,
    const gboolean * in, const ClothLocalisationOptions * o)
{
  g_autofree gdouble *series = follow (excess, in);
  gdouble sum = 0.;
  guint last = 0;

  for (guint frame = 1; frame < excess->n_frames; frame++) {
    if (isnan (series[frame]))
      continue;
    sum += MIN (log (MAX (series[frame], LEAST_SQUARE) / o->onset_ratio),
        MOST_OF_ONE);
    if (!(sum > 0.)) {
      sum = 0.;
      last = frame;
    }
    if (sum < o->onset_evidence)
      continue;
    if (times[last + 1] - times[0] < o->beginning_s)
      return 0;
    frame = go_back (series, last + 1);
    return times[frame] - times[0] < o->beginning_s ? 0 : frame;
  }
  return 0;
}

static void
locate (ClothLocalisation * region, const ClothExcess * place,
    const ClothExcess * time, const ClothRecording * r, guint from,
    const ClothLocalisationOptions * o)
{
  g_auto (Cells) cells = { 0 };
  g_autofree gdouble *x = g_new (gdouble, r->n);
  g_autofree gboolean *in = g_new0 (gboolean, r->n);

  cells_init (&cells, r->scene->topology, FINE_LINES);
  average (place, from, x);
  find_place (&cells, x, in);
  for (guint pass = 0; pass < N_PASSES; pass++) {
    region->onset = find_onset (time, r->times, in, o);
    average (place, region->onset, x);
    find_place (&cells, x, in);
  }
  for (guint v = 0; v < r->n; v++)
    if (in[v])
      g_array_append_val (region->vertices, v);
}

/* @take: the residual of the simulation that was nudged to a take
 * @nulls: (array length=n_nulls): the residuals of some that lack nothing, of the same
 *   cloth; in each vertex the larger counts, and chance is that of the first
 * @n_nulls: how many, at least one
 * @alike: whether the first moves as the take does, frame by frame: then it is taken off
 * @options: how
 *
 * Returns: (transfer full): where the residual is more than chance makes the null, and
 *   from when on
 */
ClothLocalisation *
cloth_localisation_new (const ClothNudgedResidual * take,
    const ClothNudgedResidual * nulls, guint n_nulls, gboolean alike,
    const ClothLocalisationOptions * options)
{
  const ClothRecording *r = take->recording;
  ClothLocalisation *region = g_new0 (ClothLocalisation, 1);
  ClothLocalisationOptions doubtful = *options;
  g_autoptr (ClothExcess) sure = NULL, place = NULL, time = NULL;
  g_autoptr (ClothExcess) nothing = NULL;
  g_auto (Cells) cells = { 0 };
  g_autofree gdouble *x = g_new (gdouble, r->n);
  gdouble frame_s = (r->times[r->n_frames - 1] - r->times[0]) /
      (r->n_frames - 1);
  guint block = CLAMP ((guint) round (options->block_s / frame_s), 1,
      r->n_frames);
  guint n_blocks = MAX (1, r->n_frames / block), from = 0;

  region->vertices = g_array_new (FALSE, FALSE, sizeof (guint));
  doubtful.null_alike *= options->doubt;
  doubtful.null_other *= options->doubt;
  sure = cloth_excess_new (take, nulls, n_nulls, alike, TRUE, &doubtful);
  nothing = cloth_excess_new_null (nulls, options);
  cells_init (&cells, r->scene->topology, COARSE_LINES);
  for (guint b = 1; b <= n_blocks; b++) {
    guint begin = b < n_blocks ? r->n_frames - b * block : 0;
    gdouble score;

    average (sure, begin, x);
    score = score_of (&cells, x, b, n_blocks);
    if (score > region->score) {
      region->score = score;
      from = begin;
    }
  }
  region->threshold = find_threshold (nothing, &cells, block, n_blocks,
      options);
  if (!(region->score > region->threshold))
    return region;
  place = cloth_excess_new (take, nulls, n_nulls, alike, TRUE, options);
  time = cloth_excess_new (take, nulls, n_nulls, alike, FALSE, options);
  locate (region, place, time, r, from, options);
  return region;
}

/* @region: (nullable) (transfer full): a place
 */
void
cloth_localisation_free (ClothLocalisation * region)
{
  if (!region)
    return;
  g_array_unref (region->vertices);
  g_free (region);
}
