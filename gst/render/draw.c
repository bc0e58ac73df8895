/* Anti-aliased drawing on 8-bit pictures of any layout.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/* Every shape is a function from a pixel to a coverage, by the distance to its outline
 * (box filter of one sample); draw-rows.c works it out along rows, once for all components
 * of equal subsampling, and blends it into each. */
#include "gst/render/draw.h"

#include <math.h>

#include "gst/render/draw-private.h"

/* The next group of components that share one sampling grid; FALSE after the last. */
static gboolean
next_group (const ClothCanvas * canvas, ClothDrawGroup * group)
{
  const ClothComponent *c;
  gint i = group->first + group->n;

  if (i >= (gint) canvas->n_components) {
    return FALSE;
  }
  c = &canvas->components[i];
  group->first = i;
  while (i < (gint) canvas->n_components
      && canvas->components[i].shift_x == c->shift_x
      && canvas->components[i].shift_y == c->shift_y) {
    i++;
  }
  group->n = i - group->first;
  group->width = c->width;
  group->height = c->height;
  group->scale_x = (gfloat) (1 << c->shift_x);
  group->scale_y = (gfloat) (1 << c->shift_y);
  group->offset_x = 0.5f * (group->scale_x - 1);
  group->offset_y = 0.5f * (group->scale_y - 1);
  group->softness = MAX (group->scale_x, group->scale_y);
  return TRUE;
}

static guint8
value_of (const ClothComponent * c, const ClothColour * colour)
{
  gfloat value = c->weights[0] * colour->r + c->weights[1] * colour->g +
      c->weights[2] * colour->b + c->weights[3];

  return (guint8) CLAMP (value + 0.5f, 0.0f, 255.0f);
}

/* The colour in the components of @group. */
static ClothDrawInk
ink_of (const ClothCanvas * canvas, const ClothDrawGroup * group,
    const ClothColour * colour)
{
  ClothDrawInk ink = { &canvas->components[group->first], group->n };
  const ClothComponent *c = ink.components;
  guint8 *last = c->data;
  gint k, i;

  ink.step = c->step;
  ink.stride = c->stride;
  ink.data = c->data;
  for (k = 0; k < ink.n; k++) {
    ink.values[k] = value_of (&c[k], colour);
    ink.data = MIN (ink.data, c[k].data);
    last = MAX (last, c[k].data);
    if (c[k].step != ink.step || c[k].stride != ink.stride) {
      ink.step = 0;
    }
  }
  if (ink.step < 2 || ink.step > 4 || last - ink.data >= ink.step) {
    ink.step = 0;
    return ink;
  }
  for (k = 0; k < ink.n; k++) {
    gint at = (gint) (c[k].data - ink.data);

    ink.own[at] = 1;
    for (i = at; i < ink.step * CLOTH_DRAW_CHUNK; i += ink.step) {
      ink.value[i] = ink.values[k];
    }
  }
  return ink;
}

/* Pixels of a range of rows or columns that lie in the picture, along its @size. */
static gdouble
clipped (gfloat low, gfloat high, gint size)
{
  const gdouble a = MAX (low, 0.0f), b = MIN (high, (gfloat) size);

  return MAX (b - a, 0);
}

/* What a shape's edges and its coarsest samples reach beyond its corners, px. */
#define REACH 16

/* Whether a shape between two corners is to be drawn that is at most @wide in each row: it
 * is not when it lies beside the picture, or when there is no work left for it. A row costs a
 * chunk at least. */
static gboolean
take_work (const ClothCanvas * canvas, gfloat left, gfloat top, gfloat right,
    gfloat bottom, gfloat wide)
{
  const ClothComponent *c = &canvas->components[0];
  const gint width = c->width << c->shift_x, height = c->height << c->shift_y;
  gdouble row;

  if (!(right + REACH > 0) || !(left - REACH < (gfloat) width)
      || !(bottom + REACH > 0) || !(top - REACH < (gfloat) height)) {
    cloth_work_take (canvas->work, 0);
    return FALSE;
  }
  if (!canvas->work)
    return TRUE;
  row = MIN (clipped (left, right, width), (gdouble) wide);
  return cloth_work_take (canvas->work, MAX (row, CLOTH_DRAW_CHUNK) *
      clipped (top - 1, bottom + 1, height));
}

/* @canvas: where to
 * @x0: px
 * @y0: px
 * @x1: px
 * @y1: px
 * @width: px; a line thinner than a sample gets fainter
 * @colour: colour
 *
 * Draws a straight line with round ends.
 */
void
cloth_draw_line (const ClothCanvas * canvas, gfloat x0, gfloat y0, gfloat x1,
    gfloat y1, gfloat width, const ClothColour * colour)
{
  const ClothDrawRows *rows = CLOTH_SIMD_TABLE (cloth_draw_rows,
      CLOTH_SIMD_BEST);
  ClothDrawGroup group = { 0 };
  gfloat dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
  gfloat length = sqrtf (length2);
  ClothDrawLine line = { x0, y0, x1, y1, 1, 0, length };

  if (!isfinite (length2) || !isfinite (x0) || !isfinite (y0)
      || !(width > 0) || !(colour->a > 0)) {
    return;
  }
  if (length > 0) {
    line.ux = dx / length;
    line.uy = dy / length;
  }
  if (fabsf (dy) > 1e-3f) {
    line.strip = length / fabsf (dy);
    line.slope = dx / dy;
  }
  line.most = 256 * colour->a * MIN (width, 1);
  line.radius = 0.5f * (width + 1);
  if (!take_work (canvas, MIN (x0, x1) - line.radius,
          MIN (y0, y1) - line.radius, MAX (x0, x1) + line.radius,
          MAX (y0, y1) + line.radius,
          line.strip > 0 ? 2 * line.strip * line.radius : INFINITY)) {
    return;
  }
  while (next_group (canvas, &group)) {
    ClothDrawInk ink = ink_of (canvas, &group, colour);

    line.radius = 0.5f * (width + group.softness);
    line.strength = 256 * colour->a / group.softness;
    rows->line (&group, &ink, &line);
  }
}

/* @canvas: where to
 * @x0: px
 * @y0: px
 * @x1: px
 * @y1: px
 * @width: px
 * @dash: length of a dash and of a gap, px
 * @colour: colour
 *
 * Draws a dashed line; it begins and ends with a dash.
 */
void
cloth_draw_dashes (const ClothCanvas * canvas, gfloat x0, gfloat y0, gfloat x1,
    gfloat y1, gfloat width, gfloat dash, const ClothColour * colour)
{
  gfloat length = hypotf (x1 - x0, y1 - y0);
  gint i, n;

  if (!isfinite (length) || !(dash > 0)) {
    return;
  }
  /* an odd number of pieces, and never more than make sense on a picture */
  n = (gint) MIN (length / dash, 4096) | 1;
  for (i = 0; i < n && !cloth_work_is_over (canvas->work); i += 2) {
    gfloat a = (gfloat) i / (gfloat) n, b = (gfloat) (i + 1) / (gfloat) n;

    cloth_draw_line (canvas, x0 + a * (x1 - x0), y0 + a * (y1 - y0),
        x0 + b * (x1 - x0), y0 + b * (y1 - y0), width, colour);
  }
}

/* @canvas: where to
 * @x: corners in order, px
 * @y: corners in order, px
 * @colour: colour
 *
 * Fills a convex quadrilateral; one that is not convex is left out.
 */
void
cloth_draw_quad (const ClothCanvas * canvas, const gfloat x[4],
    const gfloat y[4], const ClothColour * colour)
{
  const ClothDrawRows *rows = CLOTH_SIMD_TABLE (cloth_draw_rows,
      CLOTH_SIMD_BEST);
  ClothDrawGroup group = { 0 };
  ClothDrawQuad quad = {.top = y[0],.bottom = y[0],.full = 256 * colour->a };
  gfloat turn = 0, left, right;
  gint k;

  if (!(colour->a > 0)) {
    return;
  }
  for (k = 0; k < 4; k++) {
    gint l = (k + 1) & 3, m = (k + 2) & 3;
    gfloat cross = (x[l] - x[k]) * (y[m] - y[l]) - (y[l] - y[k]) * (x[m] -
        x[l]);

    /* all four turns the same way; fails for NaN too */
    if (!isfinite (cross) || !(turn * cross >= 0) || cross == 0) {
      return;
    }
    turn = cross;
  }
  left = right = x[0];
  for (k = 0; k < 4; k++) {
    gint l = (k + 1) & 3;
    gfloat ex = x[l] - x[k], ey = y[l] - y[k];
    gfloat scale = (turn > 0 ? 1 : -1) / hypotf (ex, ey);

    quad.nx[k] = -ey * scale;
    quad.ny[k] = ex * scale;
    quad.d[k] = -(quad.nx[k] * x[k] + quad.ny[k] * y[k]);
    quad.top = MIN (quad.top, y[k]);
    quad.bottom = MAX (quad.bottom, y[k]);
    left = MIN (left, x[k]);
    right = MAX (right, x[k]);
  }
  if (!take_work (canvas, left, quad.top, right, quad.bottom, INFINITY)) {
    return;
  }
  while (next_group (canvas, &group)) {
    ClothDrawInk ink = ink_of (canvas, &group, colour);

    rows->quad (&group, &ink, &quad);
  }
}

/* @canvas: where to
 * @x: centre, px
 * @y: centre, px
 * @xx: of the matrix C, px²
 * @xy: of C
 * @yy: of C
 * @width: of the line, px
 * @colour: colour
 *
 * Draws the ellipse p' C⁻¹ p = 1 about the centre: with C a covariance, its one-sigma
 * contour. Left out when C is not positive definite.
 */
void
cloth_draw_ellipse (const ClothCanvas * canvas, gfloat x, gfloat y, gfloat xx,
    gfloat xy, gfloat yy, gfloat width, const ClothColour * colour)
{
  /* the Cholesky factor of C maps the unit circle to the ellipse */
  gfloat a = sqrtf (xx), b = xy / a, c = sqrtf (yy - b * b);
  gfloat from_x = x + a, from_y = y + b;
  gint i, n;

  if (!isfinite (a) || !isfinite (b) || !isfinite (c) || !(a > 0)) {
    return;
  }
  n = (gint) CLAMP (2 * MAX (a, sqrtf (yy)), 12.0f, 64.0f);
  for (i = 1; i <= n && !cloth_work_is_over (canvas->work); i++) {
    gfloat angle = (gfloat) (2 * G_PI) * (gfloat) i / (gfloat) n;
    gfloat u = cosf (angle), v = sinf (angle);
    gfloat to_x = x + a * u, to_y = y + b * u + c * v;

    cloth_draw_line (canvas, from_x, from_y, to_x, to_y, width, colour);
    from_x = to_x;
    from_y = to_y;
  }
}

/* Digits as strokes on a grid of 3 × 5 points: "xy" pairs, a space lifts the pen. */
static const gchar *const digits[] = {
  "0020240400", "011014 0424", "002022020424", "00202404 0222", "000222 2024",
  "200002222404", "200004242202", "002014", "0020240400 0222", "220200202404"
};

static void
draw_digit (const ClothCanvas * canvas, gint digit, const gfloat origin[2],
    const gfloat right[2], const gfloat down[2], gfloat width,
    const ClothColour * colour)
{
  const gchar *s = digits[digit];
  gfloat x = 0, y = 0;
  gboolean pen = FALSE;

  while (*s) {
    gfloat u, v, to_x, to_y;

    if (*s == ' ') {
      pen = FALSE;
      s++;
      continue;
    }
    u = (gfloat) (s[0] - '0') / 2;
    v = (gfloat) (s[1] - '0') / 4;
    to_x = origin[0] + u * right[0] + v * down[0];
    to_y = origin[1] + u * right[1] + v * down[1];
    if (pen) {
      cloth_draw_line (canvas, x, y, to_x, to_y, width, colour);
    }
    x = to_x;
    y = to_y;
    pen = TRUE;
    s += 2;
  }
}

/* @canvas: where to
 * @number: what to write, −9999 … 99999
 * @origin: top-left of the first digit, px
 * @right: from the left to the right edge of a digit, px
 * @down: from its top to its bottom, px
 * @width: of the strokes, px
 * @colour: colour
 *
 * Writes a whole number along any direction, so that it can lie on the cloth. Digits
 * are 1.6 @right apart.
 */
void
cloth_draw_number (const ClothCanvas * canvas, gint number,
    const gfloat origin[2], const gfloat right[2], const gfloat down[2],
    gfloat width, const ClothColour * colour)
{
  gchar text[16];
  gfloat at[2] = { origin[0], origin[1] };
  gint i;

  g_snprintf (text, sizeof (text), "%d", CLAMP (number, -9999, 99999));
  for (i = 0; text[i]; i++) {
    if (text[i] == '-') {
      cloth_draw_line (canvas, at[0] + 0.5f * down[0], at[1] + 0.5f * down[1],
          at[0] + right[0] + 0.5f * down[0], at[1] + right[1] + 0.5f * down[1],
          width, colour);
    } else {
      draw_digit (canvas, text[i] - '0', at, right, down, width, colour);
    }
    at[0] += 1.6f * right[0];
    at[1] += 1.6f * right[1];
  }
}

/* @confidence: −1 … 1
 * @low: the confidence below which a square is given up, c_low of the paper
 *
 * The colours of the paper's figure 2: yellow for a confidence of 1, purple for @low
 * (and whatever is below), through red and orange between.
 *
 * Returns: an opaque colour
 */
ClothColour
cloth_draw_confidence_colour (gfloat confidence, gfloat low)
{
  static const ClothColour stops[4] = {
    {0.50f, 0.13f, 0.78f, 1}, {0.91f, 0.22f, 0.46f, 1},
    {1.00f, 0.58f, 0.13f, 1}, {1.00f, 0.93f, 0.15f, 1}
  };
  gfloat t = low < 1 ? (confidence - low) / (1 - low) : 1;
  const ClothColour *s;
  ClothColour colour;
  gfloat f;

  t = t >= 0 ? MIN (t, 1) : 0;  /* NaN counts as low */
  s = &stops[MIN ((gint) (3 * t), 2)];
  f = 3 * t - (gfloat) (s - stops);
  colour.r = s[0].r + f * (s[1].r - s[0].r);
  colour.g = s[0].g + f * (s[1].g - s[0].g);
  colour.b = s[0].b + f * (s[1].b - s[0].b);
  colour.a = 1;
  return colour;
}

/* ---- heat maps ---- */

/* The scale's bar in a picture of 480 rows, px; it grows with taller ones. */
#define BAR_HEIGHT 96.0f
#define BAR_WIDTH 10.0f
#define BAR_MARGIN 12.0f
#define DIGIT_HEIGHT 11.0f

/* From the plain cloth to the end of a scale: at, and red, green, blue there. */
typedef struct
{
  gfloat at, rgb[3];
} Stop;

#define N_STOPS 5

static const Stop warm[N_STOPS] = {
  {0.00f, {240, 234, 222}}, {0.20f, {248, 214, 150}}, {0.45f, {244, 150, 70}},
  {0.70f, {214, 62, 52}}, {1.00f, {104, 10, 62}}
};

static const Stop cold[N_STOPS] = {
  {0.00f, {240, 234, 222}}, {0.20f, {178, 216, 232}}, {0.45f, {92, 164, 220}},
  {0.70f, {44, 100, 190}}, {1.00f, {22, 32, 110}}
};

static const ClothColour unknown = { 0.502f, 0.525f, 0.569f, 1 };

static ClothColour
mix (const Stop stops[N_STOPS], gfloat at)
{
  ClothColour colour = { 0, 0, 0, 1 };
  gfloat *to[3] = { &colour.r, &colour.g, &colour.b }, f;
  guint k = 0;

  while (k < N_STOPS - 2 && stops[k + 1].at < at)
    k++;
  f = (at - stops[k].at) / (stops[k + 1].at - stops[k].at);
  for (guint j = 0; j < 3; j++)
    *to[j] = (stops[k].rgb[j] + f * (stops[k + 1].rgb[j] -
            stops[k].rgb[j])) / 255;
  return colour;
}

/* @colours: (out) (array): colours of a heat map, those of the report: plain cloth for
 *   nothing to a dark red for the scale's end and all beyond, then a grey for what isn't
 *   known
 */
void
cloth_draw_heat_colours (ClothColour colours[CLOTH_DRAW_HEATS])
{
  const guint n = CLOTH_DRAW_HEATS - 1;

  for (guint i = 0; i < n; i++)
    colours[i] = mix (warm, (gfloat) i / (gfloat) (n - 1));
  colours[n] = unknown;
}

/* @residuals: (array): 3 a vertex, metres; NaN where not known
 * @n: number of vertices
 * @scale_mm: length of a residual that has the last colour, mm
 * @heats: (out) (array): index of each vertex's colour in cloth_draw_heat_colours ()
 */
void
cloth_draw_heats (const gfloat * residuals, guint n, guint scale_mm,
    guint8 * heats)
{
  const guint last = CLOTH_DRAW_HEATS - 2;
  const gfloat per_metre = 1000 * (gfloat) last / (gfloat) scale_mm;
  const gfloat *r = residuals;

  for (guint i = 0; i < n; i++, r += 3) {
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
  const ClothColour edge = { 0.05f, 0.05f, 0.15f, 0.95f * opacity };
  const ClothColour text = { 1, 1, 1, 0.95f * opacity };

  cloth_draw_number (canvas, number, origin, right, down, 0.36f * size, &edge);
  cloth_draw_number (canvas, number, origin, right, down, 0.14f * size, &text);
}

/* @colours: (out caller-allocates): blue where threads are shorter, plain where nothing is
 *   strained, in the middle, to red; the last one where it is not known
 */
void
cloth_draw_strain_colours (ClothColour colours[CLOTH_DRAW_STRAINS])
{
  const guint n = CLOTH_DRAW_STRAINS - 1, middle = n / 2;

  for (guint i = 0; i <= middle; i++) {
    const gfloat at = (gfloat) i / (gfloat) middle;

    colours[middle + i] = mix (warm, at);
    colours[middle - i] = mix (cold, at);
  }
  colours[n] = unknown;
}

/* @strains: (array): one of the @step numbers of each vertex, the first one's; NaN where
 *   not known
 * @n: number of vertices
 * @step: numbers from one vertex to the next
 * @scale_percent: strain that has the first or last colour, %
 * @colours: (out) (array): index of each vertex's colour in cloth_draw_strain_colours ()
 */
void
cloth_draw_strains (const gfloat * strains, guint n, guint step,
    guint scale_percent, guint8 * colours)
{
  const gfloat middle = (CLOTH_DRAW_STRAINS - 1) / 2;
  const gfloat scale = 100 * middle / (gfloat) scale_percent;

  for (gsize i = 0; i < n; i++) {
    const gfloat at = middle + scale * strains[i * step];

    colours[i] = (guint8) (isnan (at) ? CLOTH_DRAW_STRAINS - 1 :
        CLAMP (at, 0, 2 * middle) + 0.5f);
  }
}

/* @canvas: picture to draw on
 * @width: of the picture, px
 * @height: of the picture, px
 * @colours: those of the scale, from its lower end
 * @n: how many
 * @low: what its lower end means
 * @high: and its upper
 * @opacity: 0 … 1
 *
 * Draws a scale of colours at the lower left, with its ends beside it. In a thumbnail there
 * is no place for it.
 */
void
cloth_draw_scale (const ClothCanvas * canvas, gint width, gint height,
    const ClothColour * colours, guint n, gint low, gint high, gfloat opacity)
{
  const gfloat grow = MAX (1.0f, (gfloat) height / 480);
  const gfloat tall = grow * BAR_HEIGHT, wide = grow * BAR_WIDTH;
  const gfloat left = grow * BAR_MARGIN;
  const gfloat bottom = (gfloat) height - grow * BAR_MARGIN;
  const gfloat size = grow * DIGIT_HEIGHT;

  if ((gfloat) height < 2 * tall || (gfloat) width < 2 * tall)
    return;
  for (guint i = 0; i < n; i++) {
    const gfloat y0 = bottom - tall * (gfloat) (i + 1) / (gfloat) n;
    const gfloat y1 = bottom - tall * (gfloat) i / (gfloat) n;
    const gfloat x[4] = { left, left + wide, left + wide, left };
    const gfloat y[4] = { y0, y0, y1, y1 };

    ClothColour colour = colours[i];

    colour.a *= opacity;
    cloth_draw_quad (canvas, x, y, &colour);
  }
  draw_label (canvas, low, left + 1.6f * wide, bottom - size, size, opacity);
  draw_label (canvas, high, left + 1.6f * wide, bottom - tall, size, opacity);
}
