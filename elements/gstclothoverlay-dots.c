/* clothoverlay: labelled dots from their metadata into a video frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothoverlay-draw.h"

#include <math.h>

/* Log-odds of a label that is drawn in the colour of full confidence, nats. */
#define SURE 20.0f
/* Arms of the cross on a dot without a label; half the size of a dot's mark, px. */
#define CROSS_ARM 3.0f
#define MARK 2.0f
/* Share of a link that its dot's half leaves free at the ends: the dots stay visible. */
#define GAP 0.2f

static const ClothColour unlabelled_colour = { 1, 0.15f, 0.15f, 1 };
static const ClothColour behind_colour = { 0.30f, 0.65f, 1, 1 };
static const ClothColour text_colour = { 1, 1, 1, 0.95f };

static ClothColour
colour_of (const GstClothDot * dot, const GstClothOverlayStyle * style)
{
  return with_opacity (cloth_draw_confidence_colour (MIN (dot->confidence
              / SURE, 1), 0), style->opacity);
}

static void
draw_link (const ClothCanvas * canvas, const GstClothDot * a,
    const GstClothDot * b, const GstClothOverlayStyle * style)
{
  gfloat dx = b->x - a->x, dy = b->y - a->y;
  ClothColour colour = colour_of (a->confidence < b->confidence ? a : b, style);

  if (a->mirrored) {
    colour = with_opacity (behind_colour, style->opacity);
  }
  cloth_draw_line (canvas, a->x + GAP * dx, a->y + GAP * dy, b->x - GAP * dx,
      b->y - GAP * dy, style->line_width, &colour);
}

/* Column above, row below, upright in the picture. */
static void
draw_index (const ClothCanvas * canvas, const GstClothDot * dot, gfloat size,
    const GstClothOverlayStyle * style)
{
  ClothColour colour = with_opacity (text_colour, style->opacity);
  const gint numbers[2] = { dot->column, dot->row };
  const gfloat right[2] = { 0.16f * size, 0 }, down[2] = { 0, 0.28f * size };

  for (gint line = 0; line < 2; line++) {
    gfloat origin[2] = { dot->x - 0.2f * size,
      dot->y + (line ? 0.06f : -0.34f) * size
    };

    cloth_draw_number (canvas, numbers[line], origin, right, down,
        MAX (1.0f, 0.04f * size), &colour);
  }
}

static gboolean
has_label (const GstClothDot * dot, guint columns, guint rows)
{
  return dot->column >= 0 && dot->row >= 0 && (guint) dot->column < columns
      && (guint) dot->row < rows;
}

/* Pictures share the table, so that it needs no memory anew: what is found may be of
 * another picture, and a dot has the label when it says so itself. */
static const GstClothDot *
find_dot (GHashTable * by_label, guint columns, guint rows,
    const GstClothDot * dots, guint n, gint column, gint row)
{
  const guint key = (guint) row * columns + (guint) column;
  const guint i = GPOINTER_TO_UINT (g_hash_table_lookup (by_label,
          GUINT_TO_POINTER (key)));

  return i < n && dots[i].column == column && dots[i].row == row
      && has_label (&dots[i], columns, rows) ? &dots[i] : NULL;
}

void
gst_cloth_overlay_draw_dots (const ClothCanvas * canvas, GstClothDots * dots,
    GHashTable * by_label, const GstClothOverlayStyle * style)
{
  guint n, columns = gst_cloth_dots_get_columns (dots);
  guint rows = gst_cloth_dots_get_rows (dots);
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n);
  ClothColour cross = with_opacity (unlabelled_colour, style->opacity);

  if (g_hash_table_size (by_label) > GST_CLOTH_MAX_FEATURES) {
    g_hash_table_remove_all (by_label);
  }
  for (guint i = 0; i < n; i++) {
    if (has_label (&dot[i], columns, rows)) {
      g_hash_table_insert (by_label, GUINT_TO_POINTER ((guint) dot[i].row
              * columns + (guint) dot[i].column), GUINT_TO_POINTER (i));
    }
  }
  for (guint i = 0; i < n; i++) {
    const GstClothDot *d = &dot[i];
    const GstClothDot *right, *below;

    if (!has_label (d, columns, rows)) {
      if (style->draw_dots) {
        cloth_draw_line (canvas, d->x - CROSS_ARM, d->y - CROSS_ARM,
            d->x + CROSS_ARM, d->y + CROSS_ARM, style->line_width, &cross);
        cloth_draw_line (canvas, d->x - CROSS_ARM, d->y + CROSS_ARM,
            d->x + CROSS_ARM, d->y - CROSS_ARM, style->line_width, &cross);
      }
      continue;
    }
    right = find_dot (by_label, columns, rows, dot, n, d->column + 1, d->row);
    below = find_dot (by_label, columns, rows, dot, n, d->column, d->row + 1);
    if (style->draw_dots) {
      ClothColour colour = colour_of (d, style);

      if (right) {
        draw_link (canvas, d, right, style);
      }
      if (below) {
        draw_link (canvas, d, below, style);
      }
      cloth_draw_ellipse (canvas, d->x, d->y, MARK * MARK, 0, MARK * MARK,
          style->line_width, &colour);
    }
    if (style->draw_indices && (right || below)) {
      const GstClothDot *other = right ? right : below;
      gfloat size = hypotf (other->x - d->x, other->y - d->y);

      if (size >= LEAST_SIZE_FOR_INDEX) {
        draw_index (canvas, d, size, style);
      }
    }
  }
}
