/* GstClothSync through a small subclass whose output says what each set held, and threads
 * that feed it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

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
       gint mark;               /* of the caps that a pad had last */
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
  self->mark = 0;
  gst_structure_get_int (gst_caps_get_structure (caps, 0), "mark", &self->mark);
  self->with_caps |= G_GUINT64_CONSTANT (1) << index;
  return TRUE;
}

static inline GstFlowReturn
test_sync_negotiate_src (GstClothSync * sync, GstCaps * downstream,
    GstCaps ** caps)
{
  *caps = gst_caps_new_simple ("test/x-sets", "pads", G_TYPE_INT,
      (gint) g_bit_storage (TEST_SYNC (sync)->with_caps),
      "mark", G_TYPE_INT, TEST_SYNC (sync)->mark, NULL);
  return GST_FLOW_OK;
}

static inline GstFlowReturn
test_sync_process_set (GstClothSync * sync, GstBuffer ** views, guint n,
    guint64 mask, GstClockTime pts, GstClockTime duration, GstBuffer ** out)
{
  g_autoptr (GstCaps) caps =
      gst_pad_get_current_caps (GST_AGGREGATOR_SRC_PAD (sync));
  guint i, writable = 0;
  gint mark = -1;

  gst_structure_get_int (gst_caps_get_structure (caps, 0), "mark", &mark);
  fail_unless_equals_int (mark, TEST_SYNC (sync)->mark);
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

static inline void
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

static inline void
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
  sync_class->prefix = "sync";
}

static inline void
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

static inline gpointer
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

static inline void
give (Bench * b, guint i, gpointer item)
{
  g_atomic_int_inc (&b->pending[i]);
  g_async_queue_push (b->queue[i], item);
}

static inline void
settle (Bench * b, guint i)
{
  while (g_atomic_int_get (&b->pending[i]) > 0) {
    g_thread_yield ();
  }
}

static guint32 feed_seed = 1;

static inline void
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

static inline void
bench_stop_feed (Bench * b, guint i)
{
  /* a pad without caps has no feeder */
  if (!b->queue[i]) {
    return;
  }
  give (b, i, gst_caps_new_empty ());
  g_thread_join (b->feeder[i]);
  g_async_queue_unref (b->queue[i]);
  b->queue[i] = NULL;
}

static inline void
bench_add_pad (Bench * b, guint i, const gchar * caps)
{
  g_autofree gchar *name = g_strdup_printf ("sink_%u", i);

  b->in[i] = gst_harness_new_with_element (b->sync, name, NULL);
  if (caps) {
    gst_harness_set_src_caps_str (b->in[i], caps);
    bench_start_feed (b, i);
  }
}

static inline void
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

static inline void
bench_init (Bench * b, guint n_pads, gboolean live)
{
  guint i;

  memset (b, 0, sizeof (*b));
  b->sync = gst_object_ref_sink (g_object_new (TEST_TYPE_SYNC, NULL));
  /* deadlines are the tolerance's alone */
  g_object_set (b->sync, "latency", G_GUINT64_CONSTANT (0), NULL);
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

static inline void
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

static inline GstBuffer *
frame (GstClockTime pts)
{
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, 4, NULL);

  GST_BUFFER_PTS (buffer) = pts;
  GST_BUFFER_DURATION (buffer) = 33 * MS;
  return buffer;
}

static inline void
push (Bench * b, guint i, GstClockTime pts)
{
  give (b, i, frame (pts));
}

static inline void
gap (Bench * b, guint i, GstClockTime pts, GstClockTime duration)
{
  give (b, i, gst_event_new_gap (pts, duration));
}

static inline void
caps (Bench * b, guint i, const gchar * text)
{
  GstCaps *caps = gst_caps_from_string (text);

  give (b, i, gst_event_new_caps (caps));
  gst_caps_unref (caps);
}

static inline void
eos (Bench * b, guint i)
{
  give (b, i, gst_event_new_eos ());
}

static inline void
expect (Bench * b, GstClockTime pts, guint64 mask)
{
  GstBuffer *out = gst_harness_pull (b->src);

  fail_unless (out != NULL, "no set at %" GST_TIME_FORMAT, GST_TIME_ARGS (pts));
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), pts);
  fail_unless_equals_uint64_hex (GST_BUFFER_OFFSET (out), mask);
  fail_unless_equals_uint64 (GST_BUFFER_DURATION (out), 33 * MS);
  gst_buffer_unref (out);
}

static inline void
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

static inline guint64
stat_of (Bench * b, const gchar * name)
{
  g_autoptr (GstStructure) stats = NULL;
  guint64 value = G_MAXUINT64;

  g_object_get (b->sync, "stats", &stats, NULL);
  fail_unless (gst_structure_get_uint64 (stats, name, &value));
  return value;
}

/* A count of one pad. */
static inline guint64
stat_of_pad (Bench * b, guint i, const gchar * name)
{
  g_autoptr (GstStructure) stats = NULL;
  g_autofree gchar *pad = g_strdup_printf ("sink_%u", i);
  const GValue *value;
  guint64 count = G_MAXUINT64;

  g_object_get (b->sync, "stats", &stats, NULL);
  value = gst_structure_get_value (stats, pad);
  fail_unless (value && GST_VALUE_HOLDS_STRUCTURE (value));
  fail_unless (gst_structure_get_uint64 (gst_value_get_structure (value), name,
          &count));
  return count;
}

static inline GstMessage *
message_of (Bench * b, GstMessageType type)
{
  return gst_bus_pop_filtered (b->bus, type);
}
