// The cloth laid flat: residuals over (u, v).
// SPDX-License-Identifier: LGPL-2.1-or-later
import { css, shade } from './colours.js';
import { colour, element } from './dom.js';
import { number } from './words.js';

const LEFT = 34, TOP = 6, RIGHT = 6, BOTTOM = 30;

export class FlatMap {
  constructor(playback, title) {
    this.playback = playback;
    this.canvas = element('canvas', { role: 'img', 'aria-label': title });
    this.node = element('figure', { class: 'map' }, element('figcaption', {}, title), this.canvas);
    const { uv } = playback;
    this.low = [Infinity, Infinity];
    this.high = [-Infinity, -Infinity];
    for (let i = 0; i < uv.length; i++) {
      this.low[i % 2] = Math.min(this.low[i % 2], uv[i]);
      this.high[i % 2] = Math.max(this.high[i % 2], uv[i]);
    }
  }

  flat() {
    return this.high[0] > this.low[0] && this.high[1] > this.low[1];
  }

  resize(width) {
    const ratio = Math.min(2, devicePixelRatio);
    const span = [this.high[0] - this.low[0], this.high[1] - this.low[1]];
    const w = Math.min(width, 340);
    const scale = Math.min((w - LEFT - RIGHT) / span[0], 300 / span[1]);
    const height = Math.round(scale * span[1]) + TOP + BOTTOM;
    this.scale = scale;
    this.canvas.style.width = w + 'px';
    this.canvas.style.height = height + 'px';
    this.canvas.width = Math.round(w * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.ratio = ratio;
  }

  // v grows downwards: the top edge of the cloth is on top.
  draw(values, limit) {
    const { uv, faces } = this.playback;
    const context = this.canvas.getContext('2d');
    const x = (vertex) => LEFT + this.scale * (uv[2 * vertex] - this.low[0]);
    const y = (vertex) => TOP + this.scale * (uv[2 * vertex + 1] - this.low[1]);
    const rgb = [0, 0, 0];
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    for (let f = 0; f < faces.length; f += 4) {
      const n = faces[f + 3] === 0xffffffff ? 3 : 4;
      let sum = 0;
      context.beginPath();
      for (let i = 0; i < n; i++) {
        const vertex = faces[f + i];
        sum += values[vertex];
        if (i) context.lineTo(x(vertex), y(vertex));
        else context.moveTo(x(vertex), y(vertex));
      }
      context.closePath();
      shade(sum / n / limit, rgb);
      context.fillStyle = context.strokeStyle = `rgb(${rgb.join(',')})`;
      context.fill();
      context.lineWidth = 1;
      context.stroke();
    }
    this.#axes(context);
  }

  #axes(context) {
    const right = LEFT + this.scale * (this.high[0] - this.low[0]);
    const bottom = TOP + this.scale * (this.high[1] - this.low[1]);
    context.fillStyle = colour('soft');
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'left';
    context.fillText(number(this.low[0], 2), LEFT, bottom + 14);
    context.textAlign = 'center';
    context.fillText('u, m', (LEFT + right) / 2, bottom + 14);
    context.textAlign = 'right';
    context.fillText(number(this.high[0], 2), right, bottom + 14);
    context.fillText(number(this.low[1], 2), LEFT - 5, TOP + 9);
    context.fillText('v, m', LEFT - 5, (TOP + bottom) / 2);
    context.fillText(number(this.high[1], 2), LEFT - 5, bottom);
  }
}

// The colours' key, of a scale from 0 or from −1 to 1.
export function legend(paint = shade, low = 0, unseen = 'not seen') {
  const strip = element('span', { class: 'strip' });
  const stops = [];
  for (let i = 0; i <= 20; i++) stops.push(css(low + (1 - low) * i / 20, paint));
  strip.style.background = `linear-gradient(to right, ${stops.join(',')})`;
  const bottom = element('span', {}, '0');
  const top = element('span', {}, '');
  return {
    node: element('div', { class: 'legend' }, bottom, strip, top, element('span', { class: 'unseen' }, unseen)),
    set(text, least = '0') {
      top.textContent = text;
      bottom.textContent = least;
    },
  };
}
