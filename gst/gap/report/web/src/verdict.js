// The verdict, its four figures, and the ranked effects.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { bar, element, section } from './dom.js';
import { capital, chance, fitted, known, mm, percent, probability, range, spoken, unit, verdicts } from './words.js';

const ROWS = 6;

function figure(name, value, interval, note) {
  return element('div', { class: 'figure' },
    element('dt', {}, name),
    element('dd', {}, element('strong', {}, value), ' ',
      interval ? element('span', { class: 'interval' }, interval) : null,
      element('small', {}, note)));
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
    element('dl', { class: 'figures' },
      figure('Gap before', mm(gap.gap_before.value), range(gap.gap_before.interval, 1000, 1), times),
      figure('Gap after', mm(gap.gap_after.value), range(gap.gap_after.interval, 1000, 1),
        known(gap.gap_after.value) ? 'with the accepted effects' : 'no effect was accepted'),
      figure('Noise floor', mm(gap.noise_floor.value), range(gap.noise_floor.interval, 1000, 1),
        'of a simulation that lacks nothing'),
      figure('Shrink', percent(gap.shrink.value), range(gap.shrink.interval, 100, 0),
        'of variance, ' + where)),
    element('p', { class: 'note' }, 'The gap is the RMS distance of recorded and simulated over windows of 0.3 s, ' +
      where + '. Brackets are 95% intervals.'));
}

function parameters(effect) {
  return effect.parameters.filter((item) => known(item.value)).map((item) => {
    const [value, interval] = fitted(item.value, item.sigma);
    return element('div', {}, element('span', { class: 'parameter' }, spoken(item.name)), ' ',
      element('span', { class: 'nowrap' }, value + unit(item.unit)), ' ',
      element('span', { class: 'interval' }, interval));
  });
}

function confused(gap, effect) {
  const names = effect.group === null ? []
    : gap.groups[effect.group].effects.filter((name) => name !== effect.name);
  const notes = [];
  if (names.length) notes.push(names.map(spoken).join(', '));
  if (known(effect.constancy_p_value) && effect.constancy_p_value < 0.05) {
    notes.push(`changes over time (p ${chance(effect.constancy_p_value)})`);
  }
  return notes.map((note) => element('div', {}, note));
}

function row(gap, effect, index, about) {
  const share = effect.shrink;
  return element('tr', { class: effect.accepted ? 'accepted' : null, hidden: index >= ROWS },
    element('td', { class: 'rank' }, String(index + 1)),
    element('th', { scope: 'row' }, capital(spoken(effect.name)), ' ',
      element('span', { class: 'side ' + effect.side }, effect.camera ?? effect.side), ' ',
      effect.accepted ? element('span', { class: 'tick' }, 'accepted') : null, ' ',
      about ? element('small', {}, about) : null),
    element('td', { class: 'measure' }, bar(effect.probability, 'probability'),
      element('span', {}, probability(effect.probability)),
      element('small', {}, `p ${chance(effect.p_value)}`)),
    element('td', {}, ...parameters(effect)),
    element('td', { class: 'measure' }, bar(share.value, 'shrink', share.interval),
      element('span', {}, percent(share.value)), ' ',
      element('span', { class: 'interval' }, range(share.interval, 100, 0))),
    element('td', {}, ...confused(gap, effect)));
}

export function effects(gap, about) {
  const rows = gap.effects.map((effect, i) => row(gap, effect, i, about[effect.name]));
  const table = element('table', { id: 'ranking' },
    element('thead', {}, element('tr', {}, ...['#', 'Effect', 'Probability', 'Parameters', 'Shrinks the gap by', 'Confused with'].map(
      (title) => element('th', { scope: 'col' }, title)))),
    element('tbody', {}, ...rows));
  const result = section('effects', 'Which effects', gap.effects.length
    ? 'Ranked by the evidence for each. The shrink is what the accepted effects take off the gap together, in per cent of the variance above the noise floor; a high shrink alone does not name an effect.'
    : 'No effect was tested.', gap.effects.length ? element('div', { class: 'wide' }, table) : null);
  if (rows.length > ROWS) {
    const more = element('button', { type: 'button', 'aria-expanded': 'false' }, `Show all ${rows.length}`);
    more.addEventListener('click', () => {
      const open = more.getAttribute('aria-expanded') === 'false';
      rows.slice(ROWS).forEach((item) => { item.hidden = !open; });
      more.setAttribute('aria-expanded', String(open));
      more.textContent = open ? `Show the first ${ROWS}` : `Show all ${rows.length}`;
    });
    result.append(more);
  }
  if (gap.untested.length) {
    result.append(element('details', { id: 'untested' },
      element('summary', {}, `${gap.untested.length} could not be tested`),
      element('ul', {}, ...gap.untested.map((item) => element('li', {},
        element('strong', {}, capital(spoken(item.name))), ' ',
        element('span', { class: 'side ' + item.side }, item.side), ' ', item.reason)))));
  }
  return result;
}
