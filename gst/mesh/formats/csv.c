/* CSV: one line for each vertex of each frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/mesh/formats/export.h"
#include "gst/mesh/strain.h"

#define HEADER "frame,time_s,vertex,x_m,y_m,z_m,sigma_m,state,strain_warp," \
    "strain_weft,strain_shear\n"

typedef struct
{
  ClothOutput *output;
  guint n_vertices;
  gdouble time_s;
  GString *text;
  ClothStrains *strains;        /* NULL when uv is not known */
} Csv;

static void
free_csv (gpointer export)
{
  Csv *self = export;

  cloth_output_free (self->output);
  g_string_free (self->text, TRUE);
  cloth_strains_free (self->strains);
  g_free (self);
}

static gpointer
start_csv (const ClothExportInfo * info, GError ** error)
{
  Csv *self = g_new0 (Csv, 1);

  self->n_vertices = info->topology->n_vertices;
  self->strains = cloth_strains_new (info->topology);
  self->text = g_string_new (HEADER);
  self->output = cloth_export_open (info, ".csv", error);
  if (self->output && cloth_text_flush (self->text, self->output, error))
    return self;
  free_csv (self);
  return NULL;
}

static gboolean
append_csv (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  Csv *self = export;
  g_autofree gchar *begin = NULL;
  GString *text = self->text;
  const gfloat *strain = NULL;

  if (!cloth_export_check_later (number, self->time_s, time_s, error))
    return FALSE;
  self->time_s = time_s;
  g_string_append_printf (text, "%" G_GUINT64_FORMAT ",", number);
  cloth_text_append_double (text, time_s);
  begin = g_strdup (text->str);
  g_string_truncate (text, 0);
  if (self->strains) {
    cloth_strains_measure (self->strains, frame->positions, frame->states);
    strain = cloth_strains_get_vertices (self->strains);
  }
  for (gsize i = 0; i < self->n_vertices; i++) {
    const gfloat *p = frame->positions + 3 * i;
    const gfloat sigma = frame->covariances ?
        cloth_export_sigma (frame->covariances + 6 * i) : NAN;

    g_string_append_printf (text, "%s,%" G_GSIZE_FORMAT, begin, i);
    for (guint k = 0; k < 3; k++) {
      g_string_append_c (text, ',');
      if (!isnan (p[k]))
        cloth_text_append_float (text, p[k]);
    }
    g_string_append_c (text, ',');
    if (!isnan (p[0]) && !isnan (sigma))
      cloth_text_append_float (text, sigma);
    g_string_append_printf (text, ",%u", frame->states[i]);
    for (guint k = 0; k < CLOTH_STRAIN_SIZE; k++) {
      g_string_append_c (text, ',');
      if (strain && !isnan (strain[CLOTH_STRAIN_SIZE * i + k]))
        cloth_text_append_float (text, strain[CLOTH_STRAIN_SIZE * i + k]);
    }
    g_string_append_c (text, '\n');
  }
  return cloth_text_flush (text, self->output, error) &&
      cloth_output_flush (self->output, error);
}

static gboolean
finish_csv (gpointer export, GError ** error)
{
  Csv *self = export;

  return cloth_output_commit (self->output, error);
}

/* Where the last whole frame of @n_vertices lines ends. */
static gboolean
count_frames (ClothInput * input, guint64 n_vertices, guint64 * n_frames,
    guint64 * end, GError ** error)
{
  const guint64 size = cloth_input_get_size (input);
  gchar block[1 << 14];
  guint64 n_lines = 0;

  *n_frames = 0;
  *end = 0;
  for (guint64 at = 0; at < size; at += sizeof block) {
    const gsize n = (gsize) MIN (sizeof block, size - at);

    if (!cloth_input_read_at (input, at, block, n, error))
      return FALSE;
    for (gsize i = 0; i < n; i++) {
      /* The first line is the header. */
      if (block[i] != '\n' || n_lines++ == 0 || (n_lines - 1) % n_vertices != 0)
        continue;
      *n_frames = (n_lines - 1) / n_vertices;
      *end = at + i + 1;
    }
  }
  return TRUE;
}

gboolean
cloth_csv_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error)
{
  const guint64 n_vertices =
      g_ascii_strtoull (cloth_parts_get_note (parts), NULL, 10);
  g_autofree gchar *name = g_strconcat (base, ".csv", NULL);
  g_autofree gchar *path = cloth_parts_get_path (parts, name);
  GError *fault = NULL;
  g_autoptr (ClothInput) input = cloth_input_open (path, &fault);
  g_autoptr (ClothOutput) output = NULL;
  guint64 end;

  if (!input)
    return cloth_file_is_unwritten (fault, error);
  if (n_vertices == 0 || n_vertices > CLOTH_MAX_VERTICES)
    return cloth_file_invalid (error, "how many vertices it has is not noted");
  if (!count_frames (input, n_vertices, &recovered->n_frames, &end, error))
    return FALSE;
  recovered->n_left_out = end < cloth_input_get_size (input);
  if (recovered->n_frames == 0)
    return TRUE;
  output = cloth_parts_continue (parts, name, end, error);
  return output && cloth_output_commit (output, error);
}

const ClothExporter cloth_csv_exporter = {
  TRUE, ".csv", TRUE, start_csv, append_csv, finish_csv, free_csv
};
