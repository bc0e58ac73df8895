/* What remains: how much of a take nothing accounts for that the baseline has too.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/gap/diagnosis.h"

/* A rest this many times the noise speaks of something unknown … */
#define UNKNOWN 1.9
/* … if it is also this share of the simulator's own error: where that is large, chaos of
 * the real cloth is too. */
#define UNKNOWN_SHARE 0.45

/* Sums over takes of squares: of what is left, over the noise of the take and of its
 * signature; of the signature itself; the number of features. */
typedef struct
{
  gdouble rest, signature, n;
} Rest;

/* With the free numbers fitted once more. */
static void
add_rest (const ClothDiagnosis * d, const ClothStudy * study, Rest * rest)
{
  guint n = d->candidates->n_free;
  gdouble scale = cloth_study_signature_scale (study);
  g_autofree gdouble *z = cloth_study_residual (study, 0);
  g_autofree gboolean *blocks = g_new (gboolean, study->features->n_blocks);
  g_autofree gdouble *precisions = g_new (gdouble, n + 1);
  g_autoptr (ClothGapPower) noise = cloth_gap_power_new (study->features, z);
  g_autoptr (ClothGapNormal) normal = NULL;
  ClothGapReduced reduced;

  for (guint k = 0; k < noise->n; k++)
    noise->values[k] = scale * scale;
  for (guint b = 0; b < study->features->n_blocks; b++)
    blocks[b] = TRUE;
  for (guint k = 0; k < n; k++)
    precisions[k] = d->precisions[k] * d->study.overdispersion;
  normal = cloth_gap_normal_new (study->features, noise, 1., z,
      study->columns[0], n);
  if (!cloth_gap_normal_reduce (normal, blocks, d->all, precisions, n, NULL, 0,
          &reduced))
    return;
  rest->rest += reduced.r;
  rest->n += normal->per_block * normal->n_blocks;
  for (gsize k = 0; k < study->features->size; k++)
    rest->signature += scale * scale / (1. + scale * scale) *
        study->signature->z[0][k] * study->signature->z[0][k];
}

/**
 * cloth_diagnosis_is_unknown:
 * @d: a diagnosis whose takes are linearised at the model
 *
 * Where baselines move alike, the residual without their signature would be noise if the
 * model lacked nothing. With an effect it is not, even the right one: another motion has
 * other wrinkles.
 *
 * Returns: whether much more than noise is in the takes that is not in the baselines
 */
gboolean
cloth_diagnosis_is_unknown (const ClothDiagnosis * d)
{
  Rest rest = { 0. };

  if (!cloth_diagnosis_has_signatures (d))
    return FALSE;
  for (guint i = 0; i < d->n_takes; i++)
    add_rest (d, cloth_diagnosis_study (d, i), &rest);
  return rest.rest > UNKNOWN * UNKNOWN * rest.n
      && rest.rest > UNKNOWN_SHARE * UNKNOWN_SHARE * rest.signature;
}
