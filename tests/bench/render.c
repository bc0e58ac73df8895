/* How long a picture of a cloth takes to draw.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/render.h"

#include <math.h>
#include <stdio.h>

#include "gst/pattern/texture.h"

#define COLUMNS 33
#define ROWS 35
#define REPEATS 15

static gdouble positions[3 * COLUMNS * ROWS], later[3 * COLUMNS * ROWS];
static gfloat uv[2 * COLUMNS * ROWS];
static guint32 faces[4 * (COLUMNS - 1) * (ROWS - 1)];

/* A cloth of 0.63 × 0.67 m in waves, 1 m before the camera: a third of the picture. */
static void
make_mesh (void)
{
  for (gint j = 0; j < ROWS; j++)
    for (gint i = 0; i < COLUMNS; i++) {
      const gint at = j * COLUMNS + i;

      uv[2 * at] = 0.63f * (gfloat) i / (COLUMNS - 1);
      uv[2 * at + 1] = 0.67f * (gfloat) j / (ROWS - 1);
      positions[3 * at] = 1.1 * (uv[2 * at] - 0.315);
      positions[3 * at + 1] = 0.04 * sin (9 * uv[2 * at])
          + 0.02 * sin (14 * uv[2 * at + 1]);
      positions[3 * at + 2] = 0.335 - uv[2 * at + 1];
      for (gint k = 0; k < 3; k++)
        later[3 * at + k] = positions[3 * at + k] + 0.02;
      if (i + 1 < COLUMNS && j + 1 < ROWS) {
        guint32 *f = faces + 4 * (j * (COLUMNS - 1) + i);

        f[0] = (guint32) at;
        f[1] = (guint32) (at + COLUMNS);
        f[2] = f[1] + 1;
        f[3] = f[0] + 1;
      }
    }
}

static gdouble
best_ms (const ClothPaint * paint, const gchar * effects, guint threads,
    ClothSimd simd)
{
  const ClothCamera camera = { NULL, 1920, 1080,
    {1400, 0, 959.5, 0, 1400, 539.5, 0, 0, 1}, CLOTH_LENS_NONE, {0},
    {1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0, 1}
  };
  const gdouble times[2] = { 0, 0.04 };
  const gdouble *const frames[2] = { positions, later };
  const ClothMotion motion = { COLUMNS * ROWS, 2, times, frames };
  g_autoptr (ClothRenderer) renderer = cloth_renderer_new (COLUMNS * ROWS, uv,
      faces, G_N_ELEMENTS (faces) / 4, threads, simd);
  g_autofree guint8 *data = g_malloc (1920 * 1080);
  guint8 *const planes[1] = { data };
  const gint strides[1] = { 1920 };
  ClothRenderStyle style;
  ClothCapture capture;
  gdouble best = G_MAXDOUBLE;

  cloth_render_style_init (&style);
  cloth_capture_init (&capture, &camera);
  cloth_capture_add_effects (&capture, effects, NULL);
  for (gint i = 0; i < REPEATS; i++) {
    const gint64 start = g_get_monotonic_time ();

    cloth_renderer_draw (renderer, paint, &capture, &style, &motion, 0, NULL);
    cloth_renderer_develop (renderer, &capture, 0, 0, 1, planes, strides, 1,
        NULL);
    best = MIN (best, (gdouble) (g_get_monotonic_time () - start) / 1000);
  }
  return best;
}

int
main (void)
{
  static const gchar *const effects[] = { NULL, "noise,sigma=2",
    "defocus,sigma=0.8", "lens_distortion,k1=-0.2",
    "rolling_shutter,seconds=0.01", "motion_blur,exposure=0.004"
  };
  g_autoptr (ClothPattern) pattern = cloth_pattern_new_checker (12, 13, 0.05,
      0.01, TRUE, NULL);
  g_autoptr (ClothTexture) texture = cloth_pattern_texture (pattern, 3000, 20,
      230, NULL);
  const gdouble origin[2] = { 0, 0 }, size[2] = { 0.63, 0.67 };
  g_autoptr (ClothPaint) paint = cloth_paint_new (texture->data,
      texture->width, texture->height, texture->width, 1, NULL, origin, size);
  gdouble scalar, one;

  make_mesh ();
  printf ("a picture of 1920×1080 with 1,155 vertices, best of %d:\n",
      REPEATS);
  scalar = best_ms (paint, NULL, 1, CLOTH_SIMD_SCALAR);
  one = best_ms (paint, NULL, 1, CLOTH_SIMD_BEST);
  printf ("one thread: %.1f ms portable, %.1f ms vectorised (%.2f×)\n", scalar,
      one, scalar / one);
  for (guint i = 0; i < G_N_ELEMENTS (effects); i++) {
    const gdouble ms = best_ms (paint, effects[i], 0, CLOTH_SIMD_BEST);

    printf ("all threads, %s: %.1f ms, %.0f pictures a second (%.2f× one "
        "thread)\n", effects[i] ? effects[i] : "no effect", ms, 1000 / ms,
        one / ms);
  }
  return 0;
}
