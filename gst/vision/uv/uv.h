/* The flat cloth's places on the pixels of a picture, and the cloth's vertices in space.
 *
 * D. Pritchard and W. Heidrich, “Cloth Motion Capture” (2003), section 5.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/uv/dense.h"
#include "gst/vision/uv/join.h"
#include "gst/vision/uv/vertex.h"
