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
/* Indices closer than this could not be read, px. */
#define LEAST_SIZE_FOR_INDEX 14.0f

static const ClothColour unlabelled_colour = { 1, 0.15f, 0.15f, 1 };
static const ClothColour behind_colour = { 0.30f, 0.65f, 1, 1 };
static const ClothColour text_colour = { 1, 1, 1, 0.95f };

static ClothColour
with_opacity (ClothColour colour, gfloat opacity)
{
  colour.a *= opacity;
  return colour;
}

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

void
gst_cloth_overlay_draw_dots (const ClothCanvas * canvas, GstClothDots * dots,
    const GstClothOverlayStyle * style)
{
  guint n, columns = gst_cloth_dots_get_columns (dots);
  guint rows = gst_cloth_dots_get_rows (dots);
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n);
  ClothColour cross = with_opacity (unlabelled_colour, style->opacity);
  g_autoptr (GHashTable) by_label = g_hash_table_new (NULL, NULL);

  for (guint i = 0; i < n; i++) {
    if (dot[i].column >= 0 && dot[i].row >= 0
        && (guint) dot[i].column < columns && (guint) dot[i].row < rows) {
      g_hash_table_insert (by_label, GUINT_TO_POINTER ((guint) dot[i].row
              * columns + (guint) dot[i].column + 1), (gpointer) & dot[i]);
    }
  }
  for (guint i = 0; i < n; i++) {
    const GstClothDot *d = &dot[i];
    const guint key = (guint) d->row * columns + (guint) d->column + 1;
    const GstClothDot *right = NULL, *below = NULL;

    if (d->column < 0 || d->row < 0 || (guint) d->column >= columns
        || (guint) d->row >= rows) {
      if (style->draw_dots) {
        cloth_draw_line (canvas, d->x - CROSS_ARM, d->y - CROSS_ARM,
            d->x + CROSS_ARM, d->y + CROSS_ARM, style->line_width, &cross);
        cloth_draw_line (canvas, d->x - CROSS_ARM, d->y + CROSS_ARM,
            d->x + CROSS_ARM, d->y - CROSS_ARM, style->line_width, &cross);
      }
      continue;
    }
    if ((guint) d->column + 1 < columns) {
      right = g_hash_table_lookup (by_label, GUINT_TO_POINTER (key + 1));
    }
    if ((guint) d->row + 1 < rows) {
      below = g_hash_table_lookup (by_label, GUINT_TO_POINTER (key + columns));
    }
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
