/* What the cameras saw of a take: its rig and its files of observations.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/observations.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

gboolean gst_cloth_sights_load (const gchar * folder,
    const ClothTopology * topology, ClothSights ** sights, GError ** error);
gboolean gst_cloth_sights_load_take (ClothTake * take, ClothSights ** sights,
    GError ** error);
gboolean gst_cloth_sights_read (ClothSights * sights, guint camera,
    guint columns, guint rows, ClothInput * input, GError ** error);

G_END_DECLS
