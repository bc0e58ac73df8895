/* What the numbers of a user's simulator do to ours.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/simulator/capabilities.h"

G_BEGIN_DECLS

/* @name: of a number of ours, as cloth_model_get () names it
 * @logarithmic: it is searched by its logarithm
 * @value: where it is
 *
 * A number of ours that a fit moves.
 */
typedef struct {
  const gchar *name;
  gboolean logarithmic;
  gdouble value;
} ClothSimulatorTarget;

gdouble cloth_simulator_parameter_unit (const ClothSimulatorParameter *
    parameter);
gdouble cloth_simulator_parameter_place (const ClothSimulatorParameter *
    parameter, gdouble value);
gdouble cloth_simulator_parameter_value (const ClothSimulatorParameter *
    parameter, gdouble place);
gboolean cloth_simulator_parameter_does (const ClothSimulatorParameter *
    parameter, const gchar * name);
gboolean cloth_simulator_parameter_slopes (const ClothSimulatorParameter *
    parameter, const ClothSimulatorTarget * targets, guint n,
    gdouble * slopes);

G_END_DECLS
