/* Where the cloth of a recording was in its first frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

gboolean cloth_start_smooth (const ClothTopology * topology,
    const gdouble * seen, gdouble sigma, gdouble * positions,
    gdouble * velocities);
gboolean cloth_recording_find_start (const ClothRecording * recording,
    gdouble * positions, gdouble * velocities);

G_END_DECLS
