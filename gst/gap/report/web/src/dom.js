// Elements of the page. Text goes in as text only: names come from strangers.
// SPDX-License-Identifier: LGPL-2.1-or-later

// element('td', { class: 'number' }, 'text', child …)
export function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) node.setAttribute(name, '');
    else if (value !== false && value != null) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child != null));
  return node;
}

export function section(id, title, note, ...children) {
  return element('section', { id, 'aria-labelledby': id + '-title' },
    element('h2', { id: id + '-title' }, title),
    note ? element('p', { class: 'note' }, note) : null,
    ...children);
}

// Rows of cells. On narrow screens each row becomes a block in which cells carry their titles;
// the roles keep it a table for those who listen to it.
export function table(id, caption, titles, rows, attributes = []) {
  const cell = (content, i) => element(i === 0 ? 'th' : 'td', i === 0 ? { scope: 'row', role: 'rowheader' }
    : { role: 'cell', 'data-title': titles[i] }, ...[content].flat());
  return element('div', { class: 'wide' },
    element('table', { id, role: 'table', 'aria-label': caption },
      element('thead', { role: 'rowgroup' }, element('tr', { role: 'row' }, ...titles.map(
        (title) => element('th', { scope: 'col', role: 'columnheader' }, title)))),
      element('tbody', { role: 'rowgroup' }, ...rows.map((row, i) =>
        element('tr', { role: 'row', ...attributes[i] }, ...row.map(cell))))));
}

// A bar as long as a share of 0 to 1, with the interval as a whisker.
export function bar(share, kind = '', interval = null) {
  const fill = element('span', { class: 'fill' });
  const box = element('span', { class: 'bar ' + kind, 'aria-hidden': 'true' }, fill);
  const percent = (value) => 100 * Math.min(1, Math.max(0, value)) + '%';
  fill.style.width = percent(share ?? 0);
  if (interval) {
    const whisker = element('span', { class: 'whisker' });
    whisker.style.left = percent(interval[0]);
    whisker.style.right = 100 - 100 * Math.min(1, Math.max(0, interval[1])) + '%';
    box.append(whisker);
  }
  return box;
}

export function radios(name, label, options, chosen, changed) {
  const group = element('fieldset', { class: 'choice' }, element('legend', {}, label));
  for (const [value, text] of options) {
    const input = element('input', { type: 'radio', name, value, id: name + '-' + value });
    input.checked = value === chosen;
    input.addEventListener('change', () => changed(value));
    group.append(element('span', {}, input, element('label', { for: input.id }, text)));
  }
  return group;
}

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
}

// Calls back now, when the theme changes, and when the node's width does.
export function whenShown(node, draw) {
  let width = 0;
  // Drawing may resize the node again: not within the observer.
  new ResizeObserver(() => requestAnimationFrame(() => {
    if (node.clientWidth !== width) {
      width = node.clientWidth;
      if (width > 0) draw(width);
    }
  })).observe(node);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    if (width > 0) draw(width);
  });
}
