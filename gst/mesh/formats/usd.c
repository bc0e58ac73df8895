/* USD as text: one mesh whose points have a sample a frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/mesh/formats/export.h"

/* Of the last time code, which stands in the header and is known at the end. */
#define CODE_WIDTH 24
/* Time codes a second where the frame rate varies: milliseconds. */
#define CODES_PER_SECOND 1000
/* Time codes are rounded to this part of one: time stamps are whole nanoseconds. */
#define CODE_PARTS 1000

typedef struct
{
  const ClothExportInfo *info;
  ClothOutput *output;
  ClothOutput *extents;         /* wait: they stand behind all points */
  GString *text;
  guint64 code_offset;
  gdouble start_s, codes_per_second, code;
} Usd;

static void
free_usd (gpointer export)
{
  Usd *self = export;

  cloth_output_free (self->output);
  cloth_output_free (self->extents);
  g_string_free (self->text, TRUE);
  g_free (self);
}

static void
append_vector (GString * text, const gfloat * values, guint n)
{
  for (guint k = 0; k < n; k++) {
    g_string_append (text, k > 0 ? ", " : "(");
    cloth_text_append_float (text, values[k]);
  }
  g_string_append_c (text, ')');
}

static void
append_header (Usd * self, const gchar * name)
{
  const ClothExportInfo *info = self->info;
  GString *text = self->text;

  g_string_append_printf (text, "#usda 1.0\n(\n    defaultPrim = \"%s\"\n"
      "    doc = \"metres, z up; st in metres on the flat cloth\"\n"
      "    endTimeCode = ", name);
  self->code_offset = text->len;
  g_string_append_printf (text, "%*s\n", CODE_WIDTH, "");
  if (info->fps_n > 0) {
    g_string_append (text, "    framesPerSecond = ");
    cloth_text_append_double (text, self->codes_per_second);
    g_string_append_c (text, '\n');
  }
  g_string_append (text, "    metersPerUnit = 1\n    startTimeCode = 0\n"
      "    timeCodesPerSecond = ");
  cloth_text_append_double (text, self->codes_per_second);
  g_string_append_printf (text, "\n    upAxis = \"Z\"\n)\n\ndef Mesh \"%s\"\n"
      "{\n    uniform bool doubleSided = 1\n"
      "    uniform token orientation = \"rightHanded\"\n"
      "    uniform token subdivisionScheme = \"none\"\n", name);
}

static void
append_topology (Usd * self)
{
  const ClothTopology *topology = self->info->topology;
  GString *text = self->text;

  g_string_append (text, "    int[] faceVertexCounts = [");
  for (gsize f = 0; f < topology->n_faces; f++)
    g_string_append_printf (text, "%s%u", f > 0 ? ", " : "",
        cloth_face_corners (topology->faces + 4 * f));
  g_string_append (text, "]\n    int[] faceVertexIndices = [");
  for (gsize f = 0; f < topology->n_faces; f++)
    for (guint k = 0; k < cloth_face_corners (topology->faces + 4 * f); k++)
      g_string_append_printf (text, "%s%u", f > 0 || k > 0 ? ", " : "",
          topology->faces[4 * f + k]);
  g_string_append (text, "]\n    texCoord2f[] primvars:st = [");
  for (gsize i = 0; i < topology->n_vertices; i++) {
    g_string_append (text, i > 0 ? ", " : "");
    append_vector (text, topology->uv + 2 * i, 2);
  }
  g_string_append (text, "] (\n        interpolation = \"vertex\"\n    )\n"
      "    point3f[] points.timeSamples = {\n");
}

static gpointer
start_usd (const ClothExportInfo * info, GError ** error)
{
  g_autofree gchar *name = cloth_export_identifier (info);
  Usd *self = g_new0 (Usd, 1);

  self->info = info;
  self->codes_per_second = info->fps_n > 0 ?
      (gdouble) info->fps_n / info->fps_d : CODES_PER_SECOND;
  self->text = g_string_new (NULL);
  self->output = cloth_export_open (info, ".usda", error);
  if (self->output)
    self->extents = cloth_export_open (info, ".extents", error);
  if (self->extents) {
    append_header (self, name);
    append_topology (self);
    if (cloth_text_flush (self->text, self->output, error))
      return self;
  }
  free_usd (self);
  return NULL;
}

static void
append_code (GString * text, gdouble code)
{
  g_string_append (text, "        ");
  cloth_text_append_double (text, code);
  g_string_append (text, ": [");
}

static gboolean
append_usd (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  Usd *self = export;
  const guint n = self->info->topology->n_vertices;
  gdouble code;
  gfloat bounds[6];

  if (number == 0)
    self->start_s = time_s;
  code = rint ((time_s - self->start_s) * self->codes_per_second * CODE_PARTS)
      / CODE_PARTS;
  if (!cloth_export_check_later (number, self->code, code, error))
    return FALSE;
  self->code = code;
  g_string_truncate (self->text, 0);
  append_code (self->text, code);
  for (gsize i = 0; i < n; i++) {
    g_string_append (self->text, i > 0 ? ", " : "");
    append_vector (self->text, frame->positions + 3 * i, 3);
  }
  g_string_append (self->text, "],\n");
  if (!cloth_text_flush (self->text, self->output, error))
    return FALSE;
  cloth_export_bounds (frame->positions, n, bounds);
  append_code (self->text, code);
  append_vector (self->text, bounds, 3);
  g_string_append (self->text, ", ");
  append_vector (self->text, bounds + 3, 3);
  g_string_append (self->text, "],\n");
  return cloth_output_write (self->extents, self->text->str, self->text->len,
      error);
}

static gboolean
finish_usd (gpointer export, GError ** error)
{
  static const gchar between[] =
      "    }\n    float3[] extent.timeSamples = {\n", end[] = "    }\n}\n";
  Usd *self = export;

  g_string_truncate (self->text, 0);
  cloth_text_append_double (self->text, self->code);
  return cloth_output_write_at (self->output, self->code_offset,
      self->text->str, MIN (self->text->len, CODE_WIDTH), error) &&
      cloth_output_write (self->output, between, strlen (between), error) &&
      cloth_output_copy (self->extents, self->output, error) &&
      cloth_output_write (self->output, end, strlen (end), error) &&
      cloth_output_commit (self->output, error);
}

const ClothExporter cloth_usd_exporter = {
  FALSE, ".usda", FALSE, start_usd, append_usd, finish_usd, free_usd
};
