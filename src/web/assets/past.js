// SPDX-License-Identifier: Apache-2.0
// The time of a recording: a slider, play and pause, and where robots were stalled.

import {byId, element, mark, say} from './dom.js';

const SPEEDS = [0.25, 0.5, 1, 2, 5, 10, 30];
const MARKS_MAX = 300;
const LEAP = 30; /* steps; the server gives mail of so many */
const PATIENCE_MS = 1000;

/** What recording is shown: {name, first, last, step_ms, robots, stalls}; null: a run is. */
export async function fetchRecording() {
  const answer = await fetch('/recording', {cache: 'no-store'});
  return answer.ok ? answer.json() : null;
}

/** Where robots were: {steps, robots}. */
export async function fetchTracks() {
  const answer = await fetch('/tracks', {cache: 'no-store'});
  return answer.ok ? answer.json() : {steps: [], robots: []};
}

async function fetchMoment(step, robot) {
  const answer = await fetch(`/moments/${step}/${encodeURIComponent(robot)}`, {cache: 'no-store'});
  return answer.ok ? answer.json() : null;
}

/** Why a robot drove as it did at a step, as lines. */
export async function fetchWhy(step, robot) {
  const answer = await fetch(`/why/${step}/${encodeURIComponent(robot)}`, {cache: 'no-store'});
  return (await answer.text()).trimEnd();
}

/**
 * @param whole  from fetchRecording
 * @param robotOf  whose mind is to come with a moment; '': none
 * @param onMoment  is given each moment, and whether it goes on from the one before
 * @param onStall  is asked of a stall: [robot's index, first step, last step]
 */
export function createPast(whole, {robotOf, onMoment, onStall}) {
  const {first, last} = whole;
  let wanted = first, shown = -1, asked = '', busy = false, stale = false;
  let playing = false, speed = 1, clock = 0, rest = 0;

  const button = element('button', {type: 'button', id: 'play', click: toggle}, 'Play');
  const slider = element('input', {type: 'range', id: 'slider', min: first, max: last, step: 1, value: first,
    'aria-label': 'time', input: () => seek(Number(slider.value))});
  const choice = element('select', {id: 'speed', 'aria-label': 'speed', change: () => { speed = Number(choice.value); }},
    ...SPEEDS.map((value) => element('option', {value, selected: value === 1}, `${value} ×`)));
  const time = element('output', {id: 'moment'});
  const marks = element('div', {class: 'marks'});
  const bar = byId('past');
  bar.append(button, choice, element('div', {class: 'track'}, slider, marks), time);
  bar.hidden = false;

  const secondsOf = (step) => step * whole.step_ms / 1000;

  function seek(step) {
    wanted = Math.min(last, Math.max(first, Math.round(step)));
    rest = 0;
    fill();
  }

  function toggle() {
    playing = !playing;
    if (playing && wanted >= last) seek(first);
    clock = performance.now();
    say(button, playing ? 'Pause' : 'Play');
  }

  /* One question at a time: where the slider was meanwhile is not asked. */
  async function fill() {
    if (busy) return;
    busy = true;
    try {
      while (wanted !== shown || stale) {
        const step = wanted;
        stale = false;
        asked = robotOf();
        const moment = await fetchMoment(step, asked);
        if (moment) onMoment(moment, shown >= 0 && step >= shown && step - shown <= LEAP);
        shown = step;
      }
    } catch {
      await new Promise((resolve) => setTimeout(resolve, PATIENCE_MS)); /* it is gone; the page says so */
    }
    busy = false;
  }

  return {
    seek,
    toggle,
    get step() {
      return wanted;
    },
    by: (steps) => seek(wanted + steps),
    /** Asks again, for another robot's mind. */
    renew() {
      stale = true;
      fill();
    },
    /** Puts marks where robots were stalled. */
    load(scene, colors) {
      const span = Math.max(1, last - first);
      marks.replaceChildren(...whole.stalls.slice(0, MARKS_MAX).map((stall) => {
        const [robot, from, to] = stall;
        const node = element('button', {type: 'button', class: 'stall', click: () => onStall(stall),
          title: `${scene.robots[robot]?.name} stalled from ${secondsOf(from).toFixed(1)} s to ${secondsOf(to + 1).toFixed(1)} s: why?`});
        node.style.left = `${100 * (from - first) / span}%`;
        node.style.setProperty('--robot', colors[robot] ?? '');
        return node;
      }));
    },
    /** Sixty times a second. */
    draw(now) {
      if (playing) {
        rest += Math.max(0, now - clock) * speed / whole.step_ms;
        wanted = Math.min(last, wanted + Math.floor(rest));
        rest -= Math.floor(rest);
        if (wanted >= last) toggle();
      }
      clock = now;
      if (robotOf() !== asked) stale = true;
      if (wanted !== shown || stale) fill();
      if (slider.value !== String(wanted)) slider.value = wanted;
      say(time, `${secondsOf(wanted).toFixed(1)} of ${secondsOf(last).toFixed(1)} s`);
      mark(slider, 'aria-valuetext', `${secondsOf(wanted).toFixed(1)} seconds`);
    },
    get speed() {
      return playing ? speed : 0;
    },
  };
}
