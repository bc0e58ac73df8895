/* PC2 point caches: where each vertex of a mesh is in each sample.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/formats/pc2.h"

#include <math.h>
#include <string.h>

#include "gst/file/npy.h"
#include "gst/mesh/formats/export.h"
#include "gst/mesh/formats/obj.h"

/* The layout, little-endian: char[12] magic, int32 version = 1, int32 points,
 * float32 start, float32 rate, int32 samples; then float32[samples][points][3]. */
#define MAGIC "POINTCACHE2"
#define MAGIC_SIZE 12
#define HEADER_SIZE 32
#define SAMPLES_OFFSET 28

struct _ClothPc2Reader
{
  ClothInput *input;
  ClothPc2Info info;
};

/* A cache under a temporary name. */
typedef struct
{
  ClothOutput *output;
  ClothPc2Info info;
} Writer;

static gboolean
parse_header (ClothInput * input, ClothPc2Info * info, GError ** error)
{
  guint8 header[HEADER_SIZE];
  gint32 counts[2], n_samples;
  gfloat timing[2];
  guint64 bytes;

  if (!cloth_input_read_at (input, 0, header, sizeof header, error))
    return FALSE;
  memcpy (counts, header + 12, sizeof counts);
  memcpy (timing, header + 20, sizeof timing);
  memcpy (&n_samples, header + SAMPLES_OFFSET, sizeof n_samples);
  cloth_swap_little_endian (counts, 4, 2);
  cloth_swap_little_endian (timing, 4, 2);
  cloth_swap_little_endian (&n_samples, 4, 1);
  if (memcmp (header, MAGIC, MAGIC_SIZE) != 0 || counts[0] != 1)
    return cloth_file_invalid (error, "not a PC2 file of version 1");
  if (counts[1] < 1 || counts[1] > (gint32) CLOTH_MAX_VERTICES) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%d points: between 1 and %u are accepted", counts[1],
        CLOTH_MAX_VERTICES);
    return FALSE;
  }
  if (n_samples < 0 || !isfinite (timing[0]) || !isfinite (timing[1]) ||
      timing[1] <= 0)
    return cloth_file_invalid (error,
        "the PC2 file has a negative number of samples, or a start or a rate "
        "that makes no sense");
  bytes = (guint64) counts[1] * 12 * (guint64) n_samples;
  if (bytes > cloth_input_get_size (input) - HEADER_SIZE) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_TRUNCATED,
        "the PC2 file is cut short: %d samples are promised", n_samples);
    return FALSE;
  }
  info->n_points = (guint) counts[1];
  info->start = timing[0];
  info->rate = timing[1];
  info->n_samples = (guint) n_samples;
  return TRUE;
}

/* @input: (transfer full): the bytes of a PC2 file
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full): a reader, or %NULL
 */
ClothPc2Reader *
cloth_pc2_reader_new (ClothInput * input, GError ** error)
{
  g_autoptr (ClothPc2Reader) reader = g_new0 (ClothPc2Reader, 1);

  reader->input = input;
  if (!parse_header (input, &reader->info, error))
    return NULL;
  return g_steal_pointer (&reader);
}

/* @path: a PC2 file
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: (transfer full): a reader, or %NULL
 */
ClothPc2Reader *
cloth_pc2_reader_open (const gchar * path, GError ** error)
{
  ClothInput *input = cloth_input_open (path, error);
  ClothPc2Reader *reader;

  if (!input)
    return NULL;
  reader = cloth_pc2_reader_new (input, error);
  if (!reader)
    g_prefix_error (error, "%s: ", path);
  return reader;
}

/* @reader: a reader
 *
 * Returns: (transfer none): the header
 */
const ClothPc2Info *
cloth_pc2_reader_get_info (const ClothPc2Reader * reader)
{
  return &reader->info;
}

/* @reader: a reader
 * @sample: which sample
 * @positions: (out caller-allocates): room for 3 numbers a point
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when the sample was read
 */
gboolean
cloth_pc2_reader_read (ClothPc2Reader * reader, guint sample,
    gfloat * positions, GError ** error)
{
  gsize n_floats = 3 * (gsize) reader->info.n_points;

  if (sample >= reader->info.n_samples)
    return cloth_file_invalid (error,
        "sample %u of %u", sample, reader->info.n_samples);
  if (!cloth_input_read_at (reader->input,
          HEADER_SIZE + (guint64) sample * n_floats * sizeof *positions,
          positions, n_floats * sizeof *positions, error))
    return FALSE;
  cloth_swap_little_endian (positions, sizeof *positions, n_floats);
  return TRUE;
}

/* @reader: (transfer full) (nullable): a reader
 */
void
cloth_pc2_reader_free (ClothPc2Reader * reader)
{
  if (!reader)
    return;
  cloth_input_free (reader->input);
  g_free (reader);
}

static void
writer_free (Writer * writer)
{
  if (!writer)
    return;
  cloth_output_free (writer->output);
  g_free (writer);
}

/* @output: (transfer full): an empty file
 * @n_points: vertices of the mesh
 * @start: frame of the first sample
 * @rate: frames from one sample to the next
 * @error: #GIOErrorEnum
 *
 * Starts a point cache; samples are written as they come.
 *
 * Returns: (transfer full): a writer, or %NULL
 */
static Writer *
writer_new (ClothOutput * output, guint n_points, gfloat start,
    gfloat rate, GError ** error)
{
  Writer *writer = g_new0 (Writer, 1);
  guint8 header[HEADER_SIZE] = MAGIC;
  gint32 counts[2] = { 1, (gint32) n_points };
  gfloat timing[2] = { start, rate };

  writer->info.n_points = n_points;
  cloth_swap_little_endian (counts, 4, 2);
  cloth_swap_little_endian (timing, 4, 2);
  memcpy (header + 12, counts, sizeof counts);
  memcpy (header + 20, timing, sizeof timing);
  writer->output = output;
  if (!cloth_output_write (output, header, sizeof header, error)) {
    writer_free (writer);
    return NULL;
  }
  return writer;
}

/* @writer: a writer
 * @positions: 3 numbers a point
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * Returns: %TRUE when the sample was taken
 */
static gboolean
writer_append (Writer * writer, const gfloat * positions, GError ** error)
{
  gsize size = 3 * (gsize) writer->info.n_points * sizeof *positions;
#if G_BYTE_ORDER == G_LITTLE_ENDIAN
  gconstpointer ordered = positions;
#else
  g_autofree gpointer ordered = g_memdup2 (positions, size);

  cloth_swap_little_endian (ordered, sizeof *positions,
      size / sizeof *positions);
#endif
  if (writer->info.n_samples == G_MAXINT32) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "a PC2 file holds no more samples");
    return FALSE;
  }
  if (!cloth_output_write (writer->output, ordered, size, error) ||
      !cloth_output_flush (writer->output, error))
    return FALSE;
  writer->info.n_samples++;
  return TRUE;
}

/* The number of samples is known at the end only. */
static gboolean
finish_cache (ClothOutput * output, guint32 n_samples, GError ** error)
{
  cloth_swap_little_endian (&n_samples, 4, 1);
  return cloth_output_write_at (output, SAMPLES_OFFSET, &n_samples,
      sizeof n_samples, error) && cloth_output_commit (output, error);
}

/* An OBJ file with a PC2 file, and the states of the vertices. */

typedef struct
{
  const ClothExportInfo *info;
  ClothOutput *obj;
  Writer *cache;
  ClothNpyWriter *states;
} ObjPc2;

static void
free_obj_pc2 (gpointer export)
{
  ObjPc2 *self = export;

  cloth_output_free (self->obj);
  writer_free (self->cache);
  cloth_npy_writer_free (self->states);
  g_free (self);
}

static gpointer
start_obj_pc2 (const ClothExportInfo * info, GError ** error)
{
  const guint64 row_shape[] = { info->topology->n_vertices };
  ObjPc2 *self = g_new0 (ObjPc2, 1);
  ClothOutput *output;

  self->info = info;
  self->obj = cloth_export_open (info, ".obj", error);
  output = self->obj ? cloth_export_open (info, ".pc2", error) : NULL;
  if (output)
    self->cache = writer_new (output, info->topology->n_vertices, 0, 1, error);
  output = self->cache ? cloth_export_open (info, ".states.npy", error) : NULL;
  if (output)
    self->states = cloth_npy_writer_new (output, CLOTH_NPY_UINT8, 2, row_shape,
        error);
  if (self->states)
    return self;
  free_obj_pc2 (self);
  return NULL;
}

static gboolean
append_obj_pc2 (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  ObjPc2 *self = export;
  const ClothExportInfo *info = self->info;

  /* The OBJ file shows the first frame, and is whole with it. */
  if (number == 0 && (!cloth_obj_write (self->obj, info->name, info->topology,
              frame->positions, info->fps_n, info->fps_d, error) ||
          !cloth_output_commit (self->obj, error)))
    return FALSE;
  return writer_append (self->cache, frame->positions, error) &&
      cloth_npy_writer_append (self->states, frame->states, 1, error);
}

static gboolean
finish_obj_pc2 (gpointer export, GError ** error)
{
  ObjPc2 *self = export;

  return finish_cache (self->cache->output, self->cache->info.n_samples, error)
      && cloth_npy_writer_finish (self->states, error);
}

static gboolean
count_samples (const gchar * path, guint64 * n_samples, guint64 * rest,
    guint64 * sample_size, GError ** error)
{
  GError *fault = NULL;
  g_autoptr (ClothPc2Reader) reader = cloth_pc2_reader_open (path, &fault);
  guint64 bytes;

  *n_samples = *rest = *sample_size = 0;
  if (!reader)
    return cloth_file_is_unwritten (fault, error);
  *sample_size = 3 * sizeof (gfloat) * (guint64) reader->info.n_points;
  bytes = cloth_input_get_size (reader->input) - HEADER_SIZE;
  *n_samples = MIN (bytes / *sample_size, G_MAXINT32);
  *rest = bytes % *sample_size;
  return TRUE;
}

gboolean
cloth_obj_pc2_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error)
{
  g_autofree gchar *obj = g_strconcat (base, ".obj", NULL);
  g_autofree gchar *pc2 = g_strconcat (base, ".pc2", NULL);
  g_autofree gchar *states = g_strconcat (base, ".states.npy", NULL);
  g_autofree gchar *path = cloth_parts_get_path (parts, pc2);
  g_autoptr (ClothOutput) output = NULL;
  guint64 n_samples, rest, size, n_states;

  if (!cloth_parts_is_whole (parts, obj))
    return TRUE;
  if (!count_samples (path, &n_samples, &rest, &size, error) ||
      !cloth_npy_part_count (parts, states, &n_states, error))
    return FALSE;
  recovered->n_frames = MIN (n_samples, n_states);
  recovered->n_left_out =
      MAX (n_samples + (rest > 0), n_states) - recovered->n_frames;
  if (recovered->n_frames == 0)
    return TRUE;
  output = cloth_parts_continue (parts, pc2, HEADER_SIZE +
      recovered->n_frames * size, error);
  return output && finish_cache (output, (guint32) recovered->n_frames, error)
      && cloth_npy_part_finish (parts, states, recovered->n_frames, error);
}

const ClothExporter cloth_obj_pc2_exporter = {
  FALSE, ".obj", TRUE, start_obj_pc2, append_obj_pc2, finish_obj_pc2,
  free_obj_pc2
};
