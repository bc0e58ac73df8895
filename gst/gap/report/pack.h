/* Moving meshes as few bytes, for a page.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/jsonwriter.h"
#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* @origin: of the box that the places lie in
 * @step: of its grid, metres
 *
 * Places as 16-bit numbers of steps from a corner of the box; the last number is of those
 * not seen.
 */
typedef struct {
  gfloat origin[3];
  gfloat step;
} ClothPackBox;

void cloth_pack_box (ClothPackBox * box, const gfloat low[3],
    const gfloat high[3], gfloat margin);
void cloth_pack_place (const ClothPackBox * box, const gfloat place[3],
    guint16 packed[3]);
guint8 cloth_pack_sigma (gdouble sigma_m);

void cloth_pack_put_bytes (ClothJsonWriter * writer, const gchar * key,
    gconstpointer bytes, gsize size);
void cloth_pack_put_box (ClothJsonWriter * writer, const ClothPackBox * box);
void cloth_pack_put_sigmas (ClothJsonWriter * writer, const guint8 * sigmas,
    gsize n);
void cloth_pack_put_topology (ClothJsonWriter * writer,
    const ClothTopology * topology);

G_END_DECLS
