/* Drawing 1,000 squares over 1080p: this rasteriser in place against cairo.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/draw.h"

#include <cairo.h>

#include "tests/bench/clock.h"

#define WIDTH 1920
#define HEIGHT 1080
#define COLUMNS 40
#define ROWS 25
#define ROUNDS 20

static gfloat quads[COLUMNS * ROWS][2][4];

/* A grid that fills the picture, bent so that no line runs along the pixels. */
static void
make_quads (void)
{
  static const gint at[4][2] = { {0, 0}, {1, 0}, {1, 1}, {0, 1} };
  gint i, k;

  for (i = 0; i < COLUMNS * ROWS; i++) {
    for (k = 0; k < 4; k++) {
      gfloat c = (gfloat) (i % COLUMNS + at[k][0]);
      gfloat r = (gfloat) (i / COLUMNS + at[k][1]);

      quads[i][0][k] = 40 + 45 * c + 0.12f * r * r;
      quads[i][1][k] = 20 + 40 * r + 0.02f * (c - 20) * (c - 20);
    }
  }
}

static void
plane (ClothComponent * c, guint8 * data, gint width, gint height, gint step,
    gint shift)
{
  c->data = data;
  c->width = width;
  c->height = height;
  c->stride = width * step;
  c->step = step;
  c->shift_x = c->shift_y = shift;
  c->weights[0] = c->weights[1] = c->weights[2] = 85;
  c->weights[3] = 0;
}

static gdouble
time_own (const ClothCanvas * canvas, gboolean fill, gboolean outline,
    gboolean numbers)
{
  gdouble best = G_MAXDOUBLE;
  gint round, i, k;

  for (round = 0; round < ROUNDS; round++) {
    gdouble start = cpu_ms ();

    for (i = 0; i < COLUMNS * ROWS; i++) {
      const gfloat *x = quads[i][0], *y = quads[i][1];
      ClothColour colour = cloth_draw_confidence_colour (0.8f, 0.62f);

      if (fill) {
        ClothColour faint = colour;

        faint.a = 0.3f;
        cloth_draw_quad (canvas, x, y, &faint);
      }
      for (k = 0; k < 4 && outline; k++) {
        gint l = (k + 1) & 3;

        cloth_draw_line (canvas, x[k], y[k], x[l], y[l], 1.5f, &colour);
      }
      if (numbers) {
        const gfloat at[2] = { x[0] + 5, y[0] + 5 };
        const gfloat right[2] = { 6, 0 }, down[2] = { 0, 10 };

        cloth_draw_number (canvas, i % COLUMNS, at, right, down, 1.5f, &colour);
      }
    }
    best = MIN (best, cpu_ms () - start);
  }
  return best;
}

static gdouble
time_cairo (gboolean fill)
{
  cairo_surface_t *surface =
      cairo_image_surface_create (CAIRO_FORMAT_RGB24, WIDTH, HEIGHT);
  cairo_t *cr = cairo_create (surface);
  gdouble best = G_MAXDOUBLE;
  gint round, i, k;

  cairo_set_line_width (cr, 1.5);
  for (round = 0; round < ROUNDS; round++) {
    gdouble start = cpu_ms ();

    for (i = 0; i < COLUMNS * ROWS; i++) {
      const gfloat *x = quads[i][0], *y = quads[i][1];

      for (k = 0; k < 4; k++) {
        cairo_line_to (cr, x[k] + 0.5, y[k] + 0.5);
      }
      cairo_close_path (cr);
      if (fill) {
        cairo_set_source_rgba (cr, 1, 0.5, 0.1, 0.3);
        cairo_fill_preserve (cr);
      }
      cairo_set_source_rgb (cr, 1, 0.5, 0.1);
      cairo_stroke (cr);
    }
    cairo_surface_flush (surface);
    best = MIN (best, cpu_ms () - start);
  }
  cairo_destroy (cr);
  cairo_surface_destroy (surface);
  return best;
}

int
main (void)
{
  g_autofree guint8 *rgb = g_malloc0 (4 * WIDTH * HEIGHT);
  g_autofree guint8 *yuv = g_malloc0 (WIDTH * HEIGHT * 3 / 2);
  ClothCanvas bgrx = { 3 }, i420 = { 3 };
  gint k, fill;

  make_quads ();
  for (k = 0; k < 3; k++) {
    plane (&bgrx.components[k], rgb + k, WIDTH, HEIGHT, 4, 0);
  }
  plane (&i420.components[0], yuv, WIDTH, HEIGHT, 1, 0);
  plane (&i420.components[1], yuv + WIDTH * HEIGHT, WIDTH / 2, HEIGHT / 2, 1,
      1);
  plane (&i420.components[2], yuv + WIDTH * HEIGHT * 5 / 4, WIDTH / 2,
      HEIGHT / 2, 1, 1);

  g_print ("%d squares on %d x %d, best of %d\n", COLUMNS * ROWS, WIDTH, HEIGHT,
      ROUNDS);
  for (fill = 0; fill < 2; fill++) {
    gdouble a = time_own (&i420, fill, TRUE, FALSE);
    gdouble b = time_own (&bgrx, fill, TRUE, FALSE);
    gdouble cairo = time_cairo (fill);

    g_print ("%s: I420 %.2f ms, BGRx %.2f ms; cairo on RGB24 %.2f ms, ratio to "
        "BGRx %.1f\n", fill ? "filled and outlined" : "outlined", a, b, cairo,
        cairo / b);
  }
  g_print ("filled only: I420 %.2f ms, BGRx %.2f ms\n", time_own (&i420, TRUE,
          FALSE, FALSE), time_own (&bgrx, TRUE, FALSE, FALSE));
  g_print ("with indices: I420 %.2f ms\n", time_own (&i420, TRUE, TRUE, TRUE));
  return 0;
}
