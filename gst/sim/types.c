/* The simulator's errors.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/types.h"

GQuark
cloth_sim_error_quark (void)
{
  return g_quark_from_static_string ("cloth-sim-error-quark");
}
