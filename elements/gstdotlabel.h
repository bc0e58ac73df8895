/* dotlabel: coloured dots, found, classified and labelled.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfilter.h"

G_BEGIN_DECLS

#define GST_TYPE_DOT_LABEL (gst_dot_label_get_type ())
G_DECLARE_FINAL_TYPE (GstDotLabel, gst_dot_label, GST, DOT_LABEL,
    GstClothFilter)

GST_ELEMENT_REGISTER_DECLARE (dotlabel);

G_END_DECLS
