/* clothoverlay: what is found of a print, into a video frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothoverlay-draw.h"

#include <math.h>

/* Arms of the cross on a match; half the size of a vertex's mark, px. */
#define MATCH_ARM 1.5f
#define MARK 2.0f
/* Share of a link that is left free at each end: the vertices stay visible. */
#define FREE 0.2f
/* Of matches that aren't verified. */
#define FAINT 0.3f
/* Of the heat map and of the checks: the film shows through. */
#define SHEET_OPACITY 0.6f
/* Edge of the heat map's cells, px: each match counts in the four around it, by how near their
 * centres are. */
#define CELL 16
/* Matches a pixel that have the last colour. */
#define DENSE (1.0f / (8 * 8))
/* Colours from none to many: the one after them is of what isn't known. */
#define HEATS (CLOTH_DRAW_HEATS - 1)

static const ClothColour vertex_colour = { 1, 1, 1, 1 };

static const ClothColour check_colours[2] = {
  {0.05f, 0.05f, 0.05f, 1}, {0.95f, 0.95f, 0.95f, 1}
};

/* A hue of its own for each group: that of neighbours in number is far away. */
static ClothColour
group_colour (guint group, gfloat opacity)
{
  /* the golden ratio times 2³² */
  const gfloat hue = (gfloat) (group * 2654435769u >> 8) / 16777216.0f * 6;
  const gint sector = MIN ((gint) hue, 5);
  const gfloat part = hue - (gfloat) sector, low = 0.15f;
  const gfloat up = low + (1 - low) * part, down = 1 - (1 - low) * part;
  const ClothColour colours[6] = {
    {1, up, low, opacity}, {down, 1, low, opacity}, {low, 1, up, opacity},
    {low, down, 1, opacity}, {up, low, 1, opacity}, {1, low, down, opacity}
  };

  return colours[sector];
}

static void
draw_groups (const ClothCanvas * canvas, const GstClothMatch * match, guint n,
    const GstClothOverlayStyle * style)
{
  for (gint verified = 0; verified < 2; verified++) {
    for (guint i = 0; i < n; i++) {
      const GstClothMatch *m = &match[i];
      const ClothColour colour = group_colour (m->group,
          style->opacity * (verified ? 1 : FAINT));

      if ((m->verified != FALSE) != verified) {
        continue;
      }
      cloth_draw_line (canvas, m->x - MATCH_ARM, m->y, m->x + MATCH_ARM, m->y,
          style->line_width, &colour);
      if (verified) {
        cloth_draw_line (canvas, m->x, m->y - MATCH_ARM, m->x,
            m->y + MATCH_ARM, style->line_width, &colour);
      }
    }
  }
}

static void
draw_density (const ClothCanvas * canvas, gint width, gint height,
    const GstClothMatch * match, guint n, GArray * cells,
    const GstClothOverlayStyle * style)
{
  const gint columns = (width + CELL - 1) / CELL;
  const gint rows = (height + CELL - 1) / CELL;
  ClothColour colours[CLOTH_DRAW_HEATS];
  gfloat *cell;

  cloth_draw_heat_colours (colours);
  g_array_set_size (cells, (guint) (columns * rows));
  cell = (gfloat *) cells->data;
  memset (cell, 0, cells->len * sizeof *cell);
  for (guint i = 0; i < n; i++) {
    /* from the centres of the first row and column of cells, in cells */
    const gfloat x = (match[i].x + 0.5f) / CELL - 0.5f;
    const gfloat y = (match[i].y + 0.5f) / CELL - 0.5f;

    /* also what is no number */
    if (!match[i].verified || !(x > -1 && x < (gfloat) columns && y > -1
            && y < (gfloat) rows)) {
      continue;
    }
    for (gint k = 0; k < 4; k++) {
      const gint column = (gint) floorf (x) + k % 2;
      const gint row = (gint) floorf (y) + k / 2;

      if (column >= 0 && column < columns && row >= 0 && row < rows) {
        cell[row * columns + column] += (1 - fabsf (x - (gfloat) column))
            * (1 - fabsf (y - (gfloat) row)) / (CELL * CELL);
      }
    }
  }
  for (gint k = 0; k < columns * rows; k++) {
    const gfloat left = (gfloat) (k % columns * CELL) - 0.5f;
    const gfloat top = (gfloat) (k / columns * CELL) - 0.5f;
    const gfloat x[4] = { left, left + CELL, left + CELL, left };
    const gfloat y[4] = { top, top, top + CELL, top + CELL };
    const gfloat heat = MIN (cell[k] / DENSE, 1) * (HEATS - 1);
    ClothColour colour = colours[(gint) heat];

    if (cell[k] > 0) {
      colour.a = SHEET_OPACITY * style->opacity;
      cloth_draw_quad (canvas, x, y, &colour);
    }
  }
}

static void
draw_link (const ClothCanvas * canvas, const GstClothGridPoint * a,
    const GstClothGridPoint * b, const ClothColour * colour,
    const GstClothOverlayStyle * style)
{
  const gfloat dx = b->x - a->x, dy = b->y - a->y;

  cloth_draw_line (canvas, a->x + FREE * dx, a->y + FREE * dy, b->x - FREE * dx,
      b->y - FREE * dy, style->line_width, colour);
}

static void
draw_points (const ClothCanvas * canvas, GstClothMatches * matches,
    GArray * places, const GstClothOverlayStyle * style)
{
  const guint columns = gst_cloth_matches_get_columns (matches);
  const guint rows = gst_cloth_matches_get_rows (matches);
  guint n;
  const GstClothGridPoint *point = gst_cloth_matches_get_points (matches, &n);

  g_array_set_size (places, 0);
  for (guint i = 0; i < n; i++) {
    if (point[i].column >= 0 && point[i].row >= 0
        && (guint) point[i].column < columns && (guint) point[i].row < rows) {
      const guint64 place = gst_cloth_overlay_place (columns, point[i].column,
          point[i].row, i);

      g_array_append_val (places, place);
    }
  }
  gst_cloth_overlay_sort_places (places);
  for (guint i = 0; i < places->len; i++) {
    const GstClothGridPoint *p =
        &point[g_array_index (places, guint64, i) & G_MAXUINT32];
    ClothColour colour =
        p->mirrored ? gst_cloth_overlay_behind_colour : vertex_colour;

    colour.a *= style->opacity;
    for (gint k = 0; k < 2; k++) {
      const guint next = gst_cloth_overlay_find_place (places, columns, rows,
          p->column + !k, p->row + k);

      if (next != G_MAXUINT) {
        draw_link (canvas, p, &point[next], &colour, style);
      }
    }
    cloth_draw_ellipse (canvas, p->x, p->y, MARK * MARK, 0, MARK * MARK,
        style->line_width, &colour);
  }
}

void
gst_cloth_overlay_draw_matches (const ClothCanvas * canvas, gint width,
    gint height, GstClothMatches * matches, GArray * places, GArray * cells,
    const GstClothOverlayStyle * style)
{
  guint n;
  const GstClothMatch *match = gst_cloth_matches_get_matches (matches, &n);

  if (style->draw_matches == GST_CLOTH_OVERLAY_MATCHES_DENSITY) {
    draw_density (canvas, width, height, match, n, cells, style);
    return;
  }
  draw_groups (canvas, match, n, style);
  draw_points (canvas, matches, places, style);
}

/* Which colour a place has: 0 or 1; −1: it isn't known. */
static gint
check_at (const gfloat * uv, gfloat edge)
{
  if (isnan (uv[0]) || isnan (uv[1])) {
    return -1;
  }
  return (gint) (fmodf (floorf (uv[0] / edge) + floorf (uv[1] / edge), 2) != 0);
}

void
gst_cloth_overlay_draw_uv (const ClothCanvas * canvas, gint width, gint height,
    const GstClothUV * uv, const GstClothOverlayStyle * style)
{
  const gint columns = (gint) gst_cloth_uv_get_width (uv);
  const gint rows = (gint) gst_cloth_uv_get_height (uv);
  const gfloat wide = (gfloat) width / (gfloat) columns;
  const gfloat tall = (gfloat) height / (gfloat) rows;
  const gfloat edge = 0.001f * (gfloat) style->check;
  const gfloat *place = gst_cloth_uv_get_uv (uv, NULL);

  for (gint row = 0; row < rows && !cloth_work_is_over (canvas->work); row++) {
    gint begin = 0, colour = -1;

    for (gint column = 0; column <= columns; column++) {
      const gint next = column < columns ? check_at (place
          + 2 * ((gsize) row * columns + column), edge) : -1;

      if (next == colour) {
        continue;
      }
      if (colour >= 0) {
        const gfloat left = wide * (gfloat) begin - 0.5f;
        const gfloat right = wide * (gfloat) column - 0.5f;
        const gfloat top = tall * (gfloat) row - 0.5f;
        const gfloat bottom = tall * (gfloat) (row + 1) - 0.5f;
        const gfloat x[4] = { left, right, right, left };
        const gfloat y[4] = { top, top, bottom, bottom };
        ClothColour fill = check_colours[colour];

        fill.a = SHEET_OPACITY * style->opacity;
        cloth_draw_quad (canvas, x, y, &fill);
      }
      begin = column;
      colour = next;
    }
  }
}
