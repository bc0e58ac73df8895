// Where all of this comes from.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { element, section, table } from './dom.js';
import { capital, number, quantity, roles, spoken } from './words.js';

const origins = { simulated: 'simulated for this take', parameter: 'chosen', paper: 'from a paper', definition: 'what the word means' };

const some = (id, caption, titles, rows) => rows.length ? table(id, caption, titles, rows) : null;

export function provenance(gap) {
  return section('provenance', 'Provenance', null,
    element('p', {}, `${gap.simulations} simulations, of which ${gap.failures.length || 'none'} failed, in ${number(gap.seconds)} s; seed ${gap.seed}.`),
    element('div', { class: 'columns' },
      some('inputs', 'Inputs', ['Name', 'Input', 'SHA-256'], gap.inputs.map((item) => [item.name, roles[item.role],
        element('code', { title: item.sha256 }, item.sha256 ?? '–')])),
      some('thresholds', 'Thresholds', ['Threshold', 'Value', 'Where from'], gap.thresholds.map((item) => [capital(spoken(item.name)),
        quantity(item.value, item.unit), [capital(origins[item.origin]), element('small', {}, item.reason)]])),
      some('versions', 'Versions', ['Program', 'Version'], gap.versions.map((item) => [item.name, item.version])),
      some('failures', 'Failed simulations', ['Failed simulation', 'What happened'], gap.failures.map((item) => [item.run, item.what]))));
}
