/* VTK PolyData for ParaView: one VTP file a frame and a PVD file with their times.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/mesh/formats/export.h"
#include "gst/mesh/strain.h"

typedef struct
{
  const ClothExportInfo *info;
  ClothOutput *collection;
  guint64 n_frames;
  gchar *base;                  /* of the files' names, for XML */
  GString *text;
  gdouble time_s;
  gsize n_corners;
  guint32 *corners;             /* of all faces, one after the other */
  guint32 *ends;                /* a face, in corners */
  gfloat *scratch;              /* 3 a vertex, 3 a face */
  ClothStrains *strains;        /* NULL when uv is not known */
} Vtp;

/* The arrays behind the XML text; each has its length, 8 bytes, before it. */
typedef struct
{
  gsize item_size, n_items;
  gpointer items;               /* in the byte order of the file */
} Block;

static void
free_vtp (gpointer export)
{
  Vtp *self = export;

  cloth_output_free (self->collection);
  g_string_free (self->text, TRUE);
  g_free (self->base);
  g_free (self->corners);
  g_free (self->ends);
  g_free (self->scratch);
  cloth_strains_free (self->strains);
  g_free (self);
}

static void
list_corners (Vtp * self)
{
  const ClothTopology *topology = self->info->topology;

  self->corners = g_new (guint32, 4 * (gsize) topology->n_faces + 1);
  self->ends = g_new (guint32, (gsize) topology->n_faces + 1);
  for (gsize f = 0; f < topology->n_faces; f++) {
    for (guint k = 0; k < cloth_face_corners (topology->faces + 4 * f); k++)
      self->corners[self->n_corners++] = topology->faces[4 * f + k];
    self->ends[f] = (guint32) self->n_corners;
  }
  cloth_swap_little_endian (self->corners, sizeof *self->corners,
      self->n_corners);
  cloth_swap_little_endian (self->ends, sizeof *self->ends, topology->n_faces);
}

static gpointer
start_vtp (const ClothExportInfo * info, GError ** error)
{
  Vtp *self = g_new0 (Vtp, 1);

  self->info = info;
  self->base = g_markup_escape_text (info->base, -1);
  self->text = g_string_new ("<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n  <Collection>\n");
  self->scratch = g_new (gfloat, 3 * MAX ((gsize) info->topology->n_vertices,
          (gsize) info->topology->n_faces));
  self->strains = cloth_strains_new (info->topology);
  list_corners (self);
  self->collection = cloth_export_open (info, ".pvd", error);
  if (self->collection &&
      cloth_text_flush (self->text, self->collection, error))
    return self;
  free_vtp (self);
  return NULL;
}

static void
append_array (GString * text, const gchar * type, const gchar * name,
    guint n_components, guint64 * offset, const Block * block)
{
  g_string_append_printf (text, "<DataArray type=\"%s\" Name=\"%s\" "
      "NumberOfComponents=\"%u\" format=\"appended\" offset=\"%"
      G_GUINT64_FORMAT "\"/>\n", type, name, n_components, *offset);
  *offset += 8 + block->item_size * block->n_items;
}

/* Three numbers with names, so that nobody takes them for a vector. */
static void
append_strain (GString * text, guint64 * offset, const Block * block)
{
  g_string_append_printf (text, "<DataArray type=\"Float32\" Name=\"strain\" "
      "NumberOfComponents=\"3\" ComponentName0=\"warp\" "
      "ComponentName1=\"weft\" ComponentName2=\"shear\" format=\"appended\" "
      "offset=\"%" G_GUINT64_FORMAT "\"/>\n", *offset);
  *offset += 8 + block->item_size * block->n_items;
}

static gboolean
write_block (ClothOutput * output, const Block * block, GError ** error)
{
  guint64 size = block->item_size * block->n_items, ordered = size;

  cloth_swap_little_endian (&ordered, sizeof ordered, 1);
  return cloth_output_write (output, &ordered, sizeof ordered, error) &&
      cloth_output_write (output, block->items, size, error);
}

/* Fills the scratch memory with @values, or with standard deviations or strains. */
static gpointer
order_floats (Vtp * self, const gfloat * values, gsize n)
{
  memcpy (self->scratch, values, n * sizeof *values);
  cloth_swap_little_endian (self->scratch, sizeof *values, n);
  return self->scratch;
}

static gpointer
order_sigmas (Vtp * self, const ClothMeshFrame * frame)
{
  const gsize n = self->info->topology->n_vertices;

  for (gsize i = 0; i < n; i++)
    self->scratch[i] = frame->covariances &&
        frame->states[i] != CLOTH_VERTEX_UNSEEN ?
        cloth_export_sigma (frame->covariances + 6 * i) : NAN;
  cloth_swap_little_endian (self->scratch, sizeof *self->scratch, n);
  return self->scratch;
}

static gboolean
write_strain (Vtp * self, ClothOutput * output, Block * block,
    const gfloat * values, GError ** error)
{
  block->items = order_floats (self, values, block->n_items);
  return write_block (output, block, error);
}

static gboolean
write_frame (Vtp * self, ClothOutput * output, const ClothMeshFrame * frame,
    GError ** error)
{
  const ClothTopology *topology = self->info->topology;
  const gsize n = topology->n_vertices, n_faces = topology->n_faces;
  Block states = { 1, n, (gpointer) frame->states }, sigmas = { 4, n, NULL };
  Block uv = { 4, 2 * n, NULL }, points = { 4, 3 * n, NULL };
  Block corners = { 4, self->n_corners, self->corners };
  Block ends = { 4, n_faces, self->ends };
  Block strains = { 4, 3 * n, NULL }, face_strains = { 4, 3 * n_faces, NULL };
  guint64 offset = 0;
  GString *text = self->text;

  g_string_append_printf (text, "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"%" G_GSIZE_FORMAT "\" NumberOfVerts=\"0\" "
      "NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"%"
      G_GSIZE_FORMAT "\">\n<PointData Scalars=\"sigma\" TCoords=\"uv\">\n", n,
      n_faces);
  append_array (text, "UInt8", "state", 1, &offset, &states);
  append_array (text, "Float32", "sigma", 1, &offset, &sigmas);
  append_array (text, "Float32", "uv", 2, &offset, &uv);
  if (self->strains) {
    cloth_strains_measure (self->strains, frame->positions, frame->states);
    append_strain (text, &offset, &strains);
    g_string_append (text, "</PointData>\n<CellData>\n");
    append_strain (text, &offset, &face_strains);
    g_string_append (text, "</CellData>\n<Points>\n");
  } else {
    g_string_append (text, "</PointData>\n<Points>\n");
  }
  append_array (text, "Float32", "Points", 3, &offset, &points);
  g_string_append (text, "</Points>\n<Polys>\n");
  append_array (text, "Int32", "connectivity", 1, &offset, &corners);
  append_array (text, "Int32", "offsets", 1, &offset, &ends);
  g_string_append (text, "</Polys>\n</Piece>\n</PolyData>\n"
      "<AppendedData encoding=\"raw\">\n_");
  if (!cloth_text_flush (text, output, error) ||
      !write_block (output, &states, error))
    return FALSE;
  sigmas.items = order_sigmas (self, frame);
  if (!write_block (output, &sigmas, error))
    return FALSE;
  uv.items = order_floats (self, topology->uv, 2 * n);
  if (!write_block (output, &uv, error))
    return FALSE;
  if (self->strains && (!write_strain (self, output, &strains,
              cloth_strains_get_vertices (self->strains), error) ||
          !write_strain (self, output, &face_strains,
              cloth_strains_get_faces (self->strains), error)))
    return FALSE;
  points.items = order_floats (self, frame->positions, 3 * n);
  g_string_append (text, "\n</AppendedData>\n</VTKFile>\n");
  return write_block (output, &points, error) &&
      write_block (output, &corners, error) &&
      write_block (output, &ends, error) &&
      cloth_text_flush (text, output, error);
}

static gboolean
append_vtp (gpointer export, guint64 number, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  Vtp *self = export;
  g_autoptr (ClothOutput) output = NULL;

  if (!cloth_export_check_later (number, self->time_s, time_s, error))
    return FALSE;
  self->time_s = time_s;
  output = cloth_parts_open_numbered (self->info->parts, self->info->base,
      number, ".vtp", error);
  if (!output || !write_frame (self, output, frame, error) ||
      !cloth_output_commit (output, error))
    return FALSE;
  self->n_frames = number + 1;
  g_string_append (self->text, "    <DataSet timestep=\"");
  cloth_text_append_double (self->text, time_s);
  g_string_append_printf (self->text, "\" group=\"\" part=\"0\" file=\"%s_%05"
      G_GUINT64_FORMAT ".vtp\"/>\n", self->base, number);
  return cloth_text_flush (self->text, self->collection, error) &&
      cloth_output_flush (self->collection, error);
}

static gboolean
end_collection (ClothOutput * collection, GError ** error)
{
  static const gchar end[] = "  </Collection>\n</VTKFile>\n";

  return cloth_output_write (collection, end, strlen (end), error) &&
      cloth_output_commit (collection, error);
}

static gboolean
finish_vtp (gpointer export, GError ** error)
{
  Vtp *self = export;

  return cloth_parts_replace_numbered (self->info->parts, self->info->base,
      self->n_frames, ".vtp", error) && end_collection (self->collection,
      error);
}

/* How many frames the collection lists, and where each line ends. */
static GArray *
list_frames (const gchar * path, GError ** error)
{
  g_autoptr (ClothInput) input = cloth_input_open (path, error);
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  g_autoptr (GArray) ends = g_array_new (FALSE, FALSE, sizeof (guint64));
  const gchar *text, *line, *end;

  if (!input || !cloth_input_load (input, CLOTH_MAX_BUFFER, bytes, error))
    return NULL;
  text = line = (const gchar *) bytes->data;
  for (; (end = strchr (line, '\n')); line = end + 1) {
    const guint64 offset = (guint64) (end + 1 - text);

    if (g_str_has_prefix (line, "    <DataSet "))
      g_array_append_val (ends, offset);
  }
  return g_steal_pointer (&ends);
}

gboolean
cloth_vtp_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error)
{
  g_autofree gchar *name = g_strconcat (base, ".pvd", NULL);
  g_autofree gchar *path = cloth_parts_get_path (parts, name);
  GError *fault = NULL;
  g_autoptr (GArray) ends = list_frames (path, &fault);
  g_autoptr (ClothOutput) output = NULL;
  guint64 n, n_files;

  if (!ends)
    return cloth_file_is_unwritten (fault, error);
  if (!cloth_parts_count_numbered (parts, base, ".vtp", &n_files, error))
    return FALSE;
  n = recovered->n_frames = MIN (n_files, ends->len);
  recovered->n_left_out = MAX (n_files, ends->len) - n;
  if (n == 0)
    return TRUE;
  if (!cloth_parts_drop_numbered (parts, base, n, ".vtp", error) ||
      !cloth_parts_replace_numbered (parts, base, n, ".vtp", error))
    return FALSE;
  output = cloth_parts_continue (parts, name,
      g_array_index (ends, guint64, n - 1), error);
  return output && end_collection (output, error);
}

const ClothExporter cloth_vtp_exporter = {
  FALSE, ".pvd", TRUE, start_vtp, append_vtp, finish_vtp, free_vtp
};
