/* The tests' own renderer and the texture, each against the other and against closed
 * forms; and what the dots of a coded board do to the paper's confidence and saddles.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/picture.h"
#include "tests/common/render.h"

#include "gst/pattern/code.h"
#include "gst/pattern/texture.h"

#include <math.h>
#include <string.h>

static ClothPattern *
board (gint columns, gint rows, gboolean first_black, gboolean with_code)
{
  ClothPattern *pattern = cloth_pattern_new_checker (columns, rows, 0.05,
      0.025, first_black, NULL);

  if (with_code)
    g_assert_true (cloth_code_generate (pattern, CLOTH_CODE_DOT_RATIO, 1, NULL,
            NULL));
  return pattern;
}

/* One pixel a millimetre, half a pixel off the texture's own grid: the first pixel's
 * centre sees the cloth's corner + 0.5 px, as the texture's does. */
static void
test_flat_is_texture (void)
{
  for (gint first = 0; first < 2; first++) {
    g_autoptr (ClothPattern) pattern = board (8, 6, first, TRUE);
    TestWave wave = { pattern };
    ClothCamera camera = test_camera (450, 350, 1000, 1);
    TestScene scene = { pattern, &camera, test_surface_wave, &wave, 20, 220,
      90
    };
    g_autoptr (TestRender) render = test_render (&scene);
    g_autoptr (ClothTexture) texture =
        cloth_pattern_texture (pattern, 1000, 20, 220, NULL);
    gint most = 0;

    test_picture_keep ("flat.pgm", render->data, 450, 350);
    g_assert_cmpint (texture->width, ==, 450);
    g_assert_cmpint (texture->height, ==, 350);
    for (gint i = 0; i < 450 * 350; i++)
      most = MAX (most, ABS (render->data[i] - texture->data[i]));
    g_test_message ("most difference %d grey levels of 200", most);
    g_assert_cmpint (most, <=, 4);
    for (gint n = 0; n < 9 * 7; n++) {
      g_assert_cmpfloat_with_epsilon (render->x[n], 24.5 + 50 * (n % 9), 1e-9);
      g_assert_cmpfloat_with_epsilon (render->y[n], 24.5 + 50 * (n / 9), 1e-9);
      g_assert_true (render->visible[n]);
    }
  }
}

/* Squares of 7.3 px: every edge falls within a pixel, whose grey is the covered part. */
static void
test_texture_means (void)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (10, 10, 0.0073, 0, TRUE, NULL);
  g_autoptr (ClothTexture) texture =
      cloth_pattern_texture (pattern, 1000, 0, 250, NULL);

  g_assert_cmpint (texture->width, ==, 73);
  g_assert_cmpint (texture->data[0], ==, 0);
  g_assert_cmpint (texture->data[8], ==, 250);
  /* Pixel 7 is 0.3 black, 0.7 white; and on the diagonal 0.3² + 0.7² black. */
  g_assert_cmpint (texture->data[7], ==, 175);
  g_assert_cmpint (texture->data[7 * 73 + 7], ==, 105);
}

static void
test_texture_refused (void)
{
  g_autoptr (ClothPattern) pattern = board (8, 8, TRUE, FALSE);
  const gdouble scales[] = { 0, -1, NAN, INFINITY, 1e6 };

  for (gsize i = 0; i < G_N_ELEMENTS (scales); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_pattern_texture (pattern, scales[i], 0, 255, &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
  }
}

/* Across an edge, the sum of light in a row of pixels tells where the edge is. */
static void
test_bent_edges (void)
{
  g_autoptr (ClothPattern) pattern = board (8, 8, TRUE, FALSE);
  TestWave wave = { pattern, {0.01, 0, 0.005}, 0.3, 0.2, 0.1, 0.02, 0.3, 1,
  0.4
  };
  ClothCamera camera = test_camera (640, 480, 1000, 1.2);
  TestScene scene = { pattern, &camera, test_surface_wave, &wave, 10, 230, 90 };
  g_autoptr (TestRender) render = test_render (&scene);
  gdouble most = 0;
  gint edges = 0;

  test_picture_keep ("bent.pgm", render->data, 640, 480);
  for (gint row = 0; row < 8; row++) {
    for (gint column = 1; column < 8; column++) {
      /* Rows of pixels across the vertical edge at half the square's height. */
      const gdouble u = 0.025 + 0.05 * column, v = 0.025 + 0.05 * (row + 0.5);
      const gdouble *K = camera.K;
      gdouble p[3], q[3], x, y, slope, sum = 0, expected;
      gint x0, py;

      test_surface_wave (u, v, p, &wave);
      test_surface_wave (u, v + 1e-5, q, &wave);
      x = K[0] * p[0] / (p[1] + 1.2) + K[2];
      y = -K[4] * p[2] / (p[1] + 1.2) + K[5];
      slope = (K[0] * q[0] / (q[1] + 1.2) + K[2] - x)
          / (-K[4] * q[2] / (q[1] + 1.2) + K[5] - y);
      py = (gint) floor (y + 0.5);
      x0 = (gint) floor (x) - 7;
      for (gint i = 0; i < 15; i++)
        sum += (render->data[py * 640 + x0 + i] - 10) / 220.0;
      /* Light left or right of the edge. */
      expected = x + slope * (py - y) - (x0 - 0.5);
      if ((row + column) % 2 == 1)
        expected = 15 - expected;
      most = MAX (most, fabs (sum - expected));
      edges++;
    }
  }
  g_test_message ("%d bent edges, most error %.4f px", edges, most);
  /* Rounding to 220 grey levels alone gives about 0.005 px. */
  g_assert_cmpfloat (most, <, 0.01);
}

static void
test_occlusion (void)
{
  g_autoptr (ClothPattern) pattern = board (8, 8, FALSE, TRUE);
  TestWave wave = { pattern };
  ClothCamera camera = test_camera (376, 240, 400, 1);
  const TestDisc disc = { 187.5, 119.5, 30, 128 };
  TestScene scene = { pattern, &camera, test_surface_wave, &wave, 30, 200, 90,
    &disc, 1, {1, 0, 150, 0.5}, 0.7, 2, 5
  };
  g_autoptr (TestRender) render = test_render (&scene);
  g_autoptr (TestRender) again = test_render (&scene);
  g_autoptr (TestRender) other = NULL;
  gdouble sum = 0, squares = 0;
  gint n = 0, seen = 0;

  test_picture_keep ("occluded.pgm", render->data, 376, 240);
  g_assert_cmpmem (render->data, 376 * 240, again->data, 376 * 240);
  scene.seed = 6;
  other = test_render (&scene);
  g_assert_cmpint (memcmp (render->data, other->data, 376 * 240), !=, 0);
  for (gint y = 105; y < 135; y++) {
    for (gint x = 172; x < 203; x++, n++) {
      sum += render->data[y * 376 + x];
      squares += pow (render->data[y * 376 + x] - 128, 2);
    }
  }
  /* Noise of 2 and rounding of 1/12. */
  g_assert_cmpfloat_with_epsilon (sum / n, 128, 0.3);
  g_assert_cmpfloat_with_epsilon (sqrt (squares / n), sqrt (4 + 1 / 12.0),
      0.15);
  for (gint i = 0; i < 81; i++) {
    gdouble x = 187.5 + 20 * (i % 9 - 4), y = 119.5 + 20 * (i / 9 - 4);

    g_assert_cmpint (render->visible[i], ==,
        hypot (x - 187.5, y - 119.5) >= 31);
  }
  for (gint i = 0; i < 64; i++)
    seen += render->square_visible[i];
  /* The disc reaches into two squares from the middle, the diagonal one too: its
   * corner is 28.3 px away. */
  g_assert_cmpint (seen, ==, 64 - 16);
}

/* A pipe of 10 cm across: its back hides from the camera. */
static void
pipe_surface (gdouble u, gdouble v, gdouble point[3], gpointer data)
{
  point[0] = 0.05 * sin ((u - 0.225) / 0.05);
  point[1] = -0.05 * cos ((u - 0.225) / 0.05);
  point[2] = 0.225 - v;
}

static void
test_self_occlusion (void)
{
  g_autoptr (ClothPattern) pattern = board (8, 8, TRUE, FALSE);
  ClothCamera camera = test_camera (320, 240, 400, 1);
  TestScene scene = { pattern, &camera, pipe_surface, NULL, 30, 200, 90 };
  g_autoptr (TestRender) render = test_render (&scene);

  test_picture_keep ("pipe.pgm", render->data, 320, 240);
  for (gint column = 0; column <= 8; column++) {
    const gdouble angle = (column * 0.05 - 0.2) / 0.05;
    /* Tangent from the camera, 1 m off the axis: cos(angle) = 0.05. */
    const gboolean front = fabs (angle) < acos (0.05);

    g_assert_cmpint (render->visible[4 * 9 + column], ==, front);
  }
}

/* The dots must not spoil the paper's confidence of a black square (its section 3.5)
 * nor look like corners. */
static void
test_dots_are_harmless (void)
{
  g_autoptr (ClothPattern) pattern = board (12, 12, TRUE, TRUE);
  const gdouble px = 16, sigma = 1;
  TestWave wave = { pattern };
  ClothCamera camera = test_camera (224, 224, px * 20, 1);
  TestScene scene = { pattern, &camera, test_surface_wave, &wave, 20, 220, 90,
    NULL, 0, {0}, sigma
  };
  g_autoptr (TestRender) render = test_render (&scene);
  gdouble least_corner = G_MAXDOUBLE, most_dot = 0, least_confidence = 1;

  test_picture_keep ("coded.pgm", render->data, 224, 224);
  for (gint y = 20; y < 204; y++) {
    for (gint x = 20; x < 204; x++) {
      const guint8 *p = render->data + y * 224 + x;
      gdouble xx = p[1] - 2 * p[0] + p[-1], yy = p[224] - 2 * p[0] + p[-224];
      gdouble xy = (p[225] - p[223] - p[-223] + p[-225]) / 4.0;
      gdouble response = -(xx * yy - xy * xy);
      gdouble cx = (x - render->x[0]) / px, cy = (y - render->y[0]) / px;
      gdouble to_corner = hypot (cx - floor (cx + 0.5), cy - floor (cy + 0.5));
      gdouble to_centre = hypot (cx - floor (cx) - 0.5, cy - floor (cy) - 0.5);

      if (to_corner * px < 0.75)
        least_corner = MIN (least_corner, response);
      if (to_centre < 0.35)
        most_dot = MAX (most_dot, response);
    }
  }
  for (gint row = 0; row < 12; row++) {
    for (gint column = row & 1; column < 12; column += 2) {
      const gdouble left = render->x[row * 13 + column];
      const gdouble top = render->y[row * 13 + column];
      gdouble sum = 0, confidence = 0;
      gint n = 0;

      /* A square and four lapels of a quarter: sign(I − mean)·μ. */
      for (gint pass = 0; pass < 2; pass++) {
        for (gint y = 0; y < 224; y++) {
          for (gint x = 0; x < 224; x++) {
            gdouble a = (x - left) / px, b = (y - top) / px;
            gboolean in = a > 0 && a < 1 && b > 0 && b < 1;
            gboolean lapel = !in && ((a > 0 && a < 1 && b > -0.25 && b < 1.25)
                || (b > 0 && b < 1 && a > -0.25 && a < 1.25));

            if (!in && !lapel)
              continue;
            if (pass == 0) {
              sum += render->data[y * 224 + x];
              n++;
            } else {
              confidence += (render->data[y * 224 + x] > sum / n ? 1 : -1)
                  * (in ? -1 : 1);
            }
          }
        }
      }
      least_confidence = MIN (least_confidence, confidence / n);
    }
  }
  g_test_message ("saddle response: corners at least %.0f, dots at most %.0f; "
      "least confidence %.3f", least_corner, most_dot, least_confidence);
  g_assert_cmpfloat (most_dot, <, 0.35 * least_corner);
  g_assert_cmpfloat (least_confidence, >, 0.85);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/render/flat-is-texture", test_flat_is_texture);
  g_test_add_func ("/render/texture-means", test_texture_means);
  g_test_add_func ("/render/texture-refused", test_texture_refused);
  g_test_add_func ("/render/bent-edges", test_bent_edges);
  g_test_add_func ("/render/occlusion", test_occlusion);
  g_test_add_func ("/render/self-occlusion", test_self_occlusion);
  g_test_add_func ("/render/dots-are-harmless", test_dots_are_harmless);
  return g_test_run ();
}
