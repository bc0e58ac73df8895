/* dotlabel: labels against the mesh that the pictures were rendered from, all formats
 * alike, and what it refuses.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/dotringscene.h"

#include <glib/gstdio.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>

static Ring ring;
static GstSample *film;         /* the first picture of cam0 */

static void
setup (void)
{
  ring_open (&ring);
  film = ring_picture ("cam0");
}

static void
teardown (void)
{
  ring_close (&ring);
  gst_sample_unref (film);
}

static GstHarness *
open_label (const gchar * pattern)
{
  GstElement *element = gst_element_factory_make ("dotlabel", NULL);
  GstHarness *h;

  fail_unless (element != NULL);
  gst_object_ref_sink (element);
  g_object_set (element, "pattern", pattern, "camera", "cam0", NULL);
  h = gst_harness_new_with_element (element, "sink", "src");
  gst_object_unref (element);
  return h;
}

/* The film's picture, or its top-left @width × @height, converted and with @padding bytes
 * after each row. */
static GstBuffer *
picture (GstVideoFormat format, gint width, gint height, guint padding,
    GstCaps ** caps)
{
  GstVideoInfo from, cut, to;
  GstVideoFrame in, out;
  GstVideoConverter *converter;
  GstVideoAlignment align;
  GstBuffer *buffer;

  fail_unless (gst_video_info_from_caps (&from, gst_sample_get_caps (film)));
  gst_video_info_set_format (&to, format, (guint) width, (guint) height);
  to.colorimetry = from.colorimetry;
  to.chroma_site = from.chroma_site;
  to.fps_n = 25;
  to.fps_d = 1;
  *caps = gst_video_info_to_caps (&to);
  cut = from;
  converter = gst_video_converter_new (&cut, &to,
      gst_structure_new ("options", GST_VIDEO_CONVERTER_OPT_SRC_WIDTH,
          G_TYPE_INT, width, GST_VIDEO_CONVERTER_OPT_SRC_HEIGHT, G_TYPE_INT,
          height, GST_VIDEO_CONVERTER_OPT_DITHER_METHOD,
          GST_TYPE_VIDEO_DITHER_METHOD, GST_VIDEO_DITHER_NONE, NULL));
  fail_unless (converter != NULL);
  gst_video_alignment_reset (&align);
  align.padding_right = padding;
  fail_unless (gst_video_info_align (&to, &align));
  buffer = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (&to), NULL);
  gst_buffer_memset (buffer, 0, 0xaa, -1);
  gst_buffer_add_video_meta_full (buffer, 0, format, (guint) width,
      (guint) height, GST_VIDEO_INFO_N_PLANES (&to), to.offset, to.stride);
  fail_unless (gst_video_frame_map (&in, &from, gst_sample_get_buffer (film),
          GST_MAP_READ));
  fail_unless (gst_video_frame_map (&out, &to, buffer, GST_MAP_WRITE));
  gst_video_converter_frame (converter, &in, &out);
  gst_video_frame_unmap (&in);
  gst_video_frame_unmap (&out);
  gst_video_converter_free (converter);
  GST_BUFFER_PTS (buffer) = 0;
  GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
  return buffer;
}

static GstBuffer *
label (GstHarness * h, GstVideoFormat format, gint width, gint height,
    guint padding)
{
  GstCaps *caps;
  GstBuffer *buffer = picture (format, width, height, padding, &caps);
  GstBuffer *out;

  gst_harness_set_src_caps (h, caps);
  out = gst_harness_push_and_pull (h, buffer);
  fail_unless (out != NULL);
  return out;
}

/* How many dots of a picture have a label, and how many of those the right one. */
static void
count (GstClothDots * dots, guint frame, guint * n_labelled, guint * n_right)
{
  guint n;
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n);

  *n_labelled = *n_right = 0;
  for (guint i = 0; i < n; i++, dot++) {
    if (dot->column >= 0) {
      (*n_labelled)++;
      *n_right += ring_distance (&ring, "cam0", frame, dot->column, dot->row,
          dot->x, dot->y) < 3;
    }
  }
}

GST_START_TEST (test_labels)
{
  GstHarness *h = open_label (RING "pattern.json");
  g_autoptr (GstBuffer) out = label (h, GST_VIDEO_FORMAT_I420, 1004, 1004, 0);
  GstClothDots *dots = gst_buffer_get_cloth_dots (out);
  guint n_labelled, n_right;

  fail_unless (dots != NULL);
  fail_unless_equals_string (gst_cloth_dots_get_camera (dots), "cam0");
  fail_unless_equals_int (gst_cloth_dots_get_columns (dots), 31);
  fail_unless_equals_int (gst_cloth_dots_get_rows (dots), 33);
  fail_unless_equals_int (gst_cloth_dots_get_n_colours (dots), 5);
  count (dots, 0, &n_labelled, &n_right);
  g_test_message ("%u dots, %u labelled, %u of them right",
      gst_cloth_dots_get_n_dots (dots), n_labelled, n_right);
  fail_unless (n_labelled > 850, "%u", n_labelled);
  fail_unless (1000 * n_right >= 995 * n_labelled, "%u of %u", n_right,
      n_labelled);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* clothcamera films the same cloth, its pattern drawn by us: places are those of the mesh.
 * Its printed side faces cam4. */
GST_START_TEST (test_synthetic_film)
{
  g_autofree gchar *line = g_strdup_printf ("clothcamera rig=" RING
      "rig.json camera=cam4 pattern=" RING "pattern.json ! "
      "video/x-raw,format=I420 ! dotlabel camera=cam4 pattern=" RING
      "pattern.json");
  GstHarness *h = gst_harness_new_parse (line);
  g_autoptr (GstClothTopology) grid = gst_cloth_topology_new_grid (MESH_COLUMNS,
      MESH_ROWS, 0.63f, 0.67f, NULL);
  g_autofree guint8 *states = g_malloc (MESH_COLUMNS * MESH_ROWS);
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GstBuffer) out = NULL;
  GstBuffer *buffer;
  const GstClothDot *dot;
  guint n, n_labelled = 0, n_right = 0;
  gdouble sum = 0;

  memset (states, GST_CLOTH_VERTEX_MEASURED, MESH_COLUMNS * MESH_ROWS);
  mesh = gst_cloth_mesh_new (0, MESH_COLUMNS * MESH_ROWS, ring.mesh, states,
      NULL);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = 0;
  GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
  gst_harness_set_src_caps (h, gst_cloth_topology_to_caps (grid, 25, 1));
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  out = gst_harness_pull (h);
  dot = gst_cloth_dots_get_dots (gst_buffer_get_cloth_dots (out), &n);
  for (guint i = 0; i < n; i++) {
    gdouble off;

    if (dot[i].column < 0)
      continue;
    n_labelled++;
    /* this print lies where it should */
    off = ring_distance (&ring, "cam4", 0, dot[i].column, dot[i].row, dot[i].x,
        dot[i].y);
    n_right += off < 3;
    sum += off < 3 ? off * off : 0;
  }
  g_test_message ("%u dots, %u labelled, %u right, %.3f px RMS each way", n,
      n_labelled, n_right, sqrt (sum / (2 * n_right)));
  fail_unless (n_labelled > 700 && 1000 * n_right >= 995 * n_labelled,
      "%u of %u", n_right, n_labelled);
  /* with what the bend does to centres of gravity */
  fail_unless (sqrt (sum / (2 * n_right)) < 0.3);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* The paper's way, step by step: fewer labels, and most of them right. */
GST_START_TEST (test_paper)
{
  GstHarness *h = open_label (RING "pattern.json");
  guint n_labelled, n_right;

  gst_util_set_object_arg (G_OBJECT (h->element), "colours", "hue");
  gst_util_set_object_arg (G_OBJECT (h->element), "labels", "windows");
  {
    g_autoptr (GstBuffer) out = label (h, GST_VIDEO_FORMAT_I420, 1004, 1004, 0);
    GstClothDots *dots = gst_buffer_get_cloth_dots (out);
    const GstClothDot *dot = gst_cloth_dots_get_dots (dots, NULL);

    count (dots, 0, &n_labelled, &n_right);
    g_test_message ("%u labelled, %u right", n_labelled, n_right);
    fail_unless (n_labelled > 100, "%u", n_labelled);
    fail_unless (10 * n_right >= 9 * n_labelled, "%u of %u", n_right,
        n_labelled);
    for (guint i = 0; i < gst_cloth_dots_get_n_dots (dots); i++)
      for (guint c = 0; c < 5; c++)
        fail_unless (dot[i].log_likelihood[c] >= -100
            && dot[i].log_likelihood[c] <= 0);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Planes and pairs, strides of their own: the same places and labels. Other samplings of
 * chroma change colours a little, not labels. */
GST_START_TEST (test_formats)
{
  static const GstVideoFormat formats[] = { GST_VIDEO_FORMAT_YV12,
    GST_VIDEO_FORMAT_NV12, GST_VIDEO_FORMAT_NV21, GST_VIDEO_FORMAT_Y42B,
    GST_VIDEO_FORMAT_NV16, GST_VIDEO_FORMAT_Y444, GST_VIDEO_FORMAT_NV24,
    GST_VIDEO_FORMAT_A420, GST_VIDEO_FORMAT_YUY2, GST_VIDEO_FORMAT_UYVY,
    GST_VIDEO_FORMAT_YVYU
  };
  const gint width = 701, height = 603;
  GstHarness *h = open_label (RING "pattern.json");
  g_autoptr (GstBuffer) first =
      label (h, GST_VIDEO_FORMAT_I420, width, height, 0);
  guint n, n_labelled, n_right;
  const GstClothDot *dots =
      gst_cloth_dots_get_dots (gst_buffer_get_cloth_dots (first), &n);

  count (gst_buffer_get_cloth_dots (first), 0, &n_labelled, &n_right);
  fail_unless (n_labelled > 250 && 1000 * n_right >= 995 * n_labelled,
      "%u of %u", n_right, n_labelled);
  for (guint i = 0; i < G_N_ELEMENTS (formats); i++) {
    g_autoptr (GstBuffer) out = label (h, formats[i], width, height, 40);
    guint n_other, n_same = 0;
    const GstClothDot *other =
        gst_cloth_dots_get_dots (gst_buffer_get_cloth_dots (out), &n_other);

    fail_unless_equals_int (n_other, n);
    for (guint k = 0; k < n; k++) {
      fail_unless (other[k].x == dots[k].x && other[k].y == dots[k].y);
      n_same += other[k].column == dots[k].column
          && other[k].row == dots[k].row;
    }
    fail_unless (100 * n_same >= 99 * n, "%s: %u of %u",
        gst_video_format_to_string (formats[i]), n_same, n);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Sizes and films one after the other, a flush between: what comes after it is as at the
 * start, but that the colours are known better. */
GST_START_TEST (test_renegotiation_and_flush)
{
  GstHarness *h = open_label (RING "pattern.json");
  g_autoptr (GstBuffer) whole = label (h, GST_VIDEO_FORMAT_I420, 1004, 1004, 0);
  g_autoptr (GstBuffer) part = label (h, GST_VIDEO_FORMAT_NV12, 503, 401, 3);
  g_autoptr (GstBuffer) tiny = label (h, GST_VIDEO_FORMAT_I420, 1, 1, 0);
  g_autoptr (GstBuffer) again = NULL;
  guint n, m, n_same = 0;
  const GstClothDot *a, *b;

  fail_unless (gst_cloth_dots_get_n_dots (gst_buffer_get_cloth_dots (part)) >
      50);
  fail_unless_equals_int (gst_cloth_dots_get_n_dots (gst_buffer_get_cloth_dots
          (tiny)), 0);
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
  {
    GstSegment segment;

    gst_segment_init (&segment, GST_FORMAT_TIME);
    fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
  }
  again = label (h, GST_VIDEO_FORMAT_I420, 1004, 1004, 0);
  a = gst_cloth_dots_get_dots (gst_buffer_get_cloth_dots (whole), &n);
  b = gst_cloth_dots_get_dots (gst_buffer_get_cloth_dots (again), &m);
  fail_unless_equals_int (n, m);
  for (guint i = 0; i < n; i++) {
    fail_unless (a[i].x == b[i].x && a[i].y == b[i].y);
    n_same += a[i].column == b[i].column && a[i].row == b[i].row;
  }
  fail_unless (100 * n_same >= 99 * n, "%u of %u", n_same, n);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_grey)
{
  GstHarness *h = open_label (RING "pattern.json");
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;
  GstCaps *caps;
  GstBuffer *buffer = picture (GST_VIDEO_FORMAT_GRAY8, 321, 241, 0, &caps);

  gst_element_set_bus (h->element, bus);
  gst_harness_set_src_caps (h, caps);
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_ERROR);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, &debug);
  fail_unless (strstr (error->message, "grey") && strstr (debug, "colour"));
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Plays cam0's picture n times; returns the warning, NULL when there was none, and the
 * number of "found" and "lost" messages. */
static gchar *
play (const gchar * pattern, guint n, guint * n_found, guint * n_lost)
{
  GstHarness *h = open_label (pattern);
  g_autoptr (GstBus) bus = gst_bus_new ();
  GstMessage *message;
  gchar *warning = NULL;
  GstCaps *caps;
  g_autoptr (GstBuffer) buffer =
      picture (GST_VIDEO_FORMAT_I420, 1004, 1004, 0, &caps);

  gst_element_set_bus (h->element, bus);
  gst_harness_set_src_caps (h, caps);
  for (guint i = 0; i < n; i++) {
    GstBuffer *copy = gst_buffer_copy (buffer);

    GST_BUFFER_PTS (copy) = i * 40 * GST_MSECOND;
    fail_unless_equals_int (gst_harness_push (h, copy), GST_FLOW_OK);
    gst_buffer_unref (gst_harness_pull (h));
  }
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  *n_found = *n_lost = 0;
  while ((message = gst_bus_pop_filtered (bus, GST_MESSAGE_ELEMENT
              | GST_MESSAGE_WARNING))) {
    if (GST_MESSAGE_TYPE (message) == GST_MESSAGE_WARNING) {
      g_autoptr (GError) error = NULL;
      g_autofree gchar *debug = NULL;

      fail_unless (warning == NULL);
      gst_message_parse_warning (message, &error, &debug);
      warning = g_strconcat (error->message, debug, NULL);
    } else {
      *n_found += gst_message_has_name (message, "dotlabel/found");
      *n_lost += gst_message_has_name (message, "dotlabel/lost");
    }
    gst_message_unref (message);
  }
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
  return warning;
}

/* Another print, and the film's own with two colours swapped: labels there are next to
 * none, and the user is told once. */
GST_START_TEST (test_wrong_pattern)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = g_dir_make_tmp ("dotlabel-XXXXXX", &error);
  g_autofree gchar *path = g_build_filename (folder, "pattern.json", NULL);
  ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;
  g_autoptr (ClothMArray) array = NULL;
  g_autofree gchar *none = NULL, *warning = NULL, *swapped = NULL;
  g_autofree gchar *at_end = NULL;
  guint n_found, n_lost;

  none = play (RING "pattern.json", 30, &n_found, &n_lost);
  fail_unless (none == NULL, "%s", none);
  fail_unless_equals_int (n_found, 1);
  fail_unless_equals_int (n_lost, 0);

  g_assert_no_error (error);
  code.seed = 77;
  code.two_sided = TRUE;
  array = cloth_m_array_new (31, 33, 5, 0.02, 0.013, 0.015, &code, &error);
  g_assert_no_error (error);
  fail_unless (cloth_m_array_save (array, path, &error));
  warning = play (path, 30, &n_found, &n_lost);
  fail_unless (warning != NULL);
  fail_unless (strstr (warning, "fit nowhere into the pattern"));
  fail_unless_equals_int (n_found, 0);

  at_end = play (path, 3, &n_found, &n_lost);
  fail_unless (at_end != NULL);
  fail_unless (strstr (at_end, "fit nowhere into the pattern"));

  /* cyan and magenta */
  for (gint i = 0; i < 31 * 33; i++)
    array->matrix[i] = ring.array->matrix[i] < 2 ? 1 - ring.array->matrix[i] :
        ring.array->matrix[i];
  fail_unless (cloth_m_array_save (array, path, &error));
  swapped = play (path, 30, &n_found, &n_lost);
  fail_unless (swapped != NULL);
  fail_unless (strstr (swapped, "swapped") != NULL, "%s", swapped);
  g_test_message ("%s", swapped);
  g_free (swapped);

  /* Green and cyan leave no label at all; they are named all the same. */
  for (gint i = 0; i < 31 * 33; i++)
    array->matrix[i] = ring.array->matrix[i] == 0 ? 4 :
        ring.array->matrix[i] == 4 ? 0 : ring.array->matrix[i];
  fail_unless (cloth_m_array_save (array, path, &error));
  swapped = play (path, 3, &n_found, &n_lost);
  fail_unless (swapped != NULL);
  fail_unless (strstr (swapped, "should be cyan look green") != NULL, "%s",
      swapped);
  fail_unless_equals_int (n_found, 0);
  g_remove (path);
  g_rmdir (folder);
}

GST_END_TEST;

static void
refuse_to_start (const gchar * pattern, const gchar * chart, const gchar * text)
{
  GstElement *element = gst_element_factory_make ("dotlabel", NULL);
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;

  gst_object_ref_sink (element);
  gst_element_set_bus (element, bus);
  g_object_set (element, "pattern", pattern, "chart", chart, NULL);
  fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, NULL);
  fail_unless (strstr (error->message, text) != NULL, "%s", error->message);
  gst_element_set_state (element, GST_STATE_NULL);
  gst_element_set_bus (element, NULL);
  gst_object_unref (element);
}

/* A picture in a light that lacks green and blue, as of a lamp with a filament. */
static GstBuffer *
in_other_light (GstSample * sample, GstCaps ** caps)
{
  g_autoptr (GstCaps) rgb = gst_caps_from_string ("video/x-raw,format=RGB");
  g_autoptr (GstSample) picture =
      gst_video_convert_sample (sample, rgb, 10 * GST_SECOND, NULL);
  GstBuffer *buffer;
  GstVideoInfo info;
  GstVideoFrame frame;

  fail_unless (picture != NULL);
  fail_unless (gst_video_info_from_caps (&info, gst_sample_get_caps (picture)));
  *caps = gst_caps_ref (gst_sample_get_caps (picture));
  buffer = gst_buffer_copy_deep (gst_sample_get_buffer (picture));
  fail_unless (gst_video_frame_map (&frame, &info, buffer, GST_MAP_READWRITE));
  for (gint y = 0; y < info.height; y++) {
    guint8 *row = GST_VIDEO_FRAME_PLANE_DATA (&frame, 0);

    row += y * GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0);
    for (gint x = 0; x < info.width; x++) {
      row[3 * x + 1] = (guint8) (0.6 * row[3 * x + 1]);
      row[3 * x + 2] = (guint8) (0.4 * row[3 * x + 2]);
    }
  }
  gst_video_frame_unmap (&frame);
  return buffer;
}

static void
write_png (GstBuffer * picture, GstCaps * caps, const gchar * path)
{
  g_autoptr (GstSample) sample = gst_sample_new (picture, caps, NULL, NULL);
  g_autoptr (GstCaps) png = gst_caps_from_string ("image/png");
  g_autoptr (GstSample) written =
      gst_video_convert_sample (sample, png, 10 * GST_SECOND, NULL);
  GstMapInfo map;

  fail_unless (written != NULL);
  fail_unless (gst_buffer_map (gst_sample_get_buffer (written), &map,
          GST_MAP_READ));
  fail_unless (g_file_set_contents (path, (const gchar *) map.data,
          (gssize) map.size, NULL));
  gst_buffer_unmap (gst_sample_get_buffer (written), &map);
}

/* Labels of cam0's picture in another light, the colours as on @chart and not learnt. */
static void
label_in_other_light (const gchar * chart, guint * n_labelled, guint * n_right)
{
  GstHarness *h = open_label (RING "pattern.json");
  g_autoptr (GstCaps) i420 = gst_caps_from_string ("video/x-raw,format=I420");
  GstCaps *rgb;
  g_autoptr (GstBuffer) light = in_other_light (film, &rgb);
  g_autoptr (GstSample) sample = gst_sample_new (light, rgb, NULL, NULL);
  g_autoptr (GstSample) picture =
      gst_video_convert_sample (sample, i420, 10 * GST_SECOND, NULL);
  g_autoptr (GstBuffer) out = NULL;

  fail_unless (picture != NULL);
  /* properties of files hold from the start */
  gst_element_set_state (h->element, GST_STATE_NULL);
  g_object_set (h->element, "chart", chart, "learn", FALSE, NULL);
  gst_element_set_state (h->element, GST_STATE_PLAYING);
  gst_harness_set_src_caps (h, gst_caps_copy (gst_sample_get_caps (picture)));
  out = gst_harness_push_and_pull (h,
      gst_buffer_copy (gst_sample_get_buffer (picture)));
  fail_unless (out != NULL);
  count (gst_buffer_get_cloth_dots (out), 0, n_labelled, n_right);
  gst_caps_unref (rgb);
  gst_harness_teardown (h);
}

/* The chart is a picture from elsewhere in the same light. */
GST_START_TEST (test_chart)
{
  g_autofree gchar *folder = g_dir_make_tmp ("dotlabel-XXXXXX", NULL);
  g_autofree gchar *path = g_build_filename (folder, "chart.png", NULL);
  g_autoptr (GstSample) other = ring_picture ("cam4");
  GstCaps *caps;
  g_autoptr (GstBuffer) chart = in_other_light (other, &caps);
  guint n_without, n_labelled, n_right;

  write_png (chart, caps, path);
  label_in_other_light (NULL, &n_without, &n_right);
  label_in_other_light (path, &n_labelled, &n_right);
  g_test_message ("%u labelled by the colours of the print, %u by those of the "
      "chart, %u of them right", n_without, n_labelled, n_right);
  fail_unless (n_labelled > 850, "%u", n_labelled);
  fail_unless (n_labelled > 2 * n_without, "%u", n_without);
  fail_unless (1000 * n_right >= 995 * n_labelled, "%u of %u", n_right,
      n_labelled);
  gst_caps_unref (caps);
  g_remove (path);
  g_rmdir (folder);
}

GST_END_TEST;

/* Charts that can be read and teach nothing: another print, and no colours. */
GST_START_TEST (test_useless_chart)
{
  g_autofree gchar *folder = g_dir_make_tmp ("dotlabel-XXXXXX", NULL);
  g_autofree gchar *grey = g_build_filename (folder, "grey.png", NULL);
  const gchar *charts[] = { TEST_DATA "/checker_pair/cam0.mp4", grey };
  GstCaps *caps;
  g_autoptr (GstBuffer) picture_of_greys =
      picture (GST_VIDEO_FORMAT_GRAY8, 1004, 1004, 0, &caps);

  write_png (picture_of_greys, caps, grey);
  gst_caps_unref (caps);
  for (guint i = 0; i < G_N_ELEMENTS (charts); i++) {
    GstHarness *h = open_label (RING "pattern.json");
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstMessage) message = NULL;
    g_autoptr (GError) error = NULL;
    g_autofree gchar *debug = NULL;
    GstBuffer *buffer = picture (GST_VIDEO_FORMAT_I420, 321, 241, 0, &caps);

    gst_element_set_state (h->element, GST_STATE_NULL);
    g_object_set (h->element, "chart", charts[i], NULL);
    gst_element_set_bus (h->element, bus);
    gst_element_set_state (h->element, GST_STATE_PLAYING);
    gst_harness_set_src_caps (h, caps);
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_ERROR);
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
    fail_unless (message != NULL);
    gst_message_parse_error (message, &error, &debug);
    fail_unless (strstr (error->message, "chart teaches no colours") != NULL
        && strstr (debug, "very print") != NULL, "%s", error->message);
    gst_element_set_bus (h->element, NULL);
    gst_harness_teardown (h);
  }
  g_remove (grey);
  g_rmdir (folder);
}

GST_END_TEST;

GST_START_TEST (test_no_chart)
{
  refuse_to_start (RING "pattern.json", "/nonexistent/chart.png",
      "Can't read the chart: /nonexistent/chart.png: there is no such file");
  refuse_to_start (RING "pattern.json", RING "rig.json",
      "Can't read the chart");
  refuse_to_start (RING "pattern.json", TEST_DATA, "is a folder");
}

GST_END_TEST;

/* A GStreamer without the plugin that decodes. */
GST_START_TEST (test_no_decoder)
{
  GstRegistry *registry = gst_registry_get ();
  GstPluginFeature *decoder = gst_registry_lookup_feature (registry,
      "decodebin");

  if (decoder)
    gst_registry_remove_feature (registry, decoder);
  refuse_to_start (RING "pattern.json", RING "rig.json", "decodebin");
  if (decoder)
    gst_registry_add_feature (registry, decoder);
}

GST_END_TEST;

GST_START_TEST (test_no_pattern)
{
  refuse_to_start (NULL, NULL, "pattern is not set");
  refuse_to_start ("/nonexistent/pattern.json", NULL, "pattern.json");
  refuse_to_start (TEST_DATA "/checker_pair/pattern.json", NULL, "m-array");
  refuse_to_start (RING "rig.json", NULL, "pattern");
  refuse_to_start (RING "vertices.npy", NULL, "pattern");
}

GST_END_TEST;

static Suite *
dotlabel_suite (void)
{
  Suite *s = suite_create ("dotlabel");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_checked_fixture (tc, setup, teardown);
  tcase_add_test (tc, test_labels);
  tcase_add_test (tc, test_synthetic_film);
  tcase_add_test (tc, test_paper);
  tcase_add_test (tc, test_formats);
  tcase_add_test (tc, test_renegotiation_and_flush);
  tcase_add_test (tc, test_grey);
  tcase_add_test (tc, test_wrong_pattern);
  tcase_add_test (tc, test_chart);
  tcase_add_test (tc, test_useless_chart);
  tcase_add_test (tc, test_no_chart);
  tcase_add_test (tc, test_no_decoder);
  tcase_add_test (tc, test_no_pattern);
  return s;
}

GST_CHECK_MAIN (dotlabel);
