/* One frame of an observation stream: sections of what a camera saw.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothprivate.h"

/* docs/streams.md holds the layout, byte by byte. */
#define OBSERVATIONS_MAGIC "GCOB"
#define OBSERVATIONS_VERSION 1
#define OBSERVATIONS_HEADER 32
#define MAX_SECTIONS 64
#define MAX_TIMES 16
#define MAX_REFERENCE 255

#define SECTION_HEADER 8
#define SECTION_SADDLES "SADL"
#define SECTION_QUADS "QUAD"
#define SECTION_DOTS "DOTS"
#define SECTION_TIME "TIME"
#define SADDLES_HEADER 20
#define QUADS_HEADER 24
#define DOTS_HEADER 24
#define TIME_HEADER 20
#define SADDLE_BYTES 28
#define CANDIDATE_BYTES 12
#define QUAD_BYTES 96
#define DOT_BYTES(n_colours) (36 + 4 * (n_colours))

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

static void
put_saddles (GByteArray * bytes, const GstClothSaddles * saddles,
    guint * n_sections)
{
  const gchar *camera = gst_cloth_saddles_get_camera (saddles);
  guint n_refined, n_candidates, n, start;
  const GstClothSaddle *refined = gst_cloth_saddles_get_refined (saddles,
      &n_refined);
  const GstClothCandidate *candidates =
      gst_cloth_saddles_get_candidates (saddles, &n_candidates);

  start = begin_section (bytes, SECTION_SADDLES);
  put_u64 (bytes, gst_cloth_saddles_get_sequence (saddles));
  put_u32 (bytes, 0);
  put_u32 (bytes, 0);
  put_u16 (bytes, (guint) strlen (camera));
  put_u16 (bytes, 0);
  put_string (bytes, camera);
  n = 0;
  for (guint i = 0; i < n_refined; i++) {
    if (all_finite ((const gfloat *) &refined[i], 7)) {
      put_floats (bytes, (const gfloat *) &refined[i], 7);
      n++;
    }
  }
  GST_WRITE_UINT32_LE (bytes->data + start + 8, n);
  n = 0;
  for (guint i = 0; i < n_candidates; i++) {
    if (all_finite ((const gfloat *) &candidates[i], 3)) {
      put_floats (bytes, (const gfloat *) &candidates[i], 3);
      n++;
    }
  }
  GST_WRITE_UINT32_LE (bytes->data + start + 12, n);
  end_section (bytes, start, n_sections);
}

static void
put_quads (GByteArray * bytes, const GstClothQuads * quads, guint * n_sections)
{
  const gchar *camera = gst_cloth_quads_get_camera (quads);
  guint columns = gst_cloth_quads_get_columns (quads);
  guint rows = gst_cloth_quads_get_rows (quads);
  guint n_quads, start, n = 0;
  const GstClothQuad *quad = gst_cloth_quads_get_quads (quads, &n_quads);

  start = begin_section (bytes, SECTION_QUADS);
  put_u64 (bytes, gst_cloth_quads_get_sequence (quads));
  put_u32 (bytes, columns);
  put_u32 (bytes, rows);
  put_u32 (bytes, 0);
  put_u16 (bytes, (guint) strlen (camera));
  put_u16 (bytes, 0);
  put_string (bytes, camera);
  for (guint i = 0; i < n_quads; i++, quad++) {
    guint8 state[4] = { (guint8) quad->state, quad->black ? 1 : 0, 0, 0 };

    if (!quad_is_valid (quad, columns, rows))
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
  GST_WRITE_UINT32_LE (bytes->data + start + 16, n);
  end_section (bytes, start, n_sections);
}

static void
put_dots (GByteArray * bytes, const GstClothDots * dots, guint * n_sections)
{
  const gchar *camera = gst_cloth_dots_get_camera (dots);
  guint columns = gst_cloth_dots_get_columns (dots);
  guint rows = gst_cloth_dots_get_rows (dots);
  guint n_colours = gst_cloth_dots_get_n_colours (dots);
  guint n_dots, start, n = 0;
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n_dots);

  start = begin_section (bytes, SECTION_DOTS);
  put_u64 (bytes, gst_cloth_dots_get_sequence (dots));
  put_u32 (bytes, columns);
  put_u32 (bytes, rows);
  put_u32 (bytes, 0);
  put_u16 (bytes, (guint) strlen (camera));
  put_u16 (bytes, n_colours);
  put_string (bytes, camera);
  for (guint i = 0; i < n_dots; i++, dot++) {
    const guint8 flags[4] =
        { dot->mirrored ? 1 : 0, dot->touches ? 1 : 0, 0, 0 };
    const gfloat floats[6] = { dot->confidence, dot->x, dot->y, dot->cov_xx,
      dot->cov_xy, dot->cov_yy
    };

    if (!dot_is_valid (dot, columns, rows, n_colours))
      continue;
    put_u32 (bytes, (guint32) dot->column);
    put_u32 (bytes, (guint32) dot->row);
    g_byte_array_append (bytes, flags, 4);
    put_floats (bytes, floats, 6);
    put_floats (bytes, dot->log_likelihood, n_colours);
    n++;
  }
  GST_WRITE_UINT32_LE (bytes->data + start + 16, n);
  end_section (bytes, start, n_sections);
}

/* A reference is written as the text of its caps: these are the characters that such
 * caps need (timestamp/x-ntp; timestamp/x-ptp, version=IEEE1588-2008, domain=1). The
 * reader hands nothing else to GStreamer's parser. */
static gboolean
reference_is_plain (const gchar * text, gsize length)
{
  if (length < 1 || length > MAX_REFERENCE)
    return FALSE;
  for (gsize i = 0; i < length; i++)
    if (!g_ascii_isalnum (text[i]) && !(text[i] && strchr ("/_-+., =()",
                text[i])))
      return FALSE;
  return TRUE;
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

    if (!gst_caps_is_fixed (time->reference)
        || !reference_is_plain (reference, strlen (reference)))
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
 * Writes what was seen in a picture, without the picture: the saddles, the quads and the dots
 * on @buffer, with camera and sequence number, and its #GstReferenceTimestampMeta. A
 * feature with a float that isn't finite, a quad or dot outside its pattern, and a reference
 * clock whose caps aren't fixed or need more than plain characters are left out. @buffer
 * without any such meta gives a buffer without sections.
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
  GByteArray *bytes;
  GstBuffer *observation;
  guint n_sections = 0, size = OBSERVATIONS_HEADER + 512;

  g_return_val_if_fail (GST_IS_BUFFER (buffer), NULL);

  saddles = gst_buffer_get_cloth_saddles (buffer);
  quads = gst_buffer_get_cloth_quads (buffer);
  dots = gst_buffer_get_cloth_dots (buffer);
  if (saddles)
    size += SADDLE_BYTES * gst_cloth_saddles_get_n_refined (saddles)
        + CANDIDATE_BYTES * gst_cloth_saddles_get_n_candidates (saddles);
  if (quads)
    size += QUAD_BYTES * gst_cloth_quads_get_n_quads (quads);
  if (dots)
    size += DOT_BYTES (gst_cloth_dots_get_n_colours (dots))
        * gst_cloth_dots_get_n_dots (dots);

  bytes = g_byte_array_sized_new (size);
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

/* The camera's name of @length bytes at @at; the section must hold it whole. */
static gchar *
get_camera (const Section * section, gsize at, guint length,
    const gchar * what, GError ** error)
{
  const gchar *name = (const gchar *) section->data + at;

  if (length > GST_CLOTH_MAX_CAMERA_NAME) {
    fail (error, GST_CLOTH_ERROR_LIMIT, what, "the camera's name is too long");
    return NULL;
  }
  if (section->size - at < padded (length)) {
    fail (error, GST_CLOTH_ERROR_TRUNCATED, what,
        "it ends inside the camera's name");
    return NULL;
  }
  if (length && !g_utf8_validate_len (name, length, NULL)) {
    fail (error, GST_CLOTH_ERROR_VALUE, what, "the camera's name is not UTF-8");
    return NULL;
  }
  return g_strndup (name, length);
}

static gboolean
read_saddles (const Section * section, Observed * observed, GError ** error)
{
  g_autofree gchar *camera = NULL;
  g_autofree GstClothSaddle *refined = NULL;
  g_autofree GstClothCandidate *candidates = NULL;
  const guint8 *at = section->data;
  guint64 sequence;
  guint n_refined, n_candidates, length;
  gsize need;

  if (observed->saddles)
    return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_SADDLES,
        "there are two of them");
  if (section->size < SADDLES_HEADER)
    return fail (error, GST_CLOTH_ERROR_TRUNCATED, SECTION_SADDLES,
        "it ends inside its header");
  sequence = gst_cloth_read_u64 (at);
  n_refined = gst_cloth_read_u32 (at + 8);
  n_candidates = gst_cloth_read_u32 (at + 12);
  length = gst_cloth_read_u16 (at + 16);
  if (n_refined > GST_CLOTH_MAX_FEATURES
      || n_candidates > GST_CLOTH_MAX_FEATURES)
    return fail (error, GST_CLOTH_ERROR_LIMIT, SECTION_SADDLES,
        "there are more than 65536 features");
  if (!(camera = get_camera (section, SADDLES_HEADER, length, SECTION_SADDLES,
              error)))
    return FALSE;
  need = SADDLES_HEADER + padded (length) + (gsize) n_refined *SADDLE_BYTES
      + (gsize) n_candidates *CANDIDATE_BYTES;
  if (section->size != need)
    return fail (error, section->size < need ? GST_CLOTH_ERROR_TRUNCATED :
        GST_CLOTH_ERROR_VALUE, SECTION_SADDLES,
        "its size is not that of what it announces");

  at += SADDLES_HEADER + padded (length);
  refined = g_new (GstClothSaddle, n_refined);
  candidates = g_new (GstClothCandidate, n_candidates);
  for (guint i = 0; i < n_refined; i++, at += SADDLE_BYTES) {
    gst_cloth_copy_le32 (&refined[i], at, 7);
    if (!all_finite ((const gfloat *) &refined[i], 7))
      return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_SADDLES,
          "a float is not finite");
  }
  for (guint i = 0; i < n_candidates; i++, at += CANDIDATE_BYTES) {
    gst_cloth_copy_le32 (&candidates[i], at, 3);
    if (!all_finite ((const gfloat *) &candidates[i], 3))
      return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_SADDLES,
          "a float is not finite");
  }
  observed->saddles = gst_cloth_saddles_new (camera, sequence, refined,
      n_refined, candidates, n_candidates);
  return TRUE;
}

static gboolean
read_quads (const Section * section, Observed * observed, GError ** error)
{
  g_autofree gchar *camera = NULL;
  g_autofree GstClothQuad *quads = NULL;
  const guint8 *at = section->data;
  guint64 sequence;
  guint columns, rows, n_quads, length;
  gsize need;

  if (observed->quads)
    return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_QUADS,
        "there are two of them");
  if (section->size < QUADS_HEADER)
    return fail (error, GST_CLOTH_ERROR_TRUNCATED, SECTION_QUADS,
        "it ends inside its header");
  sequence = gst_cloth_read_u64 (at);
  columns = gst_cloth_read_u32 (at + 8);
  rows = gst_cloth_read_u32 (at + 12);
  n_quads = gst_cloth_read_u32 (at + 16);
  length = gst_cloth_read_u16 (at + 20);
  if (columns > GST_CLOTH_MAX_FEATURES || rows > GST_CLOTH_MAX_FEATURES
      || n_quads > GST_CLOTH_MAX_FEATURES)
    return fail (error, GST_CLOTH_ERROR_LIMIT, SECTION_QUADS,
        "there are more than 65536 quads, columns or rows");
  if (!(camera = get_camera (section, QUADS_HEADER, length, SECTION_QUADS,
              error)))
    return FALSE;
  need = QUADS_HEADER + padded (length) + (gsize) n_quads *QUAD_BYTES;
  if (section->size != need)
    return fail (error, section->size < need ? GST_CLOTH_ERROR_TRUNCATED :
        GST_CLOTH_ERROR_VALUE, SECTION_QUADS,
        "its size is not that of what it announces");

  at += QUADS_HEADER + padded (length);
  quads = g_new0 (GstClothQuad, n_quads);
  for (guint i = 0; i < n_quads; i++, at += QUAD_BYTES) {
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
      return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_QUADS,
          "a quad lies outside the board, has an unknown state or a float that "
          "is not finite");
  }
  observed->quads = gst_cloth_quads_new (camera, sequence, columns, rows, quads,
      n_quads);
  return TRUE;
}

static gboolean
read_dots (const Section * section, Observed * observed, GError ** error)
{
  g_autofree gchar *camera = NULL;
  g_autofree GstClothDot *dots = NULL;
  const guint8 *at = section->data;
  guint64 sequence;
  guint columns, rows, n_colours, n_dots, length;
  gsize need;

  if (observed->dots)
    return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_DOTS,
        "there are two of them");
  if (section->size < DOTS_HEADER)
    return fail (error, GST_CLOTH_ERROR_TRUNCATED, SECTION_DOTS,
        "it ends inside its header");
  sequence = gst_cloth_read_u64 (at);
  columns = gst_cloth_read_u32 (at + 8);
  rows = gst_cloth_read_u32 (at + 12);
  n_dots = gst_cloth_read_u32 (at + 16);
  length = gst_cloth_read_u16 (at + 20);
  n_colours = gst_cloth_read_u16 (at + 22);
  if (columns > GST_CLOTH_MAX_FEATURES || rows > GST_CLOTH_MAX_FEATURES
      || n_dots > GST_CLOTH_MAX_FEATURES)
    return fail (error, GST_CLOTH_ERROR_LIMIT, SECTION_DOTS,
        "there are more than 65536 dots, columns or rows");
  if (n_colours > GST_CLOTH_DOT_MAX_COLOURS)
    return fail (error, GST_CLOTH_ERROR_LIMIT, SECTION_DOTS,
        "there are more than 8 colours");
  if (!(camera = get_camera (section, DOTS_HEADER, length, SECTION_DOTS,
              error)))
    return FALSE;
  need = DOTS_HEADER + padded (length)
  + (gsize) n_dots *DOT_BYTES (n_colours);
  if (section->size != need)
    return fail (error, section->size < need ? GST_CLOTH_ERROR_TRUNCATED :
        GST_CLOTH_ERROR_VALUE, SECTION_DOTS,
        "its size is not that of what it announces");

  at += DOTS_HEADER + padded (length);
  dots = g_new0 (GstClothDot, n_dots);
  for (guint i = 0; i < n_dots; i++, at += DOT_BYTES (n_colours)) {
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
      return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_DOTS,
          "a dot lies outside the pattern, has an unknown flag or a float that "
          "is not finite");
  }
  observed->dots = gst_cloth_dots_new (camera, sequence, columns, rows,
      n_colours, dots, n_dots);
  return TRUE;
}

static gboolean
read_time (const Section * section, Observed * observed, GError ** error)
{
  g_autofree gchar *text = NULL;
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
  text = g_strndup ((const gchar *) section->data + TIME_HEADER, length);
  reference = reference_is_plain (text, strlen (text)) && strlen (text)
      == length ? gst_caps_from_string (text) : NULL;
  if (!reference || !gst_caps_is_fixed (reference)
      || gst_cloth_read_u64 (section->data) == GST_CLOCK_TIME_NONE) {
    g_clear_pointer (&reference, gst_caps_unref);
    return fail (error, GST_CLOTH_ERROR_VALUE, SECTION_TIME,
        "the reference clock is no fixed caps, or there is no time");
  }
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
  if (memcmp (tag, SECTION_SADDLES, 4) == 0)
    return read_saddles (section, observed, error);
  if (memcmp (tag, SECTION_QUADS, 4) == 0)
    return read_quads (section, observed, error);
  if (memcmp (tag, SECTION_DOTS, 4) == 0)
    return read_dots (section, observed, error);
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
 * Puts on @target the metas that @observation holds: saddles, quads, dots and reference
 * time stamps. Sections of a kind that this library doesn't know are passed over. Time stamps
 * and flags of @target stay.
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
  return TRUE;
}
