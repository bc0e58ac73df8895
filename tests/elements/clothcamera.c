/* clothcamera: caps, formats, times, window of meshes, events, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/check.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "tests/elements/damage.h"

#define PATTERN TEST_DATA "/checker_pair/pattern.json"

static gchar *folder, *rig;

/* Two cameras before a cloth in the plane y = 0; odd sizes; the second is late. */
static void
make_rig (void)
{
  folder = g_dir_make_tmp ("clothcamera-XXXXXX", NULL);
  rig = g_build_filename (folder, "rig.json", NULL);
  g_assert_true (g_file_set_contents (rig,
          "{\"version\":1,\"cameras\":["
          "{\"name\":\"a\",\"size\":[97,65],\"K\":[[100,0,48],[0,100,32],"
          "[0,0,1]],\"distortion\":{\"model\":\"none\",\"coefficients\":[]},"
          "\"R\":[[1,0,0],[0,0,-1],[0,1,0]],\"t\":[0,0,2]},"
          "{\"name\":\"late\",\"size\":[64,48],\"K\":[[100,0,32],[0,100,24],"
          "[0,0,1]],\"distortion\":{\"model\":\"none\",\"coefficients\":[]},"
          "\"R\":[[1,0,0],[0,0,-1],[0,1,0]],\"t\":[0,0,2],"
          "\"offset_s\":0.02}]}", -1, NULL));
}

static void
remove_rig (void)
{
  g_remove (rig);
  g_rmdir (folder);
  g_free (rig);
  g_free (folder);
}

static GstCaps *
mesh_caps (guint columns, guint rows)
{
  g_autoptr (GstClothTopology) topology =
      gst_cloth_topology_new_grid (columns, rows, 0.6f, 0.4f, NULL);

  return gst_cloth_topology_to_caps (topology, 25, 1);
}

/* A flat cloth of 0.6 × 0.4 m that has moved to the right by @right. */
static GstBuffer *
mesh_buffer (guint number, guint columns, guint rows, gdouble right)
{
  g_autofree gfloat *positions = g_new (gfloat, 3 * columns * rows);
  g_autofree guint8 *states = g_malloc (columns * rows);
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *buffer;

  for (guint i = 0; i < columns * rows; i++) {
    positions[3 * i] = (gfloat) (right - 0.3 + 0.6 * (i % columns)
        / (columns - 1));
    positions[3 * i + 1] = 0;
    positions[3 * i + 2] = (gfloat) (0.2 - 0.4 * (i / columns) / (rows - 1));
    states[i] = GST_CLOTH_VERTEX_PREDICTED;
  }
  mesh = gst_cloth_mesh_new (number, columns * rows, positions, states, NULL);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = number * 40 * GST_MSECOND;
  GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
  return buffer;
}

static GstHarness *
harness (const gchar * settings, const gchar * format)
{
  g_autofree gchar *caps = g_strdup_printf ("video/x-raw,format=%s", format);
  g_autofree gchar *launch = g_strdup_printf ("clothcamera rig=%s %s", rig,
      settings);
  GstHarness *h = gst_harness_new_parse (launch);

  gst_harness_set_sink_caps_str (h, caps);
  gst_harness_set_src_caps (h, mesh_caps (4, 3));
  return h;
}

static gchar *
checksum (GstBuffer * buffer)
{
  GstMapInfo map;
  gchar *sum;

  gst_buffer_map (buffer, &map, GST_MAP_READ);
  sum = g_compute_checksum_for_data (G_CHECKSUM_SHA256, map.data, map.size);
  gst_buffer_unmap (buffer, &map);
  return sum;
}

/* Mean column of the cloth in a GRAY8 picture of 97 × 65, px. */
static gdouble
middle_of (GstBuffer * buffer)
{
  gdouble sum = 0, first = 0;
  GstMapInfo map;

  gst_buffer_map (buffer, &map, GST_MAP_READ);
  for (gint x = 0; x < 97; x++) {
    /* the background is darker */
    const gdouble light = MAX (map.data[32 * 100 + x] - 110, 0);

    sum += light;
    first += light * x;
  }
  gst_buffer_unmap (buffer, &map);
  return first / sum;
}

GST_START_TEST (test_formats)
{
  static const gchar *const formats[] = { "GRAY8", "BGRx", "RGBx", "xRGB",
    "xBGR", "RGB", "BGR"
  };

  for (guint f = 0; f < G_N_ELEMENTS (formats); f++) {
    GstHarness *h = harness ("camera=a pattern=" PATTERN, formats[f]);
    g_autoptr (GstCaps) got = NULL;
    GstVideoInfo info;
    GstVideoFrame frame;
    GstBuffer *out;

    out = gst_harness_push_and_pull (h, mesh_buffer (7, 4, 3, 0));
    fail_unless (out != NULL);
    got = gst_pad_get_current_caps (h->sinkpad);
    fail_unless (gst_video_info_from_caps (&info, got));
    fail_unless_equals_string (gst_video_format_to_string
        (GST_VIDEO_INFO_FORMAT (&info)), formats[f]);
    fail_unless (info.width == 97 && info.height == 65);
    fail_unless (info.fps_n == 25 && info.fps_d == 1);
    fail_unless (GST_BUFFER_PTS (out) == 280 * GST_MSECOND);
    fail_unless (GST_BUFFER_DURATION (out) == 40 * GST_MSECOND);
    fail_unless (GST_BUFFER_OFFSET (out) == 7);
    fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
    for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS (&frame) && c < 3; c++) {
      const guint8 *data = GST_VIDEO_FRAME_COMP_DATA (&frame, c);
      const gint stride = GST_VIDEO_FRAME_COMP_STRIDE (&frame, c);
      const gint step = GST_VIDEO_FRAME_COMP_PSTRIDE (&frame, c);

      /* the wall, the cloth's white edge */
      fail_unless (data[2 * stride + 2 * step] < 110);
      fail_unless (data[32 * stride + 36 * step] > 180);
    }
    gst_video_frame_unmap (&frame);
    gst_buffer_unref (out);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Pictures of luma and chroma are those of RGB by the matrix of their caps (Rec. BT.601
 * and 709), 16 … 235 and 16 … 240; chroma lies between four pixels (jpeg) or in even
 * columns (mpeg2). Strong noise is all colours. Odd sizes. */
#define assert_near(value, expected, tolerance) \
  g_assert_cmpfloat_with_epsilon (value, expected, tolerance)

GST_START_TEST (test_luma_and_chroma)
{
  static const struct
  {
    const gchar *format, *colorimetry, *site;
    gdouble kr, kb;
    guint before, at, after;    /* a chroma's weights of columns 2 i − 1 to 2 i + 1 */
  } cases[] = {
    {"I420", "bt601", "jpeg", 0.299, 0.114, 0, 2, 2},
    {"I420", "bt709", "mpeg2", 0.2126, 0.0722, 1, 2, 1},
    {"NV12", "bt601", "mpeg2", 0.299, 0.114, 1, 2, 1},
    {"NV12", "bt709", "jpeg", 0.2126, 0.0722, 0, 2, 2},
  };
  const gchar *settings = "camera=a pattern=" PATTERN " effects=noise,sigma=30";
  GstHarness *rgb = harness (settings, "RGB");
  g_autoptr (GstBuffer) truth = gst_harness_push_and_pull (rgb,
      mesh_buffer (0, 4, 3, 0));
  GstMapInfo map;

  fail_unless (gst_buffer_map (truth, &map, GST_MAP_READ));
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *caps = g_strdup_printf ("%s,colorimetry=%s,"
        "chroma-site=%s", cases[i].format, cases[i].colorimetry, cases[i].site);
    GstHarness *h = harness (settings, caps);
    g_autoptr (GstBuffer) out = gst_harness_push_and_pull (h,
        mesh_buffer (0, 4, 3, 0));
    g_autoptr (GstCaps) got = gst_pad_get_current_caps (h->sinkpad);
    const gdouble kr = cases[i].kr, kb = cases[i].kb;
    GstVideoInfo info;
    GstVideoFrame frame;

    fail_unless (gst_video_info_from_caps (&info, got));
    fail_unless_equals_string (gst_video_format_to_string
        (GST_VIDEO_INFO_FORMAT (&info)), cases[i].format);
    fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
    for (gint y = 0; y < 65; y++) {
      for (gint x = 0; x < 97; x++) {
        const guint8 *p = map.data + 292 * y + 3 * x;
        const gdouble luma = kr * p[0] + (1 - kr - kb) * p[1] + kb * p[2];
        const guint8 *data = GST_VIDEO_FRAME_COMP_DATA (&frame, 0);

        assert_near (data[y * GST_VIDEO_FRAME_COMP_STRIDE (&frame, 0) + x],
            16 + 219. / 255 * luma, 1.2);
      }
    }
    for (gint y = 0; y < 32; y++) {
      for (gint x = 1; x < 48; x++) {
        const guint weights[3] = { cases[i].before, cases[i].at,
          cases[i].after
        };
        gdouble mean[3] = { 0, 0, 0 }, luma;

        for (gint k = 0; k < 6; k++)
          for (gint c = 0; c < 3; c++)
            mean[c] += weights[k % 3] / 8. * map.data[292 * (2 * y + k / 3) +
                3 * (2 * x + k % 3 - 1) + c];
        luma = kr * mean[0] + (1 - kr - kb) * mean[1] + kb * mean[2];
        for (gint c = 1; c < 3; c++) {
          const guint8 *data = GST_VIDEO_FRAME_COMP_DATA (&frame, c);
          const gint stride = GST_VIDEO_FRAME_COMP_STRIDE (&frame, c);
          const gint step = GST_VIDEO_FRAME_COMP_PSTRIDE (&frame, c);
          const gdouble expected = c == 1 ? (mean[2] - luma) / (2 - 2 * kb) :
              (mean[0] - luma) / (2 - 2 * kr);

          assert_near (data[y * stride + x * step], 128 + 224. / 255 * expected,
              2.2);
        }
      }
    }
    gst_video_frame_unmap (&frame);
    gst_harness_teardown (h);
  }
  gst_buffer_unmap (truth, &map);
  gst_harness_teardown (rgb);
}

GST_END_TEST;

/* Pictures do not depend on threads; with noise they do on the seed. */
GST_START_TEST (test_same_bytes)
{
  static const gchar *const settings[] = {
    "threads=1 seed=3", "threads=3 seed=3", "threads=1 seed=4"
  };
  g_autofree gchar *sums[3] = { NULL, NULL, NULL };

  for (guint i = 0; i < 3; i++) {
    g_autofree gchar *all =
        g_strdup_printf ("camera=a effects=noise,sigma=2 %s",
        settings[i]);
    GstHarness *h = harness (all, "GRAY8");
    GstBuffer *out = gst_harness_push_and_pull (h, mesh_buffer (0, 4, 3, 0));

    sums[i] = checksum (out);
    gst_buffer_unref (out);
    gst_harness_teardown (h);
  }
  fail_unless_equals_string (sums[0], sums[1]);
  fail_unless (strcmp (sums[0], sums[2]) != 0);
  g_free (sums[1]);
  g_free (sums[2]);
  sums[1] = sums[2] = NULL;
}

GST_END_TEST;

/* 50 px/m: 0.1 m a mesh are 5 px. Pictures wait for the meshes around them, and come at
 * the end. */
GST_START_TEST (test_window)
{
  static const struct
  {
    const gchar *effects;
    gdouble lag;                /* meshes */
  } cases[] = {
    {"sync_offset,seconds=0.02", 0.5},
    {"sync_offset,seconds=-0.06", -1.5},
    {"motion_blur,exposure=0.04", -0.5}
  };

  for (guint c = 0; c < G_N_ELEMENTS (cases); c++) {
    g_autofree gchar *settings = g_strdup_printf ("camera=a effects=\"%s\"",
        cases[c].effects);
    GstHarness *h = harness (settings, "GRAY8");

    for (guint i = 0; i < 8; i++)
      fail_unless_equals_int (gst_harness_push (h, mesh_buffer (i, 4, 3,
                  0.02 * i)), GST_FLOW_OK);
    fail_unless (gst_harness_buffers_received (h) < 8);
    fail_unless (gst_harness_buffers_received (h) > 3);
    gst_harness_push_event (h, gst_event_new_eos ());
    fail_unless_equals_int (gst_harness_buffers_received (h), 8);
    for (guint i = 0; i < 8; i++) {
      GstBuffer *out = gst_harness_pull (h);

      fail_unless (GST_BUFFER_PTS (out) == i * 40 * GST_MSECOND);
      fail_unless (fabs (middle_of (out) - 48 - (i - cases[c].lag)) < 0.3,
          "%s: picture %u at %f", cases[c].effects, i, middle_of (out));
      gst_buffer_unref (out);
    }
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

GST_START_TEST (test_dropped)
{
  GstHarness *h =
      harness ("camera=a effects=frame_drop,rate=0.5 seed=1", "GRAY8");
  g_autofree gchar *last = NULL;
  guint same = 0;

  for (guint i = 0; i < 40; i++) {
    GstBuffer *out = gst_harness_push_and_pull (h, mesh_buffer (i, 4, 3,
            0.003 * i));
    gchar *sum = checksum (out);

    fail_unless (GST_BUFFER_PTS (out) == i * 40 * GST_MSECOND);
    same += last && strcmp (last, sum) == 0;
    g_free (last);
    last = sum;
    gst_buffer_unref (out);
  }
  fail_unless (same >= 10 && same <= 30, "%u of 40 are repeats", same);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A flush forgets what waits; new caps make a new mesh; states go up and down. */
GST_START_TEST (test_events)
{
  GstHarness *h =
      harness ("camera=a effects=rolling_shutter,seconds=0.01", "GRAY8");
  GstSegment segment;

  for (guint i = 0; i < 2; i++)
    gst_harness_push (h, mesh_buffer (i, 4, 3, 0));
  fail_unless_equals_int (gst_harness_buffers_received (h), 0);
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  fail_unless_equals_int (gst_harness_buffers_received (h), 0);
  /* earlier than before the flush: no fault */
  gst_harness_push (h, mesh_buffer (0, 4, 3, 0));
  gst_harness_push (h, mesh_buffer (1, 4, 3, 0));
  gst_harness_set_src_caps (h, mesh_caps (5, 6));
  fail_unless_equals_int (gst_harness_buffers_received (h), 2);
  gst_harness_push (h, mesh_buffer (0, 5, 6, 0));
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (h), 3);
  gst_harness_teardown (h);

  for (guint i = 0; i < 3; i++) {
    g_autofree gchar *launch = g_strdup_printf ("clothcamera rig=%s camera=a",
        rig);
    GstElement *element = gst_parse_launch (launch, NULL);

    fail_unless (gst_element_set_state (element, GST_STATE_PAUSED)
        != GST_STATE_CHANGE_FAILURE);
    gst_element_set_state (element, GST_STATE_NULL);
    gst_object_unref (element);
  }
}

GST_END_TEST;

/* With qos what comes too late is not drawn, and counted; without it each mesh is. */
GST_START_TEST (test_qos)
{
  for (guint on = 0; on < 2; on++) {
    g_autofree gchar *settings =
        g_strdup_printf ("camera=a pattern=" PATTERN "%s", on ? " qos=true" :
        "");
    GstHarness *h = harness (settings, "GRAY8");
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstElement) element = gst_harness_find_element (h,
        "clothcamera");
    const guint drawn[] = { 0, 6, 7 };
    guint n = 0;

    gst_element_set_bus (element, bus);
    gst_harness_push (h, mesh_buffer (0, 4, 3, 0));
    gst_harness_push_upstream_event (h,
        gst_event_new_qos (GST_QOS_TYPE_UNDERFLOW, 2, 100 * GST_MSECOND, 0));
    for (guint k = 1; k < 8; k++) {
      /* those between are about as late as it can be told */
      if (k < 3 || k > 5)
        fail_unless_equals_int (gst_harness_push (h, mesh_buffer (k, 4, 3, 0)),
            GST_FLOW_OK);
    }
    fail_unless_equals_int (gst_harness_buffers_received (h), on ? 3 : 5);
    for (; on && n < 3; n++) {
      g_autoptr (GstBuffer) out = gst_harness_pull (h);

      fail_unless_equals_uint64 (GST_BUFFER_PTS (out),
          drawn[n] * 40 * GST_MSECOND);
    }
    for (n = 0; TRUE; n++) {
      g_autoptr (GstMessage) told = gst_bus_pop_filtered (bus, GST_MESSAGE_QOS);

      if (!told)
        break;
    }
    fail_unless_equals_int (n, on ? 2 : 0);
    gst_element_set_bus (element, NULL);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Nobody takes the pictures: that is what upstream hears. */
GST_START_TEST (test_not_linked)
{
  const gchar *const cases[] = { "a", NULL };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    GstElement *element = gst_element_factory_make ("clothcamera", NULL);
    GstHarness *h;

    if (cases[i])
      g_object_set (element, "rig", rig, "camera", cases[i], NULL);
    h = gst_harness_new_with_element (element, "sink", NULL);
    gst_harness_set_src_caps (h, mesh_caps (4, 3));
    fail_unless_equals_int (gst_harness_push (h, mesh_buffer (0, 4, 3, 0)),
        GST_FLOW_NOT_LINKED);
    gst_harness_teardown (h);
    gst_object_unref (element);
  }
}

GST_END_TEST;

GST_START_TEST (test_latency)
{
  GstHarness *late = harness ("camera=late", "GRAY8");
  GstHarness *still = harness ("camera=a", "GRAY8");

  gst_harness_push (still, mesh_buffer (0, 4, 3, 0));
  gst_harness_push (late, mesh_buffer (0, 4, 3, 0));
  fail_unless (gst_harness_query_latency (still) == 0);
  fail_unless (gst_harness_query_latency (late) == 80 * GST_MSECOND);
  gst_harness_teardown (still);
  gst_harness_teardown (late);
}

GST_END_TEST;

/* A pipeline asks for the latency before caps have come: it is told when it changes. */
GST_START_TEST (test_latency_message)
{
  static const gchar *const cameras[] = { "camera=a", "camera=late" };

  for (guint i = 0; i < G_N_ELEMENTS (cameras); i++) {
    GstHarness *h = harness (cameras[i], "GRAY8");
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstMessage) message = NULL;

    /* start from nothing */
    gst_element_set_state (h->element, GST_STATE_READY);
    gst_element_set_bus (h->element, bus);
    gst_element_set_state (h->element, GST_STATE_PLAYING);
    gst_harness_push_event (h, gst_event_new_stream_start ("meshes"));
    gst_harness_set_src_caps (h, mesh_caps (5, 3));
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_LATENCY);
    fail_unless (i == 0 ? message == NULL : message != NULL);
    gst_element_set_bus (h->element, NULL);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* What says that nothing comes does not overtake the pictures that wait. */
GST_START_TEST (test_order)
{
  for (guint i = 0; i < 3; i++) {
    GstHarness *h =
        harness ("camera=a effects=rolling_shutter,seconds=0.01", "GRAY8");
    GstEvent *event;

    gst_harness_push (h, mesh_buffer (0, 4, 3, 0));
    gst_harness_push (h, mesh_buffer (1, 4, 3, 0));
    fail_unless_equals_int (gst_harness_buffers_received (h), 0);
    if (i == 0)
      event = gst_event_new_gap (80 * GST_MSECOND, 40 * GST_MSECOND);
    else if (i == 1)
      event = gst_event_new_segment_done (GST_FORMAT_TIME, 80 * GST_MSECOND);
    else
      event = gst_event_new_stream_start ("another");
    gst_harness_push_event (h, event);
    fail_unless_equals_int (gst_harness_buffers_received (h), 2);
    if (i == 0) {
      /* and on it goes */
      for (guint k = 3; k < 7; k++)
        gst_harness_push (h, mesh_buffer (k, 4, 3, 0));
      gst_harness_push_event (h, gst_event_new_eos ());
      fail_unless_equals_int (gst_harness_buffers_received (h), 6);
    }
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Who comes to stand downstream may want another format; what waits isn't lost. */
GST_START_TEST (test_reconfigure)
{
  GstHarness *h =
      harness ("camera=a effects=rolling_shutter,seconds=0.01", "GRAY8");
  g_autoptr (GstCaps) caps = NULL;
  GstVideoInfo info;
  guint n;

  for (guint i = 0; i < 4; i++)
    gst_harness_push (h, mesh_buffer (i, 4, 3, 0));
  n = gst_harness_buffers_received (h);
  fail_unless (n > 0 && n < 4);
  gst_harness_set_sink_caps_str (h, "video/x-raw,format=BGRx");
  gst_harness_push_upstream_event (h, gst_event_new_reconfigure ());
  fail_unless_equals_int (gst_harness_push (h, mesh_buffer (4, 4, 3, 0)),
      GST_FLOW_OK);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (h), 5);
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_video_info_from_caps (&info, caps));
  fail_unless_equals_int (GST_VIDEO_INFO_FORMAT (&info), GST_VIDEO_FORMAT_BGRx);
  for (guint i = 0; i < 5; i++) {
    g_autoptr (GstBuffer) out = gst_harness_pull (h);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (out), i * 40 * GST_MSECOND);
    fail_unless_equals_int (gst_buffer_get_size (out), i < n ? 100 * 65 :
        4 * 97 * 65);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* After a stop the camera may be another, also of another size. */
GST_START_TEST (test_other_camera)
{
  g_autofree gchar *launch = g_strdup_printf ("clothcamera rig=%s camera=a",
      rig);
  g_autoptr (GstElement) element = gst_parse_launch (launch, NULL);
  g_autoptr (GstPad) pad = gst_element_get_static_pad (element, "src");
  g_autoptr (GstCaps) small =
      gst_caps_from_string ("video/x-raw,format=GRAY8,width=64,height=48");
  g_autoptr (GstCaps) can = NULL;

  gst_element_set_state (element, GST_STATE_PAUSED);
  can = gst_pad_query_caps (pad, small);
  fail_unless (gst_caps_is_empty (can));
  gst_caps_unref (can);
  gst_element_set_state (element, GST_STATE_NULL);
  g_object_set (element, "camera", "late", NULL);
  can = gst_pad_query_caps (pad, small);
  fail_if (gst_caps_is_empty (can));
}

GST_END_TEST;

/* Without a rig: of any size, all of the cloth in the picture and about its middle; turned
 * while it plays. */
GST_START_TEST (test_free_view)
{
  GstHarness *h = gst_harness_new_parse ("clothcamera elevation=0");
  g_autoptr (GstElement) element = NULL;
  GstCaps *caps;
  GstBuffer *out;
  GstSegment segment;
  gdouble level, edge_on;

  gst_harness_set_sink_caps_str (h,
      "video/x-raw,format=GRAY8,height=65,width=[1,97]");
  gst_harness_set_src_caps (h, mesh_caps (4, 3));
  gst_harness_push (h, mesh_buffer (0, 4, 3, 0.5));
  out = gst_harness_pull (h);
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_caps_is_subset (caps, gst_static_caps_get (&(GstStaticCaps)
              GST_STATIC_CAPS ("video/x-raw,width=97,height=65"))));
  gst_caps_unref (caps);
  level = middle_of (out);
  fail_unless (fabs (level - 48) < 1, "%g", level);
  gst_buffer_unref (out);
  /* the view stays where the cloth was first seen */
  gst_harness_push (h, mesh_buffer (1, 4, 3, 0.6));
  out = gst_harness_pull (h);
  fail_unless (middle_of (out) > level + 4);
  gst_buffer_unref (out);
  /* from above a cloth that hangs is a line */
  element = gst_harness_find_element (h, "clothcamera");
  g_object_set (element, "elevation", 90.0, NULL);
  gst_harness_push (h, mesh_buffer (2, 4, 3, 0.5));
  out = gst_harness_pull (h);
  edge_on = middle_of (out);
  fail_unless (isnan (edge_on) || fabs (edge_on - 48) < 2, "%g", edge_on);
  gst_buffer_unref (out);
  /* a stream that doesn't count in time, as that of an appsrc left at its default */
  gst_segment_init (&segment, GST_FORMAT_BYTES);
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  fail_unless_equals_int (gst_harness_push (h, mesh_buffer (3, 4, 3, 0.5)),
      GST_FLOW_OK);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A damaged mesh has no picture; those around it have. */
GST_START_TEST (test_damaged)
{
  GstHarness *h = harness ("camera=a", "GRAY8");
  g_autoptr (GstElement) camera = gst_harness_find_element (h, "clothcamera");
  g_autoptr (GstBus) bus = gst_bus_new ();

  gst_element_set_bus (camera, bus);
  for (guint i = 0; i < 6; i++)
    fail_unless_equals_int (gst_harness_push (h, i % 3 == 0 ?
            mesh_buffer (i, 4, 3, 0) : i % 3 == 1 ? mesh_buffer (i, 3, 3, 0) :
            gst_buffer_new_memdup ("garbage", 7)), GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_buffers_received (h), 2);
  assert_dropped (camera, bus, 4, "9 vertices in a stream of 12");
  gst_harness_push_event (h, gst_event_new_eos ());
  assert_summed_up (bus, 4);
  gst_element_set_bus (camera, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A mesh each of whose 120,000 triangles covers the picture: no cloth, and hours of work for
 * large ones. The next mesh is drawn. */
GST_START_TEST (test_crowded)
{
  const guint columns = 60001, rows = 2, n = columns * rows;
  g_autofree gfloat *positions = g_new (gfloat, 3 * n);
  g_autofree guint8 *states = g_malloc (n);
  GstHarness *h = harness ("camera=a", "GRAY8");
  g_autoptr (GstElement) camera = gst_harness_find_element (h, "clothcamera");
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstClothMesh) mesh = NULL;

  for (guint i = 0; i < n; i++) {
    positions[3 * i] = i % columns % 2 ? 4 : -4;
    positions[3 * i + 1] = 5e-6f * (gfloat) (i % columns);
    positions[3 * i + 2] = i / columns ? -4 : 4;
    states[i] = GST_CLOTH_VERTEX_PREDICTED;
  }
  mesh = gst_cloth_mesh_new (0, n, positions, states, NULL);
  gst_element_set_bus (camera, bus);
  gst_harness_set_src_caps (h, mesh_caps (columns, rows));
  fail_unless_equals_int (gst_harness_push (h, gst_cloth_mesh_to_buffer (mesh)),
      GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_buffers_received (h), 0);
  fail_unless_equals_int (gst_harness_push (h, mesh_buffer (1, columns, rows,
              0)), GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_buffers_received (h), 1);
  assert_dropped (camera, bus, 1, "cover the picture too often");
  gst_element_set_bus (camera, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

static void
assert_refused (const gchar * launch, const gchar * says)
{
  g_autoptr (GError) error = NULL;
  GstElement *element = gst_parse_launch (launch, &error);
  GstHarness *h;
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autofree gchar *debug = NULL, *all = NULL;
  g_autoptr (GError) fault = NULL;

  g_assert_no_error (error);
  gst_element_set_bus (element, bus);
  if (gst_element_set_state (element, GST_STATE_PAUSED)
      != GST_STATE_CHANGE_FAILURE) {
    h = gst_harness_new_with_element (element, "sink", "src");
    gst_element_set_bus (element, bus);
    gst_harness_set_src_caps (h, mesh_caps (4, 3));
    gst_harness_push (h, mesh_buffer (0, 4, 3, 0));
    gst_harness_push (h, mesh_buffer (0, 4, 3, 0));
    gst_harness_teardown (h);
  }
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL, "%s: no error", launch);
  gst_message_parse_error (message, &fault, &debug);
  all = g_strdup_printf ("%s %s", fault->message, debug ? debug : "");
  fail_unless (strstr (all, says) != NULL, "%s: %s", launch, all);
  gst_element_set_state (element, GST_STATE_NULL);
  gst_element_set_bus (element, NULL);
  gst_object_unref (element);
}

/* The film's first picture. */
static gchar *
film_of (const gchar * settings)
{
  GstHarness *h = harness (settings, "RGB");
  g_autoptr (GstBuffer) out = NULL;
  gchar *sum;

  fail_unless_equals_int (gst_harness_push (h, mesh_buffer (0, 4, 3, 0)),
      GST_FLOW_OK);
  out = gst_harness_pull (h);
  sum = checksum (out);
  gst_harness_teardown (h);
  return sum;
}

/* A printed picture lies where its pattern says: as large as the cloth it is what texture= lays
 * over the whole of it, twice as wide it isn't. */
GST_START_TEST (test_picture_pattern)
{
  g_autofree gchar *scan = g_build_filename (folder, "scan.png", NULL);
  g_autofree gchar *json = g_build_filename (folder, "pattern.json", NULL);
  g_autofree gchar *line = g_strdup_printf ("videotestsrc num-buffers=1 ! "
      "video/x-raw,format=RGB,width=120,height=80 ! pngenc ! filesink "
      "location=%s", scan);
  g_autofree gchar *texture = g_strdup_printf ("camera=a texture=%s", scan);
  g_autofree gchar *pattern = g_strdup_printf ("camera=a pattern=%s", json);
  g_autofree gchar *expected = NULL;
  g_autoptr (GError) error = NULL;
  g_autoptr (GstElement) pipeline = gst_parse_launch (line, &error);
  g_autoptr (GstBus) bus = NULL;
  g_autoptr (GstMessage) message = NULL;

  g_assert_no_error (error);
  bus = gst_element_get_bus (pipeline);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_EOS);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  expected = film_of (texture);
  for (guint wide = 0; wide < 2; wide++) {
    g_autofree gchar *text = g_strdup_printf ("{\"pattern\":\"picture\","
        "\"reference\":\"scan.png\",\"cloth_m\":[%s,0.4],\"columns\":31,"
        "\"rows\":21}", wide ? "1.2" : "0.6");
    g_autofree gchar *sum = NULL;

    g_assert_true (g_file_set_contents (json, text, -1, NULL));
    sum = film_of (pattern);
    fail_unless (g_str_equal (sum, expected) == !wide);
  }
  g_remove (json);
  g_remove (scan);
}

GST_END_TEST;

GST_START_TEST (test_refused)
{
  static const struct
  {
    const gchar *settings, *says;
  } cases[] = {
    {"", "Set camera= to one of: a, late"},
    {"camera=c", "Set camera= to one of: a, late"},
    {"camera=a effects=snow,much=1", "there are: lens_distortion"},
    {"camera=a effects=noise,sigma=99", "use 0 to 50"},
    {"camera=a pattern=" PATTERN " texture=x.png", "Leave out pattern="},
    {"camera=a pattern=/nowhere/pattern.json", "/nowhere/pattern.json"},
    {"camera=a texture=/nowhere/a.png", "there is no such file"},
    {"camera=a texture=" PATTERN, "pattern.json"},
    {"camera=a texture=" TEST_DATA, "is a folder"},
    {"camera=a effects=motion_blur,exposure=0.01", "rising times"}
  };

  assert_refused ("clothcamera camera=a", "Set rig= to a rig.json");
  assert_refused ("clothcamera rig=/nowhere/rig.json", "/nowhere/rig.json");
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *launch = g_strdup_printf ("clothcamera rig=%s %s", rig,
        cases[i].settings);

    assert_refused (launch, cases[i].says);
  }
}

GST_END_TEST;

static Suite *
clothcamera_suite (void)
{
  Suite *s = suite_create ("clothcamera");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_unchecked_fixture (tc, make_rig, remove_rig);
  tcase_add_test (tc, test_formats);
  tcase_add_test (tc, test_picture_pattern);
  tcase_add_test (tc, test_luma_and_chroma);
  tcase_add_test (tc, test_same_bytes);
  tcase_add_test (tc, test_window);
  tcase_add_test (tc, test_dropped);
  tcase_add_test (tc, test_events);
  tcase_add_test (tc, test_qos);
  tcase_add_test (tc, test_not_linked);
  tcase_add_test (tc, test_latency);
  tcase_add_test (tc, test_latency_message);
  tcase_add_test (tc, test_order);
  tcase_add_test (tc, test_reconfigure);
  tcase_add_test (tc, test_other_camera);
  tcase_add_test (tc, test_free_view);
  tcase_add_test (tc, test_damaged);
  tcase_add_test (tc, test_crowded);
  tcase_add_test (tc, test_refused);
  return s;
}

GST_CHECK_MAIN (clothcamera);
