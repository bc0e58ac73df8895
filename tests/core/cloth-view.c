/* What cameras saw of a mesh: payload, and a meta of which a buffer has one of each camera.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/cloth/cloth.h>

#include "tests/core/refused.h"

/* One dot at @x, of a camera that doesn't know its name. */
static GstClothView *
make_view (const gchar * camera, gfloat x)
{
  const GstClothDot dot = {.column = 1,.row = 0,.x = x,.y = 2 };
  g_autoptr (GstBuffer) picture = gst_buffer_new ();

  gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new (NULL, 5, 3, 2, 4,
          &dot, 1));
  return gst_cloth_view_new (camera, 5, gst_cloth_observations_pack (picture));
}

static gfloat
find_x (const GstClothView * view)
{
  g_autoptr (GstBuffer) picture = gst_buffer_new ();
  g_autoptr (GError) error = NULL;
  GstClothDot dot;

  gst_cloth_observations_unpack (gst_cloth_view_get_observation (view), picture,
      &error);
  g_assert_no_error (error);
  g_assert_true (gst_cloth_dots_get_dot (gst_buffer_get_cloth_dots (picture), 0,
          &dot));
  return dot.x;
}

/* The observation lives as long as its view, of which there may be many. */
static void
test_payload (void)
{
  GstBuffer *buffer = gst_buffer_new ();
  GstClothView *view = make_view ("left", 1), *same;

  g_assert_cmpstr (gst_cloth_view_get_camera (view), ==, "left");
  g_assert_cmpuint (gst_cloth_view_get_sequence (view), ==, 5);
  gst_buffer_add_cloth_view_meta (buffer, view);
  same = gst_cloth_view_ref (gst_buffer_get_cloth_view (buffer, "left"));
  gst_buffer_unref (buffer);
  g_assert_cmpfloat (find_x (same), ==, 1);
  gst_cloth_view_unref (same);
}

static void
test_misuse (void)
{
  g_autofree gchar *name = g_strnfill (GST_CLOTH_MAX_CAMERA_NAME + 1, 'c');
  g_autoptr (GstBuffer) observation = gst_buffer_new ();

  ASSERT_MISUSE (gst_cloth_view_new (name, 0, observation));
  ASSERT_MISUSE (gst_cloth_view_new ("\xff", 0, observation));
  ASSERT_MISUSE (gst_cloth_view_new (NULL, 0, observation));
  ASSERT_MISUSE (gst_cloth_view_new ("left", 0, NULL));
}

/* One of each camera; the second of a camera takes the place of its first. Copies of the whole mesh have
 * all, a part of it has none. */
static void
test_cameras (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new_allocate (NULL, 64, NULL);
  g_autoptr (GstBuffer) copy = NULL;
  g_autoptr (GstBuffer) part = NULL;

  g_assert_null (gst_buffer_get_cloth_view (buffer, NULL));
  g_assert_null (gst_buffer_get_nth_cloth_view (buffer, 0));
  gst_buffer_add_cloth_view_meta (buffer, make_view ("left", 1));
  gst_buffer_add_cloth_view_meta (buffer, make_view ("right", 2));
  gst_buffer_add_cloth_view_meta (buffer, make_view ("left", 3));
  copy = gst_buffer_copy (buffer);
  g_assert_cmpfloat (find_x (gst_buffer_get_cloth_view (copy, "left")), ==, 3);
  g_assert_cmpfloat (find_x (gst_buffer_get_cloth_view (copy, NULL)), ==, 3);
  g_assert_cmpfloat (find_x (gst_buffer_get_nth_cloth_view (copy, 1)), ==, 2);
  g_assert_null (gst_buffer_get_cloth_view (copy, "middle"));
  g_assert_null (gst_buffer_get_nth_cloth_view (copy, 2));
  part = gst_buffer_copy_region (buffer, GST_BUFFER_COPY_ALL, 0, 32);
  g_assert_null (gst_buffer_get_cloth_view (part, NULL));
}

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/cloth-view/payload", test_payload);
  g_test_add_func ("/cloth-view/misuse", test_misuse);
  g_test_add_func ("/cloth-view/cameras", test_cameras);
  return g_test_run ();
}
