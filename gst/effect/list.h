/* The one list of effects, in the order of documents and results. A line makes an effect
 * known to all: the declarations and the table of effects, the hooks of the simulator's
 * lanes and the parts of a capture follow from it in the compiler, and meson.build reads
 * it for the files to compile.
 *
 * The name is the effect's id. Its file is named like it, with - for _:
 *   LANES: gst/sim/effects/, acts in the lanes of the simulator;
 *   SCENE: gst/sim/effects/, changes the scene or the step before they are loaded, in
 *     gst/sim/numerics.c;
 *   CAPTURE: gst/rig/effects/, changes how a camera takes its pictures;
 *   RECORDING: gst/take/effects/, changes what is recorded of the positions.
 *
 * An includer defines the macros that it needs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifndef LANES
#define LANES(name)
#endif
#ifndef SCENE
#define SCENE(name)
#endif
#ifndef CAPTURE
#define CAPTURE(name)
#endif
#ifndef RECORDING
#define RECORDING(name)
#endif

LANES (air_drag)
LANES (air_drag_linear)
LANES (air_drag_tangential)
LANES (wind)
LANES (gust)
LANES (added_mass)
LANES (bending)
LANES (bending_anisotropy)
LANES (bending_softening)
LANES (stretch)
LANES (stretch_anisotropy)
LANES (shear)
LANES (grain_angle)
LANES (biphasic_stretch)
LANES (hysteresis)
LANES (damping_mass)
LANES (damping_stiffness)
LANES (plasticity)
LANES (rest_curvature)
LANES (areal_mass)
LANES (mass_distribution)
LANES (gravity_tilt)
LANES (gravity_scale)
LANES (shrinkage)
LANES (self_contact)
LANES (friction)
LANES (clamp_slip)
LANES (clamp_compliance)
LANES (clamp_delay)
SCENE (time_step)
SCENE (mesh_resolution)
SCENE (mesh_diagonals)
CAPTURE (lens_distortion)
CAPTURE (focal_length)
CAPTURE (extrinsic_drift)
CAPTURE (sync_offset)
CAPTURE (rolling_shutter)
CAPTURE (frame_drop)
CAPTURE (motion_blur)
CAPTURE (defocus)
CAPTURE (shading_shift)
CAPTURE (colour_crosstalk)
CAPTURE (noise)
RECORDING (position_scale)
RECORDING (misalignment)
RECORDING (axes_exchange)
RECORDING (label_exchange)
RECORDING (time_scale)
RECORDING (recording_delay)
RECORDING (smoothing)

#undef LANES
#undef SCENE
#undef CAPTURE
#undef RECORDING
