/* Observations: what is packed comes out again, and bytes that lie are refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/cloth/cloth.h>
#include <malloc.h>
#include <math.h>
#include <string.h>

#include "tests/core/farmemory.h"
#include "tests/core/refused.h"

/* The layout as docs/streams.md has it, written out by hand: an unknown section, a
 * reference time, one saddle and one candidate, one quad. */
static const guint8 golden[] = {
  'G', 'C', 'O', 'B', 1, 0, 32, 0,      /*   0 magic, version, header */
  0x24, 1, 0, 0, 4, 0, 0, 0,    /*   8 size 292, sections */
  0, 0xe1, 0xf5, 5, 0, 0, 0, 0, /*  16 PTS 100 ms */
  0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,       /*  24 no duration */
  'N', 'E', 'W', '!', 4, 0, 0, 0, 1, 2, 3, 4,   /*  32 unknown */
  'T', 'I', 'M', 'E', 36, 0, 0, 0,      /*  44 */
  7, 0, 0, 0, 0, 0, 0, 0,       /*  52 timestamp */
  0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff,       /*  60 duration */
  15, 0, 0, 0,                  /*  68 length */
  't', 'i', 'm', 'e', 's', 't', 'a', 'm', 'p', '/', 'x', '-', 'n', 't', 'p', 0,
  'S', 'A', 'D', 'L', 64, 0, 0, 0,      /*  88 */
  9, 0, 0, 0, 0, 0, 0, 0,       /*  96 sequence */
  1, 0, 0, 0, 1, 0, 0, 0,       /* 104 refined, candidates */
  4, 0, 0, 0, 'c', 'a', 'm', '0',       /* 112 camera */
  0, 0, 0x28, 0x41, 0, 0, 0xa0, 0x41,   /* 120 x 10.5, y 20 */
  0, 0, 0xc8, 0x42, 0, 0, 0, 0x3f,      /* 128 response 100, axis 0.5 */
  0, 0, 0x80, 0x3e, 0, 0, 0, 0, 0, 0, 0x80, 0x3e,       /* 136 ¼, 0, ¼ */
  0, 0, 0x30, 0x41, 0, 0, 0xa0, 0x41, 0, 0, 0x80, 0x42, /* 148 11, 20, 64 */
  'Q', 'U', 'A', 'D', 124, 0, 0, 0,     /* 160 */
  9, 0, 0, 0, 0, 0, 0, 0,       /* 168 sequence */
  8, 0, 0, 0, 6, 0, 0, 0, 1, 0, 0, 0,   /* 176 columns, rows, quads */
  4, 0, 0, 0, 'c', 'a', 'm', '0',       /* 188 camera */
  7, 0, 0, 0, 5, 0, 0, 0,       /* 196 column, row */
  1, 1, 0, 0, 0, 0, 0x80, 0x3f, /* 204 predicted, black, confidence 1 */
  0, 0, 0x80, 0x3f, 0, 0, 0, 0x40, 0, 0, 0x80, 0x3e, 0, 0, 0, 0, 0, 0, 0x80,
  0x3e,                         /* 212 corner 0: 1, 2, ¼, 0, ¼ */
  0, 0, 0x40, 0x40, 0, 0, 0, 0x40, 0, 0, 0x80, 0x3e, 0, 0, 0, 0, 0, 0, 0x80,
  0x3e,                         /* 232 corner 1: 3, 2 */
  0, 0, 0x40, 0x40, 0, 0, 0x80, 0x40, 0, 0, 0x80, 0x3e, 0, 0, 0, 0, 0, 0, 0x80,
  0x3e,                         /* 252 corner 2: 3, 4 */
  0, 0, 0x80, 0x3f, 0, 0, 0x80, 0x40, 0, 0, 0x80, 0x3e, 0, 0, 0, 0, 0, 0, 0x80,
  0x3e,                         /* 272 corner 3: 1, 4 */
};

static GstReferenceTimestampMeta *
get_time (GstBuffer * buffer, const gchar * reference)
{
  g_autoptr (GstCaps) caps = gst_caps_from_string (reference);

  return gst_buffer_get_reference_timestamp_meta (buffer, caps);
}

static void
test_golden (void)
{
  g_autoptr (GstBuffer) observation = gst_buffer_new_memdup (golden,
      sizeof golden);
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree guint8 *expected = g_memdup2 (golden, sizeof golden);
  GstClothSaddles *saddles;
  GstClothQuads *quads;
  GstReferenceTimestampMeta *time;
  GstClothSaddle saddle;
  GstClothCandidate candidate;
  GstClothQuad quad;
  GstMapInfo map;

  gst_cloth_observations_unpack (observation, target, &error);
  g_assert_no_error (error);
  saddles = gst_buffer_get_cloth_saddles (target);
  quads = gst_buffer_get_cloth_quads (target);
  g_assert_cmpstr (gst_cloth_saddles_get_camera (saddles), ==, "cam0");
  g_assert_cmpuint (gst_cloth_saddles_get_sequence (saddles), ==, 9);
  g_assert_true (gst_cloth_saddles_get_saddle (saddles, 0, &saddle));
  g_assert_cmpfloat (saddle.x, ==, 10.5f);
  g_assert_cmpfloat (saddle.y, ==, 20);
  g_assert_cmpfloat (saddle.response, ==, 100);
  g_assert_cmpfloat (saddle.axis, ==, 0.5f);
  g_assert_cmpfloat (saddle.cov_xx, ==, 0.25f);
  g_assert_cmpfloat (saddle.cov_xy, ==, 0);
  g_assert_true (gst_cloth_saddles_get_candidate (saddles, 0, &candidate));
  g_assert_cmpfloat (candidate.response, ==, 64);
  g_assert_cmpstr (gst_cloth_quads_get_camera (quads), ==, "cam0");
  g_assert_cmpuint (gst_cloth_quads_get_columns (quads), ==, 8);
  g_assert_cmpuint (gst_cloth_quads_get_rows (quads), ==, 6);
  g_assert_true (gst_cloth_quads_get_quad (quads, 0, &quad));
  g_assert_cmpint (quad.column, ==, 7);
  g_assert_cmpint (quad.row, ==, 5);
  g_assert_cmpint (quad.state, ==, GST_CLOTH_QUAD_PREDICTED);
  g_assert_true (quad.black);
  g_assert_cmpfloat (quad.x[2], ==, 3);
  g_assert_cmpfloat (quad.y[3], ==, 4);
  g_assert_cmpfloat (quad.cov_yy[3], ==, 0.25f);
  time = get_time (target, "timestamp/x-ntp");
  g_assert_cmpuint (time->timestamp, ==, 7);
  g_assert_false (GST_CLOCK_TIME_IS_VALID (time->duration));

  /* Packed again it is the same without the section that nobody knows. */
  GST_BUFFER_PTS (target) = 100 * GST_MSECOND;
  packed = gst_cloth_observations_pack (target);
  memmove (expected + 32, expected + 44, sizeof golden - 44);
  GST_WRITE_UINT32_LE (expected + 8, sizeof golden - 12);
  GST_WRITE_UINT32_LE (expected + 12, 3);
  g_assert_cmpuint (GST_BUFFER_PTS (packed), ==, 100 * GST_MSECOND);
  g_assert_true (gst_buffer_map (packed, &map, GST_MAP_READ));
  g_assert_cmpmem (map.data, map.size, expected, sizeof golden - 12);
  gst_buffer_unmap (packed, &map);
}

static GstBuffer *
observed_buffer (GRand * rand, guint n_refined, guint n_candidates,
    guint n_quads)
{
  g_autofree GstClothSaddle *refined = g_new (GstClothSaddle, n_refined);
  g_autofree GstClothCandidate *candidates = g_new (GstClothCandidate,
      n_candidates);
  g_autofree GstClothQuad *quads = g_new0 (GstClothQuad, n_quads);
  g_autoptr (GstCaps) ptp = gst_caps_from_string
      ("timestamp/x-ptp, version=(string)IEEE1588-2008, domain=(int)1");
  g_autoptr (GstCaps) ntp = gst_caps_from_string ("timestamp/x-ntp");
  GstBuffer *buffer = gst_buffer_new ();

  for (guint i = 0; i < 7 * n_refined; i++)
    ((gfloat *) refined)[i] = (gfloat) g_rand_double_range (rand, -1, 2000);
  for (guint i = 0; i < 3 * n_candidates; i++)
    ((gfloat *) candidates)[i] = (gfloat) g_rand_double_range (rand, 0, 2000);
  for (guint i = 0; i < n_quads; i++) {
    /* each once, in no order that anybody would sort by */
    quads[i].column = (gint) (i * 40503 % 65536 % 256);
    quads[i].row = (gint) (i * 40503 % 65536 / 256);
    quads[i].state = (GstClothQuadState) g_rand_int_range (rand, 0, 3);
    quads[i].black = g_rand_boolean (rand);
    quads[i].confidence = (gfloat) g_rand_double (rand);
    gfloat *floats[5] = { quads[i].x, quads[i].y, quads[i].cov_xx,
      quads[i].cov_xy, quads[i].cov_yy
    };

    for (guint k = 0; k < 20; k++)
      floats[k / 4][k % 4] = (gfloat) g_rand_double_range (rand, -1, 2000);
  }
  gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new
      ("caméra gauche", 1234567890123, refined, n_refined, candidates,
          n_candidates));
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new (NULL, 17, 256,
          256, quads, n_quads));
  gst_buffer_add_reference_timestamp_meta (buffer, ptp, 1700000000000000000,
      GST_CLOCK_TIME_NONE);
  gst_buffer_add_reference_timestamp_meta (buffer, ntp, 99, 5);
  GST_BUFFER_PTS (buffer) = 3 * GST_SECOND;
  GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
  GST_BUFFER_OFFSET (buffer) = 75;
  return buffer;
}

static void
test_round_trips (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (3);
  static const guint counts[][3] = { {0, 0, 0}, {1, 0, 0}, {0, 3, 0}, {5, 7, 2},
  {3500, 20000, 1000}, {65536, 65536, 65536}
  };

  for (guint i = 0; i < G_N_ELEMENTS (counts); i++) {
    g_autoptr (GstBuffer) buffer = observed_buffer (rand, counts[i][0],
        counts[i][1], counts[i][2]);
    g_autoptr (GstBuffer) packed = gst_cloth_observations_pack (buffer);
    g_autoptr (GstBuffer) target = gst_buffer_new ();
    g_autoptr (GError) error = NULL;
    GstClothSaddles *before, *after;
    GstClothQuads *old, *new;
    GstReferenceTimestampMeta *time;

    g_assert_cmpuint (GST_BUFFER_PTS (packed), ==, 3 * GST_SECOND);
    g_assert_cmpuint (GST_BUFFER_DURATION (packed), ==, 40 * GST_MSECOND);
    g_assert_cmpuint (GST_BUFFER_OFFSET (packed), ==, 75);
    gst_cloth_observations_unpack (packed, target, &error);
    g_assert_no_error (error);
    before = gst_buffer_get_cloth_saddles (buffer);
    after = gst_buffer_get_cloth_saddles (target);
    g_assert_cmpstr (gst_cloth_saddles_get_camera (after), ==,
        "caméra gauche");
    g_assert_cmpuint (gst_cloth_saddles_get_sequence (after), ==,
        1234567890123);
    g_assert_cmpuint (gst_cloth_saddles_get_n_refined (after), ==,
        counts[i][0]);
    g_assert_cmpuint (gst_cloth_saddles_get_n_candidates (after), ==,
        counts[i][1]);
    g_assert_cmpmem (gst_cloth_saddles_get_refined (before, NULL),
        28 * counts[i][0], gst_cloth_saddles_get_refined (after, NULL),
        28 * counts[i][0]);
    g_assert_cmpmem (gst_cloth_saddles_get_candidates (before, NULL),
        12 * counts[i][1], gst_cloth_saddles_get_candidates (after, NULL),
        12 * counts[i][1]);
    old = gst_buffer_get_cloth_quads (buffer);
    new = gst_buffer_get_cloth_quads (target);
    g_assert_cmpstr (gst_cloth_quads_get_camera (new), ==, "");
    g_assert_cmpuint (gst_cloth_quads_get_n_quads (new), ==, counts[i][2]);
    g_assert_cmpmem (gst_cloth_quads_get_quads (old, NULL),
        sizeof (GstClothQuad) * counts[i][2], gst_cloth_quads_get_quads (new,
            NULL), sizeof (GstClothQuad) * counts[i][2]);
    time = get_time (target, "timestamp/x-ptp, version=IEEE1588-2008, "
        "domain=1");
    g_assert_cmpuint (time->timestamp, ==, 1700000000000000000);
    time = get_time (target, "timestamp/x-ntp");
    g_assert_cmpuint (time->duration, ==, 5);
    g_test_message ("%u saddles, %u candidates, %u quads: %" G_GSIZE_FORMAT
        " bytes", counts[i][0], counts[i][1], counts[i][2],
        gst_buffer_get_size (packed));
  }
}

/* A picture nobody looked at gives no section, and unpacking it adds nothing. */
static void
test_nothing (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = gst_cloth_observations_pack (buffer);
  g_autoptr (GError) error = NULL;

  g_assert_cmpuint (gst_buffer_get_size (packed), ==, 32);
  g_assert_true (gst_cloth_observations_unpack (packed, packed, &error));
  g_assert_null (gst_buffer_get_cloth_saddles (packed));
  g_assert_null (gst_buffer_get_cloth_quads (packed));
}

/* Of features at one place the first valid one is written; a reader refuses such bytes. */
static void
test_repeated_places (void)
{
  GstClothQuad quads[6] = { {.column = 1,.row = 1,.confidence = NAN}, {.column =
        1,.row = 1,.confidence = 0.1f}, {.column = 1}, {.column = 1,.row =
        1,.confidence = 0.2f}, {.row = 1,.confidence = 0.3f}, {.column = 1}
  };
  GstClothDot dots[6] = { {.column = -1,.row = -1}, {.column = 3,.row = 2,.x =
        1}, {.column = -1,.row = -1}, {.column = 3,.row = 2,.x = 2}, {.column =
        2,.row = 3}, {.column = 3,.row = 2,.x = 3}
  };
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GError) error = NULL;
  const GstClothQuad *quad;
  const GstClothDot *dot;
  guint n;

  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new ("a", 1, 2, 2,
          quads, 6));
  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("a", 1, 4, 4, 1,
          dots, 6));
  packed = gst_cloth_observations_pack (buffer);
  gst_cloth_observations_unpack (packed, target, &error);
  g_assert_no_error (error);
  quad = gst_cloth_quads_get_quads (gst_buffer_get_cloth_quads (target), &n);
  g_assert_cmpuint (n, ==, 3);
  g_assert_cmpfloat (quad[0].confidence, ==, 0.1f);
  g_assert_cmpint (quad[1].row, ==, 0);
  g_assert_cmpfloat (quad[2].confidence, ==, 0.3f);
  dot = gst_cloth_dots_get_dots (gst_buffer_get_cloth_dots (target), &n);
  g_assert_cmpuint (n, ==, 4);
  g_assert_cmpint (dot[0].column, ==, -1);
  g_assert_cmpfloat (dot[1].x, ==, 1);
  g_assert_cmpint (dot[2].column, ==, -1);
  g_assert_cmpint (dot[3].row, ==, 3);
}

/* Two quads, then two dots, whose bytes say the same place; whether it is the place of the
 * last or of the one before makes no difference. */
static void
test_repeated_refused (void)
{
  const GstClothQuad quads[3] = { {.column = 1}, {.row = 1}, {.column = 1,.row =
        1}
  };
  const GstClothDot dots[3] = { {.column = 1}, {.row = 1}, {.column = 1,.row = 1}
  };
  static const guint8 places[2][8] = { {1, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 1,
      0, 0, 0}
  };

  for (guint kind = 0; kind < 2; kind++) {
    g_autoptr (GstBuffer) buffer = gst_buffer_new ();
    g_autoptr (GstBuffer) packed = NULL;
    g_autofree guint8 *bytes = NULL;
    gsize size, last;

    if (kind == 0)
      gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new (NULL, 1, 2,
              2, quads, 3));
    else
      gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new (NULL, 1, 2, 2,
              1, dots, 3));
    packed = gst_cloth_observations_pack (buffer);
    gst_buffer_extract_dup (packed, 0, gst_buffer_get_size (packed),
        (gpointer *) & bytes, &size);
    last = size - (kind == 0 ? 96 : 40);
    for (guint i = 0; i < 2; i++) {
      memcpy (bytes + last, places[i], 8);
      assert_refused (bytes, size, GST_CLOTH_ERROR_VALUE, "repeated");
    }
  }
}

/* What the reader would refuse is left out by the writer, the rest stays. */
static void
test_invalid_left_out (void)
{
  const GstClothSaddle refined[3] = { {1, 2, 3, 0, 1, 0, 1}, {NAN, 2, 3, 0, 1,
      0, 1}, {4, 2, 3, 0, INFINITY, 0, 1}
  };
  const GstClothCandidate candidates[2] = { {1, NAN, 3}, {5, 6, 7} };
  GstClothQuad quads[5] = { {.column = 1}, {.column = 2}, {.row = -1}, {.state =
        (GstClothQuadState) 3}, {.column = 1,.y = {0, 0, NAN, 0}}
  };
  const GstClothDot dots[4] = { {.column = -1,.row = 2}, {.column = 2,.row =
        -1},
  {.column = -1,.row = -1,.x = 7}, {.column = 4}
  };
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GstCaps) odd = gst_caps_from_string ("timestamp/x-odd, "
      "name=(string)\"a\\\"b{\"");
  g_autoptr (GstCaps) any = gst_caps_new_any ();
  g_autoptr (GError) error = NULL;
  GstClothSaddle saddle;
  GstClothCandidate candidate;

  gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new ("a", 1,
          refined, 3, candidates, 2));
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new ("a", 1, 2, 2,
          quads, 5));
  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("a", 1, 4, 4, 1,
          dots, 4));
  gst_buffer_add_reference_timestamp_meta (buffer, odd, 1, 1);
  gst_buffer_add_reference_timestamp_meta (buffer, any, 1, 1);
  packed = gst_cloth_observations_pack (buffer);
  gst_cloth_observations_unpack (packed, target, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (gst_cloth_saddles_get_n_refined
      (gst_buffer_get_cloth_saddles (target)), ==, 1);
  g_assert_true (gst_cloth_saddles_get_saddle (gst_buffer_get_cloth_saddles
          (target), 0, &saddle));
  g_assert_cmpfloat (saddle.x, ==, 1);
  g_assert_true (gst_cloth_saddles_get_candidate (gst_buffer_get_cloth_saddles
          (target), 0, &candidate));
  g_assert_cmpfloat (candidate.x, ==, 5);
  g_assert_cmpuint (gst_cloth_quads_get_n_quads (gst_buffer_get_cloth_quads
          (target)), ==, 1);
  g_assert_cmpuint (gst_cloth_dots_get_n_dots (gst_buffer_get_cloth_dots
          (target)), ==, 1);
  g_assert_cmpfloat (gst_cloth_dots_get_dots (gst_buffer_get_cloth_dots
          (target), NULL)[0].x, ==, 7);
  g_assert_null (gst_buffer_get_reference_timestamp_meta (target, NULL));
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
    {"magic", 0, 0x42544347, GST_CLOTH_ERROR_MAGIC},
    {"version 2", 4, 0x00200002, GST_CLOTH_ERROR_VERSION},
    {"header of 31 bytes", 4, 0x001f0001, GST_CLOTH_ERROR_VALUE},
    {"size of 4 GB", 8, 0xffffffff, GST_CLOTH_ERROR_TRUNCATED},
    {"size too small", 8, 288, GST_CLOTH_ERROR_VALUE},
    {"sections missing", 12, 5, GST_CLOTH_ERROR_TRUNCATED},
    {"sections left over", 12, 3, GST_CLOTH_ERROR_VALUE},
    {"4 G sections", 12, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"unknown section of 4 GB", 36, 0xfffffffc, GST_CLOTH_ERROR_TRUNCATED},
    {"section size no multiple of 4", 36, 5, GST_CLOTH_ERROR_VALUE},
    {"section one word too long", 36, 8, GST_CLOTH_ERROR_VALUE},
    {"time: shorter than its header", 48, 16, GST_CLOTH_ERROR_TRUNCATED},
    {"time: no time", 52, 7, -1},
    {"time: text longer than section", 68, 17, GST_CLOTH_ERROR_TRUNCATED},
    {"time: text of 4 GB", 68, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"time: no text", 68, 0, GST_CLOTH_ERROR_TRUNCATED},
    {"time: a list", 72, 0x7b7b7b7b, GST_CLOTH_ERROR_VALUE},
    {"time: NUL inside", 76, 0x00626262, GST_CLOTH_ERROR_VALUE},
    {"saddles: one too many", 104, 2, GST_CLOTH_ERROR_TRUNCATED},
    {"saddles: one too few", 104, 0, GST_CLOTH_ERROR_VALUE},
    {"saddles: 65537", 104, 65537, GST_CLOTH_ERROR_LIMIT},
    {"saddles: 65536", 104, 65536, GST_CLOTH_ERROR_TRUNCATED},
    {"saddles: 4 G candidates", 108, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"saddles: camera of 256 bytes", 112, 256, GST_CLOTH_ERROR_LIMIT},
    {"saddles: camera past the section", 112, 60, GST_CLOTH_ERROR_TRUNCATED},
    {"saddles: camera not UTF-8", 116, 0xc3c3c3c3, GST_CLOTH_ERROR_VALUE},
    {"saddles: NUL in camera", 116, 0x61006161, GST_CLOTH_ERROR_VALUE},
    {"saddles: x NaN", 120, 0x7fc00000, GST_CLOTH_ERROR_VALUE},
    {"saddles: cov_yy infinite", 144, 0x7f800000, GST_CLOTH_ERROR_VALUE},
    {"saddles: candidate NaN", 156, 0xffffffff, GST_CLOTH_ERROR_VALUE},
    {"saddles twice", 160, 0x4c444153, GST_CLOTH_ERROR_VALUE},
    {"quads: 4 G columns", 176, 0xffffffff, GST_CLOTH_ERROR_LIMIT},
    {"quads: no rows", 180, 0, GST_CLOTH_ERROR_VALUE},
    {"quads: 65536", 184, 65536, GST_CLOTH_ERROR_TRUNCATED},
    {"quads: 65537", 184, 65537, GST_CLOTH_ERROR_LIMIT},
    {"quads: none", 184, 0, GST_CLOTH_ERROR_VALUE},
    {"quads: camera not UTF-8", 192, 0x61ff6161, GST_CLOTH_ERROR_VALUE},
    {"quads: column past the board", 196, 8, GST_CLOTH_ERROR_VALUE},
    {"quads: column -1", 196, 0xffffffff, GST_CLOTH_ERROR_VALUE},
    {"quads: row past the board", 200, 6, GST_CLOTH_ERROR_VALUE},
    {"quads: state 3", 204, 0x0103, GST_CLOTH_ERROR_VALUE},
    {"quads: state 255", 204, 0x01ff, GST_CLOTH_ERROR_VALUE},
    {"quads: neither black nor white", 204, 0x0201, GST_CLOTH_ERROR_VALUE},
    {"quads: confidence NaN", 208, 0x7fc00000, GST_CLOTH_ERROR_VALUE},
    {"quads: y NaN", 228, 0x7fc00000, GST_CLOTH_ERROR_VALUE},
    {"quads: cov_xx NaN", 244, 0x7fc00000, GST_CLOTH_ERROR_VALUE},
    {"quads: cov_xy NaN", 260, 0x7fc00000, GST_CLOTH_ERROR_VALUE},
    {"quads: cov_yy NaN", 276, 0x7fc00000, GST_CLOTH_ERROR_VALUE},
    {"quads: corner infinite", 272, 0xff800000, GST_CLOTH_ERROR_VALUE},
  };
  guint8 bent[sizeof golden];

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    memcpy (bent, golden, sizeof golden);
    if (cases[i].code < 0) {
      memset (bent + cases[i].at, 0xff, 8);
      assert_refused (bent, sizeof bent, GST_CLOTH_ERROR_VALUE, cases[i].name);
      continue;
    }
    GST_WRITE_UINT32_LE (bent + cases[i].at, cases[i].word);
    assert_refused (bent, sizeof bent, cases[i].code, cases[i].name);
  }
  {
    g_autoptr (GstBuffer) far = far_buffer (sizeof golden);
    g_autoptr (GstBuffer) target = gst_buffer_new ();
    g_autoptr (GError) error = NULL;

    g_assert_false (gst_cloth_observations_unpack (far, target, &error));
    g_assert_nonnull (error);
    g_assert_cmpint (error->domain, ==, GST_CLOTH_ERROR);
  }
}

/* Cut anywhere: once as it is, once with the size in the header mended, so that the
 * sections themselves are found short. */
static void
test_truncated (void)
{
  guint8 bent[sizeof golden];

  for (gsize cut = 0; cut < sizeof golden; cut++) {
    assert_refused (golden, cut, GST_CLOTH_ERROR_TRUNCATED, "cut");
    if (cut >= 32) {
      memcpy (bent, golden, sizeof golden);
      GST_WRITE_UINT32_LE (bent + 8, (guint32) cut);
      assert_refused (bent, cut, GST_CLOTH_ERROR_TRUNCATED, "cut and mended");
    }
  }
}

static void
test_too_many_times (void)
{
  guint8 *bytes = g_malloc (32 + 17 * 44);
  g_autoptr (GstBuffer) buffer = gst_buffer_new_wrapped (bytes, 32 + 17 * 44);
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GError) error = NULL;

  memcpy (bytes, golden, 32);
  GST_WRITE_UINT32_LE (bytes + 8, 32 + 17 * 44);
  GST_WRITE_UINT32_LE (bytes + 12, 17);
  for (guint i = 0; i < 17; i++)
    memcpy (bytes + 32 + 44 * i, golden + 44, 44);
  g_assert_false (gst_cloth_observations_unpack (buffer, target, &error));
  g_assert_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_LIMIT);
}

/* An observation with nothing but reference times, one of each of @texts. */
static GstBuffer *
times_buffer (const gchar * const *texts, guint n)
{
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  gsize size;

  g_byte_array_append (bytes, golden, 32);
  for (guint i = 0; i < n; i++) {
    const guint length = (guint) strlen (texts[i]);
    guint8 section[28 + 256] = { 'T', 'I', 'M', 'E' };

    GST_WRITE_UINT32_LE (section + 4, 20 + (length + 3) / 4 * 4);
    section[8] = (guint8) (i + 1);
    GST_WRITE_UINT32_LE (section + 24, length);
    memcpy (section + 28, texts[i], length);
    g_byte_array_append (bytes, section, 28 + (length + 3) / 4 * 4);
  }
  GST_WRITE_UINT32_LE (bytes->data + 8, bytes->len);
  GST_WRITE_UINT32_LE (bytes->data + 12, n);
  size = bytes->len;
  return gst_buffer_new_memdup (bytes->data, size);
}

/* The clocks of GStreamer 1.22 to 1.26 and its plugins, as its documentation and its
 * sources write them. Packed again they are the same bytes. */
static void
test_known_clocks (void)
{
  static const gchar *const clocks[] = {
    "timestamp/x-ntp",
    "timestamp/x-ntp, host=(string)pool.ntp.org, port=(int)123",
    "timestamp/x-ntp, port=(int)65535",
    "timestamp/x-ptp",
    "timestamp/x-ptp, version=(string)IEEE1588-2008, domain=(int)0",
    "timestamp/x-ptp, domain=(int)255, version=(string)IEEE1588-2019",
    "timestamp/x-unix",
    "timestamp/x-decklink-stream",
    "timestamp/x-decklink-hardware",
    "timestamp/x-aja-stream",
    "timestamp/x-ndi-timecode",
    "timestamp/x-ndi-timestamp",
  };
  g_autoptr (GstBuffer) observation = times_buffer (clocks,
      G_N_ELEMENTS (clocks));
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GError) error = NULL;
  gpointer iterator = NULL;
  GstMapInfo map;

  gst_cloth_observations_unpack (observation, target, &error);
  g_assert_no_error (error);
  for (guint i = 0; i < G_N_ELEMENTS (clocks); i++) {
    const GstReferenceTimestampMeta *time = (GstReferenceTimestampMeta *)
        gst_buffer_iterate_meta_filtered (target, &iterator,
        GST_REFERENCE_TIMESTAMP_META_API_TYPE);
    g_autoptr (GstCaps) expected = gst_caps_from_string (clocks[i]);

    g_assert_nonnull (time);
    g_assert_true (gst_caps_is_strictly_equal (time->reference, expected));
    g_assert_cmpuint (time->timestamp, ==, i + 1);
  }
  GST_BUFFER_PTS (target) = 100 * GST_MSECOND;
  packed = gst_cloth_observations_pack (target);
  g_assert_true (gst_buffer_map (observation, &map, GST_MAP_READ));
  g_assert_cmpint (gst_buffer_memcmp (packed, 0, map.data, map.size), ==, 0);
  g_assert_cmpuint (gst_buffer_get_size (packed), ==, map.size);
  gst_buffer_unmap (observation, &map);
}

/* Times of other clocks, and of these with what no such clock has, are passed over when
 * read and left out when written; what else the packet holds stays. */
static void
test_unknown_clocks (void)
{
  static const gchar *const clocks[] = {
    "timestamp/x-odd", "timestamp/x-ntp2", "timestamp/x-nt", "x-ntp", "a",
    "timestamp/x-ntp,", "timestamp/x-ntp, ", "timestamp/x-ntp ",
    "timestamp/x-ntp(host)", "timestamp/x-ntp, host", "timestamp/x-ntp, host=",
    "timestamp/x-ntp, host=(string)", "timestamp/x-ntp, host=a",
    "timestamp/x-ntp, host=(int)1", "timestamp/x-ntp, host=(string)a b",
    "timestamp/x-ntp,host=(string)a", "timestamp/x-ntp, Host=(string)a",
    "timestamp/x-ntp, host=(string)a, host=(string)b",
    "timestamp/x-ntp, port=(int)0", "timestamp/x-ntp, port=(int)65536",
    "timestamp/x-ntp, port=(int)-1", "timestamp/x-ntp, port=(int)0123",
    "timestamp/x-ntp, port=(int)4294967419", "timestamp/x-ntp, port=(int)12a",
    "timestamp/x-ntp, port=(int)", "timestamp/x-ntp, port=(string)123",
    "timestamp/x-ntp, port=123", "timestamp/x-ntp, domain=(int)1",
    "timestamp/x-ptp, domain=(int)256", "timestamp/x-unix, host=(string)a",
    "timestamp/x-ntp, c=(fraction)-2147483648/-1",
    "timestamp/x-ntp, port=(int)123 timestamp/x-ntp",
  };

  for (guint i = 0; i < G_N_ELEMENTS (clocks); i++) {
    const gchar *both[2] = { clocks[i], "timestamp/x-unix" };
    g_autoptr (GstBuffer) observation = times_buffer (both, 2);
    g_autoptr (GstBuffer) target = gst_buffer_new ();
    g_autoptr (GError) error = NULL;
    GstReferenceTimestampMeta *time;

    g_test_message ("%s", clocks[i]);
    gst_cloth_observations_unpack (observation, target, &error);
    g_assert_no_error (error);
    time = gst_buffer_get_reference_timestamp_meta (target, NULL);
    g_assert_cmpuint (time->timestamp, ==, 2);
    g_assert_cmpuint (gst_buffer_get_n_meta (target,
            GST_REFERENCE_TIMESTAMP_META_API_TYPE), ==, 1);
  }
}

static void
test_unknown_clocks_left_out (void)
{
  static const gchar *const clocks[] = { "timestamp/x-odd",
    "timestamp/x-ntp, host=(string)\"a b\"", "timestamp/x-ntp, stratum=(int)1",
    "timestamp/x-ntp; timestamp/x-unix", "timestamp/x-ntp, port=(int)[ 1, 2 ]",
    "timestamp/x-unix(memory:other)", "EMPTY", "ANY",
  };
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (clocks); i++) {
    g_autoptr (GstCaps) caps = gst_caps_from_string (clocks[i]);

    gst_buffer_add_reference_timestamp_meta (buffer, caps, 1, 1);
  }
  {
    g_autoptr (GstCaps) known = gst_caps_from_string ("timestamp/x-ntp");

    gst_buffer_add_reference_timestamp_meta (buffer, known, 1, 1)->timestamp =
        GST_CLOCK_TIME_NONE;
  }
  packed = gst_cloth_observations_pack (buffer);
  g_assert_cmpuint (gst_buffer_get_size (packed), ==, 32);
}

/* As many as a reader takes. */
static void
test_many_clocks_left_out (void)
{
  g_autoptr (GstBuffer) buffer = gst_buffer_new ();
  g_autoptr (GstBuffer) target = gst_buffer_new ();
  g_autoptr (GstBuffer) packed = NULL;
  g_autoptr (GstCaps) caps = gst_caps_from_string ("timestamp/x-ntp");
  g_autoptr (GError) error = NULL;

  for (guint i = 0; i < 17; i++)
    gst_buffer_add_reference_timestamp_meta (buffer, caps, i, 1);
  packed = gst_cloth_observations_pack (buffer);
  g_assert_true (gst_cloth_observations_unpack (packed, target, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (gst_buffer_get_n_meta (target,
          GST_REFERENCE_TIMESTAMP_META_API_TYPE), ==, 16);
}

/* A stranger's packets, none like the other: GStreamer would remember all their names. */
static void
test_clocks_leave_no_trace (void)
{
  const guint n_packets = 5000;
  gsize before = 0;

  for (guint i = 0; i < n_packets; i++) {
    gchar *texts[12];
    g_autoptr (GstBuffer) observation = NULL;
    g_autoptr (GstBuffer) target = gst_buffer_new ();
    g_autoptr (GError) error = NULL;

    for (guint k = 0; k < G_N_ELEMENTS (texts); k++)
      texts[k] = g_strdup_printf ("timestamp/x-%0200u, name%u-%u=(int)1",
          12 * i + k, i, k);
    observation = times_buffer ((const gchar * const *) texts,
        G_N_ELEMENTS (texts));
    for (guint k = 0; k < G_N_ELEMENTS (texts); k++)
      g_free (texts[k]);
    gst_cloth_observations_unpack (observation, target, &error);
    g_assert_no_error (error);
    if (i == n_packets / 10)
      before = mallinfo2 ().uordblks;
  }
  g_test_message ("%" G_GSSIZE_FORMAT " bytes more",
      (gssize) (mallinfo2 ().uordblks - before));
  g_assert_cmpuint (mallinfo2 ().uordblks, <=, before + 65536);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  gst_init (&argc, &argv);
  g_test_add_func ("/cloth/observations/golden", test_golden);
  g_test_add_func ("/cloth/observations/round-trips", test_round_trips);
  g_test_add_func ("/cloth/observations/nothing", test_nothing);
  g_test_add_func ("/cloth/observations/repeated-places", test_repeated_places);
  g_test_add_func ("/cloth/observations/repeated-refused",
      test_repeated_refused);
  g_test_add_func ("/cloth/observations/invalid", test_invalid_left_out);
  g_test_add_func ("/cloth/observations/hostile", test_hostile);
  g_test_add_func ("/cloth/observations/truncated", test_truncated);
  g_test_add_func ("/cloth/observations/too-many-times", test_too_many_times);
  g_test_add_func ("/cloth/observations/known-clocks", test_known_clocks);
  g_test_add_func ("/cloth/observations/unknown-clocks", test_unknown_clocks);
  g_test_add_func ("/cloth/observations/unknown-clocks-left-out",
      test_unknown_clocks_left_out);
  g_test_add_func ("/cloth/observations/many-clocks-left-out",
      test_many_clocks_left_out);
  g_test_add_func ("/cloth/observations/clocks-leave-no-trace",
      test_clocks_leave_no_trace);
  return g_test_run ();
}
