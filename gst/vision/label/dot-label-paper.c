/* Labels by seeds and growing of regions, as in Scholz et al. 2005, 4.2.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/label/dot-label-private.h"

#include <math.h>

/* Dots of the 5×5 neighbourhood. */
#define N_NEAR 25
/* The eight neighbours in the order of their angle. */
static const gint ring[8][2] = { {1, 0}, {1, 1}, {0, 1}, {-1, 1},
{-1, 0}, {-1, -1}, {0, -1}, {1, -1}
};

typedef ClothLatticeFrame Frame;

/* All windows of the array, by their nine colours. */
static void
index_windows (ClothDotLabeller * labeller)
{
  const gint columns = labeller->columns;

  labeller->windows = g_hash_table_new (NULL, NULL);
  for (gint row = 1; row < labeller->rows - 1; row++) {
    for (gint column = 1; column < columns - 1; column++) {
      guint key = labeller->matrix[row * columns + column];

      for (gint k = 0; k < 8; k++)
        key = key * (guint) labeller->n_colours
            + labeller->matrix[(row + ring[k][1]) * columns + column
            + ring[k][0]];
      g_hash_table_insert (labeller->windows, GUINT_TO_POINTER (key),
          GINT_TO_POINTER (row * columns + column));
    }
  }
}

static gboolean
is_near (const gfloat a[2], const gfloat b[2], gfloat c)
{
  return hypotf (a[0] - b[0], a[1] - b[1]) < c * hypotf (b[0], b[1]);
}

/* The dot nearest to @at within the share c of the vector that led there, -1: none. */
static gint
find_dot (const ClothDotLabeller * labeller, gfloat x, gfloat y,
    const gfloat step[2])
{
  ClothNear near;

  return cloth_point_grid_nearest (labeller->grid, x + step[0], y + step[1],
      labeller->params.c * hypotf (step[0], step[1]), &near, 1)
      ? near.index : -1;
}

/* Directions of the three nearest neighbours, opposite ones taken for one. */
static gboolean
find_directions (const ClothDotLabeller * labeller, guint seed,
    gfloat directions[3][2])
{
  const ClothLatticeNode *node = &labeller->nodes[seed];
  ClothNear near[N_NEAR];
  const guint n = cloth_point_grid_nearest (labeller->grid, node->x, node->y,
      G_MAXINT16, near, N_NEAR);
  gint found = 0;

  for (guint k = 0; k < n && found < 3; k++) {
    const gfloat way[2] = { labeller->nodes[near[k].index].x - node->x,
      labeller->nodes[near[k].index].y - node->y
    };
    gboolean is_new = near[k].index != (gint) seed;

    for (gint j = 0; j < found && is_new; j++) {
      const gfloat cross = way[0] * directions[j][1]
          - way[1] * directions[j][0];
      const gfloat size = hypotf (way[0], way[1])
          * hypotf (directions[j][0], directions[j][1]);

      is_new = fabsf (cross) > 0.25f * size;
    }
    if (is_new) {
      directions[found][0] = way[0];
      directions[found][1] = way[1];
      found++;
    }
  }
  return found == 3;
}

/* --- growing -------------------------------------------------------------------------- */

/* Vector from the dot of a label to the one @by further in its region, if it is there. */
static gboolean
step_between (const ClothDotLabeller * labeller, gint column, gint row,
    gint by_column, gint by_row, guint patch, gfloat step[2])
{
  const gint x = column + by_column, y = row + by_row;
  const ClothLatticeNode *from, *to;
  gint holder;

  if ((guint) x >= (guint) labeller->columns
      || (guint) y >= (guint) labeller->rows)
    return FALSE;
  holder = labeller->holders[y * labeller->columns + x];
  if (holder < 0 || labeller->labels[holder].patch != patch)
    return FALSE;
  from = &labeller->nodes[labeller->holders[row * labeller->columns + column]];
  to = &labeller->nodes[holder];
  step[0] = to->x - from->x;
  step[1] = to->y - from->y;
  return TRUE;
}

/* The lattice vectors at a labelled dot from its labelled neighbours; @frame holds those
 * of the dot it was found from. */
static void
measure_frame (const ClothDotLabeller * labeller, gint column, gint row,
    guint patch, Frame * frame)
{
  for (gint axis = 0; axis < 2; axis++) {
    gfloat *to = axis ? frame->v : frame->u, on[2] = { 0 }, back[2] = { 0 };
    const gboolean has_on = step_between (labeller, column, row, axis == 0,
        axis == 1, patch, on);
    const gboolean has_back = step_between (labeller, column, row,
        -(axis == 0), -(axis == 1), patch, back);

    if (!has_on && !has_back)
      continue;
    for (gint c = 0; c < 2; c++)
      to[c] = has_on && has_back ? (on[c] - back[c]) / 2
          : has_on ? on[c] : -back[c];
  }
}

static void
give_label (ClothDotLabeller * labeller, guint i, gint column, gint row,
    gboolean mirrored, guint patch)
{
  labeller->labels[i] = (ClothDotLabel) {
  column, row, 0, mirrored, patch};
  labeller->holders[row * labeller->columns + column] = (gint) i;
}

/* Looks for the dot next to a labelled one. */
static gboolean
take_next (ClothDotLabeller * labeller, guint i, gint way, const Frame * frame)
{
  static const gint ways[4][2] = { {1, 0}, {0, 1}, {-1, 0}, {0, -1} };
  const gint column = labeller->labels[i].column + ways[way][0];
  const gint row = labeller->labels[i].row + ways[way][1];
  const gfloat sign = way & 2 ? -1 : 1;
  const gfloat *along = way & 1 ? frame->v : frame->u;
  const gfloat step[2] = { sign * along[0], sign * along[1] };
  const ClothLatticeNode *node = &labeller->nodes[i];
  const guint patch = labeller->labels[i].patch;
  Frame there = *frame;
  gint dot;

  if ((guint) column >= (guint) labeller->columns
      || (guint) row >= (guint) labeller->rows
      || labeller->holders[row * labeller->columns + column] >= 0)
    return FALSE;
  dot = find_dot (labeller, node->x, node->y, step);
  if (dot < 0 || labeller->labels[dot].column >= 0
      || cloth_dot_label_look (labeller, (guint) dot)
      != labeller->matrix[row * labeller->columns + column])
    return FALSE;
  give_label (labeller, (guint) dot, column, row, labeller->labels[i].mirrored,
      patch);
  measure_frame (labeller, column, row, patch, &there);
  if (!is_near (there.u, frame->u, labeller->params.c)
      || !is_near (there.v, frame->v, labeller->params.c)) {
    labeller->holders[row * labeller->columns + column] = -1;
    cloth_dot_label_clear (&labeller->labels[dot]);
    return FALSE;
  }
  labeller->frames[dot] = there;
  labeller->queue[labeller->n_members++] = (guint) dot;
  return TRUE;
}

/* Grows a region from a seed; takes all labels back if it stays too small. */
static gboolean
grow_from (ClothDotLabeller * labeller, guint seed, gint column, gint row,
    const Frame * frame, gboolean mirrored, guint patch)
{
  if (labeller->holders[row * labeller->columns + column] >= 0)
    return FALSE;
  labeller->n_members = 0;
  give_label (labeller, seed, column, row, mirrored, patch);
  labeller->frames[seed] = *frame;
  labeller->queue[labeller->n_members++] = seed;
  for (guint k = 0; k < labeller->n_members; k++) {
    const guint i = labeller->queue[k];
    Frame here = labeller->frames[i];

    measure_frame (labeller, labeller->labels[i].column,
        labeller->labels[i].row, patch, &here);
    for (gint way = 0; way < 4; way++)
      take_next (labeller, i, way, &here);
  }
  for (guint k = 0; k < labeller->n_members; k++) {
    ClothDotLabel *label = &labeller->labels[labeller->queue[k]];

    if (labeller->n_members >= labeller->params.least_region) {
      label->confidence = (gfloat) labeller->n_members
          * logf ((gfloat) labeller->n_colours)
          - logf ((gfloat) (8 * labeller->columns * labeller->rows));
    } else {
      labeller->holders[label->row * labeller->columns + label->column] = -1;
      cloth_dot_label_clear (label);
    }
  }
  return labeller->n_members >= labeller->params.least_region;
}

/* --- seeds ---------------------------------------------------------------------------- */

/* Tries the window about @seed with the two base vectors. */
static gboolean
try_window (ClothDotLabeller * labeller, guint seed, const gfloat e1[2],
    const gfloat e2[2], guint patch)
{
  const ClothLatticeNode *node = &labeller->nodes[seed];
  const guint n = (guint) labeller->n_colours;
  guint colours[8], key;

  for (gint k = 0; k < 8; k++) {
    gfloat step[2];
    gint dot;

    for (gint c = 0; c < 2; c++)
      step[c] = (gfloat) ring[k][0] * e1[c] + (gfloat) ring[k][1] * e2[c];
    dot = find_dot (labeller, node->x, node->y, step);
    if (dot < 0 || dot == (gint) seed)
      return FALSE;
    colours[k] = cloth_dot_label_look (labeller, (guint) dot);
  }
  /* Turned by quarters, either way round. */
  for (gint turn = 0; turn < 8; turn++) {
    const gint start = 2 * (turn & 3), sense = turn & 4 ? -1 : 1;
    const gint *to_u = ring[start];
    const gint *to_v = ring[(start + 2 * sense + 8) & 7];
    gboolean mirrored;
    gpointer found;
    Frame frame;

    key = cloth_dot_label_look (labeller, seed);
    for (gint k = 0; k < 8; k++)
      key = key * n + colours[(start + sense * k + 8) & 7];
    if (!g_hash_table_lookup_extended (labeller->windows,
            GUINT_TO_POINTER (key), NULL, &found))
      continue;
    for (gint c = 0; c < 2; c++) {
      frame.u[c] = (gfloat) to_u[0] * e1[c] + (gfloat) to_u[1] * e2[c];
      frame.v[c] = (gfloat) to_v[0] * e1[c] + (gfloat) to_v[1] * e2[c];
    }
    mirrored = frame.u[0] * frame.v[1] < frame.u[1] * frame.v[0];
    if ((labeller->params.mirrored || !mirrored)
        && grow_from (labeller, seed,
            GPOINTER_TO_INT (found) % labeller->columns,
            GPOINTER_TO_INT (found) / labeller->columns, &frame, mirrored,
            patch))
      return TRUE;
  }
  return FALSE;
}

/* Labels the dots by seeds and growing of regions. */
void
cloth_dot_label_as_paper (ClothDotLabeller * labeller)
{
  guint patch = 0;

  if (!labeller->windows)
    index_windows (labeller);
  for (gint k = 0; k < labeller->columns * labeller->rows; k++)
    labeller->holders[k] = -1;
  for (guint i = 0; i < labeller->n; i++) {
    gfloat d[3][2];

    if (!labeller->nodes[i].sound || labeller->labels[i].column >= 0
        || !find_directions (labeller, i, d))
      continue;
    /* The nearest two are u and v most often; else one of them is u + v. */
    if (try_window (labeller, i, d[0], d[1], patch)
        || try_window (labeller, i, d[0], d[2], patch)
        || try_window (labeller, i, d[1], d[2], patch))
      patch++;
  }
}
