/* Disparities and the stereo head that they share: payload, points, meta.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>
#include <math.h>
#include <string.h>

#include "tests/core/refused.h"

/* A picture of 3 by 2 pixels that looks askew at what it measures depth along. */
static const gdouble normal[3] = { 0, -0.6, 0.8 };

static const gdouble rotation[9] = { 0, -1, 0, 1, 0, 0, 0, 0, 1 };

static const gdouble translation[3] = { 0.25, -0.5, 2 };

static const gfloat rays[12] = { -0.5f, -0.25f, 0, -0.25f, 0.5f, -0.25f, -0.5f,
  0.25f, 0, 0.25f, NAN, NAN
};

#define FOCAL_BASELINE 142.22

static GstClothStereo *
make_stereo (void)
{
  return gst_cloth_stereo_new (3, 2, rays, 12, normal, FOCAL_BASELINE,
      rotation, translation, 3);
}

static void
test_stereo (void)
{
  g_autoptr (GstClothStereo) stereo = make_stereo ();
  guint n;

  g_assert_cmpuint (gst_cloth_stereo_get_width (stereo), ==, 3);
  g_assert_cmpuint (gst_cloth_stereo_get_height (stereo), ==, 2);
  g_assert_cmpuint (gst_cloth_stereo_get_n_cameras (stereo), ==, 3);
  g_assert_true (gst_cloth_stereo_get_focal_baseline (stereo) ==
      FOCAL_BASELINE);
  g_assert_cmpmem (gst_cloth_stereo_get_rays (stereo, &n), sizeof rays, rays,
      sizeof rays);
  g_assert_cmpuint (n, ==, 12);
  g_assert_cmpmem (gst_cloth_stereo_get_normal (stereo), sizeof normal, normal,
      sizeof normal);
  g_assert_cmpmem (gst_cloth_stereo_get_rotation (stereo), sizeof rotation,
      rotation, sizeof rotation);
  g_assert_cmpmem (gst_cloth_stereo_get_translation (stereo),
      sizeof translation, translation, sizeof translation);
}

static void
test_stereo_misuse (void)
{
  const gdouble long_normal[3] = { 0, 1, 1 }, no_normal[3] = { 0, 0, NAN };
  gdouble bad[9];

#define NEW(width, height, rays, n, normal, fb, rotation, translation, cameras) \
  gst_cloth_stereo_new (width, height, rays, n, normal, fb, rotation, \
      translation, cameras)
  memcpy (bad, rotation, sizeof bad);
  bad[1] = INFINITY;
  ASSERT_MISUSE (NEW (0, 2, rays, 0, normal, 1, rotation, translation, 2));
  ASSERT_MISUSE (NEW (3, 0, rays, 0, normal, 1, rotation, translation, 2));
  ASSERT_MISUSE (NEW (16385, 1, rays, 32770, normal, 1, rotation, translation,
          2));
  ASSERT_MISUSE (NEW (4097, 4096, rays, 2 * 4097 * 4096, normal, 1, rotation,
          translation, 2));
  ASSERT_MISUSE (NEW (65536, 65536, rays, 0, normal, 1, rotation, translation,
          2));
  ASSERT_MISUSE (NEW (3, 2, rays, 11, normal, 1, rotation, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, NULL, 12, normal, 1, rotation, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, NULL, 1, rotation, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, long_normal, 1, rotation, translation,
          2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, no_normal, 1, rotation, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, normal, 0, rotation, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, normal, NAN, rotation, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, normal, 1, bad, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, normal, 1, NULL, translation, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, normal, 1, rotation, bad, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, normal, 1, rotation, NULL, 2));
  ASSERT_MISUSE (NEW (3, 2, rays, 12, normal, 1, rotation, translation, 1));
#undef NEW
}

/* A plane whose depth along the normal is 0.9 m, by the meeting of each ray with it. */
static void
test_points (void)
{
  const gdouble depth = 0.9;
  g_autoptr (GstClothStereo) stereo = make_stereo ();
  g_autoptr (GstClothDisparity) disparity = NULL;
  g_autoptr (GBytes) bytes = NULL;
  const guint8 states[6] = { 2, 3, 2, 1, 2, 2 };
  gfloat disparities[6], points[18];

  for (guint i = 0; i < 6; i++)
    disparities[i] = (gfloat) (FOCAL_BASELINE / depth);
  disparity = gst_cloth_disparity_new ("cam0", 1, stereo, 0.5f, disparities, 6,
      states, 6);
  gst_cloth_disparity_get_points (disparity, points);
  for (guint i = 0; i < 3; i++) {
    const gdouble x = rays[2 * i], y = rays[2 * i + 1];
    const gdouble s = depth / (normal[1] * y + normal[2]);

    g_assert_cmpfloat_with_epsilon (points[3 * i], s * x, 1e-6);
    g_assert_cmpfloat_with_epsilon (points[3 * i + 1], s * y, 1e-6);
    g_assert_cmpfloat_with_epsilon (points[3 * i + 2], s, 1e-6);
    g_assert_cmpfloat_with_epsilon (points[3 * i + 1] * normal[1]
        + points[3 * i + 2] * normal[2], depth, 1e-6);
  }
  g_assert_true (isnan (points[9]) && isnan (points[11]));      /* a hole */
  g_assert_false (isnan (points[12]));
  g_assert_true (isnan (points[15]) && isnan (points[17]));     /* sees nothing */
  bytes = gst_cloth_disparity_dup_points (disparity);
  g_assert_cmpmem (g_bytes_get_data (bytes, NULL), g_bytes_get_size (bytes),
      points, sizeof points);
}

/* A ray that meets the plane behind the camera has no point. */
static void
test_behind (void)
{
  const gdouble away[3] = { 0, 0, -1 };
  const gfloat one[2] = { 0.25f, 0.5f }, ten = 10;
  const guint8 measured = GST_CLOTH_DISPARITY_MEASURED;
  g_autoptr (GstClothStereo) stereo = gst_cloth_stereo_new (1, 1, one, 2, away,
      1, rotation, translation, 2);
  g_autoptr (GstClothDisparity) disparity = gst_cloth_disparity_new (NULL, 0,
      stereo, NAN, &ten, 1, &measured, 1);
  gfloat point[3];

  gst_cloth_disparity_get_points (disparity, point);
  g_assert_true (isnan (point[0]) && isnan (point[1]) && isnan (point[2]));
}

static void
test_payload (void)
{
  g_autoptr (GstClothStereo) stereo = make_stereo ();
  const gfloat given[6] = { 10, NAN, 0, 4, INFINITY, 20.5f };
  const guint8 states[6] = { GST_CLOTH_DISPARITY_MEASURED,
    GST_CLOTH_DISPARITY_MEASURED, GST_CLOTH_DISPARITY_FILLED,
    GST_CLOTH_DISPARITY_HOLE, 77, GST_CLOTH_DISPARITY_FILLED
  };
  const guint8 expected[6] = { GST_CLOTH_DISPARITY_MEASURED,
    GST_CLOTH_DISPARITY_HOLE, GST_CLOTH_DISPARITY_HOLE,
    GST_CLOTH_DISPARITY_HOLE, GST_CLOTH_DISPARITY_OUTSIDE,
    GST_CLOTH_DISPARITY_FILLED
  };
  g_autoptr (GstClothDisparity) disparity = gst_cloth_disparity_new ("cam0",
      G_MAXUINT64, stereo, 0.25f, given, 6, states, 6);
  g_autofree gchar *name = g_strnfill (GST_CLOTH_MAX_CAMERA_NAME + 1, 'c');
  const gfloat *disparities;
  guint n;

  g_assert_cmpstr (gst_cloth_disparity_get_camera (disparity), ==, "cam0");
  g_assert_cmpuint (gst_cloth_disparity_get_sequence (disparity), ==,
      G_MAXUINT64);
  g_assert_cmpuint (gst_cloth_disparity_get_width (disparity), ==, 3);
  g_assert_cmpuint (gst_cloth_disparity_get_height (disparity), ==, 2);
  g_assert_true (gst_cloth_disparity_get_stereo (disparity) == stereo);
  g_assert_true (gst_cloth_disparity_get_sigma (disparity) == 0.25f);
  disparities = gst_cloth_disparity_get_disparities (disparity, &n);
  g_assert_cmpuint (n, ==, 6);
  g_assert_true (disparities[0] == 10 && disparities[5] == 20.5f);
  for (guint i = 1; i < 5; i++)
    g_assert_true (isnan (disparities[i]));
  g_assert_cmpmem (gst_cloth_disparity_get_states (disparity, &n), 6, expected,
      sizeof expected);
  g_assert_cmpuint (n, ==, 6);

#define NEW(name, stereo, sigma, disparities, n, states, n_states) \
  gst_cloth_disparity_new (name, 0, stereo, sigma, disparities, n, states, \
      n_states)
  ASSERT_MISUSE (NEW (name, stereo, 1, given, 6, states, 6));
  ASSERT_MISUSE (NEW ("\xff", stereo, 1, given, 6, states, 6));
  ASSERT_MISUSE (NEW (NULL, NULL, 1, given, 6, states, 6));
  ASSERT_MISUSE (NEW (NULL, stereo, -1, given, 6, states, 6));
  ASSERT_MISUSE (NEW (NULL, stereo, INFINITY, given, 6, states, 6));
  ASSERT_MISUSE (NEW (NULL, stereo, 1, given, 5, states, 6));
  ASSERT_MISUSE (NEW (NULL, stereo, 1, given, 6, states, 7));
  ASSERT_MISUSE (NEW (NULL, stereo, 1, NULL, 6, states, 6));
  ASSERT_MISUSE (NEW (NULL, stereo, 1, given, 6, NULL, 6));
#undef NEW
}

/* Copies and scaled pictures hold the same payload; the stereo head lives as long as the last
 * of them, which the sanitizers look after. */
static void
test_meta (void)
{
  const gfloat disparities[6] = { 1, 2, 3, 4, 5, 6 };
  const guint8 states[6] = { 2, 2, 2, 2, 2, 2 };
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) copy = NULL;
  g_autoptr (GstBuffer) scaled = gst_buffer_new ();
  GstClothStereo *stereo = make_stereo ();
  GstClothDisparity *disparity = gst_cloth_disparity_new ("cam0", 1, stereo, 1,
      disparities, 6, states, 6);
  GstVideoInfo in, out;
  GstVideoMetaTransform transform = { &in, &out };
  GstMeta *meta;

  g_assert_null (gst_buffer_get_cloth_disparity (buffer));
  gst_buffer_add_cloth_disparity_meta (buffer, gst_cloth_disparity_new (NULL, 0,
          stereo, 1, disparities, 6, states, 6));
  gst_buffer_add_cloth_disparity_meta (buffer, disparity);
  gst_cloth_stereo_unref (stereo);
  copy = gst_buffer_copy (buffer);
  g_assert_true (gst_buffer_get_cloth_disparity (copy) == disparity);

  gst_video_info_set_format (&in, GST_VIDEO_FORMAT_GRAY8, 3, 2);
  gst_video_info_set_format (&out, GST_VIDEO_FORMAT_GRAY8, 30, 10);
  out.par_d = 2;
  meta = gst_buffer_get_meta (buffer, gst_cloth_disparity_meta_api_get_type ());
  g_assert_true (meta->info->transform_func (scaled, meta, buffer,
          gst_video_meta_transform_scale_get_quark (), &transform));
  g_assert_true (gst_buffer_get_cloth_disparity (scaled) == disparity);
  g_assert_false (meta->info->transform_func (scaled, meta, buffer,
          g_quark_from_static_string ("gst-cloth-turned"), NULL));

  gst_clear_buffer (&buffer);
  gst_clear_buffer (&copy);
  g_assert_cmpuint (gst_cloth_stereo_get_n_cameras
      (gst_cloth_disparity_get_stereo (gst_buffer_get_cloth_disparity
              (scaled))), ==, 3);
}

/* Disparities stay where the picture is. */
static void
test_no_section (void)
{
  const gfloat disparities[6] = { 1, 2, 3, 4, 5, 6 };
  const guint8 states[6] = { 2, 2, 2, 2, 2, 2 };
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) bare = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstBuffer) expected = NULL;
  g_autoptr (GstClothStereo) stereo = make_stereo ();

  gst_buffer_add_cloth_disparity_meta (buffer, gst_cloth_disparity_new (NULL, 0,
          stereo, 1, disparities, 6, states, 6));
  packed = gst_cloth_observations_pack (buffer);
  expected = gst_cloth_observations_pack (bare);
  g_assert_cmpuint (gst_buffer_get_size (packed), ==,
      gst_buffer_get_size (expected));
}

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/cloth-disparity/stereo", test_stereo);
  g_test_add_func ("/cloth-disparity/stereo-misuse", test_stereo_misuse);
  g_test_add_func ("/cloth-disparity/points", test_points);
  g_test_add_func ("/cloth-disparity/behind", test_behind);
  g_test_add_func ("/cloth-disparity/payload", test_payload);
  g_test_add_func ("/cloth-disparity/meta", test_meta);
  g_test_add_func ("/cloth-disparity/no-section", test_no_section);
  return g_test_run ();
}
