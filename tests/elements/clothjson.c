/* clothjson: what was found as JSON Lines.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>

#include <math.h>

#define PICTURES "video/x-raw, format=(string)GRAY8, width=(int)4, " \
    "height=(int)4, framerate=(fraction)25/1"

static GstBuffer *
make_picture (void)
{
  GstBuffer *picture = gst_buffer_new_allocate (NULL, 16, NULL);

  GST_BUFFER_PTS (picture) = 120 * GST_MSECOND;
  return picture;
}

static gchar *
text_of (GstBuffer * buffer)
{
  g_autoptr (GstBuffer) held = buffer;
  GstMapInfo map;
  gchar *text;

  fail_unless (gst_buffer_map (held, &map, GST_MAP_READ));
  text = g_strndup ((const gchar *) map.data, map.size);
  gst_buffer_unmap (held, &map);
  return text;
}

static void
assert_line (GstBuffer * picture, const gchar * expected)
{
  GstHarness *h = gst_harness_new ("clothjson");
  g_autoptr (GstCaps) caps = NULL;
  g_autofree gchar *text = NULL;

  gst_harness_set_src_caps_str (h, PICTURES);
  fail_unless_equals_int (gst_harness_push (h, picture), GST_FLOW_OK);
  text = text_of (gst_harness_pull (h));
  fail_unless_equals_string (text, expected);
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_structure_has_name (gst_caps_get_structure (caps, 0),
          "application/x-ndjson"));
  gst_harness_teardown (h);
}

GST_START_TEST (test_squares)
{
  GstClothQuad quad = {.column = 7,.row = 3,.black = TRUE,.confidence = 0.5f,
    .state = GST_CLOTH_QUAD_LOST,.x = {1, 2, 3, 4},.y = {5, 6, 7, NAN},
    .cov_xx = {0.25f}
  };
  GstBuffer *picture = make_picture ();

  /* A name is text, whatever stands in it. */
  gst_buffer_add_cloth_quads_meta (picture,
      gst_cloth_quads_new ("a\"\n", 9, 8, 8, &quad, 1));
  assert_line (picture,
      "{\"frame\": 9, \"time_s\": 0.12, \"camera\": \"a\\\"\\n\", "
      "\"squares\": [{\"column\": 7, \"row\": 3, \"state\": \"lost\", \"black\": true, "
      "\"confidence\": 0.5, \"corners_px\": [[1, 5], [2, 6], [3, 7], [4, null]], "
      "\"covariances_px2\": [[0.25, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]]}]}\n");
}

GST_END_TEST;

GST_START_TEST (test_dots_and_matches)
{
  GstClothDot dot = {.column = -1,.row = -1,.x = 1.5f,.y = 2,.cov_yy = 4,
    .log_likelihood = {-0.5f, -2}
  };
  GstClothMatch match = {.x = 1,.y = 2,.u = 0.25f,.v = 0.5f,.scale = 2,
    .distance = 3,.verified = TRUE
  };
  GstClothGridPoint point = {.column = 2,.row = 1,.mirrored = TRUE,.x = 3 };
  GstBuffer *picture = make_picture ();

  gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new (NULL, 4, 8, 8,
          2, &dot, 1));
  gst_buffer_add_cloth_matches_meta (picture, gst_cloth_matches_new (NULL, 4,
          5, 5, 9, FALSE, &match, 1, &point, 1));
  assert_line (picture, "{\"frame\": 4, \"time_s\": 0.12, \"camera\": null, "
      "\"dots\": [{\"column\": null, \"row\": null, \"mirrored\": false, "
      "\"touches\": false, \"confidence\": 0, \"centre_px\": [1.5, 2], "
      "\"covariance_px2\": [0, 0, 4], \"log_likelihoods\": [-0.5, -2]}], "
      "\"matches\": [{\"place_px\": [1, 2], \"uv_m\": [0.25, 0.5], \"scale_px\": 2, "
      "\"distance\": 3, \"mirrored\": false, \"verified\": true}], "
      "\"vertices\": [{\"column\": 2, \"row\": 1, \"mirrored\": true, "
      "\"place_px\": [3, 0], \"covariance_px2\": [0, 0, 0]}]}\n");
}

GST_END_TEST;

/* Looked, and nothing was there; nobody looked; no time. */
GST_START_TEST (test_nothing)
{
  GstBuffer *picture = make_picture ();

  gst_buffer_add_cloth_quads_meta (picture, gst_cloth_quads_new ("c", 0, 8, 8,
          NULL, 0));
  assert_line (picture,
      "{\"frame\": 0, \"time_s\": 0.12, \"camera\": \"c\", \"squares\": []}\n");
  picture = make_picture ();
  GST_BUFFER_PTS (picture) = GST_CLOCK_TIME_NONE;
  assert_line (picture,
      "{\"frame\": null, \"time_s\": null, \"camera\": null}\n");
}

GST_END_TEST;

static GstHarness *
harness_of_meshes (const GstClothTopology * topology)
{
  GstHarness *h = gst_harness_new ("clothjson");

  gst_harness_set_src_caps (h, gst_cloth_topology_to_caps (topology, 25, 1));
  return h;
}

GST_START_TEST (test_mesh)
{
  const gfloat positions[12] = { 0, 1, 2, NAN, NAN, NAN, 0.1f, 0, 0, 1, 1, 1 };
  const guint8 states[4] = { 1, 0, 3, 4 };
  const gfloat covariances[24] = { 1, 0, 0, 1, 0, 1, NAN, NAN, NAN, NAN, NAN,
    NAN, 2, 0, 0, 2, 0, 2, NAN, NAN, NAN, NAN, NAN, NAN
  };
  g_autoptr (GstClothTopology) topology = gst_cloth_topology_new_grid (2, 2,
      1, 1, NULL);
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (5, 4, positions, states,
      covariances);
  GstHarness *h = harness_of_meshes (topology);
  GstBuffer *buffer = gst_cloth_mesh_to_buffer (mesh);
  g_autofree gchar *text = NULL;

  GST_BUFFER_PTS (buffer) = GST_SECOND;
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  text = text_of (gst_harness_pull (h));
  fail_unless_equals_string (text,
      "{\"frame\": 5, \"time_s\": 1, \"columns\": 2, "
      "\"rows\": 2, \"positions_m\": [[0, 1, 2], null, [0.1, 0, 0], [1, 1, 1]], "
      "\"states\": [\"measured\", \"unseen\", \"filled\", \"predicted\"], "
      "\"covariances_m2\": [[1, 0, 0, 1, 0, 1], null, [2, 0, 0, 2, 0, 2], null]}\n");
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Bytes that are no mesh, and a mesh of another size. */
GST_START_TEST (test_damaged)
{
  const gfloat positions[3] = { 0, 1, 2 };
  const guint8 state = 1;
  g_autoptr (GstClothTopology) topology = gst_cloth_topology_new_grid (2, 2,
      1, 1, NULL);
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (5, 1, positions, &state,
      NULL);
  GstBuffer *wrong[2] = { gst_buffer_new_allocate (NULL, 40, NULL),
    gst_cloth_mesh_to_buffer (mesh)
  };

  gst_buffer_memset (wrong[0], 0, 77, 40);
  for (guint i = 0; i < 2; i++) {
    GstHarness *h = harness_of_meshes (topology);
    GstBus *bus = gst_bus_new ();
    g_autoptr (GstMessage) message = NULL;

    gst_element_set_bus (h->element, bus);
    fail_unless_equals_int (gst_harness_push (h, wrong[i]), GST_FLOW_ERROR);
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
    fail_unless (message != NULL);
    gst_element_set_bus (h->element, NULL);
    gst_object_unref (bus);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Caps without the topology, and of something else. */
GST_START_TEST (test_refused)
{
  GstHarness *h = gst_harness_new ("clothjson");

  gst_harness_set_src_caps_str (h, "application/x-cloth-mesh, version=(int)1, "
      "vertices=(int)4, framerate=(fraction)25/1");
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_allocate (NULL,
              84, NULL)), GST_FLOW_NOT_NEGOTIATED);
  gst_harness_set_src_caps_str (h, "audio/x-raw");
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_allocate (NULL,
              84, NULL)), GST_FLOW_NOT_NEGOTIATED);
  gst_harness_teardown (h);
}

GST_END_TEST;

static Suite *
clothjson_suite (void)
{
  Suite *s = suite_create ("clothjson");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_squares);
  tcase_add_test (tc, test_dots_and_matches);
  tcase_add_test (tc, test_nothing);
  tcase_add_test (tc, test_mesh);
  tcase_add_test (tc, test_damaged);
  tcase_add_test (tc, test_refused);
  return s;
}

GST_CHECK_MAIN (clothjson);
