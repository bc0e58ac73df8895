// The page, from what it carries.
// SPDX-License-Identifier: LGPL-2.1-or-later
import 'uplot/dist/uPlot.min.css';
import './style.css';
import { charts, overTime } from './charts.js';
import { Playback, read } from './data.js';
import { next, provenance } from './ending.js';
import { Player } from './player.js';
import { effects, verdict } from './verdict.js';

const gap = read('gap');
const arrays = read('arrays');
const page = document.getElementById('report');

let player = null;
let time = null;
if (arrays.playback) player = new Player(new Playback(arrays.playback), gap.where, () => time?.redraw());
if (arrays.series) {
  time = overTime(arrays.series, gap.where.onset_s, () => player?.time ?? NaN, (at) => player?.seekTime(at));
}

page.replaceChildren(...[verdict(gap), effects(gap, arrays.about), player?.node, charts(gap, arrays, time),
  next(gap), provenance(gap)].filter(Boolean));
player?.start();
document.documentElement.dataset.ready = 'yes';
