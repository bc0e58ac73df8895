/* Edges and outlines of squares, straight and bent, against where they were painted.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/edge.h"
#include "gst/vision/checker/outline.h"

#include <string.h>

#include "tests/core/polygon.h"

#define SIZE 160
#define WHITE 200
#define BLACK 40

/* A step between two half planes, read both ways and at any angle. */
static void
test_contrast (void)
{
  ClothImage image = polygon_picture (SIZE, SIZE, WHITE);

  for (gint k = 0; k < 24; k++) {
    gdouble angle = G_PI * k / 12, dx = cos (angle), dy = sin (angle);
    const gdouble x[4] = { 80 - 300 * dx, 80 + 300 * dx,
      80 + 300 * dx + 300 * dy, 80 - 300 * dx + 300 * dy
    };
    const gdouble y[4] = { 80 - 300 * dy, 80 + 300 * dy,
      80 + 300 * dy - 300 * dx, 80 - 300 * dy - 300 * dx
    };
    gfloat ax = (gfloat) (80 - 20 * dx), ay = (gfloat) (80 - 20 * dy);
    gfloat bx = (gfloat) (80 + 20 * dx), by = (gfloat) (80 + 20 * dy);

    /* Black is where a turn from y towards x leads. */
    polygon_paint_box (&image, -1, -1, SIZE, SIZE, WHITE);
    polygon_paint (&image, x, y, 4, BLACK);
    g_assert_cmpfloat_with_epsilon (cloth_edge_contrast (&image, ax, ay, bx,
            by), WHITE - BLACK, 5);
    g_assert_cmpfloat_with_epsilon (cloth_edge_contrast (&image, bx, by, ax,
            ay), BLACK - WHITE, 5);
    /* Across the edge, and beside it, there is none. */
    g_assert_cmpfloat (cloth_edge_contrast (&image, (gfloat) (80 + 20 * dy),
            (gfloat) (80 - 20 * dx), (gfloat) (80 - 20 * dy),
            (gfloat) (80 + 20 * dx)), ==, 0);
    g_assert_cmpfloat (cloth_edge_contrast (&image, ax + (gfloat) (12 * dy),
            ay - (gfloat) (12 * dx), bx + (gfloat) (12 * dy),
            by - (gfloat) (12 * dx)), ==, 0);
    /* Twice as long as the board's edge: beyond the picture. */
    g_assert_cmpfloat (cloth_edge_contrast (&image, ax, ay,
            ax + 400 * (gfloat) dx, ay + 400 * (gfloat) dy), ==, 0);
  }
  polygon_picture_clear (&image);
}

/* An edge that is there on half the way only, or too weak, is none. */
static void
test_no_contrast (void)
{
  static const gfloat odd[] = { NAN, INFINITY, 1e30f, -1e30f, -5 };
  ClothImage image = polygon_picture (SIZE, SIZE, WHITE);
  ClothImage dot = { image.data, 1, 1, SIZE };
  guint8 levels[256];

  g_assert_cmpfloat (cloth_edge_contrast (&image, 60, 80, 100, 80), ==, 0);
  polygon_paint_box (&image, 40, 80, 80, 120, BLACK);
  g_assert_cmpfloat (cloth_edge_contrast (&image, 60, 80, 100, 80), ==, 0);
  g_assert_cmpfloat (cloth_edge_contrast (&image, 45, 80, 75, 80), <, -100);
  g_assert_cmpfloat (cloth_edge_contrast (&image, 60, 80, 60, 80), ==, 0);
  for (guint k = 0; k < G_N_ELEMENTS (odd); k++) {
    g_assert_cmpfloat (cloth_edge_contrast (&image, odd[k], 80, 75, 80), ==, 0);
    g_assert_cmpfloat (cloth_edge_contrast (&image, 45, 80, 75, odd[k]), ==, 0);
  }
  g_assert_cmpfloat (cloth_edge_contrast (&dot, 0, 0, 5, 5), ==, 0);
  polygon_paint_box (&image, -1, -1, SIZE, SIZE, 100);
  polygon_paint_box (&image, 40, 80, 120, 120, 97);
  g_assert_cmpfloat (cloth_edge_contrast (&image, 45, 80, 75, 80), ==, 0);
  /* In levels that part the two it is one, as strong as they say. */
  for (guint level = 0; level < G_N_ELEMENTS (levels); level++)
    levels[level] = level < 99 ? 20 : 220;
  g_assert_cmpfloat (cloth_edge_contrast_in_levels (&image, levels, 45, 80, 75,
          80), ==, -200);
  polygon_paint_box (&image, 40, 80, 120, 120, 20);
  g_assert_cmpfloat (cloth_edge_contrast (&image, 45, 80, 75, 80), ==, -80);
  memset (levels, 7, sizeof levels);
  g_assert_cmpfloat (cloth_edge_contrast_in_levels (&image, levels, 45, 80, 75,
          80), ==, 0);
  polygon_picture_clear (&image);
}

static gdouble
off (gdouble a, gdouble b)
{
  return fabs (remainder (a - b, 2 * G_PI));
}

/* The edges at each corner of a square, and the walk along each to the next corner, of
 * both colours and at any angle. */
static void
test_square (void)
{
  gdouble worst_ray = 0, worst_end = 0;

  for (gint k = 0; k < 40; k++) {
    gboolean black = !(k & 1);
    ClothImage image = polygon_picture (SIZE, SIZE, black ? WHITE : BLACK);
    gdouble x[4], y[4];

    polygon_square (80.3, 79.1, 30 + k, 0.17 * k, x, y);
    polygon_paint (&image, x, y, 4, black ? BLACK : WHITE);
    for (gint c = 0; c < 4; c++) {
      gint next = (c + 1) & 3, last = (c + 3) & 3;
      gdouble to_next = atan2 (y[next] - y[c], x[next] - x[c]);
      gdouble to_last = atan2 (y[last] - y[c], x[last] - x[c]);
      gfloat rays[2], contrast, ex, ey, angle;

      g_assert_true (cloth_edge_wedge (&image, (gfloat) x[c], (gfloat) y[c], 8,
              black, (gfloat) (to_next + 0.6), rays, &contrast));
      g_assert_cmpfloat_with_epsilon (contrast, WHITE - BLACK, 5);
      worst_ray = MAX (worst_ray, MAX (off (rays[0], to_next),
              off (rays[1], to_last)));
      /* The square lies where a turn from x towards y leads. */
      g_assert_true (cloth_edge_walk (&image, (gfloat) x[c], (gfloat) y[c],
              rays[0], black, contrast, 150, &ex, &ey, &angle));
      worst_end = MAX (worst_end, hypot (ex - x[next], ey - y[next]));
      g_assert_true (cloth_edge_walk (&image, (gfloat) x[c], (gfloat) y[c],
              rays[1], !black, contrast, 150, &ex, &ey, &angle));
      worst_end = MAX (worst_end, hypot (ex - x[last], ey - y[last]));
      /* Too far, and with the colours the other way round. */
      g_assert_false (cloth_edge_walk (&image, (gfloat) x[c], (gfloat) y[c],
              rays[0], black, contrast, 15, &ex, &ey, &angle));
      /* No wedge of the other colour that way. */
      g_assert_false (cloth_edge_wedge (&image, (gfloat) x[c], (gfloat) y[c], 8,
              !black, (gfloat) (to_next + 0.6), rays, &contrast));
    }
    polygon_picture_clear (&image);
  }
  g_test_message ("edges leave corners within %.3f rad, end within %.2f px",
      worst_ray, worst_end);
  g_assert_cmpfloat (worst_ray, <, 0.1);
  g_assert_cmpfloat (worst_end, <, 2.5);
}

#define ARC 24

/* A square bent into a ring's sector, its middle at (80, 80): corners in ring order. */
static void
paint_bent (ClothImage * image, gdouble radius, gdouble side, gdouble x[4],
    gdouble y[4])
{
  gdouble px[2 * ARC], py[2 * ARC];

  for (gint k = 0; k < ARC; k++) {
    gdouble turn = -G_PI_2 + side / radius * (k / (ARC - 1.0) - 0.5);

    px[k] = 80 + (radius + side / 2) * cos (turn);
    py[k] = 80 + radius + (radius + side / 2) * sin (turn);
    px[2 * ARC - 1 - k] = 80 + (radius - side / 2) * cos (turn);
    py[2 * ARC - 1 - k] = 80 + radius + (radius - side / 2) * sin (turn);
  }
  polygon_paint (image, px, py, 2 * ARC, BLACK);
  for (gint c = 0; c < 4; c++) {
    static const gint at[4] = { 0, ARC - 1, ARC, 2 * ARC - 1 };

    x[c] = px[at[c]];
    y[c] = py[at[c]];
  }
}

/* Any one corner, or two next to each other, are found from the others along the edges,
 * on straight and on bent squares, to a third of a pixel. */
static void
test_outline (void)
{
  gdouble worst = 0;
  guint n = 0;

  for (gint k = 0; k < 24; k++) {
    ClothImage image = polygon_picture (SIZE, SIZE, WHITE);
    gdouble x[4], y[4];

    if (k < 16) {
      polygon_square (80.3, 79.1, 24 + 2 * k, 0.37 * k, x, y);
      polygon_paint (&image, x, y, 4, BLACK);
    } else {
      paint_bent (&image, 70 + 10 * (k - 16), 40, x, y);
    }
    for (gint missing = 0; missing < 16; missing++) {
      static const gint sets[16] =
          { 0, 1, 2, 4, 8, 3, 6, 12, 9, 0, 0, 0, 0, 0, 0,
        0
      };
      ClothOutline outline = { {0} };

      if (missing > 0 && !sets[missing])
        continue;
      for (gint c = 0; c < 4; c++) {
        outline.x[c] = (gfloat) x[c];
        outline.y[c] = (gfloat) y[c];
        if (sets[missing] & (1 << c)) {
          /* a guess */
          outline.x[c] += c & 1 ? 3 : -2.5f;
          outline.y[c] += c & 2 ? 2 : -3;
        }
      }
      for (gint c = 0; c < 4; c++)
        if (!(sets[missing] & (1 << c)))
          g_assert_true (cloth_outline_fit (&outline, &image, c,
                  (gfloat) x[c] + 0.6f, (gfloat) y[c] - 0.7f, 3, TRUE));
      g_assert_true (cloth_outline_complete (&outline, &image, TRUE));
      for (gint c = 0; c < 4; c++) {
        worst = MAX (worst, hypot (outline.x[c] - x[c], outline.y[c] - y[c]));
        n++;
        g_assert_true (outline.have[c]);
        g_assert_false (outline.saddle[c]);
        g_assert_cmpfloat (outline.cov[c][0], >, 0);
        g_assert_cmpfloat (outline.cov[c][0] * outline.cov[c][2], >,
            outline.cov[c][1] * outline.cov[c][1]);
      }
    }
    polygon_picture_clear (&image);
  }
  g_test_message ("%u corners: at most %.3f px off", n, worst);
  g_assert_cmpfloat (worst, <, 0.35);
}

/* Where four squares meet a corner is a saddle. */
static void
test_saddle (void)
{
  ClothImage image = polygon_picture (SIZE, SIZE, WHITE);
  ClothOutline outline = { {60, 100, 100, 60}, {60, 60, 100, 100} };

  polygon_paint_box (&image, 60, 60, 100, 100, BLACK);
  polygon_paint_box (&image, 100, 100, 140, 140, BLACK);
  for (gint c = 0; c < 4; c++)
    g_assert_true (cloth_outline_fit (&outline, &image, c, outline.x[c],
            outline.y[c], 2, TRUE));
  g_assert_true (cloth_outline_complete (&outline, &image, TRUE));
  for (gint c = 0; c < 4; c++)
    g_assert_cmpint (outline.saddle[c], ==, c == 2);
  polygon_picture_clear (&image);
}

/* What is no square: nothing, a triangle, a square with a side cut out, one of the other
 * colour, corners in the wrong places, and what lies outside the picture. */
static void
test_no_outline (void)
{
  for (gint k = 0; k < 6; k++) {
    ClothImage image = polygon_picture (SIZE, SIZE, WHITE);
    const gdouble tx[3] = { 60, 100, 100 }, ty[3] = { 60, 60, 100 };
    ClothOutline outline = { {60, 100, 100, 60}, {60, 60, 100, 100} };
    gboolean whole = TRUE;

    switch (k) {
      case 1:
        polygon_paint (&image, tx, ty, 3, BLACK);
        break;
      case 2:
        polygon_paint_box (&image, 60, 60, 100, 100, BLACK);
        polygon_paint_box (&image, 70, 90, 90, 140, WHITE);
        break;
      case 3:
        polygon_paint_box (&image, -1, -1, SIZE, SIZE, BLACK);
        polygon_paint_box (&image, 60, 60, 100, 100, WHITE);
        break;
      case 4:
        polygon_paint_box (&image, 30, 30, 140, 140, BLACK);
        break;
      case 5:
        polygon_paint_box (&image, 60, 60, 100, 100, BLACK);
        outline.x[1] = outline.x[2] = 1e6f;
        break;
      default:
        break;
    }
    for (gint c = 0; c < 4; c++)
      whole &= cloth_outline_fit (&outline, &image, c, outline.x[c],
          outline.y[c], 2, TRUE);
    g_assert_false (whole && cloth_outline_complete (&outline, &image, TRUE));
    polygon_picture_clear (&image);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/edge/contrast", test_contrast);
  g_test_add_func ("/edge/no-contrast", test_no_contrast);
  g_test_add_func ("/edge/square", test_square);
  g_test_add_func ("/outline/complete", test_outline);
  g_test_add_func ("/outline/saddle", test_saddle);
  g_test_add_func ("/outline/none", test_no_outline);
  return g_test_run ();
}
