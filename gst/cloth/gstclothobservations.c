/* One frame of an observation stream: sections of what a camera saw.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothclock.h"
#include "gst/cloth/gstclothdots.h"
#include "gst/cloth/gstclothmatches.h"
#include "gst/cloth/gstclothobservations.h"
#include "gst/cloth/gstclothplaces.h"
#include "gst/cloth/gstclothprivate.h"
#include "gst/cloth/gstclothquads.h"
#include "gst/cloth/gstclothsaddles.h"
#include "gst/cloth/gstclothsilhouette.h"

/* docs/streams.md holds the layout, byte by byte. */
#define OBSERVATIONS_MAGIC "GCOB"
#define OBSERVATIONS_VERSION 1
#define OBSERVATIONS_HEADER 32
#define MAX_SECTIONS 64
#define MAX_TIMES 16
#define MAX_REFERENCE 255

#define MAX_COUNTS 5

#define SECTION_HEADER 8
#define SECTION_TIME "TIME"
#define TIME_HEADER 20

/* A section of features begins with the frame's number (64 bits), @n_counts numbers of 32
 * bits, two of 16 bits (the length of the camera's name, and one that only some have: the
 * colours of dots, whether matches were found along a surface), and the name. Of what count i
 * counts, each takes @item_bytes[i] bytes, a dot 4 more a colour.
 * @too_many says what is wrong when count i is over @most[i]. */
typedef struct
{
  const gchar *tag;
  guint n_counts;
  guint item_bytes[MAX_COUNTS];
  guint most[MAX_COUNTS];
  const gchar *too_many;
} FeatureKind;

/* counts: refined saddles, candidates */
static const FeatureKind saddles_kind = { "SADL", 2, {28, 12},
{GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES},
"there are more than 65536 features"
};

/* counts: columns, rows, quads */
static const FeatureKind quads_kind = { "QUAD", 3, {0, 0, 96},
{GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES},
"there are more than 65536 quads, columns or rows"
};

/* counts: columns, rows, dots */
static const FeatureKind dots_kind = { "DOTS", 3, {0, 0, 36},
{GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES},
"there are more than 65536 dots, columns or rows"
};

/* counts: columns, rows, runs */
static const FeatureKind silhouette_kind = { "SILH", 3, {0, 0, 6},
{GST_CLOTH_MAX_SILHOUETTE_SIZE, GST_CLOTH_MAX_SILHOUETTE_SIZE,
    GST_CLOTH_MAX_RUNS},
"there are more than 16384 columns or rows, or more than 1048576 runs"
};

/* counts: columns, rows, features, matches, vertices */
static const FeatureKind matches_kind = { "MTCH", 5, {0, 0, 0, 32, 32},
{GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES,
    GST_CLOTH_MAX_FEATURES, GST_CLOTH_MAX_FEATURES},
"there are more than 65536 features, matches, vertices, columns or rows"
};

static gsize
items_size (const FeatureKind * kind, const guint counts[MAX_COUNTS],
    guint n_colours)
{
  gsize size = 0;

  for (guint i = 0; i < kind->n_counts; i++)
    size += (gsize) counts[i] * kind->item_bytes[i];
  return size + (kind == &dots_kind ? (gsize) counts[2] * 4 * n_colours : 0);
}

static gsize
padded (gsize size)
{
  return (size + 3) & ~(gsize) 3;
}

static gboolean
all_finite (const gfloat * values, gsize n)
{
  for (gsize i = 0; i < n; i++)
    if (!isfinite (values[i]))
      return FALSE;
  return TRUE;
}

static gboolean
quad_is_valid (const GstClothQuad * quad, guint columns, guint rows)
{
  return quad->column >= 0 && (guint) quad->column < columns && quad->row >= 0
      && (guint) quad->row < rows && (guint) quad->state <= GST_CLOTH_QUAD_LOST
      && isfinite (quad->confidence) && all_finite (quad->x, 4)
      && all_finite (quad->y, 4) && all_finite (quad->cov_xx, 4)
      && all_finite (quad->cov_xy, 4) && all_finite (quad->cov_yy, 4);
}

/* A dot has both numbers of its label or neither. */
static gboolean
dot_is_valid (const GstClothDot * dot, guint columns, guint rows,
    guint n_colours)
{
  const gboolean inside = dot->column >= 0 && (guint) dot->column < columns
      && dot->row >= 0 && (guint) dot->row < rows;
  const gfloat floats[6] = { dot->confidence, dot->x, dot->y, dot->cov_xx,
    dot->cov_xy, dot->cov_yy
  };

  return (inside || (dot->column == -1 && dot->row == -1))
      && all_finite (floats, 6) && all_finite (dot->log_likelihood, n_colours);
}

static gboolean
match_is_valid (const GstClothMatch * match)
{
  const gfloat floats[6] = { match->x, match->y, match->u, match->v,
    match->scale, match->distance
  };

  return all_finite (floats, 6);
}

static gboolean
grid_point_is_valid (const GstClothGridPoint * point, guint columns, guint rows)
{
  const gfloat floats[5] = { point->x, point->y, point->cov_xx, point->cov_xy,
    point->cov_yy
  };

  return point->column >= 0 && (guint) point->column < columns
      && point->row >= 0 && (guint) point->row < rows && all_finite (floats, 5);
}

/* Writing */

static void
put_u16 (GByteArray * bytes, guint value)
{
  guint16 le = GUINT16_TO_LE ((guint16) value);

  g_byte_array_append (bytes, (guint8 *) & le, 2);
}

static void
put_u32 (GByteArray * bytes, guint32 value)
{
  guint32 le = GUINT32_TO_LE (value);

  g_byte_array_append (bytes, (guint8 *) & le, 4);
}

static void
put_u64 (GByteArray * bytes, guint64 value)
{
  guint64 le = GUINT64_TO_LE (value);

  g_byte_array_append (bytes, (guint8 *) & le, 8);
}

static void
put_floats (GByteArray * bytes, const gfloat * values, guint n)
{
  guint at = bytes->len;

  g_byte_array_set_size (bytes, at + 4 * n);
  gst_cloth_copy_le32 (bytes->data + at, values, n);
}

static void
put_string (GByteArray * bytes, const gchar * string)
{
  static const guint8 zeros[4] = { 0 };
  gsize n = strlen (string);

  g_byte_array_append (bytes, (const guint8 *) string, (guint) n);
  g_byte_array_append (bytes, zeros, (guint) (padded (n) - n));
}

/* Returns where the section's size is to be put by end_section (). */
static guint
begin_section (GByteArray * bytes, const gchar * tag)
{
  g_byte_array_append (bytes, (const guint8 *) tag, 4);
  put_u32 (bytes, 0);
  return bytes->len;
}

static void
end_section (GByteArray * bytes, guint start, guint * n_sections)
{
  GST_WRITE_UINT32_LE (bytes->data + start - 4, bytes->len - start);
  (*n_sections)++;
}

/* What a section of features begins with; the counts of what follows are still 0. */
static guint
begin_features (GByteArray * bytes, const FeatureKind * kind,
    guint64 sequence, const gchar * camera, guint columns, guint rows,
    guint extra)
{
  const guint counts[MAX_COUNTS] = { columns, rows };
  guint start = begin_section (bytes, kind->tag);

  put_u64 (bytes, sequence);
  for (guint i = 0; i < kind->n_counts; i++)
    put_u32 (bytes, counts[i]);
  put_u16 (bytes, (guint) strlen (camera));
  put_u16 (bytes, extra);
  put_string (bytes, camera);
  return start;
}

static void
set_count (GByteArray * bytes, guint start, guint i, guint n)
{
  GST_WRITE_UINT32_LE (bytes->data + start + 8 + 4 * i, n);
}

/* Items of @n_floats each; one with a float that isn't finite is left out. */
static guint
put_finite (GByteArray * bytes, const gfloat * items, guint n_items,
    guint n_floats)
{
  guint n = 0;

  for (guint i = 0; i < n_items; i++, items += n_floats) {
    if (all_finite (items, n_floats)) {
      put_floats (bytes, items, n_floats);
      n++;
    }
  }
  return n;
}

static void
put_saddles (GByteArray * bytes, const GstClothSaddles * saddles,
    guint * n_sections)
{
  guint n_refined, n_candidates, start;
  const GstClothSaddle *refined = gst_cloth_saddles_get_refined (saddles,
      &n_refined);
  const GstClothCandidate *candidates =
      gst_cloth_saddles_get_candidates (saddles, &n_candidates);

  start = begin_features (bytes, &saddles_kind,
      gst_cloth_saddles_get_sequence (saddles),
      gst_cloth_saddles_get_camera (saddles), 0, 0, 0);
  set_count (bytes, start, 0,
      put_finite (bytes, (const gfloat *) refined, n_refined, 7));
  set_count (bytes, start, 1,
      put_finite (bytes, (const gfloat *) candidates, n_candidates, 3));
  end_section (bytes, start, n_sections);
}

static void
put_quads (GByteArray * bytes, const GstClothQuads * quads, guint * n_sections)
{
  guint columns = gst_cloth_quads_get_columns (quads);
  guint rows = gst_cloth_quads_get_rows (quads);
  guint n_quads, start, n_places = 0, n = 0;
  const GstClothQuad *quad = gst_cloth_quads_get_quads (quads, &n_quads);
  g_autofree guint64 *places = g_new (guint64, n_quads);
  g_autofree guint8 *left_out = g_new0 (guint8, n_quads);

  for (guint i = 0; i < n_quads; i++) {
    left_out[i] = !quad_is_valid (&quad[i], columns, rows);
    if (!left_out[i])
      places[n_places++] =
          gst_cloth_place (quad[i].column, quad[i].row, columns, i);
  }
  gst_cloth_places_mark_repeated (places, n_places, left_out);
  start = begin_features (bytes, &quads_kind,
      gst_cloth_quads_get_sequence (quads), gst_cloth_quads_get_camera (quads),
      columns, rows, 0);
  for (guint i = 0; i < n_quads; i++, quad++) {
    guint8 state[4] = { (guint8) quad->state, quad->black ? 1 : 0, 0, 0 };

    if (left_out[i])
      continue;
    put_u32 (bytes, (guint32) quad->column);
    put_u32 (bytes, (guint32) quad->row);
    g_byte_array_append (bytes, state, 4);
    put_floats (bytes, &quad->confidence, 1);
    for (guint c = 0; c < 4; c++) {
      gfloat corner[5] = { quad->x[c], quad->y[c], quad->cov_xx[c],
        quad->cov_xy[c], quad->cov_yy[c]
      };

      put_floats (bytes, corner, 5);
    }
    n++;
  }
  set_count (bytes, start, 2, n);
  end_section (bytes, start, n_sections);
}

static void
put_dots (GByteArray * bytes, const GstClothDots * dots, guint * n_sections)
{
  guint columns = gst_cloth_dots_get_columns (dots);
  guint rows = gst_cloth_dots_get_rows (dots);
  guint n_colours = gst_cloth_dots_get_n_colours (dots);
  guint n_dots, start, n_places = 0, n = 0;
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n_dots);
  g_autofree guint64 *places = g_new (guint64, n_dots);
  g_autofree guint8 *left_out = g_new0 (guint8, n_dots);

  for (guint i = 0; i < n_dots; i++) {
    left_out[i] = !dot_is_valid (&dot[i], columns, rows, n_colours);
    if (!left_out[i] && dot[i].column >= 0)
      places[n_places++] =
          gst_cloth_place (dot[i].column, dot[i].row, columns, i);
  }
  gst_cloth_places_mark_repeated (places, n_places, left_out);
  start = begin_features (bytes, &dots_kind,
      gst_cloth_dots_get_sequence (dots), gst_cloth_dots_get_camera (dots),
      columns, rows, n_colours);
  for (guint i = 0; i < n_dots; i++, dot++) {
    const guint8 flags[4] =
        { dot->mirrored ? 1 : 0, dot->touches ? 1 : 0, 0, 0 };
    const gfloat floats[6] = { dot->confidence, dot->x, dot->y, dot->cov_xx,
      dot->cov_xy, dot->cov_yy
    };

    if (left_out[i])
      continue;
    put_u32 (bytes, (guint32) dot->column);
    put_u32 (bytes, (guint32) dot->row);
    g_byte_array_append (bytes, flags, 4);
    put_floats (bytes, floats, 6);
    put_floats (bytes, dot->log_likelihood, n_colours);
    n++;
  }
  set_count (bytes, start, 2, n);
  end_section (bytes, start, n_sections);
}

static void
put_silhouette (GByteArray * bytes, const GstClothSilhouette * silhouette,
    guint * n_sections)
{
  guint n, start;
  const GstClothRun *run = gst_cloth_silhouette_get_runs (silhouette, &n);

  start = begin_features (bytes, &silhouette_kind,
      gst_cloth_silhouette_get_sequence (silhouette),
      gst_cloth_silhouette_get_camera (silhouette),
      gst_cloth_silhouette_get_width (silhouette),
      gst_cloth_silhouette_get_height (silhouette), 0);
  for (guint i = 0; i < n; i++, run++) {
    put_u16 (bytes, run->row);
    put_u16 (bytes, run->begin);
    put_u16 (bytes, run->end);
  }
  if (n % 2)
    put_u16 (bytes, 0);
  set_count (bytes, start, 2, n);
  end_section (bytes, start, n_sections);
}

static void
put_matches (GByteArray * bytes, const GstClothMatches * matches,
    guint * n_sections)
{
  guint columns = gst_cloth_matches_get_columns (matches);
  guint rows = gst_cloth_matches_get_rows (matches);
  guint n_matches, n_points, start, n_places = 0, n = 0;
  const GstClothMatch *match = gst_cloth_matches_get_matches (matches,
      &n_matches);
  const GstClothGridPoint *point = gst_cloth_matches_get_points (matches,
      &n_points);
  g_autofree guint64 *places = g_new (guint64, n_points);
  g_autofree guint8 *left_out = g_new0 (guint8, n_points);

  start = begin_features (bytes, &matches_kind,
      gst_cloth_matches_get_sequence (matches),
      gst_cloth_matches_get_camera (matches), columns, rows,
      gst_cloth_matches_get_on_surface (matches));
  for (guint i = 0; i < n_matches; i++, match++) {
    const guint8 flags[4] = { match->oblique ? 1 : 0, match->mirrored ? 1 : 0,
      match->verified ? 1 : 0, 0
    };
    const gfloat floats[6] = { match->x, match->y, match->u, match->v,
      match->scale, match->distance
    };

    if (!match_is_valid (match))
      continue;
    put_floats (bytes, floats, 6);
    put_u32 (bytes, match->group);
    g_byte_array_append (bytes, flags, 4);
    n++;
  }
  set_count (bytes, start, 2, gst_cloth_matches_get_n_features (matches));
  set_count (bytes, start, 3, n);

  for (guint i = 0; i < n_points; i++) {
    left_out[i] = !grid_point_is_valid (&point[i], columns, rows);
    if (!left_out[i])
      places[n_places++] =
          gst_cloth_place (point[i].column, point[i].row, columns, i);
  }
  gst_cloth_places_mark_repeated (places, n_places, left_out);
  n = 0;
  for (guint i = 0; i < n_points; i++, point++) {
    const guint8 flags[4] = { point->mirrored ? 1 : 0, 0, 0, 0 };
    const gfloat floats[5] = { point->x, point->y, point->cov_xx,
      point->cov_xy, point->cov_yy
    };

    if (left_out[i])
      continue;
    put_u32 (bytes, (guint32) point->column);
    put_u32 (bytes, (guint32) point->row);
    g_byte_array_append (bytes, flags, 4);
    put_floats (bytes, floats, 5);
    n++;
  }
  set_count (bytes, start, 4, n);
  end_section (bytes, start, n_sections);
}

/* A reference is written as the text of its caps: these are the characters that such
 * caps need (timestamp/x-ntp; timestamp/x-ptp, version=(string)IEEE1588-2008). */
static gboolean
reference_is_plain (const gchar * text, gsize length)
{
  if (length < 1 || length > MAX_REFERENCE)
    return FALSE;
  for (gsize i = 0; i < length; i++)
    if (!g_ascii_isalnum (text[i]) && !(text[i] && strchr ("/_-+.:, =()",
                text[i])))
      return FALSE;
  return TRUE;
}

/* What a reader would pass over need not be written. */
static gboolean
reference_is_known (const gchar * text)
{
  g_autoptr (GstCaps) caps = gst_cloth_clock_from_text (text, strlen (text));

  return caps != NULL;
}

static void
put_times (GByteArray * bytes, GstBuffer * buffer, guint * n_sections)
{
  gpointer iterator = NULL;
  GstMeta *meta;
  guint n = 0;

  while (n < MAX_TIMES && (meta = gst_buffer_iterate_meta_filtered (buffer,
              &iterator, GST_REFERENCE_TIMESTAMP_META_API_TYPE))) {
    GstReferenceTimestampMeta *time = (GstReferenceTimestampMeta *) meta;
    g_autofree gchar *reference = gst_caps_to_string (time->reference);
    guint start;

    if (!GST_CLOCK_TIME_IS_VALID (time->timestamp)
        || !reference_is_plain (reference, strlen (reference))
        || !reference_is_known (reference))
      continue;
    start = begin_section (bytes, SECTION_TIME);
    put_u64 (bytes, time->timestamp);
    put_u64 (bytes, time->duration);
    put_u32 (bytes, (guint32) strlen (reference));
    put_string (bytes, reference);
    end_section (bytes, start, n_sections);
    n++;
  }
}

/**
 * gst_cloth_observations_pack:
 * @buffer: a buffer with cloth metas
 *
 * Writes what was seen in a picture, without the picture: the saddles, the quads, the dots,
 * the silhouette and the matches on @buffer, with camera and sequence number, and its
 * #GstReferenceTimestampMeta. A feature with a float that isn't finite, a quad, dot or vertex
 * outside its pattern or at the place of an earlier one, and a reference clock that isn't one
 * of GStreamer's own are left out. Disparities are no part of a stream. @buffer without any
 * such meta gives a buffer without sections.
 *
 * Returns: (transfer full): a new buffer in the layout of the observation stream, with
 *   the time stamps and the flags of @buffer
 *
 * Since: 0.1
 */
GstBuffer *
gst_cloth_observations_pack (GstBuffer * buffer)
{
  GstClothSaddles *saddles;
  GstClothQuads *quads;
  GstClothDots *dots;
  GstClothSilhouette *silhouette;
  GstClothMatches *matches;
  GByteArray *bytes;
  GstBuffer *observation;
  guint n_sections = 0;
  gsize size = OBSERVATIONS_HEADER + 512;

  g_return_val_if_fail (GST_IS_BUFFER (buffer), NULL);

  saddles = gst_buffer_get_cloth_saddles (buffer);
  quads = gst_buffer_get_cloth_quads (buffer);
  dots = gst_buffer_get_cloth_dots (buffer);
  silhouette = gst_buffer_get_cloth_silhouette (buffer);
  matches = gst_buffer_get_cloth_matches (buffer);
  if (saddles)
    size += sizeof (GstClothSaddle) * gst_cloth_saddles_get_n_refined (saddles)
        + sizeof (GstClothCandidate)
        * gst_cloth_saddles_get_n_candidates (saddles);
  if (quads)
    size += sizeof (GstClothQuad) * gst_cloth_quads_get_n_quads (quads);
  if (dots)
    size += sizeof (GstClothDot) * gst_cloth_dots_get_n_dots (dots);
  if (silhouette)
    size += sizeof (GstClothRun) * gst_cloth_silhouette_get_n_runs (silhouette);
  if (matches)
    size += sizeof (GstClothMatch) * gst_cloth_matches_get_n_matches (matches)
        + sizeof (GstClothGridPoint) * gst_cloth_matches_get_n_points (matches);

  bytes = g_byte_array_sized_new ((guint) size);
  g_byte_array_append (bytes, (const guint8 *) OBSERVATIONS_MAGIC, 4);
  put_u16 (bytes, OBSERVATIONS_VERSION);
  put_u16 (bytes, OBSERVATIONS_HEADER);
  put_u32 (bytes, 0);
  put_u32 (bytes, 0);
  put_u64 (bytes, GST_BUFFER_PTS (buffer));
  put_u64 (bytes, GST_BUFFER_DURATION (buffer));
  put_times (bytes, buffer, &n_sections);
  if (saddles)
    put_saddles (bytes, saddles, &n_sections);
  if (quads)
    put_quads (bytes, quads, &n_sections);
  if (dots)
    put_dots (bytes, dots, &n_sections);
  if (silhouette)
    put_silhouette (bytes, silhouette, &n_sections);
  if (matches)
    put_matches (bytes, matches, &n_sections);
  GST_WRITE_UINT32_LE (bytes->data + 8, bytes->len);
  GST_WRITE_UINT32_LE (bytes->data + 12, n_sections);

  size = bytes->len;
  observation = gst_buffer_new_wrapped (g_byte_array_free (bytes, FALSE), size);
  gst_buffer_copy_into (observation, buffer, GST_BUFFER_COPY_FLAGS
      | GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
  return observation;
}

/* Reading */

typedef struct
{
  const guint8 *data;
  gsize size;
} Section;

typedef struct
{
  GstClothSaddles *saddles;
  GstClothQuads *quads;
  GstClothDots *dots;
  GstClothSilhouette *silhouette;
  GstClothMatches *matches;
  GstCaps *references[MAX_TIMES];
  guint64 timestamps[MAX_TIMES];
  guint64 durations[MAX_TIMES];
  guint n_times;
} Observed;

static void
observed_clear (Observed * observed)
{
  g_clear_pointer (&observed->saddles, gst_cloth_saddles_unref);
  g_clear_pointer (&observed->quads, gst_cloth_quads_unref);
  g_clear_pointer (&observed->dots, gst_cloth_dots_unref);
  g_clear_pointer (&observed->silhouette, gst_cloth_silhouette_unref);
  g_clear_pointer (&observed->matches, gst_cloth_matches_unref);
  while (observed->n_times)
    gst_caps_unref (observed->references[--observed->n_times]);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Observed, observed_clear);

static gboolean
fail (GError ** error, GstClothError code, const gchar * what,
    const gchar * problem)
{
  g_set_error (error, GST_CLOTH_ERROR, code, "In the section %s of the "
      "observation: %s", what, problem);
  return FALSE;
}

typedef struct
{
  guint64 sequence;
  guint counts[MAX_COUNTS];
  guint extra;
  gchar camera[GST_CLOTH_MAX_CAMERA_NAME + 1];
  const guint8 *items;
} Features;

/* What begin_features () has written. @has: whether there was such a section before. */
static gboolean
read_features (const Section * section, const FeatureKind * kind,
    gboolean has, Features * features, GError ** error)
{
  const guint8 *at = section->data;
  const gchar *tag = kind->tag, *name;
  gsize header = 12 + 4 * kind->n_counts, size;
  guint length;

  if (has)
    return fail (error, GST_CLOTH_ERROR_VALUE, tag, "there are two of them");
  if (section->size < header)
    return fail (error, GST_CLOTH_ERROR_TRUNCATED, tag,
        "it ends inside its header");
  features->sequence = gst_cloth_read_u64 (at);
  for (guint i = 0; i < kind->n_counts; i++) {
    features->counts[i] = gst_cloth_read_u32 (at + 8 + 4 * i);
    if (features->counts[i] > kind->most[i])
      return fail (error, GST_CLOTH_ERROR_LIMIT, tag, kind->too_many);
  }
  length = gst_cloth_read_u16 (at + header - 4);
  features->extra = gst_cloth_read_u16 (at + header - 2);
  if (kind == &dots_kind && features->extra > GST_CLOTH_DOT_MAX_COLOURS)
    return fail (error, GST_CLOTH_ERROR_LIMIT, tag,
        "there are more than 8 colours");

  name = (const gchar *) at + header;
  if (length > GST_CLOTH_MAX_CAMERA_NAME)
    return fail (error, GST_CLOTH_ERROR_LIMIT, tag,
        "the camera's name is too long");
  if (section->size - header < padded (length))
    return fail (error, GST_CLOTH_ERROR_TRUNCATED, tag,
        "it ends inside the camera's name");
  if (length && !g_utf8_validate_len (name, length, NULL))
    return fail (error, GST_CLOTH_ERROR_VALUE, tag,
        "the camera's name is not UTF-8");
  memcpy (features->camera, name, length);

  size = header + padded (length) + padded (items_size (kind,
          features->counts, features->extra));
  if (section->size != size)
    return fail (error, section->size < size ? GST_CLOTH_ERROR_TRUNCATED :
        GST_CLOTH_ERROR_VALUE, tag,
        "its size is not that of what it announces");
  features->items = at + header + padded (length);
  return TRUE;
}

static gboolean
read_finite (gfloat * items, const guint8 * at, guint n_floats, GError ** error)
{
  if (n_floats)
    gst_cloth_copy_le32 (items, at, n_floats);
  return all_finite (items, n_floats) || fail (error, GST_CLOTH_ERROR_VALUE,
      saddles_kind.tag, "a float is not finite");
}

static gboolean
read_saddles (const Section * section, Observed * observed, GError ** error)
{
  Features features = { 0 };
  g_autofree GstClothSaddle *refined = NULL;
  g_autofree GstClothCandidate *candidates = NULL;
  guint n_refined, n_candidates;

  if (!read_features (section, &saddles_kind, observed->saddles != NULL,
          &features, error))
    return FALSE;
  n_refined = features.counts[0];
  n_candidates = features.counts[1];

  refined = g_new (GstClothSaddle, n_refined);
  candidates = g_new (GstClothCandidate, n_candidates);
  if (!read_finite ((gfloat *) refined, features.items, 7 * n_refined, error)
      || !read_finite ((gfloat *) candidates, features.items
          + n_refined * sizeof *refined, 3 * n_candidates, error))
    return FALSE;
  observed->saddles = gst_cloth_saddles_new (features.camera,
      features.sequence, refined, n_refined, candidates, n_candidates);
  return TRUE;
}

static gboolean
read_quads (const Section * section, Observed * observed, GError ** error)
{
  Features features = { 0 };
  g_autofree GstClothQuad *quads = NULL;
  g_autofree guint64 *places = NULL;
  const guint8 *at;
  guint columns, rows, n_quads;

  if (!read_features (section, &quads_kind, observed->quads != NULL, &features,
          error))
    return FALSE;
  columns = features.counts[0];
  rows = features.counts[1];
  n_quads = features.counts[2];

  at = features.items;
  quads = g_new0 (GstClothQuad, n_quads);
  places = g_new (guint64, n_quads);
  for (guint i = 0; i < n_quads; i++, at += quads_kind.item_bytes[2]) {
    GstClothQuad *quad = &quads[i];

    quad->column = (gint) MIN (gst_cloth_read_u32 (at), (guint) G_MAXINT);
    quad->row = (gint) MIN (gst_cloth_read_u32 (at + 4), (guint) G_MAXINT);
    quad->state = (GstClothQuadState) at[8];
    quad->black = at[9];
    gst_cloth_copy_le32 (&quad->confidence, at + 12, 1);
    for (guint c = 0; c < 4; c++) {
      gfloat corner[5];

      gst_cloth_copy_le32 (corner, at + 16 + 20 * c, 5);
      quad->x[c] = corner[0];
      quad->y[c] = corner[1];
      quad->cov_xx[c] = corner[2];
      quad->cov_xy[c] = corner[3];
      quad->cov_yy[c] = corner[4];
    }
    if (!quad_is_valid (quad, columns, rows) || at[9] > 1)
      return fail (error, GST_CLOTH_ERROR_VALUE, quads_kind.tag,
          "a quad lies outside the board, has an unknown state or a float that "
          "is not finite");
    places[i] = gst_cloth_place (quad->column, quad->row, columns, i);
  }
  if (!gst_cloth_places_sort (places, n_quads))
    return fail (error, GST_CLOTH_ERROR_VALUE, quads_kind.tag,
        "two quads have the same column and row");
  observed->quads =
      gst_cloth_quads_new (features.camera, features.sequence, columns, rows,
      quads, n_quads);
  return TRUE;
}

static gboolean
read_dots (const Section * section, Observed * observed, GError ** error)
{
  Features features = { 0 };
  g_autofree GstClothDot *dots = NULL;
  g_autofree guint64 *places = NULL;
  const guint8 *at;
  guint columns, rows, n_dots, n_colours, n_places = 0;

  if (!read_features (section, &dots_kind, observed->dots != NULL, &features,
          error))
    return FALSE;
  columns = features.counts[0];
  rows = features.counts[1];
  n_dots = features.counts[2];
  n_colours = features.extra;

  at = features.items;
  dots = g_new0 (GstClothDot, n_dots);
  places = g_new (guint64, n_dots);
  for (guint i = 0; i < n_dots;
      i++, at += dots_kind.item_bytes[2] + 4 * n_colours) {
    GstClothDot *dot = &dots[i];
    gfloat floats[6];

    dot->column = (gint) gst_cloth_read_u32 (at);
    dot->row = (gint) gst_cloth_read_u32 (at + 4);
    dot->mirrored = at[8];
    dot->touches = at[9];
    gst_cloth_copy_le32 (floats, at + 12, 6);
    dot->confidence = floats[0];
    dot->x = floats[1];
    dot->y = floats[2];
    dot->cov_xx = floats[3];
    dot->cov_xy = floats[4];
    dot->cov_yy = floats[5];
    gst_cloth_copy_le32 (dot->log_likelihood, at + 36, n_colours);
    if (!dot_is_valid (dot, columns, rows, n_colours) || at[8] > 1 || at[9] > 1)
      return fail (error, GST_CLOTH_ERROR_VALUE, dots_kind.tag,
          "a dot lies outside the pattern, has an unknown flag or a float that "
          "is not finite");
    if (dot->column >= 0)
      places[n_places++] = gst_cloth_place (dot->column, dot->row, columns, i);
  }
  if (!gst_cloth_places_sort (places, n_places))
    return fail (error, GST_CLOTH_ERROR_VALUE, dots_kind.tag,
        "two dots have the same label");
  observed->dots =
      gst_cloth_dots_new (features.camera, features.sequence, columns, rows,
      n_colours, dots, n_dots);
  return TRUE;
}

static gboolean
read_silhouette (const Section * section, Observed * observed, GError ** error)
{
  Features features = { 0 };
  g_autofree GstClothRun *runs = NULL;
  const guint8 *at;
  guint width, height, n_runs;

  if (!read_features (section, &silhouette_kind, observed->silhouette != NULL,
          &features, error))
    return FALSE;
  width = features.counts[0];
  height = features.counts[1];
  n_runs = features.counts[2];

  at = features.items;
  runs = g_new (GstClothRun, n_runs);
  for (guint i = 0; i < n_runs; i++, at += silhouette_kind.item_bytes[2])
    runs[i] = (GstClothRun) {
    gst_cloth_read_u16 (at), gst_cloth_read_u16 (at + 2),
        gst_cloth_read_u16 (at + 4)};
  if (!gst_cloth_silhouette_runs_are_valid (width, height, runs, n_runs))
    return fail (error, GST_CLOTH_ERROR_VALUE, silhouette_kind.tag,
        "a run is empty, lies outside the picture or is not after the one before "
        "it, or there is no picture");
  observed->silhouette = gst_cloth_silhouette_new (features.camera,
      features.sequence, width, height, runs, n_runs);
  return TRUE;
}

static gboolean
read_matches (const Section * section, Observed * observed, GError ** error)
{
  const gchar *tag = matches_kind.tag;
  Features features = { 0 };
  g_autofree GstClothMatch *matches = NULL;
  g_autofree GstClothGridPoint *points = NULL;
  g_autofree guint64 *places = NULL;
  const guint8 *at;
  guint columns, rows, n_matches, n_points;

  if (!read_features (section, &matches_kind, observed->matches != NULL,
          &features, error))
    return FALSE;
  columns = features.counts[0];
  rows = features.counts[1];
  n_matches = features.counts[3];
  n_points = features.counts[4];
  if (features.extra > 1)
    return fail (error, GST_CLOTH_ERROR_VALUE, tag,
        "it is neither along a surface nor by the picture only");

  at = features.items;
  matches = g_new0 (GstClothMatch, n_matches);
  for (guint i = 0; i < n_matches; i++, at += matches_kind.item_bytes[3]) {
    GstClothMatch *match = &matches[i];
    gfloat floats[6];

    gst_cloth_copy_le32 (floats, at, 6);
    match->x = floats[0];
    match->y = floats[1];
    match->u = floats[2];
    match->v = floats[3];
    match->scale = floats[4];
    match->distance = floats[5];
    match->group = gst_cloth_read_u32 (at + 24);
    match->oblique = at[28];
    match->mirrored = at[29];
    match->verified = at[30];
    if (!match_is_valid (match) || at[28] > 1 || at[29] > 1 || at[30] > 1)
      return fail (error, GST_CLOTH_ERROR_VALUE, tag,
          "a match has an unknown flag or a float that is not finite");
  }

  points = g_new0 (GstClothGridPoint, n_points);
  places = g_new (guint64, n_points);
  for (guint i = 0; i < n_points; i++, at += matches_kind.item_bytes[4]) {
    GstClothGridPoint *point = &points[i];
    gfloat floats[5];

    point->column = (gint) MIN (gst_cloth_read_u32 (at), (guint) G_MAXINT);
    point->row = (gint) MIN (gst_cloth_read_u32 (at + 4), (guint) G_MAXINT);
    point->mirrored = at[8];
    gst_cloth_copy_le32 (floats, at + 12, 5);
    point->x = floats[0];
    point->y = floats[1];
    point->cov_xx = floats[2];
    point->cov_xy = floats[3];
    point->cov_yy = floats[4];
    if (!grid_point_is_valid (point, columns, rows) || at[8] > 1)
      return fail (error, GST_CLOTH_ERROR_VALUE, tag,
          "a vertex lies outside the pattern, has an unknown flag or a float "
          "that is not finite");
    places[i] = gst_cloth_place (point->column, point->row, columns, i);
  }
  if (!gst_cloth_places_sort (places, n_points))
    return fail (error, GST_CLOTH_ERROR_VALUE, tag,
        "two vertices have the same column and row");
  observed->matches = gst_cloth_matches_new (features.camera,
      features.sequence, columns, rows, features.counts[2],
      features.extra != 0, matches, n_matches, points, n_points);
  return TRUE;
}

static gboolean
read_time (const Section * section, Observed * observed, GError ** error)
{
  const gchar *text;
  GstCaps *reference;
  guint length;

  if (observed->n_times == MAX_TIMES)
    return fail (error, GST_CLOTH_ERROR_LIMIT, SECTION_TIME,
        "there are more than 16 of them");
  if (section->size < TIME_HEADER)
    return fail (error, GST_CLOTH_ERROR_TRUNCATED, SECTION_TIME,
        "it ends inside its header");
  length = gst_cloth_read_u32 (section->data + 16);
  if (length > MAX_REFERENCE)
    return fail (error, GST_CLOTH_ERROR_LIMIT, SECTION_TIME,
        "the caps of the reference clock are too long");
  if (section->size != TIME_HEADER + padded (length))
    return fail (error, GST_CLOTH_ERROR_TRUNCATED, SECTION_TIME,
        "its size is not that of what it announces");
  text = (const gchar *) section->data + TIME_HEADER;
  if (!reference_is_plain (text, length)
      || gst_cloth_read_u64 (section->data) == GST_CLOCK_TIME_NONE)
    return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_TIME,
        "the reference clock is no plain text, or there is no time");
  reference = gst_cloth_clock_from_text (text, length);
  if (!reference)
    return TRUE;                /* of a clock that this library doesn't know */
  observed->references[observed->n_times] = reference;
  observed->timestamps[observed->n_times] = gst_cloth_read_u64 (section->data);
  observed->durations[observed->n_times] =
      gst_cloth_read_u64 (section->data + 8);
  observed->n_times++;
  return TRUE;
}

static gboolean
read_section (const guint8 * tag, const Section * section,
    Observed * observed, GError ** error)
{
  if (memcmp (tag, saddles_kind.tag, 4) == 0)
    return read_saddles (section, observed, error);
  if (memcmp (tag, quads_kind.tag, 4) == 0)
    return read_quads (section, observed, error);
  if (memcmp (tag, dots_kind.tag, 4) == 0)
    return read_dots (section, observed, error);
  if (memcmp (tag, silhouette_kind.tag, 4) == 0)
    return read_silhouette (section, observed, error);
  if (memcmp (tag, matches_kind.tag, 4) == 0)
    return read_matches (section, observed, error);
  if (memcmp (tag, SECTION_TIME, 4) == 0)
    return read_time (section, observed, error);
  return TRUE;                  /* of a later library */
}

static gboolean
read_observation (const guint8 * bytes, gsize size, Observed * observed,
    GError ** error)
{
  guint n_sections;
  gsize at = OBSERVATIONS_HEADER;

  if (!gst_cloth_check_header (bytes, size, OBSERVATIONS_MAGIC,
          OBSERVATIONS_VERSION, OBSERVATIONS_HEADER, "observation", error)
      || !gst_cloth_check_size (size, gst_cloth_read_u32 (bytes + 8),
          "observation", error))
    return FALSE;
  n_sections = gst_cloth_read_u32 (bytes + 12);
  if (n_sections > MAX_SECTIONS)
    return fail (error, GST_CLOTH_ERROR_LIMIT, "count",
        "there are more than 64 sections");
  for (guint i = 0; i < n_sections; i++) {
    Section section;

    if (size - at < SECTION_HEADER)
      return fail (error, GST_CLOTH_ERROR_TRUNCATED, "list",
          "the bytes end before the last section");
    section.data = bytes + at + SECTION_HEADER;
    section.size = gst_cloth_read_u32 (bytes + at + 4);
    if (section.size > size - at - SECTION_HEADER)
      return fail (error, GST_CLOTH_ERROR_TRUNCATED, "list",
          "a section is longer than what remains");
    if (section.size % 4)
      return fail (error, GST_CLOTH_ERROR_VALUE, "list",
          "the size of a section is no multiple of 4");
    if (!read_section (bytes + at, &section, observed, error))
      return FALSE;
    at += SECTION_HEADER + section.size;
  }
  if (at != size)
    return fail (error, GST_CLOTH_ERROR_VALUE, "list",
        "there are bytes after the last section");
  return TRUE;
}

/**
 * gst_cloth_observations_unpack:
 * @observation: a buffer of an observation stream
 * @target: a writable buffer, which may be @observation itself
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * Puts on @target the metas that @observation holds: saddles, quads, dots, a silhouette,
 * matches and reference time stamps. Sections of a kind that this library doesn't know are
 * passed over, and so are times of a clock that it doesn't know. Time stamps and flags of @target stay.
 *
 * Returns: %FALSE with @error set, and @target as it was, when the bytes are no valid
 *   observation
 *
 * Since: 0.1
 */
gboolean
gst_cloth_observations_unpack (GstBuffer * observation, GstBuffer * target,
    GError ** error)
{
  g_auto (Observed) observed = { NULL };
  GstMapInfo map;
  gboolean valid;

  g_return_val_if_fail (GST_IS_BUFFER (observation), FALSE);
  g_return_val_if_fail (GST_IS_BUFFER (target)
      && gst_buffer_is_writable (target), FALSE);

  if (!gst_cloth_map (observation, &map, error))
    return FALSE;
  valid = read_observation (map.data, map.size, &observed, error);
  gst_buffer_unmap (observation, &map);
  if (!valid)
    return FALSE;

  for (guint i = 0; i < observed.n_times; i++)
    gst_buffer_add_reference_timestamp_meta (target, observed.references[i],
        observed.timestamps[i], observed.durations[i]);
  if (observed.saddles)
    gst_buffer_add_cloth_saddles_meta (target,
        g_steal_pointer (&observed.saddles));
  if (observed.quads)
    gst_buffer_add_cloth_quads_meta (target, g_steal_pointer (&observed.quads));
  if (observed.dots)
    gst_buffer_add_cloth_dots_meta (target, g_steal_pointer (&observed.dots));
  if (observed.silhouette)
    gst_buffer_add_cloth_silhouette_meta (target,
        g_steal_pointer (&observed.silhouette));
  if (observed.matches)
    gst_buffer_add_cloth_matches_meta (target,
        g_steal_pointer (&observed.matches));
  return TRUE;
}
