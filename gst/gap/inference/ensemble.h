/* Simulators that the recording might have come from if nothing acted that the model lacks.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/estimate.h"

G_BEGIN_DECLS

/* Draws of the free numbers for each way to compute. */
#define CLOTH_ENSEMBLE_DRAWS 4
/* With fewer members nothing is known of chance. */
#define CLOTH_ENSEMBLE_LEAST 8u

/* @n: how many members
 * @models: (array length=n): what each of them is
 * @families: (array length=n): 1 for those with another force model than the first one, else 0
 *
 * Other ways to compute the same cloth.
 */
typedef struct {
  guint n;
  ClothModel **models;
  guint *families;
} ClothEnsemble;

/* @CLOTH_KIN_SAME: the same cloth, computed in the same way
 * @CLOTH_KIN_OTHER_CLOTH: another cloth: other free numbers and laws
 * @CLOTH_KIN_OTHER_NUMERICS: computed on another mesh or with other steps
 * @CLOTH_KIN_OTHER_FORCES: computed with another force model
 * @CLOTH_N_KINS: how many combinations of these bits there are
 *
 * In what a reference differs from the recording although nothing acts.
 */
typedef enum {
  CLOTH_KIN_SAME = 0,
  CLOTH_KIN_OTHER_CLOTH = 1 << 0,
  CLOTH_KIN_OTHER_NUMERICS = 1 << 1,
  CLOTH_KIN_OTHER_FORCES = 1 << 2,
  CLOTH_N_KINS = 1 << 3
} ClothEnsembleKin;

ClothEnsemble *cloth_ensemble_new (const ClothModel * model,
    const ClothTopology * topology, const ClothCandidates * candidates,
    guint64 seed);
guint cloth_ensemble_find_kin (const ClothEnsemble * ensemble, guint member,
    ClothEnsembleKin kin);
void cloth_ensemble_free (ClothEnsemble * ensemble);
gboolean cloth_ensemble_run (const ClothEnsemble * ensemble,
    const ClothSensitivities * study, const ClothModel * model,
    gdouble noise, guint stream, ClothEstimateOptions * options, gdouble * z,
    gboolean * sound, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothEnsemble, cloth_ensemble_free)
G_END_DECLS
