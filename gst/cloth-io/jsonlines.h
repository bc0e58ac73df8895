/* What was found, as JSON: one object a frame, on a line of its own.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

G_BEGIN_DECLS

/* A line, with its end, of the squares, dots and matches that a picture carries.
 * @time_s: of the picture, NaN when it has none */
gchar *gst_cloth_io_json_of_picture (GstBuffer * picture, gdouble time_s);
/* The same of a mesh of @topology. */
gchar *gst_cloth_io_json_of_mesh (const GstClothMesh * mesh,
    const GstClothTopology * topology, gdouble time_s);

G_END_DECLS
