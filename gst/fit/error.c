/* What keeps an estimate from being made.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/error.h"

/* *INDENT-OFF* */
G_DEFINE_QUARK (cloth-fit-error-quark, cloth_fit_error)
/* *INDENT-ON* */
