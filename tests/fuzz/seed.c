/* Fuzz target: the square that is given to quadtrack as a text, and a picture with it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzzelements.h"

#include <string.h>

#define WIDTH 64
#define HEIGHT 48

/* Squares of 8 pixels. */
static GstBuffer *
make_picture (void)
{
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, WIDTH * HEIGHT, NULL);
  GstMapInfo map;

  g_assert_true (gst_buffer_map (buffer, &map, GST_MAP_WRITE));
  for (guint i = 0; i < WIDTH * HEIGHT; i++)
    map.data[i] = (i % WIDTH / 8 + i / WIDTH / 8) % 2 ? 220 : 30;
  gst_buffer_unmap (buffer, &map);
  GST_BUFFER_PTS (buffer) = 0;
  return buffer;
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };
  g_autofree gchar *text = fuzz_take_text (&bytes);
  GstElement *element;

  fuzz_elements_init ();
  element = gst_object_ref_sink (gst_element_factory_make ("quadtrack", NULL));
  g_object_set (element, "seed", text, "link", FALSE, "columns", 6, "rows", 4,
      NULL);
  if (gst_element_set_state (element, GST_STATE_PAUSED)
      != GST_STATE_CHANGE_FAILURE) {
    GstHarness *h = gst_harness_new_with_element (element, "sink", "src");

    gst_harness_set_src_caps_str (h, "video/x-raw,format=GRAY8,width=64,"
        "height=48,framerate=25/1");
    g_assert_cmpint (gst_harness_push (h, make_picture ()), ==, GST_FLOW_OK);
    gst_harness_teardown (h);
  }
  gst_element_set_state (element, GST_STATE_NULL);
  gst_object_unref (element);
  return 0;
}
