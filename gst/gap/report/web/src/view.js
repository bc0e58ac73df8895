// Recordings beside each other, from what the page carries.
// SPDX-License-Identifier: LGPL-2.1-or-later
import './style.css';
import './view.css';
import { css, shade, shadeState, shadeStrain } from './colours.js';
import { niceLimit, read } from './data.js';
import { element, radios, section, table, whenShown } from './dom.js';
import { legend } from './maps.js';
import { View, arranged } from './scene.js';
import { align, COMPONENTS, Take } from './takes.js';
import { Transport } from './transport.js';
import { listed, mm, number, percent } from './words.js';

const takes = read('takes').takes.map((data) => new Take(data));
const { times, apart } = align(takes);
const page = document.getElementById('view');

const STATES = ['not seen', 'measured', 'from two views', 'filled', 'predicted'];
const ORDER = [1, 2, 3, 4, 0];

// Values of some frames of all takes, for the scale.
function sample(value) {
  const values = [];
  for (const take of takes) {
    const every = Math.ceil(take.frames / 30), each = Math.ceil(take.vertices / 2000);
    for (let frame = 0; frame < take.frames; frame += every) {
      for (let vertex = 0; vertex < take.vertices; vertex += each) values.push(value(take, frame, vertex));
    }
  }
  return values;
}

function quantiles(values, shares) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return sorted.length ? shares.map((share) => sorted[Math.round(share * (sorted.length - 1))]) : null;
}

// How the cloth is coloured by a number: what it says of one frame of one take.
function scaled(title, value, low, paint, write) {
  const limit = niceLimit(sample(value).map(Math.abs));
  const key = legend(paint, low, 'not known');
  key.set(write(limit), low ? write(-limit) : '0');
  return {
    title,
    key: key.node,
    columns: ['Take', 'Median', '5% to 95% of the vertices'],
    paint: (take, frame) => (vertex, rgb) => paint(value(take, frame, vertex) / limit, rgb),
    row(take, frame) {
      const found = quantiles(Array.from({ length: take.vertices }, (_, vertex) => value(take, frame, vertex)), [0.5, 0.05, 0.95]);
      return found ? [write(found[0]), `${write(found[1])} to ${write(found[2])}`] : ['not known', ''];
    },
  };
}

const modes = {
  state: {
    title: 'state',
    key: element('div', { class: 'legend' }, ...ORDER.map((state) => {
      const swatch = element('span', { class: 'swatch' });
      swatch.style.background = css(state, shadeState);
      return element('span', {}, swatch, STATES[state]);
    })),
    columns: ['Take', ...ORDER.map((state) => STATES[state])],
    paint: (take, frame) => (vertex, rgb) => shadeState(take.state(frame, vertex), rgb),
    row(take, frame) {
      const counts = [0, 0, 0, 0, 0];
      for (let vertex = 0; vertex < take.vertices; vertex++) counts[take.state(frame, vertex)]++;
      return ORDER.map((state) => percent(counts[state] / take.vertices));
    },
  },
};
if (takes.some((take) => take.sigmas)) {
  modes.sigma = scaled('σ', (take, frame, vertex) => take.sigma(frame, vertex), 0, shade, (value) => mm(value, value < 0.002 ? 2 : 1));
}
if (takes.some((take) => take.strains)) {
  COMPONENTS.forEach((name, component) => {
    modes[name] = scaled(name === 'shear' ? 'shear strain' : name + ' strain',
      (take, frame, vertex) => take.strain(frame, vertex, component), -1, shadeStrain,
      (value) => number(100 * value, 2) + '%');
  });
}

class Viewer {
  constructor() {
    this.mode = 'state';
    this.canvas = element('canvas', { id: 'cloth', tabindex: '0', role: 'img',
      'aria-label': 'The cloths in 3D. Arrow keys turn them, plus and minus zoom, Home resets.' });
    this.labels = element('div', { class: 'labels grid', 'aria-hidden': 'true' });
    this.transport = new Transport(times, 0, () => this.#refresh(), () => this.view?.reset());
    this.output = element('output', { id: 'readout', for: 'time' });
    this.key = element('div', { id: 'key' });
    this.readings = element('div', { id: 'readings' });
    const choices = Object.entries(modes).map(([value, { title }]) => [value, title]);
    this.node = section('cloths', 'Cloths', apart ? 'The takes’ times don’t overlap: all are shown from their beginnings.' : null,
      element('div', { class: 'choices' }, radios('colour', 'Colour by', choices, this.mode, (value) => {
        this.mode = value;
        this.#refresh();
      })),
      element('div', { class: 'stage' }, this.canvas, this.labels), this.transport.node,
      element('div', { class: 'under' }, this.output, this.key), this.readings);
  }

  // Needs the canvas to be in the page.
  start() {
    const names = takes.map((_, i) => 'take' + i);
    try {
      this.view = new View(this.canvas, Object.fromEntries(takes.map((take, i) => [names[i], take])), names);
    } catch (problem) {
      this.labels.remove();
      this.canvas.replaceWith(element('p', { class: 'missing' }, 'This browser offers no WebGL, so the cloths can’t be shown in 3D. The numbers are here.'));
    }
    if (this.view) {
      this.view.show(names.map((name) => ({ cloth: name, wire: false })));
      this.labels.replaceChildren(...takes.map((take, i) => element('span', {}, take.name,
        this.view.moved.has(names[i]) ? element('small', {}, ', moved here') : null)));
      whenShown(this.canvas, () => this.#arrange());
      this.#arrange();
    }
    this.#refresh();
  }

  #arrange() {
    const [columns, rows] = arranged(takes.length);
    this.labels.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    this.canvas.style.height = rows * (rows > 1 ? 300 : 440) + 'px';
    this.view.redraw();
  }

  // A take that is not there at this time.
  #beyond(take, time) {
    const at = time + take.shift;
    if (at < take.times[0] - 1e-4) return element('small', {}, 'not begun: its first frame');
    return at > take.times[take.frames - 1] + 1e-4 ? element('small', {}, 'at its end: its last frame') : '';
  }

  #refresh() {
    const { time } = this.transport;
    const mode = modes[this.mode];
    const frames = takes.map((take) => take.frameAt(time));
    const text = `${time.toFixed(2)} s`;
    this.output.value = text;
    this.transport.tell(text);
    if (this.key.firstChild !== mode.key) this.key.replaceChildren(mode.key);
    this.readings.replaceChildren(table('values', 'What is shown at this time', mode.columns,
      takes.map((take, i) => [[take.name, this.#beyond(take, time)], ...mode.row(take, frames[i])])));
    this.view?.update(Object.fromEntries(takes.map((take, i) =>
      ['take' + i, { frame: frames[i], paint: mode.paint(take, frames[i]) }])));
  }
}

function about() {
  const carried = (take) => listed(['state', take.sigmas && 'σ', take.strains && 'strain'].filter(Boolean));
  return section('about', 'Takes', null, table('takes-table', 'Takes', ['Take', 'Frames', 'Time', 'Vertices', 'Carries'],
    takes.map((take) => [take.name,
      take.frameStep > 1 ? `${take.frames} of ${take.allFrames}, one of ${take.frameStep}, to keep this file small` : String(take.frames),
      `${number(take.times[0], 4)} s to ${number(take.times[take.frames - 1], 4)} s`, String(take.vertices), carried(take)])),
  modes.warp ? element('p', { class: 'note' }, 'Strain is Green–Lagrange’s, against the flat cloth: threads along warp and weft are so '
    + 'much longer, and shear is half the sine of how far the angle between them has closed.') : null);
}

const viewer = new Viewer();
page.replaceChildren(element('header', {}, element('p', { class: 'over' }, takes.length > 1 ? `${takes.length} takes` : 'Take'),
  element('h1', {}, takes.map((take) => take.name).join(', '))), viewer.node, about());
viewer.start();
document.documentElement.dataset.ready = 'yes';
