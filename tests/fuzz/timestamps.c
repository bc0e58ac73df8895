/* Fuzz target: frames, gaps and segments of any time through the elements that join
 * streams. Every stream ends, whatever came before.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzzelements.h"

#define N_PADS 2
#define MAX_ITEMS 32

typedef struct
{
  GstHarness *in;
  GPtrArray *items;             /* GstMiniObject: buffers and events */
} Feed;

static GstClockTime
take_time (FuzzBytes * bytes)
{
  static const GstClockTime wild[] = { GST_CLOCK_TIME_NONE, 0, 1, G_MAXINT64,
    (GstClockTime) G_MAXINT64 + 1, G_MAXINT64 - 1, G_MAXUINT64 - 1,
    G_MAXUINT32, GST_SECOND
  };
  guint8 kind = fuzz_take_byte (bytes);

  if (kind < G_N_ELEMENTS (wild))
    return wild[kind];
  if (kind == G_N_ELEMENTS (wild))
    return fuzz_take_long (bytes);
  return (kind - 16) * (10 * GST_MSECOND);
}

static GstEvent *
make_segment (FuzzBytes * bytes)
{
  static const gdouble rates[] = { 1, 2, 0.5, -1, 1e-9, 1e9, -1e9, 1 };
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = rates[fuzz_take_byte (bytes) % 8];
  segment.start = take_time (bytes);
  segment.stop = take_time (bytes);
  segment.base = take_time (bytes);
  segment.offset = take_time (bytes);
  segment.time = take_time (bytes);
  /* What GStreamer itself lets nobody send. */
  if (!GST_CLOCK_TIME_IS_VALID (segment.start))
    segment.start = 0;
  if (!GST_CLOCK_TIME_IS_VALID (segment.base))
    segment.base = 0;
  if (!GST_CLOCK_TIME_IS_VALID (segment.offset))
    segment.offset = 0;
  if (GST_CLOCK_TIME_IS_VALID (segment.stop))
    segment.stop = MAX (segment.stop, segment.start);
  return gst_event_new_segment (&segment);
}

static gpointer
make_item (FuzzBytes * bytes)
{
  guint8 kind = fuzz_take_byte (bytes) % 8;
  GstClockTime pts;
  GstBuffer *buffer;

  if (kind == 0)
    return make_segment (bytes);
  pts = take_time (bytes);
  if (kind == 1 && GST_CLOCK_TIME_IS_VALID (pts))
    return gst_event_new_gap (pts, take_time (bytes));
  buffer = gst_buffer_new ();
  GST_BUFFER_PTS (buffer) = pts;
  if (kind < 4) {
    GST_BUFFER_DURATION (buffer) = take_time (bytes);
    GST_BUFFER_DTS (buffer) = take_time (bytes);
    GST_BUFFER_OFFSET (buffer) = take_time (bytes);
  }
  return buffer;
}

/* A pad takes one frame and then blocks until it is used: so each has its thread. */
static gpointer
feed (gpointer data)
{
  const Feed *self = data;

  for (guint i = 0; i < self->items->len; i++) {
    gpointer item = g_ptr_array_index (self->items, i);

    if (GST_IS_EVENT (item))
      gst_harness_push_event (self->in, item);
    else
      gst_harness_push (self->in, item);
  }
  gst_harness_push_event (self->in, gst_event_new_eos ());
  return NULL;
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  GstHarness *in[N_PADS], *src;
  GThread *threads[N_PADS];
  Feed feeds[N_PADS];
  GstBuffer *out;

  fuzz_elements_init ();
  src = fuzz_triangulate_new (N_PADS, in);
  for (guint i = 0; i < N_PADS; i++) {
    feeds[i].in = in[i];
    feeds[i].items = g_ptr_array_new ();
  }
  for (guint n = 0; n < MAX_ITEMS && bytes.size > 0; n++)
    g_ptr_array_add (feeds[fuzz_take_byte (&bytes) % N_PADS].items,
        make_item (&bytes));
  for (guint i = 0; i < N_PADS; i++)
    threads[i] = g_thread_new ("feed", feed, &feeds[i]);
  while (gst_harness_pull_until_eos (src, &out) && out)
    gst_buffer_unref (out);
  for (guint i = 0; i < N_PADS; i++) {
    g_thread_join (threads[i]);
    g_ptr_array_free (feeds[i].items, TRUE);
  }
  fuzz_triangulate_free (src, N_PADS, in);
  return 0;
}
