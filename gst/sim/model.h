/* A model of a cloth: what the simulator knows of it (model.json).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/effect/effect.h"

G_BEGIN_DECLS

/* @CLOTH_MODEL_ERROR_FORMAT: a text that is no model.json
 * @CLOTH_MODEL_ERROR_NAME: a key, parameter or effect that there is not
 * @CLOTH_MODEL_ERROR_VALUE: a value that cannot be
 *
 * What can be wrong with a model. Messages name the key and the value.
 */
typedef enum {
  CLOTH_MODEL_ERROR_FORMAT,
  CLOTH_MODEL_ERROR_NAME,
  CLOTH_MODEL_ERROR_VALUE
} ClothModelError;

#define CLOTH_MODEL_ERROR (cloth_model_error_quark ())
GQuark cloth_model_error_quark (void);

/* @CLOTH_FORCE_MEMBRANE: orthotropic membrane on triangles with a plate's bending
 * @CLOTH_FORCE_MASS_SPRING: structural, shear and bend springs
 *
 * How the inner forces of the cloth are computed.
 */
typedef enum {
  CLOTH_FORCE_MEMBRANE,
  CLOTH_FORCE_MASS_SPRING
} ClothForceModel;

/* @CLOTH_INTEGRATOR_EXPLICIT: leapfrog, the reference
 * @CLOTH_INTEGRATOR_IMPLICIT: linearly implicit, for stiff cloth
 *
 * How time passes.
 */
typedef enum {
  CLOTH_INTEGRATOR_EXPLICIT,
  CLOTH_INTEGRATOR_IMPLICIT
} ClothIntegrator;

/* @effect: an effect that the model has
 * @values: its parameters, in the order of @effect
 */
typedef struct {
  const ClothEffect *effect;
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
} ClothModelEffect;

/* @name: a parameter that may be fitted, as cloth_model_get () names it
 * @range: between which values
 */
typedef struct {
  gchar *name;
  gdouble range[2];
} ClothModelFree;

/* @force_model: how inner forces are computed
 * @areal_density: kg/m²
 * @stretch_warp: stretch stiffness along u, N/m
 * @stretch_weft: stretch stiffness along v, N/m
 * @shear: shear stiffness, N/m
 * @bending_warp: bending stiffness of a fold that bends the u direction, N·m
 * @bending_weft: bending stiffness of a fold that bends the v direction, N·m
 * @damping_mass: velocity is lost at this rate, 1/s (α of αM + βK)
 * @damping_stiffness: inner forces lag by this time, s (β of αM + βK)
 * @compression_ratio: stiffness of compressed cloth over that of stretched cloth
 * @air_density: kg/m³
 * @integrator: how time passes
 * @time_step: s, 0 = automatic
 * @effects: (element-type ClothModelEffect): effects that are modelled
 * @free: (element-type ClothModelFree): what may be fitted
 *
 * The contents of model.json.
 */
typedef struct {
  ClothForceModel force_model;
  gdouble areal_density;
  gdouble stretch_warp;
  gdouble stretch_weft;
  gdouble shear;
  gdouble bending_warp;
  gdouble bending_weft;
  gdouble damping_mass;
  gdouble damping_stiffness;
  gdouble compression_ratio;
  gdouble air_density;
  ClothIntegrator integrator;
  gdouble time_step;
  GArray *effects;
  GArray *free;
} ClothModel;

ClothModel *cloth_model_new (void);
ClothModel *cloth_model_copy (const ClothModel * model);
void cloth_model_set_effect (ClothModel * model, const ClothEffect * effect,
    const gdouble * values);
gboolean cloth_model_get (const ClothModel * model, const gchar * name,
    gdouble * value, GError ** error);
gboolean cloth_model_set (ClothModel * model, const gchar * name,
    gdouble value, GError ** error);
gboolean cloth_model_get_range (const gchar * name, gdouble range[2],
    GError ** error);
const gchar *cloth_model_get_unit (const gchar * name);
gboolean cloth_model_check (const ClothModel * model, GError ** error);
void cloth_model_free (ClothModel * model);

ClothModel *cloth_model_parse (const gchar * json, gsize size,
    GError ** error);
ClothModel *cloth_model_load (const gchar * path, GError ** error);
gchar *cloth_model_to_json (const ClothModel * model);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothModel, cloth_model_free)
G_END_DECLS
