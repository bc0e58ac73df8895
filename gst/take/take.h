/* A take: the folder that holds one recording of a cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/formats/formats.h"
#include "gst/take/take-info.h"

G_BEGIN_DECLS

typedef struct _ClothTake ClothTake;
typedef struct _ClothTakeWriter ClothTakeWriter;

ClothTake *cloth_take_open (const gchar * folder, GError ** error);
void cloth_take_add_file (ClothTake * take, const gchar * name);
const gchar *cloth_take_get_folder (const ClothTake * take);
const ClothTakeInfo *cloth_take_get_info (const ClothTake * take);
const ClothTopology *cloth_take_get_topology (const ClothTake * take);
guint cloth_take_get_n_frames (const ClothTake * take);
guint cloth_take_get_n_positions (const ClothTake * take);
const gdouble *cloth_take_get_times (const ClothTake * take);
gdouble cloth_take_get_time (const ClothTake * take, guint frame);
gdouble cloth_take_get_rate (const ClothTake * take);
gboolean cloth_take_has_covariances (const ClothTake * take);
gboolean cloth_take_has_clamps (const ClothTake * take);
gboolean cloth_take_read_positions (ClothTake * take, guint frame,
    gfloat * positions, GError ** error);
gboolean cloth_take_read_states (ClothTake * take, guint frame,
    const gfloat * positions, guint8 * states, GError ** error);
gboolean cloth_take_read_covariances (ClothTake * take, guint frame,
    gfloat * covariances, GError ** error);
gboolean cloth_take_read_clamps (ClothTake * take, guint frame,
    gfloat * clamps, GError ** error);
gchar *cloth_take_sha256 (const ClothTake * take, GError ** error);
void cloth_take_free (ClothTake * take);

ClothTakeWriter *cloth_take_writer_new (const gchar * folder,
    const ClothTakeInfo * info, const ClothTopology * topology,
    GError ** error);
gboolean cloth_take_writer_append (ClothTakeWriter * writer, gdouble time_s,
    const gfloat * positions, const guint8 * states,
    const gfloat * covariances, const gfloat * clamps, GError ** error);
gboolean cloth_take_writer_close (ClothTakeWriter * writer, GError ** error);
gboolean cloth_take_writer_leave (ClothTakeWriter * writer);
void cloth_take_writer_free (ClothTakeWriter * writer);
gboolean cloth_take_recover (ClothParts * parts, const gchar * base,
    ClothRecovered * recovered, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTake, cloth_take_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTakeWriter, cloth_take_writer_free)
G_END_DECLS
