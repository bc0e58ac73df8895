/* A retextured cloth over 1080p film, on one core: how long a picture takes, beside the
 * renderer that films cloth exactly.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/surface.h"

#include <math.h>

#include "tests/bench/clock.h"

#define COLUMNS 70
#define ROWS 50
#define WIDTH 1920
#define HEIGHT 1080
#define REPEATS 40

static gfloat positions[3 * COLUMNS * ROWS], uv[2 * COLUMNS * ROWS];
static gdouble wide_positions[3 * COLUMNS * ROWS];
static guint32 faces[4 * (COLUMNS - 1) * (ROWS - 1)];

/* 0.7 × 0.5 m in waves, 1 m before the camera: a third of the picture. */
static void
make_mesh (void)
{
  for (gint j = 0; j < ROWS; j++)
    for (gint i = 0; i < COLUMNS; i++) {
      const gint at = j * COLUMNS + i;

      uv[2 * at] = 0.7f * (gfloat) i / (COLUMNS - 1);
      uv[2 * at + 1] = 0.5f * (gfloat) j / (ROWS - 1);
      positions[3 * at] = uv[2 * at] - 0.35f;
      positions[3 * at + 1] = 0.04f * sinf (9 * uv[2 * at])
          + 0.02f * sinf (14 * uv[2 * at + 1]);
      positions[3 * at + 2] = 0.25f - uv[2 * at + 1];
      for (gint k = 0; k < 3; k++)
        wide_positions[3 * at + k] = positions[3 * at + k];
      if (i + 1 < COLUMNS && j + 1 < ROWS) {
        guint32 *f = faces + 4 * (j * (COLUMNS - 1) + i);

        f[0] = (guint32) at;
        f[1] = (guint32) (at + COLUMNS);
        f[2] = f[1] + 1;
        f[3] = f[0] + 1;
      }
    }
}

static void
plane (ClothComponent * c, guint8 * data, gint width, gint height, gint step,
    gint shift, gfloat r, gfloat g, gfloat b, gfloat offset)
{
  *c = (ClothComponent) {
    data, width * step, step, width, height, shift, shift, {
    r, g, b, offset}
  };
}

static const ClothCamera camera = { NULL, WIDTH, HEIGHT,
  {1400, 0, 959.5, 0, 1400, 539.5, 0, 0, 1}, CLOTH_LENS_NONE, {0},
  {1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0, 1}
};

static gdouble
time_surface (ClothSurface * surface, const ClothCanvas * canvas,
    const ClothRenderStyle * style)
{
  gdouble best = G_MAXDOUBLE;

  for (gint i = 0; i < REPEATS; i++) {
    const gdouble start = cpu_ms ();

    cloth_surface_draw (surface, canvas, WIDTH, HEIGHT, &camera, positions,
        style, 1);
    best = MIN (best, cpu_ms () - start);
  }
  return best;
}

static gdouble
time_renderer (const ClothPaint * paint, const ClothRenderStyle * style,
    guint8 * rgb)
{
  const gdouble times[1] = { 0 };
  const gdouble *const frames[1] = { wide_positions };
  const ClothMotion motion = { COLUMNS * ROWS, 1, times, frames };
  g_autoptr (ClothRenderer) renderer = cloth_renderer_new (COLUMNS * ROWS, uv,
      faces, G_N_ELEMENTS (faces) / 4, 1, CLOTH_SIMD_BEST);
  guint8 *const planes[3] = { rgb, rgb + 1, rgb + 2 };
  const gint strides[3] = { 4 * WIDTH, 4 * WIDTH, 4 * WIDTH };
  gdouble best = G_MAXDOUBLE;
  ClothCapture capture;

  cloth_capture_init (&capture, &camera);
  for (gint i = 0; i < 5; i++) {
    const gdouble start = cpu_ms ();

    cloth_renderer_draw (renderer, paint, &capture, style, &motion, 0, NULL);
    cloth_renderer_develop (renderer, &capture, 0, 0, 3, planes, strides, 4,
        NULL);
    best = MIN (best, cpu_ms () - start);
  }
  return best;
}

int
main (void)
{
  g_autofree guint8 *rgb = g_malloc0 (4 * WIDTH * HEIGHT);
  g_autofree guint8 *yuv = g_malloc0 (WIDTH * HEIGHT * 3 / 2);
  g_autofree guint8 *picture = g_malloc (3 * 1024 * 768);
  const gdouble origin[2] = { 0, 0 }, size[2] = { 0.7, 0.5 };
  ClothCanvas bgrx = { 3 }, i420 = { 3 };
  g_autoptr (ClothPaint) paint = NULL;
  g_autoptr (ClothSurface) surface = NULL;
  ClothRenderStyle style;
  gdouble a, b, slow;

  make_mesh ();
  for (gint i = 0; i < 3 * 1024 * 768; i++)
    picture[i] = (guint8) (i * 2654435761u >> 24);
  paint = cloth_paint_new (picture, 1024, 768, 3 * 1024, 3, NULL, origin, size);
  surface = cloth_surface_new (COLUMNS * ROWS, uv, faces,
      G_N_ELEMENTS (faces) / 4, paint, CLOTH_SIMD_BEST);
  cloth_render_style_init (&style);
  for (gint k = 0; k < 3; k++)
    plane (&bgrx.components[k], rgb + k, WIDTH, HEIGHT, 4, 0,
        k == 2 ? 255 : 0, k == 1 ? 255 : 0, k == 0 ? 255 : 0, 0);
  plane (&i420.components[0], yuv, WIDTH, HEIGHT, 1, 0, 65.5f, 128.6f, 25, 16);
  plane (&i420.components[1], yuv + WIDTH * HEIGHT, WIDTH / 2, HEIGHT / 2, 1,
      1, -37.8f, -74.2f, 112, 128);
  plane (&i420.components[2], yuv + WIDTH * HEIGHT * 5 / 4, WIDTH / 2,
      HEIGHT / 2, 1, 1, 112, -93.8f, -18.2f, 128);
  a = time_surface (surface, &i420, &style);
  b = time_surface (surface, &bgrx, &style);
  slow = time_renderer (paint, &style, rgb);
  g_print
      ("%d vertices, a third of %d × %d, a picture of 1024 × 768 on it, one "
      "core:\nI420 %.1f ms (%.0f pictures a second), BGRx %.1f ms (%.0f); "
      "the renderer %.1f ms, ratio %.1f\n", COLUMNS * ROWS, WIDTH, HEIGHT, a,
      1000 / a, b, 1000 / b, slow, slow / b);
  return 0;
}
