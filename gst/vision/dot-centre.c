/* The centres of dots: the ground around each, then the mean of what is brighter.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot-private.h"

#include <math.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "gst/vision/dot-rows.h"

#define TILE CLOTH_DOT_TILE
/* Half-axes of the window that is weighed are longer than the spot's by this, px: the
 * blur of the edge. The ground is looked for in the ring outside. */
#define MARGIN 1.5
#define RING 2.0
/* Half-axes of the inside, of the spot's. */
#define INSIDE 0.5
/* Variance of a centre without any noise, px², times the area: what sampling and the
 * tails of neighbours leave, measured on drawn dots of radius 2.5 to 15. */
#define METHOD_VARIANCE 0.0016f
/* Luma between these shares of the contrast is weighed; below it is ground, above
 * inside. So shading and noise of either do not move the centre. */
#define FOOT 0.1
#define TOP 0.9
/* The most neighbours that a window may be kept from. */
#define MAX_SIDES 8
/* Of a distance, px. */
#define ROUNDING 1e-6
/* The most rows that a window and the ring about it may have. */
#define MAX_ROWS 512
/* Fewest pixels that give the ground. */
#define MIN_GROUND 8
/* Least luma of a dot above its ground over the ground: the noise of a bright wall gives
 * spots as well. */
#define LEAST_WEBER 0.25f

/* Least share of the ring about a spot that was cut from another that is ground. */
#define LEAST_GROUND 0.5f

/* Own side of the line between two dots: nx·dx + ny·dy ≤ reach. */
typedef struct
{
  gdouble nx, ny, reach;
} Side;

/* Squares of what Immerkær's mask (1 −2 1) × (1 −2 1) gives (1996, “Fast noise variance
 * estimation”): shading that bends along one axis only does not show in it. */
typedef struct
{
  gint64 sum, count;
} Bends;

/* Half the extent of the ellipse of second moments @shape towards (@ux, @uy). */
static gdouble
extent_towards (const gdouble shape[3], gdouble ux, gdouble uy)
{
  const gdouble det = shape[0] * shape[2] - shape[1] * shape[1];

  return 2 * sqrt (det / (shape[2] * ux * ux - 2 * shape[1] * ux * uy
          + shape[0] * uy * uy));
}

static void
sort_candidates (ClothDotDetector * detector)
{
  for (gint t = 0; t < detector->columns * detector->rows; t++)
    detector->heads[t] = -1;
  detector->widest = 0;
  for (guint i = 0; i < detector->candidates->len; i++) {
    ClothDotCandidate *spot =
        &g_array_index (detector->candidates, ClothDotCandidate, i);
    gint32 *head =
        &detector->heads[(gint) spot->y / TILE * detector->columns +
        (gint) spot->x / TILE];

    spot->axes = cloth_dot_axes (spot->shape);
    spot->next = *head;
    *head = (gint32) i;
    detector->widest = MAX (detector->widest, spot->axes.a);
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
    for (gint i = left; i <= right; i++) {
      for (gint32 k = detector->heads[j * detector->columns + i]; k >= 0;) {
        const ClothDotCandidate *other =
            &g_array_index (detector->candidates, ClothDotCandidate, k);
        const gdouble dx = other->x - spot->x, dy = other->y - spot->y;
        const gdouble square = dx * dx + dy * dy;
        const gdouble most = own + other->axes.a;
        gdouble distance, near, gap;

        k = other->next;
        if (square == 0 || square > most * most || n == MAX_SIDES)
          continue;
        distance = sqrt (square);
        near = extent_towards (spot->shape, dx / distance, dy / distance);
        gap = distance - near
            - extent_towards (other->shape, dx / distance, dy / distance);
        if (gap < 2 * MARGIN)
          sides[n++] = (Side) {
          dx / distance, dy / distance, near + gap / 2};
      }
    }
  }
  return n;
}

/* Leaves of row @y what is on the own side. */
static inline void
clip_row (const Side * side, const ClothDotCandidate * spot, gint y,
    gint * first, gint * last)
{
  const gdouble left = side->reach - side->ny * (y - spot->y);

  if (fabs (side->nx) < 1e-6) {
    if (left < 0)
      *last = *first - 1;
  } else if (side->nx > 0) {
    *last = (gint) MIN (*last, floor (spot->x + left / side->nx));
  } else {
    *first = (gint) MAX (*first, ceil (spot->x + left / side->nx));
  }
}

/* Where the ellipses about a dot are, row by row. */
typedef struct
{
  ClothDotEllipse window;
  gint y0, n;
  struct
  {
    gint first[MAX_ROWS], last[MAX_ROWS];
  } inside, weighed, ring;
} Rows;

static void
find_rows (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    Rows * rows)
{
  const ClothImage *luma = &detector->image->luma;
  const ClothDotEllipse inside = cloth_dot_ellipse (&spot->axes, INSIDE, 0);
  const ClothDotEllipse ring =
      cloth_dot_ellipse (&spot->axes, 1, MARGIN + RING);
  gint y1;

  rows->window = cloth_dot_ellipse (&spot->axes, 1, MARGIN);
  rows->y0 = MAX (0, (gint) ceil (spot->y - ring.height));
  y1 = MIN (luma->height - 1, (gint) floor (spot->y + ring.height));
  rows->n = CLAMP (y1 - rows->y0 + 1, 0, MAX_ROWS);
  cloth_dot_ellipse_rows (&inside, spot->x, spot->y, rows->y0, rows->n,
      luma->width, rows->inside.first, rows->inside.last, detector->level);
  cloth_dot_ellipse_rows (&rows->window, spot->x, spot->y, rows->y0, rows->n,
      luma->width, rows->weighed.first, rows->weighed.last, detector->level);
  cloth_dot_ellipse_rows (&ring, spot->x, spot->y, rows->y0, rows->n,
      luma->width, rows->ring.first, rows->ring.last, detector->level);
}

/* Sum and number of pixels; those that vectors have summed wait in halves. */
typedef struct
{
  gint64 sum, n;
#ifdef __SSE2__
  __m128i sums, counts;
#endif
} Tally;

/* Counts the pixels from @start to before @end of a row that are not above @most. */
static inline void
add_dark (const guint8 * row, gint start, gint end, gint width, guint8 most,
    gboolean vectors, Tally * tally)
{
#ifdef __SSE2__
  const __m128i lane = _mm_set_epi8 (15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4,
      3, 2, 1, 0);
  const __m128i zero = _mm_setzero_si128 (), one = _mm_set1_epi8 (1);

  for (; vectors && start < end && start + 16 <= width; start += 16) {
    const __m128i v = _mm_loadu_si128 ((const __m128i *) (row + start));
    const __m128i left = _mm_set1_epi8 ((gchar) MIN (end - start, 16));
    const __m128i above = _mm_subs_epu8 (v, _mm_set1_epi8 ((gchar) most));
    const __m128i is_dark = _mm_and_si128 (_mm_cmpeq_epi8 (above, zero),
        _mm_cmpgt_epi8 (left, lane));

    tally->sums = _mm_add_epi64 (tally->sums,
        _mm_sad_epu8 (_mm_and_si128 (v, is_dark), zero));
    tally->counts = _mm_add_epi64 (tally->counts,
        _mm_sad_epu8 (_mm_and_si128 (one, is_dark), zero));
  }
#endif
  for (gint x = start; x < end; x++) {
    const gint is_dark = row[x] <= most;

    tally->sum += is_dark * row[x];
    tally->n += is_dark;
  }
}

static void
finish_tally (Tally * tally)
{
#ifdef __SSE2__
  tally->sum += _mm_cvtsi128_si32 (_mm_add_epi64 (tally->sums,
          _mm_srli_si128 (tally->sums, 8)));
  tally->n += _mm_cvtsi128_si32 (_mm_add_epi64 (tally->counts,
          _mm_srli_si128 (tally->counts, 8)));
#endif
}

static void
add_bends (const ClothImage * luma, gint y, gint first, gint last,
    Bends * bends)
{
  const guint8 *row = luma->data + (gsize) y * (gsize) luma->stride;
  const guint8 *above = row - luma->stride, *below = row + luma->stride;

  if (y < 1 || y > luma->height - 2)
    return;
  for (gint x = MAX (1, first); x <= MIN (luma->width - 2, last); x++) {
    const gint bend = above[x - 1] - 2 * above[x] + above[x + 1]
        - 2 * (row[x - 1] - 2 * row[x] + row[x + 1])
        + below[x - 1] - 2 * below[x] + below[x + 1];

    bends->sum += bend * bend;
    bends->count++;
  }
}

/* Does a spot that was cut from another stand out? Where a wall's noise was cut there is
 * hardly any ground about it. */
static gboolean
is_apart (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    const Rows * rows, const ClothDot * dot)
{
  const ClothImage *luma = &detector->image->luma;
  const gboolean vectors = detector->level != CLOTH_SIMD_SCALAR;
  const guint8 middle = (guint8) ((dot->colour[0] + dot->background) / 2);
  Tally dark = { 0 };
  gint64 n = 0;

  for (gint i = 0; i < rows->n; i++) {
    const guint8 *row = luma->data
        + (gsize) (rows->y0 + i) * (gsize) luma->stride;
    const gint first = rows->ring.first[i], end = rows->ring.last[i] + 1;
    gint from = rows->weighed.first[i], to = rows->weighed.last[i] + 1;

    if (first >= end)
      continue;
    if (from >= to)
      from = to = end;
    add_dark (row, first, MIN (from, end), luma->width, middle, vectors, &dark);
    add_dark (row, MAX (to, first), end, luma->width, middle, vectors, &dark);
    n += MAX (0, MIN (from, end) - first) + MAX (0, end - MAX (to, first));
  }
  finish_tally (&dark);
  return (gfloat) dark.n >= LEAST_GROUND * (gfloat) n;
}

/* Luma of the ground, mean colour of the inside, noise. FALSE when there is no inside or
 * too little contrast. */
static gboolean
look_around (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    const Rows * rows, ClothDot * dot, Bends * bends)
{
  const ClothDotImage *image = detector->image;
  const ClothImage *luma = &image->luma;
  const gboolean vectors = detector->level != CLOTH_SIMD_SCALAR;
  Tally ground = { 0 }, bright = { 0 };
  gint64 sum[3] = { 0 };

  for (gint i = 0; i < rows->n; i++) {
    const gint y = rows->y0 + i;
    const guint8 *row = luma->data + (gsize) y * (gsize) luma->stride;
    const gint first = rows->ring.first[i], end = rows->ring.last[i] + 1;
    gint from = rows->weighed.first[i], to = rows->weighed.last[i];

    if (first >= end)
      continue;
    if (from > to)
      from = end, to = end - 1;
    add_dark (row, first, MIN (from, end), luma->width, spot->threshold,
        vectors, &ground);
    add_dark (row, MAX (to + 1, first), end, luma->width, spot->threshold,
        vectors, &ground);
    from = rows->inside.first[i], to = rows->inside.last[i];
    if (from > to)
      continue;
    add_dark (row, from, to + 1, luma->width, 255, vectors, &bright);
    add_bends (luma, y, from, to, bends);
    for (gint k = 0; k < 2 && image->chroma[k]; k++) {
      const guint8 *chroma = image->chroma[k]
          + (gsize) (y >> image->chroma_shift[1])
          * (gsize) image->chroma_stride;

      for (gint x = from; x <= to; x++)
        sum[1 + k] +=
            chroma[(x >> image->chroma_shift[0]) * image->chroma_step];
    }
  }
  finish_tally (&ground);
  finish_tally (&bright);
  if (bright.n == 0)
    return FALSE;
  sum[0] = bright.sum;
  dot->background = ground.n >= MIN_GROUND
      ? (gfloat) ground.sum / (gfloat) ground.n
      : (gfloat) detector->low[(gint) spot->y / TILE * detector->columns
      + (gint) spot->x / TILE];
  for (gint k = 0; k < 3; k++)
    dot->colour[k] = k == 0 || image->chroma[k - 1]
        ? (gfloat) sum[k] / (gfloat) bright.n : 128;
  if (dot->colour[0] - dot->background < MAX (detector->params.contrast,
          LEAST_WEBER * dot->background))
    return FALSE;
  return !spot->touches || is_apart (detector, spot, rows, dot);
}

/* Lanes that are summed apart; the order of the sums is the same on every machine. */
#define LANES 8
#define INLINE static inline __attribute__((always_inline))

typedef gfloat Floats __attribute__((vector_size (4 * LANES)));
typedef gint32 Ints __attribute__((vector_size (4 * LANES)));
typedef guint8 Bytes __attribute__((vector_size (LANES)));

/* Sums of 1, x, y, x², xy, y², lane by lane. */
typedef struct
{
  Floats m[6];
} Moments;

INLINE void
add_row (Moments * sum, Floats n, Floats x, Floats xx, gfloat dy)
{
  sum->m[0] += n;
  sum->m[1] += x;
  sum->m[2] += n * dy;
  sum->m[3] += xx;
  sum->m[4] += x * dy;
  sum->m[5] += n * (dy * dy);
}

static void
total (const Moments * sum, gdouble m[6])
{
  for (gint k = 0; k < 6; k++) {
    m[k] = 0;
    for (gint i = 0; i < LANES; i++)
      m[k] += sum->m[k][i];
  }
}

/* Adds the pixels from @first to @last of a row: @shares weighs each by its luma, @edges
 * counts those between foot and top. */
INLINE void
weigh_row (const guint8 * row, gint first, gint last, gint width, gint x0,
    gfloat dy, gfloat foot, gfloat gain, Moments * shares, Moments * edges)
{
  static const Ints lane = { 0, 1, 2, 3, 4, 5, 6, 7 };
  Floats n = { 0 }, nx = { 0 }, nxx = { 0 };
  Floats e = { 0 }, ex = { 0 }, exx = { 0 };

  for (gint x = first; x <= last; x += LANES) {
    const Ints inside = lane <= last - x;
    const Floats dx = __builtin_convertvector (lane + (x - x0), Floats);
    const Floats one = { 1, 1, 1, 1, 1, 1, 1, 1 };
    Bytes bytes = { 0 };
    Floats raw, share, edge;
    Ints above, below;

    if (x + LANES <= width)
      memcpy (&bytes, row + x, LANES);
    else
      memcpy (&bytes, row + x, (gsize) (width - x));
    raw = (__builtin_convertvector (bytes, Floats) - foot) * gain;
    above = inside & (raw > 0);
    below = raw < 1;
    edge = (Floats) ((Ints) one & above & below);
    share = (Floats) ((((Ints) raw & below) | ((Ints) one & ~below)) & above);
    n += share;
    nx += share * dx;
    nxx += share * dx * dx;
    e += edge;
    ex += edge * dx;
    exx += edge * dx * dx;
  }
  add_row (shares, n, nx, nxx, dy);
  add_row (edges, e, ex, exx, dy);
}

/* What of a picture is weighed, and how. */
typedef struct
{
  const ClothImage *luma;
  const ClothDotCandidate *spot;
  const Rows *rows;
  Side sides[MAX_SIDES];
  guint n_sides;
  gint x0, y0;
  gfloat foot, gain;
} Weighing;

INLINE void
weigh_rows (const Weighing * weighing, Moments * shares, Moments * edges)
{
  const ClothImage *luma = weighing->luma;
  const ClothDotCandidate *spot = weighing->spot;
  const Rows *rows = weighing->rows;
  const gint last_row = (gint) floor (spot->y + rows->window.height);

  for (gint y = (gint) ceil (spot->y - rows->window.height); y <= last_row; y++) {
    gint first = rows->weighed.first[y - rows->y0];
    gint last = rows->weighed.last[y - rows->y0];

    if (first > last)
      continue;
    for (guint k = 0; k < weighing->n_sides; k++)
      clip_row (&weighing->sides[k], spot, y, &first, &last);
    weigh_row (luma->data + (gsize) y * (gsize) luma->stride, first, last,
        luma->width, weighing->x0, (gfloat) (y - weighing->y0),
        weighing->foot, weighing->gain, shares, edges);
  }
}

static void
weigh_rows_plain (const Weighing * weighing, Moments * shares, Moments * edges)
{
  weigh_rows (weighing, shares, edges);
}

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2")
static void
weigh_rows_avx2 (const Weighing * weighing, Moments * shares, Moments * edges)
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
    const ClothDotCandidate * spot, const Rows * rows, ClothDot * dot)
{
  const ClothImage *luma = &detector->image->luma;
  const ClothDotEllipse *window = &rows->window;
  const gfloat contrast = dot->colour[0] - dot->background;
  Weighing weighing = {
    .luma = luma,.spot = spot,.rows = rows,
    .x0 = (gint) floor (spot->x),.y0 = (gint) floor (spot->y),
    .foot = dot->background + (gfloat) FOOT * contrast,
    .gain = 1 / ((gfloat) (TOP - FOOT) * contrast)
  };
  Moments shares = { 0 }, edges = { 0 };
  gdouble w[6], e[6], c[2], scale;

  if (spot->x - window->width < 0
      || spot->x + window->width > luma->width - 1
      || spot->y - window->height < 0
      || spot->y + window->height > luma->height - 1)
    return FALSE;
  weighing.n_sides = find_sides (detector, spot, weighing.sides);
  if (detector->level >= CLOTH_SIMD_AVX2)
    weigh_rows_avx2 (&weighing, &shares, &edges);
  else
    weigh_rows_plain (&weighing, &shares, &edges);
  total (&shares, w);
  total (&edges, e);
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
  Bends all = { 0 };

  sort_candidates (detector);
  for (guint i = 0; i < detector->candidates->len; i++) {
    const ClothDotCandidate *spot =
        &g_array_index (detector->candidates, ClothDotCandidate, i);
    Bends bends = { 0 };
    ClothDot dot;
    Rows rows;

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
