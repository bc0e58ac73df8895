/* Anti-aliased drawing on 8-bit pictures of any layout.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/* Every shape is a function from a pixel to a coverage, by the distance to its outline
 * (box filter of one sample); rows are cut into short runs whose coverages are worked
 * out once for all components of equal subsampling and then blended into each. */
#include "gst/vision/draw.h"

#include <math.h>

#define RUN 64

typedef struct
{
  gint first, n;                /* components */
  gint width, height;           /* samples */
  gfloat scale_x, scale_y;      /* pixels a sample */
  gfloat offset_x, offset_y;    /* pixel position of the first sample */
  gfloat softness;              /* pixels over which an edge fades */
} Group;

/* The next group of components that share one sampling grid; FALSE after the last. */
static gboolean
next_group (const ClothCanvas * canvas, Group * group)
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

/* Blends a run of coverages (0 … 256) at sample (x, y) of every component. Sixteen bits
 * hold 255 · 256 + 128. */
static void
blend (const ClothCanvas * canvas, const Group * group, gint x, gint y,
    const guint16 * restrict coverage, gint n, const guint8 * values)
{
  gint k, i;

  for (k = 0; k < group->n; k++) {
    const ClothComponent *c = &canvas->components[group->first + k];
    gint step = c->step;
    guint16 value = values[group->first + k];
    guint8 *restrict p = c->data + (gsize) y * c->stride + (gsize) x * step;

    if (step == 1) {
      for (i = 0; i < n; i++) {
        p[i] = (guint8) ((guint16) (p[i] * (guint16) (256 - coverage[i]) +
                value * coverage[i] + 128) >> 8);
      }
    } else {
      for (i = 0; i < n; i++, p += step) {
        *p = (guint8) ((*p * (256 - coverage[i]) + value * coverage[i] +
                128) >> 8);
      }
    }
  }
}

static void
values_of (const ClothCanvas * canvas, const ClothColour * colour,
    guint8 values[4])
{
  guint k;

  for (k = 0; k < MIN (canvas->n_components, 4); k++) {
    values[k] = value_of (&canvas->components[k], colour);
  }
}

/* First and last sample of [low, high] pixels, kept inside the grid; safe for any
 * finite numbers. */
static void
clip_range (gfloat low, gfloat high, gfloat offset, gfloat scale, gint size,
    gint * first, gint * last)
{
  gfloat a = (low - offset) / scale, b = (high - offset) / scale;

  a = CLAMP (a, 0.0f, (gfloat) size);
  b = CLAMP (b, -1.0f, (gfloat) (size - 1));
  /* ceil and floor, which plain SSE2 lacks; adding 1 keeps floor from below zero */
  *first = (gint) a + ((gfloat) (gint) a < a);
  *last = (gint) (b + 1) - 1;
}

/**
 * cloth_draw_line:
 * @canvas: where to
 * @x0: px
 * @y0: px
 * @x1: px
 * @y1: px
 * @width: px; a line thinner than a sample gets fainter
 * @colour: colour
 *
 * Draws a straight line with round ends.
 *
 * Since: 0.1
 */
void
cloth_draw_line (const ClothCanvas * canvas, gfloat x0, gfloat y0, gfloat x1,
    gfloat y1, gfloat width, const ClothColour * colour)
{
  Group group = { 0 };
  guint8 values[4];
  gfloat dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
  gfloat length = sqrtf (length2);
  gfloat ux = length > 0 ? dx / length : 1, uy = length > 0 ? dy / length : 0;
  gfloat strip = 0;             /* half width of the line along a row, per radius */

  if (!isfinite (length2) || !isfinite (x0) || !isfinite (y0)
      || !(width > 0) || !(colour->a > 0)) {
    return;
  }
  if (fabsf (dy) > 1e-3f) {
    strip = length / fabsf (dy);
  }
  values_of (canvas, colour, values);

  while (next_group (canvas, &group)) {
    gfloat soft = group.softness;
    gfloat radius = 0.5f * (width + soft), strength = 256 * colour->a / soft;
    gfloat most = 256 * colour->a * MIN (width, 1);
    gint y, row_first, row_last;

    clip_range (MIN (y0, y1) - radius, MAX (y0, y1) + radius, group.offset_y,
        group.scale_y, group.height, &row_first, &row_last);
    for (y = row_first; y <= row_last; y++) {
      gfloat py = group.offset_y + (gfloat) y * group.scale_y;
      gfloat low = MIN (x0, x1) - radius, high = MAX (x0, x1) + radius;
      gfloat row_along = (py - y0) * uy, row_across = (py - y0) * ux;
      gint x, first, last;

      if (strip > 0) {
        gfloat centre = x0 + (py - y0) * dx / dy;

        low = MAX (low, centre - strip * radius);
        high = MIN (high, centre + strip * radius);
      }
      clip_range (low, high, group.offset_x, group.scale_x, group.width, &first,
          &last);
      for (x = first; x <= last; x += RUN) {
        gint i, n = MIN (RUN, last - x + 1);
        guint16 coverage[RUN];

        for (i = 0; i < n; i++) {
          gfloat qx = group.offset_x + (gfloat) (x + i) * group.scale_x - x0;
          gfloat along = qx * ux + row_along, across = qx * uy - row_across;
          gfloat beyond = along - length, c;

          /* how far past either end */
          beyond = beyond > -along ? beyond : -along;
          c = beyond > 0 ? sqrtf (across * across + beyond * beyond) :
              fabsf (across);
          c = (radius - c) * strength;
          c = c < 0 ? 0 : c;
          coverage[i] = (guint16) (gint) (c > most ? most : c);
        }
        blend (canvas, &group, x, y, coverage, n, values);
      }
    }
  }
}

/**
 * cloth_draw_dashes:
 * @canvas: where to
 * @x0: px
 * @y0: px
 * @x1: px
 * @y1: px
 * @width: px
 * @dash: length of a dash and of a gap, px
 * @colour: colour
 *
 * Draws a dashed line; it begins and ends with a dash.
 *
 * Since: 0.1
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
  for (i = 0; i < n; i += 2) {
    gfloat a = (gfloat) i / (gfloat) n, b = (gfloat) (i + 1) / (gfloat) n;

    cloth_draw_line (canvas, x0 + a * (x1 - x0), y0 + a * (y1 - y0),
        x0 + b * (x1 - x0), y0 + b * (y1 - y0), width, colour);
  }
}

/**
 * cloth_draw_quad:
 * @canvas: where to
 * @x: corners in order, px
 * @y: corners in order, px
 * @colour: colour
 *
 * Fills a convex quadrilateral; one that is not convex is left out.
 *
 * Since: 0.1
 */
void
cloth_draw_quad (const ClothCanvas * canvas, const gfloat x[4],
    const gfloat y[4], const ClothColour * colour)
{
  Group group = { 0 };
  guint8 values[4];
  gfloat nx[4], ny[4], d[4], top = y[0], bottom = y[0], turn = 0;
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
  /* inward distance of a pixel to edge k: nx·px + ny·py + d */
  for (k = 0; k < 4; k++) {
    gint l = (k + 1) & 3;
    gfloat ex = x[l] - x[k], ey = y[l] - y[k];
    gfloat scale = (turn > 0 ? 1 : -1) / hypotf (ex, ey);

    nx[k] = -ey * scale;
    ny[k] = ex * scale;
    d[k] = -(nx[k] * x[k] + ny[k] * y[k]);
    top = MIN (top, y[k]);
    bottom = MAX (bottom, y[k]);
  }
  values_of (canvas, colour, values);

  while (next_group (canvas, &group)) {
    gfloat soft = group.softness, full = 256 * colour->a;
    gfloat strength = full / soft, margin = 0.5f * soft;
    guint16 coverage[RUN], inside[RUN];
    gint row, row_first, row_last;

    for (k = 0; k < RUN; k++) {
      inside[k] = (guint16) (gint) full;
    }

    clip_range (top - margin, bottom + margin, group.offset_y, group.scale_y,
        group.height, &row_first, &row_last);
    for (row = row_first; row <= row_last; row++) {
      gfloat py = group.offset_y + (gfloat) row * group.scale_y;
      gfloat low = -1e9f, high = 1e9f, rest[4];
      gfloat inner_low = -1e9f, inner_high = 1e9f;
      gint column, first, last, inner_first, inner_last, n;

      for (k = 0; k < 4; k++) {
        rest[k] = ny[k] * py + d[k] + margin;
        /* the row's part with any coverage, and within it the part with all */
        if (nx[k] > 1e-6f) {
          low = MAX (low, -rest[k] / nx[k]);
          inner_low = MAX (inner_low, (soft - rest[k]) / nx[k]);
        } else if (nx[k] < -1e-6f) {
          high = MIN (high, -rest[k] / nx[k]);
          inner_high = MIN (inner_high, (soft - rest[k]) / nx[k]);
        } else if (rest[k] < soft) {
          inner_high = -1e9f;
        }
      }
      clip_range (low, high, group.offset_x, group.scale_x, group.width, &first,
          &last);
      clip_range (inner_low, inner_high, group.offset_x, group.scale_x,
          group.width, &inner_first, &inner_last);
      for (column = first; column <= last; column += n) {
        gint i;

        if (column >= inner_first && column <= inner_last) {
          n = MIN (RUN, inner_last - column + 1);
          blend (canvas, &group, column, row, inside, n, values);
          continue;
        }
        n = MIN (RUN, last - column + 1);
        if (column < inner_first && inner_first <= inner_last) {
          n = MIN (n, inner_first - column);
        }
        for (i = 0; i < n; i++) {
          gfloat px = group.offset_x + (gfloat) (column + i) * group.scale_x;
          gfloat a = nx[0] * px + rest[0], b = nx[1] * px + rest[1];
          gfloat e = nx[2] * px + rest[2], f = nx[3] * px + rest[3];

          a = a < b ? a : b;
          e = e < f ? e : f;
          a = (a < e ? a : e) * strength;
          a = a < 0 ? 0 : a;
          coverage[i] = (guint16) (gint) (a > full ? full : a);
        }
        blend (canvas, &group, column, row, coverage, n, values);
      }
    }
  }
}

/**
 * cloth_draw_ellipse:
 * @canvas: where to
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
 *
 * Since: 0.1
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
  for (i = 1; i <= n; i++) {
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

/**
 * cloth_draw_number:
 * @canvas: where to
 * @number: what to write, −9999 … 99999
 * @origin: top-left of the first digit, px
 * @right: from the left to the right edge of a digit, px
 * @down: from its top to its bottom, px
 * @width: of the strokes, px
 * @colour: colour
 *
 * Writes a whole number along any direction, so that it can lie on the cloth. Digits
 * are 1.6 @right apart.
 *
 * Since: 0.1
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

/**
 * cloth_draw_confidence_colour:
 * @confidence: −1 … 1
 * @low: the confidence below which a square is given up, c_low of the paper
 *
 * The colours of the paper's figure 2: yellow for a confidence of 1, purple for @low
 * (and whatever is below), through red and orange between.
 *
 * Returns: an opaque colour
 * Since: 0.1
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
