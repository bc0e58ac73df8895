/* Errors of what OpenCV does.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @CLOTH_CV_ERROR_PICTURE: a picture that can't be, or is too small or too large
 * @CLOTH_CV_ERROR_PARAMETER: a parameter is out of its range
 * @CLOTH_CV_ERROR_FAILED: OpenCV threw an exception
 */
typedef enum {
  CLOTH_CV_ERROR_PICTURE,
  CLOTH_CV_ERROR_PARAMETER,
  CLOTH_CV_ERROR_FAILED
} ClothCvError;

#define CLOTH_CV_ERROR (cloth_cv_error_quark ())
GQuark cloth_cv_error_quark (void);

G_END_DECLS
