// The model's fitted numbers, and what was measured take by take.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { element, section, table } from './dom.js';
import { capital, chance, fitted, known, mm, number, percent, range, roles, spoken, unit } from './words.js';

// A range with a mark where the number is and a line as wide as its interval.
function scale({ value, sigma, range: ends, at_end: end }) {
  if (!ends || !known(value)) return null;
  // Ranges over decades are read by their logarithm.
  const place = (at) => {
    const log = ends[0] > 0 && ends[1] > 10 * ends[0];
    const [low, high, x] = [...ends, Math.min(ends[1], Math.max(ends[0], at))].map((item) => log ? Math.log(item) : item);
    return 100 * (x - low) / (high - low);
  };
  const [from, to] = known(sigma) ? [place(value - 1.96 * sigma), place(value + 1.96 * sigma)] : [place(value), place(value)];
  const line = element('span', { class: 'whisker' });
  line.style.left = from + '%';
  line.style.right = 100 - to + '%';
  const mark = element('span', { class: 'mark' + (end ? ' end' : '') });
  mark.style.left = place(value) + '%';
  return element('span', { class: 'bar scale', 'aria-hidden': 'true' }, line, mark);
}

// Keys of model.json: stretch.warp.
const keyed = (name) => spoken(name).replaceAll('.', ' ');

// The number that it can be traded against best.
function partner(gap, i) {
  const row = gap.free_correlation?.[i];
  if (!row) return null;
  const others = row.map((value, k) => k !== i && known(value) ? Math.abs(value) : -1);
  const best = others.indexOf(Math.max(...others));
  return others[best] >= 0 ? `${keyed(gap.free_numbers[best].name)} (r ${number(row[best], 2)})` : null;
}

export function freeNumbers(gap) {
  const { free_numbers: all } = gap;
  if (!all.length) return null;
  return section('free', 'Numbers that were fitted', 'The model’s free numbers, with 95% intervals. Those that move together can’t be told apart well: when one is changed, ' +
    'the other makes up for it. r is their correlation; at 1 or −1 only both together are known.',
  table('numbers', 'Numbers that were fitted', ['Number', 'Value', 'Range that it was allowed', 'Moves with'], all.map((item, i) => {
    const [value, interval] = fitted(item.value, item.sigma);
    return [capital(keyed(item.name)),
      [element('span', { class: 'nowrap' }, known(item.value) ? value + unit(item.unit) : '–'), ' ', element('span', { class: 'interval' }, interval)],
      [...[scale(item)].filter(Boolean), item.range ? `${number(item.range[0])} to ${number(item.range[1])}${unit(item.unit)}` : 'not known',
        ...(item.at_end ? [element('small', { class: 'warn' }, 'At the end: the range, or the model, may be too narrow.')] : [])],
      partner(gap, i) ?? '–'];
  })));
}

const change = (before, after) => known(after.value) ? [`${mm(before.value)} → `, element('strong', {}, mm(after.value))] : [mm(before.value)];

export function takes(gap) {
  if (!gap.takes.length) return null;
  const p = gap.takes_agree_p_value;
  return section('takes', 'Take by take', 'The gap before and with the accepted effects, over windows of 0.3 s and over the free run, which starts with the take and is never put right.',
    table('per-take', 'Take by take', ['Take', 'Windows', 'Floor', 'Shrink', 'Free run', 'Floor of it'], gap.takes.map((take) => [
      [take.name, ' ', element('span', { class: 'side' }, roles[take.role])],
      change(take.gap_before, take.gap_after), mm(take.noise_floor.value),
      [percent(take.shrink.value), ' ', element('span', { class: 'interval' }, range(take.shrink.interval, 100, 0))],
      change(take.free_before, take.free_after), mm(take.free_floor.value)])),
    known(p) ? element('p', { id: 'agree' }, 'Do the takes agree on the numbers? If they do, chance alone parts them this much or more with a probability of ' +
      `${p < 1e-4 ? 'less than 0.01%' : percent(p)} (p ${chance(p)}). The smaller, the surer they contradict each other.`) : null);
}
