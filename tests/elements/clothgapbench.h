/* clothgap's tests: files, harness, messages. A loose sheet falls; the recording falls
 * more slowly by ACCELERATION. No inner force acts, so the distance e of recording and
 * simulation obeys e″ = ACCELERATION − g·e − 2ζ√g·e′ and settles at ACCELERATION / g.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <glib/gstdio.h>
#include <math.h>

#include "gst/take/take.h"

#define COLUMNS 4
#define ROWS 3
#define N (COLUMNS * ROWS)
#define FPS 200
#define N_FRAMES 240
#define PER_WINDOW 60
#define GRAVITY 9.81
#define ACCELERATION 1.0
#define GAIN 100.0
#define LATENCY 3
/* The element that is tested, with what it always is given. */
#ifndef ELEMENT
#define ELEMENT "clothgap effects=air_drag"
#endif

static gchar *folder;           /* of all files of this test */

static inline gchar *
in_folder (const gchar * name)
{
  return g_build_filename (folder, name, NULL);
}

/* ---- files ---- */

static inline void
put_model (const gchar * name, const gchar * keys)
{
  g_autofree gchar *path = in_folder (name);
  g_autofree gchar *text = g_strdup_printf ("{\"version\": 1, "
      "\"damping\": {\"mass\": 0, \"stiffness\": 0.0005}%s}", keys);

  g_assert_true (g_file_set_contents (path, text, -1, NULL));
}

static inline void
find_places (guint frame, gdouble acceleration, gfloat * places)
{
  gdouble t = (gdouble) frame / FPS;

  for (guint i = 0; i < N; i++) {
    places[3 * i] = 0.1f * (gfloat) (i % COLUMNS);
    places[3 * i + 1] = 0.1f * (gfloat) (i / COLUMNS);
    places[3 * i + 2] = (gfloat) (5 - 0.5 * (GRAVITY - acceleration) * t * t);
  }
}

static inline void
put_take (const gchar * name, guint columns, guint rows, gboolean held,
    gdouble acceleration)
{
  g_autofree gchar *path = in_folder (name);
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new (name);
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (columns, rows, 0.1f * (gfloat) (columns - 1),
      0.1f * (gfloat) (rows - 1));
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree gfloat *places = g_new0 (gfloat, 3 * columns * rows + 3 * N);
  g_autofree guint8 *states = g_malloc0 (columns * rows + N);
  const ClothHeld corner = { 0, -INFINITY, INFINITY };

  info->fps = FPS;
  info->columns = columns;
  info->rows = rows;
  info->width_m = 0.1 * (columns - 1);
  info->height_m = 0.1 * (rows - 1);
  info->noise_sigma_m = 0.0004;
  if (held)
    g_array_append_val (info->held, corner);
  memset (states, CLOTH_VERTEX_MEASURED, columns * rows);
  writer = cloth_take_writer_new (path, info, topology, &error);
  g_assert_no_error (error);
  for (guint frame = 0; frame < N_FRAMES; frame++) {
    find_places (frame, acceleration, places);
    cloth_take_writer_append (writer, (gdouble) frame / FPS, places, states,
        NULL, held ? places : NULL, &error);
    g_assert_no_error (error);
  }
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
}

static inline void
make_files (void)
{
  g_autofree gchar *observations = NULL;

  folder = g_dir_make_tmp ("clothgap-test-XXXXXX", NULL);
  g_assert_nonnull (folder);
  /* short steps: the closed form has none */
  put_model ("model.json", ", \"time_step\": 0.0002");
  put_model ("wild.json", ", \"time_step\": 0.02, \"stretch\": "
      "{\"warp\": 100000, \"weft\": 100000}");
  put_model ("bad.json", ", \"shear\": -4");
  put_take ("take", COLUMNS, ROWS, FALSE, ACCELERATION);
  put_take ("held", COLUMNS, ROWS, TRUE, ACCELERATION);
  put_take ("other", COLUMNS + 1, ROWS, FALSE, ACCELERATION);
  put_take ("blind", COLUMNS, ROWS, FALSE, ACCELERATION);
  put_take ("simulated", COLUMNS, ROWS, FALSE, 0.);
  observations = in_folder ("/blind/observations");
  g_assert_cmpint (g_mkdir (observations, 0777), ==, 0);
}

static inline void
remove_all (const gchar * path)
{
  GDir *dir = g_dir_open (path, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *inside = g_build_filename (path, name, NULL);

    remove_all (inside);
  }
  if (dir)
    g_dir_close (dir);
  g_remove (path);
}

/* ---- harness ---- */

typedef struct
{
  GstHarness *h;
  GstBus *bus;
} Setup;

static inline GstElement *
make_element (const gchar * model, const gchar * take, const gchar * more)
{
  g_autofree gchar *text =
      g_strdup_printf (ELEMENT " %s%s%s %s%s%s %s",
      model ? "model=" : "", model ? folder : "", model ? model : "",
      take ? "location=" : "", take ? folder : "", take ? take : "", more);
  g_autoptr (GError) error = NULL;
  GstElement *element = gst_parse_launch (text, &error);

  g_assert_no_error (error);
  return gst_object_ref_sink (element);
}

static inline GstCaps *
make_caps (guint columns, guint rows, gfloat step, gint fps)
{
  g_autoptr (GstClothTopology) topology = gst_cloth_topology_new_grid (columns,
      rows, step * (gfloat) (columns - 1), step * (gfloat) (rows - 1), NULL);

  return gst_cloth_topology_to_caps (topology, fps, 1);
}

static inline Setup
set_up (const gchar * model, const gchar * take, const gchar * more)
{
  GstElement *element = make_element (model, take, more);
  Setup setup;

  setup.bus = gst_bus_new ();
  gst_element_set_bus (element, setup.bus);
  setup.h = gst_harness_new_with_element (element, "sink", "src");
  gst_object_unref (element);
  return setup;
}

static inline Setup
set_up_good (const gchar * more)
{
  Setup setup = set_up ("/model.json", "/take", more);

  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  return setup;
}

static inline void
tear_down (Setup * setup)
{
  gst_element_set_bus (setup->h->element, NULL);
  gst_harness_teardown (setup->h);
  gst_object_unref (setup->bus);
}

/* @missing: a vertex that is not seen, or -1 */
static inline GstBuffer *
make_frame (guint frame, gint missing, const gfloat * covariances)
{
  gfloat places[3 * N];
  guint8 states[N];
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *buffer;

  find_places (frame, ACCELERATION, places);
  memset (states, GST_CLOTH_VERTEX_MEASURED, N);
  if (missing >= 0)
    states[missing] = GST_CLOTH_VERTEX_UNSEEN;
  mesh = gst_cloth_mesh_new (frame, N, places, states, covariances);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = gst_util_uint64_scale (frame, GST_SECOND, FPS);
  GST_BUFFER_DURATION (buffer) = GST_SECOND / FPS;
  return buffer;
}

static inline void
push (Setup * setup, guint from, guint to)
{
  for (guint frame = from; frame < to; frame++)
    fail_unless_equals_int (gst_harness_push (setup->h, make_frame (frame, -1,
                NULL)), GST_FLOW_OK);
}

static inline void
flush (Setup * setup)
{
  gst_harness_push_event (setup->h, gst_event_new_flush_start ());
  gst_harness_push_event (setup->h, gst_event_new_flush_stop (TRUE));
}

static inline void
begin_segment (Setup * setup)
{
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (setup->h, gst_event_new_segment (&segment));
}

/* The next message of a type; for ours, of a name. */
static inline GstMessage *
find_message (Setup * setup, GstMessageType type, const gchar * name)
{
  GstMessage *message;

  while ((message = gst_bus_pop_filtered (setup->bus, type))) {
    const GstStructure *structure = gst_message_get_structure (message);

    if (!name || gst_structure_has_name (structure, name))
      return message;
    gst_message_unref (message);
  }
  return NULL;
}

static inline void
expect (Setup * setup, GstMessageType type, const gchar * text)
{
  g_autoptr (GstMessage) message = find_message (setup, type, NULL);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL, *all = NULL;

  fail_unless (message != NULL, "no message; expected: %s", text);
  if (type == GST_MESSAGE_ERROR)
    gst_message_parse_error (message, &error, &debug);
  else
    gst_message_parse_warning (message, &error, &debug);
  all = g_strconcat (error->message, " ", debug, NULL);
  fail_unless (strstr (all, text) != NULL, "\"%s\" lacks \"%s\"", all, text);
}

/* Takes the events that came out; whether an EOS or one of that @name is among them. */
static inline gboolean
pull_events (Setup * setup, const gchar * name)
{
  gboolean seen = FALSE;
  GstEvent *event;

  while ((event = gst_harness_try_pull_event (setup->h))) {
    seen |= name ? gst_event_has_name (event, name) :
        GST_EVENT_TYPE (event) == GST_EVENT_EOS;
    gst_event_unref (event);
  }
  return seen;
}

/* Takes the meshes that came out; so many in all, and with a gap. */
static inline void
expect_meshes (Setup * setup, guint n, guint with_gap)
{
  guint n_out = 0, n_with_gap = 0;
  GstBuffer *buffer;

  while ((buffer = gst_harness_try_pull (setup->h))) {
    n_with_gap += gst_buffer_get_cloth_gap (buffer) != NULL;
    n_out++;
    gst_buffer_unref (buffer);
  }
  fail_unless_equals_int (n_out, n);
  fail_unless_equals_int (n_with_gap, with_gap);
}

/* The next buffer is as @in was, which it takes. */
static inline void
expect_same (Setup * setup, GstBuffer * in)
{
  GstBuffer *out = gst_harness_pull (setup->h);
  GstMapInfo map;

  gst_buffer_map (in, &map, GST_MAP_READ);
  fail_unless_equals_int (gst_buffer_get_size (out), map.size);
  fail_unless_equals_int (gst_buffer_memcmp (out, 0, map.data, map.size), 0);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), GST_BUFFER_PTS (in));
  gst_buffer_unmap (in, &map);
  gst_buffer_unref (in);
  gst_buffer_unref (out);
}

static inline gdouble
mean_residual (GstBuffer * buffer, guint axis)
{
  GstClothGap *gap = gst_buffer_get_cloth_gap (buffer);
  const gfloat *r;
  gdouble sum = 0;
  guint n = 0;

  fail_unless (gap != NULL);
  r = gst_cloth_gap_get_residuals (gap, NULL);
  for (guint i = 0; i < N; i++) {
    if (isfinite (r[3 * i])) {
      sum += r[3 * i + axis];
      n++;
    }
  }
  return sum / n;
}

/* e(t) from rest for ζ = 0.5 */
static inline gdouble
oscillator (gdouble t)
{
  gdouble w = sqrt (GAIN * 0.75), decay = 0.5 * sqrt (GAIN);

  return ACCELERATION / GAIN * (1 - exp (-decay * t) * (cos (w * t) +
          decay / w * sin (w * t)));
}

/* Takes what came out, so many in all; from the @first on it is the oscillator from rest. */
static inline void
expect_oscillator (Setup * setup, guint first, guint n)
{
  guint n_out = 0;
  GstBuffer *buffer;

  while ((buffer = gst_harness_try_pull (setup->h))) {
    if (n_out >= first)
      fail_unless (fabs (mean_residual (buffer, 2) -
              oscillator ((gdouble) (n_out - first) / FPS)) < 0.0005);
    n_out++;
    gst_buffer_unref (buffer);
  }
  fail_unless_equals_int (n_out, n);
}
