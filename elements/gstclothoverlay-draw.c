/* clothoverlay: silhouettes, squares, saddles and dots from their metadata into a video frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothoverlay-draw.h"

#include <math.h>

/* px: the arms of a saddle's cross, the dashes of a predicted square */
#define CROSS_ARM 4.0f
#define DASH 4.0f
/* px: the dark edge on each side of a line, so that any film leaves it visible */
#define EDGE 1.0f

/* Indices on squares smaller or dots closer than this could not be read, px. */
#define LEAST_SIZE_FOR_INDEX 14.0f

const ClothColour gst_cloth_overlay_vertex_colours[GST_CLOTH_OVERLAY_STATES] = {
  {0.55f, 0.55f, 0.55f, 1},     /* unseen */
  {0.20f, 0.85f, 0.45f, 1},     /* measured: green */
  {1.00f, 0.72f, 0.15f, 1},     /* two views: amber */
  {0.25f, 0.60f, 1.00f, 1},     /* filled: blue */
  {0.75f, 0.45f, 1.00f, 1}      /* predicted: violet */
};

static const ClothColour saddle_colour = { 0.10f, 0.90f, 0.95f, 1 };
static const ClothColour silhouette_colour = { 0.20f, 0.95f, 0.35f, 1 };
static const ClothColour edge_colour = { 0.05f, 0.05f, 0.15f, 0.75f };
static const ClothColour text_colour = { 1, 1, 1, 0.95f };

static ClothColour
with_opacity (ClothColour colour, gfloat opacity)
{
  colour.a *= opacity;
  return colour;
}

/* Everything is drawn twice: first the edges of all lines, which would else lie over other
 * lines, then the lines. */
typedef enum
{
  PASS_EDGES,
  PASS_LINES,
  N_PASSES
} Pass;

static gfloat
width_in (Pass pass, gfloat width)
{
  return pass == PASS_EDGES ? width + 2 * EDGE : width;
}

static ClothColour
colour_in (Pass pass, ClothColour colour, const GstClothOverlayStyle * style)
{
  return with_opacity (pass == PASS_EDGES ? edge_colour : colour,
      style->opacity);
}

/* ---- silhouettes ---- */

/* The runs of one row. */
typedef struct
{
  const GstClothRun *runs;
  guint n;
} Row;

static const Row no_row = { NULL, 0 };

static void
draw_box (const ClothCanvas * canvas, const gdouble scale[2], gdouble x0,
    gdouble y0, gdouble x1, gdouble y1, const ClothColour * colour)
{
  const gfloat left = (gfloat) (x0 * scale[0] - 0.5);
  const gfloat right = (gfloat) (x1 * scale[0] - 0.5);
  const gfloat top = (gfloat) (y0 * scale[1] - 0.5);
  const gfloat bottom = (gfloat) (y1 * scale[1] - 0.5);
  const gfloat x[4] = { left, right, right, left };
  const gfloat y[4] = { top, top, bottom, bottom };

  cloth_draw_quad (canvas, x, y, colour);
}

static gint
end_of_run (const Row * row, guint i)
{
  if (i >= 2 * row->n) {
    return G_MAXINT;
  }
  return i % 2 ? row->runs[i / 2].end : row->runs[i / 2].begin;
}

/* Where just one of two rows is cloth is the border between them. */
static void
draw_between (const ClothCanvas * canvas, const gdouble scale[2],
    const Row * above, const Row * below, gdouble y, gdouble half,
    const ClothColour * colour)
{
  gboolean differs = FALSE;
  gint from = 0;
  guint i = 0, k = 0;

  while (i < 2 * above->n || k < 2 * below->n) {
    const gint a = end_of_run (above, i), b = end_of_run (below, k);
    const gint at = MIN (a, b);

    if (differs && at > from) {
      draw_box (canvas, scale, from, y - half, at, y + half, colour);
    }
    differs ^= (a == at) != (b == at);
    from = at;
    i += a == at;
    k += b == at;
  }
}

void
gst_cloth_overlay_draw_silhouette (const ClothCanvas * canvas, gint width,
    gint height, const GstClothSilhouette * silhouette,
    const GstClothOverlayStyle * style)
{
  const gdouble scale[2] =
      { (gdouble) width / gst_cloth_silhouette_get_width (silhouette),
    (gdouble) height / gst_cloth_silhouette_get_height (silhouette)
  };
  const gdouble half_x = 0.5 * style->line_width / scale[0];
  const gdouble half_y = 0.5 * style->line_width / scale[1];
  const ClothColour fill =
      with_opacity (silhouette_colour, style->fill_opacity * style->opacity);
  const ClothColour border = with_opacity (silhouette_colour, style->opacity);
  Row above = no_row, below;
  guint n, i;
  gint row_above = -1;
  const GstClothRun *runs = gst_cloth_silhouette_get_runs (silhouette, &n);

  for (i = 0; i < n; i += below.n) {
    const gint row = runs[i].row;
    guint k;

    below.runs = runs + i;
    for (below.n = 1; i + below.n < n && runs[i + below.n].row == row;) {
      below.n++;
    }
    if (row > row_above + 1) {
      draw_between (canvas, scale, &above, &no_row, row_above + 1, half_y,
          &border);
      above = no_row;
    }
    draw_between (canvas, scale, &above, &below, row, half_y, &border);
    for (k = 0; k < below.n; k++) {
      const GstClothRun *run = &below.runs[k];

      draw_box (canvas, scale, run->begin, row, run->end, row + 1, &fill);
      draw_box (canvas, scale, run->begin - half_x, row, run->begin + half_x,
          row + 1, &border);
      draw_box (canvas, scale, run->end - half_x, row, run->end + half_x,
          row + 1, &border);
    }
    above = below;
    row_above = row;
  }
  draw_between (canvas, scale, &above, &no_row, row_above + 1, half_y, &border);
}

/* ---- squares ---- */

static void
draw_quad_index (const ClothCanvas * canvas, const GstClothQuad * quad,
    Pass pass, const GstClothOverlayStyle * style)
{
  const ClothColour colour = colour_in (pass, text_colour, style);
  const gfloat *x = quad->x, *y = quad->y;
  /* edges of the square as it lies in the picture */
  gfloat right[2] = { 0.5f * (x[1] - x[0] + x[2] - x[3]),
    0.5f * (y[1] - y[0] + y[2] - y[3])
  };
  gfloat down[2] = { 0.5f * (x[3] - x[0] + x[2] - x[1]),
    0.5f * (y[3] - y[0] + y[2] - y[1])
  };
  gfloat size = MIN (hypotf (right[0], right[1]), hypotf (down[0], down[1]));
  gint line, numbers[2] = { quad->column, quad->row };

  if (!(size >= LEAST_SIZE_FOR_INDEX)) {
    return;
  }
  for (line = 0; line < 2; line++) {
    /* column above, row below; digits 0.16 wide and 0.28 high of the square */
    gint digits = numbers[line] < 0 || numbers[line] > 9 ? 2 : 1;
    gfloat u = 0.5f - 0.08f * (1 + 1.6f * (gfloat) (digits - 1));
    gfloat v = line ? 0.57f : 0.15f;
    gfloat origin[2] = { x[0] + u * right[0] + v * down[0],
      y[0] + u * right[1] + v * down[1]
    };
    gfloat r[2] = { 0.16f * right[0], 0.16f * right[1] };
    gfloat d[2] = { 0.28f * down[0], 0.28f * down[1] };

    cloth_draw_number (canvas, numbers[line], origin, r, d,
        width_in (pass, MAX (1.0f, 0.04f * size)), &colour);
  }
}

void
gst_cloth_overlay_draw_quads (const ClothCanvas * canvas,
    const GstClothQuad * quads, guint n, const GstClothOverlayStyle * style)
{
  guint i;
  gint k;

  for (i = 0; i < n && style->draw_quads; i++) {
    const GstClothQuad *q = &quads[i];
    ClothColour colour =
        cloth_draw_confidence_colour (q->confidence, style->c_low);

    if (q->state == GST_CLOTH_QUAD_TRACKED) {
      ClothColour fill =
          with_opacity (colour, style->fill_opacity * style->opacity);

      cloth_draw_quad (canvas, q->x, q->y, &fill);
    }
  }
  for (i = 0; i < N_PASSES * n && style->draw_quads; i++) {
    const Pass pass = i / n;
    const GstClothQuad *q = &quads[i % n];
    const gfloat width = width_in (pass, style->line_width);
    ClothColour colour = colour_in (pass,
        cloth_draw_confidence_colour (q->confidence, style->c_low), style);

    for (k = 0; k < 4; k++) {
      gint l = (k + 1) & 3;

      if (q->state == GST_CLOTH_QUAD_TRACKED) {
        cloth_draw_line (canvas, q->x[k], q->y[k], q->x[l], q->y[l], width,
            &colour);
      } else if (q->state == GST_CLOTH_QUAD_PREDICTED) {
        cloth_draw_dashes (canvas, q->x[k], q->y[k], q->x[l], q->y[l], width,
            DASH, &colour);
      }
    }
  }
  for (i = 0; i < n && style->draw_indices; i++) {
    if (quads[i].state != GST_CLOTH_QUAD_LOST) {
      draw_quad_index (canvas, &quads[i], PASS_EDGES, style);
      draw_quad_index (canvas, &quads[i], PASS_LINES, style);
    }
  }
}

/* ---- saddles ---- */

static void
draw_cross (const ClothCanvas * canvas, gfloat x, gfloat y, gfloat arm,
    gfloat width, const ClothColour * colour)
{
  cloth_draw_line (canvas, x - arm, y, x + arm, y, width, colour);
  cloth_draw_line (canvas, x, y - arm, x, y + arm, width, colour);
}

/* Refined saddles; the raw candidates only where nothing was refined. */
void
gst_cloth_overlay_draw_saddles (const ClothCanvas * canvas,
    GstClothSaddles * saddles, const GstClothOverlayStyle * style)
{
  guint i, n_refined, n_candidates;
  const GstClothSaddle *refined =
      gst_cloth_saddles_get_refined (saddles, &n_refined);
  const GstClothCandidate *candidates =
      gst_cloth_saddles_get_candidates (saddles, &n_candidates);

  for (Pass pass = 0; pass < N_PASSES; pass++) {
    const ClothColour colour = colour_in (pass, saddle_colour, style);
    const gfloat width = width_in (pass, style->line_width);

    for (i = 0; i < n_refined; i++) {
      const GstClothSaddle *s = &refined[i];
      gfloat scale2 = style->ellipse_scale * style->ellipse_scale;

      draw_cross (canvas, s->x, s->y, CROSS_ARM, width, &colour);
      if (scale2 > 0) {
        cloth_draw_ellipse (canvas, s->x, s->y, scale2 * s->cov_xx,
            scale2 * s->cov_xy, scale2 * s->cov_yy, width, &colour);
      }
    }
    for (i = 0; i < n_candidates && n_refined == 0; i++) {
      cloth_draw_line (canvas, candidates[i].x, candidates[i].y,
          candidates[i].x, candidates[i].y, width, &colour);
    }
  }
}

/* ---- dots ---- */

/* Log-odds of a label that is drawn in the colour of full confidence, nats. */
#define SURE 20.0f
/* Arms of the cross on a dot without a label; half the size of a dot's mark, px. */
#define DOT_ARM 3.0f
#define MARK 2.0f
/* Share of a link that is left free at each end: the dots stay visible. */
#define FREE 0.2f

const ClothColour gst_cloth_overlay_unlabelled_colour = { 1, 0.15f, 0.15f, 1 };
const ClothColour gst_cloth_overlay_behind_colour = { 0.30f, 0.65f, 1, 1 };

static ClothColour
dot_colour (const GstClothDot * dot)
{
  return cloth_draw_confidence_colour (MIN (dot->confidence / SURE, 1), 0);
}

static void
draw_link (const ClothCanvas * canvas, const GstClothDot * a,
    const GstClothDot * b, Pass pass, const GstClothOverlayStyle * style)
{
  gfloat dx = b->x - a->x, dy = b->y - a->y;
  ClothColour colour = colour_in (pass, a->mirrored ?
      gst_cloth_overlay_behind_colour :
      dot_colour (a->confidence < b->confidence ? a : b), style);

  cloth_draw_line (canvas, a->x + FREE * dx, a->y + FREE * dy, b->x - FREE * dx,
      b->y - FREE * dy, width_in (pass, style->line_width), &colour);
}

/* Column above, row below, upright in the picture. */
static void
draw_dot_index (const ClothCanvas * canvas, const GstClothDot * dot,
    gfloat size, Pass pass, const GstClothOverlayStyle * style)
{
  const ClothColour colour = colour_in (pass, text_colour, style);
  const gint numbers[2] = { dot->column, dot->row };
  const gfloat right[2] = { 0.16f * size, 0 }, down[2] = { 0, 0.28f * size };

  for (gint line = 0; line < 2; line++) {
    gfloat origin[2] = { dot->x - 0.2f * size,
      dot->y + (line ? 0.06f : -0.34f) * size
    };

    cloth_draw_number (canvas, numbers[line], origin, right, down,
        width_in (pass, MAX (1.0f, 0.04f * size)), &colour);
  }
}

static gboolean
has_label (const GstClothDot * dot, guint columns, guint rows)
{
  return dot->column >= 0 && dot->row >= 0 && (guint) dot->column < columns
      && (guint) dot->row < rows;
}

guint64
gst_cloth_overlay_place (guint columns, gint column, gint row, guint index)
{
  return ((guint64) (guint) row * columns + (guint) column) << 32 | index;
}

static gint
compare_places (gconstpointer a, gconstpointer b)
{
  const guint64 x = *(const guint64 *) a, y = *(const guint64 *) b;

  return (x > y) - (x < y);
}

void
gst_cloth_overlay_sort_places (GArray * places)
{
  g_array_sort (places, compare_places);
}

/* Places may be a stranger's: no table is hashed by them. */
guint
gst_cloth_overlay_find_place (const GArray * places, guint columns, guint rows,
    gint column, gint row)
{
  const guint64 key = gst_cloth_overlay_place (columns, column, row, 0);
  guint low = 0, high = places->len;
  guint64 found;

  if ((guint) column >= columns || (guint) row >= rows) {
    return G_MAXUINT;
  }
  while (low < high) {
    const guint middle = (low + high) / 2;

    if (g_array_index (places, guint64, middle) < key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  if (low == places->len) {
    return G_MAXUINT;
  }
  found = g_array_index (places, guint64, low);
  return found >> 32 == key >> 32 ? (guint) (found & G_MAXUINT32) : G_MAXUINT;
}

static const GstClothDot *
find_dot (const GArray * places, guint columns, guint rows,
    const GstClothDot * dots, gint column, gint row)
{
  const guint index = gst_cloth_overlay_find_place (places, columns, rows,
      column, row);

  return index == G_MAXUINT ? NULL : &dots[index];
}

void
gst_cloth_overlay_draw_dots (const ClothCanvas * canvas, GstClothDots * dots,
    GArray * places, const GstClothOverlayStyle * style)
{
  guint n, columns = gst_cloth_dots_get_columns (dots);
  guint rows = gst_cloth_dots_get_rows (dots);
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n);

  g_array_set_size (places, 0);
  for (guint i = 0; i < n; i++) {
    if (has_label (&dot[i], columns, rows)) {
      const guint64 place =
          gst_cloth_overlay_place (columns, dot[i].column, dot[i].row, i);

      g_array_append_val (places, place);
    }
  }
  gst_cloth_overlay_sort_places (places);
  for (guint i = 0; i < N_PASSES * n; i++) {
    const Pass pass = i / n;
    const GstClothDot *d = &dot[i % n];
    const gfloat width = width_in (pass, style->line_width);
    const GstClothDot *right, *below;

    if (!has_label (d, columns, rows)) {
      if (style->draw_dots) {
        const ClothColour cross = colour_in (pass,
            gst_cloth_overlay_unlabelled_colour, style);

        cloth_draw_line (canvas, d->x - DOT_ARM, d->y - DOT_ARM,
            d->x + DOT_ARM, d->y + DOT_ARM, width, &cross);
        cloth_draw_line (canvas, d->x - DOT_ARM, d->y + DOT_ARM,
            d->x + DOT_ARM, d->y - DOT_ARM, width, &cross);
      }
      continue;
    }
    right = find_dot (places, columns, rows, dot, d->column + 1, d->row);
    below = find_dot (places, columns, rows, dot, d->column, d->row + 1);
    if (style->draw_dots) {
      const ClothColour colour = colour_in (pass, dot_colour (d), style);

      if (right) {
        draw_link (canvas, d, right, pass, style);
      }
      if (below) {
        draw_link (canvas, d, below, pass, style);
      }
      cloth_draw_ellipse (canvas, d->x, d->y, MARK * MARK, 0, MARK * MARK,
          width, &colour);
    }
    if (style->draw_indices && (right || below)) {
      const GstClothDot *other = right ? right : below;
      gfloat size = hypotf (other->x - d->x, other->y - d->y);

      if (size >= LEAST_SIZE_FOR_INDEX) {
        draw_dot_index (canvas, d, size, pass, style);
      }
    }
  }
}

/* ---- the picture ---- */

/* How a colour becomes sample values, by the picture's colorimetry. */
static void
fill_weights (const GstVideoInfo * info, guint component, gfloat weights[4])
{
  const GstVideoFormatInfo *finfo = info->finfo;
  gint offset[4], scale[4];
  gdouble Kr = 0.299, Kb = 0.114, Kg;
  guint k;

  gst_video_color_range_offsets (info->colorimetry.range, finfo, offset, scale);
  gst_video_color_matrix_get_Kr_Kb (info->colorimetry.matrix, &Kr, &Kb);
  Kg = 1 - Kr - Kb;
  for (k = 0; k < 4; k++) {
    weights[k] = 0;
  }
  weights[3] = (gfloat) offset[component];
  if (component == GST_VIDEO_COMP_A) {
    weights[3] = 255;
  } else if (GST_VIDEO_FORMAT_INFO_IS_RGB (finfo)) {
    weights[component] = (gfloat) scale[component];
  } else {
    gdouble w[3] = { Kr, Kg, Kb };

    if (component == GST_VIDEO_COMP_U) {
      gdouble f = 1 / (2 * (1 - Kb));

      w[0] = -Kr * f;
      w[1] = -Kg * f;
      w[2] = 0.5;
    } else if (component == GST_VIDEO_COMP_V) {
      gdouble f = 1 / (2 * (1 - Kr));

      w[0] = 0.5;
      w[1] = -Kg * f;
      w[2] = -Kb * f;
    }
    for (k = 0; k < 3; k++) {
      weights[k] = (gfloat) (w[k] * scale[component]);
    }
  }
}

void
gst_cloth_overlay_canvas (GstVideoFrame * frame, ClothCanvas * canvas)
{
  guint i;

  canvas->work = NULL;
  canvas->n_components = GST_VIDEO_FRAME_N_COMPONENTS (frame);
  for (i = 0; i < canvas->n_components; i++) {
    ClothComponent *c = &canvas->components[i];

    c->data = GST_VIDEO_FRAME_COMP_DATA (frame, i);
    c->stride = GST_VIDEO_FRAME_COMP_STRIDE (frame, i);
    c->step = GST_VIDEO_FRAME_COMP_PSTRIDE (frame, i);
    c->width = GST_VIDEO_FRAME_COMP_WIDTH (frame, i);
    c->height = GST_VIDEO_FRAME_COMP_HEIGHT (frame, i);
    c->shift_x = GST_VIDEO_FORMAT_INFO_W_SUB (frame->info.finfo, i);
    c->shift_y = GST_VIDEO_FORMAT_INFO_H_SUB (frame->info.finfo, i);
    fill_weights (&frame->info, i, c->weights);
  }
}
