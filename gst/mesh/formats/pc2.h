/* PC2 point caches: where each vertex of a mesh is in each sample.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* @n_points: vertices, as many as the mesh has
 * @start: frame of the first sample
 * @rate: frames from one sample to the next
 * @n_samples: number of samples
 *
 * The header of a PC2 file. It knows no frame rate.
 */
typedef struct {
  guint n_points;
  gfloat start;
  gfloat rate;
  guint n_samples;
} ClothPc2Info;

typedef struct _ClothPc2Reader ClothPc2Reader;

ClothPc2Reader *cloth_pc2_reader_open (const gchar * path, GError ** error);
ClothPc2Reader *cloth_pc2_reader_new (ClothInput * input, GError ** error);
const ClothPc2Info *cloth_pc2_reader_get_info (const ClothPc2Reader * reader);
gboolean cloth_pc2_reader_read (ClothPc2Reader * reader, guint sample,
    gfloat * positions, GError ** error);
void cloth_pc2_reader_free (ClothPc2Reader * reader);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPc2Reader, cloth_pc2_reader_free)
G_END_DECLS
