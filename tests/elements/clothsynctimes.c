/* GstClothSync: time stamps that no camera means, and jumps that are real.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothsyncbench.h"

#define FRAME (33 * MS)
/* What a packet of eight hostile bytes may say. */
static const GstClockTime far[] = { G_MAXINT64, G_MAXINT64 - 1,
  (GstClockTime) G_MAXINT64 + 1, GST_CLOCK_TIME_NONE - 1,
  G_GUINT64_CONSTANT (1) << 62, 3600 * GST_SECOND, 11 * GST_SECOND
};

static void
expect_warning (Bench * b, const gchar * text)
{
  g_autoptr (GstMessage) warning = message_of (b, GST_MESSAGE_WARNING);
  g_autoptr (GError) error = NULL;

  fail_unless (warning != NULL);
  gst_message_parse_warning (warning, &error, NULL);
  fail_unless (strstr (error->message, text) != NULL, "%s", error->message);
}

static void
expect_silence (Bench * b)
{
  g_autoptr (GstMessage) warning = message_of (b, GST_MESSAGE_WARNING);

  fail_unless (warning == NULL);
}

/* One frame far ahead among good ones: it goes, they stay, and the end comes. */
GST_START_TEST (test_one_far)
{
  const GstClockTime pts = far[__i__ % G_N_ELEMENTS (far)];
  const guint at = (guint) __i__ / G_N_ELEMENTS (far);
  Bench b;
  guint f, n = 0;

  bench_init (&b, 1, FALSE);
  for (f = 0; f < 6; f++) {
    push (&b, 0, f == at ? pts : f * FRAME);
  }
  eos (&b, 0);
  for (f = 0; f < 6; f++) {
    if (f != at) {
      expect (&b, f * FRAME, 1);
      n++;
    }
  }
  expect_eos (&b);
  expect_warning (&b, "pad sink_0");
  expect_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "sets"), n);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 0);
  fail_unless_equals_uint64 (stat_of (&b, "implausible"), 1);
  bench_clear (&b);
}

GST_END_TEST;

/* Of three cameras one lies once: the others' sets are whole but for that frame. */
GST_START_TEST (test_one_far_of_three)
{
  const GstClockTime pts = far[__i__ % G_N_ELEMENTS (far)];
  const guint at = (guint) __i__ / G_N_ELEMENTS (far);
  Bench b;
  guint f, i;

  bench_init (&b, 3, FALSE);
  for (f = 0; f < 6; f++) {
    for (i = 0; i < 3; i++) {
      push (&b, i, f == at && i == 1 ? pts : f * FRAME);
    }
  }
  for (i = 0; i < 3; i++) {
    eos (&b, i);
  }
  for (f = 0; f < 6; f++) {
    expect (&b, f * FRAME, f == at ? 5 : 7);
  }
  expect_eos (&b);
  expect_warning (&b, "pad sink_1");
  fail_unless_equals_uint64 (stat_of (&b, "implausible"), 1);
  bench_clear (&b);
}

GST_END_TEST;

/* Every second frame lies: one word on the bus, and all the good ones. */
GST_START_TEST (test_many_far)
{
  Bench b;
  guint f;

  bench_init (&b, 1, FALSE);
  for (f = 0; f < 20; f++) {
    push (&b, 0, f * FRAME);
    push (&b, 0, G_MAXINT64 - f * GST_SECOND);
  }
  eos (&b, 0);
  for (f = 0; f < 20; f++) {
    expect (&b, f * FRAME, 1);
  }
  expect_eos (&b);
  expect_warning (&b, "pad sink_0");
  expect_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "implausible"), 20);
  bench_clear (&b);
}

GST_END_TEST;

/* All cameras pause for an hour: every frame comes, nothing is said. */
GST_START_TEST (test_pause)
{
  Bench b;
  guint f, i;

  bench_init (&b, 2, FALSE);
  for (f = 0; f < 6; f++) {
    for (i = 0; i < 2; i++) {
      push (&b, i, f * FRAME + (f < 3 ? 0 : 3600 * GST_SECOND));
    }
  }
  for (i = 0; i < 2; i++) {
    eos (&b, i);
  }
  for (f = 0; f < 6; f++) {
    expect (&b, f * FRAME + (f < 3 ? 0 : 3600 * GST_SECOND), 3);
  }
  expect_eos (&b);
  expect_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "implausible"), 0);
  bench_clear (&b);
}

GST_END_TEST;

/* One camera joins a minute later. */
GST_START_TEST (test_late_start)
{
  const GstClockTime start = 60 * GST_SECOND;
  Bench b;
  guint f;

  bench_init (&b, 2, FALSE);
  for (f = 0; f < 4; f++) {
    push (&b, 0, f * 20 * GST_SECOND);
    push (&b, 1, start + f * FRAME);
  }
  eos (&b, 0);
  eos (&b, 1);
  for (f = 0; f < 3; f++) {
    expect (&b, f * 20 * GST_SECOND, 1);
  }
  expect (&b, start, 3);
  for (f = 1; f < 4; f++) {
    expect (&b, start + f * FRAME, 2);
  }
  expect_eos (&b);
  expect_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "implausible"), 0);
  bench_clear (&b);
}

GST_END_TEST;

/* A picture a minute, unevenly, is a stream like any other. */
GST_START_TEST (test_time_lapse)
{
  static const guint seconds[] = { 0, 60, 119, 181, 240, 301, 360 };
  Bench b;
  guint f;

  bench_init (&b, 1, FALSE);
  for (f = 0; f < G_N_ELEMENTS (seconds); f++) {
    push (&b, 0, seconds[f] * GST_SECOND);
  }
  eos (&b, 0);
  for (f = 0; f < G_N_ELEMENTS (seconds); f++) {
    expect (&b, seconds[f] * GST_SECOND, 1);
  }
  expect_eos (&b);
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* A lone picture with any time is nobody's contradiction. */
GST_START_TEST (test_single_frame)
{
  Bench b;

  bench_init (&b, 1, FALSE);
  push (&b, 0, 3600 * GST_SECOND);
  eos (&b, 0);
  expect (&b, 3600 * GST_SECOND, 1);
  expect_eos (&b);
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* The last frame lies: nothing bears it out any more. */
GST_START_TEST (test_far_at_the_end)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  push (&b, 0, G_MAXINT64);
  push (&b, 1, FRAME);
  eos (&b, 0);
  eos (&b, 1);
  expect (&b, 0, 3);
  expect (&b, FRAME, 2);
  expect_eos (&b);
  expect_warning (&b, "pad sink_0");
  bench_clear (&b);
}

GST_END_TEST;

/* Who wants every time stamp believed gets them, without a hang. */
GST_START_TEST (test_all_believed)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  g_object_set (b.sync, "max-jump", GST_CLOCK_TIME_NONE, NULL);
  push (&b, 0, 0);
  push (&b, 1, 0);
  push (&b, 0, G_MAXINT64);
  push (&b, 1, G_MAXINT64);
  expect (&b, 0, 3);
  expect (&b, G_MAXINT64, 3);
  push (&b, 0, FRAME);
  eos (&b, 0);
  eos (&b, 1);
  expect_eos (&b);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 1);
  bench_clear (&b);
}

GST_END_TEST;

/* A frame without any time among others with theirs: it goes, they stay. */
GST_START_TEST (test_untimed)
{
  Bench b;
  guint f;

  bench_init (&b, 2, FALSE);
  for (f = 0; f < 4; f++) {
    push (&b, 0, f * FRAME);
    if (f == 2) {
      push (&b, 1, GST_CLOCK_TIME_NONE);
    }
    push (&b, 1, f * FRAME);
  }
  eos (&b, 0);
  eos (&b, 1);
  for (f = 0; f < 4; f++) {
    expect (&b, f * FRAME, 3);
  }
  expect_eos (&b);
  expect_warning (&b, "pad sink_1 was dropped: it has no time stamp");
  expect_silence (&b);
  fail_unless_equals_uint64 (stat_of (&b, "implausible"), 1);
  bench_clear (&b);
}

GST_END_TEST;

/* Pictures a minute from each other, each in a segment of its own, as concat makes them: a
 * held one keeps the time of its segment. */
GST_START_TEST (test_segments)
{
  GstSegment segment;
  Bench b;
  guint f;

  bench_init (&b, 1, FALSE);
  for (f = 0; f < 5; f++) {
    gst_segment_init (&segment, GST_FORMAT_TIME);
    segment.base = f * 60 * GST_SECOND;
    segment.start = segment.time = f * GST_SECOND;
    give (&b, 0, gst_event_new_segment (&segment));
    push (&b, 0, f * GST_SECOND);
  }
  eos (&b, 0);
  for (f = 0; f < 5; f++) {
    expect (&b, f * 60 * GST_SECOND, 1);
  }
  expect_eos (&b);
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* Caps that come behind a held frame count when it has gone. */
GST_START_TEST (test_caps)
{
  Bench b;

  bench_init (&b, 1, FALSE);
  push (&b, 0, 0);
  expect (&b, 0, 1);
  fail_unless_equals_int (TEST_SYNC (b.sync)->n_caps, 1);
  push (&b, 0, 3600 * GST_SECOND);
  caps (&b, 0, "test/x-frames,framerate=60/1,mark=1");
  settle (&b, 0);
  fail_unless_equals_int (TEST_SYNC (b.sync)->n_caps, 1);
  push (&b, 0, 3600 * GST_SECOND + FRAME);
  expect (&b, 3600 * GST_SECOND, 1);
  expect (&b, 3600 * GST_SECOND + FRAME, 1);
  fail_unless_equals_int (TEST_SYNC (b.sync)->n_caps, 2);
  /* refused ones end the stream, then */
  push (&b, 0, 2 * 3600 * GST_SECOND);
  caps (&b, 0, "test/x-frames,refuse=true");
  push (&b, 0, 2 * 3600 * GST_SECOND + FRAME);
  expect (&b, 2 * 3600 * GST_SECOND, 1);
  {
    g_autoptr (GstMessage) error = gst_bus_timed_pop_filtered (b.bus,
        10 * GST_SECOND, GST_MESSAGE_ERROR);

    fail_unless (error != NULL);
  }
  bench_clear (&b);
}

GST_END_TEST;

static void
hold_with_caps (Bench * b)
{
  g_autoptr (GstPad) pad = NULL;

  bench_init (b, 1, FALSE);
  push (b, 0, 0);
  expect (b, 0, 1);
  push (b, 0, 3600 * GST_SECOND);
  caps (b, 0, "test/x-frames,framerate=30/1,mark=1");
  pad = gst_element_get_static_pad (b->sync, "sink_0");
  while (!g_atomic_pointer_get (&GST_CLOTH_SYNC_PAD (pad)->caps)) {
    g_thread_yield ();
  }
  fail_unless_equals_int (TEST_SYNC (b->sync)->n_caps, 1);
}

static void
begin_anew (Bench * b)
{
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  give (b, 0, gst_event_new_segment (&segment));
}

/* The frame that caps wait for is flushed: they count at once, unless newer ones come, and
 * those stay. */
GST_START_TEST (test_caps_flushed)
{
  for (gint newer = 0; newer < 2; newer++) {
    Bench b;

    hold_with_caps (&b);
    give (&b, 0, gst_event_new_flush_start ());
    give (&b, 0, gst_event_new_flush_stop (TRUE));
    begin_anew (&b);
    if (newer) {
      caps (&b, 0, "test/x-frames,framerate=30/1,mark=2");
    }
    push (&b, 0, 0);
    push (&b, 0, FRAME);
    expect (&b, 0, 1);
    expect (&b, FRAME, 1);
    fail_unless_equals_int (TEST_SYNC (b.sync)->mark, newer ? 2 : 1);
    fail_unless_equals_int (TEST_SYNC (b.sync)->n_caps, 2);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* What waits is of the stream before. */
GST_START_TEST (test_caps_restarted)
{
  Bench b;

  hold_with_caps (&b);
  fail_unless_equals_int (gst_element_set_state (b.sync, GST_STATE_READY),
      GST_STATE_CHANGE_SUCCESS);
  gst_element_set_state (b.sync, GST_STATE_PLAYING);
  give (&b, 0, gst_event_new_stream_start ("again"));
  begin_anew (&b);
  push (&b, 0, 0);
  expect (&b, 0, 1);
  /* the harness has sent its caps again, and no others count */
  fail_unless_equals_int (TEST_SYNC (b.sync)->n_caps, 2);
  bench_clear (&b);
}

GST_END_TEST;

/* A pad goes while one of its frames is held: the others go on. */
GST_START_TEST (test_release)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  push (&b, 1, G_MAXINT64);
  push (&b, 0, FRAME);
  settle (&b, 1);
  bench_remove_pad (&b, 1);
  expect (&b, FRAME, 1);
  eos (&b, 0);
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* One of two cameras jumps for good: the other goes on, and it is said. */
GST_START_TEST (test_one_jumps)
{
  Bench b;
  guint f;

  bench_init (&b, 2, FALSE);
  for (f = 0; f < 6; f++) {
    push (&b, 0, f * FRAME);
    push (&b, 1, f * FRAME + (f < 3 ? 0 : 3600 * GST_SECOND));
  }
  eos (&b, 0);
  eos (&b, 1);
  for (f = 0; f < 6; f++) {
    expect (&b, f * FRAME, f < 3 ? 3 : 1);
  }
  for (f = 3; f < 6; f++) {
    expect (&b, f * FRAME + 3600 * GST_SECOND, 2);
  }
  expect_eos (&b);
  expect_warning (&b, "pad sink_1 jump to 3600.099 s");
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* After a pause the last frame of all is one, too. */
GST_START_TEST (test_pause_at_the_end)
{
  Bench b;

  bench_init (&b, 1, FALSE);
  push (&b, 0, 0);
  push (&b, 0, 3600 * GST_SECOND);
  eos (&b, 0);
  expect (&b, 0, 1);
  expect (&b, 3600 * GST_SECOND, 1);
  expect_eos (&b);
  expect_silence (&b);
  bench_clear (&b);

  /* a gap says how long nothing comes */
  bench_init (&b, 2, FALSE);
  gap (&b, 1, 0, 30 * GST_SECOND);
  push (&b, 1, 30 * GST_SECOND);
  push (&b, 0, 0);
  eos (&b, 0);
  eos (&b, 1);
  expect (&b, 0, 1);
  expect (&b, 30 * GST_SECOND, 2);
  expect_eos (&b);
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* Two frames that bear each other out move the stream's time on; that what follows is lost
 * is said once. */
GST_START_TEST (test_back)
{
  Bench b;
  guint f;

  bench_init (&b, 1, FALSE);
  push (&b, 0, 0);
  push (&b, 0, 3600 * GST_SECOND);
  push (&b, 0, 3600 * GST_SECOND + FRAME);
  for (f = 1; f < 5; f++) {
    push (&b, 0, f * FRAME);
  }
  eos (&b, 0);
  expect (&b, 0, 1);
  expect (&b, 3600 * GST_SECOND, 1);
  expect (&b, 3600 * GST_SECOND + FRAME, 1);
  expect_eos (&b);
  fail_unless_equals_uint64 (stat_of (&b, "dropped"), 4);
  expect_warning (&b, "pad sink_0 are dropped: their time stamps went back to "
      "0.033 s");
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* A gap that begins far ahead, and one that ends there. */
GST_START_TEST (test_gaps)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  gap (&b, 1, G_MAXINT64, FRAME);
  push (&b, 1, FRAME);
  push (&b, 0, FRAME);
  eos (&b, 1);
  expect (&b, 0, 1);
  expect (&b, FRAME, 3);
  push (&b, 0, 2 * FRAME);
  eos (&b, 0);
  expect (&b, 2 * FRAME, 1);
  expect_eos (&b);
  bench_clear (&b);

  bench_init (&b, 2, FALSE);
  gap (&b, 1, 0, G_MAXINT64);
  push (&b, 0, 0);
  push (&b, 0, FRAME);
  eos (&b, 0);
  eos (&b, 1);
  expect (&b, 0, 1);
  expect (&b, FRAME, 1);
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* A duration that reaches beyond the last nanosecond. */
GST_START_TEST (test_duration)
{
  Bench b;
  GstBuffer *buffer = frame (FRAME);

  bench_init (&b, 1, FALSE);
  GST_BUFFER_DURATION (buffer) = GST_CLOCK_TIME_NONE - FRAME / 2;
  push (&b, 0, 0);
  give (&b, 0, buffer);
  push (&b, 0, 2 * FRAME);
  eos (&b, 0);
  expect (&b, 0, 1);
  buffer = gst_harness_pull (b.src);
  fail_unless (buffer != NULL);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), FRAME);
  gst_buffer_unref (buffer);
  expect (&b, 2 * FRAME, 1);
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* What is held goes with a flush. */
GST_START_TEST (test_flush)
{
  GstSegment segment;
  Bench b;

  bench_init (&b, 1, FALSE);
  push (&b, 0, 0);
  expect (&b, 0, 1);
  push (&b, 0, 3600 * GST_SECOND);
  settle (&b, 0);
  give (&b, 0, gst_event_new_flush_start ());
  give (&b, 0, gst_event_new_flush_stop (TRUE));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  give (&b, 0, gst_event_new_segment (&segment));
  push (&b, 0, FRAME);
  push (&b, 0, 2 * FRAME);
  expect (&b, FRAME, 1);
  expect (&b, 2 * FRAME, 1);
  eos (&b, 0);
  expect_eos (&b);
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* Running times backwards count from the end: a segment without one, or whose end is before
 * where it is to begin, is refused before the base class computes with it. */
GST_START_TEST (test_backwards_from_no_end)
{
  static const GstClockTime stops[] = { GST_CLOCK_TIME_NONE, GST_SECOND - 1 };
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;
  GstSegment segment;
  Bench b;

  bench_init (&b, 2, FALSE);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = stops[__i__];
  segment.offset = GST_SECOND;
  give (&b, 0, gst_event_new_segment (&segment));
  push (&b, 0, FRAME);
  settle (&b, 0);
  message = gst_bus_pop_filtered (b.bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, NULL);
  fail_unless (g_error_matches (error, GST_STREAM_ERROR,
          GST_STREAM_ERROR_FORMAT));
  fail_unless (strstr (error->message, "sink_0") != NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* Offsets at the ends of their range. */
GST_START_TEST (test_offset)
{
  Bench b;

  bench_init (&b, 2, FALSE);
  g_object_set (b.sync, "max-jump", GST_CLOCK_TIME_NONE, NULL);
  gst_cloth_sync_set_pad_offset (GST_CLOTH_SYNC (b.sync), 1, G_MININT64 + 2);
  push (&b, 0, 0);
  push (&b, 1, FRAME);
  eos (&b, 0);
  expect (&b, 0, 1);
  expect (&b, G_MAXINT64, 2);
  eos (&b, 1);
  expect_eos (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* Live, all cameras begin a minute after the pipeline: the first set waits for them. */
GST_START_TEST (test_live_start)
{
  Bench b;
  GstTestClock *clock;

  bench_init (&b, 2, TRUE);
  clock = gst_harness_get_testclock (b.src);
  gst_test_clock_set_time (clock, 60 * GST_SECOND);
  push (&b, 0, 60 * GST_SECOND);
  {
    GstClockID id;

    /* the deadline: it waits */
    gst_test_clock_wait_for_next_pending_id (clock, &id);
    fail_unless (gst_clock_id_get_time (id) > 60 * GST_SECOND);
    gst_clock_id_unref (id);
  }
  push (&b, 1, 60 * GST_SECOND);
  expect (&b, 60 * GST_SECOND, 3);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* Live: a camera that was silent for a minute is believed at once, one that lies is not. */
GST_START_TEST (test_live)
{
  Bench b;
  GstTestClock *clock;

  bench_init (&b, 1, TRUE);
  clock = gst_harness_get_testclock (b.src);
  push (&b, 0, 0);
  expect (&b, 0, 1);
  gst_test_clock_set_time (clock, 60 * GST_SECOND);
  push (&b, 0, 60 * GST_SECOND);
  expect (&b, 60 * GST_SECOND, 1);
  push (&b, 0, G_MAXINT64);
  push (&b, 0, 60 * GST_SECOND + FRAME);
  expect (&b, 60 * GST_SECOND + FRAME, 1);
  fail_unless_equals_uint64 (stat_of (&b, "implausible"), 1);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
clothsynctimes_suite (void)
{
  Suite *s = suite_create ("clothsynctimes");
  TCase *tc = tcase_create ("general");
  const gint n = (gint) G_N_ELEMENTS (far);

  suite_add_tcase (s, tc);
  /* the lie is the first frame, the second, the fourth … of six */
  tcase_add_loop_test (tc, test_one_far, 0, 5 * n);
  tcase_add_loop_test (tc, test_one_far_of_three, 0, 5 * n);
  tcase_add_test (tc, test_many_far);
  tcase_add_test (tc, test_pause);
  tcase_add_test (tc, test_late_start);
  tcase_add_test (tc, test_time_lapse);
  tcase_add_test (tc, test_single_frame);
  tcase_add_test (tc, test_far_at_the_end);
  tcase_add_test (tc, test_all_believed);
  tcase_add_test (tc, test_back);
  tcase_add_test (tc, test_untimed);
  tcase_add_test (tc, test_segments);
  tcase_add_test (tc, test_caps);
  tcase_add_test (tc, test_caps_flushed);
  tcase_add_test (tc, test_caps_restarted);
  tcase_add_test (tc, test_release);
  tcase_add_test (tc, test_one_jumps);
  tcase_add_test (tc, test_pause_at_the_end);
  tcase_add_test (tc, test_gaps);
  tcase_add_test (tc, test_duration);
  tcase_add_test (tc, test_flush);
  tcase_add_loop_test (tc, test_backwards_from_no_end, 0, 2);
  tcase_add_test (tc, test_offset);
  tcase_add_test (tc, test_live_start);
  tcase_add_test (tc, test_live);
  return s;
}

int
main (int argc, char **argv)
{
  /* the plugin has a GstClothSync of its own: it must not come in by a scan */
  g_setenv ("GST_REGISTRY_DISABLE", "yes", TRUE);
  gst_check_init (&argc, &argv);
  return gst_check_run_suite (clothsynctimes_suite (), "clothsynctimes",
      __FILE__);
}
