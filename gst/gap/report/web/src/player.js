// The moving cloth with its slider, in 3D and flat.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { niceLimit, rms } from './data.js';
import { element, radios, section, whenShown } from './dom.js';
import { FlatMap, legend } from './maps.js';
import { View } from './scene.js';
import { known, mm, number, percent } from './words.js';

// Which vertices the gap is at, and since when; in metres where every vertex is shown.
function place(where, playback) {
  const { region, onset_s: onset, vertices } = where ?? {};
  if (!region) return null;
  if (!region.length) return element('p', { id: 'place' }, 'Nowhere on the cloth is the gap more than chance makes it.');
  const span = (k) => {
    const at = region.map((vertex) => playback.uv[2 * vertex + k]);
    return `${'uv'[k]} ${[Math.min, Math.max].map((end) => number(at.reduce((a, b) => end(a, b)))).join(' to ')} m`;
  };
  const share = vertices ? ` of ${vertices.length} vertices (${percent(region.length / vertices.length)})` : ' vertices';
  return element('p', { id: 'place' }, `More than chance makes it, the gap is at ${region.length}${share}, `,
    playback.vertexStep === 1 ? `${span(0)}, ${span(1)}, ` : null,
    known(onset) ? `from ${number(onset)} s on.` : 'from the beginning on.');
}

const TITLES = { recorded: 'Recorded', before: 'Simulated before', after: 'Simulated after' };

export class Player {
  constructor(playback, where, frameChanged) {
    this.playback = playback;
    this.where = where;
    this.frameChanged = frameChanged;
    this.names = ['recorded', 'before', 'after'].filter((name) => playback.has(name));
    this.simulated = this.names.slice(1);
    this.residuals = Object.fromEntries(this.simulated.map((name) => [name, playback.room(1)]));
    this.relative = false;
    this.frame = 0;
    this.playing = false;
    this.speed = 1;
    this.#measure();
    this.node = this.#build();
  }

  // Scales of both units, and the frame that is worst.
  #measure() {
    const { playback } = this;
    const metres = [], expected = [];
    const scratch = playback.room(1);
    let worst = -1;
    this.limits = { metres: 1e-3, expected: 1 };
    if (!this.simulated.length) return;
    for (let frame = 0; frame < playback.frames; frame += Math.ceil(playback.frames / 60)) {
      playback.residuals(this.simulated[0], frame, scratch);
      const value = rms(scratch);
      if (value > worst) {
        worst = value;
        this.frame = frame;
      }
      metres.push(...scratch);
      if (playback.sigma) expected.push(...playback.residuals(this.simulated[0], frame, scratch, true));
    }
    this.limits.metres = niceLimit(metres);
    if (playback.sigma) this.limits.expected = niceLimit(expected);
  }

  #build() {
    const { playback } = this;
    this.canvas = element('canvas', { id: 'cloth', tabindex: '0', role: 'img',
      'aria-label': 'The cloth in 3D. Arrow keys turn it, plus and minus zoom, Home resets.' });
    this.labels = element('div', { class: 'labels', 'aria-hidden': 'true' });
    this.slider = element('input', { type: 'range', id: 'time', min: '0', max: String(playback.frames - 1),
      step: '1', value: String(this.frame), 'aria-label': 'Time' });
    this.slider.addEventListener('input', () => this.seek(Number(this.slider.value)));
    this.button = element('button', { type: 'button', id: 'play' }, 'Play');
    this.button.addEventListener('click', () => this.toggle());
    const speed = element('select', { id: 'speed', 'aria-label': 'Speed' }, ...[['1', '1×'], ['0.5', '½×'],
      ['0.25', '¼×'], ['0.1', '⅒×']].map(([value, text]) => element('option', { value }, text)));
    speed.addEventListener('change', () => { this.speed = Number(speed.value); });
    const home = element('button', { type: 'button' }, 'Reset view');
    home.addEventListener('click', () => this.view?.reset());
    this.output = element('output', { id: 'readout', for: 'time' });
    this.key = legend();
    const choices = [element('div', { class: 'choices' })];
    if (this.simulated.length) {
      const ways = [['all', 'side by side'], ...this.simulated.map((name) => [name, 'recorded over ' + name])];
      choices[0].append(radios('view', 'Show', ways, 'all', (value) => this.#arrange(value)));
      if (playback.sigma) {
        choices[0].append(radios('unit', 'Colour by distance in', [['metres', 'mm'],
          ['expected', 'multiples of the floor']], 'metres', (value) => {
          this.relative = value === 'expected';
          this.#refresh();
        }));
      }
    }
    this.#makeMaps();
    const thin = [];
    if (playback.frameStep > 1) thin.push(`every ${playback.frameStep}th frame`);
    if (playback.vertexStep > 1) thin.push(`every ${playback.vertexStep}th vertex each way`);
    return section('where', 'Where', (playback.take ? `Take ${playback.take}. ` : '') +
      'The simulations are coloured by each vertex’s distance from the recording.' +
      (thin.length ? ` To keep this file small it shows ${thin.join(' and ')}.` : ''),
    ...choices, element('div', { class: 'stage' }, this.canvas, this.labels),
    element('div', { class: 'controls' }, this.button, this.slider, speed, home),
    element('div', { class: 'under' }, this.output, this.key.node),
    this.maps.length ? element('h3', {}, 'On the flat cloth') : null,
    this.maps.length ? this.mapBox : null, place(this.where, playback));
  }

  #makeMaps() {
    const { playback } = this;
    this.maps = this.simulated.map((name) => ({ name, map: new FlatMap(playback, `${TITLES[name]}, this frame`) }));
    if (playback.shares) this.maps.push({ values: playback.shares, map: new FlatMap(playback, 'Share of the gap, whole take') });
    if (playback.gained) this.maps.push({ values: playback.gained, map: new FlatMap(playback, 'What the effects take off it') });
    if (this.maps.length && !this.maps[0].map.flat()) this.maps = [];
    this.mapBox = element('div', { class: 'maps' }, ...this.maps.map((item) => item.map.node));
    this.shareLimit = playback.shares ? niceLimit(playback.shares) : 1;
  }

  // Needs the canvas to be in the page.
  start() {
    try {
      this.view = new View(this.canvas, this.playback, this.names);
    } catch (problem) {
      this.labels.remove();
      this.canvas.replaceWith(element('p', { class: 'missing' }, 'This browser offers no WebGL, so the cloth can’t be shown in 3D. All else is here.'));
    }
    this.#arrange('all');
    if (this.view) whenShown(this.canvas, () => this.view.redraw());
    whenShown(this.mapBox, (width) => {
      const columns = Math.max(1, Math.min(this.maps.length, Math.floor(width / 200)));
      for (const { map } of this.maps) map.resize(width / columns - 16);
      this.#refresh();
    });
    this.#refresh();
  }

  #arrange(way) {
    const panels = way === 'all' ? this.names.map((name) => ({ cloth: name, wire: false }))
      : [{ cloth: way, wire: true }];
    if (!this.view) return;
    this.view.show(panels);
    this.labels.replaceChildren(...panels.map((panel) => element('span', {}, TITLES[panel.cloth],
      panel.wire ? ', the recording as lines' : '')));
  }

  seek(frame) {
    this.frame = Math.min(this.playback.frames - 1, Math.max(0, frame));
    this.slider.value = String(this.frame);
    this.#refresh();
  }

  seekTime(time) {
    const { times } = this.playback;
    let best = 0;
    times.forEach((value, i) => {
      if (Math.abs(value - time) < Math.abs(times[best] - time)) best = i;
    });
    this.seek(best);
  }

  get time() {
    return this.playback.times[this.frame];
  }

  #refresh() {
    const { playback, frame } = this;
    const limit = this.relative ? this.limits.expected : this.limits.metres;
    const words = [];
    for (const name of this.simulated) {
      words.push(`${name} ${mm(rms(playback.residuals(name, frame, this.residuals[name])))}`);
      if (this.relative) playback.residuals(name, frame, this.residuals[name], true);
    }
    const text = `${this.time.toFixed(2)} s` + (words.length ? `, RMS distance ${words.join(', ')}` : '');
    this.output.value = text;
    this.slider.setAttribute('aria-valuetext', text);
    this.key.set(this.relative ? `${number(limit, 1)}× the floor` : mm(limit, limit < 0.01 ? 1 : 0));
    this.view?.update(frame, this.residuals, limit);
    for (const { name, values, map } of this.maps) {
      if (map.scale) map.draw(values ?? this.residuals[name], values ? this.shareLimit : limit);
    }
    this.frameChanged(this.time);
  }

  toggle() {
    this.playing = !this.playing;
    this.button.textContent = this.playing ? 'Pause' : 'Play';
    if (!this.playing) return;
    if (this.frame === this.playback.frames - 1) this.seek(0);
    let last = performance.now();
    let clock = this.time;
    let shown = this.frame;
    const tick = (now) => {
      if (!this.playing) return;
      const { times, frames } = this.playback;
      // Whoever moves the slider while it plays goes on from there.
      clock = this.frame === shown ? clock + (now - last) / 1000 * this.speed : this.time;
      last = now;
      if (clock > times[frames - 1]) clock = times[0];
      shown = clock < this.time ? 0 : this.frame;
      while (shown + 1 < frames && times[shown + 1] <= clock) shown++;
      if (shown !== this.frame) this.seek(shown);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}
