// The scale of residuals: plain cloth where there is none, to a dark red.
// SPDX-License-Identifier: LGPL-2.1-or-later

const STOPS = [[0, 240, 234, 222], [0.2, 248, 214, 150], [0.45, 244, 150, 70],
  [0.7, 214, 62, 52], [1, 104, 10, 62]];
const UNSEEN = [128, 134, 145];

const table = new Uint8ClampedArray(3 * 256);
for (let i = 0; i < 256; i++) {
  const at = i / 255;
  const k = Math.max(1, STOPS.findIndex((stop) => stop[0] >= at));
  const [low, high] = [STOPS[k - 1], STOPS[k]];
  const part = (at - low[0]) / (high[0] - low[0]);
  for (let c = 0; c < 3; c++) table[3 * i + c] = low[c + 1] + part * (high[c + 1] - low[c + 1]);
}

// Red, green, blue of 0 to 255 for a value of 0 to 1; NaN: not seen.
export function shade(value, into, offset = 0) {
  if (Number.isNaN(value)) {
    into[offset] = UNSEEN[0];
    into[offset + 1] = UNSEEN[1];
    into[offset + 2] = UNSEEN[2];
    return;
  }
  const i = 3 * Math.round(255 * Math.min(1, Math.max(0, value)));
  into[offset] = table[i];
  into[offset + 1] = table[i + 1];
  into[offset + 2] = table[i + 2];
}

export function css(value) {
  const rgb = [0, 0, 0];
  shade(value, rgb);
  return `rgb(${rgb.join(',')})`;
}
