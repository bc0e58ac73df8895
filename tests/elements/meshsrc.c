/* meshsrc: every frame once, at its time; seeks, segments, loops, errors.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>

#include "tests/core/meshpeer.h"

#define TAKE TEST_DATA "/take_drop"
#define FRAMES 32
#define PERIOD (20 * GST_MSECOND)

typedef struct
{
  GstElement *pipeline, *src;
  GstBus *bus;
  GArray *times;                /* guint64 */
  GArray *frames;               /* guint64 */
} Player;

static void
on_mesh (GstElement * sink, GstBuffer * buffer, GstPad * pad, Player * player)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, &error);
  guint64 time = GST_BUFFER_PTS (buffer), frame;

  g_assert_no_error (error);
  frame = gst_cloth_mesh_get_sequence (mesh);
  g_array_append_val (player->times, time);
  g_array_append_val (player->frames, frame);
}

static void
player_init (Player * player, const gchar * location, const gchar * more)
{
  g_autofree gchar *path = *location == '/' ? g_strdup (location) :
      scratch_path (location);
  g_autofree gchar *line = g_strdup_printf ("meshsrc name=src location=%s %s ! "
      "fakesink name=sink signal-handoffs=true", path, more);
  g_autoptr (GstElement) sink = NULL;

  player->pipeline = gst_parse_launch (line, NULL);
  fail_unless (player->pipeline != NULL);
  player->bus = gst_element_get_bus (player->pipeline);
  player->src = gst_bin_get_by_name (GST_BIN (player->pipeline), "src");
  player->times = g_array_new (FALSE, FALSE, sizeof (guint64));
  player->frames = g_array_new (FALSE, FALSE, sizeof (guint64));
  sink = gst_bin_get_by_name (GST_BIN (player->pipeline), "sink");
  g_signal_connect (sink, "handoff", G_CALLBACK (on_mesh), player);
}

static void
player_clear (Player * player)
{
  gst_element_set_state (player->pipeline, GST_STATE_NULL);
  gst_object_unref (player->src);
  gst_object_unref (player->bus);
  gst_object_unref (player->pipeline);
  g_array_unref (player->times);
  g_array_unref (player->frames);
}

static void
preroll (Player * player)
{
  gst_element_set_state (player->pipeline, GST_STATE_PAUSED);
  fail_unless_equals_int (gst_element_get_state (player->pipeline, NULL, NULL,
          GST_CLOCK_TIME_NONE), GST_STATE_CHANGE_SUCCESS);
}

static void
play (Player * player, GstMessageType until)
{
  g_autoptr (GstMessage) message = NULL;

  gst_element_set_state (player->pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (player->bus, GST_CLOCK_TIME_NONE,
      until | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), until);
}

static void
expect_frames (Player * player, gint64 first, gint64 step, guint n)
{
  fail_unless_equals_int (player->frames->len, n);
  for (guint i = 0; i < n; i++) {
    guint64 frame = (guint64) (first + step * i);

    fail_unless_equals_uint64 (g_array_index (player->frames, guint64, i),
        frame);
    fail_unless_equals_uint64 (g_array_index (player->times, guint64, i),
        frame * PERIOD);
  }
  g_array_set_size (player->frames, 0);
  g_array_set_size (player->times, 0);
}

static void
expect_error (const gchar * location, const gchar * more, GQuark domain,
    gint code, const gchar * text)
{
  Player player;
  g_autoptr (GstMessage) message = NULL, second = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;
  gboolean at_start;

  player_init (&player, location, more);
  at_start = gst_element_set_state (player.pipeline, GST_STATE_PLAYING)
      == GST_STATE_CHANGE_FAILURE;
  message = gst_bus_timed_pop_filtered (player.bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_ERROR);
  gst_message_parse_error (message, &error, &debug);
  /* what to do stands on a line of its own */
  fail_unless (strstr (debug, ":\n") != NULL, "%s: %s", error->message, debug);
  fail_unless (g_error_matches (error, domain, code), "%s %d: %s",
      g_quark_to_string (error->domain), error->code, error->message);
  fail_unless (strstr (error->message, text) != NULL, "%s", error->message);
  second = gst_bus_pop_filtered (player.bus, GST_MESSAGE_ERROR);
  fail_unless (!at_start || !second);   /* one is enough */
  player_clear (&player);
}

/* A pad that is let rest and woken again begins anew, without a change of the element's state. */
GST_START_TEST (test_pad_reactivated)
{
  GstHarness *h = gst_harness_new ("meshsrc");
  GstPad *pad = gst_element_get_static_pad (h->element, "src");

  g_object_set (h->element, "location", TAKE, NULL);
  gst_harness_play (h);
  gst_buffer_unref (gst_harness_pull (h));
  for (guint i = 0; i < 2; i++) {
    fail_unless (gst_pad_set_active (pad, FALSE));
    fail_unless (gst_pad_set_active (pad, TRUE));
  }
  gst_object_unref (pad);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* The same take through every format and back. */
GST_START_TEST (test_plays_all)
{
  static const gchar *const names[] = { "c.obj", "c.ply", "c.take" };

  scratch_begin ();
  for (guint i = 0; i <= G_N_ELEMENTS (names); i++) {
    Player player;
    gint64 duration;

    if (i > 0) {
      g_autofree gchar *path = scratch_path (names[i - 1]);
      g_autofree gchar *line = g_strdup_printf ("meshsrc location=%s ! "
          "meshsink location=%s", TAKE, path);
      g_autoptr (GstElement) pipeline = gst_parse_launch (line, NULL);
      g_autoptr (GstBus) bus = gst_element_get_bus (pipeline);
      g_autoptr (GstMessage) message = NULL;

      gst_element_set_state (pipeline, GST_STATE_PLAYING);
      message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
          GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
      fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_EOS);
      gst_element_set_state (pipeline, GST_STATE_NULL);
    }
    player_init (&player, i > 0 ? names[i - 1] : TAKE, "");
    preroll (&player);
    fail_unless (gst_element_query_duration (player.pipeline, GST_FORMAT_TIME,
            &duration));
    fail_unless_equals_int64 (duration, FRAMES * PERIOD);
    play (&player, GST_MESSAGE_EOS);
    expect_frames (&player, 0, 1, FRAMES);
    player_clear (&player);
  }
  /* What went through is what NumPy finds in the source. */
  peer_run ("a=np.load('" TAKE "/positions.npy')\n"
      "b=np.load('c.take/positions.npy')\n"
      "assert np.array_equal(a,b,equal_nan=True) and np.isnan(a).any()\n"
      "c=np.frombuffer(open('c.pc2','rb').read()[32:],'<f4').reshape(a.shape)\n"
      "s=~np.isnan(a)\n"
      "assert (c[s]==a[s]).all() and np.isfinite(c).all()\n"
      "d=np.diff(c.reshape(len(c),-1,3),axis=0)[~s.all(2)[1:]]\n"
      "assert len(d)>300\n"
      "h=(d==0).all(1).sum(); assert h==len(d),(h,len(d))\n"
      "assert np.allclose(np.load('c.take/times.npy'),np.arange(32)/50)\n");
  scratch_end ();
}

GST_END_TEST;

static void
seek (Player * player, gdouble rate, GstSeekFlags flags, gint64 start,
    gint64 stop)
{
  fail_unless (gst_element_seek (player->pipeline, rate, GST_FORMAT_TIME, flags,
          GST_SEEK_TYPE_SET, start, stop < 0 ? GST_SEEK_TYPE_NONE :
          GST_SEEK_TYPE_SET, stop));
}

GST_START_TEST (test_seeks)
{
  static const struct
  {
    gdouble rate;
    gint64 start, stop;
    gint first, step;
    guint n;
  } cases[] = {
    {1, 0, -1, 0, 1, FRAMES},
    {1, 10 * PERIOD, -1, 10, 1, 22},
    {1, 10 * PERIOD - 1, -1, 9, 1, 23},
    {1, 10 * PERIOD + 1, -1, 10, 1, 22},
    /* a stop is not part of the segment */
    {1, 4 * PERIOD, 8 * PERIOD, 4, 1, 4},
    {1, 4 * PERIOD, 8 * PERIOD + 1, 4, 1, 5},
    {1, 31 * PERIOD, -1, 31, 1, 1},
    {2, 30 * PERIOD, -1, 30, 1, 2},
    {-1, 0, FRAMES * PERIOD, 31, -1, FRAMES},
    {-1, 4 * PERIOD, 8 * PERIOD, 7, -1, 4},
    {-1, 4 * PERIOD + 1, 8 * PERIOD + 1, 8, -1, 5},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    Player player;

    player_init (&player, TAKE, "");
    preroll (&player);
    seek (&player, cases[i].rate, GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE,
        cases[i].start, cases[i].stop);
    play (&player, GST_MESSAGE_EOS);
    GST_INFO ("case %u: %u frames", i, player.frames->len);
    expect_frames (&player, cases[i].first, cases[i].step, cases[i].n);
    player_clear (&player);
  }
}

GST_END_TEST;

GST_START_TEST (test_seek_from_end)
{
  Player player;

  player_init (&player, TAKE, "");
  preroll (&player);
  fail_unless (gst_element_seek (player.pipeline, 1, GST_FORMAT_TIME,
          GST_SEEK_FLAG_FLUSH, GST_SEEK_TYPE_END, -3 * (gint64) PERIOD,
          GST_SEEK_TYPE_NONE, -1));
  play (&player, GST_MESSAGE_EOS);
  expect_frames (&player, 29, 1, 3);
  player_clear (&player);
}

GST_END_TEST;

/* Segment seeks loop without a gap: no EOS, no frame lost or twice. */
GST_START_TEST (test_loops)
{
  Player player;

  player_init (&player, TAKE, "");
  preroll (&player);
  seek (&player, 1, GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_SEGMENT, 2 * PERIOD,
      6 * PERIOD);
  for (guint turn = 0; turn < 3; turn++) {
    play (&player, GST_MESSAGE_SEGMENT_DONE);
    expect_frames (&player, 2, 1, 4);
    if (turn < 2)
      seek (&player, 1, GST_SEEK_FLAG_SEGMENT, 2 * PERIOD, 6 * PERIOD);
  }
  player_clear (&player);
}

GST_END_TEST;

GST_START_TEST (test_rates)
{
  Player player;
  g_autoptr (GstQuery) query = gst_query_new_seeking (GST_FORMAT_TIME);
  g_autoptr (GstPad) pad = NULL;
  g_autoptr (GstCaps) caps = NULL;
  gboolean seekable;
  gint64 start, stop;
  gint n, d;

  player_init (&player, TAKE, "fps=30000/1001");
  preroll (&player);
  fail_unless (gst_element_query (player.src, query));
  gst_query_parse_seeking (query, NULL, &seekable, &start, &stop);
  fail_unless (seekable);
  fail_unless_equals_int64 (start, 0);
  fail_unless_equals_int64 (stop, 1067733333);
  pad = gst_element_get_static_pad (player.src, "src");
  caps = gst_pad_get_current_caps (pad);
  fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
          "framerate", &n, &d));
  fail_unless_equals_int (n, 30000);
  fail_unless_equals_int (d, 1001);
  play (&player, GST_MESSAGE_EOS);
  fail_unless_equals_uint64 (g_array_index (player.times, guint64, 30),
      1001 * GST_MSECOND);
  player_clear (&player);
}

GST_END_TEST;

/* Of a take that has times only, as import writes them, even ones are a frame rate: files that
 * count frames would be played at another one. */
GST_START_TEST (test_even_times)
{
  static const struct
  {
    const gchar *times;
    guint n_frames;
    gint n, d;
  } cases[] = {
    {"np.arange(32)/50", 32, 50, 1},
    {"7+np.arange(32)/12.5", 32, 25, 2},
    /* as a table has them */
    {"np.round(np.arange(32)/30,6)", 32, 30, 1},
    {"np.arange(32)/50+.004*(np.arange(32)%2)", 32, 0, 1},
    {"np.zeros(1)", 1, 0, 1},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *script = g_strdup_printf ("import json\nos.mkdir('t')\n"
        "j=json.load(open('" TAKE "/take.json'))\n"
        "del j['fps']; j['held']=[]\n"
        "json.dump(j,open('t/take.json','w'))\n"
        "np.save('t/positions.npy',np.load('" TAKE "/positions.npy')[:%u])\n"
        "np.save('t/times.npy',%s)\n", cases[i].n_frames, cases[i].times);
    g_autoptr (GstPad) pad = NULL;
    g_autoptr (GstCaps) caps = NULL;
    Player player;
    gint n, d;

    scratch_begin ();
    peer_run (script);
    player_init (&player, "t", "");
    preroll (&player);
    pad = gst_element_get_static_pad (player.src, "src");
    caps = gst_pad_get_current_caps (pad);
    fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
            "framerate", &n, &d));
    fail_unless_equals_int (n, cases[i].n);
    fail_unless_equals_int (d, cases[i].d);
    player_clear (&player);
    scratch_end ();
  }
}

GST_END_TEST;

/* times.npy decides when it is there; the last frame lasts as the one before. */
GST_START_TEST (test_times)
{
  static const guint64 expected[] = { 500, 600, 1000, 1250 };
  Player player;
  gint64 duration;

  scratch_begin ();
  peer_run ("import json\nos.mkdir('t')\n"
      "j=json.load(open('" TAKE "/take.json'))\n"
      "del j['fps']; j['held']=[]\n"
      "json.dump(j,open('t/take.json','w'))\n"
      "np.save('t/positions.npy',np.load('" TAKE "/positions.npy')[:4])\n"
      "np.save('t/times.npy',np.array([.5,.6,1,1.25]))\n");
  player_init (&player, "t", "");
  preroll (&player);
  fail_unless (gst_element_query_duration (player.pipeline, GST_FORMAT_TIME,
          &duration));
  fail_unless_equals_int64 (duration, 1500 * GST_MSECOND);
  play (&player, GST_MESSAGE_EOS);
  fail_unless_equals_int (player.times->len, 4);
  for (guint i = 0; i < 4; i++)
    fail_unless_equals_uint64 (g_array_index (player.times, guint64, i),
        expected[i] * GST_MSECOND);
  player_clear (&player);
  player_init (&player, "t", "");
  preroll (&player);
  seek (&player, 1, GST_SEEK_FLAG_FLUSH, 999 * GST_MSECOND, -1);
  play (&player, GST_MESSAGE_EOS);
  fail_unless_equals_int (player.times->len, 3);
  player_clear (&player);
  /* Times before zero cannot be played as they are, but at a rate they can. */
  peer_run ("np.save('t/times.npy',np.array([-1,.6,1,1.25]))");
  expect_error ("t", "", GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT, "fps");
  player_init (&player, "t", "fps=50/1");
  preroll (&player);
  play (&player, GST_MESSAGE_EOS);
  expect_frames (&player, 0, 1, 4);
  player_clear (&player);
  scratch_end ();
}

GST_END_TEST;

GST_START_TEST (test_files_without_rate)
{
  Player player;

  scratch_begin ();
  peer_run ("open('k.obj','w').write('v 0 0 0\\nv 1 0 0\\nv 0 1 0\\n"
      "f 1 2 3\\n')\n"
      "open('k.pc2','wb').write(b'POINTCACHE2\\0'+struct.pack('<iiffi',1,3,1,1,"
      "4)+bytes(144))\n");
  player_init (&player, "k.obj", "");
  preroll (&player);
  play (&player, GST_MESSAGE_EOS);
  fail_unless_equals_int (player.times->len, 4);
  fail_unless_equals_uint64 (g_array_index (player.times, guint64, 3),
      GST_SECOND / 10);
  player_clear (&player);
  scratch_end ();
}

GST_END_TEST;

/* After stop and start it plays from the beginning, also another file. */
GST_START_TEST (test_restarts)
{
  Player player;

  player_init (&player, TAKE, "");
  for (guint i = 0; i < 3; i++) {
    preroll (&player);
    if (i == 1)
      seek (&player, 1, GST_SEEK_FLAG_FLUSH, 30 * PERIOD, -1);
    play (&player, GST_MESSAGE_EOS);
    expect_frames (&player, i == 1 ? 30 : 0, 1, i == 1 ? 2 : FRAMES);
    gst_element_set_state (player.pipeline, GST_STATE_NULL);
  }
  player_clear (&player);
}

GST_END_TEST;

GST_START_TEST (test_errors)
{
  scratch_begin ();
  expect_error ("none.obj", "", GST_RESOURCE_ERROR,
      GST_RESOURCE_ERROR_NOT_FOUND, "none.obj");
  expect_error ("none.ply", "", GST_RESOURCE_ERROR,
      GST_RESOURCE_ERROR_NOT_FOUND, "none");
  expect_error ("none.take", "", GST_RESOURCE_ERROR,
      GST_RESOURCE_ERROR_NOT_FOUND, "none.take");
  expect_error ("/dev/zero", "format=take", GST_RESOURCE_ERROR,
      GST_RESOURCE_ERROR_READ, "/dev/zero");
  scratch_write ("a.obj", "v 1 2 x\n", -1);
  expect_error ("a.obj", "", GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT,
      "line 1");
  scratch_write ("a.ply", "plyer", -1);
  expect_error ("a.ply", "", GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT, "PLY");
  peer_run ("os.mkdir('t'); open('t/take.json','w').write('{')");
  expect_error ("t", "", GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT,
      "take.json");
  scratch_end ();
}

GST_END_TEST;

/* A frame that turns out bad ends the stream with an error, not with an EOS. */
GST_START_TEST (test_bad_frame)
{
  scratch_begin ();
  peer_run ("import shutil\nshutil.copytree('" TAKE "','t')\n"
      "os.chmod('t',0o755)\n"
      "a=np.load('t/positions.npy'); a[9,8,1]=np.inf\n"
      "os.remove('t/positions.npy'); np.save('t/positions.npy',a)\n");
  expect_error ("t", "", GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT, "frame 9");
  scratch_end ();
}

GST_END_TEST;

GST_START_TEST (test_no_location)
{
  g_autoptr (GstElement) element =
      gst_object_ref_sink (gst_element_factory_make ("meshsrc", NULL));

  fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  gst_element_set_state (element, GST_STATE_NULL);
}

GST_END_TEST;

static Suite *
meshsrc_suite (void)
{
  Suite *suite = suite_create ("meshsrc");
  TCase *tests = tcase_create ("general");

  suite_add_tcase (suite, tests);
  tcase_add_test (tests, test_pad_reactivated);
  tcase_add_test (tests, test_plays_all);
  tcase_add_test (tests, test_seeks);
  tcase_add_test (tests, test_seek_from_end);
  tcase_add_test (tests, test_loops);
  tcase_add_test (tests, test_rates);
  tcase_add_test (tests, test_even_times);
  tcase_add_test (tests, test_times);
  tcase_add_test (tests, test_files_without_rate);
  tcase_add_test (tests, test_restarts);
  tcase_add_test (tests, test_errors);
  tcase_add_test (tests, test_bad_frame);
  tcase_add_test (tests, test_no_location);
  return suite;
}

GST_CHECK_MAIN (meshsrc);
