/* Errors of what OpenCV does.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cv/error.h"

GQuark
cloth_cv_error_quark (void)
{
  return g_quark_from_static_string ("cloth-cv-error-quark");
}
