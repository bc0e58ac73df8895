/* Coded checkerboards: the code's distance, checked pair by pair.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/code.h"

#include <math.h>
#include <string.h>

static ClothPattern *
coded (gint columns, gint rows, guint64 seed, gint * window)
{
  g_autoptr (GError) error = NULL;
  ClothPattern *pattern =
      cloth_pattern_new_checker (columns, rows, 0.01, 0, TRUE, &error);

  g_assert_no_error (error);
  cloth_code_generate (pattern, CLOTH_CODE_DOT_RATIO, seed, window, &error);
  g_assert_no_error (error);
  return pattern;
}

/* Own code, on purpose unlike the generator's: cuts the window out as a picture of
 * characters (b, w plain; B, W with a dot), turns the picture, and compares pictures
 * that have equal colours. */
typedef struct
{
  gchar cell[36];
} Picture;

static Picture
turn_picture (const Picture * picture, gint k)
{
  Picture turned;

  for (gint y = 0; y < k; y++)
    for (gint x = 0; x < k; x++)
      turned.cell[x * k + (k - 1 - y)] = picture->cell[y * k + x];
  return turned;
}

static gint
least_distance (const ClothPattern * pattern, gint k)
{
  const gint across = pattern->columns - k + 1, down = pattern->rows - k + 1;
  const gint n = across * down * 4;
  g_autofree guint64 *dots = g_new (guint64, n);
  g_autofree guint8 *starts_black = g_new (guint8, n);
  gint least = G_MAXINT, m = 0;

  for (gint r = 0; r < down; r++) {
    for (gint c = 0; c < across; c++) {
      Picture picture;

      for (gint y = 0; y < k; y++) {
        for (gint x = 0; x < k; x++) {
          gchar cell =
              cloth_pattern_is_black (pattern, c + x, r + y) ? 'b' : 'w';

          picture.cell[y * k + x] = cloth_pattern_has_dot (pattern, c + x,
              r + y) ? g_ascii_toupper (cell) : cell;
        }
      }
      for (gint q = 0; q < 4; q++, m++) {
        dots[m] = 0;
        for (gint i = 0; i < k * k; i++) {
          if (g_ascii_isupper (picture.cell[i]))
            dots[m] |= G_GUINT64_CONSTANT (1) << i;
          /* A checkerboard whichever way it is turned. */
          g_assert_true ((g_ascii_tolower (picture.cell[i]) ==
                  g_ascii_tolower (picture.cell[0])) ==
              ((i % k + i / k) % 2 == 0));
        }
        starts_black[m] = g_ascii_tolower (picture.cell[0]) == 'b';
        picture = turn_picture (&picture, k);
      }
    }
  }
  for (gint a = 0; a < n; a++) {
    for (gint b = a + 1; b < n; b++) {
      if (starts_black[a] == starts_black[b]) {
        gint distance = __builtin_popcountll (dots[a] ^ dots[b]);

        least = MIN (least, distance);
      }
    }
  }
  return least;
}

static void
test_distance (void)
{
  const struct
  {
    gint columns, rows, most;
  } cases[] = {
    {4, 4, 4}, {8, 8, 4}, {5, 12, 4}, {14, 14, 4}, {24, 16, 5}, {60, 60, 5},
    {100, 100, 5}
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    gint window, least;
    g_autoptr (ClothPattern) pattern =
        coded (cases[i].columns, cases[i].rows, 1, &window);

    least = least_distance (pattern, window);
    g_test_message ("%d by %d squares: window %d, least distance %d",
        cases[i].columns, cases[i].rows, window, least);
    g_assert_cmpint (least, >=, CLOTH_CODE_DISTANCE);
    g_assert_cmpint (window, <=, cases[i].most);
  }
}

static void
test_checker_sees_faults (void)
{
  gint window;
  g_autoptr (ClothPattern) pattern = coded (20, 20, 3, &window);

  /* Two squares away in each direction the colours are the same. */
  for (gint y = window - 1; y >= 0; y--)
    memcpy (pattern->code + (y + 6) * pattern->columns + 8,
        pattern->code + y * pattern->columns, (gsize) window);
  g_assert_cmpint (least_distance (pattern, window), ==, 0);
}

static void
test_deterministic (void)
{
  gint window;
  g_autoptr (ClothPattern) a = coded (30, 30, 7, &window);
  g_autoptr (ClothPattern) b = coded (30, 30, 7, &window);
  g_autoptr (ClothPattern) c = coded (30, 30, 8, &window);

  g_assert_cmpmem (a->code, 900, b->code, 900);
  g_assert_cmpint (memcmp (a->code, c->code, 900), !=, 0);
}

static void
test_refused (void)
{
  const struct
  {
    gint columns, rows;
    gdouble ratio;
  } cases[] = { {3, 8, 0.3}, {8, 3, 0.3}, {1, 1, 0.3}, {8, 8, 0},
  {8, 8, 1}, {8, 8, -0.3}, {8, 8, NAN}
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothPattern) pattern =
        cloth_pattern_new_checker (cases[i].columns, cases[i].rows, 0.01, 0,
        TRUE, NULL);

    g_assert_false (cloth_code_generate (pattern, cases[i].ratio, 1, NULL,
            &error));
    g_assert_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE);
    g_assert_null (pattern->code);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/code/distance", test_distance);
  g_test_add_func ("/code/checker-sees-faults", test_checker_sees_faults);
  g_test_add_func ("/code/deterministic", test_deterministic);
  g_test_add_func ("/code/refused", test_refused);
  return g_test_run ();
}
