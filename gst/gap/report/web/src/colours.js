// Scales: of distances, plain cloth where there is none, to a dark red; of strain, blue where
// threads are shorter, red where longer. clothoverlay has the same.
// SPDX-License-Identifier: LGPL-2.1-or-later

const PLAIN = [240, 234, 222];
const WARM = [[0, ...PLAIN], [0.2, 248, 214, 150], [0.45, 244, 150, 70], [0.7, 214, 62, 52], [1, 104, 10, 62]];
const COLD = [[0, ...PLAIN], [0.2, 178, 216, 232], [0.45, 92, 164, 220], [0.7, 44, 100, 190], [1, 22, 32, 110]];
const UNSEEN = [128, 134, 145];
// By ClothVertexState.
const STATES = [UNSEEN, [51, 217, 115], [255, 184, 38], [64, 153, 255], [191, 115, 255]];

function table(stops) {
  const made = new Uint8ClampedArray(3 * 256);
  for (let i = 0; i < 256; i++) {
    const at = i / 255;
    const k = Math.max(1, stops.findIndex((stop) => stop[0] >= at));
    const [low, high] = [stops[k - 1], stops[k]];
    const part = (at - low[0]) / (high[0] - low[0]);
    for (let c = 0; c < 3; c++) made[3 * i + c] = low[c + 1] + part * (high[c + 1] - low[c + 1]);
  }
  return made;
}

const warm = table(WARM);
const cold = table(COLD);

function put(from, i, into, offset) {
  for (let c = 0; c < 3; c++) into[offset + c] = from[i + c];
}

// Red, green, blue of 0 to 255 for a value of 0 to 1; NaN: not seen.
export function shade(value, into, offset = 0) {
  if (Number.isNaN(value)) put(UNSEEN, 0, into, offset);
  else put(warm, 3 * Math.round(255 * Math.min(1, Math.max(0, value))), into, offset);
}

// The same for one of −1 to 1.
export function shadeStrain(value, into, offset = 0) {
  if (Number.isNaN(value)) put(UNSEEN, 0, into, offset);
  else put(value < 0 ? cold : warm, 3 * Math.round(255 * Math.min(1, Math.abs(value))), into, offset);
}

export function shadeState(state, into, offset = 0) {
  put(STATES[state] ?? UNSEEN, 0, into, offset);
}

export function css(value, paint = shade) {
  const rgb = [0, 0, 0];
  paint(value, rgb);
  return `rgb(${rgb.join(',')})`;
}
