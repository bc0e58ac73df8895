/* From the squares, dots or matches of a picture to the places of a grid's vertices in it, px.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "gst/cloth-io/points.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"

/* As triangulate has them by default: when the estimates of one corner contradict each
 * other, and the variance that its first set starts with, px². */
#define THRESHOLD 4.0
#define ERROR_FLOOR 0.01
/* How far outside the picture a point may be, as a share of the picture: a square at the
 * edge has corners that are a little outside. */
#define MARGIN 0.1

void
gst_cloth_io_points_add_quads (const GstClothQuads * quads, guint columns,
    guint rows, ClothMerge * merge)
{
  const GstClothQuad *quad;
  guint n, i, c;

  quad = gst_cloth_quads_get_quads (quads, &n);
  for (i = 0; i < n; i++, quad++) {
    if (quad->state != GST_CLOTH_QUAD_TRACKED || quad->column < 0
        || quad->row < 0 || (guint) quad->column >= columns - 1
        || (guint) quad->row >= rows - 1) {
      continue;
    }
    for (c = 0; c < 4; c++) {
      guint column = (guint) quad->column + (c == 1 || c == 2);
      guint row = (guint) quad->row + (c >= 2);
      gdouble cov[3] = { quad->cov_xx[c], quad->cov_xy[c], quad->cov_yy[c] };

      cloth_merge_add (merge, row * columns + column, quad->x[c], quad->y[c],
          cov);
    }
  }
}

static gboolean
is_usable (const GstClothDot * dot, guint columns, guint rows)
{
  return !dot->touches && dot->column >= 0 && dot->row >= 0
      && (guint) dot->column < columns && (guint) dot->row < rows;
}

/* Where two of a dot's neighbours are not seen, the edge of a fold hides them. It may hide a
 * part of the dot too, which moves the centre of gravity of what is seen. */
static gboolean
is_at_fold (const GstClothDot * dot, guint columns, guint rows,
    const guint8 * seen)
{
  const guint column = (guint) dot->column, row = (guint) dot->row;
  const guint8 *at = seen + row * columns + column;
  guint missing = 0;

  missing += column > 0 && !at[-1];
  missing += column + 1 < columns && !at[1];
  missing += row > 0 && !*(at - columns);
  missing += row + 1 < rows && !at[columns];
  return missing > 1;
}

/* A dot seen from behind is the same vertex: cloth is thin. */
void
gst_cloth_io_points_add_dots (const GstClothDots * dots, guint columns,
    guint rows, guint8 * seen, ClothMerge * merge)
{
  const GstClothDot *list;
  guint n, i;

  list = gst_cloth_dots_get_dots (dots, &n);
  memset (seen, 0, (gsize) columns * rows);
  for (i = 0; i < n; i++) {
    if (is_usable (&list[i], columns, rows)) {
      seen[(guint) list[i].row * columns + (guint) list[i].column] = 1;
    }
  }
  for (i = 0; i < n; i++) {
    const GstClothDot *dot = &list[i];
    gdouble cov[3] = { dot->cov_xx, dot->cov_xy, dot->cov_yy };

    if (is_usable (dot, columns, rows)
        && !is_at_fold (dot, columns, rows, seen)) {
      cloth_merge_add (merge, (guint) dot->row * columns
          + (guint) dot->column, dot->x, dot->y, cov);
    }
  }
}

/* What is seen from behind is the same vertex: cloth is thin. */
void
gst_cloth_io_points_add_matches (const GstClothMatches * matches,
    guint columns, guint rows, ClothMerge * merge)
{
  const GstClothGridPoint *point;
  guint n, i;

  point = gst_cloth_matches_get_points (matches, &n);
  for (i = 0; i < n; i++, point++) {
    gdouble cov[3] = { point->cov_xx, point->cov_xy, point->cov_yy };

    if (point->column >= 0 && point->row >= 0
        && (guint) point->column < columns && (guint) point->row < rows) {
      cloth_merge_add (merge, (guint) point->row * columns
          + (guint) point->column, point->x, point->y, cov);
    }
  }
}

GstClothIoPoints *
gst_cloth_io_points_new (guint columns, guint rows)
{
  GstClothIoPoints *points = g_new0 (GstClothIoPoints, 1);

  points->columns = columns;
  points->rows = rows;
  points->merge = cloth_merge_new (columns * rows);
  points->seen = g_malloc ((gsize) columns * rows);
  return points;
}

/* Takes the squares, the dots or the matches, whichever are of the grid; a picture may carry
 * several. */
static gboolean
merge_metas (GstClothIoPoints * self, GstBuffer * picture, GError ** error)
{
  const GstClothQuads *quads = gst_buffer_get_cloth_quads (picture);
  const GstClothDots *dots = gst_buffer_get_cloth_dots (picture);
  const GstClothMatches *matches = gst_buffer_get_cloth_matches (picture);
  guint columns = 0, rows = 0;

  if (quads) {
    columns = gst_cloth_quads_get_columns (quads) + 1;
    rows = gst_cloth_quads_get_rows (quads) + 1;
    if (columns == self->columns && rows == self->rows) {
      gst_cloth_io_points_add_quads (quads, columns, rows, self->merge);
      self->camera = gst_cloth_quads_get_camera (quads);
      self->sequence = gst_cloth_quads_get_sequence (quads);
      return TRUE;
    }
  }
  if (dots) {
    columns = gst_cloth_dots_get_columns (dots);
    rows = gst_cloth_dots_get_rows (dots);
    if (columns == self->columns && rows == self->rows) {
      gst_cloth_io_points_add_dots (dots, columns, rows, self->seen,
          self->merge);
      self->camera = gst_cloth_dots_get_camera (dots);
      self->sequence = gst_cloth_dots_get_sequence (dots);
      return TRUE;
    }
  }
  if (matches) {
    columns = gst_cloth_matches_get_columns (matches);
    rows = gst_cloth_matches_get_rows (matches);
    if (columns == self->columns && rows == self->rows) {
      gst_cloth_io_points_add_matches (matches, columns, rows, self->merge);
      self->camera = gst_cloth_matches_get_camera (matches);
      self->sequence = gst_cloth_matches_get_sequence (matches);
      return TRUE;
    }
  }
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
      "it is of a pattern with %u×%u vertices, but the take's "
      "grid has %u×%u: both must come from one pattern.json", columns, rows,
      self->columns, self->rows);
  return FALSE;
}

gboolean
gst_cloth_io_points_has_any (GstBuffer * picture)
{
  return gst_buffer_get_cloth_quads (picture)
      || gst_buffer_get_cloth_dots (picture)
      || gst_buffer_get_cloth_matches (picture);
}

gboolean
gst_cloth_io_points_find (GstClothIoPoints * points, GstBuffer * picture,
    GError ** error)
{
  cloth_merge_clear (points->merge);
  if (!merge_metas (points, picture, error))
    return FALSE;
  cloth_merge_finish (points->merge, THRESHOLD, ERROR_FLOOR, &points->view);
  return TRUE;
}

gboolean
gst_cloth_io_points_check_places (const GstClothIoPoints * points,
    const ClothCamera * camera, GError ** error)
{
  gdouble w = camera->width, h = camera->height;

  for (guint i = 0; i < points->columns * points->rows; i++) {
    gdouble x = points->view.x[i], y = points->view.y[i];

    if (isnan (x) || (x >= -MARGIN * w && x <= (1 + MARGIN) * w
            && y >= -MARGIN * h && y <= (1 + MARGIN) * h))
      continue;
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING,
        "vertex %u is at (%.1f, %.1f) px, but the camera was calibrated with "
        "pictures of %d×%d: calibrate at the size that is filmed", i, x, y,
        camera->width, camera->height);
    return FALSE;
  }
  return TRUE;
}

guint
gst_cloth_io_points_list (const ClothTriangulateView * view, guint n,
    guint32 * vertices, gdouble * px, gdouble * covariances)
{
  guint shown = 0;

  for (guint i = 0; i < n; i++) {
    if (isnan (view->x[i]))
      continue;
    vertices[shown] = i;
    px[2 * shown] = view->x[i];
    px[2 * shown + 1] = view->y[i];
    covariances[3 * shown] = view->xx[i];
    covariances[3 * shown + 1] = view->xy[i];
    covariances[3 * shown + 2] = view->yy[i];
    shown++;
  }
  return shown;
}

void
gst_cloth_io_points_free (GstClothIoPoints * points)
{
  if (!points)
    return;
  cloth_merge_free (points->merge);
  g_free (points->seen);
  g_free (points);
}
