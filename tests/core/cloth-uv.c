/* Maps of places: payload, and a meta of which a buffer has one of each camera.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>
#include <math.h>

#include "tests/core/refused.h"

static const gfloat given[12] = { 0.1f, 0.2f, NAN, 0.2f, 0.3f, INFINITY, 0, 0,
  -1, 4, NAN, NAN
};

static GstClothUV *
make_uv (const gchar * camera)
{
  return gst_cloth_uv_new (camera, 7, 3, 2, given, 12);
}

static void
test_payload (void)
{
  GstClothUV *uv = make_uv ("cam0");
  const gfloat *places;
  g_autoptr (GBytes) map = NULL;
  guint n;

  g_assert_cmpstr (gst_cloth_uv_get_camera (uv), ==, "cam0");
  g_assert_cmpuint (gst_cloth_uv_get_sequence (uv), ==, 7);
  g_assert_cmpuint (gst_cloth_uv_get_width (uv), ==, 3);
  g_assert_cmpuint (gst_cloth_uv_get_height (uv), ==, 2);
  places = gst_cloth_uv_get_uv (uv, &n);
  g_assert_cmpuint (n, ==, 12);
  for (guint i = 0; i < 12; i++)
    if (i / 2 == 1 || i / 2 == 2 || i / 2 == 5)
      g_assert_true (isnan (places[i]));
    else
      g_assert_true (places[i] == given[i]);
  map = gst_cloth_uv_get_map (uv);
  gst_cloth_uv_unref (uv);
  g_assert_cmpuint (g_bytes_get_size (map), ==, 48);
  g_assert_true (((const gfloat *) g_bytes_get_data (map, NULL))[9] == 4);
}

static void
test_misuse (void)
{
  g_autofree gchar *name = g_strnfill (GST_CLOTH_MAX_CAMERA_NAME + 1, 'c');

  ASSERT_MISUSE (gst_cloth_uv_new (name, 0, 3, 2, given, 12));
  ASSERT_MISUSE (gst_cloth_uv_new ("\xff", 0, 3, 2, given, 12));
  ASSERT_MISUSE (gst_cloth_uv_new (NULL, 0, 3, 2, given, 11));
  ASSERT_MISUSE (gst_cloth_uv_new (NULL, 0, 3, 2, NULL, 12));
  ASSERT_MISUSE (gst_cloth_uv_new (NULL, 0, 0, 2, given, 0));
  ASSERT_MISUSE (gst_cloth_uv_new (NULL, 0, 2, 0, given, 0));
  ASSERT_MISUSE (gst_cloth_uv_new (NULL, 0, 16385, 1, given, 32770));
  ASSERT_MISUSE (gst_cloth_uv_new (NULL, 0, 4097, 4096, given,
          2 * 4097 * 4096));
  ASSERT_MISUSE (gst_cloth_uv_new (NULL, 0, 65536, 65536, given, 0));
}

/* One of each camera, in the order in which they came; the second of a camera takes the place
 * of its first. Copies have all. */
static void
test_cameras (void)
{
  static const gchar *names[] = { "left", "middle", "right" };
  GstClothUV *uvs[3], *again = make_uv ("middle");
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) copy = NULL;

  g_assert_null (gst_buffer_get_cloth_uv (buffer, NULL));
  g_assert_null (gst_buffer_get_cloth_uv (buffer, "left"));
  g_assert_null (gst_buffer_get_nth_cloth_uv (buffer, 0));
  for (guint i = 0; i < 3; i++)
    gst_buffer_add_cloth_uv_meta (buffer, uvs[i] = make_uv (names[i]));
  gst_buffer_add_cloth_uv_meta (buffer, again);
  uvs[1] = again;

  copy = gst_buffer_copy (buffer);
  for (guint i = 0; i < 3; i++) {
    g_assert_true (gst_buffer_get_cloth_uv (buffer, names[i]) == uvs[i]);
    g_assert_true (gst_buffer_get_nth_cloth_uv (buffer, i) == uvs[i]);
    g_assert_true (gst_buffer_get_cloth_uv (copy, names[i]) == uvs[i]);
    g_assert_true (gst_buffer_get_nth_cloth_uv (copy, i) == uvs[i]);
  }
  g_assert_true (gst_buffer_get_cloth_uv (copy, NULL) == uvs[0]);
  g_assert_null (gst_buffer_get_cloth_uv (copy, "Left"));
  g_assert_null (gst_buffer_get_cloth_uv (copy, ""));
  g_assert_null (gst_buffer_get_nth_cloth_uv (copy, 3));
}

/* A camera without a name is one, too. */
static void
test_no_name (void)
{
  GstClothUV *uv = make_uv (""), *left = make_uv ("left");
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();

  gst_buffer_add_cloth_uv_meta (buffer, make_uv (NULL));
  gst_buffer_add_cloth_uv_meta (buffer, left);
  gst_buffer_add_cloth_uv_meta (buffer, uv);
  g_assert_true (gst_buffer_get_cloth_uv (buffer, "") == uv);
  g_assert_true (gst_buffer_get_cloth_uv (buffer, "left") == left);
  g_assert_null (gst_buffer_get_nth_cloth_uv (buffer, 2));
}

/* It is of a mesh: a part of the buffer, or a picture of another size, has none. */
static void
test_whole_buffers (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new_allocate (NULL, 64, NULL);
  g_autoptr (GstBuffer) part = NULL;
  GstVideoInfo in, out;
  GstVideoMetaTransform transform = { &in, &out };
  GstMeta *meta;

  gst_buffer_add_cloth_uv_meta (buffer, make_uv ("left"));
  part = gst_buffer_copy_region (buffer, GST_BUFFER_COPY_ALL, 0, 32);
  g_assert_null (gst_buffer_get_cloth_uv (part, NULL));
  gst_video_info_set_format (&in, GST_VIDEO_FORMAT_GRAY8, 3, 2);
  gst_video_info_set_format (&out, GST_VIDEO_FORMAT_GRAY8, 30, 10);
  meta = gst_buffer_get_meta (buffer, gst_cloth_uv_meta_api_get_type ());
  g_assert_false (meta->info->transform_func (part, meta, buffer,
          gst_video_meta_transform_scale_get_quark (), &transform));
  g_assert_null (gst_buffer_get_cloth_uv (part, NULL));
}

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/cloth-uv/payload", test_payload);
  g_test_add_func ("/cloth-uv/misuse", test_misuse);
  g_test_add_func ("/cloth-uv/cameras", test_cameras);
  g_test_add_func ("/cloth-uv/no-name", test_no_name);
  g_test_add_func ("/cloth-uv/whole-buffers", test_whole_buffers);
  return g_test_run ();
}
