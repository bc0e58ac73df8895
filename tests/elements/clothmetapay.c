/* clothmetapay and clothmetadepay: from pictures to observations and back.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>

#include "tests/elements/damage.h"

#define OBSERVATIONS "application/x-cloth-observations, version=(int)1, " \
    "width=(int)321, height=(int)239, framerate=(fraction)25/1"

static GstBuffer *
make_picture (guint number, gsize size)
{
  GstClothSaddle saddle = {.x = 1.5f + number,.y = 2.25f,.cov_xx = 0.01f };
  GstClothQuad quad = {.column = 7,.row = 3,.black = TRUE,.confidence = 0.5f };
  GstClothDot dot = {.column = 6,.row = 2,.x = 8.5f + number };
  GstBuffer *picture = gst_buffer_new_allocate (NULL, size, NULL);

  gst_buffer_memset (picture, 0, 77, size);
  gst_buffer_add_cloth_saddles_meta (picture, gst_cloth_saddles_new ("cam0",
          number, &saddle, 1, NULL, 0));
  gst_buffer_add_cloth_quads_meta (picture, gst_cloth_quads_new ("cam0", number,
          8, 8, &quad, 1));
  gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new ("cam0", number,
          8, 8, 5, &dot, 1));
  GST_BUFFER_PTS (picture) = number * 40 * GST_MSECOND;
  GST_BUFFER_DURATION (picture) = 40 * GST_MSECOND;
  return picture;
}

static void
check_metas (GstBuffer * buffer, guint number)
{
  GstClothSaddles *saddles = gst_buffer_get_cloth_saddles (buffer);
  GstClothQuads *quads = gst_buffer_get_cloth_quads (buffer);
  GstClothDots *dots = gst_buffer_get_cloth_dots (buffer);
  GstClothSaddle saddle;
  GstClothQuad quad;
  GstClothDot dot;

  fail_unless (saddles && quads && dots);
  fail_unless_equals_uint64 (gst_cloth_saddles_get_sequence (saddles), number);
  fail_unless_equals_string (gst_cloth_quads_get_camera (quads), "cam0");
  fail_unless (gst_cloth_saddles_get_saddle (saddles, 0, &saddle));
  fail_unless (saddle.x == 1.5f + number && saddle.cov_xx == 0.01f);
  fail_unless (gst_cloth_quads_get_quad (quads, 0, &quad));
  fail_unless (quad.column == 7 && quad.black && quad.confidence == 0.5f);
  fail_unless (gst_cloth_dots_get_dot (dots, 0, &dot));
  fail_unless (dot.column == 6 && dot.row == 2 && dot.x == 8.5f + number);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer),
      number * 40 * GST_MSECOND);
}

static void
assert_black (GstBuffer * picture, gsize size)
{
  GstMapInfo map;
  guint any = 0;

  fail_unless (gst_buffer_map (picture, &map, GST_MAP_READ));
  fail_unless_equals_uint64 (map.size, size);
  for (gsize i = 0; i < map.size; i++)
    any |= map.data[i];
  fail_unless_equals_int (any, 0);
  gst_buffer_unmap (picture, &map);
}

GST_START_TEST (test_pay)
{
  GstHarness *h = gst_harness_new ("clothmetapay");
  g_autoptr (GstCaps) caps = NULL;
  g_autoptr (GstCaps) expected = gst_caps_from_string (OBSERVATIONS);

  gst_harness_set_src_caps_str (h, "video/x-raw, format=(string)GRAY8, "
      "width=(int)321, height=(int)239, framerate=(fraction)25/1");
  for (guint i = 0; i < 5; i++) {
    g_autoptr (GstBuffer) observation = NULL;
    g_autoptr (GstBuffer) target = gst_buffer_new ();
    g_autoptr (GError) error = NULL;

    fail_unless_equals_int (gst_harness_push (h, make_picture (i, 324 * 239)),
        GST_FLOW_OK);
    observation = gst_harness_pull (h);
    fail_unless (gst_buffer_get_size (observation) < 400);
    fail_unless (gst_buffer_get_cloth_saddles (observation) == NULL);
    gst_cloth_observations_unpack (observation, target, &error);
    g_assert_no_error (error);
    GST_BUFFER_PTS (target) = GST_BUFFER_PTS (observation);
    check_metas (target, i);
  }
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_caps_is_equal (caps, expected));
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A picture that nobody looked at still gives a buffer: the cadence stays. */
GST_START_TEST (test_pay_without_metas)
{
  GstHarness *h = gst_harness_new ("clothmetapay");
  g_autoptr (GstBuffer) observation = NULL;

  gst_harness_set_src_caps_str (h, "video/x-raw, format=(string)I420, "
      "width=(int)4, height=(int)4");
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_allocate (NULL,
              24, NULL)), GST_FLOW_OK);
  observation = gst_harness_pull (h);
  fail_unless_equals_uint64 (gst_buffer_get_size (observation), 32);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* In a file the header's time is all there is: it must not depend on the segment, as it
 * would for films whose first picture is not at 0. */
GST_START_TEST (test_running_time)
{
  GstHarness *h = gst_harness_new ("clothmetapay");
  g_autoptr (GstBuffer) observation = NULL;
  GstSegment segment;
  GstMapInfo map;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.start = 80 * GST_MSECOND;
  segment.base = 7 * GST_MSECOND;
  gst_harness_set_src_caps_str (h, "video/x-raw, format=(string)GRAY8, "
      "width=(int)321, height=(int)239, framerate=(fraction)25/1");
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  fail_unless_equals_int (gst_harness_push (h, make_picture (3, 324 * 239)),
      GST_FLOW_OK);
  observation = gst_harness_pull (h);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (observation), 120 * GST_MSECOND);
  fail_unless (gst_buffer_map (observation, &map, GST_MAP_READ));
  fail_unless_equals_uint64 (GST_READ_UINT64_LE (map.data + 16),
      47 * GST_MSECOND);
  gst_buffer_unmap (observation, &map);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Times of clocks of the table are carried; of others that they are not is said, once. */
GST_START_TEST (test_clocks)
{
  static const struct
  {
    const gchar *clock;
    gboolean known;
  } cases[] = {
    {"timestamp/x-unix", TRUE},
    {"timestamp/x-ntp, host=(string)pool.ntp.org, port=(int)123", TRUE},
    {"timestamp/x-of-a-vendor", FALSE},
    {"timestamp/x-ntp, host=(string)pool.ntp.org, port=(int)-1", FALSE},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    GstHarness *h = gst_harness_new ("clothmetapay");
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstCaps) clock = gst_caps_from_string (cases[i].clock);
    g_autoptr (GstMessage) message = NULL;
    g_autoptr (GstMessage) second = NULL;

    gst_element_set_bus (h->element, bus);
    gst_harness_set_src_caps_str (h, "video/x-raw, format=(string)GRAY8, "
        "width=(int)321, height=(int)239, framerate=(fraction)25/1");
    for (guint k = 0; k < 2; k++) {
      g_autoptr (GstBuffer) observation = NULL;
      g_autoptr (GstBuffer) unpacked = gst_buffer_new ();
      GstBuffer *picture = make_picture (k, 324 * 239);

      gst_buffer_add_reference_timestamp_meta (picture, clock, 7 * GST_SECOND,
          GST_CLOCK_TIME_NONE);
      fail_unless_equals_int (gst_harness_push (h, picture), GST_FLOW_OK);
      observation = gst_harness_pull (h);
      fail_unless (gst_cloth_observations_unpack (observation, unpacked, NULL));
      fail_unless_equals_int (gst_buffer_get_n_meta (unpacked,
              GST_REFERENCE_TIMESTAMP_META_API_TYPE), cases[i].known);
    }
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING);
    second = gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING);
    fail_unless ((message != NULL) == !cases[i].known);
    fail_unless (second == NULL);
    gst_element_set_bus (h->element, NULL);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

GST_START_TEST (test_there_and_back)
{
  static const gchar *const carriers[] = { "", "gdppay ! gdpdepay ! ",
    "rtpgstpay ! rtpgstdepay ! "
  };

  for (guint c = 0; c < G_N_ELEMENTS (carriers); c++) {
    g_autofree gchar *line = g_strdup_printf ("clothmetapay ! %s"
        "clothmetadepay", carriers[c]);
    GstHarness *h = gst_harness_new_parse (line);

    gst_harness_set_src_caps_str (h, "video/x-raw, format=(string)NV12, "
        "width=(int)321, height=(int)239, framerate=(fraction)25/1");
    for (guint i = 0; i < 5; i++)
      fail_unless_equals_int (gst_harness_push (h, make_picture (i,
                  324 * 239 + 324 * 120)), GST_FLOW_OK);
    gst_harness_push_event (h, gst_event_new_eos ());
    for (guint i = 0; i < 5; i++) {
      g_autoptr (GstBuffer) picture = gst_harness_pull (h);

      check_metas (picture, i);
      assert_black (picture, 324 * 239);
    }
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* All pictures share one black memory; who draws on one gets a copy. */
GST_START_TEST (test_depay_shares_black)
{
  GstHarness *h = gst_harness_new_parse ("clothmetapay ! clothmetadepay");
  GstBuffer *first;
  g_autoptr (GstBuffer) second = NULL;

  gst_harness_set_src_caps_str (h, "video/x-raw, format=(string)GRAY8, "
      "width=(int)64, height=(int)48, framerate=(fraction)25/1");
  gst_harness_push (h, make_picture (0, 64 * 48));
  gst_harness_push (h, make_picture (1, 64 * 48));
  first = gst_harness_pull (h);
  second = gst_harness_pull (h);
  fail_unless (gst_buffer_peek_memory (first, 0) ==
      gst_buffer_peek_memory (second, 0));
  first = gst_buffer_make_writable (first);
  gst_buffer_memset (first, 0, 255, 100);
  assert_black (second, 64 * 48);
  gst_buffer_unref (first);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_renegotiation)
{
  GstHarness *h = gst_harness_new_parse ("clothmetapay ! clothmetadepay");
  static const gint sizes[][2] = { {64, 48}, {1, 1}, {321, 7} };

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    gint stride = GST_ROUND_UP_4 (sizes[i][0]);
    g_autofree gchar *caps = g_strdup_printf ("video/x-raw, "
        "format=(string)GRAY8, width=(int)%d, height=(int)%d, "
        "framerate=(fraction)25/1", sizes[i][0], sizes[i][1]);
    g_autoptr (GstBuffer) picture = NULL;

    gst_harness_set_src_caps_str (h, caps);
    gst_harness_push (h, make_picture (i, (gsize) stride * sizes[i][1]));
    picture = gst_harness_pull (h);
    check_metas (picture, i);
    assert_black (picture, (gsize) stride * sizes[i][1]);
  }
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  gst_harness_teardown (h);
}

GST_END_TEST;

static const guint8 damaged[3][40] = { "nothing of the kind", "GCOB\1\0\40",
  "GCOB\2\0\40"
};

/* What a network damages is dropped, what comes between goes on. */
GST_START_TEST (test_depay_damaged)
{
  GstHarness *h = gst_harness_new ("clothmetadepay");
  g_autoptr (GstBus) bus = gst_bus_new ();
  guint n_damaged = 0;
  guint64 dropped;

  gst_element_set_bus (h->element, bus);
  gst_harness_set_src_caps_str (h, OBSERVATIONS);
  for (guint number = 0; number < 3; number++) {
    g_autoptr (GstBuffer) picture = make_picture (number, 16);
    g_autoptr (GstBuffer) out = NULL;

    for (guint i = 0; i < 40; i++, n_damaged++)
      fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_memdup
              (damaged[i % 3], sizeof damaged[0])), GST_FLOW_OK);
    fail_unless_equals_int (gst_harness_push (h,
            gst_cloth_observations_pack (picture)), GST_FLOW_OK);
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), 1);
    out = gst_harness_pull (h);
    check_metas (out, number);
    fail_unless (GST_BUFFER_IS_DISCONT (out));
  }
  assert_dropped (h->element, bus, n_damaged, "damaged packet");
  assert_summed_up (bus, 0);
  gst_harness_push_event (h, gst_event_new_eos ());
  assert_summed_up (bus, n_damaged);

  /* a new start counts anew */
  gst_element_set_state (h->element, GST_STATE_READY);
  gst_element_set_state (h->element, GST_STATE_PLAYING);
  g_object_get (h->element, "dropped", &dropped, NULL);
  fail_unless_equals_uint64 (dropped, 0);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_depay_strict)
{
  for (guint i = 0; i < G_N_ELEMENTS (damaged); i++) {
    GstHarness *h = gst_harness_new_parse ("clothmetadepay strict=true");
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstElement) depay = gst_harness_find_element (h,
        "clothmetadepay");

    gst_element_set_bus (depay, bus);
    gst_harness_set_src_caps_str (h, OBSERVATIONS);
    fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_memdup
            (damaged[i], sizeof damaged[i])), GST_FLOW_ERROR);
    assert_refused_damage (depay, bus, "observation");
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
    gst_element_set_bus (depay, NULL);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Nothing damaged: nothing is told. */
GST_START_TEST (test_depay_sound)
{
  GstHarness *h = gst_harness_new ("clothmetadepay");
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstBuffer) picture = make_picture (0, 16);

  gst_element_set_bus (h->element, bus);
  gst_harness_set_src_caps_str (h, OBSERVATIONS);
  gst_harness_push (h, gst_cloth_observations_pack (picture));
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless (gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING | GST_MESSAGE_INFO
          | GST_MESSAGE_ERROR) == NULL);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_depay_other_version)
{
  GstHarness *h = gst_harness_new ("clothmetadepay");

  gst_harness_set_src_caps_str (h, "application/x-cloth-observations, "
      "version=(int)2, width=(int)4, height=(int)4, framerate=(fraction)25/1");
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_allocate (NULL,
              32, NULL)), GST_FLOW_NOT_NEGOTIATED);
  gst_harness_teardown (h);
}

GST_END_TEST;

static Suite *
clothmetapay_suite (void)
{
  Suite *suite = suite_create ("clothmetapay");
  TCase *chain = tcase_create ("general");

  suite_add_tcase (suite, chain);
  tcase_add_test (chain, test_pay);
  tcase_add_test (chain, test_pay_without_metas);
  tcase_add_test (chain, test_running_time);
  tcase_add_test (chain, test_clocks);
  tcase_add_test (chain, test_there_and_back);
  tcase_add_test (chain, test_depay_shares_black);
  tcase_add_test (chain, test_renegotiation);
  tcase_add_test (chain, test_depay_damaged);
  tcase_add_test (chain, test_depay_strict);
  tcase_add_test (chain, test_depay_sound);
  tcase_add_test (chain, test_depay_other_version);
  return suite;
}

GST_CHECK_MAIN (clothmetapay);
