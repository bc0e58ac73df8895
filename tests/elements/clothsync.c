/* GstClothSync: joining streams by running time, through a small subclass whose output
 * says what each set held.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/check/gsttestclock.h>

#include "elements/gstclothsync.h"

/* The subclass: one empty buffer a set, the mask in OFFSET, the number of views that
 * could be written in place in OFFSET_END. */
#define TEST_TYPE_SYNC (test_sync_get_type ())
G_DECLARE_FINAL_TYPE (TestSync, test_sync, TEST, SYNC, GstClothSync)
     struct _TestSync
     {
       GstClothSync parent;

       guint n_caps, n_gone, n_resets;
       guint64 with_caps;
     };
G_DEFINE_TYPE (TestSync, test_sync, GST_TYPE_CLOTH_SYNC);

     static gboolean
         test_sync_set_pad_caps (GstClothSync * sync, guint index,
    GstCaps * caps)
{
  TestSync *self = TEST_SYNC (sync);

  if (!caps) {
    self->n_gone++;
    self->with_caps &= ~(G_GUINT64_CONSTANT (1) << index);
    return TRUE;
  }
  if (gst_structure_has_field (gst_caps_get_structure (caps, 0), "refuse")) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT, ("refused"), (NULL));
    return FALSE;
  }
  self->n_caps++;
  self->with_caps |= G_GUINT64_CONSTANT (1) << index;
  return TRUE;
}

static GstFlowReturn
test_sync_negotiate_src (GstClothSync * sync, GstCaps * downstream,
    GstCaps ** caps)
{
  *caps = gst_caps_new_simple ("test/x-sets", "pads", G_TYPE_INT,
      (gint) g_bit_storage (TEST_SYNC (sync)->with_caps), NULL);
  return GST_FLOW_OK;
}

static GstFlowReturn
test_sync_process_set (GstClothSync * sync, GstBuffer ** views, guint n,
    guint64 mask, GstClockTime pts, GstClockTime duration, GstBuffer ** out)
{
  guint i, writable = 0;

  for (i = 0; i < n; i++) {
    fail_unless_equals_int (views[i] != NULL, mask >> i & 1);
    if (views[i]) {
      fail_if (GST_BUFFER_FLAG_IS_SET (views[i], GST_BUFFER_FLAG_GAP));
      writable += gst_buffer_is_writable (views[i]);
    }
  }
  *out = gst_buffer_new ();
  GST_BUFFER_OFFSET (*out) = mask;
  GST_BUFFER_OFFSET_END (*out) = writable;
  return GST_FLOW_OK;
}

static void
test_sync_reset (GstClothSync * sync)
{
  TEST_SYNC (sync)->n_resets++;
}

static GstStaticPadTemplate sink_template =
GST_STATIC_PAD_TEMPLATE ("sink_%u", GST_PAD_SINK, GST_PAD_REQUEST,
    GST_STATIC_CAPS ("test/x-frames"));
static GstStaticPadTemplate src_template =
GST_STATIC_PAD_TEMPLATE ("src", GST_PAD_SRC, GST_PAD_ALWAYS,
    GST_STATIC_CAPS ("test/x-sets"));

static void
test_sync_class_init (TestSyncClass * klass)
{
  GstElementClass *element_class = GST_ELEMENT_CLASS (klass);
  GstClothSyncClass *sync_class = GST_CLOTH_SYNC_CLASS (klass);

  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &sink_template, GST_TYPE_CLOTH_SYNC_PAD);
  gst_element_class_add_static_pad_template_with_gtype (element_class,
      &src_template, GST_TYPE_AGGREGATOR_PAD);
  gst_element_class_set_static_metadata (element_class, "test", "Test", "test",
      "test");
  sync_class->set_pad_caps = test_sync_set_pad_caps;
  sync_class->negotiate_src = test_sync_negotiate_src;
  sync_class->process_set = test_sync_process_set;
  sync_class->reset = test_sync_reset;
}

static void
test_sync_init (TestSync * self)
{
}

/* ---- a bench of harnesses: one for the source pad, one a sink pad. A pad takes one
 * frame and then blocks until it is used, so each has a thread that feeds it. ---- */

#define MS GST_MSECOND
#define MAX_PADS GST_CLOTH_SYNC_MAX_PADS

typedef struct
{
  GstElement *sync;
  GstHarness *src;
  GstHarness *in[MAX_PADS];
  GThread *feeder[MAX_PADS];
  GAsyncQueue *queue[MAX_PADS];
  gint pending[MAX_PADS];
  GstBus *bus;
} Bench;

typedef struct
{
  GstHarness *in;
  GAsyncQueue *queue;
  gint *pending;
  GRand *rand;
} Feed;

static gpointer
feed (gpointer data)
{
  g_autofree Feed *f = data;
  GstMiniObject *item;
  gboolean stop = FALSE;

  while (!stop) {
    gint spin = g_rand_int_range (f->rand, 0, 4);

    item = g_async_queue_pop (f->queue);
    stop = GST_IS_CAPS (item);  /* the mark of the end */
    while (spin--) {
      g_thread_yield ();
    }
    if (GST_IS_BUFFER (item)) {
      gst_harness_push (f->in, GST_BUFFER (item));
    } else if (GST_IS_EVENT (item)) {
      gst_harness_push_event (f->in, GST_EVENT (item));
    } else {
      gst_mini_object_unref (item);
    }
    g_atomic_int_add (f->pending, -1);
  }
  g_rand_free (f->rand);
  g_async_queue_unref (f->queue);
  return NULL;
}

static void
give (Bench * b, guint i, gpointer item)
{
  g_atomic_int_inc (&b->pending[i]);
  g_async_queue_push (b->queue[i], item);
}

static void
settle (Bench * b, guint i)
{
  while (g_atomic_int_get (&b->pending[i]) > 0) {
    g_thread_yield ();
  }
}

static guint32 feed_seed = 1;

static void
bench_start_feed (Bench * b, guint i)
{
  Feed *f = g_new0 (Feed, 1);

  b->queue[i] = g_async_queue_new ();
  f->in = b->in[i];
  f->queue = g_async_queue_ref (b->queue[i]);
  f->pending = &b->pending[i];
  f->rand = g_rand_new_with_seed (feed_seed * 100 + i);
  b->feeder[i] = g_thread_new ("feed", feed, f);
}

static void
bench_stop_feed (Bench * b, guint i)
{
  give (b, i, gst_caps_new_empty ());
  g_thread_join (b->feeder[i]);
  g_async_queue_unref (b->queue[i]);
  b->queue[i] = NULL;
}

static void
bench_add_pad (Bench * b, guint i, const gchar * caps)
{
  g_autofree gchar *name = g_strdup_printf ("sink_%u", i);

  b->in[i] = gst_harness_new_with_element (b->sync, name, NULL);
  if (caps) {
    gst_harness_set_src_caps_str (b->in[i], caps);
    bench_start_feed (b, i);
  }
}

static void
bench_remove_pad (Bench * b, guint i)
{
  g_autofree gchar *name = g_strdup_printf ("sink_%u", i);
  GstPad *pad = gst_element_get_static_pad (b->sync, name);

  settle (b, i);
  bench_stop_feed (b, i);
  gst_harness_teardown (b->in[i]);
  b->in[i] = NULL;
  if (GST_OBJECT_PARENT (pad)) {
    gst_element_release_request_pad (b->sync, pad);
  }
  gst_object_unref (pad);
}

static void
bench_init (Bench * b, guint n_pads, gboolean live)
{
  guint i;

  memset (b, 0, sizeof (*b));
  b->sync = gst_object_ref_sink (g_object_new (TEST_TYPE_SYNC, NULL));
  b->bus = gst_bus_new ();
  gst_element_set_bus (b->sync, b->bus);
  b->src = gst_harness_new_with_element (b->sync, NULL, "src");
  for (i = 0; i < n_pads; i++) {
    bench_add_pad (b, i, NULL);
    gst_harness_set_live (b->in[i], live);
  }
  gst_harness_use_testclock (b->src);
  gst_harness_set_live (b->src, live);
  for (i = 0; i < n_pads; i++) {
    gst_harness_set_src_caps_str (b->in[i], "test/x-frames,framerate=30/1");
    bench_start_feed (b, i);
  }
}

static void
bench_clear (Bench * b)
{
  guint i;

  /* unblocks the feeders */
  gst_element_set_state (b->sync, GST_STATE_NULL);
  for (i = 0; i < MAX_PADS; i++) {
    if (b->in[i]) {
      bench_stop_feed (b, i);
    }
  }
  for (i = 0; i < MAX_PADS; i++) {
    if (b->in[i]) {
      gst_harness_teardown (b->in[i]);
    }
  }
  gst_harness_teardown (b->src);
  gst_element_set_bus (b->sync, NULL);
  gst_object_unref (b->bus);
  gst_object_unref (b->sync);
}

static GstBuffer *
frame (GstClockTime pts)
{
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, 4, NULL);

  GST_BUFFER_PTS (buffer) = pts;
  GST_BUFFER_DURATION (buffer) = 33 * MS;
  return buffer;
}

static void
push (Bench * b, guint i, GstClockTime pts)
{
  give (b, i, frame (pts));
}

static void
gap (Bench * b, guint i, GstClockTime pts, GstClockTime duration)
{
  give (b, i, gst_event_new_gap (pts, duration));
}

static void
caps (Bench * b, guint i, const gchar * text)
{
  GstCaps *caps = gst_caps_from_string (text);

  give (b, i, gst_event_new_caps (caps));
  gst_caps_unref (caps);
}

static void
eos (Bench * b, guint i)
{
  give (b, i, gst_event_new_eos ());
}

static void
expect (Bench * b, GstClockTime pts, guint64 mask)
{
  GstBuffer *out = gst_harness_pull (b->src);

  fail_unless (out != NULL, "no set at %" GST_TIME_FORMAT, GST_TIME_ARGS (pts));
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), pts);
  fail_unless_equals_uint64_hex (GST_BUFFER_OFFSET (out), mask);
  fail_unless_equals_uint64 (GST_BUFFER_DURATION (out), 33 * MS);
  gst_buffer_unref (out);
}

static void
expect_eos (Bench * b)
{
  gboolean done = FALSE;

  while (!done) {
    GstEvent *event = gst_harness_pull_event (b->src);

    fail_unless (event != NULL);
    done = GST_EVENT_TYPE (event) == GST_EVENT_EOS;
    gst_event_unref (event);
  }
}

static guint64
stat_of (Bench * b, const gchar * name)
{
  g_autoptr (GstStructure) stats = NULL;
  guint64 value = G_MAXUINT64;

  g_object_get (b->sync, "stats", &stats, NULL);
  fail_unless (gst_structure_get_uint64 (stats, name, &value));
  return value;
}

static GstMessage *
message_of (Bench * b, GstMessageType type)
{
  return gst_bus_pop_filtered (b->bus, type);
}

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
  fail_unless_equals_uint64 (stat_of (&b, "incomplete"), 2);
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
  {
    GstClockID id;

    gst_test_clock_wait_for_next_pending_id (clock, &id);
    fail_unless_equals_uint64 (gst_clock_id_get_time (id),
        33 * MS + gst_util_uint64_scale (GST_SECOND, 1, 30) / 2);
    gst_clock_id_unref (id);
  }
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

/* No camera sends: nothing comes out, and nothing spins. */
GST_START_TEST (test_live_silence)
{
  Bench b;
  GstTestClock *clock;

  bench_init (&b, 2, TRUE);
  clock = bench_clock (&b);
  push (&b, 0, 0);
  push (&b, 1, 0);
  expect (&b, 0, 3);
  gst_test_clock_set_time (clock, 10 * GST_SECOND);
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  fail_unless_equals_int (gst_test_clock_peek_id_count (clock), 0);
  push (&b, 0, 10 * GST_SECOND);
  push (&b, 1, 10 * GST_SECOND);
  expect (&b, 10 * GST_SECOND, 3);
  gst_object_unref (clock);
  bench_clear (&b);
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
  tcase_add_test (tc, test_min_views);
  tcase_add_test (tc, test_never_enough_views);
  tcase_add_test (tc, test_one_pad);
  tcase_add_test (tc, test_64_pads);
  tcase_add_test (tc, test_writable_views);
  tcase_add_test (tc, test_deterministic);
  tcase_add_test (tc, test_live_deadline);
  tcase_add_test (tc, test_live_silence);
  tcase_add_test (tc, test_live_latency);
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
  return gst_check_run_suite (clothsync_suite (), "clothsync", __FILE__);
}
