/* quadtrack on films of other boards: a slip that the code mends, each colour, narrow
 * boards; against the renderer's truth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/check.h>
#include <gst/cloth/cloth.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/pattern/code.h"
#include "tests/common/render.h"

#define WIDTH 320
#define HEIGHT 272

typedef struct
{
  ClothPattern *pattern;
  TestRender *render;           /* of the last frame pushed */
  GstHarness *h;
  gchar *path;                  /* of pattern.json */
  gboolean *shown;              /* squares tracked or predicted in the last frame */
  guint n_lost;                 /* squares reported lost so far */
  gboolean half;                /* the right of the picture is covered */
} Film;

static void
film_init (Film * film, gint columns, gint rows, gboolean coded)
{
  gint file = g_file_open_tmp ("cloth-XXXXXX.json", &film->path, NULL);

  fail_unless (file >= 0);
  g_close (file, NULL);
  film->pattern = cloth_pattern_new_checker (columns, rows,
      0.16 / MAX (columns, rows), 0.02, TRUE, NULL);
  if (coded)
    fail_unless (cloth_code_generate (film->pattern, CLOTH_CODE_DOT_RATIO, 2,
            NULL, NULL));
  fail_unless (cloth_pattern_save (film->pattern, film->path, NULL));
  film->shown = g_new0 (gboolean, columns * rows);
}

static void
film_start (Film * film, const gchar * settings)
{
  gsize n = (gsize) (film->pattern->columns * film->pattern->rows);
  g_autofree gchar *launch = g_strdup_printf ("saddledetect ! quadtrack "
      "name=track pattern=%s %s", film->path, settings);

  if (film->h)
    gst_harness_teardown (film->h);
  memset (film->shown, 0, n * sizeof (gboolean));
  film->h = gst_harness_new_parse (launch);
  gst_harness_set_src_caps_str (film->h, "video/x-raw,format=GRAY8,width=320,"
      "height=272,framerate=30/1");
}

static void
film_clear (Film * film)
{
  if (film->h)
    gst_harness_teardown (film->h);
  g_clear_pointer (&film->render, test_render_free);
  cloth_pattern_free (film->pattern);
  g_remove (film->path);
  g_free (film->path);
  g_free (film->shown);
}

/* The cloth waves and turns to and fro. */
static void
film_render (Film * film, guint frame)
{
  const ClothCamera camera = test_camera (WIDTH, HEIGHT, 560, 0.45);
  TestWave wave = { film->pattern, {0.008 * sin (0.4 * frame), 0, 0},
  0.3 * sin (0.15 * frame), 0.2, 0.1 * sin (0.2 * frame), 0.004, 0.1,
  0.5 * frame, 0.6
  };
  TestScene scene = { film->pattern, &camera, test_surface_wave, &wave };

  scene.black = 40;
  scene.white = 200;
  scene.background = 90;
  scene.blur = 0.6;
  scene.noise = 2;
  scene.seed = frame;
  g_clear_pointer (&film->render, test_render_free);
  film->render = test_render (&scene);
}

/* Corner c of a square, as the renderer has it. */
static void
film_corner (const Film * film, guint column, guint row, guint c, gdouble * x,
    gdouble * y)
{
  guint vertex = (row + (c >= 2)) * (guint) (film->pattern->columns + 1)
      + column + (c == 1 || c == 2);

  *x = film->render->x[vertex];
  *y = film->render->y[vertex];
}

/* A seed for a square of the first picture, said to be another one. */
static gchar *
film_seed (const Film * film, guint column, guint row, guint said_column,
    guint said_row)
{
  GString *text = g_string_new ("seed=");

  for (guint c = 0; c < 4; c++) {
    gdouble x, y;

    film_corner (film, column, row, c, &x, &y);
    g_string_append_printf (text, "%d,%d,", (gint) lrint (x), (gint) lrint (y));
  }
  g_string_append_printf (text, "%u,%u", said_column, said_row);
  return g_string_free (text, FALSE);
}

typedef struct
{
  guint black, white;           /* tracked where they are */
  guint wrong;                  /* tracked elsewhere */
  guint by_one;                 /* of those: one square to the right and down */
} Score;

static gboolean
lies_on (const Film * film, const GstClothQuad * quad, guint column, guint row)
{
  if ((gint) column >= film->pattern->columns
      || (gint) row >= film->pattern->rows)
    return FALSE;
  for (guint c = 0; c < 4; c++) {
    gdouble x, y;

    film_corner (film, column, row, c, &x, &y);
    if (hypot (quad->x[c] - x, quad->y[c] - y) > 1.5)
      return FALSE;
  }
  return TRUE;
}

/* No square goes without being reported lost, once. */
static void
film_check_lost (Film * film, GstClothQuads * quads)
{
  gint n = film->pattern->columns * film->pattern->rows;
  g_autofree gboolean *told = g_new0 (gboolean, n);

  for (guint k = 0; k < gst_cloth_quads_get_n_quads (quads); k++) {
    GstClothQuad quad;
    gint at;

    fail_unless (gst_cloth_quads_get_quad (quads, k, &quad));
    at = (gint) quad.row * film->pattern->columns + (gint) quad.column;
    told[at] = TRUE;
    if (quad.state == GST_CLOTH_QUAD_LOST) {
      fail_unless (film->shown[at], "square (%d, %d) was not there to lose",
          (gint) quad.column, (gint) quad.row);
      fail_unless (isfinite (quad.x[0] + quad.y[0] + quad.cov_xx[0]));
      film->n_lost++;
    }
    film->shown[at] = quad.state != GST_CLOTH_QUAD_LOST;
  }
  for (gint at = 0; at < n; at++)
    fail_unless (told[at] || !film->shown[at], "square (%d, %d) just went",
        at % film->pattern->columns, at / film->pattern->columns);
}

static Score
film_push (Film * film, guint frame)
{
  GstBuffer *buffer, *out;
  GstClothQuads *quads;
  Score score = { 0 };

  film_render (film, frame);
  for (guint row = 0; film->half && row < HEIGHT; row++)
    memset (film->render->data + row * WIDTH + WIDTH / 2, 90, WIDTH / 2);
  buffer = gst_buffer_new_memdup (film->render->data, WIDTH * HEIGHT);
  GST_BUFFER_PTS (buffer) = gst_util_uint64_scale (frame, GST_SECOND, 30);
  out = gst_harness_push_and_pull (film->h, buffer);
  fail_unless (out != NULL);
  quads = gst_buffer_get_cloth_quads (out);
  fail_unless (quads != NULL);
  film_check_lost (film, quads);
  for (guint k = 0; k < gst_cloth_quads_get_n_quads (quads); k++) {
    GstClothQuad quad;

    fail_unless (gst_cloth_quads_get_quad (quads, k, &quad));
    if (quad.state != GST_CLOTH_QUAD_TRACKED)
      continue;
    fail_unless_equals_int (quad.black,
        cloth_pattern_is_black (film->pattern, quad.column, quad.row));
    if (lies_on (film, &quad, quad.column, quad.row)) {
      score.black += quad.black;
      score.white += !quad.black;
    } else {
      score.wrong++;
      score.by_one += quad.column > 0 && quad.row > 0
          && lies_on (film, &quad, quad.column - 1, quad.row - 1);
    }
  }
  gst_buffer_unref (out);
  return score;
}

#define COLUMNS 10
#define ROWS 8
#define N_BLACK (COLUMNS * ROWS / 2)

/* A seed that is off by one square, right and down: the paper's tracker slips as a whole,
 * and nothing in a plain board could tell. As soon as the code is read the whole grid is
 * right, and stays so. */
GST_START_TEST (test_slip_mended)
{
  g_autofree gchar *settings = NULL;
  Film film = { NULL };
  g_autofree gchar *seed = NULL;
  g_autoptr (GstElement) track = NULL;
  guint frame = 0;

  film_init (&film, COLUMNS, ROWS, TRUE);
  film_render (&film, 0);
  seed = film_seed (&film, 4, 4, 5, 5);
  settings = g_strdup_printf ("link=false %s", seed);
  film_start (&film, settings);
  for (; frame < 6; frame++) {
    Score score = film_push (&film, frame);

    fail_unless_equals_int ((gint) score.black, 0);
    fail_unless_equals_int ((gint) score.wrong, (gint) score.by_one);
    fail_unless (frame < 4 || score.by_one > 8, "%u squares slipped",
        score.by_one);
  }
  track = gst_bin_get_by_name (GST_BIN (film.h->element), "track");
  g_object_set (track, "link", TRUE, NULL);
  for (; frame < 16; frame++) {
    Score score = film_push (&film, frame);

    fail_unless_equals_int ((gint) score.wrong, 0);
    fail_unless (score.black >= N_BLACK * 9 / 10,
        "%u of %d squares in frame %u", score.black, N_BLACK, frame);
  }
  film_clear (&film);
}

GST_END_TEST;

/* When the code shows that the grid had slipped while half of it is covered, the squares
 * that go with the old grid are reported lost. */
GST_START_TEST (test_slip_lost)
{
  g_autofree gchar *settings = NULL;
  Film film = { NULL };
  g_autofree gchar *seed = NULL;
  g_autoptr (GstElement) track = NULL;
  Score score;

  film_init (&film, COLUMNS, ROWS, TRUE);
  film_render (&film, 0);
  seed = film_seed (&film, 4, 4, 5, 5);
  settings = g_strdup_printf ("link=false %s", seed);
  film_start (&film, settings);
  for (guint frame = 0; frame < 8; frame++)
    film_push (&film, frame);
  fail_unless_equals_int ((gint) film.n_lost, 0);
  track = gst_bin_get_by_name (GST_BIN (film.h->element), "track");
  g_object_set (track, "link", TRUE, NULL);
  film.half = TRUE;
  score = film_push (&film, 8);
  fail_unless_equals_int ((gint) score.wrong, 0);
  fail_unless (score.black >= N_BLACK / 4, "%u squares", score.black);
  fail_unless (film.n_lost >= N_BLACK / 4, "%u squares lost", film.n_lost);
  film_clear (&film);
}

GST_END_TEST;

/* With linking a wrong seed can't even begin to slip. */
GST_START_TEST (test_wrong_seed_overruled)
{
  g_autofree gchar *seed = NULL;
  Film film = { NULL };

  film_init (&film, COLUMNS, ROWS, TRUE);
  film_render (&film, 0);
  seed = film_seed (&film, 4, 4, 5, 5);
  film_start (&film, seed);
  for (guint frame = 0; frame < 4; frame++) {
    Score score = film_push (&film, frame);

    fail_unless_equals_int ((gint) score.wrong, 0);
    fail_unless (score.black >= N_BLACK * 9 / 10, "%u squares", score.black);
  }
  film_clear (&film);
}

GST_END_TEST;

/* The property squares: those of the colour asked for, none of the other. */
GST_START_TEST (test_colours)
{
  static const struct
  {
    const gchar *settings;
    guint black, white;
  } cases[] = { {"squares=black", 31, 0},
  /* White squares on the rim of white cloth have no edge there. */
  {"squares=white", 0, 24}, {"squares=both", 31, 24}
  };

  for (gint coded = 0; coded < 2; coded++)
    for (guint k = 0; k < G_N_ELEMENTS (cases); k++) {
      Film film = { NULL };

      film_init (&film, COLUMNS, ROWS - 1 + coded, coded);
      film_start (&film, cases[k].settings);
      for (guint frame = 0; frame < 3; frame++) {
        Score score = film_push (&film, frame);

        fail_unless_equals_int ((gint) score.wrong, 0);
        fail_unless (score.black >= cases[k].black
            && (score.black > 0) == (cases[k].black > 0),
            "%s: %u black squares", cases[k].settings, score.black);
        fail_unless (score.white >= cases[k].white
            && (score.white > 0) == (cases[k].white > 0),
            "%s: %u white squares", cases[k].settings, score.white);
      }
      film_clear (&film);
    }
}

GST_END_TEST;

/* Boards of two columns or rows have no square between four inner corners, so linking can't
 * find them, and says so; from a seed they are tracked like any. A plain board that looks
 * the same in four ways is taken for upright. */
GST_START_TEST (test_narrow)
{
  static const struct
  {
    gint columns, rows;
    gboolean found;
  } sizes[] = { {2, 8, FALSE}, {8, 2, FALSE}, {3, 4, TRUE}, {5, 5, TRUE} };

  for (guint k = 0; k < G_N_ELEMENTS (sizes); k++)
    for (gint given = 0; given < 2; given++) {
      g_autofree gchar *seed = NULL, *settings = NULL;
      g_autoptr (GstElement) track = NULL;
      g_autoptr (GstBus) bus = gst_bus_new ();
      Film film = { NULL };
      Score score = { 0 };
      GstMessage *message;

      film_init (&film, sizes[k].columns, sizes[k].rows, FALSE);
      film_render (&film, 0);
      seed = film_seed (&film, 0, 0, 0, 0);
      settings = g_strdup_printf ("link=%s %s", given ? "false" : "true",
          given ? seed : "");
      film_start (&film, settings);
      track = gst_bin_get_by_name (GST_BIN (film.h->element), "track");
      gst_element_set_bus (track, bus);
      for (guint frame = 0; frame < (given ? 7 : 2); frame++)
        score = film_push (&film, frame);
      fail_unless_equals_int ((gint) score.wrong, 0);
      fail_unless_equals_int ((gint) score.black,
          given
          || sizes[k].found ? (sizes[k].columns * sizes[k].rows + 1) / 2 : 0);
      message = gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING);
      fail_unless ((message != NULL) == (!given && !sizes[k].found));
      if (message)
        gst_message_unref (message);
      fail_unless (gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING) == NULL);
      gst_element_set_bus (track, NULL);
      film_clear (&film);
    }
}

GST_END_TEST;

static Suite *
quadtrackboards_suite (void)
{
  Suite *suite = suite_create ("quadtrackboards");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (suite, tc);
  tcase_add_test (tc, test_slip_mended);
  tcase_add_test (tc, test_slip_lost);
  tcase_add_test (tc, test_wrong_seed_overruled);
  tcase_add_test (tc, test_colours);
  tcase_add_test (tc, test_narrow);
  return suite;
}

GST_CHECK_MAIN (quadtrackboards);
