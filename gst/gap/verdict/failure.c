/* Simulations that diverged, and effects that could not be tested for it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/failure.h"

#include <math.h>

/* Appends the free numbers that differ from their fitted values. */
static void
append_free (const ClothDiagnosis * d, const ClothModel * model, GString * text)
{
  for (guint i = 0; d->candidates && i < d->candidates->n_free; i++) {
    const gchar *name = cloth_candidates_direction (d->candidates, i)->name;
    gdouble value = 0., fitted = NAN;

    if (!cloth_model_get (model, name, &value, NULL)
        || (d->model && cloth_model_get (d->model, name, &fitted, NULL)
            && value == fitted))
      continue;
    g_string_append_printf (text, "%s%s %.3g", text->len ? ", " : "", name,
        value);
  }
}

/* Appends the parameters of effects that differ from their null values. */
static void
append_effects (const ClothModel * model, GString * text)
{
  for (guint i = 0; i < model->effects->len; i++) {
    const ClothModelEffect *e = &g_array_index (model->effects,
        ClothModelEffect, i);

    for (guint k = 0; k < e->effect->n_parameters; k++)
      if (e->values[k] != e->effect->parameters[k].null_value)
        g_string_append_printf (text, "%seffects.%s.%s %.3g",
            text->len ? ", " : "", e->effect->id, e->effect->parameters[k].name,
            e->values[k]);
  }
}

/* A #ClothRolloutFailed: notes what ran, on which recording, and with which numbers. */
void
cloth_diagnosis_note_failure (gpointer data, const ClothRecording * recording,
    const ClothModel * model, gdouble sound_s)
{
  ClothDiagnosis *d = data;
  g_autoptr (GString) numbers = g_string_new (NULL);
  g_autofree gchar *run = NULL;
  g_autofree gchar *what = g_strdup_printf ("It diverged at %.2f s.", sound_s);

  if (d->model && model->force_model != d->model->force_model)
    g_string_append (numbers, "the other force model");
  append_free (d, model, numbers);
  append_effects (model, numbers);
  run = g_strdup_printf ("%s%s%s%s%s", d->what,
      g_str_has_suffix (d->what, recording->name) ? "" : " on ",
      g_str_has_suffix (d->what, recording->name) ? "" : recording->name,
      numbers->len ? ", with " : "", numbers->str);
  cloth_gap_result_add_failure (d->result, run, what);
}

static gboolean
is_listed (const ClothGapResult * result, const ClothEffect * effect)
{
  for (guint i = 0; i < result->effects->len; i++)
    if (g_array_index (result->effects, ClothGapEffect, i).effect == effect)
      return TRUE;
  for (guint i = 0; i < result->untested->len; i++)
    if (g_array_index (result->untested, ClothGapUntested, i).effect == effect)
      return TRUE;
  return FALSE;
}

/* Notes the effects that are neither ranked nor listed as untested: the simulation diverges with
 * them. */
void
cloth_diagnosis_note_untested (ClothDiagnosis * d)
{
  for (guint i = 0; i < d->candidates->list->len; i++) {
    const ClothEffect *effect = g_array_index (d->candidates->list,
        ClothCandidate, i).effect;

    if (!is_listed (d->result, effect))
      cloth_gap_result_add_untested (d->result, effect, "The simulation "
          "diverges with it; give the model softer cloth, more damping or a "
          "smaller time_step.");
  }
}
