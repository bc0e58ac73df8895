/* What a user's simulator says of itself: capabilities.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @CLOTH_SIMULATOR_ERROR_CAPABILITIES: a text that is no capabilities.json
 * @CLOTH_SIMULATOR_ERROR_RUN: it could not be started, failed or took too long
 * @CLOTH_SIMULATOR_ERROR_RESULT: what it wrote is no simulation of the scene
 *
 * What can be wrong with a user's simulator. Messages say what to do.
 */
typedef enum {
  CLOTH_SIMULATOR_ERROR_CAPABILITIES,
  CLOTH_SIMULATOR_ERROR_RUN,
  CLOTH_SIMULATOR_ERROR_RESULT
} ClothSimulatorError;

#define CLOTH_SIMULATOR_ERROR (cloth_simulator_error_quark ())
GQuark cloth_simulator_error_quark (void);

/* @name: its name in the simulator
 * @unit: its unit there, "1" for a ratio
 * @blurb: (nullable): one sentence
 * @value: where it is when nobody asks for another value
 * @range: least and greatest value; NaN of one that is never changed
 * @is: (nullable) (array zero-terminated=1): the numbers of a model.json, as
 *   cloth_model_get () names them, that change with it
 * @scale: the number of model.json over its own, NaN when not told
 *
 * One number of a simulator. It is searched by its logarithm when all of its range is
 * above 0.
 */
typedef struct {
  gchar *name;
  gchar *unit;
  gchar *blurb;
  gdouble value;
  gdouble range[2];
  gchar **is;
  gdouble scale;
} ClothSimulatorParameter;

/* @simulator: its name
 * @version: (nullable): its version
 * @parameters: (element-type ClothSimulatorParameter): its numbers
 *
 * The contents of capabilities.json.
 */
typedef struct {
  gchar *simulator;
  gchar *version;
  GArray *parameters;
} ClothSimulatorCapabilities;

ClothSimulatorCapabilities *cloth_simulator_capabilities_parse (
    const gchar * json, gsize size, GError ** error);
void cloth_simulator_capabilities_free (
    ClothSimulatorCapabilities * capabilities);
gboolean cloth_simulator_parameter_is_fixed (
    const ClothSimulatorParameter * parameter);
gboolean cloth_simulator_parameter_is_logarithmic (
    const ClothSimulatorParameter * parameter);

/* The i-th parameter. */
static inline const ClothSimulatorParameter *
cloth_simulator_capabilities_get (const ClothSimulatorCapabilities *
    capabilities, guint i)
{
  return &g_array_index (capabilities->parameters, ClothSimulatorParameter, i);
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSimulatorCapabilities,
    cloth_simulator_capabilities_free)
G_END_DECLS
