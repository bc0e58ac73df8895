/* Recordings of other programs, as they are in their files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/formats/formats.h"
#include "gst/mesh/seam.h"

G_BEGIN_DECLS

/* @markers: where the points are
 * @topology: (nullable): the mesh, when the source has one
 * @has_uv: whether that says where its vertices lie on the flat cloth
 * @split: (nullable): the mesh in parts, when it gives vertices several uv
 */
typedef struct {
  ClothMarkers *markers;
  ClothTopology *topology;
  gboolean has_uv;
  ClothSplit *split;
} ClothImportSource;

gboolean cloth_import_source_read (ClothImportSource * source,
    const gchar * path, GError ** error);
void cloth_import_source_clear (ClothImportSource * source);

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (ClothImportSource, cloth_import_source_clear)
G_END_DECLS
