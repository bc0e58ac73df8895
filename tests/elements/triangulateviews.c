/* triangulate: what its cameras saw, on the mesh that it makes of it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/triangulatebench.h"

#define OFFSET (10 * GST_MSECOND)
/* Of the second camera's pictures: less than half a period. */
#define LATE (3 * GST_MSECOND)

/* Three cameras; the clock of the second is OFFSET ahead, as the rig knows. */
static void
views_init (Bench * b, const gchar * caps)
{
  g_autoptr (GError) error = NULL;

  bench_open (b, 3);
  b->rig->cameras[1].offset_s = (gdouble) OFFSET / GST_SECOND;
  cloth_rig_save (b->rig, b->rig_path, &error);
  g_assert_no_error (error);
  bench_link (b, 3, FALSE, caps);
}

static GstClockTime
time_of (guint camera, guint frame)
{
  return frame * PERIOD + (camera == 1 ? OFFSET + LATE : 0);
}

/* Pushes what a camera sees of the first @n squares, -1: no squares were looked for. */
static void
push_view (Bench * b, guint camera, guint frame, gint n, const gchar * name,
    gboolean pack)
{
  GstClothQuad quads[N_QUADS];
  GstBuffer *buffer;

  see (b, camera, frame, quads);
  buffer = picture (n < 0 ? NULL : gst_cloth_quads_new (name, 100 * camera
          + frame, COLUMNS, ROWS, quads, (guint) n), frame);
  GST_BUFFER_PTS (buffer) = time_of (camera, frame);
  if (pack) {
    GstBuffer *packed = gst_cloth_observations_pack (buffer);

    gst_buffer_unref (buffer);
    buffer = packed;
  }
  fail_unless_equals_int (gst_harness_push (b->in[camera], buffer),
      GST_FLOW_OK);
}

/* Whether the mesh has what a camera saw: @n squares, each to the bit, or none at all (-1). */
static void
expect_view (Bench * b, GstBuffer * mesh, guint camera, guint frame, gint n)
{
  g_autoptr (GstBuffer) seen = gst_buffer_new ();
  g_autoptr (GError) error = NULL;
  GstClothView *view = gst_buffer_get_cloth_view (mesh,
      b->rig->cameras[camera].name);
  GstClothQuad truth[N_QUADS];
  const GstClothQuad *quads;
  guint n_quads;

  fail_unless (view != NULL);
  fail_unless_equals_uint64 (gst_cloth_view_get_sequence (view),
      n < 0 ? 0 : 100 * camera + frame);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (gst_cloth_view_get_observation
          (view)), time_of (camera, frame));
  gst_cloth_observations_unpack (gst_cloth_view_get_observation (view), seen,
      &error);
  g_assert_no_error (error);
  if (n < 0) {
    fail_unless (gst_buffer_get_cloth_quads (seen) == NULL);
    return;
  }
  quads = gst_cloth_quads_get_quads (gst_buffer_get_cloth_quads (seen),
      &n_quads);
  fail_unless_equals_int (n_quads, n);
  see (b, camera, frame, truth);
  for (gint i = 0; i < n; i++) {
    fail_unless (memcmp (quads[i].x, truth[i].x, sizeof truth[i].x) == 0);
    fail_unless (memcmp (quads[i].y, truth[i].y, sizeof truth[i].y) == 0);
  }
}

/* Of pictures and of packets, with the times of the cameras' own clocks; a camera that saw nothing, and one that gave
 * no picture. What fills the mesh's holes leaves them there. */
GST_START_TEST (test_seen)
{
  const gboolean pack = __i__ == 1;
  GstHarness *fill = gst_harness_new ("meshfill");
  Bench b;

  views_init (&b, pack ? OBSERVATIONS : VIDEO);
  for (guint frame = 0; frame < 4; frame++) {
    g_autoptr (GstBuffer) mesh = NULL;
    g_autoptr (GstBuffer) filled = NULL;
    g_autoptr (GstCaps) caps = NULL;
    const gint n[3] = { N_QUADS, frame == 1 ? -1 : 3, N_QUADS - 4 };

    for (guint camera = 0; camera < 3; camera++)
      if (frame != 3 || camera != 2)
        push_view (&b, camera, frame, n[camera], NULL, pack);
    if (frame == 3)             /* the last set of all */
      for (guint i = 0; i < 3; i++)
        gst_harness_push_event (b.in[i], gst_event_new_eos ());
    mesh = gst_harness_pull (b.src);
    fail_unless_equals_uint64 (GST_BUFFER_PTS (mesh), frame * PERIOD);
    for (guint camera = 0; camera < 3; camera++) {
      if (frame == 3 && camera == 2)
        fail_unless (gst_buffer_get_cloth_view (mesh, "cam2") == NULL);
      else
        expect_view (&b, mesh, camera, frame, n[camera]);
    }
    caps = gst_pad_get_current_caps (b.src->sinkpad);
    if (frame == 0)
      gst_harness_set_src_caps (fill, gst_caps_ref (caps));
    filled = gst_harness_push_and_pull (fill, gst_buffer_ref (mesh));
    expect_view (&b, filled, 0, frame, N_QUADS);
    fail_unless ((gst_buffer_get_nth_cloth_view (filled, 2) == NULL) ==
        (frame == 3));
  }
  gst_harness_teardown (fill);
  bench_clear (&b);
}

GST_END_TEST;

/* The rig's name counts, also where pictures have none or the pad has another than they. */
GST_START_TEST (test_names)
{
  g_autoptr (GstBuffer) mesh = NULL;
  Bench b;

  views_init (&b, VIDEO);
  gst_child_proxy_set (GST_CHILD_PROXY (b.element), "sink_0::camera", "cam2",
      "sink_2::camera", "cam0", NULL);
  for (guint camera = 0; camera < 3; camera++)
    push_view (&b, camera, 0, N_QUADS, camera ? NULL : "cam0", FALSE);
  mesh = gst_harness_pull (b.src);
  fail_unless_equals_uint64 (gst_cloth_view_get_sequence
      (gst_buffer_get_cloth_view (mesh, "cam0")), 200);
  fail_unless_equals_uint64 (gst_cloth_view_get_sequence
      (gst_buffer_get_cloth_view (mesh, "cam2")), 0);
  bench_clear (&b);
}

GST_END_TEST;

/* Damaged packets, and those of another camera, are on no mesh. */
GST_START_TEST (test_damaged)
{
  Bench b;

  views_init (&b, OBSERVATIONS);
  for (guint frame = 0; frame < 3; frame++) {
    g_autoptr (GstBuffer) mesh = NULL;

    push_view (&b, 0, frame, N_QUADS, "cam0", TRUE);
    if (frame == 1) {
      GstBuffer *buffer = gst_buffer_new_memdup ("nonsense", 8);

      GST_BUFFER_PTS (buffer) = time_of (1, frame);
      gst_harness_push (b.in[1], buffer);
    } else {
      push_view (&b, 1, frame, N_QUADS, "cam1", TRUE);
    }
    push_view (&b, 2, frame, N_QUADS, frame == 2 ? "cam0" : "cam2", TRUE);
    mesh = gst_harness_pull (b.src);
    expect_view (&b, mesh, 0, frame, N_QUADS);
    fail_unless ((gst_buffer_get_cloth_view (mesh, "cam1") == NULL) ==
        (frame == 1));
    fail_unless ((gst_buffer_get_cloth_view (mesh, "cam2") == NULL) ==
        (frame == 2));
  }
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
triangulateviews_suite (void)
{
  Suite *suite = suite_create ("triangulateviews");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (suite, tc);
  tcase_add_loop_test (tc, test_seen, 0, 2);
  tcase_add_test (tc, test_names);
  tcase_add_test (tc, test_damaged);
  return suite;
}

GST_CHECK_MAIN (triangulateviews);
