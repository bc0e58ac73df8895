/* A user's simulator as a program: --simulator COMMAND.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/simulator/simulator.h"

G_BEGIN_DECLS

/* Seconds that a run may take when nobody says otherwise: a hundred times what Blender's
 * cloth takes for 250 frames of 33×35 vertices. */
#define GAP_SIMULATOR_SECONDS 600

typedef struct _GapSimulator GapSimulator;

GapSimulator *gap_simulator_new (const gchar * command, guint seconds,
    GError ** error);
ClothGapSimulator *gap_simulator_get (GapSimulator * simulator);
void gap_simulator_free (GapSimulator * simulator);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GapSimulator, gap_simulator_free)
G_END_DECLS
