/* CSV: one line for each vertex of each frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/mesh/formats/export.h"

#define HEADER "frame,time_s,vertex,x_m,y_m,z_m,sigma_m,state\n"

typedef struct
{
  ClothOutput *output;
  guint n_vertices;
  gdouble time_s;
  GString *text;
} Csv;

static void
free_csv (gpointer export)
{
  Csv *self = export;

  cloth_output_free (self->output);
  g_string_free (self->text, TRUE);
  g_free (self);
}

static gpointer
start_csv (const ClothExportInfo * info, GError ** error)
{
  Csv *self = g_new0 (Csv, 1);

  self->n_vertices = info->topology->n_vertices;
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

  if (!cloth_export_check_later (number, self->time_s, time_s, error))
    return FALSE;
  self->time_s = time_s;
  g_string_append_printf (text, "%" G_GUINT64_FORMAT ",", number);
  cloth_text_append_double (text, time_s);
  begin = g_strdup (text->str);
  g_string_truncate (text, 0);
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
    g_string_append_printf (text, ",%u\n", frame->states[i]);
  }
  return cloth_text_flush (text, self->output, error);
}

static gboolean
finish_csv (gpointer export, GError ** error)
{
  Csv *self = export;

  return cloth_output_commit (&self->output, 1, error);
}

const ClothExporter cloth_csv_exporter = {
  TRUE, start_csv, append_csv, finish_csv, free_csv
};
