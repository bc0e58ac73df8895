/* A model of a cloth: defaults and effects.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/model.h"

#include <string.h>

static void
free_clear (gpointer data)
{
  g_free (((ClothModelFree *) data)->name);
}

/**
 * cloth_model_new:
 *
 * Returns: (transfer full): a model with the default of every key and no effects
 * Since: 0.1
 */
ClothModel *
cloth_model_new (void)
{
  ClothModel *model = g_new0 (ClothModel, 1);

  model->areal_density = 0.187;
  model->stretch_warp = model->stretch_weft = 100.;
  model->shear = 40.;
  model->bending_warp = model->bending_weft = 2e-5;
  model->damping_mass = 0.2;
  model->damping_stiffness = 1e-3;
  model->compression_ratio = 0.02;
  model->air_density = 1.2;
  model->effects = g_array_new (FALSE, TRUE, sizeof (ClothModelEffect));
  model->free = g_array_new (FALSE, TRUE, sizeof (ClothModelFree));
  g_array_set_clear_func (model->free, free_clear);
  return model;
}

/**
 * cloth_model_set_effect:
 * @model: a model
 * @effect: an effect
 * @values: (nullable): its parameters, as many as the effect has; %NULL for its nulls
 *
 * Adds the effect, or changes it when the model has it already.
 *
 * Since: 0.1
 */
void
cloth_model_set_effect (ClothModel * model, const ClothEffect * effect,
    const gdouble * values)
{
  ClothModelEffect entry = { effect };

  for (guint i = 0; i < effect->n_parameters; i++)
    entry.values[i] = values ? values[i] : effect->parameters[i].null_value;
  for (guint i = 0; i < model->effects->len; i++) {
    ClothModelEffect *present =
        &g_array_index (model->effects, ClothModelEffect, i);

    if (strcmp (present->effect->id, effect->id) == 0) {
      *present = entry;
      return;
    }
  }
  g_array_append_val (model->effects, entry);
}

/**
 * cloth_model_free:
 * @model: (nullable) (transfer full): a model
 *
 * Since: 0.1
 */
void
cloth_model_free (ClothModel * model)
{
  if (!model)
    return;
  g_array_unref (model->effects);
  g_array_unref (model->free);
  g_free (model);
}
