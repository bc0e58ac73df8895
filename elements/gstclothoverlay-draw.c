/* clothoverlay: squares, saddles and gaps from their metadata into a video frame.
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

static const ClothColour saddle_colour = { 0.10f, 0.90f, 0.95f, 1 };
static const ClothColour text_on_black = { 1, 1, 1, 0.95f };
static const ClothColour text_on_white = { 0.05f, 0.05f, 0.15f, 0.95f };

static void
draw_index (const ClothCanvas * canvas, const GstClothQuad * quad,
    const ClothColour * colour)
{
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
        MAX (1.0f, 0.04f * size), colour);
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
  for (i = 0; i < n && style->draw_quads; i++) {
    const GstClothQuad *q = &quads[i];
    ClothColour colour =
        with_opacity (cloth_draw_confidence_colour (q->confidence,
            style->c_low), style->opacity);

    for (k = 0; k < 4; k++) {
      gint l = (k + 1) & 3;

      if (q->state == GST_CLOTH_QUAD_TRACKED) {
        cloth_draw_line (canvas, q->x[k], q->y[k], q->x[l], q->y[l],
            style->line_width, &colour);
      } else if (q->state == GST_CLOTH_QUAD_PREDICTED) {
        cloth_draw_dashes (canvas, q->x[k], q->y[k], q->x[l], q->y[l],
            style->line_width, DASH, &colour);
      }
    }
  }
  for (i = 0; i < n && style->draw_indices; i++) {
    ClothColour colour =
        with_opacity (quads[i].black ? text_on_black : text_on_white,
        style->opacity);

    if (quads[i].state != GST_CLOTH_QUAD_LOST) {
      draw_index (canvas, &quads[i], &colour);
    }
  }
}

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
  ClothColour colour = with_opacity (saddle_colour, style->opacity);
  guint i, n_refined, n_candidates;
  const GstClothSaddle *refined =
      gst_cloth_saddles_get_refined (saddles, &n_refined);
  const GstClothCandidate *candidates =
      gst_cloth_saddles_get_candidates (saddles, &n_candidates);

  for (i = 0; i < n_refined; i++) {
    const GstClothSaddle *s = &refined[i];
    gfloat scale2 = style->ellipse_scale * style->ellipse_scale;

    draw_cross (canvas, s->x, s->y, CROSS_ARM, style->line_width, &colour);
    if (scale2 > 0) {
      cloth_draw_ellipse (canvas, s->x, s->y, scale2 * s->cov_xx,
          scale2 * s->cov_xy, scale2 * s->cov_yy, style->line_width, &colour);
    }
  }
  for (i = 0; i < n_candidates && n_refined == 0; i++) {
    cloth_draw_line (canvas, candidates[i].x, candidates[i].y, candidates[i].x,
        candidates[i].y, style->line_width, &colour);
  }
}

/* ---- the gap ---- */

/* The scale's bar in a picture of this height and more, px. */
#define BAR_HEIGHT 96.0f
#define BAR_WIDTH 10.0f
#define BAR_MARGIN 12.0f
#define DIGIT_HEIGHT 11.0f

/* The report's colours: plain cloth for no distance, to a dark red. */
const ClothColour *
gst_cloth_overlay_heat_colours (void)
{
  static const struct
  {
    gfloat at, rgb[3];
  } stops[5] = {
    {0.00f, {240, 234, 222}}, {0.20f, {248, 214, 150}}, {0.45f, {244, 150, 70}},
    {0.70f, {214, 62, 52}}, {1.00f, {104, 10, 62}}
  };
  static const ClothColour unseen = { 0.502f, 0.525f, 0.569f, 1 };
  static ClothColour colours[GST_CLOTH_OVERLAY_HEATS];
  static gsize done;

  if (g_once_init_enter (&done)) {
    guint i, k = 0, n = GST_CLOTH_OVERLAY_HEATS - 1;

    for (i = 0; i < n; i++) {
      gfloat at = (gfloat) i / (gfloat) (n - 1), f;
      gfloat *to[3] = { &colours[i].r, &colours[i].g, &colours[i].b };
      guint c;

      while (k < 3 && stops[k + 1].at < at) {
        k++;
      }
      f = (at - stops[k].at) / (stops[k + 1].at - stops[k].at);
      for (c = 0; c < 3; c++) {
        *to[c] = (stops[k].rgb[c] + f * (stops[k + 1].rgb[c] -
                stops[k].rgb[c])) / 255;
      }
      colours[i].a = 1;
    }
    colours[n] = unseen;
    g_once_init_leave (&done, 1);
  }
  return colours;
}

void
gst_cloth_overlay_heat (GstClothGap * gap, guint scale_mm, guint8 * heats)
{
  const guint last = GST_CLOTH_OVERLAY_HEATS - 2;
  const gfloat *r = gst_cloth_gap_get_residuals (gap, NULL);
  const gfloat per_metre = 1000 * (gfloat) last / (gfloat) scale_mm;
  guint i, n = gst_cloth_gap_get_n_vertices (gap);

  for (i = 0; i < n; i++, r += 3) {
    gfloat heat = per_metre * sqrtf (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);

    heats[i] = (guint8) (isnan (heat) ? last + 1 :
        heat < (gfloat) last ? (guint) (heat + 0.5f) : last);
  }
}

/* A number with an edge of the other lightness, so that any film leaves it legible. */
static void
draw_label (const ClothCanvas * canvas, gint number, gfloat x, gfloat y,
    gfloat size, gfloat opacity)
{
  const gfloat origin[2] = { x, y }, right[2] = { 0.57f * size, 0 };
  const gfloat down[2] = { 0, size };
  ClothColour edge = with_opacity (text_on_white, opacity);
  ClothColour text = with_opacity (text_on_black, opacity);

  cloth_draw_number (canvas, number, origin, right, down, 0.36f * size, &edge);
  cloth_draw_number (canvas, number, origin, right, down, 0.14f * size, &text);
}

void
gst_cloth_overlay_draw_scale (const ClothCanvas * canvas, gint width,
    gint height, const GstClothOverlayStyle * style)
{
  const ClothColour *colours = gst_cloth_overlay_heat_colours ();
  const guint n = GST_CLOTH_OVERLAY_HEATS - 1;
  gfloat grow = MAX (1.0f, (gfloat) height / 480);
  gfloat tall = grow * BAR_HEIGHT, wide = grow * BAR_WIDTH;
  gfloat left = grow * BAR_MARGIN;
  gfloat bottom = (gfloat) height - grow * BAR_MARGIN;
  gfloat size = grow * DIGIT_HEIGHT;
  guint i;

  /* In a thumbnail there is no place for it. */
  if ((gfloat) height < 2 * tall || (gfloat) width < 2 * tall) {
    return;
  }
  for (i = 0; i < n; i++) {
    gfloat y0 = bottom - tall * (gfloat) (i + 1) / (gfloat) n;
    gfloat y1 = bottom - tall * (gfloat) i / (gfloat) n;
    const gfloat x[4] = { left, left + wide, left + wide, left };
    const gfloat y[4] = { y0, y0, y1, y1 };
    ClothColour colour = with_opacity (colours[i], style->opacity);

    cloth_draw_quad (canvas, x, y, &colour);
  }
  draw_label (canvas, 0, left + 1.6f * wide, bottom - size, size,
      style->opacity);
  draw_label (canvas, (gint) style->gap_scale, left + 1.6f * wide,
      bottom - tall, size, style->opacity);
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
