/* triangulate: from the squares that cameras see to a mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/damage.h"
#include "tests/elements/triangulatebench.h"

GST_START_TEST (test_three_views)
{
  Bench b;
  guint frame;

  bench_init (&b, 3);
  for (frame = 0; frame < 4; frame++) {
    push_all (&b, frame);
    expect_all (&b, frame, GST_CLOTH_VERTEX_MEASURED);
  }
  {
    g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b.src->sinkpad);
    g_autoptr (GError) error = NULL;
    g_autoptr (GstClothTopology) topology =
        gst_cloth_topology_from_caps (caps, &error);
    const gfloat *uv;
    gint n, d;

    g_assert_no_error (error);
    fail_unless_equals_int (gst_cloth_topology_get_columns (topology),
        COLUMNS + 1);
    fail_unless_equals_int (gst_cloth_topology_get_rows (topology), ROWS + 1);
    uv = gst_cloth_topology_get_uv (topology, NULL);
    /* the margin of 50 mm; then the third vertex of the second row */
    fail_unless (fabs (uv[0] - 0.05) < 1e-6 && fabs (uv[1] - 0.05) < 1e-6);
    fail_unless (fabs (uv[2 * (COLUMNS + 3)] - 0.13) < 1e-6);
    fail_unless (fabs (uv[2 * (COLUMNS + 3) + 1] - 0.09) < 1e-6);
    fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
            "framerate", &n, &d));
    fail_unless_equals_int (n, 25);
    fail_unless_equals_int (d, 1);
  }
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_two_views)
{
  Bench b;

  bench_init (&b, 2);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* Squares seen by one camera only, and squares that are not tracked now, are unseen. */
GST_START_TEST (test_unseen)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  guint i;

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  for (i = 0; i < N_QUADS; i++) {
    if (i % COLUMNS >= 3) {
      quads[i].state = i % 2 ? GST_CLOTH_QUAD_LOST : GST_CLOTH_QUAD_PREDICTED;
    }
  }
  push (&b, 0, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (i = 0; i < N_VERTICES; i++) {
    fail_unless_equals_int (states[i], i % (COLUMNS + 1) <= 3 ?
        GST_CLOTH_VERTEX_TWO_VIEWS : GST_CLOTH_VERTEX_UNSEEN);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* Nothing seen is a mesh of unseen vertices: nothing of the frame before is left. */
GST_START_TEST (test_nothing_seen)
{
  Bench b;

  bench_init (&b, 3);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  push_seen (&b, 0, 0, 1, 0, NULL);
  push_seen (&b, 1, 1, 1, 0, NULL);
  push_seen (&b, 2, 2, 1, 0, NULL);
  expect_all (&b, 1, GST_CLOTH_VERTEX_UNSEEN);
  /* no metadata at all, in one and in every camera */
  push (&b, 0, NULL, 2);
  push_seen (&b, 1, 1, 2, ALL, NULL);
  push_seen (&b, 2, 2, 2, ALL, NULL);
  expect_all (&b, 2, GST_CLOTH_VERTEX_TWO_VIEWS);
  push (&b, 0, NULL, 3);
  push (&b, 1, NULL, 3);
  push (&b, 2, NULL, 3);
  expect_all (&b, 3, GST_CLOTH_VERTEX_UNSEEN);
  push_all (&b, 4);
  expect_all (&b, 4, GST_CLOTH_VERTEX_MEASURED);
  bench_clear (&b);
}

GST_END_TEST;

/* No frame ever carries squares: said once. */
GST_START_TEST (test_no_detector)
{
  Bench b;
  guint frame, i;

  bench_init (&b, 2);
  for (frame = 0; frame < 30; frame++) {
    for (i = 0; i < 2; i++) {
      push (&b, i, NULL, frame);
    }
    expect_all (&b, frame, GST_CLOTH_VERTEX_UNSEEN);
  }
  expect_message (&b, GST_MESSAGE_WARNING, "quadtrack");
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* One camera linked, or one of two with a detector: said once, with its name. */
GST_START_TEST (test_one_detector)
{
  guint n, frame;

  for (n = 1; n <= 2; n++) {
    Bench b;

    bench_open (&b, 2);
    g_object_set (b.element, "allow-one-camera", n == 1, NULL);
    bench_link (&b, n, FALSE, VIDEO);
    for (frame = 0; frame < 30; frame++) {
      push_seen (&b, 0, 0, frame, ALL, "cam0");
      if (n == 2) {
        push (&b, 1, NULL, frame);
      }
      expect_all (&b, frame, GST_CLOTH_VERTEX_UNSEEN);
    }
    expect_message (&b, GST_MESSAGE_WARNING, "Only camera \"cam0\"");
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* The pads are mixed up, or a camera was moved: said once, with its name. */
GST_START_TEST (test_cameras_do_not_fit)
{
  Bench b;
  guint frame, i;

  bench_init (&b, 4);
  b.rig->cameras[2].t[1] += 0.02;
  for (frame = 0; frame < 30; frame++) {
    for (i = 0; i < 4; i++) {
      push_seen (&b, i, i, frame, ALL, NULL);
    }
    gst_buffer_unref (gst_harness_pull (b.src));
  }
  expect_message (&b, GST_MESSAGE_WARNING, "Camera \"cam2\"");
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* One camera makes no vertex: an error unless it is asked for, or others are gone. */
GST_START_TEST (test_one_camera)
{
  GstPad *pad;
  Bench b;

  bench_open (&b, 2);
  bench_link (&b, 1, FALSE, VIDEO);
  gst_harness_push (b.in[0], picture (NULL, 0));
  expect_error (&b, "allow-one-camera");
  bench_clear (&b);

  bench_init (&b, 2);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  pad = gst_element_get_static_pad (b.element, "sink_1");
  gst_harness_teardown (b.in[1]);
  if (GST_OBJECT_PARENT (pad)) {
    gst_element_release_request_pad (b.element, pad);
  }
  gst_object_unref (pad);
  b.n_pads = 1;
  push_seen (&b, 0, 0, 1, ALL, "cam0");
  expect_all (&b, 1, GST_CLOTH_VERTEX_UNSEEN);
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_ERROR) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

static void
end_all (Bench * b)
{
  for (guint i = 0; i < b->n_pads; i++) {
    fail_unless (gst_harness_push_event (b->in[i], gst_event_new_eos ()));
  }
  while (TRUE) {
    g_autoptr (GstEvent) event = gst_harness_pull_event (b->src);

    fail_unless (event != NULL);
    if (GST_EVENT_TYPE (event) == GST_EVENT_EOS) {
      return;
    }
  }
}

/* Of a short film it is said at its end whether the cameras fit, and of a good one nothing. */
GST_START_TEST (test_short_films)
{
  guint mixed, frame, i;

  for (mixed = 0; mixed < 2; mixed++) {
    Bench b;

    bench_init (&b, 2);
    for (frame = 0; frame < 3; frame++) {
      for (i = 0; i < 2; i++) {
        push_seen (&b, i, mixed ? 1 - i : i, frame, ALL, NULL);
      }
      gst_buffer_unref (gst_harness_pull (b.src));
    }
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
    end_all (&b);
    if (mixed) {
      expect_message (&b, GST_MESSAGE_WARNING,
          "Cameras \"cam0\" and \"cam1\" contradict each other");
    }
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* A film that starts a frame late: the hint says that it may be its time. */
GST_START_TEST (test_late_film)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;
  g_autoptr (GstMessage) message = NULL;
  guint frame, i;
  Bench b;

  bench_init (&b, 3);
  for (frame = 0; frame < 25; frame++) {
    for (i = 0; i < 3; i++) {
      GstClothQuad quads[N_QUADS];

      see (&b, i, frame + (i == 1), quads);
      push (&b, i, gst_cloth_quads_new (NULL, frame, COLUMNS, ROWS, quads,
              N_QUADS), frame);
    }
    gst_buffer_unref (gst_harness_pull (b.src));
  }
  message = gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING);
  fail_unless (message != NULL);
  gst_message_parse_warning (message, &error, &debug);
  fail_unless (strstr (error->message, "contradicts the others"));
  fail_unless (strstr (debug, "start together") && strstr (debug, "offset_s"),
      "%s", debug);
  bench_clear (&b);
}

GST_END_TEST;

/* A rig in centimetres, and a print that is smaller or larger than pattern says: the cameras
 * agree, but no cloth is like that. Said once, also of a short film. */
GST_START_TEST (test_wrong_size)
{
  static const struct
  {
    gdouble rig, square;
    guint n_frames;
    const gchar *text;
  } cases[] = {
    {100, SQUARE, 30, "Neighbours are 10"}, {100, SQUARE, 3,
        "Neighbours are 10"},
    {1, 0.75 * SQUARE, 30, "Neighbours are 1.3"},
    {1, 1.5 * SQUARE, 30, "Neighbours are 0."}, {1, SQUARE, 30, NULL}
  };

  for (guint k = 0; k < G_N_ELEMENTS (cases); k++) {
    g_autoptr (ClothPattern) pattern = NULL;
    g_autoptr (ClothRig) rig = NULL;
    g_autoptr (GError) error = NULL;
    Bench b;

    bench_open (&b, 2);
    rig = cloth_rig_load (b.rig_path, &error);
    g_assert_no_error (error);
    for (guint c = 0; c < 2; c++) {
      for (guint i = 0; i < 3; i++) {
        rig->cameras[c].t[i] *= cases[k].rig;
      }
    }
    cloth_rig_save (rig, b.rig_path, &error);
    g_assert_no_error (error);
    pattern = cloth_pattern_new_checker (COLUMNS, ROWS, cases[k].square, 0.05,
        TRUE, &error);
    g_assert_no_error (error);
    cloth_pattern_save (pattern, b.pattern_path, &error);
    g_assert_no_error (error);
    bench_link (&b, 2, FALSE, VIDEO);
    for (guint frame = 0; frame < cases[k].n_frames; frame++) {
      push_all (&b, frame);
      gst_buffer_unref (gst_harness_pull (b.src));
    }
    end_all (&b);
    if (cases[k].text) {
      expect_message (&b, GST_MESSAGE_WARNING, cases[k].text);
    }
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* Cameras of different rates are spoken of once; those of a phone's 29.9 and 30 are not. */
GST_START_TEST (test_rates)
{
  static const gchar *const rates[] = { "30/1", "299/10", "0/1" };

  for (guint k = 0; k < G_N_ELEMENTS (rates); k++) {
    g_autofree gchar *caps = g_strconcat ("video/x-raw,format=GRAY8,width=1280,"
        "height=720,framerate=", rates[k], NULL);
    Bench b;

    bench_open (&b, 2);
    bench_link (&b, 2, FALSE, k ? "video/x-raw,format=GRAY8,width=1280,"
        "height=720,framerate=30/1" : VIDEO);
    gst_harness_set_src_caps_str (b.in[1], caps);
    for (guint frame = 0; frame < 3; frame++) {
      push_all (&b, frame);
      gst_buffer_unref (gst_harness_pull (b.src));
    }
    if (k == 0) {
      expect_message (&b, GST_MESSAGE_WARNING,
          "25/1 on sink_0, 30/1 on sink_1");
    }
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* One film given as two cameras': said at its first picture, once. */
GST_START_TEST (test_same_film)
{
  guint frame, i;
  Bench b;

  bench_init (&b, 3);
  for (frame = 0; frame < 2; frame++) {
    for (i = 0; i < 3; i++) {
      push_seen (&b, i, i < 2 ? i : 1, frame, ALL, NULL);
    }
    gst_buffer_unref (gst_harness_pull (b.src));
  }
  expect_message (&b, GST_MESSAGE_WARNING,
      "Cameras \"cam1\" and \"cam2\" show the very same picture");
  end_all (&b);
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* A camera without a frame for an instant: the others make the mesh. */
GST_START_TEST (test_missing_camera)
{
  Bench b;

  bench_init (&b, 3);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  fail_unless (gst_harness_push_event (b.in[1], gst_event_new_gap (PERIOD,
              PERIOD)));
  push_seen (&b, 0, 0, 1, ALL, NULL);
  push_seen (&b, 2, 2, 1, ALL, NULL);
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  push_seen (&b, 0, 0, 2, ALL, NULL);
  push_seen (&b, 2, 2, 2, ALL, NULL);
  push_seen (&b, 1, 1, 2, ALL, NULL);
  expect_all (&b, 2, GST_CLOTH_VERTEX_MEASURED);
  /* one ends before the others */
  fail_unless (gst_harness_push_event (b.in[0], gst_event_new_eos ()));
  push_seen (&b, 1, 1, 3, ALL, NULL);
  push_seen (&b, 2, 2, 3, ALL, NULL);
  expect_all (&b, 3, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* Pictures of a pad of which camera 1 is @ahead frames ahead of the others, of streams that begin with frame @first. */
static void
push_from (Bench * b, guint pad, guint first, guint frame, gint ahead)
{
  const gint instant = (gint) frame - (pad == 1 ? ahead : 0) + MAX (ahead, 0);
  GstClothQuad quads[N_QUADS];

  see (b, pad, (guint) instant, quads);
  push (b, pad, gst_cloth_quads_new (NULL, frame, COLUMNS, ROWS, quads,
          N_QUADS), first + frame);
}

static void
push_ahead (Bench * b, guint pad, guint frame, gint ahead)
{
  push_from (b, pad, 0, frame, ahead);
}

static void
open_ahead (Bench * b, gint ahead)
{
  g_autoptr (GError) error = NULL;

  bench_open (b, 3);
  b->rig->cameras[1].offset_s = (gdouble) ahead *PERIOD / GST_SECOND;
  cloth_rig_save (b->rig, b->rig_path, &error);
  g_assert_no_error (error);
  bench_link (b, 3, FALSE, VIDEO);
}

static void
expect_frame (Bench * b, guint frame, guint instant, GstClothVertexState state)
{
  g_autoptr (GstClothMesh) mesh = pull (b, frame);

  fail_unless (check_all (mesh, instant, state) < 1e-6);
}

/* A camera whose clock is two frames ahead, or that began two frames late. No instant is lost, not even the first, when
 * nobody knows yet whose the pictures are. Pushed in an order in which no pad waits for another. */
GST_START_TEST (test_offset)
{
  Bench b;

  open_ahead (&b, 2);
  for (guint pad = 0; pad < 3; pad++)
    push_ahead (&b, pad, 0, 2);
  push_ahead (&b, 1, 1, 2);
  push_ahead (&b, 1, 2, 2);
  expect_frame (&b, 0, 2, GST_CLOTH_VERTEX_MEASURED);
  push_ahead (&b, 0, 1, 2);
  push_ahead (&b, 2, 1, 2);
  push_ahead (&b, 1, 3, 2);
  expect_frame (&b, 1, 3, GST_CLOTH_VERTEX_MEASURED);
  bench_clear (&b);

  open_ahead (&b, -2);
  for (guint pad = 0; pad < 3; pad++)
    push_ahead (&b, pad, 0, -2);
  expect_frame (&b, 0, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  for (guint frame = 1; frame < 3; frame++) {
    push_ahead (&b, 0, frame, -2);
    push_ahead (&b, 2, frame, -2);
    expect_frame (&b, frame, frame, frame == 2 ? GST_CLOTH_VERTEX_MEASURED :
        GST_CLOTH_VERTEX_TWO_VIEWS);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* The same of streams that begin so late that their first times are not believed at once. */
GST_START_TEST (test_offset_late)
{
  const guint first = 20 * GST_SECOND / PERIOD;
  Bench b;

  open_ahead (&b, -2);
  for (guint frame = 0; frame < 2; frame++)
    for (guint pad = 0; pad < 3; pad++)
      push_from (&b, pad == 1 ? 0 : pad == 0 ? 1 : 2, first, frame, -2);
  {
    g_autoptr (GstClothMesh) mesh = pull (&b, first);

    fail_unless (check_all (mesh, 0, GST_CLOTH_VERTEX_TWO_VIEWS) < 1e-6);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* Cameras by the name in the metadata, whatever the order of the pads. */
GST_START_TEST (test_names_in_metadata)
{
  Bench b;

  bench_init (&b, 3);
  push_seen (&b, 0, 2, 0, ALL, "cam2");
  push_seen (&b, 1, 0, 0, ALL, "cam0");
  push_seen (&b, 2, 1, 0, ALL, "cam1");
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  bench_clear (&b);
}

GST_END_TEST;

/* Cameras by the pads' property, which wins over the metadata; two pads of a rig of
 * three. */
GST_START_TEST (test_names_of_pads)
{
  Bench b;
  g_autofree gchar *name = NULL;

  bench_open (&b, 3);
  bench_link (&b, 2, FALSE, VIDEO);
  gst_child_proxy_set (GST_CHILD_PROXY (b.element), "sink_0::camera", "cam2",
      "sink_1::camera", "cam1", NULL);
  gst_child_proxy_get (GST_CHILD_PROXY (b.element), "sink_1::camera", &name,
      NULL);
  fail_unless_equals_string (name, "cam1");
  push_seen (&b, 0, 2, 0, ALL, "cam0");
  push_seen (&b, 1, 1, 0, ALL, NULL);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

static GstBuffer *
packet (Bench * b, guint camera, guint frame, const gchar * name, guint columns)
{
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstBuffer) buffer = NULL;

  see (b, camera, frame, quads);
  buffer = picture (gst_cloth_quads_new (name, frame, columns, ROWS, quads,
          N_QUADS), frame);
  return gst_cloth_observations_pack (buffer);
}

/* Well-formed packets that name another camera, or another board, than those before them: as
 * if that camera saw nothing. From the first packet on they are an error. */
GST_START_TEST (test_forged)
{
  static const gchar *const names[] = { "nobody", "cam2", "cam0" };
  Bench b;
  guint frame, i;

  bench_open (&b, 3);
  bench_link (&b, 3, FALSE, OBSERVATIONS);
  for (frame = 0; frame < 5; frame++) {
    const gboolean forged = frame > 0 && frame < 4;

    for (i = 0; i < 3; i++) {
      g_autofree gchar *name = g_strdup_printf ("cam%u", i);

      fail_unless_equals_int (gst_harness_push (b.in[i], i == 0 && forged ?
              packet (&b, i, frame, names[frame - 1],
                  frame == 3 ? COLUMNS + 1 : COLUMNS) :
              packet (&b, i, frame, name, COLUMNS)), GST_FLOW_OK);
    }
    expect_all (&b, frame, forged ? GST_CLOTH_VERTEX_TWO_VIEWS :
        GST_CLOTH_VERTEX_MEASURED);
  }
  assert_dropped (b.element, b.bus, 3, "another camera or pattern");
  bench_clear (&b);

  bench_open (&b, 3);
  bench_link (&b, 3, FALSE, OBSERVATIONS);
  for (i = 0; i < 3; i++)
    gst_harness_push (b.in[i], packet (&b, i, 0, i ? NULL : "nobody", COLUMNS));
  expect_error (&b, "nobody");
  bench_clear (&b);
}

GST_END_TEST;

/* The same from observation streams, beside a picture. */
GST_START_TEST (test_observations)
{
  Bench b;
  guint frame, i;

  bench_open (&b, 3);
  bench_link (&b, 3, FALSE, OBSERVATIONS);
  gst_harness_set_src_caps_str (b.in[1], VIDEO);
  for (frame = 0; frame < 3; frame++) {
    for (i = 0; i < 3; i++) {
      GstClothQuad quads[N_QUADS];
      GstBuffer *buffer;

      see (&b, i, frame, quads);
      buffer = picture (gst_cloth_quads_new (NULL, frame, COLUMNS, ROWS, quads,
              N_QUADS), frame);
      if (i != 1) {
        GstBuffer *packed = gst_cloth_observations_pack (buffer);

        gst_buffer_unref (buffer);
        buffer = packed;
      }
      fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
    }
    expect_all (&b, frame, GST_CLOTH_VERTEX_MEASURED);
  }
  /* bytes that are no observations: as a camera that saw nothing */
  push_seen (&b, 1, 1, 3, ALL, NULL);
  for (i = 0; i < 3; i += 2) {
    GstBuffer *buffer = gst_buffer_new_memdup ("nonsense", 8);

    GST_BUFFER_PTS (buffer) = 3 * PERIOD;
    GST_BUFFER_DURATION (buffer) = PERIOD;
    fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
  }
  expect_all (&b, 3, GST_CLOTH_VERTEX_UNSEEN);
  /* told of once */
  assert_dropped (b.element, b.bus, 2, "sink_0");
  for (i = 0; i < 3; i++) {
    GstBuffer *buffer = gst_buffer_new_memdup ("nonsense", 8);

    GST_BUFFER_PTS (buffer) = 4 * PERIOD;
    GST_BUFFER_DURATION (buffer) = PERIOD;
    fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
  }
  expect_all (&b, 4, GST_CLOTH_VERTEX_UNSEEN);
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  /* with strict the first is one too many */
  g_object_set (b.element, "strict", TRUE, NULL);
  for (i = 0; i < 3; i++) {
    GstBuffer *buffer = gst_buffer_new_memdup ("nonsense", 8);

    GST_BUFFER_PTS (buffer) = 5 * PERIOD;
    GST_BUFFER_DURATION (buffer) = PERIOD;
    gst_harness_push (b.in[i], buffer);
  }
  expect_error (&b, "sink_0");
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
triangulate_suite (void)
{
  Suite *s = suite_create ("triangulate");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_three_views);
  tcase_add_test (tc, test_two_views);
  tcase_add_test (tc, test_unseen);
  tcase_add_test (tc, test_nothing_seen);
  tcase_add_test (tc, test_no_detector);
  tcase_add_test (tc, test_one_detector);
  tcase_add_test (tc, test_cameras_do_not_fit);
  tcase_add_test (tc, test_one_camera);
  tcase_add_test (tc, test_short_films);
  tcase_add_test (tc, test_late_film);
  tcase_add_test (tc, test_wrong_size);
  tcase_add_test (tc, test_rates);
  tcase_add_test (tc, test_same_film);
  tcase_add_test (tc, test_missing_camera);
  tcase_add_test (tc, test_offset);
  tcase_add_test (tc, test_offset_late);
  tcase_add_test (tc, test_names_in_metadata);
  tcase_add_test (tc, test_names_of_pads);
  tcase_add_test (tc, test_observations);
  tcase_add_test (tc, test_forged);
  return s;
}

GST_CHECK_MAIN (triangulate);
