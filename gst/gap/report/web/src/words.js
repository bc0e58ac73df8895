// Numbers and names as people read them.
// SPDX-License-Identifier: LGPL-2.1-or-later

export const known = (value) => typeof value === 'number' && Number.isFinite(value);

const short = (digits) => digits.includes('.') ? digits.replace(/\.?0+$/, '') : digits;

// At most three significant digits; plain notation where that is short.
export function number(value, digits = 3) {
  if (!known(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    const raised = [...String(Number(exponent))].map((c) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]);
    return `${short(mantissa)}·10${raised.join('')}`.replace('-', '−');
  }
  const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return short(value.toFixed(Math.min(places, 6))).replace('-', '−');
}

export const mm = (metres, places = 1) =>
  known(metres) ? (1000 * metres).toFixed(places).replace('-', '−') + ' mm' : '–';

export const percent = (share) =>
  known(share) ? (100 * share).toFixed(share !== 0 && Math.abs(share) < 0.01 ? 1 : 0).replace('-', '−') + '%' : '–';

// A fitted value and its 95% interval, with no more digits than are sure.
export function fitted(value, sigma) {
  if (!known(value) || !known(sigma) || sigma <= 0) return [number(value), ''];
  const power = Math.floor(Math.log10(sigma));
  const places = (sigma < 3 * 10 ** power ? 1 : 0) - power;
  if (places < 0 || places > 6) return [number(value), range([value - 1.96 * sigma, value + 1.96 * sigma])];
  const [text, ...ends] = [value, value - 1.96 * sigma, value + 1.96 * sigma].map(
    (number) => number.toFixed(places).replace('-', '−'));
  return [text, `[${ends.join(', ')}]`];
}

export function range(interval, scale = 1, digits = null) {
  if (!interval) return '';
  const text = interval.map((end) => digits === null ? number(scale * end)
    : (scale * end).toFixed(digits).replace('-', '−'));
  return `[${text[0]}, ${text[1]}]`;
}

export const spoken = (name) => String(name).replaceAll('_', ' ');

// Plain digits that any program reads, of no more than four that count.
export const digits = (value) => known(value) ? String(Number(value.toPrecision(4))) : '';

// [a], [a, b], [a, b, c] as "a", "a and b", "a, b and c".
export const listed = (items, last = ' and ') => items.length < 2 ? items.join('')
  : items.slice(0, -1).join(', ') + last + items[items.length - 1];

export const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// A length of less than a decimetre in millimetres.
export const quantity = (value, symbol) => {
  if (!known(value)) return '–';
  return symbol === 'm' && Math.abs(value) < 0.1 ? number(1000 * value) + ' mm' : number(value) + unit(symbol);
};

export const unit = (symbol) => symbol === '1' || symbol === '' ? '' : (symbol === '°' ? '' : ' ') + symbol;

export function probability(value) {
  if (!known(value)) return '–';
  if (value > 0 && value < 0.01) return '< 1%';
  if (value < 1 && value > 0.99) return '> 99%';
  return (100 * value).toFixed(0) + '%';
}

export function chance(value) {
  if (!known(value)) return '–';
  return value < 1e-4 ? '< 0.0001' : value.toFixed(value < 0.01 ? 4 : 2);
}

export const roles = { take: 'diagnosed take', baseline: 'baseline take', hold_out: 'unseen take', model: 'model',
  simulated: 'your simulation', simulated_after: 'your simulation with the effects' };

export const verdicts = {
  no_gap: 'No gap',
  explained: 'Explained',
  ambiguous: 'Ambiguous',
  unexplained: 'Unexplained',
  undecidable: 'Undecidable',
};
