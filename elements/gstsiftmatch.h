/* siftmatch: which place of its print each feature of a cloth shows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfilter.h"

G_BEGIN_DECLS

#define GST_TYPE_SIFT_MATCH (gst_sift_match_get_type ())
G_DECLARE_FINAL_TYPE (GstSiftMatch, gst_sift_match, GST, SIFT_MATCH,
    GstClothFilter)

GST_ELEMENT_REGISTER_DECLARE (siftmatch);

G_END_DECLS
