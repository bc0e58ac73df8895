// Two or three points of the cloth over time: recorded, before, after.
// SPDX-License-Identifier: LGPL-2.1-or-later
import uPlot from 'uplot';
import { axis, column, line, upright } from './charts.js';
import { colour, element, radios, whenShown } from './dom.js';
import { capital, listed, mm, number } from './words.js';

const MOST = 3;
const HEIGHT = 190;
const AXES = ['x', 'y', 'z'];
const LOOKS = { recorded: ['ink', { width: 1.5 }], before: ['before', { width: 2 }], after: ['after', { width: 2, dash: [6, 3] }] };
const TITLES = { recorded: 'recorded', before: 'simulated before', after: 'simulated after' };

// Sum over the frames of the squared distance from the recording, of each vertex.
function squares(playback, name) {
  const sums = new Float64Array(playback.vertices);
  const distances = playback.room(1);
  for (let frame = 0; frame < playback.frames; frame++) {
    playback.residuals(name, frame, distances);
    for (let i = 0; i < sums.length; i++) {
      if (Number.isFinite(distances[i])) sums[i] += distances[i] ** 2;
    }
  }
  return sums;
}

// The largest gap first, then what is both large and far on the flat cloth from those chosen.
export function choose(playback, sums) {
  const { uv } = playback;
  const chosen = [];
  const near = new Float64Array(sums.length).fill(1);
  while (chosen.length < MOST) {
    let best = -1;
    for (let i = 0; i < sums.length; i++) {
      if (sums[i] * near[i] > (best < 0 ? 0 : sums[best] * near[best])) best = i;
    }
    if (best < 0) break;
    for (let i = 0; i < near.length; i++) {
      const distance = Math.hypot(uv[2 * i] - uv[2 * best], uv[2 * i + 1] - uv[2 * best + 1]);
      near[i] = chosen.length ? Math.min(near[i], distance) : distance;
    }
    chosen.push(best);
  }
  return chosen;
}

// Positions in cm and distances from the recording in mm.
function trace(playback, names, vertex) {
  const at = Object.fromEntries(names.map((name) => [name, Array.from({ length: playback.frames }, (_, frame) => playback.point(name, frame, vertex))]));
  const paths = (k) => Object.fromEntries(names.map((name) => [name, at[name].map((point) => 100 * point[k])]));
  const distances = names.slice(1).map((name) => [name, at[name].map((point, frame) =>
    1000 * Math.hypot(...AXES.map((_, k) => point[k] - at.recorded[frame][k])))]);
  return { distance: Object.fromEntries(distances), ...Object.fromEntries(AXES.map((axis, k) => [axis, paths(k)])) };
}

const meanSquare = (values) => {
  const finite = values.filter(Number.isFinite);
  return finite.reduce((sum, value) => sum + value * value, 0) / finite.length;
};

// The coordinate in which the points are furthest from the recording.
function worstAxis(traces) {
  const parts = AXES.map((axis) => traces.reduce((sum, item) => sum + meanSquare(
    item[axis].before.map((value, frame) => value - item[axis].recorded[frame])), 0));
  return AXES[parts.indexOf(Math.max(...parts))];
}

function place({ uv, vertexStep }, vertex, number_) {
  const flat = uv.some((value) => value !== 0);
  return `Point ${number_ + 1}: ` + (flat ? `u ${number(uv[2 * vertex])} m, v ${number(uv[2 * vertex + 1])} m on the flat cloth`
    : vertexStep === 1 ? `vertex ${vertex}` : 'a vertex');
}

export class Points {
  constructor(playback, seek) {
    this.playback = playback;
    this.seek = seek;
    this.names = ['recorded', 'before', 'after'].filter((name) => playback.has(name));
    this.vertices = choose(playback, squares(playback, 'before'));
    this.traces = this.vertices.map((vertex) => trace(playback, this.names, vertex));
    this.time = NaN;
    this.node = this.vertices.length ? this.#build() : null;
  }

  #build() {
    this.way = worstAxis(this.traces);
    this.plots = [];
    const key = element('p', { class: 'key', 'aria-hidden': 'true' }, ...this.names.map((name) =>
      element('span', { class: 'series ' + name }, TITLES[name])));
    return element('div', { id: 'points' },
      element('h3', {}, this.vertices.length > 1 ? `${this.vertices.length} points over time` : 'One point over time'),
      element('p', { class: 'note' }, `Where the gap is largest${this.vertices.length > 1 ? ', in different places' : ''}. ` + (this.playback.freeRun
        ? 'The simulations run from the start of the take and are never put right.'
        : 'The simulations start anew where the recording is every 0.3 s, hence the steps.') + ' Click to see that moment below.'),
      radios('way', 'Show', [['distance', 'distance from the recording'], ...AXES.map((axis) => [axis, axis])], this.way, (way) => {
        this.way = way;
        this.charts.forEach((chart) => chart.draw());
      }),
      key, element('div', { class: 'columns three' }, ...this.#charts()));
  }

  #charts() {
    this.charts = this.vertices.map((vertex, i) => {
      const title = place(this.playback, vertex, i);
      const sizes = this.names.slice(1).map((name) => `${name} ${mm(Math.sqrt(meanSquare(this.traces[i].distance[name])) / 1000)}`);
      const box = element('div', { class: 'chart', role: 'img',
        'aria-label': `${title} over time. RMS distance from the recording: ${listed(sizes)}.` });
      const chart = { box, plot: null, width: 0, draw: () => this.#draw(chart, i),
        node: element('figure', { class: 'point' }, element('figcaption', {}, title, element('small', {}, capital(listed(sizes)))), box) };
      whenShown(box, (width) => {
        chart.width = width;
        chart.draw();
      });
      return chart;
    });
    return this.charts.map((chart) => chart.node);
  }

  #draw(chart, i) {
    if (!chart.width) return;
    const series = this.traces[i][this.way];
    const names = Object.keys(series);
    const label = this.way === 'distance' ? 'distance, mm' : `${this.way}, cm`;
    chart.plot?.destroy();
    chart.plot = new uPlot({
      width: chart.width, height: HEIGHT, legend: { show: false },
      scales: { x: { time: false }, ...(this.way === 'distance' ? { y: { range: (_, low, high) => [0, Math.max(high, 1) * 1.08] } } : {}) },
      axes: [{ ...axis('time, s'), size: 34 }, axis(label)],
      series: [{}, ...names.map((name) => line(name, LOOKS[name][0], LOOKS[name][1]))],
      cursor: { drag: { x: false, y: false }, points: { size: 6 } },
      hooks: {
        draw: [(plot) => upright(plot, this.time, colour('ink'), [])],
        ready: [(plot) => plot.over.addEventListener('click', () => {
          if (plot.cursor.left >= 0) this.seek(plot.posToVal(plot.cursor.left, 'x'));
        })],
      },
    }, [this.playback.times, ...names.map((name) => column(series[name]))], chart.box);
  }

  mark(time) {
    this.time = time;
    this.charts?.forEach((chart) => chart.plot?.redraw(false, false));
  }
}
