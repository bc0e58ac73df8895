/* Quad tracker, the paper's alone: prediction, search, the table of consistency, extension.
 *
 * The squares are painted one by one, each where a rule wants it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/quad/quad.h"
#include "gst/vision/corner/saddle.h"

#include "tests/core/polygon.h"

#define SIZE 256
#define SIDE 30
#define WHITE 200
#define BLACK 40

/* Squares of one picture, and what a tracker makes of them. */
typedef struct
{
  ClothPattern *pattern;
  ClothQuadTracker *tracker;
  ClothQuadParams params;
  ClothImage image;
  GArray *candidates;           /* ClothSaddleCandidate */
  const ClothQuad *quads;
  guint n_quads;
} Scene;

static void
scene_init (Scene * scene, gint columns, gint rows)
{
  scene->pattern = cloth_pattern_new_checker (columns, rows, 0.01, 0, TRUE,
      NULL);
  scene->tracker = cloth_quad_tracker_new (scene->pattern);
  scene->params = cloth_quad_default_params ();
  scene->params.link = FALSE;
  scene->image = polygon_picture (SIZE, SIZE, WHITE);
  scene->candidates = g_array_new (FALSE, FALSE, sizeof (ClothSaddleCandidate));
}

static void
scene_clear (Scene * scene)
{
  cloth_quad_tracker_free (scene->tracker);
  cloth_pattern_free (scene->pattern);
  polygon_picture_clear (&scene->image);
  g_array_unref (scene->candidates);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Scene, scene_clear);

static void
scene_wipe (Scene * scene)
{
  polygon_paint_box (&scene->image, -1, -1, SIZE, SIZE, WHITE);
  g_array_set_size (scene->candidates, 0);
}

/* A square with its top-left corner between pixels, and candidates at its corners. */
static void
scene_paint (Scene * scene, gint left, gint top)
{
  polygon_paint_box (&scene->image, left - 0.5, top - 0.5, left + SIDE - 0.5,
      top + SIDE - 0.5, BLACK);
  for (gint c = 0; c < 4; c++) {
    ClothSaddleCandidate candidate = {
      (gfloat) (left + (c == 1 || c == 2 ? SIDE : 0)),
      (gfloat) (top + (c >= 2 ? SIDE : 0)), 100
    };

    g_array_append_val (scene->candidates, candidate);
  }
}

/* A white disc of so much radius on a square takes from its confidence. */
static void
scene_spoil (Scene * scene, gint left, gint top, gdouble radius)
{
  gdouble x[32], y[32];

  for (gint k = 0; k < 32; k++) {
    x[k] = left + SIDE / 2 - 0.5 + radius * cos (2 * G_PI * k / 32);
    y[k] = top + SIDE / 2 - 0.5 + radius * sin (2 * G_PI * k / 32);
  }
  polygon_paint (&scene->image, x, y, 32, WHITE);
}

static void
scene_seed (Scene * scene, gint left, gint top, gint column, gint row)
{
  const gfloat x[4] = { (gfloat) left, (gfloat) (left + SIDE),
    (gfloat) (left + SIDE), (gfloat) left
  };
  const gfloat y[4] = { (gfloat) top, (gfloat) top, (gfloat) (top + SIDE),
    (gfloat) (top + SIDE)
  };

  cloth_quad_tracker_seed (scene->tracker, x, y, column, row);
}

static guint
scene_run (Scene * scene)
{
  guint tracked = 0;

  scene->quads = cloth_quad_tracker_run (scene->tracker, &scene->params,
      &scene->image, NULL, 0,
      (const ClothSaddleCandidate *) scene->candidates->data,
      scene->candidates->len, &scene->n_quads);
  for (guint k = 0; k < scene->n_quads; k++)
    tracked += scene->quads[k].state == CLOTH_QUAD_TRACKED;
  return tracked;
}

static const ClothQuad *
scene_find (const Scene * scene, gint column, gint row, ClothQuadState state)
{
  for (guint k = 0; k < scene->n_quads; k++)
    if (scene->quads[k].column == column && scene->quads[k].row == row
        && scene->quads[k].state == state)
      return &scene->quads[k];
  return NULL;
}

static gboolean
scene_tracks (const Scene * scene, gint column, gint row, gint left, gint top)
{
  const ClothQuad *quad = scene_find (scene, column, row, CLOTH_QUAD_TRACKED);

  if (!quad)
    return FALSE;
  for (gint c = 0; c < 4; c++) {
    g_assert_cmpfloat_with_epsilon (quad->x[c], left - 0.5 + (c == 1
            || c == 2 ? SIDE : 0), 0.3);
    g_assert_cmpfloat_with_epsilon (quad->y[c], top - 0.5 + (c >=
            2 ? SIDE : 0), 0.3);
  }
  return TRUE;
}

/* The middle square of a 3 × 3 board at (113, 113) and its four neighbours. */
#define MIDDLE 113
static const gint way_x[4] = { -1, 1, 1, -1 }, way_y[4] = { -1, -1, 1, 1 };

/* Whether the middle square is kept with @present neighbours of which @far lie @gap off
 * to the right or left and as much up or down. The gap is filled by a small black square,
 * so that all corners stay saddles. The middle square is too unsure to count for its
 * neighbours; they, if @confident, do count for it. */
static gboolean
keeps_middle (guint present, guint far, gint gap, gboolean confident)
{
  g_auto (Scene) scene = { 0 };
  const ClothQuad *middle;
  guint expected = 0;

  scene_init (&scene, 3, 3);
  scene_paint (&scene, MIDDLE, MIDDLE);
  scene_seed (&scene, MIDDLE, MIDDLE, 1, 1);
  for (gint k = 0; k < 4; k++) {
    gint off = far & (1 << k) ? gap : 0, stub = off;
    gint left = MIDDLE + way_x[k] * (SIDE + off);
    gint top = MIDDLE + way_y[k] * (SIDE + off);
    gdouble x0 = MIDDLE - 0.5 + (way_x[k] > 0 ? SIDE : 0);
    gdouble y0 = MIDDLE - 0.5 + (way_y[k] > 0 ? SIDE : 0);

    if (!(present & (1 << k)))
      stub = 9;
    else
      scene_paint (&scene, left, top);
    polygon_paint_box (&scene.image, MIN (x0, x0 + way_x[k] * stub),
        MIN (y0, y0 + way_y[k] * stub), MAX (x0, x0 + way_x[k] * stub),
        MAX (y0, y0 + way_y[k] * stub), BLACK);
    if (!(present & (1 << k)))
      continue;
    if (!confident)
      scene_spoil (&scene, left, top, 9);
    scene_seed (&scene, left, top, 1 + way_x[k], 1 + way_y[k]);
    expected++;
  }
  scene_spoil (&scene, MIDDLE, MIDDLE, 9);
  scene_run (&scene);
  middle = scene_find (&scene, 1, 1, CLOTH_QUAD_TRACKED);
  for (gint k = 0; k < 4; k++) {
    const ClothQuad *other = scene_find (&scene, 1 + way_x[k], 1 + way_y[k],
        CLOTH_QUAD_TRACKED);

    if (!(present & (1 << k)))
      continue;
    g_assert_nonnull (other);
    g_assert_true ((other->confidence > scene.params.c_high) == confident);
    expected--;
  }
  g_assert_cmpuint (expected, ==, 0);
  if (!middle)
    return FALSE;
  g_assert_cmpfloat (middle->confidence, <=, scene.params.c_high);
  g_assert_true (scene_tracks (&scene, 1, 1, MIDDLE, MIDDLE));
  return TRUE;
}

static guint
count (guint set)
{
  return (set & 1) + (set >> 1 & 1) + (set >> 2 & 1) + (set >> 3 & 1);
}

/* Table 1 of the paper, whole: N_i of N_c neighbours inconsistent, all ways to choose
 * them. A lone square is not tested. 0.4 of the square's edge are 12 px. */
static void
test_consistency (void)
{
  static const guint most[5] = { 99, 1, 1, 2, 2 };
  guint n = 0, dropped = 0;

  for (guint present = 0; present < 16; present++)
    for (guint far = 0; far < 16; far++) {
      gboolean kept;

      if (far & ~present)
        continue;
      /* 10 px each way: 14.1 px. */
      kept = keeps_middle (present, far, 10, TRUE);
      if (kept != (count (far) < most[count (present)]))
        g_test_message ("neighbours %x, far %x: %s", present, far,
            kept ? "kept" : "dropped");
      g_assert_cmpint (kept, ==, count (far) < most[count (present)]);
      n++;
      dropped += !kept;
    }
  g_assert_cmpuint (n, ==, 81);
  g_test_message ("%u of %u dropped", dropped, n);
}

/* Below the threshold they agree, and unsure neighbours don't count. */
static void
test_consistency_bounds (void)
{
  /* 11.3 px */
  g_assert_true (keeps_middle (15, 15, 8, TRUE));
  g_assert_true (keeps_middle (1, 1, 8, TRUE));
  g_assert_true (keeps_middle (15, 15, 10, FALSE));
  g_assert_true (keeps_middle (2, 2, 10, FALSE));
}

/* The candidates of a picture that was scaled after its saddles were found lie between the
 * pixels. Those of a square that moved by 14.8 px lie within the search's reach of 15 px;
 * rounded to whole pixels they would lie 15.2 px away. */
static void
test_scaled_candidates (void)
{
  const gdouble x = 113.7, y = 103.7;
  g_auto (Scene) scene = { 0 };
  const ClothQuad *quad;

  scene_init (&scene, 2, 2);
  scene_paint (&scene, 100, 100);
  polygon_paint_box (&scene.image, 99.5 + SIDE, 99.5 + SIDE, 108.5 + SIDE,
      108.5 + SIDE, BLACK);
  scene_seed (&scene, 100, 100, 0, 0);
  g_assert_cmpuint (scene_run (&scene), ==, 1);

  scene_wipe (&scene);
  polygon_paint_box (&scene.image, x, y, x + SIDE, y + SIDE, BLACK);
  polygon_paint_box (&scene.image, x + SIDE, y + SIDE, x + SIDE + 9,
      y + SIDE + 9, BLACK);
  for (gint c = 0; c < 4; c++) {
    ClothSaddleCandidate candidate = {
      (gfloat) (x + (c == 1 || c == 2 ? SIDE : 0)),
      (gfloat) (y + (c >= 2 ? SIDE : 0)), 100
    };

    g_array_append_val (scene.candidates, candidate);
  }
  g_assert_cmpuint (scene_run (&scene), ==, 1);
  quad = scene_find (&scene, 0, 0, CLOTH_QUAD_TRACKED);
  g_assert_nonnull (quad);
  g_assert_cmpfloat_with_epsilon (quad->x[0], x, 0.3);
  g_assert_cmpfloat_with_epsilon (quad->y[0], y, 0.3);
}

/* The speed of the last two pictures is kept (3.6): what gains less than the search's
 * reach from picture to picture is followed however fast it gets. */
static void
test_prediction (void)
{
  static const gint at[] = { 20, 32, 56, 92, 128, 164, 188, 200, 200 };
  g_auto (Scene) scene = { 0 };

  scene_init (&scene, 2, 2);
  for (guint frame = 0; frame < G_N_ELEMENTS (at); frame++) {
    gint left = at[frame], top = 200 - at[frame] / 2;

    scene_wipe (&scene);
    scene_paint (&scene, left, top);
    /* The square's inner corner must be a saddle. */
    polygon_paint_box (&scene.image, left + SIDE - 0.5, top + SIDE - 0.5,
        left + SIDE + 8.5, top + SIDE + 8.5, BLACK);
    if (frame == 0)
      scene_seed (&scene, left, top, 0, 0);
    g_assert_cmpuint (scene_run (&scene), ==, 1);
    g_assert_true (scene_tracks (&scene, 0, 0, left, top));
  }
  /* A jump is beyond it. */
  scene_wipe (&scene);
  scene_paint (&scene, 120, 100);
  g_assert_cmpuint (scene_run (&scene), ==, 0);
}

/* Two squares run towards each other, and where both are expected there is but one: the
 * first has it, the other is refused and goes on as predicted. */
static void
test_taken (void)
{
  static const gint gone[] = { 0, 12, 36, 72 };
  g_auto (Scene) scene = { 0 };

  scene_init (&scene, 3, 3);
  for (guint frame = 0; frame < G_N_ELEMENTS (gone) + 1; frame++) {
    const gboolean met = frame == G_N_ELEMENTS (gone);
    const gint left[2] = { met ? 108 : 10 + gone[frame],
      met ? 108 : 206 - gone[frame]
    };

    scene_wipe (&scene);
    for (gint k = 0; k < (met ? 1 : 2); k++) {
      scene_paint (&scene, left[k], 100);
      /* The inner corner of each must be a saddle: below, to the right or left. */
      polygon_paint_box (&scene.image, left[k] + SIDE - 0.5, 129.5,
          left[k] + SIDE + 8.5, 138.5, BLACK);
      polygon_paint_box (&scene.image, left[k] - 9.5, 129.5, left[k] - 0.5,
          138.5, BLACK);
      if (frame == 0)
        scene_seed (&scene, left[k], 100, 2 * k, 0);
    }
    g_assert_cmpuint (scene_run (&scene), ==, met ? 1 : 2);
    g_assert_true (scene_tracks (&scene, 0, 0, left[0], 100));
    if (!met)
      g_assert_true (scene_tracks (&scene, 2, 0, left[1], 100));
  }
  g_assert_nonnull (scene_find (&scene, 2, 0, CLOTH_QUAD_PREDICTED));
}

/* What vanishes is predicted for five pictures, once said to be lost, then silent. */
static void
test_lost (void)
{
  g_auto (Scene) scene = { 0 };

  scene_init (&scene, 2, 2);
  scene_paint (&scene, 100, 100);
  polygon_paint_box (&scene.image, 129.5, 129.5, 139.5, 139.5, BLACK);
  scene_seed (&scene, 100, 100, 0, 0);
  g_assert_cmpuint (scene_run (&scene), ==, 1);
  scene_wipe (&scene);
  for (gint frame = 1; frame <= 8; frame++) {
    g_assert_cmpuint (scene_run (&scene), ==, 0);
    g_assert_cmpuint (scene.n_quads, ==, frame <= 6 ? 1 : 0);
    if (scene.n_quads)
      g_assert_cmpint (scene.quads[0].state, ==, frame <= 5
          ? CLOTH_QUAD_PREDICTED : CLOTH_QUAD_LOST);
  }
}

/* One ring of squares a picture; what was just added is less confident (3.9, 3.10). */
static void
test_extension (void)
{
  g_auto (Scene) scene = { 0 };
  static const guint grown[] = { 5, 13, 25, 25 };

  scene_init (&scene, 7, 7);
  for (gint row = 0; row < 7; row++)
    for (gint column = row & 1; column < 7; column += 2)
      scene_paint (&scene, 20 + SIDE * column, 20 + SIDE * row);
  scene_seed (&scene, 20 + 3 * SIDE, 20 + 3 * SIDE, 3, 3);
  for (guint frame = 0; frame < G_N_ELEMENTS (grown); frame++) {
    guint tracked = scene_run (&scene), fresh = 0;

    g_assert_cmpuint (tracked, ==, grown[frame]);
    for (guint k = 0; k < scene.n_quads; k++) {
      const ClothQuad *quad = &scene.quads[k];

      g_assert_true (scene_tracks (&scene, quad->column, quad->row,
              20 + SIDE * quad->column, 20 + SIDE * quad->row));
      g_assert_cmpfloat (quad->confidence, >, 0.85f);
      g_assert_cmpfloat (quad->confidence, <=, 1);
      if (quad->confidence <= scene.params.damping)
        fresh++;
    }
    /* The last ring was just added, all before are sure by now. */
    g_assert_cmpuint (fresh, ==, frame == 0 ? 4 : frame < 3 ?
        grown[frame] - grown[frame - 1] : 0);
  }
}

/* A grid of squares like a chessboard's, those in the first @grey rows of another colour, and
 * all in light that is @light of the full. */
static void
scene_board (Scene * scene, gint grey, gdouble light)
{
  scene_wipe (scene);
  for (gint row = 0; row < 7; row++)
    for (gint column = row & 1; column < 7; column += 2) {
      const gint left = 20 + SIDE * column, top = 20 + SIDE * row;

      scene_paint (scene, left, top);
      if (row < grey)
        polygon_paint_box (&scene->image, left - 0.5, top - 0.5,
            left + SIDE - 0.5, top + SIDE - 0.5, WHITE / 2);
    }
  for (gint k = 0; k < SIZE * SIZE; k++)
    ((guint8 *) scene->image.data)[k] = (guint8) (light * scene->image.data[k]);
}

/* Squares of another print are refused, whatever the light, but with linking only. */
static void
test_shade (void)
{
  static const guint rows[] = { 4, 3, 4, 3 };

  for (gint grey = 0; grey <= 3; grey++)
    for (gint light = 2; light >= 1; light--) {
      g_auto (Scene) scene = { 0 };

      scene_init (&scene, 7, 7);
      scene_board (&scene, 0, 1);
      scene_seed (&scene, 20 + 3 * SIDE, 20 + 3 * SIDE, 3, 3);
      for (gint k = 0; k < 4; k++)
        scene_run (&scene);
      scene_board (&scene, grey, 0.5 * light);
      g_assert_cmpuint (scene_run (&scene), ==, 25);
    }
  for (gint grey = 0; grey <= 4; grey++)
    for (gint light = 2; light >= 1; light--) {
      g_auto (Scene) scene = { 0 };
      guint left = 25;

      scene_init (&scene, 7, 7);
      scene_board (&scene, 0, 1);
      scene_seed (&scene, 20 + 3 * SIDE, 20 + 3 * SIDE, 3, 3);
      for (gint k = 0; k < 4; k++)
        scene_run (&scene);
      scene.params.link = TRUE;
      scene_board (&scene, grey, 0.5 * light);
      for (gint row = 0; row < grey; row++)
        left -= rows[row];
      for (gint k = 0; k < 3; k++)
        g_assert_cmpuint (scene_run (&scene), ==, left);
    }
}

/* Runs the tracker on the saddles that are in the picture, with linking. */
static guint
scene_see (Scene * scene, ClothSaddleDetector * detector)
{
  const ClothSaddleParams params = cloth_saddle_default_params ();
  const ClothSaddleCandidate *candidates;
  const ClothSaddle *saddles;
  guint n_saddles, n_candidates, tracked = 0;

  cloth_saddle_detector_run (detector, &params, &scene->image, CLOTH_SIMD_BEST);
  saddles = cloth_saddle_detector_get_saddles (detector, &n_saddles);
  candidates = cloth_saddle_detector_get_candidates (detector, &n_candidates);
  scene->params.link = TRUE;
  scene->quads = cloth_quad_tracker_run (scene->tracker, &scene->params,
      &scene->image, saddles, n_saddles, candidates, n_candidates,
      &scene->n_quads);
  for (guint k = 0; k < scene->n_quads; k++)
    if (scene->quads[k].state == CLOTH_QUAD_TRACKED) {
      const ClothQuad *quad = &scene->quads[k];

      /* Edges this sharp have no sub-pixel saddles. */
      g_assert_cmpfloat_with_epsilon (quad->x[0], 19.5 + SIDE * quad->column,
          1);
      g_assert_cmpfloat_with_epsilon (quad->y[0], 19.5 + SIDE * quad->row, 1);
      tracked++;
    }
  return tracked;
}

/* The board with so many rows of squares of level @dark, the others black. */
static void
scene_fade (Scene * scene, gint n_rows, gint dark)
{
  scene_board (scene, 0, 1);
  for (gint row = 0; row < n_rows; row++)
    for (gint column = row & 1; column < 7; column += 2)
      polygon_paint_box (&scene->image, 19.5 + SIDE * column,
          19.5 + SIDE * row, 19.5 + SIDE * (column + 1),
          19.5 + SIDE * (row + 1), (guint8) dark);
}

/* The print is learnt again when most of what is seen of it changes: after three pictures
 * when at once, and losing none when slowly. A part that has changed never is. */
static void
test_shade_again (void)
{
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  g_auto (Scene) scene = { 0 };

  scene_init (&scene, 7, 7);
  for (gint turn = 0; turn < 4; turn++)
    for (gint k = 0; k < 12; k++) {
      scene_fade (&scene, 7, turn & 1 ? 120 : BLACK);
      g_assert_cmpuint (scene_see (&scene, detector), ==,
          turn > 0 && k < 3 ? 0 : 25);
    }
  for (gint dark = 120; dark >= BLACK; dark--) {
    scene_fade (&scene, 7, dark);
    g_assert_cmpuint (scene_see (&scene, detector), ==, 25);
  }
  for (gint k = 0; k < 12; k++) {
    scene_fade (&scene, 3, 120);
    g_assert_cmpuint (scene_see (&scene, detector), ==, 14);
  }
}

/* A square all of whose corners are others' vertices is none; its neighbours stay, and all
 * squares are found where they are. */
static void
test_contested (void)
{
  g_auto (Scene) scene = { 0 };

  scene_init (&scene, 7, 7);
  scene_board (&scene, 0, 1);
  for (gint k = 0; k < 4; k++)
    scene_seed (&scene, 20 + (3 + way_x[k]) * SIDE, 20 + (3 + way_y[k]) * SIDE,
        3 + way_x[k], 3 + way_y[k]);
  scene_seed (&scene, 20 + 3 * SIDE, 20 + 3 * SIDE, 1, 1);
  g_assert_cmpuint (scene_run (&scene), ==, 13);
  for (guint k = 0; k < scene.n_quads; k++)
    g_assert_true (scene_tracks (&scene, scene.quads[k].column,
            scene.quads[k].row, 20 + SIDE * scene.quads[k].column,
            20 + SIDE * scene.quads[k].row));
}

/* Of two squares that contradict each other in one corner, with no other to say which is
 * right, neither is believed. */
static void
test_contested_pair (void)
{
  for (gint row = 0; row <= 1; row++) {
    g_auto (Scene) scene = { 0 };

    scene_init (&scene, 7, 7);
    scene_board (&scene, 0, 1);
    scene.params.c_pred = 1;
    scene_seed (&scene, 20 + 2 * SIDE, 20 + 2 * SIDE, 2, 2);
    scene_seed (&scene, 20 + 3 * SIDE, 20 + 3 * SIDE, 3, 3 - 2 * row);
    g_assert_cmpuint (scene_run (&scene), ==, row ? 0 : 2);
  }
}

/* Nothing extends from a square below c_pred, and nothing below c_low is tracked. */
static void
test_confidence (void)
{
  for (gint k = 0; k < 3; k++) {
    g_auto (Scene) scene = { 0 };

    scene_init (&scene, 3, 3);
    for (gint m = 0; m < 9; m += 2)
      scene_paint (&scene, 80 + SIDE * (m % 3), 80 + SIDE * (m / 3));
    /* 1 - π·r² / 900 on a cross of 1800 px */
    scene_spoil (&scene, 80 + SIDE, 80 + SIDE, k == 0 ? 7 : k == 1 ? 9.7 : 11);
    scene_seed (&scene, 80 + SIDE, 80 + SIDE, 1, 1);
    g_assert_cmpuint (scene_run (&scene), ==, k == 0 ? 5 : k == 1 ? 1 : 0);
  }
}

/* A seed that is no square, or of a colour not tracked, or off the board, starts none. */
static void
test_no_start (void)
{
  static const gint places[][4] = { {100, 100, 0, 3},
  {100, 100, 99, 99}, {100, 100, 1, 0}, {180, 30, 0, 0}, {-500, 0, 0, 0},
  {1000000, 1000000, 0, 0}
  };

  for (guint k = 0; k < G_N_ELEMENTS (places); k++) {
    g_auto (Scene) scene = { 0 };

    scene_init (&scene, 3, 3);
    scene_paint (&scene, 100, 100);
    polygon_paint_box (&scene.image, 129.5, 129.5, 139.5, 139.5, BLACK);
    scene_seed (&scene, places[k][0], places[k][1], places[k][2], places[k][3]);
    g_assert_cmpuint (scene_run (&scene), ==, 0);
    /* The picture was fine: it is the seed. */
    scene_seed (&scene, 100, 100, 0, 0);
    g_assert_cmpuint (scene_run (&scene), ==, 1);
    cloth_quad_tracker_reset (scene.tracker);
    g_assert_cmpuint (scene_run (&scene), ==, 0);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/quad/consistency", test_consistency);
  g_test_add_func ("/quad/consistency-bounds", test_consistency_bounds);
  g_test_add_func ("/quad/scaled-candidates", test_scaled_candidates);
  g_test_add_func ("/quad/prediction", test_prediction);
  g_test_add_func ("/quad/taken", test_taken);
  g_test_add_func ("/quad/lost", test_lost);
  g_test_add_func ("/quad/extension", test_extension);
  g_test_add_func ("/quad/confidence", test_confidence);
  g_test_add_func ("/quad/shade", test_shade);
  g_test_add_func ("/quad/shade-again", test_shade_again);
  g_test_add_func ("/quad/contested", test_contested);
  g_test_add_func ("/quad/contested-pair", test_contested_pair);
  g_test_add_func ("/quad/no-start", test_no_start);
  return g_test_run ();
}
