/* Boards with markers, of markers and corners that are known: a homography of the tests, which none of
 * the code under test knows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/vision/checker/checker.h"

#define COLUMNS 8
#define ROWS 7
#define MARKER 0.7
#define N_MARKERS 28

typedef struct
{
  gint ids[N_MARKERS + 2];
  gfloat corners[N_MARKERS + 2][8];
  guint n;
  ClothSaddle saddles[(COLUMNS - 1) * (ROWS - 1)];
  guint n_saddles;
} Scene;

/* A board that is tilted. */
static void
see (gdouble u, gdouble v, gfloat * x, gfloat * y)
{
  gdouble w = 1 + 0.03 * u - 0.02 * v;

  *x = (gfloat) ((60 + 42 * u + 5 * v) / w);
  *y = (gfloat) ((50 - 4 * u + 45 * v) / w);
}

static void
scene_init (Scene * scene, gint rows_seen)
{
  memset (scene, 0, sizeof *scene);
  for (gint i = 0, id = 0; i < COLUMNS * ROWS; i++) {
    gint c = i % COLUMNS, r = i / COLUMNS;
    gdouble low = 0.5 - MARKER / 2, high = 0.5 + MARKER / 2;
    const gdouble U[4] = { low, high, high, low }, V[4] = { low, low, high,
      high
    };

    if ((c + r) % 2 == 0)
      continue;                 /* black */
    if (r < rows_seen) {
      scene->ids[scene->n] = id;
      for (guint k = 0; k < 4; k++)
        see (c + U[k], r + V[k], &scene->corners[scene->n][2 * k],
            &scene->corners[scene->n][2 * k + 1]);
      scene->n++;
    }
    id++;
  }
  for (gint r = 1; r < MIN (rows_seen + 1, ROWS); r++)
    for (gint c = 1; c < COLUMNS; c++) {
      ClothSaddle *s = &scene->saddles[scene->n_saddles++];

      see (c, r, &s->x, &s->y);
      s->cov[0] = s->cov[2] = 0.01f;
    }
}

static ClothMarkedBoard *
make_board (void)
{
  g_autoptr (ClothPattern) pattern = cloth_pattern_new_checker (COLUMNS, ROWS,
      0.03, 0.015, TRUE, NULL);

  return cloth_marked_board_new (pattern, MARKER);
}

static gboolean
find (ClothMarkedBoard * board, const Scene * scene,
    const ClothBoardView ** view)
{
  cloth_marked_board_set_markers (board, scene->n, scene->ids,
      scene->corners[0]);
  return cloth_marked_board_find (board, scene->saddles, scene->n_saddles,
      view);
}

static void
check_places (const ClothBoardView * view)
{
  for (gint v = 0; v < view->columns * view->rows; v++) {
    gfloat x, y;

    if (!view->seen[v])
      continue;
    see (v % view->columns, v / view->columns, &x, &y);
    g_assert_cmpfloat (hypotf (view->x[v] - x, view->y[v] - y), ==, 0);
  }
}

/* Each corner is where it is, of a whole board and of its upper rows. */
static void
test_found (void)
{
  g_autoptr (ClothMarkedBoard) board = make_board ();

  for (gint rows = ROWS; rows > 1; rows -= 4) {
    const ClothBoardView *view;
    Scene scene;

    scene_init (&scene, rows);
    g_assert_true (find (board, &scene, &view));
    g_assert_false (cloth_marked_board_is_contradicted (board));
    g_assert_cmpuint (view->n_seen, ==, scene.n_saddles);
    check_places (view);
    /* 15% of squares of some 40 px */
    g_assert_cmpfloat (cloth_marked_board_get_margin (board), >, 3);
    g_assert_cmpfloat (cloth_marked_board_get_margin (board), <, 9);
  }
}

/* A marker that is taken for another one, beside those that are seen or far from them: either its
 * corners are not used, or none of the picture. */
static void
test_misread (void)
{
  g_autoptr (ClothMarkedBoard) board = make_board ();
  guint n_refused = 0;

  for (guint wrong = 0; wrong < 12; wrong++) {
    for (gint as = 12; as < N_MARKERS; as++) {
      const ClothBoardView *view;
      Scene scene;

      scene_init (&scene, 3);
      g_assert_cmpuint (scene.n, ==, 12);
      scene.ids[wrong] = as;
      if (find (board, &scene, &view)) {
        check_places (view);
        continue;
      }
      g_assert_true (cloth_marked_board_is_contradicted (board));
      g_assert_cmpuint (view->n_seen, ==, 0);
      n_refused++;
    }
  }
  g_assert_cmpuint (n_refused, >, 100);
}

/* Numbers that no board has, markers seen twice, places that can't be. */
static void
test_hostile (void)
{
  g_autoptr (ClothMarkedBoard) board = make_board ();
  static const gint strange[] = { -1, G_MININT, G_MAXINT, N_MARKERS };
  const ClothBoardView *view;
  Scene scene;

  for (guint i = 0; i < G_N_ELEMENTS (strange); i++) {
    scene_init (&scene, ROWS);
    scene.ids[scene.n] = strange[i];
    memcpy (scene.corners[scene.n++], scene.corners[3],
        sizeof scene.corners[3]);
    g_assert_true (find (board, &scene, &view));
    g_assert_cmpuint (view->n_seen, ==, scene.n_saddles);
  }
  /* the two are left out; the corners they tell are those of others, too, but one at the rim */
  scene_init (&scene, ROWS);
  scene.ids[scene.n] = 3;
  memcpy (scene.corners[scene.n++], scene.corners[20],
      sizeof scene.corners[20]);
  g_assert_cmpuint (cloth_marked_board_set_markers (board, scene.n, scene.ids,
          scene.corners[0]), ==, N_MARKERS - 1);
  g_assert_true (find (board, &scene, &view));
  for (guint i = 0; i < 3; i++) {
    scene_init (&scene, ROWS);
    for (guint k = 0; k < scene.n; k++)
      for (guint j = 0; j < 8; j++)
        scene.corners[k][j] = i == 0 ? NAN : i == 1 ? INFINITY : 7;
    g_assert_false (find (board, &scene, &view));
  }
  scene_init (&scene, ROWS);
  scene.n_saddles = 0;
  g_assert_false (find (board, &scene, &view));
  scene.n = 0;
  g_assert_false (find (board, &scene, &view));
  g_assert_true (isinf (cloth_marked_board_get_margin (board)));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/markedboard/found", test_found);
  g_test_add_func ("/markedboard/misread", test_misread);
  g_test_add_func ("/markedboard/hostile", test_hostile);
  return g_test_run ();
}
