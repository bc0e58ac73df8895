/* The lanes' half of each effect.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/random.h"
#include "gst/sim/lanes/fold.h"
#include "gst/sim/lanes/strain.h"

extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_areal_mass);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_mass_distribution);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_stretch);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_stretch_anisotropy);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_shear);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_bending);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_bending_anisotropy);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_damping_mass);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_damping_stiffness);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_gravity_scale);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_gravity_tilt);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_shrinkage);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_grain_angle);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_air_drag);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_air_drag_linear);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_air_drag_tangential);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_wind);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_gust);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_biphasic_stretch);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_hysteresis);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_clamp_slip);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_clamp_compliance);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_clamp_delay);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_bending_softening);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_rest_curvature);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_plasticity);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_added_mass);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_friction);
extern const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_self_contact);

void CLOTH_LANE_NAME (cloth_lane_wind) (ClothLaneState * state,
    const ClothLane wind[3], ClothLane coefficient, ClothLane turbulence);

/* exp, for setting up: exactly 1 at 0. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_exp (ClothLane a)
{
  for (guint l = 0; l < CLOTH_N_LANES; l++)
    CLOTH_LANE_AT (&a, l) = (ClothReal) exp (CLOTH_LANE_AT (&a, l));
  return a;
}
