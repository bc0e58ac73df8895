// The gap over time, its spectrum and its shares.
// SPDX-License-Identifier: LGPL-2.1-or-later
import uPlot from 'uplot';
import { bar, colour, element, section, whenShown } from './dom.js';
import { css } from './colours.js';
import { capital, known, number, percent, spoken } from './words.js';

const HEIGHT = 240;

export function axis(label) {
  return { label, labelSize: 22, stroke: colour('soft'), font: '11px system-ui, sans-serif',
    labelFont: '12px system-ui, sans-serif', grid: { stroke: colour('line'), width: 1 },
    ticks: { stroke: colour('line'), width: 1, size: 5 } };
}

export function line(label, name, more = {}) {
  return { label, stroke: colour(name), width: 2, points: { show: false },
    value: (_, value) => known(value) ? number(value) : '–', ...more };
}

const edge = (label) => ({ label, stroke: 'transparent', width: 0, points: { show: false },
  value: (_, value) => known(value) ? number(value) : '–' });

export const column = (values, scale = 1) => values?.map((value) => known(value) ? value * scale : null);

// Draws now and again when width or theme change.
function chart(id, label, make) {
  const box = element('div', { id, class: 'chart', role: 'img', 'aria-label': label });
  let plot = null;
  whenShown(box, (width) => {
    plot?.destroy();
    const { options, data } = make();
    plot = new uPlot({ width, height: HEIGHT, ...options }, data, box);
  });
  return { box, redraw: () => plot?.redraw(false, false) };
}

// The gap over time; a click goes to that moment.
export function overTime(series, onset, now, seek) {
  const banded = series.null_low && series.null_high;
  const rows = [series.times, column(series.before, 1000)];
  if (banded) rows.push(column(series.null_low, 1000), column(series.null_high, 1000));
  if (series.after) rows.push(column(series.after, 1000));
  return chart('over-time', 'The gap over time', () => ({
    data: rows,
    options: {
      scales: { x: { time: false }, y: { range: (_, low, high) => [0, Math.max(high, 1e-3) * 1.08] } },
      axes: [{ ...axis('time, s'), size: 34 }, axis('gap, mm')],
      series: [{ label: 'time, s', value: (_, value) => known(value) ? value.toFixed(2) : '–' },
        line('before, mm', 'before'), ...(banded ? [edge('band from, mm'), edge('band to, mm')] : []),
        ...(series.after ? [line('after, mm', 'after')] : [])],
      bands: banded ? [{ series: [3, 2], fill: colour('band') }] : [],
      cursor: { drag: { x: false, y: false }, points: { size: 6 } },
      hooks: {
        draw: [(plot) => {
          upright(plot, now(), colour('ink'), []);
          if (known(onset)) upright(plot, onset, colour('soft'), [5, 4], 'begins');
        }],
        ready: [(plot) => plot.over.addEventListener('click', () => {
          if (plot.cursor.left >= 0) seek(plot.posToVal(plot.cursor.left, 'x'));
        })],
      },
    },
  }));
}

export function upright(plot, time, stroke, dash, text) {
  const x = Math.round(plot.valToPos(time, 'x', true));
  const { left, top, width, height } = plot.bbox;
  if (!(x >= left && x <= left + width)) return;
  const { ctx } = plot;
  ctx.save();
  ctx.strokeStyle = ctx.fillStyle = stroke;
  ctx.lineWidth = 1.5 * devicePixelRatio;
  ctx.setLineDash(dash.map((length) => length * devicePixelRatio));
  ctx.beginPath();
  ctx.moveTo(x, top);
  ctx.lineTo(x, top + height);
  ctx.stroke();
  if (text) {
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textBaseline = 'top';
    ctx.textAlign = 'left';
    ctx.fillText(text, x + 5 * devicePixelRatio, top + 3 * devicePixelRatio);
  }
  ctx.restore();
}

// Energy per frequency, all waves together. What stands still has no place on the axis.
function overFrequency(spectrum) {
  const moving = spectrum.frequencies.flatMap((value, f) => value > 0 ? [f] : []);
  const sum = (values) => values && moving.map((f) => {
    let total = 0;
    for (let k = 0; k < spectrum.waves.length; k++) total += values[k * spectrum.frequencies.length + f] ?? 0;
    return total > 0 ? 1e6 * total : null;
  });
  const rows = [moving.map((f) => spectrum.frequencies[f]), sum(spectrum.before)];
  if (spectrum.null) rows.push(sum(spectrum.null));
  if (spectrum.after) rows.push(sum(spectrum.after));
  return chart('spectrum', 'Spectrum of the gap', () => ({
    data: rows,
    options: {
      scales: { x: { time: false, distr: 3 }, y: { distr: 3 } },
      axes: [{ ...axis('frequency, Hz'), size: 34,
        values: (_, ticks) => ticks.map((value) => value === null ? '' : number(value, 2)) }, { ...axis('mean square, mm²'), size: 62,
        values: (_, ticks) => ticks.map((value) => value === null ? '' : number(value, 1)) }],
      series: [{ label: 'frequency, Hz', value: (_, value) => known(value) ? number(value) : '–' },
        line('before, mm²', 'before'), ...(spectrum.null ? [line('floor, mm²', 'soft', { dash: [5, 4], width: 1.5 })] : []),
        ...(spectrum.after ? [line('after, mm²', 'after')] : [])],
      cursor: { drag: { x: false, y: false } },
    },
  })).box;
}

// Energy over the floor for each wave number and frequency.
function heat(spectrum) {
  const canvas = element('canvas', { id: 'heat', role: 'img',
    'aria-label': 'Energy over the floor per wave number and frequency' });
  const { frequencies, waves } = spectrum;
  const ratios = spectrum.before.map((value, i) => spectrum.null[i] > 0 && known(value) ? value / spectrum.null[i] : NaN);
  const top = Math.max(2, ...ratios.filter(Number.isFinite));
  const box = element('div', { class: 'chart' }, canvas, element('div', { class: 'legend' }, element('span', {}, '1× the floor'),
    (() => {
      const strip = element('span', { class: 'strip' });
      strip.style.background = `linear-gradient(to right, ${Array.from({ length: 21 }, (_, i) => css(i / 20)).join(',')})`;
      return strip;
    })(), element('span', {}, `${number(top, 2)}×`)));
  whenShown(box, (width) => {
    const ratio = Math.min(2, devicePixelRatio);
    const [left, bottom, right] = [52, 40, 8];
    canvas.style.width = width + 'px';
    canvas.style.height = HEIGHT + 'px';
    canvas.width = width * ratio;
    canvas.height = HEIGHT * ratio;
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    const w = (width - left - right) / frequencies.length, h = (HEIGHT - bottom - 6) / waves.length;
    ratios.forEach((value, i) => {
      const f = i % frequencies.length, k = Math.floor(i / frequencies.length);
      context.fillStyle = css(value >= 0 ? Math.log(Math.max(1, value)) / Math.log(top) : NaN);
      context.fillRect(left + f * w, 6 + (waves.length - 1 - k) * h, w + 0.5, h + 0.5);
    });
    context.fillStyle = colour('soft');
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    const every = Math.ceil(frequencies.length / (width / 70));
    frequencies.forEach((value, f) => {
      if (f % every === 0) context.fillText(number(value, 2), left + (f + 0.5) * w, HEIGHT - bottom + 16);
    });
    context.font = '12px system-ui, sans-serif';
    context.fillText('frequency, Hz', left + (width - left - right) / 2, HEIGHT - 6);
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'right';
    const skip = Math.ceil(waves.length / 10);
    waves.forEach((value, k) => {
      if (k % skip === 0) context.fillText(number(value, 2), left - 5, 6 + (waves.length - 0.5 - k) * h + 4);
    });
    context.save();
    context.translate(12, 6 + (HEIGHT - bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = 'center';
    context.font = '12px system-ui, sans-serif';
    context.fillText('waves per metre', 0, 0);
    context.restore();
  });
  return box;
}

// Rows of [name, share, more]; what could not be measured has a reason instead.
function shares(title, rows, reasons = []) {
  if (!rows.some(([, share]) => known(share))) return null;
  return element('div', { class: 'shares' }, element('h3', {}, title), element('table', {}, element('tbody', {},
    ...rows.map(([name, share, more]) => element('tr', {}, element('th', { scope: 'row' }, capital(spoken(name))),
      element('td', {}, known(share) ? bar(share) : null), element('td', { class: 'number' },
        known(share) ? percent(share) : 'not measured', more ? element('small', {}, more) : null))))),
  reasons.length ? element('details', {}, element('summary', {}, 'Why not measured'),
    element('ul', {}, ...reasons.map(([name, reason]) => element('li', {}, `${capital(spoken(name))}: ${reason}`)))) : null);
}

// "1.2× the floor, 3% left"
function details({ over_floor, after }) {
  return [known(over_floor) ? `${number(over_floor, 2)}× the floor` : null,
    known(after) ? `${percent(after)} left` : null].filter(Boolean).join(', ');
}

// Cycles per metre as wave lengths.
function lengths({ from_per_m, to_per_m }) {
  const cm = (value) => number(100 / value, 2);
  if (!(from_per_m > 0)) return 'As a whole';
  return known(to_per_m) ? `${cm(to_per_m)}–${cm(from_per_m)} cm` : `Below ${cm(from_per_m)} cm`;
}

export function charts(gap, arrays, time) {
  const { where } = gap;
  const cells = [];
  if (time) cells.push(element('div', {}, element('h3', {}, 'Over time'), time.box));
  if (arrays.spectrum) {
    cells.push(element('div', {}, element('h3', {}, 'Per frequency'), overFrequency(arrays.spectrum)));
    if (arrays.spectrum.null) {
      cells.push(element('div', {}, element('h3', {}, 'Per frequency and wave length'), heat(arrays.spectrum)));
    }
  }
  const still = known(where.static) ? [['Stands still', where.static]] : [];
  const tables = [
    shares('Per stage', where.stages.map((item) => [item.name, item.share]),
      where.stages.filter((item) => item.reason).map((item) => [item.name, item.reason])),
    shares('Per direction', Object.entries(where.directions)),
    shares('Per frequency', [...still, ...where.bands.map((item) => [
      `${number(item.from_hz, 2)}–${number(item.to_hz, 2)} Hz`, item.share, details(item)])]),
    shares('Per wave length', where.waves.map((item) => [lengths(item), item.share, details(item)])),
  ].filter(Boolean);
  if (!cells.length && !tables.length) return null;
  return section('when', 'When and in which way', time ? (arrays.series.null_low
    ? 'The band is where 95% of simulations lie that lack nothing. ' : '') + 'Click to go to a moment.' : null,
  cells.length ? element('div', { class: 'charts' }, ...cells) : null,
  tables.length ? element('div', { class: 'columns' }, ...tables) : null);
}
