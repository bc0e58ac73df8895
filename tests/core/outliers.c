/* What would have to be torn off a cloth: patches that lie elsewhere, single corners, halves
 * of which none is more likely, and what no cloth denies.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib.h>
#include <math.h>

#include "gst/fit/recording/recording.h"
#include "gst/math/random.h"

#define COLUMNS 12
#define ROWS 10
#define N (COLUMNS * ROWS)
#define EDGE 0.02

typedef struct
{
  ClothTopology *topology;
  ClothOutliers *tears;
  gdouble positions[3 * N];
} Sheet;

/* Bent round a cylinder. */
static void
set_up (Sheet * sheet, gconstpointer data)
{
  sheet->topology = cloth_topology_new_grid (COLUMNS, ROWS,
      (gfloat) (EDGE * (COLUMNS - 1)), (gfloat) (EDGE * (ROWS - 1)));
  sheet->tears = cloth_outliers_new (sheet->topology);
  for (guint v = 0; v < N; v++) {
    const gdouble angle = EDGE * (v % COLUMNS) / 0.1;

    sheet->positions[3 * v] = 0.1 * sin (angle);
    sheet->positions[3 * v + 1] = 0.1 * cos (angle);
    sheet->positions[3 * v + 2] = -EDGE * (v / COLUMNS);
  }
}

static void
tear_down (Sheet * sheet, gconstpointer data)
{
  cloth_outliers_free (sheet->tears);
  cloth_topology_free (sheet->topology);
}

static void
shift (Sheet * sheet, guint column, guint row, guint columns, guint rows,
    gdouble by)
{
  for (guint j = row; j < row + rows; j++)
    for (guint i = column; i < column + columns; i++)
      sheet->positions[3 * (j * COLUMNS + i) + 2] += by;
}

static void
hide (Sheet * sheet, guint column, guint row)
{
  for (guint k = 0; k < 3; k++)
    sheet->positions[3 * (row * COLUMNS + column) + k] = NAN;
}

static gboolean
is_gone (const Sheet * sheet, guint column, guint row)
{
  return isnan (sheet->positions[3 * (row * COLUMNS + column)]);
}

static guint
cut (Sheet * sheet, gdouble slack_m)
{
  return cloth_outliers_remove (sheet->tears, slack_m, sheet->positions);
}

/* Stretched to less than twice its length nothing is torn, and a hole tears nothing. */
static void
test_whole (Sheet * sheet, gconstpointer data)
{
  g_assert_cmpuint (cut (sheet, 0.), ==, 0);
  for (guint i = 0; i < 3 * N; i++)
    sheet->positions[i] *= 1.98;
  hide (sheet, 4, 4);
  hide (sheet, 5, 4);
  g_assert_cmpuint (cut (sheet, 0.), ==, 0);
  g_assert_false (is_gone (sheet, 4, 5));
}

/* The patch goes, and nothing around it; a corner of the sheet alike. */
static void
test_patch (Sheet * sheet, gconstpointer data)
{
  shift (sheet, 4, 3, 3, 3, 0.3);
  shift (sheet, 0, 0, 1, 1, -0.3);
  g_assert_cmpuint (cut (sheet, 0.), ==, 10);
  for (guint j = 0; j < ROWS; j++)
    for (guint i = 0; i < COLUMNS; i++)
      g_assert_cmpint (is_gone (sheet, i, j), ==, (i >= 4 && i <= 6 && j >= 3
              && j <= 5) || (i == 0 && j == 0));
}

/* Three rows up it is still near one of its neighbours, so that the sheet hangs together. */
static void
test_among_others (Sheet * sheet, gconstpointer data)
{
  shift (sheet, 4, 6, 1, 1, 2.9 * EDGE);
  g_assert_cmpuint (cut (sheet, 0.), ==, 1);
  g_assert_true (is_gone (sheet, 4, 6));
}

/* Of two halves none is more likely than the other; of two thirds and one it is. */
static void
test_halves (Sheet * sheet, gconstpointer data)
{
  shift (sheet, 0, 0, 4, ROWS, 0.5);
  g_assert_cmpuint (cut (sheet, 0.), ==, 4 * ROWS);
  tear_down (sheet, data);
  set_up (sheet, data);
  shift (sheet, 0, 0, 6, ROWS, 0.5);
  g_assert_cmpuint (cut (sheet, 0.), ==, N);
}

/* What noise can do is no tear. */
static void
test_slack (Sheet * sheet, gconstpointer data)
{
  shift (sheet, 4, 4, 1, 1, 0.05);
  g_assert_cmpuint (cut (sheet, 0.06), ==, 0);
  g_assert_cmpuint (cut (sheet, 0.01), ==, 1);
}

/* An island that no seen vertex is beside stays; nothing seen is nothing torn. */
static void
test_unseen (Sheet * sheet, gconstpointer data)
{
  shift (sheet, 5, 5, 1, 1, 0.3);
  hide (sheet, 4, 5);
  hide (sheet, 6, 5);
  hide (sheet, 5, 4);
  hide (sheet, 5, 6);
  g_assert_cmpuint (cut (sheet, 0.), ==, 0);
  for (guint v = 0; v < N; v++)
    hide (sheet, v % COLUMNS, v / COLUMNS);
  g_assert_cmpuint (cut (sheet, 0.), ==, 0);
}

/* Of whatever comes, no two neighbours are left that are torn. */
static void
test_anything (Sheet * sheet, gconstpointer data)
{
  ClothRandom random;

  cloth_random_init (&random, 3);
  for (guint turn = 0; turn < 200; turn++) {
    const gdouble spread = EDGE * cloth_random_uniform (&random);

    tear_down (sheet, data);
    set_up (sheet, data);
    for (guint i = 0; i < 3 * N; i++)
      sheet->positions[i] += spread * cloth_random_gaussian (&random);
    cut (sheet, 0.);
    for (guint v = 0; v < N; v++) {
      const gdouble *p = sheet->positions + 3 * v;

      for (guint side = 0; side < 2; side++) {
        const gdouble *q = p + (side ? 3 * COLUMNS : 3);
        const gboolean beside = side ? v + COLUMNS < N :
            v % COLUMNS + 1 < COLUMNS;

        if (beside && !isnan (p[0]) && !isnan (q[0]))
          g_assert_cmpfloat (sqrt (pow (p[0] - q[0], 2) + pow (p[1] - q[1],
                      2) + pow (p[2] - q[2], 2)), <=, 2.001 * EDGE);
      }
    }
  }
}

/* So much torn that it is not sorted out one by one. */
static void
test_hostile (void)
{
  const guint side = 300, n = side * side;
  g_autoptr (ClothTopology) topology = cloth_topology_new_grid (side, side, 1,
      1);
  g_autoptr (ClothOutliers) tears = cloth_outliers_new (topology);
  g_autofree gdouble *positions = g_new (gdouble, 3 * (gsize) n);
  ClothRandom random;

  cloth_random_init (&random, 4);
  for (guint i = 0; i < 3 * n; i++)
    positions[i] = 0.007 * cloth_random_gaussian (&random);
  g_assert_cmpuint (cloth_outliers_remove (tears, 0., positions), >, n / 2);
  g_assert_cmpuint (cloth_outliers_remove (tears, 0., positions), ==, 0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
#define ADD(name) g_test_add ("/outliers/" #name, Sheet, NULL, set_up, \
      test_##name, tear_down)
  ADD (whole);
  ADD (patch);
  ADD (among_others);
  ADD (halves);
  ADD (slack);
  ADD (unseen);
  ADD (anything);
  g_test_add_func ("/outliers/hostile", test_hostile);
  return g_test_run ();
}
