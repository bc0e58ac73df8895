/* Dots: payload, meta, changes of size, and their section of an observation.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>
#include <math.h>
#include <string.h>

#include "tests/core/refused.h"

/* The layout as docs/streams.md has it, written out by hand: two dots of a pattern of
 * 31 by 33 dots in two colours, the second without a label. */
static const guint8 golden[] = {
  'G', 'C', 'O', 'B', 1, 0, 32, 0,      /*   0 magic, version, header */
  156, 0, 0, 0, 1, 0, 0, 0,     /*   8 size 156, sections */
  0, 0, 0, 0, 0, 0, 0, 0,       /*  16 PTS */
  0, 0, 0, 0, 0, 0, 0, 0,       /*  24 duration */
  'D', 'O', 'T', 'S', 116, 0, 0, 0,     /*  32 */
  9, 0, 0, 0, 0, 0, 0, 0,       /*  40 sequence */
  31, 0, 0, 0, 33, 0, 0, 0, 2, 0, 0, 0, /*  48 columns, rows, dots */
  4, 0, 2, 0, 'c', 'a', 'm', '0',       /*  60 name's length, colours, name */
  30, 0, 0, 0, 32, 0, 0, 0,     /*  68 column, row */
  1, 0, 0, 0, 0, 0, 0x40, 0x3f, /*  76 mirrored, confidence ¾ */
  0, 0, 0x28, 0x41, 0, 0, 0xa0, 0x41,   /*  84 x 10.5, y 20 */
  0, 0, 0x80, 0x3e, 0, 0, 0, 0xbe, 0, 0, 0, 0x3f,       /*  92 ¼, −⅛, ½ */
  0, 0, 0, 0xc0, 0, 0, 0, 0xbf, /* 104 −2, −½ */
  0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,       /* 112 no label */
  0, 1, 0, 0, 0, 0, 0, 0,       /* 120 touches, confidence 0 */
  0, 0, 0x80, 0x3f, 0, 0, 0, 0x40,      /* 128 x 1, y 2 */
  0, 0, 0x80, 0x3e, 0, 0, 0, 0, 0, 0, 0x80, 0x3e,       /* 136 ¼, 0, ¼ */
  0, 0, 0, 0, 0, 0, 0x80, 0xbf, /* 148 0, −1 */
};

static GstClothDot
some_dot (void)
{
  return (GstClothDot) {
    .column = 30,.row = 32,.mirrored = TRUE,.confidence = 0.75f,.x = 10.5f,.y =
        20,.cov_xx = 0.25f,.cov_xy = -0.125f,.cov_yy = 0.5f,.log_likelihood = {
      -2, -0.5f
    }
  };
}

static void
test_payload (void)
{
  GstClothDot source[2] = { some_dot (), {.column = -1,.row = -1} }, got;
  g_autoptr (GstClothDots) dots = gst_cloth_dots_new ("cam0", G_MAXUINT64, 31,
      33, 2, source, 2);
  g_autoptr (GstClothDots) none = gst_cloth_dots_new (NULL, 0, 3, 4, 5, NULL,
      0);
  g_autoptr (GBytes) points = gst_cloth_dots_get_points (dots);
  const gfloat expected[16] = { 30, 32, 10.5f, 20, 0.25f, -0.125f, 0.5f, 0.75f,
    -1, -1
  };
  gfloat value;
  gsize size;
  guint n;

  memset (source, 0, sizeof source);
  g_assert_cmpstr (gst_cloth_dots_get_camera (dots), ==, "cam0");
  g_assert_cmpuint (gst_cloth_dots_get_sequence (dots), ==, G_MAXUINT64);
  g_assert_cmpuint (gst_cloth_dots_get_columns (dots), ==, 31);
  g_assert_cmpuint (gst_cloth_dots_get_rows (dots), ==, 33);
  g_assert_cmpuint (gst_cloth_dots_get_n_colours (dots), ==, 2);
  g_assert_cmpuint (gst_cloth_dots_get_n_dots (dots), ==, 2);
  g_assert_cmpint (gst_cloth_dots_get_dots (dots, &n)[1].row, ==, -1);
  g_assert_cmpuint (n, ==, 2);
  g_assert_true (gst_cloth_dots_get_dot (dots, 0, &got));
  g_assert_true (got.mirrored);
  g_assert_true (gst_cloth_dot_get_log_likelihood (&got, 1, &value));
  g_assert_cmpfloat (value, ==, -0.5f);
  g_assert_true (gst_cloth_dot_set_log_likelihood (&got, 7, 3));
  g_assert_cmpfloat (got.log_likelihood[7], ==, 3);
  g_assert_false (gst_cloth_dot_get_log_likelihood (&got, 8, &value));
  g_assert_false (gst_cloth_dot_set_log_likelihood (&got, 8, 0));
  g_assert_false (gst_cloth_dots_get_dot (dots, 2, &got));
  g_assert_cmpmem (g_bytes_get_data (points, &size), size, expected,
      sizeof expected);

  g_assert_cmpstr (gst_cloth_dots_get_camera (none), ==, "");
  g_assert_cmpuint (gst_cloth_dots_get_n_dots (none), ==, 0);
  g_assert_false (gst_cloth_dots_get_dot (none, 0, &got));
}

/* A copied buffer shares the payload, which outlives the first buffer; adding replaces;
 * a meta put on by GStreamer's own function has no payload yet. */
static void
test_meta (void)
{
  GstClothDot dot = some_dot ();
  GstClothDots *dots = gst_cloth_dots_new ("cam0", 42, 31, 33, 2, &dot, 1);
  GstBuffer *buffer = gst_buffer_new (), *copy;

  g_assert_null (gst_buffer_get_cloth_dots (buffer));
  gst_buffer_add_meta (buffer, gst_cloth_dots_meta_get_info (), NULL);
  copy = gst_buffer_copy (buffer);
  g_assert_null (gst_buffer_get_cloth_dots (copy));
  gst_buffer_unref (copy);
  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("a", 1, 1, 1, 2,
          NULL, 0));
  gst_buffer_add_cloth_dots_meta (buffer, dots);
  g_assert_cmpuint (gst_buffer_get_n_meta (buffer,
          gst_cloth_dots_meta_api_get_type ()), ==, 1);
  copy = gst_buffer_copy (buffer);
  g_assert_true (gst_buffer_get_cloth_dots (copy) == dots);
  gst_buffer_unref (buffer);
  g_assert_cmpuint (gst_cloth_dots_get_sequence (dots), ==, 42);
  gst_buffer_unref (copy);
}

static void
test_transforms (void)
{
  GstClothDot dot = some_dot (), got;
  GstBuffer *buffer = gst_buffer_new (), *other = gst_buffer_new ();
  const GstMetaInfo *meta = gst_cloth_dots_meta_get_info ();
  GstVideoInfo in, out;
  GstVideoMetaTransform scale = { &in, &out };
  GstMeta *from = &gst_buffer_add_cloth_dots_meta (buffer,
      gst_cloth_dots_new ("cam0", 7, 31, 33, 2, &dot, 1))->meta;
  GstClothDots *scaled;

  gst_video_info_set_format (&in, GST_VIDEO_FORMAT_I420, 640, 480);
  gst_video_info_set_format (&out, GST_VIDEO_FORMAT_I420, 320, 960);
  out.par_n = 4;
  g_assert_false (meta->transform_func (other, from, buffer,
          g_quark_from_static_string ("a-transform-that-nobody-knows"), NULL));
  g_assert_null (gst_buffer_get_cloth_dots (other));
  g_assert_true (meta->transform_func (other, from, buffer,
          gst_video_meta_transform_scale_get_quark (), &scale));
  scaled = gst_buffer_get_cloth_dots (other);
  g_assert_cmpstr (gst_cloth_dots_get_camera (scaled), ==, "cam0");
  g_assert_cmpuint (gst_cloth_dots_get_columns (scaled), ==, 31);
  g_assert_cmpuint (gst_cloth_dots_get_rows (scaled), ==, 33);
  g_assert_cmpuint (gst_cloth_dots_get_n_colours (scaled), ==, 2);
  g_assert_true (gst_cloth_dots_get_dot (scaled, 0, &got));
  g_assert_cmpfloat (got.x, ==, 5);
  g_assert_cmpfloat (got.y, ==, 40.5f);
  g_assert_cmpfloat (got.cov_xx, ==, 0.0625f);
  g_assert_cmpfloat (got.cov_xy, ==, -0.125f);
  g_assert_cmpfloat (got.cov_yy, ==, 2);
  g_assert_cmpint (got.column, ==, 30);
  g_assert_cmpfloat (got.log_likelihood[0], ==, -2);
  g_assert_true (got.mirrored);
  for (guint i = 0; i < 3; i++) {
    const gchar *tags[] = { GST_META_TAG_VIDEO_STR,
      GST_META_TAG_VIDEO_ORIENTATION_STR, GST_META_TAG_VIDEO_SIZE_STR
    };

    g_assert_true (gst_meta_api_type_has_tag (meta->api,
            g_quark_from_string (tags[i])));
  }
  gst_buffer_unref (buffer);
  gst_buffer_unref (other);
}

static void
test_golden (void)
{
  g_autoptr (GstBuffer) observation = gst_buffer_new_memdup (golden,
      sizeof golden);
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GError) error = NULL;
  const GstClothDot *dot;
  GstClothDots *dots;
  GstMapInfo map;
  guint n;

  gst_cloth_observations_unpack (observation, target, &error);
  g_assert_no_error (error);
  dots = gst_buffer_get_cloth_dots (target);
  g_assert_cmpstr (gst_cloth_dots_get_camera (dots), ==, "cam0");
  g_assert_cmpuint (gst_cloth_dots_get_sequence (dots), ==, 9);
  g_assert_cmpuint (gst_cloth_dots_get_columns (dots), ==, 31);
  g_assert_cmpuint (gst_cloth_dots_get_rows (dots), ==, 33);
  g_assert_cmpuint (gst_cloth_dots_get_n_colours (dots), ==, 2);
  dot = gst_cloth_dots_get_dots (dots, &n);
  g_assert_cmpuint (n, ==, 2);
  g_assert_cmpint (dot->column, ==, 30);
  g_assert_cmpint (dot->row, ==, 32);
  g_assert_true (dot->mirrored && !dot->touches);
  g_assert_cmpfloat (dot->confidence, ==, 0.75f);
  g_assert_cmpfloat (dot->x, ==, 10.5f);
  g_assert_cmpfloat (dot->y, ==, 20);
  g_assert_cmpfloat (dot->cov_xx, ==, 0.25f);
  g_assert_cmpfloat (dot->cov_xy, ==, -0.125f);
  g_assert_cmpfloat (dot->cov_yy, ==, 0.5f);
  g_assert_cmpfloat (dot->log_likelihood[0], ==, -2);
  g_assert_cmpfloat (dot->log_likelihood[1], ==, -0.5f);
  g_assert_cmpint (dot[1].column, ==, -1);
  g_assert_cmpint (dot[1].row, ==, -1);
  g_assert_true (dot[1].touches && !dot[1].mirrored);
  g_assert_cmpfloat (dot[1].log_likelihood[1], ==, -1);

  GST_BUFFER_PTS (target) = GST_BUFFER_DURATION (target) = 0;
  packed = gst_cloth_observations_pack (target);
  g_assert_true (gst_buffer_map (packed, &map, GST_MAP_READ));
  g_assert_cmpmem (map.data, map.size, golden, sizeof golden);
  gst_buffer_unmap (packed, &map);
}

/* As many dots as there may be, of all numbers of colours. */
static void
test_round_trips (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (3);

  for (guint n_colours = 0; n_colours <= 8; n_colours++) {
    const guint n = n_colours == 8 ? GST_CLOTH_MAX_FEATURES : 50 * n_colours;
    g_autofree GstClothDot *dots = g_new0 (GstClothDot, n);
    g_autoptr (GstBuffer) buffer = gst_buffer_new ();
    g_autoptr (GstBuffer) packed = NULL;
    g_autoptr (GstBuffer) target = gst_buffer_new ();
    g_autoptr (GError) error = NULL;
    GstClothDots *got;

    for (guint i = 0; i < n; i++) {
      gfloat *floats[6] = { &dots[i].confidence, &dots[i].x, &dots[i].y,
        &dots[i].cov_xx, &dots[i].cov_xy, &dots[i].cov_yy
      };

      dots[i].column = dots[i].row = -1;
      if (g_rand_boolean (rand)) {
        /* each once, in no order that anybody would sort by */
        dots[i].column = (gint) (i * 40503 % 65536 % 400);
        dots[i].row = (gint) (i * 40503 % 65536 / 400);
      }
      dots[i].mirrored = g_rand_boolean (rand);
      dots[i].touches = g_rand_boolean (rand);
      for (guint k = 0; k < 6; k++)
        *floats[k] = (gfloat) g_rand_double_range (rand, -1, 2000);
      for (guint k = 0; k < n_colours; k++)
        dots[i].log_likelihood[k] = (gfloat) g_rand_double_range (rand, -90, 0);
    }
    gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("caméra", 17,
            400, 300, n_colours, dots, n));
    packed = gst_cloth_observations_pack (buffer);
    g_assert_true (gst_cloth_observations_unpack (packed, target, &error));
    g_assert_no_error (error);
    got = gst_buffer_get_cloth_dots (target);
    g_assert_cmpstr (gst_cloth_dots_get_camera (got), ==, "caméra");
    g_assert_cmpuint (gst_cloth_dots_get_n_colours (got), ==, n_colours);
    g_assert_cmpmem (gst_cloth_dots_get_dots (got, NULL),
        gst_cloth_dots_get_n_dots (got) * sizeof *dots, dots, n * sizeof *dots);
  }
}

/* What the reader would refuse is left out by the writer, the rest stays. */
static void
test_invalid_left_out (void)
{
  GstClothDot dots[8] = { some_dot (), some_dot (), some_dot (), some_dot (),
    some_dot (), some_dot (), some_dot (), some_dot ()
  };
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GError) error = NULL;
  GstClothDot got;

  dots[0].column = 31;
  dots[1].row = 33;
  dots[2].row = -1;
  dots[3].x = NAN;
  dots[4].cov_xy = INFINITY;
  dots[5].log_likelihood[1] = -INFINITY;
  dots[6].log_likelihood[2] = NAN;      /* beyond the colours */
  dots[7].column = -2;
  dots[7].row = -2;
  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("a", 1, 31, 33, 2,
          dots, 8));
  packed = gst_cloth_observations_pack (buffer);
  gst_cloth_observations_unpack (packed, target, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (gst_cloth_dots_get_n_dots (gst_buffer_get_cloth_dots
          (target)), ==, 1);
  g_assert_true (gst_cloth_dots_get_dot (gst_buffer_get_cloth_dots (target), 0,
          &got));
  g_assert_cmpfloat (got.log_likelihood[2], ==, 0);
}

static void
test_hostile (void)
{
  static const struct
  {
    const gchar *name;
    guint at;
    guint32 word;
    gint code;
  } cases[] = {
    {"4 G columns", 48, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"65537 rows", 52, 65537, GST_CLOTH_ERROR_LIMIT},
    {"no rows", 52, 0, GST_CLOTH_ERROR_VALUE},
    {"65537 dots", 56, 65537, GST_CLOTH_ERROR_LIMIT},
    {"65536 dots", 56, 65536, GST_CLOTH_ERROR_TRUNCATED},
    {"one dot too few", 56, 1, GST_CLOTH_ERROR_VALUE},
    {"9 colours", 60, 0x00090004, GST_CLOTH_ERROR_LIMIT},
    {"65535 colours", 60, 0xffff0004, GST_CLOTH_ERROR_LIMIT},
    {"8 colours", 60, 0x00080004, GST_CLOTH_ERROR_TRUNCATED},
    {"1 colour", 60, 0x00010004, GST_CLOTH_ERROR_VALUE},
    {"camera of 256 bytes", 60, 0x00020100, GST_CLOTH_ERROR_LIMIT},
    {"camera past the section", 60, 0x00020080, GST_CLOTH_ERROR_TRUNCATED},
    {"camera not UTF-8", 64, 0x61ff6161, GST_CLOTH_ERROR_VALUE},
    {"column past the pattern", 68, 31, GST_CLOTH_ERROR_VALUE},
    {"column -2", 68, 0xfffffffe, GST_CLOTH_ERROR_VALUE},
    {"half a label", 72, 0xffffffff, GST_CLOTH_ERROR_VALUE},
    {"row past the pattern", 72, 33, GST_CLOTH_ERROR_VALUE},
    {"mirrored 2", 76, 2, GST_CLOTH_ERROR_VALUE},
    {"touches 255", 76, 0xff00, GST_CLOTH_ERROR_VALUE},
    {"confidence NaN", 80, 0x7fc00000, GST_CLOTH_ERROR_VALUE},
    {"y infinite", 88, 0x7f800000, GST_CLOTH_ERROR_VALUE},
    {"cov_yy NaN", 100, 0xffffffff, GST_CLOTH_ERROR_VALUE},
    {"log-likelihood −∞", 108, 0xff800000, GST_CLOTH_ERROR_VALUE},
  };
  guint8 bent[sizeof golden], twice[32 + 2 * 124];

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    memcpy (bent, golden, sizeof golden);
    GST_WRITE_UINT32_LE (bent + cases[i].at, cases[i].word);
    assert_refused (bent, sizeof bent, cases[i].code, cases[i].name);
  }
  memcpy (twice, golden, sizeof golden);
  memcpy (twice + sizeof golden, golden + 32, 124);
  GST_WRITE_UINT32_LE (twice + 8, sizeof twice);
  GST_WRITE_UINT32_LE (twice + 12, 2);
  assert_refused (twice, sizeof twice, GST_CLOTH_ERROR_VALUE, "twice");
  for (gsize cut = 0; cut < sizeof golden; cut++) {
    memcpy (bent, golden, sizeof golden);
    if (cut >= 32)
      GST_WRITE_UINT32_LE (bent + 8, (guint32) cut);
    if (cut >= 40)
      GST_WRITE_UINT32_LE (bent + 36, (guint32) (cut - 40) & ~3u);
    if (cut % 4 == 0)
      assert_refused (bent, cut, GST_CLOTH_ERROR_TRUNCATED, "cut and mended");
  }
}

static void
test_misuse (void)
{
  g_autoptr (GstClothDots) none = gst_cloth_dots_new ("c", 0, 1, 1, 8, NULL, 0);

  ASSERT_MISUSE (gst_cloth_dots_new ("c", 0, 1, 1, 2, NULL, 1));
  ASSERT_MISUSE (gst_cloth_dots_new ("c", 0, 1, 1, 9, NULL, 0));
  ASSERT_MISUSE (gst_cloth_dots_new ("c", 0, G_MAXUINT, 1, 2, NULL, 0));
  ASSERT_MISUSE (gst_cloth_dots_new ("\xc3", 0, 1, 1, 2, NULL, 0));
  ASSERT_MISUSE (gst_cloth_dots_scale (none, 0, 1));
  ASSERT_MISUSE (gst_cloth_dots_scale (none, 1, NAN));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  gst_init (&argc, &argv);
  g_test_add_func ("/cloth/dots/payload", test_payload);
  g_test_add_func ("/cloth/dots/meta", test_meta);
  g_test_add_func ("/cloth/dots/transforms", test_transforms);
  g_test_add_func ("/cloth/dots/golden", test_golden);
  g_test_add_func ("/cloth/dots/round-trips", test_round_trips);
  g_test_add_func ("/cloth/dots/invalid", test_invalid_left_out);
  g_test_add_func ("/cloth/dots/hostile", test_hostile);
  g_test_add_func ("/cloth/dots/misuse", test_misuse);
  return g_test_run ();
}
