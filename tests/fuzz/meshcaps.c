/* Fuzz target: caps of a mesh stream, and a frame after them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzzelements.h"

#include <math.h>

/* More vertices than that fill the memory, not the branches. */
#define MAX_VERTICES 4096

static void
set_number (GstStructure * structure, const gchar * name, FuzzBytes * bytes,
    gint usual)
{
  switch (fuzz_take_byte (bytes) % 8) {
    case 0:
      break;
    case 1:
      gst_structure_set (structure, name, G_TYPE_INT,
          (gint) fuzz_take_long (bytes), NULL);
      break;
    case 2:
      gst_structure_set (structure, name, G_TYPE_STRING, "1", NULL);
      break;
    default:
      gst_structure_set (structure, name, G_TYPE_INT, usual, NULL);
      break;
  }
}

static void
set_rate (GstStructure * structure, FuzzBytes * bytes)
{
  gint n = (gint) fuzz_take_short (bytes), d = (gint) fuzz_take_short (bytes);

  /* GStreamer itself makes no fraction over 0. */
  if (fuzz_take_byte (bytes) % 4)
    gst_structure_set (structure, "framerate", GST_TYPE_FRACTION, n,
        MAX (d, 1), NULL);
}

/* What is left is the streamheader. */
static void
set_header (GstStructure * structure, FuzzBytes * bytes)
{
  guint kind = fuzz_take_byte (bytes) % 8;
  GstBuffer *buffer = bytes->size > 0 ?
      gst_buffer_new_memdup (bytes->data, bytes->size) : gst_buffer_new ();
  GValue array = G_VALUE_INIT, value = G_VALUE_INIT;

  g_value_init (&array, GST_TYPE_ARRAY);
  g_value_init (&value, kind == 1 ? G_TYPE_STRING : GST_TYPE_BUFFER);
  if (kind == 1)
    g_value_set_static_string (&value, "none");
  else
    gst_value_set_buffer (&value, buffer);
  for (guint i = 0; i < (kind == 2 ? 2 : 1); i++)
    gst_value_array_append_value (&array, &value);
  if (kind == 3)
    gst_structure_set_value (structure, "streamheader", &value);
  else if (kind != 4)
    gst_structure_set_value (structure, "streamheader", &array);
  g_value_unset (&value);
  g_value_unset (&array);
  gst_buffer_unref (buffer);
}

/* A mesh stream of these caps through an element, which may refuse it. */
static void
feed (GstCaps * caps, const GstClothTopology * topology)
{
  const guint n = gst_cloth_topology_get_n_vertices (topology);
  g_autofree gfloat *positions = g_new0 (gfloat, 3 * n);
  g_autofree guint8 *states = g_new0 (guint8, n);
  GstHarness *h = gst_harness_new ("meshfill");

  for (guint i = 0; i < n; i++) {
    states[i] = i % 3 ? GST_CLOTH_VERTEX_MEASURED : GST_CLOTH_VERTEX_UNSEEN;
    positions[3 * i] = i % 3 ? (gfloat) i : NAN;
  }
  gst_harness_set_src_caps (h, gst_caps_ref (caps));
  {
    g_autoptr (GstClothMesh) mesh =
        gst_cloth_mesh_new (0, n, positions, states, NULL);
    GstBuffer *buffer = gst_cloth_mesh_to_buffer (mesh);

    GST_BUFFER_PTS (buffer) = 0;
    gst_harness_push (h, buffer);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  gst_harness_teardown (h);
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothTopology) topology = NULL;
  GstStructure *structure;
  GstCaps *caps;

  fuzz_elements_init ();
  structure = gst_structure_new_empty (fuzz_take_byte (&bytes) % 16 ?
      GST_CLOTH_MESH_MEDIA_TYPE : "application/x-other");
  set_number (structure, "version", &bytes, 1);
  set_number (structure, "vertices", &bytes, (gint) fuzz_take_byte (&bytes));
  set_rate (structure, &bytes);
  set_header (structure, &bytes);
  caps = gst_caps_new_full (structure, NULL);
  topology = gst_cloth_topology_from_caps (caps, &error);
  g_assert_true ((topology == NULL) == (error != NULL));
  if (topology && gst_cloth_topology_get_n_vertices (topology) <= MAX_VERTICES)
    feed (caps, topology);
  gst_caps_unref (caps);
  return 0;
}
