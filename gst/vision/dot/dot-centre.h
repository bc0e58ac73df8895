/* The centres of dots: the ground around each, then the mean of what is brighter.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/dot/dot.h"

G_BEGIN_DECLS

void cloth_dot_measure (ClothDotDetector * detector);

G_END_DECLS
