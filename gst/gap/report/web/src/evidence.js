// Which effects: ranked, together, and how large others may be unseen.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { bar, element, section, table } from './dom.js';
import { capital, chance, fitted, known, listed, percent, probability, range, spoken, unit } from './words.js';

const ROWS = 6;

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
  return [
    [element('span', { class: 'rank' }, String(index + 1)), ' ', capital(spoken(effect.name)), ' ',
      element('span', { class: 'side ' + effect.side }, effect.camera ?? effect.side), ' ',
      ...(effect.accepted ? [element('span', { class: 'tick' }, 'accepted'), ' '] : []),
      ...(about ? [element('small', {}, about)] : [])],
    [bar(effect.probability, 'probability'), element('span', {}, probability(effect.probability)),
      element('small', {}, `p ${chance(effect.p_value)}`)],
    parameters(effect),
    known(share.value) ? [bar(share.value, 'shrink', share.interval), element('span', {}, percent(share.value)), ' ',
      element('span', { class: 'interval' }, range(share.interval, 100, 0))] : [],
    confused(gap, effect),
  ];
}

const RIVALS = { force_field: 'an unknown force', displacement_field: 'an unknown error of the measured positions' };

function explanation({ effects, rival }) {
  const names = effects.map(spoken);
  if (rival) names.push(RIVALS[rival]);
  if (!names.length) return 'no effect of the library';
  return names.length === 1 ? `${names[0]} alone` : `${listed(names)} together`;
}

function outside({ none_acts: none, force_field: force, displacement_field: displacement }) {
  const parts = [[force, 'that an unknown force acts'], [displacement, 'that positions were measured wrong in an unknown way'],
    [none, 'that nothing is missing']].filter(([value]) => known(value));
  return parts.length ? element('p', { id: 'rivals' }, 'Beyond the library’s effects, the probability ',
    parts.map(([value, text]) => `${text} is ${probability(value)}`).join('; '), '.') : null;
}

function explanations(gap) {
  const { sets } = gap;
  const said = outside(gap.rivals);
  if (!sets.length && !said) return null;
  return element('div', { id: 'sets' }, element('h3', {}, 'Which explanations remain'),
    sets.length ? element('p', { class: 'note' }, sets.length === 1 ? 'The only explanation that counts: no other is needed to make up 95% of the probability.'
      : `These ${sets.length} explanations make up 95% of the probability. More than one means that these data can’t tell them apart.`) : null,
    sets.length ? element('ol', {}, ...sets.map((set) => element('li', {}, capital(explanation(set)), ' ',
      element('span', { class: 'interval' }, probability(set.probability))))) : null, said);
}

export function effects(gap, about) {
  const box = gap.effects.length ? table('ranking', 'Ranked effects', ['Effect', 'Probability', 'Its numbers', 'Shrinks the gap by', 'Confused with'],
    gap.effects.map((effect, i) => row(gap, effect, i, about[effect.name])),
    gap.effects.map((effect, i) => ({ class: effect.accepted ? 'accepted' : null, hidden: i >= ROWS }))) : null;
  const result = section('effects', 'Which effects', gap.effects.length
    ? 'The probability is that the effect acts, given these data, whatever else does. p: how often chance alone would make as strong a sign of it. ' +
      'The shrink is what the accepted effects take off the gap together, of its square above the noise floor; a wrong effect may shrink it too.'
    : 'No effect was tested.', box);
  const rows = box ? [...box.querySelectorAll('tbody tr')] : [];
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
  const together = explanations(gap);
  if (together) result.append(together);
  if (gap.untested.length) {
    result.append(element('details', { id: 'untested' },
      element('summary', {}, `${gap.untested.length} could not be tested`),
      element('ul', {}, ...gap.untested.map((item) => element('li', {},
        element('strong', {}, capital(spoken(item.name))), ' ',
        element('span', { class: 'side ' + item.side }, item.side), ' ', item.reason)))));
  }
  return result;
}

// What was not found may be there, but no larger than this.
export function limits(gap) {
  const { detection_limits: all } = gap;
  if (!all.length) return null;
  const seen = all.filter((item) => known(item.value));
  const unseen = all.filter((item) => !known(item.value));
  return section('limits', 'What would have shown', 'Effects this large would have been found on these takes with a probability of 95%. Smaller ones may be there unseen.',
    seen.length ? element('ul', { class: 'many' }, ...seen.map((item) => element('li', {}, capital(item.text)))) : null,
    unseen.length ? element('p', {}, 'Not seen here, however large: ', listed([...new Set(unseen.map((item) => spoken(item.effect)))]), '.') : null);
}
