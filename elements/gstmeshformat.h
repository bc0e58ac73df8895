/* What meshsink and meshsrc share: the formats and how a file's error is told.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/take/sequence.h"

G_BEGIN_DECLS

/* Of the enum GstMeshFormat. */
extern const GEnumValue gst_mesh_format_values[];

ClothTopology *gst_mesh_copy_topology (const GstClothTopology * from);
void gst_mesh_post_error (GstElement * element, const gchar * doing,
    const gchar * location, gboolean writing, const GError * error);

G_END_DECLS
