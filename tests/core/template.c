/* Square template: the paper's sum over pixels, literally; refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/template.h"

#include "tests/core/polygon.h"

#define SIZE 128

static void
to_float (const gdouble * from, gfloat * to)
{
  for (gint k = 0; k < 4; k++)
    to[k] = (gfloat) from[k];
}

/* Section 3.5 as it stands: every pixel of the cross κ, the mean over it, and
 * sign (I − mean)·μ; the mean may be put off. */
static gdouble
paper (const ClothImage * image, const gdouble x[4], const gdouble y[4],
    gdouble alpha, gdouble put_off)
{
  gdouble sum = 0, score = 0;
  guint n = 0;

  for (gint pass = 0; pass < 2; pass++)
    for (gint v = 0; v < image->height; v++)
      for (gint u = 0; u < image->width; u++) {
        gboolean in = polygon_holds (x, y, 4, u, v), lapel = FALSE;
        gdouble grey = image->data[v * image->stride + u];

        for (gint k = 0; k < 4 && !in && !lapel; k++) {
          gint a = (k + 1) & 3, b = (k + 2) & 3, c = (k + 3) & 3;
          const gdouble lx[4] = { x[k], x[a], (1 + alpha) * x[a] - alpha * x[b],
            (1 + alpha) * x[k] - alpha * x[c]
          };
          const gdouble ly[4] = { y[k], y[a], (1 + alpha) * y[a] - alpha * y[b],
            (1 + alpha) * y[k] - alpha * y[c]
          };

          lapel = polygon_holds (lx, ly, 4, u, v);
        }
        if (!in && !lapel)
          continue;
        if (pass == 0) {
          sum += grey;
          n++;
        } else {
          gdouble d = grey - sum / n - put_off;

          score += ((d > 0) - (d < 0)) * (in ? -1 : 1);
        }
      }
  return score / n;
}

/* Black squares as they are: the template fits, its negative is the opposite. */
static void
test_squares (void)
{
  for (gint k = 0; k < 12; k++) {
    ClothImage image = polygon_picture (SIZE, SIZE, k & 1 ? 40 : 200);
    gdouble x[4], y[4];
    gfloat fx[4], fy[4], own, other;

    polygon_square (64.2, 63.6, 24 + 2 * k, 0.13 * k, x, y);
    polygon_paint (&image, x, y, 4, k & 1 ? 200 : 40);
    to_float (x, fx);
    to_float (y, fy);
    own = cloth_quad_confidence (&image, fx, fy, 0.25f, !(k & 1));
    other = cloth_quad_confidence (&image, fx, fy, 0.25f, k & 1);
    g_assert_cmpfloat (own, >, 0.9f);
    g_assert_cmpfloat (own, <=, 1);
    g_assert_cmpfloat (other, ==, -own);
    polygon_picture_clear (&image);
  }
}

/* On the pixels' own grid not one sample is wrong. */
static void
test_exact (void)
{
  ClothImage image = polygon_picture (SIZE, SIZE, 200);
  const gfloat x[4] = { 39.5f, 79.5f, 79.5f, 39.5f };
  const gfloat y[4] = { 29.5f, 29.5f, 69.5f, 69.5f };

  /* Nothing at all is neither darker nor brighter than the mean. */
  g_assert_cmpfloat (cloth_quad_confidence (&image, x, y, 0.25f, TRUE), ==, 0);
  polygon_paint_box (&image, 39.5, 29.5, 79.5, 69.5, 40);
  g_assert_cmpfloat (cloth_quad_confidence (&image, x, y, 0.25f, TRUE), ==, 1);
  /* One level less, with the mean in between, is darker. */
  polygon_paint_box (&image, 39.5, 29.5, 79.5, 69.5, 199);
  g_assert_cmpfloat (cloth_quad_confidence (&image, x, y, 0.25f, TRUE), ==, 1);
  polygon_picture_clear (&image);
}

/* Parallelograms on any texture against the paper's sum, but for those where the mean
 * is the grey of some large piece of the texture: there a hair decides. */
static void
test_paper (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (3);
  gdouble worst = 0, sum2 = 0;
  guint n = 0;

  while (n < 150) {
    ClothImage image = polygon_picture (SIZE, SIZE, 150);
    gdouble alpha = g_rand_double_range (rand, 0.1, 0.5), difference;
    gdouble x[4], y[4], ux, uy, vx, vy, expected;
    gfloat fx[4], fy[4];

    for (gint k = 0; k < 12; k++) {
      polygon_square (g_rand_double_range (rand, 20, 108),
          g_rand_double_range (rand, 20, 108),
          g_rand_double_range (rand, 10, 45), g_rand_double_range (rand, 0, 3),
          x, y);
      polygon_paint (&image, x, y, 4, (guint8) g_rand_int_range (rand, 0, 256));
    }
    ux = g_rand_double_range (rand, 15, 40);
    uy = g_rand_double_range (rand, -12, 12);
    vx = g_rand_double_range (rand, -12, 12);
    vy = g_rand_double_range (rand, 15, 40);
    for (gint k = 0; k < 4; k++) {
      x[k] = 40 + (k == 1 || k == 2 ? ux : 0) + (k >= 2 ? vx : 0);
      y[k] = 40 + (k == 1 || k == 2 ? uy : 0) + (k >= 2 ? vy : 0);
    }
    to_float (x, fx);
    to_float (y, fy);
    expected = paper (&image, x, y, alpha, 0);
    if (fabs (paper (&image, x, y, alpha, 4) - expected) < 0.02
        && fabs (paper (&image, x, y, alpha, -4) - expected) < 0.02) {
      difference = cloth_quad_confidence (&image, fx, fy, (gfloat) alpha, TRUE)
          - expected;
      worst = MAX (worst, fabs (difference));
      sum2 += difference * difference;
      n++;
    }
    polygon_picture_clear (&image);
  }
  g_test_message ("%u parallelograms: RMS %.4f, at most %.4f from the sum over "
      "all pixels", n, sqrt (sum2 / n), worst);
  g_assert_cmpfloat (sqrt (sum2 / n), <, 0.03);
  g_assert_cmpfloat (worst, <, 0.15);
}

/* Neither light nor contrast matter, nor which corner is the first, nor which way round. */
static void
test_invariant (void)
{
  ClothImage image = polygon_picture (SIZE, SIZE, 100);
  ClothImage bright = polygon_picture (SIZE, SIZE, 0);
  gfloat fx[4], fy[4], tx[4], ty[4], confidence;
  gdouble x[4], y[4];

  polygon_square (64, 64, 30, 0.4, x, y);
  polygon_paint (&image, x, y, 4, 20);
  polygon_paint_box (&image, 60, 60, 90, 70, 120);
  for (gint k = 0; k < SIZE * SIZE; k++)
    ((guint8 *) bright.data)[k] = (guint8) (2 * image.data[k] + 9);
  to_float (x, fx);
  to_float (y, fy);
  confidence = cloth_quad_confidence (&image, fx, fy, 0.25f, TRUE);
  g_assert_cmpfloat (fabsf (confidence), <, 0.99f);
  g_assert_cmpfloat (cloth_quad_confidence (&bright, fx, fy, 0.25f, TRUE), ==,
      confidence);
  for (gint first = 0; first < 4; first++)
    for (gint way = 1; way <= 3; way += 2) {
      for (gint k = 0; k < 4; k++) {
        tx[k] = fx[(first + way * k) & 3];
        ty[k] = fy[(first + way * k) & 3];
      }
      g_assert_cmpfloat_with_epsilon (cloth_quad_confidence (&image, tx, ty,
              0.25f, TRUE), confidence, 0.02);
    }
  polygon_picture_clear (&image);
  polygon_picture_clear (&bright);
}

/* The two levels' ratio in full light, in shadow and half in it, for either colour; one side
 * lighter and one darker make no difference, and the picture's edge is too near. */
static void
test_shade (void)
{
  const gfloat x[4] = { 39.5f, 79.5f, 79.5f, 39.5f };
  const gfloat y[4] = { 29.5f, 29.5f, 69.5f, 69.5f };
  gfloat tx[4];

  for (gint dark = 20; dark <= 180; dark += 40)
    for (gint black = 0; black <= 1; black++)
      for (gint shadow = 0; shadow <= SIZE; shadow += SIZE / 4) {
        ClothImage image = polygon_picture (SIZE, SIZE, black ? 200
            : (guint8) dark);

        polygon_paint_box (&image, 39.5, 29.5, 79.5, 69.5, black
            ? (guint8) dark : 200);
        for (gint k = 0; k < SIZE * SIZE; k++)
          if (k % SIZE < shadow)
            ((guint8 *) image.data)[k] = (guint8) (image.data[k] / 2);
        g_assert_cmpfloat_with_epsilon (cloth_quad_shade (&image, x, y, black),
            dark / 200.0, 1e-5);
        polygon_paint_box (&image, 0, 0, 38, 127, 255);
        polygon_paint_box (&image, 81, 0, 127, 127, 1);
        g_assert_cmpfloat_with_epsilon (cloth_quad_shade (&image, x, y, black),
            dark / 200.0, 1e-5);
        for (gint c = 0; c < 4; c++)
          tx[c] = x[c] - 30.5f;
        g_assert_cmpfloat (cloth_quad_shade (&image, tx, y, black), ==, -1);
        tx[0] = NAN;
        g_assert_cmpfloat (cloth_quad_shade (&image, tx, y, black), ==, -1);
        polygon_picture_clear (&image);
      }
}

static void
test_refused (void)
{
  static const gfloat odd[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 1e9f };
  ClothImage image = polygon_picture (SIZE, SIZE, 200);
  ClothImage dot = { image.data, 1, 1, SIZE };
  const gfloat x[4] = { 40, 80, 80, 40 }, y[4] = { 40, 40, 80, 80 };
  gfloat tx[4];

  polygon_paint_box (&image, 0, 0, 127, 127, 40);
  for (guint k = 0; k < G_N_ELEMENTS (odd); k++)
    for (gint c = 0; c < 4; c++) {
      memcpy (tx, x, sizeof tx);
      tx[c] = odd[k];
      g_assert_cmpfloat (cloth_quad_confidence (&image, tx, y, 0.25f, TRUE), ==,
          -1);
      g_assert_cmpfloat (cloth_quad_confidence (&image, y, tx, 0.25f, TRUE), ==,
          -1);
    }
  /* A lapel of 10 px needs 10 px. */
  for (gint left = 8; left <= 12; left++) {
    for (gint c = 0; c < 4; c++)
      tx[c] = x[c] - 40 + (gfloat) left;
    g_assert_true ((cloth_quad_confidence (&image, tx, y, 0.25f, TRUE) == -1)
        == (left < 10));
    g_assert_true ((cloth_quad_confidence (&image, y, tx, 0.25f, TRUE) == -1)
        == (left < 10));
    for (gint c = 0; c < 4; c++)
      tx[c] = x[c] + 47 - (gfloat) left;
    g_assert_true ((cloth_quad_confidence (&image, tx, y, 0.25f, TRUE) == -1)
        == (left < 10));
    g_assert_true ((cloth_quad_confidence (&image, y, tx, 0.25f, TRUE) == -1)
        == (left < 10));
  }
  g_assert_cmpfloat (cloth_quad_confidence (&dot, x, y, 0.25f, TRUE), ==, -1);
  polygon_picture_clear (&image);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/template/squares", test_squares);
  g_test_add_func ("/template/exact", test_exact);
  g_test_add_func ("/template/paper", test_paper);
  g_test_add_func ("/template/invariant", test_invariant);
  g_test_add_func ("/template/shade", test_shade);
  g_test_add_func ("/template/refused", test_refused);
  return g_test_run ();
}
