/* Printed surfaces over a film, against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/surface.h"

#include <math.h>
#include <string.h>

#define WIDTH 201
#define HEIGHT 151
#define FILM 77

static const ClothCamera camera = { NULL, WIDTH, HEIGHT,
  {150, 0, 100, 0, 150, 75, 0, 0, 1}, CLOTH_LENS_NONE, {0},
  {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}
};

/* light of 1 everywhere: colours are as printed */
static const ClothRenderStyle even = {.lamp = {0, 0, 1},.ambient_light = 1 };

typedef struct
{
  guint8 data[WIDTH * HEIGHT * 3];
  ClothCanvas canvas;
} Picture;

static void
set_component (ClothComponent * c, guint8 * data, gint width, gint height,
    gint step, gint shift, guint channel)
{
  *c = (ClothComponent) {
    data, width * step, step, width, height, shift, shift, {
    0, 0, 0, 0}
  };
  c->weights[channel] = 255;
}

static Picture *
new_rgb (void)
{
  Picture *picture = g_new0 (Picture, 1);

  memset (picture->data, FILM, sizeof picture->data);
  picture->canvas.n_components = 3;
  for (guint k = 0; k < 3; k++)
    set_component (&picture->canvas.components[k], picture->data + k, WIDTH,
        HEIGHT, 3, 0, k);
  return picture;
}

/* Planes, the second and third of half the size, which is odd. */
static Picture *
new_planes (void)
{
  Picture *picture = g_new0 (Picture, 1);
  const gint w = (WIDTH + 1) / 2, h = (HEIGHT + 1) / 2;

  memset (picture->data, FILM, sizeof picture->data);
  picture->canvas.n_components = 3;
  set_component (&picture->canvas.components[0], picture->data, WIDTH, HEIGHT,
      1, 0, 0);
  set_component (&picture->canvas.components[1], picture->data + WIDTH * HEIGHT,
      w, h, 1, 1, 1);
  set_component (&picture->canvas.components[2], picture->data + WIDTH * HEIGHT
      + w * h, w, h, 1, 1, 2);
  return picture;
}

/* 64 × 64: red rises along u, green along v, by 4 a pixel, over 1 m × 1 m. */
static ClothPaint *
new_ramp (void)
{
  const gdouble origin[2] = { 0, 0 }, size[2] = { 1, 1 };
  guint8 data[64 * 64 * 3];

  for (gint i = 0; i < 64 * 64; i++) {
    data[3 * i] = (guint8) (4 * (i % 64));
    data[3 * i + 1] = (guint8) (4 * (i / 64));
    data[3 * i + 2] = 200;
  }
  return cloth_paint_new (data, 64, 64, 3 * 64, 3, NULL, origin, size);
}

#define SIDE 13
#define N (SIDE * SIDE)

typedef struct
{
  gfloat uv[2 * N], positions[3 * N];
  guint32 faces[4 * (SIDE - 1) * (SIDE - 1)];
} Sheet;

/* (u, v) lies at origin + u·along + v·down; inner vertices moved within the plane. */
static void
make_sheet (Sheet * sheet, const gdouble * origin, const gdouble * along,
    const gdouble * down, gdouble jitter)
{
  g_autoptr (GRand) random = g_rand_new_with_seed (7);

  for (guint i = 0; i < N; i++) {
    const guint c = i % SIDE, r = i / SIDE;
    const gboolean inner = c > 0 && r > 0 && c < SIDE - 1 && r < SIDE - 1;
    const gdouble u = (c + (inner ? jitter * g_rand_double_range (random, -1,
                1) : 0)) / (SIDE - 1);
    const gdouble v = (r + (inner ? jitter * g_rand_double_range (random, -1,
                1) : 0)) / (SIDE - 1);

    sheet->uv[2 * i] = (gfloat) u;
    sheet->uv[2 * i + 1] = (gfloat) v;
    for (guint k = 0; k < 3; k++)
      sheet->positions[3 * i + k] = (gfloat) (origin[k] + u * along[k] + v *
          down[k]);
  }
  for (guint f = 0; f < (SIDE - 1) * (SIDE - 1); f++) {
    const guint32 v = f / (SIDE - 1) * SIDE + f % (SIDE - 1);
    const guint32 face[4] = { v, v + SIDE, v + SIDE + 1, v + 1 };

    memcpy (sheet->faces + 4 * f, face, sizeof face);
  }
}

static ClothSurface *
new_surface (const Sheet * sheet, const ClothPaint * paint, ClothSimd simd)
{
  return cloth_surface_new (N, sheet->uv, sheet->faces, (SIDE - 1) * (SIDE -
          1), paint, simd);
}

static const gdouble origin[3] = { -0.55, -0.4, 2.2 };
static const gdouble along[3] = { 1, 0.1, -0.7 }, down[3] = { -0.05, 0.8, 0.3 };

/* Where the ray through a pixel meets the sheet: its (u, v), by Cramer's rule. */
static void
meet (gint x, gint y, gdouble uv[2])
{
  const gdouble ray[3] = { (x - 100) / 150.0, (y - 75) / 150.0, 1 };
  /* u·along + v·down − t·ray = −origin */
#define DET(a, b, c) ((a)[0] * ((b)[1] * (c)[2] - (b)[2] * (c)[1]) \
    - (b)[0] * ((a)[1] * (c)[2] - (a)[2] * (c)[1]) \
    + (c)[0] * ((a)[1] * (b)[2] - (a)[2] * (b)[1]))
  const gdouble det = -DET (along, down, ray);

  uv[0] = DET (origin, down, ray) / det;
  uv[1] = DET (along, origin, ray) / det;
#undef DET
}

/* Every pixel: the print where the sheet is, the film elsewhere, no gap between. */
static void
test_plane (void)
{
  g_autoptr (ClothPaint) paint = new_ramp ();
  g_autofree Picture *picture = new_rgb ();
  Sheet sheet;
  g_autoptr (ClothSurface) surface = NULL;
  guint n = 0, most = 0;

  make_sheet (&sheet, origin, along, down, 0.3);
  surface = new_surface (&sheet, paint, CLOTH_SIMD_BEST);
  cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
      sheet.positions, &even, 1);
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      const guint8 *got = picture->data + 3 * (y * WIDTH + x);
      gdouble uv[2], off;

      meet (x, y, uv);
      off = MAX (fabs (uv[0] - 0.5), fabs (uv[1] - 0.5)) - 0.5;
      if (off > 1e-4)
        g_assert_true (got[0] == FILM && got[1] == FILM && got[2] == FILM);
      if (off >= -1e-4)
        continue;
      n++;
      g_assert_cmpint (ABS (got[2] - 200), <=, 1);
      for (guint k = 0; k < 2; k++) {
        const gdouble wanted = CLAMP (4 * (64 * uv[k] - 0.5), 0, 252);

        most = MAX (most, (guint) ceil (fabs (got[k] - wanted)));
        g_assert_cmpfloat (fabs (got[k] - wanted), <=, 2.5);
      }
    }
  g_test_message ("%u pixels, at most %u levels off", n, most);
  g_assert_cmpuint (n, >, 3000);
}

static void
put_square (gfloat * positions, gfloat * uv, gdouble half, gdouble z, gdouble u)
{
  for (guint k = 0; k < 4; k++) {
    positions[3 * k] = (gfloat) ((k == 1 || k == 2 ? 1 : -1) * half);
    positions[3 * k + 1] = (gfloat) ((k > 1 ? 1 : -1) * half);
    positions[3 * k + 2] = (gfloat) z;
    uv[2 * k] = (gfloat) u;
    uv[2 * k + 1] = 0.5f;
  }
}

/* The nearer of two is seen, whichever comes first; the lens' other side is not. */
static void
test_nearest (void)
{
  g_autoptr (ClothPaint) paint = new_ramp ();
  static const guint32 orders[2][12] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
    {8, 9, 10, 11, 4, 5, 6, 7, 0, 1, 2, 3}
  };

  for (guint i = 0; i < 2; i++) {
    g_autofree Picture *picture = new_rgb ();
    g_autoptr (ClothSurface) surface = NULL;
    gfloat positions[36], uv[24];

    put_square (positions, uv, 0.6, 2, 0.25);
    put_square (positions + 12, uv + 8, 0.2, 1.5, 0.75);
    put_square (positions + 24, uv + 16, 0.2, -1, 0.5);
    surface = cloth_surface_new (12, uv, orders[i], 3, paint, CLOTH_SIMD_BEST);
    cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
        positions, &even, 1);
    g_assert_cmpint (ABS (picture->data[3 * (75 * WIDTH + 100)] - 190), <=, 2);
    g_assert_cmpint (ABS (picture->data[3 * (75 * WIDTH + 130)] - 62), <=, 2);
  }
}

/* Two squares that cover the picture, the nearer last, with room for one and a half: only
 * the first is there, and of a picture that nobody wants nothing. Then all is as ever. */
static void
test_work (void)
{
  static const guint32 faces[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  g_autoptr (ClothPaint) paint = new_ramp ();
  g_autofree Picture *picture = new_rgb ();
  g_autoptr (ClothSurface) surface = NULL;
  const guint8 *middle = picture->data + 3 * (75 * WIDTH + 100);
  gfloat positions[24], uv[16];
  gint stop = 0;
  ClothWork work = { 3 * WIDTH * HEIGHT, &stop, FALSE };

  put_square (positions, uv, 20, 2, 0.25);
  put_square (positions + 12, uv + 8, 20, 1, 0.75);
  surface = cloth_surface_new (8, uv, faces, 2, paint, CLOTH_SIMD_BEST);
  picture->canvas.work = &work;
  stop = 1;
  cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
      positions, &even, 1);
  g_assert_cmpint (middle[0], ==, FILM);
  stop = 0;
  cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
      positions, &even, 1);
  g_assert_true (work.left_out);
  g_assert_cmpint (ABS (middle[0] - 62), <=, 2);
  picture->canvas.work = NULL;
  cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
      positions, &even, 1);
  g_assert_cmpint (ABS (middle[0] - 190), <=, 2);
}

static void
test_opacity (void)
{
  g_autoptr (ClothPaint) paint = new_ramp ();
  g_autofree Picture *full = new_rgb (), *half = new_rgb (), *none = new_rgb ();
  g_autofree Picture *film = new_rgb ();
  Sheet sheet;
  g_autoptr (ClothSurface) surface = NULL;

  make_sheet (&sheet, origin, along, down, 0);
  surface = new_surface (&sheet, paint, CLOTH_SIMD_BEST);
  cloth_surface_draw (surface, &full->canvas, WIDTH, HEIGHT, &camera,
      sheet.positions, &even, 1);
  cloth_surface_draw (surface, &half->canvas, WIDTH, HEIGHT, &camera,
      sheet.positions, &even, 0.5f);
  cloth_surface_draw (surface, &none->canvas, WIDTH, HEIGHT, &camera,
      sheet.positions, &even, 0);
  g_assert_cmpmem (none->data, sizeof none->data, film->data,
      sizeof film->data);
  for (guint i = 0; i < sizeof half->data; i++)
    g_assert_cmpint (ABS (2 * half->data[i] - full->data[i] - FILM), <=, 2);
}

/* A quarter turned from the lamp: cos 60° of its light. */
static void
test_light (void)
{
  g_autoptr (ClothPaint) paint = new_ramp ();
  const ClothRenderStyle style = {.lamp = {0, sqrt (3), 1},.lamp_light =
      0.8,.ambient_light = 0.1
  };
  g_autofree Picture *picture = new_rgb ();
  g_autoptr (ClothSurface) surface = NULL;
  static const guint32 face[4] = { 0, 1, 2, 3 };
  gfloat positions[12], uv[8];

  put_square (positions, uv, 0.5, 2, 0.5);
  surface = cloth_surface_new (4, uv, face, 1, paint, CLOTH_SIMD_BEST);
  cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
      positions, &style, 1);
  g_assert_cmpfloat (fabs (picture->data[3 * (75 * WIDTH + 100) + 2] - 200 *
          pow (0.1 + 0.8 * 0.5, 1 / 2.2)), <=, 1.5);
}

/* What touches an unknown vertex is left out, the rest is there. */
static void
test_unknown_vertices (void)
{
  static const gfloat bad[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e38f };
  g_autoptr (ClothPaint) paint = new_ramp ();

  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_autofree Picture *whole = new_rgb (), *picture = new_rgb ();
    Sheet sheet;
    g_autoptr (ClothSurface) surface = NULL;
    guint n = 0;

    make_sheet (&sheet, origin, along, down, 0);
    surface = new_surface (&sheet, paint, CLOTH_SIMD_BEST);
    cloth_surface_draw (surface, &whole->canvas, WIDTH, HEIGHT, &camera,
        sheet.positions, &even, 1);
    sheet.positions[3 * (N / 2)] = bad[i];
    cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
        sheet.positions, &even, 1);
    for (guint k = 2; k < sizeof whole->data; k += 3)
      n += picture->data[k] != whole->data[k];
    /* at least four faces of 144, or what was in their place */
    g_assert_cmpuint (n, >, 80);
    if (isnan (bad[i]))
      g_assert_cmpuint (n, <, 500);
  }
}

/* Every level: the same bytes, and nothing of a picture is left for the next one. */
static void
test_instruction_sets (void)
{
  const ClothSimd best = cloth_simd_resolve (CLOTH_SIMD_BEST);
  g_autoptr (ClothPaint) paint = new_ramp ();

  for (guint planes = 0; planes < 2; planes++) {
    g_autofree Picture *scalar = planes ? new_planes () : new_rgb ();

    for (ClothSimd level = CLOTH_SIMD_SCALAR; level <= best; level++) {
      g_autofree Picture *picture = planes ? new_planes () : new_rgb ();
      ClothRenderStyle style;
      Sheet sheet;
      g_autoptr (ClothSurface) surface = NULL;

      make_sheet (&sheet, origin, along, down, 0.3);
      sheet.positions[2] -= 1;
      cloth_render_style_init (&style);
      surface = new_surface (&sheet, paint, level);
      if (level == CLOTH_SIMD_SCALAR)
        cloth_surface_draw (surface, &scalar->canvas, WIDTH, HEIGHT, &camera,
            sheet.positions, &style, 0.7f);
      for (guint again = 0; again < 2; again++) {
        memset (picture->data, FILM, sizeof picture->data);
        cloth_surface_draw (surface, &picture->canvas, WIDTH, HEIGHT, &camera,
            sheet.positions, &style, 0.7f);
        g_assert_cmpmem (scalar->data, sizeof scalar->data, picture->data,
            sizeof picture->data);
      }
    }
  }
}

/* Coarse samples: the mean of what is covered, by its share. */
static void
test_chroma (void)
{
  g_autoptr (ClothPaint) paint = new_ramp ();
  g_autofree Picture *fine = new_rgb (), *coarse = new_planes ();
  const gint w = (WIDTH + 1) / 2, h = (HEIGHT + 1) / 2;
  Sheet sheet;
  g_autoptr (ClothSurface) surface = NULL;

  make_sheet (&sheet, origin, along, down, 0);
  /* over the right and lower border of the picture */
  for (guint i = 0; i < N; i++) {
    sheet.positions[3 * i] += 0.8f;
    sheet.positions[3 * i + 1] += 0.5f;
  }
  surface = new_surface (&sheet, paint, CLOTH_SIMD_BEST);
  cloth_surface_draw (surface, &fine->canvas, WIDTH, HEIGHT, &camera,
      sheet.positions, &even, 1);
  cloth_surface_draw (surface, &coarse->canvas, WIDTH, HEIGHT, &camera,
      sheet.positions, &even, 1);
  g_assert_cmpint (fine->data[3 * WIDTH * HEIGHT - 1], !=, FILM);
  for (gint y = 0; y < h; y++)
    for (gint x = 0; x < w; x++) {
      gint sum = 0, n = 0;

      for (gint k = 0; k < 4; k++) {
        const gint fx = 2 * x + k % 2, fy = 2 * y + k / 2;

        if (fx < WIDTH && fy < HEIGHT) {
          sum += fine->data[3 * (fy * WIDTH + fx) + 1];
          n++;
        }
      }
      g_assert_cmpfloat (fabs (coarse->data[WIDTH * HEIGHT + y * w + x] -
              (gdouble) sum / n), <=, 1.6);
    }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/surface/work", test_work);
  g_test_add_func ("/surface/plane", test_plane);
  g_test_add_func ("/surface/nearest", test_nearest);
  g_test_add_func ("/surface/opacity", test_opacity);
  g_test_add_func ("/surface/light", test_light);
  g_test_add_func ("/surface/unknown-vertices", test_unknown_vertices);
  g_test_add_func ("/surface/instruction-sets", test_instruction_sets);
  g_test_add_func ("/surface/chroma", test_chroma);
  return g_test_run ();
}
