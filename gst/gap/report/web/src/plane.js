// Drawings in the plane of a camera's picture.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { shade } from './colours.js';
import { colour, element, whenShown } from './dom.js';
import { number } from './words.js';

// A figure as wide as there is room; `draw(context, scale, width, height)` draws it, in CSS
// pixels, `scale` of them for one of the picture's.
export function plane(camera, title, label, draw, most = 540) {
  const canvas = element('canvas', { role: 'img', 'aria-label': label });
  const node = element('figure', { class: 'plane' }, element('figcaption', {}, ...[title].flat()), canvas);
  let shown = 0;
  node.redraw = () => {
    if (!shown) return;
    const ratio = Math.min(2, devicePixelRatio);
    const scale = Math.min(shown, most) / camera.width;
    const width = scale * camera.width, height = scale * camera.height;
    canvas.style.width = width + 'px';
    canvas.style.height = height + 'px';
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    draw(context, scale, width, height);
  };
  whenShown(node, (width) => {
    shown = width;
    node.redraw();
  });
  return node;
}

// A hundredth of a pixel is plain, ten are dark.
export const sigmaShade = (sigma) => sigma === null ? NaN : (Math.log10(sigma) + 2) / 3;

function write(context, text, x, y, align) {
  context.font = '600 12px system-ui, sans-serif';
  context.textAlign = align;
  context.lineWidth = 3;
  context.strokeStyle = 'rgba(255, 255, 255, 0.85)';
  context.strokeText(text, x, y);
  context.fillStyle = '#111';
  context.fillText(text, x, y);
}

// Where the map passes a level: of each cell the line between two of its edges.
function contour(context, map, columns, rows, level, width, height) {
  const value = (i, j) => map[j * columns + i] ?? Infinity;
  context.beginPath();
  for (let j = 0; j + 1 < rows; j++) {
    for (let i = 0; i + 1 < columns; i++) {
      const ring = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
      const ends = [];
      for (let k = 0; k < 4; k++) {
        const [a, b] = [ring[k], ring[(k + 1) % 4]];
        const [va, vb] = [value(...a), value(...b)];
        if ((va > level) === (vb > level)) continue;
        const part = Number.isFinite(va) && Number.isFinite(vb) ? (level - va) / (vb - va) : 0.5;
        ends.push([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
      }
      for (let k = 0; k + 1 < ends.length; k += 2) {
        context.moveTo(ends[k][0] / (columns - 1) * width, ends[k][1] / (rows - 1) * height);
        context.lineTo(ends[k + 1][0] / (columns - 1) * width, ends[k + 1][1] / (rows - 1) * height);
      }
    }
  }
  context.lineWidth = 3;
  context.strokeStyle = 'rgba(255, 255, 255, 0.85)';
  context.stroke();
  context.lineWidth = 1.5;
  context.strokeStyle = '#111';
  context.stroke();
}

// The map of the standard deviations, with numbers in the corners and the centre.
export function drawMap(context, map, columns, level, width, height) {
  const rows = map.length / columns;
  const w = width / (columns - 1), h = height / (rows - 1);
  const small = element('canvas', { width: columns, height: rows });
  const image = new ImageData(columns, rows);
  map.forEach((sigma, i) => {
    shade(sigmaShade(sigma), image.data, 4 * i);
    image.data[4 * i + 3] = 255;
  });
  small.getContext('2d').putImageData(image, 0, 0);
  context.imageSmoothingQuality = 'high';
  context.drawImage(small, -w / 2, -h / 2, width + w, height + h);
  contour(context, map, columns, rows, level, width, height);
  const at = (i, j) => {
    const sigma = map[j * columns + i];
    return sigma === null ? 'unknown' : number(sigma, 2);
  };
  write(context, at(0, 0), 6, 16, 'left');
  write(context, at(columns - 1, 0), width - 6, 16, 'right');
  write(context, at(0, rows - 1), 6, height - 7, 'left');
  write(context, at(columns - 1, rows - 1), width - 6, height - 7, 'right');
  write(context, at((columns - 1) / 2, (rows - 1) / 2), width / 2, height / 2 + 4, 'center');
}

// Corners with their residuals, `times` as long; outliers in another colour.
export function drawCorners(context, view, scale, times, ink) {
  const outliers = new Set(view.outliers);
  view.x.forEach((x, i) => {
    const [u, v] = [(x + 0.5) * scale, (view.y[i] + 0.5) * scale];
    context.strokeStyle = context.fillStyle = outliers.has(i) ? colour('bad') : ink;
    context.beginPath();
    context.arc(u, v, outliers.has(i) ? 4 : 1.6, 0, 2 * Math.PI);
    if (outliers.has(i)) context.stroke();
    else context.fill();
    if (view.dx[i] === null) return;
    context.beginPath();
    context.moveTo(u, v);
    context.lineTo(u + times * scale * view.dx[i], v + times * scale * view.dy[i]);
    context.stroke();
  });
}

export function drawFrame(context, width, height) {
  context.fillStyle = colour('stage');
  context.fillRect(0, 0, width, height);
  context.lineWidth = 1.2;
}

// How the residuals of both axes are distributed, beside a Gaussian of the same width.
export function drawHistogram(context, values, sigma, width, height) {
  const span = 4 * sigma, n = 41, base = height - 22;
  const bins = new Array(n).fill(0);
  for (const value of values) {
    const k = Math.floor((value + span) / (2 * span) * n);
    bins[Math.min(n - 1, Math.max(0, k))]++;
  }
  const gauss = (x) => values.length * 2 * span / n * Math.exp(-x * x / (2 * sigma * sigma)) / (sigma * Math.sqrt(2 * Math.PI));
  const top = Math.max(gauss(0), ...bins, 1) / (base - 8);
  drawFrame(context, width, height);
  context.fillStyle = colour('mark');
  bins.forEach((count, k) => context.fillRect(k * width / n + 0.5, base - count / top, width / n - 1, count / top));
  context.strokeStyle = colour('before');
  context.lineWidth = 2;
  context.beginPath();
  for (let x = 0; x <= width; x += 2) context.lineTo(x, base - gauss((x / width * 2 - 1) * span) / top);
  context.stroke();
  context.fillStyle = colour('ink');
  context.font = '12px system-ui, sans-serif';
  for (const [part, align] of [[0, 'left'], [0.5, 'center'], [1, 'right']]) {
    context.textAlign = align;
    context.fillText(part === 0.5 ? '0' : `${part ? '' : '−'}${number(span, 2)} px`, part * width + (align === 'left' ? 4 : align === 'right' ? -4 : 0), height - 6);
  }
}
