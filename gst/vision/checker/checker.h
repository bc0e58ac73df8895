/* Checkerboards in one picture: patches of squares, their outlines, and where on the board
 * they lie.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/checker/board.h"
#include "gst/vision/checker/link.h"
#include "gst/vision/checker/marked.h"
#include "gst/vision/checker/outline.h"
#include "gst/vision/checker/pose.h"
#include "gst/vision/checker/template.h"
