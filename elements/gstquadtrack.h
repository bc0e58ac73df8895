/* quadtrack: the squares of a checkerboard, tracked through a film.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfilter.h"

G_BEGIN_DECLS

#define GST_TYPE_QUAD_TRACK (gst_quad_track_get_type ())
G_DECLARE_FINAL_TYPE (GstQuadTrack, gst_quad_track, GST, QUAD_TRACK,
    GstClothFilter)

GST_ELEMENT_REGISTER_DECLARE (quadtrack);

G_END_DECLS
