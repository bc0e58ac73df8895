// The page, from what it carries.
// SPDX-License-Identifier: LGPL-2.1-or-later
import 'uplot/dist/uPlot.min.css';
import './style.css';
import { charts, overTime } from './charts.js';
import { Playback, read } from './data.js';
import { provenance } from './ending.js';
import { effects, limits } from './evidence.js';
import { freeNumbers, takes } from './numbers.js';
import { Player } from './player.js';
import { Points } from './points.js';
import { todo } from './todo.js';
import { verdict } from './verdict.js';

const gap = read('gap');
const arrays = read('arrays');
const page = document.getElementById('report');

let player = null;
let points = null;
let time = null;
const seek = (at) => player.seekTime(at);
if (arrays.playback) {
  const playback = new Playback(arrays.playback);
  player = new Player(playback, gap.where, (at) => {
    time?.redraw();
    points?.mark(at);
  });
  if (playback.has('before')) points = new Points(playback, seek);
}
if (arrays.series) {
  time = overTime(arrays.series, gap.where.onset_s, () => player?.time ?? NaN, (at) => player?.seekTime(at));
}

page.replaceChildren(...[verdict(gap), todo(gap, points?.node), effects(gap, arrays.about), freeNumbers(gap), limits(gap), takes(gap),
  player?.node, charts(gap, arrays, time), provenance(gap)].filter(Boolean));
player?.start();
document.documentElement.dataset.ready = 'yes';
