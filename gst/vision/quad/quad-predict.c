/* Quad tracker: where each square is looked for, by its past motion and by the motion of
 * the squares around it that were found.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/quad/quad-private.h"

/* Passes that spread the shift of linked corners to the others. */
#define SPREAD_PASSES 6
/* Share of its speed that a square not seen keeps from picture to picture. */
#define SLOWING 0.7f
/* Weight that each picture of age takes from a remembered corner. */
#define FADE 0.85f

/* Section 3.6, and what it means for the corners. */
void
cloth_quad_predict (ClothQuadTracker * tracker)
{
  gint columns = tracker->pattern.columns, rows = tracker->pattern.rows;

  for (gint k = 0; k < (columns + 1) * (rows + 1); k++)
    tracker->vertices[k] = (ClothQuadVertex) {
    0};
  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++) {
      ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);
      gfloat weight = 1, speed = cell->age == 0 ? 1 : SLOWING;

      cell->wanted = tracker->params->squares == CLOTH_SQUARES_BOTH
          || cloth_pattern_is_black (&tracker->pattern, column, row)
          == (tracker->params->squares == CLOTH_SQUARES_BLACK);
      cell->found = cell->fresh = cell->refused = FALSE;
      if (cell->age > CLOTH_QUAD_MEMORY)
        continue;
      for (guint a = 0; a < cell->age; a++)
        weight *= FADE;
      for (gint k = 0; k < 4; k++) {
        ClothQuadVertex *vertex = cloth_quad_vertex (tracker,
            column + cloth_quad_corner_column[k],
            row + cloth_quad_corner_row[k]);

        cell->guess_x[k] = cell->x[k];
        cell->guess_y[k] = cell->y[k];
        if (cell->run >= 2) {
          cell->guess_x[k] += speed * (cell->x[k] - cell->before_x[k]);
          cell->guess_y[k] += speed * (cell->y[k] - cell->before_y[k]);
        }
        vertex->guess_x += weight * cell->guess_x[k];
        vertex->guess_y += weight * cell->guess_y[k];
        vertex->size += weight * cloth_quad_shortest (cell->x, cell->y);
        vertex->weight += weight;
        vertex->freshest = MAX (vertex->freshest, weight);
      }
    }
  for (gint k = 0; k < (columns + 1) * (rows + 1); k++) {
    ClothQuadVertex *vertex = &tracker->vertices[k];

    if (vertex->weight == 0)
      continue;
    vertex->guessed = TRUE;
    vertex->guess_x /= vertex->weight;
    vertex->guess_y /= vertex->weight;
    vertex->size = MAX (vertex->size / vertex->weight, 1.0f);
    vertex->weight = vertex->freshest;
  }
}

/* Gives a vertex not seen the mean shift of its neighbours. */
static void
spread_to (ClothQuadTracker * tracker, gint column, gint row)
{
  static const gint dc[4] = { -1, 1, 0, 0 }, dr[4] = { 0, 0, -1, 1 };
  ClothQuadVertex *own = cloth_quad_vertex (tracker, column, row);
  gfloat sum_x = 0, sum_y = 0, weight = 0;

  if (own->seen && own->guessed)
    return;
  for (gint k = 0; k < 4; k++) {
    const ClothQuadVertex *other;

    if (column + dc[k] < 0 || column + dc[k] > tracker->pattern.columns
        || row + dr[k] < 0 || row + dr[k] > tracker->pattern.rows)
      continue;
    other = cloth_quad_vertex (tracker, column + dc[k], row + dr[k]);
    sum_x += other->spread * other->shift_x;
    sum_y += other->spread * other->shift_y;
    weight += other->spread;
  }
  if (weight == 0)
    return;
  own->shift_x = sum_x / weight;
  own->shift_y = sum_y / weight;
  own->spread = MIN (0.5f * weight, 0.9f);
}

/* Forth and back in turn, so that no direction is preferred. */
void
cloth_quad_spread_shift (ClothQuadTracker * tracker)
{
  gint columns = tracker->pattern.columns + 1, rows = tracker->pattern.rows + 1;
  gint n_unknown = 0;

  for (gint k = 0; k < columns * rows; k++) {
    ClothQuadVertex *vertex = &tracker->vertices[k];
    gboolean known = vertex->seen && vertex->guessed;

    vertex->shift_x = known ? vertex->x - vertex->guess_x : 0;
    vertex->shift_y = known ? vertex->y - vertex->guess_y : 0;
    vertex->spread = known ? 1 : 0;
    n_unknown += !known;
  }
  for (gint pass = 0; n_unknown && pass < SPREAD_PASSES; pass++)
    for (gint k = 0; k < columns * rows; k++) {
      gint at = pass & 1 ? columns * rows - 1 - k : k;

      spread_to (tracker, at % columns, at / columns);
    }
  for (gint row = 0; row + 1 < rows; row++)
    for (gint column = 0; column + 1 < columns; column++) {
      ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);

      if (cell->found || cell->age > CLOTH_QUAD_MEMORY)
        continue;
      for (gint k = 0; k < 4; k++) {
        const ClothQuadVertex *vertex = cloth_quad_vertex (tracker,
            column + cloth_quad_corner_column[k],
            row + cloth_quad_corner_row[k]);

        cell->guess_x[k] += vertex->shift_x;
        cell->guess_y[k] += vertex->shift_y;
      }
    }
  for (gint k = 0; k < columns * rows; k++) {
    ClothQuadVertex *vertex = &tracker->vertices[k];

    if (!vertex->guessed)
      continue;
    vertex->guess_x += vertex->shift_x;
    vertex->guess_y += vertex->shift_y;
  }
}
