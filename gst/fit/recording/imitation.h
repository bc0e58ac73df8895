/* Recordings that a simulation made in place of the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording-type.h"

G_BEGIN_DECLS

ClothRecording *cloth_imitation_new (const ClothRecording * recording);
void cloth_imitation_spoil (ClothRecording * imitation,
    const ClothRecording * recording, gdouble noise, guint64 seed);
void cloth_imitation_free (ClothRecording * imitation);

G_END_DECLS
