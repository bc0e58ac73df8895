/* What keeps an estimate from being made.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/error.h"

GQuark
cloth_fit_error_quark (void)
{
  return g_quark_from_static_string ("cloth-fit-error-quark");
}
