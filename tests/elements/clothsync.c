/* GstClothSync: which frames of joined streams become a set.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothsyncbench.h"

/* ---- joining ---- */

GST_START_TEST (test_jitter)
{
  static const gint jitter[3][6] = {
    {0, 3, -4, 6, -2, 1}, {2, -3, 5, -1, 7, 0}, {4, 0, 1, -5, 3, -6}
  };
  Bench b;
  gint f, i;

  bench_init (&b, 3, FALSE);
  for (f = 0; f < 6; f++) {
    gint earliest = 1000;

    for (i = 0; i < 3; i++) {
      push (&b, (guint) i, (GstClockTime) (100 + 33 * f + jitter[i][f]) * MS);
      earliest = MIN (earliest, jitter[i][f]);
    }
    expect (&b, (GstClockTime) (100 + 33 * f + earliest) * MS, 7);
  }
  for (i = 0; i < 3; i++) {
    eos (&b, (guint) i);
  }
  expect_eos (&b);
  fail_unless_equals_uint64 (stat_of (&b, "sets"), 6);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 0);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_dropped_frames)
{
  Bench b;
  gint f;

  bench_init (&b, 2, FALSE);
  for (f = 0; f < 8; f++) {
    push (&b, 0, (GstClockTime) f * 33 * MS);
    if (f != 3 && f != 4) {
      push (&b, 1, (GstClockTime) f * 33 * MS);
    }
  }
  eos (&b, 0);
  eos (&b, 1);
  for (f = 0; f < 8; f++) {
    expect (&b, (GstClockTime) f * 33 * MS, f == 3 || f == 4 ? 1 : 3);
  }
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_different_start)
{
  Bench b;
  gint f;

  bench_init (&b, 2, FALSE);
  for (f = 0; f < 3; f++) {
    push (&b, 0, (GstClockTime) f * 33 * MS);
  }
  push (&b, 1, 66 * MS);
  expect (&b, 0, 1);
  expect (&b, 33 * MS, 1);
  expect (&b, 66 * MS, 3);
  bench_clear (&b);
}

GST_END_TEST;

/* Twice as fast on one pad: every other set has both. */
GST_START_TEST (test_framerates)
{
  Bench b;
  gint f;

  bench_init (&b, 2, FALSE);
  caps (&b, 1, "test/x-frames,framerate=60/1");
  for (f = 0; f < 6; f++) {
    if (f % 2 == 0) {
      push (&b, 0, (GstClockTime) f * 16 * MS);
    }
    push (&b, 1, (GstClockTime) f * 16 * MS);
  }
  eos (&b, 0);
  eos (&b, 1);
  for (f = 0; f < 6; f++) {
    expect (&b, (GstClockTime) f * 16 * MS, f % 2 ? 2 : 3);
  }
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* The automatic tolerance is half a frame: 16 ms apart is one set, 17 ms are two. */
GST_START_TEST (test_tolerance)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 16 * MS);
  expect (&b, 0, 3);
  push (&b, 0, 100 * MS);
  push (&b, 1, 117 * MS);
  expect (&b, 100 * MS, 1);
  push (&b, 0, 200 * MS);
  expect (&b, 117 * MS, 2);
  settle (&b, 0);
  g_object_set (b.sync, "tolerance", (guint64) 1 * MS, NULL);
  push (&b, 1, 202 * MS);
  expect (&b, 200 * MS, 1);
  push (&b, 0, 300 * MS);
  expect (&b, 202 * MS, 2);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_pad_offset)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  /* this camera's clock is 500 ms ahead of the common one */
  gst_cloth_sync_set_pad_offset (GST_CLOTH_SYNC (b.sync), 1, 500 * MS);
  push (&b, 0, 0);
  push (&b, 0, 33 * MS);
  push (&b, 1, 467 * MS);       /* before the common time begins */
  push (&b, 1, 500 * MS);
  push (&b, 1, 535 * MS);
  expect (&b, 0, 3);
  expect (&b, 33 * MS, 3);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 1);
  bench_clear (&b);
}

GST_END_TEST;

/* A segment that starts later: what counts is the running time. */
GST_START_TEST (test_running_time)
{
  GstSegment segment;
  Bench b;

  bench_init (&b, 2, FALSE);
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.start = 10 * GST_SECOND;
  segment.time = 10 * GST_SECOND;
  give (&b, 1, gst_event_new_segment (&segment));
  push (&b, 1, 5 * GST_SECOND); /* outside the segment */
  push (&b, 1, 10 * GST_SECOND);
  push (&b, 0, 0);
  expect (&b, 0, 3);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_gap)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  gap (&b, 1, 0, 33 * MS);
  expect (&b, 0, 1);
  push (&b, 0, 33 * MS);
  push (&b, 1, 33 * MS);
  expect (&b, 33 * MS, 3);
  /* one long gap over two frames */
  push (&b, 0, 66 * MS);
  gap (&b, 1, 66 * MS, 66 * MS);
  expect (&b, 66 * MS, 1);
  push (&b, 0, 99 * MS);
  expect (&b, 99 * MS, 1);
  /* gaps everywhere are no set at all */
  gap (&b, 0, 132 * MS, 33 * MS);
  gap (&b, 1, 132 * MS, 33 * MS);
  push (&b, 0, 165 * MS);
  push (&b, 1, 165 * MS);
  expect (&b, 165 * MS, 3);
  /* a gap that doesn't say how long it is */
  gap (&b, 1, 198 * MS, GST_CLOCK_TIME_NONE);
  push (&b, 0, 198 * MS);
  push (&b, 1, 198 * MS);
  expect (&b, 198 * MS, 3);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_one_eos)
{
  Bench b;
  gint f;

  bench_init (&b, 2, FALSE);
  for (f = 0; f < 5; f++) {
    push (&b, 0, (GstClockTime) f * 33 * MS);
    if (f < 2) {
      push (&b, 1, (GstClockTime) f * 33 * MS);
    } else if (f == 2) {
      eos (&b, 1);
    }
    expect (&b, (GstClockTime) f * 33 * MS, f < 2 ? 3 : 1);
  }
  eos (&b, 0);
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* Downstream hears of the sets that are not sent, from the first one on. */
GST_START_TEST (test_gap_for_incomplete)
{
  GstClockTime pts = GST_CLOCK_TIME_NONE, duration;
  gboolean segment = FALSE;
  Bench b;

  bench_init (&b, 2, FALSE);
  g_object_set (b.sync, "min-views", 2, NULL);
  push (&b, 0, 0);
  push (&b, 0, 33 * MS);
  push (&b, 1, 33 * MS);
  while (!GST_CLOCK_TIME_IS_VALID (pts)) {
    GstEvent *event = gst_harness_pull_event (b.src);

    fail_unless (event != NULL);
    segment |= GST_EVENT_TYPE (event) == GST_EVENT_SEGMENT;
    if (GST_EVENT_TYPE (event) == GST_EVENT_GAP) {
      gst_event_parse_gap (event, &pts, &duration);
    }
    gst_event_unref (event);
  }
  fail_unless (segment);
  fail_unless_equals_uint64 (pts, 0);
  fail_unless_equals_uint64 (duration, 33 * MS);
  expect (&b, 33 * MS, 3);
  bench_clear (&b);
}

GST_END_TEST;

/* The next GAP; the SEGMENT events until then are counted. */
static void
expect_gap (Bench * b, GstClockTime pts, GstClockTime duration,
    guint32 seqnum, guint * n_segments)
{
  gboolean found = FALSE;

  while (!found) {
    g_autoptr (GstEvent) event = gst_harness_pull_event (b->src);
    GstClockTime is_pts, is_duration;

    fail_unless (event != NULL, "no gap at %" GST_TIME_FORMAT,
        GST_TIME_ARGS (pts));
    found = GST_EVENT_TYPE (event) == GST_EVENT_GAP;
    if (GST_EVENT_TYPE (event) == GST_EVENT_SEGMENT) {
      (*n_segments)++;
    }
    if (found) {
      gst_event_parse_gap (event, &is_pts, &is_duration);
      fail_unless_equals_uint64 (is_pts, pts);
      fail_unless_equals_uint64 (is_duration, duration);
    }
    if (found || GST_EVENT_TYPE (event) == GST_EVENT_SEGMENT) {
      fail_unless_equals_int (gst_event_get_seqnum (event), seqnum);
    }
  }
}

static void
new_segment (Bench * b, guint i, guint32 seqnum)
{
  GstSegment segment;
  GstEvent *event;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  event = gst_event_new_segment (&segment);
  gst_event_set_seqnum (event, seqnum);
  give (b, i, event);
}

/* What all pads say nothing comes of goes on, and nothing is told twice. */
GST_START_TEST (test_gap_of_all)
{
  const guint32 seqnum = gst_util_seqnum_next ();
  guint n_segments = 0;
  Bench b;

  bench_init (&b, 2, FALSE);
  new_segment (&b, 0, seqnum);
  new_segment (&b, 1, seqnum);
  /* before any frame; the second pad's gap is longer than the first one's */
  gap (&b, 0, 0, 40 * MS);
  gap (&b, 1, 0, 140 * MS);
  expect_gap (&b, 0, 40 * MS, seqnum, &n_segments);
  fail_unless_equals_int (n_segments, 1);
  /* it is still known of then: a frame within it waits for nothing */
  push (&b, 0, 40 * MS);
  expect (&b, 40 * MS, 1);
  /* the frame lasts until 73 ms */
  gap (&b, 0, 60 * MS, 40 * MS);
  expect_gap (&b, 73 * MS, 27 * MS, seqnum, &n_segments);
  gap (&b, 0, 100 * MS, 60 * MS);
  expect_gap (&b, 100 * MS, 40 * MS, seqnum, &n_segments);
  /* one that doesn't say how long it is */
  gap (&b, 1, 150 * MS, GST_CLOCK_TIME_NONE);
  expect_gap (&b, 140 * MS, 10 * MS, seqnum, &n_segments);
  /* one pad alone is all that there are */
  eos (&b, 1);
  expect_gap (&b, 150 * MS, 10 * MS, seqnum, &n_segments);
  gap (&b, 0, 200 * MS, GST_CLOCK_TIME_NONE);
  expect_gap (&b, 200 * MS, GST_CLOCK_TIME_NONE, seqnum, &n_segments);
  push (&b, 0, 200 * MS);
  expect (&b, 200 * MS, 1);
  eos (&b, 0);
  expect_eos (&b);
  fail_unless_equals_int (n_segments, 1);
  fail_unless_equals_int (gst_harness_buffers_received (b.src), 2);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 0);
  bench_clear (&b);
}

GST_END_TEST;

/* One segment goes out, with the number of the seek that it is of, whether a set or a gap is first. */
GST_START_TEST (test_gap_numbers)
{
  for (guint is_set = 0; is_set < 2; is_set++) {
    guint n_segments = 0;
    Bench b;

    bench_init (&b, 1, FALSE);
    for (guint k = 0; k < 2; k++) {
      const guint32 seqnum = gst_util_seqnum_next ();

      if (k > 0) {
        GstEvent *start = gst_event_new_flush_start ();
        GstEvent *stop = gst_event_new_flush_stop (TRUE);

        gst_event_set_seqnum (start, seqnum);
        gst_event_set_seqnum (stop, seqnum);
        give (&b, 0, start);
        give (&b, 0, stop);
      }
      new_segment (&b, 0, seqnum);
      if (is_set) {
        push (&b, 0, 0);
        expect (&b, 0, 1);
      }
      gap (&b, 0, 33 * MS, 33 * MS);
      expect_gap (&b, 33 * MS, 33 * MS, seqnum, &n_segments);
      push (&b, 0, 66 * MS);
      expect (&b, 66 * MS, 1);
      gap (&b, 0, 99 * MS, 33 * MS);
      expect_gap (&b, 99 * MS, 33 * MS, seqnum, &n_segments);
      fail_unless_equals_int (n_segments, k + 1);
    }
    bench_clear (&b);
  }
}

GST_END_TEST;

GST_START_TEST (test_min_views)
{
  Bench b;
  g_autoptr (GstMessage) warning = NULL;

  bench_init (&b, 3, FALSE);
  g_object_set (b.sync, "min-views", 2, NULL);
  push (&b, 0, 0);
  push (&b, 1, 33 * MS);
  push (&b, 2, 33 * MS);
  push (&b, 0, 66 * MS);
  expect (&b, 33 * MS, 6);
  eos (&b, 0);
  eos (&b, 1);
  eos (&b, 2);
  expect_eos (&b);
  fail_unless_equals_uint64 (stat_of (&b, "sets"), 1);
  fail_unless_equals_uint64 (stat_of (&b, "skipped"), 2);
  /* the one that was sent lacked a pad too */
  fail_unless_equals_uint64 (stat_of (&b, "incomplete"), 3);
  fail_unless_equals_uint64 (stat_of_pad (&b, 0, "used"), 2);
  fail_unless_equals_uint64 (stat_of_pad (&b, 0, "missing"), 1);
  fail_unless_equals_uint64 (stat_of_pad (&b, 2, "missing"), 2);
  warning = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (warning == NULL);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_never_enough_views)
{
  Bench b;
  g_autoptr (GstMessage) warning = NULL;

  bench_init (&b, 2, FALSE);
  g_object_set (b.sync, "min-views", 2, NULL);
  push (&b, 0, 0);
  eos (&b, 0);
  push (&b, 1, 10 * GST_SECOND);
  eos (&b, 1);
  expect_eos (&b);
  warning = message_of (&b, GST_MESSAGE_WARNING);
  fail_unless (warning != NULL);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_one_pad)
{
  Bench b;

  bench_init (&b, 1, FALSE);
  push (&b, 0, 5 * MS);
  push (&b, 0, 38 * MS);
  expect (&b, 5 * MS, 1);
  expect (&b, 38 * MS, 1);
  /* alone a frame needs no time: the order says it all */
  push (&b, 0, GST_CLOCK_TIME_NONE);
  expect (&b, GST_CLOCK_TIME_NONE, 1);
  eos (&b, 0);
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_64_pads)
{
  Bench b;
  guint i, f;

  bench_init (&b, MAX_PADS, FALSE);
  fail_unless (gst_element_request_pad_simple (b.sync, "sink_%u") == NULL);
  for (f = 0; f < 3; f++) {
    for (i = 0; i < MAX_PADS; i++) {
      if (f != 1 || i % 2) {
        push (&b, i, f * 33 * MS + i * 100 * GST_USECOND);
      } else if (f == 1) {
        gap (&b, i, 33 * MS, 33 * MS);
      }
    }
    expect (&b, f == 1 ? 33 * MS + 100 * GST_USECOND : f * 33 * MS,
        f == 1 ? G_GUINT64_CONSTANT (0xaaaaaaaaaaaaaaaa) : G_MAXUINT64);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* The subclass gets the only reference, so it can write without a copy. */
GST_START_TEST (test_writable_views)
{
  Bench b;
  GstBuffer *out;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  out = gst_harness_pull (b.src);
  fail_unless_equals_uint64 (GST_BUFFER_OFFSET_END (out), 2);
  gst_buffer_unref (out);
  bench_clear (&b);
}

GST_END_TEST;

/* ---- the same files give the same sets, whichever thread comes first ---- */

static gchar *
sets_of_run (guint32 seed)
{
  g_autoptr (GRand) content = g_rand_new_with_seed (1);
  GString *sets = g_string_new (NULL);
  GstBuffer *out;
  Bench b;
  guint i, f;

  feed_seed = seed;
  bench_init (&b, 4, FALSE);
  for (f = 0; f < 60; f++) {
    for (i = 0; i < 4; i++) {
      gint jitter = g_rand_int_range (content, -7, 8);

      if (g_rand_int_range (content, 0, 4) > 0) {
        push (&b, i, (GstClockTime) (100 + (gint) f * 33 + jitter) * MS);
      }
    }
  }
  for (i = 0; i < 4; i++) {
    eos (&b, i);
  }
  expect_eos (&b);
  while ((out = gst_harness_try_pull (b.src)) != NULL) {
    g_string_append_printf (sets, "%" G_GUINT64_FORMAT ":%x ",
        GST_BUFFER_PTS (out) / MS, (guint) GST_BUFFER_OFFSET (out));
    gst_buffer_unref (out);
  }
  bench_clear (&b);
  return g_string_free (sets, FALSE);
}

GST_START_TEST (test_deterministic)
{
  g_autofree gchar *first = sets_of_run (1);
  guint32 seed;

  fail_unless (strlen (first) > 300);
  for (seed = 2; seed < 8; seed++) {
    g_autofree gchar *again = sets_of_run (seed);

    fail_unless_equals_string (again, first);
  }
}

GST_END_TEST;

static Suite *
clothsync_suite (void)
{
  Suite *s = suite_create ("clothsync");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_jitter);
  tcase_add_test (tc, test_dropped_frames);
  tcase_add_test (tc, test_different_start);
  tcase_add_test (tc, test_framerates);
  tcase_add_test (tc, test_tolerance);
  tcase_add_test (tc, test_pad_offset);
  tcase_add_test (tc, test_running_time);
  tcase_add_test (tc, test_gap);
  tcase_add_test (tc, test_one_eos);
  tcase_add_test (tc, test_gap_for_incomplete);
  tcase_add_test (tc, test_gap_of_all);
  tcase_add_test (tc, test_gap_numbers);
  tcase_add_test (tc, test_min_views);
  tcase_add_test (tc, test_never_enough_views);
  tcase_add_test (tc, test_one_pad);
  tcase_add_test (tc, test_64_pads);
  tcase_add_test (tc, test_writable_views);
  tcase_add_test (tc, test_deterministic);
  return s;
}

int
main (int argc, char **argv)
{
  /* the plugin has a GstClothSync of its own: it must not come in by a scan */
  g_setenv ("GST_REGISTRY_DISABLE", "yes", TRUE);
  gst_check_init (&argc, &argv);
  return gst_check_run_suite (clothsync_suite (), "clothsync", __FILE__);
}
