/* The effects that have a part in the lanes, in the order in which they act.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/hooks.h"

const ClothLaneHooks *const
CLOTH_LANE_NAME (cloth_lane_hooks)[] = {
  &CLOTH_LANE_NAME (cloth_hooks_areal_mass),
  &CLOTH_LANE_NAME (cloth_hooks_mass_distribution),
  &CLOTH_LANE_NAME (cloth_hooks_stretch),
  &CLOTH_LANE_NAME (cloth_hooks_stretch_anisotropy),
  &CLOTH_LANE_NAME (cloth_hooks_shear),
  &CLOTH_LANE_NAME (cloth_hooks_bending),
  &CLOTH_LANE_NAME (cloth_hooks_bending_anisotropy),
  &CLOTH_LANE_NAME (cloth_hooks_damping_mass),
  &CLOTH_LANE_NAME (cloth_hooks_damping_stiffness),
  &CLOTH_LANE_NAME (cloth_hooks_gravity_scale),
  &CLOTH_LANE_NAME (cloth_hooks_gravity_tilt),
  &CLOTH_LANE_NAME (cloth_hooks_shrinkage),
  &CLOTH_LANE_NAME (cloth_hooks_grain_angle),
  &CLOTH_LANE_NAME (cloth_hooks_air_drag),
  &CLOTH_LANE_NAME (cloth_hooks_air_drag_linear),
  &CLOTH_LANE_NAME (cloth_hooks_air_drag_tangential),
  &CLOTH_LANE_NAME (cloth_hooks_wind),
  &CLOTH_LANE_NAME (cloth_hooks_gust),
  &CLOTH_LANE_NAME (cloth_hooks_biphasic_stretch),
  &CLOTH_LANE_NAME (cloth_hooks_hysteresis),
  &CLOTH_LANE_NAME (cloth_hooks_bending_softening),
  &CLOTH_LANE_NAME (cloth_hooks_rest_curvature),
  &CLOTH_LANE_NAME (cloth_hooks_plasticity),
  &CLOTH_LANE_NAME (cloth_hooks_clamp_slip),
  &CLOTH_LANE_NAME (cloth_hooks_clamp_compliance),
  &CLOTH_LANE_NAME (cloth_hooks_clamp_delay),
  &CLOTH_LANE_NAME (cloth_hooks_friction),
  &CLOTH_LANE_NAME (cloth_hooks_self_contact),
  &CLOTH_LANE_NAME (cloth_hooks_added_mass),
  NULL
};
