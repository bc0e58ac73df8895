/* Matches that contradict their neighbours are refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/match/grow.h"

G_BEGIN_DECLS

/* @vote: least mean vote of a feature that is kept, 0 to 1
 * @group_vote: of a group: its edges to others lie along folds, where distances are the
 *   least sure
 * @support: a feature with fewer votes is refused in the end
 * @reach: longest edge that votes, px
 * @stretch: the bounds of distances
 */
typedef struct {
  gdouble vote, group_vote;
  guint support;
  gdouble reach;
  ClothStretchParams stretch;
} ClothVerifyParams;

/* @n_verified: matches that are left
 * @n_refused_within: that their own group refused
 * @n_refused_groups: of groups that other groups refused
 * @n_refused_among: that all refused
 */
typedef struct {
  guint n_verified;
  guint n_refused_within, n_refused_groups, n_refused_among;
} ClothVerification;

typedef struct _ClothVerifier ClothVerifier;

ClothVerifyParams cloth_verify_default_params (void);
ClothVerifier *cloth_verifier_new (void);
void cloth_verifier_free (ClothVerifier * verifier);
void cloth_verifier_run (ClothVerifier * verifier,
    const ClothVerifyParams * params, const ClothReference * reference,
    const ClothCvFeatures * features, const ClothMatchSurface * surface,
    ClothMatch * matches, ClothVerification * verification, ClothPool * pool);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothVerifier, cloth_verifier_free)
G_END_DECLS
