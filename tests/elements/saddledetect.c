/* saddledetect: formats, strides, sharing of memory, events, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/check.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <math.h>
#include <string.h>

#include "tests/elements/padded.h"

#define SIDE 16

/* Squares of SIDE px whose corners lie between pixels: SIDE·k − 0.5. */
static void
paint (guint8 * luma, gint width, gint height, gint stride, gint step)
{
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++)
      luma[y * stride + x * step] = (x / SIDE + y / SIDE) % 2 ? 200 : 40;
}

static GstBuffer *
board (const GstVideoInfo * info, gint padding)
{
  Luma luma;
  GstBuffer *buffer = padded_picture (info, padding, 0xcc, &luma);
  GstMapInfo map;

  gst_buffer_map (buffer, &map, GST_MAP_WRITE);
  paint (map.data + luma.offset + GST_VIDEO_INFO_COMP_POFFSET (info, 0),
      GST_VIDEO_INFO_WIDTH (info), GST_VIDEO_INFO_HEIGHT (info), luma.stride,
      GST_VIDEO_INFO_COMP_PSTRIDE (info, 0));
  gst_buffer_unmap (buffer, &map);
  GST_BUFFER_PTS (buffer) = 0;
  return buffer;
}

static gchar *
caps_of (const gchar * format, gint width, gint height)
{
  return g_strdup_printf ("video/x-raw,format=%s,width=%d,height=%d,"
      "framerate=25/1", format, width, height);
}

static void
assert_board (GstBuffer * buffer, gint width, gint height)
{
  GstClothSaddles *saddles = gst_buffer_get_cloth_saddles (buffer);
  const GstClothSaddle *refined;
  const GstClothCandidate *candidates;
  guint n, m, expected = 0;

  fail_unless (saddles != NULL);
  refined = gst_cloth_saddles_get_refined (saddles, &n);
  candidates = gst_cloth_saddles_get_candidates (saddles, &m);
  for (gint y = SIDE; y < height - 4; y += SIDE) {
    for (gint x = SIDE; x < width - 4; x += SIDE) {
      gboolean found = FALSE, candidate = FALSE;

      for (guint i = 0; i < n; i++)
        found |= hypot (refined[i].x - x + 0.5, refined[i].y - y + 0.5) < 0.02
            && refined[i].cov_xx > 0 && refined[i].response > 100;
      for (guint i = 0; i < m; i++)
        candidate |= hypot (candidates[i].x - x + 0.5,
            candidates[i].y - y + 0.5) < 1;
      fail_unless (found && candidate, "no saddle at %d, %d", x, y);
      expected++;
    }
  }
  /* Those near the border may be found, others not. */
  fail_unless (n >= expected
      && n <= (guint) ((width - 1) / SIDE * ((height - 1) / SIDE)),
      "%u saddles for %u corners", n, expected);
}

GST_START_TEST (test_formats)
{
  static const gchar *const formats[] = { "GRAY8", "I420", "YV12", "NV12",
    "NV21", "Y42B", "NV16", "NV61", "Y444", "NV24", "Y41B", "YUV9", "YVU9",
    "A420", "YUY2", "UYVY", "YVYU"
  };
  static const gint sizes[][3] = { {96, 64, 0}, {97, 65, 0}, {97, 65, 7},
  {131, 83, 64}
  };

  for (guint f = 0; f < G_N_ELEMENTS (formats); f++) {
    for (guint s = 0; s < G_N_ELEMENTS (sizes); s++) {
      GstHarness *h = gst_harness_new ("saddledetect");
      g_autofree gchar *caps = caps_of (formats[f], sizes[s][0], sizes[s][1]);
      g_autoptr (GstCaps) parsed = gst_caps_from_string (caps);
      GstVideoInfo info;
      GstBuffer *out;

      fail_unless (gst_video_info_from_caps (&info, parsed));
      gst_harness_set_src_caps_str (h, caps);
      out = gst_harness_push_and_pull (h, board (&info, sizes[s][2]));
      fail_unless (out != NULL);
      assert_board (out, sizes[s][0], sizes[s][1]);
      gst_buffer_unref (out);
      gst_harness_teardown (h);
    }
  }
}

GST_END_TEST;

static void
expect_message_of_encoded (GstBus * bus, const gchar * text)
{
  g_autoptr (GstMessage) message = gst_bus_pop_filtered (bus,
      GST_MESSAGE_ERROR);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;

  fail_unless ((message != NULL) == (text != NULL));
  if (!text) {
    return;
  }
  gst_message_parse_error (message, &error, &debug);
  fail_unless (strstr (error->message, "has to be decoded first") != NULL);
  fail_unless (strstr (debug, text) != NULL, "%s", debug);
}

static GstCaps *offered_caps;

static gboolean
offer_caps (GstPad * pad, GstObject * parent, GstQuery * query)
{
  if (GST_QUERY_TYPE (query) != GST_QUERY_CAPS) {
    return gst_pad_query_default (pad, parent, query);
  }
  gst_query_set_caps_result (query, offered_caps);
  return TRUE;
}

/* A camera that sends nothing but encoded pictures is told what decodes them, when it has tried to
 * send them or given up; one that can send others as well is not. That somebody asks changes
 * nothing. */
GST_START_TEST (test_encoded)
{
  static const struct
  {
    const gchar *offered, *text;
  } cases[] = {
    {"image/jpeg, width=640, height=480, framerate=30/1",
        "Put jpegdec before saddles"},
    {"video/x-h264, width=640, height=480",
        "Put h264parse ! avdec_h264 before"},
    {"image/jpeg; video/x-raw, format=YUY2, width=640, height=480", NULL},
    {"video/x-raw, format=RGB, width=640, height=480", NULL},
  };

  for (guint k = 0; k < 2 * G_N_ELEMENTS (cases); k++) {
    const guint i = k / 2, sends = k % 2;
    GstElement *element = gst_element_factory_make ("saddledetect", "saddles");
    GstHarness *h = gst_harness_new_with_element (element, "sink", "src");
    g_autoptr (GstPad) pad = NULL;
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstCaps) taken = NULL;

    offered_caps = gst_caps_from_string (cases[i].offered);
    gst_pad_set_query_function (h->srcpad, offer_caps);
    gst_element_set_bus (element, bus);
    gst_harness_play (h);
    gst_harness_push_event (h, gst_event_new_stream_start ("camera"));
    pad = gst_element_get_static_pad (element, "sink");
    taken = gst_pad_query_caps (pad, offered_caps);
    fail_unless (cases[i].text == NULL || gst_caps_is_empty (taken));
    if (gst_caps_is_fixed (offered_caps)) {
      fail_if (gst_pad_query_accept_caps (pad, offered_caps));
    }
    expect_message_of_encoded (bus, NULL);
    if (sends && gst_caps_is_fixed (offered_caps)) {
      gst_harness_push_event (h, gst_event_new_caps (offered_caps));
      expect_message_of_encoded (bus, cases[i].text);
    }
    gst_harness_push_event (h, gst_event_new_eos ());
    /* once is enough */
    expect_message_of_encoded (bus, sends ? NULL : cases[i].text);
    gst_element_set_bus (element, NULL);
    gst_harness_teardown (h);
    gst_object_unref (element);
    gst_clear_caps (&offered_caps);
  }
}

GST_END_TEST;

/* A stream that was good ends well, whatever else its source could send. */
GST_START_TEST (test_not_encoded)
{
  GstElement *element = gst_element_factory_make ("saddledetect", NULL);
  GstHarness *h = gst_harness_new_with_element (element, "sink", "src");
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autofree gchar *caps = caps_of ("GRAY8", 96, 64);

  offered_caps = gst_caps_from_string ("image/jpeg");
  gst_harness_set_src_caps_str (h, caps);
  gst_pad_set_query_function (h->srcpad, offer_caps);
  gst_element_set_bus (element, bus);
  gst_harness_push_event (h, gst_event_new_eos ());
  expect_message_of_encoded (bus, NULL);
  gst_element_set_bus (element, NULL);
  gst_harness_teardown (h);
  gst_object_unref (element);
  gst_clear_caps (&offered_caps);
}

GST_END_TEST;

/* What else holds the buffer keeps it without metas; both hold the same memory, whose
 * bytes have not changed. */
GST_START_TEST (test_shared)
{
  GstHarness *h = gst_harness_new ("saddledetect");
  g_autofree gchar *caps = caps_of ("GRAY8", 96, 64);
  g_autoptr (GstCaps) parsed = gst_caps_from_string (caps);
  g_autofree guint8 *before = g_malloc (96 * 64);
  GstVideoInfo info;
  GstBuffer *in, *out;
  GstMemory *memory;
  GstMapInfo a, b;

  gst_video_info_from_caps (&info, parsed);
  gst_harness_set_src_caps_str (h, caps);
  in = board (&info, 0);
  gst_buffer_extract (in, 0, before, 96 * 64);
  memory = gst_buffer_peek_memory (in, 0);
  out = gst_harness_push_and_pull (h, gst_buffer_ref (in));
  fail_unless (out != in);
  fail_unless (gst_buffer_n_memory (out) == 1);
  fail_unless (gst_buffer_get_cloth_saddles (in) == NULL);
  assert_board (out, 96, 64);
  gst_memory_map (memory, &a, GST_MAP_READ);
  gst_buffer_map (out, &b, GST_MAP_READ);
  fail_unless (a.data == b.data);
  fail_unless (memcmp (b.data, before, 96 * 64) == 0);
  gst_buffer_unmap (out, &b);
  gst_memory_unmap (memory, &a);
  gst_buffer_unref (in);
  gst_buffer_unref (out);

  /* held by nobody else, the very buffer comes back */
  in = board (&info, 0);
  out = gst_harness_push_and_pull (h, in);
  fail_unless (out == in);
  gst_buffer_unref (out);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_after_tee)
{
  GstElement *pipeline = gst_parse_launch ("videotestsrc num-buffers=5 "
      "pattern=checkers-8 ! video/x-raw,format=I420,width=160,height=120 ! "
      "tee name=t ! queue ! saddledetect camera=left ! fakesink name=a "
      "enable-last-sample=true sync=false async=false "
      "t. ! queue ! fakesink name=b sync=false async=false", NULL);
  GstBus *bus = gst_element_get_bus (pipeline);
  GstMessage *message;
  GstSample *sample[2] = { NULL, NULL };
  GstMapInfo map[2];
  GstClothSaddles *saddles;
  guint n;

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless (GST_MESSAGE_TYPE (message) == GST_MESSAGE_EOS);
  gst_message_unref (message);
  for (gint i = 0; i < 2; i++) {
    g_autoptr (GstElement) sink = gst_bin_get_by_name (GST_BIN (pipeline),
        i ? "b" : "a");
    g_object_get (sink, "last-sample", &sample[i], NULL);
    fail_unless (sample[i] != NULL);
    gst_buffer_map (gst_sample_get_buffer (sample[i]), &map[i], GST_MAP_READ);
  }
  fail_unless (map[0].data == map[1].data);
  saddles = gst_buffer_get_cloth_saddles (gst_sample_get_buffer (sample[0]));
  fail_unless (saddles != NULL);
  fail_unless (gst_buffer_get_cloth_saddles (gst_sample_get_buffer (sample[1]))
      == NULL);
  fail_unless_equals_string (gst_cloth_saddles_get_camera (saddles), "left");
  fail_unless_equals_uint64 (gst_cloth_saddles_get_sequence (saddles), 4);
  gst_cloth_saddles_get_refined (saddles, &n);
  fail_unless (n >= 200, "%u saddles", n);
  for (gint i = 0; i < 2; i++) {
    gst_buffer_unmap (gst_sample_get_buffer (sample[i]), &map[i]);
    gst_sample_unref (sample[i]);
  }
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (bus);
  gst_object_unref (pipeline);
}

GST_END_TEST;

GST_START_TEST (test_renegotiation)
{
  static const gint sizes[][2] = { {96, 64}, {1, 1}, {321, 33}, {2, 2},
  {96, 65}
  };
  GstHarness *h = gst_harness_new ("saddledetect");

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    g_autofree gchar *caps = caps_of (i % 2 ? "I420" : "GRAY8", sizes[i][0],
        sizes[i][1]);
    g_autoptr (GstCaps) parsed = gst_caps_from_string (caps);
    GstVideoInfo info;
    GstBuffer *out;

    gst_video_info_from_caps (&info, parsed);
    gst_harness_set_src_caps_str (h, caps);
    out = gst_harness_push_and_pull (h, board (&info, 0));
    assert_board (out, sizes[i][0], sizes[i][1]);
    gst_buffer_unref (out);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_flush_and_eos)
{
  GstHarness *h = gst_harness_new ("saddledetect");
  g_autofree gchar *caps = caps_of ("NV12", 96, 64);
  g_autoptr (GstCaps) parsed = gst_caps_from_string (caps);
  GstSegment segment;
  GstVideoInfo info;
  GstEvent *event;
  GstBuffer *out;
  gboolean eos = FALSE;

  gst_video_info_from_caps (&info, parsed);
  gst_harness_set_src_caps_str (h, caps);
  out = gst_harness_push_and_pull (h, board (&info, 0));
  gst_buffer_unref (out);
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
  out = gst_harness_push_and_pull (h, board (&info, 0));
  assert_board (out, 96, 64);
  gst_buffer_unref (out);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  while ((event = gst_harness_try_pull_event (h))) {
    eos |= GST_EVENT_TYPE (event) == GST_EVENT_EOS;
    gst_event_unref (event);
  }
  fail_unless (eos);
  fail_unless (gst_harness_push (h, board (&info, 0)) == GST_FLOW_EOS);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* An appsrc counts in bytes when nobody tells it otherwise. */
GST_START_TEST (test_segment_in_bytes)
{
  GstHarness *h = gst_harness_new ("saddledetect");
  g_autofree gchar *caps = caps_of ("GRAY8", 96, 64);
  g_autoptr (GstCaps) parsed = gst_caps_from_string (caps);
  GstSegment segment;
  GstVideoInfo info;

  gst_video_info_from_caps (&info, parsed);
  gst_harness_set_src_caps_str (h, caps);
  gst_segment_init (&segment, GST_FORMAT_BYTES);
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
  for (guint i = 0; i < 2; i++) {
    g_autoptr (GstBuffer) out = gst_harness_push_and_pull (h, board (&info, 0));

    assert_board (out, 96, 64);
    fail_unless_equals_uint64 (gst_cloth_saddles_get_sequence
        (gst_buffer_get_cloth_saddles (out)), i);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A second detector's saddles take the place of the first one's. */
GST_START_TEST (test_chain)
{
  GstHarness *h = gst_harness_new_parse ("saddledetect camera=first ! "
      "saddledetect camera=second refine=model roi-width=40 roi-height=40");
  g_autofree gchar *caps = caps_of ("GRAY8", 96, 64);
  g_autoptr (GstCaps) parsed = gst_caps_from_string (caps);
  GstVideoInfo info;
  GstBuffer *out;
  GstClothSaddles *saddles;
  const GstClothSaddle *refined;
  guint n;

  gst_video_info_from_caps (&info, parsed);
  gst_harness_set_src_caps_str (h, caps);
  out = gst_harness_push_and_pull (h, board (&info, 0));
  saddles = gst_buffer_get_cloth_saddles (out);
  fail_unless_equals_string (gst_cloth_saddles_get_camera (saddles), "second");
  refined = gst_cloth_saddles_get_refined (saddles, &n);
  fail_unless_equals_int (n, 4);
  for (guint i = 0; i < n; i++)
    fail_unless (refined[i].x < 40 && refined[i].y < 40);
  fail_unless (gst_buffer_get_n_meta (out,
          gst_cloth_saddles_meta_api_get_type ()) == 1);
  gst_buffer_unref (out);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_properties)
{
  GstElement *element = gst_element_factory_make ("saddledetect", NULL);
  static const gchar *const doubles[] = { "sigma", "epsilon",
    "relative-epsilon", "radius"
  };
  static const gchar *const ints[] = { "roi-x", "roi-y", "roi-width",
    "roi-height"
  };
  gboolean qos = TRUE;
  gint refine;

  for (guint i = 0; i < G_N_ELEMENTS (doubles); i++) {
    GParamSpecDouble *spec = G_PARAM_SPEC_DOUBLE (g_object_class_find_property
        (G_OBJECT_GET_CLASS (element), doubles[i]));
    gdouble value;

    g_object_get (element, doubles[i], &value, NULL);
    fail_unless (fabs (value - spec->default_value) < 1e-6);
    g_object_set (element, doubles[i], spec->maximum, NULL);
    g_object_get (element, doubles[i], &value, NULL);
    fail_unless (fabs (value - spec->maximum) < 1e-6 * spec->maximum);
  }
  for (guint i = 0; i < G_N_ELEMENTS (ints); i++) {
    gint value;
    g_object_set (element, ints[i], 77, NULL);
    g_object_get (element, ints[i], &value, NULL);
    fail_unless_equals_int (value, 77);
  }
  gst_util_set_object_arg (G_OBJECT (element), "refine", "none");
  g_object_get (element, "qos", &qos, "refine", &refine, NULL);
  fail_if (qos);
  fail_unless_equals_int (refine, 0);
  gst_object_unref (element);
}

GST_END_TEST;

GST_START_TEST (test_refine_none)
{
  GstHarness *h = gst_harness_new_parse ("saddledetect refine=none");
  g_autofree gchar *caps = caps_of ("GRAY8", 96, 64);
  g_autoptr (GstCaps) parsed = gst_caps_from_string (caps);
  GstVideoInfo info;
  GstBuffer *out;
  guint n;

  gst_video_info_from_caps (&info, parsed);
  gst_harness_set_src_caps_str (h, caps);
  out = gst_harness_push_and_pull (h, board (&info, 0));
  gst_cloth_saddles_get_refined (gst_buffer_get_cloth_saddles (out), &n);
  fail_unless_equals_int (n, 0);
  gst_cloth_saddles_get_candidates (gst_buffer_get_cloth_saddles (out), &n);
  fail_unless (n > 15);
  gst_buffer_unref (out);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Neither 16-bit grey nor RGB nor huge pictures are taken. */
GST_START_TEST (test_refused_caps)
{
  static const gchar *const bad[] = {
    "video/x-raw,format=GRAY16_LE,width=16,height=16,framerate=25/1",
    "video/x-raw,format=AYUV,width=16,height=16,framerate=25/1",
    "video/x-raw,format=RGB,width=16,height=16,framerate=25/1",
    "video/x-raw,format=GRAY8,width=16385,height=16,framerate=25/1",
    "video/x-raw,format=GRAY8,width=0,height=16,framerate=25/1",
    "image/jpeg"
  };

  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    GstElement *element = gst_element_factory_make ("saddledetect", NULL);
    g_autoptr (GstPad) pad = gst_element_get_static_pad (element, "sink");
    g_autoptr (GstCaps) caps = gst_caps_from_string (bad[i]);

    fail_if (gst_pad_query_accept_caps (pad, caps), "%s", bad[i]);
    gst_object_unref (element);
  }
}

GST_END_TEST;

/* A buffer that holds less than its caps say. */
GST_START_TEST (test_short_buffer)
{
  GstHarness *h = gst_harness_new ("saddledetect");
  GstBus *bus = gst_bus_new ();
  GstMessage *message;

  gst_element_set_bus (h->element, bus);
  gst_harness_set_src_caps_str (h,
      "video/x-raw,format=GRAY8,width=64,height=64,framerate=25/1");
  fail_unless (gst_harness_push (h, gst_buffer_new_allocate (NULL, 100,
              NULL)) == GST_FLOW_ERROR);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_unref (message);
  gst_element_set_bus (h->element, NULL);
  gst_object_unref (bus);
  gst_harness_teardown (h);
}

GST_END_TEST;

static Suite *
saddledetect_suite (void)
{
  Suite *suite = suite_create ("saddledetect");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (suite, tc);
  tcase_add_test (tc, test_formats);
  tcase_add_test (tc, test_encoded);
  tcase_add_test (tc, test_not_encoded);
  tcase_add_test (tc, test_shared);
  tcase_add_test (tc, test_after_tee);
  tcase_add_test (tc, test_renegotiation);
  tcase_add_test (tc, test_flush_and_eos);
  tcase_add_test (tc, test_segment_in_bytes);
  tcase_add_test (tc, test_chain);
  tcase_add_test (tc, test_properties);
  tcase_add_test (tc, test_refine_none);
  tcase_add_test (tc, test_refused_caps);
  tcase_add_test (tc, test_short_buffer);
  return suite;
}

GST_CHECK_MAIN (saddledetect);
