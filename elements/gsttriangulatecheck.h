/* Whether the cameras of triangulate fit together: what a user should be told.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

#include "elements/gsttriangulateboard.h"
#include "gst/rig/rig.h"
#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

/* All 0 at the start. */
typedef struct {
  guint n_sets;
  gboolean warned;
  gboolean seen[CLOTH_RIG_MAX_CAMERAS];
  guint64 n_compared[CLOTH_RIG_MAX_CAMERAS];
  guint64 n_left_out[CLOTH_RIG_MAX_CAMERAS];
} GstTriangulateCheck;

/* Counts one set; every 25 sets posts, once, a warning if fewer than two cameras have
 * carried squares or dots yet, or if a camera contradicts the others on more than half of
 * what it sees; the message's details name it as "camera". */
void gst_triangulate_check_add (GstTriangulateCheck * check,
    GstElement * element, const GstTriangulateBoard * board,
    const ClothRig * rig,
    const ClothTriangulateView * views, const ClothTriangulation * result);

G_END_DECLS
