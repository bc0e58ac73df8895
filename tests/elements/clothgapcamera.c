/* clothgap on what one camera saw: residuals across the sight against closed forms, what
 * stays unseen along it, which camera it is, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "clothgaplook.h"
#include "tests/elements/damage.h"

/* @rig: a file of this test, or NULL: the one in the take's folder */
static Setup
set_up_camera (const gchar * take, const gchar * rig, const gchar * more)
{
  g_autofree gchar *text = g_strdup_printf ("%s%s%s %s", rig ? "rig=" : "",
      rig ? folder : "", rig ? rig : "", more);
  Setup setup = set_up ("/model.json", take, text);

  gst_harness_set_src_caps (setup.h, make_camera_caps (SIZE, FPS));
  return setup;
}

static void
push_seen (Setup * setup, const Look * look, guint from, guint to)
{
  for (guint frame = from; frame < to; frame++)
    fail_unless_equals_int (gst_harness_push (setup->h, see (look, frame)),
        GST_FLOW_OK);
}

static void
end (Setup * setup)
{
  gst_harness_push_event (setup->h, gst_event_new_eos ());
}

/* RMS of the next window's score, and how much of the cloth was seen; NaN: there is none */
static gdouble
next_score (Setup * setup, gdouble * coverage)
{
  g_autoptr (GstMessage) message = find_message (setup, GST_MESSAGE_ELEMENT,
      "clothgap/score");
  gdouble rms = NAN;

  if (message)
    fail_unless (gst_structure_get (gst_message_get_structure (message), "rms",
            G_TYPE_DOUBLE, &rms, "coverage", G_TYPE_DOUBLE, coverage, NULL));
  return rms;
}

/* ---- positive ---- */

/* The closed form of clothgapbench.h, by dots or by squares: from the front the fall is
 * across the sight. In the first window the distance of what falls freely is a·t²/2. */
GST_START_TEST (test_across)
{
  const Look looks[] = { front, {.name = "",.acceleration = ACCELERATION,
      .missing = -1}
  };
  Look look = looks[__i__];
  Setup setup = set_up_camera ("/seen", NULL, __i__ ? "camera=front" : "");
  gdouble worst = 0, want = 0, coverage, rms;

  for (guint frame = 0; frame < N_FRAMES; frame++) {
    push_seen (&setup, &look, frame, frame + 1);
    fail_unless_equals_int (gst_harness_buffers_received (setup.h),
        frame < LATENCY ? 0 : frame - LATENCY + 1);
  }
  end (&setup);
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), N_FRAMES);
  for (guint frame = 0; frame < N_FRAMES; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    GstClothGap *gap = gst_buffer_get_cloth_gap (buffer);
    gdouble e = oscillator ((gdouble) frame / FPS);

    fail_unless_equals_uint64 (gst_cloth_gap_get_sequence (gap), frame);
    worst = MAX (worst, fabs (mean_residual (buffer, 2) - e));
    fail_unless (fabs (mean_residual (buffer, 0)) < 1e-5);
    /* sights are tilted by up to 6% */
    fail_unless (fabs (mean_residual (buffer, 1)) < 0.06 * 0.02);
    /* a pixel is 1 cm */
    fail_unless (fabs (gst_cloth_gap_get_sigmas (gap, NULL)[5] -
            SIGMA_PX * 0.01) < 1e-6 + 0.005 * SIGMA_PX * 0.01);
    gst_buffer_unref (buffer);
  }
  fail_unless (worst < 0.0003, "%.3f mm from the closed form", 1000 * worst);
  for (guint i = 1; i <= PER_WINDOW; i++)
    want += pow (0.5 * ACCELERATION * i * i / FPS / FPS, 2) / PER_WINDOW;
  want = sqrt (want);
  rms = next_score (&setup, &coverage);
  fail_unless (fabs (rms - want) < 0.03 * want, "%.2f mm, not %.2f",
      1000 * rms, 1000 * want);
  fail_unless_equals_float (coverage, 1);
  tear_down (&setup);
}

GST_END_TEST;

/* From above the same fall is along the sight: it shows only in perspective, by 0.18 m of
 * 100 m on 0.15 m after 0.6 s. */
GST_START_TEST (test_along)
{
  const Look look = {.above = TRUE,.name = "above",.acceleration = ACCELERATION,
    .missing = -1
  };
  Setup setup = set_up_camera ("/seen", NULL, "");
  gdouble coverage, rms;
  guint n = 0;

  push_seen (&setup, &look, 0, 124);
  for (guint frame = 0; frame < 121; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    const gfloat *r =
        gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap (buffer), NULL);

    for (guint i = 0; i < 3 * N; i++)
      fail_unless (fabsf (r[i]) < 0.0004f, "%.3f mm", 1000. * r[i]);
    gst_buffer_unref (buffer);
  }
  while (!isnan (rms = next_score (&setup, &coverage))) {
    fail_unless (rms < 0.0005, "%.3f mm", 1000 * rms);
    n++;
  }
  fail_unless_equals_int (n, 2);
  tear_down (&setup);
}

GST_END_TEST;

/* Until it falls out of the picture; the first frames' speeds are noisy, which takes 0.7 s
 * to settle. */
#define N_SEEN 220
#define N_SETTLED 140

/* Without gap residuals are the pixels' noise, in two directions, and the verdict is that. */
GST_START_TEST (test_noise)
{
  ClothRandom random;
  Look look = front;
  Setup setup = set_up_camera ("/seen", NULL, "");
  g_autoptr (GstMessage) message = NULL;
  gdouble sum = 0;

  cloth_random_init (&random, 1);
  look.noise = &random;
  look.acceleration = 0;
  push_seen (&setup, &look, 0, N_SEEN);
  end (&setup);
  for (guint frame = 0; frame < N_SEEN; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    const gfloat *r =
        gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap (buffer), NULL);

    for (guint i = 0; frame >= N_SETTLED && i < 3 * N; i++)
      sum += r[i] * r[i] / (N_SEEN - N_SETTLED) / N;
    gst_buffer_unref (buffer);
  }
  sum = sqrt (sum / 2) / 0.01 / SIGMA_PX;
  GST_INFO ("residuals are %.3f times the noise", sum);
  fail_unless (sum > 0.9 && sum < 1.1, "residuals are %.3f times the noise",
      sum);
  message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
  fail_unless (message != NULL);
  /* without a baseline nobody knows how much could be seen */
  fail_unless_equals_string (gst_structure_get_string
      (gst_message_get_structure (message), "verdict"), "undecidable");
  tear_down (&setup);
}

GST_END_TEST;

/* A jump aside is as large as it is in the frame in which it comes, but for what the
 * springs do in that frame. */
GST_START_TEST (test_jump)
{
  Look look = front;
  Setup setup = set_up_camera ("/seen", NULL, "");

  look.acceleration = 0;
  look.shift = 0.03;
  push_seen (&setup, &look, 0, 64);
  for (guint frame = 0; frame < 61; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    gdouble want = frame < 57 ? 0 : 0.03;

    /* three frames before it the velocities know of it already */
    if (frame < 57 || frame == 60)
      fail_unless (fabs (mean_residual (buffer, 0) - want) < 0.1 * 0.03,
          "frame %u: %.2f mm", frame, 1000 * mean_residual (buffer, 0));
    gst_buffer_unref (buffer);
  }
  tear_down (&setup);
}

GST_END_TEST;

/* The observations leave as they came. */
GST_START_TEST (test_same_bytes)
{
  Setup setup = set_up_camera ("/seen", NULL, "");

  push_seen (&setup, &front, 0, 5);
  for (guint frame = 0; frame < 2; frame++)
    expect_same (&setup, see (&front, frame));
  tear_down (&setup);
}

GST_END_TEST;

/* A dot that is not seen, and pictures that show nothing, from the first on. */
GST_START_TEST (test_missing)
{
  Setup setup = set_up_camera ("/seen", NULL, "");
  Look look = front;
  gdouble coverage;

  look.missing = 6;
  for (guint frame = 0; frame < 65; frame++) {
    if (frame == 0 || frame == 30) {
      fail_unless_equals_int (gst_harness_push (setup.h, see_nothing (frame)),
          GST_FLOW_OK);
    } else {
      push_seen (&setup, frame < 20 ? &look : &front, frame, frame + 1);
    }
  }
  for (guint frame = 0; frame < 62; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    const gfloat *r =
        gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap (buffer), NULL);
    gboolean dark = frame == 0 || frame == 30;

    fail_unless_equals_int (isnan (r[18]), dark || frame < 20);
    fail_unless_equals_int (isnan (r[0]), dark);
    fail_unless_equals_uint64 (gst_cloth_gap_get_sequence
        (gst_buffer_get_cloth_gap (buffer)), frame);
    gst_buffer_unref (buffer);
  }
  next_score (&setup, &coverage);
  /* of the window's 60 frames one was dark, and 19 lacked one of 12 vertices */
  fail_unless (fabs (coverage - (1 - (1 + 19. / N) / PER_WINDOW)) < 1e-9, "%g",
      coverage);
  tear_down (&setup);
}

GST_END_TEST;

/* A dot that is taken for one that is six squares away, from the first frame on, counts as
 * not seen; where it was believed the simulation would burst. */
GST_START_TEST (test_wrong)
{
  Setup setup = set_up_camera ("/seen", NULL, "");
  g_autoptr (GstMessage) message = NULL;
  ClothRandom random;
  Look look = front;

  cloth_random_init (&random, 2);
  look.acceleration = 0;
  look.noise = &random;
  look.wrong = 5;
  push_seen (&setup, &look, 0, N_SEEN);
  end (&setup);
  for (guint frame = 0; frame < N_SEEN; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    const gfloat *r =
        gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap (buffer), NULL);

    for (guint i = 0; i < N; i++)
      fail_unless_equals_int (isnan (r[3 * i]), i == 5);
    gst_buffer_unref (buffer);
  }
  message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
  fail_unless (message != NULL);
  /* without a baseline nobody knows how much could be seen */
  fail_unless_equals_string (gst_structure_get_string
      (gst_message_get_structure (message), "verdict"), "undecidable");
  tear_down (&setup);
}

GST_END_TEST;

/* The property counts, then the metas' name, then that there is only one camera; the rig
 * is the property's, then that of the folder. */
GST_START_TEST (test_which_camera)
{
  static const struct
  {
    const gchar *take, *rig, *more, *name;
  } cases[] = {
    {"/seen", NULL, "", "front"},
    {"/seen", NULL, "camera=front", ""},
    {"/seen", NULL, "camera=front", "above"},
    {"/take", "/one.json", "", ""},
    {"/take", "/one.json", "", "only"},
    {"/seen", "/one.json", "", ""},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    Setup setup = set_up_camera (cases[i].take, cases[i].rig, cases[i].more);
    Look look = front;

    look.name = cases[i].name;
    push_seen (&setup, &look, 0, 5);
    expect_meshes (&setup, 2, 2);
    fail_unless (find_message (&setup, GST_MESSAGE_ERROR, NULL) == NULL);
    tear_down (&setup);
  }
}

GST_END_TEST;

/* A camera that is 2 frames late shows what was 2 frames before; of pictures that say no time the first two, which
 * are before the scene, count. */
GST_START_TEST (test_offset)
{
  Setup setup = set_up_camera ("/seen", "/late.json", "");
  g_autoptr (GstMessage) message = NULL;
  guint64 time;

  for (guint frame = __i__ ? 0 : 2; frame < 70; frame++) {
    GstBuffer *buffer = see (&front, frame);

    if (__i__)
      GST_BUFFER_PTS (buffer) = GST_CLOCK_TIME_NONE;
    fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_OK);
  }
  message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/score");
  fail_unless (gst_structure_get_uint64 (gst_message_get_structure (message),
          "time", &time));
  fail_unless_equals_uint64 (time, 0);
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_latency)
{
  Setup setup = set_up_camera ("/seen", NULL, "");

  gst_harness_set_upstream_latency (setup.h, 7 * GST_MSECOND);
  fail_unless_equals_uint64 (gst_harness_query_latency (setup.h),
      22 * GST_MSECOND);
  tear_down (&setup);
}

GST_END_TEST;

/* After a flush it starts anew, with meshes if they come; so it does when a segment goes
 * back. */
GST_START_TEST (test_again)
{
  for (guint way = 0; way < 3; way++) {
    Setup setup = set_up_camera ("/seen", NULL, "");

    push_seen (&setup, &front, 0, 12);
    if (way > 0)
      flush (&setup);
    if (way == 2)
      gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
    begin_segment (&setup);
    if (way == 2)
      push (&setup, 0, 12);
    else
      push_seen (&setup, &front, 0, 12);
    expect_oscillator (&setup, way ? 9 : 12, way ? 18 : 21);
    tear_down (&setup);
  }
}

GST_END_TEST;

/* The meshes of a source, filmed from 1.2 m. @sine: of the angle that the sight has turned
 * from y to −x */
static void
film (Setup * setup, GstHarness * source, gdouble sine)
{
  const gdouble cosine = sqrt (1 - sine * sine), focal = 900, away = 1.2;
  GstBuffer *buffer;
  ClothRandom random;

  cloth_random_init (&random, 3);
  for (guint frame = 0; frame < 60 && (buffer = gst_harness_pull (source));
      frame++) {
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, NULL);
    const gfloat *places = gst_cloth_mesh_get_positions (mesh, NULL);
    g_autoptr (GstBuffer) picture = gst_buffer_new ();
    GstClothDot dots[81] = { {0} };
    GstBuffer *observation;

    for (guint i = 0; i < 81; i++) {
      gdouble x = places[3 * i] - 0.19, y = places[3 * i + 1];
      gdouble depth = away - sine * x + cosine * y;

      dots[i].column = (gint) (i % 9);
      dots[i].row = (gint) (i / 9);
      dots[i].x = (gfloat) (320 + focal * (cosine * x + sine * y) / depth
          + 0.05 * cloth_random_gaussian (&random));
      dots[i].y = (gfloat) (240 + focal * (1.3 - places[3 * i + 2]) / depth
          + 0.05 * cloth_random_gaussian (&random));
      dots[i].cov_xx = dots[i].cov_yy = 0.0025f;
    }
    gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new ("", frame, 9,
            9, 4, dots, 81));
    observation = gst_cloth_observations_pack (picture);
    GST_BUFFER_PTS (observation) = frame * GST_SECOND / 50;
    fail_unless_equals_int (gst_harness_push (setup->h, observation),
        GST_FLOW_OK);
    gst_buffer_unref (buffer);
  }
}

#define KNIT "model=" TEST_DATA "/../../pipelines/model-knit.json"
#define DRAG "location=" TEST_DATA "/take_drag"

/* A sheet that swings along y, held against a model that knows no air drag. When the sheet
 * doesn't either there is no gap. When it does there is one, the larger the more of the
 * motion is across the sight. The scores that remain without it come from the speeds of
 * the first frame, of which a camera sees two directions, and from the springs. */
GST_START_TEST (test_drag)
{
  static const struct
  {
    const gchar *source;
    gdouble sine;
  } cases[] = {
    {"meshsrc " DRAG, 0.8}, {"meshsrc " DRAG, 0}, {"clothsim " KNIT " " DRAG,
        0.8}
  };
  gdouble sums[G_N_ELEMENTS (cases)] = { 0 };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    gdouble s = cases[i].sine, c = sqrt (1 - s * s), coverage, rms;
    g_autofree gchar *rig = g_strdup_printf ("{\"version\": 1, \"cameras\": "
        "[{\"name\": \"it\", \"size\": [640, 480], \"K\": [[900, 0, 320], "
        "[0, 900, 240], [0, 0, 1]], \"distortion\": {\"model\": \"none\", "
        "\"coefficients\": []}, \"R\": [[%g, %g, 0], [0, 0, -1], [%g, %g, 0]], "
        "\"t\": [%g, 1.3, %g]}]}", c, s, -s, c, -0.19 * c, 1.2 + 0.19 * s);
    g_autofree gchar *text = g_strdup_printf ("clothgap " KNIT " " DRAG
        " rig=%s/turned.json effects=air_drag,wind,gravity_tilt", folder);
    g_autoptr (GstMessage) message = NULL;
    const gchar *verdict;
    GstElement *element;
    GstHarness *source = gst_harness_new_parse (cases[i].source);
    Setup setup = { NULL, gst_bus_new () };

    put_file ("turned.json", rig);
    element = gst_object_ref_sink (gst_parse_launch (text, NULL));
    gst_element_set_bus (element, setup.bus);
    setup.h = gst_harness_new_with_element (element, "sink", "src");
    gst_object_unref (element);
    gst_harness_set_src_caps (setup.h,
        gst_caps_from_string (GST_CLOTH_OBSERVATIONS_MEDIA_TYPE ", version=1, "
            "width=640, height=480, framerate=50/1"));
    gst_harness_play (source);
    film (&setup, source, s);
    gst_harness_teardown (source);
    while (!isnan (rms = next_score (&setup, &coverage))) {
      fail_unless (coverage > 0.9);
      sums[i] += rms;
    }
    end (&setup);
    message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
    fail_unless (message != NULL);
    verdict = gst_structure_get_string (gst_message_get_structure (message),
        "verdict");
    GST_INFO ("%.1f mm, %s", 1000 * sums[i], verdict);
    /* nobody says what the simulation would be off by without a gap */
    fail_if (g_str_equal (verdict, "no_gap")
        || g_str_equal (verdict, "unexplained"));
    if (i == 2)
      fail_unless_equals_string (verdict, "undecidable");
    tear_down (&setup);
  }
  fail_unless (sums[0] > 1.5 * sums[1], "%.1f mm and %.1f mm", 1000 * sums[0],
      1000 * sums[1]);
  fail_unless (sums[0] > 2 * sums[2], "%.1f mm and %.1f mm", 1000 * sums[0],
      1000 * sums[2]);
}

GST_END_TEST;

/* ---- refusals ---- */

GST_START_TEST (test_no_camera)
{
  static const struct
  {
    const gchar *take, *rig, *more, *name, *text;
  } cases[] = {
    {"/take", NULL, "", "front", "Set rig="},
    {"/take", NULL, "camera=front", "", "Set rig="},
    {"/take", "/none.json", "", "front", "none.json"},
    {"/take", "/broken.json", "camera=front", "front", "Can't read the rig"},
    {"/seen", NULL, "camera=left", "front", "front, above"},
    {"/seen", NULL, "", "left", "no camera “left”"},
    {"/seen", NULL, "", "", "front, above"},
    {"/seen", NULL, "", NULL, "front, above"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    Setup setup = set_up_camera (cases[i].take, cases[i].rig, cases[i].more);
    Look look = front;

    look.name = cases[i].name;
    fail_unless (gst_harness_push (setup.h, see (&look, 0)) != GST_FLOW_OK);
    expect (&setup, GST_MESSAGE_ERROR, cases[i].text);
    tear_down (&setup);
  }
}

GST_END_TEST;

/* Another size of picture, from the beginning and in mid-stream. */
GST_START_TEST (test_other_size)
{
  Setup setup = set_up_camera ("/seen", NULL, "");

  push_seen (&setup, &front, 0, 5);
  gst_harness_set_src_caps (setup.h, make_camera_caps (640, FPS));
  expect (&setup, GST_MESSAGE_ERROR, "calibrated at 1000×1000");
  tear_down (&setup);

  setup = set_up ("/model.json", "/seen", "");
  gst_harness_set_src_caps (setup.h, make_camera_caps (640, FPS));
  fail_unless_equals_int (gst_harness_push (setup.h, see (&front, 0)),
      GST_FLOW_ERROR);
  expect (&setup, GST_MESSAGE_ERROR, "Pictures are 640×640");
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_other_grid)
{
  for (guint dots = 0; dots < 2; dots++) {
    Setup setup = set_up_camera ("/seen", NULL, "");
    Look look = front;

    look.dots = dots;
    look.columns = COLUMNS + 1;
    fail_unless_equals_int (gst_harness_push (setup.h, see (&look, 0)),
        GST_FLOW_ERROR);
    expect (&setup, GST_MESSAGE_ERROR, "5×3 vertices, but the take's grid has "
        "4×3");
    tear_down (&setup);
  }
}

GST_END_TEST;

GST_START_TEST (test_other_camera)
{
  Setup setup = set_up_camera ("/seen", NULL, "");
  Look look = front;

  push_seen (&setup, &front, 0, 5);
  look.name = "above";
  fail_unless_equals_int (gst_harness_push (setup.h, see (&look, 5)),
      GST_FLOW_OK);
  assert_dropped (setup.h->element, setup.bus, 1,
      "of camera “above”, those before it are of “");
  tear_down (&setup);
}

GST_END_TEST;

/* Bytes that are none, that end too soon, and a place that is NaN. */
GST_START_TEST (test_bad_buffers)
{
  for (guint i = 0; i < 4; i++) {
    Setup setup = set_up_camera ("/seen", NULL, "");
    GstBuffer *buffer = see (&front, 0);
    const gfloat nan = NAN;
    /* of the first dot, behind the header, the section's head and the name */
    const gsize at = 32 + 8 + 24 + 8 + 16;

    if (i == 0)
      gst_buffer_memset (buffer, 0, 0, gst_buffer_get_size (buffer));
    else if (i == 1)
      gst_buffer_resize (buffer, 0, 50);
    else if (i == 2)
      gst_buffer_fill (buffer, at, &nan, sizeof nan);
    else
      gst_buffer_resize (buffer, 0, 0);
    g_object_set (setup.h->element, "strict", TRUE, NULL);
    fail_unless_equals_int (gst_harness_push (setup.h, gst_buffer_copy
            (buffer)), GST_FLOW_ERROR);
    assert_refused_damage (setup.h->element, setup.bus, "stream is damaged");
    g_object_set (setup.h->element, "strict", FALSE, NULL);
    fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_OK);
    assert_dropped (setup.h->element, setup.bus, 1, "damaged packet");
    tear_down (&setup);
  }
}

GST_END_TEST;

/* A place that no picture of this camera has. */
GST_START_TEST (test_far_outside)
{
  Setup setup = set_up_camera ("/seen", NULL, "");
  Look look = front;

  push_seen (&setup, &front, 0, 5);
  look.shift = 8;
  fail_unless_equals_int (gst_harness_push (setup.h, see (&look, 60)),
      GST_FLOW_OK);
  assert_dropped (setup.h->element, setup.bus, 1,
      "px, but the camera was calibrated");
  tear_down (&setup);
}

GST_END_TEST;

/* Neither a time nor a rate; times that fall. */
GST_START_TEST (test_times)
{
  Setup setup = set_up_camera ("/seen", NULL, "");
  GstBuffer *buffer = see (&front, 0);

  push_seen (&setup, &front, 0, 5);
  push_seen (&setup, &front, 4, 5);
  expect (&setup, GST_MESSAGE_WARNING, "The picture at 0.020 s");
  tear_down (&setup);

  setup = set_up ("/model.json", "/seen", "");
  gst_harness_set_src_caps (setup.h, make_camera_caps (SIZE, 0));
  GST_BUFFER_PTS (buffer) = GST_CLOCK_TIME_NONE;
  fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_ERROR);
  expect (&setup, GST_MESSAGE_ERROR, "picture has neither");
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_other_kind)
{
  Setup setup = set_up_camera ("/seen", NULL, "");

  push_seen (&setup, &front, 0, 5);
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  expect (&setup, GST_MESSAGE_ERROR, "from observations to meshes");
  tear_down (&setup);

  setup = set_up ("/model.json", "/seen", "");
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  push (&setup, 0, 5);
  gst_harness_set_src_caps (setup.h, make_camera_caps (SIZE, FPS));
  expect (&setup, GST_MESSAGE_ERROR, "from meshes to observations");
  tear_down (&setup);
}

GST_END_TEST;

/* Nothing came; or only pictures that show nothing. */
GST_START_TEST (test_nothing)
{
  Setup setup = set_up_camera ("/seen", NULL, "");

  end (&setup);
  expect (&setup, GST_MESSAGE_ERROR, "without a picture");
  fail_unless (pull_events (&setup, NULL));
  tear_down (&setup);

  setup = set_up_camera ("/seen", NULL, "");
  for (guint frame = 0; frame < 20; frame++)
    fail_unless_equals_int (gst_harness_push (setup.h, see_nothing (frame)),
        GST_FLOW_OK);
  end (&setup);
  expect (&setup, GST_MESSAGE_ERROR, "No picture showed squares, dots or");
  fail_unless (pull_events (&setup, NULL));
  tear_down (&setup);
}

GST_END_TEST;

static Suite *
clothgapcamera_suite (void)
{
  Suite *s = suite_create ("clothgapcamera");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, test_across, 0, 2);
  tcase_add_test (tc, test_along);
  tcase_add_test (tc, test_noise);
  tcase_add_test (tc, test_jump);
  tcase_add_test (tc, test_drag);
  tcase_add_test (tc, test_same_bytes);
  tcase_add_test (tc, test_missing);
  tcase_add_test (tc, test_wrong);
  tcase_add_test (tc, test_which_camera);
  tcase_add_loop_test (tc, test_offset, 0, 2);
  tcase_add_test (tc, test_latency);
  tcase_add_test (tc, test_again);
  tcase_add_test (tc, test_no_camera);
  tcase_add_test (tc, test_other_size);
  tcase_add_test (tc, test_other_grid);
  tcase_add_test (tc, test_other_camera);
  tcase_add_test (tc, test_bad_buffers);
  tcase_add_test (tc, test_far_outside);
  tcase_add_test (tc, test_times);
  tcase_add_test (tc, test_other_kind);
  tcase_add_test (tc, test_nothing);
  return s;
}

int
main (int argc, char **argv)
{
  int failed;

  gst_check_init (&argc, &argv);
  make_files ();
  make_rigs ();
  failed = gst_check_run_suite (clothgapcamera_suite (), "clothgapcamera",
      __FILE__);
  remove_all (folder);
  g_free (folder);
  return failed;
}
