// The moving cloth with its slider, in 3D and flat.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { shade } from './colours.js';
import { niceLimit, rms } from './data.js';
import { element, radios, section, whenShown } from './dom.js';
import { FlatMap, legend } from './maps.js';
import { View } from './scene.js';
import { Transport } from './transport.js';
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
    this.first = 0;
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
        this.first = frame;
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
    this.transport = new Transport(playback.times, this.first, () => this.#refresh(), () => this.view?.reset());
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
    this.transport.node,
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
      this.view = new View(this.canvas, Object.fromEntries(this.names.map((name) => [name, this.playback])), ['recorded'],
        'recorded');
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

  seekTime(time) {
    this.transport.seekTime(time);
  }

  get time() {
    return this.transport.time;
  }

  #refresh() {
    const { playback, transport: { frame } } = this;
    const limit = this.relative ? this.limits.expected : this.limits.metres;
    const words = [];
    for (const name of this.simulated) {
      words.push(`${name} ${mm(rms(playback.residuals(name, frame, this.residuals[name])))}`);
      if (this.relative) playback.residuals(name, frame, this.residuals[name], true);
    }
    const text = `${this.time.toFixed(2)} s` + (words.length ? `, RMS distance ${words.join(', ')}` : '');
    this.output.value = text;
    this.transport.tell(text);
    this.key.set(this.relative ? `${number(limit, 1)}× the floor` : mm(limit, limit < 0.01 ? 1 : 0));
    this.view?.update(Object.fromEntries(this.names.map((name) => {
      const residuals = this.residuals[name];
      return [name, { frame, paint: (vertex, rgb) => shade(residuals ? residuals[vertex] / limit : 0, rgb) }];
    })));
    for (const { name, values, map } of this.maps) {
      if (map.scale) map.draw(values ?? this.residuals[name], values ? this.shareLimit : limit);
    }
    this.frameChanged(this.time);
  }

}
