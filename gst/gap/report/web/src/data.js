// What the page carries: numbers as JSON, arrays as base64.
// SPDX-License-Identifier: LGPL-2.1-or-later

export function read(id) {
  return JSON.parse(document.getElementById(id).textContent);
}

export function bytes(text) {
  const binary = atob(text);
  const result = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) result[i] = binary.charCodeAt(i);
  return result.buffer;
}

// Arrays are little-endian, as are the machines that browsers run on.
export class Playback {
  constructor(data) {
    this.take = data.take;
    this.times = data.times;
    this.frames = data.times.length;
    this.frameStep = data.frame_step;
    this.vertexStep = data.vertex_step;
    this.origin = data.origin;
    this.step = data.step;
    this.freeRun = data.free_run;
    this.uv = new Float32Array(bytes(data.uv));
    this.faces = new Uint32Array(bytes(data.faces));
    this.vertices = this.uv.length / 2;
    this.packed = {};
    for (const name of ['recorded', 'before', 'after']) {
      if (data[name]) this.packed[name] = new Uint16Array(bytes(data[name]));
    }
    this.sigma = data.sigma ? new Uint8Array(bytes(data.sigma)) : null;
    this.sigmaScale = data.sigma_scale;
    this.edges = this.#edges();
    this.shares = data.shares ? new Float32Array(bytes(data.shares)) : null;
    this.gained = data.gained ? new Float32Array(bytes(data.gained)) : null;
    this.now = { recorded: this.room(3), before: this.room(3), after: this.room(3) };
  }

  room(n) {
    return new Float32Array(n * this.vertices);
  }

  has(name) {
    return name in this.packed;
  }

  // Positions of one frame in metres; NaN: not seen.
  positions(name, frame, into = this.now[name]) {
    const from = this.packed[name];
    const start = frame * this.vertices * 3;
    for (let i = 0; i < into.length; i++) {
      const value = from[start + i];
      into[i] = value === 0xffff ? NaN : this.origin[i % 3] + this.step * value;
    }
    return into;
  }

  // Of one vertex in one frame.
  point(name, frame, vertex) {
    const start = 3 * (frame * this.vertices + vertex);
    return [0, 1, 2].map((k) => {
      const value = this.packed[name][start + k];
      return value === 0xffff ? NaN : this.origin[k] + this.step * value;
    });
  }

  // Distance from the recording of each vertex, metres; `relative`: in expected distances.
  residuals(name, frame, into, relative = false) {
    const a = this.positions('recorded', frame);
    const b = this.positions(name, frame);
    for (let i = 0; i < this.vertices; i++) {
      into[i] = Math.hypot(a[3 * i] - b[3 * i], a[3 * i + 1] - b[3 * i + 1], a[3 * i + 2] - b[3 * i + 2]);
      if (relative) into[i] /= this.expected(frame, i);
    }
    return into;
  }

  // Residual that a simulation without a gap would have, metres.
  expected(frame, vertex) {
    const value = this.sigma[frame * this.vertices + vertex];
    return value === 0xff ? NaN : this.sigmaScale[0] * Math.exp(this.sigmaScale[1] * value);
  }

  #edges() {
    const seen = new Set();
    const edges = [];
    for (let f = 0; f < this.faces.length; f += 4) {
      const n = this.faces[f + 3] === 0xffffffff ? 3 : 4;
      for (let i = 0; i < n; i++) {
        const a = this.faces[f + i], b = this.faces[f + (i + 1) % n];
        const key = Math.min(a, b) * this.vertices + Math.max(a, b);
        if (!seen.has(key)) {
          seen.add(key);
          edges.push(a, b);
        }
      }
    }
    return edges;
  }
}

// Root of the mean square of what is finite.
export function rms(values) {
  let sum = 0, n = 0;
  for (const value of values) {
    if (Number.isFinite(value)) {
      sum += value * value;
      n++;
    }
  }
  return n ? Math.sqrt(sum / n) : NaN;
}

// A scale that leaves out the largest few of a sample, rounded up to 1, 2 or 5.
export function niceLimit(values) {
  const finite = Array.from(values).filter(Number.isFinite).sort((a, b) => a - b);
  const high = finite.length ? finite[Math.floor(0.98 * (finite.length - 1))] : 1;
  if (!(high > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(high));
  return [1, 2, 3, 5, 10].find((digit) => digit * power >= high * 0.999) * power;
}
