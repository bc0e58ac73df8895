/* Time to make a code and to place patches on coded and plain boards, against looking at
 * every square under every pose.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

#include "gst/math/random.h"
#include "gst/pattern/code.h"
#include "tests/bench/clock.h"
#include "tests/common/brutepose.h"

#define M CLOTH_PATCH_MARGIN

/* The board's part at (@left, @top), turned by half a turn; one dot in ten is misread. */
static ClothPatch *
window (const ClothPattern * pattern, gint left, gint top, gint columns,
    gint rows, ClothRandom * random, ClothPose * truth)
{
  ClothPatch *patch = test_patch_new (columns + 1 + 2 * M, rows + 1 + 2 * M);

  *truth = (ClothPose) {
  2, left + columns + M, top + rows + M, 0};
  for (gint j = M; j <= rows + M; j++)
    for (gint i = M; i <= columns + M; i++) {
      const gint at = j * patch->columns + i;
      gint column, row;

      cloth_pose_vertex (truth, i, j, &column, &row);
      patch->kind[at] = column > 0 && row > 0 && column < pattern->columns
          && row < pattern->rows ? CLOTH_VERTEX_SADDLE : CLOTH_VERTEX_RIM;
      patch->linked[at] = patch->kind[at] == CLOTH_VERTEX_SADDLE;
      patch->x[at] = (gfloat) (-10 * i);
      patch->y[at] = (gfloat) (-10 * j);
      if (i == columns + M || j == rows + M)
        continue;
      cloth_pose_cell (truth, i, j, &column, &row);
      patch->square[at] = 1;
      patch->n_squares++;
      patch->odd_black = ((i + j) & 1) == (cloth_pattern_is_black (pattern,
              column, row) ? 1 : 0);
      if (pattern->code)
        patch->bit[at] = 3 - (gfloat) cloth_random_uniform (random);
      if (cloth_random_below (random, 10) == 0
          ? cloth_pattern_has_dot (pattern, column, row)
          : !cloth_pattern_has_dot (pattern, column, row))
        patch->bit[at] = -patch->bit[at];
    }
  return patch;
}

static void
measure (const ClothPattern * pattern, gint columns, gint rows, gboolean brute)
{
  g_autoptr (ClothPoseFinder) pose_finder = cloth_pose_finder_new (pattern);
  g_autoptr (ClothPatch) patch = NULL;
  gdouble least[2] = { G_MAXDOUBLE, G_MAXDOUBLE }, slow = 0;
  ClothPose truth, best = { 0 };
  gboolean right = TRUE;
  ClothRandom random;

  cloth_random_init (&random, 1);
  patch = window (pattern, pattern->columns - columns, 0, columns, rows,
      &random, &truth);
  truth.weight = 14;
  for (guint voted = 0; voted < 2; voted++)
    for (gint run = 0; run < 10; run++) {
      const gdouble start = cpu_ms ();

      cloth_pose_finder_run (pose_finder, patch, &cloth_pose_cloth, &truth,
          voted, &best);
      least[voted] = MIN (least[voted], cpu_ms () - start);
      right &= best.rotation == truth.rotation && best.column == truth.column
          && best.row == truth.row;
    }
  if (brute) {
    slow = cpu_ms ();
    test_brute_place (pattern, patch, &cloth_pose_cloth, NULL, 0, &best);
    slow = cpu_ms () - slow;
  }
  g_print ("%s board of %d by %d, patch of %d by %d placed %s in %.3f ms, with "
      "the memory's vote in %.3f ms", pattern->code ? "coded" : "plain",
      pattern->columns, pattern->rows, columns, rows,
      right ? "right" : pattern->code ? "WRONG" : "anywhere", least[0],
      least[1]);
  if (brute)
    g_print ("; every square under every pose %.1f ms: %.0f times", slow,
        slow / least[0]);
  g_print ("\n");
}

int
main (void)
{
  const gint sizes[] = { 32, 100, 250, 500 };

  for (gsize s = 0; s < G_N_ELEMENTS (sizes); s++) {
    const gint size = sizes[s];
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothPattern) plain =
        cloth_pattern_new_checker (size, size, 0.01, 0, TRUE, NULL);
    g_autoptr (ClothPattern) pattern =
        cloth_pattern_new_checker (size, size, 0.01, 0, TRUE, NULL);
    const gdouble start = cpu_ms ();
    gint least;

    if (!cloth_code_generate (pattern, CLOTH_CODE_DOT_RATIO, 1, &least, &error)) {
      g_printerr ("%s\n", error->message);
      return 1;
    }
    g_print ("%d by %d squares: window %d, code made in %.1f ms\n", size, size,
        least, cpu_ms () - start);
    measure (pattern, size, size, size <= 100);
    measure (pattern, size / 2, size / 2, size <= 100);
    measure (pattern, 20, 20, size <= 100);
    measure (plain, size / 2, size / 2, size <= 100);
  }
  return 0;
}
