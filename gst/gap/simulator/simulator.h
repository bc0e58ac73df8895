/* A user's simulator as a function: numbers in, a simulated take out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inputs.h"
#include "gst/gap/simulator/capabilities.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

/* @data: the caller's
 * @scene: the take that gives mesh, clamps, obstacles, gravity, times and the start
 * @values: one number for each parameter of the capabilities, in their order
 * @error: #ClothSimulatorError
 *
 * Simulates once.
 *
 * Returns: (transfer full) (nullable): what was simulated
 */
typedef ClothTake *(*ClothSimulatorRun) (gpointer data, ClothTake * scene,
    const gdouble * values, GError ** error);

/* @capabilities: what it says of itself
 * @run: simulates once
 * @data: of @run
 * @n_runs: (inout): counts the runs, those that failed too
 */
struct _ClothGapSimulator
{
  const ClothSimulatorCapabilities *capabilities;
  ClothSimulatorRun run;
  gpointer data;
  guint n_runs;
};

gdouble *cloth_gap_simulator_defaults (const ClothSimulatorCapabilities *
    capabilities);
gdouble cloth_gap_simulator_move (const ClothSimulatorParameter * parameter,
    gdouble value);
ClothTake *cloth_gap_simulator_run (ClothGapSimulator * simulator,
    ClothTake * scene, const gdouble * values, GError ** error);
gchar *cloth_gap_simulator_describe (const ClothSimulatorCapabilities *
    capabilities, const gdouble * values);

G_END_DECLS
