/* The model's free numbers and the effects to look for, as directions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/candidates.h"

/* Notes why an effect is no candidate. Camera effects are tested elsewhere. */
static void
skip (gpointer data, const ClothEffect * effect, const gchar * reason)
{
  ClothDiagnosis *d = data;

  if (effect->side == CLOTH_EFFECT_CAMERA || effect->side == CLOTH_EFFECT_IMAGE) {
    const gchar *blind = effect->untested;

    if (d->has_camera_errors && !blind)
      return;
    if (cloth_diagnosis_has_observations (d))
      reason = blind ? blind : "No point was seen by two cameras at a time.";
  }
  cloth_gap_result_add_untested (d->result, effect, reason);
}

/* @d: a diagnosis whose recordings are loaded and whose cameras are checked
 * @model: what the simulator knows
 * @error: #ClothFitError
 *
 * Lists the model's free numbers and the effects to test, as directions.
 *
 * Returns: whether that is possible
 */
gboolean
cloth_diagnosis_list_candidates (ClothDiagnosis * d, const ClothModel * model,
    GError ** error)
{
  guint n;

  d->candidates =
      cloth_candidates_new (model, cloth_diagnosis_recording (d, 0),
      d->options->effects,
      CLOTH_CANDIDATES_MEASUREMENT | (cloth_diagnosis_n_references (d) ?
          CLOTH_CANDIDATES_FROZEN : CLOTH_CANDIDATES_DEFAULT), skip, d, error);
  if (!d->candidates)
    return FALSE;
  n = d->candidates->directions->len;
  d->all = g_new (guint, n + 1);
  for (guint i = 0; i < n; i++)
    d->all[i] = i;
  d->precisions = g_new (gdouble, d->candidates->n_free + 1);
  return TRUE;
}
