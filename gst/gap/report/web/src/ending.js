// What to film next, and where all of this comes from.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { element, section } from './dom.js';
import { capital, known, number, quantity, spoken } from './words.js';

function advice(gap) {
  const list = gap.groups.filter((group) => group.effects.length > 1 && gap.verdict !== 'no_gap').map((group) => element('li', {},
    'To tell ', element('strong', {}, group.effects.map(spoken).join(' from ')), ': ',
    group.experiment ?? 'none of the captures that were tried would.',
    known(group.evidence) ? ' ' : null, known(group.evidence) ? element('span', { class: 'interval' },
      `Expected evidence: log Bayes factor ${number(group.evidence)}.`) : null));
  if (gap.verdict === 'undecidable' && gap.reason) list.unshift(element('li', {}, gap.reason));
  if (gap.verdict === 'unexplained') {
    list.push(element('li', {}, 'Something acts that the library does not have. Film the same motion with one condition changed at a time; the maps above say where on the cloth and when to look.'));
  }
  if (gap.held_out !== 'takes' && gap.verdict !== 'undecidable') {
    list.push(element('li', {}, 'The shrink was judged on time blocks of the same take. A second take of another motion, given as --hold-out, judges it harder.'));
  }
  if (gap.verdict !== 'undecidable' && !gap.inputs.some((input) => input.role === 'baseline')) {
    list.push(element('li', {}, 'There was no baseline. A take on which the model is right, given as --baseline, tells the simulator’s own error from an effect.'));
  }
  return list.length ? element('ul', {}, ...list)
    : element('p', {}, 'Nothing: the named effects are told apart from all others that were tested.');
}

function table(id, titles, rows) {
  return rows.length === 0 ? null : element('table', { id },
    element('thead', {}, element('tr', {}, ...titles.map((title) => element('th', { scope: 'col' }, title)))),
    element('tbody', {}, ...rows.map((row) => element('tr', {}, ...row.map((cell) => element('td', {}, cell))))));
}

const roles = { take: 'diagnosed take', baseline: 'baseline take', hold_out: 'unseen take', model: 'model' };

export function next(gap) {
  return section('next', 'What to film next', null, advice(gap));
}

export function provenance(gap) {
  return section('provenance', 'Provenance', null,
    element('p', {}, `${gap.simulations} simulations, of which ${gap.failures.length || 'none'} failed, in ${number(gap.seconds)} s; seed ${gap.seed}.`),
    element('div', { class: 'columns' },
      table('inputs', ['Input', 'Name', 'SHA-256'], gap.inputs.map((item) => [roles[item.role], item.name,
        element('code', { title: item.sha256 }, item.sha256 ?? '–')])),
      table('thresholds', ['Threshold', 'Value'], gap.thresholds.map((item) => [capital(spoken(item.name)),
        quantity(item.value, item.unit)])),
      table('versions', ['Version of', ''], gap.versions.map((item) => [item.name, item.version])),
      table('failures', ['Failed simulation', 'What happened'], gap.failures.map((item) => [item.run, item.what]))));
}
