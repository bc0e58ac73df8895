/* Where on the board a patch lies: every window of coded and plain boards in every turn,
 * with what the patch would hold written down from the pattern.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/pattern/code.h"
#include "tests/common/brutepose.h"

#define M CLOTH_PATCH_MARGIN
#define MOST 24
/* Log-likelihood ratio of a dot read, and of cloth seen beyond the rim. */
#define BIT 4
#define BEYOND -3
/* Both ways to place a patch: in a film and in a single picture. */
static gboolean
run (gboolean single, const ClothPattern * pattern, const ClothPatch * patch,
    const ClothPose * votes, guint n_votes, ClothPose * best)
{
  g_autoptr (ClothPoseFinder) pose_finder = cloth_pose_finder_new (pattern);

  return cloth_pose_finder_run (pose_finder, patch,
      single ? &cloth_pose_rigid : &cloth_pose_cloth, votes, n_votes, best);
}

/* A patch with room for what tests need. */
typedef struct
{
  ClothPatch patch;
  guint8 kind[MOST * MOST], linked[MOST * MOST], square[MOST * MOST];
  gfloat x[MOST * MOST], y[MOST * MOST], cov[3 * MOST * MOST];
  gfloat confidence[MOST * MOST], inside[MOST * MOST], bit[MOST * MOST];
} Window;

/* Vertex (@i, @j) turned @rotation times by (i, j) → (−j, i). */
static void
turn (gint rotation, gint i, gint j, gint * column, gint * row)
{
  for (gint k = 0; k < rotation; k++) {
    gint old = i;

    i = -j;
    j = old;
  }
  *column = i;
  *row = j;
}

/* The patch that shows the board's squares (@left, @top) to +(@width, @height), the board
 * upright in the picture, its own grid turned; @truth is where it lies. */
static void
fill (Window * window, const ClothPattern * pattern, gint left, gint top,
    gint width, gint height, gint rotation, ClothPose * truth)
{
  gint across = rotation & 1 ? height : width;
  gint down = rotation & 1 ? width : height;
  gint columns = across + 1 + 2 * M, rows = down + 1 + 2 * M;
  gint low_c = G_MAXINT, low_r = G_MAXINT;
  ClothPatch *patch = &window->patch;

  memset (window, 0, sizeof *window);
  g_assert_cmpint (columns * rows, <=, MOST * MOST);
  for (gint k = 0; k < 4; k++) {
    gint c, r;

    turn (rotation, M + (k & 1) * across, M + (k >> 1) * down, &c, &r);
    low_c = MIN (low_c, c);
    low_r = MIN (low_r, r);
  }
  *truth = (ClothPose) {
  rotation, left - low_c, top - low_r, 0};
  patch->columns = columns;
  patch->rows = rows;
  patch->kind = window->kind;
  patch->x = window->x;
  patch->y = window->y;
  patch->cov = window->cov;
  patch->linked = window->linked;
  patch->square = window->square;
  patch->confidence = window->confidence;
  patch->inside = window->inside;
  patch->bit = window->bit;
  for (gint j = 0; j < rows; j++)
    for (gint i = 0; i < columns; i++) {
      gint at = j * columns + i, c, r, c1, r1, column, row;

      turn (rotation, i, j, &c, &r);
      c += truth->column;
      r += truth->row;
      window->x[at] = (gfloat) (100 + 20 * c);
      window->y[at] = (gfloat) (100 + 20 * r);
      if (c >= left && r >= top && c <= left + width && r <= top + height) {
        gboolean inner = c > 0 && r > 0 && c < pattern->columns
            && r < pattern->rows;

        window->kind[at] = inner ? CLOTH_VERTEX_SADDLE : CLOTH_VERTEX_RIM;
        window->linked[at] = inner;
      }
      if (i + 1 == columns || j + 1 == rows)
        continue;
      turn (rotation, i + 1, j + 1, &c1, &r1);
      column = MIN (c, c1 + truth->column);
      row = MIN (r, r1 + truth->row);
      if (column >= left && row >= top && column < left + width
          && row < top + height) {
        window->square[at] = 1;
        patch->n_squares++;
        patch->odd_black = ((i + j) & 1)
            == (cloth_pattern_is_black (pattern, column, row) ? 1 : 0);
        if (pattern->code)
          window->bit[at] =
              cloth_pattern_has_dot (pattern, column, row) ? BIT : -BIT;
      } else if ((column < 0 || row < 0 || column >= pattern->columns
              || row >= pattern->rows) && column >= left - 1 && row >= top - 1
          && column <= left + width && row <= top + height) {
        window->inside[at] = BEYOND;
      }
    }
}

static gboolean
equal (const ClothPose * a, const ClothPose * b)
{
  return a->rotation == b->rotation && a->column == b->column
      && a->row == b->row;
}

/* Every window of the code's own size in every turn has one place, also with a dot read
 * wrongly; every single square has none. */
static void
test_coded (void)
{
  g_autoptr (ClothPattern) pattern = cloth_pattern_new_checker (11, 9, 0.01, 0,
      TRUE, NULL);
  g_autofree Window *window = g_new (Window, 1);
  gfloat least = G_MAXFLOAT, least_misread = G_MAXFLOAT;
  guint n = 0;
  gint size;

  g_assert_true (cloth_code_generate (pattern, CLOTH_CODE_DOT_RATIO, 3, &size,
          NULL));
  for (gint single = 0; single < 2; single++)
    for (gint rotation = 0; rotation < 4; rotation++) {
      for (gint top = 0; top + size <= pattern->rows; top++)
        for (gint left = 0; left + size <= pattern->columns; left++) {
          ClothPose truth, best;
          gint middle;

          fill (window, pattern, left, top, size, size, rotation, &truth);
          g_assert_true (run (single, pattern, &window->patch, NULL, 0, &best));
          g_assert_true (equal (&best, &truth));
          least = MIN (least, best.weight);
          middle = (M + size / 2) * (window->patch.columns + 1);
          window->bit[middle] = -window->bit[middle];
          g_assert_true (run (single, pattern, &window->patch, NULL, 0, &best));
          g_assert_true (equal (&best, &truth));
          least_misread = MIN (least_misread, best.weight);
          n++;
        }
      for (gint k = 0; k < pattern->columns * pattern->rows; k++) {
        ClothPose truth, best;

        fill (window, pattern, k % pattern->columns, k / pattern->columns, 1, 1,
            rotation, &truth);
        memset (window->inside, 0, sizeof window->inside);
        g_assert_true (run (single, pattern, &window->patch, NULL, 0, &best));
        g_assert_cmpfloat (best.weight, <, CLOTH_POSE_MIN_LEAD);
      }
    }
  g_test_message ("%u windows of %d squares: least lead %g, with one dot "
      "misread %g", n, size, least, least_misread);
  /* A code's distance is that many dots, each worth twice its ratio. */
  g_assert_cmpfloat (least, >=, 2 * BIT * CLOTH_CODE_DISTANCE);
  g_assert_cmpfloat (least_misread, >=, 2 * BIT * (CLOTH_CODE_DISTANCE - 2));
}

/* A plain board's windows away from the rim could be anywhere: next to no lead. Its own
 * corners, and the board as a whole, have a place when the sum of its sides is odd. */
static void
test_plain (void)
{
  static const gint sizes[][2] = { {10, 7}, {7, 10}, {9, 4} };
  g_autofree Window *window = g_new (Window, 1);

  for (guint s = 0; s < G_N_ELEMENTS (sizes); s++) {
    g_autoptr (ClothPattern) pattern =
        cloth_pattern_new_checker (sizes[s][0], sizes[s][1], 0.01, 0, s & 1,
        NULL);
    gint columns = pattern->columns, rows = pattern->rows;

    for (gint single = 0; single < 2; single++)
      for (gint rotation = 0; rotation < 4; rotation++) {
        ClothPose truth, best;

        for (gint k = 0; k < columns * rows; k++) {
          gint left = k % columns, top = k / columns;

          if (left < 1 || top < 1 || left + 2 > columns - 1
              || top + 2 > rows - 1)
            continue;
          fill (window, pattern, left, top, 2, 2, rotation, &truth);
          g_assert_true (run (single, pattern, &window->patch, NULL, 0, &best));
          g_assert_cmpfloat (best.weight, >=, 0);
          g_assert_cmpfloat (best.weight, <, 0.01f);
        }
        fill (window, pattern, 0, 0, columns, rows, rotation, &truth);
        g_assert_true (run (single, pattern, &window->patch, NULL, 0, &best));
        g_assert_true (equal (&best, &truth));
        g_assert_cmpfloat (best.weight, >, CLOTH_POSE_MIN_LEAD);
        /* Half of the board with three of its sides. */
        for (gint side = 0; side < 2; side++) {
          fill (window, pattern, side * (columns - columns / 2), 0, columns / 2,
              rows, rotation, &truth);
          g_assert_true (run (single, pattern, &window->patch, NULL, 0, &best));
          g_assert_true (equal (&best, &truth));
          g_assert_cmpfloat (best.weight, >, CLOTH_POSE_MIN_LEAD);
        }
      }
  }
}

/* What is remembered decides where the picture doesn't, and not where it does. */
static void
test_votes (void)
{
  g_autoptr (ClothPattern) pattern = cloth_pattern_new_checker (10, 7, 0.01, 0,
      TRUE, NULL);
  g_autofree Window *window = g_new (Window, 1);

  for (gint single = 0; single < 2; single++) {
    ClothPose truth, vote, best;

    fill (window, pattern, 3, 2, 3, 3, 1, &truth);
    vote = truth;
    vote.weight = 10;
    g_assert_true (run (single, pattern, &window->patch, &vote, 1, &best));
    g_assert_true (equal (&best, &truth));
    g_assert_cmpfloat (best.weight, >, CLOTH_POSE_MIN_LEAD);
    /* Nothing lies on a square of the other colour. */
    vote.column++;
    vote.weight = 1000;
    g_assert_true (run (single, pattern, &window->patch, &vote, 1, &best));
    g_assert_false (equal (&best, &vote));
    fill (window, pattern, 0, 0, 10, 7, 1, &truth);
    vote = truth;
    vote.column += 2;
    vote.weight = 14;
    g_assert_true (run (single, pattern, &window->patch, &vote, 1, &best));
    g_assert_true (equal (&best, &truth));
  }
}

/* Nothing seen, and more squares than the board has. */
static void
test_refused (void)
{
  g_autoptr (ClothPattern) large = cloth_pattern_new_checker (15, 15, 0.01, 0,
      TRUE, NULL);
  g_autoptr (ClothPattern) small = cloth_pattern_new_checker (5, 4, 0.01, 0,
      TRUE, NULL);
  g_autofree Window *window = g_new (Window, 1);

  for (gint single = 0; single < 2; single++) {
    ClothPose truth, best;

    fill (window, large, 0, 0, 15, 15, 0, &truth);
    g_assert_false (run (single, small, &window->patch, NULL, 0, &best));
    memset (window->square, 0, sizeof window->square);
    window->patch.n_squares = 0;
    g_assert_false (run (single, large, &window->patch, NULL, 0, &best));
  }
}

/* A patch of a board's part, turned, with holes, misread dots, squares that aren't there
 * and cells that show cloth, all at random. Its corners lie nowhere, so nothing is
 * upright. */
static ClothPatch *
random_patch (const ClothPattern * pattern, ClothRandom * random,
    ClothPose * truth)
{
  const gint columns = 2 + (gint) cloth_random_below (random, 24);
  const gint rows = 2 + (gint) cloth_random_below (random, 24);
  ClothPatch *patch = test_patch_new (columns + 4, rows + 4);
  const gint rotation = (gint) cloth_random_below (random, 4);
  gint column, row;

  *truth = (ClothPose) {
  rotation, 0, 0, 0};
  cloth_pose_cell (truth, columns / 2, rows / 2, &column, &row);
  truth->column = (gint) cloth_random_below (random,
      (guint32) pattern->columns) - column;
  truth->row = (gint) cloth_random_below (random,
      (guint32) pattern->rows) - row;
  cloth_pose_cell (truth, 0, 0, &column, &row);
  patch->odd_black = !cloth_pattern_is_black (pattern, column & 1, row & 1);
  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < patch->columns; i++) {
      const gint at = j * patch->columns + i;
      const gdouble chance = cloth_random_uniform (random);
      gboolean on;

      cloth_pose_cell (truth, i, j, &column, &row);
      on = column >= 0 && row >= 0 && column < pattern->columns
          && row < pattern->rows;
      patch->square[at] = on ? chance > 0.15 : chance > 0.998;
      patch->kind[at] = (guint8) cloth_random_below (random, 4);
      patch->linked[at] = patch->kind[at] == CLOTH_VERTEX_SADDLE
          && chance > 0.4;
      if (!patch->square[at] && chance < 0.1)
        patch->inside[at] = -3;
      /* Whole steps of what is summed. */
      if (patch->square[at] && pattern->code)
        patch->bit[at] = (gfloat) (on && cloth_random_uniform (random) > 0.15
            && !cloth_pattern_has_dot (pattern, column, row) ? -1 : 1)
            * (gfloat) cloth_random_below (random, 193) / 64;
    }
  return patch;
}

/* The same as by looking at every square under every pose: place and lead. */
static void
test_brute (void)
{
  static const gint sizes[][2] =
      { {8, 8}, {11, 6}, {30, 24}, {4, 25}, {26, 26} };
  ClothPoseWeights weights[2] = { cloth_pose_cloth, cloth_pose_rigid };
  guint n = 0, placed = 0, coded = 0;
  ClothRandom random;

  weights[1].least = -G_MAXFLOAT;
  weights[1].rim_refuses = 1;
  /* Twins are rivals to the brute force. */
  weights[1].twins = FALSE;
  cloth_random_init (&random, 11);
  for (guint s = 0; s < 2 * G_N_ELEMENTS (sizes); s++) {
    g_autoptr (ClothPattern) pattern =
        cloth_pattern_new_checker (sizes[s / 2][0], sizes[s / 2][1], 0.01, 0,
        s & 1, NULL);
    g_autoptr (ClothPoseFinder) pose_finder = NULL;

    if (s & 1)
      g_assert_true (cloth_code_generate (pattern, CLOTH_CODE_DOT_RATIO, s,
              NULL, NULL));
    pose_finder = cloth_pose_finder_new (pattern);
    for (guint k = 0; k < 60; k++) {
      ClothPose best = { 0 }, brute = { 0 }, votes[3];
      g_autoptr (ClothPatch) patch = random_patch (pattern, &random, &votes[0]);
      const guint n_votes = cloth_random_below (&random, 4);
      gboolean fits;

      votes[0].weight = 14;
      votes[1] = votes[2] = votes[0];
      votes[1].column++;
      votes[2].rotation ^= 2;
      fits = test_brute_place (pattern, patch, &weights[k & 1], votes, n_votes,
          &brute);
      g_assert_cmpint (cloth_pose_finder_run (pose_finder, patch,
              &weights[k & 1], votes, n_votes, &best), ==, fits);
      if (!fits)
        continue;
      n++;
      /* Of equals either may be first. */
      if (brute.weight > 0)
        g_assert_true (equal (&best, &brute));
      g_assert_cmpfloat_with_epsilon (best.weight, brute.weight, 1e-3);
      placed += equal (&best, &votes[0]);
      coded += (s & 1) && equal (&best, &votes[0]);
    }
  }
  g_test_message ("%u patches, of which %u in their true place, %u by dots", n,
      placed, coded);
  g_assert_cmpuint (coded, >, 100);
}

/* Cells and vertices under a pose agree: a cell's vertices are its own. */
static void
test_mapping (void)
{
  for (gint rotation = 0; rotation < 4; rotation++) {
    const ClothPose pose = { rotation, 5, -3, 0 };

    for (gint j = -2; j < 3; j++)
      for (gint i = -2; i < 3; i++) {
        gint c, r, c1, r1, column, row;

        cloth_pose_vertex (&pose, i, j, &column, &row);
        turn (rotation, i, j, &c, &r);
        g_assert_cmpint (column, ==, c + 5);
        g_assert_cmpint (row, ==, r - 3);
        turn (rotation, i + 1, j + 1, &c1, &r1);
        cloth_pose_cell (&pose, i, j, &column, &row);
        g_assert_cmpint (column, ==, MIN (c, c1) + 5);
        g_assert_cmpint (row, ==, MIN (r, r1) - 3);
      }
  }
}

/* Marks the corners along the board's row @rim as found, or as linked; how many. */
static gint
mark (Window * window, const ClothPose * truth, gint rim, gboolean linked)
{
  const ClothPatch *patch = &window->patch;
  gint n = 0;

  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i < patch->columns; i++) {
      gint at = j * patch->columns + i, column, row;

      cloth_pose_vertex (truth, i, j, &column, &row);
      if (row != rim || !window->kind[at])
        continue;
      window->kind[at] = CLOTH_VERTEX_SADDLE;
      window->linked[at] = linked;
      n++;
    }
  return n;
}

/* A corner on the rim that looks like an inner one speaks against a place, unless only it
 * says so and most of the board is in sight; one that linking joined always does. */
static void
test_evidence (void)
{
  g_autoptr (ClothPattern) pattern = cloth_pattern_new_checker (10, 7, 0.01, 0,
      TRUE, NULL);
  g_autofree Window *window = g_new (Window, 1);
  ClothPose truth, best;

  for (gint rotation = 0; rotation < 4; rotation++)
    for (gint width = 7; width <= 10; width++) {
      const gboolean whole = width >= 8;
      gfloat clean;

      fill (window, pattern, 0, 0, width, 7, rotation, &truth);
      g_assert_true (run (FALSE, pattern, &window->patch, NULL, 0, &best));
      g_assert_true (equal (&best, &truth));
      g_assert_true (best.whole == whole);
      clean = best.evidence;
      /* Anywhere else squares stick out, or cells that show its end lie on the board. */
      g_assert_cmpfloat (clean, >=, 5 * -BEYOND);
      g_assert_cmpint (mark (window, &truth, 0, FALSE), ==, width + 1);
      g_assert_true (run (FALSE, pattern, &window->patch, NULL, 0, &best));
      g_assert_true (equal (&best, &truth));
      if (whole)
        g_assert_cmpfloat (best.evidence, ==, clean);
      else
        g_assert_cmpfloat (best.evidence, <, 0);
      mark (window, &truth, 0, TRUE);
      g_assert_true (run (FALSE, pattern, &window->patch, NULL, 0, &best));
      g_assert_true (equal (&best, &truth));
      g_assert_cmpfloat (best.evidence, <, 0);
    }
  /* Of a piece without a rim nothing tells the place. */
  fill (window, pattern, 2, 2, 4, 3, 0, &truth);
  g_assert_true (run (FALSE, pattern, &window->patch, NULL, 0, &best));
  g_assert_cmpfloat (best.evidence, ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/pose/mapping", test_mapping);
  g_test_add_func ("/pose/coded", test_coded);
  g_test_add_func ("/pose/plain", test_plain);
  g_test_add_func ("/pose/brute", test_brute);
  g_test_add_func ("/pose/votes", test_votes);
  g_test_add_func ("/pose/refused", test_refused);
  g_test_add_func ("/pose/evidence", test_evidence);
  return g_test_run ();
}
