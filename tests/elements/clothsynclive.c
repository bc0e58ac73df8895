/* GstClothSync: deadlines of live streams, pads that come and go, what no stream should send.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clockwait.h"
#include "tests/elements/clothsyncbench.h"

/* ---- live ---- */

static GstTestClock *
bench_clock (Bench * b)
{
  return gst_harness_get_testclock (b->src);
}

GST_START_TEST (test_live_deadline)
{
  Bench b;
  GstTestClock *clock;
  g_autoptr (GstMessage) qos = NULL;
  GstClockTime timestamp;
  GstFormat format;
  guint64 dropped;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);

  /* one camera is silent: the deadline is the set's time plus the tolerance */
  push (&b, 0, 33 * MS);
  wait_for_deadline (clock,
      33 * MS + gst_util_uint64_scale (GST_SECOND, 1, 30) / 2);
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  fail_unless (gst_test_clock_crank (clock));
  expect (&b, 33 * MS, 1);

  /* its frame comes too late for that set: dropped, said, and the next one is good */
  push (&b, 1, 40 * MS);
  push (&b, 0, 66 * MS);
  push (&b, 1, 66 * MS);
  expect (&b, 66 * MS, 3);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 1);
  qos = message_of (&b, GST_MESSAGE_QOS);
  fail_unless (qos != NULL);
  gst_message_parse_qos (qos, NULL, NULL, NULL, &timestamp, NULL);
  fail_unless_equals_uint64 (timestamp, 40 * MS);
  gst_message_parse_qos_stats (qos, &format, NULL, &dropped);
  fail_unless_equals_int (format, GST_FORMAT_BUFFERS);
  fail_unless_equals_uint64 (dropped, 1);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* The end sums up what the sets lacked; %NULL: nothing that is worth a word. */
static void
expect_loss (Bench * b, const gchar * says)
{
  g_autoptr (GstMessage) warning = NULL;
  g_autoptr (GError) error = NULL;

  eos (b, 0);
  eos (b, 1);
  expect_eos (b);
  warning = message_of (b, GST_MESSAGE_WARNING);
  fail_unless ((warning != NULL) == (says != NULL));
  if (warning) {
    gst_message_parse_warning (warning, &error, NULL);
    fail_unless (strstr (error->message, says) != NULL, "%s", error->message);
  }
}

/* The message says which pad fell silent or is back, and how long it was silent. */
static void
expect_silence (Bench * b, const gchar * name, guint pad, gdouble seconds)
{
  g_autoptr (GstMessage) message =
      gst_bus_timed_pop_filtered (b->bus, 10 * GST_SECOND, GST_MESSAGE_ELEMENT);
  g_autofree gchar *expected = g_strdup_printf ("sink_%u", pad);
  const GstStructure *s;
  gdouble said;

  fail_unless (message != NULL, "no %s", name);
  s = gst_message_get_structure (message);
  fail_unless (gst_structure_has_name (s, name), "%s",
      gst_structure_get_name (s));
  fail_unless_equals_string (gst_structure_get_string (s, "pad"), expected);
  fail_unless_equals_string (gst_structure_get_string (s, "camera"), "");
  fail_unless (gst_structure_get_double (s, "seconds", &said));
  fail_unless_equals_float (said, seconds);
}

static void
expect_no_silence (Bench * b)
{
  g_autoptr (GstMessage) message = message_of (b, GST_MESSAGE_ELEMENT);

  fail_unless (message == NULL);
}

/* The set of @mask, which lacks a pad, ends at its deadline; @pad gives the last of it. */
static void
push_beside (Bench * b, GstTestClock * clock, guint pad, GstClockTime pts,
    guint64 mask)
{
  GstClockTime tolerance, latency;

  g_object_get (b->sync, "tolerance", &tolerance, "latency", &latency, NULL);
  push (b, pad, pts);
  for (guint i = 0; i < MAX_PADS; i++) {
    settle (b, i);
  }
  wait_for_deadline (clock, pts + latency +
      (GST_CLOCK_TIME_IS_VALID (tolerance) ? tolerance : GST_SECOND / 60));
  fail_unless (gst_test_clock_crank (clock));
  expect (b, pts, mask);
}

/* One pad gives. */
static void
push_alone (Bench * b, GstTestClock * clock, guint pad, GstClockTime pts)
{
  push_beside (b, clock, pad, pts, 1 << pad);
}

GST_START_TEST (test_live_silent_pad)
{
  GstTestClock *clock;
  GstClockTime pts;
  Bench b;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  for (pts = 110 * MS; pts < 1000 * MS; pts += 110 * MS) {
    push_alone (&b, clock, 0, pts);
  }
  expect_no_silence (&b);
  push_alone (&b, clock, 0, 1100 * MS);
  expect_silence (&b, "sync/silent", 1, 1.1);
  push_alone (&b, clock, 0, 1150 * MS); /* once is enough */
  expect_no_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "incomplete"), 11);
  fail_unless_equals_uint64 (stat_of (&b, "sets"), 12);
  fail_unless_equals_uint64 (stat_of_pad (&b, 0, "missing"), 0);
  fail_unless_equals_uint64 (stat_of_pad (&b, 1, "missing"), 11);
  fail_unless_equals_uint64 (stat_of_pad (&b, 1, "used"), 1);

  push (&b, 0, 1200 * MS);
  push (&b, 1, 1200 * MS);
  expect (&b, 1200 * MS, 3);
  expect_silence (&b, "sync/back", 1, 1.2);
  fail_unless_equals_uint64 (stat_of (&b, "incomplete"), 11);
  expect_loss (&b,
      "11 of 13 sets lacked a picture: that of pad sink_1 in 11 (0 "
      "came too late)");
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* A camera that never gives anything, with caps or without them, is told of as one that
 * fell silent is; every set lacks it. */
GST_START_TEST (test_live_never)
{
  GstTestClock *clock;
  GstClockTime pts;
  Bench b;

  bench_init (&b, 2, TRUE);
  bench_remove_pad (&b, 1);
  bench_add_pad (&b, 1, __i__ ? "test/x-frames,framerate=30/1" : NULL);
  gst_harness_set_live (b.in[1], TRUE);
  clock = bench_clock (&b);
  for (pts = 0; pts < 1000 * MS; pts += 110 * MS) {
    push_alone (&b, clock, 0, pts);
  }
  expect_no_silence (&b);
  push_alone (&b, clock, 0, pts);
  expect_silence (&b, "sync/silent", 1, 1.1);
  expect_no_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "incomplete"), 11);
  fail_unless_equals_uint64 (stat_of (&b, "sets"), 11);
  fail_unless_equals_uint64 (stat_of_pad (&b, 1, "missing"), 11);
  fail_unless_equals_uint64 (stat_of_pad (&b, 1, "used"), 0);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* None of the cameras ever gives anything. */
GST_START_TEST (test_live_none_ever)
{
  GstTestClock *clock;
  Bench b;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  /* as a pipeline does that plays */
  gst_harness_query_latency (b.src);
  wait_for_deadline (clock, GST_SECOND + GST_SECOND / 60);
  expect_no_silence (&b);
  gst_test_clock_set_time (clock, 2 * GST_SECOND);
  fail_unless (gst_test_clock_crank (clock));
  expect_silence (&b, "sync/silent", 0, 2.);
  expect_silence (&b, "sync/silent", 1, 2.);
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  fail_unless_equals_int (gst_test_clock_peek_id_count (clock), 0);
  push (&b, 0, 3 * GST_SECOND);
  push (&b, 1, 3 * GST_SECOND);
  expect (&b, 3 * GST_SECOND, 3);
  expect_silence (&b, "sync/back", 0, 3.);
  expect_silence (&b, "sync/back", 1, 3.);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* A camera that is linked later has its time from then on. */
GST_START_TEST (test_live_linked_later)
{
  GstTestClock *clock;
  GstClockTime pts;
  Bench b;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  push (&b, 0, 5000 * MS);
  push (&b, 1, 5000 * MS);
  expect (&b, 5000 * MS, 3);
  gst_test_clock_set_time (clock, 5000 * MS);
  bench_add_pad (&b, 2, NULL);
  gst_harness_set_live (b.in[2], TRUE);
  for (pts = 5110 * MS; pts < 6000 * MS; pts += 110 * MS) {
    push (&b, 1, pts);
    push_beside (&b, clock, 0, pts, 3);
  }
  expect_no_silence (&b);
  push (&b, 1, pts);
  push_beside (&b, clock, 0, pts, 3);
  expect_silence (&b, "sync/silent", 2, 1.1);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* Films are waited for: one that never comes is not silent. */
GST_START_TEST (test_film_never)
{
  g_autoptr (GstMessage) early = NULL, warning = NULL, more = NULL;
  const GstStructure *details;
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  gst_test_clock_set_time (bench_clock (&b), 10 * GST_SECOND);
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  expect_no_silence (&b);
  eos (&b, 1);
  expect (&b, 0, 1);
  expect_no_silence (&b);
  /* at the end it is told which stream was never used; that of the other is not */
  early = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (early == NULL);
  eos (&b, 0);
  expect_eos (&b);
  warning = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (warning != NULL);
  gst_message_parse_warning_details (warning, &details);
  fail_unless_equals_string (gst_structure_get_string (details, "pad"),
      "sink_1");
  more = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (more == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* A slow camera is given five of its frames. */
GST_START_TEST (test_live_not_silent)
{
  GstTestClock *clock;
  GstClockTime pts;
  Bench b;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  caps (&b, 1, "test/x-frames,framerate=2/1");
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  for (pts = 490 * MS; pts < 2500 * MS; pts += 490 * MS) {
    push_alone (&b, clock, 0, pts);
  }
  expect_no_silence (&b);
  push_alone (&b, clock, 0, pts);
  expect_silence (&b, "sync/silent", 1, 2.94);
  expect_no_silence (&b);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* Films that end are not silent, but sets lack them. */
GST_START_TEST (test_film_ends)
{
  guint i;
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  eos (&b, 1);
  for (i = 1; i < 4; i++) {
    push (&b, 0, i * GST_SECOND);
    expect (&b, i * GST_SECOND, 1);
  }
  expect_no_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "incomplete"), 3);
  fail_unless_equals_uint64 (stat_of (&b, "skipped"), 0);
  bench_clear (&b);
}

GST_END_TEST;

/* No camera sends: that is said once, nothing comes out, and nothing spins. */
GST_START_TEST (test_live_silence)
{
  Bench b;
  GstTestClock *clock;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  wait_for_deadline (clock, GST_SECOND + GST_SECOND / 60);
  expect_no_silence (&b);
  gst_test_clock_set_time (clock, 10 * GST_SECOND);
  fail_unless (gst_test_clock_crank (clock));
  expect_silence (&b, "sync/silent", 0, 10.);
  expect_silence (&b, "sync/silent", 1, 10.);
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  fail_unless_equals_int (gst_test_clock_peek_id_count (clock), 0);
  push (&b, 0, 10 * GST_SECOND);
  push (&b, 1, 10 * GST_SECOND);
  expect (&b, 10 * GST_SECOND, 3);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* The first frame that misses its deadline is told of, with the time that it lacked. */
GST_START_TEST (test_live_late)
{
  g_autoptr (GstMessage) warning = NULL, more = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;
  const GstStructure *details;
  GstTestClock *clock;
  gdouble seconds;
  Bench b;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  g_object_set (b.sync, "tolerance", (guint64) 10 * MS, "latency",
      (guint64) 20 * MS, NULL);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  push_alone (&b, clock, 0, 100 * MS);  /* it is 130 ms now */
  warning = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (warning == NULL);
  gst_test_clock_set_time (clock, 187 * MS);
  push (&b, 1, 105 * MS);       /* of the set of 100 ms */
  push (&b, 0, 200 * MS);
  push (&b, 1, 200 * MS);
  expect (&b, 200 * MS, 3);
  warning = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (warning != NULL);
  gst_message_parse_warning (warning, &error, &debug);
  fail_unless (strstr (error->message, "pad sink_1") != NULL, "%s",
      error->message);
  fail_unless (strstr (error->message, " 57 ms too late") != NULL, "%s",
      error->message);
  fail_unless (strstr (debug, "latency, now 20 ms") != NULL, "%s", debug);
  gst_message_parse_warning_details (warning, &details);
  fail_unless (gst_structure_get_double (details, "seconds", &seconds));
  fail_unless_equals_float (seconds, 0.057);
  fail_unless_equals_string (gst_structure_get_string (details, "pad"),
      "sink_1");

  push_alone (&b, clock, 0, 300 * MS);
  gst_test_clock_set_time (clock, 400 * MS);
  push (&b, 1, 300 * MS);
  push (&b, 0, 400 * MS);
  push (&b, 1, 400 * MS);
  expect (&b, 400 * MS, 3);
  more = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (more == NULL);
  fail_unless_equals_uint64 (stat_of_pad (&b, 1, "dropped"), 2);
  expect_loss (&b, "2 of 5 sets lacked a picture: that of pad sink_1 in 2 (2 "
      "came too late)");
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* Out of order is not late: a film has no deadline. */
GST_START_TEST (test_film_not_late)
{
  g_autoptr (GstMessage) warning = NULL;
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 100 * MS);
  push (&b, 1, 100 * MS);
  expect (&b, 100 * MS, 3);
  push (&b, 0, 50 * MS);
  push (&b, 0, 133 * MS);
  push (&b, 1, 133 * MS);
  expect (&b, 133 * MS, 3);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 1);
  warning = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (warning == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* What detectors take is waited for unless the user says otherwise. */
GST_START_TEST (test_live_latency_default)
{
  GstElement *sync = gst_object_ref_sink (g_object_new (TEST_TYPE_SYNC, NULL));
  guint64 latency;

  g_object_get (sync, "latency", &latency, NULL);
  fail_unless_equals_uint64 (latency, 200 * MS);
  gst_object_unref (sync);
}

GST_END_TEST;

GST_START_TEST (test_live_latency)
{
  Bench b;

  bench_init (&b, 2, TRUE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  gst_harness_set_upstream_latency (b.in[0], 20 * MS);
  gst_harness_set_upstream_latency (b.in[1], 10 * MS);
  g_object_set (b.sync, "latency", (guint64) 7 * MS, "tolerance",
      (guint64) 5 * MS, NULL);
  gst_cloth_sync_set_pad_offset (GST_CLOTH_SYNC (b.sync), 0, 2 * MS);
  fail_unless_equals_uint64 (gst_harness_query_latency (b.src), 34 * MS);
  bench_clear (&b);
}

GST_END_TEST;

/* One stream waits for nothing; that others come and go is told. */
GST_START_TEST (test_live_latency_alone)
{
  Bench b;

  bench_init (&b, 1, TRUE);
  push (&b, 0, 0);
  expect (&b, 0, 1);
  gst_harness_set_upstream_latency (b.in[0], 20 * MS);
  /* so that the number of pads is all that changes */
  g_object_set (b.sync, "latency", (guint64) 200 * MS, "tolerance",
      (guint64) 0, NULL);
  fail_unless_equals_uint64 (gst_harness_query_latency (b.src), 20 * MS);
  gst_cloth_sync_set_pad_offset (GST_CLOTH_SYNC (b.sync), 0, 2 * MS);
  fail_unless_equals_uint64 (gst_harness_query_latency (b.src), 22 * MS);
  gst_bus_set_flushing (b.bus, TRUE);
  gst_bus_set_flushing (b.bus, FALSE);
  bench_add_pad (&b, 1, "test/x-frames,framerate=30/1");
  gst_harness_set_live (b.in[1], TRUE);
  gst_message_unref (gst_bus_pop_filtered (b.bus, GST_MESSAGE_LATENCY));
  fail_unless_equals_uint64 (gst_harness_query_latency (b.src), 222 * MS);
  gst_bus_set_flushing (b.bus, TRUE);
  gst_bus_set_flushing (b.bus, FALSE);
  bench_remove_pad (&b, 1);
  gst_message_unref (gst_bus_pop_filtered (b.bus, GST_MESSAGE_LATENCY));
  fail_unless_equals_uint64 (gst_harness_query_latency (b.src), 22 * MS);
  bench_clear (&b);
}

GST_END_TEST;

/* ---- seeking ---- */

typedef struct
{
  gboolean answers, seekable;
  gint64 start, stop;
} Range;

static const Range *ranges[2];
static GstPadQueryFunction harness_query;

static gboolean
answer_seeking (GstPad * pad, GstObject * parent, GstQuery * query)
{
  const Range *range = ranges[GPOINTER_TO_UINT (g_object_get_data (G_OBJECT
              (pad), "number"))];
  GstFormat format;

  if (GST_QUERY_TYPE (query) != GST_QUERY_SEEKING) {
    return harness_query (pad, parent, query);
  }
  gst_query_parse_seeking (query, &format, NULL, NULL, NULL);
  fail_unless_equals_int (format, GST_FORMAT_TIME);
  gst_query_set_seeking (query, format, range->seekable, range->start,
      range->stop);
  return range->answers;
}

/* What is joined can be sought where all streams can. */
GST_START_TEST (test_seeking)
{
  static const Range all = { TRUE, TRUE, 0, -1 }, film =
      { TRUE, TRUE, 0, 9 * GST_SECOND };
  static const Range part = { TRUE, TRUE, GST_SECOND, 10 * GST_SECOND };
  static const Range none = { TRUE, FALSE, 0, 9 * GST_SECOND };
  static const Range silent = { FALSE, TRUE, 0, 9 * GST_SECOND };
  static const struct
  {
    const Range *range[2], is;
  } cases[] = {
    {{&all, &all}, {TRUE, TRUE, 0, -1}},
    {{&all, &film}, {TRUE, TRUE, 0, 9 * GST_SECOND}},
    {{&film, &all}, {TRUE, TRUE, 0, 9 * GST_SECOND}},
    {{&part, &film}, {TRUE, TRUE, GST_SECOND, 9 * GST_SECOND}},
    {{&film, &part}, {TRUE, TRUE, GST_SECOND, 9 * GST_SECOND}},
    {{&none, &film}, {TRUE, FALSE, 0, -1}},
    {{&film, &none}, {TRUE, FALSE, 0, -1}},
    {{&film, &silent}, {TRUE, FALSE, 0, -1}},
  };
  Bench b;

  bench_init (&b, 2, FALSE);
  harness_query = GST_PAD_QUERYFUNC (b.in[0]->srcpad);
  for (guint i = 0; i < 2; i++) {
    g_object_set_data (G_OBJECT (b.in[i]->srcpad), "number",
        GUINT_TO_POINTER (i));
    gst_pad_set_query_function (b.in[i]->srcpad, answer_seeking);
  }
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GstQuery) query = gst_query_new_seeking (GST_FORMAT_TIME);
    gboolean seekable;
    gint64 start, stop;

    ranges[0] = cases[i].range[0];
    ranges[1] = cases[i].range[1];
    fail_unless (gst_pad_peer_query (b.src->sinkpad, query));
    gst_query_parse_seeking (query, NULL, &seekable, &start, &stop);
    fail_unless_equals_int (seekable, cases[i].is.seekable);
    fail_unless_equals_int64 (start, cases[i].is.start);
    fail_unless_equals_int64 (stop, cases[i].is.stop);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* ---- changes under way ---- */

GST_START_TEST (test_flush)
{
  GstSegment segment;
  Bench b;
  guint32 seqnum;
  guint i;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  push (&b, 0, 33 * MS);        /* is flushed away */
  settle (&b, 0);
  gst_segment_init (&segment, GST_FORMAT_TIME);
  /* one seek, so one sequence number, reaches all pads */
  seqnum = gst_util_seqnum_next ();
  for (i = 0; i < 2; i++) {
    GstEvent *event = gst_event_new_flush_start ();

    gst_event_set_seqnum (event, seqnum);
    fail_unless (gst_harness_push_event (b.in[i], event));
  }
  for (i = 0; i < 2; i++) {
    GstEvent *event = gst_event_new_flush_stop (TRUE);

    gst_event_set_seqnum (event, seqnum);
    fail_unless (gst_harness_push_event (b.in[i], event));
    fail_unless (gst_harness_push_event (b.in[i],
            gst_event_new_segment (&segment)));
  }
  /* running time starts again: nothing is late */
  for (i = 0; i < 2; i++) {
    push (&b, i, 0);
  }
  expect (&b, 0, 3);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 0);
  fail_unless (TEST_SYNC (b.sync)->n_resets >= 2);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_caps_change)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  fail_unless_equals_int (TEST_SYNC (b.sync)->n_caps, 2);
  caps (&b, 0, "test/x-frames,framerate=25/1");
  push (&b, 0, 40 * MS);
  push (&b, 1, 40 * MS);
  expect (&b, 40 * MS, 3);
  fail_unless_equals_int (TEST_SYNC (b.sync)->n_caps, 3);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_pads_come_and_go)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);

  bench_add_pad (&b, 5, "test/x-frames,framerate=30/1");
  push (&b, 0, 33 * MS);
  push (&b, 1, 33 * MS);
  push (&b, 5, 33 * MS);
  expect (&b, 33 * MS, 0x23);

  /* the set that waited for the pad goes on when it is released */
  push (&b, 0, 66 * MS);
  push (&b, 5, 66 * MS);
  bench_remove_pad (&b, 1);
  push (&b, 0, 99 * MS);
  push (&b, 5, 99 * MS);
  expect (&b, 66 * MS, 0x21);
  expect (&b, 99 * MS, 0x21);
  fail_unless_equals_int (TEST_SYNC (b.sync)->n_gone, 1);

  /* its number is free again */
  bench_add_pad (&b, 1, "test/x-frames,framerate=30/1");
  push (&b, 0, 132 * MS);
  push (&b, 1, 132 * MS);
  push (&b, 5, 132 * MS);
  expect (&b, 132 * MS, 0x23);
  bench_clear (&b);
}

GST_END_TEST;

/* A pad that comes and goes at any moment takes nothing from the other one. */
GST_START_TEST (test_pads_come_and_go_quickly)
{
  GstBuffer *out;
  guint i, n = 0;
  Bench b;

  bench_init (&b, 1, FALSE);
  for (i = 0; i < 80; i++) {
    push (&b, 0, i * 33 * MS);
  }
  for (i = 0; i < 80; i++) {
    bench_add_pad (&b, 1, "test/x-frames,framerate=30/1");
    push (&b, 1, i * 33 * MS);
    bench_remove_pad (&b, 1);
  }
  eos (&b, 0);
  expect_eos (&b);
  while ((out = gst_harness_try_pull (b.src)) != NULL) {
    n += GST_BUFFER_OFFSET (out) & 1;
    gst_buffer_unref (out);
  }
  fail_unless_equals_int (n, 80);
  bench_clear (&b);
}

GST_END_TEST;

/* ---- bad input ---- */

GST_START_TEST (test_no_time_stamp)
{
  g_autoptr (GstMessage) error = NULL;
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, GST_CLOCK_TIME_NONE);
  push (&b, 1, 0);
  error = gst_bus_timed_pop_filtered (b.bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_ERROR);
  fail_unless (error != NULL);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_segment_in_bytes)
{
  g_autoptr (GstMessage) error = NULL;
  GstSegment segment;
  Bench b;

  bench_init (&b, 2, FALSE);
  gst_segment_init (&segment, GST_FORMAT_BYTES);
  give (&b, 0, gst_event_new_segment (&segment));
  error = gst_bus_timed_pop_filtered (b.bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_ERROR);
  fail_unless (error != NULL);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_refused_caps)
{
  g_autoptr (GstMessage) error = NULL;
  Bench b;

  bench_init (&b, 2, FALSE);
  caps (&b, 0, "test/x-frames,refuse=true");
  error = gst_bus_timed_pop_filtered (b.bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_ERROR);
  fail_unless (error != NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* Times that step back would give sets that step back: the frame is dropped. */
GST_START_TEST (test_time_steps_back)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 100 * MS);
  push (&b, 1, 100 * MS);
  expect (&b, 100 * MS, 3);
  push (&b, 0, 50 * MS);
  push (&b, 0, 100 * MS);
  push (&b, 0, 133 * MS);
  push (&b, 1, 133 * MS);
  expect (&b, 133 * MS, 3);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 2);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_bad_pad_names)
{
  GstElement *sync = gst_object_ref_sink (g_object_new (TEST_TYPE_SYNC, NULL));
  GstPad *pad;

  fail_unless (gst_element_request_pad_simple (sync, "sink_64") == NULL);
  fail_unless (gst_element_request_pad_simple (sync,
          "sink_4294967296") == NULL);
  fail_unless (gst_element_request_pad_simple (sync, "sink_x") == NULL);
  pad = gst_element_request_pad_simple (sync, "sink_63");
  fail_unless (pad != NULL);
  gst_element_release_request_pad (sync, pad);
  gst_object_unref (pad);
  gst_object_unref (sync);
}

GST_END_TEST;

GST_START_TEST (test_no_frames_at_all)
{
  Bench b;
  g_autoptr (GstMessage) warning = NULL;

  bench_init (&b, 2, FALSE);
  eos (&b, 0);
  eos (&b, 1);
  expect_eos (&b);
  warning = message_of (&b, GST_MESSAGE_WARNING | GST_MESSAGE_ERROR);
  fail_unless (warning == NULL);
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
clothsynclive_suite (void)
{
  Suite *s = suite_create ("clothsynclive");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_live_deadline);
  tcase_add_test (tc, test_live_silence);
  tcase_add_test (tc, test_live_silent_pad);
  tcase_add_test (tc, test_live_not_silent);
  tcase_add_loop_test (tc, test_live_never, 0, 2);
  tcase_add_test (tc, test_live_none_ever);
  tcase_add_test (tc, test_live_linked_later);
  tcase_add_test (tc, test_film_never);
  tcase_add_test (tc, test_film_ends);
  tcase_add_test (tc, test_live_late);
  tcase_add_test (tc, test_film_not_late);
  tcase_add_test (tc, test_live_latency);
  tcase_add_test (tc, test_live_latency_alone);
  tcase_add_test (tc, test_seeking);
  tcase_add_test (tc, test_live_latency_default);
  tcase_add_test (tc, test_flush);
  tcase_add_test (tc, test_caps_change);
  tcase_add_test (tc, test_pads_come_and_go);
  tcase_add_test (tc, test_pads_come_and_go_quickly);
  tcase_add_test (tc, test_no_time_stamp);
  tcase_add_test (tc, test_segment_in_bytes);
  tcase_add_test (tc, test_refused_caps);
  tcase_add_test (tc, test_time_steps_back);
  tcase_add_test (tc, test_bad_pad_names);
  tcase_add_test (tc, test_no_frames_at_all);
  return s;
}

int
main (int argc, char **argv)
{
  /* the plugin has a GstClothSync of its own: it must not come in by a scan */
  g_setenv ("GST_REGISTRY_DISABLE", "yes", TRUE);
  gst_check_init (&argc, &argv);
  return gst_check_run_suite (clothsynclive_suite (), "clothsynclive",
      __FILE__);
}
