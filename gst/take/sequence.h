/* Mesh sequences on disk, whatever their format: read and written frame by frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* @CLOTH_MESH_FORMAT_AUTO: what the location's ending says
 * @CLOTH_MESH_FORMAT_OBJ_PC2: `name.obj`, `name.pc2` and `name.states.npy`
 * @CLOTH_MESH_FORMAT_PLY: `name_00000.ply`, `name_00001.ply` and so on
 * @CLOTH_MESH_FORMAT_TAKE: the folder of a take
 * @CLOTH_MESH_FORMAT_GLTF: `name.glb`
 * @CLOTH_MESH_FORMAT_USD: `name.usda`
 * @CLOTH_MESH_FORMAT_VTP: `name.pvd` with `name_00000.vtp` and so on
 * @CLOTH_MESH_FORMAT_C3D: `name.c3d`
 * @CLOTH_MESH_FORMAT_CSV: `name.csv`
 *
 * Formats of mesh sequences. The last five are written only.
 */
typedef enum {
  CLOTH_MESH_FORMAT_AUTO,
  CLOTH_MESH_FORMAT_OBJ_PC2,
  CLOTH_MESH_FORMAT_PLY,
  CLOTH_MESH_FORMAT_TAKE,
  CLOTH_MESH_FORMAT_GLTF,
  CLOTH_MESH_FORMAT_USD,
  CLOTH_MESH_FORMAT_VTP,
  CLOTH_MESH_FORMAT_C3D,
  CLOTH_MESH_FORMAT_CSV
} ClothMeshFormat;

typedef struct _ClothMeshReader ClothMeshReader;
typedef struct _ClothMeshWriter ClothMeshWriter;

ClothMeshFormat cloth_mesh_format_guess (const gchar * location);
gboolean cloth_mesh_format_check (const gchar * location,
    ClothMeshFormat format, GError ** error);
gchar *cloth_mesh_format_stem (const gchar * location, ClothMeshFormat format);
gchar *cloth_mesh_format_head (const gchar * location, ClothMeshFormat format);

ClothMeshReader *cloth_mesh_reader_open (const gchar * location,
    ClothMeshFormat format, GError ** error);
const ClothTopology *cloth_mesh_reader_get_topology (
    const ClothMeshReader * reader);
guint cloth_mesh_reader_get_n_frames (const ClothMeshReader * reader);
gdouble cloth_mesh_reader_get_fps (const ClothMeshReader * reader);
const gdouble *cloth_mesh_reader_get_times (const ClothMeshReader * reader);
guint cloth_mesh_reader_get_n_seam_vertices (const ClothMeshReader * reader);
gboolean cloth_mesh_reader_read (ClothMeshReader * reader, guint frame,
    ClothMeshFrame * contents, GError ** error);
void cloth_mesh_reader_free (ClothMeshReader * reader);

ClothMeshWriter *cloth_mesh_writer_new (const gchar * location,
    ClothMeshFormat format, const gchar * name, const ClothTopology * topology,
    gint fps_n, gint fps_d, GError ** error);
gboolean cloth_mesh_writer_append (ClothMeshWriter * writer, gdouble time_s,
    const ClothMeshFrame * frame, GError ** error);
guint64 cloth_mesh_writer_get_n_frames (const ClothMeshWriter * writer);
gboolean cloth_mesh_writer_close (ClothMeshWriter * writer, GError ** error);
gboolean cloth_mesh_writer_leave (ClothMeshWriter * writer);
void cloth_mesh_writer_free (ClothMeshWriter * writer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothMeshReader, cloth_mesh_reader_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothMeshWriter, cloth_mesh_writer_free)
G_END_DECLS
