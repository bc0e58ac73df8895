/* The centres of dots: the ground around each, then the mean of what is brighter.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot-around.h"

#include <math.h>
#include <string.h>

#include "gst/vision/dot/dot-rows.h"

#define TILE CLOTH_DOT_TILE
#define MARGIN CLOTH_DOT_MARGIN
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

    spot->axes = cloth_dot_axes (spot->shape);
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

/* Lanes that are summed apart; the order of the sums is the same on every machine. */
#define LANES 8
#define INLINE static inline __attribute__((always_inline))

typedef gfloat Floats __attribute__((vector_size (4 * LANES)));
typedef gint32 Ints __attribute__((vector_size (4 * LANES)));
typedef guint8 Bytes __attribute__((vector_size (2 * LANES)));
typedef guint64 Pair __attribute__((vector_size (2 * LANES)));
typedef gint16 Shorts __attribute__((vector_size (4 * LANES)));
typedef gint16 HalfShorts __attribute__((vector_size (2 * LANES)));

/* Sums of 1, x, y, x², xy, y², lane by lane. */
typedef struct
{
  Floats m[6];
} Moments;

/* Adds columns at @x, by their sums of 1, y, y². */
INLINE void
add_columns (Moments * sum, Floats x, const Floats column[3])
{
  sum->m[0] += column[0];
  sum->m[1] += column[0] * x;
  sum->m[2] += column[1];
  sum->m[3] += column[0] * (x * x);
  sum->m[4] += column[1] * x;
  sum->m[5] += column[2];
}

INLINE void
total (const Moments * sum, gdouble m[6])
{
  for (gint k = 0; k < 6; k++) {
    const Floats v = sum->m[k];
    const Floats a = v + __builtin_shufflevector (v, v, 4, 5, 6, 7, 0, 1, 2, 3);
    const Floats b = a + __builtin_shufflevector (a, a, 2, 3, 0, 1, 6, 7, 4, 5);

    m[k] = b[0] + b[1];
  }
}

/* What of a picture is weighed, and how. */
typedef struct
{
  const ClothImage *luma;
  gint x0, y0;                  /* the middle, about */
  gint left, right;             /* columns of all rows */
  gint top, n;                  /* rows */
  const gint *first, *last;     /* columns of each */
  gfloat foot, gain;
} Weighing;

/* By way of 16 bits, for which compilers know instructions. */
INLINE Floats
floats_of_bytes (Bytes bytes)
{
  const Shorts shorts = __builtin_convertvector (bytes, Shorts);
  const HalfShorts half = __builtin_shufflevector (shorts, shorts, 0, 1, 2, 3,
      4, 5, 6, 7);

  return __builtin_convertvector (__builtin_convertvector (half, Ints), Floats);
}

/* @shares weighs each pixel by its luma, @edges counts those between foot and top. */
INLINE void
weigh_rows (const Weighing * weighing, gdouble shares[6], gdouble edges[6])
{
  static const Ints lane = { 0, 1, 2, 3, 4, 5, 6, 7 };
  static const Floats one = { 1, 1, 1, 1, 1, 1, 1, 1 }, zero = { 0 };
  const ClothImage *luma = weighing->luma;
  Moments all_shares = { 0 }, all_edges = { 0 };

  for (gint x = weighing->left; x <= weighing->right; x += LANES) {
    const Floats dx = __builtin_convertvector (lane + (x - weighing->x0),
        Floats);
    const gsize room = (gsize) MIN (LANES, luma->width - x);
    const guint8 *row = luma->data
        + (gsize) weighing->top * (gsize) luma->stride + x;
    Floats share[3] = { 0 }, edge[3] = { 0 };
    Floats dy = zero + (gfloat) (weighing->top - weighing->y0);

    for (gint i = 0; i < weighing->n; i++, row += luma->stride, dy += one) {
      const Ints inside = (lane >= weighing->first[i] - x)
          & (lane <= weighing->last[i] - x);
      const Floats dy2 = dy * dy;
      Bytes bytes = { 0 };
      Floats raw, s;
      Ints above, below, e;

      if (room == LANES) {
        guint64 eight;

        memcpy (&eight, row, LANES);
        bytes = (Bytes) (Pair) {
        eight};
      } else {
        memcpy (&bytes, row, room);
      }
      raw = (floats_of_bytes (bytes) - weighing->foot) * weighing->gain;
      above = inside & (raw > zero);
      below = raw < one;
      e = above & below;
      s = (Floats) ((((Ints) raw & below) | ((Ints) one & ~below)) & above);
      share[0] += s;
      share[1] += s * dy;
      share[2] += s * dy2;
      edge[0] += (Floats) ((Ints) one & e);
      edge[1] += (Floats) ((Ints) dy & e);
      edge[2] += (Floats) ((Ints) dy2 & e);
    }
    add_columns (&all_shares, dx, share);
    add_columns (&all_edges, dx, edge);
  }
  total (&all_shares, shares);
  total (&all_edges, edges);
}

static void
weigh_rows_plain (const Weighing * weighing, gdouble shares[6],
    gdouble edges[6])
{
  weigh_rows (weighing, shares, edges);
}

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2")
static void
weigh_rows_avx2 (const Weighing * weighing, gdouble shares[6], gdouble edges[6])
{
  weigh_rows (weighing, shares, edges);
}

#pragma GCC pop_options
#else
#define weigh_rows_avx2 weigh_rows_plain
#endif

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
  Weighing weighing = {
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
  if (detector->level >= CLOTH_SIMD_AVX2)
    weigh_rows_avx2 (&weighing, w, e);
  else
    weigh_rows_plain (&weighing, w, e);
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

    cloth_dot_find_rows (detector, spot, &rows);
    if (cloth_dot_look_around (detector, spot, &rows, &dot, &bends)
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
