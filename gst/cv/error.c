/* Errors of what OpenCV does.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cv/error.h"

G_DEFINE_QUARK (cloth - cv - error - quark, cloth_cv_error)
