/* A piece of checkerboard in a grid of its own: its corners, its squares, its rim.
 *
 * Linking joins saddles, and a saddle needs four squares around it. The squares on the
 * board's rim lack some of them: their outer corners are looked for here, where the grid
 * says they should lie, and fitted with a corner model that needs only two edges. What is
 * seen just beyond tells where the board ends.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/patch.h"

#include <math.h>

#include "gst/vision/checker/outline.h"
#include "gst/vision/checker/template.h"

/* Confidence from which the outline of a linked square is not checked. */
#define SURE 0.85f
/* Rounds of taking in squares beside those taken in before. */
#define ROUNDS 4
/* Near a cell's edge, in cells. */
#define NEAR_EDGE 0.1f
/* The shorter of two strides of the grid that follow each other over the longer. */
#define EVEN 0.7f

/* @patch: the patch
 *
 * Releases the memory a patch holds, not the patch itself.
 */
void
cloth_patch_clear (ClothPatch * patch)
{
  g_free (patch->memory);
  *patch = (ClothPatch) {
  0};
}

static void
make_room (ClothPatch * patch, gint columns, gint rows)
{
  gsize n = (gsize) columns * (gsize) rows;
  gfloat *at;

  patch->columns = columns;
  patch->rows = rows;
  if (n > patch->capacity) {
    g_free (patch->memory);
    patch->memory = g_malloc (n * (8 * sizeof (gfloat) + 4));
    patch->capacity = n;
  }
  at = patch->memory;
  patch->x = at;
  patch->y = at + n;
  patch->cov = at + 2 * n;
  patch->confidence = at + 5 * n;
  patch->inside = at + 6 * n;
  patch->bit = at + 7 * n;
  patch->kind = (guint8 *) (at + 8 * n);
  patch->square = patch->kind + n;
  patch->tried = patch->square + n;
  patch->linked = patch->tried + n;
  for (gsize k = 0; k < n; k++) {
    patch->kind[k] = CLOTH_VERTEX_UNKNOWN;
    patch->square[k] = patch->tried[k] = patch->linked[k] = 0;
    patch->confidence[k] = patch->inside[k] = patch->bit[k] = 0;
  }
}

static inline gboolean
known (const ClothPatch * patch, gint i, gint j)
{
  return i >= 0 && j >= 0 && i < patch->columns && j < patch->rows
      && patch->kind[j * patch->columns + i] != CLOTH_VERTEX_UNKNOWN;
}

/* The four corners of a cell in ring order. */
static const gint corner_i[4] = { 0, 1, 1, 0 };
static const gint corner_j[4] = { 0, 0, 1, 1 };

/* Extrapolates vertex (@i, @j) from those known around it: along rows and columns, and by
 * closing parallelograms. */
static gboolean
predict_vertex (const ClothPatch * patch, gint i, gint j, gfloat * x,
    gfloat * y)
{
  gfloat sum_x = 0, sum_y = 0, weight = 0;
  gint n = patch->columns;

  for (gint dj = -1; dj <= 1; dj++)
    for (gint di = -1; di <= 1; di++) {
      gint a, b;

      if (!di == !dj)
        continue;
      /* Straight on: 2 v(1) - v(2). */
      if (known (patch, i + di, j + dj)
          && known (patch, i + 2 * di, j + 2 * dj)) {
        a = (j + dj) * n + i + di;
        b = (j + 2 * dj) * n + i + 2 * di;
        sum_x += 2 * patch->x[a] - patch->x[b];
        sum_y += 2 * patch->y[a] - patch->y[b];
        weight += 1;
      }
    }
  for (gint dj = -1; dj <= 1; dj += 2)
    for (gint di = -1; di <= 1; di += 2) {
      gint a, b, c;

      if (!known (patch, i + di, j) || !known (patch, i, j + dj)
          || !known (patch, i + di, j + dj))
        continue;
      a = j * n + i + di;
      b = (j + dj) * n + i;
      c = (j + dj) * n + i + di;
      sum_x += patch->x[a] + patch->x[b] - patch->x[c];
      sum_y += patch->y[a] + patch->y[b] - patch->y[c];
      weight += 1;
    }
  if (weight == 0) {
    /* The far corner of a square of which one edge or one corner is known: shift it by
     * the neighbouring square's edges. */
    for (gint dj = -1; dj <= 1; dj += 2)
      for (gint di = -1; di <= 1; di += 2) {
        if (known (patch, i + di, j + dj)
            && known (patch, i + 2 * di, j + 2 * dj)) {
          gint a = (j + dj) * n + i + di, b = (j + 2 * dj) * n + i + 2 * di;

          sum_x += 2 * patch->x[a] - patch->x[b];
          sum_y += 2 * patch->y[a] - patch->y[b];
          weight += 1;
        }
      }
  }
  if (weight == 0)
    return FALSE;
  *x = sum_x / weight;
  *y = sum_y / weight;
  return TRUE;
}

/* Known corners as they are, the others extrapolated; the count of known ones, or -1
 * when one can't be told. */
static gint
cell_corners (const ClothPatch * patch, gint i, gint j, gfloat x[4],
    gfloat y[4])
{
  gint n_known = 0;

  for (gint k = 0; k < 4; k++) {
    gint ci = i + corner_i[k], cj = j + corner_j[k];

    if (known (patch, ci, cj)) {
      x[k] = patch->x[cj * patch->columns + ci];
      y[k] = patch->y[cj * patch->columns + ci];
      n_known++;
    } else if (!predict_vertex (patch, ci, cj, &x[k], &y[k])) {
      return -1;
    }
  }
  return n_known;
}

/* Grey level at (@s, @t) of the unit square, -1 outside the picture. */
static gint
cell_sample (const ClothImage * image, const gfloat x[4], const gfloat y[4],
    gfloat s, gfloat t)
{
  gfloat px = (1 - t) * ((1 - s) * x[0] + s * x[1]) + t * ((1 - s) * x[3]
      + s * x[2]);
  gfloat py = (1 - t) * ((1 - s) * y[0] + s * y[1]) + t * ((1 - s) * y[3]
      + s * y[2]);
  gint column = (gint) lrintf (px), row = (gint) lrintf (py);

  if (column < 0 || row < 0 || column >= image->width || row >= image->height)
    return -1;
  return image->data[row * image->stride + column];
}

/* Darkest and brightest of some samples of a cell, away from its edges and from the dot
 * a coded board may have at its centre. */
static gboolean
cell_range (const ClothImage * image, const gfloat x[4], const gfloat y[4],
    gfloat range[2])
{
  static const gfloat at[8][2] = {
    {0.22f, 0.22f}, {0.5f, 0.22f}, {0.78f, 0.22f}, {0.22f, 0.5f},
    {0.78f, 0.5f}, {0.22f, 0.78f}, {0.5f, 0.78f}, {0.78f, 0.78f}
  };

  range[0] = 255;
  range[1] = 0;
  for (gint k = 0; k < 8; k++) {
    gint level = cell_sample (image, x, y, at[k][0], at[k][1]);

    if (level < 0)
      return FALSE;
    range[0] = MIN (range[0], (gfloat) level);
    range[1] = MAX (range[1], (gfloat) level);
  }
  return TRUE;
}

/* Black and white as the squares seen around cell (@i, @j) show them. */
static gboolean
local_levels (const ClothPatch * patch, const ClothImage * image, gint i,
    gint j, gfloat * black, gfloat * white)
{
  gfloat sum[2] = { 0 };
  gint n[2] = { 0 };

  for (gint cj = MAX (j - 2, 0); cj <= MIN (j + 2, patch->rows - 2); cj++)
    for (gint ci = MAX (i - 2, 0); ci <= MIN (i + 2, patch->columns - 2); ci++) {
      gfloat x[4], y[4], range[2];
      gint colour = cloth_patch_is_black (patch, ci, cj);

      if ((ci == i && cj == j) || !patch->square[cj * patch->columns + ci])
        continue;
      if (cell_corners (patch, ci, cj, x, y) < 4
          || !cell_range (image, x, y, range))
        continue;
      sum[colour] += 0.5f * (range[0] + range[1]);
      n[colour]++;
    }
  if (!n[0] || !n[1])
    return FALSE;
  *white = sum[0] / (gfloat) n[0];
  *black = sum[1] / (gfloat) n[1];
  return *white > *black;
}

/* Looks for cell (@i, @j) where the grid puts it; takes it in if it is there. A white
 * square can be seen on the rim only of a board on dark cloth, a black one only on white
 * cloth; a cell that is none of the kind fails at once for want of edges. */
static gboolean
extend_cell (ClothPatch * patch, const ClothImage * image, gint i, gint j,
    const ClothPatchParams * params)
{
  ClothOutline outline = { {0} };
  gboolean black = cloth_patch_is_black (patch, i, j);
  gint at = j * patch->columns + i, n_known;
  gfloat confidence;

  n_known = cell_corners (patch, i, j, outline.x, outline.y);
  outline.thorough = params->thorough;
  /* The same corners would fail again. */
  if (n_known < 1 || n_known <= patch->tried[at])
    return FALSE;
  patch->tried[at] = (guint8) n_known;
  for (gint k = 0; k < 4; k++)
    outline.have[k] = known (patch, i + corner_i[k], j + corner_j[k]);
  if (!cloth_outline_complete (&outline, image, black))
    return FALSE;
  confidence = cloth_quad_confidence (image, outline.x, outline.y,
      params->alpha, black);
  if (confidence < params->c_low)
    return FALSE;
  for (gint k = 0; k < 4; k++) {
    gint to = (j + corner_j[k]) * patch->columns + i + corner_i[k];

    if (patch->kind[to] != CLOTH_VERTEX_UNKNOWN)
      continue;
    patch->kind[to] = !outline.saddle[k] ? CLOTH_VERTEX_RIM
        : outline.sure[k] || !params->thorough ? CLOTH_VERTEX_SADDLE
        : CLOTH_VERTEX_UNSURE;
    patch->x[to] = outline.x[k];
    patch->y[to] = outline.y[k];
    for (gint m = 0; m < 3; m++)
      patch->cov[3 * to + m] = outline.cov[k][m];
  }
  patch->square[at] = 1;
  patch->confidence[at] = confidence;
  return TRUE;
}

/* Takes in squares of one colour, beside those there and then beside these; whether one of
 * them lies on a rim. */
static gboolean
extend_colour (ClothPatch * patch, const ClothImage * image, gboolean black,
    const ClothPatchParams * params)
{
  gboolean added = TRUE, rim = FALSE;

  for (gint round = 0; round < ROUNDS && added; round++) {
    added = FALSE;
    for (gint j = 0; j + 1 < patch->rows; j++)
      for (gint i = 0; i + 1 < patch->columns; i++)
        if (!patch->square[j * patch->columns + i]
            && cloth_patch_is_black (patch, i, j) == black)
          added |= extend_cell (patch, image, i, j, params);
  }
  for (gint at = 0; at < patch->columns * patch->rows; at++)
    rim |= patch->kind[at] == CLOTH_VERTEX_RIM || (params->thorough
        && patch->kind[at] == CLOTH_VERTEX_UNSURE);
  return rim;
}

/* Measures a black square that linking found, and looks closer if it is no good one: its
 * corners may be chance crossings of a fold with the print. */
static void
check_square (ClothPatch * patch, const ClothImage * image, gint i, gint j,
    const ClothPatchParams * params)
{
  ClothOutline outline = { {0} };
  gint at = j * patch->columns + i;

  cell_corners (patch, i, j, outline.x, outline.y);
  patch->confidence[at] = cloth_quad_confidence (image, outline.x, outline.y,
      params->alpha, TRUE);
  if (patch->confidence[at] >= SURE)
    return;
  for (gint k = 0; k < 4; k++)
    outline.have[k] = TRUE;
  if (!cloth_outline_complete (&outline, image, TRUE))
    patch->square[at] = 0;
}

/* Widens a cell's range by samples close to those of its edges that are known: what
 * covers the board may leave a rim of the square in sight. */
static void
widen_range (const ClothPatch * patch, const ClothImage * image, gint i,
    gint j, const gfloat x[4], const gfloat y[4], gfloat range[2])
{
  static const gfloat at[4][2] = {
    {0.5f, NEAR_EDGE}, {1 - NEAR_EDGE, 0.5f}, {0.5f, 1 - NEAR_EDGE},
    {NEAR_EDGE, 0.5f}
  };

  for (gint k = 0; k < 4; k++) {
    const gint to = (k + 1) & 3;
    gint level;

    if (!known (patch, i + corner_i[k], j + corner_j[k])
        || !known (patch, i + corner_i[to], j + corner_j[to])
        || (level = cell_sample (image, x, y, at[k][0], at[k][1])) < 0)
      continue;
    range[0] = MIN (range[0], (gfloat) level);
    range[1] = MAX (range[1], (gfloat) level);
  }
}

/* Whether the corners of cell (@i, @j) that lie on a rim are about as far from those
 * before them as these are from those before: squares that something cuts off end anywhere,
 * and what is beyond is no cell. */
static gboolean
is_even (const ClothPatch * patch, gint i, gint j)
{
  const gint n = patch->columns;

  for (gint k = 0; k < 4; k++) {
    const gint ci = i + corner_i[k], cj = j + corner_j[k], at = cj * n + ci;

    if (patch->kind[at] != CLOTH_VERTEX_RIM)
      continue;
    for (gint way = 0; way < 2; way++) {
      const gint di = way ? 0 : (corner_i[k] ? 1 : -1);
      const gint dj = way ? (corner_j[k] ? 1 : -1) : 0;
      const gint one = (cj + dj) * n + ci + di;
      const gint two = (cj + 2 * dj) * n + ci + 2 * di;
      gfloat outer, inner;

      if (!known (patch, ci + di, cj + dj)
          || !known (patch, ci + 2 * di, cj + 2 * dj))
        continue;
      outer = hypotf (patch->x[at] - patch->x[one],
          patch->y[at] - patch->y[one]);
      inner = hypotf (patch->x[one] - patch->x[two],
          patch->y[one] - patch->y[two]);
      if (MIN (outer, inner) < EVEN * MAX (outer, inner))
        return FALSE;
    }
  }
  return TRUE;
}

/* Whether the board goes on at cell (@i, @j), which was not seen as a square: hardly, if
 * it shows the other colour. Its own colour says nothing, for the cloth has it too, and
 * neither does what differs from the print around. */
static gfloat
judge_cell (const ClothPatch * patch, const ClothImage * image, gint i, gint j,
    const ClothPatchParams * params)
{
  gfloat x[4], y[4], range[2], black, white, other, reach;

  if (cell_corners (patch, i, j, x, y) < 1 || !cell_range (image, x, y, range)
      || !is_even (patch, i, j)
      || !local_levels (patch, image, i, j, &black, &white))
    return 0;
  widen_range (patch, image, i, j, x, y, range);
  other = cloth_patch_is_black (patch, i, j) ? white : black;
  reach = params->alike * (white - black);
  return range[0] > other - reach && range[1] < other + reach
      ? params->other_colour : 0;
}

/* Log-likelihood ratio that the square carries a dot of the other colour. */
static gfloat
read_bit (const ClothPatch * patch, const ClothImage * image, gint i, gint j)
{
  gfloat x[4], y[4], black, white, level, own, other;
  gint centre;

  if (cell_corners (patch, i, j, x, y) < 4
      || !local_levels (patch, image, i, j, &black, &white)
      || (centre = cell_sample (image, x, y, 0.5f, 0.5f)) < 0)
    return 0;
  level = (gfloat) centre;
  own = cloth_patch_is_black (patch, i, j) ? black : white;
  other = cloth_patch_is_black (patch, i, j) ? white : black;
  /* A small dot is blurred: half way to the other colour is already a dot. */
  return CLAMP (8 * ((level - own) / (other - own) - 0.4f), -3.0f, 3.0f);
}

/* @patch: (out caller-allocates): zeroed before its first use; keeps its memory
 * @image: the picture
 * @saddles: the saddles that were linked
 * @link: one patch of them
 * @params: parameters
 *
 * Takes over a linked patch, adds the squares around it that linking can't see, and
 * judges the cells beyond.
 */
void
cloth_patch_build (ClothPatch * patch, const ClothImage * image,
    const ClothSaddle * saddles, const ClothLinkPatch * link,
    const ClothPatchParams * params)
{
  const gint margin = CLOTH_PATCH_MARGIN;
  gint n;

  make_room (patch, link->columns + 2 * margin, link->rows + 2 * margin);
  n = patch->columns;
  patch->odd_black = link->odd_black;
  patch->n_squares = 0;
  for (gint j = 0; j < link->rows; j++)
    for (gint i = 0; i < link->columns; i++) {
      gint from = link->node[j * link->columns + i];
      gint at = (j + margin) * n + i + margin;

      patch->square[at] = link->square[j * link->columns + i];
      if (from < 0)
        continue;
      patch->kind[at] = CLOTH_VERTEX_SADDLE;
      patch->linked[at] = 1;
      patch->x[at] = saddles[from].x;
      patch->y[at] = saddles[from].y;
      for (gint m = 0; m < 3; m++)
        patch->cov[3 * at + m] = saddles[from].cov[m];
    }
  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < n; i++)
      if (patch->square[j * n + i] && cloth_patch_is_black (patch, i, j))
        check_square (patch, image, i, j, params);
  /* The rim has squares of the colour that the cloth has not. */
  if (!extend_colour (patch, image, TRUE, params))
    extend_colour (patch, image, FALSE, params);
  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < n; i++) {
      gint at = j * n + i;

      if (!patch->square[at] && !cloth_patch_is_black (patch, i, j)
          && known (patch, i, j) && known (patch, i + 1, j)
          && known (patch, i, j + 1) && known (patch, i + 1, j + 1))
        patch->square[at] = 1;
      if (patch->square[at])
        patch->n_squares++;
    }
  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < n; i++) {
      gint at = j * n + i;

      if (!patch->square[at])
        patch->inside[at] = judge_cell (patch, image, i, j, params);
      else if (params->read_bits)
        patch->bit[at] = read_bit (patch, image, i, j);
    }
}
