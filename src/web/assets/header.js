// SPDX-License-Identifier: Apache-2.0
// The line above the world, and the word across it when something is not as usual.

import {byId, element, mark, say} from './dom.js';

const PACE_SPAN_S = 2;

const STATES = {none: 'no run', waiting: 'waiting', ready: 'ready', running: 'running', done: 'ended', fault: 'fault',
  recorded: 'recording', lost: 'no contact'};

/** Simulated seconds in a second, lately. */
function createPace() {
  let marks = [];
  return {
    take(frame) {
      if (marks.length && frame.step < marks[marks.length - 1].step) marks = [];
      marks.push({step: frame.step, time: frame.time, wall: frame.wall});
      while (marks.length > 2 && frame.wall - marks[0].wall > PACE_SPAN_S) marks.shift();
    },
    get value() {
      const first = marks[0], last = marks[marks.length - 1];
      return last && last.wall > first.wall ? (last.time - first.time) / (last.wall - first.wall) : 0;
    },
  };
}

/* What the banner says; null: nothing. */
function bannerOf({linked, full, blind, hello, run, scene}) {
  if (full) return {bad: true, words: ['As many pages are open as muster web has room for; this one tries again.']};
  if (!linked) return {bad: true, words: ['The page has lost muster web; it tries again.']};
  if (blind) return {bad: true, words: [`There is no picture of this run: ${blind}.`]};
  if (!run) return null;
  if (run.state === 'fault') return {bad: true, words: ['The run has failed: ', element('code', {}, run.waits_for)]};
  if (run.state === 'waiting' && run.waits_for) return {words: [`The run waits for ${run.waits_for}.`]};
  if (run.state === 'done') {
    const report = run.report ? [', report ', element('code', {}, run.report)] : [];
    return {words: ['The run has ended, hash ', element('code', {}, run.hash.slice(0, 16)), '…', ...report]};
  }
  if (run.state === 'none' && !scene) {
    const command = `muster run experiments/follow.yaml --rate 1 --domain ${hello?.domain ?? 0}`;
    return {words: ['There is no run yet.  To start one: ', element('code', {}, command)]};
  }
  if (run.state === 'none') return {bad: true, words: ['The run is gone.  This is how it was last.']};
  if (run.state === 'recorded') return null;
  if (!run.broker) return {bad: true, words: ['The broker is gone: robots cannot be reached.']};
  return null;
}

export function createHeader() {
  const pace = createPace();
  const state = {linked: true, full: false, blind: '', hello: null, run: null, scene: null, frame: null, missed: 0,
    lost: 0, mails: 0, rate: 0}; /* mails, rate: of a recording */
  let shown = '';

  function sayBanner() {
    const banner = byId('banner'), now = bannerOf(state);
    const text = now ? now.words.map((word) => word.textContent ?? word).join('') : '';
    if (text === shown) return;
    shown = text;
    banner.hidden = !now;
    banner.classList.toggle('bad', Boolean(now?.bad));
    banner.replaceChildren(...(now?.words ?? []));
  }

  return {
    set(change) {
      if (change.frame) pace.take(change.frame);
      if (change.scene !== undefined && state.scene !== change.scene) state.frame = null;
      Object.assign(state, change);
    },
    draw() {
      const {run, scene, frame, missed, lost} = state;
      const time = Math.max(frame?.time ?? 0, run?.state === 'running' ? 0 : (run?.time_ms ?? 0) / 1000);
      const name = state.linked ? run?.state ?? 'none' : 'lost';
      const length = (run?.duration_ms ?? 0) / 1000;
      const running = run?.state === 'running';
      const whole = run && run.wall_ms > 0 ? run.time_ms / run.wall_ms : 0;
      const rate = running ? pace.value : run?.state === 'recorded' ? state.rate : whole;
      say(byId('world'), scene ? `${scene.world} · seed ${scene.seed}` : '');
      say(byId('state'), STATES[name] ?? name);
      mark(byId('state'), 'data-state', name);
      say(byId('time'), time.toFixed(1));
      say(byId('step'), String(Math.max(frame?.step ?? 0, run?.step ?? 0)));
      say(byId('pace'), rate >= 100 ? rate.toFixed(0) : rate.toFixed(1));
      say(byId('mails'), String(run?.state === 'recorded' ? state.mails : run?.mails[0] ?? 0));
      byId('progress').value = length > 0 ? Math.min(1, time / length) : 0;
      byId('progress').hidden = length <= 0;
      const many = (count, what) => `${count} ${what}${count === 1 ? '' : 's'}`;
      const notes = [missed > 0 && `${many(missed, 'frame')} passed over`, lost > 0 && `${many(lost, 'answer')} lost`];
      say(byId('note'), notes.filter(Boolean).join(', '));
      sayBanner();
    },
  };
}
