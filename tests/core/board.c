/* Board finder: real boards against OpenCV's corners, boards half hidden, no boards.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/board.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/vision/corner/saddle.h"
#include "tests/common/picture.h"

/* A real picture of a board with the inner corners that OpenCV found. */
typedef struct
{
  gchar *name;
  TestPicture *picture;
  gint columns, rows;           /* of inner corners */
  gdouble *x, *y;
} Real;

static void
real_free (gpointer data)
{
  Real *real = data;

  g_free (real->name);
  if (real->picture)
    test_picture_free (real->picture);
  g_free (real->x);
  g_free (real->y);
  g_free (real);
}

/* Which of two ways of counting the corners is the board's own: square (1, 1) is black.
 * OpenCV doesn't look at colours. */
static void
orient (Real * real)
{
  const gint n = real->columns * real->rows, w = real->columns;
  const ClothImage *image = &real->picture->image;
  gdouble level[2] = { 0, 0 };

  for (gint k = 0; k < n - w; k++)
    if (k % w + 1 < w) {
      gdouble x = (real->x[k] + real->x[k + 1] + real->x[k + w]
          + real->x[k + w + 1]) / 4;
      gdouble y = (real->y[k] + real->y[k + 1] + real->y[k + w]
          + real->y[k + w + 1]) / 4;

      level[(k % w + k / w) & 1] +=
          image->data[(gint) lrint (y) * image->stride + (gint) lrint (x)];
    }
  if (level[0] < level[1])
    return;
  for (gint k = 0; k < n / 2; k++) {
    gdouble x = real->x[k], y = real->y[k];

    real->x[k] = real->x[n - 1 - k];
    real->y[k] = real->y[n - 1 - k];
    real->x[n - 1 - k] = x;
    real->y[n - 1 - k] = y;
  }
}

/* Lines "camera picture corner x y", all corners of a picture one after the other. */
static GPtrArray *
load_reals (const gchar * folder, gint columns, gint rows, gint every,
    gchar * (*name_of) (const gchar * camera, const gchar * picture))
{
  GPtrArray *reals = g_ptr_array_new_with_free_func (real_free);
  g_autofree gchar *path = g_build_filename (TEST_DATA, folder,
      "corners_cv2.txt", NULL);
  g_autofree gchar *text = NULL;
  g_auto (GStrv) lines = NULL;
  const gint n = columns * rows;
  guint n_lines;

  g_assert_true (g_file_get_contents (path, &text, NULL, NULL));
  lines = g_strsplit (g_strstrip (text), "\n", -1);
  n_lines = g_strv_length (lines);
  g_assert_cmpuint (n_lines, ==, 26 * n);
  for (guint line = 0; line < n_lines; line += (guint) (n * every)) {
    g_auto (GStrv) first = g_strsplit (lines[line], " ", 5);
    g_autofree gchar *name = name_of (first[0], first[1]);
    g_autofree gchar *file = g_build_filename (TEST_DATA, folder, name, NULL);
    Real *real = g_new0 (Real, 1);

    real->name = g_steal_pointer (&name);
    real->columns = columns;
    real->rows = rows;
    real->x = g_new (gdouble, n);
    real->y = g_new (gdouble, n);
    for (gint k = 0; k < n; k++) {
      g_auto (GStrv) part = g_strsplit (lines[line + (guint) k], " ", 5);

      g_assert_cmpstr (part[1], ==, first[1]);
      g_assert_cmpint (atoi (part[2]), ==, k);
      real->x[k] = g_ascii_strtod (part[3], NULL);
      real->y[k] = g_ascii_strtod (part[4], NULL);
    }
    real->picture = test_picture_load (file);
    orient (real);
    g_ptr_array_add (reals, real);
  }
  return reals;
}

static gchar *
opencv_name (const gchar * camera, const gchar * picture)
{
  static const gint number[] = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14 };

  return g_strdup_printf ("%s%02d.jpg", *camera == '0' ? "left" : "right",
      number[atoi (picture)]);
}

static gchar *
multidic_name (const gchar * camera, const gchar * picture)
{
  return g_strdup_printf ("board_%s_%s.jpg", camera, picture);
}

typedef struct
{
  ClothPattern *pattern;
  ClothSaddleDetector *detector;
  ClothBoardFinder *finder;
} Bench;

static void
bench_init (Bench * bench, gint columns, gint rows, gboolean first_black)
{
  bench->pattern = cloth_pattern_new_checker (columns, rows, 0.025, 0,
      first_black, NULL);
  bench->detector = cloth_saddle_detector_new ();
  bench->finder = cloth_board_finder_new (bench->pattern);
}

static void
bench_clear (Bench * bench)
{
  cloth_board_finder_free (bench->finder);
  cloth_saddle_detector_free (bench->detector);
  cloth_pattern_free (bench->pattern);
}

static const ClothBoardView *
bench_find (Bench * bench, const ClothImage * image)
{
  ClothSaddleParams params = cloth_saddle_default_params ();
  const ClothBoardView *view = NULL;
  const ClothSaddle *saddles;
  gboolean found;
  guint n;

  cloth_saddle_detector_run (bench->detector, &params, image, CLOTH_SIMD_BEST);
  saddles = cloth_saddle_detector_get_saddles (bench->detector, &n);
  found = cloth_board_finder_find (bench->finder, image, saddles, n, &view);
  g_assert_nonnull (view);
  g_assert_cmpint (view->columns, ==, bench->pattern->columns + 1);
  g_assert_cmpint (view->rows, ==, bench->pattern->rows + 1);
  g_assert_cmpint (found, ==, view->n_seen > 0);
  return view;
}

/* All inner corners of a whole board, each where OpenCV has it. */
static void
compare_whole (Bench * bench, GPtrArray * reals, gdouble limit,
    guint least_seen)
{
  gdouble worst = 0, sum = 0;
  guint n = 0;

  for (guint r = 0; r < reals->len; r++) {
    const Real *real = g_ptr_array_index (reals, r);
    const ClothBoardView *view = bench_find (bench, &real->picture->image);
    gdouble most = 0;

    for (gint k = 0; k < real->columns * real->rows; k++) {
      gint at = (k / real->columns + 1) * view->columns + k % real->columns + 1;
      gdouble d;

      if (view->seen[at] != CLOTH_VERTEX_SADDLE) {
        g_test_message ("%s: corner %d of %d not found", real->name, k,
            real->columns * real->rows);
        g_test_fail ();
        continue;
      }
      d = hypot (view->x[at] - real->x[k], view->y[at] - real->y[k]);
      most = MAX (most, d);
      sum += d * d;
      n++;
      g_assert_cmpfloat (view->cov[3 * at], >, 0);
      g_assert_cmpfloat (view->cov[3 * at + 2], >, 0);
    }
    if (most > limit || view->n_seen < least_seen)
      g_test_message ("%s: %u vertices, %.3f px from OpenCV's at most",
          real->name, view->n_seen, most);
    g_assert_cmpfloat (most, <=, limit);
    g_assert_cmpuint (view->n_seen, >=, least_seen);
    worst = MAX (worst, most);
  }
  g_test_message
      ("%u boards, %u inner corners: RMS %.3f px, at most %.3f px from "
      "OpenCV's", reals->len, n, sqrt (sum / n), worst);
}

static void
test_opencv (void)
{
  g_autoptr (GPtrArray) reals = load_reals ("opencv_boards", 9, 6, 1,
      opencv_name);
  Bench bench;

  g_assert_cmpuint (reals->len, ==, 26);
  bench_init (&bench, 10, 7, TRUE);
  compare_whole (&bench, reals, 0.5, 54);
  bench_clear (&bench);
}

/* The outermost corners of two white squares can't be seen on white paper. */
static void
test_multidic (void)
{
  g_autoptr (GPtrArray) reals = load_reals ("multidic", 14, 19, 1,
      multidic_name);
  Bench bench;

  g_assert_cmpuint (reals->len, ==, 26);
  bench_init (&bench, 15, 20, TRUE);
  compare_whole (&bench, reals, 0.5, 16 * 21 - 2);
  bench_clear (&bench);
}

/* Where discs are put, in shares of the field of inner corners. */
static const gdouble places[][2] = {
  {0.5, 0.5}, {0, 0.5}, {1, 0.5}, {0.5, 0}, {0.5, 1}, {0, 0}, {1, 0}, {0, 1},
  {1, 1}
};

typedef struct
{
  guint pictures, none, other;
  guint visible, found;
  guint wrong, stray;
} Tally;

/* The screen in some of the pictures shows boards too. */
static gboolean
is_other (const Real * real, const ClothBoardView * view)
{
  gdouble least = G_MAXDOUBLE;

  for (gint at = 0; at < view->columns * view->rows; at++)
    for (gint k = 0; view->seen[at] && k < real->columns * real->rows; k++)
      least = MIN (least, hypot (view->x[at] - real->x[k],
              view->y[at] - real->y[k]));
  return view->n_seen && least > 25;
}

/* Counts what was found with a disc over part of the board. A corner that is no nearer to
 * its true place than a quarter of a square is wrong. */
static void
tally_disc (const Real * real, const ClothBoardView * view, gdouble x,
    gdouble y, gdouble radius, Tally * tally)
{
  const gint w = real->columns;
  const gboolean other = is_other (real, view);
  guint found = 0;

  for (gint k = 0; k < w * real->rows; k++) {
    gint at = (k / w + 1) * view->columns + k % w + 1;
    gint beside = k % w ? k - 1 : k + 1, above = k >= w ? k - w : k + w;
    gdouble size = MIN (hypot (real->x[k] - real->x[beside],
            real->y[k] - real->y[beside]), hypot (real->x[k] - real->x[above],
            real->y[k] - real->y[above]));
    gdouble d = hypot (view->x[at] - real->x[k], view->y[at] - real->y[k]);
    gboolean visible = hypot (real->x[k] - x, real->y[k] - y) > radius + 4;

    tally->visible += visible;
    if (!view->seen[at] || other)
      continue;
    if (d > 0.25 * size)
      tally->wrong++;
    else if (visible && d > 1)
      tally->stray++;
    else if (visible)
      found++;
  }
  tally->found += found;
  tally->none += !view->n_seen;
  tally->other += other;
  tally->pictures++;
}

static void
board_place (const Real * real, gdouble s, gdouble t, gdouble * x, gdouble * y)
{
  const gint w = real->columns, n = w * real->rows;
  const gint corner[4] = { 0, w - 1, n - w, n - 1 };
  const gdouble share[4] = { (1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t
  };

  *x = *y = 0;
  for (gint k = 0; k < 4; k++) {
    *x += share[k] * real->x[corner[k]];
    *y += share[k] * real->y[corner[k]];
  }
}

/* px² of the board's squares, all of them whole. */
static gdouble
board_area (const Real * real)
{
  const gint w = real->columns, n = w * real->rows;
  const gint corner[4] = { 0, w - 1, n - 1, n - w };
  gdouble area = 0;

  for (gint k = 0; k < 4; k++) {
    gint a = corner[k], b = corner[(k + 1) & 3];

    area += 0.5 * (real->x[a] * real->y[b] - real->x[b] * real->y[a]);
  }
  return fabs (area) * (w + 1) * (real->rows + 1) / ((w - 1) * (real->rows -
          1));
}

static void
test_discs (void)
{
  static const gdouble shares[] = { 0.05, 0.1, 0.2, 0.3, 0.4 };
  static const gint greys[] = { 128, 255, -1 };
  static const gchar *const names[] = { "grey", "white", "noise" };
  g_autoptr (GPtrArray) reals = load_reals ("opencv_boards", 9, 6, 1,
      opencv_name);
  Tally all = { 0 };
  Bench bench;

  bench_init (&bench, 10, 7, TRUE);
  for (guint s = 0; s < G_N_ELEMENTS (shares); s++)
    for (guint g = 0; g < G_N_ELEMENTS (greys); g++) {
      Tally tally = { 0 };

      for (guint r = 0; r < reals->len; r++) {
        const Real *real = g_ptr_array_index (reals, r);
        gdouble radius = sqrt (shares[s] * board_area (real) / G_PI);

        for (guint p = 0; p < G_N_ELEMENTS (places); p++) {
          g_autoptr (TestPicture) picture = test_picture_copy (real->picture);
          const ClothBoardView *view;
          const Tally before = tally;
          gdouble x, y;

          board_place (real, places[p][0], places[p][1], &x, &y);
          test_picture_disc (picture, x, y, radius, greys[g], r);
          view = bench_find (&bench, &picture->image);
          tally_disc (real, view, x, y, radius, &tally);
          if (tally.wrong > before.wrong || tally.none > before.none) {
            g_autofree gchar *name = g_strdup_printf ("disc-%s-%.0f-%s-%u.pgm",
                real->name, 100 * shares[s], names[g], p);

            test_picture_keep (name, picture->data, picture->image.width,
                picture->image.height);
            g_test_message ("%s: %u wrong, %u seen", name,
                tally.wrong - before.wrong, view->n_seen);
          }
        }
      }
      g_test_message
          ("%2.0f%% %s: %.1f%% of the visible inner corners, %u wrong, "
          "%u stray, %u of %u pictures without, %u other", 100 * shares[s],
          names[g], 100.0 * tally.found / tally.visible, tally.wrong,
          tally.stray, tally.none, tally.pictures, tally.other);
      g_assert_cmpuint (tally.wrong, ==, 0);
      g_assert_cmpuint (100 * tally.found, >=, 70 * tally.visible);
      g_assert_cmpuint (tally.none, <, tally.pictures / 5);
      all.found += tally.found;
      all.visible += tally.visible;
      all.wrong += tally.wrong;
      all.stray += tally.stray;
      all.none += tally.none;
      all.other += tally.other;
      all.pictures += tally.pictures;
    }
  g_test_message
      ("all: %.2f%% of the visible inner corners, %u wrong, %u stray, "
      "%u of %u pictures without, %u with another board",
      100.0 * all.found / all.visible, all.wrong, all.stray, all.none,
      all.pictures, all.other);
  g_assert_cmpuint (100 * all.found, >=, 90 * all.visible);
  bench_clear (&bench);
}

/* A board of another size is none, nor is a piece of it. */
static void
test_other_size (void)
{
  static const gint sizes[][2] = { {9, 7}, {10, 6}, {10, 8}, {11, 7}, {8, 7},
  {12, 7}, {8, 10}
  };
  g_autoptr (GPtrArray) reals = load_reals ("opencv_boards", 9, 6, 1,
      opencv_name);
  guint found = 0;

  for (guint s = 0; s < G_N_ELEMENTS (sizes); s++)
    for (gint first_black = 0; first_black < 2; first_black++) {
      guint here = 0;
      Bench bench;

      bench_init (&bench, sizes[s][0], sizes[s][1], first_black);
      for (guint r = 0; r < reals->len; r++) {
        const Real *real = g_ptr_array_index (reals, r);
        const ClothBoardView *view = bench_find (&bench,
            &real->picture->image);

        /* The screen in some of the pictures shows boards too. */
        if (view->n_seen && !is_other (real, view)) {
          g_test_message ("%s: %u vertices of a board of %d by %d squares",
              real->name, view->n_seen, sizes[s][0], sizes[s][1]);
          here++;
        }
      }
      g_test_message ("%d by %d squares, the first %s: %u boards found",
          sizes[s][0], sizes[s][1], first_black ? "black" : "white", here);
      found += here;
      bench_clear (&bench);
    }
  g_assert_cmpuint (found, ==, 0);
}

/* How many corners of @real were found, each where the board @view is of has it: column
 * and row counted from the other end when @mirror_x and @mirror_y. */
static guint
count_right (const Real * real, const ClothBoardView * view, gboolean mirror_x,
    gboolean mirror_y)
{
  guint n = 0;

  for (gint k = 0; k < real->columns * real->rows; k++) {
    gint column = k % real->columns + 1, row = k / real->columns + 1, at;

    if (mirror_x)
      column = real->columns + 1 - column;
    if (mirror_y)
      row = real->rows + 1 - row;
    at = row * view->columns + column;
    n += view->seen[at] && hypot (view->x[at] - real->x[k],
        view->y[at] - real->y[k]) < 1;
  }
  return n;
}

/* The pictures turned upside down and mirrored, rows with bytes beyond their end, and the
 * board declared with its other corner first: the same corners. A mirror changes the
 * corners' sense, so a mirrored board's columns run the other way. */
static void
test_turned (void)
{
  g_autoptr (GPtrArray) reals = load_reals ("opencv_boards", 9, 6, 1,
      opencv_name);
  guint right[5] = { 0 };
  Bench bench, white_first;

  bench_init (&bench, 10, 7, TRUE);
  bench_init (&white_first, 10, 7, FALSE);
  for (guint r = 0; r < reals->len; r++) {
    Real *real = g_ptr_array_index (reals, r);
    const gint width = real->picture->image.width;
    const gint height = real->picture->image.height, stride = width + 37;
    const gint n = real->columns * real->rows;
    g_autofree guint8 *padded = g_malloc (stride * height);
    g_autoptr (TestPicture) turned = test_picture_copy (real->picture);
    g_autoptr (TestPicture) mirrored = test_picture_copy (real->picture);
    g_autofree gdouble *x = g_memdup2 (real->x, sizeof (gdouble) * n);
    g_autofree gdouble *y = g_memdup2 (real->y, sizeof (gdouble) * n);
    Real moved = *real;
    ClothImage image = { padded, width, height, stride };

    memset (padded, 255 * (r & 1), stride * height);
    for (gint row = 0; row < height; row++)
      for (gint column = 0; column < width; column++) {
        guint8 level = real->picture->data[row * width + column];

        padded[row * stride + column] = level;
        turned->data[(height - 1 - row) * width + width - 1 - column] = level;
        mirrored->data[row * width + width - 1 - column] = level;
      }
    right[0] += count_right (real, bench_find (&bench, &image), FALSE, FALSE);
    /* Its white corner square is the board's last one. */
    right[1] += count_right (real, bench_find (&white_first,
            &real->picture->image), TRUE, TRUE);
    moved.x = x;
    moved.y = y;
    for (gint k = 0; k < n; k++) {
      x[k] = width - 1 - real->x[k];
      y[k] = height - 1 - real->y[k];
    }
    right[2] += count_right (&moved, bench_find (&bench, &turned->image), FALSE,
        FALSE);
    /* A mirrored board is a board whose rows are counted from the other end, and with an
     * odd number of them its first square is black again. */
    for (gint k = 0; k < n; k++)
      y[k] = real->y[k];
    right[3] += count_right (&moved, bench_find (&bench, &mirrored->image),
        FALSE, TRUE);
    right[4] += (guint) n;
  }
  g_test_message ("of %u corners: padded rows %u, white first %u, upside down "
      "%u, mirrored %u", right[4], right[0], right[1], right[2], right[3]);
  for (guint k = 0; k < 4; k++)
    g_assert_cmpuint (right[k], ==, right[4]);
  bench_clear (&bench);
  bench_clear (&white_first);
}

/* Nothing is found where no board is: in what surrounds the boards, in noise, in stripes,
 * and in pictures too small to hold one. */
static void
test_none (void)
{
  g_autoptr (GPtrArray) reals = load_reals ("opencv_boards", 9, 6, 1,
      opencv_name);
  ClothRandom random;
  guint found = 0;
  Bench bench;

  bench_init (&bench, 10, 7, TRUE);
  cloth_random_init (&random, 5);
  for (gint height = 1; height <= 8; height++)
    for (gint width = 1; width <= 8; width++) {
      guint8 pixels[64];
      ClothImage image = { pixels, width, height, width };

      for (gint k = 0; k < 64; k++)
        pixels[k] = (guint8) (255 * (((k % width) + k / width) & 1));
      found += bench_find (&bench, &image)->n_seen > 0;
    }
  for (guint n = 0; n < 24; n++) {
    const gint grain = 1 + (gint) n % 12;
    g_autoptr (TestPicture) picture = test_picture_new (640, 480, 128);

    for (gint y = 0; y < 480; y++)
      for (gint x = 0; x < 640; x++) {
        guint8 *at = &picture->data[y * 640 + x];

        if (n < 12)
          *at = (guint8) (255 * (x / (2 * grain) & 1));
        else if (x % grain == 0 && y % grain == 0)
          *at = (guint8) cloth_random_below (&random, 256);
        else
          *at = picture->data[(y - y % grain) * 640 + x - x % grain];
      }
    found += bench_find (&bench, &picture->image)->n_seen > 0;
  }
  g_assert_cmpuint (found, ==, 0);
  for (guint r = 0; r < reals->len; r++) {
    const Real *real = g_ptr_array_index (reals, r);
    g_autoptr (TestPicture) picture = test_picture_copy (real->picture);
    const ClothBoardView *view;
    gdouble x, y;

    /* All of the board covered. */
    board_place (real, 0.5, 0.5, &x, &y);
    test_picture_disc (picture, x, y, sqrt (board_area (real)), 128, r);
    view = bench_find (&bench, &picture->image);
    if (view->n_seen)
      g_test_message ("%s: %u vertices beside the board", real->name,
          view->n_seen);
    found += view->n_seen > 0;
  }
  g_assert_cmpuint (found, ==, 0);
  bench_clear (&bench);
}

int
main (int argc, char *argv[])
{
  g_test_init (&argc, &argv, NULL);
  test_picture_init (&argc, &argv);
  g_test_add_func ("/board/opencv", test_opencv);
  g_test_add_func ("/board/multidic", test_multidic);
  g_test_add_func ("/board/other-size", test_other_size);
  g_test_add_func ("/board/turned", test_turned);
  g_test_add_func ("/board/none", test_none);
  g_test_add_func ("/board/discs", test_discs);
  return g_test_run ();
}
