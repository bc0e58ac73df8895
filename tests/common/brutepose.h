/* Placing a patch by its definition: every pose, square by square.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/checker/checker.h"

G_BEGIN_DECLS

/* A patch that owns its arrays; all of it 0: no vertex known, nothing seen. */
static inline ClothPatch *
test_patch_new (gint columns, gint rows)
{
  const gsize n = (gsize) columns * (gsize) rows;
  ClothPatch *patch = g_new0 (ClothPatch, 1);

  patch->columns = columns;
  patch->rows = rows;
  patch->memory = g_malloc0 (n * (8 * sizeof (gfloat) + 3));
  patch->x = patch->memory;
  patch->y = patch->x + n;
  patch->cov = patch->x + 2 * n;
  patch->confidence = patch->x + 5 * n;
  patch->inside = patch->x + 6 * n;
  patch->bit = patch->x + 7 * n;
  patch->kind = (guint8 *) (patch->x + 8 * n);
  patch->square = patch->kind + n;
  patch->linked = patch->square + n;
  return patch;
}

static inline void
test_patch_free (ClothPatch * patch)
{
  cloth_patch_clear (patch);
  g_free (patch);
}

/* What was seen, under a pose; corners that are no saddles stand alone. */
static inline gdouble
test_brute_score (const ClothPattern * pattern, const ClothPatch * patch,
    const ClothPoseWeights * weights, const ClothPose * pose)
{
  gdouble score = 0;

  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < patch->columns; i++) {
      const gint at = j * patch->columns + i;
      gint c, r;

      cloth_pose_vertex (pose, i, j, &c, &r);
      if (patch->linked[at] || (weights->found_corners
              && patch->kind[at] == CLOTH_VERTEX_SADDLE))
        score += c < 1 || r < 1 || c >= pattern->columns || r >= pattern->rows
            ? weights->corner_outside : 0;
      else if (patch->kind[at] >= CLOTH_VERTEX_UNSURE)
        score += c < 1 || r < 1 || c >= pattern->columns || r >= pattern->rows
            ? 0 : weights->cut_corner;
      cloth_pose_cell (pose, i, j, &c, &r);
      if (c < 0 || r < 0 || c >= pattern->columns || r >= pattern->rows)
        score += patch->square[at] ? weights->square_outside : 0;
      else if (!patch->square[at])
        score += patch->inside[at];
      else if (pattern->code)
        score += cloth_pattern_has_dot (pattern, c, r) ? patch->bit[at]
            : -patch->bit[at];
    }
  return score;
}

/* The best of all poses by which no square sticks out by more than one, and black
 * squares lie on black ones; @best gets its lead as weight. */
static inline gboolean
test_brute_place (const ClothPattern * pattern, const ClothPatch * patch,
    const ClothPoseWeights * weights, const ClothPose * votes,
    guint n_votes, ClothPose * best)
{
  const gint reach = patch->columns + patch->rows + 2;
  gdouble first = -G_MAXDOUBLE, second = -G_MAXDOUBLE;
  gint box[4] = { G_MAXINT, G_MAXINT, -1, -1 };

  for (gint at = 0; at < patch->columns * patch->rows; at++)
    if (patch->square[at]) {
      box[0] = MIN (box[0], at % patch->columns);
      box[1] = MIN (box[1], at / patch->columns);
      box[2] = MAX (box[2], at % patch->columns);
      box[3] = MAX (box[3], at / patch->columns);
    }
  for (gint rotation = 0; rotation < 4; rotation++)
    for (gint row = -reach; row <= pattern->rows + reach; row++)
      for (gint column = -reach; column <= pattern->columns + reach; column++) {
        ClothPose try = { rotation, column, row, 0 };
        gboolean fits = box[2] >= 0;
        gdouble score;

        for (gint k = 0; k < 4 && fits; k += 2) {
          gint c, r;

          cloth_pose_cell (&try, box[k & 2], box[(k & 2) + 1], &c, &r);
          fits = c >= -1 && r >= -1 && c <= pattern->columns
              && r <= pattern->rows && cloth_pattern_is_black (pattern, c & 1,
              r & 1) == cloth_patch_is_black (patch, box[k & 2],
              box[(k & 2) + 1]);
        }
        if (!fits)
          continue;
        score = test_brute_score (pattern, patch, weights, &try);
        for (guint k = 0; k < n_votes; k++)
          if (votes[k].rotation == rotation && votes[k].column == column
              && votes[k].row == row)
            score += votes[k].weight;
        if (score > first) {
          second = first;
          first = score;
          *best = try;
        } else {
          second = MAX (second, score);
        }
      }
  /* The only one leads by a square. */
  best->weight = second == -G_MAXDOUBLE ? -weights->square_outside
      : (gfloat) MIN (first - second, CLOTH_POSE_MOST_LEAD);
  return first > -G_MAXDOUBLE;
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPatch, test_patch_free)
G_END_DECLS
