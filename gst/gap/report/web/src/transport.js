// Through time: a slider, and playing at some speed.
// SPDX-License-Identifier: LGPL-2.1-or-later
import { element } from './dom.js';

export class Transport {
  // `times`: seconds, rising. `changed()` when another frame is shown, `reset()` for the button.
  constructor(times, frame, changed, reset) {
    this.times = times;
    this.frame = frame;
    this.changed = changed;
    this.playing = false;
    this.speed = 1;
    this.slider = element('input', { type: 'range', id: 'time', min: '0', max: String(times.length - 1),
      step: '1', value: String(frame), 'aria-label': 'Time' });
    this.slider.addEventListener('input', () => this.seek(Number(this.slider.value)));
    this.button = element('button', { type: 'button', id: 'play' }, 'Play');
    this.button.addEventListener('click', () => this.toggle());
    const speed = element('select', { id: 'speed', 'aria-label': 'Speed' }, ...[['1', '1×'], ['0.5', '½×'],
      ['0.25', '¼×'], ['0.1', '⅒×']].map(([value, text]) => element('option', { value }, text)));
    speed.addEventListener('change', () => { this.speed = Number(speed.value); });
    const home = element('button', { type: 'button' }, 'Reset view');
    home.addEventListener('click', reset);
    this.node = element('div', { class: 'controls' }, this.button, this.slider, speed, home);
  }

  get time() {
    return this.times[this.frame];
  }

  // What is shown, for those who listen.
  tell(text) {
    this.slider.setAttribute('aria-valuetext', text);
  }

  seek(frame) {
    this.frame = Math.min(this.times.length - 1, Math.max(0, frame));
    this.slider.value = String(this.frame);
    this.changed();
  }

  seekTime(time) {
    let best = 0;
    this.times.forEach((value, i) => {
      if (Math.abs(value - time) < Math.abs(this.times[best] - time)) best = i;
    });
    this.seek(best);
  }

  toggle() {
    this.playing = !this.playing;
    this.button.textContent = this.playing ? 'Pause' : 'Play';
    if (!this.playing) return;
    if (this.frame === this.times.length - 1) this.seek(0);
    let last = performance.now();
    let clock = this.time;
    let shown = this.frame;
    const tick = (now) => {
      if (!this.playing) return;
      const { times } = this;
      // Whoever moves the slider while it plays goes on from there.
      clock = this.frame === shown ? clock + (now - last) / 1000 * this.speed : this.time;
      last = now;
      if (clock > times[times.length - 1]) clock = times[0];
      shown = clock < this.time ? 0 : this.frame;
      while (shown + 1 < times.length && times[shown + 1] <= clock) shown++;
      if (shown !== this.frame) this.seek(shown);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }
}
