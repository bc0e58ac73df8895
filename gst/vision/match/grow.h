/* Features of a film matched to those of the flat picture, from seeds that grow.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/math/simd.h"
#include "gst/vision/match/reference.h"
#include "gst/vision/match/stretch.h"

G_BEGIN_DECLS

/* The reference feature of what has none. */
#define CLOTH_MATCH_NONE G_MAXUINT32

/* @CLOTH_MATCH_UNKNOWN: nothing was found for it
 * @CLOTH_MATCH_UNSEEDED: a seed that didn't grow
 * @CLOTH_MATCH_MATCHED: found
 * @CLOTH_MATCH_REFUSED: found, but verification refused it
 */
typedef enum {
  CLOTH_MATCH_UNKNOWN,
  CLOTH_MATCH_UNSEEDED,
  CLOTH_MATCH_MATCHED,
  CLOTH_MATCH_REFUSED
} ClothMatchState;

/* @state: how far it has come
 * @reference: index among the reference features, %CLOTH_MATCH_NONE while there is none
 * @distance: squared distance in feature space
 * @group: number of the seed that it grew from
 */
typedef struct {
  ClothMatchState state;
  guint32 reference, distance, group;
} ClothMatch;

/* @radius: r_c, how far growth reaches at a time, px, 1 to 1000
 * @distance: greatest distance in feature space of a match that grows
 * @seed_distance: of a seed
 * @first: seeds of the first group; each group is twice as large as the one before
 * @least_scale: features of smaller scale are no seeds, px
 * @least: a seed from which fewer grow is no match
 * @tries: neighbours from which a feature is looked for, those nearest to the seed first:
 *   whom so many don't find the rest won't
 * @turn: by how much neighbours may be turned against each other in the picture, radians;
 *   π and more: not looked at
 * @zoom: by which factor their scales may differ, from 1 on; 0: not looked at
 * @stretch: the bounds of distances
 */
typedef struct {
  gdouble radius;
  gdouble distance, seed_distance;
  guint first;
  gdouble least_scale;
  guint least, tries;
  gdouble turn, zoom;
  ClothStretchParams stretch;
} ClothGrowParams;

/* @n_matched: features that are matched
 * @n_groups: seeds that grew
 * @n_seeds: seeds that were tried
 * @seeds_half: after how many of them half of all features were matched or rejected; 0:
 *   never
 * @seeds_most: four fifths
 * @by_scale: whether there was no surface, so that distances are bounded by the picture only
 */
typedef struct {
  guint n_matched, n_groups, n_seeds;
  guint seeds_half, seeds_most;
  gboolean by_scale;
} ClothGrowth;

typedef struct _ClothGrower ClothGrower;

ClothGrowParams cloth_grow_default_params (void);
ClothGrower *cloth_grower_new (void);
void cloth_grower_free (ClothGrower * grower);
void cloth_grower_run (ClothGrower * grower, const ClothGrowParams * params,
    const ClothReference * reference, const ClothCvFeatures * features,
    const ClothMatchSurface * surface, ClothMatch * matches,
    ClothGrowth * growth, ClothPool * pool, ClothSimd level);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGrower, cloth_grower_free)
G_END_DECLS
