/* Linking and patches: boards flat and bent, seen askew, with corners missing and points
 * that are none, against the renderer's truth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/math/random.h"
#include "gst/pattern/code.h"
#include "gst/vision/checker/link.h"
#include "gst/vision/checker/patch.h"
#include "tests/common/render.h"

#define WIDTH 480
#define HEIGHT 400
#define COLUMNS 10
#define ROWS 8

/* Ways to hold the board: yaw, pitch, roll, height of the wave. */
static const gdouble poses[][4] = {
  {0, 0, 0, 0}, {0.6, 0.2, 0.3, 0}, {-0.5, 0.6, 2.5, 0}, {0, 0, -1.4, 0.006},
  {0.4, 0.1, 0.1, 0.008}, {-0.3, -0.3, 3.1, 0.007}
};

typedef struct
{
  ClothPattern *pattern;
  TestRender *render;
  ClothImage image;
  GArray *saddles;              /* ClothSaddle */
} View;

static void
view_init (View * view, guint pose, gboolean coded)
{
  const ClothCamera camera = test_camera (WIDTH, HEIGHT, 700, 0.5);
  TestWave wave = { 0 };
  TestScene scene = { 0 };
  ClothSaddleParams params = cloth_saddle_default_params ();
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  const ClothSaddle *saddles;
  guint n;

  view->pattern = cloth_pattern_new_checker (COLUMNS, ROWS, 0.02, 0.02, TRUE,
      NULL);
  if (coded)
    g_assert_true (cloth_code_generate (view->pattern, CLOTH_CODE_DOT_RATIO, 1,
            NULL, NULL));
  wave.pattern = view->pattern;
  wave.yaw = poses[pose][0];
  wave.pitch = poses[pose][1];
  wave.roll = poses[pose][2];
  wave.amplitude_m = poses[pose][3];
  wave.wavelength_m = 0.12;
  wave.direction = 0.5;
  scene.pattern = view->pattern;
  scene.camera = &camera;
  scene.surface = test_surface_wave;
  scene.surface_data = &wave;
  scene.black = 12;
  scene.white = 170;
  scene.background = 40;
  scene.blur = 0.7;
  scene.noise = 2;
  scene.seed = pose;
  view->render = test_render (&scene);
  /* The camera blurs light; films hold about its root. */
  for (gint k = 0; k < WIDTH * HEIGHT; k++)
    view->render->data[k] =
        (guint8) lrint (sqrt (255.0 * view->render->data[k]));
  view->image = (ClothImage) {
  view->render->data, WIDTH, HEIGHT, WIDTH};
  cloth_saddle_detector_run (detector, &params, &view->image, CLOTH_SIMD_BEST);
  saddles = cloth_saddle_detector_get_saddles (detector, &n);
  view->saddles = g_array_new (FALSE, FALSE, sizeof (ClothSaddle));
  g_array_append_vals (view->saddles, saddles, n);
}

static void
view_clear (View * view)
{
  cloth_pattern_free (view->pattern);
  test_render_free (view->render);
  g_array_unref (view->saddles);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (View, view_clear);

/* The board's vertex nearest to a place of the picture, -1 for none. */
static gint
vertex_at (const View * view, gdouble x, gdouble y, gdouble within)
{
  gint nearest = -1;

  for (guint k = 0; k < view->render->n_vertices; k++) {
    gdouble d = hypot (view->render->x[k] - x, view->render->y[k] - y);

    if (d < within) {
      within = d;
      nearest = (gint) k;
    }
  }
  return nearest;
}

static gboolean
is_inner (gint vertex)
{
  gint column = vertex % (COLUMNS + 1), row = vertex / (COLUMNS + 1);

  return column > 0 && row > 0 && column < COLUMNS && row < ROWS;
}

/* How a grid lies on the board: a turn and an offset, no mirror. */
typedef struct
{
  gboolean known;
  gint turn, column, row;
} Lie;

static void
lay (const Lie * lie, gint i, gint j, gint * column, gint * row)
{
  static const gint c[4] = { 1, 0, -1, 0 }, s[4] = { 0, 1, 0, -1 };

  *column = lie->column + c[lie->turn] * i - s[lie->turn] * j;
  *row = lie->row + s[lie->turn] * i + c[lie->turn] * j;
}

/* The lie that most nodes of a patch agree with, and how many don't. A point beside a
 * corner that is missing may stand for it. */
#define BESIDE 12
static guint
find_lie (const View * view, const ClothLinkPatch * patch, Lie * best)
{
  guint most = 0;

  for (gint at = 0; at < patch->columns * patch->rows; at++)
    for (gint turn = 0; turn < 4 && patch->node[at] >= 0; turn++) {
      const ClothSaddle *own = &g_array_index (view->saddles, ClothSaddle,
          patch->node[at]);
      gint vertex = vertex_at (view, own->x, own->y, BESIDE), c, r;
      Lie lie = { TRUE, turn, 0, 0 };
      guint agree = 0;

      if (vertex < 0)
        continue;
      lay (&lie, at % patch->columns, at / patch->columns, &c, &r);
      lie.column = vertex % (COLUMNS + 1) - c;
      lie.row = vertex / (COLUMNS + 1) - r;
      for (gint k = 0; k < patch->columns * patch->rows; k++) {
        const ClothSaddle *saddle;

        if (patch->node[k] < 0)
          continue;
        saddle = &g_array_index (view->saddles, ClothSaddle, patch->node[k]);
        lay (&lie, k % patch->columns, k / patch->columns, &c, &r);
        agree += vertex_at (view, saddle->x, saddle->y, BESIDE)
            == r * (COLUMNS + 1) + c;
      }
      if (agree > most) {
        most = agree;
        *best = lie;
      }
    }
  return patch->n_nodes - most;
}

static void
check_patch (const View * view, const ClothLinkPatch * patch,
    const ClothLinkNode * nodes, gint number)
{
  Lie lie = { 0 };
  guint n_nodes = 0;

  g_assert_cmpuint (find_lie (view, patch, &lie), ==, 0);
  for (gint at = 0; at < patch->columns * patch->rows; at++) {
    gint i = at % patch->columns, j = at / patch->columns, column, row, c[4],
        r[4];
    static const gint corner[4][2] = { {0, 0}, {1, 0}, {1, 1}, {0, 1} };

    if (patch->node[at] >= 0) {
      const ClothLinkNode *node = &nodes[patch->node[at]];

      n_nodes++;
      g_assert_cmpint (node->patch, ==, number);
      g_assert_cmpint (node->i, ==, i);
      g_assert_cmpint (node->j, ==, j);
    }
    if (!patch->square[at])
      continue;
    column = row = G_MAXINT;
    for (gint k = 0; k < 4; k++) {
      gint m = at + corner[k][0] + corner[k][1] * patch->columns;

      g_assert_cmpint (i + corner[k][0], <, patch->columns);
      g_assert_cmpint (j + corner[k][1], <, patch->rows);
      g_assert_cmpint (patch->node[m], >=, 0);
      lay (&lie, i + corner[k][0], j + corner[k][1], &c[k], &r[k]);
      column = MIN (column, c[k]);
      row = MIN (row, r[k]);
    }
    g_assert_cmpint (cloth_pattern_is_black (view->pattern, column, row), ==,
        ((i + j) & 1) == (patch->odd_black ? 1 : 0));
  }
  g_assert_cmpuint (n_nodes, ==, patch->n_nodes);
}

static gfloat
random_in (ClothRandom * random, gdouble from, gdouble to)
{
  return (gfloat) (from + (to - from) * cloth_random_uniform (random));
}

/* Takes away every so manieth corner and adds points anywhere, also right beside corners. */
static void
disturb (View * view, guint one_in, guint n_clutter, guint64 seed)
{
  ClothRandom random;
  guint n = view->saddles->len;

  cloth_random_init (&random, seed);
  for (guint k = n; k > 0 && one_in; k--)
    if (random_in (&random, 0, one_in) < 1)
      g_array_remove_index_fast (view->saddles, k - 1);
  for (guint k = 0; k < n_clutter; k++) {
    ClothSaddle saddle = { random_in (&random, 0, WIDTH - 1),
      random_in (&random, 0, HEIGHT - 1), 50, random_in (&random, 0, G_PI),
      {0.01f, 0, 0.01f}
    };

    if (vertex_at (view, saddle.x, saddle.y, 3) < 0)
      g_array_append_val (view->saddles, saddle);
  }
}

/* With every corner there, all of them make one patch; with some missing, or with clutter,
 * what is linked is still right, and is most of the board. */
static void
test_boards (void)
{
  static const struct
  {
    guint one_in, clutter;
    gdouble least;
  } cases[] =
      { {0, 0, 1}, {0, 60, 0.75}, {12, 0, 0.7}, {8, 60, 0.25}, {0, 120, 0.45}
  };
  g_autoptr (ClothLinker) linker = cloth_linker_new ();
  guint n_inner = 0, n_linked = 0;

  for (guint pose = 0; pose < G_N_ELEMENTS (poses); pose++)
    for (guint c = 0; c < G_N_ELEMENTS (cases); c++) {
      g_auto (View) view = { 0 };
      const ClothLinkPatch *patches;
      const ClothLinkNode *nodes;
      guint n, order[4], n_order, inner = 0, linked = 0;

      view_init (&view, pose, FALSE);
      disturb (&view, cases[c].one_in, cases[c].clutter, pose);
      n = cloth_linker_run (linker, &view.image, NULL,
          (const ClothSaddle *) view.saddles->data, view.saddles->len, &patches,
          &nodes);
      n_order = cloth_link_largest (patches, n, order, G_N_ELEMENTS (order));
      g_assert_cmpuint (n_order, >, 0);
      for (guint k = 0; k < n_order; k++) {
        g_assert_cmpuint (patches[order[k]].n_nodes, >=, 4);
        if (k > 0)
          g_assert_cmpfloat (patches[order[k]].size, <=,
              patches[order[k - 1]].size);
        check_patch (&view, &patches[order[k]], nodes, (gint) order[k]);
      }
      for (guint k = 0; k < view.saddles->len; k++) {
        const ClothSaddle *s = &g_array_index (view.saddles, ClothSaddle, k);
        gint vertex = vertex_at (&view, s->x, s->y, 1.5);

        if (vertex < 0 || !is_inner (vertex)) {
          g_assert_true (nodes[k].patch < 0
              || (cases[c].clutter && vertex_at (&view, s->x, s->y,
                      BESIDE) >= 0));
          continue;
        }
        inner++;
        linked += nodes[k].patch == (gint) order[0];
      }
      g_test_message ("pose %u, case %u: %u of %u corners linked", pose, c,
          linked, inner);
      g_assert_cmpfloat (linked, >=, cases[c].least * inner);
      if (!cases[c].one_in)
        g_assert_cmpuint (inner, ==, (COLUMNS - 1) * (ROWS - 1));
      if (cases[c].clutter == 120) {
        n_inner += inner;
        n_linked += linked;
      }
    }
  /* So much clutter pushes corners out of each other's eight nearest points. */
  g_test_message ("in dense clutter %u of %u corners linked", n_linked,
      n_inner);
  g_assert_cmpfloat (n_linked, >=, 0.76 * n_inner);
}

/* Points without a board under them, all in one place, none, and a picture of one pixel. */
static void
test_no_boards (void)
{
  g_autoptr (ClothLinker) linker = cloth_linker_new ();
  g_autofree guint8 *data = g_malloc (WIDTH * HEIGHT);
  const ClothImage image = { data, WIDTH, HEIGHT, WIDTH }, dot =
      { data, 1, 1, 1 };
  ClothSaddle saddles[400];
  const ClothLinkPatch *patches;
  const ClothLinkNode *nodes;
  ClothRandom random;
  guint order[3];

  cloth_random_init (&random, 5);
  for (gint k = 0; k < WIDTH * HEIGHT; k++)
    data[k] = 128;
  for (guint k = 0; k < G_N_ELEMENTS (saddles); k++)
    saddles[k] = (ClothSaddle) {
    (gfloat) (k % 20 * 20 + 5), (gfloat) (k / 20 * 20 + 5), 10,
        (k % 20 + k / 20) % 2 ? 0.1f : 1.6f, {
    0.01f, 0, 0.01f}
    };
  g_assert_cmpuint (cloth_linker_run (linker, &image, NULL, saddles, 400,
          &patches, &nodes), ==, 0);
  for (guint k = 0; k < 400; k++)
    g_assert_cmpint (nodes[k].patch, <, 0);
  /* Noise: no square of four edges, or few. */
  for (gint k = 0; k < WIDTH * HEIGHT; k++)
    data[k] = (guint8) random_in (&random, 0, 255);
  g_assert_cmpuint (cloth_link_largest (patches, cloth_linker_run (linker,
              &image, NULL, saddles, 400, &patches, NULL), order, 3), ==, 0);
  g_assert_cmpuint (cloth_linker_run (linker, &image, NULL, NULL, 0, &patches,
          NULL), ==, 0);
  g_assert_cmpuint (cloth_link_largest (NULL, 0, order, 3), ==, 0);
  for (guint k = 0; k < G_N_ELEMENTS (saddles); k++)
    saddles[k].x = saddles[k].y = 0;
  g_assert_cmpuint (cloth_linker_run (linker, &dot, NULL, saddles, 400,
          &patches, NULL), ==, 0);
  g_assert_cmpuint (cloth_linker_run (linker, &image, NULL, saddles, 400,
          &patches, NULL), ==, 0);
}

/* A patch has every square of the board, the rim's too, each corner in its place; beyond
 * the rim nothing is taken for board, and the dots of a code are read. */
static void
test_patch (void)
{
  const ClothPatchParams params = { 0.25f, 0.62f, -3, 0.25f, FALSE, TRUE };
  g_autoptr (ClothLinker) linker = cloth_linker_new ();
  ClothPatch patch = { 0 };
  gdouble sum2[2] = { 0 }, worst = 0;
  guint n_corners[2] = { 0 };

  for (guint pose = 0; pose < G_N_ELEMENTS (poses); pose++)
    for (gint coded = 0; coded < 2; coded++) {
      g_auto (View) view = { 0 };
      const ClothLinkPatch *links;
      guint order, n, n_seen = 0, n_bits = 0;
      Lie lie = { 0 };

      view_init (&view, pose, coded);
      n = cloth_linker_run (linker, &view.image, NULL,
          (const ClothSaddle *) view.saddles->data, view.saddles->len, &links,
          NULL);
      g_assert_cmpuint (cloth_link_largest (links, n, &order, 1), ==, 1);
      g_assert_cmpuint (find_lie (&view, &links[order], &lie), ==, 0);
      cloth_patch_build (&patch, &view.image,
          (const ClothSaddle *) view.saddles->data, &links[order], &params);
      g_assert_cmpint (patch.columns, ==,
          links[order].columns + 2 * CLOTH_PATCH_MARGIN);
      g_assert_cmpint (patch.rows, ==,
          links[order].rows + 2 * CLOTH_PATCH_MARGIN);
      for (gint at = 0; at < patch.columns * patch.rows; at++) {
        gint i = at % patch.columns - CLOTH_PATCH_MARGIN;
        gint j = at / patch.columns - CLOTH_PATCH_MARGIN;
        gint column, row, c, r, inner;
        gdouble d;

        lay (&lie, i, j, &column, &row);
        if (patch.kind[at]) {
          g_assert_true (column >= 0 && row >= 0 && column <= COLUMNS
              && row <= ROWS);
          d = hypot (patch.x[at] - view.render->x[row * (COLUMNS + 1) + column],
              patch.y[at] - view.render->y[row * (COLUMNS + 1) + column]);
          worst = MAX (worst, d);
          inner = is_inner (row * (COLUMNS + 1) + column);
          sum2[inner] += d * d;
          n_corners[inner]++;
          g_assert_cmpint (patch.kind[at] == CLOTH_VERTEX_RIM, ==, !inner);
          g_assert_cmpfloat (patch.cov[3 * at], >, 0);
          g_assert_cmpfloat (patch.cov[3 * at + 2], >, 0);
        }
        if (i + 1 >= patch.columns - CLOTH_PATCH_MARGIN
            || j + 1 >= patch.rows - CLOTH_PATCH_MARGIN)
          continue;
        lay (&lie, i + 1, j + 1, &c, &r);
        column = MIN (column, c);
        row = MIN (row, r);
        if (column < 0 || row < 0 || column >= COLUMNS || row >= ROWS) {
          g_assert_cmpint (patch.square[at], ==, 0);
          g_assert_cmpfloat (patch.inside[at], <=, 0);
          continue;
        }
        n_seen += patch.square[at];
        if (!patch.square[at])
          continue;
        g_assert_cmpint (cloth_patch_is_black (&patch, i + CLOTH_PATCH_MARGIN,
                j + CLOTH_PATCH_MARGIN), ==,
            cloth_pattern_is_black (view.pattern, column, row));
        if (!coded || patch.bit[at] == 0)
          continue;
        n_bits++;
        g_assert_cmpint (patch.bit[at] > 0, ==,
            cloth_pattern_has_dot (view.pattern, column, row));
      }
      g_test_message ("pose %u%s: %u of %u squares", pose,
          coded ? ", coded" : "", n_seen, COLUMNS * ROWS);
      g_assert_cmpuint (n_seen, ==, patch.n_squares);
      /* The outermost corners of two white squares can't be seen on white cloth. */
      g_assert_cmpuint (n_seen, >=, COLUMNS * ROWS - 2);
      g_assert_cmpuint (n_bits, >=, coded ? n_seen * 9 / 10 : 0);
    }
  cloth_patch_clear (&patch);
  g_test_message ("RMS of %u inner corners %.3f px, of %u on the rim %.3f px; "
      "at most %.3f px off", n_corners[1], sqrt (sum2[1] / n_corners[1]),
      n_corners[0], sqrt (sum2[0] / n_corners[0]), worst);
  g_assert_cmpfloat (sqrt (sum2[1] / n_corners[1]), <, 0.04);
  g_assert_cmpfloat (sqrt (sum2[0] / n_corners[0]), <, 0.06);
  g_assert_cmpfloat (worst, <, 0.2);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/link/boards", test_boards);
  g_test_add_func ("/link/none", test_no_boards);
  g_test_add_func ("/patch/boards", test_patch);
  return g_test_run ();
}
