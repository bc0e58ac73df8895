/* Drawing: areas by closed forms, hidden lines, shapes that can't be drawn.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/draw.h"
#include "gst/render/wireframe.h"

#include <math.h>
#include <string.h>

#define SIZE 96

static guint8 pixels[SIZE * SIZE];

static const ClothColour white = { 1, 1, 1, 1 };

/* A black picture on which white is 250 (so that no rounding is cut off). */
static ClothCanvas
black_canvas (gint shift)
{
  ClothCanvas canvas = { 1 };
  ClothComponent *c = &canvas.components[0];

  memset (pixels, 0, sizeof (pixels));
  c->data = pixels;
  c->width = c->height = c->stride = SIZE >> shift;
  c->step = 1;
  c->shift_x = c->shift_y = shift;
  c->weights[0] = 250;
  return canvas;
}

/* Covered area in px² */
static gdouble
area (gint shift)
{
  gdouble sum = 0;
  gint i;

  for (i = 0; i < SIZE * SIZE; i++) {
    sum += pixels[i] / 250.0;
  }
  return sum * (1 << shift) * (1 << shift);
}

static void
assert_near (gdouble got, gdouble want, gdouble share, const gchar * what)
{
  g_test_message ("%s: %.2f, closed form %.2f", what, got, want);
  g_assert_cmpfloat (fabs (got - want), <=, share * want);
}

/* Width × length plus the two round ends, at any direction, also for chroma. */
static void
test_line_area (void)
{
  gint i, shift;

  for (shift = 0; shift < 2; shift++) {
    for (i = 0; i < 16; i++) {
      gdouble angle = G_PI * i / 16 + 0.03, length = 60, width = 4;
      gfloat x = 47.3f, y = 48.1f;
      gfloat dx = (gfloat) (0.5 * length * cos (angle));
      gfloat dy = (gfloat) (0.5 * length * sin (angle));
      ClothCanvas canvas = black_canvas (shift);

      cloth_draw_line (&canvas, x - dx, y - dy, x + dx, y + dy,
          (gfloat) width, &white);
      assert_near (area (shift), width * length + G_PI * width * width / 4,
          0.03, shift ? "line, subsampled" : "line");
    }
  }
}

/* A thin line keeps its area by getting fainter. */
static void
test_thin_line (void)
{
  ClothCanvas canvas = black_canvas (0);

  cloth_draw_line (&canvas, 10, 20.2f, 80, 31.7f, 0.5f, &white);
  assert_near (area (0), 0.5 * hypot (70, 11.5), 0.12, "thin line");
}

static void
test_dashes (void)
{
  ClothCanvas canvas = black_canvas (0);

  cloth_draw_dashes (&canvas, 10, 20, 87, 20, 1, 7, &white);
  /* 11 pieces of 7 px, 6 of them drawn, each with round ends */
  assert_near (area (0), 6 * (7 + G_PI / 4), 0.05, "dashes");
}

static void
test_quad_area (void)
{
  gint i, shift, turn;

  for (shift = 0; shift < 2; shift++) {
    for (turn = 0; turn < 2; turn++) {
      for (i = 0; i < 12; i++) {
        gdouble angle = 2 * G_PI * i / 12 + 0.05, sum = 0;
        gfloat x[4], y[4];
        gint k;
        ClothCanvas canvas = black_canvas (shift);

        for (k = 0; k < 4; k++) {
          gdouble a = angle + (turn ? -1 : 1) * (G_PI / 2 * k + 0.2 * (k & 1));
          gdouble r = 30 + 5 * (k == 2);

          x[k] = (gfloat) (47.6 + r * cos (a));
          y[k] = (gfloat) (46.9 + r * sin (a));
        }
        for (k = 0; k < 4; k++) {
          sum += 0.5 * (x[k] * y[(k + 1) & 3] - x[(k + 1) & 3] * y[k]);
        }
        cloth_draw_quad (&canvas, x, y, &white);
        assert_near (area (shift), fabs (sum), 0.015, "quadrilateral");
      }
    }
  }
}

/* Squares that share their edges cover everything once: no gap, no seam. */
static void
test_tiling (void)
{
  ClothCanvas canvas = black_canvas (0);
  gint i, x, y;

  for (i = 0; i < 16; i++) {
    gfloat qx[4], qy[4];
    gint k;

    for (k = 0; k < 4; k++) {
      gfloat c = (gfloat) (i % 4 + (k == 1 || k == 2));
      gfloat r = (gfloat) (i / 4 + (k > 1));

      qx[k] = 12 + 17.3f * c + 1.9f * r;
      qy[k] = 12 + 16.1f * r - 1.2f * c;
    }
    cloth_draw_quad (&canvas, qx, qy, &white);
  }
  for (y = 22; y < 70; y++) {
    for (x = 24; x < 78; x++) {
      /* two half covered quads leave a quarter open at worst */
      g_assert_cmpint (pixels[y * SIZE + x], >=, 180);
    }
  }
}

/* Samples by themselves, side by side, and in pictures that end earlier: the same values,
 * and not a byte else. */
static void
test_layouts (void)
{
  enum
  { WIDTH = 75, HEIGHT = 40, STRIDE = 4 * WIDTH + 3 };
  static const ClothColour colour = { 0.9f, 0.2f, 0.5f, 0.37f };
  static guint8 planes[3][WIDTH * HEIGHT], packed[STRIDE * HEIGHT];

  for (gint width = 1; width <= WIDTH; width += 2)
    for (gint step = 1; step <= 4; step++) {
      const gint n = MIN (step, 3), first = step - n;
      ClothCanvas apart = { (guint) n }, together = { (guint) n };

      memset (packed, 77, sizeof packed);
      memset (planes, 77, sizeof planes);
      for (gint k = 0; k < n; k++) {
        ClothComponent c = { planes[k], WIDTH, 1, WIDTH, HEIGHT, 0, 0,
          {50 * (gfloat) k, 200, 30, 3}
        };

        apart.components[k] = c;
        c.data = packed + first + k;
        c.stride = STRIDE;
        c.step = step;
        c.width = width;
        together.components[k] = c;
      }
      for (gint i = 0; i < 12; i++) {
        const gfloat x = 6 * (gfloat) i - 4, y = 3 * (gfloat) i, size =
            7 + x / 2;
        const gfloat xs[4] = { x, x + size, x + size - 3.5f, x - 2 };
        const gfloat ys[4] = { y, y + 2, y + size, y + 5 };

        cloth_draw_quad (&apart, xs, ys, &colour);
        cloth_draw_quad (&together, xs, ys, &colour);
        cloth_draw_line (&apart, x, y, 30, 20, 2.5f, &colour);
        cloth_draw_line (&together, x, y, 30, 20, 2.5f, &colour);
      }
      for (gint i = 0; i < STRIDE * HEIGHT; i++) {
        const gint x = i % STRIDE / step, k = i % STRIDE % step - first;

        g_assert_cmpuint (packed[i], ==, x < width && k >= 0 ?
            planes[k][i / STRIDE * WIDTH + x] : 77);
      }
    }
}

static void
test_not_drawn (void)
{
  const gfloat bow_x[4] = { 10, 40, 10, 40 }, bow_y[4] = { 10, 10, 40, 40 };
  const gfloat dart_x[4] = { 10, 40, 20, 10 }, dart_y[4] = { 10, 10, 20, 40 };
  const gfloat flat_x[4] = { 10, 20, 30, 40 }, flat_y[4] = { 10, 20, 30, 40 };
  const gfloat nan_x[4] = { 10, 40, NAN, 10 }, inf_x[4] =
      { 10, INFINITY, 40, 10 };
  const gfloat square_y[4] = { 10, 10, 40, 40 };
  ClothColour clear = { 1, 1, 1, 0 };
  ClothCanvas canvas = black_canvas (0);

  cloth_draw_quad (&canvas, bow_x, bow_y, &white);
  cloth_draw_quad (&canvas, dart_x, dart_y, &white);
  cloth_draw_quad (&canvas, flat_x, flat_y, &white);
  cloth_draw_quad (&canvas, nan_x, square_y, &white);
  cloth_draw_quad (&canvas, inf_x, square_y, &white);
  cloth_draw_line (&canvas, NAN, 1, 50, 50, 2, &white);
  cloth_draw_line (&canvas, 1, 1, 1, INFINITY, 2, &white);
  cloth_draw_line (&canvas, 1, 1, 50, 50, 0, &white);
  cloth_draw_line (&canvas, 1, 1, 50, 50, -3, &white);
  cloth_draw_line (&canvas, 1, 1, 50, 50, NAN, &white);
  cloth_draw_line (&canvas, 1, 1, 50, 50, 2, &clear);
  cloth_draw_line (&canvas, -50, -50, -10, 500, 2, &white);
  cloth_draw_dashes (&canvas, 1, 1, 50, 50, 2, 0, &white);
  cloth_draw_ellipse (&canvas, 40, 40, -1, 0, 4, 1, &white);
  cloth_draw_ellipse (&canvas, 40, 40, 1, 5, 4, 1, &white);
  cloth_draw_ellipse (&canvas, 40, NAN, 4, 0, 4, 1, &white);
  g_assert_cmpfloat (area (0), ==, 0);
}

/* Lines that start far outside still pass where they must. */
static void
test_clipping (void)
{
  ClothCanvas canvas = black_canvas (0);

  cloth_draw_line (&canvas, -1e5f, 48, 1e5f, 48, 3, &white);
  assert_near (area (0), 3 * SIZE, 0.01, "clipped line");
}

static void
test_confidence_colour (void)
{
  gfloat last = -1;
  gint i;

  for (i = 0; i <= 100; i++) {
    ClothColour c = cloth_draw_confidence_colour (0.62f + 0.0038f * i, 0.62f);
    /* yellow has the most red and green, purple the most blue */
    gfloat warmth = c.r + c.g - c.b;

    g_assert_cmpfloat (warmth, >, last);
    g_assert_cmpfloat (c.a, ==, 1);
    last = warmth;
  }
  g_assert_cmpfloat (cloth_draw_confidence_colour (NAN, 0.62f).b, >, 0.7f);
  g_assert_cmpfloat (cloth_draw_confidence_colour (1, 1).g, >, 0.9f);
}

/* ---- wireframe ---- */

static void
test_edges (void)
{
  const guint32 faces[] = {
    0, 1, 2, G_MAXUINT32, 2, 1, 3, G_MAXUINT32, 0, 1, 9, G_MAXUINT32,
    4, 5, 6, 40
  };
  ClothWireframe *wire = cloth_wireframe_new (12, 4, 3, NULL, 0);

  g_assert_cmpuint (cloth_wireframe_get_n_edges (wire), ==, 3 * 3 + 4 * 2);
  cloth_wireframe_free (wire);
  /* two triangles share an edge; faces out of range are left out */
  wire = cloth_wireframe_new (8, 0, 0, faces, 4);
  g_assert_cmpuint (cloth_wireframe_get_n_edges (wire), ==, 5);
  cloth_wireframe_free (wire);
  wire = cloth_wireframe_new (1, 1, 1, NULL, 0);
  g_assert_cmpuint (cloth_wireframe_get_n_edges (wire), ==, 0);
  cloth_wireframe_free (wire);
  cloth_wireframe_free (NULL);
}

static ClothCamera
pinhole (void)
{
  ClothCamera camera = { 0 };

  camera.width = camera.height = SIZE;
  camera.K[0] = camera.K[4] = 100;
  camera.K[2] = camera.K[5] = 0.5 * (SIZE - 1);
  camera.K[8] = 1;
  camera.R[0] = camera.R[4] = camera.R[8] = 1;
  return camera;
}

/* Two sheets, one 0.5 m behind the other: the one behind is faint, as asked for; with
 * the order of depth turned round the other one is. */
static void
test_hidden (void)
{
  const guint32 faces[] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const guint8 states[8] = { 1, 1, 1, 1, 1, 1, 1, 1 };
  ClothCamera camera = pinhole ();
  ClothWireStyle style = { 1, &white, 3, 1, 0.25f };
  ClothWireframe *wire = cloth_wireframe_new (8, 0, 0, faces, 2);
  gint turn, i;

  for (turn = 0; turn < 2; turn++) {
    ClothCanvas canvas = black_canvas (0);
    gfloat positions[24];

    for (i = 0; i < 8; i++) {
      gfloat half = i < 4 ? 0.35f : 0.12f;
      gfloat z = (i < 4) == (turn == 0) ? 1.0f : 1.5f;
      gint k = i & 3;

      positions[3 * i] = (k == 1 || k == 2 ? half : -half) * z;
      positions[3 * i + 1] = (k > 1 ? half : -half) * z;
      positions[3 * i + 2] = z;
    }
    cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, positions, states,
        &style);
    /* left edges, at x = 47.5 - 35 and 47.5 - 12 */
    g_test_message ("outer sheet %d, inner sheet %d", pixels[48 * SIZE + 12],
        pixels[48 * SIZE + 35]);
    g_assert_cmpint (pixels[48 * SIZE + 12], >=, 245);
    if (turn == 0) {
      g_assert_cmpint (pixels[48 * SIZE + 35], <=, 65);
      g_assert_cmpint (pixels[48 * SIZE + 35], >=, 55);
    } else {
      g_assert_cmpint (pixels[48 * SIZE + 35], >=, 245);
    }
  }
  cloth_wireframe_free (wire);
}

/* A square of 60 px and a triangle that is half of one, filled at half opacity in the
 * mean of their corners' colours; a square behind the first one is not filled, nor one
 * with a corner that isn't known. */
static void
test_filled (void)
{
  const ClothColour colours[2] = { {0, 0, 0, 1}, {0.8f, 0, 0, 1} };
  const guint32 faces[3][4] = {
    {0, 1, 2, 3}, {0, 1, 2, G_MAXUINT32}, {4, 5, 6, 7}
  };
  const guint8 states[8] = { 1, 1, 1, 0, 1, 1, 1, 1 };
  const gdouble areas[2] = { 60 * 60, 60 * 60 / 2 };
  const gdouble means[2] = { 0.6, 0.8 };
  ClothCamera camera = pinhole ();
  ClothWireStyle style = { 2, colours, 1, 0, 0, 0.5f };
  gint round, i;

  for (round = 0; round < 4; round++) {
    ClothCanvas canvas = black_canvas (0);
    ClothWireframe *wire = cloth_wireframe_new (8, 0, 0, faces[round % 2], 1);
    gfloat positions[24];

    if (round == 2) {
      const guint32 both[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };

      cloth_wireframe_free (wire);
      wire = cloth_wireframe_new (8, 0, 0, both, 2);
    }
    for (i = 0; i < 8; i++) {
      gfloat half = i < 4 ? 0.3f : 0.1f, z = i < 4 ? 1 : 3;
      gint k = i & 3;

      positions[3 * i] = (k == 1 || k == 2 ? half : -half) * z;
      positions[3 * i + 1] = (k > 1 ? half : -half) * z;
      positions[3 * i + 2] = z;
    }
    if (round == 3) {
      positions[4] = NAN;
    }
    cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, positions, states,
        &style);
    if (round == 3) {
      g_assert_cmpfloat (area (0), ==, 0);
    } else {
      assert_near (area (0), 0.5 * means[round % 2] * areas[round % 2], 0.02,
          round ? round == 1 ? "triangle" : "two squares" : "square");
    }
    cloth_wireframe_free (wire);
  }
}

/* Unknown vertices, ones behind the camera and ones at infinity draw nothing. */
static void
test_bad_vertices (void)
{
  static const gfloat bad[][3] = {
    {NAN, NAN, NAN}, {0, 0, -1}, {0, 0, 0}, {INFINITY, 0, 1}, {1e30f, 1e30f, 1}
  };
  const guint8 states[4] = { 0, 1, 2, 200 };
  ClothCamera camera = pinhole ();
  ClothWireStyle style = { 1, &white, 1, 1, 0.25f };
  ClothWireframe *wire = cloth_wireframe_new (4, 2, 2, NULL, 0);
  guint i, k;

  for (i = 0; i < G_N_ELEMENTS (bad); i++) {
    ClothCanvas canvas = black_canvas (0);
    gfloat positions[12];

    for (k = 0; k < 4; k++) {
      memcpy (&positions[3 * k], bad[i], sizeof (bad[i]));
    }
    /* one good vertex: an edge needs two */
    positions[3] = positions[4] = 0;
    positions[5] = 1;
    cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, positions, states,
        &style);
    if (i < 3) {
      g_assert_cmpfloat (area (0), ==, 0);
    }
  }
  cloth_wireframe_free (wire);
}

/* One of each shape. */
static void
draw_all (const ClothCanvas * canvas)
{
  static const ClothColour half = { 1, 1, 1, 0.5f };
  const gfloat x[4] = { -10, 60, 70, -20 }, y[4] = { 5, -30, 50, 200 };
  const gfloat origin[2] = { 30, 30 }, right[2] = { 9, 1 }, down[2] =
      { -1, 15 };

  cloth_draw_quad (canvas, x, y, &half);
  cloth_draw_line (canvas, -500, 20, 600, 70, 3, &half);
  cloth_draw_dashes (canvas, 10, -1e6f, 40, 1e6f, 2, 7, &half);
  cloth_draw_ellipse (canvas, 40, 50, 900, 100, 400, 2, &half);
  cloth_draw_number (canvas, 47, origin, right, down, 2, &half);
}

/* What fits is drawn as if there were no limit. */
static void
test_work_enough (void)
{
  ClothCanvas canvas = black_canvas (0);
  ClothWork work = { 1e6, NULL, FALSE };
  g_autofree guint8 *all = NULL;

  draw_all (&canvas);
  all = g_memdup2 (pixels, sizeof pixels);
  canvas = black_canvas (0);
  canvas.work = &work;
  draw_all (&canvas);
  g_assert_cmpmem (pixels, sizeof pixels, all, sizeof pixels);
  g_assert_false (work.left_out);
  /* the quad, the line, what is seen of 4096 dashes and what isn't */
  g_assert_cmpfloat (1e6 - work.left, >,
      5000 + 96 * 3 + 2048 * CLOTH_WORK_SHAPE);
  g_assert_cmpfloat (1e6 - work.left, <, 60000);
}

/* Room for three pictures and a half: three are drawn, and nothing after them. */
static void
test_work_too_little (void)
{
  static const ClothColour half = { 1, 1, 1, 0.5f };
  const gfloat x[4] = { -10, 200, 200, -10 }, y[4] = { -10, -10, 200, 200 };
  ClothCanvas canvas = black_canvas (0);
  ClothWork work = { 3.5 * SIZE * SIZE, NULL, FALSE };
  g_autofree guint8 *three = NULL;

  for (guint i = 0; i < 3; i++)
    cloth_draw_quad (&canvas, x, y, &half);
  three = g_memdup2 (pixels, sizeof pixels);
  canvas = black_canvas (0);
  canvas.work = &work;
  for (guint i = 0; i < 3; i++)
    cloth_draw_quad (&canvas, x, y, &half);
  g_assert_false (work.left_out);
  for (guint i = 0; i < 5; i++)
    cloth_draw_quad (&canvas, x, y, &half);
  g_assert_true (work.left_out);
  draw_all (&canvas);
  g_assert_cmpmem (pixels, sizeof pixels, three, sizeof pixels);
}

/* Lines as long as a float allows cost what is seen of them. */
static void
test_work_of_lines (void)
{
  static const gfloat ends[][4] = {
    {-1e18f, 48, 1e18f, 48}, {48, -1e18f, 48, 1e18f}, {-1e18f, -1e18f, 1e18f,
        1e18f}, {1e18f, 1e18f, 1e18f, 1e18f}, {-50, -50, -10, 1e18f}
  };

  for (guint i = 0; i < G_N_ELEMENTS (ends); i++) {
    ClothCanvas canvas = black_canvas (0);
    ClothWork work = { 1e6, NULL, FALSE };

    canvas.work = &work;
    cloth_draw_line (&canvas, ends[i][0], ends[i][1], ends[i][2], ends[i][3], 4,
        &white);
    g_test_message ("%g", 1e6 - work.left);
    g_assert_cmpfloat (1e6 - work.left, >=, CLOTH_WORK_SHAPE);
    g_assert_cmpfloat (1e6 - work.left, <=, CLOTH_WORK_SHAPE + 96 * 16);
  }
}

/* What is narrower than a pixel costs its rows; what lies beside the picture is not looked at,
 * and costs no more than any shape. */
static void
test_work_of_slivers (void)
{
  static const gfloat lefts[] = { 40, -5000, 5000 };

  for (guint i = 0; i < G_N_ELEMENTS (lefts); i++) {
    const gfloat l = lefts[i], r = l + 0.001f;
    const gfloat x[4] = { l, r, r, l }, y[4] = { -1e4f, -1e4f, 1e4f, 1e4f };
    ClothCanvas canvas = black_canvas (0);
    ClothWork work = { 1e6, NULL, FALSE };

    canvas.work = &work;
    cloth_draw_quad (&canvas, x, y, &white);
    cloth_draw_line (&canvas, l, -1e4f, l, 1e4f, 1, &white);
    if (i == 0)
      g_assert_cmpfloat (1e6 - work.left, >=, 2 * 96 * 16);
    else
      g_assert_cmpfloat (work.left, ==, 1e6 - 2 * CLOTH_WORK_SHAPE);
  }
}

static void
test_work_stopped (void)
{
  const gfloat positions[12] = { -0.2f, -0.2f, 1, 0.2f, -0.2f, 1, -0.2f, 0.2f,
    1, 0.2f, 0.2f, 1
  };
  const guint8 states[4] = { 0 };
  ClothCamera camera = pinhole ();
  ClothWireStyle style = { 1, &white, 1, 1, 0.25f, 1 };
  ClothWireframe *wire = cloth_wireframe_new (4, 2, 2, NULL, 0);
  ClothCanvas canvas = black_canvas (0);
  gint stop = 1;
  ClothWork work = { 1e6, &stop, FALSE };

  canvas.work = &work;
  draw_all (&canvas);
  cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, positions, states,
      &style);
  g_assert_cmpfloat (area (0), ==, 0);
  g_assert_cmpfloat (work.left, ==, 1e6);
  g_assert_false (work.left_out);
  stop = 0;
  cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, positions, states,
      &style);
  g_assert_cmpfloat (area (0), >, 100);
  cloth_wireframe_free (wire);
}

/* Eight hundred faces that each cover the picture: of the depths and lines only so much is
 * worked out; the next mesh, small, is drawn as without a limit. */
static void
test_work_of_mesh (void)
{
  const guint columns = 401, n = 2 * columns;
  g_autofree gfloat *crowd = g_new (gfloat, 3 * n), *small = g_new (gfloat,
      3 * n);
  g_autofree guint8 *states = g_malloc0 (n), *plain = NULL;
  ClothCamera camera = pinhole ();
  ClothWireStyle style = { 1, &white, 1, 1, 0.25f, 0.5f };
  ClothWireframe *wire = cloth_wireframe_new (n, columns, 2, NULL, 0);
  ClothCanvas canvas = black_canvas (0);
  ClothWork work = { 64 * SIZE * SIZE, NULL, FALSE };

  for (guint i = 0; i < n; i++) {
    const gfloat share = (gfloat) (i % columns) / (gfloat) columns;

    crowd[3 * i] = i % 2 ? 3 : -3;
    crowd[3 * i + 1] = i < columns ? 3 : -3;
    small[3 * i] = 0.4f * share - 0.2f;
    small[3 * i + 1] = i < columns ? 0.2f : -0.2f;
    crowd[3 * i + 2] = small[3 * i + 2] = 1;
  }
  cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, small, states,
      &style);
  plain = g_memdup2 (pixels, sizeof pixels);
  canvas = black_canvas (0);
  canvas.work = &work;
  cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, crowd, states,
      &style);
  g_assert_true (work.left_out);
  canvas = black_canvas (0);
  work = (ClothWork) {
  1e6, NULL, FALSE};
  canvas.work = &work;
  cloth_wireframe_draw (wire, &canvas, SIZE, SIZE, &camera, small, states,
      &style);
  g_assert_false (work.left_out);
  g_assert_cmpmem (pixels, sizeof pixels, plain, sizeof pixels);
  cloth_wireframe_free (wire);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/draw/work-enough", test_work_enough);
  g_test_add_func ("/draw/work-too-little", test_work_too_little);
  g_test_add_func ("/draw/work-of-lines", test_work_of_lines);
  g_test_add_func ("/draw/work-of-slivers", test_work_of_slivers);
  g_test_add_func ("/draw/work-stopped", test_work_stopped);
  g_test_add_func ("/draw/work-of-mesh", test_work_of_mesh);
  g_test_add_func ("/draw/line-area", test_line_area);
  g_test_add_func ("/draw/thin-line", test_thin_line);
  g_test_add_func ("/draw/dashes", test_dashes);
  g_test_add_func ("/draw/quad-area", test_quad_area);
  g_test_add_func ("/draw/tiling", test_tiling);
  g_test_add_func ("/draw/layouts", test_layouts);
  g_test_add_func ("/draw/not-drawn", test_not_drawn);
  g_test_add_func ("/draw/clipping", test_clipping);
  g_test_add_func ("/draw/confidence-colour", test_confidence_colour);
  g_test_add_func ("/wireframe/edges", test_edges);
  g_test_add_func ("/wireframe/hidden", test_hidden);
  g_test_add_func ("/wireframe/filled", test_filled);
  g_test_add_func ("/wireframe/bad-vertices", test_bad_vertices);
  return g_test_run ();
}
