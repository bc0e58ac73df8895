/* What the cameras saw of a take: its rig and its files of observations.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

#include "gst/file/output.h"
#include "gst/fit/recording/recording.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

gboolean gst_cloth_io_observations_load (const gchar * folder,
    const gchar * rig_file, const ClothTopology * topology, ClothObservations ** observations, GError ** error);
gboolean gst_cloth_io_observations_load_take (ClothTake * take, const gchar * rig_file,
    ClothObservations ** observations, GError ** error);
gboolean gst_cloth_io_observations_read (ClothObservations * observations, guint camera,
    guint columns, guint rows, ClothInput * input, GError ** error);
gboolean gst_cloth_io_observations_write (ClothOutput * output, GstBuffer * observation,
    GstClockTime time, GError ** error);

G_END_DECLS
