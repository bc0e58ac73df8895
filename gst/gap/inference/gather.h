/* From simulations to arrays: the residuals of takes, their derivatives, the ensemble, references.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"
#include "gst/gap/inference/ensemble.h"
#include "gst/gap/inference/stack.h"

G_BEGIN_DECLS

/* @references: of each take the study that its model must agree with, or %G_MAXUINT
 * @on_references: features of the members on each of these, [n_members][size], or NULL
 * @sound: (array): which members were sound on all of them
 * @ensemble: the members at the model without effects
 *
 * What stays while the takes are linearised anew.
 */
typedef struct {
  guint *references;
  gdouble **on_references;
  gboolean *sound;
  ClothEnsemble *ensemble;
} ClothGapGathered;

/* @made: (element-type gdouble): of each take features of the members on it, [n_members][size]
 * @sound: (array): which members were sound on all takes and references
 * @model: where the takes were linearised
 *
 * What the ensemble makes of the takes. Their residuals and derivatives are in the studies.
 */
typedef struct {
  GPtrArray *made;
  gboolean *sound;
  ClothModel *model;
} ClothGapMade;

gboolean cloth_gap_gather_references (ClothDiagnosis * d,
    ClothGapGathered * gathered, GError ** error);
gboolean cloth_gap_gather_takes (ClothDiagnosis * d,
    const ClothGapGathered * gathered, const ClothModel * model,
    const ClothGapMade * before, ClothGapMade * made, GError ** error);
ClothGapStack *cloth_gap_stack_new (const ClothDiagnosis * d,
    const ClothGapGathered * gathered, const ClothGapMade * made,
    ClothEnsembleKin kin, GError ** error);
void cloth_gap_made_clear (ClothGapMade * made);
void cloth_gap_gathered_clear (ClothGapGathered * gathered, guint n_takes);
void cloth_gap_stack_free (ClothGapStack * stack);

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (ClothGapMade, cloth_gap_made_clear)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapStack, cloth_gap_stack_free)
G_END_DECLS
