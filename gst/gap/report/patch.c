/* What to change in model.json: what parts the fitted model from the given one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/patch.h"

#include <math.h>

#include "gst/gap/report/words.h"

static gboolean
has_effect (const ClothModel * model, const ClothEffect * effect)
{
  for (guint i = 0; i < model->effects->len; i++)
    if (g_str_equal (g_array_index (model->effects, ClothModelEffect,
                i).effect->id, effect->id))
      return TRUE;
  return FALSE;
}

/* Nothing where both have the same. @is_new: the given model lacks what it belongs to. */
static void
add_change (ClothGapResult * result, const ClothModel * given,
    const gchar * name, gboolean is_new)
{
  const gchar *unit = cloth_model_get_unit (name);
  g_autofree gchar *text = NULL;
  gdouble before = NAN, after = NAN;

  cloth_model_get (given, name, &before, NULL);
  cloth_model_get (result->model, name, &after, NULL);
  if (before == after)
    return;
  if (is_new)
    before = NAN;
  text = cloth_gap_change_text (name, before, after, unit);
  cloth_gap_result_add_patch (result, name, text, before, after, unit);
}

/* @result: a result with its model
 * @given: the model that the user gave
 *
 * Adds what to change in @given to make it the result's: effects first, then free numbers;
 * with a twin only effects that @given has not, as all else was fitted to the twin: the user's
 * simulator does that already.
 */
void
cloth_gap_result_fill_patch (ClothGapResult * result, const ClothModel * given)
{
  const GArray *effects = result->model->effects, *free = result->model->free;

  for (guint i = 0; i < effects->len; i++) {
    const ClothEffect *effect = g_array_index (effects, ClothModelEffect,
        i).effect;

    if (result->has_simulated && has_effect (given, effect))
      continue;
    for (guint k = 0; k < effect->n_parameters; k++) {
      g_autofree gchar *name = g_strdup_printf ("effects.%s.%s", effect->id,
          effect->parameters[k].name);

      add_change (result, given, name, !has_effect (given, effect));
    }
  }
  for (guint i = 0; i < free->len && !result->has_simulated; i++) {
    const gchar *name = g_array_index (free, ClothModelFree, i).name;

    if (!g_str_has_prefix (name, "effects."))
      add_change (result, given, name, FALSE);
  }
}
