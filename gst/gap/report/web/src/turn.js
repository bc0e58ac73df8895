// Turning and zooming a view in 3D without a mouse.
// SPDX-License-Identifier: LGPL-2.1-or-later

// `view` has a camera, its controls, reset() and redraw().
export function turn(event, view) {
  const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.12], ArrowDown: [0, 0.12] };
  const zooms = { '+': 0.85, '=': 0.85, '-': 1 / 0.85 };
  const arm = view.camera.position.clone().sub(view.controls.target);
  if (event.key in turns) {
    const [around, tilt] = turns[event.key];
    const polar = Math.min(3.1, Math.max(0.05, Math.acos(arm.z / arm.length()) + tilt));
    const azimuth = Math.atan2(arm.y, arm.x) + around;
    const r = arm.length();
    arm.set(r * Math.sin(polar) * Math.cos(azimuth), r * Math.sin(polar) * Math.sin(azimuth), r * Math.cos(polar));
  } else if (event.key in zooms) {
    arm.multiplyScalar(zooms[event.key]);
  } else if (event.key === 'Home') {
    view.reset();
    event.preventDefault();
    return;
  } else {
    return;
  }
  event.preventDefault();
  view.camera.position.copy(view.controls.target).add(arm);
  view.controls.update();
  view.redraw();
}
