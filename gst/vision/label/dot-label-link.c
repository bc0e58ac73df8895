/* Lattice of dots: each dot's four neighbours, and the connected pieces.
 *
 * A dot's ellipse says how the cloth is foreshortened there, but for a turn: measured by
 * it, neighbours lie one pitch away and square to each other however oblique the view.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/label/dot-label-private.h"

#include <math.h>

#include "gst/vision/pointgrid.h"

/* Pitch at most, in standard deviations of a dot's area along its longer axis: dots of
 * 0.4 of the pitch across. */
#define REACH 10.0f
/* What lies farther is no diagonal either, standard deviations of the areas of both. */
#define FARTHEST 15.0f
/* The usual pitch in these units: dots of 0.65 of it. */
#define PITCH 6.2f
/* Pictures are no larger, px. */
#define MAX_EDGE 32767.0f
/* What the blur of a sharp picture adds to a dot's second moments, px². */
#define BLUR 0.4f
/* How far distances in pitches may be from those of neighbours and diagonals, and a
 * neighbour from its place. */
#define SPREAD 0.2f
#define PLACE_RADIUS 0.42f

static gboolean
is_sound (const ClothDot * dot)
{
  const gfloat *s = dot->shape;

  return fabsf (dot->x) < 1e6f && fabsf (dot->y) < 1e6f && s[0] > 0.01f
      && s[2] > 0.01f && s[0] < 1e4f && s[2] < 1e4f
      && s[0] * s[2] - s[1] * s[1] > 1e-3f * s[0] * s[2];
}

/* Second moment along the longer axis. */
static gfloat
longer_variance (const gfloat a[3])
{
  const gfloat off = (a[0] - a[2]) / 2;

  return (a[0] + a[2]) / 2 + sqrtf (off * off + a[1] * a[1]);
}

/* Inverse square root of a symmetric 2×2 matrix: of A, √A is (A + √det A)/√(tr A + 2√det
 * A), by Cayley and Hamilton. */
static void
inverse_root (const gfloat a[3], gfloat w[3])
{
  const gfloat root = sqrtf (a[0] * a[2] - a[1] * a[1]);
  const gfloat t = root * sqrtf (a[0] + a[2] + 2 * root);

  w[0] = (a[2] + root) / t;
  w[1] = -a[1] / t;
  w[2] = (a[0] + root) / t;
}

static void
look_around (ClothDotLabeller * labeller, const ClothDot * dots)
{
  for (guint i = 0; i < labeller->n; i++) {
    ClothLatticeAround *around = &labeller->around[i];

    around->n = labeller->nodes[i].sound
        ? cloth_point_grid_within (labeller->grid, dots[i].x, dots[i].y,
        REACH * sqrtf (longer_variance (dots[i].shape)), around->near,
        CLOTH_DOT_LABEL_NEAR) : 0;
  }
}

/* The value that would be at @k if the @n were in order: Hoare's find (1961). */
static gfloat
select_float (gfloat * values, guint n, guint k)
{
  gint left = 0, right = (gint) n - 1;

  while (left < right) {
    const gfloat pivot = values[(left + right) / 2];
    gint i = left, j = right;

    while (i <= j) {
      while (values[i] < pivot)
        i++;
      while (values[j] > pivot)
        j--;
      if (i <= j) {
        const gfloat swap = values[i];

        values[i++] = values[j];
        values[j--] = swap;
      }
    }
    if ((gint) k <= j)
      right = j;
    else if ((gint) k >= i)
      left = i;
    else
      break;
  }
  return values[k];
}

/* Second moments without what the picture's blur adds, as far as they go. */
static void
sharpen (const gfloat from[3], gfloat to[3])
{
  const gfloat mean = (from[0] + from[2]) / 2;
  const gfloat shorter = mean - hypotf ((from[0] - from[2]) / 2, from[1]);
  const gfloat blur = MIN (BLUR, shorter / 2);

  to[0] = from[0] - blur;
  to[1] = from[1];
  to[2] = from[2] - blur;
}

/* Neighbours in the measure of the ellipses: how far by that of both ends, for the cloth
 * bends between them, and which way by the dot's own. */
static void
measure_around (ClothDotLabeller * labeller, guint i)
{
  ClothLatticeAround *around = &labeller->around[i];
  const ClothLatticeNode *node = &labeller->nodes[i];
  guint n = 0;
  gfloat w[3];

  inverse_root (node->shape, w);
  for (guint k = 0; k < around->n; k++) {
    const gint32 near = around->near[k];
    const ClothLatticeNode *other = &labeller->nodes[near];
    const gfloat x = other->x - node->x, y = other->y - node->y;
    const gfloat a = node->shape[0] + other->shape[0];
    const gfloat b = node->shape[1] + other->shape[1];
    const gfloat c = node->shape[2] + other->shape[2];
    const gfloat d2 = 2 * (c * x * x - 2 * b * x * y + a * y * y)
        / (a * c - b * b);
    const gfloat to_x = w[0] * x + w[1] * y, to_y = w[1] * x + w[2] * y;
    const gfloat size2 = to_x * to_x + to_y * to_y;

    if (!(size2 > 0 && d2 < FARTHEST * FARTHEST))
      continue;
    around->near[n] = near;
    around->distance[n] = sqrtf (d2);
    around->way[n][0] = to_x / sqrtf (size2);
    around->way[n][1] = to_y / sqrtf (size2);
    n++;
  }
  around->n = n;
}

/* The pitch in units of the dots' size: in the middle of all dots, their second nearest
 * neighbour lies that far. FALSE without neighbours. */
static gboolean
scale_distances (ClothDotLabeller * labeller)
{
  guint n = 0;
  gfloat middle, per_pitch;

  for (guint i = 0; i < labeller->n; i++) {
    const ClothLatticeAround *around = &labeller->around[i];
    gfloat least[2] = { G_MAXFLOAT, G_MAXFLOAT };

    if (around->n < 2)
      continue;
    for (guint k = 0; k < around->n; k++) {
      if (around->distance[k] < least[0]) {
        least[1] = least[0];
        least[0] = around->distance[k];
      } else {
        least[1] = MIN (least[1], around->distance[k]);
      }
    }
    labeller->scratch[n++] = least[1];
  }
  if (n == 0)
    return FALSE;
  middle = select_float (labeller->scratch, n, n / 2);
  if (!(middle > 0))
    return FALSE;
  per_pitch = 1 / middle;
  for (guint i = 0; i < labeller->n; i++)
    for (guint k = 0; k < labeller->around[i].n; k++)
      labeller->around[i].distance[k] *= per_pitch;
  return TRUE;
}

/* How much a distance looks like @at. */
static inline gfloat
likeness (gfloat distance, gfloat at)
{
  const gfloat off = (distance - at) / SPREAD;

  return MAX (0, 1 - off * off);
}

/* The turn of the lattice about a dot: neighbours point four ways, diagonals between.
 * Then the dot nearest to each place one pitch away. */
static void
choose_slots (ClothDotLabeller * labeller, guint i)
{
  const ClothLatticeAround *around = &labeller->around[i];
  ClothLatticeNode *node = &labeller->nodes[i];
  gfloat sum[2] = { 0 }, least[4], angle, axis[2];

  for (guint k = 0; k < around->n; k++) {
    const gfloat *way = around->way[k];
    const gfloat weight = likeness (around->distance[k], 1)
        - likeness (around->distance[k], (gfloat) G_SQRT2);
    const gfloat a = way[0] * way[0] - way[1] * way[1];
    const gfloat b = 2 * way[0] * way[1];

    sum[0] += weight * (a * a - b * b);
    sum[1] += weight * 2 * a * b;
  }
  angle = atan2f (sum[1], sum[0]) / 4;
  axis[0] = cosf (angle);
  axis[1] = sinf (angle);
  for (gint slot = 0; slot < 4; slot++)
    least[slot] = PLACE_RADIUS * PLACE_RADIUS;
  for (guint k = 0; k < around->n; k++) {
    const gfloat *way = around->way[k], distance = around->distance[k];
    const gfloat x = distance * (way[0] * axis[0] + way[1] * axis[1]);
    const gfloat y = distance * (way[1] * axis[0] - way[0] * axis[1]);
    const gint slot = fabsf (x) > fabsf (y) ? (x > 0 ? 0 : 2) : y > 0 ? 1 : 3;
    const gfloat along = MAX (fabsf (x), fabsf (y)) - 1;
    const gfloat across = MIN (fabsf (x), fabsf (y));
    const gfloat miss = along * along + across * across;

    if (miss < least[slot]) {
      least[slot] = miss;
      node->next[slot] = around->near[k];
    }
  }
}

static void
cut (ClothLatticeNode * nodes, guint i, gint slot)
{
  ClothLatticeNode *other = &nodes[nodes[i].next[slot]];

  other->next[nodes[i].back[slot]] = -1;
  nodes[i].next[slot] = -1;
}

/* Only what both ends hold for a neighbour is one. */
static void
keep_mutual (ClothDotLabeller * labeller)
{
  ClothLatticeNode *nodes = labeller->nodes;

  for (guint i = 0; i < labeller->n; i++) {
    for (gint slot = 0; slot < 4; slot++) {
      const gint other = nodes[i].next[slot];

      if (other < 0)
        continue;
      nodes[i].back[slot] = 4;
      for (guint8 k = 0; k < 4; k++)
        if (nodes[other].next[k] == (gint) i)
          nodes[i].back[slot] = k;
    }
  }
  for (guint i = 0; i < labeller->n; i++)
    for (gint slot = 0; slot < 4; slot++)
      if (nodes[i].next[slot] >= 0 && nodes[i].back[slot] > 3)
        nodes[i].next[slot] = -1;
}

static gboolean
differ (const gfloat a[2], const gfloat b[2], gfloat c)
{
  const gfloat x = a[0] - b[0], y = a[1] - b[1];
  const gfloat longer = MAX (a[0] * a[0] + a[1] * a[1],
      b[0] * b[0] + b[1] * b[1]);

  return x * x + y * y >= c * c * longer;
}

/* Vectors to neighbours; those without one are predicted from the opposite. */
static void
measure_steps (ClothDotLabeller * labeller)
{
  ClothLatticeNode *nodes = labeller->nodes;

  for (guint i = 0; i < labeller->n; i++) {
    ClothLatticeNode *node = &nodes[i];

    for (gint slot = 0; slot < 4; slot++) {
      if (node->next[slot] >= 0) {
        node->step[slot][0] = nodes[node->next[slot]].x - node->x;
        node->step[slot][1] = nodes[node->next[slot]].y - node->y;
      }
    }
    for (gint slot = 0; slot < 4; slot++)
      if (node->next[slot] < 0)
        for (gint c = 0; c < 2; c++)
          node->step[slot][c] = node->next[slot ^ 2] >= 0
              ? -node->step[slot ^ 2][c] : 0;
  }
}

/* Lattice vectors may change by the share c only from dot to dot: along the line, and
 * from a dot to its neighbour across. */
static void
cut_bends (ClothDotLabeller * labeller)
{
  ClothLatticeNode *nodes = labeller->nodes;
  const gfloat c = labeller->params.c;

  for (guint i = 0; i < labeller->n; i++) {
    ClothLatticeNode *node = &nodes[i];

    for (gint slot = 0; slot < 4; slot++) {
      const gint other = node->next[slot];
      const gint on = (node->back[slot] + 2) & 3;
      const gint side = (node->back[slot] + 3) & 3;

      if (other < 0 || other < (gint) i)
        continue;
      if ((nodes[other].next[on] >= 0
              && differ (node->step[slot], nodes[other].step[on], c)
              && (node->next[slot ^ 2] < 0
                  || differ (node->step[slot], nodes[i].step[slot ^ 2], c)))
          || (node->next[(slot + 1) & 3] >= 0 && nodes[other].next[side] >= 0
              && differ (node->step[(slot + 1) & 3], nodes[other].step[side],
                  c) && node->next[(slot + 3) & 3] >= 0
              && nodes[other].next[side ^ 2] >= 0
              && differ (node->step[(slot + 3) & 3],
                  nodes[other].step[side ^ 2], c)))
        cut (nodes, i, slot);
    }
  }
}

/* Four links that lead back to where they began, the same way round. */
static void
count_squares (ClothDotLabeller * labeller)
{
  ClothLatticeNode *nodes = labeller->nodes;

  for (guint i = 0; i < labeller->n; i++) {
    for (gint first = 0; first < 4; first++) {
      gint at = (gint) i, slot = first, corner[4], slots[4], k;

      for (k = 0; k < 4; k++) {
        const gint next = nodes[at].next[slot];

        if (next < 0)
          break;
        corner[k] = at;
        slots[k] = slot;
        slot = (nodes[at].back[slot] + 3) & 3;
        at = next;
        /* Each square from its first corner only. */
        if (at < (gint) i)
          break;
      }
      if (k < 4 || at != (gint) i || slot != first)
        continue;
      for (k = 0; k < 4; k++) {
        ClothLatticeNode *node = &nodes[corner[k]];

        node->squares[slots[k]]++;
        nodes[node->next[slots[k]]].squares[node->back[slots[k]]]++;
      }
    }
  }
}

/* Makes nodes of the dots, and a grid to find them by. */
void
cloth_dot_label_start (ClothDotLabeller * labeller, const ClothDot * dots)
{
  gfloat right = 1, bottom = 1, size = 0, cells;
  guint n = 0;

  for (guint i = 0; i < labeller->n; i++) {
    ClothLatticeNode *node = &labeller->nodes[i];

    *node = (ClothLatticeNode) {
    .x = dots[i].x,.y = dots[i].y,.next = { -1, -1, -1, -1 },.patch =
          -1,.sound = is_sound (&dots[i])};
    if (node->sound) {
      sharpen (dots[i].shape, node->shape);
      right = MAX (right, dots[i].x);
      bottom = MAX (bottom, dots[i].y);
      size += longer_variance (node->shape);
      n++;
    }
  }
  right = MIN (right, MAX_EDGE);
  bottom = MIN (bottom, MAX_EDGE);
  /* Dots fill a part of the picture only: cells of two dots where they are. */
  cells = n ? right * bottom * (gfloat) n / (PITCH * PITCH * size) : 1;
  cloth_point_grid_clear (labeller->grid, (gint) right + 1, (gint) bottom + 1,
      (guint) MIN (cells, 8 * (gfloat) n));
  for (guint i = 0; i < labeller->n; i++)
    cloth_point_grid_add (labeller->grid,
        labeller->nodes[i].sound ? dots[i].x : NAN, dots[i].y);
}

/* Finds each dot's neighbours: nodes[].next, back, step and squares. */
void
cloth_dot_label_link (ClothDotLabeller * labeller, const ClothDot * dots)
{
  look_around (labeller, dots);
  for (guint i = 0; i < labeller->n; i++)
    measure_around (labeller, i);
  if (!scale_distances (labeller))
    return;
  for (guint i = 0; i < labeller->n; i++)
    choose_slots (labeller, i);
  keep_mutual (labeller);
  measure_steps (labeller);
  cut_bends (labeller);
  measure_steps (labeller);
  count_squares (labeller);
}

/* --- connected pieces ------------------------------------------------------------- */

/* Takes the free neighbours of dot @at into its patch, by links that are sides of squares
 * or also by others. */
static void
take_neighbours (ClothDotLabeller * labeller, guint at, gboolean others)
{
  ClothLatticeNode *nodes = labeller->nodes;

  for (gint slot = 0; slot < 4; slot++) {
    const gint next = nodes[at].next[slot];

    if (next < 0 || nodes[next].patch >= 0
        || !(nodes[at].squares[slot] || others))
      continue;
    nodes[next].patch = nodes[at].patch;
    cloth_dot_label_step (&nodes[at], slot, nodes[next].cell,
        &nodes[next].turn);
    labeller->members[labeller->n_members++] = (guint) next;
  }
}

/* Gathers what hangs together with dot @seed: by sides of squares as far as they go, then
 * by a link without. */
static void
grow_patch (ClothDotLabeller * labeller, guint seed)
{
  ClothLatticePatch patch = { labeller->n_members, 1, FALSE };
  guint with = patch.first, without = patch.first;

  labeller->nodes[seed].patch = (gint32) labeller->patches->len;
  labeller->nodes[seed].cell[0] = labeller->nodes[seed].cell[1] = 0;
  labeller->nodes[seed].turn = 0;
  labeller->members[labeller->n_members++] = seed;
  while (without < labeller->n_members) {
    if (with < labeller->n_members)
      take_neighbours (labeller, labeller->members[with++], FALSE);
    else
      take_neighbours (labeller, labeller->members[without++], TRUE);
  }
  patch.n = labeller->n_members - patch.first;
  g_array_append_val (labeller->patches, patch);
}

/* Finds the patches of the lattice, the best knit dots first. */
void
cloth_dot_label_grow (ClothDotLabeller * labeller)
{
  labeller->n_members = 0;
  g_array_set_size (labeller->patches, 0);
  for (gint least = 8; least >= 0; least--) {
    for (guint i = 0; i < labeller->n; i++) {
      const ClothLatticeNode *node = &labeller->nodes[i];

      if (node->patch < 0 && node->squares[0] + node->squares[1]
          + node->squares[2] + node->squares[3] >= least)
        grow_patch (labeller, i);
    }
  }
}
