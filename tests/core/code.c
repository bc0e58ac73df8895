/* Coded checkerboards: the code's distance, checked pair by pair, and the placing of
 * patches, noisy, turned and hanging over the edge.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/random.h"
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
  {
    g_autoptr (ClothPattern) plain =
        cloth_pattern_new_checker (8, 8, 0.01, 0, TRUE, NULL);

    g_assert_null (cloth_code_locator_new (plain));
  }
}

/* The patch as a camera would see it: square (i, j) is at anchor + R^q (i, j), the
 * rotation built from its angle. Some squares off the board are seen where there is
 * nothing. */
static void
observe (const ClothPattern * pattern, gint column, gint row, gint q,
    gint columns, gint rows, gdouble wrong, gdouble unknown, gdouble outside,
    ClothRandom * random, gfloat * llr)
{
  const gint cosine = (gint) lround (cos (q * G_PI_2));
  const gint sine = (gint) lround (sin (q * G_PI_2));

  for (gint j = 0; j < rows; j++) {
    for (gint i = 0; i < columns; i++) {
      gint x = column + cosine * i - sine * j, y = row + sine * i + cosine * j;
      gboolean dot;

      llr[j * columns + i] = 0;
      if (x < 0 || y < 0 || x >= pattern->columns || y >= pattern->rows) {
        if (cloth_random_uniform (random) >= outside)
          continue;
        dot = cloth_random_below (random, 2);
      } else {
        dot = cloth_pattern_has_dot (pattern, x, y);
      }
      if (cloth_random_uniform (random) < unknown)
        continue;
      if (cloth_random_uniform (random) < wrong)
        dot = !dot;
      llr[j * columns + i] = dot ? 4 : -4;
    }
  }
}

static gboolean
black_at (const ClothPattern * pattern, gint column, gint row)
{
  return (((column + row) % 2 + 2) % 2 == 0) == pattern->first_black;
}

static void
test_locate_every_window (void)
{
  gint window;
  g_autoptr (ClothPattern) pattern = coded (20, 17, 5, &window);
  g_autoptr (ClothCodeLocator) locator = cloth_code_locator_new (pattern);
  ClothRandom random;
  gint n = 0;

  cloth_random_init (&random, 1);
  for (gint q = 0; q < 4; q++) {
    for (gint row = 0; row < pattern->rows; row++) {
      for (gint column = 0; column < pattern->columns; column++) {
        gfloat llr[36];
        ClothCodePlacement best, second, truth = { column, row, q, 0 };
        gint x, y;

        cloth_code_square (&truth, window - 1, window - 1, &x, &y);
        if (x < 0 || y < 0 || x >= pattern->columns || y >= pattern->rows)
          continue;
        observe (pattern, column, row, q, window, window, 0, 0, 0, &random,
            llr);
        /* One dot of the window misread. */
        llr[n % (window * window)] *= -1;
        g_assert_true (cloth_code_locate (locator, llr, window, window,
                black_at (pattern, column, row), &best, &second));
        g_assert_cmpint (best.column, ==, column);
        g_assert_cmpint (best.row, ==, row);
        g_assert_cmpint (best.rotation, ==, q);
        /* Distance 3 less one misread on each side: one dot of 4 nats at least. */
        g_assert_cmpfloat (best.score - second.score, >=, 4);
        g_assert_cmpfloat (best.score, ==, 2.0 * (window * window - 2));
        n++;
      }
    }
  }
  g_test_message ("%d windows of %d by %d placed with one dot misread", n,
      window, window);
}

static void
test_locate_noisy (void)
{
  gint window;
  g_autoptr (ClothPattern) pattern = coded (60, 60, 2, &window);
  g_autoptr (ClothCodeLocator) locator = cloth_code_locator_new (pattern);
  ClothRandom random;
  gint over = 0;

  pattern->first_black = FALSE;
  g_clear_pointer (&locator, cloth_code_locator_free);
  locator = cloth_code_locator_new (pattern);
  cloth_random_init (&random, 9);
  for (gint n = 0; n < 300; n++) {
    const gint columns = 9 + (gint) cloth_random_below (&random, 12);
    const gint rows = 9 + (gint) cloth_random_below (&random, 12);
    const gint q = (gint) cloth_random_below (&random, 4);
    const gint column = (gint) cloth_random_below (&random, 60);
    const gint row = (gint) cloth_random_below (&random, 60);
    g_autofree gfloat *llr = g_new (gfloat, columns * rows);
    ClothCodePlacement best, second, truth = { column, row, q, 0 };
    gint x, y, i, j;

    /* At least half of it on the board. */
    cloth_code_square (&truth, columns / 2, rows / 2, &x, &y);
    if (x < 0 || y < 0 || x >= 60 || y >= 60)
      continue;
    cloth_code_square (&truth, columns - 1, rows - 1, &i, &j);
    over += i < 0 || j < 0 || i >= 60 || j >= 60;
    observe (pattern, column, row, q, columns, rows, 0.1, 0.2, 0.1,
        &random, llr);
    g_assert_true (cloth_code_locate (locator, llr, columns, rows,
            black_at (pattern, column, row), &best, &second));
    g_assert_cmpint (best.column, ==, column);
    g_assert_cmpint (best.row, ==, row);
    g_assert_cmpint (best.rotation, ==, q);
  }
  g_test_message ("%d of 300 patches hung over the edge", over);
}

static void
test_vertices (void)
{
  /* The four corners of a square stay its corners, whichever way it is turned. */
  for (gint q = 0; q < 4; q++) {
    const ClothCodePlacement placement = { 10, 20, q, 0 };

    for (gint n = 0; n < 25; n++) {
      const gint i = n % 5, j = n / 5;
      gint column, row, x, y, x_sum = 0, y_sum = 0;

      cloth_code_square (&placement, i, j, &column, &row);
      for (gint corner = 0; corner < 4; corner++) {
        cloth_code_vertex (&placement, i + corner % 2, j + corner / 2, &x, &y);
        g_assert_cmpint (ABS (2 * x - 2 * column - 1), ==, 1);
        g_assert_cmpint (ABS (2 * y - 2 * row - 1), ==, 1);
        x_sum += x;
        y_sum += y;
      }
      g_assert_cmpint (x_sum, ==, 4 * column + 2);
      g_assert_cmpint (y_sum, ==, 4 * row + 2);
    }
  }
}

static void
test_locate_odd_input (void)
{
  gint window;
  g_autoptr (ClothPattern) pattern = coded (12, 12, 5, &window);
  g_autoptr (ClothCodeLocator) locator = cloth_code_locator_new (pattern);
  g_autofree gfloat *large = g_new0 (gfloat, 500 * 500);
  gfloat llr[16] = { 0 };
  ClothCodePlacement best, second;

  /* Nothing known. */
  g_assert_false (cloth_code_locate (locator, llr, 4, 4, TRUE, &best, &second));
  for (gint i = 0; i < 16; i++)
    llr[i] = NAN;
  g_assert_false (cloth_code_locate (locator, llr, 4, 4, TRUE, &best, &second));
  /* One dot says nothing of its place: the margin is 0. */
  llr[5] = INFINITY;
  g_assert_true (cloth_code_locate (locator, llr, 4, 4, TRUE, &best, &second));
  g_assert_cmpfloat (best.score, ==, 8);
  g_assert_cmpfloat (second.score, ==, 8);
  /* A patch larger than the board, in whose midst the board lies, turned once. */
  for (gint row = 0; row < 12; row++) {
    for (gint column = 0; column < 12; column++)
      large[(200 + 11 - column) * 500 + 100 + row] =
          cloth_pattern_has_dot (pattern, column, row) ? 100 : -100;
  }
  g_assert_true (cloth_code_locate (locator, large, 500, 500,
          black_at (pattern, 11 + 200, -100), &best, &second));
  g_assert_cmpint (best.rotation, ==, 1);
  g_assert_cmpint (best.column, ==, 11 + 200);
  g_assert_cmpint (best.row, ==, -100);
  g_assert_cmpfloat (best.score, ==, 144 * 8);
  /* The other colours are another board. */
  g_assert_true (cloth_code_locate (locator, large, 500, 500,
          !black_at (pattern, 11 + 200, -100), &best, &second));
  g_assert_cmpfloat (best.score, <, 144 * 4);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/code/distance", test_distance);
  g_test_add_func ("/code/checker-sees-faults", test_checker_sees_faults);
  g_test_add_func ("/code/deterministic", test_deterministic);
  g_test_add_func ("/code/refused", test_refused);
  g_test_add_func ("/code/locate-every-window", test_locate_every_window);
  g_test_add_func ("/code/locate-noisy", test_locate_noisy);
  g_test_add_func ("/code/vertices", test_vertices);
  g_test_add_func ("/code/locate-odd-input", test_locate_odd_input);
  return g_test_run ();
}
