/* clothsim: a simulated cloth as a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsource.h"

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_SIM (gst_cloth_sim_get_type ())
G_DECLARE_FINAL_TYPE (GstClothSim, gst_cloth_sim, GST, CLOTH_SIM, GstClothSource)

GST_ELEMENT_REGISTER_DECLARE (clothsim);

G_END_DECLS
