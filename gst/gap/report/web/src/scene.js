// Cloths in 3D beside each other, one camera for all.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { turn } from './turn.js';
import {
  BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, DynamicDrawUsage, GridHelper,
  HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, PerspectiveCamera, Scene,
  SRGBColorSpace, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { colour } from './dom.js';

const linear = new Float32Array(256);
for (let i = 0; i < 256; i++) {
  linear[i] = i < 11 ? i / 255 / 12.92 : ((i / 255 + 0.055) / 1.055) ** 2.4;
}

// One moving sheet: faces in colours, or the lines of the recording.
class Cloth {
  constructor(playback, name, wire) {
    this.playback = playback;
    this.name = name;
    this.wire = wire;
    this.geometry = new BufferGeometry();
    this.place = new BufferAttribute(playback.room(3), 3).setUsage(DynamicDrawUsage);
    this.geometry.setAttribute('position', this.place);
    const most = wire ? playback.edges.length : playback.faces.length / 4 * 6;
    this.geometry.setIndex(new BufferAttribute(new Uint32Array(most), 1).setUsage(DynamicDrawUsage));
    if (wire) {
      this.object = new LineSegments(this.geometry, new LineBasicMaterial({ transparent: true, opacity: 0.55 }));
    } else {
      this.tint = new BufferAttribute(playback.room(3), 3).setUsage(DynamicDrawUsage);
      this.geometry.setAttribute('color', this.tint);
      this.object = new Mesh(this.geometry, new MeshLambertMaterial({ vertexColors: true, side: DoubleSide }));
    }
    this.object.frustumCulled = false;
  }

  // Takes the frame's positions; a face with an unseen corner is left out. `paint(vertex, rgb)`
  // says the colour of each vertex.
  update(frame, paint) {
    const { faces, edges } = this.playback;
    const place = this.playback.positions(this.name, frame, this.place.array);
    const index = this.geometry.index.array;
    const seen = (v) => !Number.isNaN(place[3 * v]);
    let n = 0;
    if (this.wire) {
      for (let e = 0; e < edges.length; e += 2) {
        if (seen(edges[e]) && seen(edges[e + 1])) {
          index[n++] = edges[e];
          index[n++] = edges[e + 1];
        }
      }
    } else {
      for (let f = 0; f < faces.length; f += 4) {
        const [a, b, c, d] = faces.subarray(f, f + 4);
        if (!(seen(a) && seen(b) && seen(c))) continue;
        index.set([a, b, c], n);
        n += 3;
        if (d !== 0xffffffff && seen(d)) {
          index.set([a, c, d], n);
          n += 3;
        }
      }
      this.#colour(paint);
    }
    // What is left out has neither a place nor a part in the normals.
    index.fill(0, n);
    for (let i = 0; i < place.length; i++) {
      if (Number.isNaN(place[i])) place[i] = 0;
    }
    this.geometry.index.needsUpdate = true;
    this.geometry.setDrawRange(0, n);
    this.place.needsUpdate = true;
    if (!this.wire) this.geometry.computeVertexNormals();
  }

  #colour(paint) {
    const rgb = [0, 0, 0];
    const tint = this.tint.array;
    for (let i = 0; i < this.playback.vertices; i++) {
      paint(i, rgb);
      for (let c = 0; c < 3; c++) tint[3 * i + c] = linear[rgb[c]];
    }
    this.tint.needsUpdate = true;
  }
}

// As in the style sheet.
const narrow = () => matchMedia('(max-width: 640px)').matches;

// How many panels stand beside and above each other.
export function arranged(n) {
  if (narrow()) return [1, n];
  return n <= 4 ? [n, 1] : [Math.ceil(n / 2), 2];
}

export class View {
  // `sheets`: the playback of each name; one of them may be shown as lines, too. The camera
  // sees all of what is `framed`. What lies far from the first is shown at its place: `moved`.
  constructor(canvas, sheets, framed, wire = null) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.outputColorSpace = SRGBColorSpace;
    this.renderer.setScissorTest(true);
    this.renderer.setClearColor(new Color(0), 0);
    this.cloths = Object.fromEntries(Object.entries(sheets).map(
      ([name, playback]) => [name, new Cloth(playback, name, false)]));
    this.wire = wire && new Cloth(sheets[wire], wire, true);
    this.scene = new Scene();
    // Overhead and head light together keep folds visible from all sides.
    this.head = new DirectionalLight(0xffffff, 2.6);
    this.scene.add(new HemisphereLight(0xffffff, 0x9aa0ac, 1.6), this.head, this.head.target,
      ...[this.wire, ...Object.values(this.cloths)].filter(Boolean).map((cloth) => cloth.object));
    this.camera = new PerspectiveCamera(32, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.redraw());
    this.#frameCloths(framed);
    canvas.addEventListener('keydown', (event) => turn(event, this));
    this.panels = [];
    this.pending = false;
  }

  // The box that a cloth moves in; adds to `normal` where its flat side looks.
  #measure(name, normal) {
    const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
    const { playback } = this.cloths[name];
    const place = playback.room(3);
    const point = new Vector3(), side = new Vector3();
    for (let frame = 0; frame < playback.frames; frame += Math.max(1, playback.frames >> 4)) {
      playback.positions(name, frame, place);
      for (let i = 0; i < playback.vertices; i++) {
        point.fromArray(place, 3 * i);
        if (Number.isFinite(point.x)) {
          low.min(point);
          high.max(point);
        }
      }
      for (let f = 0; f < playback.faces.length; f += 4) {
        const [a, b, c] = playback.faces.subarray(f, f + 3);
        point.fromArray(place, 3 * b).sub(side.fromArray(place, 3 * a));
        side.fromArray(place, 3 * c).sub(new Vector3().fromArray(place, 3 * a));
        point.cross(side);
        if (Number.isFinite(point.x)) normal.add(point.dot(normal) < 0 ? point.negate() : point);
      }
    }
    return high.x >= low.x ? { low, high } : { low: new Vector3(-0.5, -0.5, -0.5), high: new Vector3(0.5, 0.5, 0.5) };
  }

  // The camera looks at the flat side of the cloths, a little from above.
  #frameCloths(framed) {
    const normal = new Vector3(), reach = new Vector3();
    const boxes = framed.map((name) => ({ name, ...this.#measure(name, normal) }));
    const low = boxes[0].low.clone(), high = boxes[0].high.clone();
    const first = low.clone().add(high).multiplyScalar(0.5);
    this.moved = new Set();
    for (const box of boxes.slice(1)) {
      const away = box.low.clone().add(box.high).multiplyScalar(0.5).sub(first);
      reach.copy(box.high).sub(box.low).add(boxes[0].high).sub(boxes[0].low);
      if (away.length() > reach.length()) {
        this.cloths[box.name].object.position.copy(away.negate());
        this.moved.add(box.name);
      }
      const { position } = this.cloths[box.name].object;
      low.min(box.low.add(position));
      high.max(box.high.add(position));
    }
    this.size = Math.max(high.distanceTo(low), 1e-3);
    this.centre = low.clone().add(high).multiplyScalar(0.5);
    normal.z = 0;
    if (!(normal.length() > 0)) normal.set(0, -1, 0);
    normal.normalize();
    if (normal.y > 0) normal.negate();
    normal.applyAxisAngle(new Vector3(0, 0, 1), 0.5);
    this.home = normal.multiplyScalar(1.62 * this.size).add(new Vector3(0, 0, 0.36 * this.size)).add(this.centre);
    this.camera.near = this.size / 100;
    this.camera.far = this.size * 50;
    this.controls.minDistance = this.size / 10;
    this.controls.maxDistance = this.size * 10;
    this.ground = new GridHelper(1, 8);
    this.ground.scale.setScalar(1.3 * this.size);
    this.ground.rotation.x = Math.PI / 2;
    this.ground.position.set(this.centre.x, this.centre.y, low.z - 0.02 * this.size);
    this.ground.material.transparent = true;
    this.ground.material.opacity = 0.35;
    this.ground.material.vertexColors = false;
    this.scene.add(this.ground);
    this.reset();
  }

  reset() {
    this.camera.position.copy(this.home);
    this.controls.target.copy(this.centre);
    this.controls.update();
    this.redraw();
  }

  // `panels`: what stands side by side, each { cloth, wire }.
  show(panels) {
    this.panels = panels;
    this.redraw();
  }

  // `shown`: of each name its frame and colours, as Cloth takes them.
  update(shown) {
    for (const [name, cloth] of Object.entries(this.cloths)) cloth.update(shown[name].frame, shown[name].paint);
    this.wire?.update(shown[this.wire.name].frame);
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
    const { renderer, canvas, camera } = this;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height || !this.panels.length) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height, false);
    }
    this.wire?.object.material.color.set(colour('ink'));
    this.ground.material.color.set(colour('soft'));
    // From the upper left of whoever looks.
    this.head.position.copy(camera.position).add(new Vector3(0, 0, this.size))
      .addScaledVector(new Vector3().setFromMatrixColumn(camera.matrixWorld, 0), -1.2 * this.size);
    this.head.target.position.copy(this.controls.target);
    const [columns, rows] = arranged(this.panels.length);
    const w = width / columns, h = height / rows;
    // What stands nowhere is empty.
    renderer.setScissor(0, 0, width, height);
    renderer.clear();
    this.panels.forEach((panel, i) => {
      const x = i % columns * w, y = height - (Math.floor(i / columns) + 1) * h;
      for (const [name, cloth] of Object.entries(this.cloths)) cloth.object.visible = name === panel.cloth;
      if (this.wire) this.wire.object.visible = panel.wire;
      camera.aspect = w / h;
      // The cloth fits into narrow panels too.
      camera.zoom = Math.min(1, camera.aspect);
      camera.updateProjectionMatrix();
      renderer.setViewport(x, y, w, h);
      renderer.setScissor(x, y, w, h);
      renderer.render(this.scene, camera);
    });
  }
}
