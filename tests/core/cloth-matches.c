/* Matches: payload, meta, changes of size, and their section of an observation.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>
#include <math.h>
#include <string.h>

#include "tests/core/refused.h"

/* The layout as docs/streams.md has it, written out by hand: two matches and two vertices of
 * a grid of 35 by 33. */
static const guint8 golden[] = {
  'G', 'C', 'O', 'B', 1, 0, 32, 0,      /*   0 magic, version, header */
  204, 0, 0, 0, 1, 0, 0, 0,     /*   8 size 204, sections */
  0, 0, 0, 0, 0, 0, 0, 0,       /*  16 PTS */
  0, 0, 0, 0, 0, 0, 0, 0,       /*  24 duration */
  'M', 'T', 'C', 'H', 164, 0, 0, 0,     /*  32 */
  9, 0, 0, 0, 0, 0, 0, 0,       /*  40 sequence */
  35, 0, 0, 0, 33, 0, 0, 0,     /*  48 columns, rows */
  7, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0,   /*  56 features, matches, vertices */
  4, 0, 1, 0, 'c', 'a', 'm', '0',       /*  68 name's length, surface, name */
  0, 0, 0x28, 0x41, 0, 0, 0xa0, 0x40,   /*  76 10.5, 5 px */
  0, 0, 0x80, 0x3e, 0, 0, 0, 0x3f,      /*  84 0.25, 0.5 m */
  0, 0, 0, 0x40, 0, 0, 0xc8, 0x42,      /*  92 2 px, 100 */
  5, 0, 0, 0, 1, 0, 1, 0,       /* 100 group 5, oblique, verified */
  0, 0, 0x80, 0x3f, 0, 0, 0, 0, /* 108 1, 0 px */
  0, 0, 0, 0, 0, 0, 0, 0,       /* 116 0, 0 m */
  0, 0, 0x80, 0x3f, 0, 0, 0, 0, /* 124 1 px, 0 */
  0xff, 0xff, 0xff, 0xff, 0, 1, 0, 0,   /* 132 the last group, mirrored */
  34, 0, 0, 0, 32, 0, 0, 0, 1, 0, 0, 0, /* 140 column, row, mirrored */
  0, 0, 0x40, 0x40, 0, 0, 0x80, 0x40,   /* 152 3, 4 px */
  0, 0, 0x80, 0x3e, 0, 0, 0, 0xbe, 0, 0, 0x80, 0x3f,    /* 160 .25, −.125, 1 px² */
  0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0,   /* 172 column 0, row 1 */
  0, 0, 0, 0, 0, 0, 0, 0,       /* 184 0, 0 px */
  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0    /* 192 */
};

static const GstClothMatch some_matches[] = {
  {.x = 10.5f,.y = 5,.u = 0.25f,.v = 0.5f,.scale = 2,.distance = 100,
      .group = 5,.oblique = TRUE,.verified = TRUE},
  {.x = 1,.scale = 1,.group = G_MAXUINT,.mirrored = TRUE}
};

static const GstClothGridPoint some_points[] = {
  {.column = 34,.row = 32,.mirrored = TRUE,.x = 3,.y = 4,.cov_xx = 0.25f,
      .cov_xy = -0.125f,.cov_yy = 1},
  {.column = 0,.row = 1}
};

static GstClothMatches *
make_matches (void)
{
  return gst_cloth_matches_new ("cam0", 9, 35, 33, 7, TRUE, some_matches, 2,
      some_points, 2);
}

static void
assert_same (const GstClothMatches * matches)
{
  guint n;

  g_assert_cmpstr (gst_cloth_matches_get_camera (matches), ==, "cam0");
  g_assert_cmpuint (gst_cloth_matches_get_sequence (matches), ==, 9);
  g_assert_cmpuint (gst_cloth_matches_get_columns (matches), ==, 35);
  g_assert_cmpuint (gst_cloth_matches_get_rows (matches), ==, 33);
  g_assert_cmpuint (gst_cloth_matches_get_n_features (matches), ==, 7);
  g_assert_true (gst_cloth_matches_get_on_surface (matches));
  g_assert_cmpuint (gst_cloth_matches_get_n_matches (matches), ==, 2);
  g_assert_cmpuint (gst_cloth_matches_get_n_points (matches), ==, 2);
  g_assert_cmpmem (gst_cloth_matches_get_matches (matches, &n),
      2 * sizeof (GstClothMatch), some_matches, sizeof some_matches);
  g_assert_cmpuint (n, ==, 2);
  g_assert_cmpmem (gst_cloth_matches_get_points (matches, &n),
      2 * sizeof (GstClothGridPoint), some_points, sizeof some_points);
  g_assert_cmpuint (n, ==, 2);
}

static void
test_payload (void)
{
  g_autoptr (GstClothMatches) matches = make_matches ();
  g_autoptr (GstClothMatches) none = gst_cloth_matches_new (NULL, 0, 0, 0, 0,
      FALSE, NULL, 0, NULL, 0);
  g_autoptr (GBytes) table = gst_cloth_matches_get_table (matches);
  const gfloat expected[14] = { 10.5f, 5, 0.25f, 0.5f, 2, 100, 1, 1, 0, 0, 0,
    1, 0, 0
  };
  GstClothMatch match, *copy;
  GstClothGridPoint point, *point_copy;

  assert_same (matches);
  g_assert_true (gst_cloth_matches_get_match (matches, 1, &match));
  g_assert_cmpuint (match.group, ==, G_MAXUINT);
  g_assert_false (gst_cloth_matches_get_match (matches, 2, &match));
  copy = gst_cloth_match_copy (&match);
  g_assert_true (copy->mirrored);
  gst_cloth_match_free (copy);
  g_assert_true (gst_cloth_matches_get_point (matches, 0, &point));
  g_assert_cmpint (point.column, ==, 34);
  g_assert_false (gst_cloth_matches_get_point (matches, 2, &point));
  point_copy = gst_cloth_grid_point_copy (&point);
  g_assert_cmpint (point_copy->row, ==, 32);
  gst_cloth_grid_point_free (point_copy);
  g_assert_cmpmem (g_bytes_get_data (table, NULL), g_bytes_get_size (table),
      expected, sizeof expected);

  g_assert_cmpstr (gst_cloth_matches_get_camera (none), ==, "");
  g_assert_false (gst_cloth_matches_get_on_surface (none));
  g_assert_cmpuint (gst_cloth_matches_get_n_matches (none), ==, 0);
}

static void
test_misuse (void)
{
  const guint over = GST_CLOTH_MAX_FEATURES + 1;
  g_autofree gchar *name = g_strnfill (GST_CLOTH_MAX_CAMERA_NAME + 1, 'c');
  g_autofree GstClothMatch *many = g_new0 (GstClothMatch, over);
  g_autofree GstClothGridPoint *points = g_new0 (GstClothGridPoint, over);

#define NEW(name, columns, rows, features, matches, n, points, n_points) \
  gst_cloth_matches_new (name, 0, columns, rows, features, FALSE, matches, n, \
      points, n_points)
  ASSERT_MISUSE (NEW (name, 1, 1, 0, NULL, 0, NULL, 0));
  ASSERT_MISUSE (NEW ("\xff", 1, 1, 0, NULL, 0, NULL, 0));
  ASSERT_MISUSE (NEW (NULL, over, 1, 0, NULL, 0, NULL, 0));
  ASSERT_MISUSE (NEW (NULL, 1, over, 0, NULL, 0, NULL, 0));
  ASSERT_MISUSE (NEW (NULL, 1, 1, over, NULL, 0, NULL, 0));
  ASSERT_MISUSE (NEW (NULL, 1, 1, 0, NULL, 1, NULL, 0));
  ASSERT_MISUSE (NEW (NULL, 1, 1, 0, NULL, 0, NULL, 1));
  ASSERT_MISUSE (NEW (NULL, 1, 1, 0, many, over, NULL, 0));
  ASSERT_MISUSE (NEW (NULL, 1, 1, 0, NULL, 0, points, over));
#undef NEW
}

/* Copies hold the same payload; in a scaled picture the places and covariances are in its
 * pixels, and what is on the cloth stays. */
static void
test_meta (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) copy = NULL;
  g_autoptr (GstBuffer) scaled = gst_buffer_new ();
  GstClothMatches *matches = make_matches (), *found;
  GstVideoInfo in, out;
  GstVideoMetaTransform transform = { &in, &out };
  GstClothMatch match;
  GstClothGridPoint point;
  GstMeta *meta;

  g_assert_null (gst_buffer_get_cloth_matches (buffer));
  gst_buffer_add_cloth_matches_meta (buffer,
      gst_cloth_matches_new (NULL, 1, 2, 3, 0, FALSE, NULL, 0, NULL, 0));
  gst_buffer_add_cloth_matches_meta (buffer, matches);
  copy = gst_buffer_copy (buffer);
  g_assert_true (gst_buffer_get_cloth_matches (copy) == matches);

  gst_video_info_set_format (&in, GST_VIDEO_FORMAT_GRAY8, 300, 5);
  gst_video_info_set_format (&out, GST_VIDEO_FORMAT_GRAY8, 150, 40);
  out.par_n = 16;
  meta = gst_buffer_get_meta (buffer, gst_cloth_matches_meta_api_get_type ());
  g_assert_true (meta->info->transform_func (scaled, meta, buffer,
          gst_video_meta_transform_scale_get_quark (), &transform));
  found = gst_buffer_get_cloth_matches (scaled);
  g_assert_nonnull (found);
  g_assert_true (gst_cloth_matches_get_match (found, 0, &match));
  g_assert_true (match.x == 5 && match.y == 43.5f);
  g_assert_true (match.u == 0.25f && match.v == 0.5f);
  g_assert_true (match.distance == 100 && match.scale == 4);
  g_assert_true (match.verified && match.oblique && !match.mirrored);
  g_assert_true (gst_cloth_matches_get_point (found, 0, &point));
  g_assert_true (point.x == 1.25f && point.y == 35.5f);
  g_assert_true (point.cov_xx == 0.0625f && point.cov_xy == -0.5f
      && point.cov_yy == 64);
  g_assert_cmpint (point.column, ==, 34);
  assert_same (matches);
  g_assert_false (meta->info->transform_func (scaled, meta, buffer,
          g_quark_from_static_string ("gst-cloth-turned"), NULL));
}

static void
test_section (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  GError *error = NULL;
  GstMapInfo map;

  GST_BUFFER_PTS (buffer) = GST_BUFFER_DURATION (buffer) = 0;
  gst_buffer_add_cloth_matches_meta (buffer, make_matches ());
  packed = gst_cloth_observations_pack (buffer);
  g_assert_true (gst_buffer_map (packed, &map, GST_MAP_READ));
  g_assert_cmpmem (map.data, map.size, golden, sizeof golden);
  gst_buffer_unmap (packed, &map);

  g_assert_true (gst_cloth_observations_unpack (packed, target, &error));
  g_assert_no_error (error);
  assert_same (gst_buffer_get_cloth_matches (target));
}

/* What no reader would take is not written: the rest is. */
static void
test_left_out (void)
{
  GstClothMatch matches[8];
  GstClothGridPoint points[9];
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  GError *error = NULL;
  GstClothMatches *found;
  GstClothGridPoint point;
  gfloat *floats[6] = { &matches[1].x, &matches[2].y, &matches[3].u,
    &matches[4].v, &matches[5].scale, &matches[6].distance
  };

  for (guint i = 0; i < G_N_ELEMENTS (matches); i++)
    matches[i] = some_matches[0];
  for (guint i = 0; i < G_N_ELEMENTS (floats); i++)
    *floats[i] = i % 2 ? INFINITY : NAN;
  for (guint i = 0; i < G_N_ELEMENTS (points); i++)
    points[i] = some_points[0];
  points[1].x = 99;             /* at the place of the one before */
  points[2].column = 35;
  points[3].row = 33;
  points[4].column = -1;
  points[5].row = G_MININT;
  points[6].cov_xy = NAN;
  points[7].x = -INFINITY;
  points[8].column = 0;
  gst_buffer_add_cloth_matches_meta (buffer, gst_cloth_matches_new ("cam0", 9,
          35, 33, 8, FALSE, matches, 8, points, 9));
  packed = gst_cloth_observations_pack (buffer);
  g_assert_true (gst_cloth_observations_unpack (packed, target, &error));
  g_assert_no_error (error);
  found = gst_buffer_get_cloth_matches (target);
  g_assert_false (gst_cloth_matches_get_on_surface (found));
  g_assert_cmpuint (gst_cloth_matches_get_n_features (found), ==, 8);
  g_assert_cmpuint (gst_cloth_matches_get_n_matches (found), ==, 2);
  g_assert_cmpuint (gst_cloth_matches_get_n_points (found), ==, 2);
  g_assert_true (gst_cloth_matches_get_point (found, 0, &point));
  g_assert_true (point.x == 3);
  g_assert_true (gst_cloth_matches_get_point (found, 1, &point));
  g_assert_cmpint (point.column, ==, 0);
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
    {50, 2, GST_CLOTH_ERROR_LIMIT, "too many columns"},
    {54, 2, GST_CLOTH_ERROR_LIMIT, "too many rows"},
    {58, 2, GST_CLOTH_ERROR_LIMIT, "too many features"},
    {62, 2, GST_CLOTH_ERROR_LIMIT, "too many matches"},
    {66, 2, GST_CLOTH_ERROR_LIMIT, "too many vertices"},
    {60, 3, GST_CLOTH_ERROR_TRUNCATED, "one more match"},
    {65, 1, GST_CLOTH_ERROR_TRUNCATED, "more vertices than bytes"},
    {60, 1, GST_CLOTH_ERROR_VALUE, "fewer matches than bytes"},
    {64, 0, GST_CLOTH_ERROR_VALUE, "fewer vertices than bytes"},
    {68, 200, GST_CLOTH_ERROR_TRUNCATED, "a name beyond the end"},
    {69, 1, GST_CLOTH_ERROR_LIMIT, "a name that is too long"},
    {70, 2, GST_CLOTH_ERROR_VALUE, "an unknown way"},
    {72, 0xff, GST_CLOTH_ERROR_VALUE, "a name that is not UTF-8"},
    {104, 2, GST_CLOTH_ERROR_VALUE, "an unknown view"},
    {105, 2, GST_CLOTH_ERROR_VALUE, "an unknown side of a match"},
    {106, 0xff, GST_CLOTH_ERROR_VALUE, "an unknown state"},
    {48, 34, GST_CLOTH_ERROR_VALUE, "beyond the last column"},
    {52, 32, GST_CLOTH_ERROR_VALUE, "beyond the last row"},
    {143, 0xff, GST_CLOTH_ERROR_VALUE, "far beyond the last column"},
    {147, 0xff, GST_CLOTH_ERROR_VALUE, "far beyond the last row"},
    {148, 2, GST_CLOTH_ERROR_VALUE, "an unknown side of a vertex"}
  };
  static const guint floats[] = { 76, 80, 84, 88, 92, 96, 152, 156, 160, 164,
    168
  };
  guint8 bytes[sizeof golden + 172];

  g_assert_cmpuint (sizeof golden, ==, 204);
  for (guint i = 0; i < G_N_ELEMENTS (changes); i++) {
    memcpy (bytes, golden, sizeof golden);
    bytes[changes[i].at] = changes[i].value;
    assert_refused (bytes, sizeof golden, changes[i].code, changes[i].name);
  }
  for (guint i = 0; i < G_N_ELEMENTS (floats); i++) {
    memcpy (bytes, golden, sizeof golden);
    bytes[floats[i] + 2] = i % 2 ? 0x80 : 0xc0;
    bytes[floats[i] + 3] = 0x7f;
    assert_refused (bytes, sizeof golden, GST_CLOTH_ERROR_VALUE, "no number");
  }
  for (gsize size = 0; size < sizeof golden; size += 4)
    assert_refused (golden, size, GST_CLOTH_ERROR_TRUNCATED, "the beginning");

  /* the second vertex at the place of the first */
  memcpy (bytes, golden, sizeof golden);
  memcpy (bytes + 172, bytes + 140, 8);
  assert_refused (bytes, sizeof golden, GST_CLOTH_ERROR_VALUE,
      "the same place");

  /* the same section twice */
  memcpy (bytes, golden, sizeof golden);
  memcpy (bytes + sizeof golden, golden + 32, 172);
  bytes[8] = sizeof bytes & 0xff;
  bytes[9] = sizeof bytes >> 8;
  bytes[12] = 2;
  assert_refused (bytes, sizeof bytes, GST_CLOTH_ERROR_VALUE, "two of them");
}

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/cloth-matches/payload", test_payload);
  g_test_add_func ("/cloth-matches/misuse", test_misuse);
  g_test_add_func ("/cloth-matches/meta", test_meta);
  g_test_add_func ("/cloth-matches/section", test_section);
  g_test_add_func ("/cloth-matches/left-out", test_left_out);
  g_test_add_func ("/cloth-matches/section-refused", test_section_refused);
  return g_test_run ();
}
