/* What an effect is: one thing that may part a simulation from what was filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* No effect has more parameters. */
#define CLOTH_EFFECT_MAX_PARAMETERS 5

/* @CLOTH_EFFECT_PHYSICS: a force, a mass or a rest shape of the cloth
 * @CLOTH_EFFECT_CLAMP: where the clamps really were
 * @CLOTH_EFFECT_NUMERICS: how the simulator computes
 * @CLOTH_EFFECT_CAMERA: where and when the cameras say a point was
 * @CLOTH_EFFECT_IMAGE: what the picture does to a point found in it
 *
 * On which side of the comparison an effect acts.
 */
typedef enum {
  CLOTH_EFFECT_PHYSICS,
  CLOTH_EFFECT_CLAMP,
  CLOTH_EFFECT_NUMERICS,
  CLOTH_EFFECT_CAMERA,
  CLOTH_EFFECT_IMAGE
} ClothEffectSide;

/* @name: its key in model.json
 * @unit: in the notation of the SI, "1" for a ratio
 * @null_value: the value at which the effect is not there
 * @min: least value that makes sense
 * @max: greatest value that makes sense
 * @prior: scale of the values that a diagnosis expects: the standard deviation about
 *   @null_value, or the mean distance from it when @one_sided
 * @one_sided: nature has it on one side of @null_value only, that of @min < @max
 * @blurb: one plain sentence
 *
 * One number of an effect.
 */
typedef struct {
  const gchar *name;
  const gchar *unit;
  gdouble null_value;
  gdouble min;
  gdouble max;
  gdouble prior;
  gboolean one_sided;
  const gchar *blurb;
} ClothEffectParameter;

/* @id: its name in model.json and gap.json
 * @side: where it acts
 * @blurb: one plain sentence
 * @source: where the law and the usual values come from
 * @regressor: how a residual force would show it, one sentence
 * @confusions: (nullable) (array zero-terminated=1): ids of effects that look alike
 * @n_parameters: number of @parameters
 * @parameters: its numbers
 *
 * The description of an effect. There is one for each, constant and shared by all.
 */
typedef struct {
  const gchar *id;
  ClothEffectSide side;
  const gchar *blurb;
  const gchar *source;
  const gchar *regressor;
  const gchar *const *confusions;
  guint n_parameters;
  ClothEffectParameter parameters[CLOTH_EFFECT_MAX_PARAMETERS];
} ClothEffect;

const ClothEffect *const *cloth_effect_table (guint * n_effects);
const ClothEffect *cloth_effect_find (const gchar * id);
const gchar *cloth_effect_side_name (ClothEffectSide side);

G_END_DECLS
