// What to do: the change to make, what it brings, and what to film next.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { bar, element, section, table } from './dom.js';
import { digits, known, number, percent, range, spoken, unit } from './words.js';

// One line a change, which is a setting with a comment in most languages.
function lines(gap) {
  return gap.patch.map((item) => {
    const symbol = unit(item.unit).trim();
    const was = [symbol, known(item.before) ? `was ${digits(item.before)}` : 'new', item.text].filter(Boolean).join('; ');
    return known(item.after) ? `${item.name} = ${digits(item.after)}  # ${was}` : `# ${item.name}: ${item.text}`;
  }).join('\n') + '\n';
}

// The clipboard where the browser allows it, else the old way, else by hand.
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch (refused) {
    const area = element('textarea', { 'aria-hidden': 'true', class: 'aside' });
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand('copy');
    area.remove();
    return done;
  }
}

function patch(gap) {
  if (!gap.patch.length) return null;
  const told = element('span', { id: 'copied', role: 'status' });
  const button = element('button', { type: 'button', id: 'copy' }, 'Copy as text');
  button.addEventListener('click', async () => {
    const done = await copy(lines(gap));
    button.focus();
    told.textContent = done ? 'Copied.' : 'This browser does not let pages copy: mark the table by hand.';
  });
  const where = gap.patch_simulator ? `In the names and units of ${gap.patch_simulator}.`
    : gap.has_simulated ? 'What to add to your simulation, in the names and units of model.json.'
      : 'In the names and units of model.json. The file fitted.json beside this page is the whole model with these changes.';
  return element('div', { id: 'patch' },
    element('h3', {}, `What to change in ${gap.patch_simulator ?? (gap.has_simulated ? 'your simulation' : 'the model')}`),
    element('p', { class: 'note' }, where),
    table('changes', 'What to change', ['Setting', 'Now', 'Set to', 'In words'], gap.patch.map((item) => [
      element('code', { class: 'setting' }, item.name),
      known(item.before) ? number(item.before) + unit(item.unit) : 'not there',
      element('strong', {}, known(item.after) ? number(item.after) + unit(item.unit) : 'not possible there'),
      item.text])),
    element('p', { class: 'action' }, button, ' ', told));
}

// Of what is above the floor, as the shrink in windows is; that of the runs from the start.
function freeShrink(gap) {
  const role = gap.held_out === 'takes' ? 'hold_out' : 'take';
  const take = gap.takes.find((item) => item.role === role);
  const [before, after, floor] = ['free_before', 'free_after', 'free_floor'].map((key) => take?.[key].value ?? NaN);
  const share = (before ** 2 - after ** 2) / (before ** 2 - floor ** 2);
  return { value: before > floor && Number.isFinite(share) ? share : null, interval: null };
}

// A gap that ends below the floor, which is an estimate itself, has lost all that was above it: how many times
// over says nothing.
function measure({ value, interval }) {
  return known(value) ? [bar(value, 'shrink', interval),
    element('span', {}, value > 1 && !interval ? 'all that is above the floor' : percent(value)), ' ',
    element('span', { class: 'interval' }, range(interval, 100, 0))] : ['not measured'];
}

function shrinks(gap) {
  const columns = gap.has_simulated ? [['Expected in your simulator', gap.predicted_shrink], ['Measured in your simulator', gap.measured_shrink]]
    : [['Measured', { windows: gap.shrink, free: freeShrink(gap) }]];
  if (!columns.some(([, item]) => known(item.windows.value) || known(item.free.value))) return null;
  return element('div', { id: 'shrinks' }, element('h3', {}, 'What it brings'),
    element('p', { class: 'note' }, 'How much of the gap that is more than noise goes away, of its square. Short windows flatter: each starts where the recording is. ' +
      'The free run starts with the take and is never put right, so that errors add up.'),
    table('brings', 'What it brings', ['Measured over', ...columns.map(([title]) => title)], [
      ['windows of 0.3 s', ...columns.map(([, item]) => measure(item.windows))],
      ['the free run', ...columns.map(([, item]) => measure(item.free))]]));
}

// How good the evidence of a log Bayes factor is: odds.
function odds(evidence) {
  const value = Math.exp(Math.min(evidence, 100));
  return value < 1e6 ? `${Number(value.toPrecision(2))} to 1` : 'more than a million to 1';
}

function advice(gap) {
  const list = gap.groups.filter((group) => group.effects.length > 1 && gap.verdict !== 'no_gap').map((group) => element('li', {},
    'To tell ', element('strong', {}, group.effects.map(spoken).join(' from ')), ': ',
    group.experiment ?? 'none of the captures that were tried would.',
    known(group.evidence) ? ' ' : null, known(group.evidence) ? element('span', { class: 'interval' },
      `Odds to expect for the right one: ${odds(group.evidence)}.`) : null));
  if (gap.verdict === 'undecidable' && gap.reason) list.unshift(element('li', {}, gap.reason));
  if (gap.verdict === 'unexplained') {
    list.push(element('li', {}, 'Something acts that the library does not have. Film the same motion with one condition changed at a time; the maps below say where on the cloth and when to look.'));
  }
  if (gap.held_out !== 'takes' && gap.verdict !== 'undecidable') {
    list.push(element('li', {}, 'The shrink was judged on time blocks of the same take. A second take of another motion, given as --hold-out, judges it harder.'));
  }
  if (gap.verdict !== 'undecidable' && !gap.has_simulated && !gap.inputs.some((input) => input.role === 'baseline')) {
    list.push(element('li', {}, 'Nothing tells the simulator’s own error from an effect. Give what your simulator makes of the same motion as --simulated, or a take on which the model is right as --baseline.'));
  }
  return list.length ? element('ul', {}, ...list)
    : element('p', {}, 'Nothing: the named effects are told apart from all others that were tested.');
}

export function todo(gap, points) {
  return section('todo', 'What to do', null, patch(gap), shrinks(gap), points,
    element('div', { id: 'next' }, element('h3', {}, 'What to film next'), advice(gap)));
}
