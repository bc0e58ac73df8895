/* All effects, whatever their side.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#include <string.h>

#include "gst/rig/effects/effects.h"
#include "gst/sim/effects/effects.h"

/* Documents and results list them in this order. */
static const ClothEffect *const table[] = {
  &cloth_effect_air_drag,
  &cloth_effect_air_drag_linear,
  &cloth_effect_air_drag_tangential,
  &cloth_effect_wind,
  &cloth_effect_gust,
  &cloth_effect_added_mass,
  &cloth_effect_bending,
  &cloth_effect_bending_anisotropy,
  &cloth_effect_bending_softening,
  &cloth_effect_stretch,
  &cloth_effect_stretch_anisotropy,
  &cloth_effect_shear,
  &cloth_effect_grain_angle,
  &cloth_effect_biphasic_stretch,
  &cloth_effect_hysteresis,
  &cloth_effect_damping_mass,
  &cloth_effect_damping_stiffness,
  &cloth_effect_plasticity,
  &cloth_effect_rest_curvature,
  &cloth_effect_areal_mass,
  &cloth_effect_mass_distribution,
  &cloth_effect_gravity_tilt,
  &cloth_effect_gravity_scale,
  &cloth_effect_shrinkage,
  &cloth_effect_self_contact,
  &cloth_effect_friction,
  &cloth_effect_clamp_slip,
  &cloth_effect_clamp_compliance,
  &cloth_effect_clamp_delay,
  &cloth_effect_time_step,
  &cloth_effect_mesh_resolution,
  &cloth_effect_mesh_diagonals,
  &cloth_capture_lens_distortion.effect,
  &cloth_capture_focal_length.effect,
  &cloth_capture_extrinsic_drift.effect,
  &cloth_capture_sync_offset.effect,
  &cloth_capture_rolling_shutter.effect,
  &cloth_capture_frame_drop.effect,
  &cloth_capture_motion_blur.effect,
  &cloth_capture_defocus.effect,
  &cloth_capture_shading_shift.effect,
  &cloth_capture_colour_crosstalk.effect,
  &cloth_capture_noise.effect,
};

/* @n_effects: (out): how many there are
 *
 * Returns: (transfer none) (array length=n_effects): every effect once, by side:
 *   physics, clamp, numerics, camera, image
 */
const ClothEffect *const *
cloth_effect_table (guint * n_effects)
{
  *n_effects = G_N_ELEMENTS (table);
  return table;
}

/* @id: name of an effect
 *
 * Returns: (transfer none) (nullable): the effect of that name
 */
const ClothEffect *
cloth_effect_find (const gchar * id)
{
  for (guint i = 0; i < G_N_ELEMENTS (table); i++)
    if (strcmp (table[i]->id, id) == 0)
      return table[i];
  return NULL;
}

/* @side: a side
 *
 * Returns: (transfer none): its name
 */
const gchar *
cloth_effect_side_name (ClothEffectSide side)
{
  static const gchar *const names[] =
      { "physics", "clamp", "numerics", "camera", "image" };

  return names[side];
}
