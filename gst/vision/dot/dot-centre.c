/* The centres of dots: the ground around each, then the mean of what is brighter.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/vision/dot/dot-private.h"

#define TILE CLOTH_DOT_TILE
#define MARGIN CLOTH_DOT_MARGIN
/* How far the ring in which the ground is looked for goes beyond the window, px. */
#define RING 2.0
/* Half-axes of the inside, of the spot's. */
#define INSIDE 0.5
/* Fewest pixels that give the ground. */
#define MIN_GROUND 8
/* Least luma of a dot above its ground over the ground: the noise of a bright wall gives
 * spots as well. */
#define LEAST_WEBER 0.25f
/* Least share of the ring about a spot that was cut from another that is ground. */
#define LEAST_GROUND 0.5f
/* Variance of a centre without any noise, px², times the area: what sampling and the
 * tails of neighbours leave, measured on drawn dots of radius 2.5 to 15. */
#define METHOD_VARIANCE 0.0016f
/* Luma between these shares of the contrast is weighed; below it is ground, above
 * inside. So shading and noise of either do not move the centre. */
#define FOOT 0.1
#define TOP 0.9
/* The most neighbours that a window may be kept from. */
#define MAX_SIDES 8
/* The border between neighbours that lie above each other is taken for slanted by this,
 * so that each row has an end. */
#define LEAST_SLANT 1e-6
/* Of a distance, px. */
#define ROUNDING 1e-6
/* Own side of the line between two dots: nx·dx + ny·dy ≤ reach. */
typedef struct
{
  gdouble nx, ny, reach;
} Side;

/* The ellipse of second moments @shape. */
static ClothDotAxes
get_axes (const gdouble shape[3])
{
  const gdouble mean = (shape[0] + shape[2]) / 2;
  const gdouble half = (shape[0] - shape[2]) / 2;
  const gdouble root = sqrt (half * half + shape[1] * shape[1]);

  return (ClothDotAxes) {
  2 *sqrt (mean + root), 2 * sqrt (MAX (mean - root, 1.0 / 12)),
        root > 0 ? half / root : 1, root > 0 ? shape[1] / root : 0};
}

/* With half-axes @scale times as long and @margin longer. */
static ClothDotEllipse
get_ellipse (const ClothDotAxes * axes, gdouble scale, gdouble margin)
{
  const gdouble a = axes->a * scale + margin, b = axes->b * scale + margin;
  const gdouble p = (1 / (a * a) + 1 / (b * b)) / 2;
  const gdouble q = (1 / (a * a) - 1 / (b * b)) / 2;
  const gdouble A = p + q * axes->c, B = q * axes->s, C = p - q * axes->c;

  return (ClothDotEllipse) {
  -B / A, 1 / A, 1 / (a * a * b * b * A * A), sqrt (C) * a * b,
        sqrt (A) * a * b};
}

/* Half the extent of the ellipse of second moments @shape towards (@dx, @dy). */
static gdouble
extent_towards (const gdouble shape[3], gdouble dx, gdouble dy)
{
  const gdouble det = shape[0] * shape[2] - shape[1] * shape[1];

  return 2 * sqrt (det * (dx * dx + dy * dy) / (shape[2] * dx * dx
          - 2 * shape[1] * dx * dy + shape[0] * dy * dy));
}

/* Puts the candidates in the order of their tiles. */
static void
sort_candidates (ClothDotDetector * detector)
{
  const guint n = detector->candidates->len;
  const gint n_tiles = detector->columns * detector->rows;
  gint32 *ends = detector->heads;

  memset (ends, 0, (gsize) n_tiles * sizeof *ends);
  detector->widest = 0;
  for (guint i = 0; i < n; i++) {
    ClothDotCandidate *spot =
        &g_array_index (detector->candidates, ClothDotCandidate, i);

    spot->axes = get_axes (spot->shape);
    spot->tile = (gint) spot->y / TILE * detector->columns
        + (gint) spot->x / TILE;
    ends[spot->tile]++;
    detector->widest = MAX (detector->widest, spot->axes.a);
  }
  for (gint t = 1; t < n_tiles; t++)
    ends[t] += ends[t - 1];
  ends[n_tiles] = (gint32) n;
  g_array_set_size (detector->sorted, n);
  for (guint i = 0; i < n; i++) {
    const ClothDotCandidate *spot =
        &g_array_index (detector->candidates, ClothDotCandidate, i);

    g_array_index (detector->sorted, ClothDotPlace, --ends[spot->tile]) =
        (ClothDotPlace) {
    spot->x, spot->y, spot->axes.a, i};
  }
}

/* Where neighbours are so near that their edges would be weighed: the middle of the gap
 * is the border. */
static guint
find_sides (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    Side sides[MAX_SIDES])
{
  const gdouble own = spot->axes.a + 2 * MARGIN + ROUNDING;
  const gdouble reach = own + detector->widest;
  const gint left = MAX (0, (gint) floor ((spot->x - reach) / TILE));
  const gint right = MIN (detector->columns - 1,
      (gint) floor ((spot->x + reach) / TILE));
  const gint top = MAX (0, (gint) floor ((spot->y - reach) / TILE));
  const gint bottom = MIN (detector->rows - 1,
      (gint) floor ((spot->y + reach) / TILE));
  guint n = 0;

  for (gint j = top; j <= bottom; j++) {
    const gint32 *heads = detector->heads + j * detector->columns;

    for (gint32 k = heads[left]; k < heads[right + 1]; k++) {
      const ClothDotPlace *place =
          &g_array_index (detector->sorted, ClothDotPlace, k);
      const gdouble dx = place->x - spot->x, dy = place->y - spot->y;
      const gdouble square = dx * dx + dy * dy;
      const gdouble most = own + place->a;
      const ClothDotCandidate *other;
      gdouble distance, near, gap;

      if (square > most * most || square == 0 || n == MAX_SIDES)
        continue;
      other = &g_array_index (detector->candidates, ClothDotCandidate,
          place->index);
      distance = sqrt (square);
      near = extent_towards (spot->shape, dx, dy);
      gap = distance - near - extent_towards (other->shape, dx, dy);
      if (gap < 2 * MARGIN)
        sides[n++] = (Side) {
        dx / distance, dy / distance, near + gap / 2};
    }
  }
  return n;
}

static inline gdouble
in_reach (gdouble x)
{
  x = x < CLOTH_DOT_FAR_AWAY / 2 ? x : CLOTH_DOT_FAR_AWAY / 2;
  return x > -1 ? x : -1;
}

/* Leaves of the @n rows from @top on what is on the own side. */
static void
clip_rows (const Side * side, const ClothDotCandidate * spot, gint top, gint n,
    gint * first, gint * last)
{
  const gdouble nx = fabs (side->nx) < LEAST_SLANT
      ? copysign (LEAST_SLANT, side->nx) : side->nx;
  const gdouble slope = -side->ny / nx;
  const gdouble middle = spot->x + side->reach / nx;

  if (nx > 0)
    for (gint i = 0; i < n; i++)
      last[i] = MIN (last[i],
          cloth_dot_floor_place (in_reach (middle + slope * (top + i -
                      spot->y))));
  else
    for (gint i = 0; i < n; i++)
      first[i] = MAX (first[i],
          cloth_dot_ceil_place (in_reach (middle + slope * (top + i -
                      spot->y))));
}

/* Where the ellipses about @spot are. */
static void
find_rows (const ClothDotDetector * detector,
    const ClothDotCandidate * spot, ClothDotRows * rows)
{
  const ClothImage *luma = &detector->image->luma;
  const ClothDotEllipse inside = get_ellipse (&spot->axes, INSIDE, 0);
  gint y1;

  rows->window = get_ellipse (&spot->axes, 1, MARGIN);
  rows->ring = get_ellipse (&spot->axes, 1, MARGIN + RING);
  rows->y0 = MAX (0, (gint) ceil (spot->y - rows->ring.height));
  y1 = MIN (luma->height - 1, (gint) floor (spot->y + rows->ring.height));
  rows->n = CLAMP (y1 - rows->y0 + 1, 0, CLOTH_DOT_MAX_ROWS);
  rows->inside_y0 = MAX (0, (gint) floor (spot->y - inside.height));
  y1 = MIN (luma->height - 1, (gint) ceil (spot->y + inside.height));
  rows->inside_n = CLAMP (y1 - rows->inside_y0 + 1, 0, CLOTH_DOT_MAX_ROWS);
  detector->kernels->find_rows (&inside, spot->x, spot->y, rows->inside_y0,
      rows->inside_n, luma->width, rows->inside.first, rows->inside.last);
  detector->kernels->find_rows (&rows->window, spot->x, spot->y, rows->y0,
      rows->n, luma->width, rows->weighed.first, rows->weighed.last);
  detector->kernels->find_rows (&rows->ring, spot->x, spot->y, rows->y0,
      rows->n, luma->width, rows->around.first, rows->around.last);
}

static ClothDotTally
tally_ring (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    const ClothDotRows * rows, guint8 most)
{
  ClothDotTally tally = { 0 };

  detector->kernels->add_ring (&detector->image->luma, spot, rows, most,
      &tally);
  return tally;
}

/* Does a spot that was cut from another stand out? Where a wall's noise was cut there is
 * hardly any ground about it. */
static gboolean
is_apart (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    const ClothDotRows * rows, const ClothDot * dot)
{
  const guint8 middle = (guint8) ((dot->colour[0] + dot->background) / 2);
  const ClothDotTally dark = tally_ring (detector, spot, rows, middle);
  const ClothDotTally all = tally_ring (detector, spot, rows, 255);

  return (gfloat) dark.n >= LEAST_GROUND * (gfloat) all.n;
}

static gint64
sum_chroma (const ClothPlanarImage * image, const ClothDotRows * rows, gint k)
{
  gint64 sum = 0;

  for (gint i = 0; i < rows->inside_n; i++) {
    const guint8 *chroma = image->chroma[k]
        + (gsize) ((rows->inside_y0 + i) >> image->chroma_shift[1])
        * (gsize) image->chroma_stride;

    for (gint x = rows->inside.first[i]; x <= rows->inside.last[i]; x++)
      sum += chroma[(x >> image->chroma_shift[0]) * image->chroma_step];
  }
  return sum;
}

/* Luma of the ground, mean colour of the inside, noise. FALSE when there is no inside or
 * too little contrast. */
static gboolean
look_around (const ClothDotDetector * detector,
    const ClothDotCandidate * spot, const ClothDotRows * rows, ClothDot * dot,
    ClothDotBends * bends)
{
  const ClothPlanarImage *image = detector->image;
  ClothDotTally ground, bright = { 0 };

  detector->kernels->add_inside (&image->luma, rows, &bright, bends);
  if (bright.n == 0)
    return FALSE;
  ground = tally_ring (detector, spot, rows, spot->threshold);
  dot->background = ground.n >= MIN_GROUND
      ? (gfloat) ground.sum / (gfloat) ground.n
      : (gfloat) detector->low[(gint) spot->y / TILE * detector->columns
      + (gint) spot->x / TILE];
  dot->colour[0] = (gfloat) bright.sum / (gfloat) bright.n;
  if (dot->colour[0] - dot->background < MAX (detector->params.contrast,
          LEAST_WEBER * dot->background))
    return FALSE;
  for (gint k = 0; k < 2; k++)
    dot->colour[1 + k] = image->chroma[k]
        ? (gfloat) sum_chroma (image, rows, k) / (gfloat) bright.n : 128;
  return !spot->touches || is_apart (detector, spot, rows, dot);
}

/* Weighs the window by what luma has above the foot, at most up to the top. With white
 * noise σ only pixels between both pass it on: cov = (σ·gain)²·Σ (p − c)(p − c)ᵀ / (Σw)²,
 * here without σ². FALSE where the picture's border cuts the window. */
static gboolean
weigh_window (const ClothDotDetector * detector,
    const ClothDotCandidate * spot, const ClothDotRows * rows, ClothDot * dot)
{
  const ClothImage *luma = &detector->image->luma;
  const ClothDotEllipse *window = &rows->window;
  const gfloat contrast = dot->colour[0] - dot->background;
  ClothDotWeighing weighing = {
    .luma = luma,.x0 = (gint) floor (spot->x),.y0 = (gint) floor (spot->y),
    .foot = dot->background + (gfloat) FOOT * contrast,
    .gain = 1 / ((gfloat) (TOP - FOOT) * contrast),
    .left = (gint) floor (spot->x - window->width),
    .right = (gint) ceil (spot->x + window->width),
    .top = (gint) ceil (spot->y - window->height)
  };
  const gint last_row = (gint) floor (spot->y + window->height);
  ClothDotSpans own;
  Side sides[MAX_SIDES];
  gdouble w[6], e[6], c[2], scale;
  guint n_sides;

  if (spot->x - window->width < 0
      || spot->x + window->width > luma->width - 1
      || spot->y - window->height < 0
      || spot->y + window->height > luma->height - 1)
    return FALSE;
  weighing.n = last_row - weighing.top + 1;
  weighing.first = rows->weighed.first + (weighing.top - rows->y0);
  weighing.last = rows->weighed.last + (weighing.top - rows->y0);
  n_sides = find_sides (detector, spot, sides);
  if (n_sides > 0) {
    memcpy (own.first, weighing.first, (gsize) weighing.n * sizeof (gint));
    memcpy (own.last, weighing.last, (gsize) weighing.n * sizeof (gint));
    for (guint k = 0; k < n_sides; k++)
      clip_rows (&sides[k], spot, weighing.top, weighing.n, own.first,
          own.last);
    weighing.first = own.first;
    weighing.last = own.last;
  }
  detector->kernels->weigh (&weighing, w, e);
  if (!(w[0] > 1))
    return FALSE;
  c[0] = w[1] / w[0];
  c[1] = w[2] / w[0];
  scale = weighing.gain * weighing.gain / (w[0] * w[0]);
  dot->x = (gfloat) (weighing.x0 + c[0]);
  dot->y = (gfloat) (weighing.y0 + c[1]);
  dot->area = (gfloat) w[0];
  for (gint k = 0; k < 3; k++) {
    const gint i = k / 2, j = (k + 1) / 2;

    dot->shape[k] = (gfloat) (w[3 + k] / w[0] - c[i] * c[j]
        + (k == 1 ? 0 : 1.0 / 12));
    dot->cov[k] = (gfloat) ((e[3 + k] - c[i] * e[1 + j] - c[j] * e[1 + i]
            + e[0] * c[i] * c[j]) * scale);
  }
  dot->touches = spot->touches;
  return TRUE;
}

/* Appends a dot for each candidate that has contrast and lies whole in the picture. */
void
cloth_dot_measure (ClothDotDetector * detector)
{
  ClothDotBends all = { 0 };

  sort_candidates (detector);
  for (guint i = 0; i < detector->candidates->len; i++) {
    const ClothDotCandidate *spot =
        &g_array_index (detector->candidates, ClothDotCandidate, i);
    ClothDotBends bends = { 0 };
    ClothDot dot;
    ClothDotRows rows;

    find_rows (detector, spot, &rows);
    if (look_around (detector, spot, &rows, &dot, &bends)
        && weigh_window (detector, spot, &rows, &dot)
        && dot.area >= detector->params.min_area) {
      g_array_append_val (detector->dots, dot);
      all.sum += bends.sum;
      all.count += bends.count;
    }
  }
  if (all.count > 0)
    detector->noise =
        (gfloat) sqrt ((gdouble) all.sum / (36.0 * (gdouble) all.count));
  for (guint i = 0; i < detector->dots->len; i++) {
    ClothDot *dot = &g_array_index (detector->dots, ClothDot, i);

    for (gint n = 0; n < 3; n++)
      dot->cov[n] = dot->cov[n] * detector->noise * detector->noise
          + (n == 1 ? 0 : METHOD_VARIANCE / dot->area);
  }
}
