/* Vertices of a printed cloth carried from picture to picture by optical flow.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"
#include "gst/vision/match/match.h"

G_BEGIN_DECLS

/* @window: side of the window that is followed, px (11)
 * @levels: halvings of the picture (3)
 * @back: a point that does not come back to where it began, so near, is lost, px (0.4)
 * @crowding: one that comes nearer to a neighbour of the grid than this share of how far
 *   apart neighbours usually are there is at a fold's crest, where points pile up, and is
 *   lost (0.3)
 * @drift: standard deviation that each picture adds to a place, px (0.15)
 * @uncertain: a place of a greater standard deviation is lost, px (2)
 */
typedef struct {
  gint window, levels;
  gdouble back, crowding, drift, uncertain;
} ClothFollowParams;

typedef struct _ClothFollower ClothFollower;

ClothFollowParams cloth_follow_default_params (void);
ClothFollower *cloth_follower_new (guint columns, guint rows);
void cloth_follower_free (ClothFollower * follower);
void cloth_follower_reset (ClothFollower * follower);
gboolean cloth_follower_run (ClothFollower * follower,
    const ClothFollowParams * params, const ClothImage * image,
    ClothGridVertex * vertices, guint * n_followed, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothFollower, cloth_follower_free)
G_END_DECLS
