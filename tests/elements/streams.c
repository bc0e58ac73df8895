/* Mesh and observation streams through the stock payloaders: caps and bytes unchanged.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <math.h>

#define FRAMES 5

static const gchar *const carriers[] = {
  "gdppay ! gdpdepay",
  "rtpgstpay ! rtpgstdepay",
  "rtpgstpay mtu=200 ! rtpgstdepay",
  "rtpgstpay config-interval=1 ! rtpgstdepay",
  "queue ! tee ! queue",
};

static GstBuffer *
make_mesh (guint number, guint n)
{
  g_autofree gfloat *positions = g_new (gfloat, 3 * n);
  g_autofree gfloat *covariances = g_new (gfloat, 6 * n);
  g_autofree guint8 *states = g_new (guint8, n);
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *buffer;

  for (guint i = 0; i < 3 * n; i++)
    positions[i] = sinf (0.01f * i + number);
  for (guint i = 0; i < 6 * n; i++)
    covariances[i] = 1e-6f * (i % 6 + number);
  for (guint i = 0; i < n; i++)
    states[i] = (guint8) ((i + number) % 5);
  mesh = gst_cloth_mesh_new (number, n, positions, states, covariances);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = gst_util_uint64_scale (number, GST_SECOND, 25);
  GST_BUFFER_DURATION (buffer) = GST_SECOND / 25;
  return buffer;
}

static GstBuffer *
make_observation (guint number, guint n)
{
  g_autofree GstClothSaddle *saddles = g_new0 (GstClothSaddle, n);
  g_autoptr (GstBuffer) picture = gst_buffer_new ();
  g_autoptr (GstCaps) clock = gst_caps_from_string ("timestamp/x-ptp, "
      "version=(string)IEEE1588-2008, domain=(int)1");

  for (guint i = 0; i < n; i++) {
    saddles[i].x = 0.1f * i + number;
    saddles[i].y = 0.3f * i;
    saddles[i].cov_xx = saddles[i].cov_yy = 1e-4f;
  }
  gst_buffer_add_cloth_saddles_meta (picture, gst_cloth_saddles_new ("cam1",
          number, saddles, n, NULL, 0));
  gst_buffer_add_reference_timestamp_meta (picture, clock,
      1700000000000000000 + number, GST_CLOCK_TIME_NONE);
  GST_BUFFER_PTS (picture) = gst_util_uint64_scale (number, GST_SECOND, 25);
  GST_BUFFER_DURATION (picture) = GST_SECOND / 25;
  return gst_cloth_observations_pack (picture);
}

static void
assert_same (GstBuffer * before, GstBuffer * after)
{
  GstMapInfo a, b;

  gst_buffer_map (before, &a, GST_MAP_READ);
  gst_buffer_map (after, &b, GST_MAP_READ);
  g_assert_cmpmem (a.data, a.size, b.data, b.size);
  gst_buffer_unmap (before, &a);
  gst_buffer_unmap (after, &b);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (before), GST_BUFFER_PTS (after));
}

GST_START_TEST (test_mesh)
{
  static const guint sides[] = { 2, 9, 100 };
  const gchar *carrier = carriers[__i__];

  for (guint s = 0; s < G_N_ELEMENTS (sides); s++) {
    guint n = sides[s] * sides[s];
    g_autoptr (GstClothTopology) topology =
        gst_cloth_topology_new_grid (sides[s], sides[s], 1, 1, NULL);
    g_autoptr (GstCaps) caps = gst_cloth_topology_to_caps (topology, 25, 1);
    g_autoptr (GstCaps) got = NULL;
    g_autoptr (GstClothTopology) read = NULL;
    g_autoptr (GError) error = NULL;
    GstHarness *h = gst_harness_new_parse (carrier);

    gst_harness_set_src_caps (h, gst_caps_ref (caps));
    for (guint i = 0; i < FRAMES; i++)
      fail_unless_equals_int (gst_harness_push (h, make_mesh (i, n)),
          GST_FLOW_OK);
    gst_harness_push_event (h, gst_event_new_eos ());
    for (guint i = 0; i < FRAMES; i++) {
      g_autoptr (GstBuffer) after = gst_harness_pull (h);
      g_autoptr (GstBuffer) before = make_mesh (i, n);
      g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (after,
          &error);

      g_assert_no_error (error);
      fail_unless (mesh != NULL);
      fail_unless_equals_uint64 (gst_cloth_mesh_get_sequence (mesh), i);
      assert_same (before, after);
    }
    got = gst_pad_get_current_caps (h->sinkpad);
    fail_unless (gst_caps_is_equal (got, caps));
    read = gst_cloth_topology_from_caps (got, &error);
    g_assert_no_error (error);
    fail_unless_equals_int (gst_cloth_topology_get_columns (read), sides[s]);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

GST_START_TEST (test_observations)
{
  static const guint counts[] = { 0, 1, 3500 };
  const gchar *carrier = carriers[__i__];

  for (guint c = 0; c < G_N_ELEMENTS (counts); c++) {
    g_autoptr (GstCaps) caps = gst_caps_from_string
        (GST_CLOTH_OBSERVATIONS_MEDIA_TYPE ", version=(int)1, width=(int)1920, "
        "height=(int)1080, framerate=(fraction)25/1");
    g_autoptr (GstCaps) got = NULL;
    GstHarness *h = gst_harness_new_parse (carrier);

    gst_harness_set_src_caps (h, gst_caps_ref (caps));
    for (guint i = 0; i < FRAMES; i++)
      fail_unless_equals_int (gst_harness_push (h, make_observation (i,
                  counts[c])), GST_FLOW_OK);
    for (guint i = 0; i < FRAMES; i++) {
      g_autoptr (GstBuffer) after = gst_harness_pull (h);
      g_autoptr (GstBuffer) before = make_observation (i, counts[c]);
      g_autoptr (GstBuffer) target = gst_buffer_new ();
      g_autoptr (GError) error = NULL;
      GstClothSaddles *saddles;
      GstReferenceTimestampMeta *time;

      assert_same (before, after);
      gst_cloth_observations_unpack (after, target, &error);
      g_assert_no_error (error);
      saddles = gst_buffer_get_cloth_saddles (target);
      fail_unless_equals_string (gst_cloth_saddles_get_camera (saddles),
          "cam1");
      fail_unless_equals_uint64 (gst_cloth_saddles_get_sequence (saddles), i);
      fail_unless_equals_int (gst_cloth_saddles_get_n_refined (saddles),
          counts[c]);
      time = gst_buffer_get_reference_timestamp_meta (target, NULL);
      fail_unless_equals_uint64 (time->timestamp, 1700000000000000000 + i);
    }
    got = gst_pad_get_current_caps (h->sinkpad);
    fail_unless (gst_caps_is_equal (got, caps));
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* What arrives is bytes of somebody else: cut or bent on the way they are refused. */
GST_START_TEST (test_cut_on_the_way)
{
  g_autoptr (GstBuffer) mesh = make_mesh (1, 81);
  g_autoptr (GstBuffer) observation = make_observation (1, 7);
  g_autoptr (GstBuffer) cut = gst_buffer_copy_region (mesh,
      GST_BUFFER_COPY_ALL, 0, gst_buffer_get_size (mesh) - 1);
  g_autoptr (GstBuffer) bent = gst_buffer_copy_region (observation,
      GST_BUFFER_COPY_ALL | GST_BUFFER_COPY_DEEP, 0, -1);
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GError) error = NULL;

  fail_unless (gst_cloth_mesh_from_buffer (cut, &error) == NULL);
  fail_unless (g_error_matches (error, GST_CLOTH_ERROR,
          GST_CLOTH_ERROR_TRUNCATED));
  g_clear_error (&error);
  fail_unless (gst_cloth_mesh_from_buffer (observation, &error) == NULL);
  fail_unless (g_error_matches (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_MAGIC));
  g_clear_error (&error);
  gst_buffer_memset (bent, 12, 0xff, 4);
  fail_if (gst_cloth_observations_unpack (bent, target, &error));
  fail_unless (g_error_matches (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_LIMIT));
  fail_unless (gst_buffer_get_cloth_saddles (target) == NULL);
}

GST_END_TEST;

static Suite *
streams_suite (void)
{
  Suite *suite = suite_create ("streams");
  TCase *chain = tcase_create ("general");

  suite_add_tcase (suite, chain);
  tcase_add_loop_test (chain, test_mesh, 0, G_N_ELEMENTS (carriers));
  tcase_add_loop_test (chain, test_observations, 0, G_N_ELEMENTS (carriers));
  tcase_add_test (chain, test_cut_on_the_way);
  return suite;
}

GST_CHECK_MAIN (streams);
