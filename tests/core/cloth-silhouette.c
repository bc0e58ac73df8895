/* Silhouettes: payload, meta, changes of size, and their section of an observation.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>
#include <string.h>

#include "tests/core/refused.h"

/* The layout as docs/streams.md has it, written out by hand: three runs in a picture of 300
 * by 5 pixels. */
static const guint8 golden[] = {
  'G', 'C', 'O', 'B', 1, 0, 32, 0,      /*   0 magic, version, header */
  88, 0, 0, 0, 1, 0, 0, 0,      /*   8 size 88, sections */
  0, 0, 0, 0, 0, 0, 0, 0,       /*  16 PTS */
  0, 0, 0, 0, 0, 0, 0, 0,       /*  24 duration */
  'S', 'I', 'L', 'H', 48, 0, 0, 0,      /*  32 */
  9, 0, 0, 0, 0, 0, 0, 0,       /*  40 sequence */
  44, 1, 0, 0, 5, 0, 0, 0, 3, 0, 0, 0,  /*  48 columns, rows, runs */
  4, 0, 0, 0, 'c', 'a', 'm', '0',       /*  60 name's length, name */
  0, 0, 3, 0, 44, 1,            /*  68 row 0, 3 to 300 */
  4, 0, 0, 0, 1, 0,             /*  74 row 4, column 0 */
  4, 0, 7, 0, 9, 0, 0, 0,       /*  80 row 4, 7 to 9; filled up */
};

static const GstClothRun some_runs[] = { {0, 3, 300}, {4, 0, 1}, {4, 7, 9} };

static void
test_payload (void)
{
  g_autoptr (GstClothSilhouette) silhouette = gst_cloth_silhouette_new ("cam0",
      G_MAXUINT64, 300, 5, some_runs, 3);
  g_autoptr (GstClothSilhouette) none = gst_cloth_silhouette_new (NULL, 0, 1,
      1, NULL, 0);
  g_autoptr (GBytes) mask = gst_cloth_silhouette_get_mask (silhouette);
  GstClothRun run, *copy;
  const guint8 *bytes;
  gsize size, sum = 0;
  guint n;

  g_assert_cmpstr (gst_cloth_silhouette_get_camera (silhouette), ==, "cam0");
  g_assert_cmpuint (gst_cloth_silhouette_get_sequence (silhouette), ==,
      G_MAXUINT64);
  g_assert_cmpuint (gst_cloth_silhouette_get_width (silhouette), ==, 300);
  g_assert_cmpuint (gst_cloth_silhouette_get_height (silhouette), ==, 5);
  g_assert_cmpuint (gst_cloth_silhouette_get_n_runs (silhouette), ==, 3);
  g_assert_cmpuint (gst_cloth_silhouette_get_area (silhouette), ==, 300);
  g_assert_cmpmem (gst_cloth_silhouette_get_runs (silhouette, &n),
      3 * sizeof (GstClothRun), some_runs, sizeof some_runs);
  g_assert_cmpuint (n, ==, 3);
  g_assert_true (gst_cloth_silhouette_get_run (silhouette, 2, &run));
  g_assert_cmpuint (run.begin, ==, 7);
  g_assert_false (gst_cloth_silhouette_get_run (silhouette, 3, &run));
  copy = gst_cloth_run_copy (&run);
  g_assert_cmpuint (copy->end, ==, 9);
  gst_cloth_run_free (copy);

  bytes = g_bytes_get_data (mask, &size);
  g_assert_cmpuint (size, ==, 1500);
  for (gsize i = 0; i < size; i++)
    sum += bytes[i];
  g_assert_cmpuint (sum, ==, 300 * 255);
  g_assert_cmpuint (bytes[2], ==, 0);
  g_assert_cmpuint (bytes[3], ==, 255);
  g_assert_cmpuint (bytes[4 * 300 + 8], ==, 255);
  g_assert_cmpuint (bytes[4 * 300 + 9], ==, 0);

  g_assert_cmpstr (gst_cloth_silhouette_get_camera (none), ==, "");
  g_assert_cmpuint (gst_cloth_silhouette_get_area (none), ==, 0);
}

static void
test_misuse (void)
{
  static const GstClothRun bad[][2] = {
    {{5, 0, 1}, {5, 2, 3}}, {{0, 0, 301}, {1, 0, 1}}, {{0, 4, 4}, {1, 0, 1}},
    {{0, 5, 4}, {1, 0, 1}}, {{1, 0, 4}, {0, 0, 4}}, {{1, 0, 4}, {1, 3, 6}},
    {{1, 8, 9}, {1, 3, 6}}
  };
  static const GstClothRun touching[2] = { {1, 0, 4}, {1, 4, 6} };
  g_autofree gchar *name = g_strnfill (GST_CLOTH_MAX_CAMERA_NAME + 1, 'c');

  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    g_assert_false (gst_cloth_silhouette_runs_are_valid (300, 5, bad[i], 2));
    ASSERT_MISUSE (gst_cloth_silhouette_new (NULL, 0, 300, 5, bad[i], 2));
  }
  g_assert_true (gst_cloth_silhouette_runs_are_valid (300, 5, touching, 2));
  g_assert_true (gst_cloth_silhouette_runs_are_valid (16384, 16384, NULL, 0));
  ASSERT_MISUSE (gst_cloth_silhouette_new (NULL, 0, 0, 5, NULL, 0));
  ASSERT_MISUSE (gst_cloth_silhouette_new (NULL, 0, 5, 0, NULL, 0));
  ASSERT_MISUSE (gst_cloth_silhouette_new (NULL, 0, 16385, 5, NULL, 0));
  ASSERT_MISUSE (gst_cloth_silhouette_new (NULL, 0, 5, 16385, NULL, 0));
  ASSERT_MISUSE (gst_cloth_silhouette_new (NULL, 0, 5, 5, NULL, 1));
  ASSERT_MISUSE (gst_cloth_silhouette_new (name, 0, 5, 5, NULL, 0));
  ASSERT_MISUSE (gst_cloth_silhouette_new ("\xff", 0, 5, 5, NULL, 0));
}

/* Copies hold the same payload; scaled pictures as well, with the mask as it was. */
static void
test_meta (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) copy = NULL;
  g_autoptr (GstBuffer) scaled = gst_buffer_new ();
  GstClothSilhouette *silhouette =
      gst_cloth_silhouette_new ("cam0", 1, 300, 5, some_runs, 3), *found;
  GstVideoInfo in, out;
  GstVideoMetaTransform transform = { &in, &out };
  GstMeta *meta;

  g_assert_null (gst_buffer_get_cloth_silhouette (buffer));
  gst_buffer_add_cloth_silhouette_meta (buffer,
      gst_cloth_silhouette_new (NULL, 1, 2, 3, NULL, 0));
  gst_buffer_add_cloth_silhouette_meta (buffer, silhouette);
  copy = gst_buffer_copy (buffer);
  g_assert_true (gst_buffer_get_cloth_silhouette (copy) == silhouette);

  gst_video_info_set_format (&in, GST_VIDEO_FORMAT_GRAY8, 300, 5);
  gst_video_info_set_format (&out, GST_VIDEO_FORMAT_GRAY8, 150, 10);
  out.par_n = 4;
  meta = gst_buffer_get_meta (buffer,
      gst_cloth_silhouette_meta_api_get_type ());
  g_assert_true (meta->info->transform_func (scaled, meta, buffer,
          gst_video_meta_transform_scale_get_quark (), &transform));
  found = gst_buffer_get_cloth_silhouette (scaled);
  g_assert_nonnull (found);
  g_assert_cmpuint (gst_cloth_silhouette_get_width (found), ==, 300);
  g_assert_cmpuint (gst_cloth_silhouette_get_area (found), ==, 300);
  g_assert_false (meta->info->transform_func (scaled, meta, buffer,
          g_quark_from_static_string ("gst-cloth-turned"), NULL));
}

static void
test_section (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  GstClothSilhouette *found;
  GError *error = NULL;
  GstMapInfo map;
  guint n;

  GST_BUFFER_PTS (buffer) = GST_BUFFER_DURATION (buffer) = 0;
  gst_buffer_add_cloth_silhouette_meta (buffer,
      gst_cloth_silhouette_new ("cam0", 9, 300, 5, some_runs, 3));
  packed = gst_cloth_observations_pack (buffer);
  g_assert_true (gst_buffer_map (packed, &map, GST_MAP_READ));
  g_assert_cmpmem (map.data, map.size, golden, sizeof golden);
  gst_buffer_unmap (packed, &map);

  g_assert_true (gst_cloth_observations_unpack (packed, target, &error));
  g_assert_no_error (error);
  found = gst_buffer_get_cloth_silhouette (target);
  g_assert_cmpstr (gst_cloth_silhouette_get_camera (found), ==, "cam0");
  g_assert_cmpuint (gst_cloth_silhouette_get_sequence (found), ==, 9);
  g_assert_cmpuint (gst_cloth_silhouette_get_width (found), ==, 300);
  g_assert_cmpuint (gst_cloth_silhouette_get_height (found), ==, 5);
  g_assert_cmpmem (gst_cloth_silhouette_get_runs (found, &n),
      3 * sizeof (GstClothRun), some_runs, sizeof some_runs);
}

static void
test_section_refused (void)
{
  typedef struct
  {
    guint at;
    guint8 value;
    gint code;
    const gchar *name;
  } Change;
  static const Change changes[] = {
    {49, 0x41, GST_CLOTH_ERROR_LIMIT, "too wide"},
    {53, 0x41, GST_CLOTH_ERROR_LIMIT, "too high"},
    {58, 0x11, GST_CLOTH_ERROR_LIMIT, "too many runs"},
    {56, 4, GST_CLOTH_ERROR_TRUNCATED, "one more run"},
    {57, 1, GST_CLOTH_ERROR_TRUNCATED, "more runs than bytes"},
    {56, 1, GST_CLOTH_ERROR_VALUE, "fewer runs than bytes"},
    {49, 0, GST_CLOTH_ERROR_VALUE, "beyond the last column"},
    {52, 4, GST_CLOTH_ERROR_VALUE, "beyond the last row"},
    {52, 0, GST_CLOTH_ERROR_VALUE, "no rows"},
    {78, 0, GST_CLOTH_ERROR_VALUE, "an empty run"},
    {78, 8, GST_CLOTH_ERROR_VALUE, "overlapping runs"},
    {80, 3, GST_CLOTH_ERROR_VALUE, "a row that comes too late"},
    {64, 0xff, GST_CLOTH_ERROR_VALUE, "a name that is not UTF-8"},
    {60, 200, GST_CLOTH_ERROR_TRUNCATED, "a name beyond the end"}
  };
  guint8 bytes[sizeof golden + 56];

  for (guint i = 0; i < G_N_ELEMENTS (changes); i++) {
    memcpy (bytes, golden, sizeof golden);
    bytes[changes[i].at] = changes[i].value;
    assert_refused (bytes, sizeof golden, changes[i].code, changes[i].name);
  }
  for (gsize size = 0; size < sizeof golden; size += 4)
    assert_refused (golden, size, GST_CLOTH_ERROR_TRUNCATED, "the beginning");

  /* the same section twice */
  memcpy (bytes, golden, sizeof golden);
  memcpy (bytes + sizeof golden, golden + 32, 56);
  bytes[8] = sizeof bytes;
  bytes[12] = 2;
  assert_refused (bytes, sizeof bytes, GST_CLOTH_ERROR_VALUE, "two of them");
}

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/cloth-silhouette/payload", test_payload);
  g_test_add_func ("/cloth-silhouette/misuse", test_misuse);
  g_test_add_func ("/cloth-silhouette/meta", test_meta);
  g_test_add_func ("/cloth-silhouette/section", test_section);
  g_test_add_func ("/cloth-silhouette/section-refused", test_section_refused);
  return g_test_run ();
}
