// The verdict and its four figures.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { element } from './dom.js';
import { known, mm, percent, range, verdicts } from './words.js';

const LIMITS = 3;

export function figure(name, value, interval, note) {
  return element('div', { class: 'figure' },
    element('dt', {}, name),
    element('dd', {}, element('strong', {}, value), ' ',
      interval ? element('span', { class: 'interval' }, interval) : null,
      element('small', {}, note)));
}

// What a gap that was not found would have to be: with “nothing found” the figure that counts.
function unseen(gap) {
  const limits = gap.detection_limits.filter((item) => known(item.value)).map((item) => item.text);
  if (!limits.length || !['no_gap', 'undecidable'].includes(gap.verdict)) return null;
  return element('p', { id: 'unseen' }, 'This would have shown: ', limits.slice(0, LIMITS).join('; '),
    limits.length > LIMITS ? '; ' : '.', limits.length > LIMITS ? element('a', { href: '#limits' }, `and ${limits.length - LIMITS} more`) : null,
    limits.length > LIMITS ? '.' : null);
}

export function verdict(gap) {
  const where = gap.held_out === 'takes' ? 'on an unseen take' : 'on held-out time blocks';
  const times = known(gap.gap_before.value) && gap.noise_floor.value > 0
    ? `${(gap.gap_before.value / gap.noise_floor.value).toFixed(1)}× the noise floor` : where;
  const takes = gap.inputs.filter((input) => input.role === 'take').map((input) => input.name);
  return element('header', { id: 'verdict', class: gap.verdict },
    element('p', { class: 'over' }, 'Sim-to-real gap', ' ',
      takes.length ? element('span', { class: 'takes' }, takes.join(', ')) : null),
    element('h1', {}, element('span', { class: 'pill' }, verdicts[gap.verdict]), ' ',
      element('span', { id: 'summary' }, gap.summary)),
    ...gap.notes.map((note) => element('p', { class: 'warning' }, note)),
    unseen(gap),
    element('dl', { class: 'figures' },
      figure('Gap before', mm(gap.gap_before.value), range(gap.gap_before.interval, 1000, 1), times),
      figure('Gap after', mm(gap.gap_after.value), range(gap.gap_after.interval, 1000, 1),
        known(gap.gap_after.value) ? 'with the accepted effects' : 'no effect was accepted'),
      figure('Noise floor', mm(gap.noise_floor.value), range(gap.noise_floor.interval, 1000, 1),
        'of a simulation that lacks nothing'),
      figure('Shrink', percent(gap.shrink.value), range(gap.shrink.interval, 100, 0),
        'of its square above the floor, ' + where)),
    element('p', { class: 'note' }, `The gap is how far recorded and ${gap.has_simulated ? 'your ' : ''}simulated points are apart: the root of the mean ` +
      'square (RMS) over windows of 0.3 s, at whose start the simulation is put where the recording is, ' + where + '. The noise floor is what would be left ' +
      'if the simulation lacked nothing. The true value lies in the brackets with a probability of 95%.'));
}
