/* Decides whether the user's simulator with the accepted effects agrees with what judges.
 *
 * Before it is run, ours foretells what the effects bring there, which may be far off. Once it was
 * run, its rest is what counts: it is explained when it is below 2.25 floors in variance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/confirm.h"

#include "gst/gap/verdict/agreement.h"
#include "gst/gap/verdict/judge.h"

/* @d: a diagnosis whose verdict is decided, and measured with the effects in the user's simulator
 *
 * Corrects the verdict by what was measured. What is unexplained for another reason than the rest,
 * like clamps that were elsewhere, stays so.
 */
void
cloth_diagnosis_confirm (ClothDiagnosis * d)
{
  ClothGapResult *r = d->result;
  const gdouble rest = r->gap_after.value, floor = r->noise_floor.value;
  gboolean explained;

  if (!d->afters->len || !d->n_accepted || d->clamps_off || d->chance
      || r->takes_agree_p_value < CLOTH_DIAGNOSIS_CONTRADICTION
      || r->verdict < CLOTH_GAP_EXPLAINED)
    return;
  explained = rest * rest <= CLOTH_DIAGNOSIS_LARGEST_REST * floor * floor;
  g_clear_pointer (&r->reason, g_free);
  if (!explained)
    r->verdict = CLOTH_GAP_UNEXPLAINED;
  else
    r->verdict =
        cloth_gap_result_is_ambiguous (r) ? CLOTH_GAP_AMBIGUOUS :
        CLOTH_GAP_EXPLAINED;
}
