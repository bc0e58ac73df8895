/* Where on the board a patch lies.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"
#include "gst/vision/checker/patch.h"

G_BEGIN_DECLS

/* Hypotheses that trail by more, log-likelihood, are not told apart.
 */
#define CLOTH_POSE_MOST_LEAD 64.0f

/* Lead, log-likelihood, from which on a pose in a film is believed: just less than the
 * 3 of one cell that clearly shows cloth where the board would go on.
 */
#define CLOTH_POSE_MIN_LEAD 2.9f

/* @rotation: quarter turns from the patch's grid to the board's, 0 to 3
 * @column: board vertex of the patch's vertex (0, 0)
 * @row: likewise
 * @weight: as a vote: log-likelihood in favour; as a result: log-likelihood of this
 *   pose less that of the next best, at most %CLOTH_POSE_MOST_LEAD; that of one
 *   square when there is no other
 * @evidence: as a result: the same lead by what was seen alone, over those that are no
 *   twins, less what was seen that speaks against the pose
 * @whole: as a result: whether most of the board is in sight; then corners on its rim that
 *   linking did not join don't speak against the pose
 *
 * A way to lay a patch on the board: vertex (i, j) of the patch, turned @rotation times
 * by (i, j) → (-j, i), plus (@column, @row).
 */
typedef struct {
  gint rotation;
  gint column, row;
  gfloat weight;
  gfloat evidence;
  gboolean whole;
} ClothPose;

/* @square_outside: of a square seen where the board has none
 * @corner_outside: of an inner corner seen where the board has none
 * @found_corners: whether that holds for corners too that linking did not join
 * @cut_rim: of a corner that is no saddle where the board has an inner corner, if it lies
 *   on a rim as straight as the grid
 * @cut_corner: the same of one that stands alone: something may cover the other squares
 *   there
 * @upright: of a plain board being upright rather than on its side; adds to the lead
 * @twins: whether poses that a turn of the whole board carries into each other are
 *   no hypotheses: the more upright one is taken, and being upright adds to no lead
 * @least: a pose is refused when what was seen makes it less likely
 * @rim_refuses: and when a straight rim runs along more than this share of a line within
 *   the board: the board seen is another, smaller one; 1 for never
 *
 * What the evidence for and against a pose weighs, log-likelihoods.
 */
typedef struct {
  gfloat square_outside;
  gfloat corner_outside;
  gboolean found_corners;
  gfloat cut_rim, cut_corner;
  gfloat upright;
  gboolean twins;
  gfloat least;
  gfloat rim_refuses;
} ClothPoseWeights;

extern const ClothPoseWeights cloth_pose_cloth, cloth_pose_rigid;

typedef struct _ClothPoseFinder ClothPoseFinder;

void cloth_pose_vertex (const ClothPose * pose, gint i, gint j,
    gint * column, gint * row);
void cloth_pose_cell (const ClothPose * pose, gint i, gint j,
    gint * column, gint * row);

ClothPoseFinder *cloth_pose_finder_new (const ClothPattern * pattern);
void cloth_pose_finder_free (ClothPoseFinder * finder);
gboolean cloth_pose_finder_run (ClothPoseFinder * finder, const ClothPatch * patch,
    const ClothPoseWeights * weights, const ClothPose * votes,
    guint n_votes, ClothPose * best);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPoseFinder, cloth_pose_finder_free)
G_END_DECLS
