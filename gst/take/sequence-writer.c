/* Mesh sequences on disk, whatever their format: writing frame by frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/sequence.h"

#include "gst/mesh/formats/export.h"
#include "gst/mesh/hold.h"
#include "gst/take/take.h"

struct _ClothMeshWriter
{
  const ClothExporter *exporter;
  ClothExportInfo info;
  gpointer export;
  ClothHold *hold;              /* NULL for formats that keep NaN */
  guint64 n_frames;
};

/* by ClothMeshFormat */
static const ClothExporter *const exporters[] = {
  NULL, &cloth_obj_pc2_exporter, &cloth_ply_exporter, &cloth_take_exporter,
  &cloth_gltf_exporter, &cloth_usd_exporter, &cloth_vtp_exporter,
  &cloth_c3d_exporter, &cloth_csv_exporter
};

/* @location: file or folder; a take's folder is made, no other one
 * @format: its format
 * @name: (nullable): name of the object or take; by default, of the file
 * @topology: the mesh of every frame, copied
 * @fps_n: numerator of the frame rate, 0 when it varies
 * @fps_d: its denominator
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Starts a sequence. Frames go to temporary names as they come; nothing but the
 * current one is held. The files get their names at the close.
 *
 * Returns: (transfer full): a writer, or %NULL
 */
ClothMeshWriter *
cloth_mesh_writer_new (const gchar * location, ClothMeshFormat format,
    const gchar * name, const ClothTopology * topology, gint fps_n, gint fps_d,
    GError ** error)
{
  g_autoptr (ClothMeshWriter) writer = NULL;

  if (format == CLOTH_MESH_FORMAT_AUTO)
    format = cloth_mesh_format_guess (location);
  g_return_val_if_fail (format < G_N_ELEMENTS (exporters), NULL);
  if (!cloth_topology_check (topology, error))
    return NULL;
  writer = g_new0 (ClothMeshWriter, 1);
  writer->exporter = exporters[format];
  writer->info.stem = cloth_mesh_format_stem (location, format);
  writer->info.name = name ? g_strdup (name) :
      g_path_get_basename (writer->info.stem);
  writer->info.fps_n = fps_n;
  writer->info.fps_d = fps_d;
  writer->info.topology = cloth_topology_copy (topology);
  writer->export = writer->exporter->start (&writer->info, error);
  if (!writer->export)
    return NULL;
  if (!writer->exporter->keeps_nan)
    writer->hold = cloth_hold_new (topology);
  return g_steal_pointer (&writer);
}

/* @writer: a writer
 * @time_s: time of the frame, seconds; OBJ + PC2, PLY and C3D don't keep it
 * @frame: the frame
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Returns: %TRUE when the frame was taken
 */
gboolean
cloth_mesh_writer_append (ClothMeshWriter * writer, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error)
{
  ClothMeshFrame shown = *frame;

  if (!cloth_positions_check (frame->positions,
          writer->info.topology->n_vertices, error) ||
      !cloth_states_check (frame->states, writer->info.topology->n_vertices,
          error))
    return FALSE;
  if (writer->hold)
    shown.positions = cloth_hold_apply (writer->hold, frame->positions);
  if (!writer->exporter->append (writer->export, writer->n_frames, time_s,
          &shown, error))
    return FALSE;
  writer->n_frames++;
  return TRUE;
}

/* @writer: a writer
 *
 * Returns: frames taken so far
 */
guint64
cloth_mesh_writer_get_n_frames (const ClothMeshWriter * writer)
{
  return writer->n_frames;
}

/* @writer: a writer that has at least one frame
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Gives the files their names, replacing those of an earlier sequence. The writer
 * can then only be freed.
 *
 * Returns: %TRUE when the sequence is there
 */
gboolean
cloth_mesh_writer_close (ClothMeshWriter * writer, GError ** error)
{
  if (writer->n_frames == 0) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "there is no frame to write");
    return FALSE;
  }
  return writer->exporter->finish (writer->export, error);
}

/* @writer: (transfer full) (nullable): a writer
 *
 * Frees it; a sequence that was not closed leaves nothing behind.
 */
void
cloth_mesh_writer_free (ClothMeshWriter * writer)
{
  if (!writer)
    return;
  if (writer->export)
    writer->exporter->free (writer->export);
  cloth_hold_free (writer->hold);
  cloth_topology_free (writer->info.topology);
  g_free (writer->info.stem);
  g_free (writer->info.name);
  g_free (writer);
}
