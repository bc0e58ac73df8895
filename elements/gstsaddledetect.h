/* saddledetect: finds the corners of checkerboards in a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfilter.h"

G_BEGIN_DECLS

#define GST_TYPE_SADDLE_DETECT (gst_saddle_detect_get_type ())
G_DECLARE_FINAL_TYPE (GstSaddleDetect, gst_saddle_detect, GST, SADDLE_DETECT,
    GstClothFilter)

GST_ELEMENT_REGISTER_DECLARE (saddledetect);

G_END_DECLS
