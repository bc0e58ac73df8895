// Cameras and boards in 3D.
// SPDX-License-Identifier: LGPL-2.1-or-later
import {
  BufferGeometry, Color, DoubleSide, Float32BufferAttribute, GridHelper, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, PerspectiveCamera, Scene, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { turn } from './turn.js';
import { css } from './colours.js';
import { colour, element } from './dom.js';

const place = (R, t, x) => new Vector3(...[0, 1, 2].map((i) => R[3 * i] * x[0] + R[3 * i + 1] * x[1] + R[3 * i + 2] * x[2] + t[i]));
// A camera's R and t lead into it.
const back = (camera, x) => {
  const [R, t] = [camera.R, camera.t];
  const d = x.map((value, i) => value - t[i]);
  return new Vector3(...[0, 1, 2].map((j) => R[j] * d[0] + R[3 + j] * d[1] + R[6 + j] * d[2]));
};

function lines(pairs, material) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(pairs.flat().flatMap((p) => p.toArray()), 3));
  return new LineSegments(geometry, material);
}

export class RigView {
  // `shadeOf(pose)`: 0 to 1, how badly a board's views fit.
  constructor(canvas, names, data, shadeOf) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setClearColor(new Color(0), 0);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(36, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.ink = new LineBasicMaterial();
    const all = [];
    data.poses.forEach((pose, p) => {
      if (pose[0] === null) return;
      const [u, v] = [data.columns * data.square_m, data.rows * data.square_m];
      const ring = [[0, 0], [u, 0], [u, v], [0, v]].map(([x, y]) => place(pose.slice(0, 9), pose.slice(9), [x, y, 0]));
      const material = new LineBasicMaterial({ color: new Color(css(shadeOf(p))) });
      const sheet = new BufferGeometry().setFromPoints([0, 1, 2, 0, 2, 3].map((i) => ring[i]));
      this.scene.add(lines(ring.map((corner, i) => [corner, ring[(i + 1) % 4]]), material),
        new Mesh(sheet, new MeshBasicMaterial({ color: material.color, side: DoubleSide, transparent: true, opacity: 0.12, depthWrite: false })));
      all.push(...ring);
    });
    const centres = data.cameras.map((camera) => back(camera, [0, 0, 0]));
    const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
    for (const point of [...all, ...centres]) {
      low.min(point);
      high.max(point);
    }
    this.size = Math.max(low.distanceTo(high), 1e-3);
    this.centre = low.clone().add(high).multiplyScalar(0.5);
    const axis = new Vector3();
    data.cameras.forEach((camera, c) => {
      const [fx, fy, cx, cy] = camera.parameters.map((parameter) => parameter.value);
      const depth = 0.12 * this.size;
      const ring = [[0, 0], [camera.width, 0], [camera.width, camera.height], [0, camera.height]].map(
        ([x, y]) => back(camera, [(x - cx) / fx * depth, (y - cy) / fy * depth, depth]));
      const top = back(camera, [(camera.width / 2 - cx) / fx * depth, -1.25 * cy / fy * depth, depth]);
      this.scene.add(lines([...ring.map((corner, i) => [corner, ring[(i + 1) % 4]]),
        ...ring.map((corner) => [centres[c], corner]), [ring[0], top], [top, ring[1]]], this.ink));
      axis.add(back(camera, [0, 0, 1]).sub(centres[c]));
    });
    this.labels = data.cameras.map((camera, c) => {
      const node = element('span', {}, camera.name);
      names.append(node);
      return { node, point: back(camera, [0, -0.05 * this.size, 0]) };
    });
    this.ground = new GridHelper(1, 8);
    this.ground.scale.setScalar(1.5 * this.size);
    this.ground.rotation.x = Math.PI / 2;
    this.ground.position.set(this.centre.x, this.centre.y, low.z - 0.02 * this.size);
    this.ground.material.vertexColors = false;
    this.ground.material.transparent = true;
    this.ground.material.opacity = 0.35;
    this.scene.add(this.ground);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.redraw());
    canvas.addEventListener('keydown', (event) => turn(event, this));
    // From behind the cameras, at the side and above.
    axis.z = 0;
    if (!(axis.length() > 1e-6)) axis.set(0, 1, 0);
    this.home = axis.normalize().negate().applyAxisAngle(new Vector3(0, 0, 1), 0.6)
      .multiplyScalar(1.1 * this.size).add(new Vector3(0, 0, 0.4 * this.size)).add(this.centre);
    this.camera.near = this.size / 100;
    this.camera.far = this.size * 50;
    this.reset();
  }

  reset() {
    this.camera.position.copy(this.home);
    this.controls.target.copy(this.centre);
    this.controls.update();
    this.redraw();
  }

  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.#draw();
    });
  }

  #draw() {
    const { canvas, renderer, camera } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    renderer.setSize(width, height, false);
    this.ink.color.set(colour('ink'));
    this.ground.material.color.set(colour('soft'));
    camera.aspect = width / height;
    camera.zoom = Math.min(1, camera.aspect);
    camera.updateProjectionMatrix();
    renderer.render(this.scene, camera);
    for (const { node, point } of this.labels) {
      const at = point.clone().project(camera);
      node.style.left = (at.x + 1) / 2 * width + 'px';
      node.style.top = (1 - at.y) / 2 * height + 'px';
    }
  }
}
