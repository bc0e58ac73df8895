/* clothdisparity: points against a plane's formula and a film's truth; layouts, times, ends,
 * files; and what can't be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>

#include "gst/rig/rigfile.h"
#include "tests/common/stereo.h"
#include "tests/common/stereoscene.h"
#include "tests/elements/padded.h"

#define PERIOD (40 * GST_MSECOND)
#define AREA (SCENE_WIDTH * SCENE_HEIGHT)
#define ALL 3

typedef struct
{
  gchar *folder, *rig_path;
  ClothRig *rig;
  GstElement *element;
  GstBus *bus;
  GstHarness *src, *in[4];
  GstVideoInfo info;
  guint n_pads;
  gboolean plain;               /* downstream knows no strides */
} Bench;

/* @properties: as on a gst-launch line */
static void
bench_open (Bench * b, ClothRig * rig, const gchar * properties)
{
  g_autofree gchar *launch = NULL;
  g_autoptr (GError) error = NULL;

  memset (b, 0, sizeof (*b));
  b->folder = g_dir_make_tmp ("clothdisparity-XXXXXX", NULL);
  b->rig_path = g_build_filename (b->folder, "rig.json", NULL);
  b->rig = rig;
  fail_unless (cloth_rig_save (rig, b->rig_path, &error));
  launch = g_strdup_printf ("clothdisparity rig=%s near=0.8 far=1.6 %s",
      b->rig_path, properties);
  b->element = gst_parse_launch (launch, &error);
  g_assert_no_error (error);
  gst_object_ref_sink (b->element);
  b->bus = gst_bus_new ();
  gst_element_set_bus (b->element, b->bus);
}

static void
bench_link (Bench * b, guint n_pads, const gchar * format, gint width,
    gint height)
{
  gst_video_info_set_format (&b->info, gst_video_format_from_string (format),
      (guint) width, (guint) height);
  b->info.fps_n = 25;
  b->info.fps_d = 1;
  b->n_pads = n_pads;
  b->src = gst_harness_new_with_element (b->element, NULL, "src");
  if (!b->plain)
    gst_harness_add_propose_allocation_meta (b->src, GST_VIDEO_META_API_TYPE,
        NULL);
  for (guint i = 0; i < n_pads; i++) {
    g_autofree gchar *name = g_strdup_printf ("sink_%u", i);

    b->in[i] = gst_harness_new_with_element (b->element, name, NULL);
    gst_harness_set_src_caps (b->in[i], gst_video_info_to_caps (&b->info));
  }
}

static void
bench_init (Bench * b, guint n_pads, const gchar * properties)
{
  ClothRig *rig = scene_rig ();

  /* as many cameras as pads: pads go by their order */
  while (rig->n_cameras > MAX (n_pads, 2))
    cloth_camera_clear (&rig->cameras[--rig->n_cameras]);
  bench_open (b, rig, properties);
  bench_link (b, n_pads, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
}

static void
bench_clear (Bench * b)
{
  GDir *dir;
  const gchar *name;

  gst_element_set_state (b->element, GST_STATE_NULL);
  for (guint i = 0; i < b->n_pads; i++)
    gst_harness_teardown (b->in[i]);
  if (b->src)
    gst_harness_teardown (b->src);
  gst_element_set_bus (b->element, NULL);
  gst_object_unref (b->bus);
  gst_object_unref (b->element);
  cloth_rig_free (b->rig);
  dir = g_dir_open (b->folder, 0, NULL);
  while ((name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (b->folder, name, NULL);

    g_remove (path);
  }
  g_dir_close (dir);
  g_rmdir (b->folder);
  g_free (b->rig_path);
  g_free (b->folder);
}

/* What a camera films of the plane. */
static GstBuffer *
picture (const Bench * b, guint camera, guint frame, gint padding)
{
  Luma place;
  GstBuffer *buffer = padded_picture (&b->info, padding, 77, &place);
  GstMapInfo map;

  gst_buffer_map (buffer, &map, GST_MAP_WRITE);
  scene_film (&b->rig->cameras[camera], 0.01 * frame, map.data + place.offset,
      place.stride);
  gst_buffer_unmap (buffer, &map);
  GST_BUFFER_PTS (buffer) = frame * PERIOD;
  GST_BUFFER_DURATION (buffer) = PERIOD;
  return buffer;
}

static void
push_all (Bench * b, guint frame, gint padding)
{
  for (guint i = 0; i < b->n_pads; i++)
    fail_unless_equals_int (gst_harness_push (b->in[i], picture (b, i, frame,
                padding)), GST_FLOW_OK);
}

/* A silhouette of a box. */
static GstClothSilhouette *
box (guint width, guint height, guint top, guint bottom)
{
  g_autofree GstClothRun *runs = g_new0 (GstClothRun, height);
  guint n = 0;

  for (guint y = top; y < bottom; y++)
    runs[n++] = (GstClothRun) {
    (guint16) y, 60, 180};
  return gst_cloth_silhouette_new ("", 0, width, height, runs, n);
}

static void
expect (Bench * b, GstMessageType type, const gchar * text)
{
  g_autoptr (GstMessage) message =
      gst_bus_timed_pop_filtered (b->bus, 20 * GST_SECOND, type);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;

  fail_unless (message != NULL, "no message with \"%s\"", text);
  if (type == GST_MESSAGE_ERROR)
    gst_message_parse_error (message, &error, &debug);
  else if (type == GST_MESSAGE_WARNING)
    gst_message_parse_warning (message, &error, &debug);
  else
    gst_message_parse_info (message, &error, &debug);
  fail_unless (strstr (error->message, text) || strstr (debug, text),
      "\"%s\" is not in: %s (%s)", text, error->message, debug);
}

/* Nothing is amiss, and nothing was said before. */
static void
expect_silence (Bench * b)
{
  g_autoptr (GstMessage) message = gst_bus_pop_filtered (b->bus,
      GST_MESSAGE_ERROR | GST_MESSAGE_WARNING | GST_MESSAGE_INFO);

  if (message) {
    g_autofree gchar *text =
        gst_structure_to_string (gst_message_get_structure (message));

    fail ("unexpected: %s", text);
  }
}

/* Points in the world on the plane. Returns: how many there are. */
static guint
check_points (GstClothDisparity * disparity)
{
  const GstClothStereo *stereo = gst_cloth_disparity_get_stereo (disparity);
  const gdouble *R = gst_cloth_stereo_get_rotation (stereo);
  const gdouble *t = gst_cloth_stereo_get_translation (stereo);
  g_autofree gfloat *points = g_new (gfloat, 3 * AREA);
  gdouble sum = 0;
  guint n = 0;

  fail_unless_equals_int (gst_cloth_disparity_get_width (disparity),
      SCENE_WIDTH);
  fail_unless_equals_int (gst_cloth_disparity_get_height (disparity),
      SCENE_HEIGHT);
  gst_cloth_disparity_get_points (disparity, points);
  for (gsize i = 0; i < AREA; i++) {
    gdouble p[3], X[3], off;

    if (isnan (points[3 * i]))
      continue;
    for (gint k = 0; k < 3; k++)
      p[k] = (gdouble) points[3 * i + (gsize) k] - t[k];
    cloth_mat3_vec_t (R, p, X);
    off = X[2] - scene_plane[0] * X[0] - scene_plane[1] * X[1] - scene_plane[2];
    sum += off * off;
    n++;
  }
  fail_unless (n > 0);
  fail_unless (sqrt (sum / n) < 1.5e-3, "RMS %g m", sqrt (sum / n));
  return n;
}

GST_START_TEST (test_plane)
{
  static const gchar *const formats[] = { "GRAY8", "I420", "NV12" };

  for (guint i = 0; i < G_N_ELEMENTS (formats); i++)
    for (guint n = 2; n <= 3; n++) {
      Bench b;
      ClothRig *rig = scene_rig ();
      GstClothDisparity *disparity;
      GstBuffer *head, *out;

      if (n == 2)
        cloth_camera_clear (&rig->cameras[--rig->n_cameras]);
      bench_open (&b, rig, "");
      bench_link (&b, n, formats[i], SCENE_WIDTH, SCENE_HEIGHT);
      for (guint k = n - 1; k > 0; k--)
        gst_harness_push (b.in[k], picture (&b, k, 3, (gint) (7 * i)));
      head = picture (&b, 0, 3, (gint) (7 * i));
      GST_BUFFER_OFFSET (head) = 41;
      gst_harness_push (b.in[0], head);
      out = gst_harness_pull (b.src);
      /* the very picture */
      fail_unless (out == head);
      fail_unless_equals_uint64 (GST_BUFFER_PTS (out), 3 * PERIOD);
      disparity = gst_buffer_get_cloth_disparity (out);
      fail_unless (disparity != NULL);
      fail_unless (check_points (disparity) > (n == 2 ? 0.7 : 0.9) * AREA);
      fail_unless_equals_string (gst_cloth_disparity_get_camera (disparity),
          "cam0");
      fail_unless_equals_uint64 (gst_cloth_disparity_get_sequence (disparity),
          41);
      fail_unless_equals_int (gst_cloth_stereo_get_n_cameras
          (gst_cloth_disparity_get_stereo (disparity)), n);
      fail_unless (gst_cloth_disparity_get_sigma (disparity) > 0);
      gst_buffer_unref (out);
      expect_silence (&b);
      bench_clear (&b);
    }
}

GST_END_TEST;

/* Pads by name: another camera is the head, and one of the rig has no pad. */
GST_START_TEST (test_names)
{
  Bench b;
  GstBuffer *out;

  bench_open (&b, scene_rig (), "");
  gst_object_unref (gst_element_request_pad_simple (b.element, "sink_0"));
  gst_object_unref (gst_element_request_pad_simple (b.element, "sink_1"));
  gst_child_proxy_set (GST_CHILD_PROXY (b.element), "sink_0::camera", "cam2",
      "sink_1::camera", "cam1", NULL);
  bench_link (&b, 0, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
  for (guint i = 0; i < 2; i++) {
    g_autofree gchar *name = g_strdup_printf ("sink_%u", i);

    b.in[i] = gst_harness_new_with_element (b.element, name, NULL);
    gst_harness_set_src_caps (b.in[i], gst_video_info_to_caps (&b.info));
  }
  b.n_pads = 2;
  gst_harness_push (b.in[1], picture (&b, 1, 0, 0));
  gst_harness_push (b.in[0], picture (&b, 2, 0, 0));
  out = gst_harness_pull (b.src);
  check_points (gst_buffer_get_cloth_disparity (out));
  gst_buffer_unref (out);
  bench_clear (&b);
}

GST_END_TEST;

/* The film of a rendered cloth, its silhouette from the truth. */
GST_START_TEST (test_film)
{
  g_autoptr (TestStereo) film = test_stereo_load (TEST_DATA "/lineart_stereo3");
  const gsize n = (gsize) (film->width * film->height);
  g_autofree gfloat *truth = g_new (gfloat, n);
  g_autofree gfloat *points = g_new (gfloat, 3 * n);
  g_autoptr (GArray) runs = g_array_new (FALSE, FALSE, sizeof (GstClothRun));
  gdouble sum = 0;
  guint n_cloth = 0, n_known = 0;
  GstBuffer *out;
  Bench b;

  test_stereo_truth (film, 2, truth);
  for (gint y = 0; y < film->height; y++)
    for (gint x = 0; x < film->width; x++) {
      GstClothRun run = { (guint16) y, (guint16) x, (guint16) x };

      while (x < film->width && !isnan (truth[y * film->width + x])) {
        run.end++;
        x++;
        n_cloth++;
      }
      if (run.end > run.begin)
        g_array_append_val (runs, run);
    }
  bench_open (&b, cloth_rig_load (TEST_DATA "/lineart_stereo3/rig.json", NULL),
      "near=1 far=3");
  bench_link (&b, 3, "GRAY8", film->width, film->height);
  for (gint k = 2; k >= 0; k--) {
    GstBuffer *buffer = gst_buffer_new_memdup (test_stereo_picture (film,
            (guint) k, 2), n);

    GST_BUFFER_PTS (buffer) = 0;
    if (k == 0)
      gst_buffer_add_cloth_silhouette_meta (buffer,
          gst_cloth_silhouette_new ("cam0", 0, (guint) film->width,
              (guint) film->height, (GstClothRun *) (gpointer) runs->data,
              runs->len));
    gst_harness_push (b.in[k], buffer);
  }
  out = gst_harness_pull (b.src);
  gst_cloth_disparity_get_points (gst_buffer_get_cloth_disparity (out), points);
  for (gsize i = 0; i < n; i++) {
    gdouble off;

    if (isnan (truth[i])) {
      fail_unless (isnan (points[3 * i + 2]));
      continue;
    }
    if (isnan (points[3 * i + 2]))
      continue;
    off = (gdouble) points[3 * i + 2] - film->focal * film->baseline /
        (gdouble) truth[i];
    sum += off * off;
    n_known++;
  }
  fail_unless (n_known > 0.99 * n_cloth);
  fail_unless (sqrt (sum / n_known) < 2e-3, "RMS %g m", sqrt (sum / n_known));
  gst_buffer_unref (out);
  bench_clear (&b);
}

GST_END_TEST;

/* The same bytes by any number of threads, picture after picture. */
GST_START_TEST (test_threads)
{
  g_autofree gfloat *first = NULL;

  for (guint threads = 1; threads <= 3; threads++) {
    g_autofree gchar *properties = g_strdup_printf ("threads=%u", threads);
    Bench b;

    bench_init (&b, 3, properties);
    for (guint frame = 0; frame < 2; frame++) {
      const gfloat *found;
      GstBuffer *out;

      push_all (&b, frame, 0);
      out = gst_harness_pull (b.src);
      found =
          gst_cloth_disparity_get_disparities (gst_buffer_get_cloth_disparity
          (out), NULL);
      if (frame == 1 && !first)
        first = g_memdup2 (found, AREA * sizeof (*found));
      else if (frame == 1)
        fail_unless (memcmp (found, first, AREA * sizeof (*found)) == 0);
      gst_buffer_unref (out);
    }
    bench_clear (&b);
  }
}

GST_END_TEST;

/* What is constant is one for all pictures. */
GST_START_TEST (test_shared)
{
  GstClothStereo *stereo = NULL;
  Bench b;

  bench_init (&b, 2, "");
  for (guint frame = 0; frame < 3; frame++) {
    GstClothStereo *this;
    GstBuffer *out;

    push_all (&b, frame, 0);
    out = gst_harness_pull (b.src);
    this = gst_cloth_disparity_get_stereo (gst_buffer_get_cloth_disparity
        (out));
    fail_unless (!stereo || this == stereo);
    stereo = this;
    gst_buffer_unref (out);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* A property that is set while pictures flow counts from the next one on. */
GST_START_TEST (test_change)
{
  Bench b;
  GstBuffer *out;

  bench_init (&b, 2, "");
  push_all (&b, 0, 0);
  gst_buffer_unref (gst_harness_pull (b.src));
  g_object_set (b.element, "far", 1.05, NULL);
  push_all (&b, 1, 0);
  out = gst_harness_pull (b.src);
  fail_unless (check_points (gst_buffer_get_cloth_disparity (out)) <
      0.5 * AREA);
  gst_buffer_unref (out);
  g_object_set (b.element, "near", 3., NULL);
  for (guint i = 0; i < 2; i++)
    gst_harness_push (b.in[i], picture (&b, i, 2, 0));
  expect (&b, GST_MESSAGE_ERROR, "far more than near");
  bench_clear (&b);
}

GST_END_TEST;

/* A downstream that knows no strides gets pictures as caps mean them. */
GST_START_TEST (test_plain)
{
  Bench b;
  GstBuffer *out;
  GstVideoMeta *meta;

  bench_open (&b, scene_rig (), "");
  b.plain = TRUE;
  bench_link (&b, 3, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
  push_all (&b, 0, 9);
  out = gst_harness_pull (b.src);
  meta = gst_buffer_get_video_meta (out);
  fail_unless (!meta || meta->stride[0] ==
      GST_VIDEO_INFO_PLANE_STRIDE (&b.info, 0));
  fail_unless_equals_uint64 (gst_buffer_get_size (out),
      GST_VIDEO_INFO_SIZE (&b.info));
  check_points (gst_buffer_get_cloth_disparity (out));
  gst_buffer_unref (out);
  bench_clear (&b);
}

GST_END_TEST;

/* ---- times and ends ---- */

/* A partner that ends, or has gaps: pictures go on, and that is told once and summed up. */
GST_START_TEST (test_early_end)
{
  Bench b;

  bench_init (&b, 3, "");
  push_all (&b, 0, 0);
  gst_buffer_unref (gst_harness_pull (b.src));
  gst_harness_push_event (b.in[2], gst_event_new_eos ());
  for (guint frame = 1; frame < 4; frame++) {
    GstBuffer *out;

    for (guint i = 0; i < 2; i++)
      gst_harness_push (b.in[i], picture (&b, i, frame, 0));
    out = gst_harness_pull (b.src);
    fail_unless (gst_buffer_get_cloth_disparity (out) == NULL);
    fail_unless_equals_uint64 (GST_BUFFER_PTS (out), frame * PERIOD);
    gst_buffer_unref (out);
  }
  expect (&b, GST_MESSAGE_WARNING, "\"cam2\" (sink_2) has no picture of 0.040");
  expect_silence (&b);
  gst_harness_push_event (b.in[0], gst_event_new_eos ());
  gst_harness_push_event (b.in[1], gst_event_new_eos ());
  expect (&b, GST_MESSAGE_INFO, "3 pictures went on");
  bench_clear (&b);
}

GST_END_TEST;

/* Memory whose reading takes the head's pad away. */
typedef struct
{
  GstMemory memory;
  Bench *bench;
  guint8 *data;
} Trap;

static gpointer
trap_map (GstMemory * memory, gsize size, GstMapFlags flags)
{
  Trap *trap = (Trap *) memory;
  GstElement *element = trap->bench->element;
  g_autoptr (GstPad) pad = gst_element_get_static_pad (element, "sink_0");

  if (pad) {
    gst_element_release_request_pad (element, pad);
  }
  return trap->data;
}

static void
trap_unmap (GstMemory * memory)
{
}

static void
trap_free (GstAllocator * allocator, GstMemory * memory)
{
  g_free (((Trap *) memory)->data);
  g_free (memory);
}

typedef GstAllocator TrapAllocator;
typedef GstAllocatorClass TrapAllocatorClass;
GType trap_allocator_get_type (void);
G_DEFINE_TYPE (TrapAllocator, trap_allocator, GST_TYPE_ALLOCATOR);

static void
trap_allocator_class_init (TrapAllocatorClass * klass)
{
  klass->free = trap_free;
}

static void
trap_allocator_init (TrapAllocator * allocator)
{
  allocator->mem_type = "trap";
  allocator->mem_map = trap_map;
  allocator->mem_unmap = trap_unmap;
}

/* The head's pad goes while its picture is looked at: that has its disparities, and the number
 * of its time. */
GST_START_TEST (test_head_released)
{
  g_autoptr (GstAllocator) allocator =
      gst_object_ref_sink (g_object_new (trap_allocator_get_type (), NULL));
  Trap *trap = g_new0 (Trap, 1);
  GstClothDisparity *disparity;
  GstSegment segment;
  GstBuffer *buffer, *out;
  gsize size;
  Bench b;

  bench_init (&b, 2, "");
  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.time = 10 * GST_SECOND;
  gst_harness_push_event (b.in[0], gst_event_new_segment (&segment));
  buffer = picture (&b, 0, 1, 0);
  trap->bench = &b;
  trap->data = g_malloc (gst_buffer_get_size (buffer));
  size = gst_buffer_extract (buffer, 0, trap->data, G_MAXSIZE);
  gst_memory_init (&trap->memory, 0, allocator, NULL, size, 0, 0, size);
  gst_buffer_replace_all_memory (buffer, &trap->memory);
  gst_harness_push (b.in[1], picture (&b, 1, 1, 0));
  gst_harness_push (b.in[0], buffer);
  out = gst_harness_pull (b.src);
  fail_unless (out != NULL);
  disparity = gst_buffer_get_cloth_disparity (out);
  fail_unless (disparity != NULL);
  fail_unless (gst_element_get_static_pad (b.element, "sink_0") == NULL);
  /* 25 a second, from 10 s on */
  fail_unless_equals_uint64 (gst_cloth_disparity_get_sequence (disparity), 251);
  gst_buffer_unref (out);
  bench_clear (&b);
}

GST_END_TEST;

/* Without the head's pictures there is nothing to go on. */
GST_START_TEST (test_head_ends)
{
  Bench b;
  GstEvent *event;
  gboolean ended = FALSE;

  bench_init (&b, 2, "");
  push_all (&b, 0, 0);
  gst_buffer_unref (gst_harness_pull (b.src));
  gst_harness_push_event (b.in[0], gst_event_new_eos ());
  gst_harness_push (b.in[1], picture (&b, 1, 1, 0));
  while (!ended && (event = gst_harness_pull_event (b.src))) {
    ended = GST_EVENT_TYPE (event) == GST_EVENT_EOS;
    gst_event_unref (event);
  }
  fail_unless (ended);
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

/* Clocks that the rig knows to differ are known from the first picture on. */
GST_START_TEST (test_offset)
{
  ClothRig *rig = scene_rig ();
  Bench b;

  cloth_camera_clear (&rig->cameras[--rig->n_cameras]);
  rig->cameras[1].offset_s = 0.4;
  bench_open (&b, rig, "");
  bench_link (&b, 2, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
  for (guint frame = 0; frame < 2; frame++) {
    GstBuffer *late = picture (&b, 1, frame, 0), *out;

    GST_BUFFER_PTS (late) += 400 * GST_MSECOND;
    gst_harness_push (b.in[1], late);
    gst_harness_push (b.in[0], picture (&b, 0, frame, 0));
    out = gst_harness_pull (b.src);
    fail_unless (gst_buffer_get_cloth_disparity (out) != NULL);
    fail_unless (check_points (gst_buffer_get_cloth_disparity (out)) >
        0.7 * AREA);
    gst_buffer_unref (out);
  }
  expect_silence (&b);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_flush)
{
  const guint32 seqnum = gst_util_seqnum_next ();
  GstSegment segment;
  GstBuffer *out;
  Bench b;

  bench_init (&b, 2, "");
  push_all (&b, 5, 0);
  gst_buffer_unref (gst_harness_pull (b.src));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  /* one seek, so one sequence number, reaches all pads */
  for (guint k = 0; k < 2; k++)
    for (guint i = 0; i < 2; i++) {
      GstEvent *event = k ? gst_event_new_flush_stop (TRUE) :
          gst_event_new_flush_start ();

      gst_event_set_seqnum (event, seqnum);
      gst_harness_push_event (b.in[i], event);
      if (k)
        gst_harness_push_event (b.in[i], gst_event_new_segment (&segment));
    }
  push_all (&b, 1, 0);
  out = gst_harness_pull (b.src);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), PERIOD);
  fail_unless (check_points (gst_buffer_get_cloth_disparity (out)) > 0);
  gst_buffer_unref (out);
  bench_clear (&b);
}

GST_END_TEST;

/* Other caps of the same size in mid-stream; of another size they are refused. */
GST_START_TEST (test_renegotiate)
{
  GstVideoInfo wrong;
  GstBuffer *out;
  Bench b;

  bench_init (&b, 2, "");
  push_all (&b, 0, 0);
  gst_buffer_unref (gst_harness_pull (b.src));
  gst_video_info_set_format (&b.info, GST_VIDEO_FORMAT_I420, SCENE_WIDTH,
      SCENE_HEIGHT);
  b.info.fps_n = 25;
  for (guint i = 0; i < 2; i++)
    gst_harness_set_src_caps (b.in[i], gst_video_info_to_caps (&b.info));
  push_all (&b, 1, 0);
  out = gst_harness_pull (b.src);
  check_points (gst_buffer_get_cloth_disparity (out));
  gst_buffer_unref (out);
  gst_video_info_set_format (&wrong, GST_VIDEO_FORMAT_GRAY8, 320, 200);
  gst_harness_set_src_caps (b.in[1], gst_video_info_to_caps (&wrong));
  gst_harness_push (b.in[1], gst_buffer_new_allocate (NULL, 320 * 200, NULL));
  gst_harness_push (b.in[0], picture (&b, 0, 2, 0));
  expect (&b, GST_MESSAGE_ERROR, "sink_1 are 320×200");
  bench_clear (&b);
}

GST_END_TEST;

/* ---- files ---- */

static void
check_file (const gchar * folder, const gchar * name,
    GstClothDisparity * disparity)
{
  g_autofree gchar *path = g_build_filename (folder, name, NULL);
  static const gchar head[] = "Pf\n241 181\n-1.0\n";
  g_autofree gchar *bytes = NULL;
  const gfloat *d = gst_cloth_disparity_get_disparities (disparity, NULL);
  gsize size;

  fail_unless (g_file_get_contents (path, &bytes, &size, NULL), "no %s", path);
  fail_unless_equals_uint64 (size, strlen (head) + AREA * sizeof (gfloat));
  fail_unless (g_str_has_prefix (bytes, head));
  for (gint y = 0; y < SCENE_HEIGHT; y++)
    for (gint x = 0; x < SCENE_WIDTH; x++) {
      gfloat value;

      memcpy (&value, bytes + strlen (head) + sizeof (gfloat) *
          (gsize) ((SCENE_HEIGHT - 1 - y) * SCENE_WIDTH + x), sizeof (value));
      fail_unless (value == d[y * SCENE_WIDTH + x] || (isinf (value)
              && isnan (d[y * SCENE_WIDTH + x])));
    }
  g_remove (path);
}

GST_START_TEST (test_files)
{
  static const gchar *const locations[] = { "d_%05d.pfm", "a%d", "sub" };
  static const gchar *const names[][2] = { {"d_00000.pfm", "d_00001.pfm"},
  {"a0", "a1"}, {"sub/00000.pfm", "sub/00001.pfm"}
  };

  for (guint i = 0; i < G_N_ELEMENTS (locations); i++) {
    g_autofree gchar *path = NULL, *sub = NULL;
    Bench b;

    bench_open (&b, scene_rig (), "");
    sub = g_build_filename (b.folder, "sub", NULL);
    path = g_build_filename (b.folder, locations[i], NULL);
    g_object_set (b.element, "location", path, NULL);
    bench_link (&b, 3, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
    for (guint frame = 0; frame < 2; frame++) {
      GstBuffer *out;

      push_all (&b, frame, 0);
      out = gst_harness_pull (b.src);
      check_file (b.folder, names[i][frame],
          gst_buffer_get_cloth_disparity (out));
      gst_buffer_unref (out);
    }
    g_rmdir (sub);
    bench_clear (&b);
  }
}

GST_END_TEST;

GST_START_TEST (test_bad_files)
{
  static const gchar *const bad[] = { "d.pfm", "d_%s.pfm", "%d_%d.pfm", "%5d",
    "%%d", "%000d"
  };
  Bench b;

  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    bench_open (&b, scene_rig (), "");
    g_object_set (b.element, "location", bad[i], NULL);
    fail_unless_equals_int (gst_element_set_state (b.element,
            GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
    expect (&b, GST_MESSAGE_ERROR, "%05d");
    bench_clear (&b);
  }
  /* the rig is a file, and no folder */
  bench_open (&b, scene_rig (), "");
  g_object_set (b.element, "location", b.rig_path, NULL);
  fail_unless_equals_int (gst_element_set_state (b.element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect (&b, GST_MESSAGE_ERROR, "can't be made");
  bench_clear (&b);
  /* a folder that isn't there */
  bench_open (&b, scene_rig (), "");
  {
    g_autofree gchar *path = g_build_filename (b.folder, "gone", "%d", NULL);

    g_object_set (b.element, "location", path, NULL);
  }
  bench_link (&b, 3, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
  for (guint i = 0; i < 3; i++)
    gst_harness_push (b.in[i], picture (&b, i, 0, 0));
  expect (&b, GST_MESSAGE_ERROR, "gone/0");
  bench_clear (&b);
}

GST_END_TEST;

/* ---- what is told, and what can't be ---- */

/* Pushes one set with a silhouette on the head's picture. */
static void
push_with (Bench * b, guint frame, GstClothSilhouette * silhouette)
{
  GstBuffer *head = picture (b, 0, frame, 0);

  gst_buffer_add_cloth_silhouette_meta (head, silhouette);
  for (guint i = 1; i < b->n_pads; i++)
    gst_harness_push (b->in[i], picture (b, i, frame, 0));
  gst_harness_push (b->in[0], head);
}

GST_START_TEST (test_told)
{
  static const struct
  {
    const gchar *properties, *text;
  } cases[] = {
    {"near=1.2 far=2", "make near smaller"},
    {"near=0.7 far=1.04", "make far larger"},
  };
  GstBuffer *out;
  Bench b;

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    bench_init (&b, 2, cases[i].properties);
    for (guint frame = 0; frame < 2; frame++) {
      push_with (&b, frame, box (SCENE_WIDTH, SCENE_HEIGHT, 40, 150));
      gst_buffer_unref (gst_harness_pull (b.src));
    }
    expect (&b, GST_MESSAGE_WARNING, cases[i].text);
    bench_clear (&b);
  }
  /* an empty silhouette: a map of nothing, said once */
  bench_init (&b, 2, "");
  for (guint frame = 0; frame < 2; frame++) {
    push_with (&b, frame, box (SCENE_WIDTH, SCENE_HEIGHT, 0, 0));
    out = gst_harness_pull (b.src);
    fail_unless (gst_buffer_get_cloth_disparity (out) != NULL);
    gst_buffer_unref (out);
  }
  expect (&b, GST_MESSAGE_WARNING, "silhouette is empty");
  expect_silence (&b);
  bench_clear (&b);
  /* pads that were mixed up: rows don't agree, so hardly anything is found */
  bench_init (&b, 2, "");
  gst_harness_push (b.in[0], picture (&b, 0, 0, 0));
  {
    GstBuffer *other = picture (&b, 1, 0, 0);

    gst_buffer_memset (other, 0, 128, AREA);
    gst_harness_push (b.in[1], other);
  }
  gst_buffer_unref (gst_harness_pull (b.src));
  expect (&b, GST_MESSAGE_WARNING, "of the picture only");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_wrong_silhouette)
{
  Bench b;

  bench_init (&b, 2, "");
  push_with (&b, 0, box (SCENE_WIDTH * 2, SCENE_HEIGHT, 10, 20));
  expect (&b, GST_MESSAGE_ERROR, "482 × 181");
  bench_clear (&b);
}

GST_END_TEST;

/* A picture that is smaller than its caps. */
GST_START_TEST (test_small_buffer)
{
  for (guint pad = 0; pad < 2; pad++) {
    Bench b;

    bench_init (&b, 2, "");
    for (guint i = 0; i < 2; i++) {
      GstBuffer *buffer = picture (&b, i, 0, 0);

      if (i == pad)
        gst_buffer_set_size (buffer, 100);
      gst_harness_push (b.in[i], buffer);
    }
    expect (&b, GST_MESSAGE_ERROR, "does not fit its caps");
    bench_clear (&b);
  }
}

GST_END_TEST;

static void
fail_with_pads (ClothRig * rig, guint n_pads, const gchar * text)
{
  Bench b;

  bench_open (&b, rig, "");
  bench_link (&b, n_pads, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
  for (guint i = 0; i < n_pads; i++)
    gst_harness_push (b.in[i], picture (&b, 0, 0, 0));
  expect (&b, GST_MESSAGE_ERROR, text);
  bench_clear (&b);
}

/* A head and a partner, but no pad between them. */
GST_START_TEST (test_left_out_pad)
{
  static const gchar *const names[] = { "sink_0", "sink_2" };
  ClothRig *rig = scene_rig ();
  Bench b;

  cloth_camera_clear (&rig->cameras[--rig->n_cameras]);
  bench_open (&b, rig, "");
  bench_link (&b, 0, "GRAY8", SCENE_WIDTH, SCENE_HEIGHT);
  for (; b.n_pads < G_N_ELEMENTS (names); b.n_pads++) {
    b.in[b.n_pads] = gst_harness_new_with_element (b.element, names[b.n_pads],
        NULL);
    gst_harness_set_src_caps (b.in[b.n_pads], gst_video_info_to_caps (&b.info));
  }
  for (guint i = 0; i < b.n_pads; i++)
    gst_harness_push (b.in[i], picture (&b, i, 0, 0));
  expect (&b, GST_MESSAGE_ERROR, "its partner to sink_1");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_bad_heads)
{
  ClothRig *rig = scene_rig (), *four = cloth_rig_new (4), *one;
  static const gdouble ahead[3] = { 0.01, 0, 0.2 }, still[3];
  g_autoptr (ClothRig) again = scene_rig ();

  /* which of three are they? */
  fail_with_pads (rig, 2, "Set sink_0::camera");
  for (guint i = 0; i < 4; i++) {
    cloth_camera_clear (&four->cameras[i]);
    cloth_camera_copy (&four->cameras[i], &again->cameras[i % 3]);
  }
  g_free (four->cameras[3].name);
  four->cameras[3].name = g_strdup ("cam3");
  fail_with_pads (four, 4, "two or three cameras");
  one = scene_rig ();
  while (one->n_cameras > 1)
    cloth_camera_clear (&one->cameras[--one->n_cameras]);
  fail_with_pads (one, 1, "two or three cameras");
  rig = scene_rig ();
  cloth_camera_clear (&rig->cameras[--rig->n_cameras]);
  scene_camera (&rig->cameras[1], "cam1", ahead, still);
  fail_with_pads (rig, 2, "before or behind");
  rig = scene_rig ();
  cloth_camera_clear (&rig->cameras[--rig->n_cameras]);
  rig->cameras[1].width = 300;
  fail_with_pads (rig, 2, "calibrated at 300×181");
}

GST_END_TEST;

GST_START_TEST (test_bad_rig)
{
  static const gchar *const bad[] = { NULL, "/nowhere/rig.json" };
  static const gchar *const texts[] = { "rig is not set", "could not be read" };
  Bench b;

  for (guint i = 0; i < 2; i++) {
    bench_open (&b, scene_rig (), "");
    g_object_set (b.element, "rig", bad[i], NULL);
    fail_unless_equals_int (gst_element_set_state (b.element,
            GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
    expect (&b, GST_MESSAGE_ERROR, texts[i]);
    bench_clear (&b);
  }
}

GST_END_TEST;

static Suite *
clothdisparity_suite (void)
{
  Suite *s = suite_create ("clothdisparity");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_plane);
  tcase_add_test (tc, test_names);
  tcase_add_test (tc, test_film);
  tcase_add_test (tc, test_threads);
  tcase_add_test (tc, test_shared);
  tcase_add_test (tc, test_change);
  tcase_add_test (tc, test_plain);
  tcase_add_test (tc, test_early_end);
  tcase_add_test (tc, test_head_ends);
  tcase_add_test (tc, test_head_released);
  tcase_add_test (tc, test_offset);
  tcase_add_test (tc, test_flush);
  tcase_add_test (tc, test_renegotiate);
  tcase_add_test (tc, test_files);
  tcase_add_test (tc, test_bad_files);
  tcase_add_test (tc, test_told);
  tcase_add_test (tc, test_wrong_silhouette);
  tcase_add_test (tc, test_small_buffer);
  tcase_add_test (tc, test_left_out_pad);
  tcase_add_test (tc, test_bad_heads);
  tcase_add_test (tc, test_bad_rig);
  return s;
}

GST_CHECK_MAIN (clothdisparity);
