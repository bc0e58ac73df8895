// Recordings as the page carries them: gst/gap/report/view.c writes it.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { bytes } from './data.js';

export const COMPONENTS = ['warp', 'weft', 'shear'];

export class Take {
  constructor(data) {
    this.name = data.name;
    this.allFrames = data.all_frames;
    this.frameStep = data.frame_step;
    this.times = data.times;
    this.frames = data.times.length;
    this.origin = data.origin;
    this.step = data.step;
    this.uv = new Float32Array(bytes(data.uv));
    this.faces = new Uint32Array(bytes(data.faces));
    this.vertices = this.uv.length / 2;
    this.places = new Uint16Array(bytes(data.places));
    this.states = new Uint8Array(bytes(data.states));
    this.sigmas = data.sigma ? new Uint8Array(bytes(data.sigma)) : null;
    this.sigmaScale = data.sigma_scale;
    this.strains = data.strain ? new Int16Array(bytes(data.strain)) : null;
    this.strainStep = data.strain_step;
  }

  room(n) {
    return new Float32Array(n * this.vertices);
  }

  // Positions of one frame in metres; NaN: not seen.
  positions(name, frame, into) {
    const start = frame * this.vertices * 3;
    for (let i = 0; i < into.length; i++) {
      const value = this.places[start + i];
      into[i] = value === 0xffff ? NaN : this.origin[i % 3] + this.step * value;
    }
    return into;
  }

  state(frame, vertex) {
    return this.states[frame * this.vertices + vertex];
  }

  // Standard deviation, metres; NaN: not known.
  sigma(frame, vertex) {
    const value = this.sigmas ? this.sigmas[frame * this.vertices + vertex] : 0xff;
    return value === 0xff ? NaN : this.sigmaScale[0] * Math.exp(this.sigmaScale[1] * value);
  }

  // Warp, weft, shear; NaN: not known.
  strain(frame, vertex, component) {
    const value = this.strains ? this.strains[3 * (frame * this.vertices + vertex) + component] : -32768;
    return value === -32768 ? NaN : this.strainStep * value;
  }

  // What is shown at a time of the page: the nearest frame.
  frameAt(time) {
    let low = 0, high = this.frames - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] + this.times[middle + 1] < 2 * (time + this.shift)) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

// Gives each take its shift and returns the times of the page: those of all takes, or, where they
// don't overlap, all from each one's beginning.
export function align(takes) {
  const starts = takes.map((take) => take.times[0]);
  const ends = takes.map((take) => take.times[take.frames - 1]);
  const apart = Math.max(...starts) > Math.min(...ends);
  takes.forEach((take, i) => { take.shift = apart ? starts[i] : 0; });
  const times = takes.flatMap((take) => take.times.map((time) => time - take.shift)).sort((a, b) => a - b);
  return { apart, times: times.filter((time, i) => i === 0 || time - times[i - 1] > 1e-4) };
}
