/* The effects of physics, clamps and numerics: one file each, one description each.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/effect/effect.h"

G_BEGIN_DECLS

extern const ClothEffect cloth_effect_air_drag;
extern const ClothEffect cloth_effect_air_drag_linear;
extern const ClothEffect cloth_effect_air_drag_tangential;
extern const ClothEffect cloth_effect_wind;
extern const ClothEffect cloth_effect_gust;
extern const ClothEffect cloth_effect_added_mass;
extern const ClothEffect cloth_effect_bending;
extern const ClothEffect cloth_effect_bending_anisotropy;
extern const ClothEffect cloth_effect_bending_softening;
extern const ClothEffect cloth_effect_stretch;
extern const ClothEffect cloth_effect_stretch_anisotropy;
extern const ClothEffect cloth_effect_shear;
extern const ClothEffect cloth_effect_grain_angle;
extern const ClothEffect cloth_effect_biphasic_stretch;
extern const ClothEffect cloth_effect_hysteresis;
extern const ClothEffect cloth_effect_damping_mass;
extern const ClothEffect cloth_effect_damping_stiffness;
extern const ClothEffect cloth_effect_plasticity;
extern const ClothEffect cloth_effect_rest_curvature;
extern const ClothEffect cloth_effect_areal_mass;
extern const ClothEffect cloth_effect_mass_distribution;
extern const ClothEffect cloth_effect_gravity_tilt;
extern const ClothEffect cloth_effect_gravity_scale;
extern const ClothEffect cloth_effect_shrinkage;
extern const ClothEffect cloth_effect_self_contact;
extern const ClothEffect cloth_effect_friction;
extern const ClothEffect cloth_effect_clamp_slip;
extern const ClothEffect cloth_effect_clamp_compliance;
extern const ClothEffect cloth_effect_clamp_delay;
extern const ClothEffect cloth_effect_time_step;
extern const ClothEffect cloth_effect_mesh_resolution;
extern const ClothEffect cloth_effect_mesh_diagonals;

G_END_DECLS
