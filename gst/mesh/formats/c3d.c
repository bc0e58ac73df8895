/* C3D: the vertices as labelled markers, in millimetres.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/mesh/formats/export.h"

/* The C3D file format (https://www.c3d.org), floating-point kind, Intel byte order:
 * blocks of 512 bytes, counted from 1: the header, the parameters, the data. */
#define BLOCK 512
#define MAX_PARAMETER_BLOCKS 255
#define MAX_FRAMES 65535u
/* Labels of one parameter; further ones are in LABELS2, LABELS3 and so on. */
#define MAX_LABELS 255u
/* Millimetres a step of the residual, which is one byte. */
#define RESIDUAL_STEP_MM 0.02f

enum
{
  POINT = 1,
  ANALOG,
  FORCE_PLATFORM,
  TRIAL
};

typedef struct
{
  ClothOutput *output;
  guint n_vertices;
  guint64 n_frames;
  gsize frames_offset, end_offset;      /* of POINT:FRAMES, TRIAL:ACTUAL_END_FIELD */
  gfloat *scratch;              /* 4 a vertex */
} C3d;

static void
free_c3d (gpointer export)
{
  C3d *self = export;

  cloth_output_free (self->output);
  g_free (self->scratch);
  g_free (self);
}

/* ---- parameters ---- */

static void
put_byte (GByteArray * to, gint value)
{
  const guint8 byte = (guint8) value;

  g_byte_array_append (to, &byte, 1);
}

static void
put_word (GByteArray * to, guint value)
{
  put_byte (to, value & 255);
  put_byte (to, value >> 8 & 255);
}

static void
put_name (GByteArray * to, const gchar * name, gint id)
{
  put_byte (to, (gint) strlen (name));
  put_byte (to, id);
  g_byte_array_append (to, (const guint8 *) name, (guint) strlen (name));
}

/* Distance from itself to the next group or parameter; one byte for no description. */
static void
put_group (GByteArray * to, const gchar * name, gint id)
{
  put_name (to, name, -id);
  put_word (to, 3);
  put_byte (to, 0);
}

/* @item_size: 1, 2 or 4, a text −1. Returns where the data begin. */
static gsize
put_parameter (GByteArray * to, const gchar * name, gint id, gint item_size,
    guint n_dimensions, const guint8 * dimensions, gconstpointer data)
{
  guint size = (guint) ABS (item_size);
  gsize at;

  for (guint i = 0; i < n_dimensions; i++)
    size *= dimensions[i];
  put_name (to, name, id);
  put_word (to, 2 + 2 + n_dimensions + size + 1);
  put_byte (to, item_size);
  put_byte (to, (gint) n_dimensions);
  g_byte_array_append (to, dimensions, n_dimensions);
  at = to->len;
  g_byte_array_append (to, data, size);
  put_byte (to, 0);
  return at;
}

static gsize
put_integer (GByteArray * to, const gchar * name, gint id, guint value)
{
  const guint8 bytes[2] = { value & 255, value >> 8 & 255 };

  return put_parameter (to, name, id, 2, 0, NULL, bytes);
}

static void
put_float (GByteArray * to, const gchar * name, gint id, gfloat value)
{
  cloth_swap_little_endian (&value, sizeof value, 1);
  put_parameter (to, name, id, 4, 0, NULL, &value);
}

static void
put_text (GByteArray * to, const gchar * name, gint id, const gchar * text)
{
  const guint8 length = (guint8) strlen (text);

  put_parameter (to, name, id, -1, 1, &length, text);
}

/* A vertex is called v and its number, all with as many digits. */
static void
put_labels (GByteArray * to, guint n_vertices)
{
  g_autofree gchar *last = g_strdup_printf ("%u", n_vertices - 1);
  const gint digits = (gint) strlen (last);

  for (guint first = 0, part = 1; first < n_vertices;
      first += MAX_LABELS, part++) {
    const guint n = MIN (n_vertices - first, MAX_LABELS);
    const guint8 dimensions[2] = { (guint8) (1 + digits), (guint8) n };
    g_autofree gchar *name = part == 1 ? g_strdup ("LABELS") :
        g_strdup_printf ("LABELS%u", part);
    g_autoptr (GString) text = g_string_new (NULL);

    for (guint i = first; i < first + n; i++)
      g_string_append_printf (text, "v%0*u", digits, i);
    put_parameter (to, name, POINT, -1, 2, dimensions, text->str);
  }
}

static void
put_field (GByteArray * to, const gchar * name, guint value, gsize * offset)
{
  const guint8 two = 2, bytes[4] = { value & 255, value >> 8 & 255, 0, 0 };
  gsize at = put_parameter (to, name, TRIAL, 2, 1, &two, bytes);

  if (offset)
    *offset = at;
}

/* The header's block and those of the parameters. FALSE: they don't fit the format. */
static gboolean
make_blocks (C3d * self, gfloat rate, GByteArray * bytes)
{
  guint8 *header;
  gfloat numbers[2] = { -RESIDUAL_STEP_MM, rate };
  gsize data_start_offset;
  guint n_blocks;

  g_byte_array_set_size (bytes, BLOCK);
  memset (bytes->data, 0, BLOCK);
  put_word (bytes, 0x5001);
  put_word (bytes, 84 << 8);
  put_group (bytes, "POINT", POINT);
  put_group (bytes, "ANALOG", ANALOG);
  put_group (bytes, "FORCE_PLATFORM", FORCE_PLATFORM);
  put_group (bytes, "TRIAL", TRIAL);
  put_integer (bytes, "USED", POINT, self->n_vertices);
  self->frames_offset = put_integer (bytes, "FRAMES", POINT, 0);
  data_start_offset = put_integer (bytes, "DATA_START", POINT, 0);
  put_float (bytes, "SCALE", POINT, -RESIDUAL_STEP_MM);
  put_float (bytes, "RATE", POINT, rate);
  put_text (bytes, "UNITS", POINT, "mm");
  put_text (bytes, "X_SCREEN", POINT, "+X");
  put_text (bytes, "Y_SCREEN", POINT, "+Z");
  put_integer (bytes, "USED", ANALOG, 0);
  put_float (bytes, "RATE", ANALOG, rate);
  put_float (bytes, "GEN_SCALE", ANALOG, 1);
  put_integer (bytes, "USED", FORCE_PLATFORM, 0);
  put_field (bytes, "ACTUAL_START_FIELD", 1, NULL);
  put_field (bytes, "ACTUAL_END_FIELD", 0, &self->end_offset);
  put_labels (bytes, self->n_vertices);
  /* a group without a name ends the section */
  put_word (bytes, 0);
  n_blocks = (bytes->len - 1) / BLOCK;
  if (n_blocks > MAX_PARAMETER_BLOCKS)
    return FALSE;
  while (bytes->len % BLOCK != 0)
    put_byte (bytes, 0);
  bytes->data[BLOCK + 2] = (guint8) n_blocks;
  bytes->data[data_start_offset] = (n_blocks + 2) & 255;
  bytes->data[data_start_offset + 1] = (guint8) ((n_blocks + 2) >> 8);

  header = bytes->data;
  cloth_swap_little_endian (numbers, sizeof *numbers, 2);
  header[0] = 2;
  header[1] = 0x50;
  header[2] = self->n_vertices & 255;
  header[3] = (guint8) (self->n_vertices >> 8);
  header[6] = 1;                /* first frame; the last one is mended in */
  memcpy (header + 12, &numbers[0], 4);
  header[16] = (n_blocks + 2) & 255;
  header[17] = (guint8) ((n_blocks + 2) >> 8);
  memcpy (header + 20, &numbers[1], 4);
  return TRUE;
}

static gpointer
start_c3d (const ClothExportInfo * info, GError ** error)
{
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  C3d *self;

  if (info->fps_n <= 0) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
        "a C3D file has one frame rate, and that of the stream varies: write CSV "
        "(format=csv)");
    return NULL;
  }
  self = g_new0 (C3d, 1);
  self->n_vertices = info->topology->n_vertices;
  if (self->n_vertices > G_MAXUINT16 || !make_blocks (self, (gfloat)
          ((gdouble) info->fps_n / info->fps_d), bytes)) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%u vertices: a C3D file has no room for the labels of more than about "
        "20,000; write CSV (format=csv)", self->n_vertices);
    free_c3d (self);
    return NULL;
  }
  self->scratch = g_new (gfloat, 4 * (gsize) self->n_vertices);
  self->output = cloth_export_open (info, ".c3d", error);
  if (self->output &&
      cloth_output_write (self->output, bytes->data, bytes->len, error))
    return self;
  free_c3d (self);
  return NULL;
}

/* ---- data ---- */

/* The fourth number of a point: −1 for one that is not there; else views in the upper
 * byte, one bit each, and the residual in the lower one. A residual of 0 says that the
 * point was interpolated, or that nothing is known. */
static gfloat
quality_of (guint8 state, const gfloat * covariance)
{
  const gfloat sigma = covariance ? cloth_export_sigma (covariance) : NAN;
  guint views = 0, residual = 0;

  if (state == CLOTH_VERTEX_MEASURED)
    views = 7;
  else if (state == CLOTH_VERTEX_TWO_VIEWS)
    views = 3;
  if (views > 0 && !isnan (sigma)) {
    const gfloat steps = 1000 * sigma / RESIDUAL_STEP_MM;

    residual = steps < 255 ? MAX ((guint) (steps + 0.5f), 1) : 255;
  }
  return (gfloat) (views << 8 | residual);
}

static gboolean
append_c3d (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  C3d *self = export;

  if (number >= MAX_FRAMES) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "a C3D file holds at most %u frames: write CSV (format=csv), or the "
        "recording in parts", MAX_FRAMES);
    return FALSE;
  }
  for (gsize i = 0; i < self->n_vertices; i++) {
    const gfloat *from = frame->positions + 3 * i;
    gfloat *to = self->scratch + 4 * i;

    if (isnan (from[0])) {
      to[0] = to[1] = to[2] = 0;
      to[3] = -1;
      continue;
    }
    for (guint k = 0; k < 3; k++)
      to[k] = (gfloat) (1000.0 * from[k]);
    to[3] = quality_of (frame->states[i], frame->covariances ?
        frame->covariances + 6 * i : NULL);
  }
  cloth_swap_little_endian (self->scratch, sizeof *self->scratch,
      4 * (gsize) self->n_vertices);
  if (!cloth_output_write (self->output, self->scratch,
          16 * (gsize) self->n_vertices, error))
    return FALSE;
  self->n_frames = number + 1;
  return TRUE;
}

static gboolean
finish_c3d (gpointer export, GError ** error)
{
  static const guint8 zeros[BLOCK];
  C3d *self = export;
  const gsize data = (gsize) self->n_frames * 16 * self->n_vertices;
  const guint8 count[2] = { self->n_frames & 255,
    (guint8) (self->n_frames >> 8)
  };

  return cloth_output_write (self->output, zeros, (BLOCK - data % BLOCK) %
      BLOCK, error) &&
      cloth_output_write_at (self->output, 8, count, 2, error) &&
      cloth_output_write_at (self->output, self->frames_offset, count, 2,
      error) &&
      cloth_output_write_at (self->output, self->end_offset, count, 2, error)
      && cloth_output_commit (self->output, error);
}

const ClothExporter cloth_c3d_exporter = {
  TRUE, ".c3d", FALSE, start_c3d, append_c3d, finish_c3d, free_c3d
};
